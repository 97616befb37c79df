"""Figures 1 to 4 of Arnal and Lluch: patches with their control nets and the functional F (eq. 4)."""

import numpy as np
import tripatch

from .render import BLUE, CLAY, INK, Scene, save

NET = (0.75, 0.15, 0.12)


def boundary(degree, heights, bow):
    """Three curves of this degree over an equilateral triangle; heights(i, t) lifts them, bow pushes them outwards."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 0.866, 0]])
    curves = []
    for i in range(3):
        a, b = corners[(i + 1) % 3], corners[(i + 2) % 3]
        t = np.linspace(0, 1, degree + 1)[:, None]
        out = (a + b) / 2 - corners.mean(0)
        curves.append(a * (1 - t) + b * t + bow * 4 * t * (1 - t) * out + np.array([0, 0, 1]) * heights(i, t))
    return curves


def with_net(triangle, view, net=True):
    scene = Scene(*view).patch(triangle, CLAY, lines=0)
    n = triangle.degree
    index = {}
    for i in range(n, -1, -1):
        for j in range(n - i, -1, -1):
            index[i, j] = len(index)
    p = triangle.net
    for i in range(3):
        b = np.zeros((61, 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = np.linspace(0, 1, 61), 1 - np.linspace(0, 1, 61)
        scene.curve(triangle.evaluate(b), INK, 2.4)
    if net:
        for (i, j), k in index.items():
            for other in ((i + 1, j), (i, j + 1), (i + 1, j - 1)):
                if other in index:
                    scene.curve(p[[k, index[other]]], NET, 1.1, lift=1)
        scene.dots(p, NET, 4, lift=1)
    return scene


BOUNDARIES = {
    "waves": boundary(4, lambda i, t: 0.7 * t * (1 - t) * (1 + 1.6 * np.sin(2 * np.pi * t + i)), 0.25),
    "dome": boundary(3, lambda i, t: 1.5 * t * (1 - t), 0.35),
    "saddle": boundary(4, lambda i, t: (1.8, -1.4, 0.4)[i] * t * (1 - t), 0.1),
    "twist": boundary(5, lambda i, t: 0.22 * np.sin(2 * np.pi * t) * (1, -1, 1)[i], 0.3),
    "crown": boundary(5, lambda i, t: 0.32 * np.sin(np.pi * t) * (1 + 0.6 * np.cos(4 * np.pi * t)), 0.2),
}


def compared(names, view):
    images, titles = [], []
    for name in names:
        for kind, title in (("discrete", "Coons"), ("extremal", "extremal"), ("mask", "mask (11)")):
            triangle = tripatch.coons_bezier(BOUNDARIES[name], kind)
            images.append(with_net(triangle, view).image(300, 230))
            titles.append(f"{title}, degree {triangle.degree}, F = {tripatch.coons_energy(triangle):.3g}")
    return images, titles


def draw(folder):
    view = (-65, 32)
    coons = {name: tripatch.coons_bezier(b, "discrete") for name, b in BOUNDARIES.items()}
    save(
        folder / "arnal-lluch-01.png",
        [Scene(*view).patch(coons["dome"], BLUE, lines=10).image(), with_net(coons["dome"], view, False).image()],
    )
    save(
        folder / "arnal-lluch-02.png",
        [with_net(coons[n], view).image() for n in ("dome", "saddle", "twist")],
        [f"degree {coons[n].degree}, F = {tripatch.coons_energy(coons[n]):.3g}" for n in ("dome", "saddle", "twist")],
    )
    images, titles = compared(["waves"], view)
    save(folder / "arnal-lluch-03.png", images, titles)
    images, titles = compared(["saddle", "twist", "crown"], view)
    save(folder / "arnal-lluch-04.png", images, titles, columns=3)
