"""Patches and fills of four sides and more."""

import warnings

import numpy as np
import pytest
import tripatch
from codes import refused, says
from shapes import octant


def around(n, radius=0.5, per_side=8, rings=6):
    """A sphere's upper half as a grid of triangles in the stereographic plane, with a hole of n straight sides: vertices, faces,
    corners."""
    angles = 2 * np.pi * np.arange(n) / n
    corners = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    t = np.arange(per_side)[:, None] / per_side
    rim = np.concatenate([(1 - t) * corners[i] + t * corners[(i + 1) % n] for i in range(n)])
    step = 1 + 0.1 * np.arange(rings)
    plane = radius * (step[:, None, None] * rim[None]).reshape(-1, 2)
    square = (plane**2).sum(axis=1)
    vertices = np.column_stack([2 * plane, 1 - square]) / (1 + square)[:, None]
    m = len(rim)
    faces = []
    for j in range(rings - 1):
        for k in range(m):
            a, b = j * m + k, j * m + (k + 1) % m
            faces += [[b, a, a + m], [b, a + m, b + m]]
    return vertices, np.array(faces), [per_side * i for i in range(n)]


@pytest.mark.parametrize("n", [4, 5, 6, 8])
def test_a_hole_of_many_sides_in_a_sphere(n):
    vertices, faces, corners = around(n)
    fill = tripatch.fill(vertices, faces, rim=np.arange(8 * n), corners=corners, method="multi_sided")
    assert fill.report.method == "multi_sided"
    assert fill.report.corners == [corners[k] for k in range(n)] or set(fill.report.corners) == set(corners)
    assert len(fill.report.seam_angle_max_by_side) == len(fill.report.continuity) == n
    assert fill.report.seam_angle_max < 1e-5
    assert fill.report.folds == fill.report.triangles_folded == 0
    assert np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max() < (2e-3 if n == 4 else 5e-3)
    np.testing.assert_allclose(fill.patch.evaluate(fill.uv), fill.vertices, atol=1e-12)
    assert fill.patch.domain.shape == (n, 2)
    # with the rim it is a disc: every edge of the rim once, every other one twice
    edges = np.sort(np.concatenate([np.roll(np.array(f), -k)[:2][None] for f in fill.faces for k in range(3)]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    assert (count == 1).sum() == 8 * n and count.max() == 2


def test_four_sides_of_equal_counts_give_a_grid_of_quads():
    vertices, faces, corners = around(4)
    fill = tripatch.fill(vertices, faces, rim=np.arange(32), corners=corners, method="multi_sided", output="quads")
    assert {len(f) for f in fill.faces} == {4} and len(fill.faces) == 64 and len(fill.vertices) == 49
    everything = np.concatenate([vertices, fill.vertices])
    for face in fill.faces:
        p = everything[list(face)]
        normal = np.cross(p[2] - p[0], p[3] - p[1])
        for k in range(4):
            assert np.cross(p[k] - p[k - 1], p[(k + 1) % 4] - p[k]) @ normal > 0


def sines(vertices, fill):
    """Of all corners of the quads, negative where one is turned over."""
    everything, found = np.concatenate([vertices, fill.vertices]), []
    for face in fill.faces:
        if len(face) != 4:
            continue
        p = everything[list(face)]
        normal = np.cross(p[2] - p[0], p[3] - p[1])
        for k in range(4):
            a, b = p[(k + 1) % 4] - p[k], p[k - 1] - p[k]
            found.append(np.cross(a, b) @ normal / np.linalg.norm(normal) / np.linalg.norm(a) / np.linalg.norm(b))
    return np.array(found)


@pytest.mark.parametrize("n", [5, 6, 8, 11])
def test_quads_between_many_sides(n):
    vertices, faces, corners = around(n)
    fill = tripatch.fill(vertices, faces, rim=np.arange(8 * n), corners=corners, method="multi_sided", output="quads")
    assert {len(f) for f in fill.faces} == {4}
    assert sines(vertices, fill).min() > 0.7 and len(fill.report.poles) <= 4
    assert fill.report.seam_angle_max < 1e-5 and not fill.report.warnings
    edges = np.sort(np.concatenate([np.stack([f, np.roll(f, -1)], axis=1) for f in fill.faces]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    assert (count == 1).sum() == 8 * n and count.max() == 2
    valence = [np.sum(np.concatenate(fill.faces) == v) for v, _ in fill.report.poles]
    assert valence == [k for _, k in fill.report.poles]


def test_an_odd_rim_of_many_sides_has_an_edge_split_or_one_triangle():
    vertices, faces, corners = around(5, per_side=5)
    options = {"rim": np.arange(25), "corners": corners, "method": "multi_sided", "output": "quads"}
    split = tripatch.fill(vertices, faces, **options)
    assert {len(f) for f in split.faces} == {4} and len(split.split_edges[0]) == 1
    ends = split.split_edges[0][0]
    middle = vertices[ends].mean(axis=0)
    assert np.linalg.norm(split.vertices[0] - middle) < 0.2 * np.linalg.norm(np.diff(vertices[ends], axis=0))
    one = tripatch.fill(vertices, faces, **options, odd="triangle")
    assert sum(len(f) == 3 for f in one.faces) == 1 and len(one.split_edges[0]) == 0
    assert says(one.report, "one_triangle")
    for fill in (split, one):
        assert sines(vertices, fill).min() > 0.3


def test_auto_takes_one_of_the_two_kinds_and_says_why():
    vertices, faces, corners = around(4)
    egg = vertices * (1, 0.8, 1.3) + 0.05 * vertices[:, :1] * vertices[:, 1:2]
    auto = tripatch.fill(egg, faces, rim=np.arange(32), corners=corners)
    assert auto.report.method in ("polyharmonic_spline", "multi_sided")
    assert "4 smooth sides" in auto.report.method_reason or "the whole surrounding surface" in auto.report.method_reason
    same = tripatch.fill(egg, faces, rim=np.arange(32), corners=corners, method=auto.report.method)
    assert np.array_equal(same.vertices, auto.vertices)
    # what only shapes the fill does not choose another
    bulged = tripatch.fill(egg, faces, rim=np.arange(32), corners=corners, bulge=1.1)
    assert bulged.report.method == auto.report.method


@pytest.mark.parametrize("n", [4, 5, 6, 8])
def test_clear_corners_are_found(n):
    vertices, faces, corners = around(n)
    rim = np.roll(np.arange(8 * n), 5)
    assert sorted(tripatch.find_corners(vertices, faces, rim, any_number=True)) == corners
    found = tripatch.fill(vertices, faces, rim=rim)
    assert sorted(found.report.corners) == corners
    # about other first corners, which the patch does not know of
    assert np.abs(np.linalg.norm(found.vertices, axis=1) - 1).max() < 3e-3


def test_corners_are_not_clear_where_the_rim_is_round_or_zigzags_or_turns_back():
    vertices, faces, _ = around(5)
    rim = np.arange(40)
    angle = 2 * np.pi * np.arange(40) / 40
    round_rim = vertices.copy()
    length = np.linalg.norm(vertices[:, :2], axis=1, keepdims=True)
    for ring in range(6):
        of = slice(40 * ring, 40 * ring + 40)
        round_rim[of, :2] = np.column_stack([np.cos(angle), np.sin(angle)]) * length[of].mean()
        round_rim[of, 2] = vertices[of, 2].mean()
    jagged = vertices.copy()
    jagged[rim, :2] *= 1 + 0.04 * (-1.0) ** rim[:, None]
    notched = vertices.copy()
    notched[4, :2] *= 0.8
    for points in (round_rim, jagged, notched):
        assert len(tripatch.find_corners(points, faces, rim, any_number=True)) in (0, 3)
        assert len(tripatch.fill(points, faces, rim=rim).report.corners) in (0, 3)


def test_the_open_end_of_a_box_is_flat():
    # its four sides meet at right angles: nothing is to be continued
    m = 8
    t = np.arange(m) / m
    square = np.concatenate([np.column_stack(xy) for xy in ((t, 0 * t), (0 * t + 1, t), (1 - t, 0 * t + 1), (0 * t, 1 - t))])
    vertices = np.concatenate([np.column_stack([square, np.full(4 * m, -z / m)]) for z in range(6)])
    n = 4 * m
    faces = [[j * n + (k + 1) % n, j * n + k, (j + 1) * n + k, (j + 1) * n + (k + 1) % n] for j in range(5) for k in range(n)]
    fill = tripatch.fill(vertices, faces, rim=np.arange(n))
    assert fill.report.continuity == ["Free"] * 4
    assert np.abs(fill.vertices[:, 2]).max() < 1e-12


def test_a_corner_that_turns_little_is_no_kink_in_a_side():
    # seven clear corners and one of 15 degrees: of three or four that a window sees nothing good was made
    turns = np.array([60, 40, 15, 60, 45, 50, 45, 45])
    vertices, faces, corners = around(8)
    directions = np.radians(np.cumsum(turns))
    lengths = np.ones(8)
    edges = np.column_stack([np.cos(directions), np.sin(directions)])
    # the lengths nearest to 1 that close it
    lengths -= edges @ np.linalg.solve(edges.T @ edges, edges.sum(axis=0))
    ends = np.cumsum(lengths[:, None] * edges, axis=0)
    ends = (ends - ends.mean(axis=0)) / 3
    t = np.arange(8)[:, None] / 8
    rim = np.concatenate([(1 - t) * ends[i] + t * ends[(i + 1) % 8] for i in range(8)])
    plane = ((1 + 0.1 * np.arange(6))[:, None, None] * rim[None]).reshape(-1, 2)
    vertices = np.column_stack([plane, 0.3 * (plane[:, 0] ** 2 - 0.6 * plane[:, 1] ** 2)])
    assert sorted(tripatch.find_corners(vertices, faces, np.arange(64), any_number=True)) == corners
    fill = tripatch.fill(vertices, faces, rim=np.arange(64))
    off = fill.vertices[:, 2] - 0.3 * (fill.vertices[:, 0] ** 2 - 0.6 * fill.vertices[:, 1] ** 2)
    assert np.abs(off).max() < 1e-4


def test_the_method_can_be_insisted_on():
    vertices, faces, corners = around(5)
    fill = tripatch.fill(vertices, faces, rim=np.arange(40), corners=corners, method="multi_sided")
    assert fill.report.method == "multi_sided" and fill.report.method_reason == "it was requested"
    found = tripatch.fill(vertices, faces, rim=np.arange(40), method="multi_sided")
    assert sorted(found.report.corners) == corners


@pytest.mark.parametrize("output", ["triangles", "quads", "cage"])
@pytest.mark.parametrize("method", ["side_vertex", "quintic"])
@pytest.mark.parametrize("count", [0, 2, 4, 5])
def test_a_method_of_three_sides_says_so_where_it_is_given_others(method, count, output):
    vertices, faces, _ = around(5)
    corners = [40 * k // count for k in range(count)] if count else ()
    with refused("method_takes_three" if count else "method_takes_three_not_round") as caught:
        tripatch.fill(vertices, faces, rim=np.arange(40), corners=corners, method=method, output=output)
    assert method in caught.value.reason
    for found in (tripatch.fill, lambda *mesh, rim, **options: tripatch.fill_all(*mesh, [rim], **options)[0]):
        with pytest.raises(tripatch.Refusal, match="corners"):
            result = found(vertices, faces, rim=np.arange(40), method=method, output=output)
            raise result
    with pytest.raises(ValueError, match="with three sides"):
        tripatch.patch(flat_sides(np.eye(4)[:, :3]), method=method)


def test_where_points_inside_are_met_over_a_polygon_the_report_says_why():
    vertices, faces, corners = around(3)
    inner = vertices[:24].mean(axis=0) + (0, 0, 0.05)
    fill = tripatch.fill(vertices, faces, rim=np.arange(24), corners=corners, method="side_vertex", through=[inner])
    assert (fill.report.method, fill.report.method_reason) == ("multi_sided", "a patch over a polygon meets the points inside")


def flat_sides(corners):
    sides = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = b - a
        out = np.array([along[1], -along[0], 0.0])
        sides.append(
            tripatch.Side.from_functions(
                lambda t, a=a, along=along: a + t[:, None] * along,
                lambda t, along=along: np.broadcast_to(along, (len(t), 3)),
                lambda t, out=out: np.broadcast_to(out, (len(t), 3)),
            )
        )
    return sides


def test_options_by_side_have_one_value_a_side():
    vertices, faces, corners = around(5)
    hole = {"rim": np.arange(40), "corners": corners}
    mixed = tripatch.fill(vertices, faces, **hole, continuity=("G1", "G0", "G1", "Free", "auto"), bulge=(1, 1, 1, 1, 1.5))
    assert mixed.report.continuity == ["G1", "G0", "G1", "Free", "G1"]
    plain = tripatch.fill(vertices, faces, **hole, bulge=1.5)
    assert np.array_equal(tripatch.fill(vertices, faces, **hole, bulge=(1.5,) * 5).vertices, plain.vertices)
    # of side 2 alone: more next to it than next to the others
    fuller = tripatch.fill(vertices, faces, **hole, bulge=(1, 1, 1.5, 1, 1))
    even = tripatch.fill(vertices, faces, **hole, method="multi_sided")
    ends = even.patch.domain
    adjacent = 0.85 * 0.5 * (ends + np.roll(ends, -1, axis=0))
    moved = np.linalg.norm(fuller.patch.evaluate(adjacent) - even.patch.evaluate(adjacent), axis=1)
    assert np.argmax(moved) == 2 and moved[2] > 1.5 * np.sort(moved)[-2]
    for wrong in ({"bulge": (1, 2, 3)}, {"continuity": ("G1",) * 4}):
        with pytest.raises(ValueError, match="for 5 sides; give one, or one per side"):
            tripatch.fill(vertices, faces, **hole, **wrong)
    with pytest.raises(ValueError, match="from 1 to 12, not 13"):
        tripatch.fill(vertices, faces, bulge=(1,) * 13)


def test_a_patch_of_five_sides():
    angles = 2 * np.pi * np.arange(5) / 5
    corners = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    patch = tripatch.patch(flat_sides(corners), fairing="auto", bulge=(1, 1, 2, 1, 1), continuity="G1")
    p, d = patch.evaluate(patch.domain * 0.5, 1)
    assert np.abs(p[:, 2]).max() < 1e-13 and d.shape == (5, 2, 3)
    np.testing.assert_allclose(patch.evaluate(patch.domain), corners, atol=1e-12)
    np.testing.assert_allclose(patch.normal(patch.domain * 0.5), [[0, 0, 1]] * 5, atol=1e-12)
    lifted = tripatch.patch(flat_sides(corners), fairing="auto", through=[(0.1, 0.1, 0.2)])
    assert np.linalg.norm(lifted.evaluate(lifted.domain * 0.3), axis=1).max() < 1
    assert lifted.evaluate(lifted.domain * 0.05)[:, 2].mean() > 0.1
    assert patch.energy("third_derivative") >= 0
    with pytest.raises(ValueError, match="3 values for 5 sides"):
        tripatch.patch(flat_sides(corners), bulge=(1, 2, 3))
    with pytest.raises(ValueError, match="multi_sided"):
        tripatch.patch(flat_sides(corners), method="quintic")
    with refused("sides_apart"):
        tripatch.patch(flat_sides(corners)[:2])
    with pytest.raises(TypeError, match="two to twelve"):
        tripatch.patch([[], *flat_sides(corners)])
    # a side may come in pieces, of different lengths
    sides = flat_sides(corners)
    pieces = [sides[0], [sides[1].part(0, 0.2), sides[1].part(0.2, 1)], *sides[2:]]
    same = tripatch.patch(pieces, fairing="auto")
    np.testing.assert_allclose(same.evaluate(same.on_side(1, [0, 0.5, 1])), [corners[1], corners[1:3].mean(axis=0), corners[2]])
    with refused("pieces_meet_at_angle"):
        tripatch.patch([[sides[0], sides[1]], *sides[2:]])


def lens_around(n, high=0.35, rings=6):
    """A paraboloid about a hole between two parabolas: vertices, faces, corners."""
    t = np.arange(n) / n
    lower = np.column_stack([2 * t - 1, -4 * high * t * (1 - t)])
    rim = np.concatenate([lower, -lower]) * 0.5
    step = 1 + 1.6 / n * np.arange(rings)
    plane = (step[:, None, None] * rim[None]).reshape(-1, 2)
    vertices = np.column_stack([plane, 0.5 * plane[:, 0] ** 2 + 0.3 * plane[:, 1] ** 2])
    m = 2 * n
    quads = [[j * m + (k + 1) % m, j * m + k, j * m + m + k, j * m + m + (k + 1) % m] for j in range(rings - 1) for k in range(m)]
    return vertices, quads, [0, n]


def test_a_hole_of_two_sides():
    vertices, faces, corners = lens_around(12)
    height = lambda p: p[:, 2] - 0.5 * p[:, 0] ** 2 - 0.3 * p[:, 1] ** 2  # noqa: E731
    fill = tripatch.fill(vertices, faces, rim=np.arange(24), corners=corners, method="multi_sided")
    assert fill.report.corners == corners and fill.patch.domain.shape == (2, 2) and len(fill.sides) == 2
    assert np.abs(height(fill.vertices)).max() < 1e-3 and fill.report.seam_angle_max < 1e-5
    np.testing.assert_allclose(fill.patch.evaluate(fill.uv), fill.vertices, atol=1e-12)
    np.testing.assert_allclose(fill.patch.evaluate(fill.rim_uv), vertices[fill.rim], atol=1e-12)
    np.testing.assert_allclose(fill.patch.on_side(1, [0, 1]), fill.patch.domain[::-1], atol=1e-15)
    found = tripatch.fill(vertices, faces, rim=np.roll(np.arange(24), 7))
    assert sorted(found.report.corners) == corners and np.abs(height(found.vertices)).max() < 1e-3
    for wish in ({"bulge": (1, 1.3)}, {"continuity": ("G1", "Free")}, {"tension": 1}, {"center_offset": 0.02}):
        other = tripatch.fill(vertices, faces, rim=np.arange(24), corners=corners, **wish)
        assert other.report.method == "multi_sided" and other.report.folds == 0
        middles = [each.patch.evaluate(np.zeros((1, 2))) for each in (other, fill)]
        assert np.linalg.norm(middles[0] - middles[1]) > 1e-5
    with pytest.raises(ValueError, match="2 sides"):
        tripatch.fill(vertices, faces, rim=np.arange(24), corners=corners, bulge=(1, 1, 1))


@pytest.mark.parametrize("n", [2, 5, 12])
def test_quads_and_cages_between_two_sides(n):
    vertices, faces, corners = lens_around(n)
    fill = tripatch.fill(vertices, faces, rim=np.arange(2 * n), corners=corners, method="multi_sided", output="quads")
    assert {len(f) for f in fill.faces} == {4} and sines(vertices, fill).min() > 0.3
    cage = tripatch.fill(vertices, faces, rim=np.arange(2 * n), corners=corners, output="cage")
    assert {len(f) for f in cage.faces} == {4} and cage.report.folds == cage.report.triangles_folded == 0
    surface, _ = cage.limit(3)
    assert np.abs(surface[:, 2] - 0.5 * surface[:, 0] ** 2 - 0.3 * surface[:, 1] ** 2).max() < 0.3 / n**2


def plane_sides(corners, across):
    """Straight sides of a flat polygon but the first, which lies across(t) times its length next to the line; derivative too."""
    corners = np.asarray(corners, float)

    def side(i):
        a, b = corners[i], corners[(i + 1) % len(corners)]
        along, adjacent = b - a, np.array((a[1] - b[1], b[0] - a[0]))
        off = across if i == 0 else lambda t: (0 * t, 0 * t)

        def c(t):
            return np.column_stack([a + np.outer(t, along) + np.outer(off(np.asarray(t))[0], adjacent), 0 * np.asarray(t)])

        def d(t):
            return np.column_stack([along + np.outer(off(np.asarray(t))[1], adjacent), 0 * np.asarray(t)])

        return tripatch.Side.from_functions(c, d, lambda t: np.cross(d(t), (0.0, 0, 1)))

    return [side(i) for i in range(len(corners))]


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("turn", [-2.0, -1.0, 1.0, 2.0])
@pytest.mark.parametrize("n", [4, 5])
def test_sides_that_hook_beside_a_corner_do_not_throw_the_patch_about(n, turn):
    """Edges of CAD programs do so where fillets of three radii meet: patches reached up to 37 times the size away."""
    angles = 2 * np.pi * np.arange(n) / n
    corners = np.column_stack([np.cos(angles), np.sin(angles)])
    sides = plane_sides(corners, lambda t: (turn * t * (1 - t) ** 80, turn * (1 - t) ** 79 * (1 - 81 * t)))
    places, faces = (patch := tripatch.patch(sides, fairing="auto")).triangles(24)
    assert np.abs(patch.evaluate(places)[:, :2]).max() < 1.1
    assert (patch.normal(places)[:, 2] < 0).mean() < 0.08
    assert len(faces) > 0


@pytest.mark.parametrize("n", [3, 4])
@pytest.mark.parametrize("slow", [0.9, 0.999, 1.0])
def test_a_side_that_ends_slowly_is_run_through_by_length(n, slow):
    """A saddle, one of whose sides slows down to 1 - slow of its mean speed: it came to up to 1e11 times the size."""
    corners = np.array([(0.0, 0), (0.6, 0.06), (0.24, 0.54)] if n == 3 else [(0.0, 0), (0.6, 0.06), (0.66, 0.54), (-0.06, 0.6)])

    def height(x, y):
        return 0.3 * (x * x - y * y) + 0.2 * x * y

    def side(i, share):
        a, along = corners[i], corners[(i + 1) % n] - corners[i]

        def place(t):
            return a + np.outer((1 - share) * t + share * t * t, along)

        def c(t):
            p = place(np.asarray(t))
            return np.column_stack([p, height(*p.T)])

        def d(t):
            (x, y), v = place(np.asarray(t)).T, np.outer(1 - share + 2 * share * np.asarray(t), along)
            return np.column_stack([v, (0.6 * x + 0.2 * y) * v[:, 0] + (0.2 * x - 0.6 * y) * v[:, 1]])

        def across(t):
            x, y = place(np.asarray(t)).T
            return np.cross(d(t), np.column_stack([-0.6 * x - 0.2 * y, 0.6 * y - 0.2 * x, np.ones_like(x)]))

        return tripatch.Side.from_functions(c, d, across)

    sides = [side(i, slow if i == 0 else 0) for i in range(n)]
    patch = tripatch.patch(sides[1:] + sides[:1] if n == 3 else sides, fairing="auto")
    x, y, z = patch.evaluate(patch.triangles(12)[0]).T
    assert np.abs(z - height(x, y)).max() < 1e-4


@pytest.mark.parametrize(("share", "same"), [(0.74, True), (0.76, False)])
def test_only_sides_slower_than_a_quarter_of_their_length_are_run_through_by_length(share, same):
    def c(t):
        return np.outer((1 - share) * t + share * np.asarray(t) ** 2, (1.0, 0, 0))

    def d(t):
        return np.outer(1 - share + 2 * share * np.asarray(t), (1.0, 0, 0))

    side = tripatch.Side.from_functions(c, d, lambda t: np.cross(d(t), (0.0, 0, 1)))
    (middle,) = tripatch._native._joined_side([side], [])[0].evaluate([0.5])[0]
    assert middle[0] == pytest.approx(0.5 - share / 4 if same else 0.5, abs=1e-9)


def torus_sides(speeds=(), bend=0.0):
    """Four sides of a quadrangle in the torus of radii 2 and 1. speeds: of each third of a side; bend: of the two parabolas that
    a side is made of then, whose curvatures have opposite signs."""
    corners = np.array([(-0.7, -0.5), (0.7, -0.5), (0.7, 0.5), (-0.7, 0.5)])

    def pace(t):
        if not speeds:
            return t, np.ones_like(t)
        reached = np.concatenate([[0], np.cumsum(speeds)]) / sum(speeds)
        return np.interp(3 * t, range(4), reached), np.choose(np.minimum(3 * t, 2).astype(int), speeds) * 3 / sum(speeds)

    def hill(s):
        first = s < 0.4
        return (
            bend * np.where(first, s * (0.4 - s), (s - 0.4) * (s - 1) * 2 / 3),
            bend * np.where(first, 0.4 - 2 * s, (2 * s - 1.4) * 2 / 3),
        )

    def side(start, end):
        along, left = end - start, np.array([start[1] - end[1], end[0] - start[0]])

        def place(t):
            (s, speed), rows = pace(np.asarray(t)), np.ones(len(t))
            high, slope = hill(s)
            forward = np.outer(rows, along) + np.outer(slope, left)
            return start + np.outer(s, along) + np.outer(high, left), forward * speed[:, None]

        def c(t):
            u, v = place(t)[0].T
            return np.column_stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)])

        def dc(t):
            (u, v), (du, dv) = (x.T for x in place(t))
            by_u = np.column_stack([-(2 + np.cos(v)) * np.sin(u), (2 + np.cos(v)) * np.cos(u), 0 * u])
            by_v = np.column_stack([-np.sin(v) * np.cos(u), -np.sin(v) * np.sin(u), np.cos(v)])
            return du[:, None] * by_u + dv[:, None] * by_v

        def across(t):
            u, v = place(t)[0].T
            return np.cross(dc(t), np.column_stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)]))

        return tripatch.Side.from_functions(c, dc, across)

    return [side(corners[k], corners[(k + 1) % 4]) for k in range(4)]


