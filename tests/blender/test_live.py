"""Live fills follow what lies around them, keep the last good fill, and are plain meshes for who has no add-on."""

import contextlib
import json

import bmesh
import bpy
import numpy as np
import pytest
import scenes
import tasks


def kept(shape=scenes.bowl, size=12, **options):
    """(object in edit mode, its live fill)"""
    ob = scenes.add_hole(shape, size=size)
    scenes.edit(ob)
    assert bpy.ops.mesh.fill_three_sided(keep_live=True, **options) == {"FINISHED"}
    return ob, bpy.data.objects["Hole Fill"]


def points(fill):
    values = np.empty(3 * len(fill.data.vertices), np.float32)
    fill.data.vertices.foreach_get("co", values)
    return values.reshape(-1, 3).astype(float)


def shown(ob):
    """The evaluated mesh: numbers of vertices, faces and border edges."""
    evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    bm = bmesh.new()
    bm.from_mesh(evaluated.to_mesh())
    evaluated.to_mesh_clear()
    counts = len(bm.verts), len(bm.faces), sum(e.is_boundary for e in bm.edges)
    bm.free()
    return counts


def after_a_change(following):
    """What Blender does by itself with a window: the update, then the timer."""
    bpy.context.view_layer.update()
    due = bpy.app.timers.is_registered(following._tick)
    if due:
        following._tick()
        bpy.app.timers.unregister(following._tick)
    return due


def move(ob, by, chosen=lambda v: True):
    bm = bmesh.from_edit_mesh(ob.data)
    for v in bm.verts:
        if chosen(v):
            v.co.z += by(v) if callable(by) else by
    bmesh.update_edit_mesh(ob.data)


def test_a_live_fill_is_an_object_that_is_joined_to_the_mesh(live):
    ob, fill = kept()
    vertices, faces = len(ob.data.vertices), len(ob.data.polygons)
    assert live.is_live(fill) and fill.parent == ob and len(fill.data.polygons) > 10
    bm = bmesh.from_edit_mesh(ob.data)
    rim = len(scenes.border_loops(bm)[0])
    for mode in ("EDIT", "OBJECT"):
        bpy.ops.object.mode_set(mode=mode)
        assert shown(ob) == (vertices + len(fill.data.vertices) - rim, faces + len(fill.data.polygons), 36)
    assert len(ob.data.polygons) == faces, "the mesh itself has its hole"


def test_it_follows_what_lies_around(live, following):
    ob, fill = kept()
    before = points(fill)
    move(ob, 0.5)
    assert after_a_change(following)
    assert points(fill) == pytest.approx(before + [0, 0, 0.5], abs=1e-5)
    # a neighbor of the rim only: the rim stays, the tangents turn
    bm = bmesh.from_edit_mesh(ob.data)
    rim = {v.index for v in scenes.border_loops(bm)[0]}
    place = points(fill)
    move(ob, 0.02, lambda v: v.index not in rim and any(e.other_vert(v).index in rim for e in v.link_edges))
    assert after_a_change(following)
    assert 1e-3 < np.abs(points(fill) - place).max() < 0.1
    assert shown(ob)[2] == 36


def test_without_a_change_nothing_is_filled(live, following, monkeypatch):
    ob, fill = kept(size=24)
    calls = []
    monkeypatch.setattr(live, "refill", lambda fill: calls.append(fill.name))
    after_a_change(following)
    after_a_change(following)
    other = scenes.bpy.data.objects.new("Other", None)
    bpy.context.collection.objects.link(other)
    other.location.x = 3
    assert not after_a_change(following), "another object's move is none of its business"
    bm = bmesh.from_edit_mesh(ob.data)
    far = max(bm.verts, key=lambda v: v.co.x).index
    move(ob, 0.01, lambda v: v.index == far)
    after_a_change(following)
    assert calls == []


def test_files_without_live_fills_are_not_listened_to(live, following):
    handlers = bpy.app.handlers.depsgraph_update_post
    assert following._on_change not in handlers
    _, fill = kept()
    assert following._on_change in handlers
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.object.apply_live_fill() == {"FINISHED"}
    assert following._on_change not in handlers


