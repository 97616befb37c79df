"""The tool that shapes a hole: what gizmos and keys call. That they call it is tried in a window (tests/gui)."""

import copy
import sys
import types

import bmesh
import bpy
import numpy as np
import pytest
import scenes


@pytest.fixture
def shaping(addon):
    return sys.modules[addon.__name__ + ".shaping"]


@pytest.fixture
def view(addon):
    module = sys.modules[addon.__name__ + ".shaping_view"]
    yield module
    module.stop()


def begun(shaping, ob, *selected):
    (bm,) = scenes.edit(ob)
    bm.verts.ensure_lookup_table()
    scenes.select(bm, [bm.verts[k] for k in selected])
    return bm, shaping.from_selection(ob, bm)


def lattice_hole(shaping, **size):
    """A hole of three corners, its rim selected."""
    ob = scenes.add_hole(**size)
    (bm,) = scenes.edit(ob)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    return ob, bm, shaping.from_selection(ob, bm)


def test_it_starts_with_the_corners_that_the_rim_has(shaping):
    _, bm, made = lattice_hole(shaping)
    assert len(made.shape.corners) == 3 and not made.shape.round and made.shape.bulges == [1, 1, 1]
    gaps = np.diff([*made.shape.corners, made.shape.corners[0] + len(made.rim)])
    assert gaps.tolist() == [4, 4, 4]
    assert made.preview() and not made.refusal
    assert made.surface()[1].max() < len(made.surface()[0])


def test_isolated_selected_vertices_are_the_corners_two_or_more(shaping):
    for chosen in ([0, 12], [0, 8, 16], [0, 6, 12, 18]):
        _, made = begun(shaping, scenes.add_mesh(*scenes.ring()), *chosen)
        assert sorted(made.rim[k] for k in made.shape.corners) == chosen
        assert made.preview() is not None, made.refusal
        bpy.ops.object.mode_set(mode="OBJECT")


def test_a_rim_of_four_corners_has_four(shaping):
    ob = scenes.add_mesh(*scenes.square_hole())
    (bm,) = scenes.edit(ob)
    loop = scenes.border_loops(bm)[0]
    scenes.select_rim(bm, loop)
    made = shaping.from_selection(ob, bm)
    assert len(made.corners()) == len(made.side_handles()) == 4 and not made.shape.round
    at = {tuple(np.round(np.array(made.points[k], float), 5).tolist()) for k in made.corners()}
    square = [v for v in loop if len(v.link_faces) == 3]
    assert at == {tuple(np.round(np.array(v.co, float), 5).tolist()) for v in square}
    assert made.preview() is not None and made.fill.report.triangles_folded == 0
    made.set_bulge(2, 1.5)
    assert made.options()["bulge"] == (1, 1, 1.5, 1) and made.preview() is not None and made.refusal is None


def test_a_rim_without_corners_is_round_and_can_be_given_some(shaping):
    ob = scenes.add_mesh(*scenes.ring())
    (bm,) = scenes.edit(ob)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    made = shaping.from_selection(ob, bm)
    assert made.shape.round and made.corners() == [] and len(made.side_handles()) == 1
    assert made.preview().report.corners == []
    made.set_round(False)
    assert len(made.corners()) == 3 and len(made.shape.bulges) == 3
    gaps = np.diff([*made.corners(), made.corners()[0] + 24])
    assert gaps.tolist() == [8, 8, 8]
    made.add_corner(made.corners()[0] + 2)
    assert len(made.corners()) == 4 == len(made.shape.bulges)
    made.set_round(True)
    assert made.corners() == []


def test_a_corner_is_dragged_along_the_rim_but_not_past_another(shaping):
    _, _, made = lattice_hole(shaping)
    start = list(made.shape.corners)
    screen = made.points[:, :2] * 400 + 500
    target = (start[0] + 2) % 12
    place, apart = made.nearest_place(screen, screen[target] + 3)
    assert place == target and apart == pytest.approx(3 * np.sqrt(2))
    assert made.drag_corner(0, place) == target
    assert made.drag_corner(0, start[1]) == target and made.drag_corner(0, (start[1] + 1) % 12) == target
    assert made.nearest_place(screen, screen[start[1]], taken=[start[1]])[0] != start[1]
    screen[target] = np.nan
    assert made.nearest_place(screen, (0, 0))[0] != target, "what is behind the eye cannot be meant"


