"""STL, text and binary."""

from __future__ import annotations

import re
import struct
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Array
from . import writing
from .mesh_file import MeshFile
from .writing import FileError


def _corner_triangles(faces: list[list[int]]) -> Any:
    return [(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)]


_STL_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


class StlFile(MeshFile):
    """STL, binary and text: triangles are added after the last one. Corners at the same place, to the bit, are one vertex."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._new: list[tuple[Array, Array]] = []  # normal, corners
        count = int.from_bytes(data[80:84], "little")
        self._binary = len(data) >= 84 and len(data) == 84 + 50 * count  # many binary files start with "solid", too
        if self._binary:
            corners = np.frombuffer(data, _STL_RECORD, count, 84)["corners"].reshape(-1, 3).astype(float)
        else:
            self._end = re.search(rb"(?im)^[ \t]*endsolid", data)
            words = re.findall(rb"(?im)^[ \t]*vertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", data)
            if not re.match(rb"(?i)\s*solid", data) or not self._end or len(words) % 3:
                raise FileError("The file is no STL file, or it is damaged")
            if len(re.findall(rb"(?im)^[ \t]*solid", data)) > 1:
                raise FileError("STL files with several solids cannot be read")
            try:
                corners = np.array(words, dtype="S").astype(float).reshape(-1, 3)
            except ValueError:
                raise FileError("The STL file has a vertex that is no three numbers") from None
        # in the order of their first use
        _, first, inverse = np.unique(corners, axis=0, return_index=True, return_inverse=True)
        order = np.argsort(first)
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        super().__init__(corners[first[order]].reshape(-1, 3), rank[inverse.reshape(-1)].reshape(-1, 3).tolist())

    @classmethod
    def of_mesh(cls, vertices: Array, faces: list[list[int]]) -> StlFile:
        stl = cls(b"STL".ljust(80) + struct.pack("<I", 0))
        stl._add(np.asarray(vertices, float)[np.array(_corner_triangles(faces), int).reshape(-1, 3)])
        MeshFile.__init__(stl, vertices, faces)  # numbered as given, not by first use
        return stl

    def _move(self, v: int, place: Array) -> None:
        raise FileError("An STL file has a copy of a vertex for every triangle and none is moved; write another format")

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        raise FileError("An STL file holds triangles, and one with a split edge is none; write another format")

    def _append(self, fill: Any, faces: list[list[int]], near: Array, around: Array) -> None:
        triangles = np.array(_corner_triangles(fill.faces), int).reshape(-1, 3)
        places = np.concatenate([self.vertices, fill.vertices])
        self._add(places[triangles])

    def _add(self, triangles: Array) -> Any:
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        self._new += list(zip(np.divide(normal, length, out=np.zeros_like(normal), where=length > 0), triangles))

    def _bytes(self) -> bytes:
        if self._binary:
            records = np.zeros(len(self._new), _STL_RECORD)
            for record, (normal, corners) in zip(records, self._new):
                record["normal"], record["corners"] = normal, corners
            count = int.from_bytes(self._data[80:84], "little") + len(self._new)
            return self._data[:80] + struct.pack("<I", count) + self._data[84:] + records.tobytes()
        eol = writing.line_end(writing.lines(self._data[:1000]))
        text = []
        for normal, corners in self._new:
            text += [b"  facet normal " + writing.numbers(normal), b"    outer loop"]
            text += [b"      vertex " + writing.numbers(p) for p in corners]
            text += [b"    endloop", b"  endfacet"]
        assert self._end is not None
        at = self._end.start()
        return self._data[:at] + b"".join(line + eol for line in text) + self._data[at:]

    def _save(self, path: Path) -> None:
        path.write_bytes(self._bytes())
