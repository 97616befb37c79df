"""The tool that shapes a hole: what gizmos and keys call. That they call it is tried in a window (tests/gui)."""

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
def tool(addon):
    module = sys.modules[addon.__name__ + ".tool"]
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
    made.preview(quick=True)
    assert made.fill.vertices.shape != vertices.shape or np.abs(made.fill.vertices - vertices).max() > 1e-3
    made.cancel_drag()
    assert made.shape.corners == before and made.shape.bulges == [1, 1, 1] and made.shape.middle == 0
    assert (made.fill.vertices == vertices).all()


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
    for quick in (True, False):
        made.set_middle(0.1)
        made.preview(quick)
        assert not made.refusal
        moved = made.middle_handle()[0] + 0.1 * made.middle_handle()[1]
        assert (moved - at) @ normal == pytest.approx(0.1, abs=0.02)


def test_what_is_shown_is_what_is_written_in_one_step_of_undo(shaping, tool):
    ob, bm, made = lattice_hole(shaping)
    name = ob.name
    bpy.ops.ed.undo_push(message="before")
    before = scenes.state(name)
    tool.start(shaping.from_selection(bpy.data.objects[name], bmesh.from_edit_mesh(bpy.data.objects[name].data)))
    made = tool.current()
    made.set_bulge(0, 1.7)
    made.set_middle(0.05)
    made.preview()
    shown = made.fill.vertices
    assert scenes.state(name) == before, "the mesh is not touched"
    tool.start(shaping.from_selection(bpy.data.objects[name], bmesh.from_edit_mesh(bpy.data.objects[name].data)))
    tool.current().shape = made.shape
    assert bpy.ops.mesh.shape_fill_confirm("EXEC_DEFAULT", True) == {"FINISHED"}
    assert tool.current() is None
    mesh = np.array([v.co for v in bmesh.from_edit_mesh(bpy.data.objects[name].data).verts])
    assert max(np.linalg.norm(mesh - p, axis=1).min() for p in shown) < 1e-6
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    bpy.ops.ed.undo()
    assert scenes.state(name)["vertices"] == before["vertices"]


def test_a_round_fill_is_written_without_corners(shaping, tool):
    ob = scenes.add_mesh(*scenes.ring())
    (bm,) = scenes.edit(ob)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    assert bpy.ops.mesh.shape_fill() == {"FINISHED"}
    assert bpy.context.window_manager.tripatch_tool.round
    assert bpy.ops.mesh.shape_fill_confirm() == {"FINISHED"}
    assert len(scenes.border_loops(bmesh.from_edit_mesh(ob.data))) == 1


def test_leaving_it_leaves_the_mesh(shaping, tool):
    ob, _, _ = lattice_hole(shaping)
    before = scenes.state(ob.name)
    assert bpy.ops.mesh.shape_fill() == {"FINISHED"} and tool.current() is not None
    assert bpy.ops.mesh.shape_fill_cancel() == {"FINISHED"} and tool.current() is None
    assert scenes.state(ob.name) == before
    assert not bpy.ops.mesh.shape_fill_confirm.poll() and tool._state.handle is None


def test_a_mesh_that_has_changed_is_not_written_to(shaping, tool):
    ob, bm, _ = lattice_hole(shaping)
    bpy.ops.mesh.shape_fill()
    loop = scenes.border_loops(bm)[0]
    loop[0].co.z += 0.1
    assert not tool.current().is_current(bm)
    with pytest.raises(RuntimeError, match="The mesh has changed; choose the hole again"):
        bpy.ops.mesh.shape_fill_confirm()
    tool._on_undo()
    assert tool.current() is None


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


@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize("make", [triangular_rim, square_rim, round_rim])
def test_while_dragging_the_fill_is_the_one_that_is_made_at_the_end_without_reading_the_mesh_again(
    shaping, make, output, monkeypatch
):
    made = make(shaping)
    made.arguments = {"output": output}
    made.preview()
    fill = shaping.tripatch.fill
    for change in (lambda: made.set_bulge(0, 1.4), lambda: made.set_middle(0.05 * made.size)):
        change()
        monkeypatch.setattr(shaping.tripatch, "fill", None)
        made.preview(quick=True)
        shown, surface = made.vertices, made.surface()[0]
        monkeypatch.setattr(shaping.tripatch, "fill", fill)
        normals = made.normals
        assert not made.refusal and (surface[-len(shown) :] == shown).all()
        other = make(shaping) if bpy.ops.object.mode_set(mode="OBJECT") else None
        other.arguments, other.shape = {"output": output}, made.shape
        other.preview()
        assert other.fill.report.method == made.fill.report.method
        exact = other.fill.patch.evaluate(shaping.writeback.parameters(made.fill)[1])
        assert np.abs(shown - exact).max() < 1e-5 * made.size
        assert np.abs(np.linalg.norm(normals, axis=1) - 1).max() < 1e-9


