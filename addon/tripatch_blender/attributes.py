# SPDX-License-Identifier: GPL-3.0-or-later
"""What new vertices, faces and face corners take over from the rim: UVs, colors, weights, material, shading."""

from __future__ import annotations

from collections import Counter

from . import versions
from .library import charts, np
from .selection import coordinates

# Layers of floats that are blended, by kind of element, and how a value is written.
_VERTEX_LAYERS = ("float", "float_vector", "float_color", "color", "paint_mask")
_LOOP_LAYERS = ("float", "float_vector", "float_color", "color", "uv")
# Values that are picked from the nearest rim vertex or corner.
_PICKED = ("int", "bool", "string")
# The selection of UVs, and normals: not the rim's to give.
_OWN = (".", "custom_normal")
# What Blender names with a dot and is the rim's to give: what a brush was painted with.
_GIVEN = (".sculpt_mask",)
# Creases and bevel weights are 0 inside a fill.
_ZERO = ("crease_vert", "bevel_weight_vert")


def read(value, kind):
    if kind == "uv":
        return tuple(value.uv)
    return tuple(value) if hasattr(value, "__len__") else (value,)


def write(element, layer, kind, value):
    if kind == "uv":
        element[layer].uv = value
    else:
        element[layer] = value if len(value) > 1 else value[0]


def _layers(access, kinds):
    for kind in kinds:
        for name, layer in getattr(access, kind, {}).items() if hasattr(access, kind) else ():
            if not name.startswith(_OWN) or name in _GIVEN:
                yield kind, name, layer


def edge_layers(bm):
    """(kind, layer, whether its values are blended) of all data of edges."""
    layers = bm.edges.layers
    for kind in ("crease", "bevel_weight", "freestyle"):  # Blender 3
        for layer in getattr(layers, kind).values() if hasattr(layers, kind) else ():
            yield kind, layer, kind != "freestyle"
    for kinds, blended in ((_VERTEX_LAYERS, True), (_PICKED, False)):
        for kind, _, layer in _layers(layers, kinds):
            if kind != "string" or versions.READS_STRINGS:
                yield kind, layer, blended


def blend_vertices(bm, ends, inside, blend, kept=()):
    """Gives the new vertices `inside` the vertex data of the rim. ends: the vertices at both ends of each of its edges.

    kept: rows of those that were in the mesh before, which keep what they have; groups only where they have weights.
    """
    layers, new = bm.verts.layers, [k for k in range(len(inside)) if k not in kept]
    for kind, name, layer in _layers(layers, _VERTEX_LAYERS):
        values = blend(np.array([read(v[layer], kind) for v in ends], dtype=np.float64)).tolist()
        for k in new:
            write(inside[k], layer, kind, values[k] if name not in _ZERO else [0.0])
    for kind in ("crease", "bevel_weight"):  # Blender 3
        for layer in getattr(layers, kind).values() if hasattr(layers, kind) else ():
            for k in new:
                inside[k][layer] = 0.0
    for layer in layers.deform.values():
        weights = [dict(v[layer].items()) for v in ends]
        groups = sorted({g for w in weights for g in w})
        if not groups:
            continue
        values = blend(np.array([[w.get(g, 0.0) for g in groups] for w in weights], dtype=np.float64)).tolist()
        for k in (*new, *(k for k in kept if not len(inside[k][layer]))):
            inside[k][layer].clear()
            for group, weight in zip(groups, values[k], strict=True):
                if weight > 0:
                    inside[k][layer][group] = weight


def rim_faces(edges, replaced):
    """For each rim edge the surrounding face."""
    return [next(f for f in edge.link_faces if f not in replaced) for edge in edges]


def has_corner_data(bm):
    """Whether face corners have anything that a fill could continue: else they are better left alone, since the first look at one
    of them gives all of the mesh a place in memory for Python."""
    return any(True for _ in _layers(bm.loops.layers, (*_LOOP_LAYERS, *_PICKED)))


def rim_loops(edges, faces):
    """For each rim edge the face corners of the surrounding face at its start and end, in rim direction."""
    ends = []
    for edge, face in zip(edges, faces, strict=True):
        loop = next(corner for corner in edge.link_loops if corner.face == face)
        # The surrounding face runs along the edge against the rim.
        ends += [loop.link_loop_next, loop]
    return ends


def ends_of_corner(place, before, owned):
    """The ends of rim edges, as `rim_loops` counts them, that a new face's corner at rim vertex `place` continues.

    before: place of the vertex before; owned: places of the rim edges that belong to the new face.
    """
    after = place
    if before in owned and after not in owned:
        return (2 * before + 1,)
    if after in owned and before not in owned:
        return (2 * after,)
    return (2 * before + 1, 2 * after)


