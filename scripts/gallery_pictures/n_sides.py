"""Holes of two to eight sides, filled: the domain with its lines, and these lines on the patch; quads in them; cages."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import tripatch
from matplotlib.colors import LightSource
from mpl_toolkits.mplot3d.art3d import Poly3DCollection


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


def zebra(vertices, faces, stripes=16):
    """Gray of each quad: stripes of light around, reflected by the surface seen from above."""
    p = vertices[np.array(faces)]
    normal = np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    view = np.array([0.35, -0.55, 0.75]) / np.linalg.norm([0.35, -0.55, 0.75])
    mirrored = 2 * (normal @ view)[:, None] * normal - view
    light = 0.5 + 0.5 * np.sin(stripes * np.arctan2(mirrored[:, 0], mirrored[:, 2] + 2))
    return np.clip(4 * (light - 0.5) + 0.5, 0.1, 0.95)


def sectors(n, size=6, inner=3):
    """A cage of n sectors of quads about a pole, without those within `inner` of it: vertices, faces, rim and corners."""
    number, places, faces = {}, [], []

    def vertex(s, i, j):
        key = (s, i, j) if i and j else (s, i) if i else ((s + 1) % n, j)
        if key not in number:
            number[key] = len(places)
            a, b = 2 * np.pi * s / n, 2 * np.pi * (s + 1) / n
            place = (i * np.array([np.cos(a), np.sin(a)]) + j * np.array([np.cos(b), np.sin(b)])) / size
            places.append(place * max(i, j) / size / max(np.linalg.norm(place), 1e-9))  # squares made round
        return number[key]

    for s in range(n):
        for i in range(size):
            for j in range(size):
                if max(i, j) >= inner:
                    faces.append([vertex(s, i, j), vertex(s, i + 1, j), vertex(s, i + 1, j + 1), vertex(s, i, j + 1)])
    rim, corners = [], []
    for s in range(n):
        rim += [vertex(s, inner, j) for j in range(inner)]
        corners.append(vertex(s, inner, inner))
        rim += [vertex(s, i, inner) for i in range(inner, 0, -1)]
    return np.array(places), faces, rim, corners


def show(axes, vertices, faces, colors, edges="0.3"):
    shown = Poly3DCollection(vertices[np.array(faces)], facecolors=colors, edgecolors=edges, linewidths=0.3)
    axes.add_collection3d(shown)
    axes.auto_scale_xyz(*vertices.T)
    axes.set_box_aspect(np.ptp(vertices, axis=0) + 1e-9, zoom=1.5)
    axes.view_init(50, -60)
    axes.set_axis_off()


def draw_quads(folder):
    """Writes quads.png: flat holes, an egg and a saddle with stripes, and cages with their surface."""
    figure = plt.figure(figsize=(14, 13))
    for column, (surface, n, counts) in enumerate(
        ((egg, 4, (10, 8, 6, 10)), (saddle, 5, 10), (egg, 6, 10), (saddle, 8, 10)),
    ):
        angles = 2 * np.pi * (np.arange(n) + 0.5) / n
        regular = np.stack([np.cos(angles), np.sin(angles)], -1)
        per_side = np.broadcast_to(counts, n)
        rim = [(1 - k / c) * regular[i] + k / c * regular[(i + 1) % n] for i, c in enumerate(per_side) for k in range(c)]
        plane = (np.array([1, 1.1])[:, None, None] * np.array(rim)).reshape(-1, 2)
        m, starts = len(rim), [int(sum(per_side[:i])) for i in range(n)]
        ring = [[(k + 1) % m, k, m + k, m + (k + 1) % m] for k in range(m)]
        options = {"rim": list(range(m)), "corners": starts, "method": "multi_sided", "output": "quads"}
        fill = tripatch.fill(np.column_stack([plane, 0 * plane[:, 0]]), ring, **options)
        flat = figure.add_subplot(4, 4, column + 1)
        whole = np.vstack([plane, fill.vertices[:, :2]])
        for face in fill.faces:
            flat.fill(*whole[list(face)].T, facecolor="#f3e3cd", edgecolor="0.3", linewidth=0.5)
        flat.set_title(f"{n} sides: poles of {', '.join(str(v) for _, v in fill.report.poles) or 'none'}")
        flat.set_aspect("equal")
        flat.set_axis_off()
        vertices, faces, rim, corners = holed(surface, n)
        fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, method="multi_sided", output="quads")
        everything, quads = np.vstack([vertices, fill.vertices]), [list(f) for f in fill.faces]
        colors = ["0.8"] * len(faces) + ["#d9a066"] * len(quads)
        show(figure.add_subplot(4, 4, 5 + column, projection="3d"), everything, [*faces.tolist(), *quads], colors)
        plane, faces, rim, corners = sectors(n)
        x, y = plane.T
        vertices = surface(0.6 * x, 0.6 * y)
        fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, output="cage")
        everything, quads = np.vstack([vertices, fill.vertices]), [list(f) for f in fill.faces]
        colors = ["0.8"] * len(faces) + ["#d9a066"] * len(quads)
        show(figure.add_subplot(4, 4, 9 + column, projection="3d"), everything, [*faces, *quads], colors)
        fine, fine_faces = subdivided(vertices, faces, fill)
        gray = [str(g) for g in zebra(fine, fine_faces)]
        show(figure.add_subplot(4, 4, 13 + column, projection="3d"), fine, fine_faces, gray, gray)
    figure.tight_layout()
    figure.savefig(folder / "quads.png", dpi=65)


def subdivided(vertices, faces, fill, times=4):
    """The whole cage, refined by Catmull and Clark's rules."""
    points, cells = np.vstack([vertices, fill.vertices]), [*faces, *[list(f) for f in fill.faces]]
    for _ in range(times):
        points, cells = refined(points, cells)
    return points, cells


