"""The options of single methods in the panels, in the operators and without a window."""

import importlib
import types

import bpy
import numpy as np
import pytest
import scenes
import tripatch

VALUES = {  # of an operator; of a command; of tripatch.fill
    "bulge": ({"bulge": 1.5}, ["--bulge", "1.5"], {"bulge": 1.5}),
    "cross_boundary": ({"cross_boundary": "given"}, ["--cross-boundary", "given"], {"cross_boundary": "given"}),
    "shape": ({"shape": (0.25, 0.5, 0.75)}, ["--shape", "0.25,0.5,0.75"], {"shape": (0.25, 0.5, 0.75)}),
    "optimal": ({"optimal_shape": True}, ["--shape", "optimal"], {"shape": "optimal"}),
    "reading": (None, ["--reading", "as_printed"], {"reading": "as_printed"}),
    "symmetric": ({"symmetric": True}, ["--symmetric"], {"symmetric": True}),
    "alpha": ({"permanence": True, "alpha": 0.125}, ["--alpha", "0.125"], {"alpha": 0.125}),
}
CONTROLS = {
    "tension": ({"tension": 2.0}, ["--tension", "2"], {"tension": 2}),
    "center_offset": ({"center_offset": 0.125}, ["--center-offset", "0.125"], {"center_offset": 0.125}),
    "free": ({"continuity": "Free"}, ["--continuity", "Free"], {"continuity": "Free"}),
    "individual": (
        {"individual": True, "continuity_1": "Free", "continuity_2": "G0", "bulge_0": 1.5, "continuity": "G0", "bulge": 3},
        ["--continuity", "auto,Free,G0", "--bulge", "1.5,1,1"],
        {"continuity": ("auto", "Free", "G0"), "bulge": (1.5, 1, 1)},
    ),
}
VALUES |= CONTROLS
CASES = [
    (method, name)
    for method, about in tripatch.METHODS.items()
    if method not in ("quad_rows", "annulus")
    for name in about.options
] + [
    ("szilvasi_nagy_c0", "optimal"),
    ("szilvasi_nagy_c1", "optimal"),
    *(("side_vertex", name) for name in CONTROLS),
]


def add_uneven_hole():
    """A hole without symmetry: otherwise some options change nothing."""
    ob = scenes.add_hole(lambda p: np.column_stack([p, np.sin(3 * p[:, 0] + 1) * np.cos(2 * p[:, 1]) + 0.5 * p[:, 0] ** 3]))
    ob.name = "A"
    return ob


def new_points(ob, before):
    bpy.ops.object.mode_set(mode="OBJECT")
    return np.array([v.co for v in ob.data.vertices])[before:]


def expected(ob, method, options):
    vertices = np.array([v.co for v in ob.data.vertices])
    faces = [list(p.vertices) for p in ob.data.polygons]
    rim = min(tripatch.find_holes(faces), key=len)
    return tripatch.fill(vertices, faces, rim=rim, method=method, **options).vertices


@pytest.mark.parametrize(("method", "name"), [case for case in CASES if VALUES[case[1]][0]])
def test_the_operator_hands_them_on(method, name):
    ob = add_uneven_hole()
    count = len(ob.data.vertices)
    own, _, options = VALUES[name]
    wanted, plain = expected(ob, method, options), expected(ob, method, {})
    scenes.edit(ob)
    assert bpy.ops.mesh.fill_three_sided(method=method, **own) == {"FINISHED"}
    points = new_points(ob, count)
    np.testing.assert_allclose(points, wanted, atol=2e-6)
    assert wanted.shape != plain.shape or np.abs(wanted - plain).max() > 1e-5


@pytest.mark.parametrize("name", VALUES)
def test_so_does_the_command_line(addon, tmp_path, name):
    ob = add_uneven_hole()
    count = len(ob.data.vertices)
    method = next(m for m, of in CASES if of == name)
    _, arguments, options = VALUES[name]
    wanted = expected(ob, method, options)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "in.blend"))
    command_line = importlib.import_module(addon.__name__ + ".command_line")
    assert command_line.main(["--method", method, *arguments, "--out", str(tmp_path / "out.blend")]) == 0
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "out.blend"))
    np.testing.assert_allclose(new_points(bpy.data.objects["A"], count), wanted, atol=2e-6)


class Layout:
    """Takes down what is shown, with whether it is greyed; every folded part is open."""

    def __init__(self, shown=None):
        self.shown, self.active = {} if shown is None else shown, True

    def row(self, **_given):
        return Layout(self.shown)

    split = grid_flow = row

    def panel(self, _name, default_closed):
        return self, self

    def label(self, text, icon=""):
        pass

    def column(self, **_given):
        return Layout(self.shown)

    def prop(self, operator, name, **_given):
        assert hasattr(operator, name)
        assert name not in self.shown, "twice"
        self.shown[name] = self.active

    def prop_enum(self, _operator, name, value, text):
        assert (name, value) not in self.shown, "twice"
        self.shown[name] = self.shown[name, value] = self.active


