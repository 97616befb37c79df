"""The rows of PLY files, text and binary."""

from __future__ import annotations

import re
import struct
from array import array
from collections.abc import Sequence
from typing import Any

import numpy as np

from .._types import Array
from ..messages import Message
from .lines import EditedLines, rows_of
from .mesh_file import MeshFile
from .writing import FileError, damaged, without_faces

TYPES = {
    name: code
    for names, code in (
        ("char int8", "b"),
        ("uchar uint8", "B"),
        ("short int16", "h"),
        ("ushort uint16", "H"),
        ("int int32", "i"),
        ("uint uint32", "I"),
        ("int64", "q"),
        ("uint64", "Q"),
        ("float float32", "f"),
        ("double float64", "d"),
    )
    for name in names.split()
}


class PlyElement:
    def __init__(self, name: str, count: int) -> None:
        self.name, self.count = name, count
        self.count_at = (0, 0)  # bytes of the header that say it
        self.head_end = 0  # byte of the header where its last line ends
        self.properties: list[tuple[str, str, str | None]] = []  # name, type, type of the count of a list
        self.starts: Any = ()  # of every row and of the end: bytes, or lines of a text
        self.block: Array | None = None  # all rows, where they are alike
        self.list_sizes = np.zeros((0, 0), np.int64)  # else of each row how long its lists are
        self.new: list[bytes] = []
        self.added = 0  # rows in `new`
        self.plain = False  # whether every line of a text holds its row and nothing else
        self.gaps: list[str] = []  # of a text whose rows are no lines: what is between rows, and behind the last

    def lists(self) -> list[int]:
        """The properties that are lists."""
        return [k for k, p in enumerate(self.properties) if p[2]]

    def index(self, name: str) -> int:
        return next((k for k, p in enumerate(self.properties) if p[0] == name), -1)


