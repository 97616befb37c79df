"""What shows the quality of a surface of triangles: reflection lines, curvature, angles across a seam, folds, and their colors.

Arrays in, arrays out. Only `seam_angles` loops in Python, over the edges of the seam.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _arrays, _native
from ._types import Array, ArrayLike

#: Degrees between the triangles of an edge from which on the surface counts as folded there, as in `Report.triangles_folded`.
FOLDED = 120.0
#: Degrees between two triangles from which on what lies behind their edge does not speak for the surface in front of it.
_SHARP = 40.0
#: A paraboloid over a plane has six coefficients; twice as many points leave the fit some say against noise.
_ENOUGH = 12
_FAR = 5  # triangles, from the seam inwards

#: Red, green, blue of what is as good as can be, up to what is as bad as the scale goes.
_SCALE = np.array([(0.13, 0.30, 0.85), (0.15, 0.75, 0.70), (0.95, 0.85, 0.15), (0.95, 0.45, 0.10), (0.85, 0.05, 0.10)])
#: Below zero, zero, above zero.
_SIGNED = np.array([(0.10, 0.25, 0.80), (0.45, 0.65, 0.95), (0.88, 0.88, 0.86), (0.97, 0.65, 0.40), (0.80, 0.10, 0.10)])
FOLD_COLOR = (1.0, 0.0, 0.05)
GREY = 0.75  # of what no color speaks of


def triangulated(faces: Any, vertices: ArrayLike | None = None) -> tuple[Array, Array]:
    """Triangles (t, 3), and for each triangle the number of its face (t,).

    A fan in every face; with the vertices (n, 3), quads are cut along the shorter diagonal, and concave faces and those with
    corners in a line so that no triangle is turned over.
    """
    if isinstance(faces, np.ndarray | _arrays.Rows):
        offsets, flat = _arrays.faces(faces)
        sizes = np.diff(offsets)
    else:  # of any size
        sizes = np.array([len(f) for f in faces], dtype=np.int64)
        flat = np.fromiter((v for f in faces for v in f), dtype=np.int64, count=int(sizes.sum()))
        offsets = np.concatenate([[0], np.cumsum(sizes)])
    if vertices is not None and sizes.max(initial=0) > 3:
        corners, of_face = _native._triangles_of(np.asarray(vertices, dtype=np.float64), offsets, flat)
        return corners.reshape(-1, 3), of_face
    count = np.maximum(sizes - 2, 0)
    of_face = np.repeat(np.arange(len(sizes)), count)
    step = np.arange(len(of_face)) - np.repeat(np.cumsum(count) - count, count)
    first = offsets[of_face]
    return np.column_stack([flat[first], flat[first + step + 1], flat[first + step + 2]]), of_face


def well_shaped(points: Array) -> Array:
    """(n - 2, 3) triangles of a convex polygon (n, 3), also with corners in a line: the flattest is as little flat as can be."""
    count = len(points)
    best, cut = np.full((count, count), np.inf), np.zeros((count, count), np.int64)
    for span in range(2, count):
        for i in range(count - span):
            j = i + span
            inner = points[i + 1 : j]
            edges = inner - points[i], points[j] - inner
            longest = np.maximum((edges[0] ** 2).sum(1), (edges[1] ** 2).sum(1))
            longest = np.maximum(longest, ((points[j] - points[i]) ** 2).sum())
            shape = np.linalg.norm(np.cross(*edges), axis=1) / np.maximum(longest, 1e-300)
            least = np.minimum(shape, np.minimum(best[i, i + 1 : j], best[i + 1 : j, j]))
            cut[i, j] = i + 1 + int(np.argmax(least))
            best[i, j] = least.max()
    made, left = [], [(0, count - 1)]
    while left:
        i, j = left.pop()
        if j - i > 1:
            k = int(cut[i, j])
            made.append((i, k, j))
            left += [(i, k), (k, j)]
    return np.array(made, np.int64)


def unit(vectors: Array) -> Array:
    """Rows (k, 3) of length one; what is shorter than any length stays zero."""
    made: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-30)
    return made


def triangle_normals(vertices: Array, triangles: Array) -> Array:
    """(t, 3), twice as long as the triangles are large."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    doubled: Array = np.cross(b - a, c - a)
    return doubled


def _sum_at(count: int, at: Array, values: Array) -> Array:
    """(count, d): rows of `values` added up by the number in `at`."""
    return np.column_stack([np.bincount(at, column, count) for column in values.T])


