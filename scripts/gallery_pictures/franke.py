"""Figures 7 to 10 of Liu, Ma and Cheng: Franke's six functions over his 33 points (NPS-53-79-003, 1979), and tables of errors."""

import contextlib

import matplotlib.pyplot as plt
import numpy as np
import tripatch
from matplotlib.tri import Triangulation

from .render import CLAY, Scene, save, save_figure, unit

POINTS = np.array(
    [
        (0.05, 0.45),
        (0.00, 0.50),
        (0.00, 1.00),
        (0.00, 0.00),
        (0.10, 0.15),
        (0.10, 0.75),
        (0.15, 0.30),
        (0.20, 0.10),
        (0.25, 0.20),
        (0.30, 0.35),
        (0.35, 0.85),
        (0.50, 0.00),
        (0.50, 1.00),
        (0.55, 0.95),
        (0.60, 0.25),
        (0.60, 0.65),
        (0.60, 0.85),
        (0.65, 0.70),
        (0.70, 0.20),
        (0.70, 0.65),
        (0.70, 0.90),
        (0.75, 0.10),
        (0.75, 0.35),
        (0.75, 0.85),
        (0.80, 0.40),
        (0.80, 0.65),
        (0.85, 0.25),
        (0.90, 0.35),
        (0.90, 0.80),
        (0.95, 0.90),
        (1.00, 0.00),
        (1.00, 0.50),
        (1.00, 1.00),
    ]
)
SLOPES = ("consistent", "given", "as_printed")


def with_gradient(f, fx, fy):
    return np.stack([f, fx, fy])


def f1(x, y):
    def hill(a, kx, cx, ky, cy):
        f = a * np.exp(-kx * (9 * x - cx) ** 2 - ky * (9 * y - cy) ** 2)
        return with_gradient(f, -f * 18 * kx * (9 * x - cx), -f * 18 * ky * (9 * y - cy))

    ridge = 3.9 * np.exp(-((9 * x + 1) ** 2) / 49 - (9 * y + 1) / 10)
    ridge = with_gradient(ridge, -ridge * 18 * (9 * x + 1) / 49, -ridge * 0.9)
    return hill(3.9, 0.25, 2, 0.25, 2) + ridge + hill(2.6, 0.25, 7, 0.25, 3) + hill(-1.04, 1, 4, 1, 7)


def f2(x, y):
    e = np.exp(18 * (y - x))
    slope = 5.2 / 9 * 18 * e / (e + 1) ** 2
    return with_gradient(5.2 / 9 * e / (e + 1), -slope, slope)


def f3(x, y):
    top, bottom = 5.2 * (1.25 + np.cos(5.4 * y)), 6 + 6 * (3 * x - 1) ** 2
    return with_gradient(top / bottom, -top / bottom**2 * 36 * (3 * x - 1), -5.2 * 5.4 * np.sin(5.4 * y) / bottom)


def gaussian(k):
    def f(x, y):
        v = 5.2 / 3 * np.exp(-k * ((x - 0.5) ** 2 + (y - 0.5) ** 2))
        return with_gradient(v, -2 * k * (x - 0.5) * v, -2 * k * (y - 0.5) * v)

    return f


def f6(x, y):
    root = np.sqrt(64 - 81 * ((x - 0.5) ** 2 + (y - 0.5) ** 2))
    return with_gradient(5.2 / 9 * root - 2.6, -46.8 * (x - 0.5) / root, -46.8 * (y - 0.5) / root)


FUNCTIONS = (f1, f2, f3, gaussian(81 / 16), gaussian(81 / 4), f6)


def triangles():
    """(56, 3, 2) the Delaunay triangles, counter-clockwise."""
    return POINTS[Triangulation(*POINTS.T).triangles]


def side(f, a, b):
    """The graph of f over the segment a b; across, the derivative along the outer normal times the side's length (section 5)."""
    across = np.array([b[1] - a[1], a[0] - b[0]])

    def at(t):
        return a + np.asarray(t)[:, None] * (b - a)

    def derivative(t, d):
        p = at(t)
        _, fx, fy = f(*p.T)
        return np.column_stack([np.broadcast_to(d, p.shape), fx * d[0] + fy * d[1]])

    return tripatch.Side.from_functions(
        lambda t: np.column_stack([at(t), f(*at(t).T)[0]]), lambda t: derivative(t, b - a), lambda t: derivative(t, across)
    )


def grid(n=20):
    return np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]) / n


def sides_of(f):
    return [[side(f, p[(i + 1) % 3], p[(i + 2) % 3]) for i in range(3)] for p in triangles()]


