"""Surfaces by control points, sides made from them, Coons nets, smooth_triangles."""

import re

import numpy as np
import pytest
import tripatch
from codes import refused


def net_size(n):
    return (n + 1) * (n + 2) // 2


def boundary_of(triangle):
    return [triangle.side(i) for i in range(3)]


def random_boundary(n, seed=0):
    return boundary_of(tripatch.BezierTriangle(np.random.default_rng(seed).uniform(-1, 1, (net_size(n), 3))))


def grid(m, n, seed=0):
    x, y = np.meshgrid(np.arange(m), np.arange(n), indexing="ij")
    return np.stack([x, y, np.random.default_rng(seed).uniform(-0.3, 0.3, (m, n))], axis=-1).astype(float)


def tetrahedron():
    v = np.array([(1, 1, 1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1)], float) / np.sqrt(3)
    return v, np.array([(0, 1, 3), (0, 3, 2), (0, 2, 1), (1, 2, 3)])


def degrees_between(a, b):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1)))


def test_bezier_triangle_is_a_patch():
    net = np.random.default_rng(1).normal(size=(net_size(3), 3))
    triangle = tripatch.BezierTriangle(net)
    assert isinstance(triangle, tripatch.Patch) and triangle.degree == 3
    assert np.array_equal(triangle.net, net)
    b = np.array([(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.2, 0.3, 0.5)])
    p, d1, d2, d3 = triangle.evaluate(b, derivatives=3)
    assert np.allclose(p[:3], net[[0, 6, 9]], atol=1e-15)
    assert d1.shape == (4, 2, 3) and d2.shape == (4, 3, 3) and d3.shape == (4, 4, 3)
    assert np.allclose(triangle.derivative((1, 0, -1)).evaluate(b), d1[:, 0], atol=1e-13)
    assert np.allclose(triangle.derivative((0, 1, -1)).derivative((1, 0, -1)).evaluate(b), d2[:, 1], atol=1e-13)
    assert np.allclose(triangle.elevated().evaluate(b), p, atol=1e-14)
    with pytest.raises(ValueError, match="sum to 0"):
        triangle.derivative((1, 0, 0))


@pytest.mark.parametrize("net", ["abc", [["a"] * 3], {}, None])
def test_nets_of_wrong_types(net):
    with pytest.raises((TypeError, ValueError)):
        tripatch.BezierTriangle(net)


def test_nets_of_wrong_shape_or_not_finite():
    with pytest.raises(ValueError, match="not 4"):
        tripatch.BezierTriangle(np.zeros((4, 3)))
    with pytest.raises(ValueError, match="shape"):
        tripatch.BezierTriangle(np.zeros((3, 2)))
    net = np.zeros((6, 3))
    net[4, 2] = np.nan
    with pytest.raises(ValueError, match=r"net\[4\] is not finite"):
        tripatch.BezierTriangle(net)
    with pytest.raises(ValueError, match=re.escape("net[1, 2] is not finite")):
        tripatch.BezierRectangle(np.where(np.arange(27).reshape(3, 3, 3) == 15, np.inf, 0.0))
    with pytest.raises(ValueError, match="must have shape"):
        tripatch.BezierRectangle(np.zeros((9, 3)))


