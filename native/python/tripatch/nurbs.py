"""Patches as NURBS surfaces, and in STEP files for CAD programs (with the package cadquery-ocp: `pip install tripatch[step]`)."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from . import _native
from ._native import BezierTriangle, NurbsSurface, Patch
from ._types import Array
from .attributes import angles
from .errors import WrongValue, out_of_range, wrong_type
from .messages import Message
from .surfaces import real

#: Of a patch's size: how near the surfaces come unless a tolerance is given.
_NEAR = 1e-7
#: Degree of what is fitted, and the largest of a polynomial that is written as it is (the core's for rectangles).
_DEGREE, _MOST = 5, 20
#: Spans between knots that are tried, in both directions; and what more of them must leave of the deviation to be worth it.
_SPANS, _WORTH = (1, 2, 4, 8, 16, 32), 0.5
#: Of a side: where its seam is not looked at next to the corners, as in reports.
_BESIDE_CORNER = 0.01

#: From places (k, 2) of the unit square to places of a patch.
Map = Callable[[Array], Array]


@dataclass
class NurbsPatch:
    """A patch as NURBS surfaces.

    Attributes:
        surfaces: `NurbsSurface` objects over the unit square, without weights.
        points, knots: of each of them: (m, n, 3) and a pair of lists.
        exact: whether they are the patch itself, which is a polynomial.
        deviation: largest distance from the patch, in its units.
        angle: largest angle between their normals and the patch's along its sides, in degrees, outside of 1% at corners.
    """

    surfaces: list[NurbsSurface]
    points: list[Array] = field(repr=False)
    knots: list[tuple[list[float], list[float]]] = field(repr=False)
    exact: bool
    deviation: float
    angle: float


def _bilinear(corners: Sequence[Any]) -> Map:
    """(0, 0), (1, 0), (1, 1), (0, 1) to four places."""
    a, b, c, d = (np.asarray(corner, float) for corner in corners)

    def at(st: Array) -> Array:
        s, t = st[:, [0]], st[:, [1]]
        between: Array = (1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d
        return between

    return at


def _transfinite(bottom: Map, top: Map, left: Map, right: Map) -> Map:
    """Between four curves of t (k,) that meet at the corners of the square (Coons)."""
    flat = _bilinear([f(np.array([t]))[0] for f, t in ((bottom, 0.0), (bottom, 1.0), (top, 1.0), (top, 0.0))])

    def at(st: Array) -> Array:
        s, t = st[:, 0], st[:, 1]
        across = (1 - t)[:, None] * bottom(s) + t[:, None] * top(s)
        return across + (1 - s)[:, None] * left(t) + s[:, None] * right(t) - flat(st)

    return at


def _straight(a: Array, b: Array) -> Map:
    return lambda t: (1 - np.asarray(t, float))[:, None] * a + np.asarray(t, float)[:, None] * b


def _of_disc() -> list[Map]:
    """A square in the middle, and four pieces between its edges and the border, which is theirs at t = 1."""
    square = 0.5 * np.sqrt(0.5) * np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)], float)
    maps: list[Map] = [_bilinear(square[[2, 3, 0, 1]])]
    for k in range(4):
        a, b = square[k], square[(k + 1) % 4]

        def arc(t: Array, k: int = k) -> Array:
            angle = np.pi / 2 * (k + 0.5 + np.asarray(t, float))
            return np.column_stack([np.cos(angle), np.sin(angle)])

        maps.append(_transfinite(_straight(a, b), arc, _straight(a, 2 * a), _straight(b, 2 * b)))
    return maps


def _quarters() -> list[list[Array]]:
    """Of a triangle: from each corner to the middle, with middles of sides at the others."""
    corners, middle = np.eye(3), np.full(3, 1 / 3)
    return [
        [corners[k], (corners[k] + corners[(k + 1) % 3]) / 2, middle, (corners[k] + corners[(k + 2) % 3]) / 2] for k in range(3)
    ]


def _drawn_together(patch: Patch) -> list[Map]:
    """Two pieces at each corner, drawn together there (s = 0): blends are smooth along rays from a corner and from ray to ray,
    but have no second derivatives in it. One edge of each (t = 0) lies on a side of the patch."""
    if isinstance(patch, _native.PolygonPatch):
        n, leaving, middle = len(patch.domain), 0, patch.domain.mean(axis=0)
    else:
        n, leaving, middle = 3, 2, np.full(3, 1 / 3)
    maps: list[Map] = []
    for k in range(n):
        for backwards in (False, True):
            side = (k + leaving - backwards) % n

            def edge(s: Array, side: int = side, backwards: bool = backwards) -> Array:
                return patch.on_side(side, 1 - 0.5 * s if backwards else 0.5 * s)

            def at(st: Array, edge: Map = edge) -> Array:
                s, t, corner = st[:, [0]], st[:, [1]], edge(np.zeros(1))[0]
                drawn: Array = (1 - t) * edge(st[:, 0]) + t * ((1 - s) * corner + s * middle)
                return drawn

            maps.append(at)
    return maps


def _pieces(patch: Patch) -> tuple[list[Map], list[tuple[int, Array]]]:
    """Squares that make up a patch's domain, and which of their edges (a piece and its places) lie on its sides."""
    if isinstance(patch, _native.PlanePatch | _native.RingPatch | _native.LoopsPatch):
        raise WrongValue(Message("no_nurbs"))
    t = np.linspace(2 * _BESIDE_CORNER, 1, 50)
    along_s, along_t = np.column_stack([t, 0 * t]), np.column_stack([0 * t, t])
    if isinstance(patch, _native.RoundPatch):
        around = np.column_stack([np.linspace(0, 1, 50), np.ones(50)])
        return _of_disc(), [(k, around) for k in range(1, 5)]
    if isinstance(patch, BezierTriangle):
        return [_bilinear(each) for each in _quarters()], [(k, edge) for k in range(3) for edge in (along_s, along_t)]
    maps = _drawn_together(patch)
    return maps, [(k, along_s) for k in range(len(maps))]


