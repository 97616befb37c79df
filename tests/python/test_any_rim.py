"""Rims with any number of corners: jagged, round, noisy, with islands; surfaces with a formula, and what must never happen."""

import collections
import itertools

import numpy as np
import pytest
import tripatch
from codes import refused, says
from scipy.spatial import ConvexHull
from shapes import bevelled_cylinder, corner_removed, cube_sphere, octant
from tripatch import words


def irregular(surface, n=24, seed=0, noise=0.0, cut=0.45, shape="round"):
    """A jittered grid of triangles over [-1.2, 1.2]^2 lifted by `surface`, a region of it taken out: the rim zigzags."""
    rng = np.random.default_rng(seed)
    grid = np.linspace(-1.2, 1.2, n + 1)
    x, y = np.meshgrid(grid, grid, indexing="ij")
    step = grid[1] - grid[0]
    points = np.column_stack([x.ravel(), y.ravel()]) + rng.uniform(-0.3, 0.3, ((n + 1) ** 2, 2)) * step
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = (q.ravel() for q in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    turn = rng.random(len(a)) < 0.5
    first, second = np.column_stack([a, b, c]), np.column_stack([a, c, d])
    other, another = np.column_stack([a, b, d]), np.column_stack([b, c, d])
    faces = np.vstack([np.where(turn[:, None], first, other), np.where(turn[:, None], second, another)])
    middle = points[faces].mean(axis=1)
    size = np.abs(middle).max(axis=1) if shape == "square" else np.linalg.norm(middle, axis=1)
    faces = faces[size > cut]
    vertices = np.column_stack([points, surface(*points.T)])
    return vertices + noise * step * rng.normal(size=vertices.shape), faces.tolist()


def hill(x, y):
    return 0.5 * np.exp(-0.8 * (x * x + y * y))


def wave(x, y):
    return 0.25 * np.sin(1.3 * x) * np.cos(1.1 * y)


def inner_rim(faces):
    return sorted(tripatch.find_holes(faces), key=len)[-2]


def off(fill, surface):
    return np.abs(fill.vertices[:, 2] - surface(*fill.vertices[:, :2].T))


def edge_counts(faces):
    count = collections.Counter()
    for face in faces:
        for a, b in itertools.pairwise([*face, face[0]]):
            count[min(a, b), max(a, b)] += 1
    return count


@pytest.mark.parametrize("shape", ["round", "square"])
@pytest.mark.parametrize(("surface", "bound"), [(wave, 1e-6), (hill, 2e-3)])
def test_a_jagged_hole_in_a_smooth_surface_is_filled_with_it(surface, bound, shape):
    vertices, faces = irregular(surface, shape=shape)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces))
    assert fill.report.method == "polyharmonic_spline"
    assert fill.report.triangles_folded == 0 and fill.report.warnings == []
    assert off(fill, surface).max() < bound
    assert fill.report.deviation_max == fill.deviation.max()
    assert len(fill.deviation) == len(fill.vertices) == len(fill.uv)


@pytest.mark.parametrize("seed", range(3))
def test_the_deviation_is_honest_under_noise(seed):
    vertices, faces = irregular(wave, noise=0.03, seed=seed)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces))
    assert (off(fill, wave) < 2 * fill.deviation).mean() > 0.9
    assert np.median(fill.deviation) < 0.03 * 0.1
    assert off(fill, wave).max() < 0.03 * 0.1  # nearer than the samples are


@pytest.mark.parametrize("narrow", [1.6, 2.4])
def test_the_deviation_of_a_hill_that_lies_in_the_hole_is_of_the_size_of_the_error(narrow):
    """No noise: nothing around tells of the hill but that it ends there."""

    def narrow_hill(x, y):
        return 0.5 * np.exp(-narrow * (x * x + y * y))

    vertices, faces = irregular(narrow_hill, n=30)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces))
    assert np.sqrt(np.mean((off(fill, narrow_hill) / fill.deviation) ** 2)) < 5
    assert fill.report.deviation_max < 0.01  # of a hole of diameter 0.9: not by claiming to know nothing