def vertex_normals(vertices: Array, triangles: Array) -> Array:
    """Unit normals (n, 3), those of the triangles around, weighted by their angles."""
    normals, total = unit(triangle_normals(vertices, triangles)), np.zeros((len(vertices), 3))
    for k in range(3):
        here = vertices[triangles[:, k]]
        a, b = vertices[triangles[:, (k + 1) % 3]] - here, vertices[triangles[:, (k + 2) % 3]] - here
        angle = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1))
        total += _sum_at(len(vertices), triangles[:, k], normals * angle[:, None])
    return unit(total)


def corner_normals(vertices: Array, triangles: Array, sharp: float = _SHARP) -> Array:
    """(t, 3, 3): at every corner the normal of its vertex, or of its triangle where they part by more than `sharp` degrees."""
    own, of_vertex = unit(triangle_normals(vertices, triangles)), vertex_normals(vertices, triangles)[triangles]
    smooth = (of_vertex * own[:, None]).sum(axis=2) > np.cos(np.radians(sharp))
    return np.where(smooth[:, :, None], of_vertex, own[:, None])


def curvatures(vertices: Array, triangles: Array, normals: Array | None = None) -> tuple[Array, Array]:
    """Mean and Gaussian curvature (n,) at the vertices, in 1 / units of the vertices; where the surface is convex, seen from the
    side that its normals point to, the mean is positive.

    In every triangle the second fundamental form that fits the differences of the normals along its edges best, then the mean
    over the triangles around, by area (Rusinkiewicz 2004, Estimating curvatures and their derivatives on triangle meshes).
    """
    normals = vertex_normals(vertices, triangles) if normals is None else normals
    doubled = triangle_normals(vertices, triangles)
    p, n = vertices[triangles], normals[triangles]
    u = unit(p[:, 2] - p[:, 1])
    v = np.cross(unit(doubled), u)
    left, right = np.zeros((len(triangles), 3, 3)), np.zeros((len(triangles), 3))
    for k in range(3):
        edge, turn = p[:, (k + 2) % 3] - p[:, (k + 1) % 3], n[:, (k + 2) % 3] - n[:, (k + 1) % 3]
        x, y = (edge * u).sum(axis=1), (edge * v).sum(axis=1)
        a, b = (turn * u).sum(axis=1), (turn * v).sum(axis=1)
        zero = np.zeros_like(x)
        first, second = np.column_stack([x, y, zero]), np.column_stack([zero, x, y])
        left += first[:, :, None] * first[:, None] + second[:, :, None] * second[:, None]
        right += a[:, None] * first + b[:, None] * second
    size = np.einsum("tii->t", left)
    left += (1e-9 * size + 1e-30)[:, None, None] * np.eye(3)  # needles and triangles without area
    form = np.linalg.solve(left, right[:, :, None])[:, :, 0]
    mean, gauss = (form[:, 0] + form[:, 2]) / 2, form[:, 0] * form[:, 2] - form[:, 1] ** 2
    area = np.linalg.norm(doubled, axis=1)
    at, count = triangles.ravel(), len(vertices)
    around = np.maximum(np.bincount(at, np.repeat(area, 3), count), 1e-30)
    return tuple(np.bincount(at, np.repeat(value * area, 3), count) / around for value in (mean, gauss))


def _edges(triangles: Array) -> tuple[Array, Array, Array]:
    """Edges of exactly two triangles: their vertices (e, 2) and the two triangles."""
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    key = ends[:, 0] * (int(triangles.max(initial=0)) + 1) + ends[:, 1]
    order = np.argsort(key, kind="stable")
    sorted_key = key[order]
    first = np.flatnonzero(np.concatenate([[True], sorted_key[1:] != sorted_key[:-1]]))
    two = first[np.diff(np.append(first, len(key))) == 2]
    a, b = order[two], order[two + 1]
    return ends[a], a % len(triangles), b % len(triangles)


def edge_angles(vertices: Array, triangles: Array) -> tuple[Array, Array]:
    """Edges between two triangles (e, 2) and the angles (e,) in degrees by which these are turned against each other."""
    if not len(triangles):
        return np.zeros((0, 2), np.int64), np.zeros(0)
    edges, f, g = _edges(triangles)
    return edges, _between(*(triangle_normals(vertices, triangles[side]) for side in (f, g)))


def _between(a: Array, b: Array) -> Array:
    """Degrees between rows, exact where they are small."""
    angle: Array = np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(axis=-1)))
    return angle


def folded(vertices: Array, triangles: Array) -> Array:
    """Whether a triangle (t,) and one next to it face more than 120 degrees apart."""
    at_fold = np.zeros(len(triangles), bool)
    if len(triangles):
        _, f, g = _edges(triangles)
        bad = _between(*(triangle_normals(vertices, triangles[side]) for side in (f, g))) > FOLDED
        at_fold[f[bad]] = at_fold[g[bad]] = True
    return at_fold


