"""What the new vertices of a fill take over from the rim, and normals: arrays in, arrays out."""

from __future__ import annotations

import math
import operator
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import _arrays, _native
from ._native import AttributeWeights
from ._types import Array, ArrayLike, Faces
from .errors import WrongValue, wrong_shape
from .messages import Message


def _parameters(value: Any, name: str) -> Array:
    shapes = "(k, 3) | (k, 2)"
    a = _arrays.numbers(value, name, shapes)
    if a.ndim != 2 or a.shape[1] not in (2, 3):
        raise wrong_shape(name, shapes, a.shape)
    a = np.ascontiguousarray(a, dtype=np.float64)
    if not np.isfinite(a).all():
        raise WrongValue(Message("not_finite", {"name": name}))
    return a


def attribute_weights(rim: Any, inside: ArrayLike | None = None, loops: Sequence[int] = ()) -> AttributeWeights:
    """How values that are given along the rim are continued to the points inside: the weights of UVs, colors, vertex groups.

    Values are given at both ends of every rim edge, since two edges may disagree at their common vertex, as at a UV seam. End
    2 e is the start of the edge from rim vertex e to the next, 2 e + 1 its end. Along an edge they are linear; linear functions
    of the parameters come back.

    Args:
        rim: a `Fill`; or parameters of the rim's vertices from corner 0 on: barycentric (r, 3), or places in a plane domain
            (r, 2).
        inside: with the latter, the parameters (k, 3) or (k, 2) of the points.
        loops: of a rim with islands, how many vertices each of its loops has; none: it is one loop.

    Returns:
        An `AttributeWeights` w: w(values) is (k, d) from values (2 r, d); w.ends and w.weights (k, m), w.nearest (k,). Over a
        triangle Nielson's side-vertex interpolant (1979), 12 terms a point; over a plane domain mean value coordinates (Floater
        2003), 2 r terms.
    """
    if inside is None:
        fill = rim
        rim, inside = (fill.rim_barycentric, fill.barycentric) if fill.uv is None else (fill.rim_uv, fill.uv)
        loops = fill.loops if len(fill.loops) > 1 else ()
    return AttributeWeights(_parameters(rim, "rim"), _parameters(inside, "inside"), [operator.index(n) for n in loops])


def _call(self: AttributeWeights, values: ArrayLike) -> Array:
    """Values (k, d) at the points from values (2 r, d) at the ends of the rim edges."""
    a = _arrays.numbers(values, "values", "(2 r, d)")
    if a.ndim != 2:
        raise wrong_shape("values", "(2 r, d)", a.shape)
    return self._blend(np.ascontiguousarray(a, dtype=np.float64))


AttributeWeights.__call__ = _call  # type: ignore[method-assign]


class CutWeights:
    """What corners and points of smoothed triangles have of the flat ones: how UVs, colors and vertex groups are continued.

    Every triangle is cut into r^2, and all is linear over it. Attributes: `edge` (r - 1, 2), what the points that cut an edge
    have of its ends, in the order of `SmoothMesh.edges`; `inside` (k, 3), what the points inside a triangle have of its corners.
    `corners` (m, 3 r^2, 3), what each corner of the new triangles has of those of the old one; `nearest` (3 m r^2,), which corner
    of the old triangles, 3 a triangle, has most of it.
    """

    edge: Array
    inside: Array
    corners: Array
    nearest: Array

    def __init__(self, smooth: _native.SmoothMesh, triangles: ArrayLike, count: int) -> None:
        """smooth: of these triangles (m, 3) among `count` vertices."""
        own = np.asarray(triangles).reshape(-1, 3)
        resolution = math.isqrt(len(smooth.faces) // len(own))
        inside = [(resolution - j - k, j, k) for j in range(1, resolution) for k in range(1, resolution - j)]
        self.inside = np.array(inside, dtype=np.float64).reshape(-1, 3) / resolution
        u = np.arange(1, resolution) / resolution
        self.edge = np.column_stack([1 - u, u])

        numbers, cuts = np.arange(len(smooth.vertices)), resolution - 1
        first_inside = count + len(smooth.edges) * cuts
        a, b, t = numbers.copy(), numbers.copy(), np.zeros(len(numbers))
        a[count:first_inside], b[count:first_inside] = np.repeat(smooth.edges, cuts, axis=0).T
        t[count:first_inside] = np.tile(u, len(smooth.edges))
        points = smooth.faces.reshape(len(own), -1)
        share = t[points][..., None]
        self.corners = (a[points][..., None] == own[:, None]) * (1 - share) + (b[points][..., None] == own[:, None]) * share
        held = points >= first_inside
        if held.any():
            self.corners[held] = self.inside[(points[held] - first_inside) % len(inside)]
        self.nearest = (self.corners.argmax(axis=2) + 3 * np.arange(len(own))[:, None]).ravel()

    def __call__(self, values: ArrayLike) -> Array:
        """Values (3 m r^2, d) at the corners of the new triangles from values (3 m, d) at those of the old ones."""
        made: Array = self.corners @ np.asarray(values).reshape(len(self.corners), 3, -1)
        return made.reshape(self.nearest.size, -1)

    def at_new_vertices(self, values: ArrayLike, edges: Any, triangles: ArrayLike) -> Array:
        """Values (k, d) at all new vertices from values (n, d) at the mesh's."""
        parts = ((self.edge, np.asarray(edges)), (self.inside, np.asarray(triangles)))
        return np.vstack([(share @ np.asarray(values)[rows]).reshape(-1, np.shape(values)[1]) for share, rows in parts])


def vertex_normals(vertices: ArrayLike, faces: Faces, corner_normals: ArrayLike | None = None) -> Array:
    """Unit normals (n, 3) of a mesh's vertices: those of the faces around, weighted by their angles (Thurmer and Wuthrich 1998).

    Args:
        vertices: (n, 3) positions.
        faces: (m, 3) or (m, 4) int array, or a list of index lists.
        corner_normals: (c, 3), one for every corner of the faces in their order, taken instead of the face's own where it is not
            zero; None: the faces' own.

    Returns:
        (n, 3); zero where a vertex has no face or the normals around cancel.
    """
    given = np.zeros((0, 3)) if corner_normals is None else _arrays.points(corner_normals, "corner_normals")
    return _native._vertex_normals(*_arrays.mesh(vertices, faces), given)


def angles(a: ArrayLike, b: ArrayLike) -> Array:
    """Angles between vectors, row by row, by atan2: exact where they are small. 0 where one of two vectors is zero.

    Args:
        a, b: (k, 3), of any length.

    Returns:
        (k,) in degrees.
    """
    a, b = _arrays.points(a, "a"), _arrays.points(b, "b")
    if a.shape != b.shape:
        raise wrong_shape("b", str(a.shape), b.shape)
    return _native._angles(a, b)