def test_the_filled_mesh_is_closed_at_the_rim_and_no_edge_has_three_faces():
    vertices, faces = irregular(hill)
    rim = inner_rim(faces)
    fill = tripatch.fill(vertices, faces, rim=rim)
    count = edge_counts([*faces, *fill.faces])
    assert max(count.values()) == 2
    for a, b in itertools.pairwise([*rim, rim[0]]):
        assert count[min(a, b), max(a, b)] == 2
    assert set(fill.rim.tolist()) == set(rim.tolist())


def test_an_edge_that_the_mesh_has_is_not_made_again():
    """A tetrahedron without two faces: the fill's only inner edge may not be the one that is there."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0.5, 0.9, 0], [0.5, 0.3, 0.8]])
    faces = [[0, 1, 2], [0, 2, 3]]
    fill = tripatch.fill(vertices, faces, rim=[0, 1, 2, 3])
    assert max(edge_counts([*faces, *fill.faces]).values()) == 2


def test_auto_takes_the_exact_patch_between_smooth_sides_and_says_why():
    vertices, faces, rim = octant()
    fill = tripatch.fill(vertices, faces, rim=rim)
    assert (fill.report.method, fill.report.method_reason) == ("side_vertex", "the hole has 3 smooth sides")
    assert np.sqrt(np.mean(fill.deviation**2)) == pytest.approx(fill.report.candidates[0].expected_error)
    plain = tripatch.fill(vertices, faces, rim=rim, method="side_vertex")
    assert np.array_equal(fill.vertices, plain.vertices)
    assert plain.report.method_reason == "it was requested"


def test_the_reason_of_auto_does_not_advise_to_use_auto():
    vertices, faces = irregular(hill)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces))
    said = [fill.report.method_reason, *(each.why for each in fill.report.candidates)]
    assert "no smooth sides were found" in " ".join(said)
    assert not any("use method" in each for each in said)


def test_either_method_can_be_insisted_on():
    vertices, faces, rim = octant(12)
    fill = tripatch.fill(vertices, faces, rim=rim, method="polyharmonic_spline")
    assert fill.report.method == "polyharmonic_spline"
    assert np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max() < 2e-3
    jagged, around = irregular(wave)
    with pytest.raises(tripatch.Refusal, match="corner"):
        tripatch.fill(jagged, around, rim=inner_rim(around), method="side_vertex")


def test_the_spline_insisted_on_is_refused_where_nothing_but_plain_triangles_is_left():
    """Three faces of a cube around one of its corners."""
    vertices = list(itertools.product((0, 1), repeat=3))
    faces = [[4, 6, 7, 5], [2, 3, 7, 6], [1, 5, 7, 3]]
    plain = tripatch.fill(vertices, faces)
    assert plain.patch is None and says(plain.report, "plain_triangles")
    with refused("no_surface_laid_out"):
        tripatch.fill(vertices, faces, method="polyharmonic_spline")


@pytest.mark.parametrize("count", [0, 2, 4, 5, 7])
def test_any_number_of_corners_may_be_given(count):
    vertices, faces, rim = octant(12)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=[rim[36 * k // count] for k in range(count)] if count else ())
    assert fill.report.method == "polyharmonic_spline"
    assert len(fill.report.corners) == count


def test_one_corner_is_a_mistake():
    vertices, faces, rim = octant()
    with pytest.raises(ValueError, match="One corner is too few"):
        tripatch.fill(vertices, faces, rim=rim, corners=rim[:1])
    with pytest.raises(ValueError, match="One corner is too few"):
        tripatch.fill_all(vertices, faces, [rim], corners=[rim[:1]])


def test_corners_of_all_holes_may_be_none():
    """As for `fill`: an empty list is no corners, None those that are detected."""
    vertices, faces, rim = octant(12)
    detected, round_, one_by_one = (tripatch.fill_all(vertices, faces, [rim], corners=given)[0] for given in (None, (), [()]))
    assert len(detected.report.corners) == 3 and round_.report.corners == one_by_one.report.corners == []
    assert np.array_equal(round_.vertices, one_by_one.vertices)
    (named,) = tripatch.fill_all(vertices, faces, max_edges=len(rim), corners=np.array([], int))
    assert named.report.corners == []
    with pytest.raises(ValueError, match="corners must have 1 value, not 2"):
        tripatch.fill_all(vertices, faces, [rim], corners=[(), ()])


@pytest.mark.parametrize("method", ["auto", "polyharmonic_spline"])
def test_quads_in_an_odd_rim_of_which_no_edge_is_split_say_so(method):
    angle = 2 * np.pi * np.arange(47) / 47
    ring = np.column_stack([np.cos(angle), np.sin(angle)]) * np.random.default_rng(1).uniform(0.97, 1.03, (47, 1))
    points = np.concatenate([(1 + 0.12 * k) * ring for k in range(5)])
    vertices = np.column_stack([points, 0.2 * points[:, 0] ** 2])
    at = [(47 * j + k, 47 * j + (k + 1) % 47) for j in range(4) for k in range(47)]
    faces = [face for a, b in at for face in ([b, a, a + 47], [b, a + 47, b + 47])]
    for odd in ("split", "triangle"):
        fill = tripatch.fill(vertices, faces, rim=range(47), output="quads", odd=odd, method=method)
        assert fill.report.method == "polyharmonic_spline" and not len(fill.split_edges[0])
        assert [len(face) for face in fill.faces].count(3) == 1
        assert says(fill.report, "one_triangle") == (odd == "split")  # else it is what was asked for
    assert not says(tripatch.fill(vertices, faces, rim=range(47), method=method).report, "one_triangle")


def test_options_of_patches_are_refused_where_the_spline_is_insisted_on_and_a_warning_under_auto():
    vertices, faces = irregular(wave)
    rim = inner_rim(faces)
    with pytest.raises(ValueError, match="does not take cross_boundary, fairing"):
        tripatch.fill(vertices, faces, rim=rim, method="polyharmonic_spline", fairing=None, cross_boundary="given")
    fill = tripatch.fill(vertices, faces, rim=rim, fairing=None)
    assert says(fill.report, "options_need_smooth_sides")


@pytest.mark.parametrize("island_is_rim", [False, True], ids=["outer rim", "inner rim, far from the outer one"])
def test_an_island_stays(island_is_rim):
    inner, n = (0.06, 100) if island_is_rim else (0.25, 30)
    vertices, faces = irregular(wave, n=n, cut=0.0)
    size = np.linalg.norm(np.array([np.mean(vertices[f], axis=0) for f in faces])[:, :2], axis=1)
    kept = [f for f, s in zip(faces, size, strict=True) if s > 0.6 or s < inner]
    loops = sorted(tripatch.find_holes(kept), key=len)
    rim, island = loops[:2] if island_is_rim else loops[1::-1]
    fill = tripatch.fill(vertices, kept, rim=rim, islands=[island])
    count = edge_counts([*kept, *fill.faces])
    assert max(count.values()) == 2
    for loop in loops[:2]:
        assert all(count[min(a, b), max(a, b)] == 2 for a, b in itertools.pairwise([*loop, loop[0]]))
    assert off(fill, wave).max() < 1e-5


def test_islands_are_apart_from_the_rim_and_each_other():
    vertices, faces = irregular(wave)
    rim = inner_rim(faces)
    outer = max(tripatch.find_holes(faces), key=len)
    for islands in ([rim], [outer, outer]):
        with refused("borders_share_vertex"):
            tripatch.fill(vertices, faces, rim=rim, islands=islands)


@pytest.mark.parametrize("resolution", [1, 4, 12])
def test_quads_where_they_are_good_and_triangles_else(resolution):
    vertices, faces = irregular(wave)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces), output="quads", resolution=resolution)
    assert {len(f) for f in fill.faces} <= {3, 4}
    assert max(edge_counts([*faces, *fill.faces]).values()) == 2


@pytest.mark.parametrize("noise", [0, 0.1])
def test_the_patch_is_evaluated_at_places_of_the_plane(noise):
    """With much noise it is the average of two models."""
    vertices, faces = irregular(wave, noise=noise)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces))
    assert np.allclose(fill.patch.evaluate(fill.uv), fill.vertices, atol=1e-12)
    p, d1, d2, d3 = fill.patch.evaluate(fill.uv, 3)
    n = np.cross(d1[:, 0], d1[:, 1])
    assert np.allclose(n / np.linalg.norm(n, axis=1, keepdims=True), fill.normals, atol=1e-9)
    assert np.isfinite(d2).all() and np.isfinite(d3).all()


def test_the_seam_of_a_surface_for_any_rim_is_as_good_as_its_surroundings_are_known():
    vertices, faces = irregular(hill, noise=0.02)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces), method="polyharmonic_spline")
    seam, accuracy = words.degrees(fill.report.seam_angle_max), words.degrees(fill.report.surroundings_error)
    assert words.filled([fill.report]) == f"Filled 1 hole; seam within {seam} (accuracy of the mesh: {accuracy})"
    assert fill.report.continuity == ["G1"] and len(fill.report.seam_angle_max_by_side) == 1


def test_the_domain_of_a_surface_for_any_rim_is_where_the_rim_lies():
    vertices, faces = irregular(hill)
    rim = inner_rim(faces)
    fill = tripatch.fill(vertices, faces, rim=rim, method="polyharmonic_spline")
    np.testing.assert_array_equal(fill.patch.domain, fill.rim_uv)
    np.testing.assert_allclose(fill.patch.evaluate(fill.patch.domain), vertices[fill.rim], atol=1e-3)
    with pytest.raises(ValueError, match="no energy"):
        fill.patch.energy("thin_plate")
    with pytest.raises(ValueError, match="has no sides"):
        fill.patch.on_side(0, [0.5])


def test_a_hole_that_needs_no_vertex_inside_has_its_places_too():
    angle = np.arange(6) * np.pi / 3 + 0.1
    vertices = np.vstack([r * np.column_stack([np.cos(angle), np.sin(angle), 0.1 * angle]) for r in (1.0, 2.0, 3.0)])
    faces = [[k + j, 6 + k + j, 6 + (k + 1) % 6 + j, (k + 1) % 6 + j] for j in (0, 6) for k in range(6)]
    fill = tripatch.fill(vertices, faces, rim=range(6), corners=(), method="polyharmonic_spline", resolution=1)
    assert fill.vertices.shape == (0, 3) and len(fill.faces) == 4
    assert fill.uv.shape == (0, 2) and fill.rim_uv.shape == (6, 2)
    assert tripatch.attribute_weights(fill)(np.zeros((12, 1))).shape == (0, 1)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_size_and_place_do_not_matter(scale):
    vertices, faces = irregular(hill)
    rim = inner_rim(faces)
    plain = tripatch.fill(vertices, faces, rim=rim)
    scaled = tripatch.fill(vertices * scale, faces, rim=rim)
    assert len(scaled.vertices) == len(plain.vertices)
    assert np.abs(scaled.vertices / scale - plain.vertices).max() < 1e-6


def test_holes_of_many_kinds_in_one_call():
    vertices, faces = cube_sphere(12)
    faces, _ = corner_removed(vertices, faces, 3)
    gone = [f for f, face in enumerate(faces) if vertices[face].mean(axis=0) @ [0, 0, -1] > 0.93]
    faces = [face for f, face in enumerate(faces) if f not in set(gone)]
    fills = tripatch.fill_all(vertices, faces)
    assert len(fills) == 2
    for fill in fills:
        assert np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max() < 3e-3


def test_a_rim_without_usable_surroundings_gets_plain_triangles_and_says_so():
    """A fan that is joined to nothing but the rim's own faces, folded flat onto it: no disc to lay out."""
    turn = np.linspace(0, 2 * np.pi, 9)[:-1]
    ring = np.column_stack([np.cos(turn), np.sin(turn), 0.3 * np.cos(3 * turn)])
    vertices = np.vstack([ring, [[0, 0, -2]]])
    faces = [[(k + 1) % 8, k, 8] for k in range(8)]
    fill = tripatch.fill(vertices, faces, rim=list(range(8)))
    assert len(fill.faces) >= 6
    assert max(edge_counts([*faces, *fill.faces]).values()) == 2
    assert len(fill.rim_uv) == 8
    assert fill.report.triangles_folded == 0


