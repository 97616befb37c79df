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


def l_shaped_hole(shape_key=None):
    """A grid of which an L is deleted; shape_key: heights in another shape. Returns it and the middles of the L's faces."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=12, y_subdivisions=12, size=12)
    ob = bpy.context.object
    if shape_key:
        ob.shape_key_add(name="Basis", from_mix=False)
        key = ob.shape_key_add(name="Wave", from_mix=False)
        for v, point in zip(ob.data.vertices, key.data, strict=True):
            point.co.z = shape_key(v.co.x, v.co.y)
        ob.active_shape_key_index = 0
    (bm,) = scenes.edit(ob, mode="FACE")
    middles = {f: f.calc_center_median() for f in bm.faces}
    chosen = [f for f, m in middles.items() if abs(m.x) < 2.6 and abs(m.y) < 2.6 and (m.x < 0 or m.y < 0)]
    places = np.array([middles[f] for f in chosen])
    edges = {e for f in chosen for e in f.edges}
    scenes.select(bm, edges=[e for e in edges if sum(f in chosen for f in e.link_faces) == 1])
    bmesh.ops.delete(bm, geom=chosen, context="FACES")
    bmesh.update_edit_mesh(ob.data)
    return ob, places


def test_an_outline_that_is_no_block_comes_back_in_every_shape_key():
    def height(x, y):
        return np.sin(x) + 0.3 * y * y + 0.1 * x * y

    ob, places = l_shaped_hole(height)
    assert bpy.ops.mesh.fill_smooth(output="quads") == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    new = [f for f in bm.faces if f.select]
    found = np.array([f.calc_center_median() for f in new])
    assert len(new) == len(places) and all(len(f.verts) == 4 for f in new)
    assert np.linalg.norm(found[:, None] - places[None], axis=-1).min(axis=1).max() < 1e-5
    wave = bm.verts.layers.shape["Wave"]
    for v in {v for f in new for v in f.verts}:
        assert abs(v[wave].z - height(v.co.x, v.co.y)) < 1e-4


def test_creases_go_on_past_the_corner_of_a_box():
    """As they are marked around, the three edges of a box are where its corner is filled."""
    bpy.ops.mesh.primitive_cube_add()
    ob = bpy.context.object
    (bm,) = scenes.edit(ob, mode="FACE")
    bmesh.ops.subdivide_edges(bm, edges=bm.edges[:], cuts=5, use_grid_fill=True)
    for e in bm.edges:
        if e.calc_face_angle() > 1:
            e.smooth = False
    chosen = [f for f in bm.faces if min(f.calc_center_median()) > 0]
    sharp = {tuple(np.round(sum((v.co for v in e.verts), e.verts[0].co * 0), 4)) for f in chosen for e in f.edges if not e.smooth}
    edges = {e for f in chosen for e in f.edges}
    rim = [e for e in edges if sum(f in chosen for f in e.link_faces) == 1]
    scenes.select(bm, edges=rim)
    bmesh.ops.delete(bm, geom=chosen, context="FACES")
    bmesh.update_edit_mesh(ob.data)
    assert bpy.ops.mesh.fill_smooth(output="quads") == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    assert len(bm.faces) == 6 * 36 and all(len(f.verts) == 4 for f in bm.faces)
    new = {
        tuple(np.round(sum((v.co for v in e.verts), e.verts[0].co * 0), 4))
        for f in bm.faces
        if f.select
        for e in f.edges
        if not e.smooth
    }
    assert sharp <= new and len(sharp) == 9
