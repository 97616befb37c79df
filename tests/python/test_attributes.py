"""Weights of what the rim gives to new vertices, and normals."""

import numpy as np
import pytest
import tripatch


def triangle_rim(edges):
    """Barycentric coordinates of a rim with edges[i] edges on side i, from corner 0 on."""
    rim, rng = [], np.random.default_rng(3)
    for i in (2, 0, 1):  # the side from corner 0 to 1, and on
        t = np.sort(np.concatenate([[0], rng.random(edges[i] - 1)]))
        b = np.zeros((edges[i], 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
        rim.append(b)
    return np.vstack(rim)


def inside_triangle(count):
    b = np.random.default_rng(4).dirichlet((1, 1, 1), count)
    return b


def at_ends(values):
    """From values at rim vertices to those at both ends of every edge."""
    return np.stack([values, np.roll(values, -1, axis=0)], axis=1).reshape(-1, values.shape[1])


def side_vertex(rim, b):
    """Nielson's interpolant as it is written down, in numpy: (k, 12) ends and weights."""
    count, corner = len(rim), [int(np.argmax(rim[:, i])) for i in range(3)]
    others = np.stack([b[:, 1] * b[:, 2], b[:, 2] * b[:, 0], b[:, 0] * b[:, 1]], axis=1) ** 2
    share = others / others.sum(axis=1, keepdims=True)
    ends, weights = [], []
    for i in range(3):
        first, last = corner[(i + 1) % 3], corner[(i + 2) % 3] or count
        along = rim[np.arange(first, last + 1) % count, (i + 2) % 3]
        t = b[:, (i + 2) % 3] / (b[:, (i + 1) % 3] + b[:, (i + 2) % 3])
        edge = np.clip(np.searchsorted(along, t, side="right") - 1, 0, len(along) - 2)
        u = (t - along[edge]) / (along[edge + 1] - along[edge])
        edge = edge + first
        on_side, at_corner = share[:, i] * (1 - b[:, i]), share[:, i] * b[:, i] / 2
        ends += [2 * edge, 2 * edge + 1, np.full_like(edge, 2 * corner[i]), np.full_like(edge, (2 * corner[i] - 1) % (2 * count))]
        weights += [on_side * (1 - u), on_side * u, at_corner, at_corner]
    return np.stack(ends, axis=1), np.stack(weights, axis=1)


def test_over_a_triangle_it_is_the_side_vertex_interpolant():
    rim, b = triangle_rim((4, 1, 7)), inside_triangle(10000)
    weights = tripatch.attribute_weights(rim, b)
    ends, expected = side_vertex(rim, b)
    np.testing.assert_array_equal(weights.ends, ends)
    np.testing.assert_allclose(weights.weights, expected, atol=1e-15)
    values = np.random.default_rng(5).random((2 * len(rim), 4))
    np.testing.assert_allclose(weights(values), np.einsum("ke,ked->kd", expected, values[ends]), atol=1e-14)
    np.testing.assert_array_equal(weights.nearest, ends[np.arange(len(b)), weights.weights.argmax(axis=1)])


def polygon(sides=9):
    angle = np.arange(sides) * 2 * np.pi / sides
    return np.column_stack([2 * np.cos(angle), np.sin(angle)]) * (1 + 0.3 * np.cos(3 * angle))[:, None]


def inside_polygon(rim, count=200):
    rng = np.random.default_rng(6)
    return (rng.random((count, 1)) * rim[rng.integers(len(rim), size=count)]) * 0.9


@pytest.mark.parametrize("plane", [False, True])
def test_linear_functions_of_the_parameters_come_back(plane):
    rim, at = (polygon(), inside_polygon(polygon())) if plane else (triangle_rim((3, 5, 2)), inside_triangle(200))
    weights = tripatch.attribute_weights(rim, at)
    np.testing.assert_allclose(weights(at_ends(rim)), at, atol=1e-13)
    np.testing.assert_allclose(weights.weights.sum(axis=1), 1, atol=1e-13)
    assert weights.ends.shape == weights.weights.shape == (200, 2 * len(rim) if plane else 12)


@pytest.mark.parametrize("plane", [False, True])
def test_on_the_rim_it_takes_the_rim_s_values(plane):
    rim = polygon() if plane else triangle_rim((3, 5, 2))
    values = np.random.default_rng(7).random((len(rim), 2))
    weights = tripatch.attribute_weights(rim, rim)
    np.testing.assert_allclose(weights(at_ends(values)), values, atol=1e-13)
    between = (rim + 2 * np.roll(rim, -1, axis=0)) / 3
    expected = (values + 2 * np.roll(values, -1, axis=0)) / 3
    np.testing.assert_allclose(tripatch.attribute_weights(rim, between)(at_ends(values)), expected, atol=1e-9)


def test_mean_values_of_a_regular_polygon_at_its_middle_are_equal():
    angle = np.arange(5) * 2 * np.pi / 5
    rim = np.column_stack([np.cos(angle), np.sin(angle)])
    weights = tripatch.attribute_weights(rim, [[0.0, 0.0]])
    np.testing.assert_allclose(weights.weights, 0.1, atol=1e-15)
    turned = tripatch.attribute_weights(rim[::-1], [[0.2, 0.1]])(at_ends(rim[::-1]))  # the rim may run either way
    np.testing.assert_allclose(turned, [[0.2, 0.1]], atol=1e-15)


def test_two_edges_may_disagree_at_their_vertex():
    """Each point near an edge has the values of that edge."""
    rim = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    values = np.repeat(np.arange(4.0), 2)[:, None]  # edge e has the value e
    near = [[0.5, 1e-9], [1 - 1e-9, 0.5], [0.5, 1 - 1e-9], [1e-9, 0.5]]
    np.testing.assert_allclose(tripatch.attribute_weights(rim, near)(values)[:, 0], np.arange(4), atol=1e-7)


def test_of_a_fill():
    vertices, faces = cone()
    fill = tripatch.fill(vertices, faces, rim=range(12), corners=[0, 4, 8])
    weights = tripatch.attribute_weights(fill)
    np.testing.assert_array_equal(weights.weights, tripatch.attribute_weights(fill.rim_barycentric, fill.barycentric).weights)
    assert len(weights.nearest) == len(fill.vertices)


def test_wrong_shapes_are_refused():
    with pytest.raises(ValueError, match="shape"):
        tripatch.attribute_weights(np.zeros((4, 4)), np.zeros((1, 4)))
    with pytest.raises(ValueError, match=r"inside must have shape \(1, 2\), not \(1, 3\)"):
        tripatch.attribute_weights(np.zeros((4, 2)), np.zeros((1, 3)))
    with pytest.raises(ValueError, match=r"len\(rim\) must be 3 or more"):
        tripatch.attribute_weights(np.zeros((2, 2)), np.zeros((1, 2)))
    with pytest.raises(ValueError, match="start at corner 0"):
        tripatch.attribute_weights(triangle_rim((2, 2, 2))[::-1], inside_triangle(1))
    with pytest.raises(ValueError, match="finite"):
        tripatch.attribute_weights(polygon(), [[np.nan, 0]])
    weights = tripatch.attribute_weights(polygon(), [[0.0, 0.0]])
    with pytest.raises(ValueError, match=r"shape \(18, d\), not \(9, d\)"):
        weights(np.zeros((9, 1)))
    with pytest.raises(TypeError):
        weights(["a"])


def cone(count=12):
    """A cone of quads between a circle and a smaller one, which comes first."""
    angle = np.arange(count) * 2 * np.pi / count
    circle = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    following = [(k + 1) % count for k in range(count)]
    return np.vstack([0.5 * circle + [0, 0, 0.5], circle]), [
        [k, count + k, count + following[k], following[k]] for k in range(count)
    ]


def test_vertex_normals_of_a_box_point_along_its_diagonals():
    """Three right angles in every corner, whether its faces are whole or split."""
    p = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]
    for faces in (quads, triangles):
        np.testing.assert_allclose(tripatch.vertex_normals(p, faces), (2 * p - 1) / np.sqrt(3), atol=1e-15)


def test_vertex_normals_take_what_corners_give():
    p, faces = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]]), [[0, 1, 2]]
    given = np.array([[0, 0, 0], [0, 0.6, 0.8], [0, 0, 0]])
    normals = tripatch.vertex_normals(p, faces, given)
    np.testing.assert_allclose(normals, [[0, 0, 1], [0, 0.6, 0.8], [0, 0, 1], [0, 0, 0]], atol=1e-15)


