"""Mesh files: read, add fills, write. Nothing of the user's file is lost.

OBJ, OFF, PLY and STL are read by small passes of our own that keep the file's bytes and add to them: comments, groups, materials,
texture coordinates, colours, other elements and the header stay as they are. All other formats (VTK, VTU, ...) go through meshio,
which keeps points, cells, and the data of both, but not what it does not read: comments, the title line, VTK's POLYDATA.

A vertex that a fill moves keeps its line or row but for the three numbers. A face whose edge a fill splits keeps all that the
file says of it, texture coordinates by corner are interpolated; in OBJ it goes to the end, after its new vertex. A new vertex
takes what the file says of a vertex beyond its position and normal (colours, say) from the nearest rim vertex, a new face what
the file says of a face (material, group, colour) from the faces around the rim.
"""

from __future__ import annotations

import os
import re
import struct
import warnings
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

__all__ = ["FileError", "MeshFile", "read"]


class FileError(ValueError):
    """A file that cannot be read or written; the message is a sentence."""


class MeshFile:
    """A mesh file in memory.

    Attributes:
        vertices: (n, 3) float64, the file's own.
        faces: index lists, the file's own, three corners or more each. What has fewer stays in the file, unread.
    """

    def __init__(self, vertices: np.ndarray, faces: list) -> None:
        self.vertices = vertices
        self.faces = faces
        self._added = 0  # vertices
        sizes = np.fromiter(map(len, faces), np.int64, len(faces))
        corners = np.fromiter((v for face in faces for v in face), np.int64, int(sizes.sum()))
        if corners.size and (corners.min() < 0 or corners.max() >= len(vertices)):
            place = int(np.argmax((corners < 0) | (corners >= len(vertices))))
            face = int(np.searchsorted(np.cumsum(sizes), place, "right"))
            raise FileError(f"Face {face} names a vertex that does not exist; there are {len(vertices)}")
        self._sizes, self._corners = sizes, corners

    def append(self, fill) -> None:
        """Adds a `tripatch.Fill` of this mesh (one of several, in any order)."""
        n = len(self.vertices)
        faces = [[v if v < n else v + self._added for v in face] for face in fill.faces]
        for v, place in zip(*fill.moved):
            self._move(int(v), place)
        self._append(fill, faces, self._near(fill), self._around(fill.rim))
        for k, ((a, b), t) in enumerate(zip(*fill.split_edges)):
            for f in self._around([a, b]):
                face = self.faces[f]
                for place, ends in enumerate(zip(face, face[1:] + face[:1])):
                    if set(ends) == {a, b}:
                        self._split(int(f), place, n + self._added + k, t if ends[0] == a else 1 - t)
                        face.insert(place + 1, n + self._added + k)
                        break
        self._added += len(fill.vertices)

    def write(self, path) -> None:
        """Writes the file as it was, with the fills added, in the format of the file that was read."""
        path = Path(path)
        part = path.with_name(path.name + ".part")  # so that a full disk costs nobody the file that was there
        try:
            try:
                self._save(part)
                os.replace(part, path)
            finally:
                part.unlink(missing_ok=True)
        except OSError as error:
            raise FileError(f"{path} cannot be written: {error.strerror or error}") from error

    def _move(self, v: int, place: np.ndarray) -> None:
        """The file's own vertex v goes to another place."""
        raise NotImplementedError

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        """The file's own face f gets the new vertex v after its corner `place`, the part t of the way to the next."""
        raise NotImplementedError

    def _append(self, fill, faces: list[list[int]], near: np.ndarray, around: np.ndarray) -> None:
        """near: for each new vertex the rim vertex that it takes after; around: the faces at the rim."""
        raise NotImplementedError

    def _save(self, path: Path) -> None:
        raise NotImplementedError

    def _near(self, fill) -> np.ndarray:
        rim = np.asarray(fill.rim, np.int64)
        places = self.vertices[rim]
        near = np.empty(len(fill.vertices), np.int64)
        for start in range(0, len(near), 1024):
            block = fill.vertices[start : start + 1024]
            with np.errstate(over="ignore"):
                near[start : start + 1024] = rim[((block[:, None] - places) ** 2).sum(axis=2).argmin(axis=1)]
        return near

    def _around(self, rim) -> np.ndarray:
        rim = np.asarray(rim, np.int64)
        n = len(self.vertices)

        def keys(a, b):
            return np.minimum(a, b) * n + np.maximum(a, b)

        following = np.roll(self._corners, -1)
        ends = np.cumsum(self._sizes)
        following[ends - 1] = self._corners[ends - self._sizes]
        at_rim = np.isin(keys(self._corners, following), keys(rim, np.roll(rim, -1)))
        return np.unique(np.searchsorted(ends, np.nonzero(at_rim)[0], "right"))