def drawn(addon, between=False, **values):
    """{property: whether it is active} in the panel of an operator."""
    kind = ("between_patches", "OBJECT_OT_fill_between_patches") if between else ("operators", "MESH_OT_fill_smooth")
    operator = getattr(importlib.import_module(f"{addon.__name__}.{kind[0]}"), kind[1])
    rna = (bpy.ops.object.fill_between_patches if between else bpy.ops.mesh.fill_smooth).get_rna_type()
    stub = types.SimpleNamespace(layout=Layout(), properties=types.SimpleNamespace(bl_rna=rna), sides=3)
    for base in reversed(operator.__mro__):
        for name, function in vars(base).items():
            if isinstance(function, types.FunctionType):
                setattr(stub, name, types.MethodType(function, stub))
    for prop in rna.properties:  # they hide functions of the same name
        setattr(stub, prop.identifier, getattr(prop, "default", None))
    for name, value in values.items():
        setattr(stub, name, value)
    stub.draw(bpy.context)
    shown = {name: active for name, active in stub.layout.shown.items() if isinstance(name, str)}
    assert set(shown) <= {p.identifier for p in rna.properties}
    return shown


@pytest.mark.parametrize("method", tripatch.METHODS)
def test_the_panel_shows_the_options_that_the_method_has(addon, method):
    shown = drawn(addon, method=method, optimal_shape=True, permanence=False)
    own = {name for name in tripatch.METHODS[method].options if name != "reading"}
    of_methods = {name for about in tripatch.METHODS.values() for name in about.options} - {"reading", "bulge"}
    assert of_methods & set(shown) == own - {"bulge"}
    assert shown["bulge"] == ("bulge" in own)
    assert shown.get("shape", False) is False and shown.get("alpha", False) is False  # greyed
    shown = drawn(addon, method=method, continuity="G0")
    assert shown["bulge"] is False and shown.get("cross_boundary", False) is False


@pytest.mark.parametrize("method", ["quintic", "szilvasi_nagy_c1", "coons_bezier"])
@pytest.mark.parametrize("output", ["triangles", "quads", "cage", None])
@pytest.mark.parametrize("individual", [False, True])
def test_panels_are_drawn(addon, method, output, individual):
    between = output is None
    shown = drawn(addon, between, method=method, individual=individual, **({} if between else {"output": output}))
    assert {"method", "resolution" if output in ("triangles", None) else "rows"} <= set(shown)
    assert ("cross_boundary" in shown) == (method != "coons_bezier") and ("alpha" in shown) == (method == "coons_bezier")
    assert {"continuity", "individual", "fairing", "tension", "center_offset"} <= set(shown)
    each = {f"{name}_{i}" for name in ("continuity", "bulge") for i in range(3)}
    assert each & set(shown) == (each if individual and method != "coons_bezier" else set())


def test_undo_and_redo_with_controls():
    ob = add_uneven_hole()
    scenes.edit(ob)
    bpy.ops.ed.undo_push(message="before")
    before = scenes.state("A")
    options = {"individual": True, "continuity_0": "Free", "continuity_1": "G2", "tension": 1.0, "center_offset": -0.1}
    assert bpy.ops.mesh.fill_three_sided("EXEC_DEFAULT", True, **options) == {"FINISHED"}
    after = scenes.state("A")
    assert after != before
    bpy.ops.ed.undo()
    assert scenes.state("A") == before
    bpy.ops.ed.redo()
    assert scenes.state("A") == after


@pytest.mark.parametrize("shape", ["0.5,x", "0.2,0.3", "0,0.5,0.5"])
def test_a_wrong_shape_is_named(addon, tmp_path, capsys, shape):
    add_uneven_hole()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "in.blend"))
    command_line = importlib.import_module(addon.__name__ + ".command_line")
    arguments = ["--method", "szilvasi_nagy_c1", "--shape", shape, "--out", str(tmp_path / "out.blend")]
    assert command_line.main(arguments) == 2
    assert "shape" in capsys.readouterr().err


def test_properties_follow_the_table():
    properties = bpy.ops.mesh.fill_three_sided.get_rna_type().properties
    for name in ("bulge", "tension", "center_offset", "tolerance", "symmetric", "output", "odd", "cage_rim"):
        option = tripatch.OPTIONS[name]
        assert properties[name].description == (option.seen or option.description)
        assert properties[name].default == ("auto" if name == "output" else 0 if option.default is None else option.default)
    assert [item.identifier for item in properties["fairing"].enum_items] == [
        *(each.name for each in tripatch.OPTIONS["fairing"].choices),
        "none",
    ]
    for option in tripatch.OPTIONS.values():
        assert (option.name in properties) == option.panel, option.name


def test_what_papers_misprint_is_for_programs_only():
    for operator in (bpy.ops.mesh.fill_three_sided, bpy.ops.object.fill_between_patches):
        properties = operator.get_rna_type().properties
        assert "reading" not in properties
        assert "as_printed" not in properties["cross_boundary"].enum_items
