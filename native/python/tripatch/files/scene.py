"""Files of scenes: several meshes, each with its place in the world, whose vertices may have copies along seams."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Hashable, Sequence
from typing import Any

import numpy as np

from .. import _arrays, quality
from .._types import Array
from ..messages import Message
from . import evidence
from .continued import Continued
from .mesh_file import MeshFile
from .writing import FileError


@dataclasses.dataclass
class Part:
    """A mesh of a scene.

    Attributes:
        points: (n, 3) in its own coordinates.
        offsets, corners: its faces.
        matrix: (4, 4) from its own to the world's coordinates, for columns; None: they are the same.
        flipped: whether its faces run the other way round.
        moved: own vertices that are not where the file has them.
        added: places of own vertices that the file has not; between: of those within an edge its ends, and which part of the way.
        own: vertices of the scene for which such vertices were added.
    """

    points: Array
    offsets: Array
    corners: Array
    matrix: Array | None = None
    flipped: bool = False
    moved: set[int] = dataclasses.field(default_factory=set)
    added: list[Array] = dataclasses.field(default_factory=list)
    between: dict[int, tuple[int, int, float]] = dataclasses.field(default_factory=dict)
    own: dict[int, int] = dataclasses.field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.matrix is not None and np.array_equal(self.matrix, np.eye(4)):
            self.matrix = None
        if self.matrix is not None:
            turn = np.linalg.det(self.matrix[:3, :3])
            if not abs(turn) > 1e-12 * np.linalg.norm(self.matrix[:3, :3]) ** 3:
                raise FileError(Message("mesh_scaled_to_zero"))
            self.flipped ^= bool(turn < 0)

    def in_world(self) -> Array:
        """(n, 3) its points there."""
        points = self.points.astype(float)
        return points if self.matrix is None else points @ self.matrix[:3, :3].T + self.matrix[:3, 3]

    def from_world(self, points: Array) -> Array:
        """Points (k, 3) of the world in its own coordinates."""
        return points if self.matrix is None else np.linalg.solve(self.matrix[:3, :3], (points - self.matrix[:3, 3]).T).T

    def point(self, own: int) -> Array:
        """Where one of its own vertices is."""
        return np.asarray(self.points[own] if own < len(self.points) else self.added[own - len(self.points)])

    def add(self, point: Array) -> int:
        """The number of a new own vertex."""
        self.added.append(point)
        return len(self.points) + len(self.added) - 1

    def move(self, own: int, point: Array) -> None:
        """An own vertex goes to another place."""
        if not self.moved:
            self.points = self.points.astype(float)
        self.moved.add(own)
        self.points[own] = point

    def value(self, own: int, of: Callable[[int], Array], blend: bool = True) -> Array:
        """What an own vertex has. of: what those of the file have; blend: within edges that of both ends, else of the nearer."""
        if own not in self.between:
            return of(own)
        a, b, t = self.between[own]
        return blended(of(a), of(b), t if blend else round(t))

    def normals_from_world(self, normals: Array) -> Array:
        """Unit normals (k, 3) of the world in its own coordinates."""
        if self.matrix is None:
            return normals
        own = normals @ self.matrix[:3, :3]
        return np.asarray(own / np.maximum(np.linalg.norm(own, axis=1, keepdims=True), 1e-300))

    def world_corners(self) -> Array:
        """Its corners in the order in which its faces run in the world."""
        if not self.flipped:
            return self.corners
        sizes = np.diff(self.offsets)
        of_face = np.repeat(np.arange(len(sizes)), sizes)
        turned: Array = self.corners[self.offsets[of_face] + self.offsets[of_face + 1] - 1 - np.arange(len(of_face))]
        return turned


def blended(a: Array, b: Array, t: float) -> Array:
    """Of two values that which is t of the way from a to b: numbers are blended, all else is that of the nearer."""
    return np.asarray((1 - t) * a + t * b if a.dtype.kind == "f" and 0 < t < 1 else b if t >= 0.5 else a)


class SceneFile(MeshFile):
    """The meshes of a scene as one, in the world's coordinates. Vertices of a mesh at the same place are one: along seams of
    texture coordinates and normals files have a copy for each side."""

    def __init__(self, parts: Sequence[Part], given: tuple[Array, Any] | None = None) -> None:
        """given: vertices and faces that are numbered as they are, of one part."""
        self._corners: dict[int, list[tuple[int, float]]] = {}  # of faces that have changed: own vertices, and where they were
        self._onto: dict[int, int] = {}
        self._new_points: list[Array] = []
        self._parts = list(parts)
        counts = [len(part.points) for part in parts]
        self._first_own = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        if given:
            offsets, own = _arrays.faces(given[1])
            self._part_of_face = np.zeros(len(offsets) - 1, np.int64)
            self._number_in_part = np.arange(len(offsets) - 1)
            self._own_corners = own
            super().__init__(*given)
            return
        places, corners, sizes, count = [], [], [], 0
        vertices = []
        for part, base in zip(parts, self._first_own.tolist(), strict=False):
            points = part.in_world()
            first, to = _arrays.same_places(points)
            vertices.append(points[first])
            places.append(to + count)
            count += len(first)
            corners.append(part.world_corners() + base)
            sizes.append(np.diff(part.offsets))
        own = np.concatenate([np.zeros(0, np.int64), *corners])
        place = np.concatenate([np.zeros(0, np.int64), *places])
        size = np.concatenate([np.zeros(0, np.int64), *sizes])
        if own.size and not 0 <= own.min() <= own.max() < len(place):
            raise FileError(Message("face_without_vertex", {"name": "faces"}))
        joined = place[own]
        # faces without area since vertices at one place are one
        starts = np.concatenate([[0], np.cumsum(size)]).astype(np.int64)
        before = np.arange(-1, len(joined) - 1)
        before[starts[:-1]] = starts[1:] - 1
        whole = np.ones(len(size), bool)
        whole[np.repeat(np.arange(len(size)), size)[joined == joined[before]]] = False
        kept = np.repeat(whole, size)
        self._own_corners = own[kept]
        self._part_of_face = np.repeat(np.arange(len(parts)), [len(each) for each in sizes])[whole]
        self._number_in_part = np.concatenate([np.zeros(0, np.int64), *(np.arange(len(each)) for each in sizes)])[whole]
        starts = np.concatenate([[0], np.cumsum(size[whole])]).astype(np.int64)
        super().__init__(np.concatenate([np.zeros((0, 3)), *vertices]), (starts, joined[kept]))

    @staticmethod
    def check_suffix(suffix: str) -> None:
        """Raises FileError for a format that cannot be written."""

    def _shares(self, number: int) -> bool:
        """Whether faces of a part share a vertex wherever they meet; else they have copies, whose values differ."""
        return False

    def _join(self, joined: Any) -> None:
        self._onto = dict(zip(joined.moved[0].tolist(), joined.onto.tolist(), strict=True))
        super()._join(joined)

    def _move(self, v: int, place: Array) -> None:
        for f, own in self._copies(v).items():
            number = int(self._part_of_face[f])
            part, there = self._parts[number], self._own_vertex(number, self._onto.get(v, -1))
            if there >= 0 and self._shares(number) and there not in self._own_face(f):
                self._corners[f] = [(there if corner == own else corner, at) for corner, at in self._corners_of(f)]
            else:
                part.move(own, part.point(there) if there >= 0 else part.from_world(place[None])[0])

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        number, corners = int(self._part_of_face[f]), self._corners_of(f)
        part, file = self._parts[number], self._file_face(f)
        first, second = corners[place][1], corners[(place + 1) % len(corners)][1]
        at = first + t * ((second - first) % len(file))
        own = self._own_vertex(number, v) if self._shares(number) else -1
        if own < 0:
            points = self.vertices[v] if v < len(self.vertices) else self._new_points[v - len(self.vertices)]
            own = part.add(part.from_world(points[None])[0])
            part.between[own] = file[int(at)], file[(int(at) + 1) % len(file)], at % 1
            if self._shares(number):
                part.own[v] = own
        corners.insert(place + 1, (own, at))
        self._corners[f] = corners

    def _file_face(self, f: int) -> list[int]:
        """The corners of a face as the file has it, by its part's own vertices."""
        base = int(self._first_own[self._part_of_face[f]])
        first, end = self.faces.offsets[f : f + 2]
        return [v - base for v in self._own_corners[first:end].tolist()]

    def _corners_of(self, f: int) -> list[tuple[int, float]]:
        """The corners of a face by now: its part's own vertices, and where between the corners in the file they are."""
        found = self._corners.get(int(f))
        return list(found) if found else [(v, float(k)) for k, v in enumerate(self._file_face(f))]

    def _own_face(self, f: int) -> list[int]:
        """The corners of a face by its part's own vertices."""
        return [v for v, _ in self._corners_of(f)]

    def _blended_corners(self, f: int, values: Sequence[Array]) -> list[Array]:
        """What the corners of a face have by now. values: of its corners in the file."""
        return [blended(values[int(at)], values[(int(at) + 1) % len(values)], at % 1) for _, at in self._corners_of(f)]

    def _cut(self, f: int) -> Array:
        """(k, 3) triangles of a face by now, by places of its corners, as its part's faces run."""
        part = self._parts[int(self._part_of_face[f])]
        triangles = quality.well_shaped(np.array([part.point(v) for v in self._own_face(f)]))
        return triangles[:, ::-1] if part.flipped else triangles

    def _copies(self, v: int) -> dict[int, int]:
        """Of a vertex its copies: for each face there the part's own vertex."""
        return {f: self._own_face(f)[self._face_by_now(f).index(v)] for f in self._faces_at(v)}

    def _own_vertex(self, number: int, v: int) -> int:
        """A vertex of the scene as a part's own; -1: it has none there."""
        copies = self._copies(v) if 0 <= v < len(self.vertices) else {}
        found = (own for f, own in copies.items() if self._part_of_face[f] == number)
        return next(found, self._parts[number].own.get(v, -1))

    def _home(self, continued: Continued, fill: Any) -> list[int]:
        """For each new face the old one next to which it lies."""
        if continued.model:
            return continued.model
        adjacent = next((f for v in fill.rim for f in self._faces_at(int(v))), 0)
        return [adjacent] * len(fill.faces)

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        groups: dict[Hashable, list[int]] = {}
        home = self._home(continued, fill)
        for k, f in enumerate(home):
            groups.setdefault((int(self._part_of_face[f]), self._look(f)), []).append(k)
        self._new_points += list(fill.vertices)
        n, lists = len(self.vertices), _arrays.index_lists(fill.faces)
        for number, chosen in groups.items():
            part = self._parts[number[0]]  # type: ignore[index]
            rows = [[int(v) for v in lists[k]][:: -1 if part.flipped else 1] for k in chosen]
            self._add(Addition(self, part, number[0], fill, continued, chosen, rows, [home[k] for k in chosen], n))  # type: ignore[index]

    def _add(self, new: Addition) -> None:
        """Adds new faces to a part."""
        raise NotImplementedError


