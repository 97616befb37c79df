"""Which holes a mesh has: borders that lie on each other are joined in thought, islands belong to the hole around them."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _arrays, _native, quality
from ._types import Array
from .errors import out_of_range
from .options import checked


class Joined:
    """What joining the borders of a mesh changes in it.

    Attributes:
        moved: vertices (k,) and the places (k, 3) that they go to; onto: those that are there.
        splits: (face, corner, vertex, t) of vertices that lie within edges: the face gets the vertex after this corner, t of the
            way to the next; by face, corner and t.
    """

    def __init__(self, vertices: Array, stands: Array, splits: list[tuple[int, int, int, float]]) -> None:
        """stands: for each vertex the one whose place it takes."""
        moved = np.flatnonzero((vertices[stands] != vertices).any(axis=1))
        self.moved, self.onto, self.splits = (moved, vertices[stands[moved]]), stands[moved], splits

    def as_dict(self) -> dict[str, Any]:
        """What is changed as plain values, ready for JSON: vertices that move, and vertices that faces get, as [face, vertex]."""
        return {"moved": self.moved[0].tolist(), "splits": [[f, v] for f, _, v, _ in self.splits]}

    def faces(self, offsets: Array, corners: Array) -> tuple[Array, Array]:
        """Offsets and corners of the mesh's faces with the vertices that they get."""
        face, corner, vertex = (np.array([each[k] for each in self.splits], np.int64) for k in range(3))
        sizes = np.diff(offsets) + np.bincount(face, minlength=len(offsets) - 1)
        places = offsets[face] + corner + 1
        return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64), np.insert(corners, places, vertex)

    def triangles(self, points: Array, offsets: Array, corners: Array) -> tuple[Array, Array, Array]:
        """The same with triangles cut into triangles, and the number that each face had before. points: of all vertices."""
        made, all_corners = self.faces(offsets, corners)
        cut = np.flatnonzero((np.diff(offsets) == 3) & (np.diff(made) > 3))
        sizes, of_face = np.diff(made), np.arange(len(made) - 1)
        rows = [all_corners[made[f] : made[f + 1]] for f in cut.tolist()]
        triangles = np.concatenate([row[quality.well_shaped(points[row])] for row in rows] or [np.zeros((0, 3), np.int64)])
        of_row = np.repeat(np.arange(len(rows)), [len(row) - 2 for row in rows])
        kept = np.ones(len(sizes), bool)
        kept[cut] = False
        order = np.argsort(np.concatenate([of_face[kept], cut[of_row]]), kind="stable")
        lists = np.concatenate([sizes[kept], np.full(len(triangles), 3)])[order]
        starts = np.concatenate([made[:-1][kept], len(all_corners) + 3 * np.arange(len(triangles))])[order]
        ends = np.cumsum(lists)
        places = np.repeat(starts - (ends - lists), lists) + np.arange(ends[-1] if len(ends) else 0)
        flat = np.concatenate([all_corners, triangles.reshape(-1)])[places]
        return np.concatenate([[0], ends]).astype(np.int64), flat, np.concatenate([of_face[kept], cut[of_row]])[order]


class Holes:
    """The holes of a mesh.

    Attributes:
        corners: of the faces, one after another, by vertices that stand for all at their places; mesh: with vertices and offsets.
        stands: for each vertex of the mesh the one that stands for it; None: all do for themselves.
        rims: of each hole, by such vertices; islands: of each the loops inside it.
        refused: of borders that are no holes, by their place in `rims`.
        outer: the outer borders that are left open; borders: all of them, and the chains of border edges that close to no loop,
            which are refused too.
        joined: what must change in the mesh for that; None: nothing, or borders are joined in thought only.
    """

    def __init__(self, vertices: Array, offsets: Array, corners: Array, given: Any, islands: str, join: float | None) -> None:
        """given: options of `choose_holes`."""
        if join is not None and not 0 <= join < np.inf:
            raise out_of_range("join", join, 0)
        self.corners, self.stands, self.joined, self._joined = corners, None, None, None
        self.connected = _native.ConnectedMesh(vertices, offsets, corners)
        joined = self.connected.join_borders(join)
        if joined:
            offsets, self.corners, own, self.stands, splits = joined
            whole = Joined(vertices, self.stands, splits)
            self.joined = whole if join is not None and (len(splits) or len(whole.moved[0])) else None
            self._joined = _native.JoinedMesh(offsets, self.corners, own, self.stands)
            self.connected = _native.ConnectedMesh(vertices, offsets, self.corners)
        self.mesh = vertices, offsets, self.corners
        found = self.connected.holes(given, islands == "auto")
        self.rims, self.islands, self.refused, self.outer, self.borders = found

    @classmethod
    def of_part(
        cls, vertices: Array, offsets: Array, corners: Array, rims: Any, islands: Any, stands: Array | None = None
    ) -> Holes:
        """Holes of a mesh that is a part of another one, in which they were found.

        Args:
            rims, islands: as the attributes, by the part's vertices.
            stands: for each vertex the one that stands for it.
        """
        made = object.__new__(cls)
        made.stands, made.joined, made._joined = stands, None, None
        made.corners = corners if stands is None else stands[corners]
        if stands is not None:
            made._joined = _native.JoinedMesh(offsets, made.corners, corners, stands)
        made.mesh = vertices, offsets, made.corners
        made.connected = _native.ConnectedMesh(*made.mesh)
        made.rims, made.islands, made.outer, made.borders, made.refused = list(rims), list(islands), [], [], {}
        return made

    @property
    def is_plain(self) -> bool:
        """Whether every hole is a border of the mesh by itself."""
        return self._joined is None and not self.refused and not any(self.islands)

    @property
    def outer_borders(self) -> list[Array]:
        """The outer borders that are left open, by the mesh's own vertices."""
        return [self.in_mesh(loop) for loop in self.outer]

    def in_mesh(self, loop: list[int]) -> Array:
        """A border by the mesh's own vertices: of those at one place that of the edge which starts there."""
        return np.array(loop, np.int64) if self._joined is None else self._joined.in_mesh(loop)

    def bring_back(self, native: _native.Filled) -> None:
        """A fill of the joined mesh to the mesh's own vertices: at the rim those of the faces next to it."""
        if self._joined is not None:
            self._joined.bring_back(native)


def find(vertices: Any, faces: Any, islands: str = "auto", join: float | None = None, **choosing: Any) -> Holes:
    """The holes of a mesh. choosing: options of `choose_holes`; islands, join: of `fill_all`."""
    return Holes(*_arrays.mesh(vertices, faces), checked("choose_holes", choosing), islands, join)


def islands_of(vertices: Any, faces: Any, loops: Any, parts: bool = True) -> list[list[int]]:
    """For each of some border loops the numbers of those that lie in it. parts: those of other parts of the mesh alone."""
    return _native.ConnectedMesh(*_arrays.mesh(vertices, faces)).islands(loops, parts)
