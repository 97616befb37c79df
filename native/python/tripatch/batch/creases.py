"""How sharply fills meet their surroundings as they are delivered: the angles between faces along the rims."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .. import _arrays
from .._types import Array


def _next(offsets: Array, corners: Array) -> Array:
    """The corner after each in its face."""
    following = np.roll(corners, -1)
    following[offsets[1:] - 1] = corners[offsets[:-1]]
    return following


def _normals(vertices: Array, offsets: Array, corners: Array, wanted: Array) -> Array:
    """Unit normals of some faces, by the area vector."""
    sizes = offsets[wanted + 1] - offsets[wanted]
    starts = np.cumsum(sizes) - sizes
    within = np.arange(int(sizes.sum())) - np.repeat(starts, sizes)
    p = vertices[corners[np.repeat(offsets[wanted], sizes) + within]]
    p = p - np.repeat(p[starts], sizes, axis=0)  # the origin is not far from a face
    after = np.roll(p, -1, axis=0)
    after[starts + sizes - 1] = 0
    normals: Array = np.add.reduceat(np.cross(p, after), starts, axis=0)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    return normals


def _at(vertices: Array, faces: Any, keys: Array, n: int) -> dict[int, Array]:
    """The normal of a face at each of some edges."""
    offsets, corners = _arrays.faces(faces)
    if not len(corners):
        return {}
    following = _next(offsets, corners)
    near = np.zeros(n, bool)  # of a large mesh few edges need be looked for
    near[keys // n] = near[keys % n] = True
    places = np.nonzero(near[corners] & near[following])[0]
    a, b = corners[places], following[places]
    key = np.minimum(a, b) * n + np.maximum(a, b)
    found = np.isin(key, keys)
    places, key = places[found], key[found]
    if not len(places):
        return {}
    owner = np.searchsorted(offsets, places, "right") - 1
    wanted, back = np.unique(owner, return_inverse=True)
    normals = _normals(vertices, offsets, corners, wanted)
    return dict(zip(key.tolist(), normals[back.reshape(-1)], strict=True))


def largest(vertices: Array, faces: Any, fills: Sequence[tuple[Array, Any, Array]]) -> list[float | None]:
    """For each fill the largest angle, in degrees, between a new face and the face across the rim; None where none is shared.

    Args:
        fills: new vertices, new faces counted on from `vertices`, and the rim.
    """
    points = np.concatenate([vertices, *(new for new, _, _ in fills)])
    n = len(points) + 1
    rims = [np.column_stack([rim, np.roll(rim, -1)]) for _, _, rim in fills]
    keys = [rim.min(axis=1) * n + rim.max(axis=1) for rim in rims]
    if not keys:
        return []
    wanted = np.concatenate(keys)
    outside = _at(vertices, faces, wanted, n)
    inside = _at(points, _together(len(vertices), fills), wanted, n)
    shared = [[e for e in edges.tolist() if e in inside and e in outside] for edges in keys]
    counts = [len(each) for each in shared]
    a, b = (np.array([found[e] for each in shared for e in each]).reshape(-1, 3) for found in (inside, outside))
    angles = np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)))
    parts = np.split(angles, np.cumsum(counts)[:-1])
    return [float(part.max()) if len(part) else None for part in parts]


def _together(count: int, fills: Sequence[tuple[Array, Any, Array]]) -> _arrays.Rows:
    """The faces of all fills, with new vertices one after another behind `count`."""
    sizes, corners, first = [np.zeros(1, np.int64)], [], count
    for new, own, _ in fills:
        offsets, flat = _arrays.faces(own)
        sizes.append(np.diff(offsets))
        corners.append(np.where(flat >= count, flat + (first - count), flat))
        first += len(new)
    return _arrays.Rows(np.cumsum(np.concatenate(sizes)), np.concatenate(corners))