def test_escape_brings_back_what_was_before_the_drag(shaping):
    _, _, made = lattice_hole(shaping)
    made.preview()
    before, vertices = list(made.shape.corners), made.fill.vertices.copy()
    made.begin_drag()
    made.drag_corner(0, (before[0] + 1) % 12)
    made.set_bulge(1, 2.5)
    made.set_middle(0.1)
    made.preview()
    assert made.fill.vertices.shape != vertices.shape or np.abs(made.fill.vertices - vertices).max() > 1e-3
    made.cancel_drag()
    assert made.shape.corners == before and made.shape.bulges == [1, 1, 1] and made.shape.middle == 0
    assert (made.fill.vertices == vertices).all()


def test_changes_are_taken_back_and_made_again(shaping):
    _, _, made = lattice_hole(shaping)
    made.preview()
    assert not made.step(forward=False) and not made.step(forward=True)
    shapes = [copy.deepcopy(made.shape)]
    made.begin_drag()
    made.drag_corner(0, (made.shape.corners[0] + 1) % 12)
    made.end_drag()
    shapes.append(copy.deepcopy(made.shape))
    made.set_bulge(1, 2.5)  # an arrow that no timer has found at rest yet
    shapes.append(copy.deepcopy(made.shape))
    for shape in shapes[1::-1]:
        assert made.step(forward=False) and made.shape == shape
    assert not made.step(forward=False)
    for shape in shapes[1:]:
        assert made.step(forward=True) and made.shape == shape
    assert made.step(forward=False)
    made.set_round(True)
    assert not made.step(forward=True), "another change ends what could be made again"


def test_the_arrow_of_a_side_bulges_the_fill_at_that_side(shaping):
    _, _, made = lattice_hole(shaping, size=24, holes=((7, 7, 9),))
    made.preview()
    flat = made.fill.vertices.copy()
    for k in range(3):
        made.shape.bulges = [1.0] * 3
        made.set_bulge(k, 2)
        made.preview()
        moved = np.linalg.norm(made.fill.vertices - flat, axis=1)
        near = [np.argsort(np.linalg.norm(flat - p, axis=1))[:3] for _, p, _ in made.side_handles()]
        by_side = [moved[n].mean() for n in near]
        assert int(np.argmax(by_side)) == k, by_side
    made.set_bulge(0, -3)
    assert made.shape.bulges[0] > 0


def test_the_arrow_of_the_middle_moves_the_middle_along_its_normal(shaping):
    _, _, made = lattice_hole(shaping, size=24, holes=((7, 7, 9),))
    made.preview()
    at, normal = made.middle_handle()
    made.set_middle(0.1)
    made.preview()
    assert not made.refusal and made.middle_handle()[0] is at, "the handle stands still while its arrow is dragged"
    assert ((made.fill.vertices - at) @ normal).max() == pytest.approx(0.1, abs=0.02)


def test_what_is_shown_is_what_is_written_in_one_step_of_undo(shaping, view):
    ob, bm, made = lattice_hole(shaping)
    name = ob.name
    bpy.ops.ed.undo_push(message="before")
    before = scenes.state(name)
    view.start(shaping.from_selection(bpy.data.objects[name], bmesh.from_edit_mesh(bpy.data.objects[name].data)))
    made = view.current()
    made.set_bulge(0, 1.7)
    made.set_middle(0.05)
    made.preview()
    shown = made.fill.vertices
    assert scenes.state(name) == before, "the mesh is not touched"
    view.start(shaping.from_selection(bpy.data.objects[name], bmesh.from_edit_mesh(bpy.data.objects[name].data)))
    view.current().shape = made.shape
    assert bpy.ops.mesh.shape_fill_confirm("EXEC_DEFAULT", True) == {"FINISHED"}
    assert view.current() is None
    mesh = np.array([v.co for v in bmesh.from_edit_mesh(bpy.data.objects[name].data).verts])
    assert max(np.linalg.norm(mesh - p, axis=1).min() for p in shown) < 1e-6
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    bpy.ops.ed.undo()
    assert scenes.state(name)["vertices"] == before["vertices"]


def test_a_round_fill_is_written_without_corners(shaping, view):
    ob = scenes.add_mesh(*scenes.ring())
    (bm,) = scenes.edit(ob)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    assert bpy.ops.mesh.shape_fill() == {"FINISHED"}
    assert bpy.context.window_manager.tripatch_tool.round
    assert bpy.ops.mesh.shape_fill_confirm() == {"FINISHED"}
    assert len(scenes.border_loops(bmesh.from_edit_mesh(ob.data))) == 1


