"""Smooth Fill in the place of a block of quads: what was there comes back, with its data."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes


def torus():
    """With UVs, its faces around one place deleted; returns the object, positions and UVs that were there, and the rim."""
    bpy.ops.mesh.primitive_torus_add(major_segments=32, minor_segments=16)
    ob = bpy.context.object
    (bm,) = scenes.edit(ob, mode="FACE")
    bm.faces.ensure_lookup_table()
    uv = bm.loops.layers.uv.active
    before = {tuple(np.round(f.calc_center_median(), 5)): [tuple(loop[uv].uv) for loop in f.loops] for f in bm.faces}
    start = next(f for f in bm.faces if all(0.2 < loop[uv].uv.x < 0.4 and 0.3 < loop[uv].uv.y < 0.6 for loop in f.loops))
    chosen = {start}
    for _ in range(2):
        chosen |= {f for face in chosen for v in face.verts for f in v.link_faces}
    assert len(chosen) == 25
    places = np.array([f.calc_center_median() for f in chosen])
    edges = {e for f in chosen for e in f.edges}
    rim = [e for e in edges if sum(f in chosen for f in e.link_faces) == 1]
    scenes.select(bm, edges=rim)
    bmesh.ops.delete(bm, geom=list(chosen), context="FACES_ONLY")
    bmesh.ops.delete(bm, geom=[v for v in bm.verts if not v.link_faces], context="VERTS")
    for e in [e for e in bm.edges if not e.link_faces]:
        bm.edges.remove(e)
    bmesh.update_edit_mesh(ob.data)
    return ob, places, before


def test_a_block_of_a_torus_comes_back_with_its_uvs():
    ob, places, before = torus()
    assert bpy.ops.mesh.fill_smooth(output="quads") == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    new = [f for f in bm.faces if f.select]
    assert len(new) == 25 and all(len(f.verts) == 4 for f in new)
    found = np.array([f.calc_center_median() for f in new])
    off = np.linalg.norm(found[:, None] - places[None], axis=-1).min(axis=1)
    assert off.max() < 2e-3
    uv = bm.loops.layers.uv.active
    keys = np.array(list(before))
    for f in new:
        old = before[tuple(keys[np.linalg.norm(keys - np.array(f.calc_center_median()), axis=1).argmin()])]
        middle = np.mean([loop[uv].uv for loop in f.loops], axis=0)
        assert np.abs(middle - np.mean(old, axis=0)).max() < 2e-3


@pytest.mark.parametrize("rows", [0, 2])
def test_by_hand_the_panel_may_ask_for_rows_and_for_bulge(rows):
    ob, _places, _ = torus()
    assert bpy.ops.mesh.fill_smooth(output="quads", rows=rows, bulge=1.2) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    assert sum(f.select for f in bm.faces) >= 25