def off_torus(patch):
    x, y, z = patch.evaluate(patch.triangles(16)[0]).T
    return np.abs(np.hypot(np.hypot(x, y) - 2, z) - 1).max()


@pytest.mark.parametrize("speeds", [(1, 4, 2), (1, 1.05, 1), (5, 1, 5)])
def test_how_fast_a_side_is_run_through_does_not_matter(speeds):
    """Edges of CAD programs change their speed at once: the patch was 1.9 off."""
    assert off_torus(tripatch.patch(torus_sides(speeds), fairing="auto")) < 2e-5


@pytest.mark.parametrize(("bend", "off"), [(0.01, 2e-4), (0.12, 1e-2)])
def test_sides_whose_curvature_jumps(bend, off):
    """3.5e-4 where kinks that are next to none were measured with the energy, 6e-2 where the shape is in them and none were."""
    assert off_torus(tripatch.patch(torus_sides(bend=bend), fairing="minimum_variation")) < off


@pytest.mark.parametrize("n", [3, 4, 5])
def test_a_patch_that_folds_says_so_and_one_that_does_not_says_nothing(n):
    """A bulge of twelve times the side's own turns a flat polygon over; the normals themselves tell."""
    angles = 2 * np.pi * np.arange(n) / n
    sides = plane_sides(np.column_stack([np.cos(angles), np.sin(angles)]), lambda t: (0 * t, 0 * t))
    sides = sides[1:] + sides[:1] if n == 3 else sides
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        flat = tripatch.patch(sides, fairing=None)
    with pytest.warns(UserWarning, match="folds over itself at [0-9]+ places"):
        turned = tripatch.patch(sides, fairing=None, bulge=12)
    places = flat.triangles(12)[0]
    assert (flat.normal(places)[:, 2] > 0).all()
    assert (turned.normal(places)[:, 2] < 0).any()


