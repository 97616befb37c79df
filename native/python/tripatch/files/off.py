"""Object File Format."""

from __future__ import annotations

import re
from collections.abc import Hashable
from typing import Any

import numpy as np

from .._types import Array
from ..messages import Message
from . import writing
from .continued import Continued
from .lines import SPACE, Lines, rows_of
from .mesh_file import MeshFile
from .writing import FileError, damaged


class OffFile(MeshFile):
    """Object File Format, text: OFF, COFF, NOFF, STOFF and their combinations. All lines stay but for the one with the counts."""

    def __init__(self, data: bytes) -> None:
        self._lines = Lines(data)
        self._replaced: dict[int, bytes] = {}  # what stands instead of a line
        end = re.search(rb"\r\n?|\n", data)
        self._eol = end[0] if end else b"\n"
        rows = self._rows()
        if not len(rows):
            raise damaged("OFF")
        words = self._words(int(rows[0]))
        head = re.fullmatch(rb"(ST)?(C)?(N)?(4)?(n)?OFF", words[0].removeprefix(writing.BYTE_ORDER_MARK))
        if not head:
            raise damaged("OFF")
        if head[4] or head[5]:
            raise FileError(Message("version_unreadable", {"format": "OFF", "version": head[0].decode()}))
        self._has_normals = bool(head[3])
        counts = words[1:]
        if not counts:
            rows = rows[1:]
        try:
            self._counts_line = int(rows[0])
            counts = counts or self._words(self._counts_line)
            n, m = int(counts[0]), int(counts[1])
            self._edges = int(counts[2]) if len(counts) > 2 else 0  # many writers leave it at 0
            if n < 0 or m < 0 or len(rows) < 1 + n + m:
                raise FileError(Message("file_ends_early", {"format": "OFF", "announced": n + m, "held": len(rows) - 1}))
            self._vertex_lines = rows[1 : 1 + n]
            vertices = self._read_vertices()
            faces = self._read_faces(rows[1 + n : 1 + n + m])
        except FileError:
            raise
        except (ValueError, IndexError, OverflowError):
            raise damaged("OFF") from None
        last = int(rows[n]) + 1
        self._cut = last, (int(rows[n + m]) + 1 if m else last)
        self._new_vertices: list[bytes] = []
        self._new_faces: list[bytes] = []
        self._new_edges = 0
        super().__init__(vertices, faces)

    def _rows(self) -> Array:
        """The lines that hold more than a comment."""
        first, _, _ = self._lines.heads()
        held = ~SPACE[first] & (first != ord("#"))
        for k in np.flatnonzero(SPACE[first]).tolist():
            held[k] = bool(self._words(k))
        return np.flatnonzero(held).astype(np.int32)

    def _words(self, k: int) -> list[bytes]:
        return self._text(k).split(b"#")[0].split()

    def _text(self, k: int) -> bytes:
        """A line as it is by now."""
        return self._replaced[k] if k in self._replaced else self._lines.text(k)

    def _read_vertices(self) -> Array:
        lines = self._vertex_lines
        made, left = np.empty((len(lines), 3)), np.ones(len(lines), bool)
        for chosen, numbers, _ in self._lines.table(lines, b""):
            if numbers.shape[1] >= 3:
                at = np.searchsorted(lines, chosen)
                made[at], left[at] = numbers[:, :3, 0], False
        for v in np.flatnonzero(left).tolist():
            x, y, z = self._words(int(lines[v]))[:3]
            made[v] = float(x), float(y), float(z)
        return made

    def _read_faces(self, lines: Array) -> tuple[Any, Array]:
        """Offsets, or the size of all, and corners. Sets the line of each face."""
        sizes, left = np.zeros(len(lines), np.int64), np.ones(len(lines), bool)
        found = []
        for chosen, table, _ in self._lines.table(lines, b""):
            numbers = table[:, :, 0]
            at = np.searchsorted(lines, chosen)
            for size in np.unique(numbers[:, 0]).tolist():
                mine = numbers[:, 0] == size
                corners = numbers[mine, 1 : 1 + int(max(size, 0))]
                if size == corners.shape[1] and ((corners == np.floor(corners)) & (np.abs(corners) < 2**53)).all():
                    found.append((at[mine], corners.astype(np.int64)))
                    sizes[at[mine]], left[at[mine]] = size, False
        for f in np.flatnonzero(left).tolist():
            words = self._words(int(lines[f]))
            size = int(words[0])
            if size < 0 or len(words) < 1 + size:
                raise ValueError
            found.append((np.array([f]), np.array([[int(v) for v in words[1 : 1 + size]]], np.int64)))
            sizes[f] = size
        kept = sizes >= 3
        number = np.cumsum(kept) - 1
        self._face_lines = lines[kept]
        return rows_of(sizes[kept], [(number[at], rows) for at, rows in found if rows.shape[1] >= 3])

    @classmethod
    def of_mesh(cls, vertices: Array, faces: list[list[int]]) -> OffFile:
        rows = [b"OFF", b"%d %d 0" % (len(vertices), len(faces))] + [writing.numbers(p) for p in vertices]
        rows += [b"%d " % len(face) + b" ".join(b"%d" % v for v in face) for face in faces]
        return cls(b"\n".join(rows) + b"\n")

    def _move(self, v: int, place: Array) -> None:
        k = int(self._vertex_lines[v])
        self._replaced[k] = writing.with_numbers(self._text(k), 0, [writing.number(x) for x in place])

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        k = int(self._face_lines[f])
        text = self._text(k)
        words = list(re.finditer(rb"\S+", text))
        size, corner = words[0], words[1 + place]
        text = text[: corner.end()] + b" %d" % v + text[corner.end() :]
        self._replaced[k] = text[: size.start()] + b"%d" % (int(size[0]) + 1) + text[size.end() :]

    def _look(self, f: int) -> Hashable:
        return self._face_rest(f)

    def _vertex_rest(self, v: int) -> list[bytes]:
        return self._words(int(self._vertex_lines[v]))[3:]

    def _face_rest(self, f: int) -> tuple[bytes, ...]:
        words = self._words(int(self._face_lines[f]))
        return tuple(words[1 + int(words[0]) :])

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        for point, normal, rest in zip(fill.vertices, fill.normals, continued.words(self._vertex_rest)):
            if self._has_normals and len(rest) >= 3:
                rest = [writing.numbers(normal), *rest[3:]]
            self._new_vertices.append(b" ".join([writing.numbers(point), *rest]))
        for k, face in enumerate(faces):
            like = self._face_rest(continued.model[k]) if continued.model else ()
            self._new_faces.append(b" ".join([b"%d" % len(face), *(b"%d" % v for v in face), *like]))
        edges = {(min(a, b), max(a, b)) for face in faces for a, b in zip(face, face[1:] + face[:1])}
        self._new_edges += len(edges) - len(fill.rim)

    def _pieces(self) -> list[tuple[bytes, bytes]]:
        counts = self._text(self._counts_line)
        text, comment_sign, comment = counts.partition(b"#")
        added = iter((len(self._new_vertices), len(self._new_faces), self._new_edges if self._edges else 0))
        text = re.sub(rb"(?<!\S)[+-]?\d[\d_]*(?!\S)", lambda old: b"%d" % (int(old[0]) + next(added)), text, count=3)
        changed = {**self._replaced, self._counts_line: text + comment_sign + comment}
        first, second = self._cut
        for k in {first - 1, second - 1}:
            line = changed.get(k) or self._lines.text(k)
            changed[k] = line if line.endswith((b"\n", b"\r")) or not self._new_faces else line + self._eol

        def part(begin: int, end: int) -> list[tuple[bytes, bytes]]:
            pieces, starts = [], self._lines.starts
            for k in [*sorted(k for k in changed if begin <= k < end), end]:
                same = self._lines.data[starts[begin] : starts[k]]
                pieces += [(same, same), (changed[k], self._lines.text(k))] if k < end else [(same, same)]
                begin = k + 1
            return pieces

        new_vertices, new_faces = (b"".join(line + self._eol for line in new) for new in (self._new_vertices, self._new_faces))
        return [
            *part(0, first),
            (new_vertices, b""),
            *part(first, second),
            (new_faces, b""),
            *part(second, len(self._lines)),
        ]
