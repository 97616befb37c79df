"""The compiled core (native/bindings): what the package passes on to it. What a user may call is in __init__.pyi."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import BezierRectangle as BezierRectangle
from . import BezierTriangle as BezierTriangle
from . import Choice as Choice
from . import Floats, Indices
from . import Method as Method
from . import NurbsSurface as NurbsSurface
from . import Option as Option
from . import Patch as Patch
from . import Report as Report
from . import Side as Side
from . import SmoothMesh as SmoothMesh
from . import SzilvasiNagyPatch as SzilvasiNagyPatch
from .errors import Refusal
from .messages import Message

# of the compiled classes, what the functions that the package gives them call
class AttributeWeights:
    ends: Indices
    weights: Floats
    nearest: Indices
    __call__: Callable[..., Floats]
    def __init__(self, rim: Floats, inside: Floats, loops: Sequence[int]) -> None: ...
    def _blend(self, values: Floats) -> Floats: ...

class RectangleSurface:
    domain: tuple[float, float, float, float]
    evaluate: Callable[..., Any]
    def _evaluate(self, uv: Floats, derivatives: int) -> Any: ...

class PolygonPatch(Patch):
    domain: Floats
    def _on_side(self, side: int, parameters: Sequence[float]) -> Floats: ...

class RoundPatch(Patch):
    domain: Floats

class RingPatch(Patch):
    def _on_side(self, side: int, parameters: Sequence[float]) -> Floats: ...

class LoopsPatch(Patch):
    domain: Floats
    def _on_side(self, side: int, parameters: Sequence[float]) -> Floats: ...

class PlanePatch(Patch):
    domain: Floats

class Subdivision:
    loop: bool
    preserve_corners: bool
    quality: int | None
    use_limit_surface: bool
    level: int
    crease_edges: list[list[int]]
    edge_creases: list[float]
    crease_vertices: list[int]
    vertex_creases: list[float]
    loose_vertices: list[int]
    def __init__(self, other: Subdivision = ...) -> None: ...

class ConnectedMesh:
    """A mesh with what is found of it once for several questions."""

    def __init__(self, vertices: Floats, offsets: Indices, corners: Indices) -> None: ...
    def borders(self) -> list[Indices]: ...
    def unclosed(self) -> list[Indices]: ...
    def outer_borders(self) -> list[Indices]: ...
    def chosen(self, options: _Options) -> list[Indices]: ...
    def join_borders(
        self, distance: float | None
    ) -> tuple[Indices, Indices, Indices, Indices, list[tuple[int, int, int, float]]] | None: ...
    def holes(
        self, options: _Options, islands: bool
    ) -> tuple[list[list[int]], list[list[list[int]]], dict[int, Refusal], list[list[int]], list[list[int]]]: ...
    def refusals(self, rims: Sequence[Sequence[int]]) -> list[Refusal | None]: ...
    def islands(self, loops: Sequence[Sequence[int]], parts: bool) -> list[list[int]]: ...
    def looks_within(self, loops: Sequence[Sequence[int]], known: npt.NDArray[np.bool_]) -> bool: ...

_PlacesIn = tuple[Any, int, int, tuple[int, int, int], str, bool]

def _box_of_rows(places: _PlacesIn, rows: int) -> tuple[tuple[float, float, float], tuple[float, float, float]]: ...

class FaceRows:
    """The faces of a mesh as rows of bytes in a file, which may be larger than the memory."""

    end: int
    faces: int
    portions: int

    def __init__(
        self,
        data: Any,
        first: int,
        count: int,
        lists: Sequence[tuple[int, str, int]],
        after: int,
        corners: int,
        kind: str,
        swapped: bool,
        vertices: int,
    ) -> None: ...
    def at_borders(self) -> Indices: ...
    def around(
        self, vertices: Indices, rings: int, more: Indices
    ) -> tuple[Indices, npt.NDArray[np.bool_], bytes, npt.NDArray[np.uint64]]: ...
    def connected(self, asked: Indices, without: Indices) -> Indices: ...
    def count_meeting(self, places: _PlacesIn, boxes: Floats) -> list[int]: ...
    def meeting(self, places: _PlacesIn, boxes: Floats) -> list[tuple[int, int]]: ...
    def widened(self, portion: int, by: int) -> bytes: ...

class Filled:
    """A fill as the core returns it: `Fill` wraps it."""

    vertices: Floats
    normals: Floats
    barycentric: Floats
    rim_normals: Floats
    rim_barycentric: Floats
    uv: Floats | None
    rim_uv: Floats | None
    deviation: Floats | None
    moved: Indices
    moved_to: Floats
    creases: list[list[int]]
    crease_values: list[float]
    feature_edges: list[list[int]]
    split_edges: list[list[int]]
    split_t: list[float]
    border: Indices
    rim: Indices
    face_offsets: Indices
    face_corners: Indices
    patch: Patch
    sides: list[Side]
    report: Report
    passes_through: tuple[float, float, float] | None

class CoonsKind: ...
class NormalCurve: ...

surrounding_rings: int

_Options = Mapping[str, Any]

class JoinedMesh:
    """A mesh whose borders lie on each other, by vertices that stand for all at their places."""

    def __init__(self, offsets: Indices, corners: Indices, own: Indices, stands: Indices) -> None: ...
    def in_mesh(self, loop: Sequence[int]) -> Indices: ...
    def bring_back(self, fill: Filled) -> None: ...

def _messages() -> list[tuple[str, str, str, str, str]]: ...
def _format(
    pattern: str, parameters: Mapping[str, Any], where: Sequence[int], vertices: str, panel: bool, names: Mapping[str, str]
) -> str: ...
def _not_taken(method: str, given: dict[str, Any]) -> list[str]: ...
def _options() -> dict[str, Option]: ...
def _methods() -> dict[str, Method]: ...
def _fill(
    vertices: Floats, offsets: Indices, corners: Indices, options: _Options, progress: Callable[[int, int], object] | None
) -> Filled: ...
def _fill_all(
    vertices: Floats,
    offsets: Indices,
    corners: Indices,
    rims: Sequence[Sequence[int]],
    islands: Sequence[Sequence[Sequence[int]]],
    options: _Options,
    by_rim: Sequence[Sequence[int] | None],
    progress: Callable[[int, int], object] | None,
    connected: ConnectedMesh | None,
) -> list[Filled | Refusal]: ...
def _find_holes(offsets: Indices, corners: Indices) -> list[Indices]: ...
def _find_corners(
    vertices: Floats, offsets: Indices, corners: Indices, rim: Sequence[int], replaced: Sequence[int], any_number: bool
) -> list[int]: ...
def _passages_of_faces(
    vertices: Floats, offsets: Indices, corners: Indices, fill_of_face: Sequence[int], subdivision: Subdivision | None
) -> list[tuple[float, float, float] | None]: ...
def _is_outer_border(vertices: Floats, offsets: Indices, corners: Indices, rim: Sequence[int], of_sheet: bool) -> bool: ...
def _mesh_sides(
    vertices: Floats, offsets: Indices, corners: Indices, rim: Sequence[int], at: Sequence[int]
) -> tuple[list[Side], list[list[float]], float]: ...
def set_threads(n: int | None) -> None: ...
def _patch(sides: Sequence[Side], options: _Options, progress: Callable[[int, int], object] | None) -> tuple[Patch, Report]: ...
def _first_outside(b: Floats, off: float) -> int | None: ...
def _blend(surfaces: Sequence[Patch], method: str, options: _Options) -> tuple[Patch, Report]: ...
def _round_patch(side: Side, options: _Options, progress: Callable[[int, int], object] | None) -> tuple[Patch, Report]: ...
def _ring_patch(
    sides: Sequence[Side], options: _Options, progress: Callable[[int, int], object] | None
) -> tuple[Patch, Report]: ...
def _loops_patch(
    loops: Sequence[Sequence[Side]], options: _Options, progress: Callable[[int, int], object] | None
) -> tuple[Patch, Report]: ...
def _loops_triangles(patch: Patch, parameters: Sequence[Sequence[float]], resolution: int | None) -> tuple[Floats, Any]: ...
def _ring_triangles(patch: Patch, parameters: Sequence[Sequence[float]], resolution: int | None) -> tuple[Floats, Any]: ...
def _polygon_patch(
    sides: Sequence[Side], options: _Options, progress: Callable[[int, int], object] | None
) -> tuple[Patch, Report]: ...
def _triangles(patch: Patch, parameters: Sequence[Sequence[float]], resolution: int | None) -> tuple[Floats, list[list[int]]]: ...
def _polygon_triangles(
    patch: Patch, parameters: Sequence[Sequence[float]], resolution: int | None
) -> tuple[Floats, list[list[int]]]: ...
def _disc_triangles(
    patch: Patch, parameters: Sequence[Sequence[float]], resolution: int | None
) -> tuple[Floats, list[list[int]]]: ...
def _evenly_run(sides: Sequence[Side]) -> list[Side]: ...
def _joined_side(pieces: Sequence[Side], parameters: Sequence[Sequence[float]]) -> tuple[Side, list[float]]: ...
def _vertex_normals(vertices: Floats, offsets: Indices, corners: Indices, corner_normals: Floats) -> Floats: ...
def _angles(a: Floats, b: Floats) -> Floats: ...
def _triangles_of(vertices: Floats, offsets: Indices, corners: Indices) -> tuple[Indices, Indices]: ...
def _sample_limit(
    vertices: Floats, offsets: Indices, corners: Indices, settings: Subdivision, first: int, level: int
) -> tuple[Floats, Indices]: ...
def _sides_from_normals(points: Floats, normals: Floats, curve: NormalCurve) -> tuple[Side, Side, Side]: ...
def _smits_patch(points: Floats, normals: Floats) -> Patch: ...
def _smooth_triangles(
    vertices: Floats, offsets: Indices, corners: Indices, normals: Floats | None, resolution: int, curve: NormalCurve, keep: bool
) -> SmoothMesh: ...
def _network(
    vertices: Floats, offsets: Indices, corners: Indices, edges: Sequence[tuple[int, int]], sides: Sequence[Side], resolution: int
) -> SmoothMesh: ...
def _rational_triangle(net: Floats, weights: Sequence[float]) -> Patch: ...
def _triangle_on(surface: RectangleSurface, corners: Sequence[Sequence[float]], moved: Sequence[Sequence[float]]) -> Patch: ...
def _coons_bezier(curves: Sequence[Floats], kind: CoonsKind, alpha: float | None) -> tuple[BezierTriangle, list[Message]]: ...
def _coons_rectangle(boundary: BezierRectangle, alpha: float | None) -> BezierRectangle: ...
def _coons_energy(surface: BezierTriangle | BezierRectangle, symmetric: bool) -> float: ...
