# SPDX-License-Identifier: GPL-3.0-or-later
"""Fills, as arrays -> faces of a BMesh, with their attributes."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import bmesh

from . import attributes, features, normals, records, subdivision, versions, waiting
from .library import index_lists, np, tripatch
from .selection import SAME_PLACE, Rim, coordinates, following, pairs

# Cosine of 0.5 degrees; Blender parts a fan of face corners by a sharp edge from 0.8 degrees on.
SAME_NORMAL = 0.99996


@dataclass
class Planned:
    """A fill that is ready to be written: nothing in the BMesh has changed yet."""

    rim: Rim
    fill: Any  # tripatch.Fill in world space, in the vertex numbers of the BMesh
    count: int  # from this number on the fill's vertices are new
    loop: list  # BMVert from corner 0 on
    positions: np.ndarray  # (k, 3) of the new vertices in object space
    normals: np.ndarray  # (k, 3)
    rim_normals: np.ndarray  # (r, 3)
    tangent: tuple  # to the surroundings, by side; empty: along the whole rim
    cage: bool = False  # the new vertices are control points
    passes_through: Any = None  # a place where it passes through the mesh; of a cage not known before it is written
    moved: list = field(default_factory=list)  # (BMVert, position in object space)
    in_shape_keys: dict = field(default_factory=dict)  # name: (k, 3)
    moved_in_shape_keys: dict = field(default_factory=dict)  # name: (as many as `moved`, 3)

    @property
    def loops(self):
        """The vertices of each boundary."""
        return [self.loop[end - count : end] for count, end in zip(self.fill.loops, np.cumsum(self.fill.loops), strict=True)]


def has_lid(fill):
    """Whether a fill meets the mesh at sharp edges of the rim."""
    rim = fill.rim.tolist()
    rim = {frozenset((v, rim[k])) for v, k in zip(rim, following(fill.loops), strict=True)}
    return any(frozenset(edge) in rim for edge in fill.feature_edges.tolist())


def obstacle(bm, planned):
    """A message if the new faces cannot be joined to the mesh without damage to it, else None."""
    rim = {v.index: v for v in planned.loop}
    edges, count = {frozenset((a.index, b.index)) for loop in planned.loops for a, b in pairs(loop)}, planned.count
    for face in index_lists(planned.fill.faces):
        if sorted(face)[1] >= count:  # most: at the rim is one of its vertices, or none
            continue
        if max(face) < count and (old := bm.faces.get([rim[v] for v in face])) and old not in planned.rim.replaced:
            return tripatch.Message("face_across_hole", {}, face)
        for a, b in pairs(face):
            if a < count and b < count and frozenset((a, b)) not in edges:
                edge = bm.edges.get((rim[a], rim[b]))
                if edge and any(f not in planned.rim.replaced for f in edge.link_faces):
                    return tripatch.Message("edge_across_hole", {}, (a, b))
    return None


def sides(rim, corners):
    """For each side the places of its rim edges, counted from corner 0 on. Of three corners, side i is opposite corner i, of
    others it starts at corner i; without corners all is one side.

    rim: vertices from corner 0 on; corners: those of them that are corners.
    """
    at = [rim.index(corner) for corner in corners] or [0]
    first = 1 if len(at) == 3 else 0
    starts = at[first:] + at[:first]
    return [range(a, b or len(rim)) for a, b in pairs(starts)]


def guides_of(planned):
    """The vertices without faces that the fill goes through and takes up: {its row among the new vertices: BMVert}."""
    if planned.cage or not planned.rim.inside or not len(planned.positions):
        return {}
    found, places = {}, coordinates(planned.loop)
    within = SAME_PLACE * np.ptp(places, axis=0).max()
    for vertex in planned.rim.inside:
        apart = np.linalg.norm(planned.positions - np.array(vertex.co), axis=1)
        row = int(apart.argmin())
        if apart[row] <= within and row >= len(planned.fill.split_edges[1]):
            found.setdefault(row, vertex)
    return found


def _take_up_edges(bm, guides, loop):
    """Deletes the edges without faces between vertices that the fill has taken up: it has its own there."""
    own = {*guides, *loop}
    left = {e for v in guides for e in v.link_edges if e.is_wire and own.issuperset(e.verts)}
    if left:  # the operator goes through all of the mesh
        bmesh.ops.delete(bm, geom=list(left), context="EDGES_FACES")


@dataclass
class _Rows:
    """A fill's rim and inside, once split edges have joined their vertices to the rim."""

    loop: list  # BMVert
    numbers: list  # that fill.faces has for them
    parameters: np.ndarray  # (r, 3) barycentric, or (r, 2) in a plane domain
    normals: np.ndarray
    split: int = 0  # so many of the fill's vertices are on the rim
    counts: list = field(default_factory=list)  # of the vertices of each loop

    @property
    def next(self):
        return following(self.counts)