@dataclasses.dataclass
class Addition:
    """New faces of one fill that go to one part.

    Attributes:
        chosen: their numbers in the fill.
        faces: their corners, as the part's faces run: below n vertices of the scene, from there on new ones of the fill.
        models: the old face next to each.
    """

    scene: SceneFile
    part: Part
    number: int
    fill: Any
    continued: Continued
    chosen: list[int]
    faces: list[list[int]]
    models: list[int]
    n: int

    def triangles(self) -> list[tuple[int, list[int]]]:
        """The faces as triangles, each with its place in `faces`, as places of corners."""
        return [(k, [0, c, c + 1]) for k, face in enumerate(self.faces) for c in range(1, len(face) - 1)]

    def at_corners(self, values: Any) -> list[Array] | None:
        """As `Continued.at_corners`, of these faces."""
        made = self.continued.at_corners(values)
        step = -1 if self.part.flipped else 1
        return made and [made[k][::step] for k in self.chosen]

    def copy_of(self, v: int) -> int:
        """A vertex of the scene as the part's own, preferably of a face of the kind next to it; -1: the part has none there."""
        kind, copies = self.scene._look(self.models[0]), self.scene._copies(v)
        like = (own for f, own in copies.items() if self.scene._part_of_face[f] == self.number and self.scene._look(f) == kind)
        return next(like, self.scene._own_vertex(self.number, v))

    def own_vertices(self) -> tuple[dict[int, int], list[int]]:
        """The vertices of the faces as the part's own, and which of them were added for that."""
        numbers, added = {}, []
        for v in dict.fromkeys(v for face in self.faces for v in face):
            whole = v if v < self.n else v + self.scene._added
            numbers[v] = self.copy_of(v) if v < self.n else self.part.own.get(whole, -1)
            if numbers[v] < 0:
                numbers[v] = self.part.own[whole] = self.part.add(self.place_of(v))
                added.append(v)
        return numbers, added

    def place_of(self, v: int) -> Array:
        """In the part's own coordinates."""
        if v >= self.n:
            return np.asarray(self._new_places[v - self.n])
        own = self.copy_of(v)
        return self.part.point(own) if own >= 0 else self.part.from_world(self.scene.vertices[v][None])[0]

    @functools.cached_property
    def _new_places(self) -> Array:
        return self.part.from_world(np.reshape(self.fill.vertices, (-1, 3)))

    def normals(self) -> dict[int, Array]:
        """Of all vertices of the fill, in the part's own coordinates."""
        rim = {int(v): k for k, v in enumerate(self.fill.rim)}
        of_all = np.concatenate([np.reshape(self.fill.rim_normals, (-1, 3)), np.reshape(self.fill.normals, (-1, 3))])
        own = self.part.normals_from_world(of_all)
        made = {v: own[k] for v, k in rim.items() if k < len(self.fill.rim_normals)}
        return made | {self.n + k: own[len(self.fill.rim_normals) + k] for k in range(len(self.fill.normals))}

    def said(self) -> dict[str, Any]:
        """What the file says of the fill."""
        return self.scene._about[-1] if self.scene._marks else {"fill": 0, **evidence.about(self.fill)}
