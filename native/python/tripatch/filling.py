"""Filling holes: from a mesh to new faces."""

from __future__ import annotations

import copy
import dataclasses
import functools
import operator
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from . import _arrays, _native, passages, words
from ._native import Patch, Report, Side
from ._types import Array, Faces
from .borders import Holes, Joined
from .errors import Refusal, WrongValue, not_one_of
from .holes import SURROUNDING_RINGS
from .messages import Message
from .options import OPTIONS, checked, not_at_default, takes_options, value, whole


class Fill:
    """A filled hole.

    Attributes:
        vertices: (k, 3) the new vertices only.
        faces: (m, 3) or (m, 4) int array if all have as many corners, else index lists; 0 .. n-1 are the mesh's own vertices
            (the rim's are reused), n .. are `vertices`.
        normals: (k, 3) exact unit normals of the patch at `vertices`.
        barycentric: (k, 3) of `vertices`, on a patch of three sides.
        uv, rim_uv: (k, 2), (r, 2) of `vertices` and of the rim, on a patch over a plane domain, else None.
        deviation: (k,) standard deviation of `vertices`, in units of the mesh; None where the method does not know it.
        feature_edges: (k, 2) edges of the fill, numbered as in `faces`, on which creases of the surroundings continue, and those
            of the rim where a lid meets the mesh at an angle.
        rim: (r,) vertex indices from corner 0 on, no repeat; those of islands follow.
        loops: how many of them each loop has, that around the islands first.
        rim_normals: (r, 3) exact one-sided normals of the fill at the rim.
        rim_barycentric: (r, 3).
        moved, split_edges, creases: what a cage option changed outside the fill, as (indices, positions), (edges, t),
            (edges, values); empty where unused.
        replaced: indices of the mesh's faces that the fill takes the place of.
        border: indices into `vertices` of a fill that is a mesh of its own; empty where the rim is reused.
        sides: the three `Side` objects of the surroundings used; none of a patch without sides.
        patch: the `Patch`.
        report: the `Report`.
        passes_through: a place (x, y, z) where it goes through a face of the mesh that is not at its rim, else None.
    """

    vertices: Array
    normals: Array
    barycentric: Array
    uv: Array | None
    rim_uv: Array | None
    deviation: Array | None
    rim: Array
    rim_normals: Array
    rim_barycentric: Array
    moved: tuple[Array, Array]
    split_edges: tuple[Array, Array]
    creases: tuple[Array, Array]
    feature_edges: Array
    border: Array
    sides: tuple[Side, ...]
    report: Report

    def __init__(self, native: _native.Filled, source: Source) -> None:
        self._source, self._filled, self._patch = source, native, native.patch
        self._has_patch = self._patch is not None
        self.passes_through: tuple[float, float, float] | None = native.passes_through
        if self._has_patch:
            vars(self._patch)["_recipe"] = functools.partial(source.recipe, self.rim, self.vertices)

    def __getattr__(self, name: str) -> Any:
        """What is read for the first time: of ten thousand fills most is not."""
        filled, read = vars(self).get("_filled"), _READ.get(name)
        if filled is None or read is None:
            raise AttributeError(f"a Fill has no {name}")
        made = vars(self)[name] = read(filled)
        return made

    def _whole(self) -> dict[str, Any]:
        """All that it holds, without what that is read from."""
        for name in _READ:
            getattr(self, name)
        return {name: value for name, value in vars(self).items() if name != "_filled"}

    @functools.cached_property
    def replaced(self) -> Array:
        """Indices of the mesh's faces that the fill takes the place of."""
        return np.array(self.options.get("replaced", ()), np.int64)

    @functools.cached_property
    def loops(self) -> list[int]:
        """How many vertices each loop of the rim has, that around the islands first."""
        islands = self.options.get("islands") or ()
        inside = [len(loop) for loop in islands] if not isinstance(islands, str) else []
        return [len(self.rim) - sum(inside), *inside]

    @property
    def patch(self) -> Patch:
        """The `Patch`; of a fill that was pickled it is made again when first asked for."""
        if self._patch is None and self._has_patch:
            self._patch = self._source.patch(self.vertices)
        return self._patch

    @property
    def options(self) -> dict[str, Any]:
        """The options that were given."""
        return self._source.options

    def __getstate__(self) -> dict[str, Any]:
        near = self._source.near(self._corners)
        return {**self._whole(), "_patch": None, "_source": near}

    def __deepcopy__(self, memo: dict[int, Any]) -> Fill:
        made = memo[id(self)] = object.__new__(Fill)
        shared = ("_source", "_patch")
        vars(made).update({name: v if name in shared else copy.deepcopy(v, memo) for name, v in self._whole().items()})
        return made

    @functools.cached_property
    def faces(self) -> Any:
        """(m, 3) or (m, 4) int array if all have as many corners, else index lists; 0 .. n-1 are the mesh's own vertices,
        n .. are `vertices`. Made when first read."""
        return _arrays.rows(*self._flat_faces())

    def _flat_faces(self) -> tuple[Array, Array]:
        """Offsets (m + 1,) and corners, one face after another."""
        return self._offsets, self._corners

    def limit(self, level: int = 3) -> tuple[Array, Array]:
        """The limit surface of a fill that is a cage.

        Args:
            level: 2^level quads along each edge of a face.

        Returns:
            vertices (k, 3) and faces (m, 4), of a cage of triangles (m, 3).
        """
        if self._source.options.get("output") != "cage":
            raise WrongValue(Message("no_limit_surface"))
        return self._source.limit(self, whole(level, "level", 1, 8))

    def __repr__(self) -> str:
        said = f"{words.counted(len(self.vertices), 'new vertex')}, {words.counted(len(self._offsets) - 1, 'face')}"
        seam = f", seam within {words.degrees(self.report.seam_angle_max)}" if self.sides else ""
        return f"<tripatch.Fill: {said} by {self.report.method}{seam}>"

    def _repr_png_(self) -> bytes:
        """The picture that a notebook shows: the fill and what is around it, in zebra stripes."""
        from .batch import crops
        from .canvas import png
        from .view import picture

        points, offsets, corners = self._source.in_place()
        crop: Any = crops.of_fill(points, _arrays.rows(offsets, corners), self)
        toward = np.asarray(self.rim_normals).sum(axis=0) + self.normals.sum(axis=0)
        toward = toward if np.linalg.norm(toward) > 0 else np.array([0.0, 0, 1])
        return png(picture(crop["vertices"], [*crop["around"], *crop["fill"]], size=(480, 360), toward=toward)[0])


