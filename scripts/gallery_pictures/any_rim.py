"""Jagged holes in irregular triangles, as any deletion leaves them: the hole, the fill, its distance from what was there and the
standard deviation that it states of itself."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import tripatch
from mpl_toolkits.mplot3d.art3d import Poly3DCollection


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


def on_edges(lift, n=20, radius=0.5, seed=5):
    """The same over something whose crease is the line y = 0 of the plane."""
    rng = np.random.default_rng(seed)
    grid = np.linspace(-1.2, 1.2, n + 1)
    points = np.stack(np.meshgrid(grid, grid, indexing="ij"), -1).reshape(-1, 2)
    jitter = rng.uniform(-0.3, 0.3, points.shape) * (grid[1] - grid[0])
    jitter[np.abs(points[:, 1]) < 1e-9, 1] = 0
    points += jitter
    at = np.arange(len(points)).reshape(n + 1, n + 1)
    a, b, c, d = (q.ravel() for q in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    turn = (rng.random(len(a)) < 0.5)[:, None]
    faces = np.vstack([np.where(turn, np.c_[a, b, c], np.c_[a, b, d]), np.where(turn, np.c_[a, c, d], np.c_[b, c, d])])
    faces = faces[np.linalg.norm(points[faces].mean(axis=1), axis=1) > radius]
    return lift(*points.T), faces, sorted(tripatch.find_holes(faces), key=len)[-2]


def solid(figure, place, vertices, faces, title, new=(), creases=(), zoom=1.3):
    """Flat shading, the new faces in another color, creases drawn."""
    axes = figure.add_subplot(*place, projection="3d")
    axes.plot_trisurf(*vertices.T, triangles=faces, color="0.85", edgecolor="0.45", linewidth=0.25)
    if len(new):
        axes.plot_trisurf(*vertices.T, triangles=new, color="#8db3e2", edgecolor="0.35", linewidth=0.25)
    for a, b in creases:
        axes.plot(*vertices[[a, b]].T, color="#b02020", linewidth=1.8, zorder=10)
    axes.set_title(title, y=0.97)
    axes.set_box_aspect(np.ptp(vertices, axis=0), zoom=zoom)
    axes.view_init(32, 35)
    axes.set_axis_off()


def draw_creases(path):
    """Holes across the edge of a box and of a cylinder's end: with the creases continued, and rounded off."""

    def box(x, y):
        return np.column_stack([np.minimum(y, 0), x, -np.maximum(y, 0)])

    def cylinder(x, y):
        r = 1 + np.minimum(y, 0)
        return np.column_stack([r * np.cos(x), r * np.sin(x), -np.maximum(y, 0)])

    figure = plt.figure(figsize=(12, 7))
    for row, lift in enumerate((box, cylinder)):
        vertices, faces, rim = on_edges(lift)
        near = faces[np.linalg.norm(vertices[faces].mean(axis=1) - lift(np.zeros(1), np.zeros(1)), axis=1) < 1.0]
        solid(figure, (2, 3, 3 * row + 1), vertices, near, "the hole")
        for column, features in enumerate((True, False)):
            fill = tripatch.fill(vertices, faces, rim=rim, features=features)
            whole = np.vstack([vertices, fill.vertices])
            title = "creases go on" if features else "features=False"
            solid(figure, (2, 3, 3 * row + 2 + column), whole, near, title, fill.faces, fill.feature_edges)
    figure.tight_layout()
    figure.savefig(path, dpi=90)
    plt.close(figure)


def box(n):
    """The cube from -1 to 1 with n x n quads a face."""
    grid = np.linspace(-1, 1, n + 1)
    u, v = (a.ravel() for a in np.meshgrid(grid, grid, indexing="ij"))
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], axis=-1).reshape(-1, 4)
    points, faces = [], []
    for k, (axis, side) in enumerate((axis, side) for axis in range(3) for side in (-1, 1)):
        points.append(np.roll(np.column_stack([np.full_like(u, side), u, v]), axis, axis=1))
        faces.append((quads if side > 0 else quads[:, ::-1]) + k * at.size)
    vertices, number = np.unique(np.round(np.concatenate(points), 12), axis=0, return_inverse=True)
    return vertices, number.ravel()[np.concatenate(faces)]