def _most(values):
    """The most frequent, the first of equals."""
    return Counter(values).most_common(1)[0][0]


def _number(x: float) -> bytes:
    return repr(float(x)).encode()


def _numbers(row) -> bytes:
    return b" ".join(map(_number, row))


def _with_numbers(text: bytes, first: int, values) -> bytes:
    """A line, or several that continue it, with other numbers from word `first` on; what is between the words stays."""
    words = list(re.finditer(rb"(?:(?!\\\r?\n)\S)+", text))[first : first + len(values)]
    for word, value in reversed(list(zip(words, values))):
        text = text[: word.start()] + value + text[word.end() :]
    return text


def _lines(data: bytes) -> list[bytes]:
    return data.splitlines(keepends=True)


def _line_end(lines: Sequence[bytes]) -> bytes:
    first = lines[0] if lines else b"\n"
    return first[len(first.rstrip(b"\r\n")) :] or b"\n"


# ---------------------------------------------------------------------------------------------------- OBJ

_OBJ_STATE = (b"o", b"g", b"usemtl", b"s")


class ObjFile(MeshFile):
    """Wavefront OBJ. All bytes stay; what is new is added at the end, so that no negative index changes its meaning."""

    def __init__(self, data: bytes) -> None:
        self._new: list[bytes] = []
        vertices, extras, faces = [], [], []
        self._vertex_lines, self._face_lines = [], []  # first and end
        self._counts: list[tuple[int, int, int]] = []  # of v, vt and vn before each face, for negative indices
        self._textures: list[list[bytes]] = []
        self._changed: dict[int, tuple[int, list]] = {}  # faces that were split: place in `new`, corners
        self._normals = 0
        lines = self._lines = _lines(data)
        self._eol = _line_end(lines)
        state: dict[bytes, bytes] = {}  # the last line of each keyword that later faces are under
        self._states, self._state_of = [state], []
        self._with_normals = False
        number = 0
        while number < len(lines):
            line, start = lines[number], number
            number += 1
            while line.rstrip(b"\r\n").endswith(b"\\") and number < len(lines):
                line = line.rstrip(b"\r\n")[:-1] + b" " + lines[number]
                number += 1
            words = line.split()
            if not words or words[0][:1] == b"#":
                continue
            keyword = words[0]
            try:
                if keyword == b"v":
                    vertices.append((float(words[1]), float(words[2]), float(words[3])))
                    extras.append(words[4:])
                    self._vertex_lines.append((start, number))
                elif keyword == b"vn":
                    self._normals += 1
                elif keyword == b"vt":
                    self._textures.append(words[1:])
                elif keyword == b"f":
                    if b"#" in line:
                        words = line.split(b"#")[0].split()
                    face = [int(word.partition(b"/")[0]) for word in words[1:]]
                    if 0 in face:
                        raise ValueError
                    if len(face) >= 3:
                        faces.append([v - 1 if v > 0 else v + len(vertices) for v in face])
                        self._state_of.append(len(self._states) - 1)
                        self._face_lines.append((start, number))
                        self._counts.append((len(vertices), len(self._textures), self._normals))
                        if words[1].count(b"/") == 2 and not words[1].endswith(b"/"):
                            self._with_normals = True
                elif keyword in _OBJ_STATE:
                    state = {**state, keyword: line.rstrip(b"\r\n")}
                    self._states.append(state)
            except (ValueError, IndexError):
                raise FileError(f"Line {number} cannot be understood: {line.strip().decode(errors='replace')[:60]}") from None
        self._extras = extras
        self._state = state
        super().__init__(np.array(vertices, float).reshape(-1, 3), faces)

    @classmethod
    def of_mesh(cls, vertices, faces) -> ObjFile:
        rows = [b"v " + _numbers(p) for p in vertices] + [b"f " + b" ".join(b"%d" % (v + 1) for v in face) for face in faces]
        return cls(b"\n".join(rows) + b"\n")

    def _move(self, v, place):
        start, end = self._vertex_lines[v]
        self._lines[start] = _with_numbers(b"".join(self._lines[start:end]), 1, [_number(x) for x in place])
        self._lines[start + 1 : end] = [b""] * (end - start - 1)

    def _append(self, fill, faces, near, around):
        new = self._new
        like = self._states[_most(self._state_of[f] for f in around)] if len(around) else {}
        for point, v in zip(fill.vertices, near):
            new.append(b" ".join([b"v", _numbers(point), *self._extras[v]]))
        normal_of = {}
        if self._with_normals:
            first = len(self.vertices) + self._added
            corners = [*map(int, fill.rim), *range(first, first + len(fill.vertices))]
            for v, normal in zip(corners, np.concatenate([fill.rim_normals, fill.normals])):
                self._normals += 1
                normal_of[v] = b"//%d" % self._normals
                new.append(b"vn " + _numbers(normal))
        self._go_under(like)
        for face in faces:
            new.append(b"f " + b" ".join(b"%d" % (v + 1) + normal_of.get(v, b"") for v in face))

    def _go_under(self, like: dict[bytes, bytes]) -> None:
        for keyword in _OBJ_STATE:
            # without a line of that kind before them the faces around the rim have the default
            wanted = like.get(keyword, {b"g": b"g default", b"s": b"s off"}.get(keyword, b""))
            if keyword in self._state and wanted and wanted != self._state[keyword]:
                self._new.append(wanted)
                self._state = {**self._state, keyword: wanted}

    def _split(self, f, place, v, t):
        # a face must not come before its vertices: it goes to the end, as it was
        if f not in self._changed:
            start, end = self._face_lines[f]
            text = b"".join(self._lines[start:end])
            words = re.sub(rb"\\\r?\n", b" ", text).split(b"#")[0].split()[1:]
            corners = []
            for word in words:
                parts = [int(part) if part else 0 for part in word.split(b"/")]
                corners.append([x if x >= 0 else x + n + 1 for x, n in zip(parts, self._counts[f])])
            self._lines[start:end] = [text[text.index(b"#") :] if b"#" in text else b""] + [b""] * (end - start - 1)
            self._go_under(self._states[self._state_of[f]])
            self._new.append(b"")
            self._changed[f] = len(self._new) - 1, corners
        at, corners = self._changed[f]
        first, second = corners[place], corners[(place + 1) % len(corners)]
        between = [v + 1, *first[1:]]
        if len(between) > 1 and first[1] and second[1]:
            ends = [np.array(list(map(float, self._textures[x[1] - 1]))) for x in (first, second)]
            self._textures.append([_number(x) for x in (1 - t) * ends[0] + t * ends[1]])
            between[1] = len(self._textures)
            self._new.insert(at, b"vt " + b" ".join(self._textures[-1]))
            self._changed = {g: (k + (k >= at), c) for g, (k, c) in self._changed.items()}
            at += 1
        corners.insert(place + 1, between)
        self._new[at] = b"f " + b" ".join(b"/".join(b"%d" % x if x else b"" for x in corner) for corner in corners)

    def _save(self, path):
        data = b"".join(self._lines)
        with path.open("wb") as out:
            out.write(data)
            if not self._new:
                return
            if data.rstrip(b"\r\n").endswith(b"\\"):
                out.write(self._eol)
            if data and not data.endswith((b"\n", b"\r")):
                out.write(self._eol)
            out.writelines(line + self._eol for line in self._new)


