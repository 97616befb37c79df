"""Jagged holes filled by CGAL and by TriPatch, and the standard deviation that TriPatch states.

Needs in CGAL_FILL the compiled caller of CGAL (scripts/comparison, made where libcgal-dev is installed), and in GALLERY_MANNEQUIN
the path of mannequin-devil.off among CGAL's data/meshes; where one is missing nothing is drawn and it is said so.
"""

from __future__ import annotations

import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import tripatch
from comparison import rivals
from comparison.holes import Hole
from matplotlib.colors import LightSource
from tripatch import files

from .any_rim import jagged


def surface(figure, place, vertices, faces, view, title, new=None, values=None):
    """Faces lit from the side; the new ones in another color or by a value of each of their vertices, with a bar."""
    axes = figure.add_subplot(*place, projection="3d")
    normals = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    shade = (
        0.35 + 0.65 * LightSource(300, 35).shade_normals(normals / np.linalg.norm(normals, axis=1, keepdims=True), 1.0)[:, None]
    )
    colors = np.tile([0.86, 0.86, 0.86], (len(faces), 1))
    if values is not None:
        drawn = plt.cm.ScalarMappable(plt.Normalize(0, values.max()), "viridis")
        colors[-len(new) :] = drawn.to_rgba(values[new].mean(axis=1))[:, :3]
        plt.colorbar(drawn, ax=axes, shrink=0.6, format="%.1g")
    elif new is not None:
        colors[-len(new) :] = [0.62, 0.76, 0.93]
    drawing = axes.plot_trisurf(*vertices.T, triangles=faces, linewidth=0.15, edgecolor="0.35")
    drawing.set_facecolor(np.clip(colors * shade, 0, 1))
    low, high, elevation, azimuth = view
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(np.subtract(high, low), zoom=1.5)
    axes.view_init(elevation, azimuth)
    axes.set_title(title, y=1.1, fontsize=10)
    axes.set_axis_off()


def row(figure, rows, at, program, vertices, faces, rim, view, truth=None):
    def away(points):
        return "" if truth is None else f": {np.sqrt(np.mean((points[:, 2] - truth(*points[:, :2].T)) ** 2)):.1e} away"

    low, high = np.array(view[0]), np.array(view[1])
    middle = vertices[faces].mean(axis=1)
    near = faces[np.all((middle > low) & (middle < high), axis=1)]
    surface(figure, (rows, 5, 5 * at + 1), vertices, near, view, f"a rim of {len(rim)} edges")
    for continuity in (1, 2):
        hole = Hole("", vertices, faces, np.array(rim))
        made = rivals.program(program, continuity)(hole, None)
        whole, new = made.vertices, made.faces
        title = f"CGAL, continuity {continuity}{away(whole[len(vertices) :])}"
        surface(figure, (rows, 5, 5 * at + 1 + continuity), whole, np.vstack([near, new]), view, title, new)
    fill = tripatch.fill(vertices, faces, rim=rim)
    whole, new = np.vstack([vertices, fill.vertices]), np.array([list(f) for f in fill.faces])
    surface(figure, (rows, 5, 5 * at + 4), whole, np.vstack([near, new]), view, f"TriPatch{away(fill.vertices)}", new)
    deviation = np.r_[np.zeros(len(vertices)), fill.deviation]
    surface(figure, (rows, 5, 5 * at + 5), whole, np.vstack([near, new]), view, "its standard deviation", new, deviation)


def draw(folder):
    """Writes beside_cgal.png into a folder."""
    mannequin, program = os.environ.get("GALLERY_MANNEQUIN"), os.environ.get("CGAL_FILL")
    if not (mannequin and program):
        print("beside_cgal.png is left as it is: it needs CGAL and GALLERY_MANNEQUIN")
        return
    folder.mkdir(parents=True, exist_ok=True)

    def hill(x, y):
        return 0.5 * np.exp(-0.9 * (x * x + y * y))

    figure = plt.figure(figsize=(17, 10.5))
    for at, noise in enumerate((0.0, 0.05)):
        vertices, faces, rim = jagged(hill, noise)
        row(figure, 3, at, program, vertices, faces, rim, ((-0.8, -0.8, -0.05), (0.8, 0.8, 0.6), 40, -60), hill)
    mesh = files.read(mannequin)
    vertices, faces = np.asarray(mesh.vertices), np.array([list(f) for f in mesh.faces])
    rim = max(tripatch.find_holes(faces), key=len)
    middle, half = vertices[rim].mean(axis=0), 0.7 * np.ptp(vertices[rim], axis=0).max()
    row(figure, 3, 2, program, vertices, faces, rim, (middle - half, middle + half, -35, -60))
    figure.tight_layout(h_pad=3)
    figure.savefig(folder / "beside_cgal.png", dpi=80)
    plt.close(figure)
