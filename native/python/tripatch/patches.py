"""Patches and sides: made from each other, evaluated, measured."""

from __future__ import annotations

import numbers
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from . import _arrays, _native, words
from ._native import BezierTriangle, Patch, Report, Side, SzilvasiNagyPatch
from ._types import Array, ArrayLike
from .errors import FillWarning, Refusal, WrongType, WrongValue, out_of_range, wrong_shape, wrong_type
from .messages import Message
from .options import OPTIONS, checked, choice, names, takes_options, whole
from .pickling import remade
from .surfaces import real, surface_of, triangle_on

#: Of the extent of a side: ends that are no farther apart close it.
_CLOSED = 1e-6
#: Of the extent of a patch: ends that are no farther apart differ by rounding, which a curve leaves at 1e-15 of its coordinates.
_ROUNDING = 1e-12


def _joined(sides: Sequence[Side | Sequence[Side]], as_given: bool) -> tuple[Side, ...]:
    """Sides of several pieces made one each, and, unless `as_given`, those that nearly stand still somewhere run through by
    length, of four and more all of them where one changes its speed quickly; ends of neighbors are where they were."""

    many = len(sides) > 3

    def one(side: Side | Sequence[Side]) -> Side:
        if isinstance(side, Side):
            return side if as_given or many else _native._joined_side([side], [])[0]
        return _native._joined_side(list(side), [])[0]

    made = tuple(one(side) for side in sides)
    return tuple(_native._evenly_run(made)) if many else made


def _closed(sides: Sequence[Side], tolerance: float) -> tuple[Side, ...]:
    """The sides with ends that are no farther apart than the tolerance moved to their middles."""
    starts, ends = (np.array([side.evaluate([t])[0][0] for side in sides]) for t in (0.0, 1.0))
    gaps = np.roll(starts, -1, axis=0) - ends  # from the end of a side to the start of the next
    size = np.linalg.norm(gaps, axis=1)
    gaps[size > tolerance] = 0  # refused later on, with the place
    largest = 0.5 * np.linalg.norm(gaps, axis=1).max()
    if largest <= _ROUNDING * np.ptp(starts, axis=0).max():
        return tuple(sides)
    warnings.warn(FillWarning(Message("ends_moved", {"gap": float(largest)})), stacklevel=3)
    moves = zip(sides, np.roll(-0.5 * gaps, 1, axis=0), 0.5 * gaps)
    return tuple(side._moved(before.tolist(), after.tolist()) for side, before, after in moves)


@takes_options
def patch(
    sides: Sequence[Side | Sequence[Side]],
    method: str = OPTIONS["method"].default,
    cross_boundary: str = "consistent",
    *,
    fairing: Any = None,
    through: Any = (),
    tolerance: float | None = None,
    islands: Sequence[Sequence[Side]] = (),
    progress: Callable[[int, int], object] | None = None,
    **options: Any,
) -> Patch:
    """A patch from two to twelve sides that meet at the corners, in a round rim that is one closed side, or as a ring between
    two closed sides.

    Options are those of `fill`, but nothing is made fair unless `fairing` says how ("auto" and so on). What a person should know
    of the patch is given as a warning.

    Args:
        sides: `Side` objects in the order of the rim; a list of them, from end to end, is one side of several pieces that
            continue smoothly, within 10 degrees. Of three, side i is opposite corner i and runs from corner i + 1 to corner
            i + 2; of another number side i runs from corner i to corner i + 1, and options by side have so many values. A side
            whose speed falls below a quarter of its length somewhere is run through by length, but not one of three where a
            method is named; four and more are all of them run so where the speed of one changes quickly.
        through: points (k, 3) inside, (point, normal) pairs or polylines that the patch meets exactly; of three sides it is one
            over a polygon then.
        method, cross_boundary, fairing: as of `fill`.
        tolerance: ends up to so far apart are moved together, half the way each, and a warning says how far; none: they meet.
        islands: loops of sides inside, each in the direction that new faces take, against the clock round the patch outside and
            with it inside. Other options are ignored then, and a warning names them.
        progress: called several times a second with 0 and 1; what it raises ends the work, as Ctrl-C does.
        **options: see OPTIONS.

    Returns:
        A `Patch`, for `evaluate` and `normal` at barycentric coordinates (k, 3); of four sides or more at places (k, 2) of its
        `domain`, a polygon with these corners (n, 2). Of a round rim in the unit disc; of a ring between the unit circle and a
        smaller one about its center, where `on_side` has places. Its `report` holds the numbers that a
        fill's report has of its patch: angles along the seam and round the corners, distance from the sides, folds.

    Raises:
        Refusal: the sides do not meet.
    """
    sides = tuple(side if isinstance(side, Side) or not isinstance(side, Sequence) else tuple(side) for side in sides)
    pieces = [piece for side in sides for piece in (side if isinstance(side, tuple) else (side,))]
    if not 1 <= len(sides) <= 12 or any(side == () for side in sides) or not all(isinstance(piece, Side) for piece in pieces):
        raise WrongType(Message("not_sides", {"name": "sides"}))
    if tolerance is not None:
        if not 0 <= real(tolerance, "tolerance") < np.inf:
            raise out_of_range("tolerance", tolerance, 0)
        met = iter(_closed(pieces, float(tolerance)))
        sides = tuple(next(met) if isinstance(side, Side) else tuple(next(met) for _ in side) for side in sides)
    sides = _joined(
        sides, as_given=len(sides) == 3 and method != "auto"
    )  # constructions of papers go by the sides' own parameters
    given = {"method": method, "cross_boundary": cross_boundary, "fairing": fairing, "through": through, **options}
    if len(islands) > 0:
        loops = [list(sides), *(list(loop) for loop in islands)]
        return _told(_made("_loops_patch", loops, checked("patch", given), progress))
    if len(sides) != 3 or len(through) > 0:
        return _told(_between_many(sides, given, progress))
    return _told(_made("_patch", sides, checked("patch", given), progress))