def _pairs(edges: list[list[int]]) -> Array:
    return np.array(edges, np.int64).reshape(-1, 2)


#: How the attributes of a `Fill` are read from that of the core.
_READ: dict[str, Callable[[_native.Filled], Any]] = {
    **{
        name: operator.attrgetter(name)
        for name in (
            *("vertices", "normals", "barycentric", "uv", "rim_uv", "deviation"),
            *("rim", "rim_normals", "rim_barycentric", "border", "report"),
        )
    },
    "_offsets": operator.attrgetter("face_offsets"),
    "_corners": operator.attrgetter("face_corners"),
    "moved": lambda filled: (filled.moved, filled.moved_to),
    "split_edges": lambda filled: (_pairs(filled.split_edges), np.array(filled.split_t)),
    "creases": lambda filled: (_pairs(filled.creases), np.array(filled.crease_values, np.float64)),
    "feature_edges": lambda filled: _pairs(filled.feature_edges),
    "sides": lambda filled: tuple(filled.sides),
}


class Fills(list["Fill | Refusal"]):
    """What `fill_all` makes: a list of a `Fill` or a `Refusal` for each hole.

    Attributes:
        rims: of each hole its rim.
        outer_borders: the border loops that were left open as outer ones; none where rims are named.
        joined: what `join` changes in the mesh, as `merge` does it: `moved`, vertices and their new places, and `splits`,
            vertices that faces get within their edges. None where it changes nothing.
    """

    rims: list[Array]
    outer_borders: list[Array]
    joined: Joined | None

    def __init__(
        self,
        results: Iterable[Fill | Refusal] = (),
        rims: Sequence[Array] = (),
        outer_borders: Sequence[Array] = (),
        joined: Joined | None = None,
    ) -> None:
        super().__init__(results)
        self.rims, self.outer_borders, self.joined = list(rims), list(outer_borders), joined


