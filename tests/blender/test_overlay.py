"""What the overlay shows of a mesh, when it makes that again, and that nothing is left of it when it is off."""

import re
import sys
from types import SimpleNamespace

import bmesh
import bpy
import numpy as np
import pytest
import scenes

NOT_KNOWN = "No deviation is known of this mesh; fill with Advanced > Deviation"


@pytest.fixture
def overlay(addon):
    module = sys.modules[addon.__name__ + ".overlay"]
    sys.modules[addon.__name__ + ".seam"].forget()
    yield module
    module.stop()


@pytest.fixture
def shown(addon):
    return sys.modules[addon.__name__ + ".shown"]


def settings(**given):
    usual = {"surface": "ZEBRA", "seam": True, "folds": False, "seam_most": 1.0, "fixed_range": False}
    return SimpleNamespace(**(usual | {"curvature": 1.0, "deviation": 1.0} | given))


def seen(shown, ob, **given):
    return shown.of_object(ob, bpy.context.evaluated_depsgraph_get(), settings(**given))


def filled(**options):
    ob = scenes.add_hole()
    scenes.edit(ob)
    assert bpy.ops.mesh.fill_three_sided(**options) == {"FINISHED"}
    return ob


def test_the_seam_of_the_last_fill_is_measured_in_both_modes(overlay, shown):
    ob = filled()
    in_edit_mode = seen(shown, ob)
    bpy.ops.object.mode_set(mode="OBJECT")
    made = seen(shown, ob)
    assert len(made.lines) == len(in_edit_mode.lines) == 2 * 12
    assert made.worst[1] < 1 and made.told == in_edit_mode.told
    assert made.told[0].startswith("Seam within")


def test_a_half_that_is_filled_on_a_mirror_has_its_seam(overlay, shown):
    import tasks

    ob = tasks.on_the_mirror_plane().ob
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
    made = seen(shown, ob)
    assert len(made.lines) > 0 and made.worst[1] < 5


def test_where_another_modifier_adds_faces_no_other_edges_count_as_the_seam(overlay, shown):
    ob = filled()
    ob.modifiers.new("Array", "ARRAY")
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 2
    assert "No seam" in seen(shown, ob).told[0]


def test_an_edit_of_the_fill_shows_in_its_seam(overlay, shown):
    ob = filled(resolution=4)
    bm = scenes.bmesh.from_edit_mesh(ob.data)
    inside = [v for v in bm.verts if all(f.select for f in v.link_faces)]
    for v in inside:
        v.co.z += 0.05
    scenes.bmesh.update_edit_mesh(ob.data)
    assert seen(shown, ob).worst[1] > 20


def test_under_a_subdivision_modifier_the_seam_is_that_of_the_surface(overlay, shown):
    ob = filled(output="quads", surroundings="mesh")
    bpy.ops.object.mode_set(mode="OBJECT")
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 2
    made = seen(shown, ob)
    assert len(made.lines) == 2 * 12 * 4
    assert made.worst[1] < 1


def test_without_a_fill_the_selected_edges_are_the_seam(overlay, shown):
    ob = scenes.add_mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1)], [(0, 1, 2, 3), (1, 0, 4, 5)])
    (bm,) = scenes.edit(ob, mode="EDGE")
    scenes.select(bm, edges=[e for e in bm.edges if {v.index for v in e.verts} == {0, 1}])
    made = seen(shown, ob)
    assert made.worst[1] == pytest.approx(90, abs=1e-3)
    assert made.line_colors[0, 0] > made.line_colors[0, 2], "red"


def test_where_everything_is_selected_no_seam_is_meant(overlay, shown):
    bpy.ops.mesh.primitive_cube_add()
    assert seen(shown, bpy.context.object).told == ["No seam: fill a hole, or select edges"]


def test_curvature_is_in_units_of_the_scene(overlay, shown):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1, segments=48, ring_count=24, scale=(2, 2, 2))
    made = seen(shown, bpy.context.object, surface="CURVATURE", seam=False)
    low, high = (float(word) for word in re.findall(r"[-\d.]+\d", made.told[0]))
    assert low == -high and high == pytest.approx(0.5, rel=0.02)
    assert (made.colors[:, 0] > 0.7).mean() > 0.9, "a ball is red, as it bulges everywhere"


def test_a_mirrored_object_bulges_as_the_one_it_mirrors(overlay, shown):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
    bpy.context.object.scale = (-1, 1, 1)
    bpy.context.view_layer.update()
    made = seen(shown, bpy.context.object, seam=False)
    assert ((made.positions * made.normals).sum(axis=1) > 0.9).all()
    colored = seen(shown, bpy.context.object, surface="CURVATURE", seam=False)
    assert (colored.colors[:, 0] > 0.7).all()


def test_deviation_is_the_attribute_of_that_name(overlay, shown):
    ob = scenes.add_hole()
    assert NOT_KNOWN in seen(shown, ob, surface="DEVIATION").told
    values = np.linspace(0, 0.25, len(ob.data.vertices)).astype(np.float32)
    ob.data.attributes.new("deviation", "FLOAT", "POINT")
    ob.data.update()
    assert NOT_KNOWN in seen(shown, ob, surface="DEVIATION").told, "nothing was written into it"
    attribute = ob.data.attributes["deviation"]
    attribute.data.foreach_set("value", values)
    ob.data.update()
    made = seen(shown, ob, surface="DEVIATION")
    assert "Deviation up to 0.25 (red from 0.25)" in made.told
    order = np.argsort(made.colors[:, 0] - made.colors[:, 2])
    assert made.colors[order[0], 2] > 0.8 and made.colors[order[-1], 0] > 0.8
    assert not np.isclose(made.colors[:, :3], 0.75).all(axis=1).any()
    values[ob.data.polygons[0].vertices[0]] = -1  # as a fill writes what it does not know
    attribute.data.foreach_set("value", values)
    ob.data.update()
    made = seen(shown, ob, surface="DEVIATION")
    assert "Deviation up to 0.25 (red from 0.25), gray: unknown at " in " ".join(made.told)
    assert np.isclose(made.colors[:, :3], 0.75).all(axis=1).any()


