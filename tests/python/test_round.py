"""Round rims: patches over a disc, which show no place where they begin."""

import numpy as np
import pytest
import tripatch
from codes import refused, says

PROFILES = {
    "sphere": lambda r: np.sqrt(2 - r * r),
    "paraboloid": lambda r: -0.7 * r * r,
    "cone": lambda r: -0.6 * r,
    "vase": lambda r: np.cos(2 * r) + 0.2 * r**3,
}


def revolved(profile, edges, rings=4, radius=0.5, turn=0.0):
    """A surface of revolution without its middle, as quads: vertices, faces. The rim comes first, from angle `turn` on."""
    angle = turn + 2 * np.pi * np.arange(edges) / edges
    step = 2 * np.pi * radius / edges
    rows = []
    for j in range(rings + 1):
        if profile == "tube":
            r, z = radius, -step * j
        else:
            r = radius + step * j
            z = PROFILES[profile](r)
        rows.append(np.column_stack([r * np.cos(angle), r * np.sin(angle), np.full(edges, z)]))
    n = edges
    faces = [[j * n + (k + 1) % n, j * n + k, (j + 1) * n + k, (j + 1) * n + (k + 1) % n] for j in range(rings) for k in range(n)]
    return np.concatenate(rows), faces


def unevenness(patch, base):
    """How far the patch is from a surface of revolution about z: distances from a point of the axis by the angle to it, against a
    fine spline through them."""
    from scipy.interpolate import LSQUnivariateSpline

    rho, angle = np.sqrt(np.linspace(0, 1, 60))[:, None], 2 * np.pi * np.arange(97)[None] / 97
    points = patch.evaluate(np.column_stack([(rho * np.cos(angle)).ravel(), (rho * np.sin(angle)).ravel()]))
    r, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2] - base
    order = np.argsort(np.arctan2(r, z))
    direction, distance = np.arctan2(r, z)[order], np.hypot(r, z)[order]
    x = np.concatenate([-direction[::-1], direction])
    x = np.sort(x + 1e-13 * np.arange(len(x)))
    y = np.concatenate([distance[::-1], distance])
    return np.abs(LSQUnivariateSpline(x, y, np.linspace(x[0], x[-1], 62)[1:-1], k=5)(x) - y).max()


@pytest.mark.parametrize("edges", [17, 24])
@pytest.mark.parametrize("profile", [*PROFILES, "tube"])
def test_the_end_of_a_surface_of_revolution_is_one_too(profile, edges):
    pytest.importorskip("scipy")
    vertices, faces = revolved(profile, edges)
    fill = tripatch.fill(vertices, faces, rim=np.roll(np.arange(edges), 5), corners=())
    assert fill.report.method == "multi_sided" and "of revolution" in fill.report.method_reason
    assert unevenness(fill.patch, vertices[0, 2] - 0.3) < 1e-6
    assert fill.report.seam_angle_max < 1e-5
    assert fill.report.folds == fill.report.triangles_folded == 0
    np.testing.assert_allclose(fill.patch.evaluate(fill.uv), fill.vertices, atol=1e-12)
    # found without being told; at the end of a straight tube a dome is to be asked for
    found = tripatch.fill(vertices, faces, rim=np.arange(edges), cap="dome" if profile == "tube" else "auto")
    assert found.report.method == "multi_sided" and len(found.report.corners) == 0


def funnel(narrowing, edges):
    """A cone's side below its wide end, which is the rim, of radius 1."""
    angle, down = 2 * np.pi * np.arange(edges) / edges, np.arange(6) / 5
    radius = (1 - narrowing * down)[:, None]
    rows = [radius * np.cos(angle), radius * np.sin(angle), -down[:, None] * np.ones(edges)]
    n = edges
    faces = [[j * n + (k + 1) % n, j * n + k, (j + 1) * n + k, (j + 1) * n + (k + 1) % n] for j in range(5) for k in range(n)]
    return np.stack(rows, axis=-1).reshape(-1, 3), faces