def test_a_rim_whose_own_triangles_fold_is_joined_to_its_middle():
    """The other side of a bent sheet whose edges leave the rim one triangulation, over the notch and back."""
    vertices = np.array([[0, 0, 1], [4, 0, -2], [4, 4, -1], [2, 3, 0], [0, 4, -1]], float)
    faces = [[0, 1, 3], [1, 2, 3], [0, 3, 4]]
    fill = tripatch.fill(vertices, faces, rim=[0, 4, 3, 2, 1], corners=())
    assert fill.report.triangles_folded == fill.report.rim_folded == 4  # over the sheet; none among each other
    assert len(fill.faces) == 5 and np.allclose(fill.vertices, vertices.mean(axis=0))
    assert fill.uv.shape == (1, 2) and np.linalg.norm(fill.uv) < np.linalg.norm(fill.rim_uv, axis=1).min()
    assert max(edge_counts([*faces, *fill.faces]).values()) == 2


def test_a_rim_is_not_joined_to_its_middle_where_that_folds_more():
    """The same sheet, flat: five triangles back to back with it instead of three, of which one folds back over the others."""
    vertices = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [2, 3, 0], [0, 4, 0]], float)
    fill = tripatch.fill(vertices, [[0, 1, 3], [1, 2, 3], [0, 3, 4]], rim=[0, 4, 3, 2, 1], corners=())
    assert len(fill.faces) == 3 and len(fill.vertices) == 0
    assert fill.report.triangles_folded == fill.report.rim_folded == 4


