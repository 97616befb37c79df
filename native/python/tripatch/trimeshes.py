"""Fills in a `trimesh.Trimesh`: colors, texture coordinates, normals and attributes are continued into them."""

from __future__ import annotations

import copy
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import _arrays, quality
from ._types import Array
from .borders import Joined
from .charts import SAME
from .errors import WrongValue
from .files.continued import Continued
from .files.mesh_file import MeshFile
from .filling import Fill
from .messages import Message


def is_one(mesh: Any) -> bool:
    """Whether a mesh is a `trimesh.Trimesh`."""
    trimesh = sys.modules.get("trimesh")
    return trimesh is not None and isinstance(mesh, trimesh.Trimesh)


def _at_new_vertices(continued: Continued, values: Array) -> Array:
    """What new vertices have, (k, ...), from what the mesh's vertices (n, ...) have: numbers blended, and rounded where they are
    whole; what is no number, of a vertex nearby."""
    if values.dtype.kind not in "fiu":
        nearest: Array = values[continued.near]
        return nearest
    made: Array = continued.at_vertices(lambda rim: values[rim]).reshape(-1, *values.shape[1:])
    return (made if values.dtype.kind == "f" else np.rint(made)).astype(values.dtype)


class Welded:
    """A trimesh.Trimesh with the vertices at one place as one: where texture coordinates part, it has a copy for each.

    Attributes:
        vertices, faces: of that mesh; faces that have no area there are left out.
        to: for each vertex of the Trimesh its number there.
        kept: for each of those faces its number in the Trimesh.
    """

    def __init__(self, mesh: Any) -> None:
        points, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
        _, first, inverse = np.unique(points, axis=0, return_index=True, return_inverse=True)
        order = np.argsort(first)
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        self.to, self.first = rank[inverse.reshape(-1)], first[order]
        self.vertices = points[self.first]
        corners = self.to[faces].reshape(-1, 3)
        self.kept = np.flatnonzero((corners != np.roll(corners, 1, axis=1)).all(axis=1))
        self.faces = corners[self.kept]

    def rim(self, loop: Any) -> list[int]:
        """A rim in the numbers of that mesh."""
        numbers = self.to[np.asarray(loop, int)]
        found: list[int] = numbers[numbers != np.roll(numbers, 1)].tolist()
        return found or numbers.tolist()


class _Filled:
    """A Trimesh and its fills: vertices as they are needed, one for each place and texture coordinate there."""

    def __init__(self, mesh: Any, welded: Welded, fills: Sequence[Fill], joined: Joined | None) -> None:
        self._mesh, self._welded, self._fills, self._joined = mesh, welded, fills, joined
        visual = mesh.visual
        self.kind = getattr(visual, "kind", None)
        self._uv: Any = np.asarray(visual.uv) if self.kind == "texture" and visual.uv is not None else None
        count = len(mesh.faces)
        self.by_face = {name: np.asarray(each) for name, each in mesh.face_attributes.items() if len(each) == count}
        looks = [*self.by_face.values()]
        if self.kind == "face":
            looks.append(visual.face_colors)
        elif self.kind == "texture" and visual.face_materials is not None:
            looks.append(np.asarray(visual.face_materials))
        self._old = MeshFile(welded.vertices, welded.faces)
        self._copies: dict[int, list[int]] = {}
        for fill in fills:
            used = np.unique(fill._flat_faces()[1])
            self._copies |= {v: [] for v in used[used < len(welded.vertices)].tolist()}
        if joined:
            self._copies |= {v: [] for _, _, v, _ in joined.splits}
        for k in np.flatnonzero(np.isin(welded.to, list(self._copies))).tolist():
            self._copies[int(welded.to[k])].append(k)
        self.points = np.array(mesh.vertices, float)
        self.new_uv: list[Array] = []
        self.added: list[tuple[int, int]] = []  # fill and vertex of it, or -1 and a vertex of the Trimesh, of each new one
        self._numbers: dict[tuple[int, int, bytes], int] = {}
        self.faces: list[list[int]] = []
        self.models: list[int] = []
        self.continued = []
        if joined and joined.splits:
            self._join(joined)
        for k, fill in enumerate(fills):
            look = Continued(
                self._old.vertices,
                self._old.faces.__getitem__,
                fill,
                lambda f: tuple(each[welded.kept[f]].tobytes() for each in looks),
                self._old._faces_at,
            )
            self.continued.append(look)
            self._add(k, fill, look)

    def _join(self, joined: Joined) -> None:
        """Triangles in place of those that get vertices within their edges."""
        points = self._welded.vertices.copy()
        points[joined.moved[0]] = joined.moved[1]
        old, own = self._welded.faces, np.asarray(self._mesh.faces)
        uv = {}
        for f, corner, v, t in joined.splits:
            a, b = (own[self._welded.kept[f]][c % 3] for c in (corner, corner + 1))
            uv[f, v] = None if self._uv is None else (1 - t) * self._uv[a] + t * self._uv[b]
        _, corners, of_face = joined.triangles(points, 3 * np.arange(len(old) + 1), old.reshape(-1))
        split = np.isin(of_face, list({f for f, _ in uv}))
        for f, triangle in zip(of_face[split].tolist(), corners.reshape(-1, 3)[split].tolist(), strict=True):
            adjacent = dict(zip(old[f].tolist(), own[self._welded.kept[f]].tolist(), strict=True))
            new = [adjacent[v] if v in adjacent else self._number(-1, v, uv[f, v], [*adjacent.values()]) for v in triangle]
            self.faces.append(new)
            self.models.append(int(self._welded.kept[f]))

    def _add(self, k: int, fill: Fill, continued: Continued) -> None:
        count, kept = len(self._welded.vertices), self._welded.kept
        old = np.asarray(self._mesh.faces)
        values = None if self._uv is None else continued.at_corners(lambda f: self._uv[old[kept[f]]])
        plain = None if self._uv is None else continued.at_vertices(lambda rim: self._uv[self._welded.first[rim]])
        models = continued.model or [0] * len(fill.faces)
        places = np.concatenate([self._welded.vertices, fill.vertices])
        lists = _arrays.index_lists(fill.faces)
        triangles, of_face = quality.triangulated(lists, places)
        for triangle, f in zip(triangles.tolist(), of_face.tolist(), strict=True):
            corners = []
            for v in triangle:
                uv = None
                if values is not None:
                    uv = values[f][lists[f].index(v)]
                elif plain is not None:
                    uv = plain[v - count] if v >= count else self._uv[self._welded.first[v]]
                corners.append(self._number(k, v, uv, old[kept[models[f]]].tolist()))
            self.faces.append(corners)
            self.models.append(int(kept[models[f]]))

    def _number(self, k: int, v: int, uv: Array | None, adjacent: Sequence[int]) -> int:
        """The vertex at a place with these texture coordinates."""
        count = len(self._welded.vertices)
        if v < count:
            copies = self._copies[v]
            if uv is None:
                return next((c for c in adjacent if c in copies), copies[0])
            near = np.abs(self._uv[copies] - uv).max(axis=1)
            if near.min() <= SAME * max(float(np.ptp(self._uv, axis=0).max()), 1e-12):
                return copies[int(near.argmin())]
        key = (k if v >= count else -1, v, b"" if uv is None else np.asarray(uv, np.float32).tobytes())
        if key not in self._numbers:
            self._numbers[key] = len(self.points) + len(self.added)
            self.added.append((k, v - count) if v >= count else (-1, self._copies[v][0]))
            if uv is not None:
                self.new_uv.append(uv)
        return self._numbers[key]

    def vertices(self) -> Array:
        """All of them, in the order of `of_vertices`."""
        for moved in [*([self._joined.moved] if self._joined else []), *(fill.moved for fill in self._fills)]:
            for v, place in zip(*moved, strict=True):
                self.points[self._welded.to == v] = place
        new = [self.points[v] if k < 0 else self._fills[k].vertices[v] for k, v in self.added]
        return np.concatenate([self.points, np.reshape(new, (-1, 3))])

    def of_vertices(self, given: Array) -> Array:
        """Values of all vertices from those of the Trimesh."""
        by_fill = [_at_new_vertices(each, given[self._welded.first]) for each in self.continued]
        new = [given[v] if k < 0 else by_fill[k][v] for k, v in self.added]
        return np.concatenate([given, np.reshape(np.array(new, given.dtype), (-1, *given.shape[1:]))])

    def normals(self, given: Array) -> Array:
        """Those of all vertices: of new ones the fill's own."""
        new = [given[v] if k < 0 else self._fills[k].normals[v] for k, v in self.added]
        return np.concatenate([given, np.reshape(new, (-1, 3))])


