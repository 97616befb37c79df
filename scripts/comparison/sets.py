"""The sets of holes: generated ones, all by seed, and those of files that somebody has."""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import tripatch
from known_holes import known_holes
from tripatch import files

from . import holes
from .cuts import MeshTruth, bodies, cuts, halfedges
from .holes import Hole, unit
from .metrics import rms, vertex_normals
from .rivals import run_blender

EDGES = 32  # of a side of a hole between smooth sides
SIDES = (4, 5, 6, 8)
SEED = 1
BODIES = 12
#: Of files: triangles that are taken out, and how often; boundaries that are filled.
FILE_CUTS, TURNS, MOST_EDGES = (50, 150, 400), 3, 400
KINDS = {".obj", ".off", ".ply", ".stl"}

_PRIMITIVES = """
import sys
import bpy, bmesh, numpy as np
out = sys.argv[sys.argv.index("--") + 1]
mesh = bpy.ops.mesh
kinds = {
    "cube": lambda: mesh.primitive_cube_add(),
    "UV sphere": lambda: mesh.primitive_uv_sphere_add(segments=40, ring_count=24),
    "icosphere": lambda: mesh.primitive_ico_sphere_add(subdivisions=4),
    "torus": lambda: mesh.primitive_torus_add(),
    "cylinder": lambda: mesh.primitive_cylinder_add(vertices=40, end_fill_type="NOTHING"),
    "cone": lambda: mesh.primitive_cone_add(vertices=40, radius2=0.5, end_fill_type="NOTHING"),
    "Suzanne": lambda: mesh.primitive_monkey_add(),
}
cuts = {"cube": 11, "cylinder": 9, "cone": 9, "Suzanne": 1}
for name, make in kinds.items():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    make()
    bm = bmesh.new()
    bm.from_mesh(bpy.context.object.data)
    if name in cuts:
        bmesh.ops.subdivide_edges(bm, edges=bm.edges, cuts=cuts[name], use_grid_fill=True)
    bmesh.ops.triangulate(bm, faces=bm.faces)
    bm.verts.index_update()
    np.savez(f"{out}/{name}.npz", vertices=[v.co for v in bm.verts], faces=[[v.index for v in f.verts] for f in bm.faces])
"""
#: Of primitives whose vertices are on a smooth surface: the distance to that.
ROUND = dict.fromkeys(("UV sphere", "icosphere"), lambda p: np.abs(np.linalg.norm(p, axis=1) - 1))
ROUND["torus"] = lambda p: np.abs(np.hypot(np.hypot(p[:, 0], p[:, 1]) - 1, p[:, 2]) - 0.25)


def formulas(**_) -> Iterator[Hole]:
    """Twenty holes between three smooth sides."""
    for make in [*holes.ANALYTIC.values(), *holes.FURTHER.values()]:
        yield make(EDGES)


def more_sides(**_) -> Iterator[Hole]:
    """Holes of four to eight sides in four surfaces, with even and uneven corners."""
    for name in holes.MANY_SIDED:
        for sides in SIDES:
            for regular in (True, False):
                hole = holes.many_sided(name, sides, EDGES, regular)
                hole.name = f"{name}, {sides} {'even' if regular else 'uneven'} sides"
                yield hole


def irregular(**_) -> Iterator[Hole]:
    """Holes in irregular triangles of eight surfaces: smooth sides, round and jagged, with and without noise."""
    for k, known in enumerate(known_holes(SEED)):
        distance = known.surface.distance
        hole = Hole(f"{known.name}, {known.kind} {k}", known.vertices, known.faces, np.array(known.rim), distance=distance)
        away = 1e-3 * hole.diameter
        places = known.vertices + away * vertex_normals(known.vertices, known.faces)
        hole.normals = unit(np.stack([distance(places + s) - distance(places - s) for s in 0.1 * away * np.eye(3)], -1))
        hole.mesh = known.name
        yield hole


def cad(**_) -> Iterator[Hole]:
    """Holes at edges and on faces of extruded and turned bodies with sharp and rounded corners."""
    yield from bodies(SEED, BODIES)