def test_leaving_it_leaves_the_mesh(shaping, view):
    ob, _, _ = lattice_hole(shaping)
    before = scenes.state(ob.name)
    assert bpy.ops.mesh.shape_fill() == {"FINISHED"} and view.current() is not None
    assert bpy.ops.mesh.shape_fill_cancel() == {"FINISHED"} and view.current() is None
    assert scenes.state(ob.name) == before
    assert not bpy.ops.mesh.shape_fill_confirm.poll() and view._state.handle is None


def test_a_mesh_that_has_changed_is_not_written_to(shaping, view):
    ob, bm, _ = lattice_hole(shaping)
    bpy.ops.mesh.shape_fill()
    loop = scenes.border_loops(bm)[0]
    loop[0].co.z += 0.1
    assert not view.current().is_current(bm)
    with pytest.raises(RuntimeError, match="The mesh has changed; choose the hole again"):
        bpy.ops.mesh.shape_fill_confirm()
    view._on_undo()
    assert view.current() is None


def test_a_click_means_the_nearest_rim_within_reach(shaping):
    points, faces, _ = scenes.lattice_parts(size=18, holes=((2, 2, 4), (9, 3, 4)))
    ob = scenes.add_mesh(scenes.bowl(points), faces)
    (bm,) = scenes.edit(ob)
    bm.verts.index_update()

    def screen(v):
        return v.co.x * 800, v.co.y * 800

    loops = scenes.border_loops(bm)[:2]
    for loop in loops:
        x, y = screen(loop[3])
        assert set(shaping.rims_at(bm, screen, (x + 2, y + 2)).loop) == set(loop)
    assert shaping.rims_at(bm, screen, (9000, 9000)) is None
    assert shaping.rims_at(bm, lambda v: None, (0, 0)) is None


def test_what_cannot_be_shaped_is_said(shaping):
    ob = scenes.add_mesh(scenes.bowl(scenes.lattice_parts()[0]), sum(scenes.lattice_parts()[1:], []))
    (bm,) = scenes.edit(ob, mode="FACE")
    scenes.select(bm, faces=list(bm.faces)[-4:])
    with pytest.raises(ValueError, match="delete the selected faces first|reach the border|borders"):
        shaping.from_selection(ob, bm)


def square_rim(shaping, height=lambda x, y: 0.2 * x * x - 0.1 * y * y):
    """Of a hole between four smooth sides."""
    steps = np.linspace(-2, 2, 25)
    points = np.array([(x, y, height(x, y)) for y in steps for x in steps])
    corners = [(25 * j + i, i, j) for j in range(24) for i in range(24) if not (8 <= i < 16 and 8 <= j < 16)]
    ob = scenes.add_mesh(points, [(k, k + 1, k + 26, k + 25) for k, _, _ in corners])
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bmesh.ops.delete(bm, geom=[v for v in bm.verts if not v.link_faces], context="VERTS")
    bm.to_mesh(ob.data)
    bm.free()
    (bm,) = scenes.edit(ob)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    return shaping.from_selection(ob, bm)


def wavy_rim(shaping):
    """The same, whose fill is no patch as long as nothing is asked of it."""
    return square_rim(shaping, lambda x, y: 0.4 * np.sin(1.5 * x) * np.cos(y))


def four_cornered_rim(shaping):
    """Of a round hole in a plane, with four corners: no vertex of it must be one, none that is not makes a patch fold."""
    angle, radii = np.arange(48) * np.pi / 24, np.linspace(1, 2, 7)
    points = np.array([(r * np.cos(a), r * np.sin(a), 0) for r in radii for a in angle])
    faces = [
        (48 * j + k, 48 * j + 48 + k, 48 * j + 48 + (k + 1) % 48, 48 * j + (k + 1) % 48) for j in range(6) for k in range(48)
    ]
    return begun(shaping, scenes.add_mesh(points, faces), 6, 18, 30, 42)[1]


def three_cornered_rim(shaping):
    made = round_rim(shaping)
    made.set_round(False)
    return made


def round_rim(shaping):
    return begun(shaping, scenes.add_mesh(*scenes.ring(80)), *range(80))[1]


def triangular_rim(shaping):
    return lattice_hole(shaping)[2]


def test_the_header_says_what_helps(view):
    ob = scenes.add_mesh(*scenes.square_hole())
    (bm,) = scenes.edit(ob)
    loop = scenes.border_loops(bm)[0]
    scenes.select_rim(bm, loop)
    loop[0].link_faces[0].normal_flip()
    bmesh.update_edit_mesh(ob.data)
    assert bpy.ops.mesh.shape_fill() == {"FINISHED"}
    assert view._state.problem.endswith("Mesh > Normals > Recalculate Outside turns them")