def test_it_follows_an_edge_that_is_cut_and_a_rim_that_shrinks(live, following):
    ob, fill = kept()
    bm = bmesh.from_edit_mesh(ob.data)
    loop = scenes.border_loops(bm)[0]
    bmesh.ops.subdivide_edges(bm, edges=[bm.edges.get((loop[0], loop[1]))], cuts=1)
    bmesh.update_edit_mesh(ob.data)
    after_a_change(following)
    assert live.problem_of(fill) == "" and shown(ob)[2] == 36
    bm = bmesh.from_edit_mesh(ob.data)
    bmesh.ops.contextual_create(bm, geom=scenes.border_loops(bm)[0][2:5])
    bmesh.update_edit_mesh(ob.data)
    after_a_change(following)
    assert live.problem_of(fill) == "" and shown(ob)[2] == 36


def test_a_failure_leaves_the_last_good_fill_and_says_so(live, following):
    ob, fill = kept()
    good = points(fill)
    bm = bmesh.from_edit_mesh(ob.data)
    bmesh.ops.contextual_create(bm, geom=scenes.border_loops(bm)[0])
    bmesh.update_edit_mesh(ob.data)
    after_a_change(following)
    assert live.problem_of(fill) == "The hole is gone: the mesh has no border where it was"
    assert (points(fill) == good).all()
    bm = bmesh.from_edit_mesh(ob.data)
    bm.faces.ensure_lookup_table()
    bmesh.ops.delete(bm, geom=[max(bm.faces, key=lambda f: len(f.verts))], context="FACES_ONLY")
    bmesh.update_edit_mesh(ob.data)
    after_a_change(following)
    assert live.problem_of(fill) == "" and shown(ob)[2] == 36


@pytest.mark.parametrize("shape", [scenes.flat, scenes.bowl])
def test_a_rim_that_is_a_point_is_refused_and_leaves_the_last_good_fill(live, following, shape):
    ob, fill = kept(shape)
    good = points(fill)
    bm = bmesh.from_edit_mesh(ob.data)
    for v in scenes.border_loops(bm)[0]:
        v.co = (0.1, 0.2, 0.3)
    bmesh.update_edit_mesh(ob.data)
    after_a_change(following)
    said = "All vertices of the hole are at the same place; Mesh > Merge > By Distance joins them"
    assert live.problem_of(fill) == said
    assert (points(fill) == good).all()
    bm = bmesh.from_edit_mesh(ob.data)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    with pytest.raises(RuntimeError, match=said):
        bpy.ops.mesh.fill_smooth()


@pytest.mark.parametrize("kind", ["MULTIRES", "SOFT_BODY"])
def test_a_modifier_that_needs_the_mesh_itself_is_named_and_nothing_is_left(live, following, kind):
    """No other that makes faces may stand before it."""
    ob = scenes.add_hole()
    ob.modifiers.new("Own", kind)
    ob.modifiers.new("Subdivision", "SUBSURF")
    names = set(bpy.data.objects.keys()), set(bpy.data.meshes.keys())
    scenes.edit(ob)
    with pytest.raises(RuntimeError, match="The modifier 'Own' of Hole must be the first, .*; turn off Keep Live"):
        bpy.ops.mesh.fill_smooth(keep_live=True)
    assert (set(bpy.data.objects.keys()), set(bpy.data.meshes.keys())) == names
    assert [m.name for m in ob.modifiers] == ["Own", "Subdivision"]
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}


def in_another_scene(*objects):
    """A scene with these objects, that is looked at."""
    scene = bpy.data.scenes.new("Other")
    for ob in objects:
        scene.collection.objects.link(ob)
    bpy.context.window.scene = scene
    return scene


def test_looked_at_in_another_scene_it_follows_and_says_where_it_can_be_applied(live, following):
    ob, fill = kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    while after_a_change(following):
        pass
    before, home = points(fill), bpy.context.scene
    scene = in_another_scene(fill)
    try:
        for v in ob.data.vertices:
            v.co.z += 0.5
        ob.data.update()
        following.follow(fill.name)
        assert live.problem_of(fill) == ""
        assert points(fill) == pytest.approx(before + [0, 0, 0.5], abs=1e-5)
        with pytest.raises(RuntimeError, match=f"Hole, whose hole it fills, is in the scene '{home.name}'; apply it there"):
            bpy.ops.object.apply_live_fill(fill="Hole Fill")
    finally:
        bpy.context.window.scene = home
        bpy.data.scenes.remove(scene)
    assert bpy.ops.object.apply_live_fill(fill="Hole Fill") == {"FINISHED"}