@dataclasses.dataclass
class Source:
    """What a fill was made from, so that it can be made again.

    Attributes:
        function: "fill" or "fill_all".
        vertices, offsets, corners: of the mesh.
        options: those that were given.
        rim: of this fill; its corners where `fill_all` was told them.
        others: cages that were fitted together with it.
        kept: of a part of a mesh the numbers that its vertices have there; whole: how many there are.
    """

    function: str
    vertices: Array
    offsets: Array
    corners: Array
    options: dict[str, Any]
    rim: list[int]
    rim_corners: list[int] | None = None
    others: list[Fill] = dataclasses.field(default_factory=list)
    kept: Array | None = None
    whole: int = 0

    def in_place(self) -> tuple[Array, Array, Array]:
        """Vertices, offsets and corners of the faces that are there, in the mesh's own numbers."""
        if self.kept is None:
            return self.vertices, self.offsets, self.corners
        points = np.zeros((self.whole, 3))
        points[self.kept] = self.vertices
        return points, self.offsets, self.kept[self.corners]

    def fill(self) -> Any:
        """The fill, as the core returns it."""
        mesh = self.vertices, self.offsets, self.corners
        if self.function == "fill":
            given = checked("fill", {**self.options, "rim": self.rim})
            return _native._fill(*mesh, not_at_default("fill", given), None)
        given = checked("fill_all", self.options)
        return _native._fill_all(*mesh, [self.rim], [], given, [self.rim_corners], None, None)[0]

    def patch(self, vertices: Array) -> Patch:
        """The patch of the fill that has these vertices."""
        made = self.fill()
        if isinstance(made, Refusal) or not np.array_equal(made.vertices, vertices):
            raise WrongValue(Message("mesh_changed_since"))
        patch: Patch = made.patch
        vars(patch)["_recipe"] = functools.partial(self.recipe, made.rim, vertices)
        return patch

    def recipe(self, rim: Array, vertices: Array) -> tuple[Any, ...]:
        """For pickle: what makes the patch of the fill with this rim and these vertices."""
        return Source.patch, (self.near(rim), vertices)

    def near(self, used: Array) -> Source:
        """The same with the faces alone that the fill depends on: those around vertices that it uses."""
        given = checked(self.function, self.options)
        if self.kept is not None or given["output"] == "cage" or given["surroundings"] == "limit":
            return self
        seen = np.zeros(len(self.vertices), bool)
        seen[used[used < len(seen)]] = True
        seen[self.rim] = True
        sizes = np.diff(self.offsets)
        of_face = np.repeat(np.arange(len(sizes)), sizes)
        for _ in range(SURROUNDING_RINGS + 2):
            faces = np.zeros(len(sizes), bool)
            faces[of_face[seen[self.corners]]] = True
            seen[self.corners[faces[of_face]]] = True
        number, place = np.cumsum(seen) - 1, np.cumsum(faces) - 1

        def renumbered(name: str, value: Any) -> Any:
            if name == "replaced":
                return [int(place[f]) for f in value]
            if name == "islands" and not isinstance(value, str):
                return [[int(number[v]) for v in loop] for loop in value]
            return [int(number[v]) for v in value] if name in ("rim", "corners") and value is not None else value

        return Source(
            self.function,
            self.vertices[seen],
            np.concatenate([[0], np.cumsum(sizes[faces])]).astype(np.int64),
            number[self.corners[faces[of_face]]],
            {name: renumbered(name, value) for name, value in self.options.items()},
            renumbered("rim", self.rim),
            renumbered("corners", self.rim_corners),
            kept=np.flatnonzero(seen),
            whole=len(seen),
        )

    def with_cages(self, fill: Fill) -> tuple[Array, list[list[int]], _native.Subdivision, list[int]]:
        """The cage with the fill, and others that were fitted together with it, in place: vertices, faces, settings of its
        subdivision, and how many of the last faces each fill has, the others first."""
        settings = checked(self.function, self.options)["subdivision"]
        gone = set(fill.replaced.tolist())
        points = self.vertices.copy()
        rows = enumerate(zip(self.offsets, self.offsets[1:], strict=False))
        faces = [self.corners[a:b].tolist() for f, (a, b) in rows if f not in gone]
        subdivision, counts = _native.Subdivision(settings), []
        for each in [*(other for other in self.others if other is not fill), fill]:
            n, by = len(self.vertices), len(points) - len(self.vertices)

            def own(v: int, n: int = n, by: int = by) -> int:
                return v + by if v >= n else v

            points = np.concatenate([points, each.vertices])
            points[each.moved[0]] = each.moved[1]
            splits = {frozenset(edge): n + by + k for k, edge in enumerate(each.split_edges[0].tolist())}
            if splits:
                faces = [_split(face, splits) for face in faces]
            creased = [[own(v) for v in edge] for edge in each.creases[0].tolist()]
            subdivision.crease_edges = subdivision.crease_edges + creased
            subdivision.edge_creases = subdivision.edge_creases + each.creases[1].tolist()
            faces += [[own(v) for v in face] for face in _arrays.index_lists(each.faces)]
            counts.append(len(each.faces))
        return points, faces, subdivision, counts

    def limit(self, fill: Fill, level: int) -> tuple[Array, Array]:
        """The limit surface in a fill that is a cage."""
        points, faces, subdivision, counts = self.with_cages(fill)
        limit, quads = _native._sample_limit(points, *_arrays.faces(faces), subdivision, len(faces) - counts[-1], level)
        return limit, quads.reshape(-1, 3 if subdivision.loop else 4)


