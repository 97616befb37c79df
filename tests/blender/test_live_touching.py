"""Live fills of holes that touch at a vertex."""

import bmesh
import bpy
import numpy as np
import scenes


def touching():
    """A bent sheet of quads with two holes that share a vertex, whose boundaries are selected: in edit mode."""
    n = 12
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij"))
    gone = {(6 + i, 6 + j) for i in range(3) for j in range(3)} | {(5 - i, 5 - j) for i in range(3) for j in range(3)}
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    faces = [
        [int(at[p]) for p in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
        for i in range(n)
        for j in range(n)
        if (i, j) not in gone
    ]
    used = np.unique(faces)
    heights = 0.15 * np.sin(2.3 * x + 0.4) * np.cos(2.1 * y) + 0.1 * x * y
    ob = scenes.add_mesh(np.column_stack([x, y, heights])[used], np.searchsorted(used, faces).tolist())
    (bm,) = scenes.edit(ob, mode="EDGE")
    inner = [e for e in bm.edges if e.is_boundary and max(abs(c) for v in e.verts for c in v.co.xy) < 0.9]
    scenes.select(bm, edges=inner)
    bmesh.update_edit_mesh(ob.data)
    return ob


def test_they_are_as_fills_made_together(live):
    options = {"output": "quads", "method": "polyharmonic_spline"}
    touching()
    assert bpy.ops.mesh.fill_smooth(keep_live=True, **options) == {"FINISHED"}
    kept = [fill for fill in bpy.data.objects if live.is_live(fill)]
    assert len(kept) == 2
    found = {v.co.to_tuple(4) for fill in kept for v in fill.data.vertices}
    bpy.ops.object.mode_set(mode="OBJECT")
    ob = touching()
    assert bpy.ops.mesh.fill_smooth(**options) == {"FINISHED"}
    new = {v.co.to_tuple(4) for f in bmesh.from_edit_mesh(ob.data).faces if f.select for v in f.verts}
    assert found == new
