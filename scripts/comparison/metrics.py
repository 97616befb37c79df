"""What the comparison measures of a fill. Angles in degrees, distances over the diameter of the hole."""

from __future__ import annotations

import numpy as np

from .holes import Hole, lattice_triangles, unit


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


def curvature_jump(patch, sides, samples=99) -> float:
    """The largest difference of the normal curvatures of patch and surroundings across a side, outside 1% of it, over the largest
    of the surroundings along and across all sides."""
    t = np.linspace(0.01, 0.99, samples)
    jumps, sizes = [], []
    for i, side in enumerate(sides):
        b = np.zeros((samples, 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
        _, first, second = patch.evaluate(b, 2)
        _, along, r, normal = side.evaluate(t)
        d = np.stack([np.linalg.lstsq(f.T, x, rcond=None)[0] for f, x in zip(first, r)])  # r in the patch's own derivatives
        theirs = (side.second_derivative(t) * normal).sum(1)
        ours = np.einsum("nk,nkd,nd->n", np.stack([d[:, 0] ** 2, 2 * d[:, 0] * d[:, 1], d[:, 1] ** 2], 1), second, normal)
        jumps.append(np.abs(ours - theirs) / (r * r).sum(1))
        sizes.append(np.abs(theirs) / (r * r).sum(1))
        sizes.append(np.abs((np.gradient(normal, t, axis=0) * along).sum(1)) / (along * along).sum(1))
    return float(np.max(jumps) / np.max(sizes))


def surface_points(patch, count=10_000, rows=160) -> np.ndarray:
    """Points of a patch, uniform in its area: the parameter triangle in small triangles, each hit in proportion to its area."""
    p, q = np.array([(p, q) for q in range(rows + 1) for p in range(rows + 1 - q)]).T
    place = {(a, b): k for k, (a, b) in enumerate(zip(p.tolist(), q.tolist()))}
    b = np.stack([rows - p - q, p, q], 1) / rows
    triangles = lattice_triangles(place)
    hit, weights = spread(patch.evaluate(b)[triangles], count)
    return patch.evaluate(np.einsum("nk,nkd->nd", weights, b[triangles[hit]]))


def spread(triangles, count=10_000):
    """Places uniform in the area of triangles (m, 3, 3): which triangle, and the weights of its corners."""
    u, v, w = triangles.swapaxes(0, 1)
    cumulative = np.cumsum(np.linalg.norm(np.cross(v - u, w - u), axis=1))
    k = np.arange(count)
    hit = np.searchsorted(cumulative, (k + 0.5) / count * cumulative[-1])
    r, s = (0.5 + k * 0.7548776662466927) % 1, (0.5 + k * 0.5698402909980532) % 1  # the R2 sequence
    r, s = np.where(r + s > 1, 1 - r, r), np.where(r + s > 1, 1 - s, s)
    return hit, np.stack([1 - r - s, r, s], 1)


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
    """One-sided limit normals of a triangle mesh at some of its vertices, from its own vertices alone."""
    return _fits(vertices, faces, where)[0]


def mean_curvature(vertices, faces) -> np.ndarray:
    """At the vertices of a triangle mesh by the same fits, positive where it bends towards its normals; NaN at other vertices."""
    used = np.unique(faces)
    slopes = _fits(vertices, faces, used)[1]
    fx, fy, fxx, fxy, fyy = slopes.T
    out = np.full(len(vertices), np.nan)
    out[used] = ((1 + fy**2) * fxx - 2 * fx * fy * fxy + (1 + fx**2) * fyy) / (2 * (1 + fx**2 + fy**2) ** 1.5)
    return out


def roughness(vertices, faces) -> float:
    """Integral of the squared gradient of mean curvature, linear on each triangle."""
    curvature = mean_curvature(vertices, faces)[faces]
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.maximum(np.linalg.norm(normals, axis=1), 1e-300)
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    along = (curvature[:, :, None] * opposite).sum(1)  # the gradient is this, turned in the plane, over twice the area
    return float(((along**2).sum(1) / doubled / 2).sum())


def _fits(vertices, faces, where):
    """Unit normals, and the first and second derivatives (xx, xy, yy) of the height over the plane at a right angle to them.

    A height field over the vertex's tangent plane through the vertex, a least-squares cubic (less where vertices are few) over
    the nearest rings with 20 vertices or more, fitted twice: the second time over the plane that the first one found.
    """
    neighbors = {}
    for f in faces.tolist():
        for k in range(3):
            neighbors.setdefault(f[k], set()).update((f[k - 1], f[k - 2]))
    by_count = {}  # vertices with as many others around are fitted at once
    for row, v in enumerate(np.asarray(where).tolist()):
        around, front = {v}, {v}
        for _ in range(4):
            front = {w for q in front for w in neighbors[q]} - around
            around |= front
            if len(around) > 20:
                break
        by_count.setdefault(len(around), []).append((row, v, sorted(around - {v})))
    guess = _vertex_normals(vertices, faces)
    normals, slopes = np.empty((len(where), 3)), np.empty((len(where), 5))
    for group in by_count.values():
        at, center, around = (np.array(part) for part in zip(*group))
        offsets, normals[at] = vertices[around] - vertices[center][:, None], guess[center]
        for _ in range(2):
            normals[at], slopes[at] = _fit(offsets, normals[at])
    return normals, slopes


def _fit(offsets, normals):
    """Better normals, and the derivatives of the heights over the planes of the given ones: (m, k, 3) and (m, 3)."""
    x_axes = unit(np.cross(normals, np.where(np.abs(normals[:, :1]) < 0.6, [1.0, 0, 0], [0, 1.0, 0])))
    y_axes = np.cross(normals, x_axes)
    x, y, z = np.einsum("mkd,amd->amk", offsets, np.stack([x_axes, y_axes, normals]))
    size = np.sqrt(np.mean(x * x + y * y, axis=1, keepdims=True))
    x, y, z = x / size, y / size, z / size
    columns = [x, y]
    if x.shape[1] >= 6:
        columns += [x * x / 2, x * y, y * y / 2]
    if x.shape[1] >= 12:
        columns += [x**3, x * x * y, x * y * y, y**3]
    weights = 1 / (0.3 + np.hypot(x, y))
    slopes = np.zeros((len(x), 5))
    inverse = np.linalg.pinv(np.stack(columns, -1) * weights[..., None], rcond=1e-9)
    found = np.einsum("mck,mk->mc", inverse, z * weights)[:, :5]
    slopes[:, : found.shape[1]] = found
    return unit(normals - slopes[:, :1] * x_axes - slopes[:, 1:2] * y_axes), slopes / np.hstack([size**0] * 2 + [size] * 3)


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
