"""One picture for each method, of the same hole: shaded with its (s, t) lines, and highlight lines over the seam."""

from math import comb

import numpy as np
import tripatch

from .render import CLAY, GREY, INK, Scene, of_rectangle, save

#: Those that join three sides.
METHODS = {name: about for name, about in tripatch.METHODS.items() if about.sides == (3, 3)}
DEGREE = 6
SPEEDS = (1.1, 0.8, 0.95)  # across the sides


def hill(x, y):
    """The ground that the hole is cut from: height and gradient."""
    h = 0.32 * np.exp(-2.2 * (x**2 + y**2)) + 0.10 * np.sin(2.6 * x + 0.4) * np.cos(1.8 * y)
    e = -1.408 * np.exp(-2.2 * (x**2 + y**2))
    s, c = np.sin(2.6 * x + 0.4), np.cos(2.6 * x + 0.4)
    return h, e * x + 0.26 * c * np.cos(1.8 * y), e * y - 0.18 * s * np.sin(1.8 * y)


def surroundings():
    """Three Bezier surfaces round a hole in the hill, lines in several directions and speeds."""
    angles = np.radians([90, 210, 330])
    corners = 0.62 * np.stack([np.cos(angles), np.sin(angles)], -1)
    t = np.linspace(0, 1, DEGREE + 1)
    bernstein = np.stack([comb(DEGREE, k) * t**k * (1 - t) ** (DEGREE - k) for k in range(DEGREE + 1)], -1)
    rectangles = []
    for i in range(3):
        a, b = corners[(i + 1) % 3], corners[(i + 2) % 3]
        out = (a + b) / 2
        u, v = np.meshgrid(t, t, indexing="ij")
        inner = a * (1 - u[..., None]) + b * u[..., None] + (0.5 * u * (1 - u))[..., None] * out
        xy = inner + v[..., None] * (SPEEDS[i] * inner)
        points = np.concatenate([xy, hill(xy[..., 0], xy[..., 1])[0][..., None]], -1)
        net = np.linalg.solve(bernstein, points.reshape(len(t), -1)).reshape(points.shape)
        net = np.swapaxes(np.linalg.solve(bernstein, np.swapaxes(net, 0, 1).reshape(len(t), -1)).reshape(points.shape), 0, 1)
        rectangles.append(tripatch.BezierRectangle(net))
    return rectangles


def draw(folder):
    rectangles = surroundings()
    sides = [tripatch.Side(r, 0) for r in rectangles]
    view = (-90, 58)
    for method in METHODS:
        patch = tripatch.patch(sides, method=method)
        plain, striped = Scene(*view), Scene(*view, stripes=20)
        for i, r in enumerate(rectangles):
            points, normals = of_rectangle(r, v=(0, 0.6 / SPEEDS[i]))
            plain.surface(points, normals, GREY).curve(points[:, 0], INK, 2)
            striped.surface(points, normals, GREY, True)
        plain.patch(patch, CLAY, lines=10)
        striped.patch(patch, CLAY, True, m=80)
        save(folder / f"{method}.png", [plain.image(340, 300), striped.image(340, 300)])
