"""The four papers, written out from their pages in numpy and compared with what the library makes.

Nothing here calls the library but to compare with it. Indices, u, v, w and the numbers of equations are the papers': their patch,
corner and side i is the library's i - 1, and (u, v, w) are its barycentric coordinates.
"""

from math import factorial

import numpy as np
import pytest
import tripatch

T = np.linspace(0, 1, 21)


def inside(n=24):
    """(3, k) u, v, w of the inner points of a triangle cut in n."""
    return np.array([(i, j, n - i - j) for i in range(1, n) for j in range(1, n - i)]).T / n


def on_side(i, t):
    """(3, k) u, v, w on the side opposite corner i (1, 2 or 3), from corner i + 1 to corner i + 2."""
    p = np.zeros((3, len(t)))
    p[i % 3], p[(i + 1) % 3] = 1 - t, t
    return p


def largest(a):
    return np.linalg.norm(a, axis=-1).max()


# Bezier triangles: homogeneous polynomials in u, v, w


def multi(n):
    return [(i, j, n - i - j) for i in range(n, -1, -1) for j in range(n - i, -1, -1)]


def degree(net):
    return round((np.sqrt(8 * len(net) + 1) - 3) / 2)


def bernstein(index, p):
    n = sum(index)
    c = factorial(n) / (factorial(index[0]) * factorial(index[1]) * factorial(index[2])) if min(index) >= 0 else 0
    return c * p[0] ** index[0] * p[1] ** index[1] * p[2] ** index[2] if c else 0 * p[0]


def bezier(net, p):
    return sum(bernstein(index, p)[..., None] * point for index, point in zip(multi(degree(net)), net, strict=True))


def partial(net, p, a):
    """The derivative with respect to u, v or w (a = 0, 1, 2), the two others held: that of the homogeneous polynomial."""
    n, at = degree(net), {index: k for k, index in enumerate(multi(degree(net)))}
    raised = [tuple(x + (k == a) for k, x in enumerate(index)) for index in multi(n - 1)]
    return bezier(np.array([n * net[at[index]] for index in raised]), p)


def three_quadratics(seed=2):
    rng = np.random.default_rng(seed)
    corners = np.array([[0, 0, 0], [1, 0, 0.2], [0.3, 0.9, 0.1]])
    nets = []
    for _ in range(3):
        a, b, c = corners
        middle = np.array([(a + b) / 2, (a + c) / 2, (b + c) / 2]) + 0.2 * rng.normal(size=(3, 3))
        nets.append(np.array([a, middle[0], middle[1], b, middle[2], c]))
    return nets


# M. Szilvasi-Nagy, I. Szabo, C1-continuous Coons-type blending of triangular patches


def weights(p):
    """Of r1, r2, r3: those of equation (4). In (2) the first two are exchanged: F1 has u^2 w^2."""
    u, v, w = p
    terms = np.array([v**2 * w**2, u**2 * w**2, u**2 * v**2])
    return (terms / terms.sum(axis=0))[..., None]


def mu(i, p, lam):
    a, b = {1: (p[0], p[2]), 2: (p[1], p[0]), 3: (p[2], p[1])}[i]
    with np.errstate(invalid="ignore"):
        return ((1 - lam[i - 1]) * b**2 / (lam[i - 1] * a**2 + (1 - lam[i - 1]) * b**2))[..., None]


def mixed(i, p, r, lam):
    """What is right on the two other sides: mu_3 r_3 + (1 - mu_3) r_2 for i = 1, and so on. r: functions of p."""
    before, after = (i + 1) % 3 + 1, i % 3 + 1  # 3, 2 of 1
    m = mu(before, p, lam)
    return m * r[before - 1](p) + (1 - m) * r[after - 1](p)


def printed_feet(p):
    u, v, w = p
    z = 0 * u
    return [(z, v, 1 - v), (u, z, 1 - u), (u, 1 - u, z)]


def definition_1(nets, p, lam):
    r = [lambda q, net=net: bezier(net, q) for net in nets]
    q = sum(w * mixed(i, f, r, lam) for i, (w, f) in enumerate(zip(weights(p), printed_feet(p), strict=True), 1))
    return (sum(mixed(i, p, r, lam) for i in (1, 2, 3)) - q) / 2, q


