"""A hole in Suzanne's forehead, on the Catmull-Clark limit surface that Blender evaluates."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

import numpy as np

from .cuts import MeshTruth
from .holes import RINGS, Hole, unit

SUZANNE_LEVELS = {8: 2, 16: 3, 32: 4}
SUZANNE_TRUTH = 6

_EXPORT = """
import sys
from array import array
import bpy
out, levels = sys.argv[sys.argv.index("--") + 1], sys.argv[sys.argv.index("--") + 2:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_monkey_add()
monkey = bpy.context.object
modifier = monkey.modifiers.new("limit", "SUBSURF")
for level in levels:
    modifier.levels = int(level)
    mesh = monkey.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    points, quads = array("f", [0.0]) * (3 * len(mesh.vertices)), array("i", [0]) * (4 * len(mesh.polygons))
    mesh.vertices.foreach_get("co", points)
    mesh.loops.foreach_get("vertex_index", quads)
    for kind, values in (("points", points), ("quads", quads)):
        with open(f"{out}/suzanne-{level}.{kind}", "wb") as file:
            values.tofile(file)
"""


def suzanne_meshes(folder: Path, blender="blender") -> None:
    """Has Blender write Suzanne on its Catmull-Clark limit surface into `folder`, once."""
    levels = [*SUZANNE_LEVELS.values(), SUZANNE_TRUTH]
    if all((folder / f"suzanne-{level}.quads").exists() for level in levels):
        return
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("w", suffix=".py") as script:
        script.write(_EXPORT)
        script.flush()
        command = [blender, "--background", "--factory-startup", "--python-exit-code", "1", "--python", script.name, "--"]
        subprocess.run(command + [str(folder), *map(str, levels)], check=True, stdout=subprocess.DEVNULL)


def _suzanne_grid(points, quads, n):
    """Vertices (n + 1, n + 1) of 2 x 2 faces of the forehead, walked from one corner."""
    face_of, neighbors = {}, {}
    for f, quad in enumerate(quads.tolist()):
        for a, b in zip(quad, quad[1:] + quad[:1]):
            face_of[a, b] = f
            neighbors.setdefault(a, set()).add(b)
            neighbors.setdefault(b, set()).add(a)

    def towards(v, direction):
        return max(sorted(neighbors[v]), key=lambda w: unit(points[w] - points[v]) @ direction)

    def straight(before, v):  # across a regular vertex
        beside = {w for f in (face_of.get((before, v)), face_of.get((v, before))) if f is not None for w in quads[f].tolist()}
        return (neighbors[v] - beside).pop()

    def opposite(a, b, c):  # the fourth vertex of the quad a, b, c
        for f in (face_of.get((a, b)), face_of.get((b, a))):
            if f is not None and c in quads[f]:
                return next(w for w in quads[f].tolist() if w not in (a, b, c))
        raise ValueError("not a grid of quads")

    grid = np.zeros((n + 1, n + 1), int)
    grid[0, 0] = np.linalg.norm(points - [0.4089, 0.0961, 0.8852], axis=1).argmin()
    grid[1, 0], grid[0, 1] = towards(grid[0, 0], np.array([0, 1, -0.02])), towards(grid[0, 0], np.array([-0.95, -0.12, 0.3]))
    for k in range(2, n + 1):
        grid[k, 0], grid[0, k] = straight(grid[k - 2, 0], grid[k - 1, 0]), straight(grid[0, k - 2], grid[0, k - 1])
    for i in range(1, n + 1):
        for j in range(1, n + 1):
            grid[i, j] = opposite(grid[i - 1, j], grid[i - 1, j - 1], grid[i, j - 1])
    return grid


def _faces_around(quads, grid, n):
    """Triangles (m, 3) of the rings around the half of the grid that is the hole."""
    kept = {int(grid[i, j]) for i in range(n + 1) for j in range(n + 1 - i)}
    block = {frozenset(map(int, grid[i : i + 2, j : j + 2].flat)): (i, j) for i in range(n) for j in range(n)}
    for _ in range(RINGS):
        kept |= {w for quad in quads.tolist() if kept.intersection(quad) for w in quad}
    faces = []
    for quad in quads.tolist():
        i, j = block.get(frozenset(quad), (n, n))
        if not kept.issuperset(quad) or i + j < n - 1:
            continue
        if i + j == n - 1:  # the diagonal of the hole cuts it: the outer half stays
            k = quad.index(grid[i + 1, j + 1])
            faces.append((quad[k], quad[(k + 1) % 4], quad[k - 1]))
        else:
            faces += [(quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])]
    return np.array(faces)


def _suzanne_truth(points, used, hole, folder):
    """The fine limit surface near these points and those of the hole, its triangles there, its normals at the points used."""
    truth, truth_quads = _limit_points(folder, SUZANNE_TRUTH)
    triangles = np.concatenate([truth_quads[:, [0, 1, 2]], truth_quads[:, [0, 2, 3]]])
    low, high = points[[*used, *hole]].min(0) - 0.05, points[[*used, *hole]].max(0) + 0.05
    triangles = triangles[((truth[triangles[:, 0]] > low) & (truth[triangles[:, 0]] < high)).all(1)]
    # normals from the quads' diagonals, which no cut of a quad favors
    near = np.unique(triangles)
    normals = np.zeros_like(truth)
    beside = truth_quads[np.isin(truth_quads, near).any(1)]
    a, b, c, d = truth[beside].swapaxes(0, 1)
    for k in range(4):
        np.add.at(normals, beside[:, k], np.cross(c - a, d - b))
    there = near[[np.linalg.norm(truth[near] - p, axis=1).argmin() for p in points[used]]]
    return truth, triangles, unit(normals[there])


def _limit_points(folder, level):
    points = np.fromfile(folder / f"suzanne-{level}.points", np.float32).reshape(-1, 3).astype(float)
    return points, np.fromfile(folder / f"suzanne-{level}.quads", np.int32).reshape(-1, 4)


def suzanne(n, folder: Path):
    """Half of 2 x 2 faces of Suzanne's forehead, below their diagonal, on the limit surface; n = 8, 16 or 32."""
    points, quads = _limit_points(folder, SUZANNE_LEVELS[n])
    grid = _suzanne_grid(points, quads, n)
    rim = np.array([grid[i, 0] for i in range(n)] + [grid[n - i, i] for i in range(n)] + [grid[0, n - i] for i in range(n)])
    faces = _faces_around(quads, grid, n)
    if ((faces == rim[0]) & (np.roll(faces, -1, axis=1) == rim[1])).any():
        rim = np.roll(rim[::-1], 1)

    used = np.unique(faces)
    truth, triangles, normals = _suzanne_truth(points, used, grid[np.add.outer(range(n + 1), range(n + 1)) <= n], folder)
    index = np.full(len(points), -1)
    index[used] = np.arange(len(used))
    return Hole(
        "suzanne",
        points[used],
        index[faces],
        index[rim],
        normals,
        MeshTruth(truth, triangles).nearest,
        counts=(n, n, n),
    )