def test_while_corners_are_dragged_the_method_is_not_looked_for_again(shaping, monkeypatch):
    made, methods = four_cornered_rim(shaping), []
    fill = shaping.tripatch.fill

    def watched(*arguments, **given):
        methods.append(given.get("method", "auto"))
        return fill(*arguments, **given)

    monkeypatch.setattr(shaping.tripatch, "fill", watched)
    made.preview()
    taken = made.fill.report.method
    assert taken == "multi_sided"
    made.begin_drag()
    for _ in range(2):
        made.drag_corner(0, made.shape.corners[0] + 1)
        made.preview(quick=True)
        assert not made.refusal and made.fill.report.method == taken
    made.end_drag()
    assert methods == ["auto", taken, taken, "auto"]
    made.set_bulge(0, 1.3)
    made.preview(quick=True)
    assert methods[-1] in ("auto", taken) and not made.refusal


@pytest.mark.parametrize("make", [triangular_rim, square_rim, round_rim])
@pytest.mark.parametrize("by_bulge", [True, False])
def test_most_steps_of_a_drag_make_no_fill_and_show_what_lies_between_two(shaping, make, by_bulge, monkeypatch):
    made = make(shaping)
    made.preview()
    put = (lambda v: made.set_bulge(0, 1 + v)) if by_bulge else (lambda v: made.set_middle(v * made.size))
    patch, fill, count = shaping.tripatch.patch, shaping.tripatch.fill, []
    put(0.5)
    made.preview(quick=True)  # a spline is not shaped: then the patch is
    put(0.0)
    made.preview(quick=True)
    monkeypatch.setattr(shaping.tripatch, "patch", lambda *a, **k: count.append(0) or patch(*a, **k))
    monkeypatch.setattr(shaping.tripatch, "fill", lambda *a, **k: count.append(0) or fill(*a, **k))
    shown = []
    for step in range(1, 21):
        put(0.01 * step)
        made.preview(quick=True)
        shown.append(made.vertices.copy())
        assert not made.refusal
    assert len(count) <= (3 if by_bulge else 6), "a fill for each of a few steps"
    monkeypatch.undo()
    knots = 10 if by_bulge else 5  # steps from one fill to the next
    put(0.01 * 2 * knots)
    other = make(shaping) if bpy.ops.object.mode_set(mode="OBJECT") else None
    other.shape = made.shape
    other.preview()
    truth = other.fill.patch.evaluate(shaping.writeback.parameters(made.fill)[1])
    assert np.abs(shown[2 * knots - 1] - truth).max() < 1e-5 * made.size
    first, last = shown[knots - 1], shown[2 * knots - 1]
    assert np.abs(shown[knots + 1] - ((1 - 2 / knots) * first + 2 / knots * last)).max() < 1e-6 * made.size
    assert np.abs(shown[-1] - shown[0]).max() > 1e-2 * made.size


@pytest.mark.parametrize("make", [square_rim, wavy_rim])
def test_a_step_that_moves_the_middle_makes_one_patch_at_most(shaping, make, monkeypatch):
    made = make(shaping)
    made.preview()
    assert (made.fill.report.method == "multi_sided") == (make is square_rim)
    patch, fill, patches = shaping.tripatch.patch, shaping.tripatch.fill, []
    monkeypatch.setattr(shaping.tripatch, "patch", lambda *a, **k: patches.append(1) or patch(*a, **k))
    # a fill makes one patch, and another where its middle is to be moved
    monkeypatch.setattr(
        shaping.tripatch, "fill", lambda *a, **k: patches.append(2 if k.get("center_offset") else 1) or fill(*a, **k)
    )
    most, shown = 0, []
    for step in (1, 2, 3, 4, 11):
        patches.clear()
        made.set_middle(0.01 * step * made.size)
        made.preview(quick=True)
        most = max(most, sum(patches))
        shown.append(made.vertices)
        assert not made.refusal
    assert most == 1
    moved = [np.linalg.norm(shown[k] - shown[2], axis=1).max() / made.size for k in (3, 4)]
    assert moved == pytest.approx([0.01, 0.08], rel=0.1)


