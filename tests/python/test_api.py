"""The Python interface: shapes, options, refusals."""

import pickle

import numpy as np
import pytest
import tripatch
from codes import refused
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import octant


def test_shapes_and_reuse_of_the_rim():
    vertices, faces, rim = octant()
    before = vertices.copy()
    fill = tripatch.fill(vertices, faces, rim=rim)
    n, k = len(vertices), len(fill.vertices)
    assert np.array_equal(vertices, before)
    assert fill.normals.shape == fill.barycentric.shape == (k, 3)
    assert fill.rim_normals.shape == fill.rim_barycentric.shape == (len(rim), 3)
    used = {v for face in fill.faces for v in face}
    assert used == set(rim) | set(range(n, n + k))
    assert np.allclose(fill.patch.evaluate(fill.barycentric), fill.vertices, atol=1e-15)
    assert np.allclose(fill.patch.evaluate(fill.rim_barycentric), vertices[fill.rim], atol=1e-14)
    assert sorted(fill.rim) == sorted(rim)
    assert fill.report.corners == [fill.rim[0], fill.rim[8], fill.rim[16]]
    assert fill.report.as_dict()["seam_angle_max"] == fill.report.seam_angle_max < 1e-4


def test_whole_mesh_is_closed_where_the_hole_was():
    vertices, faces, rim = octant()
    fill = tripatch.fill(vertices, faces, rim=rim)
    loops = tripatch.find_holes([*faces, *fill.faces])
    assert not any(set(loop) & set(rim) for loop in loops)
    edges = {(f[k], f[(k + 1) % len(f)]) for f in [*faces, *fill.faces] for k in range(len(f))}
    assert len(edges) == sum(len(f) for f in [*faces, *fill.faces])  # no edge twice in one direction: oriented alike


@pytest.mark.parametrize("start", [0, 5, 11])
@pytest.mark.parametrize("backwards", [False, True])
def test_a_rim_may_start_anywhere_and_run_either_way(start, backwards):
    vertices, faces, rim = octant()
    turned = rim[start:] + rim[:start]
    fill = tripatch.fill(vertices, faces, rim=turned[::-1] if backwards else turned, corners=[rim[0], rim[8], rim[16]])
    reference = tripatch.fill(vertices, faces, rim=rim, corners=[rim[0], rim[8], rim[16]])
    assert np.array_equal(fill.rim, reference.rim)
    assert np.array_equal(fill.vertices, reference.vertices)
    assert np.array_equal(fill.faces, reference.faces)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-6, 1.0, 1e6]))
def test_rigid_motions_and_scales(seed, scale):
    rng = np.random.default_rng(seed)
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    q *= np.sign(np.linalg.det(q))
    shift = scale * rng.normal(size=3)
    vertices, faces, rim = octant(4)
    plain = tripatch.fill(vertices, faces, rim=rim)
    moved = tripatch.fill(scale * vertices @ q.T + shift, faces, rim=rim)
    assert np.array_equal(moved.rim, plain.rim)
    assert np.abs((moved.vertices - shift) @ q / scale - plain.vertices).max() < 1e-9
    assert abs(moved.report.seam_angle_max - plain.report.seam_angle_max) < 1e-5


