"""The picture of docs/glossary.md: a hole with rim, corners, sides and ribbons; the patch; a cage over its limit surface."""

import matplotlib.pyplot as plt
import numpy as np
import tripatch

from .methods import SPEEDS, surroundings
from .render import CLAY, GREY, INK, RED, Scene, of_rectangle, save_figure, unit

SIZE = 400, 350
VIEW = (-90, 52)
RIBBON = 0.16  # reach of the ribbons, scene units
PLATE = {"fc": "white", "ec": "none", "alpha": 0.7, "pad": 1}  # behind words
LINE = (0.45, 0.45, 0.5)


def ground(scene, rectangles):
    for r, speed in zip(rectangles, SPEEDS):
        points, normals = of_rectangle(r, v=(0, 0.6 / speed))
        scene.surface(points, normals, GREY)
        for k in range(0, 41, 8):
            scene.curve(points[k], LINE, 0.7).curve(points[:, k], LINE, 0.7)


def ribbon(side):
    """The strip of tangent planes inside the hole along a side: points and normals on a grid."""
    c, _, r, n = side.evaluate(np.linspace(0, 1, 41))
    depth = np.linspace(0, RIBBON, 9)[None, :, None]
    return c[:, None] - depth * unit(r)[:, None], np.broadcast_to(n[:, None], (41, 9, 3))


def of_cage():
    """A cage with a fill of few quads in a corner of a rounded cube, and the fill's limit surface."""
    from .cage_shapes import cube_sphere

    cage = cube_sphere(6, 2, on_limit=False)
    fill = tripatch.fill(cage.vertices, cage.left, rim=cage.rim(), corners=cage.corners(), output="cage", resolution=0)
    return cage, fill


def flat(scene, vertices, faces, color):
    for face in faces:
        a, b, c, d = vertices[list(face)]
        grid = np.array([[a, d], [b, c]])
        scene.surface(grid, np.broadcast_to(unit(np.cross(b - a, d - a)), grid.shape), color)


def labels(axes, scene, sides, corners):
    """The words next to what they name."""
    middle = corners.mean(0)
    for i, corner in enumerate(corners):
        x, y = scene.pixels(corner - 0.22 * (middle - corner), *SIZE)
        axes.text(x, y, f"corner {i}", fontsize=9, ha="center", va="center", bbox=PLATE)
        inside = sides[i].evaluate(np.array([0.5]))[0][0]
        x, y = scene.pixels(inside - 0.22 * (middle - inside), *SIZE)
        axes.text(x, y, f"side {i}", fontsize=9, ha="center", va="center", bbox=PLATE)
    for word, at, towards in (("ribbon", 0.4, 0.45), ("rim", 0.75, 0.0)):
        place = sides[0].evaluate(np.array([at]))[0][0]
        x, y = scene.pixels(place + towards * (middle - place) * 0.5, *SIZE)
        axes.annotate(
            word, (x, y), (x + 15, y - 45 if word == "ribbon" else y + 40), fontsize=9, arrowprops={"arrowstyle": "-", "lw": 0.7}
        )


def draw(folder):
    rectangles = surroundings()
    sides = [tripatch.Side(r, 0) for r in rectangles]
    patch = tripatch.patch(sides, fairing="auto")
    hole, filled = Scene(*VIEW), Scene(*VIEW)
    for scene in (hole, filled):
        ground(scene, rectangles)
    filled.patch(patch, CLAY, lines=8)
    for side in sides:
        hole.surface(*ribbon(side), RED)
        hole.curve(side.evaluate(np.linspace(0, 1, 200))[0], INK, 3)
    corners = np.array([sides[(i + 1) % 3].evaluate(np.ones(1))[0][0] for i in range(3)])
    hole.dots(corners)

    cage, fill = of_cage()
    middle = cage.vertices[cage.rim()].mean(0)
    azimuth = np.degrees(np.arctan2(middle[1], middle[0])) + 14
    scene = Scene(azimuth, 34)
    vertices = np.concatenate([cage.vertices, fill.vertices])
    for face in fill.faces:
        scene.curve(1.004 * vertices[[*face, face[0]]], INK, 1.6, 0.05)
    points, quads = fill.limit(3)
    corners_of = points[quads]
    normals = unit(np.cross(corners_of[:, 2] - corners_of[:, 0], corners_of[:, 3] - corners_of[:, 1]))
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    scene.mesh(points, triangles, np.concatenate([normals, normals]), CLAY)
    near = [f for f in cage.left if np.linalg.norm(vertices[list(f)].mean(0) - middle) < 0.9]
    flat(scene, vertices, near, GREY)
    for face in near:
        scene.curve(vertices[[*face, face[0]]], LINE, 0.7, 0.02)

    figure, axes = plt.subplots(1, 3, figsize=(12, 3.7))
    for a, s, title in zip(axes, (hole, filled, scene), ("hole", "patch", "cage over its limit")):
        a.imshow(s.image(*SIZE), interpolation="nearest")
        a.set_title(title, fontsize=11)
        a.axis("off")
    labels(axes[0], hole, sides, corners)
    axes[2].text(0.03, 0.06, "cage: lines\nlimit: orange", transform=axes[2].transAxes, fontsize=9)
    figure.subplots_adjust(0.005, 0.0, 0.995, 0.93, 0.01)
    save_figure(folder / "glossary.png", figure)