@pytest.mark.parametrize("edges", [20, 36])
@pytest.mark.parametrize("narrowing", [0.1, 0.3, 0.5, 0.9])
def test_the_wide_end_of_a_funnel_gets_a_ball_or_where_that_is_too_high_a_lid(narrowing, edges):
    vertices, faces = funnel(narrowing, edges)
    fill = tripatch.fill(vertices, faces, rim=np.arange(edges))
    assert "of revolution" in fill.report.method_reason
    if narrowing > 0.6:  # it would be twice as high as the rim is wide
        assert np.abs(fill.vertices[:, 2]).max() < 1e-12
        assert fill.report.continuity == ["Free"] and fill.report.warnings[0].code == "flat_all_around"
        return
    assert fill.report.continuity == ["G1"] and not fill.report.warnings
    assert fill.report.seam_angle_max < 1e-5
    points = np.concatenate([fill.vertices, vertices[:edges]])
    center = np.array([0, 0, narrowing])  # of the ball that touches the cone along its rim
    assert np.abs(np.linalg.norm(points - center, axis=1) - np.hypot(1, narrowing)).max() < 1e-5
    tall = tripatch.fill(vertices, faces, rim=np.arange(edges), method="multi_sided")
    assert tall.vertices[:, 2].max() > 1.5  # follows the straight walls


def test_a_cap_is_the_spheres():
    for edges, near in ((17, 2e-4), (36, 2e-5), (64, 4e-6)):
        vertices, faces = revolved("sphere", edges)
        fill = tripatch.fill(vertices, faces, rim=np.arange(edges), corners=())
        assert np.abs(np.linalg.norm(fill.vertices, axis=1) - np.sqrt(2)).max() < near


def turned_places(at, one, other, turn):
    """The same places in the discs of two fills of one rim, of which the other begins farther on: by angles of their own."""
    begin = np.arctan2(one.rim_uv[:, 1], one.rim_uv[:, 0])[round(turn / (2 * np.pi) * len(one.rim))]
    c, s = np.cos(begin), np.sin(begin)
    return at, at @ np.array([[c, -s], [s, c]])


@pytest.mark.parametrize("first", [1, 7, 10, 13, 19])
@pytest.mark.parametrize("uneven", [lambda x, y: x * y, lambda x, y: x**3 - 0.3 * y, lambda x, y: 0.4 * x * x * y + 0.2 * y * y])
def test_where_the_rim_begins_and_which_way_the_mesh_lies_does_not_matter(first, uneven):
    vertices, faces = revolved("paraboloid", 20)
    vertices[:, 2] += 0.05 * uneven(*vertices[:, :2].T)  # no longer of revolution
    at = np.random.default_rng(1).uniform(-0.6, 0.6, (20, 2))
    one = tripatch.fill(vertices, faces, rim=np.arange(20), corners=(), method="multi_sided")
    turn = 2 * np.pi * first / 20
    rolled = np.roll(vertices.reshape(5, 20, 3), -first, axis=1).reshape(-1, 3)
    other = tripatch.fill(rolled, faces, rim=np.arange(20), corners=(), method="multi_sided")
    turned = [
        np.linalg.norm(one.patch.evaluate(p[None]) - other.patch.evaluate(q[None]))
        for p, q in zip(*turned_places(at, one, other, turn))
    ]
    assert max(turned) < 1e-6
    assert np.abs(other.patch.evaluate(other.rim_uv) - rolled[other.rim]).max() < 2e-8
    for fill in (one, other):
        t = np.linspace(0, 1, 9)
        assert (
            np.abs(
                fill.patch.evaluate(np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)]))
                - fill.sides[0].evaluate(t)[0]
            ).max()
            < 1e-9
        )


def test_no_round_patch_where_the_rim_has_corners_or_zigzags():
    vertices, faces = revolved("sphere", 24)
    jagged = vertices.copy()
    jagged[:24] += 0.03 * (-1.0) ** np.arange(24)[:, None] * vertices[:24]
    fill = tripatch.fill(jagged, faces, rim=np.arange(24), corners=())
    assert fill.report.method == "polyharmonic_spline" and "not smooth" in fill.report.method_reason


def closed_side():
    """The rim of a cylinder's end that is cut by a saddle."""

    def c(t):
        a = 2 * np.pi * t
        return np.column_stack([np.cos(a), np.sin(a), 0.2 * np.cos(2 * a)])

    def dc(t):
        a = 2 * np.pi * t
        return 2 * np.pi * np.column_stack([-np.sin(a), np.cos(a), -0.4 * np.sin(2 * a)])

    return tripatch.Side.from_functions(
        c, dc, lambda t: np.column_stack([0 * t, 0 * t, -1 + 0 * t]), q=lambda t: np.zeros((len(t), 3))
    )


