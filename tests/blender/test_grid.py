"""Grids of quads between four corners, as Grid Fill has them."""

from collections import Counter

import bmesh
import bpy
import pytest
import scenes

smooth = bpy.ops.mesh.fill_smooth


def dome_of_triangles(n=16, wide=8, high=6):
    """A dome with a rectangular hole of so many edges, among triangles."""
    bm = bmesh.new()
    bmesh.ops.create_grid(bm, x_segments=n, y_segments=n, size=1.0)
    for v in bm.verts:
        v.co.z = 0.3 * v.co.x**2 - 0.2 * v.co.y**2
    middles = {f: f.calc_center_median() for f in bm.faces}
    gone = [f for f, c in middles.items() if abs(c.x) < wide / n and abs(c.y) < high / n]
    bmesh.ops.delete(bm, geom=gone, context="FACES")
    bmesh.ops.triangulate(bm, faces=bm.faces)
    mesh = bpy.data.meshes.new("Dome")
    bm.to_mesh(mesh)
    bm.free()
    ob = bpy.data.objects.new("Dome", mesh)
    bpy.context.collection.objects.link(ob)
    return ob


def fill(ob, chosen, **options):
    """Fills the hole of which these vertices are selected; returns the corners (x, y) of each new face. Ends in object mode."""
    (bm,) = scenes.edit(ob, mode="VERT")
    for v in bm.verts:
        v.select = v.is_boundary and max(abs(v.co.x), abs(v.co.y)) < 0.9 and chosen(v.co)
    bm.select_flush_mode()
    bmesh.update_edit_mesh(ob.data)
    before = len(bm.faces)
    assert smooth("EXEC_DEFAULT", True, output="quads", **options) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    faces = [[(round(v.co.x, 3), round(v.co.y, 3)) for v in face.verts] for face in list(bm.faces)[before:]]
    bpy.ops.object.mode_set(mode="OBJECT")
    return faces


def single(faces):
    """Places with one of the faces: corners of a grid."""
    count = Counter(place for face in faces for place in face)
    return {place for place, n in count.items() if n == 1}


def test_four_picked_corners_get_a_grid(addon):
    faces = fill(dome_of_triangles(), lambda co: abs(co.x) > 0.49 and abs(co.y) > 0.37)
    assert len(faces) == 8 * 6
    assert single(faces) == {(x, y) for x in (-0.5, 0.5) for y in (-0.375, 0.375)}


@pytest.mark.parametrize("span", [4, 6, 8])
def test_span_and_slide_corners_place_a_grid(addon, span):
    faces = fill(dome_of_triangles(), lambda co: True, span=span)
    assert len(faces) == span * (14 - span) and all(len(face) == 4 for face in faces)
    corners = single(faces)
    assert len(corners) == 4
    slid = fill(dome_of_triangles(), lambda co: True, span=span, corner_offset=1)
    assert len(slid) == span * (14 - span) and not corners & single(slid)


def test_a_span_that_leaves_nothing_for_the_other_sides_changes_nothing(addon):
    assert len(fill(dome_of_triangles(), lambda co: True, span=14)) == len(fill(dome_of_triangles(), lambda co: True))