def _knots(degree: int, spans: int) -> Array:
    return np.concatenate([np.zeros(degree), np.linspace(0, 1, spans + 1), np.ones(degree)])


def _basis(degree: int, knots: Array, t: Array) -> Array:
    """(k, n) B-splines at t, by the recursion of Cox and de Boor."""
    n = len(knots) - degree - 1
    spans = np.clip(np.searchsorted(knots, t, side="right") - 1, degree, n - 1)
    values = np.zeros((len(t), len(knots) - 1))
    values[np.arange(len(t)), spans] = 1
    for d in range(1, degree + 1):
        left, right = knots[d:-1] - knots[: -d - 1], knots[d + 1 :] - knots[1:-d]
        with np.errstate(divide="ignore", invalid="ignore"):
            rising = np.where(left > 0, (t[:, None] - knots[: -d - 1]) / left, 0)
            falling = np.where(right > 0, (knots[d + 1 :] - t[:, None]) / right, 0)
        values = rising * values[:, : len(knots) - 1 - d] + falling * values[:, 1 : len(knots) - d]
    return values


def _product(s: Array, t: Array) -> Array:
    """(len(s) len(t), 2) places, those of one s after another."""
    return np.column_stack([np.repeat(s, len(t)), np.tile(t, len(s))])


def _fitted(patch: Patch, at: Map, degree: int, knots: Array) -> Array:
    """(n, n, 3) control points of the spline that meets a piece at Greville's abscissae: an edge's depend on that edge alone."""
    n = len(knots) - degree - 1
    nodes = np.array([knots[k + 1 : k + degree + 1].mean() for k in range(n)])
    inverse = np.linalg.inv(_basis(degree, knots, nodes))
    values = patch.evaluate(_kept_inside(at(_product(nodes, nodes)))).reshape(n, n, 3)
    points: Array = np.einsum("ia,jb,abx->ijx", inverse, inverse, values)
    return points


def _step(net: Array, b: Array) -> Array:
    """One step of de Casteljau's algorithm on a triangular net."""
    n = round((np.sqrt(8 * len(net) + 1) - 3) / 2)
    row = np.concatenate([np.full(s + 1, s) for s in range(n)])
    r = np.arange(len(row))
    lower: Array = b[0] * net[r] + b[1] * net[r + row + 1] + b[2] * net[r + row + 2]
    return lower


