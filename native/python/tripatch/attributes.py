"""What the new vertices of a fill take over from the rim, and normals: arrays in, arrays out."""

from __future__ import annotations

import numpy as np

from . import _arrays, _native
from ._native import AttributeWeights


def _parameters(value, name: str) -> np.ndarray:
    a = np.asarray(value)
    if a.dtype.kind not in "fiu":
        raise TypeError(f"{name} must be an array of numbers, not of {a.dtype}")
    if a.ndim != 2 or a.shape[1] not in (2, 3):
        raise ValueError(f"{name} must have shape (k, 3), barycentric, or (k, 2), in a plane domain, not {a.shape}")
    a = np.ascontiguousarray(a, dtype=np.float64)
    if not np.isfinite(a).all():
        raise ValueError(f"{name} must be finite")
    return a


def attribute_weights(rim, inside=None) -> AttributeWeights:
    """How values that are given along the rim are continued to the points inside: the weights of UVs, colors, vertex groups.

    Values are given at both ends of every rim edge, since two edges may disagree at their common vertex, as at a UV seam: end
    2 e is the start of the edge from rim vertex e to the next, 2 e + 1 its end. Along an edge they are linear; linear functions
    of the parameters come back.

    Args:
        rim: a `Fill`; or parameters of the rim's vertices from corner 0 on: barycentric (r, 3), or places in a plane domain
            (r, 2).
        inside: with the latter, the parameters (k, 3) or (k, 2) of the points.

    Returns:
        An `AttributeWeights` w: w(values) is (k, d) from values (2 r, d); w.ends and w.weights (k, m), w.nearest (k,). Over a
        triangle Nielson's side-vertex interpolant (1979), 12 terms a point; over a plane domain mean value coordinates (Floater
        2003), 2 r terms.
    """
    if inside is None:
        fill = rim
        rim, inside = (fill.rim_barycentric, fill.barycentric) if fill.uv is None else (fill.rim_uv, fill.uv)
    return AttributeWeights(_parameters(rim, "rim"), _parameters(inside, "inside"))


def _call(self: AttributeWeights, values) -> np.ndarray:
    """Values (k, d) at the points from values (2 r, d) at the ends of the rim edges."""
    a = np.asarray(values)
    if a.dtype.kind not in "fiu":
        raise TypeError(f"values must be an array of numbers, not of {a.dtype}")
    if a.ndim != 2:
        raise ValueError(f"values must have shape (2 r, d), not {a.shape}")
    return self._blend(np.ascontiguousarray(a, dtype=np.float64))


AttributeWeights.__call__ = _call


def vertex_normals(vertices, faces, corner_normals=None) -> np.ndarray:
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


def angles(a, b) -> np.ndarray:
    """Angles between vectors, row by row, by atan2: exact where they are small. 0 where one of two vectors is zero.

    Args:
        a, b: (k, 3), of any length.

    Returns:
        (k,) in degrees.
    """
    a, b = _arrays.points(a, "a"), _arrays.points(b, "b")
    if a.shape != b.shape:
        raise ValueError(f"a and b must have the same shape, not {a.shape} and {b.shape}")
    return _native._angles(a, b)
