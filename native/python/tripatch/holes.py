"""The holes of a mesh: its border loops, their corners, and which of them are holes."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _arrays, _native
from ._types import Array, ArrayLike, Faces
from .errors import out_of_range
from .options import checked, takes_options


def find_holes(faces: Faces) -> list[Array]:
    """Every border loop of a mesh.

    Args:
        faces: (m, 3) or (m, 4) int array, or a list of index lists.

    Returns:
        An int array for each loop, shortest first, each starting at its lowest index, in the direction that new faces take.

    Example:
        >>> faces = [[1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]  # an octahedron without a face
        >>> [loop.tolist() for loop in tripatch.find_holes(faces)]
        [[0, 1, 2]]
    """
    offsets, corners = _arrays.faces(faces)
    if corners.size and corners.min() < 0:
        raise out_of_range("faces", int(corners.min()), 0)
    return _native._find_holes(offsets, corners)


#: Rings of faces around a rim that a fill in a plain mesh reads at most.
SURROUNDING_RINGS: int = _native.surrounding_rings


@takes_options
def choose_holes(vertices: Any, faces: Faces | None = None, **options: Any) -> list[Array]:
    """The border loops of a mesh that `fill_all` fills where none are named.

    Args:
        vertices: (n, 3) float, positions; or a mesh with .vertices and .faces, such as what `read` returns; or a pair of both.
        faces: (m, 3) or (m, 4) int, or a list of index lists; indices count from 0. None: `vertices` is a mesh or a pair.
        **options: see OPTIONS.

    Returns:
        An int array for each loop, as `find_holes` has it.

    Example:
        >>> vertices = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]
        >>> faces = [[1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]  # an octahedron without a face
        >>> [loop.tolist() for loop in tripatch.choose_holes(vertices, faces, max_edges=20)]
        [[0, 1, 2]]
    """
    given = checked("choose_holes", options)
    return _native.ConnectedMesh(*_arrays.mesh(*_arrays.parts(vertices, faces, "choose_holes"))).chosen(given)


def outer_borders(vertices: Any, faces: Faces | None = None) -> list[Array]:
    """The border loops that `fill` and `fill_all` leave open unless they are named or `outer` is given.

    A border is an outer one if it turns the other way than a hole as a whole, and no border of its connected component is longer.
    If all borders of a mesh are such, only those of sheets are, which their fills would cover.

    Args:
        vertices: (n, 3) float, positions; or a mesh with .vertices and .faces, such as what `read` returns; or a pair of both.
        faces: (m, 3) or (m, 4) int, or a list of index lists; indices count from 0. None: `vertices` is a mesh or a pair.

    Returns:
        An int array for each loop, as `find_holes` has it.

    Example:
        >>> vertices = [[x, y, 0] for y in range(4) for x in range(4)]
        >>> faces = [[v, v + 1, v + 5, v + 4] for v in (0, 1, 2, 4, 6, 8, 9, 10)]  # a sheet of 3 x 3 quads without the middle one
        >>> [loop.tolist() for loop in tripatch.outer_borders(vertices, faces)]
        [[0, 4, 8, 12, 13, 14, 15, 11, 7, 3, 2, 1]]
    """
    return _native.ConnectedMesh(*_arrays.mesh(*_arrays.parts(vertices, faces, "outer_borders"))).outer_borders()


def find_corners(vertices: ArrayLike, faces: Faces, rim: ArrayLike, *, replaced: Any = (), any_number: bool = False) -> Array:
    """The corners of a rim, detected as `fill` does: where the rim turns, read in the tangent plane of the faces around.

    Args:
        vertices: (n, 3) positions.
        faces: (m, 3) or (m, 4) int array, or a list of index lists.
        rim: vertex indices of the hole's border, any start, either direction.
        replaced: indices of faces that count as not there.
        any_number: not only three, but those that method="auto" takes: two to twelve between smooth sides or such as meet the
            mesh at an angle, or none.

    Returns:
        (3,) vertex indices, in the direction in which new faces traverse the rim; of any number (n,).

    Raises:
        Refusal: the rim has not three clear corners (where they are asked for), or is none.

    Example:
        >>> vertices = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]
        >>> faces = [[1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]  # an octahedron without a face
        >>> tripatch.find_corners(vertices, faces, [0, 1, 2]).tolist()
        [0, 1, 2]
    """
    checked = _arrays.mesh(vertices, faces)
    gone = _arrays.indices(replaced, "replaced")
    corners = _native._find_corners(*checked, _arrays.indices(rim, "rim"), gone, bool(any_number))
    return np.array(corners, np.int64)


def is_outer_border(vertices: ArrayLike, faces: Faces, rim: ArrayLike, *, of_sheet: bool = False) -> bool:
    """Whether a border loop turns the other way than a hole as a whole. `outer_borders` finds those that are left open.

    Args:
        vertices: (n, 3) positions.
        faces: (m, 3) or (m, 4) int array, or a list of index lists; those around the border are enough.
        rim: vertex indices of a loop of `find_holes`, in its direction.
        of_sheet: whether it is that of a sheet, or of a bowl hardly deeper: what fills it lies on the mesh.
    """
    return _native._is_outer_border(*_arrays.mesh(vertices, faces), _arrays.indices(rim, "rim"), bool(of_sheet))
