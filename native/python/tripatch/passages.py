"""Where fills pass through other faces of the mesh that are not at their boundaries."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import _arrays, _native
from .options import subdivision as settings_of

if TYPE_CHECKING:
    from ._types import Array
    from .filling import Fill

Place = tuple[float, float, float]


def of_cages(fills: list[Fill]) -> list[Place | None]:
    """For each of the cages that were fitted together a place where its limit surface passes through that of the others."""
    if not fills:
        return []
    points, faces, subdivision, counts = fills[-1]._source.with_cages(fills[-1])
    of_face = np.repeat(np.arange(-1, len(counts)), [len(faces) - sum(counts), *counts])
    return _native._passages_of_faces(points, *_arrays.faces(faces), of_face.tolist(), subdivision)


def of_faces(
    vertices: Array, offsets: Array, corners: Array, fill_of_face: list[int], subdivision: dict[str, Any] | None = None
) -> list[Place | None]:
    """For each fill a place where it passes through other faces of the mesh that it is in.

    Args:
        vertices, offsets, corners: (n, 3) positions; face f has corners[offsets[f]] .. corners[offsets[f + 1] - 1].
        fill_of_face: (m,) the number of the fill that a face is of, from 0 on; -1: of none.
        subdivision: as the option of `fill`: the mesh is a cage, and its limit surface is looked at.
    """
    settings = None if subdivision is None else settings_of(subdivision)
    return _native._passages_of_faces(vertices, offsets, corners, fill_of_face, settings)
