"""Fills on the limit surface of a cage."""

import numpy as np
import pytest
import tripatch
from codes import refused, says
from random_holes import directed, icosphere
from shapes import corner_removed, cube_sphere
from tripatch import _arrays, _native, options


def unsigned_angle(a, b):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.abs((a * b).sum(-1))))


def surface(vertices, faces, **settings):
    return _native.LimitSurface(*_arrays.mesh(vertices, faces), options.subdivision(settings), [])


def noisy_cage():
    rng = np.random.default_rng(3)
    vertices, faces = cube_sphere(4)
    vertices = vertices + 0.05 * rng.normal(size=vertices.shape)
    q = faces.pop(0)
    return vertices, faces + [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]


def test_adaptive_patches_approach_the_true_limit():
    """Where they differ: at a smooth border corner, whose patch is isolated as far as the quality says."""
    n = 5
    vertices = np.array([(i, j, 0.3 * np.sin(1.3 * i) * np.cos(0.9 * j)) for j in range(n) for i in range(n)])
    faces = [[j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i] for j in range(n - 1) for i in range(n - 1)]
    true = surface(vertices, faces, quality=None)
    t = np.linspace(0, 1, 33).tolist()
    errors = []
    for quality in (2, 4, 8):
        drawn = surface(vertices, faces, quality=quality)
        errors.append(np.abs(drawn.evaluate_edge(0, 0, t)[:, 0] - true.evaluate_edge(0, 0, t)[:, 0]).max())
    assert errors[2] < 1e-5
    assert errors[0] > 4 * errors[1] > 16 * errors[2]


def test_derivatives_are_those_of_the_position():
    vertices, faces = noisy_cage()
    drawn = surface(vertices, faces, quality=3)
    h = 1e-5
    for f in (0, 7, len(faces) - 1):
        for e in range(len(faces[f])):
            j = drawn.evaluate_edge(f, e, [0.3 - h, 0.3, 0.3 + h])
            assert np.allclose((j[2, 0] - j[0, 0]) / (2 * h), j[1, 1], atol=1e-7)
            assert np.allclose((j[2, 1] - j[0, 1]) / (2 * h), j[1, 3], atol=1e-5)
            assert np.allclose((j[2, 2] - j[0, 2]) / (2 * h), j[1, 4], atol=1e-5)


def test_only_the_rings_around_matter():
    vertices, faces = noisy_cage()
    whole = surface(vertices, faces)
    v, offsets, corners = _arrays.mesh(vertices, faces)
    some = _native.LimitSurface(v, offsets, corners, options.subdivision({}), [faces[5][0]])
    t = np.linspace(0, 1, 7).tolist()
    for e in range(4):
        assert np.abs(whole.evaluate_edge(5, e, t) - some.evaluate_edge(5, e, t)).max() < 1e-13


@pytest.mark.parametrize("replaced", [False, True])
@pytest.mark.parametrize("rings", [2, 3])
def test_cube_sphere_corner(rings, replaced):
    vertices, faces = cube_sphere(8)
    left, gone = corner_removed(vertices, faces, rings)
    if replaced:
        rim = [r for r in tripatch.find_holes(left) if len(r) == 6 * rings][0]
        fill = tripatch.fill(vertices, faces, rim=rim, replaced=gone, surroundings="limit", level=2)
    else:
        fill = tripatch.fill(vertices, left, surroundings="limit", level=2)
    assert fill.report.seam_angle_max < 1e-5
    assert fill.report.folds == 0
    assert len(fill.border) == 4 * len(fill.rim)
    assert min(min(face) for face in fill.faces) >= len(vertices)
    # against the surface itself: normals along the border from its own derivatives
    t = (np.arange(100) + 0.5) / 100
    for i, side in enumerate(fill.sides):
        c, dc, r, n = side.evaluate(t)
        b = np.zeros((100, 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
        assert np.abs(fill.patch.evaluate(b) - c).max() < 1e-12
        assert unsigned_angle(fill.patch.normal(b), n).max() < 1e-5


def test_smallest_area_element_of_a_smooth_rim():
    vertices, faces = cube_sphere(8)
    left, _ = corner_removed(vertices, faces, 2)
    fill = tripatch.fill(vertices, left, surroundings="limit")
    n = 60
    b = np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]) / n
    b = b[b.max(axis=1) < 0.98]
    _, d = fill.patch.evaluate(b, 1)
    area = np.linalg.norm(np.cross(d[:, 0], d[:, 1]), axis=1)
    assert area.min() > 1e-3 * area.mean()


