"""The options of single methods: from Python and from the command line each reaches the method that has it, and no other."""

import json
import warnings

import numpy as np
import pytest
import tripatch
from codes import refused
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
#: the constructions; the methods for any rim, for rows of quads and for two boundaries read no sides
OTHERS = ("polyharmonic_spline", "quad_rows", "annulus")
BETWEEN_SIDES = [m for m in tripatch.METHODS if m not in OTHERS]


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


@pytest.mark.parametrize("method", BETWEEN_SIDES)
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
    with refused("coons_without_solution"):
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
    with pytest.warns(UserWarning, match="degree 4 with alpha -0.67 is singular .* nearest"):
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
    with pytest.raises(ValueError, match="alpha is not finite"):
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
    misses = options.get("reading") == "as_printed"  # the printed formula does not meet its boundary
    expected_status = cli.SOME if misses else cli.FILLED
    assert cli.main(["fill", str(path), str(out), "--report", str(report), "--method", *arguments, *common]) == expected_status
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


def net_size(n):
    return (n + 1) * (n + 2) // 2


@pytest.mark.parametrize("kind", ["discrete", "extremal", "extremal_symmetric", "mask", "permanence"])
@pytest.mark.parametrize("degree", range(22))
def test_every_degree_gives_a_finite_net_or_a_sentence_that_names_it(kind, degree):
    net = tripatch.BezierTriangle(np.random.default_rng(degree).normal(size=(net_size(degree), 3)))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", f"The extremal of degree {degree} solves an ill-conditioned system")
        if degree > 20:
            with pytest.raises(ValueError, match=f"degree must be from 0 to 20, not {degree}"):
                tripatch.coons_bezier([net.side(i) for i in range(3)], kind)
            return
        try:
            made = tripatch.coons_bezier([net.side(i) for i in range(3)], kind)
        except tripatch.Refusal as refusal:
            assert refusal.code == "coons_without_solution"
            assert degree in ((6, 8, 10, 12, 14, 16, 18, 20) if kind == "mask" else (4, 10) if kind == "permanence" else ())
        else:
            assert made.degree == degree + (kind == "discrete")
            assert np.isfinite(made.net).all()


@pytest.mark.parametrize("count", [0, 2, 4, 5, 7, 11])
def test_nets_of_wrong_size_are_counted(count):
    with pytest.raises(ValueError, match=f"1, 3, 6, 10, 15 and so on points, not {count}$"):
        tripatch.BezierTriangle(np.zeros((count, 3)))


