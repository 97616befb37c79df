"""Surfaces given by control points, the sides that they make, Coons nets, and meshes smoothed by their vertex normals."""

from __future__ import annotations

import inspect
import math
import numbers
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from . import _arrays, _native
from ._native import BezierRectangle, BezierTriangle, NurbsSurface, Patch, Side
from ._types import Array, ArrayLike, Faces
from .errors import FillWarning, WrongValue, not_one_of, out_of_range, wrong_shape, wrong_type
from .messages import Message
from .pickling import remade

_KINDS = {name: getattr(_native.CoonsKind, name) for name in ("discrete", "extremal", "extremal_symmetric", "mask", "permanence")}
_CURVES = {name: getattr(_native.NormalCurve, name) for name in ("hermite", "smits")}


def _named(value: Any, name: str, allowed: dict[str, Any]) -> Any:
    if not isinstance(value, str):
        raise wrong_type(name, "str", value)
    if value not in allowed:
        raise not_one_of(name, value, allowed)
    return allowed[value]


#: The core has no larger whole numbers; what is allowed ends far below, as it says.
_LARGEST = 2**31 - 1


def _whole(value: Any, name: str) -> int:
    if isinstance(value, bool) or not isinstance(value, numbers.Integral):
        raise wrong_type(name, "int", value)
    return max(-_LARGEST, min(int(value), _LARGEST))