def test_a_round_patch_whose_side_leads_outwards_says_that_it_folds():
    def circle(t):
        return np.column_stack([np.cos(turn := 2 * np.pi * np.asarray(t)), np.sin(turn), 0 * turn])

    def along(t):
        return 2 * np.pi * circle(np.asarray(t) + 0.25)

    with pytest.warns(UserWarning, match="folds over itself at [0-9]+ places"):
        tripatch.patch([tripatch.Side.from_functions(circle, along, lambda t: -circle(t))], fairing=None)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tripatch.patch([tripatch.Side.from_functions(circle, along, circle)], fairing=None)


@pytest.mark.parametrize("edges", [10, 16, 40])
def test_what_closes_the_base_of_a_flat_cone_stays_at_the_hole(edges):
    # its wall continues outwards: a surface of revolution that continues it came back from 1.3 diameters away
    angles = 2 * np.pi * np.arange(edges) / edges
    circle = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    vertices = np.concatenate([circle, 0.6 * circle + [0, 0, 0.3], [[0, 0, 0.75]]])
    following = (np.arange(edges) + 1) % edges
    faces = [[j, k, edges + k, edges + j] for j, k in enumerate(following)]
    faces += [[edges + j, edges + k, 2 * edges] for j, k in enumerate(following)]
    fill = tripatch.fill(vertices, faces, rim=range(edges))  # named: what is so flat may be a sheet
    assert np.linalg.norm(fill.vertices, axis=1).max() < 2
    assert fill.report.triangles_folded <= fill.report.rim_folded  # the solid's own edge is that sharp