def test_holes_filled_at_once_are_those_filled_one_by_one():
    vertices, faces = cube_sphere(6)
    vertices = vertices + 0.02 * np.random.default_rng(4).normal(size=vertices.shape)
    tips = np.flatnonzero(np.bincount(np.ravel(faces)) == 3)
    left = [face for face in faces if not set(face) & set(tips.tolist())]
    rims = tripatch.find_holes(left)
    assert len(rims) == 8
    corners = [rim[::2].tolist() for rim in rims]
    together = tripatch.fill_all(vertices, left, rims, corners=corners, surroundings="limit", fairing=None)
    for rim, chosen, fill in zip(rims, corners, together, strict=True):
        alone = tripatch.fill(vertices, left, rim=rim, corners=chosen, surroundings="limit", fairing=None)
        assert np.array_equal(fill.vertices, alone.vertices)


def test_creases_reach_the_surface():
    vertices, faces = cube_sphere(4)
    left, _ = corner_removed(vertices, faces, 1)
    rim = tripatch.find_holes(left)[0]
    edges = np.stack([rim, np.roll(rim, -1)], axis=1)
    smooth = tripatch.fill(vertices, left, surroundings="limit", level=0)
    sharp = tripatch.fill(vertices, left, surroundings="limit", level=0, subdivision={"vertex_creases": (rim, np.ones(len(rim)))})
    assert np.abs(sharp.vertices[sharp.border] - vertices[sharp.rim]).max() < 1e-6  # sharp vertices stay in place
    assert np.abs(smooth.vertices[smooth.border] - vertices[smooth.rim]).max() > 1e-3
    kept = tripatch.fill(vertices, left, surroundings="limit", subdivision={"edge_creases": (edges, np.ones(len(edges)))})
    assert kept.report.seam_angle_max < 1e-5


def test_a_corner_of_two_edges_has_no_tangent_plane():
    """A closed cage's vertex of two edges: every derivative of the limit vanishes there."""
    vertices, faces = cube_sphere(6)
    left, gone = corner_removed(vertices, faces, 2)
    rim = tripatch.find_holes(left)[0]
    inside = set(np.ravel([faces[f] for f in gone])) - set(rim.tolist())
    quad = next(f for f in gone if sum(v in inside for v in faces[f]) == 1)
    tip = next(v for v in faces[quad] if v in inside)
    kept = [faces[quad][(faces[quad].index(tip) + k) % 4] for k in (3, 0, 1)]  # half of it is left as a triangle
    rim = next(r for r in tripatch.find_holes(left + [kept]) if tip in r).tolist()
    corners = [rim[(rim.index(tip) + k) % len(rim)] for k in (0, 4, 8)]
    with refused("corner_lacks_planes") as refusal:
        tripatch.fill(vertices, left + [kept], rim=rim, corners=corners, output="cage")
    assert list(refusal.value.where) == [tip]


def test_without_the_limit_surface_the_refined_points_serve():
    vertices, faces = cube_sphere(8)
    left, _ = corner_removed(vertices, faces, 3)
    fill = tripatch.fill(vertices, left, surroundings="limit", level=3, subdivision={"use_limit_surface": False})
    limit = tripatch.fill(vertices, left, surroundings="limit", level=3)
    assert says(fill.report, "limit_not_used")
    gap = np.abs(fill.vertices[fill.border] - limit.vertices[limit.border]).max()
    assert 1e-5 < gap < 1e-2


