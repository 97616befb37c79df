"""Edit Fill: faces know which fill made them, and a fill is made again with its options."""

import bmesh
import bpy
import numpy as np
import pytest
from scenes import add_hole, add_mesh, ball_with_hole, border_loops, edit, ring, square_hole


def numbers(bm):
    layer = bm.faces.layers.int.get("tripatch_fill")
    return [0] * len(bm.faces) if layer is None else [f[layer] for f in bm.faces]


def filled(ob, **options):
    """An object in edit mode whose shortest border was filled."""
    (bm,) = edit(ob)
    for v in border_loops(bm)[0]:
        v.select = True
    bm.select_flush(True)
    assert bpy.ops.mesh.fill_smooth(**options) == {"FINISHED"}
    return bmesh.from_edit_mesh(ob.data)


def select_one_of(bm, number):
    bpy.ops.mesh.select_all(action="DESELECT")
    layer = bm.faces.layers.int["tripatch_fill"]
    face = next(f for f in bm.faces if f[layer] == number)
    face.select = True
    bm.faces.active = face
    bm.select_flush(True)


def places(bm, made):
    """What is inside of fills, or all else."""
    layer = bm.faces.layers.int["tripatch_fill"]
    return sorted({tuple(v.co) for v in bm.verts if all(f[layer] for f in v.link_faces) == made})


def test_faces_of_a_fill_are_marked_and_the_others_are_not():
    bm = filled(add_mesh(*ball_with_hole()))
    marked = numbers(bm)
    assert set(marked) == {0, 1}
    assert [f.select for f in bm.faces] == [n == 1 for n in marked]


def test_a_refused_hole_leaves_no_attribute():
    ob = add_mesh(*ring())
    (bm,) = edit(ob)
    for v in border_loops(bm)[0]:
        v.select = True
    bm.select_flush(True)
    with pytest.raises(RuntimeError):
        bpy.ops.mesh.fill_smooth(method="side_vertex")
    assert bmesh.from_edit_mesh(ob.data).faces.layers.int.get("tripatch_fill") is None


def test_the_same_options_make_the_same_fill_again():
    bm = filled(add_mesh(*ball_with_hole()))
    before = places(bm, True)
    select_one_of(bm, 1)
    assert bpy.ops.mesh.edit_fill() == {"FINISHED"}
    bm = bmesh.from_edit_mesh(bpy.context.edit_object.data)
    assert np.allclose(places(bm, True), before, atol=1e-6)
    assert set(numbers(bm)) == {0, 1}


def test_options_are_those_of_the_fill_unless_given():
    ob = add_mesh(*ball_with_hole())
    bm = filled(ob, bulge=1.3)
    bulged = places(bm, True)
    select_one_of(bm, 1)
    bpy.ops.mesh.edit_fill(tension=0.0)
    bm = bmesh.from_edit_mesh(ob.data)
    assert np.allclose(places(bm, True), bulged, atol=1e-6)
    select_one_of(bm, 1)
    bpy.ops.mesh.edit_fill(bulge=1.0)
    assert not np.allclose(places(bmesh.from_edit_mesh(ob.data), True)[: len(bulged)], bulged, atol=1e-3)


def test_a_fill_is_edited_after_saving_and_reading_and_all_else_stays(tmp_path):
    ob = add_mesh(*square_hole())
    bm = filled(ob)
    outside = places(bm, False)
    name = ob.name
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "fill.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "fill.blend"))
    ob = bpy.data.objects[name]
    (bm,) = edit(ob)
    select_one_of(bm, 1)
    count = numbers(bm).count(1)
    assert bpy.ops.mesh.edit_fill(rows=4) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    assert numbers(bm).count(1) > count
    assert places(bm, False) == outside
    assert not any(e.is_boundary for f in bm.faces if f.select for e in f.edges)


def test_a_face_of_no_fill_is_refused_and_nothing_changes():
    ob = add_mesh(*ball_with_hole())
    (bm,) = edit(ob)
    bm.faces.ensure_lookup_table()
    bm.faces[0].select = True
    count = len(bm.faces)
    with pytest.raises(RuntimeError, match="Select a face of a fill"):
        bpy.ops.mesh.edit_fill()
    assert len(bmesh.from_edit_mesh(ob.data).faces) == count


def test_two_fills_have_two_numbers_and_one_is_edited():
    ob = add_hole(size=16, holes=((2, 2, 4), (8, 3, 4)))
    (bm,) = edit(ob)
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.fill_smooth()
    bm = bmesh.from_edit_mesh(ob.data)
    assert set(numbers(bm)) == {0, 1, 2}
    first = sorted(f.calc_center_median().to_tuple(5) for f, n in zip(bm.faces, numbers(bm)) if n == 1)
    select_one_of(bm, 2)
    bpy.ops.mesh.edit_fill(resolution=7)
    bm = bmesh.from_edit_mesh(ob.data)
    assert sorted(f.calc_center_median().to_tuple(5) for f, n in zip(bm.faces, numbers(bm)) if n == 1) == first


def test_a_slider_that_fills_again_uses_the_same_number():
    ob = add_mesh(*ball_with_hole())
    (bm,) = edit(ob)
    for v in border_loops(bm)[0]:
        v.select = True
    bm.select_flush(True)
    bpy.ops.ed.undo_push(message="before")
    for bulge in (1.0, 1.2, 1.4):
        bpy.ops.mesh.fill_smooth("EXEC_DEFAULT", True, bulge=bulge)
        assert set(numbers(bmesh.from_edit_mesh(bpy.context.edit_object.data))) == {0, 1}
        bpy.ops.ed.undo()