def test_a_rim_that_is_a_point_is_not_shaped(shaping):
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob)
    loop = scenes.border_loops(bm)[0]
    for v in loop[1:]:
        v.co = loop[0].co
    scenes.select_rim(bm, loop)
    with pytest.raises(shaping.UnusableError, match="All vertices of the hole are at the same place"):
        shaping.from_selection(ob, bm)


class Layout:
    """Takes down what a layout shows."""

    def __init__(self):
        self.said, self.popovers = [], []

    def column(self, **_given):
        return self

    def label(self, text):
        self.said.append(text)

    def popover(self, panel, text, icon):
        self.popovers.append((panel, text))


@pytest.mark.parametrize("region", ["UI", "TOOL_HEADER"])
def test_a_problem_can_be_read_in_whole(addon, view, region):
    """In the sidebar in lines; a header has one line, which a click on its beginning opens."""
    view._state.problem = problem = "The mesh folds back at the rim near vertex 17; " * 4 + "and so on"
    context, layout = types.SimpleNamespace(region=types.SimpleNamespace(type=region, width=300)), Layout()
    sys.modules[addon.__name__ + ".tool"]._draw_problem(context, layout)
    if region != "UI":
        ((name, text),) = layout.popovers
        assert not layout.said and len(text) < 50 and text[:30] == problem[:30]
        layout = types.SimpleNamespace(layout=Layout())
        getattr(bpy.types, name).draw(layout, context)
        layout = layout.layout
    assert " ".join(layout.said) == problem and max(map(len, layout.said)) < 70
    view.stop()


@pytest.mark.parametrize("pixels", [100, 200, 400, 2000])
@pytest.mark.parametrize("make", [lattice_hole, lambda shaping: square_rim(shaping)])
def test_arrows_of_the_sides_end_before_they_meet(shaping, make, pixels):
    """pixels: that the hole takes in the view."""
    made = make(shaping)
    made = made[-1] if isinstance(made, tuple) else made
    pixel, size = made.size / pixels, 75
    middle = made.points.mean(axis=0)
    for k, handle in enumerate(made.side_handles()):
        _, point, direction = handle
        length = made.shape.bulges[k] * shaping.ARROW * made.size  # where it begins
        length += shaping.arrow_scale(made.room(k, handle) / pixel, size) * size * pixel
        assert length < np.linalg.norm(middle - point)
    assert shaping.arrow_scale(float("nan"), size) == shaping.SMALL


def jagged_rim(shaping):
    """Of a hole that only the surface around it fills."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
    (bm,) = scenes.edit(bpy.context.object)
    bmesh.ops.delete(bm, geom=[f for f in bm.faces if f.calc_center_median().x > 0.8], context="FACES")
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    return shaping.from_selection(bpy.context.object, bm)


def ridge_rim(shaping):
    """Of a single edge's two triangles: the fill has no vertices."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
    (bm,) = scenes.edit(bpy.context.object)
    bm.edges.ensure_lookup_table()
    bmesh.ops.delete(bm, geom=list(bm.edges[7].link_faces), context="FACES_ONLY")
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    return shaping.from_selection(bpy.context.object, bm)


RIMS = [square_rim, wavy_rim, four_cornered_rim, three_cornered_rim, round_rim, triangular_rim, jagged_rim]


@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize("make", RIMS)
def test_while_dragging_what_is_shown_is_what_is_inserted_with_its_edges(shaping, view, make, output):
    made = make(shaping)
    made.set_arguments({"output": output})
    view.start(made)
    plain = made.fill.vertices.copy()
    view.bulge_handlers(0)[1](1.6 * shaping.ARROW * made.size)
    view.middle_handlers()[1](0.08 * made.size)
    view._rest()
    assert not made.refusal and made.is_shown
    vertices, _, edges = made.surface()
    assert plain.shape != made.fill.vertices.shape or np.abs(made.fill.vertices - plain).max() > 0.02 * made.size
    name = made.name
    before = len(bmesh.from_edit_mesh(bpy.data.objects[name].data).faces)
    assert bpy.ops.mesh.shape_fill_confirm("EXEC_DEFAULT") == {"FINISHED"}
    bm = bmesh.from_edit_mesh(bpy.data.objects[name].data)
    inserted = np.array([[tuple(v.co) for v in e.verts] for e in {e for f in bm.faces if f.select for e in f.edges}])
    assert len(bm.faces) == before + len(made.fill.faces)
    middles, lengths = vertices[edges].mean(axis=1), np.linalg.norm(np.diff(vertices[edges], axis=1)[:, 0], axis=1)
    found = inserted.mean(axis=1)
    nearest = np.linalg.norm(middles[:, None] - found[None], axis=2).argmin(axis=1)
    assert np.abs(found[nearest] - middles).max() < 1e-5 * made.size
    assert np.abs(np.linalg.norm(np.diff(inserted, axis=1)[nearest][:, 0], axis=1) - lengths).max() < 1e-5 * made.size


