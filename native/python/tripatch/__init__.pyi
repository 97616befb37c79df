from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import between as between
from .candidates import Candidate as Candidate
from .errors import FillWarning as FillWarning
from .errors import Refusal as Refusal
from .files import FileError as FileError
from .files import MeshFile as MeshFile
from .files import read as read
from .files import write as write
from .messages import Message as Message

__version__: str
__all__: list[str]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Faces = NDArray[np.integer[Any]] | Sequence[Sequence[int]]
# begin choices: scripts/stubs
Surroundings = Literal["mesh", "limit"]
Continuity = Literal["auto", "Free", "G0", "G1", "G2"]
CrossBoundary = Literal["given", "consistent", "as_printed"]
Fairing = Literal["auto", "thin_plate", "third_derivative", "minimum_variation", "quadric_variation", "isometric"]
Output = Literal["triangles", "quads", "cage"]
Cap = Literal["auto", "flat", "dome"]
CageRim = Literal["smooth", "exact", "move"]
Odd = Literal["split", "triangle"]
Reading = Literal["corrected", "as_printed"]
# end
Shape = float | tuple[float, float, float] | Literal["optimal"]
Curve = Literal["hermite", "smits"]

class Method:
    name: str
    description: str
    citation: str
    fills_holes: bool
    continuity: Literal["G0", "G1", "G2"]
    joins_sides: bool
    sides: tuple[int, int | None]
    options: tuple[str, ...]
    def takes(self, name: str) -> bool: ...

METHODS: dict[str, Method]

class Choice:
    name: str
    label: str
    description: str
    misprint: bool

class Range:
    least: float
    most: float
    open: bool

class Option:
    name: str
    kind: Literal["flag", "whole", "number", "choice", "indices", "loops", "position", "points", "subdivision"]
    default: Any
    optional: bool
    by_side: bool
    count: int
    choices: list[Choice]
    none: Choice | None
    description: str
    seen: str
    range: Range
    soft: Range
    unit: str
    label: str
    applies: tuple[tuple[str, str], ...]
    functions: tuple[str, ...]
    selection: bool
    panel: bool

OPTIONS: dict[str, Option]
SURROUNDING_RINGS: int

class Patch:
    report: Report | None
    _report: Report | None
    def evaluate(self, b: ArrayLike, derivatives: int = 0) -> Any: ...
    def normal(self, b: ArrayLike) -> Floats: ...
    def positions_and_normals(self, b: ArrayLike) -> tuple[Floats, Floats]: ...
    def energy(self, name: str) -> float: ...
    def on_side(self, i: int, t: ArrayLike) -> Floats: ...
    def triangles(self, edges: int | Sequence[int | ArrayLike], resolution: int | None = None) -> tuple[Floats, Indices]: ...
    def _evaluate(self, b: Floats, derivatives: int) -> Any: ...
    def _normal(self, b: Floats) -> Floats: ...
    def _positions_and_normals(self, b: Floats) -> tuple[Floats, Floats]: ...
    def _energy(self, name: str) -> float: ...

class BezierTriangle(Patch):
    degree: int
    net: Floats
    elevated: Callable[[], BezierTriangle]
    def __init__(self, net: ArrayLike) -> None: ...
    def derivative(self, direction: ArrayLike) -> BezierTriangle: ...
    def side(self, i: int) -> Floats: ...
    def _derivative(self, direction: Sequence[float]) -> BezierTriangle: ...
    def _side(self, i: int) -> Floats: ...

class SzilvasiNagyPatch(Patch):
    shape: list[float]
    path: list[tuple[list[float], float]]
    def mu(self, b: ArrayLike) -> Floats: ...
    def auxiliary_curve(self, i: int, t: ArrayLike) -> Floats: ...
    def correction(self, b: ArrayLike) -> Floats: ...
    def slope_correction(self, b: ArrayLike) -> Floats: ...
    def _mu(self, b: Floats) -> Floats: ...
    def _auxiliary_curve(self, i: int, t: Sequence[float]) -> Floats: ...
    def _correction(self, b: Floats) -> Floats: ...
    def _slope_correction(self, b: Floats) -> Floats: ...

class _Rectangle:
    domain: tuple[float, float, float, float]
    def evaluate(self, uv: ArrayLike, derivatives: int = 0) -> Any: ...

class BezierRectangle(_Rectangle):
    net: Floats
    def __init__(self, net: ArrayLike) -> None: ...

class NurbsSurface(_Rectangle):
    def __init__(self, points: ArrayLike, weights: ArrayLike | None, knots_u: ArrayLike, knots_v: ArrayLike) -> None: ...