def test_where_the_mesh_is_switched_off_apply_says_so(live, following):
    ob, fill = kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.objects.active = fill
    ob.hide_viewport = True
    with pytest.raises(RuntimeError, match="switch it on in the Outliner"):
        bpy.ops.object.apply_live_fill()
    ob.hide_viewport = False
    assert bpy.ops.object.apply_live_fill() == {"FINISHED"}


def test_a_fill_that_is_deleted_as_a_person_deletes_it_gives_the_hole_back(live, following):
    """Blender keeps the object as long as the modifier points to it."""
    ob, fill = kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    after_a_change(following)
    assert shown(ob)[2] == 36
    bpy.ops.object.select_all(action="DESELECT")
    fill.select_set(True)
    bpy.context.view_layer.objects.active = fill
    assert bpy.ops.object.delete() == {"FINISHED"}
    assert after_a_change(following)
    assert shown(ob)[2] == 48 and not ob.modifiers
    assert live.fills() == []


def test_a_fill_is_where_its_mesh_is_seen(live, following):
    """The collection of a rigid body world, which comes first by its name, is in no scene."""
    ob = scenes.add_hole()
    hidden = bpy.data.collections.new("A")
    hidden.objects.link(ob)
    scenes.edit(ob)
    assert bpy.ops.mesh.fill_smooth(keep_live=True) == {"FINISHED"}
    (fill,) = live.fills()
    assert fill.name in bpy.context.scene.objects
    assert [c.name for c in fill.users_collection] == [c.name for c in ob.users_collection if c != hidden]
    bpy.data.collections.remove(hidden)


TURNED = "Mesh > Normals > Recalculate Outside turns it"


def test_a_failure_says_what_helps(live, following):
    ob, fill = kept()
    bm = bmesh.from_edit_mesh(ob.data)
    scenes.border_loops(bm)[0][0].link_faces[0].normal_flip()
    bmesh.update_edit_mesh(ob.data)
    after_a_change(following)
    assert live.problem_of(fill).endswith(TURNED)
    with pytest.raises(RuntimeError, match=TURNED):
        bpy.ops.object.apply_live_fill()


def flat_with_a_bowl():
    """A flat hole, and a shape key that makes a bowl of it."""
    ob = scenes.add_hole(scenes.flat)
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Bowl")
    key.value = 0  # 1 in Blender 5
    for k, v in enumerate(ob.data.vertices):
        key.data[k].co.z = 0.6 * (v.co.x**2 + v.co.y**2)
    return ob, key


def kept_in_its_basis():
    """The bowl flat, in object mode, with a live fill."""
    ob, key = flat_with_a_bowl()
    ob.active_shape_key_index = 0
    scenes.edit(ob)
    bpy.ops.mesh.fill_three_sided(keep_live=True)
    fill = bpy.data.objects["Hole Fill"]
    bpy.ops.object.mode_set(mode="OBJECT")
    return ob, key, fill


def test_it_follows_shape_keys_in_object_mode(live, following):
    ob, key, fill = kept_in_its_basis()
    after_a_change(following)
    assert np.abs(points(fill)[:, 2]).max() < 1e-6
    for value in (1.0, 0.5):
        key.value = value
        assert after_a_change(following)
        z = points(fill)
        assert z[:, 2] == pytest.approx(0.6 * value * (z[:, :2] ** 2).sum(axis=1), abs=2e-3)
        assert shown(ob)[2] == 36