def _split(face: list[int], splits: dict[frozenset[int], int]) -> list[int]:
    """A face with the vertices that lie on its edges."""
    ends = zip(face, [*face[1:], face[0]], strict=True)
    return [v for a, b in ends for v in (a, splits.get(frozenset((a, b)), -1)) if v >= 0]


@takes_options
def fill(
    vertices: Any, faces: Faces | None = None, *, progress: Callable[[int, int], object] | None = None, **options: Any
) -> Fill:
    """Fills one hole.

    Args:
        vertices: (n, 3) float, positions; or a mesh with .vertices and .faces, such as what `read` returns; or a pair of both.
        faces: (m, 3) or (m, 4) int, or a list of index lists; indices count from 0. None: `vertices` is a mesh or a pair.
        progress: a function of two numbers, holes done and holes in all, here always 0 and 1. It is called several times a second
            during the work. If it raises an exception, the work stops and the exception comes out, as with Ctrl-C.
        **options: see OPTIONS.

    Returns:
        A `Fill`: the new vertices and faces, and a report. `merge` adds it to the mesh. The input is never changed.

    Raises:
        Refusal: the hole cannot be filled, or the mesh has several holes and `rim` names none. It says why and where.
        TypeError, ValueError: an argument has the wrong type, shape, range or name.

    Example:
        >>> vertices = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]
        >>> faces = [[1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]  # an octahedron without a face
        >>> fill = tripatch.fill(vertices, faces)
        >>> fill.rim.tolist(), fill.faces.tolist()
        ([0, 1, 2], [[0, 1, 2]])
        >>> len(tripatch.merge(vertices, faces, fill)[1])
        8
    """
    given = checked("fill", options)
    v, offsets, corners = _arrays.mesh(*_arrays.parts(vertices, faces, "fill"))
    if not len(corners):
        raise Refusal.of(Message("mesh_without_faces", {"points": len(v)} if len(v) else {}))
    made = _native._fill(v, offsets, corners, not_at_default("fill", given), progress)
    rim = given["rim"] if given["rim"] is not None else _from_lowest(made.rim)
    filled = Fill(made, Source("fill", v, offsets, corners, options, rim))
    if given["output"] == "cage":
        (filled.passes_through,) = passages.of_cages([filled])
    return filled


def _from_lowest(rim: Array) -> list[int]:
    """A rim as `find_holes` has it."""
    found: list[int] = np.roll(rim, -int(np.argmin(rim))).tolist()
    return found