def real(value: Any, name: str) -> float:
    """A number, but not True or False."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise wrong_type(name, "float", value)
    return float(value)


def _numbers(value: Any, name: str, dimensions: int, last: int | None = None) -> Array:
    """A float64 array of so many dimensions, the last of this length."""
    shape = "(" + ", ".join(["m", "n"][: dimensions - (last is not None)] + ([str(last)] if last else [])) + ")"
    a = _arrays.numbers(value, name, shape)
    if a.ndim != dimensions or (last is not None and a.shape[-1] != last):
        raise wrong_shape(name, shape, a.shape)
    return np.ascontiguousarray(a, dtype=np.float64)


def _init_with(native_class: Any, convert: Callable[..., Any]) -> None:
    native_init = native_class.__init__

    def init(self: Any, *args: Any, **kwargs: Any) -> None:
        given = convert(*args, **kwargs)
        native_init(self, *given)
        if native_class is NurbsSurface:  # which does not tell of its parts
            vars(self)["_recipe"] = NurbsSurface, inspect.signature(convert).bind(*args, **kwargs).args

    init.__doc__ = convert.__doc__
    native_class.__init__ = init


def _triangle(net: ArrayLike) -> Any:
    """net: (n + 1)(n + 2) / 2 by 3 control points in the order (n,0,0), (n-1,1,0), (n-1,0,1), ..., (0,0,n)."""
    return (_arrays.points(net, "net"),)


def _rectangle(net: ArrayLike) -> Any:
    """net: (m + 1, n + 1, 3) control points, the first index along u."""
    return (_numbers(net, "net", 3, 3),)


def _nurbs(points: ArrayLike, weights: ArrayLike | None, knots_u: ArrayLike, knots_v: ArrayLike) -> Any:
    """A NURBS surface; its degrees are the numbers of knots less those of points less 1.

    Args:
        points: (m, n, 3), the first index along u.
        weights: (m, n), greater than 0; None: all 1.
        knots_u, knots_v: knots that do not decrease. The domain is from knot number `degree` to knot number m (n).
    """
    p = _numbers(points, "points", 3, 3)
    w: Any = [] if weights is None else _numbers(weights, "weights", 2)
    if weights is not None and w.shape != p.shape[:2]:
        raise wrong_shape("weights", str(p.shape[:2]), w.shape)
    return p, np.ravel(w).tolist(), _numbers(knots_u, "knots_u", 1).tolist(), _numbers(knots_v, "knots_v", 1).tolist()


def _side(surface: Any, edge: int, reversed: bool = False) -> Any:
    """An edge of a surface as a side of the hole, exact.

    Args:
        surface: a BezierTriangle, BezierRectangle or NurbsSurface.
        edge: of a rectangle 0: v lowest, 1: u highest, 2: v highest, 3: u lowest, counter-clockwise in (u, v); of a triangle the
            edge opposite corner `edge`, from the next corner to the one after.
        reversed: the other direction along the edge; there the side's normal is the surface's own (S_u x S_v).
    """
    if not isinstance(surface, (BezierTriangle, _native.RectangleSurface)):
        raise wrong_type("surface", "BezierTriangle | BezierRectangle | NurbsSurface", surface)
    if not isinstance(reversed, (bool, np.bool_)):
        raise wrong_type("reversed", "bool", reversed)
    return surface, _whole(edge, "edge"), bool(reversed)


_init_with(BezierTriangle, _triangle)
_init_with(BezierRectangle, _rectangle)
_init_with(NurbsSurface, _nurbs)
_init_with(Side, _side)


#: What three numbers that sum to 0 may sum to, of the largest: thirds and their like leave 1e-16.
_SUM = 1e-12


def _derivative(self: BezierTriangle, direction: ArrayLike) -> BezierTriangle:
    """The derivative in a direction (d0, d1, d2) of the domain, summing to 0: a Bezier triangle of one degree less."""
    d = _numbers(direction, "direction", 1)
    if d.shape != (3,) or abs(d.sum()) > _SUM * np.abs(d).max(initial=0):
        raise WrongValue(Message("sum_not_zero", {"name": "direction"}))
    return self._derivative(d.tolist())


def _triangle_side(self: BezierTriangle, i: int) -> Array:
    """(n + 1, 3) control points of side i, from corner i + 1 to corner i + 2."""
    if not 0 <= _whole(i, "i") <= 2:
        raise out_of_range("i", i, 0, 2)
    return self._side(i)


def _evaluate(self: _native.RectangleSurface, uv: ArrayLike, derivatives: int = 0) -> Any:
    """Position and derivatives with respect to (u, v).

    Args:
        uv: (k, 2) in the domain.
        derivatives: 0 to 3.

    Returns:
        P (k, 3); with derivatives the tuple (P, D1 (k, 2, 3), D2 (k, 3, 3) in the order uu, uv, vv, D3 (k, 4, 3)).
    """
    if not 0 <= _whole(derivatives, "derivatives") <= 3:
        raise out_of_range("derivatives", derivatives, 0, 3)
    at = _numbers(uv, "uv", 2, 2)
    u0, u1, v0, v1 = self.domain
    outside = ~((at >= (u0, v0)) & (at <= (u1, v1))).all(axis=1)
    if outside.any():
        ends = {name: f"{end:g}" for name, end in (("u0", u0), ("u1", u1), ("v0", v0), ("v1", v1))}
        raise WrongValue(Message("outside_domain", {"name": f"uv[{int(np.argmax(outside))}]", **ends}))
    return self._evaluate(at, int(derivatives))


BezierTriangle.derivative = _derivative  # type: ignore[method-assign]
BezierTriangle.side = _triangle_side  # type: ignore[method-assign]
_native.RectangleSurface.evaluate = _evaluate


def rational_triangle(net: ArrayLike, weights: ArrayLike) -> Patch:
    """A rational Bezier triangle, for `blend`.

    Args:
        net: control points (k, 3) as of `BezierTriangle`.
        weights: (k,), greater than 0.
    """
    made: Patch = remade("_rational_triangle", _arrays.points(net, "net"), _numbers(weights, "weights", 1).tolist())
    return made


def triangle_on(surface: BezierRectangle | NurbsSurface, corners: ArrayLike, moved: ArrayLike | None = None) -> Patch:
    """The part of a surface between three places of its domain as a patch over the triangle, for `blend`.

    Args:
        surface: a `BezierRectangle` or `NurbsSurface`.
        corners: (3, 2) the places (u, v) of corners 0, 1 and 2. Side i runs straight between two of them: along an edge of the
            surface if both lie on it.
        moved: (3, 3) by how much each corner is moved, and linearly what lies between; None: not at all.
    """
    if not isinstance(surface, _native.RectangleSurface):
        raise wrong_type("surface", "BezierRectangle | NurbsSurface", surface)
    at = _numbers(corners, "corners", 2, 2)
    if len(at) != 3:
        raise wrong_shape("corners", "(3, 2)", at.shape)
    by = np.zeros((3, 3)) if moved is None else _arrays.points(moved, "moved", finite=True)
    if len(by) != 3:
        raise wrong_shape("moved", "(3, 3)", by.shape)
    made: Patch = remade("_triangle_on", surface, at.tolist(), by.tolist())
    return made


#: Degrees of the polynomials that a function is taken for, one after another, until they are near enough: of its extent.
_DEGREES, _NEAR = (4, 8, 12, 16, 20, 24), 1e-12
#: A function that the last of them does not come so near to is none that a blend could take derivatives of.
_FAR = 1e-6


def _bernstein(degree: int, b: Array) -> Array:
    """(k, (degree + 1)(degree + 2) / 2) Bernstein polynomials in the order of a net."""
    indices = [(i, j, degree - i - j) for i in range(degree, -1, -1) for j in range(degree - i, -1, -1)]
    powers = [b[:, [x]] ** np.arange(degree + 1) for x in range(3)]
    factors = [math.comb(degree, i) * math.comb(degree - i, j) for i, j, _ in indices]
    at = np.array(indices)
    terms: Array = powers[0][:, at[:, 0]] * powers[1][:, at[:, 1]] * powers[2][:, at[:, 2]] * factors
    return terms


def surface_of(function: Callable[[Array], Any], name: str = "function") -> BezierTriangle:
    """A smooth function of barycentric coordinates (k, 3) -> (k, 3) as a Bezier triangle, to 12 digits if degree 24 suffices.

    Args:
        function: called with arrays of shape (k, 3).
        name: of the function, for messages.

    Raises:
        ValueError: the function is not smooth: no polynomial of degree 24 comes within a millionth of its extent.
    """

    def sampled(degree: int) -> tuple[Array, Array]:
        # products of Chebyshev's points, drawn together at a corner; each corner in turn
        x = 0.5 - 0.5 * np.cos(np.pi * (np.arange(degree + 3) + 0.5) / (degree + 3))
        s, t = (each.ravel() for each in np.meshgrid(x, x))
        own = np.column_stack([1 - s, s * (1 - t), s * t])
        b = np.vstack([np.eye(3), own, own[:, [2, 0, 1]], own[:, [1, 2, 0]]])
        return b, _numbers(function(b), f"{name}(b)", 2, 3)

    for degree in _DEGREES:
        b, values = sampled(degree)
        if values.shape != b.shape:
            raise wrong_shape(f"{name}(b)", str(b.shape), values.shape)
        if not np.isfinite(values).all():
            raise WrongValue(Message("not_finite", {"name": f"{name}(b)"}))
        net = np.linalg.lstsq(_bernstein(degree, b), values, rcond=None)[0]
        between, expected = sampled(degree + 1)
        extent = np.ptp(values, axis=0).max()
        off = np.abs(_bernstein(degree, between) @ net - expected).max()
        if off <= _NEAR * extent:
            break
    if not off <= _FAR * extent:
        raise WrongValue(Message("not_smooth", {"name": name, "degree": degree, "off": float(off)}))
    return BezierTriangle(net)


def _corners_and_normals(points: ArrayLike, normals: ArrayLike) -> tuple[Array, Array]:
    p, n = _numbers(points, "points", 2, 3), _numbers(normals, "normals", 2, 3)
    for name, a in (("points", p), ("normals", n)):
        if len(a) != 3:
            raise wrong_shape(name, "(3, 3)", a.shape)
    return p, n


def sides_from_normals(points: ArrayLike, normals: ArrayLike, curve: str = "hermite") -> tuple[Side, Side, Side]:
    """The three sides of a triangle with vertex normals: curves orthogonal to the normals at their ends (Smits 2000).

    Args:
        points: (3, 3) corners.
        normals: (3, 3) outer normals there, of any length.
        curve: "hermite": cubic, end tangents as long as the arc; "smits": equations 4 to 9 as printed.

    Raises:
        Refusal: a normal that is zero, along an edge, or opposite to its neighbor's.
    """
    p, n = _corners_and_normals(points, normals)
    return _native._sides_from_normals(p, n, _named(curve, "curve", _CURVES))


def smits_patch(points: ArrayLike, normals: ArrayLike) -> _native.Patch:
    """The fill of Smits's page: heights blended from those of his three curves, position only.

    Args:
        points: (3, 3) corners.
        normals: (3, 3) outer normals there, of any length.
    """
    made: _native.Patch = remade("_smits_patch", *_corners_and_normals(points, normals))
    return made


def coons_bezier(boundary: Sequence[Any], kind: str = "discrete", alpha: float | None = None) -> BezierTriangle:
    """A Bezier triangle from three Bezier curves (Arnal and Lluch, Coons triangular Bezier surfaces).

    Args:
        boundary: three (n + 1, 3) control polygons of one degree n <= 20; curve i along side i (from corner i + 1 to i + 2),
            the ends shared.
        kind: "discrete" (Definition 1: the Coons patch itself, of degree n + 1), "extremal" (least integral of x_uv squared,
            Propositions 2 and 3), "extremal_symmetric" (the same over the three pairs of coordinates), "mask" (eq. 11),
            "permanence" (eq. 9).
        alpha: of "permanence", 3 alpha + 6 beta = 1. None: -2/3, the paper's.

    Raises:
        Refusal: the mask's or permanence patch's system is singular and this boundary has no solution.
        ValueError: curves of different degrees, that do not meet, or that are not finite.
    """
    given = tuple(boundary)
    if len(given) != 3:
        raise WrongValue(Message("wrong_count", {"name": "boundary", "count": 3, "given": len(given)}))
    curves = [_numbers(c, f"boundary[{i}]", 2, 3) for i, c in enumerate(given)]
    value = None if alpha is None else real(alpha, "alpha")
    triangle, notes = _native._coons_bezier(curves, _named(kind, "kind", _KINDS), value)
    for note in notes:
        warnings.warn(FillWarning(note), stacklevel=2)
    return triangle


def coons_rectangle(boundary: BezierRectangle, alpha: float | None = None) -> BezierRectangle:
    """The rectangular discrete Coons patch of a net's boundary (Farin and Hansford 1999); its interior points are not read.

    Args:
        boundary: a net of (m + 1, n + 1, 3) control points.
        alpha: None: the discrete Coons patch; else the permanence patch with 4 alpha + 4 beta = 1 (-1/4: the Coons patch again).

    Returns:
        A `BezierRectangle` with the same boundary.
    """
    if not isinstance(boundary, BezierRectangle):
        raise wrong_type("boundary", "BezierRectangle", boundary)
    return _native._coons_rectangle(boundary, None if alpha is None else real(alpha, "alpha"))


def coons_energy(surface: BezierTriangle | BezierRectangle, symmetric: bool = False) -> float:
    """Integral of ``|x_uv|^2`` over the unit triangle or square, in units of length squared (Arnal and Lluch, eq. 4 and 1).

    Args:
        surface: a `BezierTriangle` or `BezierRectangle`.
        symmetric: over the triangle: summed over the three pairs of coordinates.
    """
    if not isinstance(surface, (BezierTriangle, BezierRectangle)):
        raise wrong_type("surface", "BezierTriangle | BezierRectangle", surface)
    return _native._coons_energy(surface, bool(symmetric))


def smooth_triangles(
    vertices: ArrayLike, faces: Faces, normals: ArrayLike | None = None, resolution: int = 8, curve: str = "hermite"
) -> _native.SmoothMesh:
    """A triangle mesh with vertex normals becomes one surface that is smooth (G1) across every edge.

    Args:
        vertices: (n, 3).
        faces: (m, 3), or lists of three indices.
        normals: (n, 3), of any length; None: the faces' normals weighted by their angles.
        resolution: edges that every edge is cut into, 1 to 256.
        curve: over the edges: "hermite" (cubic, tangents as long as the arc) or "smits" (equations 4 to 9 of Smits 2000).

    Returns:
        An object with `vertices`, `faces` (resolution^2 triangles for each face, in order), exact unit `normals` and `edges`
        (e, 2). The given vertices come first, then resolution - 1 points of every edge, then the faces' inner points. Those of a
        face lie at (resolution - j - k, j, k) / resolution of its corners, j and k from 1, by j first. Point k = 1 .. of edge j,
        counted from edges[j, 0], is vertex n + j (resolution - 1) + k - 1.

    Raises:
        Refusal: a face that is no triangle, or has no area; a normal that is zero, along an edge, or not finite.
    """
    v, offsets, corners = _arrays.mesh(vertices, faces)
    given = None
    if normals is not None:
        given = _arrays.points(normals, "normals")
        if len(given) != len(v):
            raise wrong_shape("normals", f"({len(v)}, 3)", given.shape)
    return _native._smooth_triangles(
        v, offsets, corners, given, _whole(resolution, "resolution"), _named(curve, "curve", _CURVES), False
    )