def test_given_corners_stay_those_vertices(live, following):
    ob = scenes.add_mesh(*scenes.ring())
    (bm,) = scenes.edit(ob)
    scenes.select(bm, list(bm.verts)[:24:8])
    assert bpy.ops.mesh.fill_three_sided(keep_live=True) == {"FINISHED"}
    fill = bpy.data.objects["Hole Fill"]
    settings = live.settings_of(fill)
    assert sorted(settings["rim"][k] for k in settings["corners"]) == [0, 8, 16]
    bm.verts.ensure_lookup_table()
    bmesh.ops.subdivide_edges(bm, edges=[bm.edges.get((bm.verts[0], bm.verts[1]))], cuts=2)
    bmesh.update_edit_mesh(ob.data)
    after_a_change(following)
    settings = live.settings_of(fill)
    assert len(settings["rim"]) == 26
    where = [tuple(round(c, 5) for c in settings["positions"][k]) for k in settings["corners"]]
    here = [tuple(round(c, 5) for c in ob.matrix_world @ v.co) for v in list(bmesh.from_edit_mesh(ob.data).verts)[:24:8]]
    assert sorted(where) == sorted(here)


@pytest.mark.parametrize("mode", ["EDIT", "OBJECT"])
def test_apply_makes_it_mesh(live, following, mode):
    ob, fill = kept()
    place, expected = points(fill), shown(ob)
    bpy.ops.object.mode_set(mode=mode)
    assert bpy.ops.object.apply_live_fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    bm = scenes.checked(ob)
    assert (len(bm.verts), len(bm.faces), sum(e.is_boundary for e in bm.edges)) == expected
    mesh = np.array([v.co for v in bm.verts])
    assert max(np.linalg.norm(mesh - p, axis=1).min() for p in place) < 1e-6
    bm.free()
    assert "Hole Fill" not in bpy.data.objects and not ob.modifiers


def test_apply_leaves_others_in_edit_mode_and_what_is_selected(live, following):
    ob, fill = kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    edited = [scenes.add_hole(), scenes.add_hole()]
    scenes.edit(*edited)
    edited[0].select_set(False)
    active = bpy.context.view_layer.objects.active
    assert bpy.ops.object.apply_live_fill(fill=fill.name) == {"FINISHED"}
    assert set(bpy.context.objects_in_mode) == set(edited) and ob.mode == "OBJECT"
    assert bpy.context.view_layer.objects.active == active
    assert [each.select_get() for each in (*edited, ob)] == [False, True, False]
    bpy.ops.object.mode_set(mode="OBJECT")
    assert scenes.checked(ob).faces and not scenes.border_loops(scenes.checked(ob))[1:]


def test_apply_fills_every_shape_key(live, following):
    ob, key = flat_with_a_bowl()
    scenes.edit(ob)
    ob.active_shape_key_index = 0
    bpy.ops.mesh.fill_three_sided(keep_live=True)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.object.apply_live_fill() == {"FINISHED"}
    z = np.array([d.co for d in ob.data.shape_keys.key_blocks["Bowl"].data])
    assert z[:, 2] == pytest.approx(0.6 * (z[:, :2] ** 2).sum(axis=1), abs=2e-3)


def test_a_subdivision_after_it_smooths_both(live):
    ob = scenes.add_hole()
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 1
    scenes.edit(ob)
    assert bpy.ops.mesh.fill_three_sided(keep_live=True, output="quads") == {"FINISHED"}
    assert [m.type for m in ob.modifiers] == ["NODES", "SUBSURF"]
    assert shown(ob)[2] == 72


@pytest.mark.parametrize("make", [tasks.cage_of_2_segments, tasks.cage_of_3_segments, tasks.pole_of_5_edges])
def test_a_live_cage_is_joined_without_a_crease_and_applied_as_it_was_seen(live, make):
    ob = make().ob
    bm = bmesh.from_edit_mesh(ob.data)
    border = scenes.border_loops(bm)
    rim = next(loop for loop in border if all(v.select for v in loop))
    left, rim, before = sum(map(len, border)) - len(rim), {tuple(v.co) for v in rim}, [tuple(v.co) for v in bm.verts]
    assert bpy.ops.mesh.fill_smooth(keep_live=True, cage_rim="move") == {"FINISHED"}
    assert live.settings_of(live.fills()[0])["arguments"]["output"] == "cage"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert shown(ob)[2] == 8 * left, "no gap along the rim"
    joined, counts = tasks.evaluated(ob), shown(ob)
    far = tasks.distance_to(joined)
    assert bpy.ops.object.apply_live_fill() == {"FINISHED"}
    applied = tasks.evaluated(ob)
    assert shown(ob) == counts and max(far([v.co for v in applied.verts])) < 1e-5
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    assert [tuple(v.co) for v in bm.verts][: len(before)] == before
    layer = bm.edges.layers.float.get("crease_edge") if bpy.app.version >= (4, 0) else bm.edges.layers.crease.active
    assert layer is None or not any(e[layer] for e in bm.edges if all(tuple(v.co) in rim for v in e.verts))
    bm.free()


