"""Values of face corners that seams part at the rim of a hole, such as UVs, continued over the new faces."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Any

import numpy as np

from ._types import Array

#: Of the range of values along a rim: two that differ by less at one vertex are the same. Files often hold six decimals.
SAME = 1e-4
#: Steps of as-rigid-as-possible maps (Liu et al. 2008); they settle within about ten.
_STEPS = 12
#: Up to so many unknowns a dense inverse is faster than conjugate gradients.
_DENSE = 400
#: Of the right-hand side: the residual at which the conjugate gradients stop, and the most steps that they take.
_RESIDUAL, _MAX_STEPS = 1e-6, 500
#: Share of a chart's rim edges in a blended value from which on it stands for the chart.
_SHARE = 0.05
#: Of the mean scale: a smaller one is no metric but an error of blending.
_THIN = 0.05
#: Of the extents of the map over that of the hole: UVs that are denser lie at one point, to double precision.
_POINT = 1e-9

Blend = Callable[[Array], Array]


class Shares:
    """How much every vertex of a fill has of what differs from rim edge to rim edge: a border that meets the rim is continued to
    where it leaves it."""

    def __init__(self, values: Sequence[Hashable], blend: Blend, following: Array) -> None:
        """values: of each rim edge; following (r,): the next rim vertex."""
        self.kinds: list[Any] = list(dict.fromkeys(values))
        number = {kind: k for k, kind in enumerate(self.kinds)}
        self._of_edge = np.array([number[value] for value in values])
        self._shares = None
        if len(self.kinds) > 1:
            of_edges = np.eye(len(self.kinds))[self._of_edge]
            before = np.empty_like(of_edges)
            before[following] = of_edges
            self._shares = np.vstack([0.5 * (of_edges + before), blend(np.repeat(of_edges, 2, axis=0))])

    def of_face(self, at: Sequence[int]) -> int:
        """The number of the kind that a face with these vertices has most of; those of the rim come first."""
        return 0 if self._shares is None else int(self._shares[at].sum(axis=0).argmax())

    def edge_near(self, edge: int, kind: int) -> int:
        """The rim edge of that kind that is the fewest edges away."""
        if self._of_edge[edge] == kind:
            return edge
        count = len(self._of_edge)
        own = np.flatnonzero(self._of_edge == kind)
        away = np.abs(own - edge)
        return int(own[np.minimum(away, count - away).argmin()])


def seams_at(at_ends: Array, following: Array) -> Array:
    """(r,) whether a seam ends at each rim vertex. at_ends (2 r, d): values at both ends of every rim edge."""
    start, end = at_ends[::2], at_ends[1::2]
    before = np.empty_like(end)
    before[following] = end
    return np.asarray(np.abs(before - start).max(axis=1) > SAME * max(float(np.ptp(at_ends, axis=0).max()), 1e-12))


def continue_corners(
    places: Array,
    faces: Sequence[Sequence[int]],
    at_ends: Array,
    around: Sequence[tuple[Array, Array]],
    blend: Blend,
) -> list[Array] | None:
    """The values of the corners of the new faces if seams part them at the rim. Each part of the rim between two seams has a
    chart; of UVs one in which the new faces are as little distorted as the faces around.

    Args:
        places: (r + k, 3) positions of the vertices of the rim, a single loop, and of those inside.
        faces: of rows of `places`.
        at_ends: (2 r, d) the values at the start and the end of every rim edge; d = 2: UVs.
        around: for each rim edge the positions (c, 3) and values (c, d) of the corners of the face next to it.
        blend: continues values (2 r, d) at the ends of the rim edges to the vertices inside (k, d).

    Returns:
        For each face the values (c, d) of its corners; None where fewer than two seams end at the rim.
    """
    count = len(at_ends) // 2
    following = np.roll(np.arange(count), -1)
    parted = seams_at(at_ends, following)
    if parted.sum() < 2:
        return None
    part = np.cumsum(parted)
    part[part == part[-1]] = 0  # the last continues through the start of the loop
    part = np.unique(part, return_inverse=True)[1]
    shares = Shares(part.tolist(), blend, following)
    of_edge = {(k, int(following[k])): int(part[k]) for k in range(count)}
    charts = []
    for at in faces:
        own = [of_edge[pair] for pair in zip(at, [*at[1:], at[0]], strict=True) if pair in of_edge]
        charts.append(own[0] if own else shares.kinds[shares.of_face(at)])
    made: list[Array] = [np.zeros((0, 2))] * len(faces)
    for p in sorted(set(charts)):
        mine = [k for k, chart in enumerate(charts) if chart == p]
        values = _chart(places, [faces[k] for k in mine], at_ends, part == p, around, blend)
        for k in mine:
            made[k] = values[list(faces[k])]
    return made


def _jacobian(places: Array, uv: Array) -> tuple[Array, Array, float]:
    """Of the UV map of a face: its derivative (2, 3) in space, its metric (3, 3), isotropic across the face, and whether it is
    mirrored: the sign of its area in the map."""
    middle = places - places.mean(axis=0)
    left, size, axes = np.linalg.svd(middle, full_matrices=False)
    size = np.maximum(size[:2], 1e-12 * max(size[0], 1e-300))
    flat = ((uv - uv.mean(axis=0)).T @ left[:, :2]) / size  # (2, 2), along both axes
    derivative = flat @ axes[:2]
    normal = np.cross(axes[0], axes[1])
    metric = derivative.T @ derivative + abs(np.linalg.det(flat)) * np.outer(normal, normal)
    turned = np.roll(uv, -1, axis=0)
    return derivative, metric, float((uv[:, 0] * turned[:, 1] - uv[:, 1] * turned[:, 0]).sum())


def _chart(places: Array, faces: Any, at_ends: Array, mine: Array, around: Any, blend: Blend) -> Array:
    """Values (r + k, d) of one chart. Those of its rim edges stay; UVs elsewhere are as rigid as possible in the metric of the
    faces next to them, other values are blended. mine (r,): its rim edges."""
    edges, count = np.flatnonzero(mine), len(mine)
    values = _blended(at_ends, mine, blend)
    ends = np.stack([2 * edges, 2 * edges + 1], axis=1).ravel()
    at = np.stack([edges, (edges + 1) % count], axis=1).ravel()
    values[at] = at_ends[ends]
    unit, length = (float(np.ptp(a, axis=0).max()) for a in (at_ends[ends], places))
    if at_ends.shape[1] != 2 or not min(unit, length) > 0 or not np.isfinite([unit, length]).all():
        return values
    values, places = values / unit, places / length
    jacobians = {e: _jacobian(around[e][0] / length, around[e][1] / unit) for e in edges.tolist()}
    turn = np.array([-1.0 if sum(area for _, _, area in jacobians.values()) < 0 else 1.0, 1.0])
    of_edges = np.zeros((2 * count, 15))
    for e, (derivative, metric, _) in jacobians.items():
        of_edges[2 * e : 2 * e + 2] = np.concatenate([(turn[:, None] * derivative).ravel(), metric.ravel()])
    everywhere = _blended(of_edges, mine, blend)
    derivative, metric = everywhere[:, :6].reshape(-1, 2, 3), everywhere[:, 6:].reshape(-1, 3, 3)
    triangles, gradients, areas, axes = _reference(places, faces, metric)
    if not len(triangles):
        return values * unit
    first = np.einsum("tij,tkj->tik", derivative[triangles].mean(axis=1), axes)
    fixed = np.zeros(len(places), bool)
    fixed[at] = True
    return np.asarray(_as_rigid_as_possible(values * turn, fixed, triangles, gradients, areas, _rotations(first)) * turn * unit)


def _blended(at_ends: Array, mine: Array, blend: Blend) -> Array:
    """Values (r + k, d) at all vertices from those at the ends of some rim edges alone."""
    both = np.repeat(mine, 2)
    masked = np.column_stack([np.where(both[:, None], at_ends, 0), both])
    everywhere = np.vstack([0.5 * (masked[::2] + np.roll(masked[1::2], 1, axis=0)), blend(masked)])
    share = everywhere[:, -1:]
    return np.where(share > _SHARE, everywhere[:, :-1] / np.maximum(share, _SHARE), at_ends[both].mean(axis=0))


def _reference(places: Array, faces: Any, metric: Array) -> tuple[Array, Array, Array, Array]:
    """Triangles (t, 3) of faces, of quads those of both diagonals; gradients (t, 2, 3) and areas (t,) of their linear functions
    in the metric; their axes (t, 2, 3), derivatives along which are those in the metric."""
    found, normals = [], []
    for face in faces:
        at = places[list(face)]
        normal = np.cross(at, np.roll(at, -1, axis=0)).sum(axis=0)
        for k in range(len(face) if len(face) > 3 else 1):
            found.append((face[k - 1], face[k], face[(k + 1) % len(face)]))
            normals.append(normal)
    triangles = np.array(found).reshape(-1, 3)
    first, second = (places[triangles[:, k]] - places[triangles[:, 0]] for k in (1, 2))
    across = np.cross(first, second)
    area = np.linalg.norm(across, axis=1)
    good = (area > 1e-9 * (first**2).sum(axis=1)) & ((across * np.array(normals).reshape(-1, 3)).sum(axis=1) > 0)
    triangles, first, second, across, area = (each[good] for each in (triangles, first, second, across, area))
    u = first / np.linalg.norm(first, axis=1, keepdims=True)
    v = np.cross(across / area[:, None], u)
    plane = np.stack([u, v], axis=1)
    own = np.einsum("tij,tjk,tlk->til", plane, metric[triangles].mean(axis=1), plane)
    size, vectors = np.linalg.eigh(0.5 * (own + own.transpose(0, 2, 1)))
    scale = float(np.median(np.sqrt(np.maximum(size, 0)))) if len(size) else 0.0
    if scale < _POINT:
        return triangles[:0], plane[:0], area[:0], plane[:0]
    root = np.maximum(np.sqrt(np.maximum(size, 0)), _THIN * scale)
    to_metric = np.einsum("tij,tj,tkj->tik", vectors, root, vectors)
    edges = np.stack([np.einsum("tij,tj->ti", plane, each) for each in (first, second)], axis=1)
    edges = np.einsum("tij,tkj->tki", to_metric, edges)
    hats = np.array([[-1.0, 1, 0], [-1, 0, 1]])
    gradients = np.linalg.solve(edges, np.broadcast_to(hats, (len(edges), 2, 3)))
    axes = np.einsum("tij,tjk->tik", np.linalg.inv(to_metric), plane)
    return triangles, gradients, 0.5 * np.abs(np.linalg.det(edges)), axes


def _rotations(jacobians: Array) -> Array:
    """The rotations (t, 2, 2) that are nearest to matrices."""
    angle = np.arctan2(jacobians[:, 1, 0] - jacobians[:, 0, 1], jacobians[:, 0, 0] + jacobians[:, 1, 1])
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([c, -s], axis=1), np.stack([s, c], axis=1)], axis=1)


def _as_rigid_as_possible(uv: Array, fixed: Array, triangles: Array, gradients: Array, areas: Array, turns: Array) -> Array:
    used = np.unique(triangles)
    free = used[~fixed[used]]
    number = np.full(len(uv), -1)
    number[free] = np.arange(len(free))
    local = areas[:, None, None] * np.einsum("tki,tkj->tij", gradients, gradients)
    rows, columns = np.repeat(triangles, 3, axis=1).ravel(), np.tile(triangles, (1, 3)).ravel()
    inner = (number[rows] >= 0) & (number[columns] >= 0)
    known = (number[rows] >= 0) & (number[columns] < 0)
    entries = local.reshape(-1)
    pinned = np.zeros((len(free), 2))
    np.add.at(pinned, number[rows[known]], entries[known, None] * uv[columns[known]])
    keys, place = np.unique(number[rows[inner]] * len(free) + number[columns[inner]], return_inverse=True)
    matrix = _Sparse(keys // max(len(free), 1), keys % max(len(free), 1), np.bincount(place, entries[inner]), len(free))
    uv, corners = uv.copy(), triangles.ravel()
    wanted = number[corners] >= 0
    for _ in range(_STEPS if len(free) else 0):
        push = areas[:, None, None] * np.einsum("tki,tjk->tij", gradients, turns)
        right = -pinned
        np.add.at(right, number[corners[wanted]], push.reshape(-1, 2)[wanted])
        uv[free] = matrix.solve(right, uv[free])
        turns = _rotations(np.einsum("tki,tij->tjk", gradients, uv[triangles]))
    return uv


class _Sparse:
    """A symmetric positive matrix whose entries are sorted by row and column; every row has some."""

    def __init__(self, rows: Array, columns: Array, entries: Array, count: int) -> None:
        self._columns, self._entries = columns, entries[:, None]
        self._starts = np.searchsorted(rows, np.arange(count))
        diagonal = np.ones(count)
        diagonal[rows[rows == columns]] = entries[rows == columns]
        self._diagonal = np.maximum(diagonal, 1e-300)[:, None]
        self._inverse: Array | None = None
        if count <= _DENSE:
            dense = np.zeros((count, count))
            dense[rows, columns] = entries
            self._inverse = np.linalg.pinv(dense, hermitian=True)  # nothing may hold a part of a chart

    def __matmul__(self, x: Array) -> Array:
        return np.add.reduceat(self._entries * x[self._columns], self._starts, axis=0)

    def solve(self, right: Array, x: Array) -> Array:
        """Near x where that is free. Of many unknowns by conjugate gradients for each column, preconditioned by the diagonal."""
        residual = right - self @ x
        if self._inverse is not None:
            return np.asarray(x + self._inverse @ residual)
        enough = _RESIDUAL**2 * np.maximum((right**2).sum(axis=0), 1e-300)
        direction = z = residual / self._diagonal
        product = (residual * z).sum(axis=0)
        for _ in range(_MAX_STEPS):
            if ((residual**2).sum(axis=0) <= enough).all():
                break
            along = self @ direction
            step = product / np.maximum((direction * along).sum(axis=0), 1e-300)
            x, residual = x + step * direction, residual - step * along
            z = residual / self._diagonal
            before, product = product, (residual * z).sum(axis=0)
            direction = z + product / np.maximum(before, 1e-300) * direction
        return x
