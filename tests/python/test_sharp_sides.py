"""Holes that the mesh meets at an angle: what lies beyond such a side tells nothing of the face that was there, the rim does."""

import numpy as np
import pytest
import tripatch
from codes import says
from shapes import corner_removed, cube_sphere, octant

#: Codes of sides that the mesh meets at an angle.
SHARP = ("side_sharp", "all_sides_sharp", "sharp_sides", "flat_all_around")

TRIANGLE = np.array([(-0.5, -0.4), (0.6, -0.3), (0.0, 0.7)])
QUADRANGLE = np.array([(-0.5, -0.5), (0.5, -0.45), (0.55, 0.5), (-0.45, 0.6)])
OCTAGON = np.array([(0.7, 0), (0.5, 0.45), (0.1, 0.7), (-0.4, 0.55), (-0.75, 0.1), (-0.5, -0.5), (0, -0.65), (0.55, -0.5)])
FLAT_HEXAGON = 0.6 * np.array([(1, 0), (0.5, 0.75), (-0.5, 0.75), (-0.9, 0.35), (-1, -0.3), (0, -0.9)])  # 36 degrees once
PENTAGON = 0.6 * np.array([(np.cos(a), np.sin(a)) for a in 2 * np.pi * np.arange(5) / 5])


def slope(x, y):
    return 0.3 * x - 0.2 * y


def cylinder(x, _):
    return np.sqrt(1.44 - x * x)


def sphere(x, y):
    return np.sqrt(2.25 - x * x - y * y)


def saddle(x, y):
    return 0.3 * (x * x - y * y)


def column(top, corners, edges=12, rows=5, lean=0.0, depth=0.5):
    """What is left of a column below z = top(x, y) over a polygon: its walls, which lean inwards by a share of its width, so far
    down below the lowest place of its top. The face on top is the hole."""
    n, t = len(corners), np.arange(edges)[:, None] / edges
    plan = np.concatenate([corners[k] + t * (corners[(k + 1) % n] - corners[k]) for k in range(n)])
    z = top(*plan.T)
    down = np.linspace(0, 1, rows + 1)[:, None]
    heights = z + down * (z.min() - depth - z)
    narrowed = (1 - lean * down[:, :, None]) * plan
    vertices = np.column_stack([narrowed.reshape(-1, 2), heights.ravel()])
    r = len(plan)
    quads = [(j * r + (k + 1) % r, j * r + k, (j + 1) * r + k, (j + 1) * r + (k + 1) % r) for j in range(rows) for k in range(r)]
    return vertices, np.array(quads), list(range(r)), list(range(0, r, edges))


def distance(fill, top):
    x, y, z = fill.vertices.T
    return np.abs(z - top(x, y)).max()


@pytest.mark.parametrize("corners", [TRIANGLE, QUADRANGLE, PENTAGON])
@pytest.mark.parametrize(("top", "within"), [(slope, 1e-12), (cylinder, 1e-4), (sphere, 1e-4), (saddle, 1e-4)])
def test_a_face_between_walls_is_what_its_rim_says(top, within, corners):
    vertices, faces, rim, at = column(top, corners)
    fill = tripatch.fill(vertices, faces, rim=rim)
    assert fill.report.corners == at
    assert fill.report.continuity == ["Free"] * len(corners)
    assert distance(fill, top) < within
    assert says(fill.report, "all_sides_sharp")
    assert fill.report.surroundings_error == 0  # none are continued


@pytest.mark.parametrize("edges", [3, 12])
@pytest.mark.parametrize("corners", [QUADRANGLE, PENTAGON, FLAT_HEXAGON, OCTAGON])
def test_all_corners_between_walls_are_found_and_told(corners, edges):
    vertices, faces, rim, at = column(slope, corners, edges=edges)
    fill = tripatch.fill(vertices, faces, rim=rim)
    assert fill.report.corners == at
    assert tripatch.find_corners(vertices, faces, rim, any_number=True).tolist() == at
    requested = tripatch.fill(vertices, faces, rim=rim, method="multi_sided")
    assert requested.report.continuity == ["Free"] * len(at) and distance(requested, slope) < 1e-12