def draw_walls(path):
    """A box without a corner, an edge, a wall: as it is, rounded off, and closed by its walls."""
    vertices, faces = box(4)
    x, y, z = vertices[faces].mean(axis=1).T
    holes = np.minimum(np.minimum(x, y), z) > 0.1, np.minimum(x, z) > 0.1, (z > 0.9) | ((np.maximum(x, y) > 0.9) & (z > 0.1))
    figure = plt.figure(figsize=(10, 9.5))
    for column, gone in enumerate(holes):
        left = faces[~gone]
        triangles = np.vstack([left[:, :3], left[:, [0, 2, 3]]])
        solid(figure, (3, 3, 1 + column), vertices, triangles, "the hole", zoom=1)
        for row, features in enumerate((False, True)):
            (fill,) = tripatch.fill_all(vertices, left.tolist(), features=features)
            whole = np.vstack([vertices, fill.vertices])
            title = "walls go on" if features else "features=False"
            solid(figure, (3, 3, 4 + 3 * row + column), whole, triangles, title, fill.faces, fill.feature_edges, zoom=1)
    figure.tight_layout()
    figure.savefig(path, dpi=90)
    plt.close(figure)


def blob(faces, start, count, seed):
    """Faces grown at random from one; the faces left and the rim."""
    rng = np.random.default_rng(seed)
    at = {(f[k], f[(k + 1) % 4]): i for i, f in enumerate(faces) for k in range(4)}
    gone = {start}
    while len(gone) < count:
        f = faces[sorted(gone)[rng.integers(len(gone))]]
        k = int(rng.integers(4))
        gone.add(at[f[(k + 1) % 4], f[k]])
    left = [f for i, f in enumerate(faces) if i not in gone]
    rims = [rim for rim in tripatch.find_holes(left) if all((b, a) in at for a, b in zip(rim, [*rim[1:], rim[0]], strict=True))]
    return left, min(rims, key=len)


def with_triangle(vertices, left, rim):
    """The same with a vertex more on an edge of the rim."""
    a, b = rim[:2]
    vertices = np.vstack([vertices, vertices[[a, b]].mean(axis=0)])
    left = [list(f) for f in left]
    face = next(f for f in left if {a, b} <= set(f))
    k = next(k for k in range(len(face)) if {face[k], face[(k + 1) % len(face)]} == {a, b})
    face.insert(k + 1, len(vertices) - 1)
    return vertices, left, [a, len(vertices) - 1, *rim[1:]]


def polygons(figure, place, vertices, faces, new, title, view, zoom=1.25):
    axes = figure.add_subplot(*place, projection="3d")
    for some, color in ((faces, "0.88"), (new, "#8db3e2")):
        if not len(some):
            continue
        solids = Poly3DCollection(
            [vertices[list(f)] for f in some], facecolors=color, edgecolors="0.3", linewidth=0.5, shade=True
        )
        axes.add_collection3d(solids)
    used = vertices[sorted({v for f in [*faces, *new] for v in f})]
    axes.set(xlim=(used[:, 0].min(), used[:, 0].max()), ylim=(used[:, 1].min(), used[:, 1].max()))
    axes.set(zlim=(used[:, 2].min(), used[:, 2].max()))
    axes.set_box_aspect(np.ptp(used, axis=0), zoom=zoom)
    axes.view_init(*view)
    axes.set_title(title, y=1.0)
    axes.set_axis_off()


def draw_grown(path):
    """Blobs of quads that are taken out: the hole, triangles, quads that continue."""
    n = 14
    x, y = (c.ravel() for c in np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1)))
    sheet = np.column_stack([x, y, 0.25 * np.sin(2 * x) * np.cos(2 * y)])
    w = n + 1
    grid = [[j * w + i, j * w + i + 1, (j + 1) * w + i + 1, (j + 1) * w + i] for j in range(n) for i in range(n)]
    ball, around = cube_sphere(10)
    corner = max(range(len(around)), key=lambda f: ball[around[f]].mean(axis=0) @ (1, 1.1, 1.2))
    one, two = blob(grid, n * n // 2 + n // 2, 26, 4), blob(around, corner, 24, 2)
    rows = [(sheet, *one, (48, -70)), (ball, *two, (35, 48)), (*with_triangle(sheet, *one), (48, -70))]
    figure = plt.figure(figsize=(12, 11))
    for row, (vertices, left, rim, view) in enumerate(rows):
        toward = np.array([np.cos(np.radians(view[1])), np.sin(np.radians(view[1])), np.tan(np.radians(view[0]))])
        seen = left if row != 1 else [f for f in left if vertices[list(f)].mean(axis=0) @ toward > 0.4]
        polygons(figure, (3, 3, 3 * row + 1), vertices, seen, [], f"{len(rim)} edges", view)
        for column, output in enumerate(("triangles", "quads")):
            fill = tripatch.fill(vertices, left, rim=rim, output=output)
            whole = np.vstack([vertices, fill.vertices])
            count = sum(len(f) == (3 if output == "triangles" else 4) for f in fill.faces)
            title = f"{count} {output}" + (", 1 triangle" if count < len(fill.faces) else "")
            polygons(figure, (3, 3, 3 * row + 2 + column), whole, seen, fill.faces, title, view)
    figure.tight_layout()
    figure.savefig(path, dpi=80)
    plt.close(figure)


def without_faces(vertices, faces, gone):
    """Vertices that are left, faces without some, and the rim of these."""
    left = [f for k, f in enumerate(faces) if k not in gone]
    used = sorted({v for f in left for v in f})
    number = {old: new for new, old in enumerate(used)}
    adjacent = {number[v] for k in gone for v in faces[k] if v in number}
    faces = [[number[v] for v in f] for f in left]
    return vertices[used], faces, next(r for r in tripatch.find_holes(faces) if set(r) <= adjacent)


def rows_of_quads(columns, rows, cells, at):
    """A grid of quads without some cells (column, row); vertices, faces left and the rim."""
    i, j = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0), indexing="ij")
    index = np.arange(i.size).reshape(i.shape)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4).tolist()
    vertices = np.stack(np.broadcast_arrays(*at(i, j)), axis=-1).reshape(-1, 3)
    return without_faces(vertices, quads, {column * rows + row for column, row in cells})