def parameters(fill):
    """Those of a fill's rim and of its new vertices."""
    return (fill.rim_barycentric, fill.barycentric) if fill.uv is None else (fill.rim_uv, fill.uv)


def _split_edges(bm, planned, custom):
    """Splits the rim edges that the fill asks for. custom: as in `_write_one`."""
    fill = planned.fill
    at_rim, inside = parameters(fill)
    rows = _Rows(list(planned.loop), fill.rim.tolist(), at_rim, planned.rim_normals, counts=list(fill.loops))
    for k, ((a, b), t) in enumerate(zip(fill.split_edges[0].tolist(), fill.split_edges[1].tolist(), strict=True)):
        place = rows.numbers.index(a)
        start, end = rows.loop[place], rows.loop[rows.numbers.index(b)]
        _, new = bmesh.utils.edge_split(bm.edges.get((start, end)), start, t)
        for name, layer in bm.verts.layers.shape.items():
            new[layer] = planned.in_shape_keys.get(name, planned.positions)[k]
        new.co = planned.positions[k]
        for corner in new.link_loops if custom is not None else ():
            between = sum(custom.get(other, np.zeros(3)) for other in (corner.link_loop_prev, corner.link_loop_next))
            custom[corner] = between / max(np.linalg.norm(between), 1e-30)
        rows.loop.insert(place + 1, new)
        rows.numbers.insert(place + 1, planned.count + k)
        rows.parameters = np.insert(rows.parameters, place + 1, inside[k], axis=0)
        rows.normals = np.insert(rows.normals, place + 1, planned.normals[k], axis=0)
        rows.split += 1
        rows.counts[0] += 1  # with islands no edge is split
    return rows


def _models(faces, around, looks, nearest_edge):
    """The surrounding face that each new one is like: at the nearest rim edge that looks as this part of the fill.

    faces: of places of the new vertices, those of the rim first; around: the face at each rim edge; nearest_edge: of each vertex
    inside.
    """
    count = len(around)
    edges = [nearest_edge[max(at) - count] if max(at) >= count else min(at) for at in faces]
    if len(looks.kinds) == 1:
        return [around[edge] for edge in edges]
    return [around[looks.edge_near(edge, looks.of_face(at))] for edge, at in zip(edges, faces, strict=True)]


def _continue_seams(bm, new_faces, loop):
    """Marks as seam where the UVs of the new faces jump, if the surroundings have seams that end at the rim."""
    if any(edge.seam for v in loop for edge in v.link_edges):
        for edge in attributes.uv_jumps(bm, new_faces):
            edge.seam = True