@pytest.mark.parametrize("sides", [1, 3, 4])
def test_places_on_a_side_are_the_sides_own(sides):
    if sides == 1:
        angle = 2 * np.pi * np.arange(24) / 24
        rings = [np.column_stack([r * np.cos(angle), r * np.sin(angle), np.full(24, -0.5 * r * r)]) for r in (0.5, 0.6, 0.7, 0.8)]
        vertices, at = np.concatenate(rings), np.arange(24)
        faces = [
            np.stack([at + 24 * j, at + 24 * (j + 1), np.roll(at, -1) + 24 * (j + 1), np.roll(at, -1) + 24 * j], 1)
            for j in range(3)
        ]
        fill = tripatch.fill(vertices, np.concatenate(faces)[:, ::-1], rim=at, corners=())
    elif sides == 3:
        vertices, faces, rim = octant(6)
        fill = tripatch.fill(vertices, faces, rim=rim, method="side_vertex")
    else:
        vertices, faces, corners = around(4)
        fill = tripatch.fill(vertices, faces, rim=np.arange(32), corners=corners, method="multi_sided")
    t = np.array([0, 0.125, 0.5, 1])
    for i in range(sides):
        places = fill.patch.on_side(i, t)
        np.testing.assert_allclose(fill.patch.evaluate(places), fill.sides[i].evaluate(t)[0], atol=1e-9)