def bevelled_box_without_a_corner(n, straight):
    """Of n x n quads a side; straight: the share of its sides that is not bevelled."""
    vertices, faces = cube_sphere(n)
    vertices = vertices / np.abs(vertices).max(axis=1, keepdims=True)
    middles = np.array([vertices[f].mean(axis=0) for f in faces])
    inner = np.clip(vertices, -straight, straight)
    bevelled = inner + (1 - straight) * (vertices - inner) / np.linalg.norm(vertices - inner, axis=1, keepdims=True)
    return without_faces(bevelled * [1, 1.2, 0.9], faces, set(np.flatnonzero(middles.min(axis=1) > 0.1).tolist()))


def draw_rows(path):
    """Quads out of a bevelled edge, a bent tube and the corner of a box: the hole, the surface over a plane, continued rows."""

    def bevel(i, j):
        k = i.astype(int)
        across = np.array([0, 1, 2, 3, 3.55, 3.85, 4, 4, 4, 4, 4])[k]
        down = np.array([0, 0, 0, 0, 0.15, 0.45, 1, 2, 3, 4, 5])[k]
        return across, 0.8 * j, -down + 0.5 * np.sin(0.6 * j)

    def tube(i, j):
        turn, bend = np.pi * i / 8, 0.16 * j
        radius = 3 + np.cos(turn)
        return radius * np.cos(bend), radius * np.sin(bend), np.sin(turn)

    block = [(2 + i, 3 + j) for i in range(6) for j in range(6)]
    cross = [(2 + i, 4 + j) for i in range(5) for j in range(6) if i in (1, 2) or j in (2, 3, 4)]
    meshes = [
        (rows_of_quads(10, 12, block, bevel), (35, 30)),
        (rows_of_quads(9, 14, cross, tube), (60, 65)),
        (bevelled_box_without_a_corner(14, 0.8), (35, 40)),
    ]
    figure = plt.figure(figsize=(12, 11))
    for row, ((vertices, left, rim), view) in enumerate(meshes):
        toward = np.array([np.cos(np.radians(view[1])), np.sin(np.radians(view[1])), np.tan(np.radians(view[0]))])
        zoom = 1.1 if row < 2 else 0.95
        normals = [np.cross(*(vertices[f[k]] - vertices[f[0]] for k in (1, 2))) for f in left]
        seen = left if row < 2 else [f for f, normal in zip(left, normals, strict=True) if normal @ toward > 0]
        polygons(figure, (3, 3, 3 * row + 1), vertices, seen, [], f"{len(rim)} edges", view, zoom)
        for column, (method, title) in enumerate(
            (("polyharmonic_spline", "a surface over a plane"), ("auto", "rows that go on"))
        ):
            fill = tripatch.fill(vertices, left, rim=rim, output="quads", method=method)
            whole = np.vstack([vertices, fill.vertices])
            polygons(figure, (3, 3, 3 * row + 2 + column), whole, seen, fill.faces, title, view, zoom)
    figure.tight_layout()
    figure.savefig(path, dpi=80)
    plt.close(figure)


def cube_sphere(n):
    """A cube of n x n quads a side, blown up to the unit sphere."""
    points, faces = {}, []
    for axis in range(3):
        for side in (0, n):
            for i in range(n):
                for j in range(n):
                    corners = []
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        place = [a, b]
                        place.insert(axis, side)
                        corners.append(points.setdefault(tuple(place), len(points)))
                    faces.append(corners if (side > 0) == (axis != 1) else corners[::-1])
    cube = 2 * np.array(list(points)) / n - 1
    return cube / np.linalg.norm(cube, axis=1, keepdims=True), faces


def draw(folder):
    """Writes hill.png, creases.png, walls.png, grown.png and rows.png into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    draw_creases(folder / "creases.png")
    draw_walls(folder / "walls.png")
    draw_grown(folder / "grown.png")
    draw_rows(folder / "rows.png")

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