def definition_2(nets, p, lam):
    """Equation (11), letter by letter."""
    f, q = definition_1(nets, p, lam)
    s = 0
    for i, (w, foot) in enumerate(zip(weights(p), printed_feet(p), strict=True), 1):
        slope = [lambda q, net=net, i=i: partial(net, q, i - 1) for net in nets]
        s = s + p[i - 1][..., None] * w * mixed(i, foot, slope, lam) / 2  # kappa_i, equations (9) and (10)
    return f - q / 2 - s


def perpendicular(i):
    """From side i to corner i at right angles, where the triangle is equilateral."""
    return np.where(np.arange(3) == i - 1, 1, -0.5)


def corrected(nets, p, lam, c1):
    """Feet at right angles, q inside the bracket, s from the derivative in the same direction (by a complex step)."""
    r = [lambda q, net=net: bezier(net, q) for net in nets]
    f = sum(mixed(i, p, r, lam) for i in (1, 2, 3)) / 2
    step = 1e-30
    for i, w in enumerate(weights(p), 1):
        foot = p - p[i - 1] * perpendicular(i)[:, None]
        f = f - w * mixed(i, foot, r, lam) / 2
        if c1:
            slope = mixed(i, foot + 1j * step * perpendicular(i)[:, None], r, lam).imag / step
            f = f - p[i - 1][..., None] * w * slope / 2
    return f


LAMBDA = (0.3, 0.55, 0.8)


@pytest.mark.parametrize("reading, c1", [("as_printed", False), ("as_printed", True), ("corrected", False), ("corrected", True)])
def test_definitions_1_and_2(reading, c1):
    nets, p = three_quadratics(), inside()
    patch = tripatch.blend(*map(tripatch.BezierTriangle, nets), f"szilvasi_nagy_c{int(c1)}", LAMBDA, reading)
    printed = definition_2(nets, p, LAMBDA) if c1 else definition_1(nets, p, LAMBDA)[0]
    expected = printed if reading == "as_printed" else corrected(nets, p, LAMBDA, c1)
    assert largest(patch.evaluate(p.T) - expected) < 1e-13


def test_definition_2_as_printed_does_not_interpolate_and_the_corrected_one_has_its_constituents_planes():
    nets = three_quadratics()
    surfaces = list(map(tripatch.BezierTriangle, nets))
    printed = tripatch.blend(*surfaces, reading="as_printed")
    patch = tripatch.blend(*surfaces)
    misses = 0
    for i in (1, 2, 3):
        b = on_side(i, T[1:-1]).T
        misses = max(misses, largest(printed.evaluate(b) - surfaces[i - 1].evaluate(b)))
        assert largest(patch.evaluate(b) - surfaces[i - 1].evaluate(b)) < 1e-13
        assert tripatch.angles(patch.normal(b), surfaces[i - 1].normal(b)).max() < 1e-9
    assert misses > 0.3


def homogeneous(nets, p, lam, c1):
    """The authors' reading: auxiliary curves g1(0, v, w) and so on, as homogeneous polynomials."""
    r, f = [lambda q, net=net: bezier(net, q) for net in nets], 0
    f = sum(mixed(i, p, r, lam) for i in (1, 2, 3)) / 2
    for i, w in enumerate(weights(p), 1):
        foot = p * (np.arange(3) != i - 1)[:, None]
        f = f - w * mixed(i, foot, r, lam) / 2
        if c1:
            slope = [lambda q, net=net, i=i: partial(net, q, i - 1) for net in nets]
            f = f - p[i - 1][..., None] * w * mixed(i, foot, slope, lam) / 2
    return f


def test_readings_by_homogeneous_polynomials_do_not_move_along_with_their_surfaces_and_the_one_taken_does():
    nets, p, up, lam = three_quadratics(), inside(40), np.array([0, 0, 1.0]), (0.5, 0.5, 0.5)
    moved = [net + up for net in nets]

    def drift(f):
        return largest(f(moved, p, lam) - f(nets, p, lam) - up)

    assert drift(lambda *given: homogeneous(*given, c1=True)) == pytest.approx(0.055, abs=0.001)
    assert drift(lambda *given: homogeneous(*given, c1=False)) == pytest.approx(0.277, abs=0.001)
    assert drift(definition_2) == pytest.approx(0.833, abs=0.001)
    for c1 in (False, True):
        assert drift(lambda *given, c1=c1: corrected(*given, c1)) < 1e-13


def cubic_curves(seed=5):
    """Control points (4, 3) of g1, g2, g3, curve i from corner i + 1 to corner i + 2."""
    rng = np.random.default_rng(seed)
    corners = np.array([[0, 0, 0], [1, 0, 0.1], [0.4, 0.9, -0.1]])
    nets = []
    for i in (1, 2, 3):
        a, b = corners[i % 3], corners[(i + 1) % 3]
        nets.append(
            np.array([a, a + (b - a) / 3, b + (a - b) / 3, b]) + np.array([[0], [1], [1], [0]]) * rng.normal(size=(4, 3)) / 9
        )
    return nets


