"""Cages with a region to be replaced, of which the gallery and the guide draw fills."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import tripatch
from tripatch import _arrays, _native


@dataclass
class Cage:
    name: str
    vertices: np.ndarray
    faces: list
    gone: list  # faces of the region
    radius: float | None = None  # of a sphere that the limit surface lies on

    @property
    def left(self):
        removed = set(self.gone)
        return [face for f, face in enumerate(self.faces) if f not in removed]

    def rim(self):
        outside = {v for f in self.left for v in f}
        inside = {v for f in self.gone for v in self.faces[f]}
        return next(r for r in tripatch.find_holes(self.left) if set(r.tolist()) <= inside & outside)

    def corners(self):
        """Of rings of quads round a vertex of three: where three faces stay outside, a third of the rim apart."""
        rim = self.rim().tolist()
        third = len(rim) // 3
        for k in range(third):
            three = rim[k::third]
            if all(sum(v in face for face in self.left) >= 3 for v in three):
                return three
        raise ValueError("the region is not three-sided")


def cube_grid(n, place):
    """A cube of n x n quads a side, its vertices p (the largest coordinate 1) at place(p)."""
    vertices, index, faces = [], {}, []

    def vertex(p):
        key = tuple(np.round(p, 9))
        if key not in index:
            index[key] = len(vertices)
            vertices.append(place(np.asarray(p)))
        return index[key]

    grid = np.linspace(-1, 1, n + 1)
    for axis in range(3):
        for sign in (-1, 1):
            for i in range(n):
                for j in range(n):
                    quad = []
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        p = np.zeros(3)
                        p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = sign, grid[a], grid[b]
                        quad.append(vertex(p))
                    faces.append(quad if sign > 0 else quad[::-1])
    return np.array(vertices), faces


def around(vertex, faces, rings):
    near, gone = {vertex}, set()
    for _ in range(rings):
        gone |= {f for f, face in enumerate(faces) if near & set(face)}
        near = {v for f in gone for v in faces[f]}
    return sorted(gone)


def cube_sphere(n, rings, on_limit=True):
    """on_limit: the vertices' limit points, else the vertices, lie on the unit sphere."""
    vertices, faces = cube_grid(n, lambda p: p / np.linalg.norm(p))
    wanted = vertices.copy()
    for _ in range(40 if on_limit else 0):
        vertices = vertices + wanted - _native.limit_points(*_arrays.mesh(vertices, faces))
    gone = around(int(np.argmax(vertices @ np.ones(3))), faces, rings)
    return Cage(f"cube-sphere {n}, {rings} rings", vertices, faces, gone, 1.0 if on_limit else None)


def suzanne(vertices, faces, rings=3):
    """Three rings round the vertex of three quads at the jaw."""
    valence = np.bincount(np.concatenate([np.array(face) for face in faces]), minlength=len(vertices))
    at = np.linalg.norm(vertices - [0.33, -0.4, -0.91], axis=1) + 10 * (valence != 3)
    return Cage("Suzanne's jaw", vertices, faces, around(int(np.argmin(at)), faces, rings))


def closed(cage, faces, fill):
    points = np.concatenate([cage.vertices, fill.vertices])
    points[fill.moved[0]] = fill.moved[1]
    return points, [list(face) for face in [*faces, *fill.faces]]
