"""Other programs on the same holes: each function takes a hole and TriPatch's fill of it, and gives a Filling or raises.

Programs on meshes are given the mesh around the hole; those that look at all of a mesh are given four rings of it. OpenCASCADE is
given three B-spline surfaces interpolated in the hole's own strips. libigl does not fill holes: it is given TriPatch's triangles,
and finds the positions. CPU time is that of the process, of all its threads, without making the program's own mesh.
"""

from __future__ import annotations

import functools
import importlib
import importlib.metadata
import json
import multiprocessing
import os
import resource
import shlex
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tripatch
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree
from tripatch import files

from .cuts import halfedges
from .holes import RINGS, Hole

REPETITIONS, LONG = 3, 0.1  # of which only one if it takes so many seconds
PATIENCE, STUCK = 60, 1200  # seconds that a rival may take for a hole: of CPU, which other work does not lengthen; of the clock
LOOK = 0.5  # seconds after which that is looked at
GIVEN_TRIANGLES = ("libigl", "OpenCASCADE")  # of TriPatch, and place their vertices
SAME = 1e-5  # of the hole: vertices as near as this are the same, also if they were written in single precision


@dataclass
class Filling:
    vertices: np.ndarray  # all, those of the hole's mesh first
    faces: np.ndarray  # the new triangles
    cpu: float  # seconds, the least of the repetitions


def filling(hole: Hole, vertices, faces, cpu: float) -> Filling:
    """The new triangles of a filled mesh, whatever the order of its vertices: those that hang together with the rim."""
    vertices, faces = np.asarray(vertices, float).reshape(-1, 3), np.asarray(faces, int).reshape(-1, 3)
    count = len(hole.vertices)
    if not (len(vertices) >= count and np.array_equal(vertices[:count], hole.vertices)):
        away, at = cKDTree(hole.vertices).query(vertices)
        is_old = away <= SAME * hole.diameter
        index = np.where(is_old, at, count + np.cumsum(~is_old) - 1)
        vertices, faces = np.concatenate([hole.vertices, vertices[~is_old]]), index[faces]
    old = {frozenset(f) for f in hole.faces.tolist()}
    new = np.array([f for f in faces.tolist() if len(set(f)) == 3 and frozenset(f) not in old], int).reshape(-1, 3)
    rim = hole.rim.tolist()
    edges = {frozenset(edge) for edge in zip(rim, [*rim[1:], rim[0]])}
    label = np.arange(len(new))  # of pieces that hang together by edges
    sides: dict = {}
    for f, face in enumerate(new.tolist()):
        for k in range(3):
            sides.setdefault(frozenset((face[k], face[k - 1])), []).append(f)
    pairs = np.array([own[:2] for edge, own in sides.items() if len(own) > 1 and edge not in edges], int).reshape(-1, 2)
    while len(pairs) and (label[pairs[:, 0]] != label[pairs[:, 1]]).any():
        least = label[pairs].min(1)
        for k in (0, 1):
            np.minimum.at(label, pairs[:, k], least)
    at_rim = {label[f] for edge in edges for f in sides.get(edge, ())}
    new = new[np.isin(label, list(at_rim))]
    if not len(new):
        raise RuntimeError("nothing was filled")
    owner = halfedges(new)
    along = sum((a, b) in owner for a, b in zip(rim, [*rim[1:], rim[0]]))
    return Filling(vertices, new if 2 * along >= len(rim) else new[:, ::-1], cpu)


def timed(call, prepared=lambda: None):
    """What it returns of what is prepared, which is not counted, and the least CPU seconds of some calls."""
    least = np.inf
    for _ in range(REPETITIONS):
        given = prepared()
        start = time.process_time()
        result = call(given)
        least = min(least, time.process_time() - start)
        if least > LONG:
            break
    return result, least


def check_patience(pid: int, began: float) -> None:
    """Raises where a process has used too much time. A limit set by `resource` would make its CPU clock tick in milliseconds."""
    user, system = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:13]
    if int(user) + int(system) > PATIENCE * os.sysconf("SC_CLK_TCK"):
        raise RuntimeError(f"more than {PATIENCE} s of CPU")
    if time.monotonic() - began > STUCK:
        raise RuntimeError(f"no answer within {STUCK} s")


