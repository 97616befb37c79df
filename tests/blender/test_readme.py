"""The minute in Blender of the README."""

import bpy
import scenes


def test_the_hole_whose_boundary_is_selected_is_filled_and_the_fill_is_changed_later():
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
    assert len(scenes.border_loops(bm)) == 1  # the outer border
    before = scenes.state(ob.name)["vertices"]
    assert bpy.ops.mesh.edit_fill(bulge=2.0) == {"FINISHED"}
    assert scenes.state(ob.name)["vertices"] != before


def test_every_hole_is_filled_if_nothing_is_selected():
    (bm,) = scenes.edit(scenes.add_hole(holes=((3, 3, 2), (7, 1, 2))))
    assert len(scenes.border_loops(bm)) == 3
    assert bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT") == {"FINISHED"}
    assert len(scenes.border_loops(bm)) == 1