def primitives(blender: str, cache: Path) -> Iterator[Hole]:
    """Holes in Blender's primitives, and in Suzanne's limit surface."""
    if not blender:
        return
    from . import suzanne

    suzanne.suzanne_meshes(cache, blender)
    yield suzanne.suzanne(EDGES, cache)
    if not (cache / "Suzanne.npz").exists():
        run_blender(blender, _PRIMITIVES, cache)
    for k, name in enumerate(("cube", "UV sphere", "icosphere", "torus", "cylinder", "cone", "Suzanne")):
        read = np.load(cache / f"{name}.npz")
        vertices, faces = read["vertices"].astype(float), read["faces"].astype(int)
        for hole in cuts(f"Blender's {name}", vertices, faces, np.random.default_rng([SEED, k]), sharp=True):
            if name in ROUND:
                hole.nearest, hole.facets, hole.distance = None, None, ROUND[name]
            yield hole


#: Name -> (settings) -> its holes
GENERATED: dict[str, Callable] = {
    "formulas": formulas,
    "more sides": more_sides,
    "irregular": irregular,
    "CAD bodies": cad,
    "primitives": primitives,
}

# ------------------------------------------------------------------------------------------------------------------- files

#: Where known files come from: name of the collection, its address, licence, and files with the ids that git gives them.
SOURCES = json.loads(Path(__file__).with_name("sources.json").read_text())


def git_id(path: Path) -> str:
    """What `git hash-object` prints."""
    data = path.read_bytes()
    return hashlib.sha1(b"blob %d\0" % len(data) + data).hexdigest()


def origin(path: Path) -> dict:
    """Of a file: its checksum, and the address where the same file is published, if that is known."""
    known = {value: source for source in SOURCES for value in source["files"].values()}
    identity = git_id(path)
    return {"file": path.name, "git": identity, "address": known.get(identity, {}).get("address", "unknown")}


def triangles_of(path: Path) -> tuple[np.ndarray, np.ndarray]:
    mesh = files.read(path)
    faces = [(f[0], f[k], f[k + 1]) for f in mesh.faces for k in range(1, len(f) - 1)]
    used, index = np.unique(np.array(faces, int), return_inverse=True)
    return np.asarray(mesh.vertices, float)[used], index.reshape(-1, 3)


def loops_of(name: str, vertices, faces, truth: MeshTruth | None) -> Iterator[Hole]:
    """The holes that a mesh has; their truth, if another mesh is known to be that."""
    for k, rim in enumerate(tripatch.find_holes(faces)):
        if not 3 <= len(rim) <= MOST_EDGES or len(set(rim.tolist())) < len(rim):
            continue
        hole = Hole(f"{name}, hole {k}", vertices, faces, np.asarray(rim), mesh=name)
        if truth:
            hole.nearest, hole.facets = truth.nearest, truth.facets
            hole.__post_init__()
            hole.off = rms(hole.distance(vertices[rim]))
        yield hole


def of_file(path: Path) -> Iterator[Hole]:
    """Of NAME_original, if NAME_gt is next to it, the holes with that truth. Of other files the holes that they have, or
    such as are cut out of a closed mesh."""
    name = path.stem.removesuffix("_original")
    truths = [p for p in path.parent.glob(f"{name}_gt.*") if p.suffix in KINDS]
    if name.endswith("_gt"):
        return
    vertices, faces = triangles_of(path)
    if path.stem != name and truths:
        yield from loops_of(name, vertices, faces, MeshTruth(*triangles_of(truths[0])))
    elif len(halfedges(faces)) == 3 * len(faces):
        yield from loops_of(name, vertices, faces, None)
        rng = np.random.default_rng(SEED)
        if not len(tripatch.find_holes(faces)):
            for turn in range(TURNS):
                for hole in cuts(name, vertices, faces, rng, FILE_CUTS):
                    hole.name += f", {turn}"
                    yield hole


def all_sets(data: Path | None, **settings) -> Iterator[tuple[str, Callable]]:
    """Name of each set, and what yields its holes."""
    for name, make in GENERATED.items():
        yield name, functools.partial(make, **settings)
    for folder in sorted({p.parent for p in data.rglob("*") if p.suffix in KINDS}) if data else ():
        own = sorted(p for p in folder.iterdir() if p.suffix in KINDS)
        yield folder.name, lambda own=own: (hole for path in own for hole in of_file(path))
