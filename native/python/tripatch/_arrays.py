"""Checks at the border: what a caller gives becomes the arrays that the compiled core reads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, pairwise
from typing import Any, overload

import numpy as np

from . import _native
from ._types import Array, ArrayLike, Faces
from .errors import WrongType, WrongValue, out_of_range, wrong_shape, wrong_type
from .messages import Message


def numbers(value: Any, name: str, shape: str) -> Array:
    """An array of numbers; shape: that it should have, as messages name it."""
    try:
        a = np.asarray(value)
    except ValueError:
        raise wrong_shape(name, shape, value, ragged=True) from None
    if a.dtype.kind not in "fiu" and a.size:
        raise WrongType(Message("not_numbers", {"name": name, "given": str(a.dtype)}))
    return a


def points(value: Any, name: str = "vertices", finite: bool = False) -> Array:
    """An (n, 3) float64 array; TypeError for what is no array of numbers, ValueError for another shape."""
    a = numbers(value, name, "(n, 3)")
    if a.size == 0 and a.ndim < 2:
        a = np.zeros((0, 3))
    if a.ndim != 2 or a.shape[1] != 3:
        raise wrong_shape(name, "(n, 3)", a.shape)
    a = np.ascontiguousarray(a, dtype=np.float64)
    if finite and not np.isfinite(a).all():
        row = int(np.nonzero(~np.isfinite(a).all(axis=1))[0][0])
        raise WrongValue(Message("not_finite", {"name": f"{name}[{row}]"}))
    return a


class Rows(Sequence[list[int]]):
    """Faces as index lists that are made when they are asked for; NumPy takes faces of one size as an (m, 3) or (m, 4) array.

    Attributes:
        corners: of all faces, one after another.
    """

    def __init__(self, offsets: Array | int, corners: Array) -> None:
        """offsets: or the number of corners that every face has."""
        self._offsets, self.corners = offsets, corners

    @property
    def offsets(self) -> Array:
        """(m + 1,) where each face begins."""
        if isinstance(self._offsets, int):
            return np.arange(0, len(self.corners) + 1, self._offsets)
        return self._offsets

    @property
    def sizes(self) -> Array:
        """(m,) how many corners each has."""
        return np.diff(self.offsets)

    def __len__(self) -> int:
        return len(self.corners) // self._offsets if isinstance(self._offsets, int) else len(self._offsets) - 1

    @overload
    def __getitem__(self, f: int) -> list[int]: ...
    @overload
    def __getitem__(self, f: slice) -> list[list[int]]: ...
    def __getitem__(self, f: Any) -> Any:
        if isinstance(f, slice):
            return [self[k] for k in range(*f.indices(len(self)))]
        if not -len(self) <= f < len(self):
            raise IndexError(f"there are {len(self)} faces")
        f = int(f) % len(self)
        if isinstance(self._offsets, int):
            return self.corners[f * self._offsets : (f + 1) * self._offsets].tolist()
        return self.corners[self._offsets[f] : self._offsets[f + 1]].tolist()

    def __iter__(self) -> Iterator[list[int]]:
        return iter(index_lists(rows(self.offsets, self.corners)))

    def __eq__(self, other: object) -> bool:
        return list(self) == list(other) if isinstance(other, Sequence) else NotImplemented

    def __add__(self, other: Iterable[Any]) -> list[Any]:
        return [*self, *other]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return np.asarray(rows(self.offsets, self.corners), dtype)

    def __repr__(self) -> str:
        return f"<{len(self)} faces>"


def faces(value: Any) -> tuple[Array, Array]:
    """Offsets (m + 1,) and corners of an (m, 3), (m, 4), ... index array or of lists of index lists."""
    if isinstance(value, Rows):
        return value.offsets, value.corners
    if isinstance(value, np.ndarray) and value.dtype != object:
        if value.size == 0:
            return np.zeros(1, np.int64), np.zeros(0, np.int64)
        if value.dtype.kind not in "iu":
            raise WrongType(Message("not_indices", {"name": "faces", "given": str(value.dtype)}))
        if value.ndim != 2 or value.shape[1] < 3:
            raise wrong_shape("faces", "(m, 3) or (m, 4)", value.shape)
        corners = np.ascontiguousarray(value, value.dtype if value.dtype == np.int32 else np.int64).reshape(-1)
        return np.arange(0, corners.size + 1, value.shape[1], dtype=np.int64), corners
    wrong = wrong_type("faces", "ndarray | Sequence[Sequence[int]]", value)
    if isinstance(value, (str, bytes)) or not isinstance(value, Iterable):
        raise wrong
    rows = list(value)
    if not rows:
        return np.zeros(1, np.int64), np.zeros(0, np.int64)
    try:
        sizes = np.fromiter((len(row) for row in rows), np.int64, len(rows))
        corners = np.asarray(list(chain.from_iterable(rows)))
    except TypeError:
        raise wrong from None
    if (sizes < 3).any():
        row = int(np.argmax(sizes < 3))
        raise WrongValue(Message("face_too_small", {"face": row, "corners": int(sizes[row])}))
    if corners.dtype.kind not in "iu":
        raise WrongType(Message("not_indices", {"name": "faces", "given": str(corners.dtype)}))
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64), corners.astype(np.int64)


def rows(offsets: Array, corners: Array) -> Any:
    """Faces from offsets and corners: an (m, 3) or (m, 4) array if all have as many corners, else index lists."""
    sizes = np.diff(offsets)
    if len(sizes) and sizes[0] in (3, 4) and (sizes == sizes[0]).all():
        return corners.reshape(-1, sizes[0])
    places, whole = offsets.tolist(), corners.tolist()
    return [whole[a:b] for a, b in pairwise(places)]


def index_lists(value: Any) -> list[list[int]]:
    """Faces as lists of Python's own numbers, which are quicker to go through one by one."""
    found: list[list[int]] = value.tolist() if isinstance(value, np.ndarray) else value
    return found