class _Around:
    """The triangles near some edges, and how they hang together."""

    def __init__(self, vertices: Array, triangles: Array, edges: Array) -> None:
        near = np.zeros(len(vertices), bool)
        near[edges] = True
        for _ in range(_FAR):
            chosen = near[triangles].any(axis=1)
            near[triangles[chosen]] = True
        self.triangles = triangles[near[triangles].any(axis=1)]
        self.normals = unit(triangle_normals(vertices, self.triangles))
        self.of_edge: dict[frozenset[int], list[int]] = {}
        for k, (a, b, c) in enumerate(self.triangles.tolist()):
            for pair in ((a, b), (b, c), (c, a)):
                self.of_edge.setdefault(frozenset(pair), []).append(k)
        self._corners = self.triangles.tolist()
        self._seam = {frozenset(e) for e in edges.tolist()}
        self._turned = self._seam | self._at_corners(vertices, edges)

    def _at_corners(self, vertices: Array, edges: Array) -> set[frozenset[int]]:
        """The edges at the vertices where the seam turns: what lies behind them goes along another side of it."""
        others: dict[int, list[int]] = {}
        for a, b in edges.tolist():
            others.setdefault(a, []).append(b)
            others.setdefault(b, []).append(a)
        turned = set()
        for v, ends in others.items():
            if len(ends) == 2:
                back, ahead = unit(vertices[ends] - vertices[v])
                if back @ ahead > -np.cos(np.radians(_SHARP)):
                    turned.add(v)
        return {pair for pair in self.of_edge if pair & turned}

    def side(self, start: int, past_corners: bool) -> tuple[list[Any], float]:
        """The vertices of one side of the seam around a triangle of it, without what lies behind sharp edges, and the cosine of
        the largest angle between two of its triangles next to each other."""
        seen, front, found = {start}, [start], set(self._corners[start])
        least, ends = 1.0, self._seam if past_corners else self._turned
        for _ in range(_FAR):
            if len(found) >= _ENOUGH:
                break
            ahead = []
            for k in front:
                a, b, c = self._corners[k]
                for pair in (frozenset((a, b)), frozenset((b, c)), frozenset((c, a))):
                    for other in () if pair in ends else self.of_edge[pair]:
                        if other not in seen and self.normals[other] @ self.normals[k] > np.cos(np.radians(_SHARP)):
                            seen.add(other)
                            ahead.append(other)
                            least = min(least, self.normals[other] @ self.normals[k])
                            found |= set(self._corners[other])
            front = ahead
        return sorted(found), least

    def angle(self, vertices: Array, a: int, b: int) -> float:
        """Degrees between the surfaces on both sides of an edge, at its middle; nan where it has not two triangles."""
        adjacent = self.of_edge.get(frozenset((a, b)), [])
        if len(adjacent) != 2:
            return float("nan")
        middle, along = (vertices[a] + vertices[b]) / 2, unit(vertices[b] - vertices[a])
        angles = []  # with what lies past corners of the seam, and without: where it is jagged there is little else
        for past_corners in (True, False):
            sides = []
            for f in adjacent:
                near, least = self.side(f, past_corners)
                sides.append(_normal_at(vertices[near], middle, along, self.normals[f], least))
            angles.append(float(_between(*sides)))
        return min(angles)

    def sharp_beyond(self, vertices: Array, end: int, before: int) -> float | None:
        """The angle of the sharp edge outside the seam that continues an edge of it straightest at its end; None without one."""
        outside = [pair for pair in self.of_edge if end in pair and pair not in self._seam]
        sharp = [
            (vertices[other] - vertices[end], other)
            for pair in outside
            for other in pair - {end}
            if len(self.of_edge[pair]) == 2 and _between(*self.normals[self.of_edge[pair]]) > _SHARP
        ]
        if not sharp:
            return None
        ahead = vertices[end] - vertices[before]
        return self.angle(vertices, end, max(sharp, key=lambda each: float(unit(each[0]) @ ahead))[1])


def _normal_at(points: Array, middle: Array, along: Array, normal: Array, least: float = -1.0) -> Array:
    """The normal at `middle` of the paraboloid over the plane of a triangle that fits points best, the near ones most. Its own
    normal where they are too few, or tell so little, as those of a strip's two edges, that it would turn farther than any two
    triangles there, whose cosine is at least `least`."""
    if len(points) < 6:
        return normal
    across, off = np.cross(normal, along), points - middle
    x, y, z = off @ along, off @ across, off @ normal
    size = np.sqrt((off**2).sum(axis=1))
    scale = max(size.min(), 1e-30)
    x, y, z = x / scale, y / scale, z / scale
    weight = 1 / (1 + (size / scale) ** 2)
    terms = np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y]) * weight[:, None]
    for count in (6, 4):  # with the curvature along the seam alone
        c = np.linalg.lstsq(terms[:, :count], z * weight, rcond=1e-6)[0]
        fitted: Array = unit(normal - c[1] * along - c[2] * across)
        if fitted @ normal >= least - 1e-12:
            return fitted
    return normal


