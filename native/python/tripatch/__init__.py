"""TriPatch fills three-sided holes with patches that continue the surrounding surface exactly.

Corners are 0, 1, 2 in rim order, the direction in which the new faces traverse the rim. Side i is opposite corner i and runs, t
from 0 to 1, from corner i + 1 to corner i + 2. Lengths are in the units of the input, angles in degrees.
"""

from __future__ import annotations

import functools
import inspect
import itertools
import numbers
import warnings
from collections.abc import Callable, Sequence

import numpy as np

from . import _arrays, _native, between
from ._native import Patch, Report, Side, SzilvasiNagyPatch
from .attributes import AttributeWeights, angles, attribute_weights, vertex_normals
from .errors import Refusal
from .surfaces import (
    BezierRectangle,
    BezierTriangle,
    NurbsSurface,
    coons_bezier,
    coons_energy,
    coons_rectangle,
    sides_from_normals,
    smits_patch,
    smooth_triangles,
)

__version__ = "0.1.0"
__all__ = [
    "METHODS",
    "AttributeWeights",
    "BezierRectangle",
    "BezierTriangle",
    "Fill",
    "NurbsSurface",
    "Patch",
    "Refusal",
    "Report",
    "Side",
    "SzilvasiNagyPatch",
    "angles",
    "attribute_weights",
    "between",
    "blend",
    "coons_bezier",
    "coons_energy",
    "coons_rectangle",
    "fill",
    "fill_all",
    "find_corners",
    "find_holes",
    "is_outer_border",
    "patch",
    "sides_from_normals",
    "smits_patch",
    "smooth_triangles",
    "vertex_normals",
]

#: name -> construction, with .description, .citation, .fills_holes, .continuity, and .options: those of `fill` that it reads and
#: not every construction does
METHODS = _native._methods()

_CROSS_BOUNDARY = {name: getattr(_native.CrossBoundary, name) for name in ("given", "consistent", "as_printed")}
_CAGE_RIM = {name: getattr(_native.CageRim, name) for name in ("smooth", "exact", "move")}
_CONTINUITY = ("auto", "Free", "G0", "G1", "G2")
_FAIRING = (None, "auto", "thin_plate", "third_derivative", "minimum_variation", "quadric_variation")
_REPORT = """
    seam_angle_max seam_angle_rms seam_angle_max_by_side seam_angle_rms_by_side continuity surroundings_error
    fairing energy_before energy_after shape_path method method_reason deviation_max triangles_folded folds corners
    cage_deviation_max cage_deviation_rms surroundings_moved_max surroundings_moved_rms surroundings_moved_where
    corners_moved_max seam_angle_median seam_angle_max_inside poles warnings seconds
""".split()


