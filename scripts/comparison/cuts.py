"""Holes cut out of triangle meshes, which are their truth; and CAD-like bodies to cut them out of. Any seed makes other ones."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from known_holes import inside, scattered
from scipy.spatial import Delaunay, cKDTree

from .holes import Hole, unit

SIZES = (8, 25, 70, 180)  # triangles that are taken out
SPACING = 0.08  # of the vertices of bodies whose outline has radius 1


class MeshTruth:
    """Nearest points of triangles, exactly: trees of their centers by size, as a large one is nearer than its center."""

    def __init__(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        self.corners = vertices[faces]
        centers = self.corners.mean(1)
        radii = np.linalg.norm(self.corners - centers[:, None], axis=2).max(1)
        self.normals = facet_normals(vertices, faces)
        size = np.floor(np.log2(np.maximum(radii, 1e-9 * radii.max()))).astype(int)
        self.classes = [
            (own, cKDTree(centers[own]), radii[own].max()) for s in np.unique(size) for own in [np.flatnonzero(size == s)]
        ]

    def find(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The nearest points (k, 3), and the triangles that they are on (k,)."""
        best, least, owner = np.empty_like(points), np.full(len(points), np.inf), np.zeros(len(points), int)
        for own, tree, radius in self.classes:
            left, first, count = np.arange(len(points)), 0, min(8, len(own))
            while len(left):
                away, at = tree.query(points[left], range(first + 1, count + 1))
                for k in range(at.shape[1]):
                    found = _nearest_on_each(points[left], *self.corners[own[at[:, k]]].swapaxes(0, 1))
                    distance = np.linalg.norm(found - points[left], axis=1)
                    nearer = distance < least[left]
                    rows = left[nearer]
                    best[rows], least[rows], owner[rows] = found[nearer], distance[nearer], own[at[nearer, k]]
                left = left[away[:, -1] - radius < least[left]] if count < len(own) else left[:0]
                first, count = count, min(2 * count, len(own))
        return best, owner

    def nearest(self, points: np.ndarray) -> np.ndarray:
        return self.find(points)[0]

    def facets(self, points: np.ndarray) -> np.ndarray:
        return self.normals[self.find(points)[1]]


def _nearest_on_each(p, a, b, c):
    """The nearest point of each triangle to its own p: its foot in the plane if that lies inside, else the best of the edges."""
    u, v, w = b - a, c - a, p - a
    uu, uv, vv = (u * u).sum(1), (u * v).sum(1), (v * v).sum(1)
    det = np.maximum(uu * vv - uv * uv, 1e-300)
    s = ((w * u).sum(1) * vv - (w * v).sum(1) * uv) / det
    t = ((w * v).sum(1) * uu - (w * u).sum(1) * uv) / det
    best = a + s[:, None] * u + t[:, None] * v
    distance = np.where((s >= 0) & (t >= 0) & (s + t <= 1), ((best - p) ** 2).sum(1), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        e = end - start
        f = np.clip(((p - start) * e).sum(1) / np.maximum((e * e).sum(1), 1e-300), 0, 1)
        q = start + f[:, None] * e
        d = ((q - p) ** 2).sum(1)
        nearer = d < distance
        best[nearer], distance[nearer] = q[nearer], d[nearer]
    return best


def facet_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = vertices[faces].swapaxes(0, 1)
    normal = np.cross(b - a, c - a)
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)


def halfedges(faces: np.ndarray) -> dict[tuple[int, int], int]:
    """Directed edge -> its face."""
    return {(f[k], f[(k + 1) % 3]): i for i, f in enumerate(faces.tolist()) for k in range(3)}


def grown(faces, owner, middles, first: int, count: int) -> list[int]:
    """Connected faces around one, those first whose centers are nearest to its own."""
    seen, taken, front = {first}, [], [(0.0, first)]
    while front and len(taken) < count:
        face = heapq.heappop(front)[1]
        taken.append(face)
        a, b, c = faces[face].tolist()
        for edge in ((b, a), (c, b), (a, c)):
            other = owner.get(edge)
            if other is not None and other not in seen:
                seen.add(other)
                heapq.heappush(front, (float(np.linalg.norm(middles[other] - middles[first])), other))
    return taken


