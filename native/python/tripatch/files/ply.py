"""PLY files, which keep all that they have while fills are added, marked and removed."""

from __future__ import annotations

import itertools
import json
import re
import struct
from collections.abc import Hashable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Array
from ..messages import Message
from . import evidence, writing
from .continued import Continued
from .mesh_file import DEVIATION, NOT_KNOWN
from .ply_rows import TYPES, PlyElement, PlyRows
from .writing import FileError

_ORIGINAL, _FILL = b"comment tripatch original ", b"comment tripatch fill "
_PLY_NORMAL = ("nx", "ny", "nz")


def _is_blended(name: str, kind: str) -> bool:
    """Colors and what is measured; other whole numbers are names of something."""
    return kind in "fd" or name in ("r", "g", "b", "a") or name.endswith(("red", "green", "blue", "alpha"))


class PlyFile(PlyRows):
    """PLY, text and binary of either byte order, whatever its elements and properties. Only the counts in the header change."""

    def __init__(self, data: bytes) -> None:
        super().__init__(data)
        self._changed: dict[int, list[Any]] = {}  # rows of faces that were split
        self._deviation_at = -1  # property of new vertices that is their fill's; -1: all are as those of the rim

    @classmethod
    def of_mesh(cls, vertices: Array, faces: list[list[int]]) -> PlyFile:
        head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        head += "".join(f"property double {c}\n" for c in "xyz")
        size = "uchar" if max(map(len, faces), default=3) < 256 else "int"
        head += f"element face {len(faces)}\nproperty list {size} int vertex_indices\nend_header\n"
        code = "<" + TYPES[size]
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

    def _with_zeros(self, element: PlyElement, kind: str, name: str) -> bytes:
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

    def _even_rows(self, element: PlyElement) -> Array | None:
        """The rows of an element as bytes (n, size); None where they differ in size, or the file is text."""
        sizes = np.diff(np.asarray(element.starts))
        if not self._order or not len(sizes) or (sizes != sizes[0]).any():
            return None
        rows = np.frombuffer(bytes(self._data[element.starts[0] : element.starts[-1]]), np.uint8)
        return rows.reshape(len(sizes), -1)

    def _last_word(self, element: PlyElement, k: int) -> re.Match[bytes]:
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
            said = self._about_original(evidence.sha256(bytes(self._data)))
            made = self._again(self._with_comment(self._with_zeros(face, "int", evidence.FILL), said))
        made._marks = True
        made._number = len(re.findall(rb"[\r\n]" + _FILL, bytes(made._data[: made._body])))
        return made

    def _about_original(self, sha256: str) -> bytes:
        """The comment that says how the file was before its fills."""
        said: dict[str, Any] = {"sha256": sha256, "counts": [self._count(e).decode("latin-1") for e in self._both()]}
        if any(element.gaps for element in self._elements):
            said["gaps"] = [element.gaps for element in self._elements]
        return _ORIGINAL + evidence.line(said)

    def _both(self) -> tuple[PlyElement, PlyElement]:
        return self._vertex, self._face

    def _count(self, element: PlyElement) -> bytes:
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

    def _shortened(self, element: PlyElement, k: int) -> bytes:
        """A row without its last number, of four bytes."""
        first, after = element.starts[k], element.starts[k + 1]
        if self._order:
            return bytes(self._data[first : after - 4])
        word, text = self._last_word(element, k), self._lines[first]
        return text[: word.start() - 1] + text[word.end() :] + self._lines.between(first + 1, after)

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
        vertex.added += len(fill.vertices)
        if vertex.block is not None and not vertex.lists():
            even = self._even_vertices(fill, continued, blended, normal)
            if even is not None:
                vertex.new.append(even)
                return
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

    def _even_vertices(self, fill: Any, continued: Continued, blended: list[int], normal: list[int]) -> bytes | None:
        """Rows of new vertices that are as long as all others; None where a number does not fit."""
        vertex = self._vertex
        table: Array = vertex.block  # type: ignore[assignment]
        rows = table[continued.near]

        def of_rim(rim: Array) -> Array:
            own = table[rim]
            return np.column_stack([own[f"p{p}"] for p in blended])

        values = {k: own for k, own in zip(normal, fill.normals.T, strict=True) if k >= 0}
        values |= dict(zip(self._xyz, fill.vertices.T, strict=True))
        if self._deviation_at >= 0:
            known = getattr(fill, DEVIATION, None)
            values[self._deviation_at] = np.full(len(rows), NOT_KNOWN) if known is None else known
        blended = [p for p in blended if p not in values]
        own_values = continued.at_vertices(of_rim).T if blended else ()
        for p, own in zip(blended, own_values, strict=True):
            values[p] = own if vertex.properties[p][1] in "fd" else np.rint(own)
        for p, own in values.items():
            kind = rows.dtype[f"p{p}"]
            ends = np.finfo(kind) if kind.kind == "f" else np.iinfo(kind)
            if not (np.abs(own) <= np.inf).all() or (own < float(ends.min)).any() or (own > float(ends.max)).any():
                return None
            rows[f"p{p}"] = own
        return bytes(rows.tobytes())

    def _with_fills(self, head: bytes) -> bytes:
        """A header that tells of the fills and counts what they have added."""
        if self._about:
            head = self._with_comment(head, self._eol.join(_FILL + evidence.line(said) for said in self._about))
        for element in reversed(self._elements):
            first, end = element.count_at
            head = head[:first] + b"%d" % (element.count + element.added) + head[end:]
        return head

    def _save(self, path: Path) -> None:
        head, pieces = bytes(self._data[: self._body]), list[bytes]()
        head = self._with_fills(head)
        body = bytes(self._data[self._body :]) if self._order else b""
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