# ---------------------------------------------------------------------------------------------------- OFF


class OffFile(MeshFile):
    """Object File Format, text: OFF, COFF, NOFF, STOFF and their combinations. All lines stay but for the one with the counts."""

    def __init__(self, data: bytes) -> None:
        self._lines = _lines(data)
        self._eol = _line_end(self._lines)
        rows = [(k, words) for k, line in enumerate(self._lines) if (words := line.split(b"#")[0].split())]
        if not rows:
            raise FileError("The file is empty")
        head = re.fullmatch(rb"(ST)?(C)?(N)?(4)?(n)?OFF", rows[0][1][0])
        if not head:
            raise FileError("An OFF file must start with OFF")
        if b"BINARY" in rows[0][1]:
            raise FileError("Binary OFF files cannot be read; save it as text")
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
        self._new_vertices, self._new_faces, self._new_edges = [], [], 0
        super().__init__(vertices, faces)

    @classmethod
    def of_mesh(cls, vertices, faces) -> OffFile:
        rows = [b"OFF", b"%d %d 0" % (len(vertices), len(faces))] + [_numbers(p) for p in vertices]
        rows += [b"%d " % len(face) + b" ".join(b"%d" % v for v in face) for face in faces]
        return cls(b"\n".join(rows) + b"\n")

    def _move(self, v, place):
        k = self._vertex_lines[v]
        self._lines[k] = _with_numbers(self._lines[k], 0, [_number(x) for x in place])

    def _split(self, f, place, v, t):
        text = self._lines[self._face_lines[f]]
        words = list(re.finditer(rb"\S+", text))
        size, corner = words[0], words[1 + place]
        text = text[: corner.end()] + b" %d" % v + text[corner.end() :]
        self._lines[self._face_lines[f]] = text[: size.start()] + b"%d" % (int(size[0]) + 1) + text[size.end() :]

    def _append(self, fill, faces, near, around):
        for point, normal, v in zip(fill.vertices, fill.normals, near):
            rest = self._vertex_rest[v]
            if self._has_normals and len(rest) >= 3:
                rest = [_numbers(normal), *rest[3:]]
            self._new_vertices.append(b" ".join([_numbers(point), *rest]))
        rest = _most(self._face_rest[f] for f in around) if len(around) else ()
        for face in faces:
            self._new_faces.append(b" ".join([b"%d" % len(face), *(b"%d" % v for v in face), *rest]))
        edges = {(min(a, b), max(a, b)) for face in faces for a, b in zip(face, face[1:] + face[:1])}
        self._new_edges += len(edges) - len(fill.rim)

    def _save(self, path):
        lines = list(self._lines)
        text, comment_sign, comment = lines[self._counts_line].partition(b"#")
        added = iter((len(self._new_vertices), len(self._new_faces), self._new_edges if self._edges else 0))
        text = re.sub(rb"(?<!\S)\d+(?!\S)", lambda old: b"%d" % (int(old[0]) + next(added)), text, count=3)
        lines[self._counts_line] = text + comment_sign + comment
        first, second = self._cut
        lines[first - 1] = self._ended(lines[first - 1])
        lines[second - 1] = self._ended(lines[second - 1])
        with path.open("wb") as out:
            out.writelines(lines[:first])
            out.writelines(line + self._eol for line in self._new_vertices)
            out.writelines(lines[first:second])
            out.writelines(line + self._eol for line in self._new_faces)
            out.writelines(lines[second:])

    def _ended(self, line: bytes) -> bytes:
        return line if line.endswith((b"\n", b"\r")) or not self._new_faces else line + self._eol


