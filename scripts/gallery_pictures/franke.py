"""Figures 7 to 10 of Liu, Ma and Cheng: Franke's six functions over his 33 points, and tables of errors."""

import matplotlib.pyplot as plt
import numpy as np
from comparison.page import measured_on, written_by
from frankes_functions import DEGREE, FUNCTIONS, POINTS, errors, sides, surface, triangles

from .methods import METHODS
from .render import CLAY, Scene, save, save_figure, unit

SLOPES = ("consistent", "given", "as_printed")


def number(x):
    return f"{x:.1e}".replace("e-0", "e-").replace("e+0", "e+")


def table(all_sides):
    """{(method, slopes, function): (max, rms)}; without slopes where they are not read."""
    figures = {}
    for method, about in METHODS.items():
        for slopes in SLOPES if about.continuity != "G0" else SLOPES[:1]:
            for k, (f, given) in enumerate(zip(FUNCTIONS, all_sides, strict=True), 1):
                e = errors(f, surface(given, method, slopes))
                figures[method, slopes, k] = np.abs(e).max(), np.sqrt((e**2).mean())
    return figures


def page(figures):
    lines = [
        "# Franke's functions over 33 points",
        "",
        "Errors of the surface against the function: 33 points, 56 Delaunay triangles, F1 to F6 in the scaling of Liu, Ma and",
        "Cheng (2008), eq. 18, 231 points a triangle. The slopes handed in are the derivatives along the outer normal times the",
        "side's length, as in their section 5; `cross_boundary` says what is made of them.",
        "",
        "A dash: the method keeps position only and reads no slopes. The three Bezier methods take each side as the curve of",
        f"degree {DEGREE} that meets the function at Chebyshev's points of the side; coons_extremal and coons_mask favor the",
        "third corner of each triangle.",
        "",
        written_by("gallery", measured_on()),
        "Patches of three sides each, neither made fair nor scaled.",
        "",
    ]
    for title, which in (("Largest error", 0), ("Rms error", 1)):
        lines += [f"## {title}", "", "| method | slopes | F1 | F2 | F3 | F4 | F5 | F6 |", "|" + "---|" * 8]
        for method, about in METHODS.items():
            for slopes in SLOPES:
                if (method, slopes, 1) in figures:
                    cells = " | ".join(number(figures[method, slopes, k][which]) for k in range(1, 7))
                    lines.append(f"| {method} | {slopes if about.continuity != 'G0' else '-'} | {cells} |")
        lines.append("")
    return "\n".join(lines)


def pictures(folder, all_sides):
    figure, axes = plt.subplots(figsize=(3.8, 3.8))
    for corners in triangles():
        axes.plot(*corners[[0, 1, 2, 0]].T, color="0.25", linewidth=0.9)
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
    all_sides = [[sides(f, corners) for corners in triangles()] for f in FUNCTIONS]
    folder.mkdir(parents=True, exist_ok=True)
    pictures(folder, all_sides)
    (folder / "franke.md").write_text(page(table(all_sides)))
