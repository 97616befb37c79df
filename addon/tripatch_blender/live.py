# SPDX-License-Identifier: GPL-3.0-or-later
"""Live fills: objects of their own that are filled again when what lies around them changes.

What a live fill needs is in custom properties of its object, so that it is saved, copied and undone with it: the objects around
by pointer, all else as text. Without the add-on it is a mesh object like any other.
"""

from __future__ import annotations

import json
import zlib

import bmesh
import bpy

from . import (
    between_patches,
    blends,
    calls,
    copies,
    filling,
    joining,
    layers,
    limit_objects,
    mirrored,
    outcomes,
    selection,
    sentences,
    smooth,
    waiting,
    writeback,
)
from .edit_mode import edited
from .library import np, tripatch
from .selection import Rim, UnusableError

_SETTINGS, _PROBLEM, _AROUND = "tripatch_live", "tripatch_problem", "tripatch_around_"
#: Kinds of fills that move with what they follow.
_IN_OBJECT = ("hole", "smooth")
#: Of the extent of a rim: how far on average the vertices of another border may be from where the rim was to count as it.
_SAME_RIM = 0.5


def is_live(ob):
    return _SETTINGS in ob and ob.library is None


def is_deleted(ob):
    """Whether an object is in no scene, nor in a collection that may be shown as an instance: Blender keeps what it deletes as
    long as something points to it."""
    return bpy.context.scene.objects.get(ob.name) != ob and not ob.users_collection


def fills():
    """The live fills of this file."""
    return [ob for ob in bpy.data.objects if is_live(ob) and not is_deleted(ob)]


def settings_of(fill):
    return json.loads(fill[_SETTINGS])


def problem_of(fill):
    """Why the last change could not be followed, or nothing."""
    return fill.get(_PROBLEM, "")


def say(fill, reason):
    """Keeps why the last change could not be followed."""
    fill[_PROBLEM] = sentences.for_people(reason)


def around(fill):
    """The objects that a fill follows; UnusableError where one has been deleted."""
    names = sorted(key for key in fill.keys() if key.startswith(_AROUND))
    objects = [fill[key] for key in names]
    if not objects or any(ob is None or is_deleted(ob) for ob in objects):
        raise UnusableError("followed_object_gone")
    return objects


def _remember(fill, settings, objects):
    fill[_SETTINGS] = json.dumps(settings)
    for k, ob in enumerate(objects):
        fill[f"{_AROUND}{k:02d}"] = ob


def forget(fill):
    """Makes a live fill an object like any other."""
    for key in [key for key in fill.keys() if key in (_SETTINGS, _PROBLEM) or key.startswith(_AROUND)]:
        del fill[key]
    fill.display_type, fill.hide_render = "TEXTURED", False


# What lies around.


def state_of(fill):
    """A number that changes with what a fill follows: positions, faces, shape keys, surfaces, scales."""
    settings, found = settings_of(fill), 0

    def take(values):
        nonlocal found
        found = zlib.crc32(np.ascontiguousarray(values), found)

    for ob in around(fill):
        matrix = np.array(ob.matrix_world, np.float64)
        take(matrix[:3, :3] if settings["kind"] in _IN_OBJECT else matrix)
        if ob.type == "SURFACE":
            for spline in ob.data.splines:
                take(np.array([tuple(p.co) for p in spline.points], np.float64))
                take(np.array([spline.order_u, spline.order_v, spline.resolution_u, spline.resolution_v], np.int64))
        elif ob.mode == "EDIT":
            _take_edited(ob, settings, take)
        else:
            take(copies.mixed(ob.data))
            corners = np.empty(len(ob.data.loops), np.int32)
            ob.data.loops.foreach_get("vertex_index", corners)
            take(corners)
        if settings.get("half"):
            take(np.array([(*plane.point, *plane.normal, plane.within) for plane in mirrored.planes_of(ob)], np.float64))
    return found


def _take_edited(ob, settings, take):
    """Of a mesh in edit mode: of a hole only what lies around the rim, where the rim is still one."""
    bm = bmesh.from_edit_mesh(ob.data)
    bm.verts.ensure_lookup_table()
    bm.verts.index_update()
    bm.faces.index_update()
    if settings["kind"] == "smooth":
        take(np.array([v for face in bm.faces for v in (*(v.index for v in face.verts), -1)], np.int64))
        take(selection.coordinates(bm.verts))
        return
    loop = _same_loop(bm, settings)
    seeds = loop or selection.border_vertices(bm)
    positions, faces, _ = selection.Surroundings(bm, np.eye(4)).around(Rim(seeds))
    take(np.array([v for face in faces for v in (*face, -1)], np.int64))
    take(positions[sorted({v for face in faces for v in face})])


