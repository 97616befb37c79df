"""Which holes a mesh has: borders that lie on each other are joined in thought, islands belong to the hole around them."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _arrays, _native, quality
from ._types import Array
from .errors import Refusal, out_of_range
from .messages import Message
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
        self._original, self._offsets, self.corners = corners, offsets, corners
        self._stands: Array | None = None
        self.joined: Joined | None = None
        self.connected = _native.ConnectedMesh(vertices, offsets, corners)
        joined = self.connected.join_borders(join)
        if joined:
            self._offsets, self.corners, self._stands, splits = joined
            whole = Joined(vertices, self._stands, splits)
            self._original = whole.faces(offsets, corners)[1]
            changes = len(splits) or len(whole.moved[0])
            self.joined = whole if join is not None and changes else None
            self.connected = _native.ConnectedMesh(vertices, self._offsets, self.corners)
        self.mesh = vertices, self._offsets, self.corners
        borders = _lists(self.connected.borders())
        chosen = _lists(self.connected.chosen(given))
        outer = [] if given.get("outer") else _lists(self.connected.outer_borders())
        found = zip(borders, self.connected.contacts(), strict=True)
        contacts = {loop[0]: contact for loop, contact in found if contact[0] or contact[1]}
        near = [loop for loop in outer if loop[0] in contacts]
        self.outer = [loop for loop in outer if loop[0] not in contacts]
        unclosed = _lists(self.connected.unclosed())
        refused = {id(loop): _refusal(loop, contacts[loop[0]]) for loop in (*chosen, *near) if loop[0] in contacts}
        refused |= {id(chain): _not_closed(chain) for chain in unclosed}
        self.borders = [*borders, *unclosed]
        self.rims = sorted([*chosen, *near, *unclosed], key=lambda loop: (len(loop), loop))
        self.refused = {k: refused[id(loop)] for k, loop in enumerate(self.rims) if id(loop) in refused}
        self.islands: list[list[list[int]]] = [[] for _ in self.rims]
        if islands == "auto" and len(self.rims) + len(self.outer) > 1:
            self._gather_islands()
        self._edges = None if self._stands is None else self._doubled_edges()

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
        made._original, made._offsets, made._stands, made.joined, made._edges = corners, offsets, stands, None, None
        made.corners = corners if stands is None else stands[corners]
        made.mesh = vertices, offsets, made.corners
        made.connected = _native.ConnectedMesh(*made.mesh)
        made.rims, made.islands, made.outer, made.borders, made.refused = list(rims), list(islands), [], [], {}
        made._edges = None if stands is None else made._doubled_edges()
        return made

    @property
    def stands(self) -> Array | None:
        """For each vertex of the mesh the one that stands for it; None: all do for themselves."""
        return self._stands

    def _gather_islands(self) -> None:
        free = [k for k in range(len(self.rims)) if k not in self.refused]
        loops = [*(self.rims[k] for k in free), *self.outer]  # a piece that floats in a hole has an outer border
        inside = self.connected.islands(loops, True)[: len(free)]
        gone = {loops[i][0] for each in inside for i in each}
        for k, each in zip(free, inside, strict=True):
            self.islands[k] = [loops[i] for i in each]
        kept = [k for k, rim in enumerate(self.rims) if rim[0] not in gone]
        self.refused = {new: self.refused[k] for new, k in enumerate(kept) if k in self.refused}
        self.rims, self.islands = [self.rims[k] for k in kept], [self.islands[k] for k in kept]
        self.outer = [loop for loop in self.outer if loop[0] not in gone]

    def _doubled_edges(self) -> dict[tuple[int, int], tuple[int, int]]:
        """Of the faces at vertices that stand for others: from the edges of the joined mesh to their own vertices."""
        assert self._stands is not None
        doubled = np.zeros(len(self._stands), bool)
        doubled[self._stands[self._stands != np.arange(len(self._stands))]] = True
        of_face = np.repeat(np.arange(len(self._offsets) - 1), np.diff(self._offsets))
        edges = {}
        for f in np.unique(of_face[doubled[self.corners]]).tolist():
            first, end = self._offsets[f], self._offsets[f + 1]
            own, joined = self._original[first:end].tolist(), self.corners[first:end].tolist()
            for k in range(len(own)):
                edges[joined[k], joined[k - 1]] = own[k], own[k - 1]  # as a new face runs
        return edges

    @property
    def is_plain(self) -> bool:
        """Whether every hole is a border of the mesh by itself."""
        return self._edges is None and not self.refused and not any(self.islands)

    @property
    def outer_borders(self) -> list[Array]:
        """The outer borders that are left open, by the mesh's own vertices."""
        return [self.in_mesh(loop) for loop in self.outer]

    def in_mesh(self, loop: list[int]) -> Array:
        """A border by the mesh's own vertices: of those at one place that of the edge which starts there."""
        if self._edges is None:
            return np.array(loop, np.int64)
        pairs = zip(loop, [*loop[1:], loop[0]], strict=True)
        return np.array([self._edges.get(pair, pair)[0] for pair in pairs], np.int64)

    def brought_back(self, native: _native.Filled) -> Any:
        """A fill of the joined mesh by the mesh's own vertices: at the rim those of the faces next to it."""
        if self._edges is None:
            return native
        corners, starts = native.face_corners.copy(), native.face_offsets.tolist()
        doubled = {v for edge, own in self._edges.items() for v, w in zip(edge, own, strict=True) if v != w}
        for first, end in zip(starts, starts[1:], strict=False):
            face = corners[first:end].tolist()
            if doubled.isdisjoint(face):
                continue
            for k, v in enumerate(face):
                after, before = (v, face[(k + 1) % len(face)]), (face[k - 1], v)
                if after in self._edges:
                    corners[first + k] = self._edges[after][0]
                elif before in self._edges:
                    corners[first + k] = self._edges[before][1]
        return _Renumbered(native, corners, self.in_mesh(native.rim.tolist()))


def _lists(loops: list[Array]) -> list[list[int]]:
    return [loop.tolist() for loop in loops]


def find(vertices: Any, faces: Any, islands: str = "auto", join: float | None = None, **choosing: Any) -> Holes:
    """The holes of a mesh. choosing: options of `choose_holes`; islands, join: of `fill_all`."""
    return Holes(*_arrays.mesh(vertices, faces), checked("choose_holes", choosing), islands, join)


def islands_of(vertices: Any, faces: Any, loops: Any, parts: bool = True) -> list[list[int]]:
    """For each of some border loops the numbers of those that lie in it. parts: those of other parts of the mesh alone."""
    return _native.ConnectedMesh(*_arrays.mesh(vertices, faces)).islands(loops, parts)


class _Renumbered:
    """A fill of the core with other numbers of the mesh's vertices."""

    def __init__(self, native: _native.Filled, face_corners: Array, rim: Array) -> None:
        self._native, self.face_corners, self.rim = native, face_corners, rim

    def __getattr__(self, name: str) -> Any:
        return getattr(self._native, name)


def _not_closed(chain: list[int]) -> Refusal:
    return Refusal.of(Message("border_not_closed", {"edges": len(chain) - 1, "ends": [chain[0], chain[-1]]}, chain))


def _refusal(loop: list[int], contact: Any) -> Refusal:
    on_others, on_itself, a, b = contact
    count = on_others + on_itself
    code = "edges_on_borders" if count < len(loop) else "rim_on_borders" if on_others else "slit_without_width"
    return Refusal.of(Message(code, {"count": int(count), "edges": len(loop), "edge": [int(a), int(b)]}, loop))