def test_arrows_change_nothing_where_the_patch_between_the_corners_would_fold(shaping, monkeypatch):
    made, fill, fills = square_rim(shaping), shaping.tripatch.fill, []
    made.drag_corner(0, made.shape.corners[0] + 2)  # along a side, which has a corner in it now
    made.preview()
    assert made.fill.report.method == "polyharmonic_spline"
    shown = made.vertices
    monkeypatch.setattr(shaping.tripatch, "fill", lambda *a, **k: fills.append(k["method"]) or fill(*a, **k))
    monkeypatch.setattr(shaping.tripatch, "patch", None)
    made.begin_drag()
    for step in range(1, 6):
        made.set_bulge(0, 1 + 0.2 * step)
        made.preview(quick=True)
        assert made.vertices is shown
    made.end_drag()
    assert fills == ["multi_sided"], "what the sides are is asked once"
    monkeypatch.undo()
    made.preview()  # what is written at the end
    assert np.abs(made.vertices - shown).max() < 1e-9 * made.size


def test_corners_are_dragged_with_the_method_of_before_after_arrows_that_changed_nothing(shaping, monkeypatch):
    made, fill, methods = square_rim(shaping), shaping.tripatch.fill, []
    made.drag_corner(0, made.shape.corners[0] + 2)
    made.preview()
    made.begin_drag()
    made.set_bulge(0, 1.5)
    made.preview(quick=True)
    made.end_drag()
    monkeypatch.setattr(shaping.tripatch, "fill", lambda *a, **k: methods.append(k.get("method")) or fill(*a, **k))
    made.begin_drag()
    for _ in range(2):
        made.drag_corner(0, made.shape.corners[0] + 1)
        made.preview(quick=True)
    assert methods == ["polyharmonic_spline"] * 2


def test_where_no_energy_serves_arrows_shape_the_plain_patch(shaping, monkeypatch):
    made = triangular_rim(shaping)
    made.drag_corner(0, made.shape.corners[0] + 3)
    made.preview()
    report = made.fill.report
    assert made.fill.sides and not report.fairing and report.energy_after == report.energy_before > 0
    patch, asked = shaping.tripatch.patch, []
    monkeypatch.setattr(shaping.tripatch, "patch", lambda *a, **k: asked.append(k["fairing"]) or patch(*a, **k))
    made.set_bulge(0, 1.3)
    made.preview(quick=True)
    assert asked == [None] * len(asked) and asked


def surface_triangles(made):
    vertices, triangles = made.surface()
    return np.asarray(vertices)[triangles]