@takes_options
def fill_all(
    vertices: Any,
    faces: Faces | None = None,
    rims: Any = None,
    *,
    corners: Any = None,
    islands: str = "auto",
    join: float | None = None,
    progress: Callable[[int, int], object] | None = None,
    **options: Any,
) -> Fills:
    """Fills several holes of one mesh. The options are those of `fill`. Cages whose surroundings overlap are fitted together.
    Fills of holes that share a vertex have one tangent plane there.

    Args:
        vertices: (n, 3) float, positions; or a mesh with .vertices and .faces, such as what `read` returns; or a pair of both.
        faces: (m, 3) or (m, 4) int, or a list of index lists; indices count from 0. None: `vertices` is a mesh or a pair.
        rims: a list of rims, each (k,) int; None: those that `choose_holes` finds with the options that it takes.
        corners: a list with an entry for each rim, as `fill` takes it: (k,) int, two or more of its vertices; an empty list for a
            round hole; or None to detect them. None: all are detected. An empty list: all holes are round.
        islands: "auto": borders of other parts of the mesh that lie inside a hole belong to it; "none": each is a hole. Of rims
            that are named none are.
        join: if rims are None, the distance, in units of the mesh, within which borders that lie on each other are joined:
            vertices move to one place, and a vertex that lies within an edge goes into the face there (T-junctions). None:
            vertices within a millionth of the mesh's size count as one, and stay. Borders that still lie on others are refused.
        progress: a function of holes done and holes in all, called several times a second. An exception in it stops the work.
        **options: see OPTIONS.

    Returns:
        A list, `Fills`: a `Fill` or a `Refusal` for each rim, in their order. A refusal of one does not stop the others. Each
        fill numbers its own new vertices from n. The list's `outer_borders` are the border loops left open as outer ones.

    Raises:
        TypeError, ValueError: an argument has the wrong type, shape, range or name.

    Example:
        >>> vertices = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]
        >>> faces = [[1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]  # an octahedron without a face
        >>> results = tripatch.fill_all(vertices, faces, max_edges=20)
        >>> [isinstance(each, tripatch.Fill) for each in results]
        [True]
    """
    given = checked("fill_all", options)
    v, offsets, face_corners = _arrays.mesh(*_arrays.parts(vertices, faces, "fill_all"))
    if rims is not None and (choosing := [name for name in options if "choose_holes" in OPTIONS[name].functions]):
        raise WrongValue(Message("options_exclusive", {"first": "rims", "second": choosing[0]}))
    if islands not in ("auto", "none"):
        raise not_one_of("islands", islands, ("auto", "none"))
    holes = Holes(v, offsets, face_corners, given, islands, join) if rims is None else rims if isinstance(rims, Holes) else None
    if holes:
        _, offsets, face_corners = holes.mesh
    loops = holes.rims if holes else [_arrays.indices(loop, "rim") for loop in rims]
    given_corners = () if corners is None else corners if len(corners) else [()] * len(loops)
    by_rim = [value(OPTIONS["corners"], each) for each in given_corners]
    if corners is not None and len(by_rim) != len(loops):
        raise WrongValue(Message("wrong_count", {"name": "corners", "count": len(loops), "given": len(by_rim)}))
    mesh = v, offsets, face_corners
    if holes:
        results = _of_holes(mesh, holes, given, by_rim, progress)
    else:
        results = _native._fill_all(*mesh, loops, [], given, by_rim, progress, None)
    together, fills = list[Any](), list[Fill | Refusal]()
    for k, result in enumerate(results):
        if isinstance(result, Refusal):
            fills.append(result)
            continue
        if holes and holes.islands[k]:
            source = Source("fill", *mesh, {**options, "islands": holes.islands[k]}, loops[k])
        else:
            source = Source("fill_all", *mesh, options, loops[k], by_rim[k] if by_rim else None)
        filled = Fill(result, source)
        fills.append(filled)
        if given["output"] == "cage":
            source.others = together
            together.append(filled)
    for filled, place in zip(together, passages.of_cages(together), strict=True):
        filled.passes_through = place
    if not holes:
        return Fills(fills, [np.array(loop, np.int64) for loop in loops])
    return Fills(fills, [holes.in_mesh(loop) for loop in loops], holes.outer_borders, holes.joined)


def _of_holes(
    mesh: tuple[Array, Array, Array], holes: Holes, given: dict[str, Any], by_rim: list[Any], progress: Any
) -> list[Any]:
    """What becomes of each, by the vertices of the mesh as it is."""
    asked = [k for k in range(len(holes.rims)) if k not in holes.refused]
    rims, islands = [holes.rims[k] for k in asked], [holes.islands[k] for k in asked]
    corners = [by_rim[k] for k in asked] if by_rim else []
    made = _native._fill_all(*mesh, rims, islands, given, corners, progress, holes.connected)
    for each in made:
        if not isinstance(each, Refusal):
            holes.bring_back(each)
    results = dict(holes.refused) | dict(zip(asked, made, strict=True))
    return [results[k] for k in range(len(results))]