def test_every_method_says_between_how_many_sides_it_fills():
    """And refuses rims with one corner more than it says."""
    angles = 2 * np.pi * np.arange(36) / 36
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    vertices = np.column_stack([np.concatenate([ring, 1.1 * ring, 1.2 * ring]), np.zeros(108)])
    at = [(36 * j + k, 36 * j + (k + 1) % 36) for j in range(2) for k in range(36)]
    faces = [face for a, b in at for face in ([b, a, a + 36], [b, a + 36, b + 36])]
    for name, about in tripatch.METHODS.items():
        least, most = about.sides
        assert (least, most) == (
            {"multi_sided": (2, 12), "polyharmonic_spline": (0, None), "quad_rows": (4, 4), "annulus": (0, None)}.get(
                name, (3, 3)
            )
        )
        if about.fills_holes and name not in ("quad_rows", "annulus"):  # see test_quad_rows and test_annulus
            for count in {max(least, 2), most or 13}:
                corners = [int(k) for k in np.arange(count) * 36 // count]
                fill = tripatch.fill(vertices, faces, rim=range(36), corners=corners, method=name)
                assert fill.report.method == name
            if most:
                with pytest.raises((tripatch.Refusal, ValueError)):
                    tripatch.fill(vertices, faces, rim=range(36), corners=np.arange(most + 1) * 36 // (most + 1), method=name)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("method", [m for m, about in tripatch.METHODS.items() if m.startswith(("nielson", "szilvasi"))])
def test_constituents_without_common_corners_are_named(method, scale):
    net = np.random.default_rng(1).normal(size=(6, 3)) * scale
    moved = net.copy()
    moved[5] += 1e-3 * scale
    a, b = tripatch.BezierTriangle(net), tripatch.BezierTriangle(moved)  # corner 2 is carried by surfaces 0 and 1
    with pytest.raises(ValueError, match="r0 and r1 do not meet at corner 2") as caught:
        tripatch.blend(b, a, a, method=method)
    assert caught.value.args[0].parameters["gap"] == pytest.approx(np.sqrt(3) * 1e-3 * scale)


@pytest.mark.parametrize("method", [m for m in BETWEEN_SIDES if not m.startswith(("nielson", "szilvasi"))])
def test_methods_that_blend_no_surfaces_say_so(method):
    a = tripatch.BezierTriangle(np.eye(3))
    with pytest.raises(ValueError, match=f"{method} works with tripatch.patch only"):
        tripatch.blend(a, a, a, method=method)


@pytest.mark.parametrize("shape", [0, 1, -0.5, 1.5, np.nan, np.inf])
@pytest.mark.parametrize("method", ["szilvasi_nagy_c0", "szilvasi_nagy_c1"])
def test_lambda_outside_its_interval_is_named(method, shape):
    a = tripatch.BezierTriangle(np.eye(3))
    with pytest.raises(ValueError, match=r"shape\[1\] (must be between 0 and 1|is not finite)"):
        tripatch.blend(a, a, a, method=method, shape=(0.5, shape, 0.5))
    with pytest.raises(ValueError, match=r"shape\[1\] (must be between 0 and 1|is not finite)"):
        filled(method=method, shape=(0.5, shape, 0.5))


def with_side(change):
    """Three sides that meet; those of side 1 changed by change(c, dc, r)."""
    sides = list(filled().sides)
    given = sides[1].evaluate
    functions = change(*(lambda t, k=k: given(t)[k] for k in range(3)))
    sides[1] = tripatch.Side.from_functions(*functions)
    return sides


@pytest.mark.parametrize("method", BETWEEN_SIDES)
def test_sides_that_do_not_meet_are_named(method):
    sides = with_side(lambda c, dc, r: (lambda t: c(t) + [0, 0, 1e-3], dc, r))
    with refused("sides_apart"):
        tripatch.patch(sides, method)


def test_ends_within_a_tolerance_are_moved_together():
    exact = tripatch.patch(filled().sides)
    sides = with_side(lambda c, dc, r: (lambda t: c(t) + [0, 0, 1e-4], dc, r))
    with pytest.warns(UserWarning, match="The ends of the sides were moved together, by up to 5e-05"):
        patch = tripatch.patch(sides, tolerance=2e-4)
    b = np.random.default_rng(1).dirichlet((1, 1, 1), 50)
    assert np.abs(patch.evaluate(b) - exact.evaluate(b)).max() < 2e-4
    with refused("sides_apart"):
        tripatch.patch(sides, tolerance=5e-5)
    with pytest.raises(TypeError, match="tolerance must be of type float"):
        tripatch.patch(sides, tolerance="some")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", "The tangent planes of the two sides differ")
        tripatch.patch(filled().sides, tolerance=0)


@pytest.mark.parametrize("method", [m for m in BETWEEN_SIDES if tripatch.METHODS[m].continuity == "G1"])
@pytest.mark.parametrize("cross_boundary", ["given", "consistent"])
def test_slopes_without_a_tangent_plane_are_refused(method, cross_boundary):
    for change in (lambda c, dc, r: (c, dc, lambda t: 0 * r(t)), lambda c, dc, r: (c, dc, lambda t: 2 * dc(t))):
        with refused("side_without_planes"):
            tripatch.patch(with_side(change), method, cross_boundary)


@pytest.mark.parametrize(("k", "name"), [(0, "c"), (1, "dc"), (2, "r")])
def test_functions_that_are_not_finite_are_named(k, name):
    def broken(*functions):
        def f(t):
            return np.where(np.abs(t[:, None] - 0.5) < 0.1, np.nan, functions[k](t))

        return [f if j == k else function for j, function in enumerate(functions)]

    with pytest.raises(ValueError, match=rf"^{name}\(0\.[45]\d*\) is not finite"):
        with_side(broken)


@pytest.mark.parametrize("method", BETWEEN_SIDES)
def test_a_rim_vertex_that_is_no_number_is_named(method):
    vertices, faces, hole = uneven_hole()
    bad = hole["rim"][3]
    vertices[bad, 1] = np.nan
    with refused("vertex_not_finite") as error:
        tripatch.fill(vertices, faces, **hole, method=method)
    assert error.value.where == [bad]


def hill(x, y):
    """Height and gradient of the ground that the pictures of the methods are cut from."""
    e = np.exp(-2.2 * (x**2 + y**2))
    s, c = np.sin(2.6 * x + 0.4), np.cos(2.6 * x + 0.4)
    height = 0.32 * e + 0.10 * s * np.cos(1.8 * y)
    return height, -1.408 * x * e + 0.26 * c * np.cos(1.8 * y), -1.408 * y * e - 0.18 * s * np.sin(1.8 * y)


def hole_in_the_hill():
    """Its sides, bent outwards, with the hill's own slopes."""
    angles, sides = np.radians([90, 210, 330]), []
    corners = 0.62 * np.stack([np.cos(angles), np.sin(angles)], -1)
    for i in range(3):
        a, b = corners[(i + 1) % 3], corners[(i + 2) % 3]
        out = (a + b) / 2

        def at(t, a=a, b=b, out=out):
            return a + t[:, None] * (b - a) + (0.5 * t * (1 - t))[:, None] * out

        def along(t, a=a, b=b, out=out):
            return b - a + (0.5 - t)[:, None] * out

        def lifted(p, d):
            _, fx, fy = hill(*p.T)
            return np.column_stack([d, fx * d[:, 0] + fy * d[:, 1]])

        sides.append(
            tripatch.Side.from_functions(
                lambda t, at=at: np.column_stack([at(t), hill(*at(t).T)[0]]),
                lambda t, at=at, along=along: lifted(at(t), along(t)),
                lambda t, at=at: lifted(at(t), at(t)),
            )
        )
    return sides


@pytest.mark.parametrize(
    ("method", "low", "high"),
    [
        ("side_vertex", 1, 2.5),
        ("nielson_blend", 1, 2.5),
        ("szilvasi_nagy_c1", 1, 2.5),
        ("quintic", 0, 0.3),
        ("gregory", 0, 0.3),
        ("barnhill_birkhoff_gordon", 0, 0.3),
    ],
)
def test_normals_near_the_corners(method, low, high):
    """Degrees off the ground a tenth of the way in; with the distance they go to zero for every method."""
    patch = tripatch.patch(hole_in_the_hill(), method)
    t, worst = np.linspace(0.02, 0.98, 49), []
    for rho in (0.1, 0.01, 1e-3):
        angles = []
        for i in range(3):
            b = np.zeros((49, 3))
            b[:, i], b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - rho, rho * (1 - t), rho * t
            _, fx, fy = hill(*patch.evaluate(b)[:, :2].T)
            n, true = patch.normal(b), np.column_stack([-fx, -fy, np.ones_like(fx)])
            angles.append(np.degrees(np.arctan2(np.linalg.norm(np.cross(n, true), axis=1), (n * true).sum(axis=1))).max())
        worst.append(max(angles))
    assert low < worst[0] < high
    assert worst[1] < 0.3 * worst[0] and worst[2] < 0.03 * worst[0]


CORNERS = np.array([(0, 0, 0), (1, 0.1, 0.2), (0.3, 0.9, -0.1)])


def rectangle(i, rational=False):
    """A surface whose edge 0 runs over side i and that leaves the hole at an angle; degrees and speeds differ by side."""
    rng = np.random.default_rng(i)
    m, n = (3, 4, 2)[i], (2, 1, 3)[i]
    a, b = CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3]
    out = (1.3, 0.6, 2.0)[i] * ((a + b) / 2 - CORNERS[i] + 0.3 * (0.5 - i) * (b - a))
    u, v = np.linspace(0, 1, m + 1), np.linspace(0, 1, n + 1)
    net = a + u[:, None, None] * (b - a) + v[None, :, None] * out + rng.uniform(-0.1, 0.1, (m + 1, n + 1, 3))
    net[[0, -1], 0] = a, b
    if rational:
        weights = rng.uniform(0.6, 1.6, (m + 1, n + 1))
        return tripatch.NurbsSurface(net, weights, [0] * (m + 1) + [1] * (m + 1), [0] * (n + 1) + [1] * (n + 1))
    return tripatch.BezierRectangle(net)


@pytest.mark.parametrize("method", BETWEEN_SIDES)
@pytest.mark.parametrize("cross_boundary", ["given", "consistent", "as_printed"])
def test_three_rectangular_surfaces_are_joined(method, cross_boundary):
    tangent = tripatch.METHODS[method].continuity == "G1"
    for rational in (False, True) if not method.startswith("coons") else (False,):
        sides = [tripatch.Side(rectangle(i, rational), 0) for i in range(3)]
        patch = tripatch.patch(sides, method, cross_boundary)
        t = np.linspace(0.01, 0.99, 51)
        for i, side in enumerate(sides):
            b = np.zeros((51, 3))
            b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
            c, _, _, n = side.evaluate(t)
            assert np.abs(patch.evaluate(b) - c).max() < 1e-12
            if tangent:
                m = patch.normal(b)
                angle = np.degrees(np.arctan2(np.linalg.norm(np.cross(m, n), axis=1), np.abs((m * n).sum(axis=1))))
                assert angle.max() < 1e-6


def test_the_bezier_methods_refuse_rational_sides():
    sides = [tripatch.Side(rectangle(i, rational=i == 1), 0) for i in range(3)]
    with refused("side_is_no_bezier_curve"):
        tripatch.patch(sides, "coons_bezier")


@pytest.mark.parametrize("method", ["nielson_blend", "szilvasi_nagy_c0", "szilvasi_nagy_c1"])
@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_blends_follow_rigid_motions_and_scales(method, scale):
    rng = np.random.default_rng(3)
    nets = CORNERS[[0, 0, 0, 1, 1, 2]] + CORNERS[[0, 1, 2, 1, 2, 2]] + rng.uniform(-0.2, 0.2, (3, 6, 3))
    nets[:, [0, 3, 5]] = 2 * CORNERS
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    q *= np.linalg.det(q)
    shift = scale * rng.normal(size=3)
    b = np.array([(i, j, 8 - i - j) for i in range(9) for j in range(9 - i)]) / 8
    options = {} if method == "nielson_blend" else {"shape": "optimal"}
    plain = tripatch.blend(*map(tripatch.BezierTriangle, nets), method=method, **options)
    moved = tripatch.blend(*map(tripatch.BezierTriangle, scale * nets @ q.T + shift), method=method, **options)
    assert np.abs((moved.evaluate(b) - shift) @ q / scale - plain.evaluate(b)).max() < 1e-7
    if options:
        assert np.allclose(moved.shape, plain.shape, atol=1e-6)