def output_of(words: list) -> str:
    """What a program prints that ends in time and without an error."""
    began = time.monotonic()
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while True:
        try:
            printed, errors = process.communicate(timeout=LOOK)
            break
        except subprocess.TimeoutExpired:
            try:
                check_patience(process.pid, began)
            except RuntimeError:
                process.kill()
                process.communicate()
                raise
    if process.returncode:
        raise RuntimeError(errors.strip()[-100:] or f"ended with {process.returncode}")
    return printed


def apart(call):
    """What it returns in a process of its own, which may crash or take too long."""
    processes = multiprocessing.get_context("fork")
    answer, question = processes.Pipe(duplex=False)

    def run():
        for stream in (1, 2):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
        try:
            question.send(call())
        except Exception as error:
            question.send(error)

    process = processes.Process(target=run)
    process.start()
    question.close()
    began = time.monotonic()
    try:
        while not answer.poll(LOOK):
            check_patience(process.pid, began)
        result = answer.recv()
    except EOFError:
        raise RuntimeError("crashed") from None
    finally:
        process.kill()
        process.join()
    if isinstance(result, Exception):
        raise RuntimeError(str(result) or type(result).__name__)
    return result


def part_around(hole: Hole) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Four rings of faces around the hole: which vertices they have, the faces and the rim in these."""
    near, left = np.zeros(len(hole.vertices), bool), hole.faces
    near[hole.rim] = True
    for _ in range(RINGS):
        near[left[near[left].any(1)].ravel()] = True
    faces = left[near[left].all(1)]
    used, index = np.unique(faces, return_inverse=True)
    return used, index.reshape(-1, 3), np.searchsorted(used, hole.rim)


# ------------------------------------------------------------------------------------------------------- TriPatch and programs


def ours(hole: Hole) -> tuple[tripatch.Fill, Filling]:
    """The fill with all options at their defaults."""
    fill, cpu = timed(lambda _: tripatch.fill(hole.vertices, hole.faces, rim=hole.rim))
    triangles = [(f[0], f[k], f[k + 1]) for f in fill.faces for k in range(1, len(f) - 1)]
    return fill, Filling(np.concatenate([hole.vertices, fill.vertices]), np.array(triangles), cpu)


def program(path: str, option: int) -> Callable:
    """cgal_fill with a continuity, or pmp_fill with a k."""

    def fill(hole: Hole, _) -> Filling:
        with tempfile.TemporaryDirectory() as folder:
            given, made = Path(folder, "given"), Path(folder, "made")
            with given.open("w") as file:
                print(len(hole.vertices), len(hole.faces), file=file)
                np.savetxt(file, hole.vertices, fmt="%.17g")
                np.savetxt(file, hole.faces, fmt="%d")
                print(*hole.rim[:2], file=file)
            command = [path, given, str(option), str(REPETITIONS), made]
            words = output_of(command).split()
            with made.open() as file:
                count, triangles = map(int, file.readline().split())
                vertices = np.loadtxt(file, max_rows=count)
                faces = np.loadtxt(file, dtype=int, max_rows=triangles, ndmin=2)
        return filling(hole, vertices, faces, min(map(float, words[1:])))

    return fill


def command(words: str) -> Callable:
    """Any program that reads a mesh with a hole from IN.obj and writes the filled mesh to OUT.obj. Its start counts."""

    def fill(hole: Hole, _) -> Filling:
        with tempfile.TemporaryDirectory() as folder:
            given, made = Path(folder, "in.obj"), Path(folder, "out.obj")
            lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in hole.vertices.tolist()]
            lines += [f"f {a} {b} {c}" for a, b, c in (hole.faces + 1).tolist()]
            given.write_text("\n".join(lines) + "\n")
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            output_of([*shlex.split(words), given, made])
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            mesh = files.read(made)
        faces = [(f[0], f[k], f[k + 1]) for f in mesh.faces for k in range(1, len(f) - 1)]
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return filling(hole, mesh.vertices, faces, cpu)

    return fill


# -------------------------------------------------------------------------------------------------------------- Python packages


def membrane(triangles, values, count: int) -> np.ndarray:
    """Values (n, d) at vertices, those from `count` on made the mean of their neighbors."""
    i, j = np.concatenate([triangles[:, [a, b]] for a in range(3) for b in range(3) if a != b]).T
    weights = coo_matrix((np.ones(len(i)), (i, j)), shape=(len(values),) * 2).tocsr()
    weights.data[:] = 1
    laplace = (diags(np.asarray(weights.sum(1)).ravel()) - weights)[count:]
    out = values.astype(float)
    out[count:] = np.reshape(spsolve(laplace[:, count:].tocsc(), -laplace[:, :count] @ out[:count]), (-1, values.shape[1]))
    return out


def libigl(hole: Hole, fill: tripatch.Fill, k: int) -> Filling:
    """k-harmonic positions over TriPatch's triangles, which begin as a membrane; the four rings around are held."""
    import igl

    used, faces, _ = part_around(hole)
    new = np.array([(f[0], f[j], f[j + 1]) for f in fill.faces for j in range(1, len(f) - 1)])
    count, added = len(used), len(fill.vertices)
    new = np.where(new < len(hole.vertices), np.searchsorted(used, np.minimum(new, used[-1])), new - len(hole.vertices) + count)
    if not added:
        raise RuntimeError("no vertices to place")
    start = membrane(new, np.concatenate([hole.vertices[used], np.zeros((added, 3))]), count)
    whole, held = np.concatenate([faces, new]), np.arange(count)
    vertices, cpu = timed(lambda _: igl.harmonic(start, whole, held, start[:count], k))
    index = np.concatenate([used, len(hole.vertices) + np.arange(added)])
    return filling(hole, np.concatenate([hole.vertices, vertices[count:]]), index[new], cpu)


