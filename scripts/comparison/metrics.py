"""What HoleBench measures of a fill. Angles in degrees, distances over the diameter of the hole."""

from __future__ import annotations

import numpy as np

from .cuts import facet_normals, halfedges
from .holes import Hole, unit

POINTS, NORMALS = 2000, 500  # of a fill that are compared with the truth
MOST_CROSSED = 4000  # triangles of a fill up to which its crossings are counted
TOUCHING = 1e-6  # of the hole: what passes by less touches


def angle(a, b):
    """Between unit vectors, exact for small angles too."""
    return np.degrees(2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1)))


def rms(values) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def spread(triangles, count=10_000):
    """Places uniform in the area of triangles (m, 3, 3): which triangle, and the weights of its corners."""
    u, v, w = triangles.swapaxes(0, 1)
    cumulative = np.cumsum(np.linalg.norm(np.cross(v - u, w - u), axis=1))
    k = np.arange(count)
    hit = np.searchsorted(cumulative, (k + 0.5) / count * cumulative[-1])
    r, s = (0.5 + k * 0.7548776662466927) % 1, (0.5 + k * 0.5698402909980532) % 1  # the R2 sequence
    r, s = np.where(r + s > 1, 1 - r, r), np.where(r + s > 1, 1 - s, s)
    return hit, np.stack([1 - r - s, r, s], 1)


def true_normals(hole: Hole, points: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Unit normals of the truth near points: of its facets, or the gradient of the distance to it a little way along `like`,
    on the same side as that."""
    if hole.facets:
        return hole.facets(points)
    away = 1e-3 * hole.diameter
    places, step = points + away * like, 0.1 * away * np.eye(3)
    normals = unit(np.stack([hole.distance(places + s) - hole.distance(places - s) for s in step], -1))
    return normals * np.where((normals * like).sum(1, keepdims=True) < 0, -1, 1)  # a point beyond the surface sees it from there


def seam(hole: Hole, vertices, faces) -> np.ndarray:
    """Angles along the rim to the true tangent planes: of limit normals at its vertices if the truth is smooth, else of the new
    triangles at its edges to the facets of the truth that were there."""
    if hole.normals is not None:
        met = hole.rim[np.isin(hole.rim, faces)]  # a fill may leave vertices of the rim out: `open_edges` counts that
        return angle(limit_normals(vertices, faces, met), hole.normals[met])
    owner = halfedges(faces)
    edges = list(zip(hole.rim.tolist(), np.roll(hole.rim, -1).tolist()))
    here = [k for k, edge in enumerate(edges) if edge in owner]
    normals = facet_normals(vertices, faces)[[owner[edges[k]] for k in here]]
    return angle(normals, hole.beyond[here]) if hole.beyond is not None else np.zeros(0)


def open_edges(hole: Hole, faces) -> int:
    """Edges of the rim without a new face, and borders and triple edges of the fill elsewhere."""
    rim = set(zip(hole.rim.tolist(), np.roll(hole.rim, -1).tolist()))
    directed = [(f[k], f[(k + 1) % 3]) for f in faces.tolist() for k in range(3)]
    given = set(directed)
    return len(rim - given) + sum((b, a) not in given for a, b in given - rim) + len(directed) - len(given)


def folds(vertices, faces) -> int:
    """Edges whose two triangles face more than 120 degrees apart."""
    owner, normals = halfedges(faces), facet_normals(vertices, faces)
    pairs = [(i, owner[b, a]) for (a, b), i in owner.items() if a < b and (b, a) in owner]
    i, j = np.array(pairs, int).reshape(-1, 2).T
    return int(((normals[i] * normals[j]).sum(1) < -0.5).sum())


def crossings(vertices, new, old, size: float) -> int:
    """Pairs of an edge and a triangle without a vertex in common that go through each other, one of them new."""
    low, high = vertices[new].min((0, 1)), vertices[new].max((0, 1))
    corners = vertices[old]
    old = old[((corners.max(1) >= low) & (corners.min(1) <= high)).all(1)]

    def edges(faces):
        return np.unique(np.sort(np.concatenate([faces[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1), axis=0)

    inner = edges(new)
    return _pierced(vertices, inner, np.concatenate([new, old]), size) + _pierced(vertices, edges(old), new, size)


def _pierced(vertices, edges, triangles, size: float) -> int:
    near, count = TOUCHING * size, 0
    ends, corners = vertices[edges], vertices[triangles]
    low, high = corners.min(1), corners.max(1)
    normals = facet_normals(vertices, triangles)
    for part in np.array_split(np.arange(len(edges)), max(1, len(edges) * len(triangles) // 2_000_000)):
        e_low, e_high = ends[part].min(1)[:, None], ends[part].max(1)[:, None]
        e, t = np.nonzero(((e_low <= high) & (e_high >= low)).all(2))
        e = part[e]
        apart = ~(edges[e][:, :, None] == triangles[t][:, None]).any((1, 2))
        e, t = e[apart], t[apart]
        p, q, n = ends[e, 0], ends[e, 1], normals[t]
        over, under = (((x - corners[t, 0]) * n).sum(1) for x in (p, q))
        at = p + (over / np.where(over == under, 1, over - under))[:, None] * (q - p)
        hit = (over * under < 0) & (np.minimum(abs(over), abs(under)) > near)
        for k in range(3):
            side = corners[t, (k + 1) % 3] - corners[t, k]
            hit &= (np.cross(side, at - corners[t, k]) * n).sum(1) > near * np.linalg.norm(side, axis=1)
        count += int(hit.sum())
    return count


def calibration(errors, deviations) -> dict:
    """Shares of errors within one and two stated deviations (0.68 and 0.95 if those are right), and rms of their ratio (1)."""
    ratio = np.asarray(errors) / np.asarray(deviations)
    return {"count": len(ratio), "within_1": float((ratio < 1).mean()), "within_2": float((ratio < 2).mean()), "rms": rms(ratio)}


def measure(hole: Hole, vertices: np.ndarray, faces: np.ndarray) -> dict:
    """All that is measured of new triangles, whatever made them; vertices: all, those of the hole first."""
    new = np.setdiff1d(np.unique(faces), hole.rim)
    angles = seam(hole, vertices, faces)
    out = {"triangles": len(faces), "new": len(new), "open": open_edges(hole, faces), "folds": folds(vertices, faces)}
    if len(angles):
        out |= {"seam": rms(angles), "seam_max": float(angles.max())}
    if len(faces) <= MOST_CROSSED:
        out["crossings"] = crossings(vertices, faces, hole.faces, hole.diameter)
    if hole.distance:
        hit, weights = spread(vertices[faces], POINTS)
        points = np.einsum("nk,nkd->nd", weights, vertices[faces[hit]])
        out["distance"] = rms(hole.distance(points)) / hole.diameter
        some = slice(None, None, POINTS // NORMALS)
        facets = facet_normals(vertices, faces)[hit[some]]
        out["normals"] = rms(angle(facets, true_normals(hole, points[some], facets)))
        if len(new):
            out["vertices"] = rms(hole.distance(vertices[new])) / hole.diameter
    return out


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
    guess = vertex_normals(vertices, faces)
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


def vertex_normals(vertices, faces):
    """Angle-weighted."""
    corners = vertices[faces]
    normals = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    out = np.zeros_like(vertices)
    for k in range(3):
        a, b = unit(corners[:, k - 2] - corners[:, k]), unit(corners[:, k - 1] - corners[:, k])
        np.add.at(out, faces[:, k], normals * np.radians(angle(a, b))[:, None])
    out[np.unique(faces)] = unit(out[np.unique(faces)])
    return out