def curve(net, t, derivative=0):
    net, n = np.asarray(net, float), len(net) - 1
    for _ in range(derivative):
        net, n = n * np.diff(net, axis=0), n - 1
    basis = [factorial(n) / factorial(k) / factorial(n - k) * (1 - t) ** (n - k) * t**k for k in range(n + 1)]
    return np.stack(basis, axis=-1) @ net


def sides_of(curves, across):
    """Library sides from control points of curves and of derivatives across them."""
    return [
        tripatch.Side.from_functions(lambda t, c=c: curve(c, t), lambda t, c=c: curve(c, t, 1), lambda t, r=r: curve(r, t))
        for c, r in zip(curves, across, strict=True)
    ]


def slopes_across(curves, seed=7):
    """Control points of derivatives outwards, neither orthogonal to the sides nor of one length."""
    rng = np.random.default_rng(seed)
    middle = np.mean([c[0] for c in curves], axis=0)
    return [np.linspace(c[0], c[-1], 3) - middle + 0.3 * rng.normal(size=(3, 3)) for c in curves]


def test_equation_1():
    curves, (u, v, w) = cubic_curves(), inside()
    # g1(0, v, 1 - v), g2(u, 0, 1 - u), g3(u, 1 - u, 0) by their second, first and second coordinate
    g1, g2, g3 = (lambda v: curve(curves[0], 1 - v)), (lambda u: curve(curves[1], u)), (lambda u: curve(curves[2], 1 - u))

    def part(a):
        return np.asarray(a)[..., None]

    first = part(w / (u + w)) * g1(v) + part(u / (u + w)) * g3(1 - v)
    second = part(w / (v + w)) * g2(u) + part(v / (v + w)) * g3(u)
    third = part(u / (u + v)) * g2(u + v) + part(v / (u + v)) * g1(u + v)
    corners = part(u) * g3(np.ones_like(u)) + part(v) * g1(np.ones_like(u)) + part(w) * g2(np.zeros_like(u))
    patch = tripatch.patch(sides_of(curves, slopes_across(curves)), "gordon_coons")
    assert largest(patch.evaluate(inside().T) - (first + second + third - corners) / 2) < 1e-13


def test_equation_2_needs_its_weights_exchanged():
    """As printed F1 has the weight u^2 w^2, which is 0 at u = 0, where DF is said to interpolate F1."""
    nets, p = three_quadratics(9), inside()
    patch = tripatch.blend(*map(tripatch.BezierTriangle, nets), "nielson_blend")
    assert largest(patch.evaluate(p.T) - sum(w * bezier(net, p) for w, net in zip(weights(p), nets, strict=True))) < 1e-13
    side = on_side(1, T[1:-1])
    printed = weights(side)[[1, 0, 2]]
    assert largest(sum(w * bezier(net, side) for w, net in zip(printed, nets, strict=True)) - bezier(nets[1], side)) < 1e-13


def nine_points(nets, lam, f):
    """Equation (5) at nine inner points of the square (s, t), u = t - s t, v = s t; second differences of the printed formula."""
    total, h = 0, 1e-3
    for s in (0.25, 0.5, 0.75):
        for t in (0.25, 0.5, 0.75):
            u, v = t - s * t, s * t
            steps = np.array([(a * h, b * h) for a in (-1, 0, 1) for b in (-1, 0, 1)]).T
            p = np.array([u + steps[0], v + steps[1], 1 - u - v - steps.sum(axis=0)])
            at = f(nets, p, lam).reshape(3, 3, 3)
            uu = (at[2, 1] - 2 * at[1, 1] + at[0, 1]) / h**2
            vv = (at[1, 2] - 2 * at[1, 1] + at[1, 0]) / h**2
            uv = (at[2, 2] - at[2, 0] - at[0, 2] + at[0, 0]) / (4 * h**2)
            total += (uu @ uu + 2 * uv @ uv + vv @ vv) * t / 9
    return total


