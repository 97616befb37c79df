"""STL, text and binary."""

from __future__ import annotations

import re
import struct
from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np

from .. import _arrays
from .._types import Array
from ..borders import Joined
from ..messages import Message
from . import writing
from .continued import Continued
from .lines import Lines
from .mesh_file import MeshFile
from .writing import FileError, damaged


def _corner_triangles(faces: list[list[int]]) -> Any:
    return [(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)]


def _outline(triangles: list[list[int]]) -> list[int]:
    """The corners around triangles that were one."""
    edges = {(a, b) for t in triangles for a, b in zip(t, t[1:] + t[:1])}
    after = {a: b for a, b in edges if (b, a) not in edges}
    found = [triangles[0][0]]
    while after[found[-1]] != found[0]:
        found.append(after[found[-1]])
    return found


def _normals(triangles: Array) -> Array:
    """(k, 3) of triangles (k, 3, 3); zero where there is no area."""
    normal: Array = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)


def _facet(normal: Array, corners: Array) -> list[bytes]:
    vertices = [b"      vertex " + writing.numbers(p) for p in corners]
    return [b"  facet normal " + writing.numbers(normal), b"    outer loop", *vertices, b"    endloop", b"  endfacet"]


def _records(triangles: Sequence[tuple[Array, Array, int]]) -> bytes:
    made = np.zeros(len(triangles), _STL_RECORD)
    for record, (normal, corners, attribute) in zip(made, triangles):
        record["normal"], record["corners"], record["attribute"] = normal, corners, attribute
    return made.tobytes()


_VERTEX = rb"(?im)^[ \t]*vertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)"
_STL_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


