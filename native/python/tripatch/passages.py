"""Where fills pass through other faces of the mesh that are not at their boundaries."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import _arrays, _native
from .options import subdivision as settings_of

if TYPE_CHECKING:
    from ._types import Array, ArrayLike, Faces
    from .filling import Fill

Place = tuple[float, float, float]


def of_fills(mesh: tuple[Array, Array, Array], fills: list[_native.Filled], given: dict[str, Any]) -> list[Place | None]:
    """For each fill of the core, in the mesh or on its limit surface, a place or None. mesh: vertices, offsets and corners;
    given: the options that were checked."""
    if not fills:
        return []
    vertices, offsets, corners = mesh
    if len(given["replaced"]):
        sizes = np.diff(offsets)
        stays = np.ones(len(sizes), bool)
        stays[np.asarray(given["replaced"])] = False
        corners, sizes = corners[np.repeat(stays, sizes)], sizes[stays]
        offsets = np.concatenate([[0], np.cumsum(sizes)])
    subdivision = given["subdivision"] if given["surroundings"] == "limit" else None
    return _native._passages(vertices, offsets, corners, fills, subdivision)


def of_cages(fills: list[Fill]) -> list[Place | None]:
    """For each of the cages that were fitted together a place where its limit surface passes through that of the others."""
    if not fills:
        return []
    points, faces, subdivision, counts = fills[-1]._source.with_cages(fills[-1])
    of_face = np.repeat(np.arange(-1, len(counts)), [len(faces) - sum(counts), *counts])
    return _native._passages_of_faces(points, *_arrays.faces(faces), of_face.tolist(), subdivision)


def of_faces(
    vertices: ArrayLike, faces: Faces, fill_of_face: list[int], subdivision: dict[str, Any] | None = None
) -> list[Place | None]:
    """For each fill a place where it passes through other faces of the mesh that it is in.

    Args:
        vertices: (n, 3) positions.
        faces: (m, 3) or (m, 4) int array, or a list of index lists.
        fill_of_face: (m,) the number of the fill that a face is of, from 0 on; -1: of none.
        subdivision: as the option of `fill`: the mesh is a cage, and its limit surface is looked at.
    """
    settings = None if subdivision is None else settings_of(subdivision)
    return _native._passages_of_faces(*_arrays.mesh(vertices, faces), fill_of_face, settings)
