"""Time to read the limit surface around a hole in a cage of 100,000 faces, against Blender's modifier at level 3 on that cage.

    PYTHONPATH=native/python python native/benchmarks/limit.py        # with bpy
    blender --background --factory-startup --python-expr "import sys; sys.path.insert(0, 'native/python')" \\
        --python native/benchmarks/limit.py
"""

import statistics
import time

import bpy  # makes bmesh importable

import bmesh  # isort: skip
import numpy as np
import tripatch
from tripatch import _arrays, _native
from tripatch.options import subdivision


def cage(n=129):
    """A sphere of 6 n^2 quads without the faces around one of the cube's corners: an object."""
    bm = bmesh.new()
    bmesh.ops.create_cube(bm, size=2)
    bmesh.ops.subdivide_edges(bm, edges=bm.edges, cuts=n - 1, use_grid_fill=True)
    corner = next(v for v in bm.verts if len(v.link_faces) == 3)
    for v in bm.verts:
        v.co.normalize()
    near = set(corner.link_faces)
    near |= {f for face in near for v in face.verts for f in v.link_faces}
    bmesh.ops.delete(bm, geom=list(near), context="FACES")
    mesh = bpy.data.meshes.new("Cage")
    bm.to_mesh(mesh)
    bm.free()
    ob = bpy.data.objects.new("Cage", mesh)
    bpy.context.collection.objects.link(ob)
    return ob


def seconds(run, times=5):
    taken = []
    for _ in range(times):
        start = time.perf_counter()
        run()
        taken.append(time.perf_counter() - start)
    return statistics.median(taken)


def main():
    ob = cage()
    mesh = ob.data
    vertices = np.empty(3 * len(mesh.vertices))
    mesh.vertices.foreach_get("co", vertices)
    faces = np.empty(4 * len(mesh.polygons), np.int64)
    mesh.loops.foreach_get("vertex_index", faces)
    arrays = _arrays.mesh(vertices.reshape(-1, 3), faces.reshape(-1, 4))
    rim = tripatch.find_holes(faces.reshape(-1, 4))[0].tolist()
    modifier = ob.modifiers.new("Subdivision", "SUBSURF")

    def blender():
        modifier.levels = 0
        bpy.context.view_layer.update()
        start = time.perf_counter()
        modifier.levels = 3
        points = len(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices)
        assert points > 60 * len(mesh.vertices), points
        return time.perf_counter() - start

    drawn = statistics.median(blender() for _ in range(3))
    settings = subdivision({}, 3)
    rim_edges = set(zip(rim[1:] + rim[:1], rim, strict=True))
    beside = [
        (f, k) for f, face in enumerate(faces.reshape(-1, 4).tolist()) for k in range(4) if (face[k], face[k - 3]) in rim_edges
    ]
    places = np.linspace(0, 1, 9).tolist()

    def read():
        surface = _native.LimitSurface(*arrays, settings, rim)
        for face, edge in beside:
            surface.evaluate_edge(face, edge, places)

    limit = seconds(read)
    options = {"rim": rim, "corners": rim[:: len(rim) // 3], "surroundings": "limit", "level": 3}
    fill = seconds(lambda: tripatch.fill(arrays[0], faces.reshape(-1, 4), **options), 3)
    assert len(beside) == len(rim)
    print(f"{len(mesh.polygons)} faces, a rim of {len(rim)} edges; Blender {bpy.app.version_string}, OpenSubdiv in both")
    print(f"  the modifier at level 3           {1e3 * drawn:8.1f} ms")
    print(f"  the limit surface along the rim   {1e3 * limit:8.1f} ms, 1/{drawn / limit:.0f}")
    print(f"  the whole fill                    {1e3 * fill:8.1f} ms, 1/{drawn / fill:.0f}")


main()