@pytest.mark.parametrize(("noise", "seed"), [(0.25, 4), (0.25, 11), (0.3, 0), (0.3, 6), (0.4, 1), (0.4, 0)])
def test_a_rim_that_noise_throws_about_is_filled_with_vertices_inside(noise, seed):
    """The field through all rings would fold over the mesh at the rim; plain triangles would cut the top of the hill off."""
    vertices, faces = irregular(hill, noise=noise, seed=seed)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces))
    plainer = [warning for warning in fill.report.warnings if warning.code not in ("faces_folded_beyond", "extra_face")]
    assert len(fill.vertices) > 10 and fill.report.warnings and len(plainer) <= 1
    bends_least = "least_bending" in [warning.code for warning in plainer]
    assert bends_least == (seed == 11)
    assert fill.report.continuity == ([] if bends_least else ["G1"]) and (fill.report.seam_angle_max > 1) == bends_least
    assert fill.report.triangles_folded <= fill.report.rim_folded
    assert np.sqrt((off(fill, hill) ** 2).mean()) < 0.05
    assert len(fill.deviation) == len(fill.vertices) and (fill.deviation > 0).all()


def test_a_half_ball_under_noise_knows_that_its_layout_is_a_guess():
    """Pooled over balls turned in eight ways; what the fill errs is in the plane that it is laid into too."""
    inside, places = [], 0
    for seed in range(8):
        vertices, faces = cube_sphere(12)
        rng = np.random.default_rng(seed)
        up = rng.normal(size=3)
        faces = [f for f in faces if vertices[f].mean(axis=0) @ up < 0.12 * np.linalg.norm(up)]
        vertices = vertices + rng.normal(size=vertices.shape) * 0.02 * np.pi / 24
        fill = tripatch.fill(vertices, faces, rim=max(tripatch.find_holes(faces), key=len), method="polyharmonic_spline")
        away = np.abs(np.linalg.norm(fill.vertices, axis=1) - 1)
        inside.append((away < 2 * fill.deviation).sum())
        places += len(away)
    assert sum(inside) > 0.85 * places


