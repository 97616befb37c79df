"""The table of docs/mathematics/cage.md: fills that are cages.

All lengths are over the diameter of the hole (the largest distance of two vertices of its rim), and over that of the whole shape.
"""

from __future__ import annotations

import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tripatch
from scipy.spatial import cKDTree
from tripatch import _arrays, _native

from .page import Setting, write_table

STEPS = 6


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


def rounded_box(n=8, rings=3):
    vertices, faces = cube_grid(n, lambda p: p / np.linalg.norm(p, 6))
    gone = around(int(np.argmax(vertices @ np.ones(3))), faces, rings)
    return Cage("rounded box", vertices * [1.0, 1.3, 0.8], faces, gone)


class _Square(Cage):
    def corners(self):
        return self.three


def torus(n=20, m=12, edges=4):
    """A square of quads on the outer and upper side, of whose corners the hole has three."""
    u, v = np.meshgrid(2 * np.pi * np.arange(n) / n, 2 * np.pi * np.arange(m) / m, indexing="ij")
    r = 1 + 0.45 * np.cos(v)
    vertices = np.stack([r * np.cos(u), r * np.sin(u), 0.45 * np.sin(v)], -1).reshape(-1, 3)
    faces = [
        [i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m] for i in range(n) for j in range(m)
    ]
    cage = _Square("torus, a square", vertices, faces, [i * m + j for i in range(edges) for j in range(edges)])
    cage.three = [0, edges * m, edges * m + edges]
    return cage


def suzanne(vertices, faces, rings=3):
    """Three rings round the vertex of three quads at the jaw."""
    valence = np.bincount(np.concatenate([np.array(face) for face in faces]), minlength=len(vertices))
    at = np.linalg.norm(vertices - [0.33, -0.4, -0.91], axis=1) + 10 * (valence != 3)
    return Cage("Suzanne's jaw", vertices, faces, around(int(np.argmin(at)), faces, rings))


def rms(x):
    return float(np.sqrt(np.mean(np.square(x)))) if np.size(x) else 0.0


def limit_blocks(vertices, faces, creases=((), ())):
    """For each face the points of the limit surface on a grid (STEPS + 1)^2, of n-gons on each of their quarters."""
    settings = _native.Subdivision()
    settings.crease_edges, settings.edge_creases = [list(map(int, e)) for e in creases[0]], [float(c) for c in creases[1]]
    points = _native.LimitSurface(vertices, *_arrays.faces(faces), settings, []).grid(STEPS).reshape(-1, STEPS + 1, STEPS + 1, 3)
    blocks = np.cumsum([0] + [1 if len(face) == 4 else len(face) for face in faces])
    return [points[a:b] for a, b in zip(blocks, blocks[1:], strict=False)]


class Truth:
    """Distances to a surface given by blocks of points: to the tangent plane of the nearest."""

    def __init__(self, blocks):
        grids = np.concatenate(blocks)
        normals = np.cross(np.gradient(grids, axis=1), np.gradient(grids, axis=2)).reshape(-1, 3)
        length = np.linalg.norm(normals, axis=1)
        usable = length > 1e-3 * np.median(length)
        self.points, self.normals = grids.reshape(-1, 3)[usable], normals[usable] / length[usable, None]
        self.tree = cKDTree(self.points)

    def distance(self, p):
        at = self.tree.query(p)[1]
        return np.abs(np.einsum("ij,ij->i", p - self.points[at], self.normals[at]))


def closed(cage, faces, fill):
    points = np.concatenate([cage.vertices, fill.vertices])
    points[fill.moved[0]] = fill.moved[1]
    return points, [list(face) for face in [*faces, *fill.faces]]


def first_rings(faces, rim, corners):
    """Faces of the first two rings round the rim, and those of them that touch no corner."""
    near, two = set(rim.tolist()), set()
    for _ in range(2):
        two |= {f for f, face in enumerate(faces) if near & set(face)}
        near |= {v for f in two for v in faces[f]}
    return sorted(two), sorted(f for f in two if not set(faces[f]) & set(corners))


