"""Wavefront OBJ."""

from __future__ import annotations

import json
import re
from collections.abc import Hashable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Array
from ..messages import Message
from . import evidence, writing
from .continued import Continued
from .lines import SPACE, Lines, rows_of
from .mesh_file import MeshFile
from .writing import FileError

_ORIGINAL, _FILL = b"# tripatch original ", b"# tripatch fill "
_OBJ_STATE = (b"o", b"g", b"usemtl", b"s")
_VERTEX, _TEXTURE, _NORMAL, _FACE, _STATE = range(1, 6)
_KINDS = {b"v": _VERTEX, b"vt": _TEXTURE, b"vn": _NORMAL, b"f": _FACE, b"fo": _FACE, **dict.fromkeys(_OBJ_STATE, _STATE)}


def _corner(v: int, texture: int, normal: int) -> bytes:
    return b"/".join(b"%d" % x if x else b"" for x in (v, texture, normal)).rstrip(b"/")


class ObjFile(MeshFile):
    """Wavefront OBJ. All bytes stay; what is new is added at the end, so that no negative index changes its meaning."""

    def __init__(self, data: bytes) -> None:
        self._new: list[bytes] = []
        self._added_textures: list[list[bytes]] = []
        self._changed: dict[int, tuple[int, list[Any]]] = {}  # faces that were split: place in `new`, corners
        self._replaced: dict[int, bytes] = {}  # what stands instead of a line
        if data.startswith((b"\xff\xfe", b"\xfe\xff")):
            raise FileError(Message("text_not_utf8"))
        self._data, self._lines = data, Lines(data, continued=True)
        end = re.search(rb"\r\n?|\n", data)
        self._eol = end[0] if end else b"\n"
        kinds = self._kinds()
        self._vertex_lines, self._texture_lines, self._normal_lines = (
            np.flatnonzero(kinds == k).astype(np.int32) for k in (_VERTEX, _TEXTURE, _NORMAL)
        )
        self._normals = len(self._normal_lines)
        self._state_lines = np.flatnonzero(kinds == _STATE)
        self._states: list[dict[bytes, bytes]] = [{}]  # the last line of each keyword that later faces are under
        for k in self._state_lines.tolist():
            self._states.append({**self._states[-1], self._lines.words(k)[0]: self._text(k).rstrip(b"\r\n")})
        self._state = self._states[-1]
        vertices = self._read_vertices()
        super().__init__(vertices, self._read_faces(np.flatnonzero(kinds == _FACE)))

    def _kinds(self) -> Array:
        """What each line is about."""
        first, second, third = self._lines.heads()
        kinds = np.zeros(len(first), np.int8)
        is_v, is_f, short = first == ord("v"), first == ord("f"), SPACE[second]
        kinds[is_v & short] = _VERTEX
        kinds[is_v & (second == ord("t")) & SPACE[third]] = _TEXTURE
        kinds[is_v & (second == ord("n")) & SPACE[third]] = _NORMAL
        kinds[is_f & (short | (second == ord("o")) & SPACE[third])] = _FACE  # fo: the older name
        odd = np.isin(first, np.frombuffer(b"ogus\\", np.uint8)) | SPACE[first]
        odd[:1] |= self._data.startswith(writing.BYTE_ORDER_MARK)
        for k in np.flatnonzero(odd).tolist():
            words = self._lines.words(k)
            word = words[0].removeprefix(writing.BYTE_ORDER_MARK if k == 0 else b"") if words else b""
            kinds[k] = _KINDS.get(word, 0)
        return kinds

    def _read_vertices(self) -> Array:
        lines = self._vertex_lines
        made = np.full((len(lines), 3), np.nan)
        left = np.ones(len(lines), bool)
        self._has_extras = False
        for chosen, numbers, _ in self._lines.table(lines, b"v"):
            if numbers.shape[1] >= 3:
                at = np.searchsorted(lines, chosen) if len(chosen) < len(lines) else slice(None)
                made[at], left[at] = numbers[:, :3, 0], False
                self._has_extras |= numbers.shape[1] > 3
        for v in np.flatnonzero(left).tolist():
            words = self._words(lines[v])
            try:
                made[v] = float(words[1]), float(words[2]), float(words[3])
            except (ValueError, IndexError):
                raise self._cannot(lines[v]) from None
            self._has_extras |= len(words) > 4
        return made

    def _read_faces(self, lines: Array) -> tuple[Any, Array]:
        """Offsets, or the size of all, and corners. Sets the line of each face."""
        sizes = np.zeros(len(lines), np.int64)
        found: list[tuple[Array, Array]] = []
        left = np.ones(len(lines), bool)
        self._with_normals = False
        for chosen, numbers, _ in self._lines.table(lines, b"fo", np.int64):
            at = np.searchsorted(lines, chosen)
            found.append((at, numbers[:, :, 0].copy()))
            sizes[at], left[at] = numbers.shape[1], False
            self._with_normals |= numbers.shape[2] == 3 or self._lines.words(chosen[0])[1].count(b"/") == 2
        for f in np.flatnonzero(left).tolist():
            words = self._words(lines[f])
            try:
                face = [int(word.partition(b"/")[0]) for word in words[1:]]
                corners = np.array([face], np.int64)
            except (ValueError, OverflowError):
                raise self._cannot(lines[f]) from None
            found.append((np.array([f]), corners))
            sizes[f] = len(face)
            self._with_normals |= len(face) >= 3 and words[1].count(b"/") == 2 and not words[1].endswith(b"/")
        kept = sizes >= 3
        number = np.cumsum(kept) - 1
        groups = []
        for at, rows in found:
            if (rows == 0).any():
                raise self._cannot(lines[at[int(np.argmax((rows == 0).any(axis=1)))]])
            if rows.shape[1] >= 3:
                before = np.searchsorted(self._vertex_lines, lines[at])[:, None] if (rows < 0).any() else 0
                rows += np.where(rows > 0, -1, before)
                groups.append((number[at], rows))
        self._face_lines = lines[kept].astype(np.int32)
        return rows_of(sizes[kept], groups)

    def _words(self, k: int) -> list[bytes]:
        """The words of a line with its keyword, without a comment in a face."""
        words = self._lines.words(k)
        if words[0].endswith((b"f", b"fo")) and any(b"#" in word for word in words):
            return b" ".join(words).split(b"#")[0].split()
        return words

    def _cannot(self, k: int) -> FileError:
        end = int(self._lines.starts[k + 1])
        number = len(re.findall(rb"\r\n?|\n", self._data[:end])) + (not self._data[:end].endswith((b"\n", b"\r")))
        text = self._lines.text(k).strip().decode(errors="replace")[:60]
        return FileError(Message("line_unreadable", {"line": number, "text": text}))

    def _extra(self, v: int) -> Sequence[bytes]:
        """What the file says of a vertex beyond its place."""
        return self._lines.words(self._vertex_lines[v])[4:] if self._has_extras else ()

    def _texture_count(self) -> int:
        return len(self._texture_lines) + len(self._added_textures)

    def _texture(self, k: int) -> list[bytes]:
        """The words of texture coordinates."""
        old = len(self._texture_lines)
        return self._lines.words(self._texture_lines[k])[1:] if k < old else self._added_textures[k - old]

    def _state_of(self, f: int) -> int:
        """The number of the state that a face is under."""
        return int(np.searchsorted(self._state_lines, self._face_lines[f]))

    @classmethod
    def of_mesh(cls, vertices: Array, faces: list[list[int]]) -> ObjFile:
        rows = [b"v " + writing.numbers(p) for p in vertices] + [
            b"f " + b" ".join(b"%d" % (v + 1) for v in face) for face in faces
        ]
        return cls(b"\n".join(rows) + b"\n")

    def _move(self, v: int, place: Array) -> None:
        k = int(self._vertex_lines[v])
        self._replaced[k] = writing.with_numbers(self._text(k), 1, [writing.number(x) for x in place])

    def _text(self, k: int) -> bytes:
        """A line as it is by now."""
        return self._replaced[k] if k in self._replaced else self._lines.text(k)

    def _look(self, f: int) -> Hashable:
        return self._state_of(f)

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        new = self._new
        if self._marks:
            if self._number == 1:
                new.append(_ORIGINAL + evidence.line({"bytes": len(self._data), "sha256": evidence.sha256(self._data)}))
            new.append(_FILL + evidence.line(self._about[-1]))
        for point, words in zip(fill.vertices, continued.words(self._extra)):
            new.append(b" ".join([b"v", writing.numbers(point), *words]))
        normal_of = {}
        if self._with_normals:
            first = len(self.vertices) + self._added
            corners = [*map(int, fill.rim), *range(first, first + len(fill.vertices))]
            for v, normal in zip(corners, np.concatenate([fill.rim_normals, fill.normals])):
                self._normals += 1
                normal_of[v] = self._normals
                new.append(b"vn " + writing.numbers(normal))
        textures = self._new_textures(continued)
        model = continued.model or [-1] * len(faces)
        for k in sorted(range(len(faces)), key=lambda k: self._state_of(model[k]) if model[k] >= 0 else -1):
            like = self._states[self._state_of(model[k])] if model[k] >= 0 else {}
            if self._marks:
                like = {**like, b"g": like.get(b"g", b"g") + b" tripatch_fill_%d" % self._number}
                self._state.setdefault(b"g", b"")
            self._go_under(like)
            numbers = zip(faces[k], textures[k] if textures else [0] * len(faces[k]))
            new.append(b"f " + b" ".join(_corner(v + 1, vt, normal_of.get(v, 0)) for v, vt in numbers))

    def _new_textures(self, continued: Continued) -> list[list[int]]:
        """Writes the texture coordinates of new faces. Returns for each face the numbers of its corners; none without any."""
        values = continued.at_corners(self._texture_of) if self._texture_count() else None
        if values is None:
            return []
        numbers: dict[bytes, int] = {}
        made = []
        for face in values:
            words = [writing.numbers(row) for row in face.tolist()]
            for word in words:
                if word not in numbers:
                    self._added_textures.append(word.split())
                    self._new.append(b"vt " + word)
                    numbers[word] = self._texture_count()
            made.append([numbers[word] for word in words])
        return made

    def _texture_of(self, f: int) -> Array | None:
        """Those of the corners of a face; None where one has none, or they differ in kind."""
        try:
            rows = [self._texture(corner[1] - 1) for corner in self._corners_of(f) if corner[1] > 0]
            values = np.array([[float(word) for word in row] for row in rows])
        except (IndexError, ValueError):
            return None
        return values if values.ndim == 2 else None

    def _go_under(self, like: dict[bytes, bytes]) -> None:
        for keyword in _OBJ_STATE:
            # without a line of that kind before them the faces around the rim have the default
            wanted = like.get(keyword, {b"g": b"g default", b"s": b"s off"}.get(keyword, b""))
            if keyword in self._state and wanted and wanted != self._state[keyword]:
                self._new.append(wanted)
                self._state = {**self._state, keyword: wanted}

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        # a face must not come before its vertices: it goes to the end, as it was
        if f not in self._changed:
            k = int(self._face_lines[f])
            text, corners = self._text(k), self._corners_of(f)
            self._replaced[k] = text[text.index(b"#") :] if b"#" in text else b""
            self._go_under(self._states[self._state_of(f)])
            self._new.append(b"")
            self._changed[f] = len(self._new) - 1, corners
        at, corners = self._changed[f]
        first, second = corners[place], corners[(place + 1) % len(corners)]
        between = [v + 1, *first[1:]]
        middle = self._texture_between(first[1], second[1], t) if min(len(first), len(second)) > 1 else None
        if middle:
            self._added_textures.append(middle)
            between[1] = self._texture_count()
            self._new.insert(at, b"vt " + b" ".join(middle))
            self._changed = {g: (k + (k >= at), c) for g, (k, c) in self._changed.items()}
            at += 1
        corners.insert(place + 1, between)
        self._new[at] = b"f " + b" ".join(b"/".join(b"%d" % x if x else b"" for x in corner) for corner in corners)

    def _corners_of(self, f: int) -> list[list[int]]:
        """Of a face the numbers of each corner's vertex, texture coordinates and normal, from 1 on; 0 where there is none."""
        if f in self._changed:
            return self._changed[f][1]
        k = self._face_lines[f]
        numbers = self._vertex_lines, self._texture_lines, self._normal_lines
        before: list[int] = []
        corners = []
        for word in self._words(int(k))[1:]:
            parts = [int(part) if part else 0 for part in word.split(b"/")]
            if min(parts) < 0 and not before:
                before = [int(np.searchsorted(lines, k)) for lines in numbers]
            corners.append([x if x >= 0 else x + n + 1 for x, n in zip(parts, before or parts, strict=False)])
        return corners

    def _texture_between(self, first: int, second: int, t: float) -> list[bytes] | None:
        """None where one is not there or no numbers, or they differ in kind."""
        if not (0 < first <= self._texture_count() and 0 < second <= self._texture_count()):
            return None
        words = self._texture(first - 1), self._texture(second - 1)
        try:
            ends = [np.array(list(map(float, each))) for each in words]
        except ValueError:
            return None
        return [writing.number(x) for x in (1 - t) * ends[0] + t * ends[1]] if len(ends[0]) == len(ends[1]) else None

    def marked(self) -> MeshFile:
        """The same file, which will name a group `tripatch_fill_K` for the faces of each fill, and say the rest in comments."""
        super().marked()
        self._number = len(re.findall(rb"^" + _FILL, self._data, re.MULTILINE))
        return self

    @property
    def fill_faces(self) -> Array:
        """(m,) bool: which faces are fills by TriPatch."""
        return self._last_faces(evidence.faces_of(re.findall(rb"^" + _FILL + rb"(.*)$", self._data, re.MULTILINE)))

    def stripped(self) -> bytes:
        """The file as it was before its fills."""
        found = re.search(rb"^" + _ORIGINAL + rb"(.*)$", self._data, re.MULTILINE)
        if not found:
            raise FileError(Message("no_fills_in_file"))
        before = json.loads(found[1])
        return evidence.original([self._data[: before["bytes"]]], before["sha256"])

    def _save(self, path: Path) -> None:
        pieces, last = [], 0
        for k, text in sorted(self._replaced.items()):
            pieces += [self._data[last : self._lines.starts[k]], text]
            last = self._lines.starts[k + 1]
        data = b"".join([*pieces, self._data[last:]])
        with path.open("wb") as out:
            out.write(data)
            if not self._new:
                return
            if data.rstrip(b"\r\n").endswith(b"\\"):
                out.write(self._eol)
            if data and not data.endswith((b"\n", b"\r")):
                out.write(self._eol)
            # a backslash that was followed by a space continued no line, and must not where it is repeated
            out.writelines(line + b" " * line.endswith(b"\\") + self._eol for line in self._new)
