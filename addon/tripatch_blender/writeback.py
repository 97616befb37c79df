# SPDX-License-Identifier: GPL-3.0-or-later
"""Fills, as arrays -> faces of a BMesh, with their attributes."""

from __future__ import annotations

from dataclasses import dataclass, field

import bmesh

from . import attributes, normals
from .library import np
from .selection import Rim, edges_of, pairs

# Cosine of 0.5 degrees; Blender parts a fan of face corners by a sharp edge from 0.8 degrees on.
_SAME_NORMAL = 0.99996


@dataclass
class Planned:
    """A fill that is ready to be written: nothing in the BMesh has changed yet."""

    rim: Rim
    fill: object  # tripatch.Fill in world space, in the vertex numbers of the BMesh
    loop: list  # BMVert from corner 0 on
    positions: np.ndarray  # (k, 3) of the new vertices in object space
    normals: np.ndarray  # (k, 3)
    rim_normals: np.ndarray  # (r, 3)
    tangent: bool  # to the surroundings
    in_shape_keys: dict = field(default_factory=dict)  # name: (k, 3)


def obstacle(bm, planned, count):
    """A sentence if the new faces cannot be joined to the mesh without damage to it."""
    rim = {v.index: v for v in planned.loop}
    edges = {frozenset((a.index, b.index)) for a, b in pairs(planned.loop)}
    for face in planned.fill.faces:
        if all(v < count for v in face) and (old := bm.faces.get([rim[v] for v in face])) and old not in planned.rim.replaced:
            return f"There is a face between vertices {', '.join(map(str, face))} of the rim already"
        for a, b in pairs(face):
            if a < count and b < count and frozenset((a, b)) not in edges:
                edge = bm.edges.get((rim[a], rim[b]))
                if edge and any(f not in planned.rim.replaced for f in edge.link_faces):
                    return f"An edge with faces joins vertices {a} and {b} across the hole"
    return ""


def _sides(planned):
    """For each side the places of its rim edges."""
    count = len(planned.loop)
    corner = [int(np.argmax(planned.fill.rim_barycentric[:, i])) for i in range(3)]
    return [range(corner[(i + 1) % 3], corner[(i + 2) % 3] or count) for i in range(3)]


def _write_one(bm, planned, count, shading, custom):
    """Creates the faces of one fill. custom: {face corner: normal} of the surroundings, or None. Returns the new faces."""
    loop, fill, rim = planned.loop, planned.fill, planned.rim
    edges = edges_of(bm, loop)
    ends = attributes.rim_loops(edges, rim.replaced)
    sides = _sides(planned)
    models = attributes.model_faces([corner.face for corner in ends[::2]], sides)
    blend = attributes.Blend(fill.rim_barycentric, fill.barycentric)

    if rim.replaced:
        bmesh.ops.delete(bm, geom=list(rim.replaced), context="FACES")
    ends_at = [loop[(k + 1) // 2 % len(loop)] for k in range(2 * len(loop))]
    # A vertex made from an example has no place in any shape key yet; one made without would pass for the first of the mesh.
    inside = [
        bm.verts.new(co, ends_at[near]) for co, near in zip(planned.positions.tolist(), blend.nearest.tolist(), strict=True)
    ]
    attributes.blend_vertices(bm, loop, inside, blend)
    for name, layer in bm.verts.layers.shape.items():
        for vertex, co in zip(inside, planned.in_shape_keys.get(name, planned.positions).tolist(), strict=True):
            vertex[layer] = co

    place = {v: k for k, v in enumerate(fill.rim.tolist())}  # deleting has changed the indices in the BMesh
    place_of_edge = {frozenset(pair): k for k, pair in enumerate(pairs(list(range(len(loop)))))}
    barycentric = np.vstack([fill.rim_barycentric, fill.barycentric])
    new_faces, corners = [], []
    for face in fill.faces:
        rows = [place[v] if v < count else len(loop) + v - count for v in face]
        side = int(np.argmin(barycentric[rows].sum(axis=0)))
        made = bm.faces.new([loop[k] if k < len(loop) else inside[k - len(loop)] for k in rows], models[side])
        made.hide = False
        made.smooth = models[side].smooth if shading == "neighbors" else shading == "smooth"
        made.normal_update()
        new_faces.append(made)
        own = {place_of_edge.get(frozenset(pair)) for pair in pairs(rows)}
        for corner, k in zip(made.loops, rows, strict=True):
            continued = attributes.ends_of_corner(k, len(loop), own) if k < len(loop) else ()
            corners.append((corner, k - len(loop), continued))
    attributes.blend_corners(bm, ends, corners, blend)
    if custom is not None:
        _give_normals(planned, custom, ends, corners)
    return new_faces


def _give_normals(planned, custom, ends, corners):
    """Adds the normals of the new face corners to `custom`: the exact ones of the fill. Where fill and surroundings are tangent,
    a seam has the normal that the surroundings have there, which Blender keeps for both while no sharp edge parts them."""
    for corner, number, continued in corners:
        if not continued:
            custom[corner] = planned.normals[number]
            continue
        around = [custom[ends[end]] for end in continued]
        agree = all(normal @ around[0] > _SAME_NORMAL for normal in around)
        exact = planned.rim_normals[(continued[-1] + 1) // 2 % len(planned.loop)]
        custom[corner] = around[0] if planned.tangent and agree else exact


def write(bm, mesh, all_planned, shading):
    """Writes fills into the BMesh; returns the new faces. The BMesh is the one that they were planned on."""
    count = len(bm.verts)
    custom = None
    if normals.has_custom_normals(bm, mesh):
        kept = {v for planned in all_planned for v in planned.loop}
        custom = normals.corner_normals(bm, kept)
    gone = {f for planned in all_planned for f in planned.rim.replaced}
    if custom is not None:
        custom = {corner: normal for corner, normal in custom.items() if corner.face not in gone}
    new_faces = []
    for planned in all_planned:
        new_faces += _write_one(bm, planned, count, shading, custom)
    if custom is not None:
        normals.set_corner_normals(bm, custom)
    return new_faces
