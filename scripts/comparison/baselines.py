"""Other programs on the same holes: each function takes a hole and gives a Filling, or raises.

Programs on meshes are given the mesh of the surroundings. OpenCASCADE is given three B-spline surfaces interpolated in the hole's
own strips. libigl has no filler of holes: it is given the triangulation of TriPatch's fill, flat, and finds the positions.
"""

from __future__ import annotations

import functools
import importlib.util
import json
import multiprocessing
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .holes import Hole, lattice_triangles, unit
from .metrics import angle, spread

REPETITIONS = 3
PATIENCE = 60  # seconds that a baseline which runs in this process may take


@dataclass
class Filling:
    vertices: np.ndarray  # all, those of the hole's mesh first
    faces: np.ndarray  # the new triangles
    seconds: float  # the least of the repetitions, arrays in to arrays out
    points: np.ndarray | None = None  # of the smooth surface, where there is one, spread evenly
    seam: float | None = None  # the largest angle of the smooth surface to the true planes, degrees, sides without their ends


def _filling(hole: Hole, vertices, faces, seconds, **more) -> Filling:
    """Turns the triangles so that they run along the rim."""
    faces = np.asarray(faces)
    edges = {(f[k], f[(k + 1) % 3]) for f in faces.tolist() for k in range(3)}
    along = sum(pair in edges for pair in zip(hole.rim.tolist(), np.roll(hole.rim, -1).tolist()))
    if not along and not len(faces):
        raise RuntimeError("nothing was filled")
    return Filling(np.asarray(vertices), faces if 2 * along > len(hole.rim) else faces[:, ::-1], seconds, **more)


def _timed(call):
    """What it returns, and the least seconds of some calls (of one, if it takes long)."""
    least = np.inf
    for _ in range(REPETITIONS):
        start = time.perf_counter()
        result = call()
        least = min(least, time.perf_counter() - start)
        if least > 0.5:
            break
    return result, least


def _apart(call):
    """What it returns in a process of its own, which may crash or take too long."""
    processes = multiprocessing.get_context("fork")
    answer, question = processes.Pipe(duplex=False)
    process = processes.Process(target=lambda: question.send(call()))
    process.start()
    question.close()
    try:
        if not answer.poll(PATIENCE):
            raise RuntimeError(f"no answer within {PATIENCE} s")
        return answer.recv()
    except EOFError:
        raise RuntimeError("failed") from None
    finally:
        process.kill()
        process.join()


# ------------------------------------------------------------------------------------------------------------ CGAL and PMP


def write_hole(hole: Hole, path: Path) -> None:
    """For cgal_fill and pmp_fill."""
    with path.open("w") as file:
        print(len(hole.vertices), len(hole.faces), file=file)
        np.savetxt(file, hole.vertices, fmt="%.17g")
        np.savetxt(file, hole.faces, fmt="%d")
        print(*hole.rim[:2], file=file)


def version(path: str) -> str:
    return subprocess.run([path], capture_output=True, text=True).stdout.strip()


def program(path: str, option: int) -> Callable:
    """cgal_fill with a continuity, or pmp_fill with a k."""

    def fill(hole: Hole, _) -> Filling:
        with tempfile.TemporaryDirectory() as folder:
            given, made = Path(folder, "given"), Path(folder, "made")
            write_hole(hole, given)
            command = [path, given, str(option), str(REPETITIONS), made]
            words = subprocess.run(command, check=True, capture_output=True, text=True, timeout=60).stdout.split()
            with made.open() as file:
                count, triangles = map(int, file.readline().split())
                vertices = np.loadtxt(file, max_rows=count)
                faces = np.loadtxt(file, dtype=int, max_rows=triangles)
        return _filling(hole, vertices, faces, min(map(float, words[1:])))

    return fill


# ------------------------------------------------------------------------------------------------------------------ libigl


