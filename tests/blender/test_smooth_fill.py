"""mesh.fill_smooth: where it is found, what its panel shows, and what becomes of a refusal by hand and from a script."""

import fnmatch
import importlib
import sys
import types
from pathlib import Path

import bmesh
import bpy
import numpy as np
import pytest
import scenes
import tripatch

smooth = bpy.ops.mesh.fill_smooth
ROOT = Path(__file__).parents[2]


def module(addon, name):
    return importlib.import_module(f"{addon.__name__}.{name}")


class Recorder:
    """Takes a layout's calls down: the operators in their order."""

    def __init__(self, operators=None):
        self.operators = [] if operators is None else operators

    def __getattr__(self, name):
        def call(*arguments, **_given):
            if name.startswith("operator") and name not in ("operator_context",):
                self.operators.append(arguments[0])
            return Recorder(self.operators)

        return call if name != "operator_context" else "INVOKE_DEFAULT"


def drawn(menu):
    layout = Recorder()
    getattr(bpy.types, menu).draw(types.SimpleNamespace(layout=layout, bl_owner_use_filter=False), bpy.context)
    return layout.operators


#: Menus of edit mode, and Blender's entry before ours where there is one that matters.
MENUS = {
    "VIEW3D_MT_edit_mesh_faces": None,
    "VIEW3D_MT_edit_mesh_context_menu": None,
    "VIEW3D_MT_edit_mesh_clean": "mesh.fill_holes",
}


@pytest.mark.parametrize("mode", ["VERT", "EDGE", "FACE"])
@pytest.mark.parametrize(("menu", "before"), MENUS.items())
def test_menus_have_it_once_at_their_end(menu, before, mode):
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode=mode)
    bm.faces.ensure_lookup_table()
    scenes.select(bm, faces=bm.faces[:3])
    bmesh.update_edit_mesh(ob.data)
    bpy.context.view_layer.update()
    names = drawn(menu)
    assert names.count("mesh.fill_smooth") == 1 and "mesh.fill_three_sided" not in names
    at = names.index("mesh.fill_smooth")
    assert names[at + 1 :] in ([], ["mesh.edit_fill", "mesh.smooth_triangles"])
    assert before in (None, names[at - 1])


def test_menus_are_only_added_to(addon):
    """Blender's own draw functions stay what they are, with the add-on and without it."""
    ui = module(addon, "ui")

    def functions():
        menus = [getattr(bpy.types, menu) for menu in MENUS]
        return {f for menu in menus for f in menu._dyn_ui_initialize() if not f.__module__.startswith(addon.__name__)}

    own = functions()
    assert len(own) == 3 and {f.__module__ for f in own} == {"bl_ui.space_view3d"}
    ui.unregister()
    try:
        assert functions() == own and not any("mesh.fill_smooth" in drawn(menu) for menu in MENUS)
    finally:
        ui.register()
    assert all("mesh.fill_smooth" in drawn(menu) for menu in MENUS)


@pytest.mark.parametrize("word", ["hole", "fill", "smooth"])
def test_the_search_finds_it_by_what_one_would_type(word):
    assert word in smooth.get_rna_type().name.lower()


@pytest.mark.parametrize("operator", ["mesh.fill_smooth", "mesh.shape_fill", "mesh.smooth_triangles", "object.apply_live_fill"])
def test_the_manual_has_a_page_on_every_operator(operator, addon):
    prefix, pages = module(addon, "links").manual_map()
    assert (prefix, pages) in [function() for function in bpy.utils._manual_map]
    page = next(page for pattern, page in pages if fnmatch.fnmatchcase(f"bpy.ops.{operator}", pattern))
    assert (ROOT / "docs" / page).with_suffix(".md").exists()


def test_links_are_the_same_where_blender_reads_them(addon):
    links, source = module(addon, "links"), Path(sys.modules[addon.__name__].__file__).read_text()
    assert f'"doc_url": "{links.GUIDE}"' in source and f'"tracker_url": "{links.BUGS}"' in source


def test_preferences_lead_to_the_documentation_and_to_reports_of_bugs(addon):
    ui, asked = module(addon, "ui"), []

    class Layout(Recorder):
        def operator(self, *_arguments, text="", **_given):
            button = types.SimpleNamespace()
            asked.append((text, button))
            return button

        def row(self):
            return self

        def label(self, **_given):
            pass

    ui.TripatchPreferences.draw(types.SimpleNamespace(layout=Layout()), bpy.context)
    links = module(addon, "links")
    own = [("Documentation", links.GUIDE), ("Report a Bug", links.BUGS)]  # until 4.1 Blender shows those of bl_info
    assert [(text, button.url) for text, button in asked] == (own if bpy.app.version >= (4, 2) else [])