def test_a_strip_between_two_rims_is_the_tube_that_was_there():
    """Two pieces of a tube, as far apart as the tube is wide: in the plane one rim lies inside the other."""
    around, apart = 24, 2.0
    heights = [-2.0, -1.75, -1.5, -1.25, -apart / 2, apart / 2, 1.25, 1.5, 1.75, 2.0]
    turn = 2 * np.pi * np.arange(around) / around
    vertices = np.array([(np.cos(a), np.sin(a), z) for z in heights for a in turn])
    rows = [k for k in range(len(heights) - 1) if heights[k] != -apart / 2]
    faces = [
        [r * around + k, r * around + (k + 1) % around, (r + 1) * around + (k + 1) % around, (r + 1) * around + k]
        for r in rows
        for k in range(around)
    ]
    one, other = (list(rim) for rim in tripatch.find_holes(faces) if np.allclose(np.abs(vertices[rim, 2]), apart / 2))
    fill = tripatch.fill(vertices, faces, rim=one, islands=[other])
    assert fill.report.method == "annulus"
    assert fill.report.triangles_folded == 0
    assert np.abs(np.hypot(fill.vertices[:, 0], fill.vertices[:, 1]) - 1).max() < 1e-6
    count = edge_counts(faces + [list(f) for f in fill.faces])
    assert max(count.values()) == 2
    for rim in (one, other):
        assert all(count[min(a, b), max(a, b)] == 2 for a, b in itertools.pairwise([*rim, rim[0]]))


