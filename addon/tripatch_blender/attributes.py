# SPDX-License-Identifier: GPL-3.0-or-later
"""What new vertices, faces and face corners take over from the rim: UVs, colours, weights, material, shading."""

from __future__ import annotations

from collections import Counter

from .library import np
from .selection import pairs

# Layers of floats that are blended, by kind of element, and how a value is written.
_VERTEX_LAYERS = ("float", "float_vector", "float_color", "color", "paint_mask")
_LOOP_LAYERS = ("float", "float_vector", "float_color", "color", "uv")
# Values that are picked from the nearest rim vertex or corner.
_PICKED = ("int", "bool", "string")
# The selection of UVs, and normals: not the rim's to give.
_OWN = (".", "custom_normal")
# Creases and bevel weights are 0 inside a fill.
_ZERO = ("crease_vert", "bevel_weight_vert")


def _read(value, kind):
    if kind == "uv":
        return tuple(value.uv)
    return tuple(value) if hasattr(value, "__len__") else (value,)


def _write(element, layer, kind, value):
    if kind == "uv":
        element[layer].uv = value
    else:
        element[layer] = value if len(value) > 1 else value[0]


def _layers(access, kinds):
    for kind in kinds:
        for name, layer in getattr(access, kind, {}).items() if hasattr(access, kind) else ():
            if not name.startswith(_OWN):
                yield kind, name, layer


def blend_vertices(bm, rim, inside, blend):
    """Gives the new vertices `inside` the vertex data of the rim (vertices from corner 0 on)."""
    ends = [v for pair in pairs(rim) for v in pair]
    layers = bm.verts.layers
    for kind, name, layer in _layers(layers, _VERTEX_LAYERS):
        values = blend(np.array([_read(v[layer], kind) for v in ends], dtype=np.float64))
        for vertex, value in zip(inside, values.tolist(), strict=True):
            _write(vertex, layer, kind, value if name not in _ZERO else [0.0])
    for kind in ("crease", "bevel_weight"):  # Blender 3
        for layer in getattr(layers, kind).values() if hasattr(layers, kind) else ():
            for vertex in inside:
                vertex[layer] = 0.0
    for layer in layers.deform.values():
        weights = [dict(v[layer].items()) for v in ends]
        groups = sorted({g for w in weights for g in w})
        if not groups:
            continue
        values = blend(np.array([[w.get(g, 0.0) for g in groups] for w in weights], dtype=np.float64))
        for vertex, value in zip(inside, values.tolist(), strict=True):
            vertex[layer].clear()
            for group, weight in zip(groups, value, strict=True):
                if weight > 0:
                    vertex[layer][group] = weight


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


def ends_of_corner(place, count, owned):
    """The ends of rim edges, as `rim_loops` counts them, that a new face's corner at rim vertex `place` continues.

    count: of rim vertices; owned: places of the rim edges that belong to the new face.
    """
    before, after = (place - 1) % count, place
    if before in owned and after not in owned:
        return (2 * before + 1,)
    if after in owned and before not in owned:
        return (2 * after,)
    return (2 * before + 1, 2 * after)


def blend_corners(bm, ends, corners, blend, nearest):
    """Gives face corners the corner data of the rim.

    ends: face corners of the surroundings at the ends of the rim edges; corners: (new face corner, number of the vertex inside,
    ends that it continues, none inside); nearest: for each vertex inside the end whose values it takes where they cannot be
    blended. Where two surrounding faces disagree at their vertex, as at a UV seam, the later
    one counts.
    """
    for kind, _name, layer in _layers(bm.loops.layers, _LOOP_LAYERS):
        at_rim = np.array([_read(loop[layer], kind) for loop in ends], dtype=np.float64)
        inside = blend(at_rim).tolist()
        at_rim = at_rim.tolist()
        for corner, vertex, continued in corners:
            _write(corner, layer, kind, at_rim[continued[-1]] if continued else inside[vertex])
    for _kind, _name, layer in _layers(bm.loops.layers, _PICKED):
        for corner, vertex, continued in corners:
            corner[layer] = ends[continued[-1] if continued else nearest[vertex]][layer]


def model_faces(surrounding, on_side):
    """For each side the surrounding face whose material and shading most of its rim edges have. on_side: sides by rim edge."""
    models = []
    for side in range(max(on_side.values()) + 1):
        faces = [surrounding[e] for e in sorted(on_side) if on_side[e] == side]
        most = Counter((f.material_index, f.smooth) for f in faces).most_common(1)[0][0]
        models.append(next(f for f in faces if (f.material_index, f.smooth) == most))
    return models