def measure(cage, region, **options):
    """One fill, measured by an evaluation of its own, not by the report (but for the seam)."""
    rim, left, corners = cage.rim(), cage.left, cage.corners()
    diameter = np.linalg.norm(cage.vertices[rim][:, None] - cage.vertices[rim], axis=-1).max()
    size = np.linalg.norm(np.ptp(cage.vertices, axis=0)) / np.sqrt(3)
    given = dict(rim=rim, corners=corners, output="cage", **options)
    if region:
        fill = tripatch.fill(cage.vertices, cage.faces, replaced=cage.gone, **given)
    else:
        fill = tripatch.fill(cage.vertices, left, **given)
    points, faces = closed(cage, left, fill)
    after = limit_blocks(points, faces, fill.creases)
    whole = limit_blocks(cage.vertices, cage.faces)
    kept = [f for f in range(len(cage.faces)) if f not in set(cage.gone)]
    before = [whole[f] for f in kept] if region else limit_blocks(cage.vertices, left)
    two, apart = first_rings(left, rim, corners)
    moved = [np.linalg.norm(after[f] - before[f], axis=-1).ravel() for f in range(len(left))]
    inside = np.concatenate([block.reshape(-1, 3) for block in after[len(left) :]])
    nearby = np.concatenate([inside] + [after[f].reshape(-1, 3) for f in two])
    radial = None if cage.radius is None else np.linalg.norm(inside, axis=1) - cage.radius
    r = fill.report
    return fill, {
        "diameter": diameter,
        "size": size,
        "quads": len(fill.faces),
        "sphere": None if radial is None else rms(radial),
        "truth": rms(Truth(whole).distance(nearby)),
        "moved": rms(np.concatenate([moved[f] for f in apart])),
        "moved_all": rms(np.concatenate([moved[f] for f in two])),
        "moved_max": max(moved[f].max() for f in two),
        "deviation": r.cage_deviation_rms,
        "deviation_max": r.cage_deviation_max,
        "median": r.seam_angle_median,
        "inside": r.seam_angle_max_inside,
        "largest": r.seam_angle_max,
        "warnings": len(r.warnings),
    }


_EVALUATE = """
import sys, bpy, numpy as np
task, out = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
if task == "suzanne":
    bpy.ops.mesh.primitive_monkey_add()
    mesh = bpy.context.object.data
    np.savez(out, vertices=[tuple(v.co) for v in mesh.vertices], sizes=[len(p.vertices) for p in mesh.polygons],
             corners=[v for p in mesh.polygons for v in p.vertices])
else:
    given = np.load(task)
    faces = np.split(given["corners"], np.cumsum(given["sizes"])[:-1])
    mesh = bpy.data.meshes.new("Cage")
    mesh.from_pydata(given["vertices"].tolist(), [], [f.tolist() for f in faces])
    ob = bpy.data.objects.new("Cage", mesh)
    bpy.context.collection.objects.link(ob)
    modifier = ob.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = 3
    made = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    points = np.empty(3 * len(made.vertices), np.float32)
    made.vertices.foreach_get("co", points)
    np.save(out, points.reshape(-1, 3))
"""


def _blender(blender, *arguments):
    with tempfile.NamedTemporaryFile("w", suffix=".py") as script:
        script.write(_EVALUATE)
        script.flush()
        command = [blender, "--background", "--factory-startup", "--python-exit-code", "1", "--python", script.name, "--"]
        subprocess.run(command + list(map(str, arguments)), check=True, stdout=subprocess.DEVNULL)


def suzanne_from(blender, folder: Path) -> Cage:
    file = folder / "suzanne-cage.npz"
    if not file.exists():
        _blender(blender, "suzanne", file)
    read = np.load(file)
    faces = [f.tolist() for f in np.split(read["corners"], np.cumsum(read["sizes"])[:-1])]
    return suzanne(read["vertices"].astype(float), faces)


def evaluated(blender, folder: Path, points, faces):
    """What Blender's Subdivision modifier of level 3 makes of a cage."""
    np.savez(
        folder / "cage.npz", vertices=points, sizes=[len(f) for f in faces], corners=np.concatenate([np.array(f) for f in faces])
    )
    _blender(blender, folder / "cage.npz", folder / "evaluated.npy")
    return np.load(folder / "evaluated.npy").astype(float)


def suzanne_evaluated(blender, folder: Path) -> tuple[float, float]:
    """rms distance of all of Blender's points to the original limit surface, over Suzanne's width, and the largest."""
    cage = suzanne_from(blender, folder)
    fill, _ = measure(cage, True)
    points = evaluated(blender, folder, *closed(cage, cage.left, fill))
    distance = Truth(limit_blocks(cage.vertices, cage.faces)).distance(points)
    width = np.ptp(cage.vertices, axis=0).max()
    return rms(distance) / width, distance.max() / width


