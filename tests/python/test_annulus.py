"""Rings of faces between two boundaries: fillets, pipes, islands."""

import numpy as np
import pytest
import tripatch
from codes import says

TURN = 2 * np.pi


def circle(n, radius, z, begin=0.0):
    angle = begin + TURN * np.arange(n) / n
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(n, z)])


def tube(rings, first=0, flip=False):
    """Vertices and quads between rings of as many points each."""
    n = len(rings[0])
    at = first + np.arange(len(rings) * n).reshape(len(rings), n)
    faces = [[a, b, c, d] for r, s in zip(at, at[1:], strict=False) for a, b, c, d in zip(r, np.roll(r, -1), np.roll(s, -1), s)]
    return np.concatenate(rings), [face[::-1] for face in faces] if flip else faces


def joined(*parts):
    """Vertices, faces, and the numbers of each part's vertices."""
    points, faces, first, numbers = [], [], 0, []
    for vertices, own in parts:
        points.append(vertices)
        faces += [[first + int(v) for v in face] for face in own]
        numbers.append(first + np.arange(len(vertices)))
        first += len(vertices)
    return np.concatenate(points), faces, numbers


def boss_on_plate(m=32, n=32, begin=0.0):
    """A plate with a hole of radius 1.3, a boss of radius 0.9 that begins 0.4 above it."""
    plate = tube([circle(m, r, 0) for r in (2.2, 1.9, 1.6, 1.3)])
    boss = tube([circle(n, 0.9, z, begin) for z in (0.4, 0.7, 1.0, 1.5)])
    vertices, faces, numbers = joined(plate, boss)
    return vertices, faces, numbers[0][-m:], numbers[1][:n]


def off_fillet(points):
    return np.hypot(np.hypot(points[:, 0], points[:, 1]) - 1.3, points[:, 2] - 0.4) - 0.4


def bent_pipe(gap, m=32, n=32, large=2.0, small=0.5):
    """A pipe bent to a torus with a gap of so many degrees."""
    half = np.radians(gap) / 2

    def ring(angle, count, begin):
        c = circle(count, small, 0, begin)
        across = large + c[:, 0]
        return np.column_stack([across * np.cos(angle), across * np.sin(angle), c[:, 1]])

    first = tube([ring(-half - 0.1 * k, m, 0.0) for k in range(6)], flip=True)
    second = tube([ring(half + 0.1 * k, n, 0.1) for k in range(6)])
    vertices, faces, numbers = joined(first, second)
    return vertices, faces, numbers[0][:m], numbers[1][:n]


def off_torus(points, large=2.0, small=0.5):
    return np.hypot(np.hypot(points[:, 0], points[:, 1]) - large, points[:, 2]) - small


def check_closed(vertices, faces, fill, open_edges):
    """Every edge of the filled mesh has two faces, run along both ways, but those of borders that are left."""
    every = {}
    for face in [*faces, *np.asarray(fill.faces, dtype=object).tolist()]:
        face = [int(v) for v in face]
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            assert (a, b) not in every
            every[a, b] = True
    assert sum((b, a) not in every for a, b in every) == open_edges


def irregular(fill, count):
    """Vertices of the fill with another number of its faces than 4 inside, 2 on the rim."""
    corners = np.bincount(np.concatenate([np.asarray(face, int) for face in fill.faces]), minlength=count + len(fill.vertices))
    wanted = np.full(len(corners), 4)
    wanted[:count] = 0
    wanted[fill.rim] = 2
    return int((corners != wanted).sum())


@pytest.mark.parametrize(("m", "n", "begin"), [(32, 32, 0.0), (32, 32, 0.05), (32, 24, 0.3), (24, 40, 0.1)])
@pytest.mark.parametrize("output", ["triangles", "quads"])
def test_a_boss_on_a_plate_gets_the_fillet(m, n, begin, output):
    vertices, faces, hole, boss = boss_on_plate(m, n, begin)
    fill = tripatch.fill(vertices, faces, rim=hole, islands=[boss], output=output)
    assert fill.report.method == "annulus", fill.report.method_reason
    off = off_fillet(fill.vertices)
    assert np.sqrt((off**2).mean()) < 0.005 * 0.4 and abs(off).max() < 0.02 * 0.4
    assert fill.report.seam_angle_max < 1e-5
    assert fill.report.boundary_gap < 1e-9
    check_closed(vertices, faces, fill, m + n)
    if output == "quads":
        assert irregular(fill, len(vertices)) <= abs(m - n)
        assert sum(len(face) == 3 for face in fill.faces) <= abs(m - n) % 2


@pytest.mark.parametrize("gap", [20, 60, 90])
@pytest.mark.parametrize("n", [32, 38])
def test_the_gap_of_a_bent_pipe_is_closed_by_its_torus(gap, n):
    vertices, faces, first, second = bent_pipe(gap, n=n)
    fill = tripatch.fill(vertices, faces, rim=first, islands=[second], output="quads")
    assert fill.report.method == "annulus", fill.report.method_reason
    off = off_torus(fill.vertices)
    assert np.sqrt((off**2).mean()) < 0.005 * 0.5 and abs(off).max() < 0.02 * 0.5
    check_closed(vertices, faces, fill, 32 + n)