def test_the_tool_has_an_icon_that_blender_can_read(addon):
    """A file of triangles as Blender's own: eight bytes, then 18 for each triangle."""
    path = Path(module(addon, "tool").TRIPATCH_TOOL_shape.bl_icon + ".dat")
    content = path.read_bytes()
    assert content[:4] == b"VCO\0" and len(content) > 8 and (len(content) - 8) % 18 == 0
    assert bpy.app.icons.new_triangles_from_file(str(path))


def test_the_name_of_before_is_the_same_operator():
    results = []
    for operator in (smooth, bpy.ops.mesh.fill_three_sided):
        ob = scenes.add_hole()
        scenes.edit(ob)
        assert operator(bulge=1.5, resolution=5) == {"FINISHED"}
        bpy.ops.object.mode_set(mode="OBJECT")
        results.append(np.array([v.co for v in ob.data.vertices]))
    np.testing.assert_array_equal(*results)
    names = [{p.identifier for p in operator.get_rna_type().properties} for operator in (smooth, bpy.ops.mesh.fill_three_sided)]
    assert names[0] == names[1]


def three_holes():
    """Rims of 9, 12 and 15 edges in one bowl."""
    points, faces = scenes.lattice(size=30, holes=((2, 2, 3), (12, 2, 4), (4, 14, 5)))
    return scenes.add_mesh(scenes.bowl(points), faces)


def border_lengths(ob):
    bpy.ops.object.mode_set(mode="OBJECT")
    bm = scenes.checked(ob)
    return [len(loop) for loop in scenes.border_loops(bm)]


@pytest.mark.parametrize(
    ("filters", "left"),
    [
        ({}, [90]),
        ({"max_edges": 12}, [15, 90]),
        ({"max_diameter": 0.11}, [12, 15, 90]),
        ({"corner_count": (4, 6)}, None),
        ({"corner_count": (3, 3)}, [90]),
        ({"max_edges": 12, "use_max_edges": False}, [90]),
        ({"outer": True, "max_edges": 60}, [90]),
    ],
)
@pytest.mark.parametrize("everything", [False, True])
def test_of_all_holes_those_that_the_filters_let_through(filters, left, everything):
    ob = three_holes()
    scenes.edit(ob)
    if everything:
        bpy.ops.mesh.select_all(action="SELECT")
    if left is None:
        with pytest.raises(RuntimeError, match="All 3 holes were excluded by your filters"):
            smooth(**filters)
        return
    assert smooth(**filters) == {"FINISHED"}
    assert border_lengths(ob) == left


def test_holes_that_the_filters_keep_out_are_selected_by_hand(addon):
    ob = three_holes()
    (bm,) = scenes.edit(ob)
    rims = {v.index for loop in scenes.border_loops(bm)[:-1] for v in loop}
    state = operator(addon, corner_count=(4, 6), use_corner_count=True)
    assert state.invoke(bpy.context, None) == {"FINISHED"}
    assert state.said == [({"WARNING"}, "All 3 holes were excluded by your filters")]
    assert {v.index for v in bmesh.from_edit_mesh(ob.data).verts if v.select} == rims


def pinched():
    """A bowl whose hole has two vertices at one place, its rim selected; and which vertices they are."""
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob)
    loop = scenes.border_loops(bm)[0]
    loop[5].co = loop[6].co
    scenes.select_rim(bm, loop)
    bmesh.update_edit_mesh(ob.data)
    return ob, {loop[5].index, loop[6].index}


HAND = {"by_hand": True}  # as `invoke` sets it, which Blender calls in a window only
EXACT = {"method": "side_vertex"}  # which refuses what others get over


def selected(ob):
    bmesh.from_edit_mesh(ob.data).verts.index_update()
    return {v.index for v in bmesh.from_edit_mesh(ob.data).verts if v.select}


def test_a_refusal_from_a_script_is_an_error_and_touches_nothing():
    ob, _ = pinched()
    before = selected(ob)
    with pytest.raises(RuntimeError, match="Merge > By Distance") as error:
        smooth(**EXACT)
    assert "Error: " in str(error.value)
    assert selected(ob) == before and len(before) == 12


def test_a_refusal_by_hand_selects_the_place_and_is_one_undo_step(capfd):
    ob, concerned = pinched()
    name, before = ob.name, selected(ob)
    points = np.array([v.co for v in bmesh.from_edit_mesh(ob.data).verts])
    bpy.ops.ed.undo_push(message="before")
    assert smooth("EXEC_DEFAULT", True, **EXACT, **HAND) == {"FINISHED"}
    told = capfd.readouterr().out
    assert "Warning: " in told and "Merge > By Distance" in told
    assert selected(ob) == concerned
    np.testing.assert_array_equal(points, [v.co for v in bmesh.from_edit_mesh(ob.data).verts])
    bpy.ops.ed.undo()
    assert selected(bpy.data.objects[name]) == before


