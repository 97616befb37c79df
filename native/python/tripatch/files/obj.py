"""Wavefront OBJ."""

from __future__ import annotations

import json
import re
from array import array
from collections.abc import Hashable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Array
from . import evidence, writing
from .continued import Continued
from .mesh_file import MeshFile
from .writing import FileError

_ORIGINAL, _FILL = b"# tripatch original ", b"# tripatch fill "
_OBJ_STATE = (b"o", b"g", b"usemtl", b"s")


def _corner(v: int, texture: int, normal: int) -> bytes:
    return b"/".join(b"%d" % x if x else b"" for x in (v, texture, normal)).rstrip(b"/")


class ObjFile(MeshFile):
    """Wavefront OBJ. All bytes stay; what is new is added at the end, so that no negative index changes its meaning."""

    def __init__(self, data: bytes) -> None:
        self._new: list[bytes] = []
        # numbers by the million lie in arrays: an object for each takes several times the memory of the file
        vertices, faces = array("d"), []
        indices: list[int] = []  # one object of each for all faces
        self._extras: list[Sequence[bytes]] = []
        self._vertex_lines, self._face_lines = array("q"), array("q")  # of each the first and the end
        self._counts = array("q")  # of v, vt and vn before each face, for negative indices
        self._textures: list[list[bytes]] = []
        self._changed: dict[int, tuple[int, list[Any]]] = {}  # faces that were split: place in `new`, corners
        self._replaced: dict[int, tuple[int, bytes]] = {}  # lines by the first: the end, and what stands there instead
        self._normals = 0
        if data.startswith((b"\xff\xfe", b"\xfe\xff")):
            raise FileError("The file is UTF-16 text; save it as UTF-8")
        self._data, self._starts = data, writing.line_starts(data)
        starts, lines = self._starts, len(self._starts) - 1
        self._eol = writing.line_end([data[: starts[1]]] if lines else [])
        state: dict[bytes, bytes] = {}  # the last line of each keyword that later faces are under
        self._states, self._state_of = [state], []
        self._with_normals = False
        number = 0
        while number < lines:
            line, start = data[starts[number] : starts[number + 1]], number
            number += 1
            while line.rstrip(b"\r\n").endswith(b"\\") and number < lines:
                line = line.rstrip(b"\r\n")[:-1] + b" " + data[starts[number] : starts[number + 1]]
                number += 1
            words = (line.removeprefix(writing.BYTE_ORDER_MARK) if start == 0 else line).split()
            if not words or words[0][:1] == b"#":
                continue
            keyword = words[0]
            try:
                if keyword == b"v":
                    vertices.extend((float(words[1]), float(words[2]), float(words[3])))
                    indices.append(len(indices))
                    self._extras.append(words[4:] or ())
                    self._vertex_lines.extend((start, number))
                elif keyword == b"vn":
                    self._normals += 1
                elif keyword == b"vt":
                    self._textures.append(words[1:])
                elif keyword in (b"f", b"fo"):  # the older name
                    if b"#" in line:
                        words = line.split(b"#")[0].split()
                    face = [int(word.partition(b"/")[0]) for word in words[1:]]
                    if 0 in face:
                        raise ValueError
                    if len(face) >= 3:
                        n = len(indices)
                        faces.append([indices[v - 1] if 0 < v <= n else v - 1 if v > 0 else v + n for v in face])
                        self._state_of.append(len(self._states) - 1)
                        self._face_lines.extend((start, number))
                        self._counts.extend((n, len(self._textures), self._normals))
                        if words[1].count(b"/") == 2 and not words[1].endswith(b"/"):
                            self._with_normals = True
                elif keyword in _OBJ_STATE:
                    state = {**state, keyword: line.rstrip(b"\r\n")}
                    self._states.append(state)
            except (ValueError, IndexError):
                raise FileError(f"Line {number} cannot be understood: {line.strip().decode(errors='replace')[:60]}") from None
        self._state = state
        super().__init__(np.array(vertices).reshape(-1, 3), faces)

    @classmethod
    def of_mesh(cls, vertices: Array, faces: list[list[int]]) -> ObjFile:
        rows = [b"v " + writing.numbers(p) for p in vertices] + [
            b"f " + b" ".join(b"%d" % (v + 1) for v in face) for face in faces
        ]
        return cls(b"\n".join(rows) + b"\n")

    def _move(self, v: int, place: Array) -> None:
        start, end = self._vertex_lines[2 * v : 2 * v + 2]
        self._replaced[start] = end, writing.with_numbers(self._text(start, end), 1, [writing.number(x) for x in place])

    def _text(self, start: int, end: int) -> bytes:
        """Of lines, as it is by now."""
        return self._replaced[start][1] if start in self._replaced else self._data[self._starts[start] : self._starts[end]]

    def _look(self, f: int) -> Hashable:
        return self._state_of[f]

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        new = self._new
        if self._marks:
            if self._number == 1:
                new.append(_ORIGINAL + evidence.line({"bytes": len(self._data), "sha256": evidence.sha256(self._data)}))
            new.append(_FILL + evidence.line(self._about[-1]))
        for point, words in zip(fill.vertices, continued.words(self._extras.__getitem__)):
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
        for k in sorted(range(len(faces)), key=lambda k: self._state_of[model[k]] if model[k] >= 0 else -1):
            like = self._states[self._state_of[model[k]]] if model[k] >= 0 else {}
            if self._marks:
                like = {**like, b"g": like.get(b"g", b"g") + b" tripatch_fill_%d" % self._number}
                self._state.setdefault(b"g", b"")
            self._go_under(like)
            numbers = zip(faces[k], textures[k] if textures else [0] * len(faces[k]))
            new.append(b"f " + b" ".join(_corner(v + 1, vt, normal_of.get(v, 0)) for v, vt in numbers))

    def _new_textures(self, continued: Continued) -> list[list[int]]:
        """Writes the texture coordinates of new faces. Returns for each face the numbers of its corners; none without any."""
        values = continued.at_corners(self._texture_of) if self._textures else None
        if values is None:
            return []
        numbers: dict[bytes, int] = {}
        made = []
        for face in values:
            words = [writing.numbers(row) for row in face.tolist()]
            for word in words:
                if word not in numbers:
                    self._textures.append(word.split())
                    self._new.append(b"vt " + word)
                    numbers[word] = len(self._textures)
            made.append([numbers[word] for word in words])
        return made

    def _texture_of(self, f: int) -> Array | None:
        """Those of the corners of a face; None where one has none, or they differ in kind."""
        try:
            rows = [self._textures[corner[1] - 1] for corner in self._corners_of(f) if corner[1] > 0]
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
            start, end = self._face_lines[2 * f : 2 * f + 2]
            text, corners = self._text(start, end), self._corners_of(f)
            self._replaced[start] = end, text[text.index(b"#") :] if b"#" in text else b""
            self._go_under(self._states[self._state_of[f]])
            self._new.append(b"")
            self._changed[f] = len(self._new) - 1, corners
        at, corners = self._changed[f]
        first, second = corners[place], corners[(place + 1) % len(corners)]
        between = [v + 1, *first[1:]]
        middle = self._texture_between(first[1], second[1], t) if min(len(first), len(second)) > 1 else None
        if middle:
            self._textures.append(middle)
            between[1] = len(self._textures)
            self._new.insert(at, b"vt " + b" ".join(self._textures[-1]))
            self._changed = {g: (k + (k >= at), c) for g, (k, c) in self._changed.items()}
            at += 1
        corners.insert(place + 1, between)
        self._new[at] = b"f " + b" ".join(b"/".join(b"%d" % x if x else b"" for x in corner) for corner in corners)

    def _corners_of(self, f: int) -> list[list[int]]:
        """Of a face the numbers of each corner's vertex, texture coordinates and normal, from 1 on; 0 where there is none."""
        if f in self._changed:
            return self._changed[f][1]
        start, end = self._face_lines[2 * f : 2 * f + 2]
        corners = []
        for word in re.sub(rb"\\\r?\n", b" ", self._text(start, end)).split(b"#")[0].split()[1:]:
            parts = [int(part) if part else 0 for part in word.split(b"/")]
            corners.append([x if x >= 0 else x + n + 1 for x, n in zip(parts, self._counts[3 * f : 3 * f + 3])])
        return corners

    def _texture_between(self, first: int, second: int, t: float) -> list[bytes] | None:
        """None where one is not there or no numbers, or they differ in kind."""
        if not (0 < first <= len(self._textures) and 0 < second <= len(self._textures)):
            return None
        words = self._textures[first - 1], self._textures[second - 1]
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

    def stripped(self) -> bytes:
        """The file as it was before its fills."""
        found = re.search(rb"^" + _ORIGINAL + rb"(.*)$", self._data, re.MULTILINE)
        if not found:
            raise FileError("The file has no fills by TriPatch")
        before = json.loads(found[1])
        return evidence.original([self._data[: before["bytes"]]], before["sha256"])

    def _save(self, path: Path) -> None:
        pieces, last = [], 0
        for start, (end, text) in sorted(self._replaced.items()):
            pieces += [self._data[last : self._starts[start]], text]
            last = self._starts[end]
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
