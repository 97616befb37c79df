"""The options of single methods: from Python and from the command line each reaches the method that has it, and no other."""

import json

import numpy as np
import pytest
import tripatch
from shapes import corner_removed, cube_sphere, octant
from tripatch import __main__ as cli
from tripatch import files

VALUES = {
    "cross_boundary": "given",
    "bulge": 1.4,
    "shape": (0.2, 0.6, 0.8),
    "reading": "as_printed",
    "symmetric": True,
    "alpha": 0.1,
}
OF_ONE_METHOD = ("symmetric", "alpha")


def uneven_hole(n=5):
    """A hole without symmetry in a curved surface, and its corners."""
    vertices, faces, rim = octant(n)
    x, y, z = vertices.T
    waves = 1 + 0.12 * np.sin(3 * x + 1) * np.cos(2 * y) + 0.08 * np.sin(4 * z - y)
    return vertices * waves[:, None] * [1, 1.2, 0.8], faces, {"rim": rim, "corners": [rim[0], rim[n], rim[2 * n]]}


def filled(**options):
    vertices, faces, hole = uneven_hole()
    return tripatch.fill(vertices, faces, **hole, fairing=None, resolution=6, **options)


def test_every_option_that_a_method_names_is_one_of_fill():
    assert {o for about in tripatch.METHODS.values() for o in about.options} == set(VALUES)
    assert set(VALUES) <= set(cli.OPTIONS)


@pytest.mark.parametrize("method", tripatch.METHODS)
def test_a_method_reads_the_options_that_it_names_and_no_others(method):
    b = np.array([(i, j, 12 - i - j) for i in range(13) for j in range(13 - i)]) / 12

    def points(**options):
        return filled(method=method, **options).patch.evaluate(b)

    plain = points()
    for name, value in VALUES.items():
        if name in tripatch.METHODS[method].options:
            assert np.abs(points(**{name: value}) - plain).max() > 1e-4, name
        elif name in OF_ONE_METHOD:
            with pytest.raises(ValueError, match=f"{name} is an option of coons_.*, not of {method}"):
                points(**{name: value})
        else:
            assert np.array_equal(points(**{name: value}), plain), name


@pytest.mark.parametrize("method", ["szilvasi_nagy_c0", "szilvasi_nagy_c1"])
def test_the_path_of_an_optimal_lambda_is_in_the_report(method):
    fill = filled(method=method, shape="optimal")
    path = fill.report.shape_path
    assert len(path) >= 2 and path[0][0] == [0.5, 0.5, 0.5]
    assert path == fill.patch.path and path[-1][0] == fill.patch.shape
    assert path[-1][1] == min(energy for _, energy in path)
    assert json.loads(json.dumps(fill.report.as_dict()))["shape_path"][-1][0] == fill.patch.shape
    assert filled(method=method).report.shape_path == []


def test_the_paths_numbers_are_the_energies_of_the_patches():
    fill = filled(method="szilvasi_nagy_c1", shape="optimal")
    for shape, energy in fill.report.shape_path:
        assert filled(method="szilvasi_nagy_c1", shape=shape).patch.energy("thin_plate") == pytest.approx(energy, rel=1e-3)


def test_what_a_permanence_patch_has_to_say_is_a_warning_or_a_refusal():
    vertices, faces, hole = uneven_hole(4)  # degree 4: singular at the paper's alpha
    with pytest.raises(tripatch.Refusal, match="degree 4 with alpha -0.66"):
        tripatch.fill(vertices, faces, **hole, method="coons_bezier", alpha=-2 / 3)
    corners, sides = np.array([(0, 0, 0), (1, 0, 0.2), (0.3, 0.9, 0)]), []
    for i in range(3):
        a, edge = corners[(i + 1) % 3], corners[(i + 2) % 3] - corners[(i + 1) % 3]
        sides.append(  # control points a, a, a, a, b: alike at all corners, and then there is a solution
            tripatch.Side.from_functions(
                lambda t, a=a, edge=edge: a + np.outer(t**4, edge),
                lambda t, edge=edge: np.outer(4 * t**3, edge),
                lambda t: np.outer(1 + 0 * t, [0, 0, 1.0]),
            )
        )
    with pytest.warns(UserWarning, match="degree 4 with alpha -0.666667 is singular .* nearest"):
        tripatch.patch(sides, "coons_bezier", alpha=-2 / 3)


