# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the last fill of each mesh meets its surroundings, as long as Blender runs."""

from __future__ import annotations

from dataclasses import dataclass

from . import selection
from .library import np


@dataclass
class _Seam:
    """Of the last fills of a mesh."""

    edges: np.ndarray  # (k, 2) their vertices
    angle: float | None  # that the fills report, in degrees
    near: np.ndarray  # the vertices of the faces at the seam,
    places: np.ndarray  # and where these are, (n, 3) float32


_last: dict[str, _Seam] = {}  # by name of the mesh


def remember(bm, name, loops, chains=(), angle=None):
    """After fills were written into a BMesh; loops: lists of BMVert, chains: such that are not closed. An edge that was split
    counts as its two halves. angle: that the fills report."""
    bm.verts.index_update()
    found = []
    closed = [pair for loop in loops if all(v.is_valid for v in loop) for pair in selection.pairs(loop)]
    opened = [pair for chain in chains if all(v.is_valid for v in chain) for pair in zip(chain, chain[1:], strict=False)]
    for a, b in closed + opened:
        if bm.edges.get((a, b)):
            found.append((a.index, b.index))
            continue
        both = {e.other_vert(a) for e in a.link_edges} & {e.other_vert(b) for e in b.link_edges}
        if both:
            new = max(v.index for v in both)  # the last that was made
            found += [(a.index, new), (new, b.index)]
    rims = {v for loop in (*loops, *chains) for v in loop if v.is_valid}
    near = selection.by_index({v for rim in rims for f in rim.link_faces for v in f.verts})
    places = selection.coordinates(near).astype(np.float32)
    edges = np.array(found, dtype=np.int64).reshape(-1, 2)
    _last[name] = _Seam(edges, angle, np.array([v.index for v in near], dtype=np.int64), places)


def reported(name, places):
    """The angle that the last fills of a mesh report, as long as nothing at their seam has moved; else None. places: of the
    vertices (n, 3) float32 as they are seen."""
    last = _last.get(name)
    if last is None or last.near.max(initial=-1) >= len(places) or not np.array_equal(places[last.near], last.places):
        return None
    return last.angle


def edges(mesh, evaluated=None):
    """(k, 2) vertices of the last fill's rim, or of the selected edges where none is known. In edit mode only what was evaluated
    knows what is selected."""
    if mesh.name in _last:
        return _last[mesh.name].edges
    mesh = evaluated or mesh
    ends, selected = np.empty(2 * len(mesh.edges), np.int32), np.empty(len(mesh.edges), bool)
    mesh.edges.foreach_get("vertices", ends)
    mesh.edges.foreach_get("select", selected)
    if selected.all():  # as in a mesh that was just made: nothing is meant by it
        selected[:] = False
    return ends.reshape(-1, 2)[selected].astype(np.int64)


def is_subdivided(mesh, made, level):
    """Whether an evaluated mesh can be what a Subdivision modifier alone made of another."""
    inside, corners = 2**level - 1, 2 ** (level - 1) - 1
    new_in_faces = len(mesh.polygons) + len(mesh.loops) * (corners + corners**2)
    return len(made.vertices) == len(mesh.vertices) + len(mesh.edges) * inside + new_in_faces


def subdivided(pairs, mesh, count):
    """The same edges in what a Subdivision modifier made of a mesh: its vertices come first, then those inside of each edge, edge
    by edge in the direction of the edge.

    count: of the vertices inside of an edge.
    """
    if not count or not len(pairs):
        return pairs
    ends = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", ends)
    ends = ends.reshape(-1, 2).astype(np.int64)
    size = len(mesh.vertices)
    keys = ends.min(axis=1) * size + ends.max(axis=1)
    order = np.argsort(keys)
    at = np.searchsorted(keys[order], pairs.min(axis=1) * size + pairs.max(axis=1))
    at = order[np.minimum(at, len(order) - 1)]
    at = at[keys[at] == pairs.min(axis=1) * size + pairs.max(axis=1)]
    inside = size + at[:, None] * count + np.arange(count)
    chain = np.column_stack([ends[at, 0], inside, ends[at, 1]])
    return np.stack([chain[:, :-1], chain[:, 1:]], axis=2).reshape(-1, 2)


def forget():
    _last.clear()