def _write_one(bm, planned, shading, custom):
    """Creates the faces of one fill. custom: {face corner: normal} of the surroundings, or None. Returns the new faces."""
    fill, rim = planned.fill, planned.rim
    rows = _split_edges(bm, planned, custom)
    loop = rows.loop
    positions, own_normals, at_inside = (a[rows.split :] for a in (planned.positions, planned.normals, parameters(fill)[1]))
    after = rows.next
    before = [after.index(k) for k in range(len(loop))]
    edges = [bm.edges.get((v, loop[k])) for v, k in zip(loop, after, strict=True)]
    around = attributes.rim_faces(edges, rim.replaced)
    with_corners = custom is not None or attributes.has_corner_data(bm)
    ends = attributes.rim_loops(edges, around) if with_corners else []
    on_side = {k: i for i, places in enumerate(sides(rows.numbers, fill.report.corners)) for k in places}
    blend = tripatch.attribute_weights(rows.parameters, at_inside, rows.counts if len(rows.counts) > 1 else ())
    looks = attributes.shares([(face.material_index, face.smooth) for face in around], blend, after)
    first_inside = planned.count + rows.split
    place = {v: k for k, v in enumerate([*rows.numbers, *range(first_inside, first_inside + len(positions))])}
    faces = [[place[v] for v in face] for face in index_lists(fill.faces)]
    everywhere = np.vstack([coordinates(loop), positions])
    charts = attributes.uv_charts(bm, ends, blend, everywhere, faces) if ends and len(rows.counts) == 1 else {}

    nearest = blend.nearest.tolist()
    nearest_edge = [end // 2 for end in nearest]
    models = _models(faces, around, looks, nearest_edge)
    if rim.replaced:
        bmesh.ops.delete(bm, geom=list(rim.replaced), context="FACES")
    ends_at = [v for pair in zip(loop, (loop[k] for k in after), strict=True) for v in pair]
    guides = {row - rows.split: v for row, v in guides_of(planned).items()}
    # A vertex made from an example has no place in any shape key yet; one made without would pass for the first of the mesh.
    inside = [
        guides.get(k) or bm.verts.new(co, ends_at[near])
        for k, (co, near) in enumerate(zip(positions.tolist(), nearest, strict=True))
    ]
    attributes.blend_vertices(bm, ends_at, inside, blend, guides)
    for name, layer in bm.verts.layers.shape.items():
        shape = planned.in_shape_keys.get(name, planned.positions)[rows.split :]
        for vertex, co in zip(inside, shape.tolist(), strict=True):
            vertex[layer] = co

    everyone = [*loop, *inside]
    place_of_edge = {frozenset(pair): pair[0] for pair in enumerate(after)}
    new_faces, corners = [], []
    for at, model in zip(faces, models, strict=True):
        made = bm.faces.new([everyone[k] for k in at], model)
        if made.hide:
            made.hide = False
        if shading != "neighbors":  # else as its model
            made.smooth = shading == "smooth"
        new_faces.append(made)
        if not with_corners:
            continue
        if min(at) >= len(loop):  # most
            corners += [(corner, k - len(loop), ()) for corner, k in zip(made.loops, at, strict=True)]
            continue
        own = {place_of_edge.get(frozenset(pair)) for pair in pairs(at)}
        for corner, k in zip(made.loops, at, strict=True):
            continued = attributes.ends_of_corner(k, before[k], own) if k < len(loop) else ()
            corners.append((corner, k - len(loop), continued))
    attributes.blend_corners(bm, ends, corners, blend, nearest, charts)
    if with_corners:
        _continue_seams(bm, new_faces, loop)
    if custom is not None:
        tangent = [planned.tangent[on_side[k]] if planned.tangent else True for k in range(len(loop))]
        at_rim = rows.normals[[place for pair in enumerate(after) for place in pair]]
        _give_normals(replace(planned, loop=loop, normals=own_normals, rim_normals=at_rim), tangent, custom, ends, corners)
    _take_up_edges(bm, guides.values(), loop)
    _change_rim(bm, planned, {v: everyone[k] for v, k in place.items()})
    if len(fill.feature_edges):
        marked = [[everyone[place[v]] for v in edge] for edge in fill.feature_edges.tolist()]
        features.mark(bm, marked, loop, new_faces)
        features.sharpen_rim(bm, marked, loop)
    return new_faces


def _change_rim(bm, planned, vertex):
    """What a cage option changes outside the fill, and creases in it. vertex: BMVert by number."""
    for k, (moved, co) in enumerate(planned.moved):
        by = co - np.array(moved.co)
        for name, layer in bm.verts.layers.shape.items():
            in_key = planned.moved_in_shape_keys.get(name)
            moved[layer] = np.array(moved[layer]) + by if in_key is None else in_key[k]
        moved.co = co
    edges, values = planned.fill.creases
    if len(edges):
        layer = subdivision.edge_crease_layer(bm)
        for (a, b), value in zip(edges.tolist(), values.tolist(), strict=True):
            edge = bm.edges.get((vertex[a], vertex[b]))
            edge[layer] = max(edge[layer], value)


def _give_normals(planned, tangent, custom, ends, corners):
    """Adds the normals of the new face corners to `custom`, the exact ones of the fill; `rim_normals`: at the ends of rim edges.
    Where fill and surroundings are tangent (tangent: by rim edge), a seam has the normal that the surroundings have there, which
    Blender keeps for both while no sharp edge parts them."""
    for corner, number, continued in corners:
        if not continued:
            custom[corner] = planned.normals[number]
            continue
        around = [custom[ends[end]] for end in continued]
        agree = all(normal @ around[0] > SAME_NORMAL for normal in around) and all(tangent[end // 2] for end in continued)
        exact = planned.rim_normals[continued[-1]]
        custom[corner] = around[0] if agree else exact


DEVIATION, RECONSTRUCTED = "deviation", "reconstructed"
NOT_KNOWN = -1.0  # in place of a deviation


@contextmanager
def layers_of_fills(bm, deviation=False):
    """The layers that tell new faces from old ones and, if wanted, how well new vertices are known. They are made before any
    element is held: that forgets them. Without a new face they go again."""
    wanted = [(bm.faces.layers.int, records.FILL)]
    if deviation:
        wanted += [(bm.verts.layers.float, DEVIATION), (versions.boolean_layers(bm.faces.layers), RECONSTRUCTED)]
    made = [(access, access.new(name), name) for access, name in wanted if access.get(name) is None]
    faces = len(bm.faces)
    try:
        yield
    finally:
        if made and len(bm.faces) == faces and not any(face[bm.faces.layers.int[records.FILL]] for face in bm.faces):
            for access, _, name in made:
                access.remove(access[name])


def _write_deviation(bm, planned, new_faces):
    """Stores the error estimate of each new vertex, one standard deviation in units of the scene, or NOT_KNOWN, and marks the new
    faces."""
    known, marked = bm.verts.layers.float[DEVIATION], versions.boolean_layers(bm.faces.layers)[RECONSTRUCTED]
    rim = set(planned.loop)
    deviation = planned.fill.deviation
    for face in new_faces:
        face[marked] = True
    at = {}
    for face, numbers in zip(new_faces, index_lists(planned.fill.faces), strict=True):
        at |= {v: n - planned.count for v, n in zip(face.verts, numbers, strict=True) if v not in rim}
    for vertex, row in at.items():
        vertex[known] = NOT_KNOWN if deviation is None else float(deviation[row])


def write(bm, mesh, all_planned, options):
    """Writes fills into the BMesh; returns the new faces. The BMesh is the one that they were planned on. options: see
    calls.Options; layers are those that layers_of_fills has made."""
    waiting.must_finish()
    if any(len(planned.fill.creases[0]) for planned in all_planned):
        subdivision.edge_crease_layer(bm)  # before any other layer is held
    custom = None
    if normals.has_custom_normals(bm, mesh):
        kept = {v for planned in all_planned for v in planned.loop}
        custom = normals.corner_normals(bm, mesh, kept)
    gone = {f for planned in all_planned for f in planned.rim.replaced}
    if custom is not None:
        custom = {corner: normal for corner, normal in custom.items() if corner.face not in gone}
    new_faces = []
    for planned in all_planned:
        made = _write_one(bm, planned, options.shading, custom)
        if options.deviation:
            _write_deviation(bm, planned, made)
        records.keep(bm, mesh, planned, made, options.record)
        new_faces += made
    if any(has_lid(planned.fill) for planned in all_planned) and any(face.smooth for face in new_faces):
        versions.show_sharp_edges(mesh)
    if custom is not None:  # edges that were split had corners in faces that are gone too
        normals.set_corner_normals(bm, mesh, {corner: normal for corner, normal in custom.items() if corner.is_valid})
    return new_faces