def _exactly(triangle: BezierTriangle, corners: Sequence[Any]) -> Array:
    """(n + 1, n + 1, 3) control points of a Bezier triangle between four places that `_bilinear` takes: its blossom at these."""
    n = triangle.degree
    here, along_s, both, along_t = (np.asarray(corner, float) for corner in corners)
    values = {}
    first = triangle.net
    for k in range(n + 1):
        second = first
        for a in range(n + 1 - k):
            third = second
            for b in range(n + 1 - k - a):
                last = third
                while len(last) > 1:
                    last = _step(last, here)
                values[k, a, b] = last[0]
                third = _step(third, along_t) if len(third) > 1 else third
            second = _step(second, along_s) if len(second) > 1 else second
        first = _step(first, both) if len(first) > 1 else first
    points = np.zeros((n + 1, n + 1, 3))
    for i in range(n + 1):
        for j in range(n + 1):
            for k in range(max(0, i + j - n), min(i, j) + 1):
                share = math.comb(i, k) * math.comb(n - i, j - k) / math.comb(n, j)
                points[i, j] += share * values[k, i - k, j - k]
    return points


def _kept_inside(places: Array) -> Array:
    """Without what rounding leaves outside of a triangle."""
    if places.shape[1] == 2:
        return places
    kept: Array = np.maximum(places, 0)
    kept /= kept.sum(axis=1, keepdims=True)
    return kept


def _made(patch: Any, degree: int, spans: int, exact: bool) -> NurbsPatch:
    """The pieces of a patch as splines, compared with it between their nodes."""
    maps, on_sides = _pieces(patch)
    knots = _knots(degree, spans)
    between = np.linspace(0, 1, 3 * spans + 6)
    uv = _product(between, between)
    surfaces, nets, off, turned = [], [], 0.0, 0.0
    for k, at in enumerate(maps):
        points = _exactly(patch, _quarters()[k]) if exact else _fitted(patch, at, degree, knots)
        surface = NurbsSurface(points, None, knots, knots)
        apart = surface.evaluate(uv) - patch.evaluate(_kept_inside(at(uv)))
        off = max(off, float(np.linalg.norm(apart, axis=1).max()))
        surfaces.append(surface)
        nets.append(points)
    for k, edge in on_sides:
        d = surfaces[k].evaluate(edge, derivatives=1)[1]
        own, normal = np.cross(d[:, 0], d[:, 1]), patch.normal(_kept_inside(maps[k](edge)))
        turned = max(turned, float(angles(own * np.sign((own * normal).sum()), normal).max()))
    return NurbsPatch(surfaces, nets, [(knots.tolist(), knots.tolist())] * len(maps), exact, off, turned)


def nurbs(patch: Patch, tolerance: float | None = None) -> NurbsPatch:
    """A patch as NURBS surfaces. A `BezierTriangle` is written exactly, as it is a polynomial: one surface for each corner. Any
    other patch has two at each corner, drawn together there, and as many knots as the tolerance asks for.

    Args:
        patch: of sides or of surfaces; over the triangle, a polygon or a disc.
        tolerance: largest distance in the patch's units; None: 1e-7 of its size. Patches next to meshes, whose sides are splines,
            may not reach it: what is reached is stated.

    Returns:
        A `NurbsPatch`, which states its largest distance from the patch and the largest angle to it along the sides.
    """
    if not isinstance(patch, Patch):
        raise wrong_type("patch", "Patch", patch)
    if tolerance is not None and not 0 < real(tolerance, "tolerance") < np.inf:
        raise out_of_range("tolerance", tolerance, 0, is_open=True)
    if isinstance(patch, BezierTriangle) and 1 <= patch.degree <= _MOST:
        return _made(patch, patch.degree, 1, True)
    best: NurbsPatch | None = None
    for spans in _SPANS:
        made = _made(patch, _DEGREE, spans, False)
        worth = best is None or made.deviation < _WORTH * best.deviation
        best = made if best is None or worth else best
        size = float(np.ptp(np.concatenate([p.reshape(-1, 3) for p in made.points]), axis=0).max())
        if best.deviation <= (_NEAR * size if tolerance is None else tolerance):
            break
    assert best is not None
    return best


