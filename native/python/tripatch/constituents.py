"""Three surfaces over one triangle, for `blend`, from surfaces and meshes at a hole.

What lies over the hole is a constituent itself. What lies next to the hole is continued into it from its border, straight.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ._native import BezierRectangle, NurbsSurface, Patch, Side
from ._types import Array
from .between import Loop, facing
from .curves import Curve, SurfaceEdge, Way
from .errors import Refusal
from .messages import Message
from .nurbs import _basis
from .surfaces import triangle_on

#: Into how many parts each edge of a side is cut where its curve is read.
_PARTS = 4
#: Into how many edges the edge of a surface is cut at least.
_LEAST = 64


def _interpolated(t: Array, values: Array) -> tuple[Array, Array]:
    """Control points (n, ...) and knots of the cubic spline with these values at t (n,), n >= 4; no knots are t[1] and t[-2]."""
    knots = np.concatenate([np.full(4, t[0]), t[2:-2], np.full(4, t[-1])])
    points: Array = np.linalg.solve(_basis(3, knots, t), values.reshape(len(t), -1)).reshape(values.shape)
    return points, knots


def _continued(sides: list[tuple[Side, Array]], i: int) -> NurbsSurface:
    """The strip from side i (v = 0) straight on in its planes (v = 1), at its ends along the other sides: read as a triangle with
    its third corner amid v = 1 it leaves the corners as these do."""
    side, t = sides[i]
    parts = max(_PARTS, -(-_LEAST // (len(t) - 1)))
    fine = np.concatenate([[t[0]], *(np.linspace(a, b, parts + 1)[1:] for a, b in zip(t[:-1], t[1:]))])
    curve, along, across, _ = side.evaluate(fine)
    before, after = (sides[k % 3][0].evaluate([end])[1][0] for k, end in ((i - 1, 1.0), (i + 1, 0.0)))
    ends = (-before - along[0] / 2, after + along[-1] / 2)
    shares = [
        np.linalg.lstsq(np.column_stack([across[k], along[k]]), way, rcond=None)[0] for k, way in zip((0, -1), ends, strict=True)
    ]
    a, b = np.outer(1 - fine, shares[0]).T + np.outer(fine, shares[1]).T
    inwards = a[:, None] * across + b[:, None] * along
    points, knots = _interpolated(fine, np.stack([curve, curve + inwards], axis=1))
    return NurbsSurface(points, None, knots, [0, 0, 1, 1])


def _piece(curve: Curve, way: Way) -> tuple[Any, Array]:
    """The surface of an edge, if it is known, and three places (u, v): the middle of the opposite edge, where the way along the
    edge starts and where it ends."""
    if not isinstance(curve, SurfaceEdge) or curve.origin is None:
        return None, np.zeros((3, 2))
    if max(way) > 1:
        raise Refusal.of(Message("surface_closes_in_side", {"name": curve.name}))
    surface, edge = curve.origin
    u0, u1, v0, v1 = surface.domain
    corners = np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)])
    a, b, c, d = np.roll(corners, -edge, axis=0)
    return surface, np.array([(c + d) / 2, *(a + t * (b - a) for t in way)])


def _opposite(sides: list[tuple[Side, Array]]) -> tuple[Array, list[bool]]:
    """The corners (3, 3) of a hole, corner i opposite side i, and which objects lie on that side of their edge where it is."""
    ends = np.array([side.evaluate([0.0, 1.0])[0] for side, _ in sides])
    corners = (np.roll(ends[:, 0], 1, axis=0) + np.roll(ends[:, 1], -1, axis=0)) / 2
    over = []
    for (side, _), corner in zip(sides, corners, strict=True):
        middle, _, across, _ = (each[0] for each in side.evaluate([0.5]))
        over.append(bool(across @ (corner - middle) > 0))
    return corners, over


def of_loop(loop: Loop) -> tuple[Loop, list[tuple[Patch, Array]]]:
    """The loop, in the direction in which most of its surfaces face, and the constituents of its hole with three sides, in the
    order of these, each with the parameters where its side is drawn.

    A NURBS surface that lies over the hole, on that side of its edge where the opposite corner is, is one as it is: between the
    piece of the edge and the middle of the opposite edge. Any other object is continued straight into the hole from its border.
    """
    loop = facing(loop, _opposite(loop.sides())[1])
    sides = loop.sides()
    corners, over = _opposite(sides)
    found = []
    for i, (_, t) in enumerate(sides):
        surface: NurbsSurface | BezierRectangle | None = None
        if over[i]:
            surface, places = _piece(loop.curves[i], loop.ends[i])
        if surface is None:
            surface, places = _continued(sides, i), np.array([(0.5, 1), (0, 0), (1, 0)])
        moved = np.roll(corners, -i, axis=0) - surface.evaluate(places)
        moved[0] = 0
        found.append((triangle_on(surface, np.roll(places, i, axis=0), np.roll(moved, i, axis=0)), t))
    return loop, found