class Fill:
    """A filled hole.

    Attributes:
        vertices: (k, 3) the new vertices only.
        faces: index lists; 0 .. n-1 are the mesh's own vertices (the rim's are reused), n .. are `vertices`.
        normals: (k, 3) exact unit normals of the patch at `vertices`.
        barycentric: (k, 3) of `vertices`, on a patch of three sides.
        uv, rim_uv: (k, 2), (r, 2) of `vertices` and of the rim, on a patch over a plane domain, else None.
        deviation: (k,) standard deviation of `vertices`, in units of the mesh; None where the method does not know it.
        rim: (r,) vertex indices from corner 0 on, no repeat.
        rim_normals: (r, 3) exact one-sided normals of the fill at the rim.
        rim_barycentric: (r, 3).
        moved, split_edges, creases: what a cage option changed outside the fill, as (indices, positions), (edges, t),
            (edges, values); empty where unused.
        border: indices into `vertices` of a fill that is a mesh of its own; empty where the rim is reused.
        sides: the three `Side` objects of the surroundings used; none of a patch without sides.
        patch: the `Patch`.
        report: the `Report`.
    """

    def __init__(self, native, mesh=None) -> None:
        self._mesh, self._native = mesh, native
        self.vertices = native.vertices
        self.normals = native.normals
        self.barycentric = native.barycentric
        self.uv, self.rim_uv = native.uv, native.rim_uv
        self.deviation = native.deviation
        self.rim = native.rim
        self.rim_normals = native.rim_normals
        self.rim_barycentric = native.rim_barycentric
        self.moved = (native.moved, native.moved_to)
        self.split_edges = (np.array(native.split_edges, np.int64).reshape(-1, 2), np.array(native.split_t))
        self.creases = (np.array(native.creases, np.int64).reshape(-1, 2), np.ones(len(native.creases)))
        self.border = native.border
        self.sides = tuple(native.sides)
        self.patch = native.patch
        self.report = native.report

    @functools.cached_property
    def faces(self) -> list[list[int]]:
        """Index lists; 0 .. n-1 are the mesh's own vertices, n .. are `vertices`. Made when first read."""
        offsets, corners = self._native.face_offsets.tolist(), self._native.face_corners.tolist()
        return [corners[a:b] for a, b in itertools.pairwise(offsets)]

    def limit(self, level: int = 3) -> tuple[np.ndarray, np.ndarray]:
        """The limit surface of a fill that is a cage.

        Args:
            level: 2^level quads along each edge of a face.

        Returns:
            vertices (k, 3) and faces (m, 4), of a cage of triangles (m, 3).
        """
        if self._mesh is None:
            raise ValueError("only a fill with output='cage' has a limit surface")
        _whole(level, "level", 1, 8)
        return _limit_of_cage(self, *self._mesh, level)

    def __repr__(self) -> str:
        return (
            f"<tripatch.Fill: {len(self.vertices)} new vertices, {len(self._native.face_offsets) - 1} faces, "
            f"seam within {self.report.seam_angle_max:.2g} deg>"
        )


def _limit_of_cage(fill: Fill, vertices, offsets, corners, replaced, settings, others, level) -> tuple[np.ndarray, np.ndarray]:
    """The cage with the fill, and others that were fitted together with it, in place; and its limit surface in the fill."""
    gone = set(replaced)
    points = vertices.copy()
    faces = [corners[a:b].tolist() for f, (a, b) in enumerate(zip(offsets, offsets[1:], strict=False)) if f not in gone]
    subdivision, first = _native.Subdivision(settings), 0
    for each in [*(other for other in others if other is not fill), fill]:
        n, by = len(vertices), len(points) - len(vertices)

        def own(v, n=n, by=by):
            return v + by if v >= n else v

        points = np.concatenate([points, each.vertices])
        points[each.moved[0]] = each.moved[1]
        for k, edge in enumerate(each.split_edges[0].tolist()):
            for face in faces:
                for place, v in enumerate(face):
                    if {v, face[(place + 1) % len(face)]} == set(edge):
                        face.insert(place + 1, n + by + k)
                        break
        creased = [[own(v) for v in edge] for edge in each.creases[0].tolist()]
        subdivision.crease_edges = subdivision.crease_edges + creased
        subdivision.edge_creases = subdivision.edge_creases + each.creases[1].tolist()
        first = len(faces)
        faces += [[own(v) for v in face] for face in each.faces]
    limit, quads = _native._sample_limit(points, *_arrays.faces(faces), subdivision, first, level)
    return limit, quads.reshape(-1, 3 if settings.loop else 4)


def _name(value, name: str, allowed: Sequence):
    if value is not None and not isinstance(value, str):
        raise TypeError(f"{name} must be a name, not {type(value).__name__}")
    if value not in allowed:
        raise ValueError(f"{name} must be one of {', '.join(str(a) for a in allowed)}, not {value!r}")
    return value


