"""STL, text and binary."""

from __future__ import annotations

import re
import struct
from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np

from .._types import Array
from . import writing
from .continued import Continued
from .mesh_file import MeshFile
from .writing import FileError


def _corner_triangles(faces: list[list[int]]) -> Any:
    return [(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)]


_STL_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


class StlFile(MeshFile):
    """STL, binary and text: triangles are added after the last one. Corners at the same place, to the bit, are one vertex."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._new: list[tuple[Array, Array, int]] = []  # normal, corners, attribute or solid
        self._ends: list[int] = []  # of a text: where its solids end
        count = int.from_bytes(data[80:84], "little")
        found = re.findall(rb"(?im)^[ \t]*vertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", data)
        # many binary files start with "solid", too; some writers leave bytes behind the last triangle
        self._binary = len(data) >= 84 and (len(data) == 84 + 50 * count or (not found and count > 0))
        if self._binary:
            if len(data) < 84 + 50 * count:
                held = (len(data) - 84) // 50
                raise FileError(f"The file is no STL file, or it ends early: it announces {count} triangles and holds {held}")
            records = np.frombuffer(data, _STL_RECORD, count, 84)
            corners = records["corners"].reshape(-1, 3).astype(float)
            self._part_of = records["attribute"]
        else:
            corners = self._read_text(found)
        # in the order of their first use
        _, first, inverse = np.unique(corners, axis=0, return_index=True, return_inverse=True)
        order = np.argsort(first)
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        super().__init__(corners[first[order]].reshape(-1, 3), rank[inverse.reshape(-1)].reshape(-1, 3).tolist())

    def _read_text(self, found: list[tuple[bytes, ...]]) -> Array:
        data = self._data
        self._ends = [match.start() for match in re.finditer(rb"(?im)^[ \t]*endsolid", data)]
        if not re.match(rb"(?i)\s*solid", data):
            raise FileError("The file is no STL file: it neither starts with 'solid' nor holds as many triangles as it announces")
        if not self._ends:
            raise FileError(f"The STL file ends early: it has {len(found) // 3} triangles and no 'endsolid'")
        if len(found) % 3:
            raise FileError(f"The STL file is damaged: it has {len(found)} vertices, which are no whole triangles")
        starts = np.zeros(len(found) // 3, int)
        if len(self._ends) > 1:
            starts = np.array([m.start() for m in re.finditer(rb"(?im)^[ \t]*vertex[ \t]", data)][::3], int)
        self._part_of = np.searchsorted(self._ends[:-1], starts)
        try:
            return np.array(found, dtype="S").astype(float).reshape(-1, 3)
        except ValueError:
            raise FileError("The STL file has a vertex that is no three numbers") from None

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