@pytest.mark.parametrize("mode", ["EDGE", "FACE"])
def test_the_place_can_be_seen_in_every_mode(mode):
    ob, concerned = pinched()
    bpy.ops.mesh.select_mode(type=mode)
    bm = bmesh.from_edit_mesh(ob.data)
    scenes.select_rim(bm, scenes.border_loops(bm)[0]) if mode == "EDGE" else scenes.select(
        bm, faces={f for v in scenes.border_loops(bm)[0] for f in v.link_faces}
    )
    assert smooth(**EXACT, **HAND) == {"FINISHED"}
    assert selected(ob) == concerned
    bpy.context.tool_settings.mesh_select_mode = (True, False, False)


def test_what_a_refusal_names_is_selected_in_edge_mode_too():
    ob = scenes.add_mesh(*scenes.square_hole())
    (bm,) = scenes.edit(ob, mode="EDGE")
    loop = scenes.border_loops(bm)[0]
    scenes.select_rim(bm, loop)
    rim = {v.index for v in loop}
    assert smooth(**EXACT, **HAND) == {"FINISHED"}
    assert selected(ob) and selected(ob) <= rim  # its corners, which are too many
    bpy.context.tool_settings.mesh_select_mode = (True, False, False)


class Operator:
    """What draw and execute see of an operator, in place of Blender's; properties as keywords."""

    def __init__(self, cls, **values):
        rna = smooth.get_rna_type()
        object.__setattr__(self, "set", set(values))
        self.said = []
        self.properties = types.SimpleNamespace(is_property_set=lambda name: name in self.set, bl_rna=rna)
        for base in reversed(cls.__mro__):
            for name, function in vars(base).items():
                if isinstance(function, types.FunctionType):
                    object.__setattr__(self, name, types.MethodType(function, self))
        for prop in rna.properties:
            length = getattr(prop, "array_length", 0)
            object.__setattr__(self, prop.identifier, tuple(prop.default_array) if length else getattr(prop, "default", None))
        for name, value in values.items():
            object.__setattr__(self, name, value)
        object.__setattr__(self, "report", lambda kind, text: self.said.append((kind, text)))

    def __setattr__(self, name, value):
        object.__setattr__(self, name, value)
        self.set.add(name)


def operator(addon, **values):
    return Operator(module(addon, "operators").MESH_OT_fill_smooth, **values)


class Layout:
    """Takes down what is shown; `panels` as from Blender 4.1 on."""

    def __init__(self, panels, shown=None, inside=""):
        self.shown = [] if shown is None else shown
        self._inside, self._panels = inside, panels
        if panels:
            self.panel = lambda name, default_closed: (self.row(), self if name in panels else None)

    def row(self, **_given):
        return Layout(self._panels, self.shown, self._inside)

    column = box = split = grid_flow = row

    def label(self, text, icon=""):
        self.shown.append(text)

    def prop(self, data, name, **_given):
        assert hasattr(data, name)
        self.shown.append(name)

    def prop_enum(self, _data, name, _value, text):
        if name not in self.shown:
            self.shown.append(name)


def shown(state, panels=("none",)):
    state.layout = Layout(panels)
    state.draw(bpy.context)
    return state.layout.shown


FOLDS = ("Sides", "Subdivision", "Advanced", "Paper Methods")


def test_six_rows_are_seen_before_anything_is_opened(addon):
    scenes.edit(scenes.add_hole())
    for output, density in (("triangles", "resolution"), ("quads", "rows"), ("cage", "rows")):
        rows = shown(operator(addon, output=output))
        assert rows == ["output", density, "continuity", "bulge", "tension", "center_offset", *FOLDS]
        rows = shown(operator(addon, output=output), panels=())  # Blender 3
        assert rows[:6] == ["output", density, "continuity", "bulge", "tension", "center_offset"]
        assert rows[6:] == ["show_sides", "show_subdivision", "show_advanced", "show_papers"]


