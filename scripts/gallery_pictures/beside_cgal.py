"""Jagged holes filled by CGAL and by TriPatch, and the standard deviation that TriPatch states.

Needs CGAL's headers and a compiler (Debian: libcgal-dev, g++), and in GALLERY_MANNEQUIN the path of mannequin-devil.off among
CGAL's data/meshes; where one is missing nothing is drawn and it is said so.
"""

from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import tripatch
from matplotlib.colors import LightSource

from .any_rim import jagged

SOURCE = pathlib.Path(__file__).with_suffix(".cpp")


def read_off(path):
    words = iter(word for line in pathlib.Path(path).read_text().splitlines() for word in line.split("#")[0].split())
    assert next(words).endswith("OFF")
    n, m, _ = (int(next(words)) for _ in range(3))
    vertices = np.array([float(next(words)) for _ in range(3 * n)]).reshape(-1, 3)
    return vertices, np.array([[int(next(words)) for _ in range(int(next(words)))] for _ in range(m)])


def write_off(path, vertices, faces):
    rows = [" ".join(f"{x:.17g}" for x in v) for v in vertices] + ["3 " + " ".join(map(str, f)) for f in faces]
    pathlib.Path(path).write_text("\n".join(["OFF", f"{len(vertices)} {len(faces)} 0", *rows, ""]))


def by_cgal(program, vertices, faces, rim, continuity):
    """Vertices of the filled mesh (the given ones first), and the new faces."""
    with tempfile.TemporaryDirectory() as folder:
        given, made = f"{folder}/given.off", f"{folder}/made.off"
        write_off(given, vertices, faces)
        subprocess.run([program, given, str(rim[0]), str(rim[1]), str(continuity), made], check=True)
        filled, all_faces = read_off(made)
    return filled, all_faces[len(faces) :]


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
    axes.set_title(title, y=0.98, fontsize=10)
    axes.set_axis_off()


def row(figure, rows, at, program, vertices, faces, rim, view, truth=None):
    def away(points):
        return "" if truth is None else f": {np.sqrt(np.mean((points[:, 2] - truth(*points[:, :2].T)) ** 2)):.1e} away"

    low, high = np.array(view[0]), np.array(view[1])
    middle = vertices[faces].mean(axis=1)
    near = faces[np.all((middle > low) & (middle < high), axis=1)]
    surface(figure, (rows, 5, 5 * at + 1), vertices, near, view, f"a rim of {len(rim)} edges")
    for continuity in (1, 2):
        whole, new = by_cgal(program, vertices, faces, rim, continuity)
        title = f"CGAL, continuity {continuity}{away(whole[len(vertices) :])}"
        surface(figure, (rows, 5, 5 * at + 1 + continuity), whole, np.vstack([near, new]), view, title, new)
    fill = tripatch.fill(vertices, faces, rim=rim)
    whole, new = np.vstack([vertices, fill.vertices]), np.array([list(f) for f in fill.faces])
    surface(figure, (rows, 5, 5 * at + 4), whole, np.vstack([near, new]), view, f"TriPatch{away(fill.vertices)}", new)
    deviation = np.r_[np.zeros(len(vertices)), fill.deviation]
    surface(figure, (rows, 5, 5 * at + 5), whole, np.vstack([near, new]), view, "its standard deviation", new, deviation)


def draw(folder):
    """Writes beside_cgal.png into a folder."""
    mannequin, compiler = os.environ.get("GALLERY_MANNEQUIN"), shutil.which("g++")
    if not (mannequin and compiler and pathlib.Path("/usr/include/CGAL").exists()):
        print("beside_cgal.png is left as it is: it needs CGAL, g++ and GALLERY_MANNEQUIN")
        return
    folder.mkdir(parents=True, exist_ok=True)

    def hill(x, y):
        return 0.5 * np.exp(-0.9 * (x * x + y * y))

    with tempfile.TemporaryDirectory() as built:
        program = f"{built}/beside_cgal"
        options = ["-std=c++17", "-O2", "-DCGAL_EIGEN3_ENABLED", "-I/usr/include/eigen3"]
        subprocess.run([compiler, *options, str(SOURCE), "-o", program, "-lgmp", "-lmpfr"], check=True)
        figure = plt.figure(figsize=(17, 9.5))
        for at, noise in enumerate((0.0, 0.05)):
            vertices, faces, rim = jagged(hill, noise)
            row(figure, 3, at, program, vertices, faces, rim, ((-0.8, -0.8, -0.05), (0.8, 0.8, 0.6), 40, -60), hill)
        vertices, faces = read_off(mannequin)
        rim = max(tripatch.find_holes(faces), key=len)
        middle, half = vertices[rim].mean(axis=0), 0.7 * np.ptp(vertices[rim], axis=0).max()
        row(figure, 3, 2, program, vertices, faces, rim, (middle - half, middle + half, -35, -60))
        figure.tight_layout()
        figure.savefig(folder / "beside_cgal.png", dpi=80)
        plt.close(figure)
