"""What the picture of a filled hole needs: the fill and the faces around it."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import _arrays
from .._types import Array, ArrayLike
from ..errors import Refusal

#: Rings of faces around the rim that a picture shows.
_RINGS = 3


def around(faces: Any, rim: ArrayLike, count: int) -> list[Any]:
    """The faces within some rings of the rim, of a mesh with `count` vertices."""
    near = np.zeros(count, bool)
    near[np.asarray(rim)] = True
    offsets, corners = _arrays.faces(faces)
    if not len(corners):
        return []
    for _ in range(_RINGS):
        chosen = np.logical_or.reduceat(near[corners], offsets[:-1])
        near[corners[np.repeat(chosen, np.diff(offsets))]] = True
    rows = _arrays.Rows(offsets, corners)
    return [rows[f] for f in np.flatnonzero(chosen)]


def of_parts(vertices: Array, shown: list[Any], filled: list[Any]) -> dict[str, Any]:
    """A picture's data: faces around, faces of the fill, over vertices that they share."""
    used = np.unique(np.array([v for face in (*shown, *filled) for v in face], np.int64))
    place = {int(v): k for k, v in enumerate(used)}

    def renumbered(faces: Any) -> Any:
        return [[place[int(v)] for v in face] for face in faces]

    return {"vertices": vertices[used], "around": renumbered(shown), "fill": renumbered(filled)}


def of_fill(vertices: Array, faces: Any, fill: Any) -> dict[str, Any] | None:
    """Of a Fill; None of a Refusal."""
    if isinstance(fill, Refusal):
        return None
    points = np.concatenate([vertices, fill.vertices])
    points[fill.moved[0]] = fill.moved[1]
    return of_parts(points, around(faces, fill.rim, len(vertices)), fill.faces)
