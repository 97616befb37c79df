"""What the new vertices and faces of a fill take over from the faces around its rim."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import Any

import numpy as np

from .._types import Array
from ..attributes import attribute_weights
from ..charts import Blend, Shares, continue_corners
from . import writing


class Continued:
    """How a fill continues what the faces around it hold.

    Attributes:
        model: for each new face the old one whose material it has; none where no face is at the rim.
        near: for each new vertex one of the rim.
    """

    def __init__(
        self,
        vertices: Array,
        face: Callable[[int], Sequence[int]],
        fill: Any,
        look: Callable[[int], Hashable],
        at: Any,
        edges: Mapping[tuple[int, int], int] | None = None,
    ) -> None:
        """face: the corners of an old face; look: what of it shall not change within a part of the fill; at: the old faces at a
        vertex; edges: the face at some edges, whose lower end comes first."""
        self._edges = edges or {}
        self._vertices, self._face, self._count = vertices, face, len(vertices)
        self._faces = fill.faces
        rim = list(map(int, fill.rim))
        counts = getattr(fill, "loops", None) or [len(rim)]  # islands follow the outer loop
        loops = [sum(counts[:k]) for k in range(len(counts))] if rim else []
        self._rim, self._loop_starts = rim, loops
        self._next = np.arange(1, len(rim) + 1)
        for first, end in zip(loops, [*loops[1:], len(rim)], strict=True):
            self._next[end - 1] = first
        self._around = [self._face_at(rim[e], rim[self._next[e]], at) for e in range(len(rim))]
        self._split = {self._count + k: (a, b, t) for k, ((a, b), t) in enumerate(zip(*fill.split_edges, strict=True))}
        self._places = np.concatenate([vertices[rim], fill.vertices]) if rim else fill.vertices
        self._blend, nearest = self._blend_of(fill, vertices)
        self.near = np.array(rim, int)[nearest] if rim else np.zeros(len(fill.vertices), int)
        self.model: list[int] = []
        if rim and all(f >= 0 for f in self._around):
            shares = Shares([look(f) for f in self._around], self._blend, self._next)
            self.model = self._models_alike(nearest) if len(shares.kinds) == 1 else []
            self.model = self.model or [self._around[self._edge_like(shares, at, nearest)] for at in self._at]

    @functools.cached_property
    def _at(self) -> list[list[int]]:
        """The corners of the new faces: places in the rim, and the new vertices after them."""
        place, first = {v: k for k, v in enumerate(self._rim)}, self._count - len(self._rim)
        return [[place.get(v, v - first) for v in map(int, face)] for face in self._faces]

    def _models_alike(self, nearest: Array) -> list[int]:
        """`model` where all faces around are alike; empty where the new faces have different numbers of corners."""
        if not isinstance(self._faces, np.ndarray):
            return []
        rim, count = np.array(self._rim), len(self._rim)
        order = np.argsort(rim)
        place = order[np.minimum(np.searchsorted(rim, self._faces, sorter=order), count - 1)]
        at = np.where(rim[place] == self._faces, place, self._faces - (self._count - count))
        highest = at.max(axis=1)
        edges = at.min(axis=1)
        edges[highest >= count] = nearest[highest[highest >= count] - count]
        models: list[int] = np.array(self._around)[edges].tolist()
        return models

    def _face_at(self, a: int, b: int, at: Any) -> int:
        found = self._edges.get((min(a, b), max(a, b)))
        if found is not None:
            return found
        for f in at(a):
            face = self._face(f)
            k = face.index(b) if b in face else -1
            if k >= 0 and a in (face[(k + 1) % len(face)], face[k - 1]):
                return int(f)
        return -1

    def _blend_of(self, fill: Any, vertices: Array) -> tuple[Blend, Array]:
        """From values at both ends of each rim edge to those of all new vertices; and for each the nearest rim edge."""
        if not len(fill.vertices):
            return lambda ends: np.zeros((0, ends.shape[1])), np.zeros(0, int)
        count, split = len(self._rim), len(self._split)
        names = ("rim_barycentric", "barycentric") if getattr(fill, "uv", None) is None else ("rim_uv", "uv")
        at_rim, inside = (getattr(fill, name, ()) for name in names)
        loops = np.diff([*self._loop_starts, count]).tolist() if len(self._loop_starts) > 1 else []
        # only in a plane domain are there islands
        whole = len(at_rim) == count and len(inside) == len(fill.vertices) and (not loops or np.shape(at_rim)[1] == 2)
        place = {v: k for k, v in enumerate(self._rim)}
        on_edges = [(place[int(a)], float(t)) for a, _, t in self._split.values()]
        if whole and len(fill.vertices) > split:
            blend: Blend = attribute_weights(at_rim, inside[split:], loops)
            nearest = np.asarray(blend.nearest) // 2  # type: ignore[attr-defined]
        else:
            blend, nearest = self._by_distance(vertices, fill.vertices[split:])

        def of_all(ends: Array) -> Array:
            own = [(1 - t) * ends[2 * e] + t * ends[2 * e + 1] for e, t in on_edges]
            rest = blend(ends) if count else np.zeros((len(fill.vertices) - split, ends.shape[1]))
            return np.concatenate([np.reshape(own, (split, ends.shape[1])), rest])

        return of_all, np.concatenate([[e for e, _ in on_edges], nearest]).astype(int)

    def _by_distance(self, vertices: Array, points: Array) -> tuple[Blend, Array]:
        square = np.empty((len(points), len(self._rim)))
        for start in range(0, len(points), 1024):
            block = points[start : start + 1024]
            with np.errstate(over="ignore"):
                square[start : start + 1024] = ((block[:, None] - vertices[self._rim]) ** 2).sum(axis=2)
        weight = 1 / np.maximum(square, 1e-300) if len(self._rim) else square
        weight /= np.maximum(weight.sum(axis=1, keepdims=True), 1e-300)
        before = np.empty(len(self._rim), int)
        before[self._next] = np.arange(len(self._rim))

        def blend(ends: Array) -> Array:
            return np.asarray(weight @ (0.5 * (ends[::2] + ends[1::2][before])))

        return blend, square.argmin(axis=1) if len(self._rim) else np.zeros(len(points), int)

    def _edge_like(self, shares: Shares, at: list[int], nearest: Array) -> int:
        count = len(self._rim)
        edge = int(nearest[max(at) - count]) if max(at) >= count else min(at)
        return shares.edge_near(edge, shares.of_face(at))

    def at_vertices(self, values: Callable[[Array], Array]) -> Array:
        """(k, d) of the new vertices, within the range of the rim's. values: (r, d) of old vertices (r,)."""
        own = np.asarray(values(np.array(self._rim, int)), float).reshape(len(self._rim), -1)
        ends = np.stack([own, own[self._next]], axis=1).reshape(2 * len(own), -1)
        return np.clip(self._blend(ends), own.min(axis=0), own.max(axis=0)) if len(own) else self._blend(ends)

    def words(self, of: Callable[[int], Sequence[bytes]]) -> list[Sequence[bytes]]:
        """What a text says of each new vertex. Numbers are blended, whole ones stay whole; else the words of a vertex nearby.

        Args:
            of: the words of an old vertex.
        """
        rows = {v: tuple(of(v)) for v in self._rim}
        near = [rows.get(int(v), ()) for v in self.near]
        if len(set(rows.values())) < 2:
            return list(near)
        try:
            made = self.at_vertices(lambda rim: np.array([[float(word) for word in rows[int(v)]] for v in rim]))
        except ValueError:
            return list(near)
        whole = [all(re.fullmatch(rb"[+-]?\d+", word) for word in column) for column in zip(*rows.values(), strict=True)]
        return [[b"%d" % round(x) if w else writing.number(x) for x, w in zip(row, whole, strict=True)] for row in made.tolist()]

    def at_corners(self, values: Callable[[int], Array | None]) -> list[Array] | None:
        """For each new face the values (c, d) of its corners; None where not every face at the rim has values of one kind.

        Args:
            values: of an old face those of its corners (c, d), or None.
        """
        if not self.model:
            return None
        found = {f: values(f) for f in set(self._around)}
        of_face = {f: own for f, own in found.items() if own is not None and len(own) == len(self._face(f))}
        if len(of_face) < len(found) or len({own.shape[1] for own in of_face.values()}) != 1:
            return None
        ends = []
        for e, f in enumerate(self._around):
            face = list(self._face(f))
            ends += [of_face[f][face.index(v)] for v in (self._rim[e], self._rim[self._next[e]])]
        return self._corners(np.array(ends, float), of_face)

    def _corners(self, at_ends: Array, of_face: dict[int, Array]) -> list[Array]:
        """Seams that end at the rim are continued, else all is blended."""
        start, end = at_ends[::2], at_ends[1::2]
        if len(self._loop_starts) == 1:
            around = [(self._vertices[list(self._face(f))], of_face[f]) for f in self._around]
            charts = continue_corners(self._places, self._at, at_ends, around, self._blend)
            if charts is not None:
                return charts
        count, everywhere = len(self._rim), np.concatenate([start, self._blend(at_ends)])
        made = []
        for at in self._at:
            own = everywhere[at]
            for c, k in enumerate(at):
                if k < count and at[(c + 1) % len(at)] == self._next[k]:
                    own[c] = start[k]
                elif k < count and at[c - 1] < count and self._next[at[c - 1]] == k:
                    own[c] = end[at[c - 1]]
            made.append(own)
        return made