def blend_corners(bm, ends, corners, blend, nearest, charts=None):
    """Gives face corners the corner data of the rim.

    ends: face corners of the surroundings at the ends of the rim edges; corners: (new face corner, number of the vertex inside,
    ends that it continues, none inside); nearest: for each vertex inside the end whose values it takes where they cannot be
    blended. Where two surrounding faces disagree at their vertex the later one counts; UV maps that a seam parts are given by
    charts: {name: values of the corners}.
    """
    if not versions.READS_STRINGS and any(True for _ in _layers(bm.loops.layers, ("string",))):
        for corner, vertex, continued in corners:  # Python reads none of the strings that an attribute has there
            corner.copy_from(ends[continued[-1] if continued else nearest[vertex]])
    for kind, name, layer in _layers(bm.loops.layers, _LOOP_LAYERS):
        if kind == "uv" and charts and name in charts:
            for (corner, _, _), uv in zip(corners, charts[name], strict=True):
                corner[layer].uv = uv
            continue
        at_rim = np.array([read(loop[layer], kind) for loop in ends], dtype=np.float64)
        inside = blend(at_rim).tolist()
        at_rim = at_rim.tolist()
        for corner, vertex, continued in corners:
            write(corner, layer, kind, at_rim[continued[-1]] if continued else inside[vertex])
    for kind, _name, layer in _layers(bm.loops.layers, _PICKED):
        for corner, vertex, continued in corners if kind != "string" or versions.READS_STRINGS else ():
            corner[layer] = ends[continued[-1] if continued else nearest[vertex]][layer]


def between_corners(bm, face, place, ends, share):
    """Gives the corner of a face at a place the corner data between two others."""
    face.loops[place].copy_from(ends[int(share > 0.5)])
    corner = face.loops[place]  # read again: from Blender 4 on a copy ends what Python had of the corner
    for kind, _, layer in _layers(bm.loops.layers, _LOOP_LAYERS):
        pairs = zip(*(read(end[layer], kind) for end in ends), strict=True)
        write(corner, layer, kind, [(1 - share) * a + share * b for a, b in pairs])


def shares(values, blend, after):
    """charts.Shares of values of each rim edge. after: places of the next vertices."""
    return charts.Shares(values, blend, np.array(after))


def uv_charts(bm, ends, blend, positions, faces):
    """UV maps that seams of the surroundings part at the rim: {name: UV of every corner of the new faces}.

    positions (r + k, 3): of the rim and the vertices inside; faces: of places in it.
    """
    found, adjacent, places = {}, [list(loop.face.loops) for loop in ends[::2]], None
    for kind, name, layer in _layers(bm.loops.layers, ("uv",)):
        at_ends = np.array([read(loop[layer], kind) for loop in ends], dtype=np.float64)
        if charts.seams_at(at_ends, np.roll(np.arange(len(ends) // 2), -1)).sum() < 2:
            continue  # no seam, or one that ends here and has nowhere to go
        places = places or [coordinates([loop.vert for loop in loops]) for loops in adjacent]
        uvs = [np.array([read(loop[layer], kind) for loop in loops], dtype=np.float64) for loops in adjacent]
        values = charts.continue_corners(positions, faces, at_ends, list(zip(places, uvs, strict=True)), blend)
        found[name] = [uv.tolist() for face in values or () for uv in face]
    return found


def uv_jumps(bm, faces):
    """The edges of some faces at which a UV map of the faces on both sides differs."""
    edges = [edge for edge in {e for f in faces for e in f.edges} if len(edge.link_loops) == 2]
    jumping = np.zeros(len(edges), bool)
    for _, _, layer in _layers(bm.loops.layers, ("uv",)):
        own, other = np.zeros((2, len(edges), 2, 2))
        for k, edge in enumerate(edges):
            a, b = edge.link_loops
            beyond = (b.link_loop_next, b) if a.vert != b.vert else (b, b.link_loop_next)
            own[k] = a[layer].uv, a.link_loop_next[layer].uv
            other[k] = beyond[0][layer].uv, beyond[1][layer].uv
        within = charts.SAME * max(np.ptp(own.reshape(-1, 2), axis=0).max(initial=0), 1e-12) if len(edges) else 0
        jumping |= (np.abs(own - other) > within).any(axis=(1, 2))
    return [edge for edge, jumps in zip(edges, jumping, strict=True) if jumps]


def model_faces(surrounding, on_side):
    """For each side the surrounding face whose material and shading most of its rim edges have. on_side: sides by rim edge."""
    models = []
    for side in range(max(on_side.values()) + 1):
        faces = [surrounding[e] for e in sorted(on_side) if on_side[e] == side]
        most = Counter((f.material_index, f.smooth) for f in faces).most_common(1)[0][0]
        models.append(next(f for f in faces if (f.material_index, f.smooth) == most))
    return models