def surface(sides, method, slopes):
    """(56, 231, 3) points over the triangles."""
    return np.array([tripatch.patch(s, method=method, cross_boundary=slopes).evaluate(grid()) for s in sides])


def number(x):
    return f"{x:.1e}".replace("e-0", "e-").replace("e+0", "e+")


def table(all_sides):
    """{(method, slopes, function): (max, rms)}; without the methods that need Bezier curves, and slopes where they are unread."""
    errors = {}
    for method, about in tripatch.METHODS.items():
        for slopes in SLOPES if about.continuity != "G0" else SLOPES[:1]:
            for k, (f, sides) in enumerate(zip(FUNCTIONS, all_sides, strict=True), 1):
                with contextlib.suppress(tripatch.Refusal):
                    p = surface(sides, method, slopes)
                    e = p[..., 2] - f(p[..., 0], p[..., 1])[0]
                    errors[method, slopes, k] = np.abs(e).max(), np.sqrt((e**2).mean())
    return errors


def page(errors):
    lines = [
        "# Franke's functions over 33 points",
        "",
        "Errors of the surface against the function: 33 points, 56 Delaunay triangles, F1 to F6 in the scaling of Liu, Ma and",
        "Cheng (2008), eq. 18, 231 points a triangle. The slopes handed in are the derivatives along the outer normal times the",
        "side's length, as in their section 5; `cross_boundary` says what is made of them.",
        "Methods of position only do not read slopes.",
        "Written by `scripts/gallery`.",
        "",
    ]
    for title, which in (("Largest error", 0), ("Rms error", 1)):
        lines += [f"## {title}", "", "| method | slopes | F1 | F2 | F3 | F4 | F5 | F6 |", "|" + "---|" * 8]
        for method, about in tripatch.METHODS.items():
            for slopes in SLOPES:
                if (method, slopes, 1) in errors:
                    cells = " | ".join(number(errors[method, slopes, k][which]) for k in range(1, 7))
                    lines.append(f"| {method} | {slopes if about.continuity != 'G0' else '-'} | {cells} |")
        lines.append("")
    missing = [m for m in tripatch.METHODS if (m, SLOPES[0], 1) not in errors]
    if missing:
        lines += [
            f"Not in the tables: {', '.join(missing)}; the boundary curves here are no Bezier curves,",
            "and those methods refuse them.",
            "",
        ]
    return "\n".join(lines)


def pictures(folder, all_sides):
    figure, axes = plt.subplots(figsize=(3.8, 3.8))
    axes.triplot(Triangulation(*POINTS.T), color="0.25", linewidth=0.9)
    axes.plot(*POINTS.T, "o", color="tab:red", markersize=4)
    axes.set_aspect("equal")
    axes.axis("off")
    save_figure(folder / "liu-ma-cheng-07.png", figure)
    n = 20
    index = {(i, j): k for k, (i, j) in enumerate((i, j) for i in range(n + 1) for j in range(n + 1 - i))}
    up = [(index[i, j], index[i + 1, j], index[i, j + 1]) for i in range(n) for j in range(n - i)]
    down = [(index[i + 1, j], index[i + 1, j + 1], index[i, j + 1]) for i in range(n) for j in range(n - i - 1)]
    faces = np.array(up + down)
    every = (faces[None] + 231 * np.arange(len(triangles()))[:, None, None]).reshape(-1, 3)
    for name, numbers in (("08", (0, 1)), ("09", (2, 3)), ("10", (4, 5))):
        images, titles = [], []
        for k in numbers:
            f, given, consistent = FUNCTIONS[k], *(surface(all_sides[k], "quintic", s) for s in ("given", "consistent"))
            true = consistent.copy()
            true[..., 2] = f(true[..., 0], true[..., 1])[0]
            for title, p in ((f"F{k + 1}", true), ("slopes as given", given), ("consistent slopes", consistent)):
                vertices = p.reshape(-1, 3) * [1, 1, 0.6 / np.ptp(true[..., 2])]
                a, b, c = (vertices[every[:, i]] for i in range(3))
                normals = unit(np.cross(b - a, c - a))
                images.append(Scene(-125, 38).mesh(vertices, every, normals, CLAY).image(300, 230))
                titles.append(title)
        save(folder / f"liu-ma-cheng-{name}.png", images, titles, columns=3)


def draw(folder):
    all_sides = [sides_of(f) for f in FUNCTIONS]
    folder.mkdir(parents=True, exist_ok=True)
    pictures(folder, all_sides)
    (folder / "franke.md").write_text(page(table(all_sides)))
