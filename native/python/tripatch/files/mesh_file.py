"""A mesh file in memory, of any format."""

from __future__ import annotations

from collections.abc import Hashable
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Array
from .continued import Continued
from .writing import FileError, write_over

#: How well a vertex is known, one standard deviation in units of the mesh; called as Blender's attribute.
DEVIATION = "deviation"
NOT_KNOWN = -1.0  # in place of a deviation


class MeshFile:
    """A mesh file in memory.

    Attributes:
        vertices: (n, 3) float64, the file's own.
        faces: index lists, the file's own, three corners or more each. What has fewer stays in the file, unread.
        deviation: (n,) how well the vertices are known, below 0 where nobody knows; None: the file does not say.
    """

    deviation: Array | None = None

    def __init__(self, vertices: Array, faces: list[Any]) -> None:
        self.vertices = vertices
        self.faces = faces
        self._added = 0  # vertices
        sizes = np.fromiter(map(len, faces), np.int64, len(faces))
        try:
            corners = np.fromiter((v for face in faces for v in face), np.int64, int(sizes.sum()))
        except OverflowError:
            raise FileError(f"A face names a vertex far beyond those that exist; there are {len(vertices)}") from None
        if corners.size and (corners.min() < 0 or corners.max() >= len(vertices)):
            place = int(np.argmax((corners < 0) | (corners >= len(vertices))))
            face = int(np.searchsorted(np.cumsum(sizes), place, "right"))
            raise FileError(f"Face {face} names a vertex that does not exist; there are {len(vertices)}")
        self._sizes, self._corners = sizes, corners
        self._by_vertex: tuple[Array, Array] | None = None

    def append(self, fill: Any) -> None:
        """Adds a `tripatch.Fill` of this mesh (one of several, in any order)."""
        n = len(self.vertices)
        faces = [[v if v < n else v + self._added for v in face] for face in fill.faces]
        for v, place in zip(*fill.moved):
            self._move(int(v), place)
        self._append(fill, faces, Continued(self.vertices, self.faces, fill, self._look, self._faces_at))
        for k, ((a, b), t) in enumerate(zip(*fill.split_edges)):
            for f in set(self._faces_at(a)) & set(self._faces_at(b)):
                face = self.faces[f]
                for place, ends in enumerate(zip(face, face[1:] + face[:1])):
                    if set(ends) == {a, b}:
                        self._split(int(f), place, n + self._added + k, t if ends[0] == a else 1 - t)
                        face.insert(place + 1, n + self._added + k)
                        break
        self._added += len(fill.vertices)

    def with_deviation(self) -> MeshFile:
        """The same file with a number `deviation` at every vertex, 0 where it had none; fills that are added write theirs there.

        Raises:
            FileError: files of this format have no place for it.
        """
        raise FileError("Only PLY files hold the deviation of their vertices; give OUT a name that ends in .ply")

    def write(self, path: Path) -> None:
        """Writes the file as it was, with the fills added, in the format of the file that was read."""
        write_over(Path(path), self._save)

    def _move(self, v: int, place: Array) -> None:
        """The file's own vertex v goes to another place."""
        raise NotImplementedError

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        """The file's own face f gets the new vertex v after its corner `place`, the part t of the way to the next."""
        raise NotImplementedError

    def _look(self, f: int) -> Hashable:
        """What the file says of its own face f as a whole (material, group, ...): new faces have what a face beside them has."""
        return None

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        raise NotImplementedError

    def _save(self, path: Path) -> None:
        raise NotImplementedError

    def _faces_at(self, v: int) -> list[int]:
        """The file's own faces at its own vertex v."""
        if self._by_vertex is None:
            order = np.argsort(self._corners, kind="stable")
            starts = np.searchsorted(self._corners[order], np.arange(len(self.vertices) + 1))
            self._by_vertex = starts, np.repeat(np.arange(len(self.faces)), self._sizes)[order]
        starts, faces = self._by_vertex
        found: list[int] = faces[starts[v] : starts[v + 1]].tolist()
        return found