# ---------------------------------------------------------------------------------------------------- PLY

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
_PLY_NORMAL = ("nx", "ny", "nz")


class _PlyElement:
    def __init__(self, name: str, count: int) -> None:
        self.name, self.count = name, count
        self.properties: list[tuple[str, str, str | None]] = []  # name, type, type of the count of a list
        self.starts: Sequence[int] = ()  # of every row and of the end: bytes, or lines of a text
        self.new: list[bytes] = []

    def index(self, name: str) -> int:
        return next((k for k, p in enumerate(self.properties) if p[0] == name), -1)


class PlyFile(MeshFile):
    """PLY, text and binary of either byte order, whatever its elements and properties. Only the counts in the header change."""

    def __init__(self, data: bytes) -> None:
        end = re.search(rb"(?:^|[\r\n])end_header[ \t]*(\r\n|\n|\r)", data)
        if not data.startswith(b"ply") or not end:
            raise FileError("The file is no PLY file: its header is missing or has no end")
        self._data, self._eol = bytearray(data), end[1]
        self._elements: list[_PlyElement] = []
        form = ""
        for line in data[: end.start()].decode("latin-1").splitlines()[1:]:
            words = line.split()
            try:
                if words[:1] == ["format"]:
                    form = words[1]
                elif words[:1] == ["element"]:
                    self._elements.append(_PlyElement(words[1], int(words[2])))
                elif words[:2] == ["property", "list"]:
                    self._elements[-1].properties.append((words[4], _PLY_TYPES[words[3]], _PLY_TYPES[words[2]]))
                elif words[:1] == ["property"]:
                    self._elements[-1].properties.append((words[2], _PLY_TYPES[words[1]], None))
            except (LookupError, ValueError):
                raise FileError(f"The PLY header has a line that cannot be understood: {line.strip()[:60]}") from None
        if form not in ("ascii", "binary_little_endian", "binary_big_endian"):
            raise FileError(f"The PLY format {form or '(none given)'} is not known")
        self._order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[form]
        self._body = end.end()

        found = {e.name: e for e in self._elements}
        if "vertex" not in found or "face" not in found:
            raise FileError("The PLY file has no vertices or no faces")
        self._vertex, self._face = found["vertex"], found["face"]
        self._xyz = [self._vertex.index(c) for c in "xyz"]
        self._index = max(self._face.index("vertex_indices"), self._face.index("vertex_index"))
        if min(self._xyz) < 0 or self._index < 0 or self._face.properties[self._index][2] is None:
            raise FileError("The PLY file has vertices without x, y, z or faces without vertex indices")
        try:
            columns = self._read_text() if form == "ascii" else self._read_binary()
        except (ValueError, IndexError, struct.error):
            raise FileError("The PLY file is damaged: it ends early or holds what is no number") from None
        vertices = np.column_stack([np.asarray(columns[0][k], float) for k in self._xyz]).reshape(-1, 3)
        rows = columns[1][self._index]
        faces = (rows if isinstance(rows, np.ndarray) else np.array(rows, object)).tolist() if len(rows) else []
        keep = [f for f, face in enumerate(faces) if len(face) >= 3]
        self._row_of = keep
        self._changed: dict[int, list] = {}  # rows of faces that were split
        super().__init__(vertices, [[int(v) for v in faces[f]] for f in keep])

    @classmethod
    def of_mesh(cls, vertices, faces) -> PlyFile:
        head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        head += "".join(f"property double {c}\n" for c in "xyz")
        size = "uchar" if max(map(len, faces), default=3) < 256 else "int"
        head += f"element face {len(faces)}\nproperty list {size} int vertex_indices\nend_header\n"
        code = "<" + _PLY_TYPES[size]
        body = [np.ascontiguousarray(vertices, "<f8").tobytes()]
        body += [struct.pack(f"{code}{len(face)}i", len(face), *face) for face in faces]
        return cls(head.encode() + b"".join(body))

    # Both readers set where the rows of all elements start, and return the columns of vertices and faces by place.

    def _read_text(self):
        self._lines = _lines(self._data[self._body :])
        filled = [k for k, line in enumerate(self._lines) if line.strip()]
        first, columns = 0, {}
        for element in self._elements:
            places = filled[first : first + element.count]
            if len(places) < element.count:
                raise ValueError
            element.starts = [*places, places[-1] + 1 if places else 0]
            first += element.count
            if element is self._vertex:
                if any(p[2] for p in element.properties):
                    rows = [[self._text_row(element, k)[c] for c in self._xyz] for k in range(element.count)]
                else:
                    text = [self._lines[k].decode() for k in places]
                    rows = np.loadtxt(text, usecols=self._xyz, ndmin=2, comments=None) if text else []
                columns["vertex"] = dict(zip(self._xyz, np.array(rows, float).reshape(-1, 3).T))
            elif element is self._face:
                columns["face"] = {self._index: [self._text_row(element, k)[self._index] for k in range(element.count)]}
        return columns["vertex"], columns["face"]

    def _text_row(self, element: _PlyElement, k: int) -> list:
        words, at, row = self._lines[element.starts[k]].split(), 0, []
        for _, kind, list_kind in element.properties:
            count = 1
            if list_kind:
                count = int(words[at])
                at += 1
            if len(words) < at + count:
                raise ValueError
            values = [float(w) if kind in "fd" else int(w) for w in words[at : at + count]]
            row.append(values if list_kind else values[0])
            at += count
        return row

    def _read_binary(self):
        at, columns = self._body, {}
        for element in self._elements:
            at, rows = self._binary_rows(element, at)
            if element in (self._vertex, self._face):
                columns[element.name] = rows
        return columns["vertex"], columns["face"]

    def _binary_rows(self, element: _PlyElement, at: int):
        data, order = self._data, self._order
        if element.count == 0:
            element.starts = [at]
            return at, [[]] * len(element.properties)
        # all rows as long as the first, as where all faces are triangles: one block
        first, _ = self._binary_row(element, at)
        fields = []
        for k, ((_, kind, list_kind), value) in enumerate(zip(element.properties, first)):
            if list_kind:
                fields.append((f"n{k}", order + list_kind))
            fields.append((f"p{k}", order + kind, (len(value),) if list_kind else ()))
        block = np.dtype(fields)
        end = at + block.itemsize * element.count
        if end <= len(data):
            rows = np.frombuffer(data, block, element.count, at)
            lists = [k for k, p in enumerate(element.properties) if p[2]]
            if all((rows[f"n{k}"] == len(first[k])).all() for k in lists):
                element.starts = range(at, end + 1, block.itemsize)
                return end, [rows[f"p{k}"] for k in range(len(element.properties))]
        starts, rows = [at], []
        for _ in range(element.count):
            row, at = self._binary_row(element, at)
            rows.append(row)
            starts.append(at)
        element.starts = starts
        return at, list(zip(*rows))

    def _binary_row(self, element: _PlyElement, at: int) -> tuple[list, int]:
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

    def _row(self, element: _PlyElement, k: int) -> list:
        return list(self._binary_row(element, element.starts[k])[0] if self._order else self._text_row(element, k))

    def _encode(self, element: _PlyElement, row: list) -> bytes:
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
                raise FileError(
                    f"The new {element.name} rows need larger numbers than the file's type of index can hold"
                ) from None
            if self._order:
                parts.append(binary)
            else:
                parts += [b"%d" % len(values)] if list_kind else []
                if kind == "f":
                    values = [np.float32(v) for v in values]
                parts += [str(v).encode() for v in values]
        return b"".join(parts) if self._order else b" ".join(parts) + self._eol

    def _move(self, v, place):
        vertex, start = self._vertex, self._vertex.starts[v]
        row = self._row(vertex, v)
        for k, value in zip(self._xyz, place):
            row[k] = float(value)
        if self._order:
            encoded = self._encode(vertex, row)
            self._data[start : start + len(encoded)] = encoded
            return
        words = self._encode(vertex, row).split()
        for k in self._xyz:  # the other numbers as they are written
            first = sum(1 + len(value) if p[2] else 1 for p, value in zip(vertex.properties[:k], row))
            self._lines[start] = _with_numbers(self._lines[start], first, [words[first]])

    def _split(self, f, place, v, t):
        k, size = self._row_of[f], len(self.faces[f])
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

    def _append(self, fill, faces, near, around):
        vertex, face = self._vertex, self._face
        normal = [vertex.index(c) for c in _PLY_NORMAL]
        for point, direction, v in zip(fill.vertices, fill.normals, near):
            row = self._row(vertex, v)
            for k, value in zip(self._xyz, point):
                row[k] = float(value)
            for k, value in zip(normal, direction):
                if k >= 0:
                    row[k] = float(value)
            vertex.new.append(self._encode(vertex, row))
        empty = [[] if p[2] else 0 for p in face.properties]
        like = empty
        if len(around):  # lists, such as texture coordinates by corner, are not what a neighbour can give
            rows = (self._row(face, self._row_of[f]) for f in around)
            like = list(_most(tuple(() if p[2] else x for p, x in zip(face.properties, row)) for row in rows))
        for corners in faces:
            row = list(like)
            row[self._index] = corners
            face.new.append(self._encode(face, row))

    def _save(self, path):
        head = self._data[: self._body]
        pieces, body = [], self._data[self._body :] if self._order else b""
        for element in self._elements:
            pattern = rb"(?<![^\r\n])([ \t]*element[ \t]+" + re.escape(element.name.encode("latin-1")) + rb"[ \t]+)\d+"
            head = re.sub(pattern, lambda m, e=element: m[1] + b"%d" % (e.count + len(e.new)), head, count=1)
        at = 0
        for element in self._elements:
            end = element.starts[-1] - (self._body if self._order else 0) if element.count else at
            rows = self._changed if element is self._face else {}
            for k in [*sorted(rows), None]:  # what is before each changed row, and that row
                first, after = (
                    (end, end) if k is None else (x - (self._body if self._order else 0) for x in element.starts[k : k + 2])
                )
                pieces.append(bytes(body[at:first]) if self._order else b"".join(self._lines[at:first]))
                pieces += [] if k is None else [self._encode(element, rows[k])]
                at = after
            last = next((piece for piece in reversed(pieces) if piece), b"\n")
            if element.new and not self._order and not last.endswith((b"\n", b"\r")):
                pieces.append(self._eol)
            pieces += element.new
        pieces.append(body[at:] if self._order else b"".join(self._lines[at:]))
        with path.open("wb") as out:
            out.write(head)
            out.writelines(pieces)