@pytest.mark.parametrize("given", [False, True])
@pytest.mark.parametrize("edges", [2, 8])
@pytest.mark.parametrize("corners", [TRIANGLE, QUADRANGLE, PENTAGON, FLAT_HEXAGON, OCTAGON])
def test_a_lid_over_walls_that_lean_far_under_it_is_flat(corners, edges, given):
    """Less than 30 degrees are between them: a smooth fill would be as large as the hole or many times larger."""
    vertices, faces, rim, at = column(lambda x, y: 0 * x, corners, edges=edges, lean=0.9, depth=0.1)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=at if given else None)
    assert np.abs(fill.vertices[:, 2]).max(initial=0) < 1e-12
    assert says(fill.report, *SHARP)


@pytest.mark.parametrize("continuity", ["G0", "Free"])
def test_sides_met_in_position_only_take_nothing_from_their_neighbors(continuity):
    vertices, faces, rim, at = column(slope, TRIANGLE)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=at, continuity=continuity)
    assert distance(fill, slope) < 1e-12
    assert not fill.report.warnings


@pytest.mark.parametrize("continuity", ["G0", "Free"])
@pytest.mark.parametrize("top", [slope, sphere, saddle])
@pytest.mark.parametrize("corners", [TRIANGLE, QUADRANGLE, OCTAGON])
def test_they_are_the_same_however_these_lean(corners, top, continuity):
    patches = []
    for lean in (-0.3, 0.0, 0.4):
        vertices, faces, rim, at = column(top, corners, edges=4, rows=3, lean=lean)
        method = "side_vertex" if len(at) == 3 else "multi_sided"
        fill = tripatch.fill(vertices, faces, rim=rim, corners=at, continuity=continuity, method=method)
        patches.append(fill.patch)
    places = patches[0].triangles(8)[0]
    for patch in patches:
        assert np.abs(patch.evaluate(places) - patches[0].evaluate(places)).max() < 1e-9


@pytest.mark.parametrize("corners", [TRIANGLE, QUADRANGLE, PENTAGON])
def test_the_angle_to_walls_is_told(corners):
    vertices, faces, rim, _ = column(slope, corners)
    report = tripatch.fill(vertices, faces, rim=rim).report
    assert report.continuity == ["Free"] * len(corners)
    assert all(60 < angle < 120 for angle in report.seam_angle_max_by_side)
    assert 60 < report.seam_angle_rms < 120


def test_g1_is_what_it_is_called_at_sharp_sides_too():
    vertices, faces, rim, at = column(slope, TRIANGLE)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=at, method="side_vertex", continuity="G1")
    assert fill.report.continuity == ["G1"] * 3
    assert distance(fill, slope) > 0.01


@pytest.mark.parametrize("corners", [TRIANGLE, PENTAGON])
def test_the_spline_does_not_run_on_beyond_walls(corners):
    vertices, faces, rim, _ = column(slope, corners)
    fill = tripatch.fill(vertices, faces, rim=rim, method="polyharmonic_spline")
    assert distance(fill, slope) < 1e-12
    assert says(fill.report, "sharp_sides")


@pytest.mark.parametrize("corners", [TRIANGLE, PENTAGON])
def test_g1_makes_the_spline_go_on_from_walls(corners):
    vertices, faces, rim, _ = column(slope, corners)
    fill = tripatch.fill(vertices, faces, rim=rim, method="polyharmonic_spline", continuity="G1")
    assert not says(fill.report, *SHARP)
    assert distance(fill, slope) > 0.15


@pytest.mark.parametrize("method", ["auto", "polyharmonic_spline"])
def test_the_sides_that_a_face_goes_on_beyond_are_continued(method):
    """A cylinder's face that has a wall along one side, and continues beyond the two others."""
    vertices, faces, rim, at = column(cylinder, TRIANGLE)
    wall = [f for f in faces.tolist() if {v % 36 for v in f} <= set(range(13))]
    points, beyond = [*vertices], []
    outer = {}
    for k in [*range(12, 36), 0]:  # the two other sides continue outwards, row by row
        for j in range(5):
            x, y = vertices[k, :2] * (1 + 0.08 * j)
            outer[k, j] = k if j == 0 else len(points)
            if j:
                points.append((x, y, cylinder(x, y)))
    around = [*range(12, 36), 0]
    for a, b in zip(around, around[1:], strict=False):
        beyond += [(outer[b, j], outer[a, j], outer[a, j + 1], outer[b, j + 1]) for j in range(4)]
    fill = tripatch.fill(np.array(points), [*wall, *beyond], rim=rim, corners=at, method=method)
    assert distance(fill, cylinder) < (1e-4 if method == "auto" else 2e-2)
    if method == "auto":
        assert fill.report.continuity == ["G1", "G1", "Free"]  # side 2 runs from corner 0 to corner 1
        assert says(fill.report, "side_sharp")


