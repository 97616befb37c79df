"""Filling holes: from a mesh to new faces."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from . import _arrays, _native
from ._types import Array, ArrayLike, Faces
from .errors import Refusal
from .options import OPTIONS, checked, not_at_default, takes_options, value, whole


class Fill:
    """A filled hole.

    Attributes:
        vertices: (k, 3) the new vertices only.
        faces: index lists; 0 .. n-1 are the mesh's own vertices (the rim's are reused), n .. are `vertices`.
        normals: (k, 3) exact unit normals of the patch at `vertices`.
        barycentric: (k, 3) of `vertices`, on a patch of three sides.
        uv, rim_uv: (k, 2), (r, 2) of `vertices` and of the rim, on a patch over a plane domain, else None.
        deviation: (k,) standard deviation of `vertices`, in units of the mesh; None where the method does not know it.
        feature_edges: (k, 2) edges of the fill, numbered as in `faces`, on which creases of the surroundings go on.
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

    def __init__(self, native: _native.Filled, mesh: Any = None) -> None:
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
        self.feature_edges = np.array(native.feature_edges, np.int64).reshape(-1, 2)
        self.border = native.border
        self.sides = tuple(native.sides)
        self.patch = native.patch
        self.report = native.report

    @functools.cached_property
    def faces(self) -> list[list[int]]:
        """Index lists; 0 .. n-1 are the mesh's own vertices, n .. are `vertices`. Made when first read."""
        offsets, corners = self._native.face_offsets.tolist(), self._native.face_corners.tolist()
        return [corners[a:b] for a, b in itertools.pairwise(offsets)]

    def limit(self, level: int = 3) -> tuple[Array, Array]:
        """The limit surface of a fill that is a cage.

        Args:
            level: 2^level quads along each edge of a face.

        Returns:
            vertices (k, 3) and faces (m, 4), of a cage of triangles (m, 3).
        """
        if self._mesh is None:
            raise ValueError("only a fill with output='cage' has a limit surface")
        whole(level, "level", 1, 8)
        vertices, offsets, corners, replaced, settings, others = self._mesh
        return _limit_of_cage(self, vertices, offsets, corners, replaced, settings, others, level)

    def __repr__(self) -> str:
        return (
            f"<tripatch.Fill: {len(self.vertices)} new vertices, {len(self._native.face_offsets) - 1} faces, "
            f"seam within {self.report.seam_angle_max:.2g} deg>"
        )


class Fills(list["Fill | Refusal"]):
    """What `fill_all` makes: a list of a `Fill` or a `Refusal` for each hole.

    Attributes:
        outer_borders: the border loops that were left open as outer ones; none where rims are named.
    """

    outer_borders: list[Array]

    def __init__(self, results: Iterable[Fill | Refusal] = (), outer_borders: Sequence[Array] = ()) -> None:
        super().__init__(results)
        self.outer_borders = list(outer_borders)


def _limit_of_cage(
    fill: Fill, vertices: Array, offsets: Array, corners: Array, replaced: Any, settings: Any, others: Any, level: int
) -> tuple[Array, Array]:
    """The cage with the fill, and others that were fitted together with it, in place; and its limit surface in the fill."""
    gone = set(replaced)
    points = vertices.copy()
    faces = [corners[a:b].tolist() for f, (a, b) in enumerate(zip(offsets, offsets[1:], strict=False)) if f not in gone]
    subdivision, first = _native.Subdivision(settings), 0
    for each in [*(other for other in others if other is not fill), fill]:
        n, by = len(vertices), len(points) - len(vertices)

        def own(v: int, n: int = n, by: int = by) -> int:
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


@takes_options
def fill(vertices: ArrayLike, faces: Faces, *, progress: Callable[[int, int], object] | None = None, **options: Any) -> Fill:
    """Fills one hole.

    Args:
        vertices: (n, 3) positions.
        faces: (m, 3) or (m, 4) int array, or a list of index lists.
        progress: called several times a second with 0 and 1, as by `fill_all`; what it raises ends the work, as Ctrl-C does.
        **options: see OPTIONS.

    Returns:
        A `Fill`. The input is never changed.

    Raises:
        Refusal: the hole cannot be filled; says why and where.
        TypeError, ValueError: wrong types, shapes, ranges or names.
    """
    given = checked("fill", options)
    v, offsets, corners = _arrays.mesh(vertices, faces)
    cage = (v, offsets, corners, given["replaced"], given["subdivision"], ()) if given["output"] == "cage" else None
    return Fill(_native._fill(v, offsets, corners, not_at_default("fill", given), progress), cage)


@takes_options
def fill_all(
    vertices: ArrayLike,
    faces: Faces,
    rims: Any = None,
    *,
    corners: Any = None,
    progress: Callable[[int, int], object] | None = None,
    **options: Any,
) -> Fills:
    """Fills several holes of one mesh. The options are those of `fill`. Cages whose surroundings overlap are fitted together.

    Args:
        vertices: (n, 3) positions.
        faces: (m, 3) or (m, 4) int array, or a list of index lists.
        rims: a list of rims; None: those that `choose_holes` finds by the last of the options.
        corners: for each rim what `fill` takes: two of its vertices or more, an empty list for a round one, or None where they
            are to be detected; None: all are detected; an empty list: all are round.
        progress: called with the number of holes done and the number of all, several times a second; what it raises ends the
            work, as Ctrl-C does.
        **options: see OPTIONS.

    Returns:
        A `Fill` or a `Refusal` for each rim, in their order. A refusal of one does not stop the others. Every fill counts its
        new vertices from n on its own. Its `outer_borders` are the border loops left open as outer ones.
    """
    given = checked("fill_all", options)
    v, offsets, face_corners = _arrays.mesh(vertices, faces)
    choosing = [name for name in options if "choose_holes" in OPTIONS[name].functions]
    if rims is not None and choosing:
        raise ValueError(f"{choosing[0]} chooses among the holes of a mesh; with rims that are named it means nothing")
    chosen = _native._choose_holes(v, offsets, face_corners, given) if rims is None else rims
    loops = [_arrays.indices(loop, "rim") for loop in chosen]
    given_corners = () if corners is None else corners if len(corners) else [()] * len(loops)
    by_rim = [value(OPTIONS["corners"], each) for each in given_corners]
    if corners is not None and len(by_rim) != len(loops):
        raise ValueError(f"corners must be given for each of the {len(loops)} rims, not for {len(by_rim)}")
    results = _native._fill_all(v, offsets, face_corners, loops, given, by_rim, progress)
    together: list[Fill] = []
    cage = None
    if given["output"] == "cage":
        cage = (v, offsets, face_corners, given["replaced"], given["subdivision"], together)
    fills = [r if isinstance(r, Refusal) else Fill(r, cage) for r in results]
    together += [f for f in fills if isinstance(f, Fill)]
    left = rims is None and not given["outer"]
    return Fills(fills, _native._outer_borders(v, offsets, face_corners) if left else ())