class Side:
    def __init__(self, surface: BezierTriangle | BezierRectangle | NurbsSurface, edge: int, reversed: bool = False) -> None: ...
    @staticmethod
    def from_functions(
        c: Callable[[Floats], Floats],
        dc: Callable[[Floats], Floats],
        r: Callable[[Floats], Floats],
        rim: ArrayLike | None = None,
        q: Callable[[Floats], Floats] | None = None,
    ) -> Side: ...
    def evaluate(self, t: ArrayLike) -> tuple[Floats, Floats, Floats, Floats]: ...
    def part(self, start: float, end: float) -> Side: ...
    def second_derivative(self, t: ArrayLike) -> Floats | None: ...
    @staticmethod
    def _from_functions(
        c: Callable[[Floats], Floats],
        dc: Callable[[Floats], Floats],
        r: Callable[[Floats], Floats],
        rim: Sequence[float],
        q: Callable[[Floats], Floats] | None,
    ) -> Side: ...
    def _evaluate(self, t: Floats) -> tuple[Floats, Floats, Floats, Floats]: ...
    def _second_derivative(self, t: Floats) -> Floats | None: ...
    def _part(self, start: float, end: float) -> Side: ...
    def _moved(self, start: Sequence[float], end: Sequence[float]) -> Side: ...

class Report:
    seam_angle_max: float
    seam_angle_rms: float
    seam_angle_max_by_side: list[float]
    seam_angle_rms_by_side: list[float]
    continuity: list[Literal["Free", "G0", "G1", "G2", "none"]]
    boundary_gap: float
    corner_planes_angle: list[float]
    corner_normals_spread: list[float]
    surroundings_error: float
    fairing: str
    energy_before: float
    energy_after: float
    shape_path: list[tuple[list[float], float]]
    method: str
    method_reason: Message | Literal[""]
    candidates: list[Candidate]
    deviation_max: float | None
    triangles_folded: int
    rim_folded: int
    is_flawed: bool
    crosses_itself: bool
    folds: int
    corners: list[int]
    cage_deviation_max: float
    cage_deviation_rms: float
    surroundings_moved_max: float
    surroundings_moved_rms: float
    surroundings_moved_where: int
    corners_moved_max: float
    seam_angle_median: float
    seam_angle_max_inside: float
    rows: int
    cage_in_rows: bool
    poles: list[list[int]]
    warnings: list[Message]
    not_applied: dict[str, str]
    seconds: float
    def __init__(self) -> None: ...
    def as_dict(self) -> dict[str, Any]: ...

class Fill:
    vertices: Floats
    faces: Indices | list[list[int]]
    replaced: Indices
    normals: Floats
    barycentric: Floats
    uv: Floats | None
    rim_uv: Floats | None
    deviation: Floats | None
    passes_through: tuple[float, float, float] | None
    rim: Indices
    loops: list[int]
    rim_normals: Floats
    rim_barycentric: Floats
    moved: tuple[Indices, Floats]
    split_edges: tuple[Indices, Floats]
    creases: tuple[Indices, Floats]
    border: Indices
    feature_edges: Indices
    sides: tuple[Side, ...]
    patch: Patch
    report: Report
    def limit(self, level: int = 3) -> tuple[Floats, Indices]: ...

class AttributeWeights:
    ends: Indices
    weights: Floats
    nearest: Indices
    def __call__(self, values: ArrayLike) -> Floats: ...

class SmoothMesh:
    vertices: Floats
    faces: Indices
    normals: Floats
    edges: Indices
    patches: list[Patch]

class NurbsPatch:
    surfaces: list[NurbsSurface]
    points: list[Floats]
    knots: list[tuple[list[float], list[float]]]
    exact: bool
    deviation: float
    angle: float

class CutWeights:
    edge: Floats
    inside: Floats
    corners: Floats
    nearest: Indices
    def __init__(self, smooth: SmoothMesh, triangles: ArrayLike, count: int) -> None: ...
    def __call__(self, values: ArrayLike) -> Floats: ...
    def at_new_vertices(self, values: ArrayLike, edges: ArrayLike, triangles: ArrayLike) -> Floats: ...