class StlFile(MeshFile):
    """STL, binary and text: triangles are added after the last one. Corners at the same place, to the bit, are one vertex."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._new: list[tuple[Array, Array, int]] = []  # normal, corners, attribute or solid
        self._instead: dict[int, Array] = {}  # triangles (k, 3, 3) in place of one
        self._ends: list[int] = []  # of a text: where its solids end
        self._spans = np.zeros((0, 2), np.int64)  # of a text: where the corners of each triangle are
        count = int.from_bytes(data[80:84], "little")
        # many binary files start with "solid", too; some writers leave bytes behind the last triangle
        exact = len(data) >= 84 and len(data) == 84 + 50 * count
        self._binary = exact or (len(data) >= 84 and count > 0 and not re.search(_VERTEX, data))
        if self._binary:
            if len(data) < 84 + 50 * count:
                held = (len(data) - 84) // 50
                raise FileError(Message("file_ends_early", {"format": "STL", "announced": count, "held": held}))
            if len(data) - (84 + 50 * count) > 50 * count:  # some writers leave bytes at the end, but not most of the file
                raise damaged("STL")
            records = np.frombuffer(data, _STL_RECORD, count, 84)
            corners = records["corners"]
            self._part_of = records["attribute"]
        else:
            corners = self._read_text().reshape(-1, 3, 3)
        first, place = _arrays.same_places(corners)  # in the order of their first use
        super().__init__(corners[first // 3, first % 3].astype(float), place.reshape(-1, 3))

    def _read_text(self) -> Array:
        data = self._data
        if not re.match(rb"(?i)\s*solid", data):
            raise damaged("STL")
        lines = Lines(data)
        self._ends = lines.starts[lines.beginning_with(b"endsolid")].tolist()
        chosen = lines.beginning_with(b"vertex")
        if not self._ends:
            raise FileError(Message("file_ends_early", {"format": "STL"}))
        if len(chosen) % 3:
            raise damaged("STL")
        self._part_of = np.searchsorted(self._ends[:-1], lines.starts[chosen[::3]])
        self._spans = np.column_stack([lines.starts[chosen[::3]], lines.starts[chosen[2::3] + 1]])
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
            raise damaged("STL") from None
        return corners

    @classmethod
    def of_mesh(cls, vertices: Array, faces: list[list[int]]) -> StlFile:
        stl = cls(b"STL".ljust(80) + struct.pack("<I", 0))
        triangles = np.array(_corner_triangles(faces), int).reshape(-1, 3)
        stl._add(np.asarray(vertices, float)[triangles], [0] * len(triangles))
        stl._part_of = np.zeros(len(faces), int)
        MeshFile.__init__(stl, vertices, faces)  # numbered as given, not by first use
        return stl

    def _join(self, joined: Joined) -> None:
        points, offsets, corners = self.vertices, self.faces.offsets, self.faces.corners
        _, made, of_face = joined.triangles(points, offsets, corners)
        gone = np.isin(corners.reshape(-1, 3), joined.moved[0]).any(axis=1)
        gone[[f for f, *_ in joined.splits]] = True
        triangles = points[made.reshape(-1, 3)]
        for f in np.flatnonzero(gone).tolist():
            first, end = np.searchsorted(of_face, [f, f + 1])
            self._instead[f] = triangles[first:end]
            self._split_faces[f] = _outline(made.reshape(-1, 3)[first:end].tolist())
        for f, _, v, _ in joined.splits:
            self._also_at.setdefault(v, []).append(f)

    def _move(self, v: int, place: Array) -> None:
        raise FileError(Message("stl_moves_nothing"))

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        raise FileError(Message("stl_moves_nothing"))

    def _look(self, f: int) -> Hashable:
        return int(self._part_of[f])

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        used, places = np.unique(np.concatenate([np.zeros(0, np.int64), *fill.faces]), return_inverse=True)
        old = used[used < len(self.vertices)]
        points = np.concatenate([self.vertices[old], fill.vertices[used[len(old) :] - len(self.vertices)]])
        own = iter(places.reshape(-1).tolist())
        for k, face in enumerate(fill.faces):
            part = int(self._part_of[continued.model[k]]) if continued.model else 0
            triangles = _corner_triangles([[next(own) for _ in face]])
            self._add(points[np.array(triangles, int)], [part] * len(triangles))

    def _add(self, triangles: Array, parts: Sequence[int]) -> None:
        self._new += list(zip(_normals(triangles), triangles, parts))

    def _pieces(self) -> list[tuple[bytes, bytes]]:
        return self._binary_pieces() if self._binary else self._text_pieces()

    def _binary_pieces(self) -> list[tuple[bytes, bytes]]:
        data = self._data
        old = int.from_bytes(data[80:84], "little")
        more = sum(len(triangles) - 1 for triangles in self._instead.values())
        pieces, last = [(data[:80], data[:80]), (struct.pack("<I", old + len(self._new) + more), data[80:84])], 84
        for f, triangles in sorted(self._instead.items()):
            start = 84 + 50 * f
            made = _records([(*each, int(self._part_of[f])) for each in zip(_normals(triangles), triangles)])
            pieces += [(data[last:start], data[last:start]), (made, data[start : start + 50])]
            last = start + 50
        end = 84 + 50 * old
        return [*pieces, (data[last:end], data[last:end]), (_records(self._new), b""), (data[end:], data[end:])]

    def _text_pieces(self) -> list[tuple[bytes, bytes]]:
        data = self._data
        eol = writing.line_end(writing.lines(data[:1000]))
        upper = data.lstrip()[:5].isupper()

        def text(lines: list[bytes]) -> bytes:
            return b"".join((line.upper() if upper else line) + eol for line in lines)

        changes: list[tuple[int, int, bytes]] = []  # from, to, what is there instead
        for f, triangles in self._instead.items():
            lines = [line for each in zip(_normals(triangles), triangles) for line in _facet(*each)]
            changes.append((*self._spans[f].tolist(), text(lines[2:-2])))  # what begins the first and ends the last is there
        for solid, end in enumerate(self._ends):
            added = [_facet(normal, corners) for normal, corners, part in self._new if part == solid]
            changes.append((end, end, text([line for lines in added for line in lines])))
        pieces, last = [], 0
        for start, end, new in sorted(changes):
            pieces += [(data[last:start], data[last:start]), (new, data[start:end])]
            last = end
        return [*pieces, (data[last:], data[last:])]