@pytest.mark.parametrize("n", [2, 3, 4, 8])
def test_no_side_of_a_coarse_sphere_is_sharp(n):
    vertices, faces, rim = octant(n)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=[rim[0], rim[n], rim[2 * n]])
    assert fill.report.continuity == ["G1"] * 3
    vertices, faces = cube_sphere(n + 2)
    left, _ = corner_removed(vertices, faces, 1)
    assert "Free" not in tripatch.fill(vertices, left).report.continuity


@pytest.mark.parametrize(("top", "within"), [(slope, 1e-12), (cylinder, 0.025), (sphere, 0.025), (saddle, 0.04)])
def test_a_face_between_two_walls_comes_back_about_as_it_was(top, within):
    """Two sides that are not continued are left to the spline, which has the rim alone to go by."""
    t = np.linspace(0, 1, 20, endpoint=False)
    arc = 0.4 * np.sin(np.pi * t)
    lens = np.concatenate([np.column_stack([1 - 2 * t, arc]), np.column_stack([2 * t - 1, -arc])])
    vertices, faces, rim, _ = column(top, lens, edges=1)
    fill = tripatch.fill(vertices, faces, rim=rim)
    assert fill.report.triangles_folded == 0
    assert says(fill.report, "sharp_sides")
    assert distance(fill, top) < within


def prism(sides, rows, taper=0.0):
    """Its walls, in rows of quads, and its bottom; the top is open."""
    angles = 2 * np.pi * np.arange(sides) / sides
    circle = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    vertices = np.concatenate([circle * ([1 + taper * k] * 2 + [0]) - [0, 0, 2 * k / rows] for k in range(rows + 1)])
    at = [(k * sides + i, k * sides + (i + 1) % sides) for k in range(rows) for i in range(sides)]
    return vertices, [[a, a + sides, b + sides, b] for a, b in at] + [[rows * sides + i for i in range(sides)][::-1]]


@pytest.mark.parametrize("sides", [4, 5, 6])
@pytest.mark.parametrize("rows", [1, 3])
def test_the_open_end_of_a_prism_is_flat(sides, rows):
    """One edge a side: walls that stand upright tell a box from a coarse ball."""
    vertices, faces = prism(sides, rows)
    turned = np.linalg.qr(np.random.default_rng(sides).normal(size=(3, 3)))[0]
    turned *= np.sign(np.linalg.det(turned))
    fill = tripatch.fill(vertices @ turned.T + 1, faces)
    assert set(fill.report.continuity) == {"Free"} and fill.report.warnings[0].code in SHARP
    assert np.abs((fill.vertices - 1) @ turned[:, 2]).max(initial=0) < 1e-9
    assert fill.report.triangles_folded == 0


def test_the_tip_of_a_coarse_ball_is_no_end_of_a_prism():
    octahedron = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, -1]], float)
    for vertices, faces in ((octahedron, [[1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]]), prism(6, 3, 0.5)):
        fill = tripatch.fill(vertices, faces, rim=tripatch.find_holes(faces)[0])
        assert "Free" not in fill.report.continuity


@pytest.mark.parametrize("given", [True, False])
@pytest.mark.parametrize("continuity", ["auto", "Free", "G0"])
@pytest.mark.parametrize("corners", [TRIANGLE, QUADRANGLE, PENTAGON])
def test_a_flat_lid_over_walls_that_lean_under_it(corners, continuity, given):
    """Less than 60 degrees from the lid to the walls: it folds over the mesh where the rim itself does, and does no harm."""
    vertices, faces, rim, at = column(lambda x, _: 0 * x, 2 * corners, edges=5, rows=3, lean=0.8)
    fill = tripatch.fill(vertices, faces, rim=rim, continuity=continuity, **({"corners": at} if given else {}))
    assert np.abs(fill.vertices[:, 2]).max() < 1e-9
    assert 0 < fill.report.triangles_folded <= fill.report.rim_folded