def test_the_papers_own_energy_has_a_name_and_its_optimum():
    nets = three_quadratics(4)
    surfaces = list(map(tripatch.BezierTriangle, nets))
    for method, f in (("szilvasi_nagy_c0", lambda *a: definition_1(*a)[0]), ("szilvasi_nagy_c1", definition_2)):
        patch = tripatch.blend(*surfaces, method, LAMBDA, "as_printed")
        assert patch.energy("nine_points") == pytest.approx(nine_points(nets, LAMBDA, f), rel=1e-3)
        optimal = tripatch.blend(*surfaces, method, "optimal", "as_printed")
        least = optimal.energy("nine_points")
        assert optimal.path[-1][1] == pytest.approx(least)
        for k, step in ((k, step) for k in range(3) for step in (-0.02, 0.02)):
            other = np.array(optimal.shape)
            other[k] = np.clip(other[k] + step, 2e-3, 1 - 2e-3)
            assert tripatch.blend(*surfaces, method, tuple(other), "as_printed").energy("nine_points") > least - 1e-12


# H. Liu, J. Ma, F. Cheng, Constructing parametric triangular patches with boundary conditions


def boundary_conditions(curves, across, which):
    """dP/dtau on the sides by equations (5) to (15), per unit of the equilateral triangle's side, as functions of t."""
    found = []
    for i in range(3):
        c, r, after, before = curves[i], across[i], curves[(i + 1) % 3], curves[(i + 2) % 3]
        ends = []
        for t in (0.0, 1.0):
            dc = curve(c, np.array([t]), 1)[0]
            if t == 0:  # equation (9)
                tau = 2 / np.sqrt(3) * curve(before, np.array([1.0]), 1)[0] + dc / np.sqrt(3)
            else:  # equation (11), whose t2 runs against equation (1): from v3 to v1
                tau = -2 / np.sqrt(3) * curve(after, np.array([0.0]), 1)[0] - dc / np.sqrt(3)
            s = curve(r, np.array([t]))[0]
            normal = np.array([[s @ s, s @ dc], [s @ dc, dc @ dc]])
            ends.append(np.linalg.solve(normal, [tau @ s, tau @ dc if which == "consistent" else 0]))

        def slope(t, c=c, r=r, ends=ends):
            s, dc, (alpha, beta) = curve(r, t), curve(c, t, 1), np.outer(1 - t, ends[0]).T + np.outer(t, ends[1]).T
            if which == "given":
                return s
            if which == "as_printed":  # equation (7)
                beta = -alpha * (s * dc).sum(axis=-1) / (dc * dc).sum(axis=-1)
            return alpha[:, None] * s + beta[:, None] * dc

        found.append(slope)
    return found


def side_vertex(curves, slopes, p):
    """Nielson's side-vertex operator over the equilateral triangle of unit side, vector-valued."""
    total = 0
    for i, weight in enumerate(weights(p)):
        b, after, before = p[i], p[(i + 1) % 3], p[(i + 2) % 3]
        t, d = before / (after + before), (1 - b)[:, None]
        out, back = curves[(i + 2) % 3], curves[(i + 1) % 3]  # leaves corner i, ends in it
        to_next, to_last = curve(out, np.zeros(1), 1)[0], -curve(back, np.ones(1), 1)[0]
        corner, start = out[0], (1 - t)[:, None] * to_next + t[:, None] * to_last
        end = curve(curves[i], t)
        # the ray runs the triangle's height across the side and (t - 1/2) along it
        arriving = np.sqrt(3) / 2 * slopes[i](t) + (t - 0.5)[:, None] * curve(curves[i], t, 1)
        ray = (
            (1 + 2 * d) * (1 - d) ** 2 * corner + d * (1 - d) ** 2 * start + d**2 * (3 - 2 * d) * end - d**2 * (1 - d) * arriving
        )
        total = total + weight * ray
    return total


@pytest.mark.parametrize("which", ["given", "as_printed", "consistent"])
def test_boundary_conditions_and_nielsons_method(which):
    curves = cubic_curves()
    across = slopes_across(curves)
    patch = tripatch.patch(sides_of(curves, across), "side_vertex", cross_boundary=which)
    expected = side_vertex(curves, boundary_conditions(curves, across, which), inside())
    assert largest(patch.evaluate(inside().T) - expected) < 1e-11 * max(1, largest(expected))


def cubic_graph(seed=3):
    """A cubic function of the plane: coefficients of x^i y^j."""
    rng = np.random.default_rng(seed)
    powers = [(i, j) for i in range(4) for j in range(4 - i)]
    c = rng.normal(size=len(powers))

    def value(p):
        return sum(a * p[..., 0] ** i * p[..., 1] ** j for a, (i, j) in zip(c, powers, strict=True))

    def gradient(p):
        x, y = p[..., 0], p[..., 1]
        dx = sum(a * i * x ** max(i - 1, 0) * y**j for a, (i, j) in zip(c, powers, strict=True))
        dy = sum(a * j * x**i * y ** max(j - 1, 0) for a, (i, j) in zip(c, powers, strict=True))
        return np.stack([dx, dy], axis=-1)

    return value, gradient