@pytest.mark.parametrize("method", ["coons_bezier", "coons_extremal", "coons_mask"])
@pytest.mark.parametrize("use_limit_surface", [True, False])
def test_bezier_methods_pass_through_the_limits_of_the_rims_vertices(method, use_limit_surface):
    vertices, faces = cube_sphere(6)
    faces, _ = corner_removed(vertices, faces, 2)
    settings = {"use_limit_surface": use_limit_surface}
    options = {"surroundings": "limit", "subdivision": settings, "level": 2}
    fill = tripatch.fill(vertices, faces, **options, method=method)
    sides = tripatch.fill(vertices, faces, **options, method="triangular_coons").patch
    per_edge = len(fill.border) // len(fill.rim)
    on_rim = fill.barycentric[fill.border[::per_edge]]
    assert np.abs(fill.patch.evaluate(on_rim) - sides.evaluate(on_rim)).max() < 1e-10
    cage = tripatch.fill(vertices, faces, method=method, output="cage", fairing=None)
    assert cage.report.cage_deviation_rms < 0.05


@pytest.mark.parametrize("options", [{"alpha": "x"}, {"alpha": True}, {"symmetric": 1}])
def test_options_of_wrong_types(options):
    method = "coons_bezier" if "alpha" in options else "coons_extremal"
    with pytest.raises(TypeError, match=next(iter(options))):
        filled(method=method, **options)


def test_alpha_must_be_finite():
    with pytest.raises(ValueError, match="alpha must be finite, not nan"):
        filled(method="coons_bezier", alpha=np.nan)


@pytest.mark.parametrize(
    ("arguments", "options"),
    [
        (["szilvasi_nagy_c0", "--shape", "0.2,0.6,0.8"], {"shape": (0.2, 0.6, 0.8)}),
        (["szilvasi_nagy_c1", "--shape", "optimal"], {"shape": "optimal"}),
        (["szilvasi_nagy_c1", "--reading", "as_printed"], {"reading": "as_printed"}),
        (["coons_extremal", "--symmetric"], {"symmetric": True}),
        (["coons_bezier", "--alpha", "0.1"], {"alpha": 0.1}),
        (["coons_bezier", "--alpha", "none"], {}),
        (["gregory", "--cross-boundary", "as_printed"], {"cross_boundary": "as_printed"}),
        (["quintic", "--cross-boundary", "given", "--bulge", "1.4"], {"cross_boundary": "given", "bulge": 1.4}),
    ],
)
def test_the_command_line_takes_them(arguments, options, tmp_path):
    vertices, faces, hole = uneven_hole()
    path, out = tmp_path / "in.obj", tmp_path / "out.obj"
    path.write_text(
        "".join("v {!r} {!r} {!r}\n".format(*map(float, p)) for p in vertices)
        + "".join("f {} {} {}\n".format(*(v + 1 for v in f)) for f in faces)
    )
    common = ["--fairing", "none", "--resolution", "6"]
    for name, where in hole.items():
        common += [f"--{name}", ",".join(map(str, where))]
    report = tmp_path / "report.json"
    assert cli.main(["fill", str(path), str(out), "--report", str(report), "--method", *arguments, *common]) == 0
    expected = filled(method=arguments[0], **options)
    new = files.read(out).vertices[len(vertices) :]
    assert np.abs(new - expected.vertices).max() < 1e-12
    (told,) = json.loads(report.read_text())["holes"]
    assert told["shape_path"] == [[list(shape), energy] for shape, energy in expected.report.shape_path]


def test_the_list_of_methods_says_which_options_each_has(capsys):
    assert cli.main(["methods"]) == 0
    said = capsys.readouterr().out
    assert "options: cross_boundary, bulge, shape, reading" in said
    assert "options: alpha" in said and "options: symmetric" in said
