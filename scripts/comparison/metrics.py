"""What the comparison measures of a fill. Angles in degrees, distances over the diameter of the hole."""

from __future__ import annotations

import numpy as np

from .holes import Hole, unit


def angle(a, b):
    """Between unit vectors, exact for small angles too."""
    return np.degrees(2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1)))


def rms(values) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def order(errors) -> float:
    """Of convergence over densities that double: the slope of the least-squares line through all of them."""
    return float(-np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0])


def seam(patch, sides, samples=200) -> float:
    """The largest angle between the patch and the surroundings used: normals from exact derivatives, by atan2.

    The ends of a side count where the corner's two planes agree to 1e-6 degrees, else what lies outside 1% of the side.
    """
    ends = [side.evaluate(np.array([0.0, 1.0]))[3] for side in sides]
    agree = [angle(ends[(k + 1) % 3][1], ends[(k + 2) % 3][0]) <= 1e-6 for k in range(3)]
    largest = 0.0
    for i, side in enumerate(sides):
        t = np.linspace(0 if agree[(i + 1) % 3] else 0.01, 1 if agree[(i + 2) % 3] else 0.99, samples)
        b = np.zeros((samples, 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
        first = patch.evaluate(b, 1)[1]
        largest = max(largest, angle(unit(np.cross(first[:, 0], first[:, 1])), side.evaluate(t)[3]).max())
    return float(largest)


def surface_points(patch, count=10_000, rows=160) -> np.ndarray:
    """Points of a patch, uniform in its area: the parameter triangle in small triangles, each hit in proportion to its area."""
    p, q = np.array([(p, q) for q in range(rows + 1) for p in range(rows + 1 - q)]).T
    place = {(a, b): k for k, (a, b) in enumerate(zip(p.tolist(), q.tolist()))}
    b = np.stack([rows - p - q, p, q], 1) / rows
    x = patch.evaluate(b)
    triangles = []
    for (i, j), k in place.items():
        if i + j < rows:
            triangles.append((k, place[i + 1, j], place[i, j + 1]))
        if i + j < rows - 1:
            triangles.append((place[i + 1, j], place[i + 1, j + 1], place[i, j + 1]))
    triangles = np.array(triangles)
    u, v, w = x[triangles].swapaxes(0, 1)
    cumulative = np.cumsum(np.linalg.norm(np.cross(v - u, w - u), axis=1))
    k = np.arange(count)
    hit = np.searchsorted(cumulative, (k + 0.5) / count * cumulative[-1])
    r, s = (0.5 + k * 0.7548776662466927) % 1, (0.5 + k * 0.5698402909980532) % 1  # the R2 sequence
    r, s = np.where(r + s > 1, 1 - r, r), np.where(r + s > 1, 1 - s, s)
    at = (1 - r - s)[:, None] * b[triangles[hit, 0]] + r[:, None] * b[triangles[hit, 1]] + s[:, None] * b[triangles[hit, 2]]
    return patch.evaluate(at)


def distance(hole: Hole, points) -> float:
    """Rms distance to the true surface over the hole's diameter."""
    return rms(np.linalg.norm(hole.nearest(points) - points, axis=1)) / hole.diameter


def mesh_folds(vertices, faces) -> int:
    """Edges whose two triangles face more than 120 degrees apart."""
    owner = {(f[k], f[(k + 1) % 3]): i for i, f in enumerate(faces.tolist()) for k in range(3)}
    pairs = [(i, owner[b, a]) for (a, b), i in owner.items() if a < b and (b, a) in owner]
    u, v, w = vertices[faces].swapaxes(0, 1)
    normals = unit(np.cross(v - u, w - u))
    i, j = np.array(pairs).T
    return int(((normals[i] * normals[j]).sum(1) < -0.5).sum())


def limit_normals(vertices, faces, where) -> np.ndarray:
    """One-sided limit normals of a triangle mesh at some of its vertices, from its own vertices alone.

    A height field over the vertex's tangent plane through the vertex, a least-squares cubic (less where vertices are few) over
    the nearest rings with 20 vertices or more, fitted twice: the second time over the plane that the first one found.
    """
    neighbours = {}
    for f in faces.tolist():
        for k in range(3):
            neighbours.setdefault(f[k], set()).update((f[k - 1], f[k - 2]))
    guess = _vertex_normals(vertices, faces)
    out = np.empty((len(where), 3))
    for row, v in enumerate(np.asarray(where).tolist()):
        around, front = {v}, {v}
        for _ in range(4):
            front = {w for q in front for w in neighbours[q]} - around
            around |= front
            if len(around) > 20:
                break
        offsets = vertices[sorted(around - {v})] - vertices[v]
        normal = guess[v]
        for _ in range(2):
            normal = _fitted_normal(offsets, normal)
        out[row] = normal
    return out


def _fitted_normal(offsets, normal):
    x_axis = unit(np.cross(normal, [1.0, 0, 0] if abs(normal[0]) < 0.6 else [0, 1.0, 0]))
    y_axis = np.cross(normal, x_axis)
    x, y, z = offsets @ x_axis, offsets @ y_axis, offsets @ normal
    size = np.sqrt(np.mean(x * x + y * y))
    x, y, z = x / size, y / size, z / size
    columns = [x, y]
    if len(x) >= 6:
        columns += [x * x, x * y, y * y]
    if len(x) >= 12:
        columns += [x**3, x * x * y, x * y * y, y**3]
    weights = 1 / (0.3 + np.hypot(x, y))
    slope = np.linalg.lstsq(np.stack(columns, 1) * weights[:, None], z * weights, rcond=1e-9)[0]
    return unit(normal - slope[0] * x_axis - slope[1] * y_axis)


def _vertex_normals(vertices, faces):
    """Angle-weighted."""
    corners = vertices[faces]
    normals = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    out = np.zeros_like(vertices)
    for k in range(3):
        a, b = unit(corners[:, k - 2] - corners[:, k]), unit(corners[:, k - 1] - corners[:, k])
        np.add.at(out, faces[:, k], normals * np.radians(angle(a, b))[:, None])
    out[np.unique(faces)] = unit(out[np.unique(faces)])
    return out
