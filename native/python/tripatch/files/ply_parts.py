"""Binary PLY files that may be larger than the memory: passed over where they lie, and cut into parts that are files."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from .. import _native
from .._types import Array
from ..messages import Message
from . import evidence
from .ply import _FILL, _ORIGINAL, PlyFile
from .ply_rows import PlyElement
from .writing import FileError, damaged

_END = re.compile(rb"(?:^|[\r\n])end_header[ \t]*(?:\r\n|\n|\r)")
_WHOLE = "bBhHiI"
#: Vertices that a pass over the faces distinguishes.
_MOST = 2**32 - 2
#: Rings of faces that one pass distinguishes.
_MAX_RINGS = 240
#: Bytes that are copied at once.
_BLOCK = 1 << 24


def _size(kind: str) -> int:
    return struct.calcsize(f"<{kind}")


def _row_size(element: PlyElement) -> int | None:
    """Bytes of a row; None where it has lists."""
    return None if element.lists() else sum(_size(kind) for _, kind, _ in element.properties)


def _dtype(element: PlyElement, order: str) -> np.dtype[Any]:
    """Of rows without lists, by the places of their properties."""
    return np.dtype([(f"p{k}", order + kind) for k, (_, kind, _) in enumerate(element.properties)])


class PlyParts(PlyFile):
    """A binary PLY file of which only the header is read, and what its faces tell by a pass over them.

    Attributes:
        rows: the faces; count: of vertices; table: their rows.
    """

    def __init__(self, data: Any) -> None:
        """data: a buffer that outlives this.

        Raises:
            FileError: no PLY file, or a damaged one.
            NotImplementedError: one that cannot be read in parts.
        """
        found = _END.search(data)
        if not found:
            raise damaged("PLY")
        self._read_head(bytes(data[: found.end()]))
        self._file = memoryview(data)
        _, kind, of_count = self._face.properties[self._index]
        is_whole = kind in _WHOLE and of_count is not None and of_count in _WHOLE
        if not self._order or _row_size(self._vertex) is None or not is_whole or self._vertex.count > _MOST:
            raise NotImplementedError
        at, self._first = self._body, {}
        for element in self._elements:
            self._first[element.name] = at
            if element is self._face:
                at = self._read_faces(at)
            elif (size := _row_size(element)) is not None:
                at += size * element.count
            elif len({"vertex", "face"} & self._first.keys()) < 2:
                raise NotImplementedError
            if at > len(self._file):
                raise damaged("PLY")
        self.count = self._vertex.count
        kinds = _dtype(self._vertex, self._order)
        self.table = np.frombuffer(self._file, kinds, self.count, self._first["vertex"])

    def _read_faces(self, at: int) -> int:
        lists: list[tuple[int, str, int]] = []
        before = 0
        for _, kind, of_count in self._face.properties:
            if of_count:
                lists.append((before, of_count, _size(kind)))
                before = 0
            else:
                before += _size(kind)
        corners = self._face.lists().index(self._index)
        kind = self._face.properties[self._index][1]
        given = (self._file, at, self._face.count, lists, before, corners, kind, self._order == ">", self._vertex.count)
        try:
            self.rows = _native.FaceRows(*given)
        except IndexError as error:
            raise FileError(Message("face_without_vertex", {"face": int(str(error))})) from None
        except ValueError:
            raise damaged("PLY") from None
        return self.rows.end

    def points(self, vertices: Array | slice) -> Array:
        """(k, 3) positions of some vertices."""
        rows = self.table[vertices]
        return np.column_stack([rows[f"p{k}"] for k in self._xyz]).astype(np.float64, copy=False)

    def box(self) -> tuple[Array, Array]:
        """The lowest and the highest coordinates of vertices whose positions are finite."""
        low, high = _native._box_of_rows(self._places(), self.count)
        return np.array(low), np.array(high)

    def _places(self) -> Any:
        """What the faces' boxes are made of."""
        kinds = self.table.dtype
        at = tuple(int(kinds.fields[f"p{k}"][1]) for k in self._xyz)  # type: ignore[index]
        letters = "".join(self._vertex.properties[k][1] for k in self._xyz)
        return self._file, self._first["vertex"], kinds.itemsize, at, letters, self._order == ">"

    def count_meeting(self, boxes: Array) -> Array:
        """How many faces meet each of some boxes (k, 6), lowest coordinates first."""
        return np.array(self.rows.count_meeting(self._places(), boxes), np.int64)

    def meeting(self, boxes: Array) -> list[Array]:
        """For each box where in the file the faces begin that meet it."""
        found = np.array(self.rows.meeting(self._places(), boxes), np.int64).reshape(-1, 2)
        return [found[found[:, 1] == k, 0] for k in range(len(boxes))]

    def part(
        self, vertices: Array, rings: int, more: Sequence[int] = (), frame: Array | None = None
    ) -> tuple[bytes, Array, Array]:
        """A file of the faces within so many rings around vertices.

        Args:
            more: where other faces begin that it shall have.
            frame: (k, 3) places of vertices without faces that it gets.

        Returns:
            The file; the numbers that its vertices have in this one, -1 of the frame; and whether all faces at each are in it.
        """
        others = np.asarray(more, np.int64)
        while rings > _MAX_RINGS:
            vertices, rings = self.rows.around(vertices, _MAX_RINGS, others[:0])[0], rings - _MAX_RINGS
        numbers, known, faces, starts = self.rows.around(np.asarray(vertices, np.int64), rings, others)
        rows = self.table[numbers].tobytes()
        if frame is not None and len(frame):
            added = np.zeros(len(frame), self.table.dtype)
            for k, column in zip(self._xyz, np.asarray(frame).T, strict=True):
                added[f"p{k}"] = column
            rows += added.tobytes()
            numbers = np.concatenate([numbers, np.full(len(frame), -1)])
            known = np.concatenate([known, np.ones(len(frame), bool)])
        pieces = {self._vertex.name: (len(numbers), rows), self._face.name: (len(starts), faces)}
        head = self._data
        for element in reversed(self._elements):
            first, end = element.count_at
            head = head[:first] + b"%d" % pieces.get(element.name, (0,))[0] + head[end:]
        head = re.sub(rb"(?<=[\r\n])(?:" + _ORIGINAL + rb"|" + _FILL + rb")[^\r\n]*" + re.escape(self._eol), b"", bytes(head))
        body = [pieces[element.name][1] for element in self._elements if element.name in pieces]
        return b"".join([head, *body]), numbers, known

    def marked(self) -> PlyParts:
        raise NotImplementedError

    def with_fills(
        self, sha256: str, about: Sequence[dict[str, Any]], added: Mapping[str, tuple[int, Iterable[bytes]]]
    ) -> Iterator[Any]:
        """The file with fills, piece by piece, as `marked`, `append_all` and `write` make it of a file in memory.

        Args:
            sha256: of the file as it is.
            about: what is to be said of each fill.
            added: for "vertex" and "face" how many new rows there are, and these.
        """
        face, head = self._face, bytes(self._data)
        is_new = face.index(evidence.FILL) < 0
        if is_new:
            named = self._eol + b"property int " + evidence.FILL.encode()
            head = self._with_comment(head[: face.head_end] + named + head[face.head_end :], self._about_original(sha256))
        made = object.__new__(PlyFile)
        made._read_head(head)
        made._about = list(about)
        for element in made._both():
            element.added = added[element.name][0]
        yield made._with_fills(head)
        at = self._body
        for element in self._elements:
            if element not in self._both():
                continue
            first = self._first[element.name]
            if element is self._vertex:
                end = first + self.table.nbytes
                yield from self._copied(at, end)
            else:
                end = self.rows.end
                yield from self._copied(at, first)
                yield from self._widened() if is_new else self._copied(first, end)
            yield from added[element.name][1]
            at = end
        yield from self._copied(at, len(self._file))

    def fills_before(self) -> int:
        """How many fills the header tells of."""
        return len(re.findall(rb"[\r\n]" + _FILL, self._data))

    def kinds_in_faces(self, name: str) -> tuple[Any, Any]:
        """The types of corners, and of another number of the face, as that has it with fills."""
        properties, k = self._face.properties, self._face.index(name)
        kinds = properties[self._index][1], properties[k][1] if k >= 0 else "i"
        return np.dtype(self._order + kinds[0]), np.dtype(self._order + kinds[1])

    def is_too_many(self, vertices: int, fills: int) -> str:
        """The element whose rows cannot hold so many vertices, or fills; none: ''."""
        face = self._face
        last = {self._index: vertices - 1, face.index(evidence.FILL): fills}
        full = any(k >= 0 and most > np.iinfo(face.properties[k][1]).max for k, most in last.items())
        return face.name if full else ""

    def _copied(self, first: int, end: int) -> Iterator[memoryview]:
        for at in range(first, end, _BLOCK):
            yield self._file[at : min(at + _BLOCK, end)]

    def _widened(self) -> Iterator[bytes]:
        for portion in range(self.rows.portions):
            yield self.rows.widened(portion, 4)
