"""Open ends of tubes in Blender: flat lids with sharp edges, and domes."""

import bmesh
import bpy
import pytest
import scenes


def open_cylinder(smooth, sides=32):
    """A cylinder without its top, whose rim is selected; returns the object."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=sides)
    ob = bpy.context.object
    ob.data.polygons.foreach_set("use_smooth", [smooth] * len(ob.data.polygons))
    (bm,) = scenes.edit(ob)
    top = next(f for f in bm.faces if f.normal.z > 0.9)
    rim = list(top.edges)
    bmesh.ops.delete(bm, geom=[top], context="FACES_ONLY")
    scenes.select(bm, edges=rim)
    bmesh.update_edit_mesh(ob.data)
    return ob


def rim_of(bm):
    return [e for e in bm.edges if len({f.select for f in e.link_faces}) == 2]


@pytest.mark.parametrize("smooth", [True, False])
def test_the_lid_of_a_smooth_cylinder_has_sharp_edges(smooth):
    ob = open_cylinder(smooth)
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    rim = rim_of(bm)
    assert len(rim) == 32
    assert all(e.smooth != smooth for e in rim)
    assert max(abs(v.co.z - 1) for f in bm.faces if f.select for v in f.verts) < 1e-5


def test_a_dome_is_as_high_as_the_cylinder_is_wide():
    ob = open_cylinder(smooth=True)
    assert bpy.ops.mesh.fill_smooth(cap="dome") == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    assert max(v.co.z for v in bm.verts) == pytest.approx(2, abs=0.03)
    assert all(e.smooth for e in rim_of(bm))