def timing(cgal: str | None, folder: Path, repetitions=100):
    """Milliseconds, least and median, from a rim of 4 + 4 + 4 edges to its cage, and of CGAL's filler on the same hole."""
    cage = cube_sphere(8, 2, on_limit=False)
    rim, left, corners = cage.rim(), cage.left, cage.corners()
    seconds = []
    for _ in range(repetitions):
        start = time.perf_counter()
        tripatch.fill(cage.vertices, left, rim=rim, corners=corners, output="cage")
        seconds.append(1e3 * (time.perf_counter() - start))
    result = {"tripatch": (min(seconds), float(np.median(seconds)))}
    if cgal:
        triangles = [t for q in left for t in (q[:3], [q[0], q[2], q[3]])]
        given = folder / "cage.txt"
        with given.open("w") as file:
            print(len(cage.vertices), len(triangles), file=file)
            np.savetxt(file, cage.vertices, fmt="%.17g")
            np.savetxt(file, np.array(triangles), fmt="%d")
            print(*rim[:2], file=file)
        words = subprocess.run(
            [cgal, str(given), "1", str(repetitions)], check=True, capture_output=True, text=True
        ).stdout.split()
        times = [1e3 * float(word) for word in words[1:]]
        result["cgal"] = (min(times), float(np.median(times)))
    return result


def table(setting: Setting) -> str:
    blender, folder = setting.blender, setting.cache
    lines = [
        "| cage | hole | rim | rows | quads | fill to the sphere | fill and two rings to the whole limit "
        "| moved, but for corners | moved, rms / largest | fill to its patch, rms / largest | seam: median, inside, at corners |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]

    def row(cage, region, cage_rim, resolution):
        _, m = measure(cage, region, cage_rim=cage_rim, resolution=resolution)
        d = m["diameter"]
        both = [f"{m[k] / d:.1e} ({m[k] / m['size']:.1e})" if m[k] is not None else "" for k in ("sphere", "truth", "moved")]
        exact = cage_rim == "exact"
        lines.append(
            f"| {cage.name} | {'region' if region else 'open'} | {cage_rim} | {'auto' if resolution is None else resolution} | "
            f"{m['quads']}{' (warns)' if m['warnings'] else ''} | {' | '.join(both)} | "
            f"{m['moved_all'] / d:.1e} / {m['moved_max'] / d:.1e} | {m['deviation'] / d:.1e} / {m['deviation_max'] / d:.1e} | "
            + (f"{m['median']:.2f}, {m['inside']:.2f}, {m['largest']:.1f} |" if exact else "0 |")
        )
        print(lines[-1], flush=True)

    for n, rings in ((6, 2),) if setting.quick else ((6, 2), (6, 3), (8, 2), (8, 3), (16, 4), (16, 6)):
        for cage_rim in ("smooth", "exact", "move"):
            row(cube_sphere(n, rings), False, cage_rim, 0)
    for n, rings in () if setting.quick else ((8, 2), (16, 4)):
        row(cube_sphere(n, rings, on_limit=False), False, "exact", 0)
    for n, rings in ((6, 2),) if setting.quick else ((6, 2), (6, 3), (8, 2), (8, 3)):
        row(cube_sphere(n, rings), True, "smooth", 0)
    others = [rounded_box(), torus()] + ([suzanne_from(blender, folder)] if blender else [])
    for cage in [] if setting.quick else [cube_sphere(8, 2, on_limit=False), *others]:
        for region in (False, True):
            for cage_rim in ("smooth", "exact", "move"):
                row(cage, region, cage_rim, None)
    text = "\n".join(lines) + "\n"
    if blender:
        d, largest = suzanne_evaluated(blender, folder)
        text += (
            "\nSuzanne's jaw as a region, Smooth: all points of Blender's evaluated modifier, level 3, to the "
            "original limit surface: "
            f"{d:.1e} of Suzanne's width rms, {largest:.1e} at most.\n"
        )
    times = timing(setting.cgal, folder, 5 if setting.quick else 100)
    text += f"\nA rim of 4 + 4 + 4 edges: {times['tripatch'][0]:.0f} ms (median {times['tripatch'][1]:.0f})."
    if "cgal" in times:
        text += (
            f" CGAL's triangulate, refine and fair, which puts a few triangles between the cage's own vertices: "
            f"{times['cgal'][0]:.2f} ms, a ratio of {times['tripatch'][0] / times['cgal'][0]:.0f}."
        )
    return text + "\n"


def write(setting: Setting) -> None:
    options = 'output="cage" with the rim and the number of rows of the table; all else at its default'
    write_table(setting, "mathematics/cage.md", options, table(setting))
