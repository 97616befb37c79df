"""Fills that stay a subdivision cage."""

import numpy as np
import pytest
import tripatch
from codes import refused, says
from shapes import bevelled_corner, corner_removed, cube, cube_sphere, octant
from tripatch import _arrays, _native, words


def closed(vertices, faces, fill, replaced=()):
    """The mesh with the fill in it."""
    points = np.concatenate([vertices, fill.vertices])
    points[fill.moved[0]] = fill.moved[1]
    gone = set(replaced)
    kept = [list(face) for f, face in enumerate(faces) if f not in gone]
    for k, (a, b) in enumerate(fill.split_edges[0]):
        for face in kept:
            for place in range(len(face)):
                if {face[place], face[(place + 1) % len(face)]} == {a, b}:
                    face.insert(place + 1, len(vertices) + k)
                    break
    return points, [*kept, *map(list, fill.faces)]


def open_corner(rings=2, n=8):
    vertices, faces = cube_sphere(n)
    left, gone = corner_removed(vertices, faces, rings)
    rim = next(r for r in tripatch.find_holes(left) if len(r) == 6 * rings)
    return vertices, faces, left, gone, rim


@pytest.mark.parametrize("rings", [1, 2, 3])
@pytest.mark.parametrize("cage_rim", ["smooth", "exact", "move"])
def test_the_cage_closes_the_hole_with_one_pole(rings, cage_rim):
    vertices, _, left, _, rim = open_corner(rings)
    fill = tripatch.fill(vertices, left, rim=rim, output="cage", cage_rim=cage_rim, resolution=0)
    points, faces = closed(vertices, left, fill)
    assert tripatch.find_holes(faces) == []
    assert {len(face) for face in fill.faces} == {4}
    assert len(fill.faces) == 3 * rings * rings
    assert [valence for _, valence in fill.report.poles] == [3]
    assert np.isfinite(points).all()
    r = fill.report
    if cage_rim != "exact":
        assert r.seam_angle_max < 1e-4  # one smooth surface
        assert len(fill.creases[0]) == 0
    else:
        assert r.surroundings_moved_max < 1e-12
        assert len(fill.creases[0]) == len(rim)
    assert (len(fill.moved[0]) > 0) == (cage_rim == "move")


def test_the_report_is_what_an_independent_evaluation_finds():
    vertices, _, left, _, rim = open_corner()
    fill = tripatch.fill(vertices, left, rim=rim, output="cage", resolution=0)
    points, faces = closed(vertices, left, fill)
    before = _native.limit_points(*_arrays.mesh(vertices, left))
    after = _native.limit_points(*_arrays.mesh(points, faces))
    ring = sorted({v for face in left if set(face) & set(rim.tolist()) for v in face})
    moved = np.linalg.norm(after[ring] - before[ring], axis=1)
    # cage vertices on the limit lie between the samples of the report, and the corners are where most happens
    assert moved.max() == pytest.approx(fill.report.corners_moved_max, rel=1e-6)
    limit, quads = fill.limit(3)
    assert quads.shape[1] == 4
    inside = after[len(vertices) :]
    assert max(np.linalg.norm(limit - p, axis=1).min() for p in inside) < 1e-12


def test_a_region_to_be_replaced_stays_near_the_whole_cage():
    vertices, faces, _, gone, rim = open_corner()
    fill = tripatch.fill(vertices, faces, rim=rim, replaced=gone, output="cage", resolution=0)
    diameter = np.linalg.norm(vertices[rim][:, None] - vertices[rim], axis=-1).max()
    assert fill.report.surroundings_moved_rms < 1e-3 * diameter
    assert fill.report.corners_moved_max < 1e-3 * diameter


