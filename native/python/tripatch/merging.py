"""Whole tasks: a mesh with its fills in place, and a mesh without holes, of the kind that it was given in."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from . import _arrays, trimeshes
from ._types import Array, ArrayLike, Faces
from .borders import Joined
from .errors import FillWarning, Refusal, WrongType, WrongValue, wrong_type
from .files.mesh_file import MeshFile
from .filling import Fill, Fills, fill_all
from .holes import choose_holes
from .messages import Message
from .options import OPTIONS, checked, takes_options


class HolesReport:
    """What became of the holes of a mesh.

    Attributes:
        fills: the `Fill` of each hole that was filled.
        refusals: the `Refusal` of each hole that was not.
        results: both, in the order of the holes.
        outer_borders: the border loops that were left open as outer ones.
        joined: as of `Fills`, which `fill_all` returns.
        warnings: of all fills.
    """

    results: list[Fill | Refusal]
    outer_borders: list[Array]
    joined: Joined | None

    def __init__(self, results: Fills) -> None:
        self.results, self.outer_borders, self.joined = list(results), results.outer_borders, results.joined

    @property
    def fills(self) -> list[Fill]:
        """The `Fill` of each hole that was filled."""
        return [each for each in self.results if isinstance(each, Fill)]

    @property
    def refusals(self) -> list[Refusal]:
        """The `Refusal` of each hole that was not filled."""
        return [each for each in self.results if isinstance(each, Refusal)]

    @property
    def warnings(self) -> list[Message]:
        """The warnings of all fills."""
        return [each for fill in self.fills for each in fill.report.warnings]

    def as_dict(self) -> dict[str, Any]:
        """The report as plain values, ready for JSON."""

        def plain(each: Fill | Refusal) -> dict[str, Any]:
            if isinstance(each, Refusal):
                codes = [said.code for said in each.messages]
                return {"refused": each.reason, "codes": codes, "where": each.where}
            added = {"rim": each.rim.tolist(), "new_vertices": len(each.vertices), "new_faces": len(each.faces)}
            return {**added, **each.report.as_dict()}

        borders = [loop.tolist() for loop in self.outer_borders]
        joined = self.joined.as_dict() if self.joined else None
        return {"holes": [plain(each) for each in self.results], "outer_borders": borders, "joined": joined}

    def __repr__(self) -> str:
        return f"<tripatch.HolesReport: {len(self.fills)} filled, {len(self.refusals)} refused>"


class _Merged:
    """The faces of a mesh and of its fills as one mesh."""

    def __init__(self, vertices: ArrayLike, faces: Faces, results: Sequence[Fill | Refusal], joined: Joined | None) -> None:
        v, offsets, corners = _arrays.mesh(vertices, faces)
        self.count = len(v)
        self.fills = [each for each in results if isinstance(each, Fill)]
        self.vertices = np.concatenate([v, *(fill.vertices for fill in self.fills)])
        for moved in [*([joined.moved] if joined else []), *(fill.moved for fill in self.fills)]:
            self.vertices[moved[0]] = moved[1]
        of_face = None
        if joined and joined.splits:
            offsets, corners, of_face = joined.triangles(self.vertices, offsets, corners)
        first, sizes = self.count, np.diff(offsets)
        parts, counts = [], []
        for fill in self.fills:
            for k, (a, b) in enumerate(fill.split_edges[0].tolist()):
                corners, sizes = _split(corners, sizes, a, b, first + k)
            new, own = fill._flat_faces()
            parts.append(np.where(own >= self.count, own + (first - self.count), own))
            counts.append(np.diff(new))
            first += len(fill.vertices)
        gone = np.unique(np.concatenate([fill.replaced for fill in self.fills])) if self.fills else np.zeros(0, np.int64)
        if len(gone):
            kept = np.ones(len(sizes), bool)
            kept[gone if of_face is None else np.isin(of_face, gone)] = False
            corners, sizes = corners[np.repeat(kept, sizes)], sizes[kept]
        self.corners = np.concatenate([corners, *parts])
        self.offsets = np.concatenate([[0], np.cumsum(np.concatenate([sizes, *counts]))]).astype(np.int64)


def _split(corners: Array, sizes: Array, a: int, b: int, new: int) -> tuple[Array, Array]:
    """Faces whose edge from a to b, or from b to a, has a new vertex."""
    ends = np.cumsum(sizes)
    following = np.roll(corners, -1)
    following[ends - 1] = corners[ends - sizes]
    at = np.flatnonzero(((corners == a) & (following == b)) | ((corners == b) & (following == a)))
    sizes = sizes.copy()
    sizes[np.searchsorted(ends, at, "right")] += 1
    return np.insert(corners, at + 1, new), sizes


def merge(vertices: ArrayLike, faces: Faces, fills: Fill | Refusal | Sequence[Fill | Refusal]) -> tuple[Array, Any]:
    """A mesh with fills in place.

    Args:
        vertices: (n, 3) positions.
        faces: (m, 3) or (m, 4) int array, or a list of index lists.
        fills: one `Fill` of this mesh or several, or all that `fill_all` returns, which joins borders too; a `Refusal` adds
            nothing.

    Returns:
        Vertices: the mesh's own, where neither a cage option nor `join` moved them, then those of each fill. Faces: the mesh's
        own without those that a fill replaces, with triangles that `join` splits as several, then those of each fill; an array
        (m, 3) or (m, 4) if all have as many corners, else index lists, and lists where lists were given.

    Raises:
        ValueError: two of the fills close the same hole.

    Example:
        >>> vertices = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]
        >>> faces = [[1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]  # an octahedron without a face
        >>> fill = tripatch.fill(vertices, faces)
        >>> whole_vertices, whole_faces = tripatch.merge(vertices, faces, fill)
        >>> len(tripatch.find_holes(whole_faces))
        0
    """
    if not isinstance(fills, Fill | Refusal | Iterable):
        raise wrong_type("fills", "Fill | Sequence[Fill]", fills)
    results = [fills] if isinstance(fills, Fill | Refusal) else list(fills)
    rims = set[frozenset[int]]()
    for each in results:
        if not isinstance(each, Fill | Refusal):
            raise wrong_type("fills", "Fill | Sequence[Fill]", fills)
        if isinstance(each, Fill):
            rim = frozenset(each.rim.tolist())
            if rim in rims:
                raise WrongValue(Message("hole_filled_twice", {}, [min(rim)]))
            rims.add(rim)
    whole = _Merged(vertices, faces, results, fills.joined if isinstance(fills, Fills) else None)
    return whole.vertices, _like(faces, whole.offsets, whole.corners)


def _like(faces: Faces, offsets: Array, corners: Array) -> Any:
    """Faces as arrays where arrays were given and as lists where lists were."""
    if not isinstance(faces, np.ndarray):
        return _arrays.index_lists(_arrays.rows(offsets, corners))
    rows = _arrays.rows(offsets, corners)
    return rows.astype(faces.dtype) if isinstance(rows, np.ndarray) and faces.dtype != object else rows


@takes_options("fill_all")
def fill_holes(
    mesh_or_vertices: Any,
    faces: Faces | None = None,
    *,
    return_report: bool = False,
    rims: Any = None,
    corners: Any = None,
    islands: str = "auto",
    join: float | None = None,
    progress: Callable[[int, int], object] | None = None,
    **options: Any,
) -> Any:
    """A mesh without its holes: every hole that `fill_all` finds is filled, and the whole mesh comes back.

    Args:
        mesh_or_vertices: (n, 3) float, positions; or a whole mesh: a `trimesh.Trimesh`, what `read` returns, a pair (vertices,
            faces), or any object that has .vertices and .faces and can be made from them.
        faces: (m, 3) or (m, 4) int, or a list of index lists; indices count from 0. None if a whole mesh is given.
        return_report: whether a `HolesReport` is returned too. In the fills of a Trimesh, vertices at the same place count as
            one; texture seams have such vertices.
        rims, corners, islands, join, progress: as of `fill_all`.
        **options: see OPTIONS.

    Returns:
        The filled mesh, of the kind that was given: a pair (vertices, faces), or a mesh. The mesh's own vertices and faces come
        first, in their order, and keep colors, texture coordinates, normals and other data. The data of a new vertex is
        interpolated from those around the hole; a new face gets the data of the nearest face around the hole. With
        return_report a pair of the filled mesh and the report. What was given stays unchanged.

    Raises:
        Refusal: no hole could be filled, and no report was requested.
        TypeError, ValueError: an argument has the wrong type, shape, range or name.

    Warns:
        FillWarning: holes that were refused or all left out by options, and warnings of fills, if no report was requested.

    Example:
        >>> vertices = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]
        >>> faces = [[1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]  # an octahedron without a face
        >>> new_vertices, new_faces = tripatch.fill_holes(vertices, faces)
        >>> len(faces), len(new_faces)
        (7, 8)
    """
    mesh = mesh_or_vertices
    vertices, own = _arrays.parts(mesh, faces, "fill_holes")
    as_pair = not hasattr(mesh, "vertices")
    checked("fill_all", options, "fill_holes")
    welded = None
    if trimeshes.is_one(mesh):
        welded = trimeshes.Welded(mesh)
        vertices, own = welded.vertices, welded.faces
        rims = rims if rims is None else [welded.rim(loop) for loop in rims]
        corners = corners if corners is None else [each if each is None else welded.rim(each) for each in corners]
    asked: dict[str, Any] = {"corners": corners, "islands": islands, "join": join, "progress": progress}
    report = HolesReport(fill_all(np.asarray(vertices), own, rims, **asked, **options))
    if not return_report:
        if report.refusals and not report.fills:
            raise report.refusals[0]
        filters = [name for name in options if "choose_holes" in OPTIONS[name].functions and name != "outer"]
        if filters and not report.fills and choose_holes(vertices, own):
            warnings.warn(FillWarning(Message("all_holes_filtered")), stacklevel=2)
        for refusal in report.refusals:
            warnings.warn(FillWarning(Message("hole_not_filled", {"reason": refusal.messages[0]}, refusal.where)), stacklevel=2)
        for said in report.warnings:
            warnings.warn(FillWarning(said), stacklevel=2)
    made = (
        trimeshes.filled(mesh, welded, report.fills, report.joined) if welded else _filled(mesh, vertices, own, report, as_pair)
    )
    return (made, report) if return_report else made


def _filled(mesh: Any, vertices: ArrayLike, faces: Faces, report: HolesReport, as_pair: bool) -> Any:
    if not as_pair and isinstance(mesh, MeshFile):
        return mesh.filled(report.fills, report.joined)
    whole = _Merged(vertices, faces, report.fills, report.joined)
    kind, rows = np.asarray(vertices).dtype, _like(faces, whole.offsets, whole.corners)
    points = whole.vertices.astype(kind) if kind.kind == "f" else whole.vertices
    return (points, rows) if as_pair else _rebuilt(mesh, points, rows)


def _rebuilt(mesh: Any, vertices: Array, rows: Any) -> Any:
    """An object of the same class with other vertices and faces."""
    try:
        if dataclasses.is_dataclass(mesh) and not isinstance(mesh, type):
            return dataclasses.replace(mesh, vertices=vertices, faces=rows)
        if hasattr(mesh, "_replace"):  # a named tuple
            return mesh._replace(vertices=vertices, faces=rows)
        return type(mesh)(vertices=vertices, faces=rows)
    except TypeError as error:
        name = type(mesh).__name__
        raise WrongType(Message("mesh_not_made", {"type": name, "reason": str(error)})) from error
