"""Smooth Fill in holes that the Boolean modifier cut: the faces next to them are concave and have corners in a line."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes
from mathutils import Euler, Vector
from mathutils.bvhtree import BVHTree


def ball_cut_through(radius, turned):
    """A unit ball without what a cylinder cuts off, its walls deleted; in edit mode, the rim of one of the two holes selected."""
    bpy.ops.mesh.primitive_cylinder_add(radius=radius, depth=3, vertices=24, rotation=turned)
    cutter = bpy.context.object
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)
    ball = bpy.context.object
    modifier = ball.modifiers.new("cut", "BOOLEAN")
    modifier.object = cutter
    bpy.ops.object.modifier_apply(modifier=modifier.name)
    bpy.data.objects.remove(cutter)
    (bm,) = scenes.edit(ball, mode="EDGE")
    walls = [f for f in bm.faces if f.calc_center_median().length < 0.97]
    assert walls
    bmesh.ops.delete(bm, geom=walls, context="FACES")
    axis = np.array(Euler(turned).to_matrix())[:, 2]
    scenes.select(bm, edges=[e for e in bm.edges if e.is_boundary and np.dot(axis, e.verts[0].co) > 0])
    bmesh.update_edit_mesh(ball.data)
    return ball


@pytest.mark.parametrize("output", ["auto", "triangles"])
@pytest.mark.parametrize(
    "radius, turned", [(0.3, (0.3, 0.2, 0)), (0.4, (1.3, 0.1, 0.2)), (0.25, (0.8, 0.9, 0)), (0.42, (0.05, 0.02, 0))]
)
def test_the_ball_comes_back(radius, turned, output):
    ball = ball_cut_through(radius, turned)
    options = {} if output == "auto" else {"output": output}
    assert bpy.ops.mesh.fill_smooth(**options) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ball.data)
    new = np.array([v.co for f in bm.faces if f.select for v in f.verts])
    assert len(new) > 50
    height = 1 - np.sqrt(
        1 - radius**2
    )  # of the middle over the rim; new vertices of a plain fill would be so far inside the ball
    assert np.abs(np.linalg.norm(new, axis=1) - 1).max() < 0.01 + 0.12 * height  # the rim itself is up to 0.01 off
    assert not [e for e in bm.edges if len(e.link_faces) > 2]


@pytest.mark.parametrize("output", ["auto", "triangles"])
def test_beside_vertices_that_the_boolean_doubled(output):
    """A cutter upon the axis of the ball meets its meridians at vertices: the rim has edges of no length."""
    ball = ball_cut_through(0.42, (0, 0, 0))
    bm = bmesh.from_edit_mesh(ball.data)
    none = [e for e in bm.edges if e.select and e.calc_length() < 1e-7]
    assert len(none) > 10
    border = sum(e.is_boundary for e in bm.edges)
    rim = sum(e.select for e in bm.edges)
    other = sum(e.is_boundary and not e.select and e.calc_length() > 1e-7 for e in bm.edges)
    options = {} if output == "auto" else {"output": output}
    assert bpy.ops.mesh.fill_smooth(**options) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ball.data)
    assert sum(e.is_boundary for e in bm.edges) == border - rim
    assert not [e for e in bm.edges if len(e.link_faces) > 2]
    new = np.array([v.co for f in bm.faces if f.select for v in f.verts])
    assert np.abs(np.linalg.norm(new, axis=1) - 1).max() < 0.02  # a plain fill is 0.09 off
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.remove_doubles(threshold=1e-5)  # as the warning says
    bm = bmesh.from_edit_mesh(ball.data)
    assert not [e for e in bm.edges if e.calc_length() < 1e-7] and not [f for f in bm.faces if f.calc_area() < 1e-12]
    assert not [e for e in bm.edges if len(e.link_faces) > 2]
    assert sum(e.is_boundary for e in bm.edges) == other


@pytest.mark.parametrize("output", ["auto", "triangles"])
@pytest.mark.parametrize("segments, radius", [(2, 0.337), (2, 0.31), (2, 0.36), (4, 0.3)])
def test_a_ball_cut_out_of_a_bevel(segments, radius, output):
    """The bevel's flat strips meet the hole at angles that differ all along the rim: no reason not to continue from them."""
    bpy.ops.mesh.primitive_cube_add()
    box = bpy.context.object
    bevel = box.modifiers.new("bevel", "BEVEL")
    bevel.segments, bevel.width = segments, 0.35
    bpy.ops.object.modifier_apply(modifier=bevel.name)
    strip = min(box.data.polygons, key=lambda f: (f.center - Vector((0.95, 0, -0.77))).length)
    center = strip.center.copy()
    bpy.ops.mesh.primitive_uv_sphere_add(
        radius=radius, segments=24, ring_count=12, location=center, rotation=strip.normal.to_track_quat("Z", "Y").to_euler()
    )
    cutter = bpy.context.object
    bpy.context.view_layer.objects.active = box
    was = bmesh.new()
    was.from_mesh(box.data)
    tree = BVHTree.FromBMesh(was)
    cut = box.modifiers.new("cut", "BOOLEAN")
    cut.object = cutter
    bpy.ops.object.modifier_apply(modifier=cut.name)
    bpy.data.objects.remove(cutter)
    (bm,) = scenes.edit(box, mode="EDGE")
    inside = [f for f in bm.faces if 0.9 * radius < (f.calc_center_median() - center).length < radius]
    assert len(inside) > 50
    bmesh.ops.delete(bm, geom=inside, context="FACES")
    scenes.select(bm, edges=[e for e in bm.edges if e.is_boundary])
    bmesh.update_edit_mesh(box.data)
    options = {} if output == "auto" else {"output": output}
    assert bpy.ops.mesh.fill_smooth(**options) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(box.data)
    assert not [e for e in bm.edges if e.link_faces and len(e.link_faces) != 2]
    off = [tree.find_nearest(v.co)[3] for f in bm.faces if f.select for v in f.verts]
    assert len(off) > 50 and max(off) < 0.2 * radius
