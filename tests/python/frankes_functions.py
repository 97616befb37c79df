"""Franke's six functions over his 33 points, scaled as by Liu, Ma and Cheng (2008), eq. 18, as sides of triangular patches.

The tests and scripts/gallery use it. R. Franke, A critical comparison of some methods for interpolation of scattered data,
NPS-53-79-003, 1979.
"""

import pathlib

import numpy as np
import tripatch
from scipy.spatial import Delaunay

POINTS = np.loadtxt(pathlib.Path(__file__).parent.parent / "data" / "franke33.csv", delimiter=",", comments="#", skiprows=2)
#: Of the Bezier curves that the Bezier methods take in place of a side: it meets the function at these parameters (Chebyshev's).
DEGREE = 8
NODES = np.concatenate([[0], 0.5 - 0.5 * np.cos(np.pi * np.arange(1, DEGREE) / DEGREE), [1]])


def f1(x, y):
    """Each function gives its value and gradient, (3, ...)."""

    def hill(a, kx, cx, ky, cy):
        f = a * np.exp(-kx * (9 * x - cx) ** 2 - ky * (9 * y - cy) ** 2)
        return np.stack([f, -f * 18 * kx * (9 * x - cx), -f * 18 * ky * (9 * y - cy)])

    ridge = 3.9 * np.exp(-((9 * x + 1) ** 2) / 49 - (9 * y + 1) / 10)
    ridge = np.stack([ridge, -ridge * 18 * (9 * x + 1) / 49, -ridge * 0.9])
    return hill(3.9, 0.25, 2, 0.25, 2) + ridge + hill(2.6, 0.25, 7, 0.25, 3) + hill(-1.04, 1, 4, 1, 7)


def f2(x, y):
    e = np.exp(18 * (y - x))
    slope = 5.2 / 9 * 18 * e / (e + 1) ** 2
    return np.stack([5.2 / 9 * e / (e + 1), -slope, slope])


def f3(x, y):
    top, bottom = 5.2 * (1.25 + np.cos(5.4 * y)), 6 + 6 * (3 * x - 1) ** 2
    return np.stack([top / bottom, -top / bottom**2 * 36 * (3 * x - 1), -5.2 * 5.4 * np.sin(5.4 * y) / bottom])


def gaussian(k):
    def f(x, y):
        v = 5.2 / 3 * np.exp(-k * ((x - 0.5) ** 2 + (y - 0.5) ** 2))
        return np.stack([v, -2 * k * (x - 0.5) * v, -2 * k * (y - 0.5) * v])

    return f


def f6(x, y):
    root = np.sqrt(64 - 81 * ((x - 0.5) ** 2 + (y - 0.5) ** 2))
    return np.stack([5.2 / 9 * root - 2.6, -46.8 * (x - 0.5) / root, -46.8 * (y - 0.5) / root])


FUNCTIONS = (f1, f2, f3, gaussian(81 / 16), gaussian(81 / 4), f6)


def triangles():
    """(56, 3, 2) the Delaunay triangles, counter-clockwise."""
    corners = POINTS[Delaunay(POINTS).simplices]
    turned = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
    corners[turned] = corners[turned][:, ::-1]
    return corners


def side(f, a, b, across):
    """The graph of f over the segment a b; r is the derivative in the direction `across` of the plane."""

    def at(t):
        return a + np.asarray(t)[:, None] * (b - a)

    def directional(t, d):
        p = at(t)
        _, fx, fy = f(*p.T)
        return np.column_stack([np.broadcast_to(d, p.shape), fx * d[0] + fy * d[1]])

    def position(t):
        return np.column_stack([at(t), f(*at(t).T)[0]])

    return tripatch.Side.from_functions(position, lambda t: directional(t, b - a), lambda t: directional(t, across), rim=NODES)


def sides(f, corners, true_slopes=False):
    """Three sides over a triangle (3, 2). The slopes are the derivative along the outer normal times the side's length, as in
    section 5 of the paper; true_slopes: the derivative that the patch itself has, per unit of the equilateral domain's side."""
    found = []
    for i in range(3):
        a, b = corners[(i + 1) % 3], corners[(i + 2) % 3]
        outwards = (a + b - 2 * corners[i]) / np.sqrt(3) if true_slopes else np.array([b[1] - a[1], a[0] - b[0]])
        found.append(side(f, a, b, outwards))
    return found


def grid(n=20):
    """(231, 3) points of a triangle."""
    return np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]) / n


def surface(all_sides, method, cross_boundary):
    """(m, 231, 3) points over the triangles that the sides belong to."""
    return np.array([tripatch.patch(s, method, cross_boundary).evaluate(grid()) for s in all_sides])


def errors(f, points):
    """Heights of points (..., 3) less the function there."""
    return points[..., 2] - f(points[..., 0], points[..., 1])[0]