def test_a_tolerance_that_nothing_has_computed_is_not_shown(addon):
    scenes.edit(scenes.add_hole())
    for tolerance in (0, 0.01):
        rows = shown(operator(addon, output="triangles", tolerance=tolerance), panels=("TRIPATCH_subdivision",))
        assert ("tolerance" in rows) == bool(tolerance) and "cage_rim" in rows


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"method": "polyharmonic_spline", "continuity": "G2"}, "Spline does not take Continuity"),
        ({"method": "polyharmonic_spline", "output": "cage"}, "Spline makes no cages; choose another method"),
        ({"use_corner_count": True, "corner_count": (6, 2)}, "Corners must be the smallest and the largest"),
    ],
)
def test_options_that_do_not_go_together_are_said_and_can_be_changed(addon, options, said):
    """Whoever chooses them in the panel reads why, and can choose others."""
    ob = scenes.add_hole()
    scenes.edit(ob)
    with pytest.raises(RuntimeError, match=f"Error: {said}"):
        smooth(**options)
    state = operator(addon, **options)
    assert state.invoke(bpy.context, None) == {"FINISHED"}
    assert state.reasons.startswith(said) and state.said[0][0] == {"WARNING"}
    assert len(border_lengths(ob)) == 2


SPLINE = "polyharmonic_spline"


@pytest.mark.parametrize(
    ("method", "options", "said"),
    [
        ("gordon_coons", {"continuity": "G1"}, "Gordon Coons supports continuity G0"),
        (SPLINE, {"cross_boundary": "given"}, "Spline does not take Slopes"),
        (SPLINE, {"shape": (0.3, 0.5, 0.5)}, "Shape is an option of Szilvasi Nagy C0, Szilvasi Nagy C1, not of Spline"),
        (SPLINE, {"optimal_shape": True}, "Shape is an option of"),
        ("side_vertex", {"symmetric": True}, "Symmetric is an option of Coons Extremal"),
    ],
)
def test_what_a_method_does_not_take_is_an_error_of_a_script_and_nothing_where_the_panel_hides_it(addon, method, options, said):
    ob = scenes.add_hole()
    scenes.edit(ob)
    with pytest.raises(RuntimeError, match=f"Error: {said}"):
        smooth(method=method, **options)
    faces = len(bmesh.from_edit_mesh(ob.data).faces)
    state = operator(addon, method=method, **options)
    assert state.invoke(bpy.context, None) == {"FINISHED"}
    assert len(bmesh.from_edit_mesh(ob.data).faces) > faces and state.reasons == ""
    assert not [text for _, text in state.said if said[:12] in text]


def test_what_is_not_applied_is_said_of_what_was_chosen_only(addon):
    scenes.edit(scenes.add_hole())
    of_another = {"method": "gordon_coons", "bulge": 2.0}
    for options, said in (
        ({"symmetric": True}, "Symmetric has no effect: it is an option of Coons Extremal"),
        (of_another, "Gordon Coons ignores Bulge"),
        (of_another | {"by_hand": True}, ""),  # the panel greys it
        ({}, ""),
    ):
        state = operator(addon, **options)
        assert state.execute(bpy.context) == {"FINISHED"}
        (kind, text) = state.said[-1]
        assert (said in text) and kind == ({"WARNING"} if said else {"INFO"})
        bpy.ops.object.mode_set(mode="OBJECT")
        scenes.edit(scenes.add_hole())


def test_what_is_said_of_several_holes_is_said_once_with_their_names(addon):
    ob = three_holes()
    bm = scenes.checked(ob)
    rims = sorted(min(v.index for v in loop) for loop in scenes.border_loops(bm)[:3])
    scenes.edit(ob)
    state = operator(addon, symmetric=True, output="triangles")
    assert state.execute(bpy.context) == {"FINISHED"}
    ((_, text),) = state.said
    assert text.count("has no effect") == 1
    named = text.split("3 holes at vertices ")[1].split(":")[0].replace(" and", ",")
    assert sorted(map(int, named.split(", "))) == rims


def test_folded_parts_open(addon):
    scenes.edit(scenes.add_hole())
    state = operator(addon, show_advanced=True, show_papers=True, all_holes=True, show_holes=True)
    rows = shown(state, panels=())
    assert {
        "method",
        "fairing",
        "cross_boundary",
        "features",
        "shading",
        "max_edges",
        "max_diameter",
        "corner_count",
        "outer",
    } <= set(rows)
    assert "max_edges" in shown(operator(addon, all_holes=True), panels=("TRIPATCH_holes",))
    assert "max_edges" not in shown(operator(addon, all_holes=False, show_holes=True), panels=())


@pytest.mark.parametrize("sides", [2, 3, 5, 14])
def test_a_row_for_every_side_that_the_fill_has_counted_from_one(addon, sides):
    scenes.edit(scenes.add_hole())
    rows = shown(operator(addon, sides=sides, individual=True), panels=("TRIPATCH_sides",))
    assert [name for name in rows if name.startswith("continuity_")] == [f"continuity_{i}" for i in range(min(sides, 12))]
    properties = smooth.get_rna_type().properties
    assert [properties[f"continuity_{i}"].name for i in range(12)] == [f"Side {i + 1}" for i in range(12)]