def swept_fillet(segments, ring=0.3, tube=0.3, far=(1.0, 2.0)):
    """A fillet of radius `tube` around the corner of a plate, which is rounded with radius `ring`: path and profile are straight,
    round and straight; the quarter of a torus in the middle is left out."""
    quarter = np.linspace(0, np.pi / 2, segments + 1)
    path = [(lambda x, s=s: (x, -s)) for s in far[::-1]]
    path += [(lambda x, t=t: (x * np.cos(t), x * np.sin(t))) for t in quarter]
    path += [(lambda x, s=s: (-s, x)) for s in far]
    profile = [(ring + tube, -s) for s in far[::-1]]
    profile += [(ring + tube * np.cos(t), tube * np.sin(t)) for t in quarter] + [(0.5 * ring, tube)]
    vertices = np.array([(*step(radius), height) for step in path for radius, height in profile])
    n, hole = len(profile), range(len(far), len(far) + segments)
    faces = [
        [i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1]
        for i in range(len(path) - 1)
        for j in range(n - 1)
        if not (i in hole and j in hole)
    ]
    return vertices, faces


def test_between_fillets_where_curvature_jumps_the_patch_is_taken_not_the_spline():
    for segments in (8, 12):
        vertices, faces = swept_fillet(segments)
        rim = next(h for h in tripatch.find_holes(faces) if len(h) == 4 * segments)
        fill = tripatch.fill(vertices, faces, rim=rim)
        x, y, z = fill.vertices.T
        assert fill.report.method == "multi_sided"
        assert np.abs(np.hypot(np.hypot(x, y) - 0.3, z) - 0.3).max() < 5e-4
        assert fill.report.surroundings_error < 0.2


@pytest.mark.parametrize("seed", [0, 3])
def test_half_a_ball_without_noise_is_filled_from_many_of_its_points(seed):
    """The likeliest surface of the rim's and a hundred more is 0.0014 of the width off."""
    rng = np.random.default_rng(seed)
    k = np.arange(1500) + 0.5
    z, turn = 1 - 2 * k / len(k), np.pi * (1 + 5**0.5) * k
    points = np.stack([np.cos(turn) * np.sqrt(1 - z * z), np.sin(turn) * np.sqrt(1 - z * z), z], axis=1)
    points += rng.uniform(-0.3, 0.3, points.shape) * 0.6 * np.sqrt(4 * np.pi / len(k))
    points /= np.linalg.norm(points, axis=1)[:, None]
    faces = ConvexHull(points).simplices
    normals = np.cross(*(points[faces[:, j]] - points[faces[:, 0]] for j in (1, 2)))
    inward = (normals * points[faces].mean(1)).sum(axis=1) < 0
    faces[inward] = faces[inward][:, ::-1]
    up = rng.normal(size=3)
    faces = faces[points[faces].mean(1) @ up < 0.1 * np.linalg.norm(up)]
    fill = tripatch.fill(points, faces, rim=max(tripatch.find_holes(faces), key=len))
    assert fill.report.method == "polyharmonic_spline"
    off = np.abs(np.linalg.norm(fill.vertices, axis=1) - 1)
    assert np.sqrt((off**2).mean()) < 0.0007 * 2


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_a_long_jagged_rim_that_leans_every_way_is_followed_and_not_filled_flat(noise):
    """A cap of 60 degrees, gone from a ball of fine triangles: a flat fill would be a tenth of its width off."""
    edge, lean = 0.0113, np.radians(60)
    k = np.arange(int(4 * np.pi / (edge**2 * 0.866))) + 0.5
    z, turn = 1 - 2 * k / len(k), np.pi * (1 + 5**0.5) * k
    points = np.stack([np.cos(turn) * np.sqrt(1 - z * z), np.sin(turn) * np.sqrt(1 - z * z), z], axis=1)
    points += edge * np.random.default_rng(3).uniform(-0.3, 0.3, points.shape)
    points = points[np.abs(np.arccos(np.clip(points[:, 2], -1, 1)) - lean) < 30 * edge]
    points /= np.linalg.norm(points, axis=1)[:, None]
    faces = ConvexHull(points).simplices
    normals = np.cross(*(points[faces[:, j]] - points[faces[:, 0]] for j in (1, 2)))
    inward = (normals * points[faces].mean(1)).sum(axis=1) < 0
    faces[inward] = faces[inward][:, ::-1]
    at = np.arccos(np.clip(points[faces].mean(1)[:, 2], -1, 1))
    faces = faces[(at > lean) & (at < lean + 25 * edge)]
    points += edge * noise * np.random.default_rng(7).normal(size=points.shape)
    upper = (loop for loop in tripatch.find_holes(faces) if points[loop, 2].mean() > np.cos(lean + 5 * edge))
    rim = max(upper, key=len)
    fill = tripatch.fill(points, faces, rim=rim)
    assert len(rim) > 500 and fill.report.method == "polyharmonic_spline"
    off = np.abs(np.linalg.norm(fill.vertices, axis=1) - 1)
    assert np.sqrt((off**2).mean()) < 0.05 * 2 * np.sin(lean)
    assert np.mean(off < 2 * fill.deviation) > 0.8, "what it says of how well it is known is so"