@pytest.mark.parametrize("continuity", ["G1", "G2"])
def test_a_patch_in_one_closed_side(continuity):
    side = closed_side()
    patch = tripatch.patch([side], fairing="auto", continuity=continuity)
    t = np.linspace(0, 1, 50)
    rim = np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)])
    assert np.abs(patch.evaluate(rim) - side.evaluate(t)[0]).max() < 1e-11
    assert tripatch.angles(patch.normal(rim), side.evaluate(t)[3]).max() < 1e-5
    if continuity == "G2":  # the normal curvature along the radius is that of the cylinder's lines where it runs along them
        _, first, second = patch.evaluate(rim, 2)
        along = rim[:, :1] * first[:, 0] + rim[:, 1:] * first[:, 1]
        bend = rim[:, :1] ** 2 * second[:, 0] + 2 * rim[:, :1] * rim[:, 1:] * second[:, 1] + rim[:, 1:] ** 2 * second[:, 2]
        normal = np.column_stack([rim, 0 * t])
        across = (along * np.column_stack([-rim[:, 1], rim[:, 0], 0 * t])).sum(axis=1)
        assert np.abs((bend * normal).sum(axis=1) + across**2).max() < 1e-5
    assert patch.energy("auto") >= 0
    middle = tripatch.patch([side], fairing="auto", center=(0.1, 0, 0.7))
    np.testing.assert_allclose(middle.evaluate([[0.0, 0.0]]), [[0.1, 0, 0.7]], atol=1e-12)


def test_derivatives_are_those_of_differences():
    patch = tripatch.patch([closed_side()], fairing="auto")
    at, h = np.array([[0.3, -0.5]]), 1e-5
    _, first, second, third = patch.evaluate(at, 3)
    for axis, step in enumerate(np.eye(2) * h):
        (_, a1, a2), (_, b1, b2) = patch.evaluate(at + step, 2), patch.evaluate(at - step, 2)
        np.testing.assert_allclose((patch.evaluate(at + step) - patch.evaluate(at - step)) / (2 * h), first[:, axis], atol=1e-7)
        np.testing.assert_allclose((a1 - b1) / (2 * h), second[:, axis : axis + 2], atol=1e-6)
        np.testing.assert_allclose((a2 - b2) / (2 * h), third[:, axis : axis + 3], atol=1e-5)


def test_what_is_not_closed_is_refused():
    side = closed_side()
    with refused("single_side_open"):
        tripatch.patch([side.part(0.0, 0.9)])
    with pytest.raises(ValueError, match="for 1 side"):
        tripatch.patch([side], bulge=(1, 2))
    vertices, faces = revolved("sphere", 24)
    with pytest.raises(ValueError, match="for 1 side"):
        tripatch.fill(vertices, faces, rim=np.arange(24), corners=(), bulge=(1, 2, 3))


@pytest.mark.parametrize(("edges", "profile"), [(10, "vase"), (17, "cone"), (24, "tube"), (64, "sphere")])
def test_quads_in_a_round_rim_are_rings_about_a_grid(edges, profile):
    vertices, faces = revolved(profile, edges)
    fill = tripatch.fill(vertices, faces, rim=np.arange(edges), corners=(), output="quads")
    assert fill.report.method == "multi_sided" and {len(f) for f in fill.faces} == {4}
    assert len(fill.split_edges[0]) == edges % 2
    assert len(fill.report.poles) == 4 and {valence for _, valence in fill.report.poles} == {3}
    count = np.bincount(np.concatenate(fill.faces), minlength=len(vertices) + len(fill.vertices))
    inner = np.setdiff1d(np.arange(len(vertices) + edges % 2, len(count)), [v for v, _ in fill.report.poles])
    assert (count[inner] == 4).all()
    everything = np.concatenate([vertices, fill.vertices])
    for face in fill.faces:
        p = everything[face]
        normal = np.cross(p[2] - p[0], p[3] - p[1])
        assert min(np.cross(p[k - 1] - p[k - 2], p[k] - p[k - 1]) @ normal for k in range(4)) > 0
    one = tripatch.fill(vertices, faces, rim=np.arange(edges), corners=(), output="quads", odd="triangle")
    assert sum(len(f) == 3 for f in one.faces) == edges % 2 and len(one.split_edges[0]) == 0
    assert len(one.faces) == len(fill.faces) and one.report.poles[0][1] == 3
    assert says(one.report, "one_triangle") == (edges % 2 == 1)