# The rim of a hole.


def _same_loop(bm, settings):
    """The vertices of a rim by number, if they still go round a hole, or (half) from one mirror plane to another."""
    rim = settings.get("rim")
    if not rim or max(rim) >= len(bm.verts):
        return None
    loop = [bm.verts[k] for k in rim]
    edges = selection.edges_of(bm, loop)[: -1 if settings.get("half") else None]
    return loop if all(e is not None and e.is_boundary for e in edges) else None


def _nearest(borders, settings):
    """The one of some borders, as lists of BMVert, that is nearest to where the rim was; UnusableError where there is none."""
    was = np.array(settings["positions"], np.float64)
    best: tuple = (np.inf, None)
    for border in borders:
        here = selection.coordinates(border)
        apart = np.linalg.norm(was[:, None] - here, axis=2)
        best = min(best, ((apart.min(axis=1).mean() + apart.min(axis=0).mean()) / 2, border), key=lambda pair: pair[0])
    distance, border = best
    if border is None or distance > _SAME_RIM * np.linalg.norm(np.ptp(was, axis=0)):
        raise UnusableError("followed_hole_gone")
    return border


def find_rim(bm, settings):
    """(loop of BMVert, corners or None) of the hole that was filled last: the same vertices, else the border that is nearest to
    where they were. UnusableError where there is none."""
    loop, given = _same_loop(bm, settings), settings["corners"]
    if loop:
        return loop, None if given is None else [loop[k] for k in given]
    border = _nearest(selection.border_loops(selection.border_vertices(bm)), settings)
    if given is None:
        return border, None
    here, was = selection.coordinates(border), np.array(settings["positions"], np.float64)
    nearest = [int(np.linalg.norm(here - was[k], axis=1).argmin()) for k in given]
    return border, [border[k] for k in sorted(set(nearest))]


def find_half(ob, bm, settings):
    """The same of a hole that a Mirror modifier cuts in half, as mirrored.half_rims has it."""
    halves = mirrored.half_rims(ob, bm, [])
    same = [half for half in halves if {v.index for v in half[1]} == set(settings["rim"])]
    if same:
        return same[0]
    chain = _nearest([chain for _, chain in halves], settings)
    return next(half for half in halves if half[1] is chain)


def _touching(ob, bm, loop):
    """Rims of other live fills of an object that share vertices with a loop."""
    found = []
    for fill in fills():
        settings = settings_of(fill)
        if settings["kind"] == "hole" and not settings.get("half") and fill.get(f"{_AROUND}00") == ob:
            other = _same_loop(bm, settings)
            if other and set(other) != set(loop) and not set(other).isdisjoint(loop):
                found.append(Rim(other))
    return found


# Filling.


def _options(settings):
    arguments = {
        name: calls.BySide(value) if isinstance(value, list) and len(value) == calls.MAX_SIDES else value
        for name, value in settings["arguments"].items()
    }
    return calls.Options(arguments, settings["corner_offset"], settings["shading"], settings["deviation"])


class _LeftOut(UnusableError):
    """An outer border that is not meant."""


def _filled(ob, bm, mesh, settings, options, active=None):
    """Fills the hole of a live fill in a BMesh; returns (outcomes.Outcome, new faces), and the settings know where it is. active:
    name of the shape key whose shape the vertices have."""
    matrix = filling.world_matrix(ob.name, ob.matrix_world)
    half = find_half(ob, bm, settings) if settings.get("half") else None
    loop, corners = (half[1], None) if half else find_rim(bm, settings)
    settings["rim"], settings["positions"] = [v.index for v in loop], [tuple(v.co) for v in loop]
    settings["corners"] = None if corners is None else [loop.index(v) for v in corners]
    if half:
        outcome, new = mirrored.fill(bm, mesh, matrix, half, options, settings.pop("outer", True), active)
    else:
        rims = [Rim(loop, corners=corners or [])]
        outcome, new = filling.fill_rims(bm, mesh, matrix, rims, options, active, touching=_touching(ob, bm, loop))
    if outcome is None:
        raise _LeftOut("outer_border_left")
    if outcome.refused:
        raise UnusableError.of(outcome.refused[0].sentence)
    return outcome, new


def _fill_hole(fill, settings):
    """Fills the mesh of a live fill of a hole again; returns the outcomes.Outcome."""
    (ob,) = around(fill)
    (bm, stand_ins), options = copies.copy(ob), _options(settings)
    try:
        with writeback.layers_of_fills(bm, options.deviation):
            outcome, new = _filled(ob, bm, fill.data, settings, options)
            write(fill, bm, set(new), ob.data)
        layers.restore(fill.data, stand_ins)
        selection.name_groups(fill, ob)
        return outcome
    finally:
        bm.free()


