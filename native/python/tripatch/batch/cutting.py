"""The holes of a mesh in a mapped file, found by the faces at its borders alone, and parts of it with some of the holes each."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from .. import borders
from .._types import Array
from ..files.ply import PlyFile
from ..files.ply_parts import PlyParts
from ..holes import SURROUNDING_RINGS
from ..options import checked
from .parts import Task

#: Faces of a part, about: seconds of work, and some hundred megabytes in the process that fills it.
PART_FACES = 1 << 19


def _edges_inside(faces: Any, at_border: Array) -> tuple[Array, Array]:
    """Edges of one face between vertices at which faces are missing, as the face runs."""
    offsets, corners = faces.offsets, faces.corners
    following = np.roll(corners, -1)
    following[offsets[1:] - 1] = corners[offsets[:-1]]
    both = ~at_border[corners] & ~at_border[following] & (corners != following)
    a, b = corners[both], following[both]
    _, first, count = np.unique(np.minimum(a, b) * len(at_border) + np.maximum(a, b), return_index=True, return_counts=True)
    return a[first[count == 1]], b[first[count == 1]]


class BorderMesh:
    """The faces at the borders of a mesh, and flat ones for all others: borders and connected parts are as in the whole.

    Attributes:
        holes: of it; vertices: of it, of which the last two are as far apart as all of the whole mesh.
        numbers: of its vertices in the whole mesh.
    """

    def __init__(self, ply: PlyParts, choosing: dict[str, Any]) -> None:
        """choosing: options of `choose_holes`."""
        seen = ply.rows.at_borders()
        file, self.numbers, _ = ply.part(seen, 1)
        near = PlyFile(file)
        at_border = np.isin(self.numbers, seen, assume_unique=True)
        x, y = _edges_inside(near.faces, at_border)
        flat = [np.column_stack([y, x, x]), *self._links(ply, file, seen, at_border, x, y)]
        added = np.concatenate(flat).reshape(-1)
        offsets = np.concatenate([near.faces.offsets, near.faces.offsets[-1] + 3 * np.arange(1, len(added) // 3 + 1)])
        corners = np.concatenate([near.faces.corners, added])
        low, high = ply.box()
        self.vertices = np.concatenate([near.vertices, [low, high]]) if (low <= high).all() else near.vertices
        self.holes = borders.Holes(self.vertices, offsets, corners, checked("choose_holes", choosing), "auto", None)

    def _links(self, ply: PlyParts, file: bytes, seen: Array, at_border: Array, x: Array, y: Array) -> list[Array]:
        """Faces between pieces that are one in the whole mesh, each with its back, so that no border is added."""
        whole = ply.rows.connected(self.numbers[x], seen)
        piece = PlyParts(file).rows.connected(x, np.flatnonzero(at_border))
        first = np.unique(np.column_stack([whole, piece]), axis=0, return_index=True)[1]
        whole, x, y = whole[first], x[first], y[first]
        next_to = np.flatnonzero(whole[1:] == whole[:-1])
        a, b, c, d = x[next_to], y[next_to], x[next_to + 1], y[next_to + 1]
        return [np.column_stack(each) for each in ((a, b, c), (c, b, a), (c, d, b), (b, d, c))]

    def number(self, vertex: int) -> int:
        """That of a vertex in the whole mesh."""
        return int(self.numbers[vertex])

    def copies(self) -> dict[int, Array]:
        """By vertices that stand for others all of these, by the whole mesh's numbers."""
        stands = self.holes.stands
        if stands is None:
            return {}
        stands = stands[: len(self.numbers)]
        moved = np.flatnonzero(stands != np.arange(len(stands)))
        order = moved[np.argsort(stands[moved], kind="stable")]
        root, starts = np.unique(stands[order], return_index=True)
        groups = np.split(order, starts[1:])
        return {int(self.numbers[v]): self.numbers[np.concatenate([[v], own])] for v, own in zip(root, groups, strict=True)}


@dataclasses.dataclass
class Cut:
    """How a hole is cut out of the mesh.

    Attributes:
        rim, islands: by the whole mesh's vertices.
        rings: of faces around it that its part has.
        more: where other faces begin that its part has.
        together: the holes that are in the same part, by their places in the list of all.
    """

    rim: Array
    islands: list[Array]
    rings: int
    together: list[int]
    more: set[int] = dataclasses.field(default_factory=set)

    @property
    def loops(self) -> list[Array]:
        return [self.rim, *self.islands]

    @property
    def expected_faces(self) -> int:
        """About how many faces the part has for it."""
        edges = sum(map(len, self.loops))
        return 2 * self.rings * (edges + 3 * self.rings) + len(self.more)


def _rings(vertices: Array, loops: Sequence[Sequence[int]]) -> list[int]:
    """Of each loop: rings that are likely to be enough for it, farther than it is wide, and as many as are always looked at."""
    sizes = np.array([len(loop) for loop in loops], np.int64)
    starts = np.cumsum(sizes) - sizes
    points = vertices[np.concatenate([np.asarray(loop, np.int64) for loop in loops])] if len(loops) else np.zeros((0, 3))
    following = np.arange(1, len(points) + 1)
    following[starts + sizes - 1] = starts
    with np.errstate(invalid="ignore", over="ignore"):
        edges = np.linalg.norm(points[following] - points, axis=1)
        low, high = np.minimum.reduceat(points, starts), np.maximum.reduceat(points, starts)
        wide = np.linalg.norm(high - low, axis=1) / np.maximum(np.add.reduceat(edges, starts) / sizes, 1e-300)
    least = SURROUNDING_RINGS + 1
    rings: list[int] = (
        np.maximum(least, 4 + np.ceil(np.minimum(np.nan_to_num(wide, nan=0, posinf=0), sizes))).astype(int).tolist()
    )
    return rings