@pytest.mark.parametrize("gap", [1e-7, 1e-6, 1e-5])
def test_a_slit_whose_edges_lie_on_each_other_is_closed(gap):
    """A plate with a tube in it that is joined to it but for one vertex: what lies around the slit is laid out on a line."""
    n, angle = 12, np.arange(12) * np.pi / 6
    circle = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    points = np.vstack([circle, 6 * circle, circle - [0, 0, 2], circle[3] - [0, 0, gap]])
    faces = []
    for i, j in zip(range(n), np.roll(range(n), -1).tolist(), strict=True):
        a, b = ((36 if v == 3 else v) for v in (i, j))  # of the tube
        faces += [[i, n + i, n + j], [i, n + j, j], [2 * n + i, a, b], [2 * n + i, b, 2 * n + j]]
    rim = next(loop for loop in tripatch.find_holes(faces) if 36 in loop)
    assert len(rim) == 4
    fill = tripatch.fill(points, faces, rim=rim)
    assert len(fill.faces) == 2 and not len(fill.vertices)


WALLS = {  # (ring of quads, place around) of what is taken out; ring 3 are the walls
    "walls": [(3, 0), (3, 1), (3, 2)],
    "walls and beside": [(i, j) for i in (2, 3, 4) for j in range(3)],
    "ragged": [(3, 0), (3, 1), (3, 2), (2, 0), (2, 2), (4, 1), (1, 2)],
    "wide": [*((3, j) for j in range(5)), (2, 1), (2, 3), (4, 1), (4, 3)],
}


@pytest.mark.parametrize("cut", [False, True], ids=["quads", "triangles"])
@pytest.mark.parametrize("gone", WALLS.values(), ids=WALLS.keys())
def test_long_walls_of_a_bevelled_cylinder_are_filled_with_it(gone, cut):
    """What walls are between their ends only their long edges tell; by their corners alone the fill was dented by a tenth."""
    points, faces = bevelled_cylinder()
    faces = [f for k, f in enumerate(faces) if divmod(k, 24) not in gone]
    if cut:
        faces = [[f[0], a, b] for f in faces for a, b in itertools.pairwise(f[1:])]
    fill = tripatch.fill(points, faces)
    assert fill.report.triangles_folded == 0
    amid = fill.vertices[np.abs(fill.vertices[:, 2]) < 0.8]
    if fill.report.method == "quad_rows":  # walls again as long as they were, without vertices amid
        everything, shares = np.vstack([points, fill.vertices]), np.random.default_rng(1).dirichlet([1, 1, 1], 50)
        halves = [[f[0], a, b] for f in fill.faces for a, b in itertools.pairwise(f[1:])]
        places = np.einsum("sk,fkx->fsx", shares, everything[halves]).reshape(-1, 3)
        amid = places[np.abs(places[:, 2]) < 0.8]
    assert len(amid) > 0
    radius = np.hypot(amid[:, 0], amid[:, 1])
    within = 0.08 if gone is WALLS["wide"] else 0.03
    assert 1 - within < radius.min() and radius.max() < 1 + within


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("gone", ["ragged", "wide"])
def test_where_a_field_would_run_on_as_fillets_end_the_triangles_bend_least(gone, seed):
    """The same a little uneven: no face is flat, only vertices tell, and the field dipped by a fifth of the hole and more."""
    points, faces = bevelled_cylinder()
    points = points + 1e-3 * np.random.default_rng(seed).standard_normal(points.shape)
    faces = [f for k, f in enumerate(faces) if divmod(k, 24) not in WALLS[gone]]
    faces = [[f[0], a, b] for f in faces for a, b in itertools.pairwise(f[1:])]
    fill = tripatch.fill(points, faces)
    everything = np.vstack([points, fill.vertices])
    shares = np.random.default_rng(1).dirichlet([1, 1, 1], 50)  # of places in a triangle
    halves = [[f[0], a, b] for f in fill.faces for a, b in itertools.pairwise(f[1:])]
    made = np.einsum("sk,fkx->fsx", shares, everything[halves]).reshape(-1, 3)
    amid = made[np.abs(made[:, 2]) < 0.8]
    assert len(amid) > 0
    radius = np.hypot(amid[:, 0], amid[:, 1])
    assert 0.8 < radius.min() and radius.max() < 1.2