@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize("make", [three_cornered_rim, four_cornered_rim])
def test_a_step_of_a_corner_shows_the_patch_all_over_without_its_mesh(shaping, make, output):
    made = make(shaping)
    made.arguments = {"output": output}
    made.preview()
    made.begin_drag()
    made.drag_corner(0, made.shape.corners[0] + 1)
    made.preview(quick=True)
    assert made.fill.sides and not made.fill.report.folds
    edges = made.surface()[1][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    border = edges[~(edges[:, None] == edges[None, :, ::-1]).all(axis=2).any(axis=1)]
    assert sorted(border[:, 0]) == sorted(made.fill.rim), "closed up to the rim"
    triangles = surface_triangles(made)
    areas = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    assert areas.min() > 0
    exact = shaping.tripatch.fill(
        made._positions, made._faces, rim=made._loop, corners=[made._loop[k] for k in made.corners()], fairing=None,
        method=made.fill.report.method,
    )  # fmt: skip
    assert np.abs(exact.patch.evaluate(made._net.places) - made.vertices).max() < 1e-9 * made.size
    point, normal = made.middle_handle()
    assert np.linalg.norm(point - made.vertices[-1]) < 1e-12 and np.linalg.norm(normal) == pytest.approx(1)


@pytest.mark.parametrize("in_rows", [True, False])
def test_where_the_patch_between_dragged_corners_folds_the_spline_is_shown_at_once(shaping, in_rows, monkeypatch):
    made, fill, asked = square_rim(shaping), shaping.tripatch.fill, []
    if not in_rows:  # as round a rim that no point sees all of
        monkeypatch.setattr(shaping._Net, "of_rows", classmethod(lambda *_: None))
    monkeypatch.setattr(shaping.tripatch, "fill", lambda *a, **k: asked.append(k.get("method", "auto")) or fill(*a, **k))
    made.preview()
    made.begin_drag()
    for _ in range(2):
        made.drag_corner(0, made.shape.corners[0] + 1)
        made.preview(quick=True)
        assert made.fill.report.method == "polyharmonic_spline" and not made.refusal
        assert np.isfinite(surface_triangles(made)).all() and len(made.vertices) > 20
    assert asked == ["auto", "multi_sided", *["polyharmonic_spline"] * (2 if in_rows else 3)]
    shown = made.vertices
    made.end_drag()
    assert made.fill.report.method == "polyharmonic_spline"
    apart = np.linalg.norm(shown[:, None] - made.fill.vertices[None], axis=2).min(axis=1).max()
    assert apart < 0.15 * made.size, "what is made at the end"


def test_other_corners_are_read_anew(shaping):
    made = square_rim(shaping)
    made.preview()
    before = made.fill
    made.drag_corner(0, made.shape.corners[0] + 1)
    made.preview(quick=True)
    assert made.fill is not before


def test_the_header_says_what_helps(tool):
    ob = scenes.add_mesh(*scenes.square_hole())
    (bm,) = scenes.edit(ob)
    loop = scenes.border_loops(bm)[0]
    scenes.select_rim(bm, loop)
    loop[0].link_faces[0].normal_flip()
    bmesh.update_edit_mesh(ob.data)
    assert bpy.ops.mesh.shape_fill() == {"FINISHED"}
    assert tool._state.problem.endswith("Mesh > Normals > Recalculate Outside turns them")


def test_a_fill_of_plain_triangles_is_shown_as_they_are(shaping):
    """It has no surface of which rows could be shown while a corner is dragged."""
    fill = square_rim(shaping).preview()
    assert shaping._Net.of_rows(fill, 1000) is not None
    plain = types.SimpleNamespace(patch=None, sides=[], uv=fill.uv, feature_edges=[], rim=fill.rim)
    for name in ("rim_uv", "rim_barycentric", "barycentric"):
        setattr(plain, name, getattr(fill, name))
    assert shaping._Net.of_rows(plain, 1000) is None


def test_a_rim_that_is_a_point_is_not_shaped(shaping):
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob)
    loop = scenes.border_loops(bm)[0]
    for v in loop[1:]:
        v.co = loop[0].co
    scenes.select_rim(bm, loop)
    with pytest.raises(shaping.UnusableError, match="All vertices of the rim are at the same place"):
        shaping.from_selection(ob, bm)


class Layout:
    """Takes down what a layout is told to show."""

    def __init__(self):
        self.said, self.popovers = [], []

    def column(self, **_given):
        return self

    def label(self, text):
        self.said.append(text)

    def popover(self, panel, text, icon):
        self.popovers.append((panel, text))


@pytest.mark.parametrize("region", ["UI", "TOOL_HEADER"])
def test_a_problem_can_be_read_in_whole(tool, region):
    """In the sidebar in lines; a header has one line, which a click on its beginning opens."""
    tool._state.problem = problem = "The mesh folds back at the rim near vertex 17; " * 4 + "and so on"
    context, layout = types.SimpleNamespace(region=types.SimpleNamespace(type=region, width=300)), Layout()
    tool._draw_problem(context, layout)
    if region != "UI":
        ((name, text),) = layout.popovers
        assert not layout.said and len(text) < 50 and text[:30] == problem[:30]
        layout = types.SimpleNamespace(layout=Layout())
        getattr(bpy.types, name).draw(layout, context)
        layout = layout.layout
    assert " ".join(layout.said) == problem and max(map(len, layout.said)) < 70
    tool.stop()


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


def test_when_an_arrow_rests_the_fill_itself_is_shown(shaping, tool):
    _, _, made = lattice_hole(shaping)
    tool.start(made)
    for handlers, values in ((tool.bulge_handlers(0), (0.1, 0.12)), (tool.middle_handlers(), (0.01, 0.02))):
        for value in values:
            handlers[1](value * made.size)
            assert bpy.app.timers.is_registered(tool._settle)
        tool._settle()
        drawn = made.surface()[0].copy()
        made.preview()
        assert drawn.shape == made.surface()[0].shape and np.array_equal(drawn, made.surface()[0])
    tool.stop()
    assert not bpy.app.timers.is_registered(tool._settle)
