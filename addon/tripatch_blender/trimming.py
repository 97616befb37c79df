# SPDX-License-Identifier: GPL-3.0-or-later
"""The faces within a distance of a seam, cut out of a mesh so that a fill can take their place."""

from __future__ import annotations

import bmesh

from . import filling, selection, waiting
from .library import np
from .selection import UnusableError

#: Of the sharpest edge among the selected faces: edges that turn by less are not the seam.
_SHARE_OF_SHARPEST = 0.5
#: Radians: where no edge turns by more the faces have no seam.
_MIN_TURN = 0.1
#: Of the width: a vertex that is so near the new boundary is on it. The boundary may be off by 5%.
_ON_BOUNDARY = 0.04


def seam_of(faces):
    """The sharp edges inside some faces."""
    inner = [e for e in {e for f in faces for e in f.edges} if len(e.link_faces) == 2 and all(f in faces for f in e.link_faces)]
    turns = {e: e.calc_face_angle(0.0) for e in inner}
    most = max(turns.values(), default=0.0)
    if most < _MIN_TURN:
        raise UnusableError("no_sharp_edge", [v for f in faces for v in f.verts])
    return selection.by_index(e for e, turn in turns.items() if turn > _SHARE_OF_SHARPEST * most)


def _distances(points, starts, ends):
    """(n,) of points from the nearest of some segments."""
    least, way = np.full(len(points), np.inf), ends - starts
    length = np.maximum((way**2).sum(axis=1), 1e-300)
    for k in range(len(starts)):
        t = np.clip((points - starts[k]) @ way[k] / length[k], 0, 1)
        least = np.minimum(least, np.linalg.norm(points - starts[k] - t[:, None] * way[k], axis=1))
    return least


class _Field:
    """Distances of vertices from a seam, in the world."""

    def __init__(self, seam, world):
        self._world = world
        at = self._places([v for e in seam for v in e.verts])
        self._starts, self._ends = at[::2], at[1::2]
        self._known = {}

    def _places(self, vertices):
        return selection.coordinates(vertices) @ self._world[:3, :3].T + self._world[:3, 3]

    def of(self, vertices):
        new = [v for v in vertices if v not in self._known]
        if new:
            self._known.update(zip(new, _distances(self._places(new), self._starts, self._ends).tolist(), strict=True))
        return [self._known[v] for v in vertices]

    def put(self, vertex, distance):
        self._known[vertex] = distance


def _near_faces(seam, field, width):
    """The faces around a seam that have a vertex within the width."""
    found = {f for e in seam for f in e.link_faces}
    stack = list(found)
    while stack:
        for edge in stack.pop().edges:
            if min(field.of(edge.verts)) >= width:
                continue
            more = set(edge.link_faces) - found
            found |= more
            stack += more
    return found


def _cut(bm, faces, field, width):
    """Cuts faces along the points at a distance. Returns the vertices there."""
    on = {v for f in faces for v in f.verts if abs(field.of([v])[0] - width) <= _ON_BOUNDARY * width}
    for edge in selection.by_index({e for f in faces for e in f.edges}):
        a, b = edge.verts
        near, far = field.of([a, b])
        if a in on or b in on or (near - width) * (far - width) >= 0:
            continue
        _, new = bmesh.utils.edge_split(edge, a, (width - near) / (far - near))
        field.put(new, width)
        on.add(new)
    bmesh.ops.connect_verts(bm, verts=list(on), check_degenerate=False)
    return on


def _regions(bm, world, faces, width):
    return selection.rims_of_faces(_trim(bm, world, faces, width))


def rims(bm, world, faces, width, options):
    """The rims of what lies within a distance of the seam among some faces, which is cut out of the mesh. It is tried in a copy
    first: UnusableError if no surface takes its place, and the mesh is as it was."""
    if not faces:
        raise UnusableError("seam_faces_needed")
    copy = bm.copy()
    try:
        copy.faces.ensure_lookup_table()
        tried = _regions(copy, world, [copy.faces[f.index] for f in faces], width)
        refused = filling.refusals(copy, tried, world, options)
    finally:
        copy.free()
    if refused:
        raise UnusableError.of(refused[0], [v for f in faces for v in f.verts])
    waiting.must_finish()
    made = _regions(bm, world, faces, width)
    bm.verts.index_update()
    bm.edges.index_update()
    bm.faces.index_update()
    return made


def _trim(bm, world, faces, width):
    """Cuts the mesh at a distance from the seam among some faces. Returns the faces within it, which are to be replaced."""
    seam = seam_of(set(faces))
    bm.verts.index_update()
    bm.edges.index_update()
    field = _Field(seam, world)
    near = _near_faces(seam, field, width)
    if any(e.is_boundary for f in near for e in f.edges):
        raise UnusableError("border_within_width", [v for f in near for v in f.verts])
    on = _cut(bm, near, field, width)
    inside = {v for v in {v for f in near if f.is_valid for v in f.verts} if v not in on and field.of([v])[0] < width}
    return {f for v in inside for f in v.link_faces}