def limit_on_sphere(n, rings):
    """The cube-sphere whose limit points at the vertices lie on the unit sphere, without a corner; the diameter of the hole."""
    vertices, faces = cube_sphere(n)
    wanted = vertices.copy()
    for _ in range(40):
        vertices = vertices + wanted - _native.limit_points(*_arrays.mesh(vertices, faces))
    left, gone = corner_removed(vertices, faces, rings)
    rim = next(r for r in tripatch.find_holes(left) if len(r) == 6 * rings)
    corners = [v for v in rim if sum(v in face for face in left) == 3]
    diameter = np.linalg.norm(vertices[rim][:, None] - vertices[rim], axis=-1).max()
    return vertices, faces, left, gone, {"rim": rim, "corners": corners, "output": "cage"}, diameter


@pytest.mark.parametrize(("n", "rings"), [(6, 2), (8, 2), (8, 3)])
@pytest.mark.parametrize("cage_rim", ["smooth", "move"])
def test_a_hole_in_a_sphere_is_closed_by_a_sphere(n, rings, cage_rim):
    vertices, _, left, _, where, diameter = limit_on_sphere(n, rings)
    fill = tripatch.fill(vertices, left, cage_rim=cage_rim, **where)
    off = np.linalg.norm(fill.limit(3)[0], axis=1) - 1
    assert np.sqrt(np.mean(off**2)) < 1.5e-3 * diameter
    assert fill.report.cage_deviation_rms < 1e-3 * diameter
    assert fill.report.fairing == "minimum_variation"
    assert fill.report.energy_after < 0.2 * fill.report.energy_before


@pytest.mark.parametrize(("n", "rings"), [(6, 3), (8, 2), (8, 3)])
def test_a_region_of_a_sphere_is_replaced_by_a_sphere(n, rings):
    vertices, faces, _, gone, where, diameter = limit_on_sphere(n, rings)
    fill = tripatch.fill(vertices, faces, replaced=gone, **where)
    off = np.linalg.norm(fill.limit(3)[0], axis=1) - 1
    assert np.sqrt(np.mean(off**2)) < 1.5e-3 * diameter
    assert fill.report.surroundings_moved_rms < 4e-4 * diameter


