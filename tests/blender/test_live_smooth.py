"""mesh.smooth_triangles with Keep Live: an object that follows the mesh whose faces it smooths."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes
from test_live import after_a_change, move, points
from test_smooth_triangles import add_blob, library_surface, positions, select_all, select_top, smooth


def kept(**options):
    """(object in edit mode, its live copy)"""
    ob = add_blob()
    select_all(ob)
    assert smooth(keep_live=True, **options) == {"FINISHED"}
    return ob, bpy.data.objects["Blob Smooth"]


def faces_of(ob):
    return [list(p.vertices) for p in ob.data.polygons]


def expected(ob, **options):
    """What the library makes of an object in object mode."""
    return library_surface(positions(ob), faces_of(ob), **options).vertices


def as_set(points):
    return np.array(sorted(np.round(points, 4).tolist()))


def test_it_is_an_object_beside_the_mesh(live):
    ob, made = kept(resolution=4)
    assert live.is_live(made) and made.parent == ob and len(made.data.polygons) == 16 * 80
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(ob.data.polygons) == 80, "the mesh itself is as it was"
    assert as_set(points(made)) == pytest.approx(as_set(expected(ob, resolution=4)), abs=2e-4)


@pytest.mark.parametrize("mode", ["EDIT", "OBJECT"])
def test_it_follows_a_vertex_that_is_moved(live, following, mode):
    ob, made = kept(resolution=4)
    before = points(made)
    top = int(np.argmax([v.co.z for v in bmesh.from_edit_mesh(ob.data).verts]))
    if mode == "EDIT":
        move(ob, 0.3, lambda v: v.index == top)
        assert after_a_change(following)
        bpy.ops.object.mode_set(mode="OBJECT")
    else:
        bpy.ops.object.mode_set(mode="OBJECT")
        ob.data.vertices[top].co.z += 0.3
        ob.data.update()
        assert after_a_change(following)
    assert points(made)[:, 2].max() > before[:, 2].max() + 0.2
    assert as_set(points(made)) == pytest.approx(as_set(expected(ob, resolution=4)), abs=2e-4)


def test_it_follows_new_faces_of_a_mesh_that_is_smoothed_whole(live, following):
    ob, made = kept(resolution=2)
    bm = bmesh.from_edit_mesh(ob.data)
    bmesh.ops.poke(bm, faces=bm.faces[:3])
    bmesh.update_edit_mesh(ob.data)
    assert after_a_change(following) and live.problem_of(made) == ""
    assert len(made.data.polygons) == 4 * (80 + 6)


def test_only_the_selected_faces_are_smoothed_and_followed(live, following):
    ob = add_blob()
    top = select_top(ob)
    assert smooth(keep_live=True, resolution=3) == {"FINISHED"}
    made = bpy.data.objects["Blob Smooth"]
    assert len(made.data.polygons) == 9 * len(top)
    move(ob, 0.1)
    before = points(made)
    assert after_a_change(following)
    assert points(made) == pytest.approx(before + [0, 0, 0.1], abs=1e-5)
    bm = bmesh.from_edit_mesh(ob.data)
    bm.faces.ensure_lookup_table()
    bmesh.ops.delete(bm, geom=[bm.faces[top[0]]], context="FACES")
    bmesh.update_edit_mesh(ob.data)
    after_a_change(following)
    assert "are gone" in live.problem_of(made) and len(made.data.polygons) == 9 * len(top), "the last good one stays"


def test_undo_and_redo(live, following):
    ob = add_blob()
    select_all(ob)
    bpy.ops.ed.undo_push(message="before")
    smooth(keep_live=True)
    bpy.ops.ed.undo_push(message="kept")
    made = points(bpy.data.objects["Blob Smooth"])
    move(bpy.context.object, 0.5)
    after_a_change(following)
    bpy.ops.ed.undo_push(message="moved")
    bpy.ops.ed.undo()
    after_a_change(following)
    assert points(bpy.data.objects["Blob Smooth"]) == pytest.approx(made, abs=1e-6)
    bpy.ops.ed.redo()
    after_a_change(following)
    assert points(bpy.data.objects["Blob Smooth"]) == pytest.approx(made + [0, 0, 0.5], abs=1e-5)
    bpy.ops.ed.undo()
    bpy.ops.ed.undo()
    assert "Blob Smooth" not in bpy.data.objects


def test_a_saved_file_follows_when_it_is_opened_again(live, following, tmp_path):
    kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "smooth.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "smooth.blend"))
    ob, made = bpy.data.objects["Blob"], bpy.data.objects["Blob Smooth"]
    before = points(made)
    for v in ob.data.vertices:
        v.co.z += 0.5
    ob.data.update()
    assert after_a_change(following)
    assert points(made) == pytest.approx(before + [0, 0, 0.5], abs=1e-5)


def test_applied_it_is_a_mesh_like_any_other(live, following):
    ob, made = kept()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.object.apply_live_fill() == {"FINISHED"}
    assert not live.is_live(made) and len(made.data.polygons) == 9 * 80
    before = points(made)
    ob.data.vertices[0].co.z += 1
    ob.data.update()
    after_a_change(following)
    assert points(made).tobytes() == before.tobytes()


def test_custom_normals_of_the_mesh_count():
    flat = add_blob()
    bpy.ops.object.select_all(action="DESELECT")
    up = [(0, 0, 1)] * len(flat.data.loops)
    flat.data.normals_split_custom_set(up)
    if hasattr(flat.data, "use_auto_smooth"):
        flat.data.use_auto_smooth = True
    top = select_top(flat)
    assert smooth(keep_live=True, resolution=3) == {"FINISHED"}
    made = points(bpy.data.objects["Blob Smooth"])
    bpy.ops.object.mode_set(mode="OBJECT")
    select_top(flat)
    assert smooth(resolution=3) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    inside = {v for p in flat.data.polygons if p.select for v in p.vertices}
    assert len(made) == len(inside) and len(top) > 10
    assert as_set(made) == pytest.approx(as_set(positions(flat)[sorted(inside)]), abs=2e-4)


def test_what_cannot_be_smoothed_leaves_nothing_behind():
    ob = scenes.add_mesh(np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]], float), [[0, 1, 2], [0, 2, 3]], "Flat")
    select_all(ob)
    with pytest.raises(RuntimeError, match="has no area"):
        smooth(keep_live=True)
    assert list(bpy.data.objects) == [ob]