def filled(mesh: Any, welded: Welded, fills: Sequence[Fill], joined: Joined | None = None) -> Any:
    """A trimesh.Trimesh with its colors or texture, normals and attributes. joined: what joining borders changes in it."""
    if any(len(fill.split_edges[0]) for fill in fills):
        raise WrongValue(Message("mesh_of_triangles"))
    if not fills and not joined:
        return mesh.copy()
    whole = _Filled(mesh, welded, fills, joined)
    split = [f for f, *_ in joined.splits] if joined else []
    gone = welded.kept[np.unique(np.concatenate([np.array(split, np.int64), *(fill.replaced for fill in fills)]))]
    stay = np.setdiff1d(np.arange(len(mesh.faces)), gone)
    models = np.concatenate([stay, whole.models]).astype(np.int64)
    visual, kind = mesh.visual, whole.kind

    def of_vertices(name: str, values: Any) -> Any:
        given = np.asarray(values)
        if len(given) != len(mesh.vertices) or given.dtype == object:
            return copy.copy(values)
        return np.concatenate([given, np.reshape(whole.new_uv, (-1, 2))]) if name == "uv" else whole.of_vertices(given)

    normals = np.asarray(mesh.vertex_normals) if "vertex_normals" in mesh._cache.cache else None
    made = mesh.copy()
    made.vertices, made.faces = whole.vertices(), np.concatenate([np.asarray(mesh.faces)[stay], np.reshape(whole.faces, (-1, 3))])
    made.vertex_attributes = {name: of_vertices("", values) for name, values in mesh.vertex_attributes.items()}
    made.face_attributes = {**mesh.face_attributes, **{name: each[models] for name, each in whole.by_face.items()}}
    if kind == "texture":
        made.visual = visual.copy()
        for name, values in visual.vertex_attributes.data.items():
            made.visual.vertex_attributes[name] = of_vertices(name, values)
        if visual.face_materials is not None:
            made.visual.face_materials = np.asarray(visual.face_materials)[models]
    elif kind in ("vertex", "face"):
        colors = of_vertices("", visual.vertex_colors) if kind == "vertex" else visual.face_colors[models]
        made.visual = type(visual)(mesh=made, **{f"{kind}_colors": colors})
    else:
        made.visual = type(visual)(mesh=made)
    if normals is not None:
        made.vertex_normals = whole.normals(normals)
    return made