def test_vertex_normals_that_cancel_are_zero():
    p = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    np.testing.assert_array_equal(tripatch.vertex_normals(p, [[0, 1, 2], [0, 2, 1]]), 0)


def test_angles():
    tiny = 1e-9
    a = [[1, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 0]]
    b = [[1, tiny, 0], [-3, 0, 0], [0, 1, 1], [1, 0, 0]]
    np.testing.assert_allclose(tripatch.angles(a, b), [np.degrees(tiny), 180, 45, 0], rtol=1e-12)
    with pytest.raises(ValueError, match="b must have shape"):
        tripatch.angles(a, b[:2])


def test_what_cut_triangles_have_of_the_flat_ones_is_linear():
    """On a flat mesh the new vertices lie where their weights of the old ones say, edge by edge and corner by corner."""
    p, triangles = np.array([[0.0, 0, 0], [1, 0, 0], [0.3, 0.8, 0], [1.2, 1, 0]]), [[0, 1, 2], [2, 1, 3]]
    up = np.tile([0.0, 0, 1], (4, 1))
    for resolution in (2, 3, 5):
        smooth = tripatch.smooth_triangles(p, triangles, up, resolution)
        weights = tripatch.CutWeights(smooth, triangles, len(p))
        at_corners = weights(p[np.ravel(triangles)])
        straight = np.vstack([p, weights.at_new_vertices(p, smooth.edges, triangles)])
        np.testing.assert_allclose(straight[smooth.faces.ravel()], at_corners, atol=1e-14)
        ends = p[smooth.edges]  # points that cut an edge lie evenly on it
        cuts = straight[len(p) : len(p) + len(smooth.edges) * (resolution - 1)].reshape(len(smooth.edges), -1, 3)
        u = np.arange(1, resolution)[:, None] / resolution
        np.testing.assert_allclose(cuts, ends[:, :1] * (1 - u) + ends[:, 1:] * u, atol=1e-14)
        own = np.arange(len(triangles)).repeat(3 * resolution**2)
        np.testing.assert_array_equal(weights.nearest // 3, own)  # a corner of the triangle it came from,
        apart = np.linalg.norm(at_corners[:, None] - p[triangles][own], axis=2)
        shares = weights.corners.reshape(-1, 3)
        assert (shares[np.arange(len(own)), weights.nearest % 3] == shares.max(axis=1)).all()
        assert (apart[shares == 1] < 1e-14).all()