def _kernel() -> Any:
    """Open CASCADE's classes by name."""
    try:
        import OCP.BRepBuilderAPI
        import OCP.Geom
        import OCP.gp
        import OCP.IFSelect
        import OCP.Interface
        import OCP.Message
        import OCP.STEPControl
    except ImportError as reason:
        needed = {"what": ".step", "package": "cadquery-ocp", "install": "tripatch[step]"}
        raise ImportError(Message("package_needed", needed)) from reason
    for printer in OCP.Message.Message.DefaultMessenger_s().Printers():
        printer.SetTraceLevel(OCP.Message.Message_Gravity.Message_Fail)
    return OCP


def _arrays_of() -> tuple[Any, Any, Any]:
    """Its arrays of points, numbers and whole numbers, which version 8 has moved."""
    try:
        from OCP.collections import Array1_double, Array1_int, Array2_gp_Pnt

        return Array2_gp_Pnt, Array1_double, Array1_int
    except ImportError:
        from OCP.TColgp import TColgp_Array2OfPnt
        from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

        return TColgp_Array2OfPnt, TColStd_Array1OfReal, TColStd_Array1OfInteger


def _kernel_surface(kernel: Any, points: Array, knots: tuple[list[float], list[float]]) -> Any:
    two, reals, wholes = _arrays_of()
    m, n = points.shape[:2]
    poles = two(1, m, 1, n)
    for i in range(m):
        for j in range(n):
            poles.SetValue(i + 1, j + 1, kernel.gp.gp_Pnt(*(float(x) for x in points[i, j])))
    axes, degrees = [], []
    for count, values in zip((m, n), knots, strict=True):
        distinct, repeats = np.unique(values, return_counts=True)
        k, r = reals(1, len(distinct)), wholes(1, len(distinct))
        for a, (value, times) in enumerate(zip(distinct.tolist(), repeats.tolist(), strict=True)):
            k.SetValue(a + 1, value)
            r.SetValue(a + 1, times)
        axes.append((k, r))
        degrees.append(len(values) - count - 1)
    return kernel.Geom.Geom_BSplineSurface(poles, axes[0][0], axes[1][0], axes[0][1], axes[1][1], *degrees, False, False)


def write_step(
    path: str | os.PathLike[str], patches: Patch | Iterable[Patch], tolerance: float | None = None, unit: str = "MM"
) -> list[NurbsPatch]:
    """Writes patches to a STEP file, as NURBS surfaces that are sewn together where they meet.

    Needs the package cadquery-ocp (`pip install tripatch[step]`).

    Args:
        path: of the file.
        patches: a `Patch` or several.
        tolerance: as of `nurbs`.
        unit: of the coordinates, as STEP names it: "MM", "CM", "M", "INCH" and so on.

    Returns:
        A `NurbsPatch` of each, which states how near its surfaces are to the patch.
    """
    given = [patches] if isinstance(patches, Patch) else list(patches)
    if not given:
        raise WrongValue(Message("nothing_given", {"name": "patches"}))
    made = [nurbs(patch, tolerance) for patch in given]
    kernel = _kernel()
    extent = max(float(np.ptp(np.concatenate([p.reshape(-1, 3) for p in each.points]), axis=0).max()) for each in made)
    sewn = max(2 * max(each.deviation for each in made), _NEAR * extent)
    sewing = kernel.BRepBuilderAPI.BRepBuilderAPI_Sewing(sewn)
    for each in made:
        for points, knots in zip(each.points, each.knots, strict=True):
            surface = _kernel_surface(kernel, points, knots)
            sewing.Add(kernel.BRepBuilderAPI.BRepBuilderAPI_MakeFace(surface, sewn).Face())
    sewing.Perform()
    kernel.Interface.Interface_Static.SetCVal_s("write.step.unit", unit)
    writer = kernel.STEPControl.STEPControl_Writer()
    done = kernel.IFSelect.IFSelect_ReturnStatus.IFSelect_RetDone
    if writer.Transfer(sewing.SewedShape(), kernel.STEPControl.STEPControl_StepModelType.STEPControl_AsIs) != done:
        raise WrongValue(Message("cad_kernel_failed"))
    if writer.Write(os.fspath(path)) != done:
        raise OSError(Message("package_cannot_write", {"package": "cadquery-ocp", "suffix": ".step"}))
    return made