def test_reasons_stand_in_the_panel_in_whole(addon):
    pinched()
    state = operator(addon, **EXACT)
    assert state.invoke(bpy.context, None) == {"FINISHED"}
    (said,) = state.said
    assert said[0] == {"WARNING"}
    rows = shown(state)
    reason = rows[: rows.index("output")]
    assert " ".join(reason) == state.reasons == said[1]
    assert max(map(len, reason)) < 60


def test_what_was_computed_is_shown_and_computed_anew(addon):
    """Density is 0 nowhere in the panel; Shift R on another object chooses again what was automatic and keeps what was chosen."""
    state = operator(addon)
    scenes.edit(scenes.add_hole(holes=((3, 3, 4),)))
    assert state.execute(bpy.context) == {"FINISHED"}
    assert (state.resolution, state.output, state.faces()) == (4, "auto", "triangles")
    bpy.ops.object.mode_set(mode="OBJECT")
    scenes.edit(scenes.add_hole(size=24, holes=((5, 5, 9),)))
    assert state.execute(bpy.context) == {"FINISHED"}
    assert state.resolution == 9
    state.resolution = 5  # by hand
    bpy.ops.object.mode_set(mode="OBJECT")
    ob = scenes.add_hole(size=24, holes=((5, 5, 9),))
    scenes.edit(ob)
    assert state.execute(bpy.context) == {"FINISHED"}
    assert state.resolution == 5
    bpy.ops.object.mode_set(mode="OBJECT")
    ob = scenes.add_hole()
    ob.modifiers.new("Subdivision", "SUBSURF")
    scenes.edit(ob)
    assert state.execute(bpy.context) == {"FINISHED"}
    assert state.faces() == "cage" and state.rows >= 0
    assert len(state.said) == 4


def test_cages_and_quads_show_their_rows(addon):
    for output in ("quads", "cage"):
        state = operator(addon, output=output)
        scenes.edit(scenes.add_hole(size=20, holes=((4, 4, 6),)))
        assert state.execute(bpy.context) == {"FINISHED"}
        assert 0 <= state.rows <= 4
        count = len(bmesh.from_edit_mesh(bpy.context.object.data).faces)
        bpy.ops.object.mode_set(mode="OBJECT")
        again = operator(addon, output=output, rows=state.rows)
        scenes.edit(scenes.add_hole(size=20, holes=((4, 4, 6),)))
        assert again.execute(bpy.context) == {"FINISHED"}
        assert len(bmesh.from_edit_mesh(bpy.context.object.data).faces) == count
        bpy.ops.object.mode_set(mode="OBJECT")


def test_the_tolerance_that_is_used_is_shown(addon):
    """A thousandth of the hole's diameter, of each hole again; what was chosen stays."""
    state = operator(addon, output="quads")
    for scale in (1.0, 3.0):
        ob = scenes.add_hole()
        ob.scale = (scale,) * 3
        bpy.context.view_layer.update()
        (bm,) = scenes.edit(ob)
        loop = [np.array(v.co) for v in scenes.border_loops(bm)[0]]
        widest = max(np.linalg.norm(a - b) for a in loop for b in loop)
        assert state.execute(bpy.context) == {"FINISHED"}
        assert state.tolerance == pytest.approx(1e-3 * scale * widest, rel=1e-5)
        bpy.ops.object.mode_set(mode="OBJECT")
    state.tolerance = 0.5
    scenes.edit(scenes.add_hole())
    assert state.execute(bpy.context) == {"FINISHED"}
    assert state.tolerance == 0.5


def test_a_hole_that_gets_no_cage_is_filled_with_quads_and_says_so(addon):
    """Where nobody asked for a cage by name; who did reads what hinders it."""
    for output in ({}, {"output": "cage"}):
        vertices, faces = scenes.ring()
        vertices[:24:2, :2] *= 0.2  # a star: a cage would fold
        ob = scenes.add_mesh(vertices, faces)
        ob.modifiers.new("Subdivision", "SUBSURF")
        state = operator(addon, **output)
        (bm,) = scenes.edit(ob)
        scenes.select(bm, list(bm.verts)[:24])
        assert state.execute(bpy.context) == ({"FINISHED"} if not output else {"CANCELLED"})
        ((kind, sentence),) = state.said
        assert kind == ({"WARNING"} if not output else {"ERROR"})
        assert ("quads instead of a cage" in sentence) == (not output)
        assert len(border_lengths(ob)) == (1 if not output else 2)
        bpy.ops.object.mode_set(mode="OBJECT")


