"""What is said of a patch is the same whatever makes it: `fill`, `patch` or `blend`."""

import warnings

import numpy as np
import pytest
import tripatch
from codes import says

CORNERS = np.eye(3)
POSITION_ONLY = [m for m, about in tripatch.METHODS.items() if about.continuity == "G0" and about.sides == (3, 3)]
TANGENT = [m for m, about in tripatch.METHODS.items() if about.continuity == "G1" and about.sides == (3, 3)]


def straight(across):
    """Sides of the corner of a cube cut off, straight; across: of each side the derivative away from it."""
    sides = []
    for i in range(3):
        a, b = CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3]
        sides.append(
            tripatch.Side.from_functions(
                lambda t, a=a, b=b: (1 - t)[:, None] * a + t[:, None] * b,
                lambda t, a=a, b=b: np.broadcast_to(b - a, (len(t), 3)),
                lambda t, i=i: np.broadcast_to(across[i], (len(t), 3)),
            )
        )
    return sides


def cube():
    """The three faces of a cube around its corner that is cut off: planes that differ by 90 degrees at each corner."""
    return straight([CORNERS[(i + 1) % 3] + CORNERS[(i + 2) % 3] for i in range(3)])


def open_cube(n=6):
    """A cube of triangles whose corner at the origin is cut off, with rows of n edges next to the hole."""
    points, index, faces = [], {}, []

    def vertex(p):
        key = tuple(np.round(p, 9))
        if key not in index:
            index[key] = len(points)
            points.append(p)
        return index[key]

    for i in range(3):
        a, b = CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3]
        rows = [[vertex((1 + 0.5 * r) * ((1 - k / n) * a + k / n * b)) for k in range(n + 1)] for r in range(4)]
        for inner, outer in zip(rows[:-1], rows[1:]):
            for k in range(n):
                faces += [[inner[k + 1], inner[k], outer[k]], [inner[k + 1], outer[k], outer[k + 1]]]
    return np.array(points), faces, [index[tuple(c)] for c in CORNERS]


def told(make):
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        made = make()
    return made, [each.message.args[0] for each in seen]


def test_all_doors_report_corners_whose_planes_differ():
    vertices, faces, corners = open_cube()
    rim = next(r for r in tripatch.find_holes(faces) if len(r) == 18)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, method="side_vertex", continuity="G1", fairing=None)
    patch, of_patch = told(lambda: tripatch.patch(cube(), "side_vertex"))
    surfaces = []
    for i in range(3):  # flat triangles in the planes of the cube's faces, with an inner corner each
        net = CORNERS.copy()
        net[i] = 0
        surfaces.append(tripatch.BezierTriangle(net))
    blend, of_blend = told(lambda: tripatch.blend(*surfaces))
    for report, sentences in ((fill.report, fill.report.warnings), (patch.report, of_patch), (blend.report, of_blend)):
        assert report.corner_planes_angle == pytest.approx([90] * 3, abs=1)
        assert min(report.corner_normals_spread) > 30
        assert [each.code for each in sentences].count("corner_planes_differ") == 3
        assert all(each.parameters["spread"] > 30 for each in sentences if each.code == "corner_planes_differ")


def test_of_many_sides_too():
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
    sides = []
    for i in range(4):
        a, b = square[i], square[(i + 1) % 4]
        out = np.cross(b - a, [0, 0, 1]) + (i == 0) * np.array([0, 0, -1.0])  # the first leans by 45 degrees
        sides.append(
            tripatch.Side.from_functions(
                lambda t, a=a, b=b: (1 - t)[:, None] * a + t[:, None] * b,
                lambda t, a=a, b=b: np.broadcast_to(b - a, (len(t), 3)),
                lambda t, out=out: np.broadcast_to(out, (len(t), 3)),
            )
        )
    patch, sentences = told(lambda: tripatch.patch(sides))
    assert patch.report.corner_planes_angle == pytest.approx([45, 45, 0, 0], abs=1e-6)
    spread = patch.report.corner_normals_spread
    assert min(spread[:2]) > 40 and max(spread[2:]) < 1e-3
    assert [each.parameters["corner"] for each in sentences if each.code == "corner_planes_differ"] == [0, 1]


def test_where_the_planes_agree_so_do_the_normals_and_nothing_is_said():
    flat = straight([[1, 1, -2], [-2, 1, 1], [1, -2, 1]])
    flat = straight([(CORNERS[(i + 1) % 3] + CORNERS[(i + 2) % 3]) / 2 - CORNERS[i] for i in range(3)])
    for method in TANGENT:
        patch, sentences = told(lambda method=method: tripatch.patch(flat, method))
        assert max(patch.report.corner_planes_angle) < 1e-6
        assert max(patch.report.corner_normals_spread) < 1e-6
        assert sentences == []