def test_triangles_of_a_patch_take_one_edge_and_parameters_by_side():
    vertices, faces, rim = octant(6)
    patch = tripatch.fill(vertices, faces, rim=rim, method="side_vertex").patch
    b, triangles = patch.triangles(1, resolution=1)
    assert b.shape == (3, 3) and triangles.shape == (1, 3)
    b, _ = patch.triangles([[0, 0.25, 1], 2, 1])
    assert {tuple(row) for row in np.round(b, 9).tolist()} >= {(0, 0.75, 0.25), (0.5, 0, 0.5)}
    for wrong, told in (([[0.1, 1], 1, 1], r"edges\[0\]"), ([1, [0, 0.5], 1], r"edges\[1\]"), ([1, 1, [[0, 1]]], r"edges\[2\]")):
        with pytest.raises(ValueError, match=told):
            patch.triangles(wrong)
    with pytest.raises(TypeError, match="edges must be of type int"):
        patch.triangles([1.5, 1, 1])
    for wrong in (True, 1.0):
        with pytest.raises(TypeError, match="derivatives must be of type int"):
            patch.evaluate(b, derivatives=wrong)


def test_parameters_of_sides_go_from_0_to_1():
    def line(t):
        return np.outer(t, [1.0, 0, 0])

    def functions(rim):
        return tripatch.Side.from_functions(
            line, lambda t: line(np.ones_like(t)), lambda t: np.tile([0, 0, 1.0], (len(t), 1)), rim
        )

    for rim in ([0, 1], [0, 0.5, 1]):
        assert functions(rim).evaluate([0.5])[0][0] == pytest.approx([0.5, 0, 0])
    for rim in ([0], [0, 0.5, 0.9], [0.1, 1], [0, 0.5, 0.4, 1], [[0, 1]]):
        with pytest.raises(ValueError, match="rim must increase from 0 to 1"):
            functions(rim)
    for t in (1.5, -0.1):
        with pytest.raises(ValueError, match="t must be from 0 to 1"):
            functions(None).evaluate([t])
