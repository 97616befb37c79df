"""Meshes and cages that several tests use."""

from itertools import pairwise

import numpy as np


class Vertices:
    """Numbers points; those that are the same to 1e-9 are one."""

    def __init__(self):
        self.points, self._index = [], {}

    def __call__(self, p):
        key = tuple(np.round(p, 9))
        if key not in self._index:
            self._index[key] = len(self.points)
            self.points.append(np.asarray(p, float))
        return self._index[key]


def cube(n):
    """A cube of n x n quads a side, from -1 to 1."""
    vertex, faces = Vertices(), []
    grid = np.linspace(-1, 1, n + 1)
    for axis in range(3):
        for sign in (-1, 1):
            for i in range(n):
                for j in range(n):
                    quad = []
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        p = np.zeros(3)
                        p[axis], p[axis - 2], p[axis - 1] = sign, grid[a], grid[b]
                        quad.append(vertex(p))
                    faces.append(quad if sign > 0 else quad[::-1])
    return np.array(vertex.points), faces


def cube_sphere(n):
    """The same blown up to the unit sphere."""
    points, faces = cube(n)
    return np.array([p / np.linalg.norm(p) for p in points]), faces


def corner_removed(vertices, faces, rings):
    """The faces within some rings of the cube corner (1, 1, 1) taken out; they are returned as indices too."""
    corner = int(np.argmax(vertices @ np.ones(3)))
    near, gone = {corner}, set()
    for _ in range(rings):
        gone |= {f for f, face in enumerate(faces) if near & set(face)}
        near = {v for f in gone for v in faces[f]}
    return [face for f, face in enumerate(faces) if f not in gone], sorted(gone)


def octant(n=8, rings=3):
    """A unit sphere's octant open, with rings of triangles around it, and the rim from (1, 0, 0) on."""
    index, vertices, faces = {}, [], []

    def vertex(i, j, k):
        if (i, j, k) not in index:
            p = np.array([i, j, k], float)
            index[i, j, k] = len(vertices)
            vertices.append(p / np.linalg.norm(p))
        return index[i, j, k]

    # barycentric lattice i + j + k = n continued outwards by `rings`: the octant's own triangles are left out
    low = -rings
    for i in range(low, n - 2 * low + 1):
        for j in range(low, n - 2 * low + 1 - (i - low)):
            k = n - i - j
            if k < low:
                continue
            for tri in (((i, j, k), (i - 1, j + 1, k), (i - 1, j, k + 1)), ((i, j, k), (i - 1, j, k + 1), (i, j - 1, k + 1))):
                if all(min(p) >= low for p in tri) and not all(min(p) >= 0 for p in tri):
                    faces.append([vertex(*p) for p in tri])
    rim = (
        [vertex(n - m, m, 0) for m in range(n)]
        + [vertex(0, n - m, m) for m in range(n)]
        + [vertex(m, 0, n - m) for m in range(n)]
    )
    return np.array(vertices), faces, rim


def bevelled_corner(segments, width=0.2):
    """The corner (1, 1, 1) of a cube of 1 whose three edges there are bevelled round: strips of long quads, and the hole
    where they meet. Vertices, faces, rim and corners."""
    vertex, faces = Vertices(), []
    axes, angles = np.eye(3), np.linspace(0, np.pi / 2, segments + 1)
    arcs = [[1 - width + width * (np.cos(a) * axes[k] + np.sin(a) * axes[k - 2]) for a in angles] for k in range(3)]
    for k, near in enumerate(arcs):
        far = [p * (1 - axes[k - 1]) for p in near]
        faces += [[vertex(p) for p in (b, a, c, d)] for (a, b), (c, d) in zip(pairwise(near), pairwise(far))]
        faces.append([vertex(p) for p in (np.zeros(3), axes[k - 2], *far[::-1], axes[k])])
    for k in range(3):  # what is left of the flat side across axis k
        along, across = (1 - width) * axes[k - 2], (1 - width) * axes[k - 1]
        faces.append([vertex(p) for p in (axes[k], axes[k] + along, axes[k] + along + across, axes[k] + across)])
    return np.array(vertex.points), faces, [vertex(p) for arc in arcs for p in arc[:-1]], [vertex(arc[0]) for arc in arcs]


def bevelled_cylinder(walls=24, segments=3, bevel=0.15):
    """Of radius 1 and height 2, its two edges rounded: rings of quads from the top down, then the top and the bottom."""
    turn = np.linspace(0, np.pi / 2, segments + 1)
    half = [*zip(1 - bevel + bevel * np.sin(turn), 1 - bevel + bevel * np.cos(turn), strict=True)]
    profile = half + [(r, -z) for r, z in reversed(half)]
    around = 2 * np.pi * np.arange(walls) / walls
    points = np.array([(r * np.cos(a), r * np.sin(a), z) for r, z in profile for a in around])
    faces = [
        [i * walls + j, (i + 1) * walls + j, (i + 1) * walls + (j + 1) % walls, i * walls + (j + 1) % walls]
        for i in range(len(profile) - 1)
        for j in range(walls)
    ]
    last = (len(profile) - 1) * walls
    return points, [*faces, list(range(walls)), list(range(last, last + walls))[::-1]]