def _made(function: str, own: Any, given: dict[str, Any], progress: Any) -> Patch:
    """A patch that knows how to be made again."""
    made: Patch
    made, made._report = getattr(_native, function)(own, given, progress)
    vars(made)["_recipe"] = remade, (function, own, given, None)
    return made


def _told(made: Patch) -> Patch:
    """The patch; the warnings of its report are given to the caller of what calls this."""
    for note in made._report.warnings if made._report else ():
        warnings.warn(FillWarning(note), stacklevel=3)
    return made


def _report(self: Patch) -> Report | None:
    """Of a patch that `patch` or `blend` made: the numbers that the report of a fill has of its patch. None: of any other."""
    return self._report


def _is_ring(sides: Sequence[Side]) -> bool:
    """Whether these are two sides, each of them closed."""
    drawn = [side.evaluate(np.linspace(0, 1, 9))[0] for side in sides]
    return len(sides) == 2 and all(np.linalg.norm(p[-1] - p[0]) <= _CLOSED * np.ptp(p, axis=0).max() for p in drawn)


def _between_many(sides: Sequence[Side], options: dict[str, Any], progress: Callable[[int, int], object] | None) -> Patch:
    """A patch of another number of sides than three: options by side have one value or one a side."""
    own = ("annulus",) if _is_ring(sides) else ("multi_sided", "side_vertex") if len(sides) == 3 else ("multi_sided",)
    many = ("auto", *own)
    if options["method"] not in many:
        said = {"method": str(options["method"]), "count": len(sides), "methods": list(many)}
        raise WrongValue(Message("method_of_three_sides", said))
    given = checked("patch", options)
    if _is_ring(sides):
        return _made("_ring_patch", sides, given, progress)
    if len(sides) == 1:
        return _made("_round_patch", sides[0], given, progress)
    patch = _made("_polygon_patch", sides, given, progress)
    return _over_outline(patch, sides, given, progress) if patch._report and patch._report.folds else patch


def _turns_back(sides: Sequence[Side]) -> bool:
    """Whether the outline has a corner that turns the other way."""
    t = np.linspace(0, 1, 17)[:-1]
    points = np.concatenate([side.evaluate(t)[0] for side in sides])
    steps = np.roll(points, -1, axis=0) - points
    normal = np.cross(points - points.mean(axis=0), steps).sum(axis=0)
    turns = np.cross(np.roll(steps, 1, axis=0), steps)[:: len(t)] @ normal
    return bool((turns < -_CLOSED * np.abs(turns).max()).any())


def _over_outline(patch: Patch, sides: Sequence[Side], given: dict[str, Any], progress: Any) -> Patch:
    """A patch over the outline itself if it does not fold, else the one over a convex polygon."""
    if len(given.get("through", ())) > 0 or not _turns_back(sides):
        return patch
    try:
        other = _made("_loops_patch", [list(sides)], given, progress)
    except Refusal:
        return patch
    return patch if other._report and other._report.folds else other


def _constituent(given: Any, name: str) -> Patch:
    """A surface over the triangle from what `blend` takes."""
    if isinstance(given, Patch):
        return given
    if isinstance(given, tuple) and len(given) == 2:
        return triangle_on(*given)
    if callable(given):
        return surface_of(given, name)
    raise WrongType(Message("not_a_surface", {"name": name}))


