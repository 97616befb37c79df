"""Closed meshes with random holes: what the property tests and scripts/nightly fill. Everything follows from a seed."""

from __future__ import annotations

from collections import Counter

import numpy as np
from shapes import cube, cube_sphere

GOLDEN = (1 + 5**0.5) / 2


def icosahedron():
    p = np.array([q for a in (-1, 1) for b in (-GOLDEN, GOLDEN) for q in ((0, a, b), (a, b, 0), (b, 0, a))])
    near = np.isclose(np.linalg.norm(p[:, None] - p, axis=2), 2)
    triples = [(a, b, c) for a in range(12) for b in range(a) for c in range(b) if near[a, b] and near[b, c] and near[a, c]]
    return p, [list(t) if np.linalg.det(p[list(t)]) > 0 else list(t[::-1]) for t in triples]


def halved(points, triangles):
    """Every triangle in four."""
    points, middle = [*points], {}

    def between(a, b):
        key = (min(a, b), max(a, b))
        if key not in middle:
            middle[key] = len(points)
            points.append((points[a] + points[b]) / 2)
        return middle[key]

    faces = []
    for a, b, c in triangles:
        ab, bc, ca = between(a, b), between(b, c), between(c, a)
        faces += [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    return np.array(points), faces


def icosphere(times):
    points, faces = icosahedron()
    for _ in range(times):
        points, faces = halved(points, faces)
        points /= np.linalg.norm(points, axis=1)[:, None]
    return points, faces


def honeycomb(times):
    """The dual of a ball of triangles: hexagons, and twelve pentagons."""
    points, triangles = icosphere(times)
    left_of = {(t[k], t[k - 2]): f for f, t in enumerate(triangles) for k in range(3)}
    faces = []
    for v in range(len(points)):
        away = start = next(b for a, b in left_of if a == v)
        ring = []
        while not ring or away != start:
            f = left_of[v, away]
            ring.append(f)
            t = triangles[f]
            away = t[t.index(v) - 1]
        faces.append(ring)
    return points[np.array(triangles)].mean(axis=1), faces


def ring_mesh(n, m, thickness=0.4):
    """A torus of n x m quads."""
    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(m) * 2 * np.pi / m, indexing="ij")
    away = 1 + thickness * np.cos(v)
    points = np.stack([away * np.cos(u), away * np.sin(u), thickness * np.sin(v)], axis=-1).reshape(-1, 3)
    at = np.arange(n * m).reshape(n, m)
    quads = np.stack([at, np.roll(at, -1, 0), np.roll(at, (-1, -1), (0, 1)), np.roll(at, -1, 1)], axis=-1).reshape(-1, 4)
    return points, quads.tolist()


def cut_in_triangles(faces, rng):
    """Faces of more than three edges are cut along random diagonals."""
    out = []
    for face in faces:
        k = int(rng.integers(len(face)))
        turned = face[k:] + face[:k]
        out += [[turned[0], turned[j], turned[j + 1]] for j in range(1, len(face) - 1)]
    return out


SHAPES = {
    "icosphere": lambda rng: icosphere(int(rng.integers(1, 4))),
    "honeycomb": lambda rng: honeycomb(int(rng.integers(1, 4))),
    "ring": lambda rng: ring_mesh(int(rng.integers(6, 24)), int(rng.integers(4, 14))),
    "quads": lambda rng: cube_sphere(int(rng.integers(2, 9))),
    "box": lambda rng: cube(int(rng.integers(2, 8))),
}


def closed_mesh(rng, shape=None, spoil=None):
    """Points and faces, and in words what they are. spoil: what is done to the shape."""
    shape = shape or str(rng.choice(sorted(SHAPES)))
    points, faces = SHAPES[shape](rng)
    spoil = spoil or str(rng.choice(["none", "none", "triangles", "noise", "stretched", "bumps"]))
    if spoil in ("triangles", "noise"):
        faces = cut_in_triangles(faces, rng)
    if spoil == "noise":
        edge = np.linalg.norm(points[faces[0][0]] - points[faces[0][1]])
        points = points + edge * rng.choice([0.02, 0.1, 0.3]) * rng.normal(size=points.shape)
    if spoil == "stretched":
        points = points * rng.choice([1, 30, 1000], 3)
    if spoil == "bumps":
        points = points * (1 + 0.3 * np.sin(points @ rng.normal(0, 3, 3)))[:, None]
    return points, faces, f"{shape}, {spoil}"