def test_creases_that_the_rim_of_a_live_cage_had_stay(live):
    task = tasks.cage_of_4_segments()
    bm = bmesh.from_edit_mesh(task.ob.data)
    layers = bm.edges.layers
    layer = layers.crease.verify() if hasattr(layers, "crease") else layers.float.new("crease_edge")
    pairs = [tuple(v.index for v in e.verts) for e in bm.edges if e.select]
    for k, edge in enumerate(e for e in bm.edges if e.select):
        edge[layer] = k % 2 / 2
    bmesh.update_edit_mesh(task.ob.data)
    bpy.ops.mesh.fill_smooth(keep_live=True)
    bpy.ops.object.apply_live_fill()
    bm = bmesh.from_edit_mesh(task.ob.data)
    bm.verts.ensure_lookup_table()
    layer = bm.edges.layers.crease.active if hasattr(bm.edges.layers, "crease") else bm.edges.layers.float["crease_edge"]
    assert [bm.edges.get([bm.verts[k] for k in pair])[layer] for pair in pairs] == [k % 2 / 2 for k in range(len(pairs))]


def test_undo_and_redo(live, following):
    ob = scenes.add_hole()
    scenes.edit(ob)
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.mesh.fill_three_sided("EXEC_DEFAULT", True, keep_live=True)
    move(bpy.context.object, 0.5)
    bpy.ops.ed.undo_push(message="moved")
    after_a_change(following)
    assert points(bpy.data.objects["Hole Fill"])[:, 2].min() > 0.4
    bpy.ops.ed.undo()
    after_a_change(following)
    assert points(bpy.data.objects["Hole Fill"])[:, 2].max() < 0.4
    bpy.ops.ed.undo()
    assert "Hole Fill" not in bpy.data.objects and not bpy.context.object.modifiers
    assert following._on_change not in bpy.app.handlers.depsgraph_update_post
    bpy.ops.ed.redo()
    after_a_change(following)
    assert shown(bpy.data.objects["Hole"])[2] == 36
    bpy.ops.ed.redo()
    after_a_change(following)
    assert points(bpy.data.objects["Hole Fill"])[:, 2].min() > 0.4


def test_the_mesh_of_a_fill_stays_the_same_block(live, following):
    """Undo frees a block that is made between its steps, though the object, which no step has changed, still points to it."""
    ob, fill = kept()
    mesh, meshes, place = fill.data, set(bpy.data.meshes), points(fill)
    move(ob, 0.5)
    assert after_a_change(following) and points(fill) == pytest.approx(place + [0, 0, 0.5], abs=1e-5)
    assert fill.data == mesh and set(bpy.data.meshes) == meshes


def test_a_fill_that_is_edited_by_hand_is_filled_anew_afterwards(live, following):
    ob, fill = kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    after_a_change(following)
    place = points(fill)
    scenes.edit(fill)
    for v in ob.data.vertices:
        v.co.z += 0.5
    ob.data.update()
    after_a_change(following)
    assert live.problem_of(fill) == ""
    bpy.ops.object.mode_set(mode="OBJECT")
    assert points(fill) == pytest.approx(place, abs=1e-6)
    assert after_a_change(following)
    assert points(fill) == pytest.approx(place + [0, 0, 0.5], abs=1e-5)


def test_saved_it_follows_again_and_without_the_addon_it_is_a_mesh(live, following, addon, tmp_path):
    ob, fill = kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    place, expected = points(fill), shown(ob)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "live.blend"))
    bpy.data.objects.remove(fill)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "live.blend"))
    ob, fill = bpy.data.objects["Hole"], bpy.data.objects["Hole Fill"]
    assert (points(fill) == place).all() and shown(ob) == expected
    scenes.edit(ob)
    move(ob, 0.5)
    assert after_a_change(following)
    assert points(fill) == pytest.approx(place + [0, 0, 0.5], abs=1e-5)
    bpy.ops.object.mode_set(mode="OBJECT")
    following.unregister()  # what a Blender without the add-on does: nothing
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "live.blend"))
    assert shown(bpy.data.objects["Hole"]) == expected
    following.register()