def test_folds_are_red_also_over_stripes(overlay, shown):
    flap = scenes.add_mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.3, 0.3, 0.01), (-1, 0, 0)], [(0, 1, 2), (2, 1, 3), (0, 2, 4)])
    for surface in ("ZEBRA", "NONE"):
        made = seen(shown, flap, surface=surface, folds=True, seam=False)
        assert made.told == ["2 folded triangles"]
        assert made.colors[:, 3].tolist() == [1] * 6 + [0] * 3 and made.colors[0, 0] == 1


def test_what_has_no_faces_is_not_shown(overlay, shown):
    assert seen(shown, scenes.add_mesh([(0, 0, 0), (1, 0, 0)], [])) is None


def test_a_surface_object_is_shown(overlay, shown):
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    made = seen(shown, bpy.context.object)
    assert len(made.positions) > 100 and np.isfinite(made.normals).all()


def handlers():
    return {name: len(getattr(bpy.app.handlers, name)) for name in ("depsgraph_update_post", "load_pre", "load_post")}


def test_off_it_leaves_nothing(overlay):
    before, wm = handlers(), bpy.context.window_manager.tripatch_overlay
    wm.show = True
    assert wm.show and handlers() != before
    wm.show = True
    wm.show = False
    assert not wm.show and handlers() == before
    assert not overlay._state.handles and not overlay._state.drawn


def test_only_what_has_changed_is_made_anew(overlay, monkeypatch):
    made = []
    monkeypatch.setattr(overlay, "Drawn", lambda shown, turn: SimpleNamespace(made=shown, turn=turn))
    monkeypatch.setattr(overlay.shown, "of_object", lambda ob, *_: made.append(ob.name) or SimpleNamespace(told=[]))
    first, second = scenes.add_hole(), scenes.add_hole()
    first.name, second.name = "first", "second"

    def frame():
        graph = bpy.context.evaluated_depsgraph_get()
        for ob in (first, second):
            overlay._drawn(ob, graph, settings())
        overlay._state.changed.clear()

    overlay.start()
    bpy.context.view_layer.update()
    frame()
    frame()
    assert made == ["first", "second"]
    second.data.vertices[0].co.z += 1
    second.data.update()
    bpy.context.view_layer.update()
    frame()
    assert made == ["first", "second", "second"]
    first.location.x = 3  # goes into the matrix of the shader
    bpy.context.view_layer.update()
    frame()
    assert made == ["first", "second", "second"]
    first.scale.x = 3
    bpy.context.view_layer.update()
    frame()
    assert made == ["first", "second", "second", "first"]


def test_another_file_and_a_changed_setting_empty_the_card(overlay):
    overlay.start()
    overlay._state.drawn["gone"] = False
    bpy.context.window_manager.tripatch_overlay.surface = "CURVATURE"
    assert not overlay._state.drawn
    overlay._state.drawn["gone"] = False
    overlay._on_load()
    assert not overlay._state.drawn
    bpy.context.window_manager.tripatch_overlay.surface = "ZEBRA"


def sheet_with_a_ridge(hole):
    """Quads over a roof; hole: of a face's middle. In edit mode with the hole's rim selected."""
    bm = bmesh.new()
    bmesh.ops.create_grid(bm, x_segments=16, y_segments=16, size=2)
    for v in bm.verts:
        v.co.z = -1.2 * abs(v.co.y)
    bmesh.ops.delete(bm, geom=[f for f in bm.faces if hole(f.calc_center_median())], context="FACES")
    mesh = bpy.data.meshes.new("Roof")
    bm.to_mesh(mesh)
    bm.free()
    ob = scenes.object_of(mesh)
    (bm,) = scenes.edit(ob, mode="EDGE")
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    return ob


def told_number(sentence):
    return float(re.search(r"[Ss]eam within ([\d.]+)°", sentence)[1])


@pytest.mark.parametrize("moved", [False, True])
def test_overlay_and_status_bar_tell_the_same_angle_until_the_seam_moves(shown, capfd, moved):
    """A side of the hole lies on the ridge, where old and new faces meet at an angle as they did before."""
    ob = sheet_with_a_ridge(lambda c: abs(c.x) < 0.8 and 0 < c.y < 1)
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
    status = told_number(capfd.readouterr().out)
    if moved:
        bm = bmesh.from_edit_mesh(ob.data)
        max((v for v in bm.verts if v.select), key=lambda v: v.co.y).co.z += 0.3
        bmesh.update_edit_mesh(ob.data)
    made = seen(shown, ob)
    overlay = told_number(made.told[0])
    assert status < 0.1 and (overlay > 5 if moved else overlay == status)
    assert made.worst[1] == pytest.approx(overlay, abs=0.001 + 0.05 * overlay)


def test_a_ridge_along_a_seam_is_not_red_where_it_goes_on(shown):
    ob = sheet_with_a_ridge(lambda c: abs(c.x) < 0.8 and 0 < c.y < 1)
    bpy.ops.mesh.fill_smooth()
    colors = seen(shown, ob).line_colors
    assert (colors[:, 2] > colors[:, 0]).all(), "blue, as where there is no angle"
