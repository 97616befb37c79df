"""Smits's curves over whole meshes: an icosphere, a knot of few triangles, and Suzanne where Blender is at hand."""

import os
import pathlib

import numpy as np
import tripatch

from .render import BLUE, CLAY, Scene, save, unit


def icosahedron():
    g = (1 + 5**0.5) / 2
    v = unit(
        np.array(
            [
                (-1, g, 0),
                (1, g, 0),
                (-1, -g, 0),
                (1, -g, 0),
                (0, -1, g),
                (0, 1, g),
                (0, -1, -g),
                (0, 1, -g),
                (g, 0, -1),
                (g, 0, 1),
                (-g, 0, -1),
                (-g, 0, 1),
            ]
        )
    )
    f = np.array(
        [
            (0, 11, 5),
            (0, 5, 1),
            (0, 1, 7),
            (0, 7, 10),
            (0, 10, 11),
            (1, 5, 9),
            (5, 11, 4),
            (11, 10, 2),
            (10, 7, 6),
            (7, 1, 8),
            (3, 9, 4),
            (3, 4, 2),
            (3, 2, 6),
            (3, 6, 8),
            (3, 8, 9),
            (4, 9, 5),
            (2, 4, 11),
            (6, 2, 10),
            (8, 6, 7),
            (9, 8, 1),
        ]
    )
    return v, f


def knot(along=40, around=7):
    """A trefoil tube of few triangles, with its normals."""
    t = np.linspace(0, 2 * np.pi, along, endpoint=False)

    def axis(t):
        return np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -1.3 * np.sin(3 * t)], -1)

    tangent = unit(axis(t + 1e-4) - axis(t - 1e-4))
    side = unit(np.cross(tangent, axis(t) * [1, 1, 0]))
    other = np.cross(tangent, side)
    a = np.linspace(0, 2 * np.pi, around, endpoint=False)[:, None]
    normals = np.cos(a) * side[:, None] + np.sin(a) * other[:, None]
    v = (axis(t)[:, None] + 0.62 * normals).reshape(-1, 3)
    faces = []
    for k in range(along):
        for j in range(around):
            p, q = k * around + j, k * around + (j + 1) % around
            r, s = ((k + 1) % along) * around + j, ((k + 1) % along) * around + (j + 1) % around
            faces += [(p, q, s), (p, s, r)]
    return v, np.array(faces), normals.reshape(-1, 3)


def suzanne():
    """Suzanne's triangles, which scripts/gallery asks Blender for; None without them."""
    path = os.environ.get("GALLERY_SUZANNE", "")
    if not pathlib.Path(path).is_file():
        return None
    data = np.load(path)
    v, f = data["vertices"], data["faces"]
    flat = np.cross(v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]])
    normals = np.zeros_like(v)
    for corner in range(3):
        np.add.at(normals, f[:, corner], flat)
    # Where thin parts are folded back the faces' normals cancel: one face's has to do.
    cancel = np.linalg.norm(normals, axis=1) < 1e-6 * np.linalg.norm(flat, axis=1).max()
    for vertex in np.flatnonzero(cancel):
        normals[vertex] = flat[(f == vertex).any(1)][0]
    return v, f, normals


def before_and_after(v, f, view, normals=None, resolution=10, stripes=9):
    flat = unit(np.cross(v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]]))
    smooth = tripatch.smooth_triangles(v, f, normals, resolution=resolution)
    return [
        Scene(*view).mesh(v, f, flat, BLUE).image(),
        Scene(*view).mesh(smooth.vertices, np.asarray(smooth.faces), smooth.normals, CLAY).image(),
        Scene(*view, stripes=stripes).mesh(smooth.vertices, np.asarray(smooth.faces), smooth.normals, CLAY, True).image(),
    ], smooth


def draw(folder):
    v, f = icosahedron()
    images, smooth = before_and_after(v, f, (20, 20), v)
    off = np.abs(np.linalg.norm(smooth.vertices, axis=1) - 1).max()
    save(folder / "smits-icosphere.png", images, ["20 triangles", f"smoothed, within {off:.1e} of the sphere", "highlight lines"])
    v, f, normals = knot()
    images, _ = before_and_after(v, f, (-90, 60), normals, resolution=8)
    save(folder / "smits-knot.png", images[:2], [f"{len(f)} triangles", "smoothed"])
    monkey = suzanne()
    if monkey is not None:
        v, f, normals = monkey
        images, _ = before_and_after(v, f, (-65, 12), normals, resolution=5)
        save(folder / "smits-suzanne.png", images[:2], [f"Suzanne, {len(f)} triangles", "smoothed"])
