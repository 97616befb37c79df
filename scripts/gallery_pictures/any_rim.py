"""Jagged holes in irregular triangles, as any deletion leaves them: the hole, the fill, its distance from what was there and the
standard deviation that it states of itself."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import tripatch


def jagged(surface, noise, n=30, cut=0.55, seed=3):
    """A jittered grid of triangles, a round region taken out; the rim in the direction of new faces."""
    rng = np.random.default_rng(seed)
    grid = np.linspace(-1.2, 1.2, n + 1)
    step = grid[1] - grid[0]
    points = np.stack(np.meshgrid(grid, grid, indexing="ij"), -1).reshape(-1, 2)
    points += rng.uniform(-0.3, 0.3, points.shape) * step
    at = np.arange(len(points)).reshape(n + 1, n + 1)
    a, b, c, d = (q.ravel() for q in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    turn = (rng.random(len(a)) < 0.5)[:, None]
    faces = np.vstack([np.where(turn, np.c_[a, b, c], np.c_[a, b, d]), np.where(turn, np.c_[a, c, d], np.c_[b, c, d])])
    faces = faces[np.linalg.norm(points[faces].mean(axis=1), axis=1) > cut]
    vertices = np.column_stack([points, surface(*points.T)])
    vertices += noise * step * rng.normal(size=vertices.shape)
    return vertices, faces, sorted(tripatch.find_holes(faces), key=len)[-2]


def shaded(figure, place, vertices, faces, title):
    axes = figure.add_subplot(*place, projection="3d")
    axes.plot_trisurf(*vertices.T, triangles=faces, color="0.85", edgecolor="0.4", linewidth=0.25, shade=True)
    axes.set_title(title, y=0.95)
    axes.set(xlim=(-0.8, 0.8), ylim=(-0.8, 0.8), zlim=(0, 0.6))
    axes.set_box_aspect((1, 1, 0.4), zoom=1.35)
    axes.view_init(40, -60)
    axes.set_axis_off()


def colored(figure, place, points, faces, values, most, title):
    """Seen from above, both measures on one scale."""
    axes = figure.add_subplot(*place)
    drawn = axes.tripcolor(*points[:, :2].T, values, triangles=faces, shading="gouraud", cmap="viridis", vmin=0, vmax=most)
    axes.triplot(*points[:, :2].T, triangles=faces, color="w", linewidth=0.2)
    plt.colorbar(drawn, ax=axes, shrink=0.7, format="%.0e")
    axes.set_title(title)
    axes.set_aspect("equal")
    axes.set_axis_off()


def draw(folder):
    """Writes hill.png into a folder."""
    folder.mkdir(parents=True, exist_ok=True)

    def hill(x, y):
        return 0.5 * np.exp(-0.9 * (x * x + y * y))

    figure = plt.figure(figsize=(14, 6.4))
    for row, noise in enumerate((0.0, 0.05)):
        vertices, faces, rim = jagged(hill, noise)
        fill = tripatch.fill(vertices, faces, rim=rim)
        whole = np.vstack([vertices, fill.vertices])
        new = np.array(fill.faces)
        near = faces[np.abs(vertices[faces][..., :2]).max(axis=(1, 2)) < 0.8]
        away = np.r_[np.zeros(len(vertices)), np.abs(fill.vertices[:, 2] - hill(*fill.vertices[:, :2].T))]
        known = np.r_[np.zeros(len(vertices)), fill.deviation]
        most = max(away.max(), known.max())
        said = "no noise" if noise == 0 else f"noise of {noise:.0%} of the edge"
        shaded(figure, (2, 4, 4 * row + 1), vertices, near, f"the hole, {said}")
        shaded(figure, (2, 4, 4 * row + 2), whole, np.vstack([near, new]), "filled")
        colored(figure, (2, 4, 4 * row + 3), whole, new, away, most, "distance from what was there")
        colored(figure, (2, 4, 4 * row + 4), whole, new, known, most, "standard deviation, as stated")
    figure.tight_layout()
    figure.savefig(folder / "hill.png", dpi=90)