def test_renamed_it_follows(live, following):
    ob, fill = kept()
    after_a_change(following)
    before = points(fill)
    fill.name = "Cheek"
    move(ob, 0.5)
    assert after_a_change(following)
    assert points(fill) == pytest.approx(before + [0, 0, 0.5], abs=1e-5)
    move(ob, 0.5)
    bpy.context.view_layer.update()
    fill.name = "Chin"  # between the change and the fill
    assert after_a_change(following)
    assert points(fill) == pytest.approx(before + [0, 0, 1.0], abs=1e-5)


def saved_and_gone(folder):
    """A file with a mesh and its live fill, which are no longer here."""
    file = folder / "live.blend"
    kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.wm.save_as_mainfile(filepath=str(file), copy=True)
    for ob in list(bpy.data.objects):
        bpy.data.objects.remove(ob)
    return file


@pytest.mark.skipif(not hasattr(bpy.app.handlers, "blend_import_post"), reason="this Blender does not tell of it")
def test_appended_it_follows(live, following, tmp_path):
    file = saved_and_gone(tmp_path)
    after_a_change(following)
    assert following._on_change not in bpy.app.handlers.depsgraph_update_post
    files = [{"name": name} for name in ("Hole", "Hole Fill")]
    bpy.ops.wm.append(files=files, directory=str(file / "Object") + "/")
    ob, fill = bpy.data.objects["Hole"], bpy.data.objects["Hole Fill"]
    before = points(fill)
    scenes.edit(ob)
    move(ob, 0.5)
    assert after_a_change(following)
    assert points(fill) == pytest.approx(before + [0, 0, 0.5], abs=1e-5)


def test_a_linked_one_is_of_its_own_file(live, following, tmp_path):
    file = saved_and_gone(tmp_path)
    with bpy.data.libraries.load(str(file), link=True) as (_, linked):
        linked.objects = ["Hole", "Hole Fill"]
    for ob in linked.objects:
        bpy.context.collection.objects.link(ob)
    following.scan()
    assert live.fills() == [] and following._on_change not in bpy.app.handlers.depsgraph_update_post
    ob, _ = kept()
    (fill,) = live.fills()
    while after_a_change(following):
        pass
    before = points(fill)
    move(ob, 0.5)
    assert after_a_change(following)
    assert points(fill) == pytest.approx(before + [0, 0, 0.5], abs=1e-5)
    assert not following._following.stale


def test_a_copy_of_mesh_and_fill_follows(live, following):
    ob, fill = kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    after_a_change(following)
    before = points(fill)
    for each in (ob, fill):
        each.select_set(True)
    bpy.ops.object.duplicate()
    after_a_change(following)
    ob, copied = bpy.data.objects["Hole.001"], bpy.data.objects["Hole Fill.001"]
    scenes.edit(ob)
    move(ob, 0.5)
    assert after_a_change(following)
    assert points(copied) == pytest.approx(before + [0, 0, 0.5], abs=1e-5)
    assert (points(fill) == before).all()


def test_it_follows_a_keyed_shape_key_from_frame_to_frame(live, following):
    ob, key, fill = kept_in_its_basis()
    for frame, key.value in ((1, 0.0), (11, 1.0)):
        key.keyframe_insert("value", frame=frame)
    for frame in (1, 6, 11):
        while after_a_change(following):
            pass
        bpy.context.scene.frame_set(frame)
        assert after_a_change(following)
        z = points(fill)
        assert z[:, 2] == pytest.approx(0.6 * key.value * (z[:, :2] ** 2).sum(axis=1), abs=2e-3)
        assert shown(ob)[2] == 36
    assert key.value == 1


class Seen(bpy.types.RenderEngine):
    """Takes down what it is to render."""

    bl_idname = "TRIPATCH_SEEN"
    bl_label = "Seen"
    bl_use_preview = False
    frames: dict = {}

    def render(self, depsgraph):
        mesh = depsgraph.objects["Hole"].data
        points = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", points)
        self.frames[depsgraph.scene.frame_current] = points.reshape(-1, 3).astype(float)