def test_the_order_and_direction_in_which_boundaries_are_given_change_nothing():
    vertices, faces, hole, boss = boss_on_plate(32, 24, 0.3)
    one = tripatch.fill(vertices, faces, rim=hole, islands=[boss], output="quads")
    other = tripatch.fill(vertices, faces, rim=np.roll(hole[::-1], 5), islands=[np.roll(boss, 3)[::-1]], output="quads")
    np.testing.assert_allclose(one.vertices, other.vertices, atol=1e-12)


def test_boundaries_that_face_opposite_ways_are_refused():
    vertices, faces, hole, boss = boss_on_plate()
    turned = [face[::-1] if set(face) & set(boss.tolist()) or min(face) >= min(boss) else face for face in faces]
    with pytest.raises(tripatch.Refusal, match="opposite ways"):
        tripatch.fill(vertices, turned, rim=hole, islands=[boss], method="annulus")


def test_the_method_takes_two_boundaries_and_no_more():
    vertices, faces, hole, boss = boss_on_plate()
    for output in ("triangles", "cage"):
        with pytest.raises(tripatch.Refusal, match="joins two boundaries"):
            tripatch.fill(vertices, faces, rim=hole, method="annulus", output=output)
        (refused,) = tripatch.fill_all(vertices, faces, rims=[hole], method="annulus", output=output)
        assert refused.code == "ring_takes_two"


@pytest.mark.parametrize("n", [32, 24])
def test_a_cage_joins_two_boundaries(n):
    """Its limit surface is a pipe as wide as that of the cage on both sides."""
    vertices, faces, first, second = bent_pipe(40, 32, n)
    options = {"rim": first, "islands": [second], "output": "cage"}
    fill = tripatch.fill(vertices, faces, **options)
    check_closed(vertices, faces, fill, 32 + n)
    assert all(len(face) == 4 for face in fill.faces) and not fill.report.warnings and fill.report.rows == 0
    assert np.abs(off_torus(fill.limit()[0])).max() < 0.03 * 0.5
    more = tripatch.fill(vertices, faces, **options, resolution=2)
    assert more.report.rows == 2 and len(more.faces) > len(fill.faces)
    assert says(tripatch.fill(vertices, faces, **options, cage_rim="exact").report, "options_need_smooth_sides")


@pytest.mark.parametrize("make", [boss_on_plate, lambda: bent_pipe(40)])
def test_fill_all_joins_boundaries_that_face_each_other(make):
    vertices, faces, first, second = make()
    (fill,) = (fill for fill in tripatch.fill_all(vertices, faces) if len(fill.loops) > 1)
    assert fill.report.method == "annulus"
    assert set(fill.rim) == {*first, *second}


def test_values_at_the_boundaries_are_blended_between_them():
    vertices, faces, hole, boss = boss_on_plate(32, 24)
    fill = tripatch.fill(vertices, faces, rim=hole, islands=[boss])
    assert fill.loops == [32, 24]
    weights = tripatch.attribute_weights(fill)
    values = np.repeat([0.0, 1.0], [64, 48])[:, None]
    blended = weights(values)[:, 0]
    assert (blended > 0).all() and (blended < 1).all()
    up = fill.vertices[:, 2] / 0.4  # from the plate to the boss
    assert np.corrcoef(up, blended)[0, 1] > 0.9


def test_an_island_in_a_hole_of_a_dome_is_filled_around():
    x, y = np.meshgrid(np.linspace(-1.6, 1.6, 33), np.linspace(-1.6, 1.6, 33))
    vertices = np.column_stack([x.ravel(), y.ravel(), 1 - 0.25 * (x**2 + y**2).ravel()])
    quads = [[33 * j + i, 33 * j + i + 1, 33 * j + i + 34, 33 * j + i + 33] for j in range(32) for i in range(32)]
    middle = np.hypot(*vertices[quads].mean(axis=1)[:, :2].T)
    faces = [face for face, r in zip(quads, middle, strict=True) if not 0.35 < r < 0.95]
    (fill,) = tripatch.fill_all(vertices, faces, output="quads")
    assert len(fill.loops) == 2
    off = fill.vertices[:, 2] - 1 + 0.25 * (fill.vertices[:, :2] ** 2).sum(axis=1)
    assert abs(off).max() < 0.01
    assert np.hypot(*fill.vertices[:, :2].T).min() > 0.3


def dome_with_island(n=32, half=1.6):
    """A dome of squares with a wide ragged hole and a ragged disc in the middle of it."""
    at = np.linspace(-half, half, n + 1)
    x, y = (each.ravel() for each in np.meshgrid(at, at, indexing="ij"))
    v = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = np.stack([v[:-1, :-1], v[1:, :-1], v[1:, 1:], v[:-1, 1:]], axis=-1).reshape(-1, 4)
    vertices = np.column_stack([x, y, 1 - 0.25 * (x * x + y * y)])
    radius = np.linalg.norm(vertices[quads].mean(axis=1)[:, :2], axis=1)
    faces = quads[(radius < 0.35) | (radius > 0.95)].tolist()
    outer, hole, island = sorted(tripatch.find_holes(faces), key=len, reverse=True)
    return vertices, faces, hole, island


