"""Networks: one smooth surface over a triangulation, from curves over its edges and the planes along them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from . import _arrays, _native
from ._native import Side
from ._types import Array, ArrayLike, Faces
from .attributes import vertex_normals
from .errors import WrongValue, out_of_range, wrong_shape, wrong_type
from .messages import Message
from .surfaces import _CURVES, _named, _numbers, _whole

#: Of a curve or a field: t (k,) -> (k, 3).
Field = Callable[[Array], Array]
Edge = tuple[int, int]


def _bezier(net: Array) -> Field:
    """A Bezier curve by its control points, by de Casteljau."""

    def at(t: Array) -> Array:
        t = np.asarray(t, float)[:, None, None]
        points = np.broadcast_to(net, (len(t), *net.shape))
        while points.shape[1] > 1:
            points = (1 - t) * points[:, :-1] + t * points[:, 1:]
        return points[:, 0]

    return at


def _curve(value: Any, name: str) -> tuple[Field, Field]:
    """Position and derivative."""
    if isinstance(value, tuple) and len(value) == 2 and all(callable(f) for f in value):
        return value
    net = _numbers(value, name, 2, 3)
    if len(net) < 2:
        raise out_of_range(f"len({name})", len(net), 2)
    return _bezier(net), _bezier((len(net) - 1) * np.diff(net, axis=0))


def _field(value: Any, name: str) -> Field:
    if callable(value):
        field: Field = value
        return field
    net = _numbers(value, name, 2, 3)
    if not len(net):
        raise out_of_range(f"len({name})", 0, 1)
    return _bezier(net)


def _along(given: Mapping[Edge, Any], edge: Edge, name: str) -> Field:
    """The field of a mapping along an edge, whichever way it is given."""
    if edge in given:
        return _field(given[edge], f"{name}[{edge}]")
    if edge[::-1] not in given:
        raise WrongValue(Message("no_curve_along", {"name": name, "first": edge[0], "second": edge[1]}))
    field = _field(given[edge[::-1]], f"{name}[{edge[::-1]}]")
    return lambda t: field(1 - np.asarray(t, float))


def _side(curve: tuple[Field, Field], normal: Field) -> Side:
    """The side of a curve whose normals are those of a field, less their parts along the curve."""
    position, derivative = curve
    return Side.from_functions(position, derivative, lambda t: np.cross(derivative(t), normal(t)))


def network(
    vertices: ArrayLike,
    triangles: Faces,
    curves: str | Mapping[Edge, Any] = "hermite",
    normals: ArrayLike | Mapping[Edge, Any] | None = None,
    resolution: int = 8,
) -> _native.SmoothMesh:
    """One surface over a triangulation that is smooth (G1) across every edge, from curves over the edges and planes along them.

    Over each triangle lies a patch of the method side_vertex. It is rational, so that all curves can be met whose tangents lie in
    one plane at each vertex.

    Args:
        vertices: (n, 3).
        triangles: (m, 3), or lists of three indices.
        curves: {(a, b): curve from vertex a to vertex b}, each edge once: control points (d + 1, 3) of a Bezier curve, or two
            functions of t (k,) -> (k, 3), position and derivative. "hermite" or "smits": made from the normals at the
            vertices, as by `smooth_triangles`.
        normals: (n, 3) at the vertices, of any length, mixed linearly along the edges; None: the faces' normals weighted by their
            angles. Or {(a, b): field from a to b} if the curves are given: control points (d + 1, 3) of a Bezier field, or a
            function of t (k,) -> (k, 3), of any length. What lies along the curve is left out of either.
        resolution: edges that every edge is cut into, 1 to 256.

    Returns:
        What `smooth_triangles` returns, with `patches`: a `Patch` for each triangle, corners in the triangle's order.

    Raises:
        Refusal: an edge without a curve, a curve that does not run between its vertices, or curves that have no common plane at a
            vertex.
    """
    v, offsets, corners = _arrays.mesh(vertices, triangles)
    cuts = _whole(resolution, "resolution")
    if isinstance(normals, Mapping):
        at = None
    else:
        at = None if normals is None else _arrays.points(normals, "normals")
        if at is not None and len(at) != len(v):
            raise wrong_shape("normals", f"({len(v)}, 3)", at.shape)
    if isinstance(curves, str):
        if isinstance(normals, Mapping):
            raise wrong_type("normals", "ndarray | None", type(normals))
        return _native._smooth_triangles(v, offsets, corners, at, cuts, _named(curves, "curves", _CURVES), True)
    if not isinstance(curves, Mapping):
        raise wrong_type("curves", "str | Mapping", curves)
    if at is None:
        at = vertex_normals(vertices, triangles)
    edges, sides = [], []
    for a, b in curves:
        edge = (int(a), int(b))
        if not 0 <= min(edge) <= max(edge) < len(v):
            raise _arrays.no_such_vertex("curves", min(edge) if min(edge) < 0 else max(edge), len(v))
        field = _along(normals, edge, "normals") if isinstance(normals, Mapping) else _bezier(at[list(edge)])
        edges.append(edge)
        sides.append(_side(_curve(curves[a, b], f"curves[{edge}]"), field))
    return _native._network(v, offsets, corners, edges, sides, cuts)
