"""What holes are filled with where nobody has chosen it: quads continue in quads, triangles in triangles."""

import sys

import bmesh
import bpy
import pytest
import scenes
import tasks
from test_smooth_fill import operator

smooth = bpy.ops.mesh.fill_smooth


def grid(triangulated=0, name="Hole"):
    """A sheet of quads with a hole of twelve edges, so many of them next to triangles."""
    points, faces = scenes.square_hole()
    at_hole = []
    for face in faces:
        if sum(abs(points[v, :2]).max() < 0.2 for v in face) == 2:
            at_hole.append(face)
    assert len(at_hole) == 12
    for face in at_hole[:triangulated]:
        faces.remove(face)
        faces += [[face[0], face[1], face[2]], [face[0], face[2], face[3]]]
    return scenes.add_mesh(points, faces, name)


def corners(ob):
    """Of the faces that are selected, the new ones, in edit mode."""
    bm = bmesh.from_edit_mesh(ob.data)
    return sorted({len(f.verts) for f in bm.faces if f.select})


def filled(ob, pick=None, **options):
    """The numbers of corners of the new faces."""
    (bm,) = scenes.edit(ob, mode="EDGE")
    if pick:
        pick(bm)
    assert smooth(**options) == {"FINISHED"}
    found = corners(ob)
    bpy.ops.object.mode_set(mode="OBJECT")
    return found


def rim(bm):
    scenes.select_rim(bm, scenes.border_loops(bm)[0])


@pytest.mark.parametrize("pick", [None, rim], ids=["all", "selected"])
def test_a_hole_among_quads_is_filled_with_quads_and_one_among_triangles_with_triangles(pick):
    assert filled(grid(), pick) == [4]
    assert filled(scenes.add_hole(), pick) == [3]
    assert filled(grid(), pick, output="triangles") == [3]


@pytest.mark.parametrize(("triangulated", "expected"), [(1, [4]), (6, [4]), (7, [3]), (12, [3])])
def test_along_a_mixed_rim_the_more_faces_count(triangulated, expected):
    assert filled(grid(triangulated), rim) == expected