#: Odd numbers whose products spread over 64 bits: the golden ratio's and another's.
_SPREADING = (0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F)
_BLOCK = 3 << 15  # rows that caches hold, those of whole triangles


def same_places(points: Array) -> tuple[Array, Array]:
    """Rows (n, 3), or (n, 3, 3) of triangles, that are equal as one. Returns the first row of each place, ascending, and for each
    row its place."""
    each = 1 if points.ndim == 2 else 3
    count = each * len(points)
    blocks = [slice(k, min(k + _BLOCK, count)) for k in range(0, count, _BLOCK)]
    kind: Any = np.int32 if count < 2**31 else np.int64

    def bits(rows: Any) -> Array:
        if each == 1:
            some = points[rows]
        elif isinstance(rows, slice):
            some = points[rows.start // 3 : rows.stop // 3]
        else:
            some = points[rows // 3, rows % 3]
        some = some + points.dtype.type(0)  # -0 is 0
        return np.asarray(some.view(np.uint32 if points.dtype == np.float32 else np.uint64).reshape(-1, 3))

    low = np.uint64(max(count - 1, 1).bit_length())  # of a number: which row it is; above them a hash
    mask = (np.uint64(1) << low) - np.uint64(1)
    for factor in _SPREADING:
        keys = np.empty(count, np.uint64)
        for block in blocks:
            columns = bits(block).T.astype(np.uint64)
            key = columns[0] * np.uint64(factor)
            for column in columns[1:]:
                key ^= key >> np.uint64(32)
                key += column
                key *= np.uint64(factor)
            keys[block] = (key & ~mask) | np.arange(block.start, block.stop, dtype=np.uint64)
        keys.sort()
        order = np.bitwise_and(keys, mask, out=np.empty(count, kind), casting="unsafe")
        keys >>= low
        begins = np.ones(count, bool)
        np.not_equal(keys[1:], keys[:-1], out=begins[1:])
        del keys
        first, place = order[begins].astype(np.int64), np.empty(count, kind)
        ranks = np.cumsum(begins, dtype=kind)
        ranks -= 1
        place[order] = ranks
        del order, ranks
        if all(np.array_equal(bits(first[place[block]]), bits(block)) for block in blocks):
            break
    else:  # what is not equal has one hash
        _, first, place = np.unique(bits(slice(0, count)), axis=0, return_index=True, return_inverse=True)
        place = place.reshape(-1)
    by_use = np.argsort(first)
    rank = np.empty_like(by_use)
    rank[by_use] = np.arange(len(by_use))
    return first[by_use], rank[place]


def mesh(vertices: ArrayLike, face_list: Faces) -> tuple[Array, Array, Array]:
    """Vertices, offsets and corners; ValueError when a face names a vertex that does not exist."""
    v = points(vertices)
    offsets, corners = faces(face_list)
    if corners.size and corners.view(f"u{corners.itemsize}").max() >= len(v):  # negative ones are the largest
        place = int(np.argmax((corners < 0) | (corners >= len(v))))
        face = int(np.searchsorted(offsets, place, "right")) - 1
        raise no_such_vertex(f"faces[{face}]", int(corners[place]), len(v))
    return v, offsets, corners


def parts(mesh: Any, face_list: Any, function: str) -> tuple[Any, Any]:
    """Vertices and faces as a caller gives them: both, or one mesh that has both, or a pair."""
    whole = hasattr(mesh, "vertices") and hasattr(mesh, "faces")
    if face_list is None and whole:
        return mesh.vertices, mesh.faces
    if face_list is None and isinstance(mesh, tuple) and len(mesh) == 2:
        return mesh
    if face_list is None or whole:
        kind = type(mesh).__name__ + (" and faces" if whole else "")
        raise WrongType(Message("mesh_needed", {"function": f"{function}()", "type": kind}))
    return mesh, face_list


def no_such_vertex(name: str, vertex: int, count: int) -> ValueError:
    """The error for an index beyond the vertices."""
    return WrongValue(Message("no_such_vertex", {"option": name, "vertex": vertex, "count": count}))


def indices(value: Any, name: str) -> list[int]:
    """A list of whole numbers."""
    a = np.asarray(value)
    if a.ndim != 1:
        raise wrong_shape(name, "(k,)", a.shape)
    if a.size and a.dtype.kind not in "iu":
        raise WrongType(Message("not_indices", {"name": name, "given": str(a.dtype)}))
    if a.dtype.kind == "u" and a.size and a.max() > np.iinfo(np.int64).max:
        raise out_of_range(name, int(a.max()), 0, np.iinfo(np.int64).max)
    found: list[int] = a.tolist()
    return found


#: What barycentric coordinates may be off by: sums and lattices of doubles are, by 1e-15.
_OUTSIDE = 1e-9


def barycentric(value: Any) -> Array:
    """(k, 3) rows inside the triangle that sum to 1; one row may be given flat."""
    a = np.asarray(value)
    b = points(a[None] if a.shape == (3,) else a, "b")
    row = _native._first_outside(b, _OUTSIDE)
    if row is not None:
        points(b, "b", finite=True)
        raise WrongValue(Message("not_in_triangle", {"name": f"b[{row}]"}))
    return b


#: Sides that a patch has at most.
MAX_SIDES = 12


def by_side(value: Any, name: str, kind: type) -> tuple[Any, ...]:
    """One value for all sides, or one a side: how many there are shows later."""
    if isinstance(value, kind) and not isinstance(value, bool):
        return (value,)
    types = "str" if kind is str else "float"
    try:
        items = tuple(value)
    except TypeError:
        raise wrong_type(name, f"{types} | Sequence[{types}]", value) from None
    if not 1 <= len(items) <= MAX_SIDES:
        raise out_of_range(f"len({name})", len(items), 1, MAX_SIDES)
    for k, item in enumerate(items):
        if not isinstance(item, kind) or isinstance(item, bool):
            raise wrong_type(f"{name}[{k}]", types, item)
    return items