def test_a_round_rim_under_a_subdivision_modifier_gets_a_cage(addon):
    ob = scenes.add_mesh(*scenes.ring())
    ob.modifiers.new("Subdivision", "SUBSURF")
    state = operator(addon)
    (bm,) = scenes.edit(ob)
    scenes.select(bm, list(bm.verts)[:24])
    assert state.execute(bpy.context) == {"FINISHED"}
    ((kind, sentence),) = state.said
    assert kind == {"INFO"} and "with a cage of 36 quads" in sentence
    assert len(border_lengths(ob)) == 1
    bpy.ops.object.mode_set(mode="OBJECT")


def test_sides_and_corners_count_from_one_in_sentences(addon):
    for_people = module(addon, "sentences").for_people
    message = tripatch.messages.Message
    said = for_people(message("corner_planes_differ", {"angle": 9.0, "spread": 12.0, "corner": 2}, [7]))
    assert "at corner 3" in said
    said = for_people(message("method_lacks_options", {"method": "polyharmonic_spline", "options": ["center_offset", "tension"]}))
    assert said == "Spline does not take Center, Tension"
    assert "Recalculate Outside" in for_people(message("faces_flipped", {}, [3]))


def test_every_property_says_what_one_will_see(addon):
    for prop in smooth.get_rna_type().properties:
        if prop.identifier == "rna_type" or prop.is_hidden:
            continue
        assert prop.description and not prop.description.endswith(".")
        for word in ("functional", "barycentric", "Wachspress", "paper", "lambda", "thin-plate"):
            assert word not in prop.description, prop.identifier


def test_an_active_vertex_on_a_rim_with_other_corners_than_three():
    ob = scenes.add_mesh(*scenes.square_hole())
    (bm,) = scenes.edit(ob)
    loop = scenes.border_loops(bm)[0]
    scenes.select_rim(bm, loop)
    bm.select_history.add(loop[1])
    assert smooth() == {"FINISHED"}
    assert len(border_lengths(ob)) == 1


def registered(addon):
    """What Blender knows of the add-on."""
    classes = {
        name for name in dir(bpy.types) if str(getattr(getattr(bpy.types, name), "__module__", "")).startswith(addon.__name__)
    }
    handlers = {
        f"{kind}: {function.__name__}"
        for kind in dir(bpy.app.handlers)
        if isinstance(functions := getattr(bpy.app.handlers, kind), list)
        for function in functions
        if str(getattr(function, "__module__", "")).startswith(addon.__name__)
    }
    of_data = {
        f"{kind}.{prop.identifier}"
        for kind in ("WindowManager", "Scene", "Object", "Mesh", "Screen", "WorkSpace")
        for prop in getattr(bpy.types, kind).bl_rna.properties
        if "tripatch" in prop.identifier.lower()
    }
    menus = {
        f"{name}: {function.__name__}"
        for name in dir(bpy.types)
        for function in getattr(getattr(getattr(bpy.types, name), "draw", None), "_draw_funcs", ())
        if str(getattr(function, "__module__", "")).startswith(addon.__name__)
    }
    return classes | handlers | of_data | menus


def test_removed_it_leaves_nothing_behind(addon):
    import sys

    path = list(sys.path)
    before = registered(addon)
    assert before
    addon.unregister()
    try:
        assert registered(addon) == set()
        assert not hasattr(bpy.types, "MESH_OT_fill_smooth")
    finally:
        addon.register()
    assert registered(addon) >= before and sys.path == path


def sheet_with_holes(*middles, size=20):
    """A curved sheet of quads with square holes; returns the object."""
    bm = bmesh.new()
    bmesh.ops.create_grid(bm, x_segments=size, y_segments=size, size=2)
    for v in bm.verts:
        v.co.z = 0.2 * v.co.x**2 - 0.1 * v.co.y**2

    def missing(face):
        x, y, _ = face.calc_center_median()
        return any(max(abs(x - a), abs(y - b)) < 0.45 for a, b in middles)

    bmesh.ops.delete(bm, geom=[f for f in bm.faces if missing(f)], context="FACES")
    mesh = bpy.data.meshes.new("Sheet")
    bm.to_mesh(mesh)
    bm.free()
    return scenes.object_of(mesh)


def borders(ob):
    return [len(loop) for loop in scenes.border_loops(bmesh.from_edit_mesh(ob.data))]


