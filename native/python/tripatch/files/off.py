"""Object File Format."""

from __future__ import annotations

import re
from collections.abc import Hashable
from typing import Any

import numpy as np

from .._types import Array
from . import writing
from .continued import Continued
from .mesh_file import MeshFile
from .writing import FileError


class OffFile(MeshFile):
    """Object File Format, text: OFF, COFF, NOFF, STOFF and their combinations. All lines stay but for the one with the counts."""

    def __init__(self, data: bytes) -> None:
        self._lines = writing.lines(data)
        self._old_lines = list(self._lines)
        self._eol = writing.line_end(self._lines)
        rows = [(k, words) for k, line in enumerate(self._lines) if (words := line.split(b"#")[0].split())]
        if not rows:
            raise FileError("The file is empty")
        head = re.fullmatch(rb"(ST)?(C)?(N)?(4)?(n)?OFF", rows[0][1][0].removeprefix(writing.BYTE_ORDER_MARK))
        if not head:
            raise FileError("An OFF file must start with OFF")
        if head[4] or head[5]:
            raise FileError("OFF files of other than three dimensions cannot be read")
        self._has_normals = bool(head[3])
        rows[0] = (rows[0][0], rows[0][1][1:])
        if not rows[0][1]:
            rows.pop(0)
        try:
            self._counts_line, counts = rows[0]
            n, m = int(counts[0]), int(counts[1])
            self._edges = int(counts[2]) if len(counts) > 2 else 0  # many writers leave it at 0
            if n < 0 or m < 0 or len(rows) < 1 + n + m:
                raise FileError(f"The file announces {n} vertices and {m} faces, but has {len(rows) - 1} lines of them")
            points, facets = rows[1 : 1 + n], rows[1 + n : 1 + n + m]
            self._vertex_rest = [words[3:] for _, words in points]
            self._vertex_lines = [k for k, _ in points]
            if n and len(points[0][1]) < 3:
                raise ValueError
            vertices = np.array([words[:3] for _, words in points], dtype="S").astype(float).reshape(-1, 3)
            faces, self._face_rest, self._face_lines = [], [], []
            for k, words in facets:
                size = int(words[0])
                if size < 0 or len(words) < 1 + size:
                    raise ValueError
                if size >= 3:
                    faces.append([int(v) for v in words[1 : 1 + size]])
                    self._face_rest.append(tuple(words[1 + size :]))
                    self._face_lines.append(k)
        except FileError:
            raise
        except (ValueError, IndexError):
            raise FileError("The file is no OFF file with a vertex or face on each line") from None
        last = rows[n][0] + 1
        self._cut = last, (rows[n + m][0] + 1 if m else last)
        self._new_vertices: list[bytes] = []
        self._new_faces: list[bytes] = []
        self._new_edges = 0
        super().__init__(vertices, faces)

    @classmethod
    def of_mesh(cls, vertices: Array, faces: list[list[int]]) -> OffFile:
        rows = [b"OFF", b"%d %d 0" % (len(vertices), len(faces))] + [writing.numbers(p) for p in vertices]
        rows += [b"%d " % len(face) + b" ".join(b"%d" % v for v in face) for face in faces]
        return cls(b"\n".join(rows) + b"\n")

    def _move(self, v: int, place: Array) -> None:
        k = self._vertex_lines[v]
        self._lines[k] = writing.with_numbers(self._lines[k], 0, [writing.number(x) for x in place])

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        text = self._lines[self._face_lines[f]]
        words = list(re.finditer(rb"\S+", text))
        size, corner = words[0], words[1 + place]
        text = text[: corner.end()] + b" %d" % v + text[corner.end() :]
        self._lines[self._face_lines[f]] = text[: size.start()] + b"%d" % (int(size[0]) + 1) + text[size.end() :]

    def _look(self, f: int) -> Hashable:
        return self._face_rest[f]

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        for point, normal, rest in zip(fill.vertices, fill.normals, continued.words(self._vertex_rest.__getitem__)):
            if self._has_normals and len(rest) >= 3:
                rest = [writing.numbers(normal), *rest[3:]]
            self._new_vertices.append(b" ".join([writing.numbers(point), *rest]))
        for k, face in enumerate(faces):
            like = self._face_rest[continued.model[k]] if continued.model else ()
            self._new_faces.append(b" ".join([b"%d" % len(face), *(b"%d" % v for v in face), *like]))
        edges = {(min(a, b), max(a, b)) for face in faces for a, b in zip(face, face[1:] + face[:1])}
        self._new_edges += len(edges) - len(fill.rim)

    def _pieces(self) -> list[tuple[bytes, bytes]]:
        lines = list(self._lines)
        counts = lines[self._counts_line]
        text, comment_sign, comment = counts.partition(b"#")
        added = iter((len(self._new_vertices), len(self._new_faces), self._new_edges if self._edges else 0))
        text = re.sub(rb"(?<!\S)[+-]?\d[\d_]*(?!\S)", lambda old: b"%d" % (int(old[0]) + next(added)), text, count=3)
        lines[self._counts_line] = text + comment_sign + comment
        first, second = self._cut
        pieces = [(new, old) for new, old in zip(lines, self._old_lines, strict=True)]
        for k in {first - 1, second - 1}:
            pieces[k] = self._ended(pieces[k][0]), pieces[k][1]
        new_vertices, new_faces = (b"".join(line + self._eol for line in new) for new in (self._new_vertices, self._new_faces))
        return [*pieces[:first], (new_vertices, b""), *pieces[first:second], (new_faces, b""), *pieces[second:]]

    def _ended(self, line: bytes) -> bytes:
        return line if line.endswith((b"\n", b"\r")) or not self._new_faces else line + self._eol