def test_fill_all_tells_how_far_it_is():
    vertices, faces, rim = octant()
    told = []
    tripatch.fill_all(vertices, faces, [rim] * 5, progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (5, 5) and all(total == 5 for _, total in told) and told == sorted(told)


@pytest.mark.parametrize("raised", [KeyboardInterrupt, RuntimeError])
def test_fill_all_can_be_interrupted(raised):
    vertices, faces, rim = octant()

    def progress(done, total):
        raise raised(f"enough after {done} of {total}")

    with pytest.raises(raised, match=r"enough after 1?\d?\d?\d of 2000"):
        tripatch.fill_all(vertices, faces, [rim] * 2000, progress=progress)


def test_fill_all_keeps_the_order_and_goes_on_after_a_refusal():
    vertices, faces, rim = octant()
    loops = tripatch.find_holes(faces)
    results = tripatch.fill_all(vertices, faces, [rim, [0, 1], rim])
    assert isinstance(results[0], tripatch.Fill) and isinstance(results[2], tripatch.Fill)
    assert isinstance(results[1], tripatch.Refusal)
    assert len(tripatch.fill_all(vertices, faces, outer=True)) == len(loops) == 2
    (hole,) = tripatch.fill_all(vertices, faces)  # the other border is the outer one
    assert sorted(hole.rim) == sorted(rim)


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"method": "coons"}, ValueError),
        ({"method": 3}, TypeError),
        ({"continuity": "G3"}, ValueError),
        ({"continuity": ("G1",) * 13}, ValueError),
        ({"continuity": 1}, TypeError),
        ({"bulge": 0}, ValueError),
        ({"bulge": (1, -1, 1)}, ValueError),
        ({"bulge": "big"}, TypeError),
        ({"bulge": float("nan")}, ValueError),
        ({"shape": (0.5, 0.5, 1.0)}, ValueError),
        ({"shape": "best"}, ValueError),
        ({"resolution": 0}, ValueError),
        ({"resolution": 2.5}, TypeError),
        ({"resolution": True}, TypeError),
        ({"fairing": "nice"}, ValueError),
        ({"cross_boundary": "printed"}, ValueError),
        ({"corners": [0]}, ValueError),
        ({"corners": [0.5, 1, 2]}, TypeError),
        ({"rim": 7}, ValueError),
        ({"radius": 1}, TypeError),
    ],
)
def test_wrong_options_are_named(options, error):
    vertices, faces, rim = octant(4)
    with pytest.raises(error) as caught:
        tripatch.fill(vertices, faces, **{"rim": rim, **options})
    assert not isinstance(caught.value, tripatch.Refusal)
    assert next(iter(options)) in str(caught.value)


@pytest.mark.parametrize(
    ("vertices", "faces", "error"),
    [
        ("abc", [[0, 1, 2]], TypeError),
        (np.zeros((3, 2)), [[0, 1, 2]], ValueError),
        (np.zeros((3, 3), complex), [[0, 1, 2]], TypeError),
        (np.zeros((3, 3)), 5, TypeError),
        (np.zeros((3, 3)), [[0, 1]], ValueError),
        (np.zeros((3, 3)), [[0, 1, 3]], ValueError),
        (np.zeros((3, 3)), [[0, 1, -1]], ValueError),
        (np.zeros((3, 3)), np.zeros((1, 3)), TypeError),
        (np.zeros((3, 3)), [[0, 1, "x"]], TypeError),
        (np.zeros((0, 3)), np.zeros((0, 3), int), tripatch.Refusal),
    ],
)
def test_wrong_meshes(vertices, faces, error):
    with pytest.raises(error):
        tripatch.fill(vertices, faces)


def test_a_refusal_has_a_reason_and_a_place_and_travels():
    refusal = tripatch.Refusal("Rim has 5 corners; select three", [3, 4])
    again = pickle.loads(pickle.dumps(refusal))
    assert isinstance(refusal, ValueError)
    assert (again.reason, again.where) == (refusal.reason, refusal.where) == ("Rim has 5 corners; select three", [3, 4])


def test_continuity_above_the_method_is_refused():
    vertices, faces, rim = octant(4)
    for continuity in ("G1", "G2"):
        with refused("continuity_above_method"):
            tripatch.fill(vertices, faces, rim=rim, method="gordon_coons", continuity=continuity)


def test_position_only_leaves_the_tangent_plane():
    vertices, faces, rim = octant()
    free = tripatch.fill(vertices, faces, rim=rim, continuity=("G0", "G1", "G1"), fairing=None)
    angles = free.report.seam_angle_max_by_side
    assert angles[0] > 1 and max(angles[1:]) < 1e-4


def test_bulge_raises_the_middle_and_keeps_the_seam():
    vertices, faces, rim = octant()
    middle = [[1 / 3, 1 / 3, 1 / 3]]
    heights = []
    for bulge in (0.5, 1.0, 2.0):
        fill = tripatch.fill(vertices, faces, rim=rim, bulge=bulge, fairing=None)
        assert fill.report.seam_angle_max < 1e-4
        heights.append(np.linalg.norm(fill.patch.evaluate(middle)))
    assert heights[0] < heights[1] < heights[2]


