"""Object File Format, binary."""

from __future__ import annotations

import re
import struct
from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np

from .._types import Array
from .continued import Continued
from .mesh_file import MeshFile
from .writing import damaged

#: What programs write, the documented form first: byte order, numbers of vertices, whether a face's colors follow its corners.
#: Geomview: big-endian, floats, colors counted; pmp-library: as its machine has them, no colors.
_FORMS = [(order, real, colors) for colors in (True, False) for order in "><" for real in "fd"]
_FORMS.sort(key=lambda form: form != (">", "f", True) and form[:1] + form[2:] != ("<", False))


class BinaryOffFile(MeshFile):
    """Binary OFF, of either byte order, with floats or doubles: rows stay as they are, new ones follow those of their kind."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._head = data[: data.index(b"\n") + 1] if b"\n" in data else data
        kind = re.match(rb"(?:\xef\xbb\xbf)?(ST)?(C)?(N)?(4)?(n)?OFF\s", self._head)
        if not kind or kind[4] or kind[5]:
            raise damaged("binary OFF")
        self._normals = bool(kind[3])
        width = 3 + 3 * bool(kind[3]) + 4 * bool(kind[2]) + 2 * bool(kind[1])
        body = memoryview(data)[len(self._head) :]
        for order, real, colors in _FORMS:
            self._order, self._real, self._colors = order, order + real.replace("f", "f4").replace("d", "f8"), colors
            rows = self._rows(body, width)
            if rows:
                break
        else:
            raise damaged("binary OFF")
        self._vertex_rows, self._face_rows = rows
        self._row_of = [k for k, (face, _) in enumerate(self._face_rows) if len(face) >= 3]
        self._new_vertices: list[bytes] = []
        self._new_faces: list[bytes] = []
        super().__init__(self._vertex_rows[:, :3].astype(float), [list(self._face_rows[k][0]) for k in self._row_of])

    def _rows(self, body: memoryview, width: int) -> Any:
        """Rows of vertices (n, width), and of faces: corners, and the bytes of their colors. None where this is not the form."""
        if len(body) < 12:
            return None
        n, m, self._edges = struct.unpack_from(self._order + "3i", body)
        size = np.dtype(self._real).itemsize * width
        if n < 0 or m < 0 or 12 + n * size + 4 * m > len(body):
            return None
        vertices = np.frombuffer(body, self._real, n * width, 12).reshape(n, width).copy()
        whole = np.frombuffer(body[: len(body) // 4 * 4], self._order + "i4").tolist() if not n * size % 4 else []
        at, faces = 3 + n * size // 4, []
        for _ in range(m):
            count = whole[at] if at < len(whole) else -1
            end = at + 1 + count
            if count < 0 or end > len(whole):
                return None
            face, at = whole[at + 1 : end], end
            if face and not (min(face) >= 0 and max(face) < n):
                return None
            if self._colors:
                if at >= len(whole) or not 0 <= whole[at] <= 4:
                    return None
                end = at + 1 + whole[at]
            faces.append((face, bytes(body[4 * at : 4 * end])))
            at = end
        return (vertices, faces) if 4 * at == len(body) else None

    def _row(self, face: Sequence[int], colors: bytes) -> bytes:
        return struct.pack(f"{self._order}{1 + len(face)}i", len(face), *face) + colors

    def _move(self, v: int, place: Array) -> None:
        self._vertex_rows[v, :3] = place

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        self._face_rows[self._row_of[f]][0].insert(place + 1, v)

    def _look(self, f: int) -> Hashable:
        colors: bytes = self._face_rows[self._row_of[f]][1]
        return colors

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        rows = continued.at_vertices(lambda rim: self._vertex_rows[rim]).astype(self._vertex_rows.dtype)
        for point, normal, row in zip(fill.vertices, fill.normals, rows):
            row[:3] = point
            if self._normals:
                row[3:6] = normal
            self._new_vertices.append(row.tobytes())
        none = struct.pack(self._order + "i", 0) if self._colors else b""
        colors = [self._face_rows[self._row_of[f]][1] for f in continued.model] or [none] * len(faces)
        self._new_faces += [self._row(*pair) for pair in zip(faces, colors)]

    def _pieces(self) -> list[tuple[bytes, bytes]]:
        counts = (len(self._vertex_rows) + len(self._new_vertices), len(self._face_rows) + len(self._new_faces), self._edges)
        rows = b"".join(self._row(*row) for row in self._face_rows)
        at = len(self._head) + 12
        middle, end = at + self._vertex_rows.nbytes, len(self._data)
        return [
            (self._head, self._head),
            (struct.pack(self._order + "3i", *counts), self._data[at - 12 : at]),
            (self._vertex_rows.tobytes(), self._data[at:middle]),
            (b"".join(self._new_vertices), b""),
            (rows, self._data[middle:end]),
            (b"".join(self._new_faces), b""),
        ]