@pytest.mark.parametrize("which", ["given", "consistent"])
def test_slopes_along_the_normal_times_the_sides_length_reproduce_cubics_over_an_equilateral_triangle(which):
    """Section 5's slopes: dF/dn times L. On an equilateral triangle they are those of the patch itself."""
    value, gradient = cubic_graph()
    corners = np.array([[0, 0], [1, 0], [0.5, np.sqrt(0.75)]])
    sides = []
    for i in range(3):
        a, b = corners[(i + 1) % 3], corners[(i + 2) % 3]
        normal = np.array([(b - a)[1], -(b - a)[0]])  # of the side's length

        def at(t, a=a, b=b):
            return a + t[:, None] * (b - a)

        def along(t, d, at=at):
            return np.column_stack([np.broadcast_to(d, (len(t), 2)), gradient(at(t)) @ d])

        sides.append(
            tripatch.Side.from_functions(
                lambda t, at=at: np.column_stack([at(t), value(at(t))]),
                lambda t, d=b - a, along=along: along(t, d),
                lambda t, d=normal, along=along: along(t, d),
            )
        )
    patch = tripatch.patch(sides, "side_vertex", cross_boundary=which)
    places = inside().T @ corners
    assert np.abs(patch.evaluate(inside().T) - np.column_stack([places, value(places)])).max() < 1e-13


# A. Arnal, A. Lluch, Coons triangular Bezier surfaces


def border(n, seed):
    """Three curves of degree n as `tripatch.coons_bezier` takes them, and the points P_I of the border, I = (i, j, k)."""
    net = dict(zip(multi(n), np.random.default_rng(seed).uniform(-1, 1, (len(multi(n)), 3)), strict=True))
    runs = [
        [(0, n - k, k) for k in range(n + 1)],
        [(k, 0, n - k) for k in range(n + 1)],
        [(n - k, k, 0) for k in range(n + 1)],
    ]
    return [np.array([net[index] for index in run]) for run in runs], {i: p for i, p in net.items() if min(i) == 0}


def test_the_triangular_coons_patch_and_definition_1():
    n = 3
    curves, points = border(n, 1)
    u, v, _ = inside()

    def x0(i, j):  # the border as a function of (u, v)
        return bezier(np.array([points.get(index, np.zeros(3)) for index in multi(n)]), np.array([i, j, 1 - i - j]))

    def part(a):
        return np.asarray(a)[..., None]

    z, one = 0 * u, 1 + 0 * u
    patch = (
        part(1 - u - v) * (x0(u, z) + x0(z, v) - x0(z, z))
        + part(v) * (x0(z, u + v) + x0(u, 1 - u) - x0(z, one))
        + part(u) * (x0(u + v, z) + x0(1 - v, v) - x0(one, z))
    )
    triangle = tripatch.coons_bezier(curves, "discrete")
    assert largest(triangle.evaluate(inside().T) - patch) < 1e-13
    p = points
    for row, (i, j, k) in enumerate(multi(n + 1)):
        if min(i, j, k) == 0:
            continue
        expected = (
            k * (p[i, 0, n - i] + p[0, j, n - j] - p[0, 0, n])
            + j * (p[0, n - k, k] + p[i, n - i, 0] - p[0, n, 0])
            + i * (p[n - k, 0, k] + p[n - j, j, 0] - p[n, 0, 0])
        ) / (n + 1)  # equation (3)
        assert np.abs(triangle.net[row] - expected).max() < 1e-13


def quadrature(n=16):
    """Nodes (3, k) and weights over the unit triangle, u = x (1 - y), v = x y."""
    x, w = np.polynomial.legendre.leggauss(n)
    x, w = (x + 1) / 2, w / 2
    a, b = np.meshgrid(x, x)
    u, v = (a * (1 - b)).ravel(), (a * b).ravel()
    return np.array([u, v, 1 - u - v]), (np.outer(w, w) * a).ravel()