def blend(
    r0: Any, r1: Any, r2: Any, method: str = "szilvasi_nagy_c1", shape: Any = (0.5, 0.5, 0.5), reading: str = "corrected"
) -> Patch:
    """A patch from three surfaces over one triangle.

    Args:
        r0, r1, r2: r_i carries side i, and each two share a corner. A `Patch`, as a `BezierTriangle` or a `rational_triangle` is;
            a `BezierRectangle` or `NurbsSurface` with the places (3, 2) of the corners in its domain (see `triangle_on`);
            or a smooth function of barycentric coordinates (k, 3) -> (k, 3).
        method: a name in METHODS that blends surfaces.
        shape: lambda of the Szilvasi-Nagy methods in (0, 1), by side; or "optimal", of least energy.
        reading: "corrected", or "as_printed" for the paper's own formulas: feet, q, s and the energy, a sum over nine points.

    Returns:
        A `Patch`; of the Szilvasi-Nagy methods a `SzilvasiNagyPatch`. Its `report` compares it with the three surfaces.
    """
    surfaces = tuple(_constituent(r, f"r{i}") for i, r in enumerate((r0, r1, r2)))
    given = checked("blend", {"method": method, "shape": shape, "reading": reading})
    return _told(remade("_blend", surfaces, method, given))


def _places(b: ArrayLike) -> Array:
    """Barycentric coordinates as given, or the first two of them: over a plane domain (u, v)."""
    at = np.asarray(b)
    if at.ndim == 2 and at.shape[1] == 2 and at.dtype.kind in "fiu":
        return _arrays.points(np.column_stack([at, 1.0 - at.sum(axis=1)]), "b", finite=True)
    return _arrays.barycentric(b)


def _evaluate(self: Patch, b: ArrayLike, derivatives: int = 0) -> Any:
    """Position and derivatives with respect to (b0, b1), b2 = 1 - b0 - b1, or by (u, v) over a plane domain.

    Args:
        b: (k, 3) barycentric coordinates, or (k, 2) the first two of them: (u, v) of a patch over a plane domain.
        derivatives: 0 to 3.

    Returns:
        P (k, 3); with derivatives the tuple (P, D1 (k, 2, 3), D2 (k, 3, 3) in the order 00, 01, 11, D3 (k, 4, 3)).
    """
    if isinstance(derivatives, bool) or not isinstance(derivatives, numbers.Integral):
        raise wrong_type("derivatives", "int", derivatives)
    if not 0 <= derivatives <= 3:
        raise out_of_range("derivatives", derivatives, 0, 3)
    return self._evaluate(_places(b), int(derivatives))


def _normal(self: Patch, b: ArrayLike) -> Array:
    """(k, 3) unit normals at barycentric coordinates b (k, 3), or places (k, 2) of a plane domain, on the outer side."""
    return self._normal(_places(b))


def _positions_and_normals(self: Patch, b: ArrayLike) -> tuple[Array, Array]:
    """What `evaluate(b)` and `normal(b)` return, (k, 3) each, in little more than the time of one of them."""
    return self._positions_and_normals(_places(b))


#: The nine inner points of a square (s, t) cut in four each way, as (u, v) = (t - s t, s t), and t.
_NINE = np.array([(t - s * t, s * t, t) for s in (0.25, 0.5, 0.75) for t in (0.25, 0.5, 0.75)])


def _patch_energy(self: Patch, name: str) -> float:
    """A fairness energy, with weights that vanish at the corners.

    Args:
        name: "thin_plate", "third_derivative" (over the equilateral triangle of unit side; units of length squared),
            "minimum_variation", "quadric_variation" or "auto" (over the surface, times its size squared; no units);
            "nine_points": equation (5) of Szilvasi-Nagy and Szabo (2006) by their sum over nine points, without a weight.
    """
    if name != "nine_points":
        return self._energy(choice(name, "energy", names(OPTIONS["fairing"])))
    if _sides_of(self) != 3:
        raise WrongValue(Message("value_needs_three_sides", {"option": "energy", "value": "nine_points"}))
    second = self.evaluate(_NINE[:, :2], derivatives=2)[2]
    return float(np.einsum("k,d,kdx->", _NINE[:, 2] / 9, [1.0, 2.0, 1.0], second**2))