def _flat(hole: Hole, fill):
    """Triangles in an equilateral triangle, and their places in the plane by vertex of the whole mesh: the regular grid where the
    sides have as many edges, else what TriPatch's fill has; of other than three sides in that fill's polygon."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0.5, np.sqrt(0.75), 0)])
    n, count = hole.counts[0], len(hole.vertices)
    if len(hole.counts) != 3:
        places = np.full((count + len(fill.uv), 3), np.nan)
        places[fill.rim], places[count:] = np.pad(fill.rim_uv, [(0, 0), (0, 1)]), np.pad(fill.uv, [(0, 0), (0, 1)])
        return places, np.array(fill.faces)
    if set(hole.counts) != {n}:
        places = np.full((count + len(fill.barycentric), 3), np.nan)
        places[fill.rim], places[count:] = fill.rim_barycentric @ corners, fill.barycentric @ corners
        return places, np.array(fill.faces)
    grid = {}  # steps towards corners 1 and 2 -> vertex; the rim runs from corner 0 to 1 to 2
    for k in range(n):
        grid[k, 0], grid[n - k, k], grid[0, n - k] = hole.rim[k], hole.rim[n + k], hole.rim[2 * n + k]
    inside = [(a, b) for b in range(1, n) for a in range(1, n - b)]
    grid |= {at: count + k for k, at in enumerate(inside)}
    places = np.full((count + len(inside), 3), np.nan)
    for (a, b), v in grid.items():
        places[v] = np.array([n - a - b, a, b]) / n @ corners
    return places, lattice_triangles(grid)


def _harmonic(places, faces, fixed, values):
    """Values (k, d) at vertices `fixed` of flat triangles, made harmonic over all of them."""
    import igl

    used, local = np.unique(faces, return_inverse=True)
    index = np.full(len(places), -1)
    index[used] = np.arange(len(used))
    found = igl.harmonic(places[used], local.reshape(faces.shape), index[fixed], np.ascontiguousarray(values), 1)
    out = np.full((len(places), values.shape[1]), np.nan)
    out[used] = found
    return out


def libigl(hole: Hole, fill, k: int) -> Filling:
    """k-harmonic positions over a flat triangulation, the whole mesh around held."""
    import igl

    places, new = _flat(hole, fill)
    faces, held = np.concatenate([hole.faces, new]), np.arange(len(hole.vertices))

    def solve():
        start = _harmonic(places, new, hole.rim, hole.vertices[hole.rim])
        start[: len(hole.vertices)] = hole.vertices
        return igl.harmonic(start, faces, held, hole.vertices, k)

    vertices, seconds = _timed(solve)
    return _filling(hole, vertices, new, seconds)


# ------------------------------------------------------------------------------------------------------------- OpenCASCADE

#: arguments of BRepOffsetAPI_MakeFilling for a hole of diameter 1: degree, points on curves, iterations, anisotropic, tolerances
#: in 2D and 3D, of angle and curvature, greatest degree, greatest segments
OCCT = {
    "default": (),
    "finer": (3, 30, 2, False, 1e-5, 1e-5, 1e-3, 0.1, 8, 30),
    "finest": (4, 40, 4, False, 1e-6, 1e-6, 1e-4, 0.01, 8, 60),
}
DEPTH = 0.25  # of the strips


def _strip_face(hole: Hole, i):
    """A B-spline surface through points of the strip, as a face, and its edge along the side."""
    from OCP.Approx import Approx_ParametrizationType
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.collections import Array2_gp_Pnt
    from OCP.GeomAPI import GeomAPI_PointsToBSplineSurface
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    s, d = np.linspace(0, 1, 65), np.linspace(0, DEPTH, 9)
    points = hole.strip(i, np.repeat(s, len(d)), np.tile(d, len(s)))[0].reshape(len(s), len(d), 3)
    grid = Array2_gp_Pnt(1, len(s), 1, len(d))
    for a, row in enumerate(points.tolist()):
        for b, p in enumerate(row):
            grid.SetValue(a + 1, b + 1, gp_Pnt(*p))
    through = GeomAPI_PointsToBSplineSurface()
    # with its default, parameters by chord length, these surfaces are off by up to 12 degrees
    through.Interpolate(grid, Approx_ParametrizationType.Approx_IsoParametric)
    face = BRepBuilderAPI_MakeFace(through.Surface(), 1e-7).Face()
    middle, edges = points[len(s) // 2, 0], []
    explorer = TopExp_Explorer(face, TopAbs_EDGE)
    while explorer.More():
        edge = TopoDS.Edge(explorer.Current())
        curve = BRepAdaptor_Curve(edge)
        p = curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2)
        edges.append((np.linalg.norm(middle - [p.X(), p.Y(), p.Z()]), edge))
        explorer.Next()
    return face, min(edges, key=lambda pair: pair[0])[1]


def occt(hole: Hole, fill, setting: str) -> Filling:
    """BRepOffsetAPI_MakeFilling with G1 to the three strips; its surface over a flat triangulation."""
    if hole.strip is None:
        raise RuntimeError("no smooth surroundings")
    import OCP  # noqa: F401 - here, so that not every process takes the time

    return _apart(lambda: _occt(hole, fill, setting))


def _occt(hole, fill, setting):
    from OCP.BRep import BRep_Tool
    from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeFilling
    from OCP.GeomAbs import GeomAbs_Shape
    from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
    from OCP.gp import gp_Pnt, gp_Vec
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    sides = range(len(hole.counts))
    strips = [_strip_face(hole, i) for i in sides]
    options = list(OCCT[setting])
    if options:
        options[5] *= hole.diameter

    def build():
        filling = BRepOffsetAPI_MakeFilling(*options)
        for face, edge in strips:
            filling.Add(edge, face, GeomAbs_Shape.GeomAbs_G1)
        filling.Build()
        if not filling.IsDone():
            raise RuntimeError("not done")
        return BRep_Tool.Surface_s(TopoDS.Face(TopExp_Explorer(filling.Shape(), TopAbs_FACE).Current()))

    surface, seconds = _timed(build)

    def evaluate(uv):
        points = [surface.Value(u, v) for u, v in uv.tolist()]
        return np.array([(p.X(), p.Y(), p.Z()) for p in points])

    def parameters(points):
        return np.array([GeomAPI_ProjectPointOnSurf(gp_Pnt(*p), surface).LowerDistanceParameters()[-2:] for p in points.tolist()])

    def normals(uv):
        out, p, du, dv = [], gp_Pnt(), gp_Vec(), gp_Vec()
        for u, v in uv.tolist():
            surface.D1(u, v, p, du, dv)
            n = du.Crossed(dv)
            out.append((n.X(), n.Y(), n.Z()))
        return unit(np.array(out))

    t = np.linspace(0, 1, 22)[1:-1]
    rims, true = zip(*(hole.strip(i, t, np.zeros(len(t))) for i in sides))
    found, true = normals(parameters(np.concatenate(rims))), np.concatenate(true)
    seam = angle(found * np.sign((found * true).sum()), true).max()

    places, faces = _flat(hole, fill)
    uv = _harmonic(places, faces, hole.rim, parameters(hole.vertices[hole.rim]))
    vertices = np.concatenate([hole.vertices, evaluate(uv[len(hole.vertices) :])])
    hit, weights = spread(vertices[faces])
    points = evaluate(np.einsum("nk,nkd->nd", weights, uv[faces[hit]]))
    return _filling(hole, vertices, faces, seconds, points=points, seam=seam)


# ----------------------------------------------------------------------------------------------------------------- Blender

_BLENDER = """
import json, sys, time
import bmesh, bpy
given, made = sys.argv[sys.argv.index("--") + 1 :]
results = {}
for name, hole in json.load(open(given)).items():
    for mode in ("fill", "grid"):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(hole["vertices"], [], hole["faces"])
        thing = bpy.data.objects.new(name, mesh)
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
        start = time.perf_counter()
        try:
            if mode == "fill":
                bpy.ops.mesh.fill(use_beauty=True)
            else:
                bpy.ops.mesh.fill_grid(span=len(rim) // 4)
        except RuntimeError as error:
            print(name, mode, error)
        seconds = time.perf_counter() - start
        bm = bmesh.from_edit_mesh(mesh)
        bmesh.ops.triangulate(bm, faces=[f for f in bm.faces if len(f.verts) > 3])
        bmesh.update_edit_mesh(mesh)
        bpy.ops.object.mode_set(mode="OBJECT")
        results[name + " " + mode] = [[v.co[:] for v in mesh.vertices], [p.vertices[:] for p in mesh.polygons], seconds]
json.dump({"version": bpy.app.version_string, "fills": results}, open(made, "w"))
"""


def blender(holes: dict, program: str) -> tuple[str, dict]:
    """Blender's Fill and Grid Fill on every hole, in one start of it: its version, and (name, "fill" or "grid") -> Filling."""
    out = {}
    with tempfile.TemporaryDirectory() as folder:
        given, made, script = (Path(folder, name) for name in ("given", "made", "script.py"))
        script.write_text(_BLENDER)
        data = {k: {"vertices": h.vertices.tolist(), "faces": h.faces.tolist(), "rim": h.rim.tolist()} for k, h in holes.items()}
        given.write_text(json.dumps(data))
        command = [program, "--background", "--factory-startup", "--python-exit-code", "1", "--python", script, "--", given, made]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=300)
        results = json.loads(made.read_text())
    for name, hole in holes.items():
        old = {frozenset(f) for f in hole.faces.tolist()}
        for mode in ("fill", "grid"):
            vertices, faces, seconds = results["fills"][f"{name} {mode}"]
            new = [f for f in faces if frozenset(f) not in old]
            if new:
                vertices = np.concatenate(
                    [hole.vertices, np.reshape(vertices, (-1, 3))[len(hole.vertices) :]]
                )  # given ones unrounded
                out[name, mode] = _filling(hole, vertices, new, seconds)
    return results["version"], out


# ------------------------------------------------------------------------------------------------------------------ all


def available(cgal: str | None, pmp: str | None) -> dict:
    """name -> (hole, TriPatch's fill) -> Filling, of the baselines that can be run one hole at a time."""
    found = {}
    for k in (1, 2) if cgal else ():
        found[f"CGAL, continuity {k}"] = program(cgal, k)
    for k in (2, 3) if pmp else ():
        found[f"PMP, k = {k}"] = program(pmp, k)
    if importlib.util.find_spec("igl"):
        found |= {f"libigl, k = {k}": functools.partial(libigl, k=k) for k in (2, 3)}
    if importlib.util.find_spec("OCP"):
        found |= {f"OpenCASCADE, {setting}": functools.partial(occt, setting=setting) for setting in OCCT}
    return found