def refined(points, cells):
    """One step of Catmull and Clark's; the border by the cubic B-spline's rule."""
    middle, edges = np.array([points[c].mean(axis=0) for c in cells]), {}
    for f, cell in enumerate(cells):
        for a, b in zip(cell, cell[1:] + cell[:1], strict=True):
            edges.setdefault((min(a, b), max(a, b)), []).append(f)
    n, number = len(points), {edge: len(points) + k for k, edge in enumerate(edges)}
    on_edges = np.array(
        [
            (points[a] + points[b] + (middle[adjacent].sum(axis=0) if len(adjacent) == 2 else 0))
            / (4 if len(adjacent) == 2 else 2)
            for (a, b), adjacent in edges.items()
        ]
    )
    sums, count, mids, border = np.zeros_like(points), np.zeros(n), np.zeros_like(points), np.zeros(n, bool)
    for f, cell in enumerate(cells):
        sums[cell] += middle[f]
        count[cell] += 1
    rim_sum = np.zeros_like(points)
    for (a, b), adjacent in edges.items():
        mids[[a, b]] += (points[a] + points[b]) / 2
        if len(adjacent) == 1:
            border[[a, b]] = True
            rim_sum[[a, b]] += (points[a] + points[b]) / 2
    k = count[:, None]
    moved = np.where(border[:, None], (2 * points + rim_sum) / 4, (sums / k + 2 * mids / k + (k - 3) * points) / k)
    base = n + len(edges)
    cells_now = []
    for f, cell in enumerate(cells):
        for i, v in enumerate(cell):
            after, before = cell[(i + 1) % len(cell)], cell[i - 1]
            ends = [number[min(v, w), max(v, w)] for w in (after, before)]
            cells_now.append([v, ends[0], base + f, ends[1]])
    return np.vstack([moved, on_edges, middle]), cells_now


def lens(surface, per_side=12, rings=5, height=0.24):
    """A mesh about a hole between two parabolas."""
    t = np.arange(per_side) / per_side
    low = np.stack([1.2 * t - 0.6, -4 * height * t * (1 - t)], -1)
    rim = np.concatenate([low, -low])
    plane = ((1 + 0.09 * np.arange(rings))[:, None, None] * rim).reshape(-1, 2)
    m = len(rim)
    a, b = (np.arange((rings - 1) * m).reshape(-1, m)[:, np.r_[s:m, 0:s]].ravel() for s in (0, 1))
    return surface(*plane.T), np.stack([b, a, a + m, b + m], -1), list(range(m)), [0, per_side]


def draw_holes(path, holes, width):
    """The domain of each hole with the lines of its triangles, and these on the patch."""
    figure = plt.figure(figsize=(width, 6.6))
    for column, (vertices, faces, rim, corners) in enumerate(holes):
        fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, method="multi_sided")
        whole = np.vstack([vertices, fill.vertices])
        flat = figure.add_subplot(2, len(holes), column + 1)
        uv = np.vstack([fill.rim_uv, fill.uv])
        at = {v: k for k, v in enumerate(fill.rim)} | {len(vertices) + k: len(fill.rim) + k for k in range(len(fill.uv))}
        flat.triplot(*uv.T, triangles=[[at[v] for v in face] for face in fill.faces], color="0.6", linewidth=0.4)
        flat.fill(*fill.rim_uv.T, fill=False, edgecolor="k", linewidth=1.5)
        flat.set_title(f"{len(corners)} sides: the domain")
        flat.set_aspect("equal")
        flat.set_axis_off()
        solid = figure.add_subplot(2, len(holes), len(holes) + 1 + column, projection="3d")
        light = LightSource(315, 50)
        around = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
        for triangles, color in ((around, "0.8"), (np.array(fill.faces), "#d9a066")):
            solid.plot_trisurf(*whole.T, triangles=triangles, color=color, edgecolor="0.35", linewidth=0.2, lightsource=light)
        solid.set_title(f"seam within {fill.report.seam_angle_max:.0e} degrees", y=0.97)
        solid.set_box_aspect(np.ptp(whole, axis=0), zoom=1.4)
        solid.view_init(48, -60)
        solid.set_axis_off()
    figure.tight_layout()
    figure.savefig(path, dpi=90)


def draw(folder):
    """Writes holes.png, lens.png and quads.png into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    draw_quads(folder)
    holes = [holed(surface, n) for surface, n in ((egg, 4), (saddle, 5), (egg, 6), (saddle, 8))]
    draw_holes(folder / "holes.png", holes, 14)
    draw_holes(folder / "lens.png", [lens(egg), lens(saddle)], 8)