def meshlab(hole: Hole, _) -> Filling:
    """Close Holes, refined to the mean edge of the rim."""
    import pymeshlab

    used, faces, rim = part_around(hole)
    edge = float(np.linalg.norm(hole.vertices[hole.rim] - np.roll(hole.vertices[hole.rim], -1, axis=0), axis=1).mean())
    options = {"maxholesize": len(rim) + 1, "refinehole": True, "refineholeedgelen": pymeshlab.PureValue(edge)}

    def prepared():
        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(hole.vertices[used], faces))
        return meshes

    def close(meshes):
        meshes.meshing_close_holes(**options)
        return meshes

    meshes, cpu = timed(close, prepared)
    made = meshes.current_mesh()  # as long as there is its set
    return filling(hole, made.vertex_matrix(), made.face_matrix(), cpu)


def meshfix(hole: Hole, _) -> Filling:
    """fill_small_boundaries, refined."""
    import pymeshfix

    used, faces, rim = part_around(hole)

    def prepared():
        mesh = pymeshfix.PyTMesh()
        mesh.set_quiet(True)
        mesh.load_array(hole.vertices[used], faces.astype(np.int32))
        return mesh

    def close(mesh):
        mesh.fill_small_boundaries(len(rim) + 1, True)
        return mesh

    mesh, cpu = timed(close, prepared)
    return filling(hole, *mesh.return_arrays(), cpu)


def meshlib(hole: Hole, _) -> Filling:
    """fillHoleNicely, its edges as long as the longest of the rim."""
    from meshlib import mrmeshnumpy, mrmeshpy

    used, faces, rim = part_around(hole)
    edges = np.linalg.norm(hole.vertices[hole.rim] - np.roll(hole.vertices[hole.rim], -1, axis=0), axis=1)

    def prepared():
        mesh = mrmeshnumpy.meshFromFacesVerts(faces, hole.vertices[used])
        ends = {mesh.topology.org(e).get(): e for e in mesh.topology.findHoleRepresentiveEdges()}
        settings = mrmeshpy.FillHoleNicelySettings()
        settings.triangulateParams.metric = mrmeshpy.getUniversalMetric(mesh)
        settings.subdivideSettings.maxEdgeLen = 1.001 * float(edges.max())  # with less it splits the rim
        return mesh, next(e for v, e in ends.items() if v in set(rim.tolist())), settings

    def close(given):
        mrmeshpy.fillHoleNicely(*given)
        return given[0]

    mesh, cpu = timed(close, prepared)
    return filling(hole, mrmeshnumpy.getNumpyVerts(mesh), mrmeshnumpy.getNumpyFaces(mesh.topology), cpu)


# ----------------------------------------------------------------------------------------------------------------- Blender