def mixed_derivatives(n, p):
    """(B_I)_uv at p, a row for each I."""
    less = [((-1, -1, 0), 1), ((-1, 0, -1), -1), ((0, -1, -1), -1), ((0, 0, -2), 1)]
    return np.array(
        [
            n * (n - 1) * sum(sign * bernstein(tuple(np.add(index, d)), p) for d, sign in less if min(np.add(index, d)) >= 0)
            + 0 * p[0]
            for index in multi(n)
        ]
    )


def test_the_integral_of_a_bernstein_polynomial_is_not_the_printed_one():
    """Printed: 1 / ((3n - 2)(3n - 3)) for those of degree m = 2n - 2; it is 1 / ((m + 1)(m + 2))."""
    p, w = quadrature()
    for n in (2, 3, 4):
        m = 2 * n - 2
        for index in multi(m):
            integral = bernstein(index, p) @ w
            assert integral == pytest.approx(1 / ((m + 1) * (m + 2)))
            assert n == 2 or integral != pytest.approx(1 / ((3 * n - 2) * (3 * n - 3)))


@pytest.mark.parametrize("n", [2, 3, 4, 5, 6])
def test_propositions_2_to_4(n):
    curves, points = border(n, n)
    p, w = quadrature()
    second = mixed_derivatives(n, p)
    c = second * w @ second.T
    inner = [k for k, index in enumerate(multi(n)) if min(index) > 0]
    outer = [k for k in range(len(c)) if k not in inner]
    net = np.array([points.get(index, np.zeros(3)) for index in multi(n)])
    if inner:
        net[inner] = -np.linalg.solve(c[np.ix_(inner, inner)], c[np.ix_(inner, outer)] @ net[outer])
    triangle = tripatch.coons_bezier(curves, "extremal")
    assert np.abs(triangle.net - net).max() < 1e-11
    assert tripatch.coons_energy(triangle) == pytest.approx(np.trace(net.T @ c @ net))
    if n == 3:  # Proposition 4
        q = points
        middle = (q[0, 1, 2] - q[0, 2, 1] + q[1, 0, 2] + q[1, 2, 0] - q[2, 0, 1] + q[2, 1, 0]) / 2
        assert np.abs(triangle.net[4] - middle).max() < 1e-13


MASK = {(-1, 0, 1): 1, (-1, 1, 0): -1, (0, -1, 1): 1, (0, 1, -1): 1, (1, -1, 0): -1, (1, 0, -1): 1}  # equation (11), halved


@pytest.mark.parametrize(
    "kind, n, alpha", [("mask", 4, None), ("mask", 5, None), ("permanence", 5, -2 / 3), ("permanence", 4, 0.1)]
)
def test_masks(kind, n, alpha):
    curves, _ = border(n, 40 + n)
    net = dict(zip(multi(n), tripatch.coons_bezier(curves, kind, alpha=alpha).net, strict=True))
    for i, j, k in multi(n):
        if min(i, j, k) == 0:
            continue
        if kind == "mask":
            expected = sum(a * net[i + d[0], j + d[1], k + d[2]] for d, a in MASK.items()) / 2
        else:  # equation (9)
            far = sum(net[i + d[0], j + d[1], k + d[2]] for d in ((2, -1, -1), (-1, 2, -1), (-1, -1, 2)))
            expected = alpha * far + (1 - 3 * alpha) / 6 * sum(net[i + d[0], j + d[1], k + d[2]] for d in MASK)
        assert np.abs(net[i, j, k] - expected).max() < 1e-11


# B. Smits, Boundary Curves


def test_smits_boundary_curves():
    rng = np.random.default_rng(6)
    p = np.array([[0, 0, 0], [1, 0, 0.1], [0.4, 0.9, -0.1]])
    n = np.array([0, 0, 1]) + 0.3 * rng.normal(size=(3, 3))
    n /= np.linalg.norm(n, axis=1)[:, None]
    sides = tripatch.sides_from_normals(p, n, curve="smits")
    t = T[:, None]
    for i, side in enumerate(sides):
        a, b = (i + 1) % 3, (i + 2) % 3
        along = p[a] - p[b]
        h = n[a] @ along * (1 - t) ** 2 * t - n[b] @ along * (1 - t) * t**2  # equations (4) to (6)
        expected = (1 - t) * p[a] + t * p[b] + h * ((1 - t) * n[a] + t * n[b])  # (7) to (9)
        c, dc, _, normal = side.evaluate(T)
        assert largest(c - expected) < 1e-14
        assert np.abs([dc[0] @ n[a], dc[-1] @ n[b]]).max() < 1e-14  # orthogonal to the normals at both ends
        assert largest(normal[[0, -1]] - n[[a, b]]) < 1e-12
