"""Figures 4 to 6 of Liu, Ma and Cheng (2008): three rectangular surfaces joined by a triangular one."""

import numpy as np
import tripatch

from .render import CLAY, GREY, INK, Scene, of_rectangle, save

ARC = 4 / 3 * np.tan(np.pi / 8)


SKEW = np.array([[1, 0.25, 0], [-0.45, 0.9, 0.1], [0.1, -0.35, 1.15]])


def fillets():
    """Three skewed bicubic fillets that end at a corner; their lines are oblique and of different lengths."""
    rectangles = []
    for i, (length, shear) in enumerate(((1.1, 0.9), (2.2, -0.8), (0.6, 0.5))):
        a, b, axis = np.roll(np.eye(3), -i, axis=0)[[1, 2, 0]]
        arc = np.array([a, a + ARC * b, b + ARC * a, b])
        along = np.array([ARC * b, 0.4 * (b - a), 0.4 * (b - a), -ARC * a]) * shear  # about c', in the tangent planes
        net = np.stack([arc + v * (-length * axis + along * (1 if v < 0.5 else 0.4)) for v in (0, 1 / 3, 2 / 3, 1)], axis=1)
        rectangles.append(tripatch.BezierRectangle(net @ SKEW.T))
    return rectangles


def draw(folder):
    rectangles = fillets()
    sides = [tripatch.Side(r, 0) for r in rectangles]
    view = (45, 35)

    def around(scene, zebra, v=(0, 0.4)):
        for r in rectangles:
            points, normals = of_rectangle(r, v=v)
            scene.surface(points, normals, GREY, zebra)
        return scene

    hole = around(Scene(*view), False, (0, 0.6))
    for r in rectangles:
        points, _ = of_rectangle(r, v=(0, 0.6))
        hole.lines(points, 8)
        hole.curve(points[:, 0], INK, 2.6)
    save(folder / "liu-ma-cheng-04.png", [hole.image(420, 380)])

    shaded, striped = [], []
    slopes = ("given", "as_printed", "consistent")
    for s in slopes:
        patch = tripatch.patch(sides, method="side_vertex", cross_boundary=s)
        shaded.append(around(Scene(*view), False, (0, 0.6)).patch(patch, CLAY, lines=0).image())
        striped.append(around(Scene(*view, stripes=12), True).patch(patch, CLAY, True, m=80).image())
    save(
        folder / "liu-ma-cheng-05-06.png",
        shaded + striped,
        [f"5: slopes {s}" for s in slopes] + [f"6: highlight lines, {s}" for s in slopes],
        columns=3,
    )
