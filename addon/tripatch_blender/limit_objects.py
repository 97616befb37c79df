# SPDX-License-Identifier: GPL-3.0-or-later
"""Fills on the limit surface of a cage: a mesh object next to the original, as a cage's vertices do not lie on its surface."""

from __future__ import annotations

from typing import Any

import bpy
from mathutils import Vector
from mathutils.kdtree import KDTree

from . import attributes, calls, filling, outcomes, selection, subdivision, waiting, writeback
from .library import index_lists, np, tripatch, words

# Of the extent; what Blender draws and what the library computes agree to float32.
_SAME_POINT = 2e-6


def collections_of(ob):
    """Those that show an object: it may be in others too, which no scene has, as that of a rigid body world."""
    own = [c for c in ob.users_collection if c.library is None]
    shown = {c for scene in bpy.data.scenes for c in (scene.collection, *scene.collection.children_recursive)}
    return [c for c in own if c in shown] or own or [bpy.context.scene.collection]


def _read_off(border, drawn, tree):
    """Border points (k, 3) with those that the modifier made in their places, and how many have none."""
    within = _SAME_POINT * np.ptp(drawn, axis=0).max()
    missing, points = 0, border.copy()
    for k, point in enumerate(border.tolist()):
        _, index, distance = tree.find(Vector(point))
        if distance <= within:
            points[k] = drawn[index]
        else:
            missing += 1
    return points, missing


def _models(rim, fill, first):
    """For each new face that of the surroundings whose material and shading it takes: of the side next to it.

    first: number of the first new vertex.
    """
    vertex = {v.index: v for v in rim.loop}
    loop = [vertex[v] for v in fill.rim.tolist()]
    bm_edges = [next(e for e in a.link_edges if e.other_vert(a) == b) for a, b in selection.pairs(loop)]
    sides = writeback.sides(fill.rim.tolist(), fill.report.corners)
    on_side = {k: i for i, places in enumerate(sides) for k in places}
    models = attributes.model_faces(attributes.rim_faces(bm_edges, rim.replaced), on_side)
    if fill.uv is None:
        return [models[int(np.argmin(fill.barycentric[np.array(face) - first].sum(axis=0)))] for face in index_lists(fill.faces)]
    ends = tripatch.attribute_weights(fill.rim_uv, fill.uv).nearest.tolist()
    return [models[on_side[ends[max(face) - first] // 2]] for face in index_lists(fill.faces)]


def take_materials(mesh, like):
    """Gives a mesh the materials of another, before it has faces: to clear materials clears what faces have."""
    if list(mesh.materials) != list(like.materials):
        mesh.materials.clear()
        for material in like.materials:
            mesh.materials.append(material)


def _new_object(ob, vertices, faces, materials, smooth):
    mesh = bpy.data.meshes.new(f"{ob.data.name} Fill")
    take_materials(mesh, ob.data)
    mesh.from_pydata(vertices.tolist(), [], faces)
    mesh.polygons.foreach_set("material_index", materials)
    mesh.polygons.foreach_set("use_smooth", smooth)
    mesh.update()
    new = ob.copy()  # the same transform, parent, collections and materials of slots
    new.name = f"{ob.name} Fill"
    for modifier in list(new.modifiers):
        if modifier.type != "MIRROR":  # what mirrors the hole mirrors its fill
            new.modifiers.remove(modifier)
    new.data = mesh  # and with it no vertex groups, which belong to the mesh
    for slot, old in zip(new.material_slots, ob.material_slots):
        slot.link = old.link
        if old.link == "OBJECT":
            slot.material = old.material
    for collection in collections_of(ob):
        collection.objects.link(new)
    new.select_set(False)
    return new


def fill_rims(ob, bm, matrix, rims, options):
    """Fills rims of an object's BMesh by one new object. Returns (Outcome, the object or None)."""
    modifier = subdivision.usable(ob, limit=True)
    bm.verts.index_update()
    bm.faces.index_update()
    cage = subdivision.cage_before(ob, bm, modifier)
    try:
        there = [subdivision.in_cage(ob, cage, bm, rim) for rim in rims]
        return _fill_rims(ob, cage, modifier, matrix, there, rims, options)
    finally:
        if cage is not bm:
            cage.free()


def _fill_rims(ob, bm, modifier, matrix, rims, named, options):
    """The same for rims of the cage that the modifier subdivides. named: the rims in the object's own BMesh."""
    positions, faces_around = filling.mesh_arrays(bm, matrix)
    arrays = positions, faces_around, sorted(f.index for rim in rims for f in rim.replaced)
    settings = subdivision.Cage(bm, modifier).near(index_lists(faces_around))
    fills = calls.fills(rims, arrays, options, subdivision=settings, level=subdivision.level_of(modifier))
    inverse = np.linalg.inv(matrix[:3, :3])
    outcome, vertices, faces, materials, smooth = outcomes.Outcome(), [], [], [], []
    drawn: Any = None
    tree: Any = None
    count = missing = 0
    said = []
    for rim, own, fill in zip(rims, named, fills, strict=True):
        if isinstance(fill, tripatch.Refusal):
            outcome.refused.append(outcomes.Refused(words.refused(fill), [v.index for v in own.loop], ob))
            said.append((min(v.index for v in own.loop), []))
            continue
        if drawn is None:
            drawn = subdivision.evaluated_points(bm, modifier)
            tree = KDTree(len(drawn))
            for k, point in enumerate(drawn.tolist()):
                tree.insert(point, k)
            tree.balance()
        points = (fill.vertices - matrix[:3, 3]) @ inverse.T
        points[fill.border], lost = _read_off(points[fill.border], drawn, tree)
        missing += lost
        first = len(arrays[0])  # of the fill's own vertices
        for face, model in zip(index_lists(fill.faces), _models(rim, fill, first), strict=True):
            faces.append([v - first + count for v in face])
            materials.append(model.material_index)
            smooth.append(model.smooth if options.shading == "neighbors" else options.shading == "smooth")
        vertices.append(points)
        count += len(points)
        outcome.reports.append(fill.report)
        outcome.passages.append(fill.passes_through)
        outcome.rim_edges.append(len(fill.border))
        if options.arguments.get("output", "triangles") != "triangles":
            outcome.diameters.append(filling.diameter(own.loop, matrix))
        told = [*fill.report.warnings, *filling.passes(fill.passes_through, own.loop)]
        said.append((min(v.index for v in own.loop), [*told, *[tripatch.Message("faces_stay")] * bool(rim.replaced)]))
    if not vertices:
        return outcome, None
    outcome.notes += words.gathered(said)
    if missing:
        outcome.notes.append(tripatch.Message("points_off_surface", {"count": int(missing)}))
    waiting.must_finish()
    new = _new_object(ob, np.vstack(vertices), faces, materials, smooth)
    outcome.count(faces, options.arguments.get("output"))
    outcome.objects.append(new.name)
    return outcome, new