def _method_options(method: str, shape, reading, symmetric=False, alpha=None) -> dict:
    """The options of single methods, as the core reads them."""
    for name, asked in (("symmetric", symmetric is not False), ("alpha", alpha is not None)):
        if asked and name not in METHODS[method].options:
            having = [m for m, about in METHODS.items() if name in about.options]
            raise ValueError(f"{name} is an option of {', '.join(having)}, not of {method}")
    if not isinstance(symmetric, (bool, np.bool_)):
        raise TypeError("symmetric must be True or False")
    if alpha is not None:
        if isinstance(alpha, bool) or not isinstance(alpha, numbers.Real):
            raise TypeError(f"alpha must be a number, or None, not {alpha!r}")
        if not np.isfinite(alpha):
            raise ValueError(f"alpha must be finite, not {alpha}")
    optimal = isinstance(shape, str) and _name(shape, "shape", ("optimal",)) == "optimal"
    values = tuple(float(s) for s in _arrays.three(0.5 if optimal else shape, "shape", numbers.Real))
    for i, s in enumerate(values):
        if not 0 < s < 1:
            raise ValueError(f"shape[{i}] must lie between 0 and 1, ends excluded, not {s}")
    return {
        "shape": values,
        "optimal_shape": optimal,
        "as_printed": _name(reading, "reading", ("corrected", "as_printed")) == "as_printed",
        "symmetric": bool(symmetric),
        "alpha": None if alpha is None else float(alpha),
    }


def _bulge(bulge) -> tuple[float, float, float]:
    values = tuple(float(s) for s in _arrays.three(bulge, "bulge", numbers.Real))
    for i, s in enumerate(values):
        if not (s > 0 and np.isfinite(s)):
            raise ValueError(f"bulge[{i}] must be greater than 0, not {s}")
    return values


