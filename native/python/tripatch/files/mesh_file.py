"""A mesh file in memory, of any format."""

from __future__ import annotations

import copy
import tempfile
from collections.abc import Hashable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .. import _arrays, words
from .._types import Array
from ..messages import Message
from . import evidence
from .continued import Continued
from .writing import FileError, write_over

#: How well a vertex is known, one standard deviation in units of the mesh; called as Blender's attribute.
DEVIATION = "deviation"
NOT_KNOWN = -1.0  # in place of a deviation


class MeshFile:
    """A mesh with the file that it was read from. `tripatch.read` makes it, `fill_holes` fills it, and `tripatch.write` writes
    all that the file had, unchanged, and the fills.

    Attributes:
        vertices: (n, 3) float64, read-only: to change a mesh, write other vertices and faces.
        faces: index lists of three corners or more, made when they are asked for; NumPy takes faces of one size as an array.
            What has fewer corners stays in the file, unread.
        deviation: (n,) standard deviation of the vertices, below 0 where it is not known; None: the file does not say.
        suffix: of the format, such as ".ply".
    """

    suffix = ""

    def __init__(self, vertices: Array, faces: Any) -> None:
        """faces: an (m, 3) or (m, 4) array, index lists, or corners after their offsets or the size of all faces."""
        self.vertices = vertices.view()
        self.vertices.flags.writeable = False
        try:
            if isinstance(faces, np.ndarray) and faces.ndim == 2 and faces.dtype.kind in "iu":
                faces = faces.shape[1], faces.astype(np.int64, copy=False).reshape(-1)
            offsets, corners = faces if isinstance(faces, tuple) else _arrays.faces(faces)
        except (OverflowError, TypeError):
            raise FileError(Message("face_without_vertex", {"name": "faces"})) from None
        self.faces = _arrays.Rows(offsets, corners)
        if corners.size and (corners.min() < 0 or corners.max() >= len(vertices)):
            place = int(np.argmax((corners < 0) | (corners >= len(vertices))))
            face = int(np.searchsorted(self.faces.offsets, place, "right")) - 1
            raise FileError(Message("face_without_vertex", {"face": face}))
        self._added = 0  # vertices
        self._marks, self._number = False, 0  # whether fills are distinguished, and how many there are
        self._about: list[dict[str, Any]] = []  # of each that was added
        self._joined: Any = None
        self._hashes: dict[int, tuple[Any, str]] = {}
        self._split_faces: dict[int, list[int]] = {}
        self._face_of_edge: dict[tuple[int, int], int] = {}
        self._by_vertex: tuple[Array, Array] | None = None
        self._also_at: dict[int, list[int]] = {}  # faces that got a vertex within an edge

    def __repr__(self) -> str:
        said = f"{words.counted(len(self.vertices), 'vertex')}, {words.counted(len(self.faces), 'face')}"
        return f"<tripatch.MeshFile {self.suffix}: {said}>"

    @property
    def deviation(self) -> Array | None:
        """(n,) standard deviation of the vertices, below 0 where it is not known; None: the file does not say."""
        return None

    @property
    def fill_faces(self) -> Array:
        """(m,) bool: which faces are fills by TriPatch, as far as files of this format say so."""
        return self._last_faces(0)

    def _last_faces(self, count: int) -> Array:
        found = np.zeros(len(self.faces), bool)
        found[max(len(found) - count, 0) :] = True
        return found

    def join(self, joined: Any) -> None:
        """Changes what `join` of `fill_all` changes in the mesh (`Fills.joined`), before fills are added."""
        self.vertices = self.vertices.copy()
        self.vertices[joined.moved[0]] = joined.moved[1]
        self.vertices.flags.writeable = False
        self._join(joined)
        self._joined = joined

    def _join(self, joined: Any) -> None:
        for v, place in zip(*joined.moved):
            self._move(int(v), place)
        last, reach = None, 1.0
        for f, corner, v, t in reversed(joined.splits):
            reach = 1.0 if (f, corner) != last else reach
            face = self._split_faces.setdefault(f, list(self.faces[f]))
            self._split(f, corner, v, t / reach)
            face.insert(corner + 1, v)
            self._also_at.setdefault(v, []).append(f)
            last, reach = (f, corner), t

    def append_all(self, fills: Sequence[Any]) -> None:
        """Adds `tripatch.Fill` objects of this mesh."""
        self._find_edges([fill.rim for fill in fills])
        for fill in fills:
            self.append(fill)

    def _find_edges(self, rims: Sequence[Array]) -> None:
        """Looks up the faces at the edges of many rims at once."""
        if not rims or not len(self.faces):
            return
        at_rim = np.zeros(len(self.vertices), bool)
        at_rim[np.concatenate([np.asarray(rim, np.int64) for rim in rims])] = True
        offsets, corners = self.faces.offsets, self.faces.corners
        places = np.flatnonzero(at_rim[corners])
        owner = np.searchsorted(offsets, places, "right") - 1
        after = places + 1
        last = after == offsets[owner + 1]
        after[last] = offsets[owner[last]]
        a, b = corners[places], corners[after]
        both = at_rim[b]
        ends = np.sort(np.column_stack([a, b])[both], axis=1).tolist()
        faces = owner[both].tolist()
        for k in range(len(faces) - 1, -1, -1):  # of several the first
            self._face_of_edge[ends[k][0], ends[k][1]] = faces[k]

    def append(self, fill: Any) -> None:
        """Adds a `tripatch.Fill` of this mesh (one of several, in any order)."""
        n = len(self.vertices)
        if self._marks:
            self._number += 1
            self._about.append({"fill": self._number, **evidence.about(fill, self._hashes)})
        faces = [[v if v < n else v + self._added for v in face] for face in _arrays.index_lists(fill.faces)]
        for v, place in zip(*fill.moved):
            self._move(int(v), place)
        self._append(
            fill, faces, Continued(self.vertices, self._face_by_now, fill, self._look, self._faces_at, self._face_of_edge)
        )
        for k, ((a, b), t) in enumerate(zip(*fill.split_edges)):
            for f in set(self._faces_at(a)) & set(self._faces_at(b)):
                face = self._face_by_now(f)
                for place, ends in enumerate(zip(face, face[1:] + face[:1])):
                    if set(ends) == {a, b}:
                        self._split(int(f), place, n + self._added + k, t if ends[0] == a else 1 - t)
                        face.insert(place + 1, n + self._added + k)
                        self._split_faces[int(f)] = face
                        break
        self._added += len(fill.vertices)

    def filled(self, fills: Iterable[Any], joined: Any = None) -> MeshFile:
        """The file as it is once these `tripatch.Fill` objects of its mesh are in it. joined: as `join` takes it."""
        made = copy.deepcopy(self).marked()
        if joined:
            made.join(joined)
        made.append_all(list(fills))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, f"mesh{self.suffix}")
            made._save(path)
            return self.of_path(path)

    @classmethod
    def of_path(cls, path: Path) -> MeshFile:
        """Reads a file of this format.

        Raises:
            FileError: says what is wrong.
        """
        made: MeshFile = cls(path.read_bytes())  # type: ignore[arg-type, call-arg]
        made.suffix = path.suffix
        return made

    def marked(self) -> MeshFile:
        """The same file, which will say of each fill that is added, where the format has a place for it: its number at each of
        its faces, the method, the error estimate, a hash of the options and the version."""
        self._marks = True
        return self

    def evidence(self) -> dict[str, Any]:
        """What a report says of the fills that were added, and how to undo them where the file itself does not."""
        said: dict[str, Any] = {"fills": self._about}
        if self._joined:
            said["joined"] = self._joined.as_dict()
        pieces = self._pieces()
        if pieces is None:
            return said
        old = b"".join(old for _, old in pieces)
        return {**said, "restore": {"sha256": evidence.sha256(old), "edits": evidence.edits(pieces)}}

    def stripped(self) -> bytes:
        """The file as it was before its fills.

        Raises:
            FileError: it does not say how it was, or was changed since.
        """
        raise FileError(Message("original_not_kept", {"suffix": self.suffix, "report": 1}))

    def _pieces(self) -> list[tuple[bytes, bytes]] | None:
        """The file as it is written, in parts, each with what stood there before; None: the file itself tells."""
        return None

    def with_deviation(self) -> MeshFile:
        """The same file with a number `deviation` at every vertex, 0 where it had none; fills that are added write theirs there.

        Raises:
            FileError: files of this format have no place for it.
        """
        raise FileError(Message("option_needs", {"option": "--deviation", "needed": "OUT.ply"}))

    def write(self, path: Path) -> None:
        """Writes the file as it was, with the fills added, in the format of the file that was read."""
        write_over(Path(path), self._save)

    def _move(self, v: int, place: Array) -> None:
        """The file's own vertex v goes to another place."""
        raise NotImplementedError

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        """The file's own face f gets the vertex v after its corner `place`, the part t of the way to the next."""
        raise NotImplementedError

    def _look(self, f: int) -> Hashable:
        """What the file says of its own face f as a whole (material, group, ...): new faces have what a face next to them has."""
        return None

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        raise NotImplementedError

    def _save(self, path: Path) -> None:
        with path.open("wb") as out:
            out.writelines(new for new, _ in self._pieces() or ())

    def _face_by_now(self, f: int) -> list[int]:
        """The corners of the file's own face f, with those that split its edges."""
        return self._split_faces.get(int(f)) or self.faces[f]

    def _faces_at(self, v: int) -> list[int]:
        """The file's own faces at its own vertex v."""
        if self._by_vertex is None:
            corners = self.faces.corners
            order = np.argsort(corners, kind="stable")
            starts = np.concatenate([[0], np.cumsum(np.bincount(corners, minlength=len(self.vertices)))])
            self._by_vertex = starts, np.repeat(np.arange(len(self.faces)), np.diff(self.faces.offsets))[order]
        starts, faces = self._by_vertex
        found: list[int] = faces[starts[v] : starts[v + 1]].tolist()
        return found + self._also_at.get(v, [])