def test_an_island_selected_as_a_whole_is_filled_inside_not_around():
    one, other = sheet_with_holes((0, 0)), sheet_with_holes((0.5, 0.5))
    other.location.x = 6
    for ob in (one, other):
        ob.select_set(True)
    bpy.ops.object.join()
    ob = bpy.context.object
    (bm,) = scenes.edit(ob, mode="FACE")
    middle = (min(v.co.x for v in bm.verts) + max(v.co.x for v in bm.verts)) / 2
    scenes.select(bm, faces=[f for f in bm.faces if f.calc_center_median().x < middle])
    around = sorted(borders(ob))
    assert smooth() == {"FINISHED"}
    assert sorted(borders(ob)) == around[1:], "one hole of two is filled, both outer borders are left"


def test_an_outer_border_that_is_selected_by_itself_is_filled():
    ob = sheet_with_holes((0, 0))
    (bm,) = scenes.edit(ob, mode="EDGE")
    scenes.select_rim(bm, scenes.border_loops(bm)[-1])
    smooth()
    assert len(borders(ob)) == 1


def border_edges(bm, loop, count):
    """The first edges of a border loop."""
    return [bm.edges.get(pair) for pair in zip(loop[:count], loop[1 : count + 1], strict=True)]


@pytest.mark.parametrize("mode", ["VERT", "EDGE"])
@pytest.mark.parametrize("count", [1, 2, 14, 78])
def test_a_part_of_a_border_is_refused_and_not_widened_to_all_of_it(count, mode, addon):
    ob = sheet_with_holes((0, 0))
    (bm,) = scenes.edit(ob, mode=mode)
    scenes.select(bm, edges=border_edges(bm, scenes.border_loops(bm)[-1], count))
    faces = len(bm.faces)
    with pytest.raises(RuntimeError, match=f"has only {count} of the border's 80 edges; select all of them"):
        smooth()
    selection = sys.modules[f"{addon.__name__}.selection"]
    _, (reason,) = selection.selected_rims(bm, selection.Selected(bm))
    assert reason.code == "part_of_border" and {v for v in bm.verts if v.select} == set(reason.vertices)
    assert len(bmesh.from_edit_mesh(ob.data).faces) == faces and borders(ob)[-1] == 80


def test_a_part_of_the_border_of_a_hole_is_refused_too():
    ob = sheet_with_holes((0, 0))
    (bm,) = scenes.edit(ob, mode="EDGE")
    hole = scenes.border_loops(bm)[0]
    scenes.select(bm, edges=border_edges(bm, hole, 3))
    with pytest.raises(RuntimeError, match=f"has only 3 of the border's {len(hole)} edges"):
        smooth()


def test_beside_a_whole_border_a_part_of_another_is_reported(capfd):
    ob = sheet_with_holes((0, 0))
    (bm,) = scenes.edit(ob, mode="EDGE")
    hole, *_, outer = scenes.border_loops(bm)
    scenes.select(bm, edges=border_edges(bm, outer, 5))
    scenes.select_rim(bm, hole)
    assert smooth() == {"FINISHED"} and borders(ob) == [80]
    assert "1 not filled: The selection has only 5 of the border's 80 edges" in capfd.readouterr().out


def test_a_vertex_of_an_outer_border_does_not_close_it():
    ob = sheet_with_holes((0, 0))
    (bm,) = scenes.edit(ob)
    scenes.select(bm, scenes.border_loops(bm)[-1][:1])
    assert smooth() == {"CANCELLED"} and borders(ob)[-1] == 80


@pytest.mark.parametrize("selected", [False, True])
def test_of_several_objects_one_without_a_hole_keeps_its_outer_border(selected):
    holed, whole = sheet_with_holes((0, 0)), sheet_with_holes()
    scenes.edit(holed, whole)
    if selected:
        bpy.ops.mesh.select_all(action="SELECT")
    assert smooth() == {"FINISHED"}
    assert (borders(holed), borders(whole)) == ([80], [80])


@pytest.mark.parametrize("selected", [False, True])
@pytest.mark.parametrize("bent", [0.0, 0.2])
def test_a_sheet_without_a_hole_is_not_closed_onto_itself(selected, bent, capfd):
    ob = sheet_with_holes()
    for v in ob.data.vertices:
        v.co.z = bent * (v.co.x**2 - v.co.y**2)
    scenes.edit(ob)
    bpy.ops.mesh.select_all(action="SELECT" if selected else "DESELECT")
    before = len(ob.data.polygons)
    capfd.readouterr()
    assert smooth() == {"CANCELLED"}, "nothing to fill is no mistake"
    sentence = "Info: Nothing to fill: 1 outer border left open (80 edges); use Outer Borders to fill it"
    assert capfd.readouterr().out.strip() == sentence
    assert len(bmesh.from_edit_mesh(ob.data).faces) == before
    bpy.ops.mesh.select_all(action="DESELECT")
    assert smooth(outer=True) == {"FINISHED"} and borders(ob) == []
    assert ("flat sheet" in capfd.readouterr().out) == (not bent)