# ---------------------------------------------------------------------------------------------------- STL


def _corner_triangles(faces):
    return [(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)]


_STL_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


class StlFile(MeshFile):
    """STL, binary and text: triangles are added after the last one. Corners at the same place, to the bit, are one vertex."""

    def __init__(self, data: bytes) -> None:
        self._data, self._new = data, []
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
    def of_mesh(cls, vertices, faces) -> StlFile:
        stl = cls(b"STL".ljust(80) + struct.pack("<I", 0))
        stl._add(np.asarray(vertices, float)[np.array(_corner_triangles(faces), int).reshape(-1, 3)])
        MeshFile.__init__(stl, vertices, faces)  # numbered as given, not by first use
        return stl

    def _move(self, v, place):
        raise FileError("An STL file has a copy of a vertex for every triangle and none is moved; write another format")

    def _split(self, f, place, v, t):
        raise FileError("An STL file holds triangles, and one with a split edge is none; write another format")

    def _append(self, fill, faces, near, around):
        triangles = np.array(_corner_triangles(fill.faces), int).reshape(-1, 3)
        places = np.concatenate([self.vertices, fill.vertices])
        self._add(places[triangles])

    def _add(self, triangles):
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
        eol = _line_end(_lines(self._data[:1000]))
        text = []
        for normal, corners in self._new:
            text += [b"  facet normal " + _numbers(normal), b"    outer loop"]
            text += [b"      vertex " + _numbers(p) for p in corners]
            text += [b"    endloop", b"  endfacet"]
        at = self._end.start()
        return self._data[:at] + b"".join(line + eol for line in text) + self._data[at:]

    def _save(self, path):
        path.write_bytes(self._bytes())