@pytest.fixture
def rendered(tmp_path):
    """What is rendered of frames 1 to 3: {frame: points of the mesh with its fill}."""
    scene = bpy.context.scene
    before = scene.render.engine, scene.frame_end, scene.render.filepath, scene.camera
    bpy.utils.register_class(Seen)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.render.engine, scene.frame_end, scene.render.filepath, scene.camera = Seen.bl_idname, 3, str(tmp_path) + "/", camera
    scene.render.resolution_x = scene.render.resolution_y = 8
    Seen.frames.clear()
    yield Seen.frames
    scene.render.engine, scene.frame_end, scene.render.filepath, scene.camera = before
    scene.frame_set(1)
    bpy.utils.unregister_class(Seen)


def test_an_animation_that_is_rendered_without_a_window_has_the_fill_of_each_frame(live, following, rendered):
    ob, key, fill = kept_in_its_basis()
    for frame, key.value in ((1, 0.0), (3, 1.0)):
        key.keyframe_insert("value", frame=frame)
    while after_a_change(following):
        pass
    assert bpy.ops.render.render(animation=True) == {"FINISHED"}
    assert sorted(rendered) == [1, 2, 3]
    for frame, value in ((1, 0), (2, 0.5), (3, 1)):
        points = rendered[frame]
        assert len(points) > len(ob.data.vertices)
        assert points[:, 2] == pytest.approx(0.6 * value * (points[:, :2] ** 2).sum(axis=1), abs=2e-3)


def test_a_file_is_saved_with_what_was_still_to_be_filled(live, following, tmp_path):
    ob, fill = kept()
    while after_a_change(following):
        pass
    before = points(fill)
    move(ob, 0.5)
    bpy.context.view_layer.update()
    assert bpy.app.timers.is_registered(following._tick) and (points(fill) == before).all()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"), copy=True)
    assert points(fill) == pytest.approx(before + [0, 0, 0.5], abs=1e-5)


