# SPDX-License-Identifier: GPL-3.0-or-later
"""Notches in an open border: one or two chains of its edges are selected, and new edges join their ends.

While such a hole is filled, a strip of faces lies beyond the new edges and tells how the surface continues there.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from . import attributes, selection
from .library import np

#: Of the square of the border's length: what has less area between its chains and the new edges is no notch.
_NO_AREA = 0.01


@dataclass
class Notch:
    """A hole that is closed by new edges, and what is in the mesh for them."""

    rim: selection.Rim
    added: list = field(default_factory=list)  # BMVert on the new edges
    strip: list = field(default_factory=list)  # BMFace beyond them
    beyond: list = field(default_factory=list)  # BMVert of these alone
    edges: list = field(default_factory=list)  # BMEdge that are new


def _runs(loop, chosen):
    """Chains of vertices along the chosen edges of a loop; chosen: of each edge."""
    starts = [k for k in range(len(loop)) if chosen[k] and not chosen[k - 1]]
    runs = []
    for k in starts:
        length = next(n for n in range(1, len(loop)) if not chosen[(k + n) % len(loop)])
        runs.append([loop[(k + n) % len(loop)] for n in range(length + 1)])
    return runs


def chains(bm, refused):
    """One or two chains of vertices that the refused parts of a selection consist of, else none. refused: UnusableError."""
    if not refused or any(reason.code != "part_of_border" for reason in refused):
        return []
    found = []
    for reason in refused:
        loop = reason.rim.loop
        found += _runs(loop, [edge is not None and edge.select for edge in selection.edges_of(bm, loop)])
    apart = len({v for chain in found for v in chain}) == sum(map(len, found))
    return found if apart and len(found) <= 2 and sum(map(len, found)) > 2 else []


def _normal(vertex):
    total = np.sum([f.normal * f.calc_area() for f in vertex.link_faces], axis=0)
    return total / max(np.linalg.norm(total), 1e-30)


def _curve(start, end, edge):
    """Points between two vertices on a curve that leaves both within their tangent planes, and the normals there."""
    a, b, first, last = np.array(start.co), np.array(end.co), _normal(start), _normal(end)
    chord = b - a
    length = np.linalg.norm(chord)
    slopes = []
    for n in (first, last):
        flat = chord - n * n.dot(chord)
        slopes.append(flat * (length / max(np.linalg.norm(flat), 1e-30)))
    count = max(1, round(length / edge))
    t = np.arange(1, count)[:, None] / count
    points = (1 - t) ** 2 * (1 + 2 * t) * a + t**2 * (3 - 2 * t) * b + t * (1 - t) ** 2 * slopes[0] - t**2 * (1 - t) * slopes[1]
    normals = (1 - t) * first + t * last
    return points, normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)


def _is_notch(points, normals):
    """Whether a closed polygon has an area on the side of its normals."""
    nexts = np.roll(points, -1, axis=0)
    area = np.cross(points - points[0], nexts - points[0]).sum(axis=0) / 2
    around = np.linalg.norm(nexts - points, axis=1).sum()
    return area.dot(normals.mean(axis=0)) > _NO_AREA * around**2


def _corner(vertex):
    return vertex.link_loops[0]


def _strip(bm, notch, start, end, between, normals, edge):
    """Faces beyond the new edges, with the corner data of the mesh at their ends."""
    row = [start, *between, end]
    known = bm.edges.get((start, end)) if not between else None
    places = selection.coordinates(row)
    along = np.gradient(places, axis=0)
    out = np.cross(along, normals)
    out *= edge / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-30)
    far = [bm.verts.new(co, start) for co in (places + out).tolist()]
    for layer in bm.verts.layers.shape.values():
        for vertex, from_ in zip(far, row, strict=True):
            vertex[layer] = from_[layer] + vertex.co - from_.co
    notch.beyond += far
    ends, share = [_corner(start), _corner(end)], np.linspace(0, 1, len(row))
    for k in range(len(row) - 1):
        face = bm.faces.new((row[k + 1], row[k], far[k], far[k + 1]), ends[0].face)
        face.select = False
        notch.strip.append(face)
        for place, at in enumerate((k + 1, k, k, k + 1)):
            attributes.between_corners(bm, face, place, ends, share[at])
    new = [bm.edges.get(pair) for pair in zip(row, row[1:], strict=False)]
    notch.edges += [edge for edge in new if edge != known]


def _close(bm, parts):
    """The `Notch` between chains, with its strips in the mesh, or None."""
    edge = np.mean([(a.co - b.co).length for chain in parts for a, b in zip(chain, chain[1:], strict=False)])
    curves = [_curve(chain[-1], other[0], edge) for chain, other in zip(parts, parts[1:] + parts[:1], strict=True)]
    if len(parts) == 1 and not len(curves[0][0]) and bm.edges.get((parts[0][-1], parts[0][0])):
        return None
    points, normals = [], []
    for chain, (places, own) in zip(parts, curves, strict=True):
        points += [selection.coordinates(chain), places]
        normals += [np.array([_normal(v) for v in chain]), own]
    if not _is_notch(np.concatenate(points), np.concatenate(normals)):
        return None
    notch, loop = Notch(selection.Rim([])), []
    for chain, other, (places, own) in zip(parts, parts[1:] + parts[:1], curves, strict=True):
        between = [bm.verts.new(co, chain[-1]) for co in places.tolist()]
        for layer in bm.verts.layers.shape.values():
            for k, vertex in enumerate(between, 1):
                moved = (chain[-1][layer] - chain[-1].co).lerp(other[0][layer] - other[0].co, k / (len(between) + 1))
                vertex[layer] = vertex.co + moved
        loop += [*chain, *between]
        notch.added += between
        ends = np.array([_normal(chain[-1]), *own, _normal(other[0])])
        _strip(bm, notch, chain[-1], other[0], between, ends, edge)
    notch.rim.loop = loop
    bm.verts.index_update()
    bm.faces.index_update()
    bm.normal_update()
    return notch


def close(bm, refused):
    """A `Notch` if parts of a border that were refused are one, with its strips in the mesh until `end`; else None."""
    parts = chains(bm, refused)
    return _close(bm, parts) if parts else None


def end(bm, notch):
    """Takes the strips out of the mesh again, and the vertices of new edges that no face has taken up."""
    for face in notch.strip:
        if face.is_valid:
            bm.faces.remove(face)
    for edge in notch.edges:
        if edge.is_valid and not edge.link_faces:
            bm.edges.remove(edge)
    for vertex in (*notch.beyond, *notch.added):
        if vertex.is_valid and not vertex.link_faces:
            bm.verts.remove(vertex)
    bm.verts.index_update()
    bm.edges.index_update()
    bm.faces.index_update()