def write(fill, bm, faces, like):
    """Makes some faces of a BMesh, which loses all others, the mesh of an object, with the materials of another mesh.

    It stays the same data-block. This happens between undo steps, and undo frees a block that no step knows, while an object that
    is the same in all steps keeps its pointer to it; Blender 5.2 follows that pointer and crashes.
    """
    bmesh.ops.delete(bm, geom=[f for f in bm.faces if f not in faces], context="FACES")
    bmesh.ops.delete(bm, geom=[v for v in bm.verts if not v.link_faces], context="VERTS")
    for element in (*bm.verts, *bm.edges, *bm.faces):
        element.hide = element.select = False
    fill.vertex_groups.clear()
    limit_objects.take_materials(fill.data, like)
    bm.to_mesh(fill.data)


def _smooth(fill, settings):
    """Smooths the faces of an object into the mesh of a live fill."""
    (ob,) = around(fill)
    bm, stand_ins = copies.copy(ob)
    try:
        write(fill, bm, set(smooth.smooth_copy(ob, bm, **settings["smooth"])), ob.data)
        layers.restore(fill.data, stand_ins)
        selection.name_groups(fill, ob)
    finally:
        bm.free()


def _follow(fill):
    """Fills again; returns what became of it. UnusableError or ValueError if it cannot be filled, and nothing has changed."""
    settings, outcome = settings_of(fill), None
    if settings["kind"] == "hole":
        outcome = _fill_hole(fill, settings)
    elif settings["kind"] == "smooth":
        _smooth(fill, settings)
    elif settings["kind"] == "patches":
        between_patches.mesh_between(around(fill), **settings["between"], mesh=fill.data)
    else:
        made = blends.mesh_of(around(fill), **settings["blend"], mesh=fill.data)[1]
        settings |= {"middles": made.middles, "names": made.names}
    fill[_SETTINGS], fill[_PROBLEM] = json.dumps(settings), ""
    return outcome


def refill(fill):
    """Fills again. A fill that fails leaves the last good one. Returns the sentence of a failure, or nothing."""
    try:
        _follow(fill)
    except (UnusableError, tripatch.Refusal, ValueError) as reason:  # and InvalidArgument
        say(fill, reason)
    return problem_of(fill)


# Making and ending.


def keep(ob, rims, options, halves=(), outer=True):
    """Live fills of holes of a mesh in edit mode, and of halves of holes, as mirrored.half_rims has them. Returns the
    outcomes.Outcome. outer: of halves of outer borders too."""
    outcome = outcomes.Outcome()

    def refuse(loop, sentence):
        outcome.refused.append(outcomes.Refused(sentence, [v.index for v in loop], ob))

    for rim in rims:
        if rim.replaced:
            refuse(rim.loop, tripatch.Message("live_needs_open_hole"))
        elif rim.islands:
            refuse(rim.loop, tripatch.Message("live_follows_one_boundary"))
    plain = [rim for rim in rims if not (rim.replaced or rim.islands)]
    given = [(rim.loop, {"corners": [rim.loop.index(v) for v in rim.corners] or None}) for rim in plain]
    given += [(chain, {"corners": None, "half": True, "outer": outer}) for _, chain in halves]
    begun = []
    for loop, how in given:
        try:
            begun.append((loop, _begin_hole(ob, loop, how, options)))
        except UnusableError as reason:
            refuse(loop, reason.said)
    for k, (loop, fill) in enumerate(begun):  # those that touch each other know of each other by now
        try:
            outcome.add(_keep_hole(ob, loop, fill))
        except _LeftOut:
            pass
        except UnusableError as reason:
            refuse(loop, reason.said)
        except waiting.Ends:
            for _, other in begun[k + 1 :]:
                bpy.data.meshes.remove(other.data)
            raise
    return outcome