def test_patch_from_functions_and_its_derivatives():
    fill = tripatch.fill(*octant(4)[:2], rim=octant(4)[2])
    b = np.array([[0.2, 0.3, 0.5], [0.6, 0.3, 0.1]])
    p, d1, d2, d3 = fill.patch.evaluate(b, 3)
    assert (d1.shape, d2.shape, d3.shape) == ((2, 2, 3), (2, 3, 3), (2, 4, 3))
    h = 1e-5
    for k, step in enumerate(([h, 0, -h], [0, h, -h])):
        q, e1, e2 = fill.patch.evaluate(b + step, 2)
        r, f1, f2 = fill.patch.evaluate(b - step, 2)
        assert np.allclose((q - r) / (2 * h), d1[:, k], atol=1e-8)
        assert np.allclose((e1 - f1) / (2 * h), d2[:, k : k + 2], atol=1e-7)
        assert np.allclose((e2 - f2) / (2 * h), d3[:, k : k + 3], atol=1e-5)


def test_two_barycentric_coordinates_tell_the_third():
    vertices, faces, rim = octant(4)
    patch = tripatch.fill(vertices, faces, rim=rim).patch
    b = np.array([[0.2, 0.3, 0.5], [0.6, 0.3, 0.1], [1, 0, 0]])
    for of_all, of_two in zip(patch.evaluate(b, 2), patch.evaluate(b[:, :2], 2)):
        assert np.allclose(of_all, of_two, rtol=0, atol=1e-11)
    assert np.allclose(patch.normal(b), patch.normal(b[:, :2]), rtol=0, atol=1e-11)


@pytest.mark.parametrize("b", [[[0.5, 0.5, 0.5]], [[1.2, -0.1, -0.1]], [[np.nan, 0.5, 0.5]], [[1]], [["a", "b", "c"]]])
def test_points_outside_the_triangle(b):
    vertices, faces, rim = octant(4)
    patch = tripatch.fill(vertices, faces, rim=rim).patch
    with pytest.raises((ValueError, TypeError)):
        patch.evaluate(b)


def test_of_many_points_the_first_outside_is_named():
    vertices, faces, rim = octant(4)
    patch = tripatch.fill(vertices, faces, rim=rim).patch
    b = np.full((100_000, 3), 1 / 3)
    b[[70_000, 90_000]] = 1.2, -0.1, -0.1
    with pytest.raises(ValueError, match=r"b\[70000\] is outside the triangle"):
        patch.evaluate(b)
    b[80_000, 2] = np.inf
    with pytest.raises(ValueError, match=r"b\[80000\] is not finite"):
        patch.normal(b)


def test_positions_and_normals_come_together():
    vertices, faces, rim = octant(4)
    patch = tripatch.fill(vertices, faces, rim=rim).patch
    b = np.vstack([np.eye(3), np.random.default_rng(0).dirichlet([1, 1, 1], 5000)])
    positions, normals = patch.positions_and_normals(b)
    assert np.allclose(positions, patch.evaluate(b), rtol=0, atol=1e-15)
    assert np.array_equal(normals, patch.normal(b))
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, rtol=0, atol=1e-15)


def test_a_wrong_derivative_is_noticed():
    def line(t):
        return np.stack([t, 0 * t, 0 * t], axis=1)

    with pytest.raises(ValueError, match="dc is not the derivative"):
        tripatch.Side.from_functions(line, line, line)
    with pytest.raises(ValueError, match="shape"):
        tripatch.Side.from_functions(lambda t: t, lambda t: t, lambda t: t)


def test_the_derivative_of_a_side_may_jump():
    """As it does along edges of CAD programs; in the middle, where a polynomial that is halved ends, it was refused."""

    def line(t):
        return np.outer(np.where(t < 0.5, t, 3 * t - 1), (1.0, 0, 0))

    def derivative(t):
        return np.outer(np.where(t < 0.5, 1, 3), (1.0, 0, 0))

    def across(t):
        return np.outer(np.ones_like(t), (0, 1.0, 0))

    tripatch.Side.from_functions(line, derivative, across)
    with pytest.raises(ValueError, match="dc is not the derivative"):
        tripatch.Side.from_functions(line, lambda t: np.outer(np.where(t < 0.8, 1, 3), (1.0, 0, 0)), across)