@pytest.mark.parametrize("method", POSITION_ONLY)
def test_a_flat_lid_by_position_only_does_not_fold_however_its_surroundings_lean(method):
    inwards = straight([-CORNERS[i] - 3 * np.ones(3) for i in range(3)])
    patch, sentences = told(lambda: tripatch.patch(inwards, method))
    assert patch.report.folds == 0
    assert sentences == []
    b = np.random.default_rng(0).dirichlet([1, 1, 1], 50)
    assert np.abs(patch.evaluate(b).sum(axis=1) - 1).max() < 1e-12  # the plane of the three corners


@pytest.mark.parametrize("method", POSITION_ONLY)
def test_position_only_reads_no_slopes(method):
    b = np.random.default_rng(0).dirichlet([1, 1, 1], 50)
    made = []
    for turn in (0, 1):
        rng = np.random.default_rng(4)
        nets = [rng.normal(size=(2, 3)) * 0.1 for _ in range(3)]
        sides = []
        for i, net in enumerate(nets):
            a, d = CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3]
            p = np.array([a, a + (d - a) / 3 + net[0], d + (a - d) / 3 + net[1], d])

            def c(t, p=p):
                return sum(k * (1 - t)[:, None] ** (3 - j) * t[:, None] ** j * p[j] for j, k in enumerate((1, 3, 3, 1)))

            def dc(t, p=p):
                q = 3 * np.diff(p, axis=0)
                return sum(k * (1 - t)[:, None] ** (2 - j) * t[:, None] ** j * q[j] for j, k in enumerate((1, 2, 1)))

            out = (a + d) / 2 - CORNERS[i] + turn * np.array([1, -2, 3])
            sides.append(
                tripatch.Side.from_functions(c, dc, lambda t, out=out: np.broadcast_to(out, (len(t), 3)), rim=[0, 0.5, 1])
            )
        made.append(told(lambda sides=sides: tripatch.patch(sides, method))[0].evaluate(b))
    assert np.array_equal(*made)


def test_a_patch_that_misses_its_boundary_says_so():
    vertices, faces, corners = open_cube()
    rim = next(r for r in tripatch.find_holes(faces) if len(r) == 18)
    asked = {"rim": rim, "corners": corners, "method": "szilvasi_nagy_c1", "continuity": "G1", "fairing": None}
    printed = tripatch.fill(vertices, faces, reading="as_printed", **asked).report
    corrected = tripatch.fill(vertices, faces, **asked).report
    assert corrected.boundary_gap < 1e-9
    assert set(corrected.continuity) == {"G1"}
    assert printed.boundary_gap > 0.1
    assert set(printed.continuity) == {"none"}
    assert says(printed, "misses_boundary")
    assert not says(corrected, "misses_boundary")


def test_a_gap_below_the_accuracy_of_the_mesh_is_not_told():
    angle = 2 * np.pi * np.arange(14) / 14
    rings = [(0.35 - 0.02 * j + 0.03 * np.sin(3 * j), 0.2 * j) for j in range(10)]
    vertices = np.concatenate([np.stack([r * np.cos(angle), 0.8 * r * np.sin(angle), 0 * angle + z], -1) for r, z in rings])
    faces = [
        [14 * j + i, 14 * j + (i + 1) % 14, 14 * (j + 1) + (i + 1) % 14, 14 * (j + 1) + i] for j in range(9) for i in range(14)
    ]
    report = tripatch.fill(vertices, faces, rim=tripatch.find_holes(faces)[1]).report
    assert report.boundary_gap > 1e-6 and report.surroundings_error > 1
    assert report.continuity == ["G1"] and not report.warnings


def test_the_gap_is_measured_of_every_fill():
    vertices, faces, corners = open_cube()
    rim = next(r for r in tripatch.find_holes(faces) if len(r) == 18)
    for options in (
        {},
        {"method": "polyharmonic_spline"},
        {"method": "multi_sided"},
        {"method": "gordon_coons"},
        {"output": "quads"},
    ):
        fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, **options)
        places = fill.rim_barycentric if len(fill.rim_barycentric) else fill.rim_uv
        gap = np.linalg.norm(fill.patch.evaluate(places) - vertices[fill.rim], axis=1).max()
        assert fill.report.boundary_gap == pytest.approx(gap, abs=1e-15)


def test_patches_without_a_report_have_none():
    assert tripatch.BezierTriangle(CORNERS).report is None
