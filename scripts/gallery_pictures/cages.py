"""Suzanne's jaw replaced by a cage, and a corner of a cube sphere filled: cages and highlight lines of the limit surfaces."""

from __future__ import annotations

import os
import pathlib

import numpy as np
import tripatch
from tripatch import _arrays, _native

from . import cage_shapes as cages
from . import render

LEVEL = 4


def limit(points, faces, creases=((), ())):
    """The limit surface as triangles with normals, and for each triangle the face of the cage that it is on."""
    settings = _native.Subdivision()
    settings.crease_edges, settings.edge_creases = [list(map(int, e)) for e in creases[0]], [float(c) for c in creases[1]]
    vertices, quads = _native._sample_limit(points, *_arrays.faces(faces), settings, 0, LEVEL)
    quads = quads.reshape(-1, 4)
    each = [4**LEVEL if len(face) == 4 else len(face) * 4 ** (LEVEL - 1) for face in faces]
    across = np.cross(vertices[quads[:, 2]] - vertices[quads[:, 0]], vertices[quads[:, 3]] - vertices[quads[:, 1]])
    normals = np.zeros_like(vertices)
    for k in range(4):
        np.add.at(normals, quads[:, k], across)
    triangles = np.stack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], 1).reshape(-1, 3)
    return vertices, triangles, render.unit(normals), np.repeat(np.repeat(np.arange(len(faces)), each), 2)


def picture(points, faces, first, view, center, span, creases=((), ()), cage=True):
    """first: the first face that is new."""
    vertices, triangles, normals, of = limit(points, faces, creases)
    scene = render.Scene(*view)
    near = np.linalg.norm(vertices[triangles].mean(1) - center, axis=1) < 0.9 * span
    scene.mesh(vertices, triangles[near & (of < first)], normals, render.GREY, zebra=True)
    if (of >= first).any():
        scene.mesh(vertices, triangles[near & (of >= first)], normals, render.CLAY, zebra=True)
    edges = {tuple(sorted(e)) for f in faces[first:] for e in zip(f, f[1:] + f[:1], strict=True)} if cage else ()
    for a, b in sorted(edges):
        scene.curve(points[[a, b]], (0.75, 0.15, 0.1), 1.2, 0.05)
    return scene.image(340, 320, center, span)


def draw(folder: pathlib.Path):
    read = np.load(os.environ["GALLERY_SUZANNE"])
    faces = [f.tolist() for f in np.split(read["cage_corners"], np.cumsum(read["cage_sizes"])[:-1])]
    jaw = cages.suzanne(read["vertices"].astype(float), faces)
    options = {"rim": jaw.rim(), "corners": jaw.corners(), "output": "cage"}
    fill = tripatch.fill(jaw.vertices, jaw.faces, replaced=jaw.gone, **options)
    center, view = jaw.vertices[options["rim"]].mean(0), (-50, -5)
    whole = picture(jaw.vertices, jaw.faces, len(jaw.faces), view, center, 1.5)
    images = [whole] + [
        picture(*cages.closed(jaw, jaw.left, fill), len(jaw.left), view, center, 1.5, cage=c) for c in (False, True)
    ]
    render.save(folder / "suzanne.png", images, ["before", "region replaced", "its cage"])

    corner = cages.cube_sphere(6, 2)
    images, center = [], np.ones(3) / np.sqrt(3)
    for name in ("smooth", "exact", "move"):
        fill = tripatch.fill(
            corner.vertices, corner.left, rim=corner.rim(), corners=corner.corners(), output="cage", cage_rim=name, resolution=0
        )
        images.append(
            picture(*cages.closed(corner, corner.left, fill), len(corner.left), (35, 30), center, 1.5, fill.creases, cage=False)
        )
    render.save(folder / "rims.png", images, ["Smooth", "Exact", "Move"])