def cut(name: str, vertices: np.ndarray, faces: np.ndarray, owner: dict, gone: list[int], truth: MeshTruth) -> Hole | None:
    """The mesh without some faces; None if that leaves anything but one simple loop. owner: of its halfedges."""
    kept = np.ones(len(faces), bool)
    kept[gone] = False
    directed = [(f[k], f[(k + 1) % 3]) for f in faces[gone].tolist() for k in range(3)]
    if any((b, a) not in owner for a, b in directed):
        return None  # it is at a border
    edges = [(a, b) for a, b in directed if kept[owner[b, a]]]
    follow = dict(edges)
    if not edges or len(follow) < len(edges):
        return None
    loop = [edges[0][0]]
    while follow.get(loop[-1], loop[0]) != loop[0] and len(loop) < len(edges):
        loop.append(follow[loop[-1]])
    used, index = np.unique(faces[kept], return_inverse=True)
    if len(loop) != len(edges) or not np.isin(loop, used).all():
        return None
    beyond = truth.normals[[owner[edge] for edge in zip(loop, [*loop[1:], loop[0]])]]
    rim = np.searchsorted(used, loop)
    return Hole(
        name, vertices[used], index.reshape(-1, 3), rim, nearest=truth.nearest, facets=truth.facets, beyond=beyond
    )  # fmt: skip


def cuts(name: str, vertices: np.ndarray, faces: np.ndarray, rng, sizes=SIZES, sharp=False) -> Iterator[Hole]:
    """A hole of each size; with `sharp` every other one at an edge of more than 37 degrees, if there is one."""
    truth, owner, middles = MeshTruth(vertices, faces), halfedges(faces), vertices[faces].mean(1)
    bent = sorted({i for (a, b), i in owner.items() if (b, a) in owner and truth.normals[i] @ truth.normals[owner[b, a]] < 0.8})
    for k, size in enumerate(sizes):
        for _ in range(50):
            first = rng.choice(bent) if sharp and bent and k % 2 == 0 else rng.integers(len(faces))
            hole = cut(f"{name} {size}", vertices, faces, owner, grown(faces, owner, middles, int(first), size), truth)
            if hole and size < len(faces) / 3:
                hole.mesh = name
                yield hole
                break


# ------------------------------------------------------------------------------------------------------------ CAD-like bodies


@dataclass
class _Corner:
    """Of a polygon: sharp where `start` and `end` are the same point, else an arc between them by `turn` radians."""

    start: np.ndarray
    end: np.ndarray
    center: np.ndarray
    turn: float = 0.0

    def points(self, spacing: float) -> np.ndarray:
        if not self.turn:
            return self.start[None]
        arm = self.start - self.center
        radius = float(np.linalg.norm(arm))
        angle = self.turn * np.linspace(0, 1, max(3, round(self.turn * radius / spacing) + 1))
        side = radius * unit(self.end - self.center - ((self.end - self.center) @ unit(arm)) * unit(arm))
        return self.center + np.cos(angle)[:, None] * arm + np.sin(angle)[:, None] * side

    def distance(self, points: np.ndarray) -> np.ndarray:
        """From each point to the arc; infinite where an end is nearest, which is a point of a straight line too."""
        away, middle = points - self.center, unit(self.start + self.end - 2 * self.center)
        long = np.linalg.norm(away, axis=1)
        faces_it = away @ middle >= np.cos(self.turn / 2) * long
        return np.where(faces_it, np.abs(long - np.linalg.norm(self.start - self.center)), np.inf)


def _corners(rng: np.random.Generator) -> list[_Corner]:
    """Of a convex polygon, sharp or rounded."""
    n = rng.integers(4, 8)
    angle = 2 * np.pi * (np.arange(n) + rng.uniform(-0.25, 0.25, n)) / n
    corners, made = np.column_stack([np.cos(angle), np.sin(angle)]), []
    for before, at, after in zip(np.roll(corners, 1, 0), corners, np.roll(corners, -1, 0)):
        away = [unit(p - at) for p in (before, after)]
        cut_off = rng.uniform(0.2, 0.4) * min(np.linalg.norm(p - at) for p in (before, after)) if rng.random() < 0.5 else 0.0
        if not cut_off:
            made.append(_Corner(at, at, at))
            continue
        half = np.arccos(np.clip(away[0] @ away[1], -1, 1)) / 2
        center = at + unit(away[0] + away[1]) * np.hypot(cut_off, cut_off * np.tan(half))
        made.append(_Corner(at + cut_off * away[0], at + cut_off * away[1], center, np.pi - 2 * half))
    return made


def _subdivided(points: np.ndarray, spacing: float) -> np.ndarray:
    """A closed line in steps of about the spacing."""
    pieces = []
    for p, q in zip(points, np.roll(points, -1, 0)):
        m = max(1, round(float(np.linalg.norm(q - p)) / spacing))
        pieces.append(p + (q - p) * (np.arange(m) / m)[:, None])
    return np.concatenate(pieces)


