#!/usr/bin/env python3
"""Meshes as programs of machine learning and voxels make them: two shells, a wall apart, with pinholes by the thousand.

    scripts/voxel_meshes.py OUT.ply [--faces 1000000] [--holes 10000] [--seed 0]    writes one
    scripts/voxel_meshes.py --measure [--faces ...] [--holes ...]                   and reads, fills and checks it: a JSON line

The shells are marched from a distance field; the pinholes have 3 to 12 edges and share no vertex.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import tempfile
import time

import numpy as np
import tripatch
from tripatch import borders, files

WALL = 4  # voxels between the shells
#: The six tetrahedra of a cube around its diagonal.
_PATHS = [np.cumsum([(0, 0, 0), *(np.eye(3, dtype=int)[k] for k in order)], axis=0) for order in itertools.permutations(range(3))]


def field(x, y, z, wall):
    """About the distance from the middle of the wall, less half of it."""
    middle = np.sqrt(x * x + y * y + z * z) - 0.6 + 0.05 * np.sin(7 * x) * np.sin(6 * y) * np.sin(5 * z)
    return np.abs(middle) - wall / 2


def marched(n):
    """Vertices and triangles where the field is zero, on n^3 cubes."""
    axis = np.linspace(-1.1, 1.1, n + 1)
    values = field(axis[:, None, None], axis[None, :, None], axis[None, None, :], WALL * (axis[1] - axis[0]))
    inside = values < 0
    low, high = inside[:-1, :-1, :-1].copy(), inside[:-1, :-1, :-1].copy()
    for corner in itertools.product((0, 1), repeat=3):
        part = inside[tuple(slice(c, n + c) for c in corner)]
        low &= part
        high |= part
    cubes = np.argwhere(high & ~low)
    strides = np.array([(n + 1) ** 2, n + 1, 1])
    flat, edges = values.ravel(), []
    for path in _PATHS:
        tets = (cubes[:, None] + path) @ strides
        edges += _triangles(tets, flat[tets])
    ends = np.concatenate(edges)  # (t, 3, 2) grid points inside and outside
    keys = np.sort(ends, axis=2) @ [(n + 1) ** 3, 1]
    unique, first, place = np.unique(keys.ravel(), return_index=True, return_inverse=True)
    a, b = ends.reshape(-1, 2)[first].T
    at = (flat[a] / (flat[a] - flat[b]))[:, None]
    grid = np.stack(np.unravel_index(np.arange((n + 1) ** 3), (n + 1,) * 3), axis=1)
    points = axis[grid[a]] * (1 - at) + axis[grid[b]] * at
    faces = place.reshape(-1, 3)
    toward = (axis[grid[ends[:, :, 1]]] - axis[grid[ends[:, :, 0]]]).sum(axis=1)
    p = points[faces]
    turned = (np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) * toward).sum(axis=1) < 0
    faces[turned] = faces[turned][:, ::-1]
    return points, faces


def _triangles(tets, values):
    """For each way that tetrahedra are cut the ends of the edges that their triangles lie on."""
    inside = values < 0
    made = []
    for pattern in itertools.product((False, True), repeat=4):
        own = tets[(inside == pattern).all(axis=1)]
        low, high = np.flatnonzero(pattern), np.flatnonzero(~np.array(pattern))
        if len(low) == 0 or len(high) == 0:
            continue
        pairs = [(i, o) for i in low for o in high]
        if len(low) == 2:
            square = [pairs[0], pairs[1], pairs[3], pairs[2]]
            made += [own[:, [square[0], square[k], square[k + 1]]] for k in (1, 2)]
        else:
            made.append(own[:, pairs])
    return made


def pierced(points, faces, holes, seed):
    """A mesh with pinholes: where a face was, two, the faces at a vertex, or those at both ends of an edge."""
    rng = np.random.default_rng(seed)
    order = np.argsort(faces.ravel(), kind="stable")
    starts = np.searchsorted(faces.ravel()[order], np.arange(len(points) + 1))
    owner = order // 3
    around = lambda v: owner[starts[v] : starts[v + 1]]  # noqa: E731
    free, gone, made = np.ones(len(points), bool), [], 0
    for f in rng.permutation(len(faces)).tolist():
        a, b, _ = faces[f].tolist()
        kind = rng.integers(4)
        chosen = np.array([f])
        if kind == 1:
            chosen = np.intersect1d(around(a), around(b))
        elif kind > 1:
            chosen = around(a) if kind == 2 else np.union1d(around(a), around(b))
        used = np.unique(faces[chosen])
        sides = np.sort(np.stack([faces[chosen], np.roll(faces[chosen], -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
        rim, times = np.unique(sides, axis=0, return_counts=True)
        rim = rim[times == 1]
        ring = np.unique(faces[np.unique(np.concatenate([around(v) for v in used]))])
        if 3 <= len(rim) == len(np.unique(rim)) <= 12 and free[ring].all():
            free[used] = False
            gone.append(chosen)
            made += 1
            if made == holes:
                break
    kept = np.ones(len(faces), bool)
    kept[np.concatenate(gone)] = False
    used, corners = np.unique(faces[kept], return_inverse=True)
    return points[used], corners.reshape(-1, 3)


def mesh(faces, holes, seed):
    """Vertices and triangles with about as many faces and pinholes."""
    n = 48
    area = len(marched(n)[1]) / n**2
    return pierced(*marched(round((faces / area) ** 0.5)), holes, seed)


def parts(count, faces):
    """The number of connected components."""
    label = np.arange(count)
    while True:
        least = np.minimum.reduceat(label[faces.ravel()], np.arange(0, faces.size, 3))
        before = label.copy()
        np.minimum.at(label, faces.ravel(), np.repeat(least, 3))
        label = label[label]
        if np.array_equal(before, label):
            return len(np.unique(label[np.unique(faces)]))


def measured(path):
    """What reading and filling take, in CPU seconds, and what is wrong with the result."""
    begun = time.process_time()
    whole = files.read(path)
    read = time.process_time()
    fills = tripatch.fill_all(whole.vertices, whole.faces)
    filled = time.process_time()
    out = whole.marked()
    out.append_all([fill for fill in fills if isinstance(fill, tripatch.Fill)])
    with tempfile.TemporaryDirectory() as folder:
        target = os.path.join(folder, "out.ply")
        out.write(target)
        written = time.process_time()
        again = files.read(target)
    left = borders.find(again.vertices, again.faces)
    before, after = (parts(len(each.vertices), np.asarray(each.faces)) for each in (whole, again))
    done = [fill for fill in fills if isinstance(fill, tripatch.Fill)]
    edges = [len(loop) for loop in tripatch.find_holes(whole.faces)]
    return {
        "faces": len(whole.faces),
        "pinholes": len(edges),
        "their edges": [min(edges), max(edges)],
        "filled": len(done),
        "borders left": len(left.borders),
        "parts before and after": [before, after],
        "through the mesh": sum(fill.passes_through is not None for fill in done),
        "seconds to read": round(read - begun, 2),
        "to fill": round(filled - read, 2),
        "to write": round(written - filled, 2),
    }


def main():
    """Runs the script."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", nargs="?", help="PLY file to write")
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("--faces", type=int, default=1_000_000)
    parser.add_argument("--holes", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    if not args.out and not args.measure:
        parser.error("name OUT.ply, or give --measure")
    vertices, faces = mesh(args.faces, args.holes, args.seed)
    with tempfile.TemporaryDirectory() as folder:
        path = args.out or os.path.join(folder, "in.ply")
        tripatch.write(path, (vertices, faces))
        if args.measure:
            print(json.dumps(measured(path)))


if __name__ == "__main__":
    main()