@pytest.mark.parametrize("scale", [(1, 1, 1), (1.5, 1.2, 0.9)])
@pytest.mark.parametrize("n", [6, 8, 12])
def test_an_octant_that_is_replaced_lies_as_near_as_one_that_was_deleted(n, scale):
    vertices, faces, left, gone, where, diameter = limit_on_sphere(n, n // 2)
    replaced, deleted = (
        tripatch.fill(vertices * scale, mesh, rim=where["rim"], output="cage", **options)
        for mesh, options in ((faces, {"replaced": gone}), (left, {}))
    )
    off = [np.abs(np.linalg.norm(fill.limit(3)[0] / scale, axis=1) - 1) for fill in (replaced, deleted)]
    assert off[0].max() <= off[1].max() + 1e-6 * diameter
    assert np.sqrt(np.mean(off[0] ** 2)) <= np.sqrt(np.mean(off[1] ** 2)) + 1e-6 * diameter


@pytest.mark.parametrize("crease", [1.0, 0.6])
def test_a_crease_that_enters_a_hole_on_both_sides_runs_through(crease):
    vertices, faces = cube(8)
    top = {v for v in range(len(vertices)) if vertices[v, 2] > 0.999 and np.abs(vertices[v, :2]).max() > 0.999}
    edges = sorted({(min(e), max(e)) for f in faces for e in zip(f, np.roll(f, -1), strict=True) if set(e) <= top})
    left, _ = corner_removed(vertices, faces, 2)
    rim = next(r for r in tripatch.find_holes(left) if len(r) == 12)
    kept = {frozenset(e) for f in left for e in zip(f, np.roll(f, -1), strict=True)}
    edges = [e for e in edges if frozenset(e) in kept]
    subdivision = {"edge_creases": (np.array(edges), np.full(len(edges), crease))}
    fill = tripatch.fill(vertices, left, rim=rim, output="cage", resolution=0, subdivision=subdivision)
    assert len(fill.creases[0]) == 4
    assert fill.creases[1] == pytest.approx(crease, abs=0.01)
    ends = np.bincount(fill.creases[0].ravel())
    assert sorted(ends[ends > 0].tolist()) == [1, 1, 2, 2, 2]  # one line from the rim to the rim


@pytest.mark.parametrize("option", [{"fairing": "third_derivative"}, {"fairing": None}, {"tension": 0.2}, {"bulge": 1.4}])
def test_a_cage_takes_the_shape_that_is_asked_of_the_patch(option):
    vertices, _, left, _, rim = open_corner()
    plain, asked = (tripatch.fill(vertices, left, rim=rim, output="cage", resolution=1, **o) for o in ({}, option))
    limit = asked.limit(2)[0]
    own = asked.patch.evaluate(np.random.default_rng(1).dirichlet([1, 1, 1], 20000))
    distance = [np.linalg.norm(own - p, axis=1).min() for p in limit[:: max(1, len(limit) // 50)]]
    assert np.median(distance) < 8e-3
    assert np.abs(asked.vertices - plain.vertices).max() > 1e-4


def test_exact_meets_its_surroundings_better_on_a_finer_cage():
    medians = []
    for n in (6, 12, 24):
        vertices, _, left, _, rim = open_corner(n // 6 * 2, n)
        r = tripatch.fill(vertices, left, rim=rim, output="cage", cage_rim="exact", resolution=0).report
        medians.append(r.seam_angle_median)
    assert medians[0] > 3 * medians[1] > 9 * medians[2]


@pytest.mark.parametrize("odd", ["split", "triangle"])
def test_an_odd_rim(odd):
    vertices, faces = cube_sphere(6)
    left, _ = corner_removed(vertices, faces, 2)
    rim = next(r for r in tripatch.find_holes(left) if len(r) == 12)
    # one more face of the surroundings taken out and its corner closed off by a triangle: 13 rim edges
    face = next(f for f in left if len(set(f) & set(rim.tolist())) == 2)
    pair = [k for k in range(4) if face[k] in set(rim.tolist()) and face[(k + 1) % 4] in set(rim.tolist())][0]
    turned = face[pair:] + face[:pair]
    left = [f for f in left if f != face] + [[turned[1], turned[2], turned[3]]]
    rim = next(r for r in tripatch.find_holes(left) if len(r) == 13)
    corners = [v for v in rim if sum(v in f for f in left) == 2][:3] or list(rim[[0, 4, 8]])
    corners = list(rim[[0, 4, 8]]) if len(corners) < 3 else corners
    fill = tripatch.fill(vertices, left, rim=rim, corners=corners, output="cage", odd=odd, resolution=0)
    points, faces = closed(vertices, left, fill)
    assert tripatch.find_holes(faces) == []
    sizes = [len(face) for face in fill.faces]
    if odd == "split":
        assert set(sizes) == {4}
        assert len(fill.split_edges[0]) == 1
    else:
        assert sizes.count(3) == 1
        assert len(fill.split_edges[0]) == 0
    assert len(fill.limit(2)[0]) > 0


def test_more_rows_come_nearer_to_the_patch():
    vertices, _, left, _, rim = open_corner()
    deviations = [
        tripatch.fill(vertices, left, rim=rim, output="cage", cage_rim="exact", resolution=k).report.cage_deviation_rms
        for k in (0, 1, 3)
    ]
    assert deviations[0] > deviations[1] > deviations[2]


def test_tolerance_decides_on_the_rows():
    vertices, _, left, _, rim = open_corner()
    coarse = tripatch.fill(vertices, left, rim=rim, output="cage", tolerance=1.0)
    fine = tripatch.fill(vertices, left, rim=rim, output="cage", tolerance=1e-9)
    assert len(coarse.faces) == 12
    assert says(fine.report, "tolerance_out_of_reach", "cage_off_patch", "rows_would_cross")
    by_rows = [tripatch.fill(vertices, left, rim=rim, output="cage", resolution=n).report.cage_deviation_rms for n in range(5)]
    assert fine.report.rows == np.argmin(by_rows), "none reaches it: the nearest is taken, not the one with the most rows"
    assert np.isclose(fine.report.cage_deviation_rms, min(by_rows), rtol=1e-6)


def test_scale_and_motion():
    vertices, _, left, _, rim = open_corner()
    q = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    q *= np.sign(np.linalg.det(q))
    plain = tripatch.fill(vertices, left, rim=rim, output="cage", resolution=0)
    for scale in (1e-6, 1e6):
        moved = tripatch.fill(scale * vertices @ q.T, left, rim=rim, output="cage", resolution=0)
        assert np.abs(moved.vertices @ q / scale - plain.vertices).max() < 1e-6


def test_exact_in_place_of_a_region_meets_what_the_crease_leaves():
    vertices, faces, left, gone, rim = open_corner()
    open_hole = tripatch.fill(vertices, left, rim=rim, output="cage", cage_rim="exact", resolution=0).report
    region = tripatch.fill(vertices, faces, rim=rim, replaced=gone, output="cage", cage_rim="exact", resolution=0).report
    assert region.seam_angle_median == pytest.approx(open_hole.seam_angle_median, rel=1e-3)
    assert region.surroundings_moved_max > 0.01  # the crease opens the border, and that is said


def two_corners(n=6, rings=2):
    """Two corners of a cube sphere removed, with n - 2 rings quads between: their surroundings overlap."""
    vertices, faces = cube_sphere(n)
    left, _ = corner_removed(vertices, faces, rings)
    left, _ = corner_removed(vertices * [1, 1, -1], left, rings)
    return vertices, left, [rim for rim in tripatch.find_holes(left) if len(rim) == 6 * rings]


def test_holes_that_share_surroundings_are_fitted_together():
    vertices, left, rims = two_corners()
    corners = [[v for v in rim if sum(v in face for face in left) == 3] for rim in rims]
    together = tripatch.fill_all(vertices, left, rims, corners=corners, output="cage", resolution=0)
    a, b = (fill.vertices for fill in together)
    # mirror images, which they are not one after the other
    assert np.abs(np.sort(np.round(a * [1, 1, -1], 6), axis=0) - np.sort(np.round(b, 6), axis=0)).max() < 3e-6
    alone = tripatch.fill(vertices, left, rim=rims[0], corners=corners[0], output="cage", resolution=0)
    assert np.abs(alone.vertices - a).max() > 1e-6
    points, faces = np.concatenate([vertices, a, b]), [list(face) for face in left]
    for fill, first in zip(together, (0, len(a)), strict=True):
        faces += [[v + first if v >= len(vertices) else v for v in face] for face in fill.faces]
    assert tripatch.find_holes(faces) == []
    radii = np.linalg.norm(_native.limit_points(*_arrays.mesh(points, faces)), axis=1)
    assert np.ptp(radii) < 0.04


def test_holes_far_apart_are_filled_as_alone():
    vertices, left, rims = two_corners(12)
    corners = [[v for v in rim if sum(v in face for face in left) == 3] for rim in rims]
    fills = tripatch.fill_all(vertices, left, rims, corners=corners, output="cage", resolution=0)
    for fill, rim, three in zip(fills, rims, corners, strict=True):
        alone = tripatch.fill(vertices, left, rim=rim, corners=three, output="cage", resolution=0)
        assert np.abs(alone.vertices - fill.vertices).max() < 1e-12
        assert np.abs(alone.limit(2)[0] - fill.limit(2)[0]).max() < 1e-12


def test_a_refusal_of_one_cage_leaves_the_others():
    vertices, left, rims = two_corners()
    good, bad = tripatch.fill_all(vertices, left, [rims[0], rims[0][:5]], output="cage", resolution=0)
    assert isinstance(good, tripatch.Fill) and isinstance(bad, tripatch.Refusal)


def test_a_split_edge_keeps_its_crease():
    vertices, faces = cube_sphere(6)
    left, _ = corner_removed(vertices, faces, 2)
    rim = next(r for r in tripatch.find_holes(left) if len(r) == 12)
    a, b = int(rim[1]), int(rim[2])
    face = next(f for f in left if a in f and b in f)
    middle = len(vertices)
    vertices = np.concatenate([vertices, [0.5 * (vertices[a] + vertices[b])]])
    left = [f for f in left if f is not face] + [face]
    face.insert(max(face.index(a), face.index(b)) if abs(face.index(a) - face.index(b)) == 1 else 4, middle)
    rim = next(r for r in tripatch.find_holes(left) if len(r) == 13)
    creased = lambda edge: {"edge_creases": (np.array([edge]), np.array([1.0]))}  # noqa: E731
    corners = [int(rim[k]) for k in (0, 4, 8)]
    plain = tripatch.fill(vertices, left, rim=rim, corners=corners, output="cage", resolution=0)
    split = plain.split_edges[0][0]
    sharp = tripatch.fill(
        vertices, left, rim=rim, corners=corners, output="cage", resolution=0, subdivision=creased(split.tolist())
    )
    assert len(sharp.split_edges[0]) == 1
    assert np.abs(sharp.vertices[1:] - plain.vertices[1:]).max() > 1e-4


@pytest.mark.parametrize("cage_rim", ["smooth", "exact", "move"])
def test_loop_subdivision_of_triangles(cage_rim):
    vertices, faces, rim = octant(6)
    options = {"rim": rim, "output": "cage", "cage_rim": cage_rim, "subdivision": {"scheme": "loop"}}
    fill = tripatch.fill(vertices, faces, **options)
    assert {len(face) for face in fill.faces} == {3}
    assert len(fill.faces) == 36  # the regular split of equal counts
    assert tripatch.fill(vertices, faces, pole_offset=(0.1, 0), **options).report.not_applied["pole_offset"] == "poles"
    limit, triangles = fill.limit(2)
    assert triangles.shape == (36 * 16, 3)
    radii = np.linalg.norm(limit, axis=1)
    if cage_rim == "exact":
        assert fill.report.surroundings_moved_max < 1e-12
        assert fill.report.seam_angle_median < 2
    else:
        assert fill.report.seam_angle_max < 1e-4
        assert np.ptp(radii) < 0.03
    sides = np.linalg.norm(limit[triangles] - limit[np.roll(triangles, 1, axis=1)], axis=2)
    assert sides.max() < 4 * np.median(sides)  # the grid is that of neighbors


def test_loop_subdivision_refuses_what_it_cannot_take():
    vertices, _, left, _, rim = open_corner()
    with refused("loop_needs_triangles") as caught:
        tripatch.fill(vertices, left, rim=rim, output="cage", subdivision={"scheme": "loop"})
    assert sorted(caught.value.where) in [sorted(face) for face in left]
    vertices, faces, rim = octant(6)
    with pytest.raises(ValueError, match="no extra rows"):
        tripatch.fill(vertices, faces, rim=rim, output="cage", resolution=2, subdivision={"scheme": "loop"})


def test_another_border_at_the_rim_is_said():
    vertices, _, left, _, rim = open_corner()
    corners = [v for v in rim.tolist() if sum(v in face for face in left) == 3]
    touching = next(face for face in left if len(set(face) & set(rim.tolist())) == 1)
    left = [face for face in left if face is not touching]
    fill = tripatch.fill(vertices, left, rim=rim, corners=corners, output="cage", resolution=0)
    assert says(fill.report, "border_touches_rim")


@pytest.mark.parametrize("cage_rim", ["smooth", "exact", "move"])
def test_a_cage_is_the_same_whichever_corner_is_the_first(cage_rim):
    vertices, _, left, _, rim = open_corner()
    vertices = vertices * [1, 1.6, 0.7]  # three corners that are differently far from the rest of the rim
    corners = [v for v in rim.tolist() if sum(v in face for face in left) == 3]
    options = {"rim": rim, "output": "cage", "cage_rim": cage_rim, "resolution": 0}
    first, *others = (tripatch.fill(vertices, left, corners=corners[k:] + corners[:k], **options) for k in range(3))
    diameter = np.linalg.norm(vertices[rim][:, None] - vertices[rim], axis=-1).max()
    for other in others:
        apart = np.linalg.norm(first.vertices[:, None] - other.vertices, axis=-1).min(axis=1)
        assert apart.max() < 1e-9 * diameter
        assert other.report.cage_deviation_rms == pytest.approx(first.report.cage_deviation_rms, rel=1e-6)


@pytest.mark.parametrize(
    ("segments", "width"),
    [(n, 0.2) for n in (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 16)]
    + [(1, 0.3), (1, 0.4), (2, 0.3), (3, 0.4), (4, 0.45), (5, 0.1), (10, 0.1)],
)
def test_the_cage_of_a_bevelled_corner_stays_within_the_cube(segments, width):
    """Strips many times as long as the fill's faces: uniform B-splines would continue into the hole by their length."""
    vertices, faces, rim, corners = bevelled_corner(segments, width)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, output="cage")
    limit, _ = fill.limit(2)
    assert limit.min() > 0.7 - width and limit.max() <= 1  # the corner of a cube from 0 to 1
    assert fill.report.triangles_folded == 0
    assert fill.report.folds == 0


def row_of_holes(count, edges, between):
    """A wavy mesh of quads with square holes in a row: vertices, faces, rims."""
    adjacent = 3 + between
    width, height = adjacent + count * (edges + between) + 3, edges + 2 * adjacent
    lefts = [adjacent + k * (edges + between) for k in range(count)]
    number = np.arange((width + 1) * (height + 1)).reshape(width + 1, height + 1)
    i, j = np.indices(number.shape)
    vertices = np.stack([i, j, 2 * np.sin(0.11 * i) * np.cos(0.13 * j)], axis=-1).reshape(-1, 3) / edges
    gone = np.zeros((width, height), bool)
    for left in lefts:
        gone[left : left + edges, adjacent : adjacent + edges] = True
    corners = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
    faces = corners[~gone].tolist()
    return vertices, faces, [rim for rim in tripatch.find_holes(faces) if len(rim) == 4 * edges]


@pytest.mark.parametrize("between", [2, 8])
def test_cages_tell_how_far_they_are_and_can_be_ended(between):
    """Holes that touch are one piece of work, others are one each: both are ended before all are done."""
    vertices, faces, rims = row_of_holes(5, 16, between)
    assert len(rims) == 5

    def enough(done, total):
        raise RuntimeError(f"enough after {done} of {total}")

    with pytest.raises(RuntimeError, match="enough after 0 of 5" if between == 2 else "enough after [0-4] of 5"):
        tripatch.fill_all(vertices, faces, rims, output="cage", progress=enough)


def test_cages_are_the_same_side_by_side_and_one_after_the_other():
    """Groups of holes that touch are made on all cores: each as if it were alone."""
    vertices, faces, rims = row_of_holes(4, 4, 8)
    told = []
    together = tripatch.fill_all(vertices, faces, rims, output="cage", progress=lambda *how_far: told.append(how_far))
    assert told[-1] == (4, 4) and told == sorted(told)
    for rim, fill in zip(rims, together, strict=True):
        (alone,) = tripatch.fill_all(vertices, faces, [rim], output="cage")
        assert alone.vertices.tobytes() == fill.vertices.tobytes() and np.array_equal(alone.faces, fill.faces)


def test_what_is_not_fitted_to_a_patch_has_no_distance_to_one():
    n = 12
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), (0.3 * x * x - 0.2 * y * y).ravel()])
    gone = {(i, j) for i in range(4, 8) for j in range(4, 8)} - {(4, 4), (7, 7)}  # a staircase, which patches do not like
    at = lambda i, j: i * (n + 1) + j  # noqa: E731
    quads = [(i, j) for i in range(n) for j in range(n) if (i, j) not in gone]
    faces = [[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)] for i, j in quads]
    fill = tripatch.fill(vertices, faces, rim=min(tripatch.find_holes(faces), key=len), output="cage")
    assert fill.report.cage_in_rows
    assert fill.report.cage_deviation_max == fill.report.cage_deviation_rms == 0 < fill.report.surroundings_moved_max
    told = str(words.filled([fill.report], cage_rim="smooth", quads=len(fill.faces)))
    assert "patch" not in told and "surroundings moved" in told