def test_outer_borders_that_are_left_open_are_reported(capfd):
    """Of two islands with a hole each."""
    ob = sheet_with_holes((0, 0))
    other = sheet_with_holes((0.5, 0.5), size=12)
    other.location.x = 6
    for each in (ob, other):
        each.select_set(True)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.join()
    scenes.edit(ob)
    capfd.readouterr()
    assert smooth() == {"FINISHED"} and borders(ob) == [48, 80]
    said = capfd.readouterr().out
    assert "Info: " in said and "; 2 outer borders left open (48 and 80 edges); use Outer Borders to fill them" in said


@pytest.mark.parametrize("selected", [False, True])
def test_of_several_objects_each_is_filled_with_what_suits_it(selected, addon, capfd):
    """One of quads, one of triangles, one under a Subdivision modifier, one without a hole."""
    quads, triangles, caged, whole = (sheet_with_holes(*holes) for holes in (((0, 0),), ((0, 0),), ((0, 0),), ()))
    scenes.edit(triangles)
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.quads_convert_to_tris()
    bpy.ops.object.mode_set(mode="OBJECT")
    caged.modifiers.new("Subdivision", "SUBSURF")
    bms = scenes.edit(quads, triangles, caged, whole)
    sizes = [len(bm.faces) for bm in bms]
    if selected:
        bpy.ops.mesh.select_all(action="SELECT")
    capfd.readouterr()
    assert smooth() == {"FINISHED"}
    corners = [[len(f.verts) for f in list(bm.faces)[size:]] for bm, size in zip(bms, sizes, strict=True)]
    assert [set(each) for each in corners] == [{4}, {3}, {4}, set()]
    said = capfd.readouterr().out
    assert "with a cage of" in said and "seam within" in said and "4 outer borders left open" in said


def test_a_bowl_without_another_border_is_closed():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=16)
    ob = bpy.context.object
    (bm,) = scenes.edit(ob)
    bmesh.ops.delete(bm, geom=[f for f in bm.faces if f.calc_center_median().z > 0], context="FACES")
    bmesh.update_edit_mesh(ob.data)
    bpy.ops.mesh.select_all(action="DESELECT")
    assert smooth() == {"FINISHED"} and borders(ob) == []


def test_beside_a_refusal_no_value_stands_that_says_nothing(addon):
    pinched()
    for output in ("triangles", "quads"):
        state = operator(addon, **(EXACT | {"output": output}))
        assert state.invoke(bpy.context, None) == {"FINISHED"} and state.reasons
        rows = shown(state, panels=("TRIPATCH_subdivision",))
        assert "output" in rows and not {"resolution", "rows", "tolerance"} & set(rows)


def test_how_well_a_patch_is_known_is_not_told_as_known():
    ob = scenes.add_hole()
    before = len(ob.data.vertices)
    scenes.edit(ob)
    assert smooth(method="side_vertex", fairing="none", deviation=True, resolution=6) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    values = np.array([each.value for each in ob.data.attributes["deviation"].data])
    assert (values == -1).sum() == len(values) - before > 0 and not values[values != -1].any()


def test_a_visible_hole_is_filled_while_another_is_hidden():
    ob = sheet_with_holes((-1, 0), (1, 0))
    (bm,) = scenes.edit(ob, mode="VERT")
    scenes.select(bm, [v for v in bm.verts if v.is_boundary and -1.8 < v.co.x < 0 and abs(v.co.y) < 0.8])
    bpy.ops.mesh.hide()
    assert len(borders(ob)) == 3
    assert smooth() == {"FINISHED"}
    left = scenes.border_loops(bmesh.from_edit_mesh(ob.data))
    assert len(left) == 2 and all(v.hide for v in left[0])


def remembered(addon, **values):
    """Blender remembers the properties of the last call from a menu, and says that none of them is set."""
    state = operator(addon, computed_output="triangles", computed_resolution=9, **values)
    state.properties.is_property_set = lambda _name: False
    scenes.edit(scenes.add_hole(holes=((3, 3, 4),)))
    assert state.execute(bpy.context) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    return state


def test_what_was_chosen_stays_for_the_next_call_from_a_menu(addon):
    assert remembered(addon, output="quads").output == "quads"
    assert remembered(addon, output="triangles", resolution=7).resolution == 7
    assert remembered(addon, output="triangles", resolution=9).resolution == 4  # was computed, and is computed again
