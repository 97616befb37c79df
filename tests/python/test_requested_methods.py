"""Methods that are requested: what they would deliver folded or crossed is refused, and options that they do not take."""

import numpy as np
import pytest
import tripatch
from codes import refused, says
from test_cli import write_obj
from test_report import jagged
from tripatch.__main__ import main

#: Codes of options that change nothing.
NOT_APPLIED = ("option_of_other_methods", "options_not_taken", "options_need_smooth_sides", "option_needs_three_sides")


def two_holes():
    """The jagged octant, and next to it the smooth one: vertices, faces, rims and the corners of each."""
    vertices, faces, rim, corners = jagged(8, 0.6)
    other, _, smooth, smooth_corners = jagged(8, 0.0)
    n = len(vertices)
    adjacent = [[n + v for v in face] for face in faces]
    rims = [list(rim), [n + v for v in smooth]]
    return np.concatenate([vertices, other + 5]), [*map(list, faces), *adjacent], rims, [corners, [n + v for v in smooth_corners]]


@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize(("method", "count"), [("side_vertex", 3), ("gregory", 3), ("multi_sided", 4), ("multi_sided", 3)])
def test_a_patch_that_would_fold_is_refused_and_auto_fills_the_hole(method, count, output):
    vertices, faces, rim, corners = jagged(8, 0.6)
    if count == 4:
        corners = [rim[k * len(rim) // 4] for k in range(4)]
    options = {"rim": rim, "corners": corners, "output": output}
    with refused("method_folds") as caught:
        tripatch.fill(vertices, faces, **options, method=method)
    assert caught.value.where and set(caught.value.where) <= set(map(int, rim))
    assert caught.value.code == "method_folds"
    report = tripatch.fill(vertices, faces, **options).report
    assert report.triangles_folded <= report.rim_folded
    for more in ({"fairing": "thin_plate"}, {"continuity": "Free"}):
        with refused("method_folds"):
            tripatch.fill(vertices, faces, **options, method=method, **more)
    told = tripatch.fill(vertices, faces, **options, method=method, fairing=None).report  # the formula's own, as asked for
    assert told.triangles_folded > told.rim_folded and says(told, "patch_folds")


def test_of_several_holes_only_those_that_would_fold_are_refused():
    vertices, faces, rims, corners = two_holes()
    folded, smooth = tripatch.fill_all(vertices, faces, rims, corners=corners, method="side_vertex")
    assert isinstance(folded, tripatch.Refusal) and folded.code.startswith("method_folds")
    assert smooth.report.method == "side_vertex" and smooth.report.triangles_folded == 0


def test_the_command_line_writes_no_fill_that_was_refused(tmp_path, capsys):
    vertices, faces, rims, corners = two_holes()
    path, out = write_obj(tmp_path / "in.obj", (vertices, faces)), tmp_path / "out.obj"
    named = "--rim", ",".join(map(str, rims[0])), "--corners", ",".join(map(str, corners[0])), "--method", "side_vertex"
    assert main(["fill", str(path), str(out), *named]) == 1
    assert "would fold over itself" in capsys.readouterr().err and not out.exists()


#: Of every option of a fill that says something of the surface, a value that is not its default.
SHAPES = {
    "continuity": "G2",
    "fairing": "thin_plate",
    "cross_boundary": "given",
    "shape": 0.3,
    "reading": "as_printed",
    "symmetric": True,
    "alpha": 0.2,
    "tolerance": 0.01,
    "pole_offset": (0.1, 0.0),
}
OF_ONE_KIND = ("shape", "reading", "symmetric", "alpha")


def with_output(name, value):
    return {name: value, "output": "quads" if name in ("tolerance", "pole_offset") else "triangles"}


@pytest.mark.parametrize("method", ["polyharmonic_spline", "quad_rows"])
@pytest.mark.parametrize(("name", "value"), SHAPES.items())
def test_what_a_surface_of_the_surroundings_does_not_take_is_a_mistake(method, name, value):
    vertices, faces, rim, _ = jagged(8, 0.6)
    said = f"{name} is an option of .*, not of {method}" if name in OF_ONE_KIND else f"{method} does not take {name}"
    with pytest.raises(ValueError, match=said) as caught:
        tripatch.fill(vertices, faces, rim=rim, method=method, **with_output(name, value))
    assert not isinstance(caught.value, tripatch.Refusal)
    with pytest.raises(ValueError, match=said):
        tripatch.fill_all(vertices, faces, [rim], method=method, **with_output(name, value))


@pytest.mark.parametrize(("name", "value"), SHAPES.items())
def test_under_auto_it_is_told_and_the_fill_is_the_same(name, value):
    vertices, faces, rim, _ = jagged(8, 0.6)
    options = with_output(name, value)
    plain = tripatch.fill(vertices, faces, rim=rim, output=options["output"])
    assert plain.report.method == "polyharmonic_spline" and not plain.report.warnings
    fill = tripatch.fill(vertices, faces, rim=rim, **options)
    assert fill.report.method == "polyharmonic_spline" and np.array_equal(fill.vertices, plain.vertices)
    (said,) = fill.report.warnings
    assert name in said and said.code in ("option_of_other_methods", "options_need_smooth_sides")
    if options["output"] == "quads":  # it means nothing for triangles, whatever the method
        assert not tripatch.fill(vertices, faces, rim=rim, **{name: value}).report.warnings


@pytest.mark.parametrize("method", ["auto", "polyharmonic_spline", "multi_sided"])
def test_of_options_at_their_defaults_nothing_is_said(method):
    vertices, faces, rim, corners = jagged(8, 0.0 if method == "multi_sided" else 0.6)
    given = {name: tripatch.OPTIONS[name].default for name in SHAPES}
    given |= {"bulge": (1, 1, 1), "shape": (0.5,) * 3, "continuity": "G1"}
    fill = tripatch.fill(vertices, faces, rim=rim, method=method, **given)
    assert not says(fill.report, *NOT_APPLIED)


def test_under_auto_the_options_of_a_formula_are_told_where_a_patch_is_taken_too():
    vertices, faces, rim, corners = jagged(8, 0.0)
    for name in OF_ONE_KIND:
        fill = tripatch.fill(vertices, faces, rim=rim, **{name: SHAPES[name]})
        assert fill.report.method == "side_vertex"
        assert says(fill.report, "option_of_other_methods")
    assert not tripatch.fill(vertices, faces, rim=rim, cross_boundary="given").report.warnings


def test_what_other_patches_between_sides_read_is_told_of_one_that_does_not():
    vertices, faces, rim, corners = jagged(8, 0.0)
    options = {"rim": rim, "corners": corners, "method": "gordon_coons"}
    plain, fill = (tripatch.fill(vertices, faces, **options, **more) for more in ({}, {"bulge": 2.0, "shape": 0.3}))
    assert np.array_equal(fill.vertices, plain.vertices) and not plain.report.warnings
    assert says(fill.report, "options_not_taken")
    assert says(fill.report, "option_of_other_methods")
    with pytest.raises(ValueError, match="gordon_coons does not take islands"):
        tripatch.fill(vertices, faces, **options, islands=[rim])
    assert tripatch.METHODS["side_vertex"].takes("bulge") and not tripatch.METHODS["gordon_coons"].takes("bulge")