def test_corners_in_a_round_rim_say_where_rows_of_quads_begin_and_nothing_is_told_of_them():
    vertices, faces = revolved("sphere", 24)
    given = {"rim": np.arange(24), "corners": (0, 5, 12, 17)}
    assert tripatch.fill(vertices, faces, output="quads", **given).report.warnings == []
    assert says(tripatch.fill(vertices, faces, method="multi_sided", **given).report, "straight_corner")  # triangles need none


@pytest.mark.parametrize("profile", ["tube", "cone", "sphere"])
def test_quads_in_a_round_rim_are_as_large_as_its_own(profile):
    """At the end of a tube they were nearly three times as large."""
    vertices, faces = revolved(profile, 32)
    fill = tripatch.fill(vertices, faces, rim=np.arange(32), corners=(), output="quads")
    corners = np.concatenate([vertices, fill.vertices])[np.array(fill.faces)]
    area = np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1) / 2
    assert area.mean() < 1.5 * np.linalg.norm(vertices[1] - vertices[0]) ** 2
    assert (fill.report.rows > 0) == (profile == "tube")


def rim_end(radial, axial, bend):
    """A round rim of radius 1; outwards the surroundings run in this direction, of length 1, and bend so along it."""

    def around(radial, axial):
        return lambda t: np.column_stack([radial * np.cos(2 * np.pi * t), radial * np.sin(2 * np.pi * t), axial + 0 * t])

    def along(t):
        return 2 * np.pi * np.column_stack([-np.sin(2 * np.pi * t), np.cos(2 * np.pi * t), 0 * t])

    return tripatch.Side.from_functions(around(1, 0), along, around(radial, axial), q=around(0, bend))


def end_of(slope, bend):
    """The rim of a profile z(r) with these derivatives at r = 1."""
    steep = np.hypot(1, slope)
    return rim_end(1 / steep, slope / steep, bend / steep**2)


def cone_end(angle):
    """That of a cone whose lines make this angle with its axis: 0 a tube, below that a funnel."""
    return rim_end(np.sin(np.radians(angle)), -np.cos(np.radians(angle)), 0)


def height(patch):
    return patch.evaluate(np.zeros((1, 2)))[0, 2]


def cone(angle, edges, rings=4):
    turn, step, a = 2 * np.pi * np.arange(edges) / edges, 2 * np.pi / edges, np.radians(angle)
    rows = []
    for j in range(rings + 1):
        r = 1 + step * j * np.sin(a)
        rows.append(np.column_stack([r * np.cos(turn), r * np.sin(turn), np.full(edges, -step * j * np.cos(a))]))
    return np.concatenate(rows), revolved("tube", edges, rings)[1]


def test_caps_of_cones_become_lower_evenly_as_the_cone_becomes_flatter():
    angles = list(range(-55, 86, 5))
    heights = np.array([height(tripatch.patch([cone_end(a)], fairing="auto")) for a in angles])
    assert (np.diff(heights) < 0).all()
    assert np.abs(np.diff(heights, 2)).max() < 0.1
    assert 1 < heights[angles.index(0)] < 2 and heights[-1] < 0.1  # of a tube, of a cone that is nearly a disc


@pytest.mark.parametrize("angle", [-20, 0, 5, 20, 40, 60])
def test_caps_of_cones_hang_little_on_the_number_of_edges(angle):
    exact = height(tripatch.patch([cone_end(angle)], fairing="auto"))
    for edges in (12, 16, 24, 40, 48, 64):
        vertices, faces = cone(angle, edges)
        fill = tripatch.fill(vertices, faces, rim=np.arange(edges), corners=(), method="multi_sided")
        assert abs(height(fill.patch) / exact - 1) < 0.1, edges


@pytest.mark.parametrize("edges", [12, 16, 36])
@pytest.mark.parametrize(
    ("profile", "near"),  # of exact sides
    [(lambda r: -0.7 * r * r, 1e-7), (lambda r: 2 * np.sqrt(12 - r * r), 5e-5), (lambda r: 0.5 * np.sqrt(6 - r * r), 5e-5)],
    ids=["paraboloid", "ellipsoid", "flat ellipsoid"],
)
def test_caps_of_quadrics_are_the_quadrics_however_coarse_and_uneven_the_rings(profile, near, edges):
    turn, rng = 2 * np.pi * np.arange(edges) / edges, np.random.default_rng(1)
    radii = 1 + np.cumsum([0, 0.1, 0.25, 0.15])
    rows = [np.column_stack([r * np.cos(turn), r * np.sin(turn), np.full(edges, profile(r))]) for r in radii]
    faces = np.array(revolved("tube", edges, rings=3)[1])
    triangles = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    fill = tripatch.fill(np.concatenate(rows), rng.permutation(triangles), rim=np.arange(edges), corners=(), method="multi_sided")
    r = np.hypot(*fill.vertices[:, :2].T)
    assert np.abs(fill.vertices[:, 2] - profile(r)).max() < near
    assert fill.report.surroundings_error < 1e-6