def wavy_hole(rng, sides, rings=5):
    """A hole with smooth sides in a wavy surface of quads, or a round one (0); its rim comes first."""
    if sides == 0:
        count = int(rng.integers(8, 30))
        angle = (np.arange(count) + rng.uniform(-0.15, 0.15, count)) * 2 * np.pi / count
        rim = np.stack([np.cos(angle), 0.9 * np.sin(angle)], axis=1)
    else:
        angle = (np.arange(sides) + rng.uniform(-0.2, 0.2, sides)) * 2 * np.pi / sides
        corners = np.stack([np.cos(angle), np.sin(angle)], axis=1) * rng.uniform(0.8, 1.2, (sides, 1))
        rim = []
        for a, b in zip(corners, np.roll(corners, -1, axis=0)):
            count, bend = int(rng.integers(3, 10)), rng.uniform(0.25, 0.5) if sides == 2 else rng.uniform(-0.1, 0.1)
            t = np.arange(count)[:, None] / count
            rim.append(a + t * (b - a) + 4 * bend * t * (1 - t) * [b[1] - a[1], a[0] - b[0]])
        rim = np.concatenate(rim)
    count = len(rim)
    away = 1 + np.arange(rings + 1)[:, None, None] * 2 * np.pi / count
    plane = (rim.mean(axis=0) + away * (rim - rim.mean(axis=0))).reshape(-1, 2)
    height = 0.15 * np.sin(plane @ rng.normal(0, 0.8, (2, 3)) + rng.uniform(0, 6, 3)).sum(axis=1)
    at = np.arange(count)
    ring = np.stack([at, at + count, np.roll(at, -1) + count, np.roll(at, -1)], axis=1)
    return np.column_stack([plane, height]), np.concatenate([ring + k * count for k in range(rings)]).tolist()


def as_seen(points, faces, look, rng):
    """The mesh in a mirror, or its vertices and faces numbered in another order; and the number that each vertex has there."""
    number = np.arange(len(points))
    if look == "mirrored":
        return points * [-1, 1, 1], [face[::-1] for face in faces], number
    if look == "relabelled":
        number = rng.permutation(len(points))
        faces = [[int(number[v]) for v in np.roll(face, int(rng.integers(len(face))))] for face in faces]
        rng.shuffle(faces)
        return points[np.argsort(number)], faces, number
    return points, faces, number


def directed(faces):
    return Counter((int(a), int(b)) for face in faces for a, b in zip(face, [*face[1:], face[0]]))


def with_hole(faces, rng, share=None):
    """The faces without a random connected region of them; a vertex or more of every face left is one of the region's no more."""
    at_edge = {(face[k], face[(k + 1) % len(face)]): f for f, face in enumerate(faces) for k in range(len(face))}
    wanted = max(1, int(len(faces) * (share if share is not None else rng.uniform(0, 0.5) ** 2)))
    first = int(rng.integers(len(faces)))
    gone, front = {first}, [first]
    ragged = rng.random() < 0.5
    while front and len(gone) < wanted:
        f = front.pop(int(rng.integers(len(front))) if ragged else 0)
        for k in range(len(faces[f])):
            other = at_edge.get((faces[f][(k + 1) % len(faces[f])], faces[f][k]))
            if other is not None and other not in gone and len(gone) < wanted:
                gone.add(other)
                front.append(other)
        if ragged and any(
            at_edge.get((faces[f][(k + 1) % len(faces[f])], faces[f][k])) not in gone for k in range(len(faces[f]))
        ):
            front.append(f)
    return [face for f, face in enumerate(faces) if f not in gone]


def is_manifold(faces):
    """Every edge has two faces at most, in opposite directions."""
    return max(directed(faces).values(), default=0) <= 1


def turned(rng):
    """A random rotation."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else q[:, [1, 0, 2]]


def hole_size(points, rim):
    p = points[rim]
    return float(np.linalg.norm(p[:, None] - p, axis=2).max())