def test_a_deleted_fill_leaves_nothing_and_comes_back_with_undo(live, following):
    ob, _ = kept()
    name, handlers = ob.name, (bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.ed.undo_push(message="kept")
    after_a_change(following)
    assert all(following._on_change in each for each in handlers)
    bpy.data.objects.remove(bpy.data.objects["Hole Fill"])
    bpy.ops.ed.undo_push(message="deleted")
    after_a_change(following)
    assert not bpy.data.objects[name].modifiers
    assert not any(following._on_change in each for each in handlers)
    bpy.ops.ed.undo()
    after_a_change(following)
    assert shown(bpy.data.objects[name])[2] == 36
    assert all(following._on_change in each for each in handlers)
    bpy.ops.ed.redo()
    after_a_change(following)
    assert not bpy.data.objects[name].modifiers
    assert not any(following._on_change in each for each in handlers)


def test_the_fill_of_a_mesh_that_is_deleted_is_left_as_a_mesh(live, following):
    ob, fill = kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    after_a_change(following)
    before = points(fill)
    bpy.data.objects.remove(ob)
    assert after_a_change(following)
    assert live.problem_of(fill) == "An object that it followed is gone; apply the fill, or delete it"
    assert bpy.ops.object.apply_live_fill() == {"FINISHED"}
    assert not live.is_live(fill) and (points(fill) == before).all()
    assert fill.display_type == "TEXTURED" and not fill.hide_render


def test_other_modifiers_with_no_fill_stay(live, following):
    ob, _ = kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    ob.modifiers.new("Mine", "NODES")
    after_a_change(following)
    bpy.data.objects.remove(bpy.data.objects["Hole Fill"])
    after_a_change(following)
    assert [m.name for m in ob.modifiers] == ["Mine"]


def test_materials_of_an_object_are_not_mixed_up(live):
    """Joined meshes have one empty slot: faces of all others would get its material."""
    ob = scenes.add_hole()
    for name in ("A", "B"):
        ob.data.materials.append(None)
        ob.material_slots[-1].link = "OBJECT"
        ob.material_slots[-1].material = bpy.data.materials.new(name)
    scenes.edit(ob)
    with pytest.raises(RuntimeError, match="linked to the object"):
        bpy.ops.mesh.fill_three_sided(keep_live=True)
    assert not live.fills()


def test_a_refused_hole_leaves_no_object(live):
    ob = scenes.add_mesh(*scenes.square_hole())
    (bm,) = scenes.edit(ob)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    before = {o.name for o in bpy.data.objects}
    with contextlib.suppress(RuntimeError):  # whether a refusal raises is the operator's matter
        assert bpy.ops.mesh.fill_three_sided(keep_live=True, method="side_vertex") == {"CANCELLED"}
    assert {o.name for o in bpy.data.objects} == before and not ob.modifiers


def patches():
    """Three NURBS surfaces around a three-sided hole: parts of a bowl."""
    corners = np.array([(np.cos(a), np.sin(a), 0) for a in (0.3, 2.4, 4.5)])
    objects = []
    for i in range(3):
        a, b = corners[(i + 1) % 3], corners[(i + 2) % 3]
        away = (a + b) / np.linalg.norm(a + b)
        data = bpy.data.curves.new(f"Patch {i}", "SURFACE")
        data.dimensions = "3D"
        made = []
        for row in range(4):
            spline = data.splines.new("NURBS")
            spline.points.add(3)
            for k, p in enumerate(spline.points):
                point = a + (b - a) * k / 3 + away * row * 0.3
                p.co = (*point[:2], 0.3 * (point[:2] @ point[:2]), 1)
            made.append(spline)
        ob = bpy.data.objects.new(f"Patch {i}", data)
        bpy.context.collection.objects.link(ob)
        bpy.context.view_layer.objects.active = ob
        bpy.ops.object.select_all(action="DESELECT")
        ob.select_set(True)
        bpy.ops.object.mode_set(mode="EDIT")
        for spline in data.splines:
            for p in spline.points:
                p.select = True
        bpy.ops.curve.make_segment()
        bpy.ops.object.mode_set(mode="OBJECT")
        for spline in data.splines:
            spline.use_endpoint_u = spline.use_endpoint_v = True
            spline.order_u = spline.order_v = 4
        objects.append(ob)
    for ob in objects:
        ob.select_set(True)
    return objects


def test_a_fill_between_surfaces_follows_when_they_are_moved(live, following):
    objects = patches()
    assert bpy.ops.object.fill_between_patches(keep_live=True, tolerance=0.01) == {"FINISHED"}
    fill = bpy.data.objects["Fill"]
    assert live.is_live(fill) and [ob.name for ob in live.around(fill)] == [ob.name for ob in objects]
    after_a_change(following)
    before = points(fill)
    for ob in objects:
        ob.location.z += 1
    assert after_a_change(following)
    assert points(fill) == pytest.approx(before + [0, 0, 1], abs=1e-5)
    objects[0].location.x += 5
    after_a_change(following)
    assert live.problem_of(fill)
    assert points(fill) == pytest.approx(before + [0, 0, 1], abs=1e-5)
    objects[0].location.x -= 5
    after_a_change(following)
    assert live.problem_of(fill) == ""
    bpy.data.objects.remove(objects[0])
    after_a_change(following)
    assert live.problem_of(fill) == "An object that it followed is gone; apply the fill, or delete it"
    assert bpy.ops.object.update_live_fill() == {"FINISHED"}
    assert json.loads(fill["tripatch_live"])["kind"] == "patches"


@pytest.mark.parametrize("parent", [False, True])
def test_a_fill_between_surfaces_follows_keyed_ones(live, following, parent):
    objects = patches()
    bpy.ops.object.fill_between_patches(keep_live=True, tolerance=0.01)
    fill = bpy.data.objects["Fill"]
    empty = bpy.data.objects.new("Empty", None)
    bpy.context.collection.objects.link(empty)
    for ob in objects:
        ob.parent = empty if parent else None
    before = points(fill)
    for frame in (1, 11):
        for ob in [empty] if parent else objects:
            ob.location.z = frame - 1
            ob.keyframe_insert("location", frame=frame)
    for frame in (1, 11, 6):
        bpy.context.scene.frame_set(frame)
        after_a_change(following)
        assert points(fill) == pytest.approx(before + [0, 0, objects[0].matrix_world.translation.z], abs=1e-5)
    assert objects[0].matrix_world.translation.z == pytest.approx(5)
