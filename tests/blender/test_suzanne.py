"""Regions of subdivided Suzanne round poles of three edges, regular vertices and poles of five, taken out and filled: none is
refused, none folded, and all are near the surface that was there."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes
import tasks

#: Regions of each kind that are tried; all there are would take a minute.
TRIED = 8


def disc(vertex, count):
    """The faces round a vertex, if they are quads and a disc inside the mesh."""
    faces, near = tasks.rings(vertex, count)
    edges = {e for f in faces for e in f.edges}
    whole = len(near) - len(edges) + len(faces) == 1 and not any(v.is_boundary for v in near)
    return faces if whole and all(len(f.verts) == 4 for f in faces) else None


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("valence", [3, 4, 5])
def test_rings_of_faces(valence, count):
    whole = tasks.suzanne(2)
    far = tasks.distance_to(whole)
    around = [v.index for v in whole.verts if len(v.link_edges) == valence and disc(v, count)]
    chosen = np.random.default_rng(count).permutation(around)[:TRIED].tolist()
    assert len(chosen) == TRIED
    mesh = bpy.data.meshes.new("Suzanne")
    whole.to_mesh(mesh)
    largest = []
    for vertex in chosen:
        ob = bpy.data.objects.new("Suzanne", mesh.copy())
        bpy.context.collection.objects.link(ob)
        (bm,) = scenes.edit(ob, mode="EDGE")
        bm.verts.ensure_lookup_table()
        gone = disc(bm.verts[vertex], count)
        points = np.array([v.co for f in gone for v in f.verts])
        size = np.linalg.norm(np.ptp(points, axis=0))
        rim = [e for f in gone for e in f.edges if any(other not in gone for other in e.link_faces)]
        bmesh.ops.delete(bm, geom=list(gone), context="FACES")
        scenes.select(bm, edges=rim)
        assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
        bm = bmesh.from_edit_mesh(ob.data)
        bm.normal_update()
        new = [f for f in bm.faces if f.select]
        assert not any(e.is_boundary for f in new for e in f.edges)
        bends = [np.degrees(e.calc_face_angle()) for e in {e for f in new for e in f.edges}]
        off = far([v.co.copy() for f in new for v in f.verts] + [f.calc_center_median() for f in new]) / size
        largest.append((max(bends), off.max()))
        bpy.ops.object.mode_set(mode="OBJECT")
        bpy.data.objects.remove(ob)
    bends, off = np.array(largest).T
    print(
        f"FIGURE {count} rings round {valence} edges: {off.max():.1e} of its size off at most, bends by {bends.max():.0f} degrees"
    )
    assert bends.max() < 120, "folded"
    assert off.max() < 0.08 and np.median(off) < 0.04


@pytest.mark.parametrize("vertex", [57, 324])
def test_three_sides_that_lie_in_other_planes_at_their_corners_are_left_to_the_spline(vertex):
    """Two rings of faces around a vertex of the subdivided mesh: planes differ by 55 degrees at a corner, and by 10, where the
    spline is nearer too, as in seven of nine such holes."""
    import tripatch

    bpy.ops.mesh.primitive_monkey_add()
    ob = bpy.context.object
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 1
    mesh = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    vertices = np.array([v.co for v in mesh.vertices])
    faces = [list(p.vertices) for p in mesh.polygons]
    near = {vertex}
    for _ in range(2):
        gone = [f for f in faces if near & set(f)]
        near |= {v for f in gone for v in f}
    left = [f for f in faces if f not in gone]
    (rim,) = [loop for loop in tripatch.find_holes(left) if set(loop.tolist()) <= near]
    fill = tripatch.fill(vertices, left, rim=rim)
    assert fill.report.method == "polyharmonic_spline" and "surrounding surface" in fill.report.method_reason
    own = tripatch.fill(vertices, left, rim=rim, corners=tripatch.find_corners(vertices, left, rim))
    assert own.report.method == "side_vertex"  # corners that are given are a person's


def test_three_sides_that_make_a_lump_of_the_face_of_a_box_are_left_to_the_spline():
    """Nearly a whole face of a rounded box, whose three sides differ by 26 degrees at a corner: the patch between them swells by
    a third of the hole, and all that is around tells of another surface."""
    import tripatch

    bpy.ops.mesh.primitive_cube_add()
    ob = bpy.context.object
    bevel = ob.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.3, 2
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 1
    mesh = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    vertices = np.array([v.co for v in mesh.vertices])
    faces = [list(p.vertices) for p in mesh.polygons]
    near = {int(np.argmin(np.linalg.norm(vertices - (0.972, -0.501, -0.501), axis=1)))}
    for _ in range(4):
        gone = [f for f in faces if near & set(f)]
        near |= {v for f in gone for v in f}
    left = [f for f in faces if f not in gone]
    (rim,) = [loop for loop in tripatch.find_holes(left) if set(loop.tolist()) <= near]
    fill = tripatch.fill(vertices, left, rim=rim)
    assert "surrounding surface" in fill.report.method_reason
    assert np.abs(fill.vertices).max() < 1.25  # the box is 1 in every direction
    own = tripatch.fill(vertices, left, rim=rim, corners=tripatch.find_corners(vertices, left, rim))
    assert own.report.method == "side_vertex"
    assert np.abs(own.vertices).max() > 1.4