def test_ragged_boundaries_are_joined_by_quads_on_the_surface_around_them():
    vertices, faces, hole, island = dome_with_island()
    fill = tripatch.fill(vertices, faces, rim=hole, islands=[island], output="quads")
    assert sum(len(face) == 3 for face in fill.faces) <= 0.05 * len(fill.faces)
    assert fill.report.triangles_folded == 0
    x, y, z = fill.vertices.T
    assert abs(z - 1 + 0.25 * (x * x + y * y)).max() < 1e-3
    check_closed(vertices, faces, fill, 4 * 32)


def pipe_end(middle, way, up, n=24, radius=0.4):
    """A straight piece of pipe that ends at a point, where it continues in a direction."""
    way, up = np.asarray(way, float), np.asarray(up, float)
    c = circle(n, radius, 0)
    ring = c[:, :1] * up + c[:, 1:2] * np.cross(way, up)
    return tube([np.asarray(middle) + ring - s * way for s in (0, 0.15, 0.3, 0.45, 0.6)], flip=True)


@pytest.mark.parametrize("bend", [60, 90, 120])
def test_the_ends_of_two_pipes_are_one_hole_around_wide_bends(bend):
    a = np.radians(bend)
    first = pipe_end((0, 0, 0), (1, 0, 0), (0, 0, 1))
    second = pipe_end((np.sin(a), 0, 1 - np.cos(a)), (-np.cos(a), 0, -np.sin(a)), (-np.sin(a), 0, np.cos(a)))
    vertices, faces, numbers = joined(first, second)
    loops = [each[:24].tolist() for each in numbers]
    assert sum(map(len, tripatch.borders.islands_of(vertices, faces, loops, parts=False))) == 1
    fill = tripatch.fill(vertices, faces, rim=loops[0], islands=[loops[1]], output="quads")
    off = np.hypot(np.hypot(fill.vertices[:, 0], fill.vertices[:, 2] - 1) - 1, fill.vertices[:, 1]) - 0.4
    assert abs(off).max() < 0.02 * 0.4


@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize("radii", [(0.45, 0.45, 0.45), (0.3, 0.5, 0.4), (0.5, 0.4, 0.4)])
def test_the_three_arms_of_a_joint_are_one_hole(radii, output):
    arms = []
    for k, radius in enumerate(radii):
        turn = TURN * k / 3
        out = np.array([np.cos(turn), np.sin(turn), 0])
        arms.append(pipe_end(1.2 * out, -out, (0, 0, 1), radius=radius))
    vertices, faces, numbers = joined(*arms)
    loops = [each[:24].tolist() for each in numbers]
    islands = tripatch.borders.islands_of(vertices, faces, loops, parts=False)
    outer = max(range(3), key=lambda k: len(islands[k]))
    assert sorted([outer, *islands[outer]]) == [0, 1, 2]
    fill = tripatch.fill(vertices, faces, rim=loops[outer], islands=[loops[k] for k in islands[outer]], output=output)
    assert fill.report.triangles_folded == 0 and not fill.report.crosses_itself
    if output == "quads":
        assert sum(len(face) == 3 for face in fill.faces) <= 0.05 * len(fill.faces)
    check_closed(vertices, faces, fill, 3 * 24)


def side_of_torus(angle, onward, large=2.0, small=0.5):
    """The circle of a torus at an angle, whose surface continues at larger angles, or smaller ones, where the hole is."""

    def c(t):
        x = TURN * t * onward
        across = large + small * np.cos(x)
        return np.column_stack([across * np.cos(angle), across * np.sin(angle), small * np.sin(x)])

    def dc(t):
        x = TURN * t * onward
        across = -small * np.sin(x)
        return TURN * onward * np.column_stack([across * np.cos(angle), across * np.sin(angle), small * np.cos(x)])

    def r(t):
        across = large + small * np.cos(TURN * t)
        return -onward * np.column_stack([-across * np.sin(angle), across * np.cos(angle), 0 * t])

    return tripatch.Side.from_functions(c, dc, r)


def test_a_patch_between_two_closed_sides_is_a_ring():
    first, second = side_of_torus(0.0, 1), side_of_torus(np.pi / 2, -1)
    ring = tripatch.patch([first, second])
    assert ring.report.method == "annulus" and ring.report.seam_angle_max < 1e-5
    places, faces = ring.triangles([32, 24])
    points = ring.evaluate(places)
    assert abs(off_torus(points)).max() < 0.02 * 0.5
    t = np.linspace(0, 1, 9)[:-1]
    for i, side in enumerate((first, second)):
        np.testing.assert_allclose(ring.evaluate(ring.on_side(i, t)), side.evaluate(t)[0], atol=1e-9)
    np.testing.assert_allclose(points[:32], first.evaluate(np.arange(32) / 32)[0], atol=1e-9)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 1).sum() == 32 + 24
    with pytest.raises(ValueError, match="no energy"):
        ring.energy("thin_plate")