@pytest.mark.parametrize(("wrong", "noticed"), [(8, False), (9, True)])
def test_a_derivative_that_is_wrong_at_nine_of_65_places_is_noticed(wrong, noticed):
    def line(t):
        return np.outer(t, (1.0, 0, 0))

    def derivative(t):
        return np.outer(np.where(np.asarray(t) < (wrong - 0.5) / 64, 3, 1), (1.0, 0, 0))

    def across(t):
        return np.outer(np.ones_like(t), (0, 1.0, 0))

    if noticed:
        with pytest.raises(ValueError, match="dc is not the derivative"):
            tripatch.Side.from_functions(line, derivative, across)
    else:
        tripatch.Side.from_functions(line, derivative, across)


def test_the_core_gives_the_interpreter_back_and_the_same_bits():
    from concurrent.futures import ThreadPoolExecutor

    vertices, faces, rim = octant()
    with ThreadPoolExecutor(4) as pool:
        fills = list(pool.map(lambda _: tripatch.fill(vertices, faces, rim=rim), range(8)))
    assert all(np.array_equal(f.vertices, fills[0].vertices) for f in fills)


def quad_counts(fill):
    return sorted(len(face) for face in fill.faces)


@pytest.mark.parametrize("resolution", [None, 0, 2])
def test_quads(resolution):
    vertices, faces, rim = octant()
    fill = tripatch.fill(vertices, faces, rim=rim, output="quads", resolution=resolution)
    assert set(quad_counts(fill)) == {4}
    assert not any(set(loop) & set(rim) for loop in tripatch.find_holes([*faces, *fill.faces]))
    assert np.allclose(fill.patch.evaluate(fill.barycentric), fill.vertices, atol=1e-14)
    if resolution == 0:
        assert len(fill.faces) == 48


@pytest.mark.parametrize("kind", [np.int32, np.int16, np.uint32, np.uint8])
def test_faces_of_any_integers_are_those_of_64_bits_and_the_compiled_core_reads_32_as_they_are(kind):
    vertices, faces, rim = octant(2)
    wide, given = np.array(faces, np.int64), np.array(faces, kind)
    assert np.array_equal(given, wide)
    a, b = tripatch.fill(vertices, wide), tripatch.fill(vertices, given)
    assert np.array_equal(a.vertices, b.vertices) and np.array_equal(a.faces, b.faces)
    for a, b in zip(tripatch.fill_holes(vertices, wide)[:2], tripatch.fill_holes(vertices, given)[:2], strict=True):
        assert np.array_equal(a, b)
    assert [list(loop) for loop in tripatch.find_holes(given)] == [list(loop) for loop in tripatch.find_holes(wide)]
    corners = tripatch._arrays.mesh(vertices, given)[2]
    assert np.shares_memory(corners, given) == (kind == np.int32)
    for wrong in (len(vertices), -1):
        if np.iinfo(kind).min <= wrong <= np.iinfo(kind).max:
            bad = given.copy()
            bad[1, 2] = wrong
            with pytest.raises(ValueError, match=rf"faces\[1\].*{wrong}"):
                tripatch.fill(vertices, bad)


def test_quads_round_an_odd_rim():
    vertices, faces, rim = octant(5)
    split = tripatch.fill(vertices, faces, rim=rim, method="side_vertex", output="quads", resolution=0)
    assert set(quad_counts(split)) == {4}
    (edge,), (t,) = split.split_edges
    assert t == 0.5
    assert {*edge} <= set(rim)
    assert not any({*edge} <= set(face) and abs(face.index(edge[0]) - face.index(edge[1])) in (1, 3) for face in split.faces)
    middle = split.vertices[0]
    assert np.linalg.norm(middle - vertices[edge].mean(axis=0)) < 0.1 * np.linalg.norm(np.diff(vertices[edge], axis=0))
    triangle = tripatch.fill(vertices, faces, rim=rim, output="quads", odd="triangle", resolution=0)
    assert quad_counts(triangle).count(3) == 1
    assert len(triangle.split_edges[0]) == 0