@pytest.mark.parametrize("kind", ["discrete", "extremal", "extremal_symmetric", "mask", "permanence"])
def test_coons_bezier_interpolates(kind):
    curves = random_boundary(5)
    triangle = tripatch.coons_bezier(curves, kind)
    assert triangle.degree == (6 if kind == "discrete" else 5)
    reference = tripatch.BezierTriangle(np.random.default_rng(0).uniform(-1, 1, (net_size(5), 3)))
    t = np.linspace(0, 1, 11)
    for i in range(3):
        b = np.zeros((11, 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
        assert np.allclose(triangle.evaluate(b), reference.evaluate(b), atol=1e-13)
    if kind == "extremal":
        assert tripatch.coons_energy(triangle) < tripatch.coons_energy(reference)


@pytest.mark.parametrize("kind", ["discrete", "extremal", "extremal_symmetric", "mask", "permanence"])
@pytest.mark.parametrize("degree", [3, 5, 7])
def test_all_coons_nets_reproduce_planes_and_no_quadratics(kind, degree):
    for own, reproduced in ((1, True), (2, False)):
        surface = tripatch.BezierTriangle(np.random.default_rng(own).normal(size=(net_size(own), 3)))
        while surface.degree < degree:
            surface = surface.elevated()
        made = tripatch.coons_bezier(boundary_of(surface), kind)
        b = np.random.default_rng(3).dirichlet([1, 1, 1], 20)
        far = np.abs(made.evaluate(b) - surface.evaluate(b)).max()
        assert far < 1e-12 if reproduced else far > 1e-3


def test_coons_bezier_refusals_and_warnings():
    with refused("coons_without_solution"):
        tripatch.coons_bezier(random_boundary(6), "mask")
    with refused("coons_without_solution"):
        tripatch.coons_bezier(random_boundary(4), "permanence")
    assert tripatch.coons_bezier(random_boundary(4), "permanence", alpha=0.1).degree == 4
    with pytest.warns(UserWarning, match="degree 14"):
        tripatch.coons_bezier(random_boundary(14), "extremal")
    flat = boundary_of(tripatch.BezierTriangle(np.eye(3)).elevated().elevated().elevated().elevated().elevated())
    with pytest.warns(UserWarning, match="nearest"):
        assert np.isfinite(tripatch.coons_bezier(flat, "mask").net).all()
    with pytest.raises(ValueError, match="kind"):
        tripatch.coons_bezier(random_boundary(3), "Coons")
    with pytest.raises(ValueError, match="do not meet at corner"):
        tripatch.coons_bezier([c + 0.1 * i for i, c in enumerate(random_boundary(3))])
    with pytest.raises(ValueError, match="boundary must have 3 values, not 2"):
        tripatch.coons_bezier(random_boundary(3)[:2])
    with pytest.raises(ValueError, match=r"boundary\[1\] must have shape \(4, 3\), not \(5, 3\)"):
        first, _, third = random_boundary(3)
        tripatch.coons_bezier([first, np.zeros((5, 3)), third])
    with pytest.raises(TypeError):
        tripatch.coons_bezier(random_boundary(3), "permanence", alpha="x")
    with pytest.raises(ValueError, match="alpha"):
        tripatch.coons_bezier(random_boundary(3), "mask", alpha=0.1)


def test_rectangles_and_nurbs():
    net = grid(4, 3)
    rectangle = tripatch.BezierRectangle(net)
    same = tripatch.NurbsSurface(net, None, [0] * 4 + [1] * 4, [0] * 3 + [1] * 3)
    assert rectangle.degrees == same.degrees == (3, 2) and np.array_equal(rectangle.net, net)
    uv = np.random.default_rng(2).uniform(0, 1, (5, 2))
    for a, b in zip(rectangle.evaluate(uv, derivatives=3), same.evaluate(uv, derivatives=3)):
        assert np.allclose(a, b, atol=1e-12)
    coons = tripatch.coons_rectangle(rectangle)
    assert tripatch.coons_energy(coons) < tripatch.coons_energy(rectangle)
    assert np.allclose(tripatch.coons_rectangle(rectangle, -0.25).net, coons.net, atol=1e-13)
    with pytest.raises(ValueError, match=r"uv\[0\] lies outside"):
        rectangle.evaluate([(1.1, 0)])


def test_bad_nurbs():
    points, ku, kv = grid(4, 3), [0] * 4 + [1] * 4, [0] * 3 + [1] * 3
    weights = np.ones((4, 3))
    weights[2, 1] = -1
    with pytest.raises(ValueError, match=re.escape("weights[2, 1] must be greater than 0")):
        tripatch.NurbsSurface(points, weights, ku, kv)
    with pytest.raises(ValueError, match="weights must have shape"):
        tripatch.NurbsSurface(points, weights.T, ku, kv)
    with pytest.raises(ValueError, match="knots_v decreases at 4"):
        tripatch.NurbsSurface(points, None, ku, [0, 0, 0, 1, 0.5, 1])
    with pytest.raises(ValueError, match=r"len\(knots_u\) must be from 5 to 6, not 7"):
        tripatch.NurbsSurface(points[:3], None, ku[1:], kv)
    with pytest.raises(TypeError, match="knots_u"):
        tripatch.NurbsSurface(points, None, ["a"] * 8, kv)


def test_sides_of_surfaces():
    rectangle = tripatch.BezierRectangle(grid(4, 4))
    t = np.linspace(0, 1, 7)
    for reversed in (False, True):
        side = tripatch.Side(rectangle, 1, reversed)
        along = 1 - t if reversed else t
        p, d1 = rectangle.evaluate(np.stack([np.ones(7), along], axis=1), derivatives=1)
        c, dc, r, n = side.evaluate(t)
        assert np.allclose(c, p, atol=1e-14)
        assert np.allclose(dc, (-1 if reversed else 1) * d1[:, 1], atol=1e-13)
        assert np.allclose(r, -d1[:, 0], atol=1e-13)  # into the surface
        up = np.cross(d1[:, 0], d1[:, 1])
        assert degrees_between(n, up if reversed else -up).max() < 1e-6
    triangle = tripatch.BezierTriangle(np.random.default_rng(5).normal(size=(10, 3)))
    assert np.allclose(tripatch.Side(triangle, 2).evaluate(t)[0][[0, -1]], triangle.net[[0, 6]], atol=1e-14)
    with pytest.raises(TypeError, match=r"of type BezierTriangle \| BezierRectangle"):
        tripatch.Side("surface", 0)
    with pytest.raises(ValueError, match="edge must be from 0 to 3, not 4"):
        tripatch.Side(rectangle, 4)
    with pytest.raises(TypeError, match="edge"):
        tripatch.Side(rectangle, 1.5)
    with refused("edge_is_point"):
        tripatch.Side(tripatch.BezierRectangle(np.repeat(grid(2, 4)[:, :1], 3, axis=1)), 1)


def test_a_patch_between_three_surfaces_keeps_their_tangent_planes():
    # three sides of one Bezier triangle's complement: the triangle itself seen from its edges, so that the fill continues it
    corners = np.array([(0, 0, 0), (1, 0, 0), (0.3, 0.9, 0)])
    sides = []
    for i in range(3):
        a, b, far = corners[(i + 1) % 3], corners[(i + 2) % 3], corners[i]
        out = (a + b) / 2 - far
        net = np.array([[a + s * (b - a) + d * out for d in (0, 0.5, 1)] for s in (0, 1 / 3, 2 / 3, 1)])
        net[:, :, 2] += np.random.default_rng(i).uniform(-0.1, 0.1, (4, 3))
        net[[0, -1], 0, 2] = 0
        sides.append(tripatch.Side(tripatch.BezierRectangle(net), 0))
    patch = tripatch.patch(sides)
    t = np.linspace(0.02, 0.98, 33)
    for i, side in enumerate(sides):
        b = np.zeros((33, 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
        c, _, _, n = side.evaluate(t)
        assert np.abs(patch.evaluate(b) - c).max() < 1e-12
        assert degrees_between(patch.normal(b), n).max() < 1e-6


@pytest.mark.parametrize("curve", ["hermite", "smits"])
def test_smooth_triangles(curve):
    v, f = tetrahedron()
    smooth = tripatch.smooth_triangles(v, f, normals=v, resolution=6, curve=curve)
    assert smooth.faces.shape == (4 * 36, 3) and smooth.edges.shape == (6, 2)
    assert smooth.vertices.shape == smooth.normals.shape == (2 * 36 + 2, 3)
    assert np.array_equal(smooth.vertices[:4], v)
    assert np.allclose(np.linalg.norm(smooth.normals, axis=1), 1, atol=1e-14)
    radius = np.linalg.norm(smooth.vertices, axis=1)
    assert abs(radius - 1).max() < (0.09 if curve == "hermite" else 0.24)  # flat triangles: 0.67
    sides = tripatch.sides_from_normals(v[f[0]], v[f[0]], curve)
    t = np.arange(1, 6) / 6
    c, _, _, n = sides[2].evaluate(t)  # from vertex 0 to vertex 1
    edge = int(np.nonzero((smooth.edges == (0, 1)).all(axis=1))[0][0])
    rows = 4 + 5 * edge + np.arange(5)
    assert np.allclose(smooth.vertices[rows], c, atol=1e-15)
    assert np.allclose(smooth.normals[rows], n, atol=1e-14)


def test_the_fill_of_smits_page():
    v, f = tetrahedron()
    patch = tripatch.smits_patch(v[f[0]], v[f[0]])
    t = np.linspace(0, 1, 5)
    b = np.stack([np.zeros(5), 1 - t, t], axis=1)
    side = tripatch.sides_from_normals(v[f[0]], v[f[0]], "smits")[0]
    assert np.allclose(patch.evaluate(b), side.evaluate(t)[0], atol=1e-14)


def test_smooth_triangles_bad_input():
    v, f = tetrahedron()
    with refused("face_is_no_triangle") as error:
        tripatch.smooth_triangles(v, [*f.tolist(), [0, 1, 2, 3]])
    assert list(error.value.where) == [0, 1, 2, 3]
    normals = v.copy()
    normals[2] = 0
    with refused("normal_zero"):
        tripatch.smooth_triangles(v, f, normals)
    with pytest.raises(ValueError, match="normals must have shape"):
        tripatch.smooth_triangles(v, f, v[:3])
    for resolution in (0, 257, 10**12):
        with pytest.raises(ValueError, match="resolution must be from 1 to 256"):
            tripatch.smooth_triangles(v, f, resolution=resolution)
    with pytest.raises(TypeError, match="resolution"):
        tripatch.smooth_triangles(v, f, resolution=2.5)
    with pytest.raises(ValueError, match="curve"):
        tripatch.smooth_triangles(v, f, curve="bezier")
    with pytest.raises(ValueError, match="names vertex 9"):
        tripatch.smooth_triangles(v, [(0, 1, 9)])
    with pytest.raises(tripatch.Refusal, match="vertex 1"):
        tripatch.sides_from_normals(v[:3], [v[0], (0, 0, 0), v[2]])


def sphere_with_a_hole(n):
    """The octant of a unit sphere left open, its rim cut n times a side, and one ring of triangles around."""
    t = np.linspace(0, np.pi / 2, n + 1)[:-1]
    z = np.zeros_like(t)
    arcs = [np.stack(a, axis=1) for a in ((np.cos(t), np.sin(t), z), (z, np.cos(t), np.sin(t)), (np.sin(t), z, np.cos(t)))]
    rim = np.concatenate(arcs)
    middle = np.ones(3) / np.sqrt(3)
    outer = rim - 0.3 * (middle - rim * (rim @ middle)[:, None])
    outer /= np.linalg.norm(outer, axis=1, keepdims=True)
    m = len(rim)
    k = np.arange(m)
    nxt = (k + 1) % m
    faces = np.concatenate([np.stack([nxt, k, m + k], axis=1), np.stack([nxt, m + k, m + nxt], axis=1)])
    return np.concatenate([rim, outer]), faces, k, [0, n, 2 * n]


@pytest.mark.parametrize(("method", "off"), [("coons_bezier", 2e-5), ("coons_extremal", 0.12), ("coons_mask", 0.22)])
def test_bezier_methods_fill_a_hole(method, off):
    v, f, rim, corners = sphere_with_a_hole(4)
    fill = tripatch.fill(v, f, rim=rim, corners=corners, method=method)
    assert np.abs(fill.patch.evaluate(fill.rim_barycentric) - v[fill.rim]).max() < 1e-12
    assert isinstance(fill.patch, tripatch.BezierTriangle)
    assert np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max() < off
    with refused("continuity_above_method"):
        tripatch.fill(v, f, rim=rim, corners=corners, method=method, continuity="G1")
    v, f, rim, corners = sphere_with_a_hole(13)
    with refused("side_has_many_vertices"):
        tripatch.fill(v, f, rim=rim, corners=corners, method=method)


GROUNDS = {  # value and gradient
    "saddle": lambda x, y: (0.7 * x * y, 0.7 * y, 0.7 * x),
    "wave": lambda x, y: (
        0.3 * np.sin(2 * x) * np.cos(1.5 * y),
        0.6 * np.cos(2 * x) * np.cos(1.5 * y),
        -0.45 * np.sin(2 * x) * np.sin(1.5 * y),
    ),
}


@pytest.mark.parametrize("ground", GROUNDS)
def test_the_normal_field_of_an_edge_limits_the_order_of_smooth_triangles(ground):
    f = GROUNDS[ground]

    def normals(x, y):
        _, fx, fy = f(x, y)
        n = np.column_stack([-fx, -fy, np.ones_like(fx)])
        return n / np.linalg.norm(n, axis=1, keepdims=True)

    def with_true_normals(side):
        def across(t):
            c, dc, _, _ = side.evaluate(t)
            return np.cross(dc, normals(c[:, 0], c[:, 1]))

        return tripatch.Side.from_functions(lambda t: side.evaluate(t)[0], lambda t: side.evaluate(t)[1], across)

    b = np.array([(i, j, 10 - i - j) for i in range(11) for j in range(11 - i)]) / 10

    def distance(sides):
        p = tripatch.patch(sides).evaluate(b)
        z, fx, fy = f(p[:, 0], p[:, 1])
        return np.sqrt(np.mean((p[:, 2] - z) ** 2 / (1 + fx**2 + fy**2)))

    own, true = [], []
    for h in (1 / 8, 1 / 16):
        xy = np.array([0.3, 0.2]) + h * np.array([(0, 0), (1, 0.1), (0.3, 0.9)])
        sides = tripatch.sides_from_normals(np.column_stack([xy, f(*xy.T)[0]]), normals(*xy.T))
        own.append(distance(sides))
        true.append(distance([with_true_normals(side) for side in sides]))
    assert 2.8 < np.log2(own[0] / own[1]) < 3.3
    assert np.log2(true[0] / true[1]) > 3.9