def attribute_weights(rim: Fill | ArrayLike, inside: ArrayLike | None = None, loops: Sequence[int] = ()) -> AttributeWeights: ...
def vertex_normals(vertices: ArrayLike, faces: Faces, corner_normals: ArrayLike | None = None) -> Floats: ...
def angles(a: ArrayLike, b: ArrayLike) -> Floats: ...
def find_holes(faces: Faces) -> list[Indices]: ...
def choose_holes(
    vertices: Any,
    faces: Faces | None = None,
    *,
    # begin choose_holes: scripts/stubs
    max_edges: int | None = None,
    max_diameter: float | None = None,
    corner_count: tuple[int, int] | None = None,
    outer: bool = False,
    # end
) -> list[Indices]: ...
def find_corners(
    vertices: ArrayLike, faces: Faces, rim: Sequence[int] | Indices, *, replaced: Sequence[int] = (), any_number: bool = False
) -> Indices: ...
def outer_borders(vertices: Any, faces: Faces | None = None) -> list[Indices]: ...
def is_outer_border(vertices: ArrayLike, faces: Faces, rim: Sequence[int] | Indices, *, of_sheet: bool = False) -> bool: ...
def fill(
    vertices: Any,
    faces: Faces | None = None,
    *,
    progress: Callable[[int, int], object] | None = None,
    # begin fill: scripts/stubs
    rim: Sequence[int] | Indices | None = None,
    corners: Sequence[int] | Indices | None = None,
    islands: Sequence[Sequence[int] | Indices] = (),
    method: str = "auto",
    surroundings: Surroundings = "mesh",
    subdivision: dict[str, Any] | None = None,
    level: int = 2,
    continuity: Continuity | Sequence[Continuity] = "auto",
    cross_boundary: CrossBoundary = "consistent",
    fairing: Fairing | None = "auto",
    output: Output = "triangles",
    resolution: int | None = None,
    features: bool = True,
    cap: Cap = "auto",
    tolerance: float | None = None,
    cage_rim: CageRim = "smooth",
    odd: Odd = "split",
    pole_offset: tuple[float, float] = (0.0, 0.0),
    bulge: float | Sequence[float] = 1.0,
    tension: float = 0.0,
    center: ArrayLike | None = None,
    center_offset: float = 0.0,
    through: Sequence[ArrayLike] = (),
    shape: float | Sequence[float] | Literal["optimal"] = 0.5,
    reading: Reading = "corrected",
    symmetric: bool = False,
    alpha: float | None = None,
    replaced: Sequence[int] | Indices = (),
    # end
) -> Fill: ...

class Fills(list[Fill | Refusal]):
    rims: list[Indices]
    outer_borders: list[Indices]

def fill_all(
    vertices: Any,
    faces: Faces | None = None,
    rims: Sequence[Sequence[int] | Indices] | None = None,
    *,
    corners: Sequence[Sequence[int] | Indices | None] | None = None,
    islands: Literal["auto", "none"] = "auto",
    join: float | None = None,
    progress: Callable[[int, int], object] | None = None,
    # begin fill_all: scripts/stubs
    method: str = "auto",
    surroundings: Surroundings = "mesh",
    subdivision: dict[str, Any] | None = None,
    level: int = 2,
    continuity: Continuity | Sequence[Continuity] = "auto",
    cross_boundary: CrossBoundary = "consistent",
    fairing: Fairing | None = "auto",
    output: Output = "triangles",
    resolution: int | None = None,
    features: bool = True,
    cap: Cap = "auto",
    tolerance: float | None = None,
    cage_rim: CageRim = "smooth",
    odd: Odd = "split",
    pole_offset: tuple[float, float] = (0.0, 0.0),
    bulge: float | Sequence[float] = 1.0,
    tension: float = 0.0,
    center: ArrayLike | None = None,
    center_offset: float = 0.0,
    shape: float | Sequence[float] | Literal["optimal"] = 0.5,
    reading: Reading = "corrected",
    symmetric: bool = False,
    alpha: float | None = None,
    replaced: Sequence[int] | Indices = (),
    max_edges: int | None = None,
    max_diameter: float | None = None,
    corner_count: tuple[int, int] | None = None,
    outer: bool = False,
    # end
) -> Fills: ...
def fill_holes(
    mesh_or_vertices: Any,
    faces: Faces | None = None,
    *,
    return_report: bool = False,
    rims: Sequence[Sequence[int] | Indices] | None = None,
    corners: Sequence[Sequence[int] | Indices | None] | None = None,
    islands: Literal["auto", "none"] = "auto",
    join: float | None = None,
    progress: Callable[[int, int], object] | None = None,
    # begin fill_all: scripts/stubs
    method: str = "auto",
    surroundings: Surroundings = "mesh",
    subdivision: dict[str, Any] | None = None,
    level: int = 2,
    continuity: Continuity | Sequence[Continuity] = "auto",
    cross_boundary: CrossBoundary = "consistent",
    fairing: Fairing | None = "auto",
    output: Output = "triangles",
    resolution: int | None = None,
    features: bool = True,
    cap: Cap = "auto",
    tolerance: float | None = None,
    cage_rim: CageRim = "smooth",
    odd: Odd = "split",
    pole_offset: tuple[float, float] = (0.0, 0.0),
    bulge: float | Sequence[float] = 1.0,
    tension: float = 0.0,
    center: ArrayLike | None = None,
    center_offset: float = 0.0,
    shape: float | Sequence[float] | Literal["optimal"] = 0.5,
    reading: Reading = "corrected",
    symmetric: bool = False,
    alpha: float | None = None,
    replaced: Sequence[int] | Indices = (),
    max_edges: int | None = None,
    max_diameter: float | None = None,
    corner_count: tuple[int, int] | None = None,
    outer: bool = False,
    # end
) -> Any: ...
def merge(vertices: ArrayLike, faces: Faces, fills: Fill | Refusal | Sequence[Fill | Refusal]) -> tuple[Floats, Any]: ...

