"""Each row of the panel works on a hole, or is greyed with the reason; a row that is greyed changes nothing."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes
import test_smooth_fill as panel
import tripatch

smooth = bpy.ops.mesh.fill_smooth


def _cut(make, gone, mode="EDGE"):
    make()
    ob = bpy.context.object
    (bm,) = scenes.edit(ob, mode=mode)
    bmesh.ops.delete(bm, geom=[f for f in bm.faces if gone(f.calc_center_median())], context="FACES")
    bmesh.update_edit_mesh(ob.data)
    return ob


def grid_block():
    return _cut(lambda: bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16), lambda c: c.x > 0.8 and abs(c.z) < 0.5)


def jagged_ball():
    return _cut(lambda: bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4), lambda c: c.x > 0.8)


def open_tube():
    return _cut(lambda: bpy.ops.mesh.primitive_cylinder_add(vertices=24), lambda c: c.z > 0.9)


def three_sides():
    ob = scenes.add_hole(size=24, holes=((6, 6, 8),))
    scenes.edit(ob)
    return ob


def four_sides():
    ob = scenes.add_mesh(*scenes.square_hole())
    scenes.edit(ob)
    return ob


def cube_face():
    return _cut(bpy.ops.mesh.primitive_cube_add, lambda c: c.z > 0.9)


def cage():
    ob = grid_block()
    ob.modifiers.new("Subdivision", "SUBSURF")
    return ob


HOLES = [grid_block, jagged_ball, open_tube, three_sides, four_sides, cube_face, cage]
ROWS = {
    "bulge": 1.6,
    "tension": 3.0,
    "center_offset": 0.15,
    "continuity": "G0",
    "fairing": "none",
    "cross_boundary": "given",
    "pole_offset": (0.15, 0.1),
    "corner_offset": 1,
}


def filled(addon, make, **values):
    """The operator after a fill, and what the mesh is then."""
    state = panel.operator(addon, **values)
    ob = make()
    assert state.execute(bpy.context) == {"FINISHED"}, state.said
    bm = bmesh.from_edit_mesh(ob.data)
    bm.verts.index_update()
    mesh = np.array([v.co for v in bm.verts]), [[v.index for v in f.verts] for f in bm.faces]
    bpy.ops.object.mode_set(mode="OBJECT")
    return state, mesh


class Layout:
    """Takes down which rows are active, and the sentences; every fold is open."""

    def __init__(self, seen=None):
        self.seen, self.active = seen or {"rows": {}, "said": []}, True

    def row(self, **_given):
        return Layout(self.seen)

    column = box = split = grid_flow = row

    def panel(self, _name, default_closed):
        return self, self

    def label(self, text, icon=""):
        self.seen["said"].append(text)

    def prop(self, _operator, name, **_given):
        self.seen["rows"][name] = self.active

    def prop_enum(self, _operator, name, _value, text):
        self.seen["rows"][name] = self.active

    def operator(self, *_, **_given):
        raise AssertionError


def rows(state):
    """{row: whether it is active}, and what is said next to."""
    state.layout = Layout()
    state.draw(bpy.context)
    return state.layout.seen["rows"], " ".join(state.layout.seen["said"])


@pytest.mark.parametrize("name", ROWS)
@pytest.mark.parametrize("make", HOLES)
def test_a_row_works_or_is_greyed_with_the_reason_and_changes_nothing(addon, make, name):
    output = {"output": "quads"} if name == "pole_offset" and make is not cage else {}
    before, (plain, faces) = filled(addon, make, **output)
    active, said = rows(before)
    after, (points, other) = filled(addon, make, **output, **{name: ROWS[name]})
    # Blender 3 makes the same scene in another order
    same = set(map(frozenset, faces)) == set(map(frozenset, other)) and np.abs(plain - points).max() < 1e-12
    changed = plain.shape != points.shape or faces != other or np.abs(plain - points).max() > 1e-5
    if name == "continuity" and not changed:  # it was met in position only as it was
        changed = (
            filled(addon, make, continuity="G1")[1][0].shape != plain.shape or filled(addon, make, continuity="G1")[1][1] != faces
        )
    if active[name]:
        assert changed, f"{name} is active and changes nothing"
    else:
        assert same, f"{name} is greyed and changes the fill"
        label = {"cross_boundary": "Slopes", "pole_offset": "Pole", "center_offset": "Center", "corner_offset": "Slide Corners"}
        assert label.get(name, name.title()) + "" in said, said
        assert rows(after)[0][name] is False


@pytest.mark.parametrize("name", [n for n in ROWS if n not in ("pole_offset", "corner_offset", "continuity")])
@pytest.mark.parametrize("make", [h for h in HOLES if h is not cage])
def test_no_row_swaps_the_method(addon, make, name):
    def method(**options):
        ob = make()
        bpy.ops.object.mode_set(mode="OBJECT")
        mesh = ob.data
        points = np.array([v.co for v in mesh.vertices], float)
        faces = [tuple(p.vertices) for p in mesh.polygons]
        rim = min(tripatch.find_holes(faces), key=len)
        return tripatch.fill(points, faces, rim=rim, output="quads", **options).report.method

    value = None if ROWS[name] == "none" else ROWS[name]
    assert method(**{name: value}) == method()


@pytest.mark.parametrize("name", ["bulge", "tension", "center_offset", "continuity", "fairing", "cross_boundary", "individual"])
def test_what_shapes_one_hole_is_not_remembered_for_the_next(name):
    assert smooth.get_rna_type().properties[name].is_skip_save


def test_six_rows_before_the_folds(addon):
    for make in HOLES:
        state, _ = filled(addon, make)
        state.layout = panel.Layout(("none",))
        state.draw(bpy.context)
        names = {p.identifier for p in smooth.get_rna_type().properties}
        main = state.layout.shown[: state.layout.shown.index("Sides")]
        assert len([name for name in main if name in names]) <= 6


def test_the_choices_have_plain_words():
    properties = smooth.get_rna_type().properties
    assert [i.name for i in properties["output"].enum_items][0] == "Automatic" and properties["output"].default == "auto"
    assert properties["rows"].name == "Extra Rows"
    methods = {i.identifier: i.name for i in properties["method"].enum_items}
    assert [methods[n] for n in ("auto", "multi_sided", "polyharmonic_spline", "quad_rows")] == [
        "Automatic",
        "Patch",
        "Spline",
        "Quad Rows",
    ]
    assert methods["gordon_coons"] == "Gordon Coons (G0)" and methods["side_vertex"] == "Side Vertex (G1)"
    fairing = {i.identifier: i.name for i in properties["fairing"].enum_items}
    assert (fairing["auto"], fairing["isometric"], fairing["none"]) == ("On", "Isometric", "Off")


@pytest.mark.parametrize("method", tripatch.METHODS)
def test_scripts_still_name_every_method(method):
    identifiers = smooth.get_rna_type().properties["method"].enum_items.keys()
    assert method in identifiers or not tripatch.METHODS[method].fills_holes


def test_a_missing_face_of_a_cube_is_no_alarm(addon):
    state, _ = filled(addon, cube_face)
    ((kind, said),) = state.said
    assert kind == {"INFO"} and "deg" not in said.split(), said


def test_a_fill_up_to_sharp_edges_says_how_they_are_rounded(addon):
    said = panel.module(addon, "sentences").for_people(tripatch.messages.Message("flat_all_around"))
    assert said == "Filled flat up to the sharp edges; set Continuity: Tangent to round them"


def test_angles_have_the_sign_for_degrees(addon):
    state, _ = filled(addon, jagged_ball)
    assert "°" in state.said[0][1] and " deg" not in state.said[0][1]


def ear():
    """The inside of an ear: a cage of it that is pulled at would fold."""
    ob = _cut(bpy.ops.mesh.primitive_monkey_add, lambda c: False)
    bm = bmesh.from_edit_mesh(ob.data)
    gone = [f for f in bm.faces if f.calc_center_median().x > 1 and f.normal.y < -0.3 and 0 < f.calc_center_median().z < 0.5]
    bmesh.ops.delete(bm, geom=gone, context="FACES")
    scenes.select(bm, edges=[e for e in bm.edges if e.is_boundary and e.verts[0].co.x > 0.9])
    bmesh.update_edit_mesh(ob.data)
    ob.modifiers.new("Subdivision", "SUBSURF")
    return ob


@pytest.mark.parametrize("name, value", [("bulge", 1.5), ("tension", 0.4), ("center_offset", 0.1)])
def test_a_cage_without_corners_is_not_shaped(addon, name, value):
    before, (plain, faces) = filled(addon, ear)
    active, said = rows(before)
    assert active[name] is False and "only in patches between" in said
    after, (points, other) = filled(addon, ear, **{name: value})
    assert faces == other and np.abs(plain - points).max() < 1e-12
    assert "Bulge, tension and center have no effect" in after.said[-1][1]


def test_a_cage_between_corners_that_would_fold_if_pulled_at_stays_a_cage(addon):
    def sheet():
        ob = four_sides()
        ob.modifiers.new("Subdivision", "SUBSURF")
        return ob

    _, (plain, faces) = filled(addon, sheet)
    after, (points, other) = filled(addon, sheet, bulge=20.0)
    assert faces == other and np.abs(plain - points).max() < 1e-12
    active, said = rows(after)
    assert active["bulge"] is False and "the cage of this hole would fold or cross itself" in said
    assert "Filled without Bulge" in after.said[-1][1]


@pytest.mark.parametrize("make", [jagged_ball, three_sides, cage])
def test_the_candidates_of_a_fill_have_the_words_of_the_panel(addon, make):
    state, _ = filled(addon, make)
    used, *others = state.candidates.split("\n")
    assert used.startswith("used ") and len(others) > 1
    assert all(line.startswith(("made ", "skipped ", "refused ")) for line in others)
    assert not any(method in state.candidates for method in tripatch.METHODS)