def seam_angles(vertices: Array, triangles: Array, edges: Array) -> Array:
    """Degrees (k,) between the surfaces on both sides of each edge (k, 2) of a seam, at its middle; nan where an edge has not two
    triangles.

    Not the angle between the two triangles, which a round surface has everywhere: on each side a paraboloid is laid through the
    points near the edge, and its normal taken where the edge is. Round surfaces give zero up to the third power of the length of
    the edges. Along a crease that comes from outside the seam and leaves it again, it is the difference to that crease's angle.
    """
    edges = np.asarray(edges, dtype=np.int64).reshape(-1, 2)
    if not len(edges) or not len(triangles):
        return np.full(len(edges), np.nan)
    around = _Around(vertices, triangles, edges)
    found = np.array([around.angle(vertices, a, b) for a, b in edges.tolist()])
    apart: Array = np.abs(found - _creases(vertices, edges, found, around))
    return apart


def _creases(vertices: Array, edges: Array, angles: Array, around: _Around) -> Array:
    """For each edge (k,) of a seam the angle of the crease that runs along it from outside: at sharp edges between two vertices
    where sharp edges continue that are none of the seam."""
    had, at = np.zeros(len(edges)), dict[int, list[int]]()
    for k in np.flatnonzero(angles > _SHARP).tolist():
        for v in edges[k].tolist():
            at.setdefault(v, []).append(k)
    for start, own in at.items():
        if len(own) != 1:
            continue
        run, ends = [own[0]], [start]  # along the seam to where it is sharp no more
        while True:
            a, b = edges[run[-1]].tolist()
            ends.append(a + b - ends[-1])
            ahead = [k for k in at[ends[-1]] if k != run[-1]]
            if len(ahead) != 1:
                break
            run.append(ahead[0])
        beyond = [around.sharp_beyond(vertices, v, inside) for v, inside in ((ends[0], ends[1]), (ends[-1], ends[-2]))]
        if None not in beyond:
            length = np.linalg.norm(np.diff(vertices[ends], axis=0), axis=1)
            had[run] = np.interp(np.cumsum(length) - length / 2, (0, length.sum()), np.array(beyond, float))
    return had


def _blend(table: Array, t: Array) -> Array:
    place = np.clip(np.nan_to_num(t), 0, 1) * (len(table) - 1)
    return np.column_stack([np.interp(place, np.arange(len(table)), column) for column in table.T])


def scale_colors(values: Array, most: float) -> Array:
    """Colors (k, 3) from blue at 0 to red at `most`."""
    return _blend(_SCALE, np.asarray(values) / max(most, 1e-30))


def known_colors(values: Array, most: float) -> Array:
    """The same, but grey where a value is nan: not known."""
    colors = scale_colors(values, most)
    colors[np.isnan(values)] = GREY
    return colors


def signed_colors(values: Array, most: float) -> Array:
    """Colors (k, 3) from blue at -`most` over grey at 0 to red at `most`."""
    return _blend(_SIGNED, np.asarray(values) / max(most, 1e-30) / 2 + 0.5)


def usual(values: Array) -> float:
    """What 95 of a hundred sizes do not exceed: where a scale may end, so that a few spikes do not wash out all else."""
    sizes = np.abs(values[np.isfinite(values)])
    return float(np.quantile(sizes, 0.95)) if len(sizes) else 0.0


def stripes(normals: Array, direction: ArrayLike, density: float, toward: ArrayLike | None = None) -> Array:
    """Brightness (k,) from 0 to 1: `density` pairs of stripes from where a surface faces a direction to where it faces away.

    toward: unit vectors (k, 3) or (3,) to the eye, for the stripes of a room that the surface mirrors (zebra); None: lines of
    equal slope against the direction, which stay on the surface when the eye moves (highlight lines).
    """
    seen = normals
    if toward is not None:
        toward = np.broadcast_to(toward, normals.shape)
        seen = 2 * (normals * toward).sum(axis=-1, keepdims=True) * normals - toward
    cosine = np.clip(seen @ (np.asarray(direction, float) / max(np.linalg.norm(direction), 1e-30)), -1, 1)
    made: Array = 0.5 + 0.5 * np.sin(2 * np.pi * density * np.arccos(cosine) / np.pi)
    return made
