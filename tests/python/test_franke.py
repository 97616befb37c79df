"""Franke's six functions over his 33 points, scaled as by Liu, Ma and Cheng (2008), eq. 18: errors of the triangular patches."""

import pathlib

import numpy as np
import pytest
import tripatch
from scipy.spatial import Delaunay

POINTS = np.loadtxt(pathlib.Path(__file__).parent.parent / "data" / "franke33.csv", delimiter=",", comments="#", skiprows=2)


def hill(f, fx, fy):
    """A term with its gradient."""
    return np.stack([f, fx, fy])


def f1(x, y):
    def term(a, cx, px, kx, cy, py, ky, linear=False):
        ex = kx * (9 * x + cx) ** 2
        ey = ky * (9 * y + cy) if linear else ky * (9 * y + cy) ** 2
        f = a * np.exp(-ex - ey)
        return hill(f, -f * 18 * kx * (9 * x + cx), -f * (9 * ky if linear else 18 * ky * (9 * y + cy)))

    return (
        term(3.9, -2, 2, 0.25, -2, 2, 0.25)
        + term(3.9, 1, 2, 1 / 49, 1, 1, 1 / 10, linear=True)
        + term(2.6, -7, 2, 0.25, -3, 2, 0.25)
        + term(-1.04, -4, 2, 1, -7, 2, 1)
    )


def f2(x, y):
    e = np.exp(18 * y - 18 * x)
    f = 5.2 * e / (9 * e + 9)
    slope = 5.2 / 9 * e / (e + 1) ** 2 * 18
    return hill(f, -slope, slope)


def f3(x, y):
    top, bottom = 5.2 * (1.25 + np.cos(5.4 * y)), 6 + 6 * (3 * x - 1) ** 2
    return hill(top / bottom, -top / bottom**2 * 36 * (3 * x - 1), -5.2 * 5.4 * np.sin(5.4 * y) / bottom)


def gaussian(k):
    def f(x, y):
        v = 5.2 * np.exp(-k * ((x - 0.5) ** 2 + (y - 0.5) ** 2)) / 3
        return hill(v, -2 * k * (x - 0.5) * v, -2 * k * (y - 0.5) * v)

    return f


def f6(x, y):
    root = np.sqrt(64 - 81 * ((x - 0.5) ** 2 + (y - 0.5) ** 2))
    return hill(5.2 * root / 9 - 2.6, -5.2 / 9 * 81 * (x - 0.5) / root, -5.2 / 9 * 81 * (y - 0.5) / root)


FUNCTIONS = [f1, f2, f3, gaussian(81 / 16), gaussian(81 / 4), f6]


def side(f, a, b, away):
    """The graph of f over the segment a b; `away` is the direction of r in the plane."""
    at = lambda t: a + np.asarray(t)[:, None] * (b - a)  # noqa: E731

    def directional(t, v):
        p = at(t)
        _, fx, fy = f(*p.T)
        return np.column_stack([np.broadcast_to(v, p.shape), fx * v[0] + fy * v[1]])

    return tripatch.Side.from_functions(
        lambda t: np.column_stack([at(t), f(*at(t).T)[0]]), lambda t: directional(t, b - a), lambda t: directional(t, away)
    )


def triangles():
    faces = Delaunay(POINTS).simplices
    for face in faces:
        p = POINTS[face]
        yield p if np.cross(p[1] - p[0], p[2] - p[0]) > 0 else p[[0, 2, 1]]


def grid(n=20):
    return np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]) / n


def errors(f, method, cross_boundary, true_slopes=False):
    """All errors f(x, y) - z at 231 points a triangle; true_slopes: r is the derivative that the triangle itself would take."""
    out = []
    for p in triangles():
        sides = []
        for i in range(3):
            a, b = p[(i + 1) % 3], p[(i + 2) % 3]
            normal = np.array([b[1] - a[1], a[0] - b[0]])  # outward, as long as the side: the paper's slopes
            sides.append(side(f, a, b, (a + b) / 2 - p[i] if true_slopes else normal))
        surface = tripatch.patch(sides, method=method, cross_boundary=cross_boundary).evaluate(grid())
        out.append(surface[:, 2] - f(surface[:, 0], surface[:, 1])[0])
    return np.concatenate(out)


def rms(e):
    return np.sqrt(np.mean(e**2))


def test_the_triangulation_is_the_papers():
    assert len(POINTS) == 33
    assert len(list(triangles())) == 56
    assert len(grid()) == 231


def test_gradients():
    x, y, h = np.array([0.3, 0.62]), np.array([0.41, 0.17]), 1e-6
    for f in FUNCTIONS:
        _, fx, fy = f(x, y)
        assert np.allclose((f(x + h, y)[0] - f(x - h, y)[0]) / (2 * h), fx, atol=1e-7)
        assert np.allclose((f(x, y + h)[0] - f(x, y - h)[0]) / (2 * h), fy, atol=1e-7)


@pytest.mark.parametrize("number, bound", list(enumerate([6e-3, 7e-4, 3e-4, 2.5e-5, 9e-4, 2.5e-5], 1)))
def test_quintic_with_consistent_slopes(number, bound):
    f = FUNCTIONS[number - 1]
    e = errors(f, "quintic", "consistent")
    assert rms(e) <= bound
    # Theorem 2: nothing is lost against the triangle's own derivative
    assert np.abs(e - errors(f, "quintic", "given", true_slopes=True)).max() < 1e-10
    # "good slopes matter": as given and as printed are worse by an order
    assert rms(errors(f, "quintic", "given")) > 3 * rms(e)


def test_printed_slopes_lose_precision():
    assert rms(errors(FUNCTIONS[3], "quintic", "as_printed")) > 100 * rms(errors(FUNCTIONS[3], "quintic", "consistent"))


def test_side_vertex():
    assert rms(errors(FUNCTIONS[0], "side_vertex", "consistent")) <= 1.7e-2