def test_a_solid_that_is_only_sharp_has_no_folded_faces():
    """Faces of convex bodies that have lost one, some of which meet at more than 120 degrees."""
    rng, sharp = np.random.default_rng(2), 0
    solids = [np.vstack([np.zeros(3), np.eye(3)]), *(rng.normal(size=(int(rng.integers(4, 9)), 3)) for _ in range(60))]
    for points in solids:
        hull = ConvexHull(points)
        outward = np.einsum("ij,ij->i", np.cross(*(points[hull.simplices[:, k]] - points[hull.simplices[:, 0]] for k in (1, 2))),
                            hull.equations[:, :3]) > 0  # fmt: skip
        faces = np.where(outward[:, None], hull.simplices, hull.simplices[:, ::-1]).tolist()
        for gone in range(len(faces)):
            left = faces[:gone] + faces[gone + 1 :]  # of a flat body what is left may be a sheet: its border is named
            report = tripatch.fill(points, left, rim=tripatch.find_holes(left)[0]).report
            sharp += report.triangles_folded > 0
            assert report.triangles_folded <= report.rim_folded
            assert not says(report, "faces_folded_beyond")
    assert sharp > 20


def test_a_face_folded_under_a_flat_sheet_is_named():
    angle = 2 * np.pi * np.arange(12) / 12
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(12)])
    vertices = np.concatenate([(1 + 0.4 * k) * ring for k in range(4)])
    vertices[2] = vertices[1] + 0.3 * (vertices[1] - vertices[2]) + (0, 0, -0.02)
    at = [(12 * j + k, 12 * j + (k + 1) % 12) for j in range(3) for k in range(12)]
    faces = [face for a, b in at for face in ([b, a, a + 12], [b, a + 12, b + 12])]
    report = tripatch.fill(vertices, faces, rim=range(12)).report
    assert report.triangles_folded > 0 and says(report, "faces_folded_beyond")


def test_a_face_folded_beside_the_rim_is_named_and_the_fill_goes_on():
    """A vertex of the rim dragged over the next one: faces there are folded over those around, and any smooth fill over them."""
    vertices, faces = irregular(hill, seed=4)
    rim = [int(v) for v in tripatch.find_holes(faces)[0]]
    whole = tripatch.fill(vertices, faces, rim=rim)
    assert not whole.report.warnings and whole.report.rim_folded == 0
    neighbors = {v for face in faces if rim[2] in face for v in face} - set(rim)
    out = vertices[sorted(neighbors)].mean(axis=0) - vertices[rim[2]]
    x, y = (vertices[rim[2]] + 1.3 * (vertices[rim[3]] - vertices[rim[2]]) + 0.8 * out)[:2]
    vertices[rim[2]] = x, y, hill(x, y)
    report = (fill := tripatch.fill(vertices, faces, rim=rim)).report
    (warning,) = report.warnings
    assert 1 <= report.triangles_folded <= report.rim_folded and warning.code == "faces_folded_beyond"
    named = warning.where
    at = rim.index(named[0])
    assert rim[at + 1] == named[1] and {at, at + 1} & {1, 2, 3}
    assert np.abs(fill.vertices[:, 2] - hill(*fill.vertices[:, :2].T)).max() < 1e-4
