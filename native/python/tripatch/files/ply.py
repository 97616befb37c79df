"""PLY, text and binary."""

from __future__ import annotations

import itertools
import json
import re
import struct
from array import array
from collections.abc import Hashable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Array
from ..messages import Message
from . import evidence, writing
from .continued import Continued
from .lines import EditedLines, rows_of
from .mesh_file import DEVIATION, NOT_KNOWN, MeshFile
from .writing import FileError, damaged

_PLY_TYPES = {
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
_ORIGINAL, _FILL = b"comment tripatch original ", b"comment tripatch fill "
_PLY_NORMAL = ("nx", "ny", "nz")


def _is_blended(name: str, kind: str) -> bool:
    """Colors and what is measured; other whole numbers are names of something."""
    return kind in "fd" or name in ("r", "g", "b", "a") or name.endswith(("red", "green", "blue", "alpha"))


class _PlyElement:
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


class PlyFile(MeshFile):
    """PLY, text and binary of either byte order, whatever its elements and properties. Only the counts in the header change."""

    def __init__(self, data: bytes) -> None:
        end = re.search(rb"(?:^|[\r\n])end_header[ \t]*(\r\n|\n|\r)", data)
        if not data.startswith(b"ply") or not end:
            raise damaged("PLY")
        self._data: bytes | bytearray = data
        self._eol = end[1]
        self._elements: list[_PlyElement] = []
        form = ""
        for line in re.finditer(rb"[^\r\n]+", data[: end.start()]):
            places = [*re.finditer(rb"\S+", line[0])]  # what bytes call white, as the rows below
            words = [place[0].decode("latin-1") for place in places]
            try:
                if words[:1] == ["format"]:
                    form = words[1]
                elif words[:1] == ["element"]:
                    self._elements.append(_PlyElement(words[1], int(words[2])))
                    self._elements[-1].count_at = (line.start() + places[2].start(), line.start() + places[2].end())
                    if self._elements[-1].count < 0:
                        raise ValueError
                elif words[:2] == ["property", "list"]:
                    self._elements[-1].properties.append((words[4], _PLY_TYPES[words[3]], _PLY_TYPES[words[2]]))
                elif words[:1] == ["property"]:
                    self._elements[-1].properties.append((words[2], _PLY_TYPES[words[1]], None))
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
            raise FileError(Message("file_lacks_mesh", {"format": "PLY"}))
        self._vertex, self._face = found["vertex"], found["face"]
        self._xyz = [self._vertex.index(c) for c in "xyz"]
        self._index = max(self._face.index("vertex_indices"), self._face.index("vertex_index"))
        if min(self._xyz) < 0 or self._index < 0 or self._face.properties[self._index][2] is None:
            raise FileError(Message("file_lacks_mesh", {"format": "PLY"}))
        try:
            vertices, sizes, corners = self._read_text() if form == "ascii" else self._read_binary()
        except (ValueError, IndexError, OverflowError, MemoryError, struct.error):
            raise damaged("PLY") from None
        self._changed: dict[int, list[Any]] = {}  # rows of faces that were split
        self._deviation_at = -1  # property of new vertices that is their fill's; -1: all are as those of the rim
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

    @classmethod
    def of_mesh(cls, vertices: Array, faces: list[list[int]]) -> PlyFile:
        head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        head += "".join(f"property double {c}\n" for c in "xyz")
        size = "uchar" if max(map(len, faces), default=3) < 256 else "int"
        head += f"element face {len(faces)}\nproperty list {size} int vertex_indices\nend_header\n"
        code = "<" + _PLY_TYPES[size]
        body = [np.ascontiguousarray(vertices, "<f8").tobytes()]
        body += [struct.pack(f"{code}{len(face)}i", len(face), *face) for face in faces]
        return cls(head.encode() + b"".join(body))

    @property
    def deviation(self) -> Array | None:
        """(n,) how well the vertices are known, below 0 where nobody knows; None: the file does not say."""
        vertex, k = self._vertex, self._vertex.index(DEVIATION)
        if k < 0 or vertex.properties[k][2]:
            return None
        return self._column(vertex, k).astype(float)

    def with_deviation(self) -> PlyFile:
        """The same file with a number `deviation` at every vertex, 0 where it had none; fills write theirs there."""
        vertex, k = self._vertex, self._vertex.index(DEVIATION)
        if k >= 0 and (vertex.properties[k][2] or vertex.properties[k][1] not in "fd"):
            raise FileError(Message("property_type", {"element": "vertex", "name": DEVIATION}))
        made = self if k >= 0 else self._again(self._with_zeros(vertex, "float", DEVIATION))
        made._deviation_at = made._vertex.index(DEVIATION)
        return made

    def _again(self, data: bytes) -> PlyFile:
        """The file with other content, of which the same is asked for."""
        made = PlyFile(data)
        made.suffix, made._marks, made._number, made._deviation_at = self.suffix, self._marks, self._number, self._deviation_at
        return made

    def _with_zeros(self, element: _PlyElement, kind: str, name: str) -> bytes:
        """The file with one more number of four bytes, 0 everywhere, at the end of the rows of an element."""
        data, end = bytes(self._data), element.head_end
        head = data[:end] + self._eol + f"property {kind} {name}".encode() + data[end : self._body]
        if self._order:
            even = self._even_rows(element)
            if even is None:
                rows = b"".join(data[a:b] + bytes(4) for a, b in itertools.pairwise(element.starts))
            else:
                rows = np.concatenate([even, np.zeros((len(even), 4), np.uint8)], axis=1).tobytes()
            return head + data[self._body : element.starts[0]] + rows + data[element.starts[-1] :]
        if element.plain:
            return head + self._lines.with_word(np.asarray(element.starts[:-1]), b"0")
        lines = [self._lines[k] for k in range(len(self._lines))]
        for k in range(element.count):
            at = element.starts[k]
            end = self._last_word(element, k).end()
            lines[at] = lines[at][:end] + b" 0" + lines[at][end:]
        return head + b"".join(lines)

    def _even_rows(self, element: _PlyElement) -> Array | None:
        """The rows of an element as bytes (n, size); None where they differ in size, or the file is text."""
        sizes = np.diff(np.asarray(element.starts))
        if not self._order or not len(sizes) or (sizes != sizes[0]).any():
            return None
        rows = np.frombuffer(bytes(self._data[element.starts[0] : element.starts[-1]]), np.uint8)
        return rows.reshape(len(sizes), -1)

    def _last_word(self, element: _PlyElement, k: int) -> re.Match[bytes]:
        """Where the last property of a row of a text stands."""
        row = self._text_row(element, k)
        words = sum(1 + len(value) if p[2] else 1 for p, value in zip(element.properties, row))
        return [*re.finditer(rb"\S+", self._lines[element.starts[k]])][words - 1]

    def marked(self) -> PlyFile:
        """The same file with a number `tripatch_fill` at every face, which tells of which fill it is; comments in the header
        will say the rest."""
        face, k = self._face, self._face.index(evidence.FILL)
        if k >= 0 and (face.properties[k][2] or face.properties[k][1] in "fd"):
            raise FileError(Message("property_type", {"element": "face", "name": evidence.FILL}))
        made = self
        if k < 0:
            said: dict[str, Any] = {
                "sha256": evidence.sha256(bytes(self._data)),
                "counts": [self._count(e).decode("latin-1") for e in self._both()],
            }
            if any(element.gaps for element in self._elements):
                said["gaps"] = [element.gaps for element in self._elements]
            made = self._again(self._with_comment(self._with_zeros(face, "int", evidence.FILL), _ORIGINAL + evidence.line(said)))
        made._marks = True
        made._number = len(re.findall(rb"[\r\n]" + _FILL, bytes(made._data[: made._body])))
        return made

    def _both(self) -> tuple[_PlyElement, _PlyElement]:
        return self._vertex, self._face

    def _count(self, element: _PlyElement) -> bytes:
        """As the header has it."""
        first, end = element.count_at
        return bytes(self._data[first:end])

    def _with_comment(self, data: bytes, comment: bytes) -> bytes:
        """With one more comment at the end of the header."""
        at = re.search(rb"(?<=[\r\n])end_header", data)
        assert at is not None
        return data[: at.start()] + comment + self._eol + data[at.start() :]

    @property
    def fill_faces(self) -> Array:
        """(m,) bool: which faces are fills by TriPatch."""
        said = re.findall(rb"(?<=[\r\n])" + _FILL + rb"([^\r\n]*)", bytes(self._data[: self._body]))
        return self._last_faces(evidence.faces_of(said))

    def stripped(self) -> bytes:
        """The file as it was before its fills."""
        head = bytes(self._data[: self._body])
        found = re.search(rb"(?<=[\r\n])" + _ORIGINAL + rb"([^\r\n]*)", head)
        if not found or self._face.index(evidence.FILL) < 0:
            raise FileError(Message("no_fills_in_file"))
        before = json.loads(found[1])
        fills = [json.loads(each) for each in re.findall(rb"(?<=[\r\n])" + _FILL + rb"([^\r\n]*)", head)]
        gone = {"vertex": sum(fill["vertices"] for fill in fills), "face": sum(fill["faces"] for fill in fills)}
        tries = []
        for added in ((), (DEVIATION,)):
            data = self._without(dict(zip(("vertex", "face"), before["counts"], strict=True)), gone, added)
            tries += [data, data.removesuffix(self._eol)]
            if "gaps" in before:
                tries.append(self._with_gaps(data, before["gaps"], gone))
        return evidence.original(tries, before["sha256"])

    def _with_gaps(self, data: bytes, gaps: Sequence[Sequence[str]], gone: dict[str, int]) -> bytes:
        """A text with other gaps between its rows than ends of lines."""
        body = data.index(self._eol, data.index(b"end_header")) + len(self._eol)
        rows, pieces = iter(data[body:].split(self._eol)), [data[:body]]
        for element, own in zip(self._elements, gaps, strict=True):
            if own:
                between, end = (gap.encode("latin-1") for gap in own)
                count = element.count - gone.get(element.name, 0)
                pieces += [between.join(itertools.islice(rows, count)), end]
        return b"".join(pieces)

    def _without(self, counts: dict[str, str], gone: dict[str, int], added: Sequence[str]) -> bytes:
        """The file without the last rows of vertices and faces, and without properties that were added at the end of theirs."""
        head = bytes(self._data[: self._body])
        for element in reversed(self._elements):
            if element in self._both():
                first, end = element.count_at
                head = head[:first] + counts[element.name].encode("latin-1") + head[end:]
        comment = rb"(?<=[\r\n])(?:" + _ORIGINAL + rb"|" + _FILL + rb")[^\r\n]*" + re.escape(self._eol)
        head = re.sub(comment, b"", head)
        body: list[bytes] = []
        at = self._body if self._order else 0
        for element in self._elements:
            name = next((n for n in (evidence.FILL, *added) if element in self._both() and element.index(n) >= 0), "")
            if name and element.index(name) == len(element.properties) - 1:
                head = re.sub(rb"[\r\n]+property \w+ " + name.encode() + rb"(?=[\r\n])", b"", head, count=1)
            else:
                name = ""
            end = element.starts[-1] if element.count else at
            kept = element.count - gone.get(element.name, 0)
            even = self._even_rows(element)
            if even is not None:
                body += [self._bytes(at, element.starts[0]), even[: max(kept, 0), : -4 if name else None].tobytes()]
                at, kept = end, 0
            if name and element.plain and kept > 0:
                last = int(element.starts[kept])
                body.append(self._lines.without_words(at, last, np.asarray(element.starts[:kept])))
                at, kept = last, 0
            for k in range(max(kept, 0)):
                first, after = element.starts[k], element.starts[k + 1]
                body.append(self._bytes(at, first))
                body.append(self._shortened(element, k) if name else self._bytes(first, after))
                at = after
            at = end
        body.append(self._bytes(at, len(self._data) if self._order else len(self._lines)))
        return head + b"".join(body)

    def _bytes(self, first: int, end: int) -> bytes:
        """From one place of rows to another."""
        return bytes(self._data[first:end]) if self._order else self._lines.between(first, end)

    def _shortened(self, element: _PlyElement, k: int) -> bytes:
        """A row without its last number, of four bytes."""
        first, after = element.starts[k], element.starts[k + 1]
        if self._order:
            return bytes(self._data[first : after - 4])
        word, text = self._last_word(element, k), self._lines[first]
        return text[: word.start() - 1] + text[word.end() :] + self._lines.between(first + 1, after)

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

    def _text_row(self, element: _PlyElement, k: int) -> list[Any]:
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

    def _find_rows(self, element: _PlyElement, at: int) -> int:
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

    def _follow_rows(self, element: _PlyElement, at: int) -> int:
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

    def _column(self, element: _PlyElement, k: int) -> Array:
        """A number of every row."""
        if element.block is not None:
            return np.asarray(element.block[f"p{k}"])
        return np.array([self._row(element, row)[k] for row in range(element.count)], float)

    def _binary_row(self, element: _PlyElement, at: int) -> tuple[list[Any], int]:
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

    def _row(self, element: _PlyElement, k: int) -> list[Any]:
        return list(self._binary_row(element, element.starts[k])[0] if self._order else self._text_row(element, k))

    def _encode(self, element: _PlyElement, row: list[Any]) -> bytes:
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

    def _move(self, v: int, place: Array) -> None:
        vertex, start = self._vertex, self._vertex.starts[v]
        row = self._row(vertex, v)
        for k, value in zip(self._xyz, place):
            row[k] = float(value)
        if self._order:
            encoded = self._encode(vertex, row)
            self._data = self._data if isinstance(self._data, bytearray) else bytearray(self._data)
            self._data[start : start + len(encoded)] = encoded
            return
        words = self._encode(vertex, row).split()
        for k in self._xyz:  # the other numbers as they are written
            first = sum(1 + len(value) if p[2] else 1 for p, value in zip(vertex.properties[:k], row))
            self._lines[start] = writing.with_numbers(self._lines[start], first, [words[first]])

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        k, size = self._row_of[f], len(self._face_by_now(f))
        row = self._changed.get(k) or self._row(self._face, k)
        for p, (_, kind, list_kind) in enumerate(self._face.properties):
            values = list(row[p]) if list_kind else []
            if p == self._index:
                values.insert(place + 1, v)
            elif values and len(values) % size == 0:  # so many by corner, as texture coordinates
                each = len(values) // size
                ends = [values[each * q : each * (q + 1)] for q in (place, (place + 1) % size)]
                between = [(1 - t) * x + t * y for x, y in zip(*ends)] if kind in "fd" else ends[0]
                values[each * (place + 1) : each * (place + 1)] = between
            if list_kind:
                row[p] = values
        self._changed[k] = row

    def _look(self, f: int) -> Hashable:
        told = [p for p, (name, _, list_kind) in enumerate(self._face.properties) if not list_kind and name != evidence.FILL]
        if not told:
            return ()
        row = self._row(self._face, self._row_of[f])
        return tuple(row[p] for p in told)

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        self._append_vertices(fill, continued)
        face = self._face
        mark = face.index(evidence.FILL) if self._marks else -1
        by_corner = {}  # such as texture coordinates
        for p, (_, kind, list_kind) in enumerate(face.properties):
            if list_kind and p != self._index and kind in "fd":
                by_corner[p] = continued.at_corners(lambda f, p=p: self._by_corner(f, p))  # type: ignore[misc]
        if face.block is not None and continued.model and not by_corner and self._fits(faces):
            rows = face.block[[self._row_of[f] for f in continued.model]]
            rows[f"p{self._index}"] = faces
            if mark >= 0:
                rows[f"p{mark}"] = self._number
            face.new.append(rows.tobytes())
            face.added += len(faces)
            return
        face.added += len(faces)
        like = [self._row(face, self._row_of[f]) for f in continued.model]
        for k, corners in enumerate(faces):
            row: list[Any] = [[] if p[2] else like[k][at] if like else 0 for at, p in enumerate(face.properties)]
            for p, values in by_corner.items():
                row[p] = values[k].ravel().tolist() if values else []
            row[self._index] = corners
            if mark >= 0:
                row[mark] = self._number
            face.new.append(self._encode(face, row))

    def _fits(self, faces: list[list[int]]) -> bool:
        """Whether rows of these faces are as those of the block, with no other list in them."""
        table = self._face.block[f"p{self._index}"]  # type: ignore[index]
        largest = np.iinfo(table.dtype).max if table.dtype.kind in "iu" else -1
        return len(self._face.lists()) == 1 and all(len(f) == table.shape[1] and max(f) <= largest for f in faces)

    def _by_corner(self, f: int, p: int) -> Array | None:
        """The values of a list of a face by its corners, if it has as many for each."""
        size, values = len(self._face_by_now(f)), self._row(self._face, self._row_of[f])[p]
        return np.reshape(values, (size, -1)) if len(values) and len(values) % size == 0 else None

    def _append_vertices(self, fill: Any, continued: Continued) -> None:
        vertex = self._vertex
        if not len(fill.vertices):
            return
        normal = [vertex.index(c) for c in _PLY_NORMAL]
        blended = [p for p, (name, kind, list_kind) in enumerate(vertex.properties) if not list_kind and _is_blended(name, kind)]
        values = continued.at_vertices(lambda rim: np.array([[self._row(vertex, v)[p] for p in blended] for v in rim.tolist()]))
        told = itertools.repeat(NOT_KNOWN) if getattr(fill, DEVIATION, None) is None else fill.deviation
        rows = zip(fill.vertices, fill.normals, continued.near.tolist(), told, values.tolist())
        for point, direction, v, deviation, own in rows:
            row = self._row(vertex, v)
            for p, value in zip(blended, own):
                row[p] = value if vertex.properties[p][1] in "fd" else round(value)
            for k, value in zip(self._xyz, point):
                row[k] = float(value)
            for k, value in zip(normal, direction):
                if k >= 0:
                    row[k] = float(value)
            if self._deviation_at >= 0:
                row[self._deviation_at] = float(deviation)
            vertex.new.append(self._encode(vertex, row))
        vertex.added += len(fill.vertices)

    def _save(self, path: Path) -> None:
        head, pieces = bytes(self._data[: self._body]), list[bytes]()
        if self._about:
            head = self._with_comment(head, self._eol.join(_FILL + evidence.line(said) for said in self._about))
        body = bytes(self._data[self._body :]) if self._order else b""
        for element in reversed(self._elements):
            first, end = element.count_at
            head = head[:first] + b"%d" % (element.count + element.added) + head[end:]
        at = 0
        for element in self._elements:
            end = element.starts[-1] - (self._body if self._order else 0) if element.count else at
            rows = self._changed if element is self._face else {}
            for k in [*sorted(rows), None]:  # what is before each changed row, and that row
                first, after = (
                    (end, end) if k is None else (x - (self._body if self._order else 0) for x in element.starts[k : k + 2])
                )
                pieces.append(body[at:first] if self._order else self._lines.between(at, first))
                pieces += [] if k is None else [self._encode(element, rows[k])]
                at = after
            last = next((piece for piece in reversed(pieces) if piece), b"\n")
            if element.new and not self._order and not last.endswith((b"\n", b"\r")):
                pieces.append(self._eol)
            pieces += element.new
        pieces.append(body[at:] if self._order else self._lines.between(at, len(self._lines)))
        with path.open("wb") as out:
            out.write(head)
            out.writelines(pieces)