def test_faces_of_more_corners_count_for_neither():
    """Those of the ends of a cylinder, next to a hole in its side."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=12)
    ob = bpy.context.object
    (bm,) = scenes.edit(ob, mode="FACE")
    bmesh.ops.delete(bm, geom=[next(f for f in bm.faces if len(f.verts) == 4)], context="FACES_ONLY")
    assert smooth() == {"FINISHED"}
    assert corners(ob) == [4] and not any(e.is_boundary for e in bmesh.from_edit_mesh(ob.data).edges)


def test_triangles_among_quads_are_replaced_by_quads():
    points, faces = scenes.square_hole()
    ob = scenes.add_mesh(points, faces)
    scenes.edit(ob, mode="EDGE")
    assert smooth(output="triangles") == {"FINISHED"}
    bpy.ops.mesh.select_mode(type="FACE")
    assert smooth() == {"FINISHED"}
    assert corners(ob) == [4]
    assert {len(f.verts) for f in bmesh.from_edit_mesh(ob.data).faces} == {4}


def test_only_rims_that_are_filled_count():
    """A hole among triangles that a filter keeps out, and the outer border of a sheet."""
    ob = grid()
    (bm,) = scenes.edit(ob, mode="FACE")
    outer = [f for f in bm.faces if any(e.is_boundary for e in f.edges) and max(abs(v.co.x) for v in f.verts) > 0.4]
    bmesh.ops.triangulate(bm, faces=outer)
    far = next(v for v in bm.verts if abs(v.co.x - 0.35) < 0.01 and abs(v.co.y + 0.35) < 0.01)
    around = list(far.link_faces)
    bmesh.ops.delete(bm, geom=[next(f for f in around if len(f.verts) == 3)], context="FACES_ONLY")
    assert smooth(use_max_edges=True, max_edges=3) == {"FINISHED"}
    assert corners(ob) == [3]
    bpy.ops.mesh.select_all(action="DESELECT")
    assert smooth() == {"FINISHED"}
    assert corners(ob) == [4]


def test_a_subdivision_modifier_asks_for_a_cage_among_quads_too(addon):
    ob = grid()
    ob.modifiers.new("Subdivision", "SUBSURF")
    scenes.edit(ob)
    state = operator(addon)
    assert state.execute(bpy.context) == {"FINISHED"}
    assert state.faces() == "cage" and "cage of" in state.said[0][1]


def run(state, ob):
    scenes.edit(ob)
    assert state.execute(bpy.context) == {"FINISHED"}
    found = corners(ob)
    bpy.ops.object.mode_set(mode="OBJECT")
    return found


def test_the_panel_shows_what_was_chosen_and_another_option_does_not_change_it(addon):
    state = operator(addon)
    assert run(state, grid()) == [4] and state.output == "auto" and state.faces() == "quads" and state.rows == 0
    state.bulge = 1.2
    assert run(state, grid()) == [4] and state.faces() == "quads"
    state.output = "triangles"
    assert run(state, grid()) == [3] and state.output == "triangles"
    state.resolution = 5
    assert run(state, grid()) == [3] and state.output == "triangles"
    state.output = "quads"
    assert run(state, grid()) == [4] and state.output == "quads"
    state.output = "auto"
    assert run(state, scenes.add_hole()) == [3] and state.faces() == "triangles"


def test_who_asks_for_quads_among_triangles_gets_them_with_every_other_option(addon):
    state = operator(addon)
    assert run(state, scenes.add_hole()) == [3]
    state.output = "quads"
    assert run(state, scenes.add_hole()) == [4]
    state.tension = 1.0
    assert run(state, scenes.add_hole()) == [4] and state.output == "quads"


def test_neither_what_was_taken_nor_what_was_computed_is_remembered_for_the_next_hole():
    """What is remembered would count as what a person has chosen."""
    properties = smooth.get_rna_type().properties
    assert properties["output"].is_skip_save and properties["computed_output"].is_skip_save


def test_the_panel_has_the_filters_of_all_holes_where_all_are_meant_whatever_they_are_filled_with(addon):
    for options in ({}, {"output": "triangles"}, {"deviation": True}):
        for pick in (None, rim):
            state = operator(addon, **options)
            (bm,) = scenes.edit(grid(), mode="EDGE")
            if pick:
                pick(bm)
            assert state.execute(bpy.context) == {"FINISHED"}
            assert state.all_holes == (pick is None)
            bpy.ops.object.mode_set(mode="OBJECT")


def test_a_script_that_counts_the_edges_of_triangles_gets_them_and_so_does_the_panel_after_it(addon):
    assert filled(grid(), resolution=2) == [3]
    state = operator(addon, resolution=2)
    assert run(state, grid()) == [3]
    state.bulge = 1.2
    assert run(state, grid()) == [3] and state.faces() == "triangles"


@pytest.mark.parametrize(
    ("makes", "expected"),
    [((grid, grid, scenes.add_hole), [[4], [4], [3]]), ((grid, scenes.add_hole, scenes.add_hole), [[4], [3], [3]])],
)
def test_each_of_several_objects_gets_the_faces_that_lie_around_its_own_hole(makes, expected):
    obs = [make() for make in makes]
    for bm in scenes.edit(*obs, mode="EDGE"):
        rim(bm)
    assert smooth() == {"FINISHED"}
    assert [corners(ob) for ob in obs] == expected


def odd_hole():
    """Where three edges of a cube that are bevelled in three rows meet: sides of three edges."""
    task = tasks._bevelled((1, 1, 1), 3)
    return tasks.open_up(task, tasks._beyond(task, (0.2, 0.2, 0.2)))


def test_an_odd_rim_among_quads_gets_one_triangle_and_they_stay_quads(addon):
    for options, triangles, larger in (({}, 1, 0), ({"output": "quads"}, 0, 1)):
        task = odd_hole()
        bm = bmesh.from_edit_mesh(task.ob.data)
        before = sum(len(f.verts) > 4 for f in bm.faces)
        assert smooth(**options) == {"FINISHED"}
        bm = bmesh.from_edit_mesh(task.ob.data)
        assert sum(len(f.verts) == 3 for f in bm.faces if f.select) == triangles
        assert sum(len(f.verts) > 4 for f in bm.faces) == before + larger
        bpy.ops.object.mode_set(mode="OBJECT")
    state = operator(addon)
    task = odd_hole()
    assert state.execute(bpy.context) == {"FINISHED"} and state.odd == "triangle"
    bpy.ops.object.mode_set(mode="OBJECT")
    state.odd = "split"
    task = odd_hole()
    assert state.execute(bpy.context) == {"FINISHED"} and state.odd == "split"
    assert corners(task.ob) == [4]


def test_the_status_bar_counts_the_triangles_among_quads(addon):
    """Where points inside are met; none where all are quads."""
    for inside in (True, False):
        ob, state = grid(), operator(addon)
        (bm,) = scenes.edit(ob)
        rim(bm)
        if inside:
            bm.verts.new((0.0, 0.02, 0.05)).select = True
        assert state.execute(bpy.context) == {"FINISHED"} and state.faces() == "quads"
        new = [len(f.verts) for f in bmesh.from_edit_mesh(ob.data).faces if f.select]
        ((_, said),) = state.said
        assert (f"; {new.count(3)} of {len(new)} new faces " in said) == (3 in new) == ("triangles" in said)
        assert inside or 3 not in new
        bpy.ops.object.mode_set(mode="OBJECT")


def test_a_hole_at_a_mirror_plane_goes_on_in_quads():
    task = tasks.on_the_mirror_plane()
    assert smooth() == {"FINISHED"}
    assert corners(task.ob) == [4]


@pytest.mark.parametrize(("make", "expected"), [(grid, {4}), (scenes.add_hole, {3})])
def test_a_live_fill_likewise_and_it_stays_so(make, expected):
    ob = make()
    scenes.edit(ob)
    assert smooth(keep_live=True) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    fill = next(other for other in bpy.data.objects if other.name.endswith("Fill"))
    assert {len(p.vertices) for p in fill.data.polygons} == expected
    assert bpy.ops.object.update_live_fill() == {"FINISHED"}
    assert {len(p.vertices) for p in fill.data.polygons} == expected


def shaped(addon, ob):
    shaping = sys.modules[addon.__name__ + ".shaping"]
    (bm,) = scenes.edit(ob)
    rim(bm)
    return shaping.from_selection(ob, bm)


def test_the_tool_likewise_until_one_chooses_otherwise(addon):
    tool = sys.modules[addon.__name__ + ".tool"]
    settings = bpy.context.window_manager.tripatch_tool
    try:
        for make, own, other in ((grid, "quads", "triangles"), (scenes.add_hole, "triangles", "quads")):
            made = shaped(addon, make())
            tool.start(made)
            assert settings.output == own and not settings.chosen
            for chosen in (other, own, other):
                settings.output = chosen
                assert settings.output == chosen
                count = {len(face) for face in made.fill.faces}
                assert count == ({4} if chosen == "quads" else {3})
            assert settings.chosen == other and tool.arguments(settings) == {"output": other}
            settings.output = own
            assert not settings.chosen and not tool.arguments(settings)
            tool.stop()
            bpy.ops.object.mode_set(mode="OBJECT")
    finally:
        settings.chosen = ""
        tool.stop()
