"""A part of a mesh that is too large for the memory: its holes are filled by a process that sees no more than the part."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Generator, Sequence
from typing import Any

import numpy as np

from .. import borders
from .._types import Array
from ..errors import Refusal
from ..files import evidence
from ..files.ply import PlyFile
from ..files.ply_parts import PlyParts
from ..filling import fill_all
from . import job, record
from .settings import Settings

#: Of the size of a fill and its distance from the origin: by how much its box is larger, which is more than rounding makes it.
_MARGIN = 1e-9


@dataclasses.dataclass
class Task:
    """What a process needs of a part. Vertices are numbered as in the part, but for `numbers`.

    Attributes:
        file: the part, a PLY file.
        numbers: of its vertices in the whole mesh, -1 of those that frame it; count: how many that has.
        known: for each vertex whether all faces at it are in the part.
        holes: places in the list of all holes; rims, islands: of each.
        frame: a rim that is none, of vertices as far apart as those of all holes; empty where there is one hole.
        stands: for each vertex the one that stands for it; None: all do for themselves.
        name: of the whole file.
    """

    file: bytes
    numbers: Array
    count: int
    known: Array
    holes: list[int]
    rims: list[list[int]]
    islands: list[list[list[int]]]
    frame: list[int]
    stands: Array | None
    name: str


@dataclasses.dataclass
class Filled:
    """What became of a hole.

    Attributes:
        line: what is said of it, but for its place.
        about: what the file says of its fill; the rest: None where there is none.
        vertices: how many it adds, and their rows; faces: likewise.
        corners: in the rows of its faces, the bytes that corners begin at, and their vertices: from the number of those of the
            whole mesh on they are the fill's own.
        marks: the bytes that the number of the fill begins at.
        box: lowest and highest coordinates of what it touches; meeting: how many faces of the part meet that.
    """

    line: dict[str, Any]
    about: dict[str, Any] | None = None
    vertices: tuple[int, bytes] = (0, b"")
    faces: tuple[int, bytes] = (0, b"")
    corners: tuple[Array, Array] = (np.zeros(0, np.int64), np.zeros(0, np.int64))
    marks: Array = dataclasses.field(default_factory=lambda: np.zeros(0, np.int64))
    box: Array | None = None
    meeting: int = 0


#: What became of holes, by their places in the list of all; None: more of the mesh is needed.
Found = dict[int, Filled | None]
#: The place of a part, and what became of its holes, as they are done.
Answers = Generator[tuple[int, Found], None, None]


def fill(task: Task, settings: Settings) -> Found:
    """What became of the holes of a part."""
    mesh = PlyFile(task.file)
    vertices, faces = mesh.vertices, mesh.faces
    holes = borders.Holes.of_part(vertices, faces.offsets, faces.corners, task.rims, task.islands, task.stands)
    known = task.known if task.stands is None else _known_together(task.known, task.stands)
    loops = [[rim, *islands] for rim, islands in zip(task.rims, task.islands, strict=True)]
    enough = [holes.connected.looks_within(each, known) for each in loops]
    found: Found = dict.fromkeys(task.holes)
    kept = _apart_from(task, [k for k, is_enough in enumerate(enough) if not is_enough])
    if not kept:
        return found
    holes.rims, holes.islands = [task.rims[k] for k in kept], [task.islands[k] for k in kept]
    if task.frame:
        holes.rims.append(task.frame)
        holes.islands.append([])
    try:
        results: list[Any] = list(fill_all(vertices, faces, holes, **settings.filling()))[: len(kept)]
    except Refusal as refusal:  # of what is asked for, not of one hole
        results = [refusal] * len(kept)
    sharp = job.largest_creases(vertices, faces, results)
    told = [_told(task, settings, result, sharp[k]) for k, result in enumerate(results)]
    for k, each in zip(kept, _with_rows(task, mesh, results, told), strict=True):
        found[task.holes[k]] = each
    return found


def _known_together(known: Array, stands: Array) -> Array:
    """For vertices that stand for others whether the faces at all of these are known."""
    made = np.ones(len(known), bool)
    np.logical_and.at(made, stands, known)
    return made


def _apart_from(task: Task, left: list[int]) -> list[int]:
    """The holes that share no vertex with those that are left, nor with one that does."""
    rims = [set(rim).union(*islands) for rim, islands in zip(task.rims, task.islands, strict=True)]
    gone, front = set(left), list(left)
    while front:
        own = rims[front.pop()]
        near = [k for k, rim in enumerate(rims) if k not in gone and not own.isdisjoint(rim)]
        gone.update(near)
        front += near
    return [k for k in range(len(rims)) if k not in gone]


def _numbering(task: Task) -> Callable[[int], int]:
    """From the part's numbers of vertices to those of the whole mesh, and of a fill's own that follow them."""
    count, here = task.count, len(task.numbers)
    return lambda v: int(task.numbers[v]) if v < here else v - here + count


def _told(task: Task, settings: Settings, result: Any, sharp: float | None) -> dict[str, Any]:
    number = _numbering(task)
    if isinstance(result, Refusal):
        return record.of_hole(settings, task.name, result.renumbered(number), crease_max=sharp)
    line: dict[str, Any] = record.of_hole(settings, task.name, result, crease_max=sharp)
    corners, warnings = line["corners"], [each.renumbered(number) for each in result.report.warnings]
    line |= record.plain({"corners": corners and [number(v) for v in corners], "warnings": warnings})
    return line


def _with_rows(task: Task, mesh: PlyFile, results: Sequence[Any], told: list[dict[str, Any]]) -> list[Filled]:
    """The same with what the fills add to the file."""
    made = [Filled(line) for line in told]
    fills = [(own, result) for own, result in zip(made, results, strict=True) if not isinstance(result, Refusal)]
    if not fills:
        return made
    number, marked = _numbering(task), mesh.marked()
    marked._find_edges([result.rim for _, result in fills])
    vertex, face = marked._vertex, marked._face
    boxes = []
    for own, result in fills:
        if result.options.get("islands"):
            loops = [[number(v) for v in loop] for loop in result.options["islands"]]
            result._source.options = {**result.options, "islands": loops}  # as they are called in the whole mesh
        rows = len(vertex.new), len(face.new)
        marked.append(result)
        about = marked._about[-1]
        own.about = {name: value for name, value in about.items() if name != "fill"}
        own.vertices = len(result.vertices), b"".join(vertex.new[rows[0] :])
        own.faces = len(result.faces), b"".join(face.new[rows[1] :])
        offsets, corners = result._flat_faces()
        places, own.marks = _places(marked, own.faces[1], np.diff(offsets))
        here = len(task.numbers)
        inside = corners < here
        own.corners = places, np.where(inside, task.numbers[np.where(inside, corners, 0)], corners - here + task.count)
        points = np.concatenate([mesh.vertices[np.unique(corners[inside])], result.vertices])
        boxes.append(_box(points))
    for (own, _), box, count in zip(fills, boxes, PlyParts(task.file).count_meeting(np.array(boxes)), strict=True):
        own.box, own.meeting = box, int(count)
    return made


def _box(points: Array) -> Array:
    low, high = points.min(axis=0), points.max(axis=0)
    margin = _MARGIN * (np.abs(points).max() + np.linalg.norm(high - low))
    return np.concatenate([low - margin, high + margin])


def _places(mesh: PlyFile, rows: bytes, sizes: Array) -> tuple[Array, Array]:
    """Of rows of new faces the bytes that their corners begin at, and those of the number of their fill. sizes: of the faces."""
    face, mark = mesh._face, mesh._face.index(evidence.FILL)
    if len(face.lists()) > 1:
        return _places_by_row(mesh, rows, len(sizes))
    at, before, index = np.zeros(len(sizes), np.int64), {}, mesh._index
    for k, (_, kind, of_count) in enumerate(face.properties):
        at = at + (np.dtype(of_count).itemsize if of_count else 0)
        before[k] = at
        at = at + np.dtype(kind).itemsize * (sizes if of_count else 1)
    starts = np.cumsum(at) - at
    within = np.arange(int(sizes.sum())) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    corners = np.repeat(starts + before[index], sizes) + np.dtype(face.properties[index][1]).itemsize * within
    return corners, starts + before[mark]


def _places_by_row(mesh: PlyFile, rows: bytes, count: int) -> tuple[Array, Array]:
    """The same where rows have other lists, which may be empty."""
    face, mark = mesh._face, mesh._face.index(evidence.FILL)
    corners: list[int] = []
    marks, at = [], 0
    for _ in range(count):
        for k, (_, kind, of_count) in enumerate(face.properties):
            entries, size = 1, np.dtype(kind).itemsize
            if of_count:
                entries = int(np.frombuffer(rows, mesh._order + of_count, 1, at)[0])
                at += np.dtype(of_count).itemsize
            if k == mesh._index:
                corners += range(at, at + entries * size, size)
            elif k == mark:
                marks.append(at)
            at += entries * size
    return np.array(corners, np.int64), np.array(marks, np.int64)