@pytest.mark.parametrize(
    ("settings", "error"),
    [
        ({"quality": 0}, ValueError),
        ({"quality": 2.5}, TypeError),
        ({"scheme": "butterfly"}, ValueError),
        ({"boundary_smooth": "none"}, ValueError),
        ({"sharp": 1}, ValueError),
        ({"edge_creases": ([[0, 1]], [2.0])}, ValueError),
        ({"edge_creases": ([[0, 1, 2]], [1.0])}, ValueError),
        ({"vertex_creases": ([0.5], [1.0])}, TypeError),
    ],
)
def test_wrong_settings(settings, error):
    vertices, faces = cube_sphere(4)
    left, _ = corner_removed(vertices, faces, 1)
    with pytest.raises(error):
        tripatch.fill(vertices, left, surroundings="limit", subdivision=settings)


def with_fin(vertices, faces, a, b):
    n = len(vertices)
    return np.vstack([vertices, 1.5 * vertices[[a, b]]]), faces + [[a, b, n + 1, n]]


def test_bad_cages():
    """Each is refused with a sentence, or filled where the trouble is out of reach."""
    vertices, faces = cube_sphere(6)
    left, _ = corner_removed(vertices, faces, 2)
    rim = tripatch.find_holes(left)[0].tolist()
    options = {"rim": rim, "corners": rim[::4], "surroundings": "limit"}
    adjacent = next(f for f in left if len(set(rim) & set(f)) == 2)
    far = max(left, key=lambda f: np.linalg.norm(vertices[f].mean(axis=0) - vertices[rim].mean(axis=0)))

    def refusal(*mesh):
        with pytest.raises(tripatch.Refusal) as caught:
            tripatch.fill(*mesh, **options)
        return caught.value.code

    on_rim = [v for v in adjacent if v in rim]
    assert "faces_on_both_sides" == refusal(*with_fin(vertices, left, *on_rim))
    assert "faces_on_both_sides" == refusal(vertices, left + [adjacent])
    assert "faces_flipped" == refusal(vertices, [f[::-1] if f is adjacent else f for f in left])
    moved = vertices.copy()
    moved[adjacent] = np.nan
    assert refusal(moved, left) == "vertex_not_finite"
    moved[adjacent] = 0
    assert refusal(moved, left) == "edge_without_length"
    # what OpenSubdiv itself rejects
    angle = np.linspace(0, 6, 70000)
    many = np.vstack([vertices, np.stack([np.cos(angle), np.sin(angle), angle], axis=1)])
    ngon = [next(v for v in adjacent if v not in rim), *range(len(vertices), len(many))]
    assert refusal(many, left + [ngon]) == "face_has_many_corners"

    plain = tripatch.fill(vertices, left, **options)
    away = [v for v in adjacent if v not in rim]
    for mesh in (with_fin(vertices, left, *far[:2]), with_fin(vertices, left, *away)):
        fill = tripatch.fill(*mesh, **options)
        assert fill.report.seam_angle_max < 1e-5 and np.abs(fill.vertices - plain.vertices).max() < 0.1
    moved = vertices.copy()
    moved[far] = np.nan
    assert np.array_equal(tripatch.fill(moved, left, **options).vertices, plain.vertices)


def test_scales_that_mirror():
    vertices, faces = cube_sphere(6)
    left, _ = corner_removed(vertices, faces, 2)
    rim = tripatch.find_holes(left)[0].tolist()
    options = {"rim": rim, "corners": rim[::4], "surroundings": "limit", "fairing": None}
    plain = tripatch.fill(vertices, left, **options)
    image = tripatch.fill(vertices * (-1, 1, 1), [f[::-1] for f in left], **options)
    t = np.linspace(0, 1, 33)
    for i, side in enumerate(image.sides):
        c, _, _, n = side.evaluate(t)
        gaps = [np.abs(other.evaluate(1 - t)[0] * (-1, 1, 1) - c).max() for other in plain.sides]
        other = plain.sides[int(np.argmin(gaps))]
        assert min(gaps) < 1e-12 and np.abs(other.evaluate(1 - t)[3] * (-1, 1, 1) - n).max() < 1e-9, i
    assert image.report.seam_angle_max < 1e-5