class PlyRows(MeshFile):
    """What a file has: elements with rows, of which two are the mesh."""

    def __init__(self, data: bytes) -> None:
        self._read_head(data)
        try:
            vertices, sizes, corners = self._read_binary() if self._order else self._read_text()
        except (ValueError, IndexError, OverflowError, MemoryError, struct.error):
            raise damaged("PLY") from None
        self._row_of: Sequence[int] = range(self._face.count)
        if isinstance(sizes, int) and sizes >= 3:
            super().__init__(vertices, (sizes, corners))
            return
        sizes = np.full(self._face.count, sizes) if isinstance(sizes, int) else sizes
        kept = sizes >= 3
        if not kept.all():
            self._row_of = np.flatnonzero(kept).tolist()
            corners, sizes = corners[np.repeat(kept, sizes)], sizes[kept]
        super().__init__(vertices, (np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64), corners))

    def _read_head(self, data: bytes) -> None:
        """Sets what the header says of the rows behind it."""
        end = re.search(rb"(?:^|[\r\n])end_header[ \t]*(\r\n|\n|\r)", data)
        if not data.startswith(b"ply") or not end:
            raise damaged("PLY")
        self._data: bytes | bytearray = data
        self._eol = end[1]
        self._elements: list[PlyElement] = []
        form = ""
        for line in re.finditer(rb"[^\r\n]+", data[: end.start()]):
            places = [*re.finditer(rb"\S+", line[0])]  # what bytes call white, as the rows below
            words = [place[0].decode("latin-1") for place in places]
            try:
                if words[:1] == ["format"]:
                    form = words[1]
                elif words[:1] == ["element"]:
                    self._elements.append(PlyElement(words[1], int(words[2])))
                    self._elements[-1].count_at = (line.start() + places[2].start(), line.start() + places[2].end())
                    if self._elements[-1].count < 0:
                        raise ValueError
                elif words[:2] == ["property", "list"]:
                    self._elements[-1].properties.append((words[4], TYPES[words[3]], TYPES[words[2]]))
                elif words[:1] == ["property"]:
                    self._elements[-1].properties.append((words[2], TYPES[words[1]], None))
                if words[:1] in (["element"], ["property"]):
                    self._elements[-1].head_end = line.end()
            except (LookupError, ValueError):
                said = line[0].decode("latin-1").strip()[:60]
                raise FileError(Message("line_unreadable", {"header": 1, "text": said})) from None
        if form not in ("ascii", "binary_little_endian", "binary_big_endian"):
            raise FileError(Message("version_unreadable", {"format": "PLY", "version": form or "?"}))
        self._order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[form]
        self._body = end.end()

        found = {e.name: e for e in self._elements}
        if "vertex" not in found or "face" not in found:
            raise without_faces(found["vertex"].count if "vertex" in found else 0)
        self._vertex, self._face = found["vertex"], found["face"]
        self._xyz = [self._vertex.index(c) for c in "xyz"]
        self._index = max(self._face.index("vertex_indices"), self._face.index("vertex_index"))
        if min(self._xyz) < 0 or self._index < 0 or self._face.properties[self._index][2] is None:
            raise FileError(Message("file_lacks_mesh", {"format": "PLY"}))

    # Both readers set where the rows of all elements start, and return vertices (n, 3), the number of corners of each face, or
    # one for all, and the corners.

    def _read_text(self) -> Any:
        self._lines = EditedLines(bytes(self._data[self._body :]))
        try:
            return self._text_columns()
        except (FileError, ValueError, IndexError) as error:
            try:
                self._lines = EditedLines(b"".join(self._a_line_for_each_row()))
            except (ValueError, IndexError):
                raise error from None
            return self._text_columns()

    def _a_line_for_each_row(self) -> list[bytes]:
        """The lines of a file that has several rows on one line, or one row on several."""
        text, at, lines = bytes(self._data[self._body :]), 0, []
        words, gaps = text.split(), [*re.findall(rb"\s+", text), b"", b""]
        for element in self._elements:
            ends = []
            for _ in range(element.count):
                start = at
                for _, _, list_kind in element.properties:
                    at += 1 + int(words[at]) if list_kind else 1
                if not start <= at <= len(words):
                    raise ValueError
                lines.append(b" ".join(words[start:at]) + self._eol)
                ends.append(gaps[at - 1])
            element.gaps = [gap.decode("latin-1") for gap in (ends[0], ends[-1])] if ends else []
        return lines

    def _text_columns(self) -> Any:
        filled = self._lines.filled()
        vertices, faces, first = np.zeros((0, 3)), (np.zeros(0, np.int64), np.zeros(0, np.int64)), 0
        for element in self._elements:
            places = filled[first : first + element.count]
            if len(places) < element.count:
                raise ValueError
            element.starts = np.append(places, places[-1] + 1 if len(places) else 0)
            first += element.count
            if element is self._vertex:
                vertices = self._text_vertices(places)
            elif element is self._face:
                faces = self._text_faces(places)
        return vertices, *faces

    def _text_vertices(self, places: Array) -> Array:
        vertex = self._vertex
        made, left, widths = np.empty((len(places), 3)), np.ones(len(places), bool), set[int]()
        for chosen, numbers, _ in [] if vertex.lists() else self._lines.table(places, b""):
            if numbers.shape[1] > max(self._xyz):
                at = np.searchsorted(places, chosen)
                made[at], left[at] = numbers[:, self._xyz, 0], False
                widths.add(numbers.shape[1])
        for k in np.flatnonzero(left).tolist():
            if vertex.lists():
                row = self._text_row(vertex, k)
                made[k] = [row[c] for c in self._xyz]
            else:
                words = self._lines[places[k]].split()
                made[k] = [float(words[c]) for c in self._xyz]
        vertex.plain = not left.any() and widths == {len(vertex.properties)}
        return made

    def _text_faces(self, places: Array) -> Any:
        """The number of corners of each, or of all, and the corners."""
        face, k, count = self._face, self._index, len(self._face.properties)
        sizes, left, found = np.zeros(len(places), np.int64), np.ones(len(places), bool), []
        face.plain = True
        for chosen, table, _ in self._lines.table(places, b"") if len(face.lists()) == 1 else []:
            numbers = table[:, :, 0]
            at = np.searchsorted(places, chosen)
            for size in np.unique(numbers[:, k]).tolist() if numbers.shape[1] > k else []:
                mine = numbers[:, k] == size
                corners = numbers[mine, k + 1 : k + 1 + int(max(size, 0))]
                whole = (corners == np.floor(corners)) & (np.abs(corners) < 2**53)
                if size == corners.shape[1] and numbers.shape[1] >= count + size and whole.all():
                    found.append((at[mine], corners.astype(np.int64)))
                    sizes[at[mine]], left[at[mine]] = size, False
                    face.plain &= numbers.shape[1] == count + size
        for f in np.flatnonzero(left).tolist():
            own = self._text_row(face, f)[k]
            found.append((np.array([f]), np.array([own], np.int64).reshape(1, -1)))
            sizes[f] = len(own)
            face.plain = False
        size, corners = rows_of(sizes, found)
        return (size if isinstance(size, int) else sizes), corners

    def _text_row(self, element: PlyElement, k: int) -> list[Any]:
        line = self._lines[element.starts[k]]
        words, at, row = line.split(), 0, []
        try:
            for _, kind, list_kind in element.properties:
                count = 1
                if list_kind:
                    count = int(words[at])
                    if count < 0:
                        raise ValueError
                    at += 1
                if len(words) < at + count:
                    raise ValueError
                values = [float(w) if kind in "fd" else int(w) for w in words[at : at + count]]
                row.append(values if list_kind else values[0])
                at += count
        except (ValueError, IndexError):  # of a vertex only the position was read before
            said = line.strip().decode(errors="replace")[:60]
            raise FileError(Message("line_unreadable", {"row": k, "element": element.name, "text": said})) from None
        return row

    def _read_binary(self) -> Any:
        at = self._body
        for element in self._elements:
            at = self._find_rows(element, at)
        vertices = np.column_stack([self._column(self._vertex, k) for k in self._xyz]).astype(float, copy=False).reshape(-1, 3)
        face, k = self._face, self._index
        if face.block is not None or not face.count:
            rows = face.block[f"p{k}"] if face.block is not None else np.zeros((0, 3))
            return vertices, rows.shape[1], rows.astype(np.int64).reshape(-1)
        return vertices, face.list_sizes[:, face.lists().index(k)], self._corners_of_rows()

    def _find_rows(self, element: PlyElement, at: int) -> int:
        """Sets where the rows of an element start, which begins at a byte; returns where it ends."""
        data, order = self._data, self._order
        element.starts, element.block = [at], None
        if element.count == 0:
            return at
        # all rows as long as the first, as where all faces are triangles: one block
        first, _ = self._binary_row(element, at)
        fields: list[Any] = []
        for k, ((_, kind, list_kind), value) in enumerate(zip(element.properties, first)):
            if list_kind:
                fields.append((f"n{k}", order + list_kind))
            fields.append((f"p{k}", order + kind, (len(value),) if list_kind else ()))
        block = np.dtype(fields)
        end = at + block.itemsize * element.count
        if end <= len(data):
            table = np.frombuffer(data, block, element.count, at)
            if all((table[f"n{k}"] == len(first[k])).all() for k in element.lists()):
                element.starts, element.block = range(at, end + 1, block.itemsize), table
                return end
        return self._follow_rows(element, at)

    def _follow_rows(self, element: PlyElement, at: int) -> int:
        """As `_find_rows`, of rows that differ in length."""
        data, between, sizes = self._data, 0, []
        steps: list[tuple[int, struct.Struct, int]] = []  # for each list: bytes before its count, that, and bytes of an entry
        for _, kind, list_kind in element.properties:
            if list_kind:
                steps.append((between, struct.Struct(self._order + list_kind), struct.calcsize(f"<{kind}")))
                between = 0
            else:
                between += struct.calcsize(f"<{kind}")
        starts = array("q", [at])
        for _ in range(element.count):
            for before, count, each in steps:
                at += before
                (size,) = count.unpack_from(data, at)
                if size < 0:
                    raise ValueError
                sizes.append(size)
                at += count.size + size * each
            at += between
            if at > len(data):
                raise ValueError
            starts.append(at)
        element.starts, element.list_sizes = starts, np.array(sizes, np.int64).reshape(element.count, -1)
        return at

    def _corners_of_rows(self) -> Array:
        """Of faces whose rows differ in length."""
        face, k = self._face, self._index
        before = np.array(face.starts[:-1])
        for p, (_, kind, list_kind) in enumerate(face.properties[: k + 1]):
            if list_kind:
                before += struct.calcsize(f"<{list_kind}")
            if p < k:
                sizes = face.list_sizes[:, face.lists().index(p)] if list_kind else 1
                before += sizes * struct.calcsize(f"<{kind}")
        number = np.dtype(self._order + face.properties[k][1])
        sizes = face.list_sizes[:, face.lists().index(k)]
        offsets = np.cumsum(sizes) - sizes
        corners = np.empty(int(sizes.sum()), np.int64)
        raw = np.frombuffer(self._data, np.uint8)
        for size in np.unique(sizes[sizes > 0]).tolist():
            mine = np.flatnonzero(sizes == size)
            bytes_ = raw[before[mine][:, None] + np.arange(size * number.itemsize)]
            corners[offsets[mine][:, None] + np.arange(size)] = bytes_.view(number)
        return corners

    def _column(self, element: PlyElement, k: int) -> Array:
        """A number of every row."""
        if element.block is not None:
            return np.asarray(element.block[f"p{k}"])
        return np.array([self._row(element, row)[k] for row in range(element.count)], float)

    def _binary_row(self, element: PlyElement, at: int) -> tuple[list[Any], int]:
        row = []
        for _, kind, list_kind in element.properties:
            count = 1
            if list_kind:
                (count,) = struct.unpack_from(self._order + list_kind, self._data, at)
                at += struct.calcsize(list_kind)
            form = f"{self._order}{count}{kind}"
            values = struct.unpack_from(form, self._data, at)
            at += struct.calcsize(form)
            row.append(values if list_kind else values[0])
        return row, at

    def _row(self, element: PlyElement, k: int) -> list[Any]:
        return list(self._binary_row(element, element.starts[k])[0] if self._order else self._text_row(element, k))

    def _encode(self, element: PlyElement, row: list[Any]) -> bytes:
        parts = []
        for (_, kind, list_kind), value in zip(element.properties, row):
            values = value if list_kind else [value]
            if kind not in "fd":
                values = [int(v) for v in values]
            try:
                binary = struct.pack(f"{self._order or '<'}{len(values)}{kind}", *values)
                if list_kind:
                    binary = struct.pack((self._order or "<") + list_kind, len(values)) + binary
            except (struct.error, OverflowError):
                raise FileError(Message("indices_too_large", {"element": element.name})) from None
            if self._order:
                parts.append(binary)
            else:
                parts += [b"%d" % len(values)] if list_kind else []
                if kind == "f":
                    values = [np.float32(v) for v in values]
                parts += [str(v).encode() for v in values]
        return b"".join(parts) if self._order else b" ".join(parts) + self._eol