# ---------------------------------------------------------------------------------------------------- VTK and others


def _meshio(suffix: str):
    try:
        import meshio
    except ImportError:
        raise FileError(f"For {suffix} files meshio is needed: pip install tripatch[files]") from None
    return meshio


_SURFACE_CELLS = ("triangle", "quad", "polygon")


class MeshioFile(MeshFile):
    """What meshio reads: points, cells of all kinds, and the data of both."""

    def __init__(self, mesh, suffix: str, options: dict) -> None:
        self._mesh, self._suffix, self._options = mesh, suffix, options
        points = np.asarray(mesh.points, float)
        if points.ndim != 2 or points.shape[1] not in (2, 3):
            raise FileError("The file has no points in space")
        if points.shape[1] == 2:
            points = np.column_stack([points, np.zeros(len(points))])
        faces, self._cell_of = [], []
        for b, block in enumerate(mesh.cells):
            if block.type in _SURFACE_CELLS:
                faces += np.asarray(block.data).tolist()
                self._cell_of += [(b, k) for k in range(len(block.data))]
        super().__init__(points, faces)

    @classmethod
    def of_path(cls, path: Path) -> MeshioFile:
        meshio = _meshio(path.suffix)
        options = {}
        if path.suffix.lower() == ".vtk":
            with path.open("rb") as file:
                head = [file.readline() for _ in range(3)]
            options["binary"] = head[2].strip().upper() == b"BINARY"
            version = re.search(rb"Version\s+(\d+)", head[0])
            options["file_format"] = "vtk42" if version and int(version[1]) < 5 else "vtk"
        try:
            mesh = meshio.read(path)
        except (Exception, SystemExit) as error:  # meshio ends the process on a suffix that it does not know
            raise FileError(f"meshio cannot read it: {error or type(error).__name__}") from error
        return cls(mesh, path.suffix, options)

    @classmethod
    def of_mesh(cls, vertices, faces, suffix: str) -> MeshioFile:
        meshio = _meshio(suffix)
        return cls(meshio.Mesh(np.asarray(vertices, float), cls._blocks(faces)), suffix, {})

    @staticmethod
    def _blocks(faces) -> list[tuple[str, np.ndarray]]:
        by_size: dict[int, list] = {}
        for face in faces:
            by_size.setdefault(len(face), []).append(face)
        return [({3: "triangle", 4: "quad"}.get(k, "polygon"), np.array(rows, np.int64)) for k, rows in sorted(by_size.items())]

    def _move(self, v, place):
        if self._mesh.points.dtype.kind != "f":
            self._mesh.points = self._mesh.points.astype(float)
        self._mesh.points[v] = place[: self._mesh.points.shape[1]]

    def _split(self, f, place, v, t):
        meshio, mesh = _meshio(self._suffix), self._mesh
        (block, row), face = self._cell_of[f], list(self.faces[f])
        face.insert(place + 1, v)
        cells = [(b.type, np.asarray(b.data)) for b in mesh.cells]
        data = {name: [np.asarray(x) for x in values] for name, values in mesh.cell_data.items()}
        cells.append(("polygon" if len(face) > 4 else "quad", np.array([face])))
        cells[block] = cells[block][0], np.delete(cells[block][1], row, axis=0)
        for values in data.values():
            values.append(values[block][row : row + 1])
            values[block] = np.delete(values[block], row, axis=0)
        self._cell_of = [(b, k - (b == block and k > row)) for b, k in self._cell_of]
        self._cell_of[f] = len(cells) - 1, 0
        if not len(cells[block][1]):
            del cells[block]
            for values in data.values():
                del values[block]
            self._cell_of = [(b - (b > block), k) for b, k in self._cell_of]
        self._mesh = meshio.Mesh(mesh.points, cells, point_data=mesh.point_data, cell_data=data, field_data=mesh.field_data)

    def _append(self, fill, faces, near, around):
        meshio, mesh = _meshio(self._suffix), self._mesh
        dtype = mesh.points.dtype if mesh.points.dtype.kind == "f" else float
        points = np.concatenate([mesh.points, np.asarray(fill.vertices, dtype)[:, : mesh.points.shape[1]]])
        point_data = {}
        for name, values in mesh.point_data.items():
            new = values[near]
            if name.lower() in ("normal", "normals") and new.shape == fill.normals.shape:
                new = fill.normals.astype(values.dtype)
            point_data[name] = np.concatenate([values, new])
        blocks = self._blocks(faces)
        cell_data = {}
        for name, values in mesh.cell_data.items():
            like = None
            if len(around):
                rows = [np.asarray(values[b])[k] for b, k in (self._cell_of[f] for f in around)]
                like = rows[[row.tobytes() for row in rows].index(_most(row.tobytes() for row in rows))]
            else:
                like = np.zeros_like(np.asarray(values[0])[0])
            cell_data[name] = [*values, *(np.repeat(like[None], len(rows), axis=0) for _, rows in blocks)]
        self._mesh = meshio.Mesh(
            points, [*mesh.cells, *blocks], point_data=point_data, cell_data=cell_data, field_data=mesh.field_data
        )

    def _save(self, path):
        meshio = _meshio(self._suffix)
        options = dict(self._options)
        form = options.pop("file_format", None) or meshio.extension_to_filetypes.get(self._suffix.lower(), [""])[0]
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                meshio.write(path, self._mesh, file_format=form, **options)
        except OSError:
            raise
        except (Exception, SystemExit) as error:
            raise FileError(f"meshio cannot write {self._suffix} files of this kind: {error or type(error).__name__}") from error


# ---------------------------------------------------------------------------------------------------- by name

_OWN = {".obj": ObjFile, ".off": OffFile, ".ply": PlyFile, ".stl": StlFile}


def read(path) -> MeshFile:
    """Reads a mesh file, the format by its suffix.

    Raises:
        FileError: says what is wrong.
    """
    path = Path(path)
    try:
        own = _OWN.get(path.suffix.lower())
        return own(path.read_bytes()) if own else MeshioFile.of_path(path)
    except FileError as error:
        raise FileError(f"{path} cannot be read. {error}") from error
    except OSError as error:
        raise FileError(f"{path} cannot be read: {error.strerror or error}") from error


def converted(mesh: MeshFile, suffix: str) -> MeshFile:
    """The same vertices and faces in the format of another suffix; all else stays behind."""
    own = _OWN.get(suffix.lower())
    return own.of_mesh(mesh.vertices, mesh.faces) if own else MeshioFile.of_mesh(mesh.vertices, mesh.faces, suffix)