class HolesReport:
    results: list[Fill | Refusal]
    outer_borders: list[Indices]
    def __init__(self, results: Fills) -> None: ...
    @property
    def fills(self) -> list[Fill]: ...
    @property
    def refusals(self) -> list[Refusal]: ...
    @property
    def warnings(self) -> list[str]: ...
    def as_dict(self) -> dict[str, Any]: ...

def set_threads(n: int | None) -> None: ...
def patch(
    sides: Sequence[Side],
    method: str = "auto",
    cross_boundary: CrossBoundary = "consistent",
    *,
    fairing: Fairing | None = None,
    tolerance: float | None = None,
    islands: Sequence[Sequence[Side]] = (),
    progress: Callable[[int, int], object] | None = None,
    # begin patch: scripts/stubs
    continuity: Continuity | Sequence[Continuity] = "auto",
    bulge: float | Sequence[float] = 1.0,
    tension: float = 0.0,
    center: ArrayLike | None = None,
    center_offset: float = 0.0,
    through: Sequence[ArrayLike] = (),
    shape: float | Sequence[float] | Literal["optimal"] = 0.5,
    reading: Reading = "corrected",
    symmetric: bool = False,
    alpha: float | None = None,
    # end
) -> Patch: ...

Constituent = Patch | tuple[BezierRectangle | NurbsSurface, ArrayLike] | Callable[[Floats], ArrayLike]

def rational_triangle(net: ArrayLike, weights: ArrayLike) -> Patch: ...
def triangle_on(surface: BezierRectangle | NurbsSurface, corners: ArrayLike, moved: ArrayLike | None = None) -> Patch: ...
def surface_of(function: Callable[[Floats], ArrayLike], name: str = "function") -> BezierTriangle: ...
def blend(
    r0: Constituent,
    r1: Constituent,
    r2: Constituent,
    method: str = "szilvasi_nagy_c1",
    shape: Shape = (0.5, 0.5, 0.5),
    reading: Reading = "corrected",
) -> Patch: ...
def sides_from_normals(points: ArrayLike, normals: ArrayLike, curve: Curve = "hermite") -> tuple[Side, Side, Side]: ...
def smits_patch(points: ArrayLike, normals: ArrayLike) -> Patch: ...
def coons_bezier(
    boundary: Sequence[ArrayLike],
    kind: Literal["discrete", "extremal", "extremal_symmetric", "mask", "permanence"] = "discrete",
    alpha: float | None = None,
) -> BezierTriangle: ...
def coons_rectangle(boundary: BezierRectangle, alpha: float | None = None) -> BezierRectangle: ...
def coons_energy(surface: BezierTriangle | BezierRectangle, symmetric: bool = False) -> float: ...
def nurbs(patch: Patch, tolerance: float | None = None) -> NurbsPatch: ...
def write_step(
    path: str | PathLike[str], patches: Patch | Iterable[Patch], tolerance: float | None = None, unit: str = "MM"
) -> list[NurbsPatch]: ...
def network(
    vertices: ArrayLike,
    triangles: Faces,
    curves: str | Mapping[tuple[int, int], Any] = "hermite",
    normals: ArrayLike | Mapping[tuple[int, int], Any] | None = None,
    resolution: int = 8,
) -> SmoothMesh: ...
def smooth_triangles(
    vertices: ArrayLike, faces: Faces, normals: ArrayLike | None = None, resolution: int = 8, curve: Curve = "hermite"
) -> SmoothMesh: ...