_BLENDER = """
import json, sys, time
import bmesh, bpy
given, made = sys.argv[sys.argv.index("--") + 1 :]
results = {}
for mode in ("fill", "grid"):
    hole = json.load(open(given))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(hole["vertices"], [], hole["faces"])
    thing = bpy.data.objects.new("mesh", mesh)
    bpy.context.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type="EDGE")
    bpy.ops.mesh.select_all(action="DESELECT")
    bm = bmesh.from_edit_mesh(mesh)
    bm.verts.ensure_lookup_table()
    rim = [bm.verts[v] for v in hole["rim"]]
    for a, b in zip(rim, rim[1:] + rim[:1]):
        bm.edges.get((a, b)).select = True
    bm.select_flush_mode()
    bmesh.update_edit_mesh(mesh)
    start = time.process_time()
    try:
        if mode == "fill":
            bpy.ops.mesh.fill(use_beauty=True)
        else:
            bpy.ops.mesh.fill_grid(span=len(rim) // 4)
    except RuntimeError as error:
        print(mode, error)
    seconds = time.process_time() - start
    bm = bmesh.from_edit_mesh(mesh)
    bmesh.ops.triangulate(bm, faces=[f for f in bm.faces if len(f.verts) > 3])
    bmesh.update_edit_mesh(mesh)
    bpy.ops.object.mode_set(mode="OBJECT")
    results[mode] = [[v.co[:] for v in mesh.vertices], [p.vertices[:] for p in mesh.polygons], seconds]
json.dump(results, open(made, "w"))
"""


def run_blender(program: str, script: str, *arguments) -> None:
    """A script in a Blender without a window; its arguments come behind --."""
    with tempfile.NamedTemporaryFile("w", suffix=".py") as file:
        file.write(script)
        file.flush()
        words = [program, "--background", "--factory-startup", "--python-exit-code", "1", "--python", file.name, "--"]
        subprocess.run([*words, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL, timeout=STUCK)


class Blender:
    """Fill and Grid Fill; both are made in one start of the program."""

    def __init__(self, program: str) -> None:
        self.program, self.hole, self.made = program, None, {}

    def fill(self, hole: Hole, _, mode: str) -> Filling:
        if self.hole is not hole:
            used, faces, rim = part_around(hole)
            with tempfile.TemporaryDirectory() as folder:
                given, made = Path(folder, "given"), Path(folder, "made")
                data = {"vertices": hole.vertices[used], "faces": faces, "rim": rim}
                given.write_text(json.dumps({key: value.tolist() for key, value in data.items()}))
                self.hole, self.made = hole, {}
                run_blender(self.program, _BLENDER, given, made)
                self.made = json.loads(made.read_text())
        if mode not in self.made:
            raise RuntimeError("Blender ended with an error")
        return filling(hole, *self.made[mode])


# --------------------------------------------------------------------------------------------------------------------- all


def available(cgal: str, pmp: str, blender: str, commands: dict[str, str]) -> tuple[dict, dict[str, str], list[str]]:
    """Name -> (hole, TriPatch's fill) -> Filling; program -> its version; and what is skipped, with the reason."""
    found: dict[str, Callable] = {}
    versions: dict[str, str] = {}
    skipped: list[str] = []
    for name, path, word, options in (("CGAL", cgal, "continuity", (1, 2)), ("PMP", pmp, "k =", (2, 3))):
        if path:
            versions[name] = subprocess.run([path], capture_output=True, text=True).stdout.strip()
            found |= {f"{name}, {word} {k}": program(path, k) for k in options}
        else:
            skipped.append(f"{name}: " + {"CGAL": "libcgal-dev is not installed", "PMP": "PMP_SOURCE names no source tree"}[name])
    packages = {
        "libigl": ("igl", "libigl", {f"libigl, k = {k}": functools.partial(libigl, k=k) for k in (2, 3)}),
        "MeshLab": ("pymeshlab", "pymeshlab", {"MeshLab": meshlab}),
        "MeshFix": ("pymeshfix", "pymeshfix", {"MeshFix": meshfix}),
        "MeshLib": ("meshlib.mrmeshpy", "meshlib", {"MeshLib": meshlib}),
    }
    from . import occ

    packages["OpenCASCADE"] = ("OCP", "cadquery-ocp", occ.SETTINGS)
    for name, (module, package, functions) in packages.items():
        try:  # here, so that not every process of its own takes the time
            importlib.import_module(module)
        except ImportError:
            skipped.append(f"{name}: {package} is not installed")
            continue
        versions[name] = importlib.metadata.version(package)
        found |= {key: lambda hole, fill, f=f: apart(lambda: f(hole, fill)) for key, f in functions.items()}
    if blender:
        versions["Blender"] = subprocess.run([blender, "--version"], capture_output=True, text=True).stdout.split()[1]
        both = Blender(blender)
        found |= {
            f"Blender, {name}": functools.partial(both.fill, mode=mode)
            for name, mode in (("Fill", "fill"), ("Grid Fill", "grid"))
        }
    else:
        skipped.append("Blender: not installed")
    return found | {name: command(words) for name, words in commands.items()}, versions, skipped
