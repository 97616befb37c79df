#!/usr/bin/env python3
"""Draws what a modeller's tasks look like, filled by the add-on: python scripts/task_pictures.py FOLDER [TASK...], with the
Python of a Blender that is a module (build/env/bpy45).

The tasks are those of tests/blender/tasks.py and, as `rings_3_5_0`, regions of 3 rings of faces round vertices of 5 edges of
subdivided Suzanne. Each picture shows the new faces with their edges, the surface, and zebra stripes; of a cage the surface under
its modifier.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests" / "blender")]

import conftest  # enables the add-on  # noqa: E402

import addon_utils  # isort: skip  # noqa: E402
import bmesh  # noqa: E402
import bpy  # noqa: E402
import numpy as np  # noqa: E402
import tasks  # noqa: E402
from tripatch.canvas import Canvas, png  # noqa: E402
from tripatch.view import picture  # noqa: E402

SIZE = (420, 420)


def arrays(bm):
    """Positions and faces."""
    bm.verts.index_update()
    return np.array([v.co for v in bm.verts]), [[v.index for v in f.verts] for f in bm.faces]


def near(vertices, faces, middle, radius):
    """The part of a mesh near a point."""
    kept = [f for f in faces if np.linalg.norm(vertices[f].mean(axis=0) - middle) < radius]
    used = np.unique(np.concatenate(kept))
    number = {int(v): k for k, v in enumerate(used)}
    return vertices[used], [[number[v] for v in f] for f in kept]


def with_edges(image, vertices, faces, toward, lines):
    """Draws line segments where nothing is before them."""
    canvas = Canvas(vertices, toward, *SIZE)
    canvas.draw(np.array([[f[0], f[i], f[i + 1]] for f in faces for i in range(1, len(f) - 1)]))
    for ends in lines:
        canvas.line(image.reshape(-1, 3), ends, (20, 60, 160), lift=0.03 * np.ptp(canvas.points[:, 2]))
    return image


def drawn(task):
    """(h, w, 3) bytes: three pictures next to each other."""
    ob = task.ob
    bm = bmesh.from_edit_mesh(ob.data)
    bm.normal_update()
    new = [f for f in bm.faces if f.select]
    points = np.array([f.calc_center_median() for f in new])
    middle = points.mean(axis=0)
    normal = np.sum([np.array(f.normal) * f.calc_area() for f in new], axis=0)
    normal /= max(np.linalg.norm(normal), 1e-12)
    side = np.cross(normal, (0.3, 0.2, 1.0))
    toward = normal + 0.45 * side + 0.35 * np.cross(side, normal)
    lines = [tuple(tuple(v.co) for v in e.verts) for e in {e for f in new for e in f.edges}]
    reach = max(np.linalg.norm(np.array([v.co for f in new for v in f.verts]) - middle, axis=1))
    caged = any(m.type in ("SUBSURF", "MIRROR") for m in ob.modifiers)
    if caged:
        bpy.ops.object.mode_set(mode="OBJECT")
        bm = tasks.evaluated(ob)
    mesh = near(*arrays(bm), middle, 1.9 * reach)
    light = {"toward": toward, "size": SIZE}
    plain, _ = picture(*mesh, kind="folds", **light)
    stripes, _ = picture(*mesh, kind="zebra", lines=14, **light)
    return np.hstack([with_edges(plain.copy(), *mesh, toward, lines), plain, stripes])


def rings(valence, count, number):
    """A region of subdivided Suzanne, taken out."""
    import test_suzanne

    bm = tasks.suzanne(2)
    around = [v for v in bm.verts if len(v.link_edges) == valence and test_suzanne.disc(v, count)]
    vertex = around[int(np.random.default_rng(count).permutation(len(around))[number])]
    return tasks.open_up(bm, test_suzanne.disc(vertex, count), tasks.distance_to(bm))


def main(folder, *names):
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    made = {make.__name__: make for make in tasks.ALL}
    for count in (1, 2, 3):
        for valence in (3, 4, 5):
            for k in range(4):
                made[f"rings_{count}_{valence}_{k}"] = lambda v=valence, c=count, k=k: rings(v, c, k)
    for name in names or made:
        if bpy.context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        for each in list(bpy.data.objects):
            bpy.data.objects.remove(each)
        task = made[name]()
        result = bpy.ops.mesh.fill_smooth(**task.options)
        (folder / f"{name}.png").write_bytes(png(drawn(task)))
        print(name, result)


try:
    main(*sys.argv[1:])
finally:
    addon_utils.disable(conftest.ADDON)