@pytest.mark.parametrize("make", [*RIMS, ridge_rim])
def test_a_handle_that_the_fill_does_not_follow_is_not_offered(shaping, make):
    made = make(shaping)
    made.preview()
    for option, change in (
        ("bulge", lambda: made.set_bulge(0, 1.6)),
        ("center_offset", lambda: made.set_middle(0.1 * made.size)),
    ):
        before, offered = made.fill.vertices.copy(), made.honors(option)
        change()
        made.preview()
        moved = len(before) > 0 and np.abs(made.fill.vertices - before).max() > 1e-3 * made.size
        assert offered == moved, option
    assert made.honors("bulge") == (make is not ridge_rim)


def test_a_fill_that_takes_long_is_made_when_the_handle_rests(shaping, view, monkeypatch):
    monkeypatch.setattr(view, "_PROMPT", 0.0)
    _, _, made = lattice_hole(shaping)
    view.start(made)
    shown = made.fill
    view.bulge_handlers(0)[1](0.3 * made.size)
    assert made.fill is shown and not made.is_shown and bpy.app.timers.is_registered(view._rest)
    view._rest()
    assert made.fill is not shown and made.is_shown
    view.stop()
    assert not bpy.app.timers.is_registered(view._rest)


def test_a_handle_that_is_set_again_to_what_it_is_makes_nothing_anew(shaping, view):
    _, _, made = lattice_hole(shaping)
    view.start(made)
    for _, put in (view.bulge_handlers(0), view.middle_handlers()):
        put(0.2 * made.size)
        view._rest()
        shown = made.fill
        if bpy.app.timers.is_registered(view._rest):
            bpy.app.timers.unregister(view._rest)
        put(float(np.float32(0.2 * made.size)))  # as Blender does in each drawing
        assert made.is_shown and made.fill is shown and not bpy.app.timers.is_registered(view._rest)
    view.stop()


@pytest.mark.parametrize("part", [0, 1, 2])
def test_a_click_on_the_label_of_a_side_changes_its_continuity_alone(shaping, part):
    _, _, made = lattice_hole(shaping)
    made.preview()
    assert made.continuities() == ["G1"] * 3
    seen = []
    for _ in shaping.CONTINUITIES:
        assert made.next_continuity(part)
        seen.append(made.continuities()[part])
        assert [each for k, each in enumerate(made.continuities()) if k != part] == ["G1", "G1"]
    assert seen[-1] == "G1" and "G0" in seen, "once around"


def test_a_side_without_tangency_has_a_kink_where_its_label_stands(shaping):
    _, _, made = lattice_hole(shaping)
    before = made.preview().rim_normals
    made.next_continuity(0)
    while made.continuities()[0] != "G0":
        assert made.next_continuity(0)
    turned = np.linalg.norm(made.fill.rim_normals - before, axis=1)
    rim = [made._positions[v] for v in made.fill.rim]
    at = [int(np.linalg.norm(rim - point, axis=1).argmin()) for _, point, _ in made.side_handles()]
    assert turned[at[0]] > 1e-5 > 1e-6 > max(turned[at[1:]])


def test_the_chosen_continuity_is_written_and_remembered(shaping, view):
    ob, _, made = lattice_hole(shaping)
    view.start(made)
    made.next_continuity(1)
    kept = made.continuities()
    assert bpy.ops.mesh.shape_fill_confirm() == {"FINISHED"}
    records = sys.modules[shaping.__name__.replace("shaping", "records")]
    properties = records.of_fill(ob.data, 1)["properties"]
    assert kept[1] in [properties[f"continuity_{k}"] for k in range(3)]


def test_a_round_hole_has_one_label(shaping):
    _, made = begun(shaping, scenes.add_mesh(*scenes.ring()), *range(24))
    made.preview()
    assert len(made.continuities()) <= 1