def _outline_and_distance(rng: np.random.Generator) -> tuple[np.ndarray, Callable]:
    """Of a polygon with sharp and rounded corners: points on it, and the signed distance to it, negative inside."""
    corners = _corners(rng)
    points = np.concatenate([corner.points(SPACING) for corner in corners])
    fine = np.concatenate([corner.points(SPACING / 40) for corner in corners])
    starts, ends = (np.array([getattr(corner, name) for corner in corners]) for name in ("end", "start"))
    step = np.roll(ends, -1, 0) - starts  # the straight lines from each corner to the next

    def distance(points):
        away = points[:, None] - starts
        share = np.clip((away * step).sum(2) / (step * step).sum(1), 0, 1)
        least = np.linalg.norm(away - share[..., None] * step, axis=2).min(1)
        for corner in corners:
            if corner.turn:
                least = np.minimum(least, corner.distance(points))
        return np.where(inside(fine, points), -least, least)

    return _subdivided(points, SPACING), distance


def prism(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, Callable]:
    """A polygon with sharp and rounded corners, extruded, of irregular triangles: vertices, faces and the distance to it."""
    ring, outline = _outline_and_distance(rng)
    spacing = SPACING
    n, inner = len(ring), scattered(spacing, rng)
    inner = inner[inside(ring, inner) & (cKDTree(ring).query(inner)[0] > 0.6 * spacing)]
    flat = np.concatenate([ring, inner])
    lid = Delaunay(flat).simplices
    a, b, c = (flat[lid[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    lid = np.where(area[:, None] > 0, lid, lid[:, ::-1])[(np.abs(area) > 1e-9) & inside(ring, flat[lid].mean(1))]
    height = rng.uniform(0.5, 1.2)
    rows = max(2, round(height / spacing))
    levels = height * np.arange(rows + 1) / rows
    z = np.repeat(levels, n).reshape(rows + 1, n)
    z[1:-1] += spacing * rng.uniform(-0.25, 0.25, (rows - 1, n))
    wall = np.column_stack([np.tile(ring, (rows + 1, 1)), z.ravel()])
    walls = _grid_faces(rows, n, rng)
    bottom, top = np.column_stack([inner, np.zeros(len(inner))]), np.column_stack([inner, np.full(len(inner), height)])
    vertices = np.concatenate([wall, bottom, top])
    count = len(wall)
    below = np.where(lid < n, lid, lid - n + count)[:, ::-1]
    above = np.where(lid < n, lid + rows * n, lid - n + count + len(inner))

    def distance(points):
        across, along = outline(points[:, :2]), np.abs(points[:, 2] - height / 2) - height / 2
        return np.abs(np.minimum(np.maximum(across, along), 0) + np.hypot(np.maximum(across, 0), np.maximum(along, 0)))

    return vertices, np.concatenate([walls, below, above]), distance


def _grid_faces(rows: int, n: int, rng, closed=False) -> np.ndarray:
    """Triangles of rows of quads around an axis, their diagonals at random."""
    faces = []
    for i in range(rows):
        for j in range(n):
            up, k = (i + 1) % rows if closed else i + 1, (j + 1) % n
            a, b, c, d = i * n + j, i * n + k, up * n + k, up * n + j
            faces += [(a, b, c), (a, c, d)] if rng.random() < 0.5 else [(a, b, d), (b, c, d)]
    return np.array(faces)


def flange(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, Callable]:
    """A profile with sharp and rounded corners, turned about an axis: planes, cylinders, cones and parts of tori."""
    size, radius = 0.35, 0.9
    profile, outline = _outline_and_distance(rng)
    profile = profile * size + [radius, 0]
    n, m = round(2 * np.pi * radius / SPACING), len(profile)
    angle = 2 * np.pi * (np.arange(n) + rng.uniform(-0.25, 0.25, (m, n))) / n
    r, z = (np.repeat(profile[:, k], n).reshape(m, n) for k in (0, 1))
    vertices = np.stack([r * np.cos(angle), r * np.sin(angle), z], -1).reshape(-1, 3)

    def distance(points):
        return size * np.abs(
            outline((np.column_stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]]) - [radius, 0]) / size)
        )

    return vertices, _grid_faces(m, n, rng, closed=True), distance


def bodies(seed: int, count: int) -> Iterator[Hole]:
    """Holes of four sizes in each of some bodies."""
    rng = np.random.default_rng(seed)
    for k in range(count):
        make = (prism, flange)[k % 2]
        vertices, faces, distance = make(rng)
        for hole in cuts(f"{make.__name__} {k // 2}", vertices, faces, rng, sharp=True):
            hole.nearest, hole.facets, hole.distance = None, None, distance
            yield hole