def _places_on_side(edges: Any, i: int) -> list[float]:
    """Parameters from a number of edges, or as they are given."""
    if isinstance(edges, numbers.Integral) or np.ndim(edges) == 0:
        return [float(t) for t in np.linspace(0, 1, whole(edges, "edges", 1, 10000) + 1)]
    t = np.asarray(edges, dtype=np.float64)
    if t.ndim != 1 or len(t) < 2 or t[0] != 0 or t[-1] != 1 or not (np.diff(t) > 0).all():
        raise WrongValue(Message("not_increasing", {"name": f"edges[{i}]"}))
    return [float(place) for place in t]


def _sides_of(patch: Patch) -> int:
    if isinstance(patch, _native.PlanePatch):
        raise WrongValue(Message("no_sides"))
    if isinstance(patch, _native.RingPatch):
        return 2
    if isinstance(patch, _native.RoundPatch):
        return 1
    return len(patch.domain) if isinstance(patch, _native.PolygonPatch | _native.LoopsPatch) else 3


def _triangles(self: Patch, edges: Any, resolution: int | None = None) -> tuple[Array, Array]:
    """The domain as triangles, well shaped on the patch.

    Args:
        edges: how many along each side, one or one a side; or for a side the parameters of its points, increasing from 0 to 1.
        resolution: edges per side inside, of a ring between its sides, 1 or more; None follows the sides.

    Returns:
        Barycentric coordinates (k, 3), those on the sides first, in order from corner 0 along side 2, 0 and 1; of a patch over a
        polygon or a disc places (k, 2) in it, from corner 0 along side 0; faces (m, 3).
    """
    count = _sides_of(self)
    given = (edges,) * count if isinstance(edges, numbers.Number) else tuple(edges)
    if len(given) != count:
        raise WrongValue(Message("values_by_side", {"name": "edges", "given": len(given), "sides": count}))
    sides = [_places_on_side(side, i) for i, side in enumerate(given)]
    inside = None if resolution is None else whole(resolution, "resolution", 1, 10000)
    if isinstance(self, _native.PolygonPatch):
        b, faces = _native._polygon_triangles(self, sides, inside)
    elif isinstance(self, _native.RingPatch):
        b, faces = _native._ring_triangles(self, [side[:-1] for side in sides], inside)
    elif isinstance(self, _native.LoopsPatch):
        b, faces = _native._loops_triangles(self, sides, inside)
    elif isinstance(self, _native.RoundPatch):
        b, faces = _native._disc_triangles(self, sides, inside)
    else:
        b, faces = _native._triangles(self, sides, inside)
    return b, np.array(faces, np.int64).reshape(-1, 3)


def _on_side(self: Patch, i: int, t: ArrayLike) -> Array:
    """The places of side i at parameters t (k,) in [0, 1], for `evaluate`: barycentric coordinates (k, 3), of a patch over a
    plane domain places (k, 2) in it."""
    t = _parameters(t)
    i = whole(i, "i", 0, _sides_of(self) - 1)
    if isinstance(self, _native.PolygonPatch | _native.RingPatch | _native.LoopsPatch):
        return self._on_side(i, t.tolist())
    if isinstance(self, _native.RoundPatch):
        return np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)])
    b = np.zeros((len(t), 3))
    b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
    return b


def _mu(self: SzilvasiNagyPatch, b: ArrayLike) -> Array:
    """(k, 3) the blending functions mu_0, mu_1, mu_2 at barycentric coordinates b (k, 3)."""
    return self._mu(_arrays.barycentric(b))


def _auxiliary_curve(self: SzilvasiNagyPatch, i: int, t: ArrayLike) -> Array:
    """(k, 3) points of the auxiliary curve g_i over side i at t (k,) in [0, 1]."""
    return self._auxiliary_curve(whole(i, "i", 0, 2), _parameters(t).tolist())


def _correction(self: SzilvasiNagyPatch, b: ArrayLike) -> Array:
    """(k, 3) the correction term q at barycentric coordinates b (k, 3)."""
    return self._correction(_arrays.barycentric(b))


def _slope_correction(self: SzilvasiNagyPatch, b: ArrayLike) -> Array:
    """(k, 3) the correction term s at barycentric coordinates b (k, 3); zero in Definition 1."""
    return self._slope_correction(_arrays.barycentric(b))


def _parameters(t: ArrayLike) -> Array:
    t = np.atleast_1d(np.asarray(t, dtype=np.float64))
    if t.ndim != 1:
        raise wrong_shape("t", "(k,)", t.shape)
    outside = ~((t >= 0) & (t <= 1))
    if outside.any():
        raise out_of_range("t", float(t[outside][0]), 0, 1)
    return np.ascontiguousarray(t)