def _number(value, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError(f"{name} must be a number, not {value!r}")
    if not np.isfinite(value):
        raise ValueError(f"{name} must be finite, not {value}")
    return float(value)


def _center(center) -> list[float] | None:
    if center is None:
        return None
    position = np.asarray(center)
    if position.dtype.kind not in "fiu":
        raise TypeError(f"center must be a position (3,), or None, not {center!r}")
    if position.shape != (3,) or not np.isfinite(position).all():
        raise ValueError("center must be three finite numbers")
    return position.astype(float).tolist()


def _continuity(continuity) -> tuple[str, str, str]:
    return tuple(_name(c, "continuity", _CONTINUITY) for c in _arrays.three(continuity, "continuity", str))


def _creases(value, name: str, width: int) -> tuple[list, list[float]]:
    """(indices, values) of creases as lists, checked."""
    if value is None:
        return [], []
    places, values = (np.asarray(part) for part in value)
    if places.size == 0:
        return [], []
    if places.dtype.kind not in "iu":
        raise TypeError(f"{name} must hold vertex indices (integers), not {places.dtype}")
    if places.shape[1:] != (() if width == 1 else (width,)) or values.shape != places.shape[:1]:
        raise ValueError(f"{name} must be indices and one value each, not of shapes {places.shape} and {values.shape}")
    if not ((values >= 0) & (values <= 1)).all():
        raise ValueError(f"{name} must be from 0 to 1")
    return places.tolist(), values.astype(float).tolist()


def _whole(value, name: str, low: int, high: int) -> int:
    if isinstance(value, bool) or not isinstance(value, numbers.Integral):
        raise TypeError(f"{name} must be a whole number, not {value!r}")
    if not low <= value <= high:
        raise ValueError(f"{name} must be from {low} to {high}, not {value}")
    return int(value)


def _subdivision(settings: dict | None, level) -> _native.Subdivision:
    """The settings of a Subdivision modifier, as the core reads them."""
    given = {} if settings is None else dict(settings)
    s = _native.Subdivision()
    s.loop = _name(given.pop("scheme", "catmull_clark"), "scheme", ("catmull_clark", "loop")) == "loop"
    smooth = _name(given.pop("boundary_smooth", "all"), "boundary_smooth", ("all", "preserve_corners"))
    s.preserve_corners = smooth == "preserve_corners"
    quality = given.pop("quality", 3)
    s.quality = None if quality is None else _whole(quality, "quality", 1, 10)
    s.use_limit_surface = bool(given.pop("use_limit_surface", True))
    s.level = _whole(level, "level", 0, 8)
    s.crease_edges, s.edge_creases = _creases(given.pop("edge_creases", None), "edge_creases", 2)
    s.crease_vertices, s.vertex_creases = _creases(given.pop("vertex_creases", None), "vertex_creases", 1)
    s.loose_vertices = _arrays.indices(given.pop("loose_vertices", ()), "loose_vertices")
    if given:
        raise ValueError(f"subdivision has no setting {', '.join(map(repr, given))}")
    return s


def _options(
    *,
    method="side_vertex",
    surroundings="mesh",
    subdivision=None,
    level=2,
    continuity="auto",
    cross_boundary="consistent",
    fairing="auto",
    output="triangles",
    resolution=None,
    tolerance=None,
    cage_rim="smooth",
    odd="split",
    pole_offset=(0.0, 0.0),
    bulge=1.0,
    tension=0.0,
    center=None,
    center_offset=0.0,
    shape=(0.5, 0.5, 0.5),
    reading="corrected",
    symmetric=False,
    alpha=None,
    replaced=(),
) -> dict:
    """The options of `fill`, checked, as the core reads them."""
    _name(output, "output", ("triangles", "quads", "cage"))
    limit = _name(surroundings, "surroundings", ("mesh", "limit")) == "limit"
    if resolution is not None:
        resolution = _whole(resolution, "resolution", *((1, 10000) if output == "triangles" else (0, 100)))
    if tolerance is not None:
        if isinstance(tolerance, bool) or not isinstance(tolerance, numbers.Real):
            raise TypeError("tolerance must be a length, or None")
        if not (tolerance > 0 and np.isfinite(tolerance)):
            raise ValueError(f"tolerance must be greater than 0, not {tolerance}")
    offset = np.asarray(pole_offset, dtype=float)
    if offset.shape != (2,) or not np.isfinite(offset).all():
        raise ValueError("pole_offset must be two numbers")
    _name(method, "method", tuple(METHODS))
    return {
        "method": method,
        "continuity": _continuity(continuity),
        "cross_boundary": _CROSS_BOUNDARY[_name(cross_boundary, "cross_boundary", tuple(_CROSS_BOUNDARY))],
        "fairing": _name(fairing, "fairing", _FAIRING) or "",
        "output": output,
        "tolerance": tolerance,
        "cage_rim": _CAGE_RIM[_name(cage_rim, "cage_rim", tuple(_CAGE_RIM))],
        "odd": _name(odd, "odd", ("split", "triangle")),
        "pole_offset": offset.tolist(),
        "resolution": resolution,
        "bulge": _bulge(bulge),
        "tension": _number(tension, "tension"),
        "center": _center(center),
        "center_offset": _number(center_offset, "center_offset"),
        "own": _method_options(method, shape, reading, symmetric, alpha),
        "replaced": _arrays.indices(replaced, "replaced"),
        "limit": limit,
        "subdivision": _subdivision(subdivision, level) if limit or output == "cage" else None,
    }


def _takes_options(function):
    """`help` and editors see the options by name where the code passes them on."""
    own = inspect.signature(function)
    kept = [p for p in own.parameters.values() if p.kind is not p.VAR_KEYWORD]
    function.__signature__ = own.replace(parameters=[*kept, *inspect.signature(_options).parameters.values()])
    return function


def _three_corners(corners) -> list[int]:
    three = _arrays.indices(corners, "corners")
    if len(three) != 3:
        raise ValueError(f"corners must be three vertex indices, not {len(three)}")
    return three


def find_holes(faces) -> list[np.ndarray]:
    """Every border loop of a mesh.

    Args:
        faces: (m, 3) or (m, 4) int array, or a list of index lists.

    Returns:
        An int array for each loop, shortest first, each starting at its lowest index, in the direction that new faces take.
    """
    offsets, corners = _arrays.faces(faces)
    if corners.size and corners.min() < 0:
        raise ValueError("faces must hold vertex indices from 0 on")
    return _native._find_holes(offsets, corners)


def find_corners(vertices, faces, rim, *, replaced=()) -> np.ndarray:
    """The three corners of a rim, detected as `fill` does: where the rim turns, read in the tangent plane of the faces around.

    Args:
        vertices: (n, 3) positions.
        faces: (m, 3) or (m, 4) int array, or a list of index lists.
        rim: vertex indices of the hole's border, any start, either direction.
        replaced: indices of faces that count as not there.

    Returns:
        (3,) vertex indices, in the direction in which new faces traverse the rim.

    Raises:
        Refusal: the rim has not three clear corners, or is none.
    """
    checked = _arrays.mesh(vertices, faces)
    corners = _native._find_corners(*checked, _arrays.indices(rim, "rim"), _arrays.indices(replaced, "replaced"))
    return np.array(corners, np.int64)


def is_outer_border(vertices, faces, rim) -> bool:
    """Whether a border loop is the outer border of an open mesh and no hole: as a whole it turns the other way.

    Without a rim `fill` leaves such borders out, unless the mesh has no other.

    Args:
        vertices: (n, 3) positions.
        faces: (m, 3) or (m, 4) int array, or a list of index lists; those around the border are enough.
        rim: vertex indices of a loop of `find_holes`, in its direction.
    """
    return _native._is_outer_border(*_arrays.mesh(vertices, faces), _arrays.indices(rim, "rim"))


@_takes_options
def fill(vertices, faces, *, rim=None, corners=None, **options) -> Fill:
    """Fills one three-sided hole.

    Args:
        vertices: (n, 3) positions.
        faces: (m, 3) or (m, 4) int array, or a list of index lists.
        rim: vertex indices of the hole's border, any start, either direction. None: the only border loop with three corners.
        corners: three vertex indices of the rim; the first stays corner 0, the others are sorted along the rim. None: detected.
        method: a name in METHODS that fills holes.
        surroundings: "mesh": tangent planes estimated from the faces around; "limit": the subdivision surface of the cage.
        subdivision: with "limit" and "cage": dict(scheme="catmull_clark" | "loop" (triangles only, which Blender
            has not), boundary_smooth="all" | "preserve_corners", quality=3
            (None: the true limit), use_limit_surface=True, edge_creases=((e, 2) int, (e,) 0..1),
            vertex_creases=((k,) int, (k,) 0..1), loose_vertices=(k,) int), all as in Blender.
        level: with "limit": the modifier's level, 2^level border edges a rim edge.
        continuity: "auto", "Free", "G0", "G1" or "G2", one or three (by side). "auto" takes the method's own, and where the
            curvature of the surroundings agrees with that of the neighbours at both corners, fairing follows it, by least
            squares; "G2" meets it, so that the normal curvature has no jump. "G0" meets the rim, with slopes that the corners
            give; "Free" leaves the slopes to the fairing's energy (without fairing it is "G0").
        cross_boundary: "consistent" (Liu, Ma and Cheng 2008, corrected), "given" or "as_printed".
        fairing: None, "thin_plate", "third_derivative" (quadratic, over the triangle), "minimum_variation" (of curvature),
            "quadric_variation" (zero on quadrics), or "auto": softly the smaller of the last two.
        output: "triangles", "quads", or "cage": a few quads whose limit surface is the patch.
        resolution: triangles: edges per side inside the fill, None follows the rim; quads, cage: extra rows round the
            pole(s), None the fewest, 0 to 4, whose deviation from the patch is under `tolerance`.
        tolerance: scene units, of the largest distance of quads, of the rms distance of a cage's limit surface; None: 1e-3 of
            the hole's diameter.
        cage_rim: "smooth": the whole cage is smooth, the surroundings move as little as possible; "exact": rim edges are creased,
            the surroundings of an open hole do not move; "move": rim vertices are free too.
        odd: quads round an odd rim: "split" splits the longest rim edge, "triangle" leaves a triangle at the pole.
        pole_offset: two fractions of the hole that move the pole, along side 2 and towards corner 2.
        bulge: > 0, one or three: scales the slopes inside each side, corners kept.
        tension: >= 0, no unit: pulls the fill tight. At 1 the integral of first derivatives weighs as much as the fairing's
            energy does for a wave as long as the hole. G1 is kept. Needs a fairing.
        center: (3,) where the middle of the patch, b = (1/3, 1/3, 1/3), is to be, in scene units; None: where the fairing puts
            it. G1 is kept.
        center_offset: scene units: the middle is moved by this distance along the fill's normal there. Instead of `center`.
        shape: lambda of the Szilvasi-Nagy methods in (0, 1), by side; or "optimal".
        reading: "corrected", or "as_printed" for the formulas of the Szilvasi-Nagy methods as their paper prints them.
        symmetric: of coons_extremal: the functional summed over the three pairs of coordinates, so that no corner is favoured.
        alpha: of coons_bezier: the permanence patch with this alpha instead of the Coons patch; None: the Coons patch.
        replaced: indices of faces that count as not there: a region to be replaced, with `rim` around it.

    Returns:
        A `Fill`. The input is never changed.

    Raises:
        Refusal: the hole cannot be filled; says why and where.
        TypeError, ValueError: wrong types, shapes, ranges or names.
    """
    checked = _options(**options)
    v, offsets, face_corners = _arrays.mesh(vertices, faces)
    checked["rim"] = None if rim is None else _arrays.indices(rim, "rim")
    if corners is not None:
        checked["corners"] = _three_corners(corners)
    cage = (v, offsets, face_corners, checked["replaced"], checked["subdivision"], ()) if checked["output"] == "cage" else None
    return Fill(_native._fill(v, offsets, face_corners, checked), cage)


@_takes_options
def fill_all(vertices, faces, rims=None, *, corners=None, progress=None, **options) -> list[Fill | Refusal]:
    """Fills several holes of one mesh. The options are those of `fill`. Cages whose surroundings overlap are fitted together.

    Args:
        rims: a list of rims; None: every border loop.
        corners: for each rim three of its vertices, or None where they are to be detected; None: all are detected.
        replaced: indices of the faces in all rims that count as not there.
        progress: called with the number of holes done and the number of all, several times a second; what it raises ends the
            work, as Ctrl-C does.

    Returns:
        A `Fill` or a `Refusal` for each rim, in their order. A refusal of one does not stop the others. Every fill counts its
        new vertices from n on its own.
    """
    checked = _options(**options)
    v, offsets, face_corners = _arrays.mesh(vertices, faces)
    loops = _native._find_holes(offsets, face_corners) if rims is None else rims
    loops = [_arrays.indices(loop, "rim") for loop in loops]
    given = [None if three is None else _three_corners(three) for three in corners or ()]
    if given and len(given) != len(loops):
        raise ValueError(f"corners must be given for each of the {len(loops)} rims, not for {len(given)}")
    results = _native._fill_all(v, offsets, face_corners, loops, checked, given, progress)
    together: list[Fill] = []
    cage = None
    if checked["output"] == "cage":
        cage = (v, offsets, face_corners, checked["replaced"], checked["subdivision"], together)
    fills = [r if isinstance(r, Refusal) else Fill(r, cage) for r in results]
    together += [f for f in fills if isinstance(f, Fill)]
    return fills


def patch(
    sides: Sequence[Side],
    method: str = "side_vertex",
    cross_boundary: str = "consistent",
    *,
    continuity="auto",
    bulge=1.0,
    tension: float = 0.0,
    center=None,
    center_offset: float = 0.0,
    shape=(0.5, 0.5, 0.5),
    reading: str = "corrected",
    symmetric: bool = False,
    alpha: float | None = None,
    fairing: str | None = None,
) -> Patch:
    """A patch from three sides that meet at the corners.

    The options are those of `fill`, but nothing is made fair unless `fairing` says how ("auto" and so on). What a person should
    know of the patch is given as a warning.

    Args:
        sides: three `Side` objects, side i opposite corner i, from corner i + 1 to corner i + 2.

    Returns:
        A `Patch`, for `evaluate` and `normal` at barycentric coordinates (k, 3).

    Raises:
        Refusal: the sides do not meet.
    """
    sides = tuple(sides)
    if len(sides) != 3 or not all(isinstance(side, Side) for side in sides):
        raise TypeError("sides must be three Side objects")
    options = _options(
        method=method,
        cross_boundary=cross_boundary,
        continuity=continuity,
        bulge=bulge,
        tension=tension,
        center=center,
        center_offset=center_offset,
        shape=shape,
        reading=reading,
        symmetric=symmetric,
        alpha=alpha,
        fairing=fairing,
    )
    made, notes = _native._patch(sides, options)
    for note in notes:
        warnings.warn(note, stacklevel=2)
    return made


def blend(
    r0: Patch, r1: Patch, r2: Patch, method: str = "szilvasi_nagy_c1", shape=(0.5, 0.5, 0.5), reading: str = "corrected"
) -> Patch:
    """A patch from three surfaces over one triangle.

    Args:
        r0, r1, r2: three `Patch` objects; r_i carries side i.
        method: a name in METHODS that blends surfaces.
        shape: lambda of the Szilvasi-Nagy methods in (0, 1), by side; or "optimal".
        reading: "corrected", or "as_printed" for the paper's own formula.

    Returns:
        A `Patch`; of the Szilvasi-Nagy methods a `SzilvasiNagyPatch`.
    """
    if not all(isinstance(r, Patch) for r in (r0, r1, r2)):
        raise TypeError("a blend needs three patches")
    _name(method, "method", tuple(METHODS))
    return _native._blend((r0, r1, r2), method, _method_options(method, shape, reading))


def _evaluate(self: Patch, b, derivatives: int = 0):
    """Position and derivatives with respect to (b0, b1), b2 = 1 - b0 - b1.

    Args:
        b: (k, 3) barycentric coordinates.
        derivatives: 0 to 3.

    Returns:
        P (k, 3); with derivatives the tuple (P, D1 (k, 2, 3), D2 (k, 3, 3) in the order 00, 01, 11, D3 (k, 4, 3)).
    """
    if isinstance(derivatives, bool) or not isinstance(derivatives, numbers.Integral):
        raise TypeError("derivatives must be a whole number")
    if not 0 <= derivatives <= 3:
        raise ValueError(f"derivatives must be from 0 to 3, not {derivatives}")
    return self._evaluate(_arrays.barycentric(b), int(derivatives))


def _normal(self: Patch, b) -> np.ndarray:
    """(k, 3) unit normals at barycentric coordinates b (k, 3), on the mesh's outer side."""
    return self._normal(_arrays.barycentric(b))


def _patch_energy(self: Patch, name: str) -> float:
    """A fairness energy, with weights that vanish at the corners.

    Args:
        name: "thin_plate", "third_derivative" (over the equilateral triangle of unit side; units of length squared),
            "minimum_variation", "quadric_variation" or "auto" (over the surface, times its size squared; no units).
    """
    return self._energy(_name(name, "energy", _FAIRING[1:]))


def _places_on_side(edges, i: int) -> list[float]:
    """Parameters from a number of edges, or as they are given."""
    if isinstance(edges, numbers.Integral) or np.ndim(edges) == 0:
        return np.linspace(0, 1, _whole(edges, "edges", 1, 10000) + 1).tolist()
    t = np.asarray(edges, dtype=np.float64)
    if t.ndim != 1 or len(t) < 2 or t[0] != 0 or t[-1] != 1 or not (np.diff(t) > 0).all():
        raise ValueError(f"edges[{i}] must increase from 0 to 1")
    return t.tolist()


def _triangles(self: Patch, edges, resolution: int | None = None) -> tuple[np.ndarray, np.ndarray]:
    """The parameter triangle as triangles, well shaped on the patch.

    Args:
        edges: how many along each side, one or three; or for a side the parameters of its points, increasing from 0 to 1.
        resolution: edges per side inside, 1 or more; None follows the sides.

    Returns:
        Barycentric coordinates (k, 3), those on the sides first, in order from corner 0 along side 2, 0 and 1; faces (m, 3).
    """
    given = (edges,) * 3 if isinstance(edges, numbers.Number) else tuple(edges)
    if len(given) != 3:
        raise ValueError(f"edges must be one value or three, not {len(given)}")
    sides = [_places_on_side(side, i) for i, side in enumerate(given)]
    inside = None if resolution is None else _whole(resolution, "resolution", 1, 10000)
    b, faces = _native._triangles(self, sides, inside)
    return b, np.array(faces, np.int64).reshape(-1, 3)


def _mu(self: SzilvasiNagyPatch, b) -> np.ndarray:
    """(k, 3) the blending functions mu_0, mu_1, mu_2 at barycentric coordinates b (k, 3)."""
    return self._mu(_arrays.barycentric(b))


def _auxiliary_curve(self: SzilvasiNagyPatch, i: int, t) -> np.ndarray:
    """(k, 3) points of the auxiliary curve g_i over side i at t (k,) in [0, 1]."""
    at = np.atleast_1d(np.asarray(t, dtype=np.float64))
    if at.ndim != 1 or not ((at >= 0) & (at <= 1)).all():
        raise ValueError("t must be numbers in [0, 1]")
    return self._auxiliary_curve(_whole(i, "i", 0, 2), at.tolist())


def _correction(self: SzilvasiNagyPatch, b) -> np.ndarray:
    """(k, 3) the correction term q at barycentric coordinates b (k, 3)."""
    return self._correction(_arrays.barycentric(b))


def _slope_correction(self: SzilvasiNagyPatch, b) -> np.ndarray:
    """(k, 3) the correction term s at barycentric coordinates b (k, 3); zero in Definition 1."""
    return self._slope_correction(_arrays.barycentric(b))


def _parameters(t) -> np.ndarray:
    t = np.atleast_1d(np.asarray(t, dtype=np.float64))
    if t.ndim != 1:
        raise ValueError(f"t must have shape (k,), not {t.shape}")
    if not ((t >= 0) & (t <= 1)).all():
        raise ValueError("t must lie in [0, 1]")
    return np.ascontiguousarray(t)


def _side_evaluate(self: Side, t) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Position c, derivative c', derivative across r and unit normal n, (k, 3) each, at t (k,) in [0, 1]."""
    return self._evaluate(_parameters(t))


def _second_derivative(self: Side, t) -> np.ndarray | None:
    """(k, 3) the surroundings' second derivative in the direction of r at t (k,) in [0, 1]; None where it is not known. Its part
    along the normal is r's length squared times the normal curvature across the side; the other parts mean nothing."""
    return self._second_derivative(_parameters(t))


def _from_functions(c: Callable, dc: Callable, r: Callable, rim=None, q: Callable | None = None) -> Side:
    """A side from functions of t (k,) -> (k, 3): position, its derivative, the derivative across, away from the hole.

    Args:
        rim: parameters t that rise from 0 to 1, as those of a rim's vertices: the Bezier methods take a side that is no
            polynomial as the curve through its points there. None: they refuse such a side.
        q: the second derivative across, in the direction of r, for continuity of curvature (only its part along the normal
            counts). None: not known.
    """
    if not all(callable(f) for f in ([c, dc, r] if q is None else [c, dc, r, q])):
        raise TypeError("c, dc, r and q must be functions of t")
    t = np.zeros(0) if rim is None else np.asarray(rim, dtype=np.float64)
    if rim is not None and not (t.ndim == 1 and len(t) > 1 and t[0] == 0 and t[-1] == 1 and (np.diff(t) > 0).all()):
        raise ValueError("rim must be numbers that rise from 0 to 1")
    return Side._from_functions(c, dc, r, t.tolist(), q)


def _part(self: Side, start: float, end: float) -> Side:
    """The piece of the side from one parameter to another, backwards where end < start. On a closed side the larger of the two
    may lie beyond 1, up to a whole turn on.

    Raises:
        ValueError: parameters that are equal or out of range.
    """
    for name, value in (("start", start), ("end", end)):
        if isinstance(value, bool) or not isinstance(value, numbers.Real):
            raise TypeError(f"{name} must be a number, not {value!r}")
    return self._part(float(start), float(end))


def _as_dict(self: Report) -> dict:
    """The report as plain values, ready for JSON."""
    return {name: getattr(self, name) for name in _REPORT}


Patch.evaluate = _evaluate
Patch.normal = _normal
Patch.energy = _patch_energy
Patch.triangles = _triangles
SzilvasiNagyPatch.mu = _mu
SzilvasiNagyPatch.auxiliary_curve = _auxiliary_curve
SzilvasiNagyPatch.correction = _correction
SzilvasiNagyPatch.slope_correction = _slope_correction
Side.evaluate = _side_evaluate
Side.part = _part
Side.second_derivative = _second_derivative
Side.from_functions = staticmethod(_from_functions)
Report.as_dict = _as_dict