@pytest.mark.parametrize("edges", [33, 34, 35])
def test_the_cap_of_a_cone_is_of_revolution_though_its_slopes_are_read_unevenly(edges):
    vertices, faces = cone(60, edges)
    fill = tripatch.fill(vertices, faces, rim=np.arange(edges), corners=(), method="multi_sided")
    assert abs(height(fill.patch) / height(tripatch.patch([cone_end(60)], fairing="auto")) - 1) < 0.05


def quadric_cap_error(profile, edges):
    """Over the diameter, of the cap in a hole of radius 1 about the axis."""
    turn, step = 2 * np.pi * np.arange(edges) / edges, 2 * np.pi / edges
    rows = [np.column_stack([r * np.cos(turn), r * np.sin(turn), np.full(edges, profile(r))]) for r in 1 + step * np.arange(5)]
    fill = tripatch.fill(np.concatenate(rows), revolved("tube", edges)[1], rim=np.arange(edges), corners=(), method="multi_sided")
    return np.abs(fill.vertices[:, 2] - profile(np.hypot(*fill.vertices[:, :2].T))).max() / 2


@pytest.mark.parametrize(("edges", "near"), [(16, 2e-5), (24, 1e-6), (64, 1e-7)])
def test_the_cap_of_a_shallow_paraboloid_is_not_a_spheres(edges, near):
    assert quadric_cap_error(lambda r: -0.1 * r * r, edges) < near  # the sphere's: 5e-4


@pytest.mark.parametrize(
    ("profile", "near"),
    [(lambda r: -0.35 * r * r, 2.2e-3), (lambda r: 2 * np.sqrt(12 - r * r), 5e-4)],
    ids=["paraboloid", "ellipsoid"],
)
def test_what_sixteen_edges_do_not_know_of_a_blunt_quadric_does_not_bend_its_cap(profile, near):
    assert quadric_cap_error(profile, 16) < near


@pytest.mark.parametrize("angle", [-20, 0, 40])
def test_the_curvature_of_a_cone_goes_on_in_its_cap(angle):
    patch, rim = tripatch.patch([cone_end(angle)], fairing="auto"), np.array([[1.0, 0.0]])
    _, first, second = patch.evaluate(rim, 2)
    assert abs(second[0, 0] @ patch.normal(rim)[0]) / (first[0, 0] @ first[0, 0]) < 0.02  # that of a sphere: 0.6 to 1


@pytest.mark.parametrize(
    ("slope", "bend", "profile"),
    [
        (-2, -2, lambda r: 1 - r * r),
        (-1 / 3**0.5, -4 / 27**0.5, lambda r: np.sqrt(4 - r * r) - 3**0.5),
        (-(3**0.5), -12 / 27**0.5, lambda r: 3 * np.sqrt(4 - r * r) - 27**0.5),
    ],
    ids=["paraboloid", "sphere", "ellipsoid"],
)
def test_caps_of_blunt_quadrics_are_the_quadrics(slope, bend, profile):
    points = tripatch.patch([end_of(slope, bend)], fairing="auto").evaluate(
        np.column_stack([np.linspace(0, 1, 30), np.zeros(30)])
    )
    assert np.abs(points[:, 2] - profile(np.hypot(points[:, 0], points[:, 1]))).max() < 2e-3


@pytest.mark.parametrize("edges", [12, 16, 24, 32, 40, 64])
def test_the_cap_of_a_tube_is_about_as_high_as_wide(edges):
    """Caps have ever less energy the longer they are: descent must not follow that."""
    vertices, faces = revolved("tube", edges)
    fill = tripatch.fill(vertices, faces, rim=np.arange(edges), corners=())
    assert fill.report.method == "multi_sided" and 0.6 < fill.patch.evaluate(np.zeros((1, 2)))[0, 2] < 1
