"""Edges of surfaces and meshes as curves, pieces of which may be sides of a hole."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from . import _arrays, _native
from ._native import RectangleSurface, Side
from ._types import Array, ArrayLike, Faces
from .errors import Refusal
from .messages import Message

Way = tuple[float, float]  # along a curve, by its parameter
_SHARP = np.cos(np.radians(25))  # a mesh's border turns by more than this at a corner
_POINT = 1e-12  # of the coordinates: an edge of no more extent is a point; rounding of them makes 1e-15
_LINE = 1e-9  # sine of the angle between derivatives that span no plane: a corner of a net that is drawn together
_CLOSED = 1e-6  # of the extent: ends that are nearer are one place, as corners of the library's sides
_DRAWN = 1e-7  # of a curve's parameter: a place so near to one that is drawn is that one


def place_of_nearest(among: Array, points: ArrayLike) -> Array:
    """Which of (n, 3) is nearest to each of (k, 3); in blocks, so that the table of distances stays small."""
    points = np.atleast_2d(points)
    block = max(1, 1_000_000 // len(among))
    parts = np.split(points, range(block, len(points), block))
    rows = [((among - part[:, None]) ** 2).sum(axis=2).argmin(axis=1) for part in parts]
    return np.concatenate(rows)


class Curve:
    """An edge that may hold a side of the hole, t from 0 to 1.

    Attributes:
        name: of the object.
        closed: t = 1 is t = 0 again.
        own: in the direction of t, a fill next to it faces as the object does.
        t, points: (n,) and (n, 3), where it is drawn; of a closed curve without t = 1.
    """

    name: str
    closed: bool
    own: bool
    t: Array
    points: Array

    def at(self, t: ArrayLike) -> Array:
        """(k, 3) points at t (k,); beyond 1 on a closed curve."""
        raise NotImplementedError

    def nearest(self, points: ArrayLike) -> tuple[Array, Array]:
        """Parameter and distance of the nearest place for each of (k, 3) points."""
        raise NotImplementedError

    def pieces(self, ends: Sequence[tuple[float, float]]) -> list[tuple[Side, Array]]:
        """For one piece, or two that follow each other, the Side and its parameters (0 .. 1) where the curve is drawn."""
        raise NotImplementedError


class SurfaceEdge(Curve):
    """An edge of a surface that is known exactly.

    Args:
        edges: into how many edges it is drawn, or the parameters at which it is, from 0 to 1.
        own: see `Curve`.
        origin: the surface and the number of its edge, as `Side` takes them, where they are known.
    """

    def __init__(
        self, name: str, side: Side, edges: int | Array, own: bool, origin: tuple[RectangleSurface, int] | None = None
    ) -> None:
        self.name, self.side, self.own, self.origin = name, side, own, origin
        drawn = np.linspace(0, 1, edges + 1) if np.ndim(edges) == 0 else np.asarray(edges, float)
        edges = len(drawn) - 1
        dense = np.linspace(0, 1, max(257, 8 * edges + 1))
        self._dense, (c, along, across, _) = dense, side.evaluate(dense)
        self._positions, size = c, np.ptp(c, axis=0).max()
        if not size > _POINT * np.abs(c).max(initial=0):
            raise Refusal.of(Message("surface_edge_is_point", {"name": name}))
        spanned = np.linalg.norm(np.cross(along, across), axis=1)
        if not (spanned > _LINE * np.linalg.norm(along, axis=1) * np.linalg.norm(across, axis=1)).any():
            raise Refusal.of(Message("surface_flat_to_line", {"name": name}))
        self.closed = bool(np.linalg.norm(c[-1] - c[0]) < _CLOSED * size)
        self.t = drawn[: edges + (not self.closed)]
        self.points = self.at(self.t)

    def at(self, t: ArrayLike) -> Array:
        t = np.atleast_1d(np.asarray(t, float))
        return self.side.evaluate(np.mod(t, 1.0) if self.closed else np.clip(t, 0, 1))[0]

    def nearest(self, points: ArrayLike) -> tuple[Array, Array]:
        points = np.atleast_2d(points)
        k = place_of_nearest(self._positions, points)
        step = self._dense[1]
        low, high = self._dense[k] - step, self._dense[k] + step
        if not self.closed:
            low, high = low.clip(0, 1), high.clip(0, 1)
        t = self._dense[k]
        for _ in range(12):  # Gauss-Newton: it ends quickly where the points are near, and only those count
            c, along = self.side.evaluate(np.mod(t, 1.0) if self.closed else t)[:2]
            t = t + ((points - c) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300)
            t = np.clip(t, low, high)
        # to the last bit where the place is one that is drawn, an end or the seam
        drawn = np.append(self.t, 1.0) if self.closed else self.t
        drawn = drawn[np.abs(t[:, None] - drawn).argmin(axis=1)]
        t = np.where(np.abs(t - drawn) < _DRAWN, drawn, t)
        distance = np.linalg.norm(self.at(t) - points, axis=1)
        return np.mod(t, 1.0) if self.closed else t, distance

    def pieces(self, ends: Sequence[tuple[float, float]]) -> list[tuple[Side, Array]]:
        found = []
        for start, end in ends:
            low, high = min(start, end), max(start, end)
            drawn = np.concatenate([self.t, self.t + 1]) if self.closed else self.t
            spacing = 0.25 / len(self.t)
            inside = drawn[(drawn > low + spacing) & (drawn < high - spacing)]
            t = (np.concatenate([[low], inside, [high]]) - low) / (high - low)
            whole = (start, end) == (0.0, 1.0) and not self.closed
            found.append((self.side if whole else self.side.part(start, end), t if end > start else (1 - t)[::-1]))
        return found


class MeshBorder(Curve):
    """A border of a mesh, or a chain of edges of one; sides of it start and end at vertices.

    Args:
        vertices, faces: the mesh.
        loop: vertex indices of the whole border, in the direction of new faces (`tripatch.find_holes`).
        chain: how many edges of it, from its start, may be used; None: all, and it is closed.
    """

    own = True

    def __init__(self, name: str, vertices: ArrayLike, faces: Faces, loop: ArrayLike, chain: int | None = None) -> None:
        self.name, self._mesh = name, _arrays.mesh(vertices, faces)
        self._loop = np.asarray(loop, np.int64)
        self.closed = chain is None
        self._steps = len(self._loop) if chain is None else chain  # edges
        used = self._loop[: self._steps + (not self.closed)]
        self.points = self._mesh[0][used]
        self.t = np.arange(len(used)) / self._steps

    def _vertex(self, t: ArrayLike) -> Array:
        at: Array = self._loop[np.round(np.asarray(t, float) * self._steps).astype(int) % len(self._loop)]
        return at

    def at(self, t: ArrayLike) -> Array:
        return self._mesh[0][self._vertex(np.atleast_1d(t))]

    def nearest(self, points: ArrayLike) -> tuple[Array, Array]:
        k = place_of_nearest(self.points, points)
        return self.t[k], np.linalg.norm(self.points[k] - points, axis=1)

    def corners(self) -> Array:
        """Parameters where the border turns sharply, the sharpest first."""
        along = np.roll(self.points, -1, axis=0) - self.points
        along /= np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
        straight = (along * np.roll(along, 1, axis=0)).sum(axis=1)
        if not self.closed:
            straight[[0, -1]] = 1
        sharp: Array = self.t[np.argsort(straight, kind="stable")[: np.count_nonzero(straight < _SHARP)]]
        return sharp

    def turns_within(self, way: Way) -> bool:
        """Whether the border turns sharply between the ends of a piece."""
        low, high = min(way) + 0.5 / self._steps, max(way) - 0.5 / self._steps
        return any(low < t < high or low < t + 1 < high for t in self.corners())

    def pieces(self, ends: Sequence[tuple[float, float]]) -> list[tuple[Side, Array]]:
        backwards = ends[0][1] < ends[0][0]
        steps = [int(round(t * self._steps)) for pair in (ends[::-1] if backwards else ends) for t in sorted(pair)]
        first, last, n = steps[0], steps[-1], len(self._loop)
        if len(ends) == 2:
            corners = [first, steps[1], last]
        elif n - (last - first) > 1:
            corners = [first, last, last + (n - (last - first)) // 2]
        else:
            raise Refusal.of(Message("border_too_short", {"name": self.name}))
        at = [int(self._loop[k % n]) for k in corners]
        sides, parameters, _ = _native._mesh_sides(*self._mesh, self._loop.tolist(), at)
        found = []
        for i in (2, 0)[: len(ends)]:
            side, t = sides[i], np.array(parameters[i])
            found.append((side.part(1.0, 0.0), (1 - t)[::-1]) if backwards else (side, t))
        return found[::-1] if backwards else found