def _side_evaluate(self: Side, t: ArrayLike) -> tuple[Array, Array, Array, Array]:
    """Position c, derivative c', derivative across r and unit normal n, (k, 3) each, at t (k,) in [0, 1]."""
    return self._evaluate(_parameters(t))


def _second_derivative(self: Side, t: ArrayLike) -> Array | None:
    """(k, 3) the surroundings' second derivative in the direction of r at t (k,) in [0, 1]; None where it is not known. Its part
    along the normal is r's length squared times the normal curvature across the side; the other parts mean nothing."""
    return self._second_derivative(_parameters(t))


def _from_functions(
    c: Callable[..., Any],
    dc: Callable[..., Any],
    r: Callable[..., Any],
    rim: ArrayLike | None = None,
    q: Callable[..., Any] | None = None,
) -> Side:
    """A side from functions of t (k,) -> (k, 3): position, its derivative, the derivative across, away from the hole.

    Args:
        rim: parameters t that rise from 0 to 1, as those of a rim's vertices: the Bezier methods take a side that is no
            polynomial as the curve through its points there. None: they refuse such a side.
        q: the second derivative across, in the direction of r, for continuity of curvature (only its part along the normal
            counts). None: not known.
    """
    for name, function in (("c", c), ("dc", dc), ("r", r), ("q", q)):
        if not callable(function) and not (name == "q" and q is None):
            raise wrong_type(name, "Callable", function)
    t = np.zeros(0) if rim is None else np.asarray(rim, dtype=np.float64)
    if rim is not None and not (t.ndim == 1 and len(t) > 1 and t[0] == 0 and t[-1] == 1 and (np.diff(t) > 0).all()):
        raise WrongValue(Message("not_increasing", {"name": "rim"}))
    return Side._from_functions(c, dc, r, t.tolist(), q)


def _part(self: Side, start: float, end: float) -> Side:
    """The piece of the side from one parameter to another, backwards where end < start. On a closed side the larger of the two
    may lie beyond 1, up to a whole turn on.

    Raises:
        ValueError: parameters that are equal or out of range.
    """
    return self._part(real(start, "start"), real(end, "end"))


def _as_dict(self: Report) -> dict[str, Any]:
    """The report as plain values, ready for JSON."""
    values = {name: getattr(self, name) for name, member in vars(Report).items() if isinstance(member, property)}
    rows = [{**each._asdict(), "codes": sorted(each.why.codes)} for each in self.candidates]
    reasons = sorted(self.method_reason.codes) if self.method_reason else []
    return {**values, "candidates": rows, "reason_codes": reasons, "codes": [each.code for each in values["warnings"]]}


def _patch_repr(self: Patch) -> str:
    name = type(self).__name__
    if isinstance(self, BezierTriangle):
        return f"<tripatch.{name}: degree {self.degree}>"
    if isinstance(self, _native.PlanePatch):
        return f"<tripatch.{name}: over the plane of {words.counted(len(self.domain), 'rim vertex')}>"
    return f"<tripatch.{name}: {words.counted(_sides_of(self), 'side')}>"


def _side_repr(self: Side) -> str:
    ends = self.evaluate([0.0, 1.0])[0]
    start, end = ("(" + ", ".join(f"{x:.4g}" for x in point + 0.0) + ")" for point in ends)
    return f"<tripatch.Side: from {start} to {end}>"


def _report_repr(self: Report) -> str:
    said = f"seam within {words.degrees(self.seam_angle_max)}, " if any(self.continuity) else ""
    return f"<tripatch.Report: {self.method or 'no method'}, {said}{words.counted(len(self.warnings), 'warning')}>"


_METHODS: dict[type, dict[str, Any]] = {
    Patch: {
        "_report": None,
        "report": property(_report),
        "evaluate": _evaluate,
        "normal": _normal,
        "positions_and_normals": _positions_and_normals,
        "energy": _patch_energy,
        "triangles": _triangles,
        "on_side": _on_side,
        "__repr__": _patch_repr,
    },
    SzilvasiNagyPatch: {
        "mu": _mu,
        "auxiliary_curve": _auxiliary_curve,
        "correction": _correction,
        "slope_correction": _slope_correction,
    },
    Side: {
        "evaluate": _side_evaluate,
        "part": _part,
        "second_derivative": _second_derivative,
        "from_functions": staticmethod(_from_functions),
        "__repr__": _side_repr,
    },
    Report: {"as_dict": _as_dict, "__repr__": _report_repr},
}
for _class, _methods in _METHODS.items():
    for _name, _function in _methods.items():
        setattr(_class, _name, _function)