def test_beside_a_cage_of_smooth_triangles_the_patch_that_bends_least_takes_the_place_of_one_that_folds():
    """The limit's slopes ripple along the border of a cage of triangles."""
    vertices, faces = icosphere(3)
    left = faces[4**3 :]  # without the first of the icosahedron's
    rim = tripatch.find_holes(left)[0]
    corners = [int(v) for v in rim if v < 12]
    folded = tripatch.fill(vertices, left, corners=corners, surroundings="limit", fairing=None)
    assert folded.report.folds > 0, "what is asked for is done, and said"
    fill = tripatch.fill(vertices, left, corners=corners, surroundings="limit")
    assert fill.report.folds == fill.report.triangles_folded == 0
    assert says(fill.report, "fairest_folds_least_bending")
    assert fill.report.seam_angle_max < 1e-5
    assert np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max() < 0.01


def jagged_hole():
    """Of a bumpy ball of uneven triangles, three rings around a vertex taken out: no side of the rim is smooth."""
    rng = np.random.default_rng(4)
    vertices, faces = icosphere(3)
    edge = np.linalg.norm(vertices[faces[0][0]] - vertices[faces[0][1]])
    vertices = vertices * (1 + 0.1 * np.sin(vertices @ [3, 1, -2]))[:, None] + 0.2 * edge * rng.normal(size=vertices.shape)
    gone = {300}
    for _ in range(2):
        gone |= {v for face in faces if gone & set(face) for v in face}
    left = [face for face in faces if not gone & set(face)]
    return vertices, left, tripatch.find_holes(left)[0]


@pytest.mark.parametrize("output", ["triangles", "quads"])
def test_where_a_patch_on_the_limit_folds_its_points_are_followed(output):
    vertices, faces, rim = jagged_hole()
    corners = [int(rim[k * len(rim) // 3]) for k in range(3)]
    settings = {"corners": corners, "surroundings": "limit", "level": 2, "output": output}
    assert tripatch.fill(vertices, faces, fairing="thin_plate", **settings).report.folds > 0
    fill = tripatch.fill(vertices, faces, **settings)
    assert fill.report.method == "polyharmonic_spline" and fill.report.triangles_folded == 0
    assert says(fill.report, "limit_planes_fold")
    assert fill.report.corners == corners or set(fill.report.corners) == set(corners)
    # a mesh of its own, whose border is that of the limit
    n = len(vertices)
    assert min(min(face) for face in fill.faces) == n and max(max(face) for face in fill.faces) == n + len(fill.vertices) - 1
    edges = directed(fill.faces)
    border = {a - n for a, b in edges if (b, a) not in edges}
    assert border == {int(v) for v in fill.border} and len(border) == 4 * len(rim)
    patch = tripatch.fill(vertices, faces, fairing="thin_plate", **settings)
    assert np.abs(fill.vertices[fill.border] - patch.vertices[patch.border]).max() < 1e-9
    assert len(fill.rim) == len(fill.rim_normals) == len(fill.rim_uv) == len(rim)
    assert len(fill.normals) == len(fill.uv) == len(fill.deviation) == len(fill.vertices)
    ahead = np.linalg.norm(fill.patch.evaluate(fill.uv) - fill.vertices, axis=1)
    assert ahead.max() < 0.02 * np.linalg.norm(np.ptp(vertices[rim], axis=0))


def test_a_patch_that_was_asked_for_is_made_though_it_folds():
    vertices, faces, rim = jagged_hole()
    corners = [int(rim[k * len(rim) // 3]) for k in range(3)]
    fill = tripatch.fill(vertices, faces, corners=corners, surroundings="limit", method="side_vertex")
    assert fill.report.method == "side_vertex" and fill.report.folds > 0
    assert says(fill.report, "patch_folds")