def _begin_hole(ob, loop, how, options):
    """The object of a live fill of a hole of a mesh in edit mode, still empty; UnusableError if there can be none. loop: BMVert,
    their indices up to date."""
    if options.arguments.get("surroundings") == "limit":
        raise UnusableError("live_needs_mesh")
    if sum(material is None for material in ob.data.materials) > 1 and any(slot.link == "OBJECT" for slot in ob.material_slots):
        raise UnusableError("live_needs_materials_of_mesh", name=ob.name)
    if (modifier := joining.by_groups(ob)) and not joining.keeps_groups():
        raise UnusableError("live_cannot_join_groups", modifier=modifier.name)
    # it must not move the vertices of what it follows, crease its edges or split them
    fixed = {"cage_rim": "smooth", "odd": "triangle"}
    applying = {"cage": fixed, "quads": {"odd": "triangle"}}.get(options.arguments.get("output"), {})
    settings = how | {
        "kind": "hole",
        "arguments": options.arguments | applying,
        "corner_offset": options.corner_offset,
        "shading": options.shading,
        "deviation": options.deviation,
        "rim": [v.index for v in loop],
        "positions": [tuple(v.co) for v in loop],
    }
    fill = bpy.data.objects.new(f"{ob.name} Fill", bpy.data.meshes.new(f"{ob.data.name} Fill"))
    _remember(fill, json.loads(json.dumps(settings, default=list)), [ob])
    for collection in limit_objects.collections_of(ob):
        collection.objects.link(fill)
    return fill


def _keep_hole(ob, loop, fill):
    """Fills the hole of a live fill that was begun, and joins it by a modifier. Returns the outcomes.Outcome; UnusableError if it
    cannot be filled, and the live fill is gone."""
    try:
        outcome = _follow(fill)
        waiting.must_finish()
        fill.parent, fill.display_type, fill.hide_render = ob, "WIRE", True
        joining.join(ob, fill, joining.WITHIN * min((a.co - b.co).length for a, b in selection.pairs(loop)))
    except (UnusableError, tripatch.Refusal, ValueError, waiting.Ends) as reason:
        bpy.data.meshes.remove(fill.data)  # and the object with it
        if isinstance(reason, (_LeftOut, waiting.Ends)):
            raise
        raise UnusableError.of(tripatch.errors.because(reason)) from None
    outcome.live.append(fill.name)
    return outcome


def keep_smooth(ob, faces, resolution, curve):
    """A live copy of some faces of a mesh in edit mode, smoothed: a new object. faces: as of smooth.chosen. UnusableError."""
    made = bpy.data.objects.new(f"{ob.name} Smooth", bpy.data.meshes.new(f"{ob.data.name} Smooth"))
    _remember(made, {"kind": "smooth", "smooth": {"faces": faces, "resolution": resolution, "curve": curve}}, [ob])
    for collection in limit_objects.collections_of(ob):
        collection.objects.link(made)
    made.parent = ob
    try:
        _follow(made)
    except (UnusableError, tripatch.Refusal, ValueError):
        bpy.data.meshes.remove(made.data)  # and the object with it
        raise
    return made


def keep_patches(fill, objects, **between):
    """Makes a fill between objects live. between: of between_patches.mesh_between."""
    _remember(fill, {"kind": "patches", "between": json.loads(json.dumps(between, default=list))}, objects)


def keep_blend(fill, objects, made, **blend):
    """Makes a blend of three objects live. made: blends.Blended; blend: of blends.mesh_of."""
    _remember(fill, {"kind": "blend", "blend": blend, "middles": made.middles, "names": made.names}, objects)


def is_blend(ob):
    return ob is not None and is_live(ob) and settings_of(ob)["kind"] == "blend"


def reshape(fill, shape):
    """Gives a blend other weights lambda, by side, and makes it again; the sentence of a failure, or nothing."""
    settings = settings_of(fill)
    settings["blend"]["shape"] = list(shape)
    fill[_SETTINGS] = json.dumps(settings)
    return refill(fill)


def apply(fill):
    """Ends a live fill. One of a hole becomes faces of the mesh around, in all its shapes; one between objects, or of a mesh that
    is gone, is a mesh of its own already. Leaves object mode as it was."""
    settings = settings_of(fill)
    try:
        objects = around(fill)
    except UnusableError:
        objects = []
    if settings["kind"] != "hole" or not objects:
        forget(fill)
        return fill
    (ob,) = objects
    with edited(ob), layers.standing_aside(bpy.context, [ob]):
        bm = bmesh.from_edit_mesh(ob.data)
        _apply_hole(ob, bm, settings)
        selection.finish_edit(bm, ob.data)
    joining.part(ob, fill)
    bpy.data.meshes.remove(fill.data)  # and the object with it
    return ob


def _apply_hole(ob, bm, settings):
    """Fills the hole in the mesh itself, with the same options, in all its shapes."""
    for elements in (bm.verts, bm.faces):
        elements.ensure_lookup_table()
        elements.index_update()
    options, active = _options(settings), ob.active_shape_key.name if ob.active_shape_key else None
    with writeback.layers_of_fills(bm, options.deviation):
        _filled(ob, bm, ob.data, settings, options, active)
