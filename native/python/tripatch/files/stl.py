"""STL, text and binary."""

from __future__ import annotations

import re
import struct
from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np

from .. import _arrays
from .._types import Array
from . import writing
from .continued import Continued
from .lines import Lines
from .mesh_file import MeshFile
from .writing import FileError


def _corner_triangles(faces: list[list[int]]) -> Any:
    return [(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)]


_VERTEX = rb"(?im)^[ \t]*vertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)"
_STL_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


class StlFile(MeshFile):
    """STL, binary and text: triangles are added after the last one. Corners at the same place, to the bit, are one vertex."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._new: list[tuple[Array, Array, int]] = []  # normal, corners, attribute or solid
        self._ends: list[int] = []  # of a text: where its solids end
        count = int.from_bytes(data[80:84], "little")
        # many binary files start with "solid", too; some writers leave bytes behind the last triangle
        exact = len(data) >= 84 and len(data) == 84 + 50 * count
        self._binary = exact or (len(data) >= 84 and count > 0 and not re.search(_VERTEX, data))
        if self._binary:
            if len(data) < 84 + 50 * count:
                held = (len(data) - 84) // 50
                raise FileError(f"The file is no STL file, or it ends early: it announces {count} triangles and holds {held}")
            records = np.frombuffer(data, _STL_RECORD, count, 84)
            corners = records["corners"].reshape(-1, 3)
            self._part_of = records["attribute"]
        else:
            corners = self._read_text()
        first, place = _arrays.same_places(corners)  # in the order of their first use
        super().__init__(corners[first].astype(float), place.reshape(-1, 3))

    def _read_text(self) -> Array:
        data = self._data
        if not re.match(rb"(?i)\s*solid", data):
            raise FileError("The file is no STL file: it neither starts with 'solid' nor holds as many triangles as it announces")
        lines = Lines(data)
        self._ends = lines.starts[lines.beginning_with(b"endsolid")].tolist()
        chosen = lines.beginning_with(b"vertex")
        if not self._ends:
            raise FileError(f"The STL file ends early: it has {len(chosen) // 3} triangles and no 'endsolid'")
        if len(chosen) % 3:
            raise FileError(f"The STL file is damaged: it has {len(chosen)} vertices, which are no whole triangles")
        self._part_of = np.searchsorted(self._ends[:-1], lines.starts[chosen[::3]])
        corners = np.full((len(chosen), 3), np.nan)
        left = np.ones(len(chosen), bool)
        for some, numbers, _ in lines.table(chosen, b"", keyword=b"vertex"):
            if numbers.shape[1] >= 3:
                at = np.searchsorted(chosen, some)
                corners[at], left[at] = numbers[:, :3, 0], False
        try:
            for k in np.flatnonzero(left).tolist():
                corners[k] = [float(word) for word in lines.words(chosen[k])[1:4]]
        except ValueError:
            raise FileError("The STL file has a vertex that is no three numbers") from None
        return corners

    @classmethod
    def of_mesh(cls, vertices: Array, faces: list[list[int]]) -> StlFile:
        stl = cls(b"STL".ljust(80) + struct.pack("<I", 0))
        triangles = np.array(_corner_triangles(faces), int).reshape(-1, 3)
        stl._add(np.asarray(vertices, float)[triangles], [0] * len(triangles))
        stl._part_of = np.zeros(len(faces), int)
        MeshFile.__init__(stl, vertices, faces)  # numbered as given, not by first use
        return stl

    def _move(self, v: int, place: Array) -> None:
        raise FileError("An STL file has a copy of a vertex for every triangle and none is moved; write another format")

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        raise FileError("An STL file holds triangles, and one with a split edge is none; write another format")

    def _look(self, f: int) -> Hashable:
        return int(self._part_of[f])

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        places = np.concatenate([self.vertices, fill.vertices])
        for k, face in enumerate(fill.faces):
            part = int(self._part_of[continued.model[k]]) if continued.model else 0
            triangles = _corner_triangles([face])
            self._add(places[np.array(triangles, int)], [part] * len(triangles))

    def _add(self, triangles: Array, parts: Sequence[int]) -> None:
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        self._new += list(zip(np.divide(normal, length, out=np.zeros_like(normal), where=length > 0), triangles, parts))

    def _pieces(self) -> list[tuple[bytes, bytes]]:
        data = self._data
        if self._binary:
            records = np.zeros(len(self._new), _STL_RECORD)
            for record, (normal, corners, attribute) in zip(records, self._new):
                record["normal"], record["corners"], record["attribute"] = normal, corners, attribute
            old = int.from_bytes(data[80:84], "little")
            end, count = 84 + 50 * old, struct.pack("<I", old + len(self._new))
            kept, rest = data[84:end], data[end:]
            return [(data[:80], data[:80]), (count, data[80:84]), (kept, kept), (records.tobytes(), b""), (rest, rest)]
        eol = writing.line_end(writing.lines(data[:1000]))
        upper = data.lstrip()[:5].isupper()
        pieces, last = [], 0
        for solid, end in enumerate(self._ends):
            text = []
            for normal, corners, part in self._new:
                if part == solid:
                    text += [b"  facet normal " + writing.numbers(normal), b"    outer loop"]
                    text += [b"      vertex " + writing.numbers(p) for p in corners]
                    text += [b"    endloop", b"  endfacet"]
            added = b"".join((line.upper() if upper else line) + eol for line in text)
            pieces += [(data[last:end], data[last:end]), (added, b"")]
            last = end
        return [*pieces, (data[last:], data[last:])]