class Cuts:
    """How all holes of a mesh are cut out, and in which parts."""

    def __init__(self, ply: PlyParts, mesh: BorderMesh, name: str) -> None:
        self._ply, self._name, holes = ply, name, mesh.holes
        self.of_hole: dict[int, Cut] = {}
        free: list[list[int]] = []
        rings = iter(_rings(mesh.vertices, [loop for k, rim in enumerate(holes.rims) for loop in (rim, *holes.islands[k])]))
        for k, rim in enumerate(holes.rims):
            loops = [mesh.numbers[loop] for loop in (rim, *holes.islands[k])]
            enough = max(next(rings) for _ in loops)
            if k in holes.refused:
                continue
            self.of_hole[k] = Cut(loops[0], loops[1:], enough, [k])
            if not holes.islands[k]:
                free.append(rim)
        # a rim that is refused, with which the holes of any part reach as far as all do: coordinates are rounded alike
        self._frame = None
        points = mesh.vertices[np.concatenate([np.asarray(rim, np.int64) for rim in free])] if len(free) > 1 else np.zeros((0, 3))
        points = points[np.isfinite(points).all(axis=1)]
        if len(points):
            low, high = points.min(axis=0), points.max(axis=0)
            self._frame = np.array([low, high, [high[0], low[1], low[2]]])
        self._copies = mesh.copies()
        self._stands = {int(v): root for root, own in self._copies.items() for v in own}
        self._unite_touching()

    def _unite_touching(self) -> None:
        first: dict[int, int] = {}
        for k, cut in self.of_hole.items():
            for loop in cut.loops:
                for v in loop.tolist():
                    other = first.setdefault(v, k)
                    if other not in cut.together:
                        self.unite(k, other)

    def unite(self, a: int, b: int) -> None:
        """Has two holes in the same part."""
        both = sorted({*self.of_hole[a].together, *self.of_hole[b].together})
        for k in both:
            self.of_hole[k].together = both

    def tasks_of(self, wanted: Sequence[int]) -> Iterator[list[int]]:
        """Parts with holes that are wanted, and with those that have to be filled with them."""
        groups = {min(each): each for each in (self.of_hole[k].together for k in wanted)}

        def place(group: list[int]) -> tuple[int, int]:
            cuts = [self.of_hole[k] for k in group]
            return max(cut.rings for cut in cuts).bit_length(), min(int(cut.rim[0]) for cut in cuts)

        part: list[int] = []
        size, kind = 0, 0
        for group in sorted(groups.values(), key=place):
            own = sum(self.of_hole[k].expected_faces for k in group)
            if part and (size + own > PART_FACES or place(group)[0] != kind):
                yield sorted(part)
                part, size = [], 0
            part += group
            size, kind = size + own, place(group)[0]
        if part:
            yield sorted(part)

    def task(self, holes: list[int]) -> Task:
        """A part with some holes."""
        cuts = [self.of_hole[k] for k in holes]
        around = np.unique(np.concatenate([loop for cut in cuts for loop in cut.loops]))
        rings, more = max(cut.rings for cut in cuts), sorted(set().union(*(cut.more for cut in cuts)))
        around = self._with_copies(around)
        while True:
            file, numbers, known = self._ply.part(around, rings, more, self._frame)
            wider = self._with_copies(numbers[known & (numbers >= 0)]) if self._copies else around
            wider = np.union1d(around, np.setdiff1d(wider, numbers[known])) if self._copies else around
            if len(wider) == len(around):
                break
            around = wider
        count = len(numbers) - (0 if self._frame is None else len(self._frame))

        def here(loop: Array) -> list[int]:
            found: list[int] = np.searchsorted(numbers[:count], loop).tolist()
            return found

        stands = None
        if self._stands and any(int(v) in self._stands for v in numbers[:count]):
            roots = np.array([self._stands.get(int(v), int(v)) for v in numbers[:count]], np.int64)
            # what stands for vertices at the end of the part only may lie beyond it
            place = np.minimum(np.searchsorted(numbers[:count], roots), count - 1)
            stands = np.where(numbers[place] == roots, place, np.arange(count))
            stands = np.concatenate([stands, np.arange(count, len(numbers))])
        rims, islands = [here(cut.rim) for cut in cuts], [[here(loop) for loop in cut.islands] for cut in cuts]
        frame = list(range(count, len(numbers))) if any(not cut.islands for cut in cuts) else []
        return Task(file, numbers, self._ply.count, known, holes, rims, islands, frame, stands, self._name)

    def _with_copies(self, vertices: Array) -> Array:
        """With all that stand for the same as they."""
        if not self._copies:
            return vertices
        own = [self._copies[self._stands[v]] for v in vertices.tolist() if v in self._stands]
        found: Array = np.unique(np.concatenate([vertices, *own]))
        return found
