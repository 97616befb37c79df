"""Holes of four to eight sides in an egg and a saddle, filled: the domain with its lines, and these lines on the patch."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import tripatch
from matplotlib.colors import LightSource


def egg(x, y):
    d = 1 + x * x + y * y
    z = (1 - x * x - y * y) / d
    return np.stack([2 * x / d * (1 + 0.25 * z), 1.6 * y / d * (1 + 0.25 * z), 1.3 * z], -1)


def saddle(x, y):
    return np.stack([x, y, 0.9 * (x * x - y * y)], -1)


def holed(surface, n, per_side=10, rings=5):
    """A mesh about a hole of n uneven sides."""
    k = np.arange(n)
    angles, radii = 2 * np.pi * (k + 0.12 * np.sin(3 * k)) / n, 0.5 * (1 + 0.1 * np.cos(2 * k))
    corners = np.stack([radii * np.cos(angles), radii * np.sin(angles)], -1)
    t = np.arange(per_side)[:, None] / per_side
    rim = np.concatenate([(1 - t) * corners[i] + t * corners[(i + 1) % n] for i in range(n)])
    plane = ((1 + 0.09 * np.arange(rings))[:, None, None] * rim).reshape(-1, 2)
    m = len(rim)
    a, b = (np.arange((rings - 1) * m).reshape(-1, m)[:, np.r_[s:m, 0:s]].ravel() for s in (0, 1))
    faces = np.stack([b, a, a + m, b + m], -1)
    return surface(*plane.T), faces, list(range(m)), [per_side * i for i in range(n)]


def draw(folder):
    """Writes holes.png into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    figure = plt.figure(figsize=(14, 6.6))
    for column, (surface, n) in enumerate(((egg, 4), (saddle, 5), (egg, 6), (saddle, 8))):
        vertices, faces, rim, corners = holed(surface, n)
        fill = tripatch.fill(vertices, faces, rim=rim, corners=corners)
        whole = np.vstack([vertices, fill.vertices])
        flat = figure.add_subplot(2, 4, column + 1)
        uv = np.vstack([fill.rim_uv, fill.uv])
        at = {v: k for k, v in enumerate(fill.rim)} | {len(vertices) + k: len(fill.rim) + k for k in range(len(fill.uv))}
        flat.triplot(*uv.T, triangles=[[at[v] for v in face] for face in fill.faces], color="0.6", linewidth=0.4)
        flat.fill(*fill.patch.domain.T, fill=False, edgecolor="k", linewidth=1.5)
        flat.set_title(f"{n} sides: the domain")
        flat.set_aspect("equal")
        flat.set_axis_off()
        solid = figure.add_subplot(2, 4, 5 + column, projection="3d")
        light = LightSource(315, 50)
        around = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
        for triangles, color in ((around, "0.8"), (np.array(fill.faces), "#d9a066")):
            solid.plot_trisurf(*whole.T, triangles=triangles, color=color, edgecolor="0.35", linewidth=0.2, lightsource=light)
        solid.set_title(f"seam within {fill.report.seam_angle_max:.0e} degrees", y=0.97)
        solid.set_box_aspect(np.ptp(whole, axis=0), zoom=1.4)
        solid.view_init(48, -60)
        solid.set_axis_off()
    figure.tight_layout()
    figure.savefig(folder / "holes.png", dpi=90)
