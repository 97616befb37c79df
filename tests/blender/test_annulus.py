"""Two boundaries that are selected are joined by one surface."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes

smooth = bpy.ops.mesh.fill_smooth


def rings_object(name, *stacks):
    """A mesh of tubes: each of rings of points, (k, n, 3)."""
    bm = bmesh.new()
    for stack in stacks:
        rows = [[bm.verts.new(p) for p in ring] for ring in stack]
        for a, b in zip(rows, rows[1:], strict=False):
            for k in range(len(a)):
                bm.faces.new((a[k - 1], a[k], b[k], b[k - 1]))
    mesh = bpy.data.meshes.new(name)
    bm.to_mesh(mesh)
    bm.free()
    ob = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(ob)
    return ob


def circle(n, radius, z):
    angle = 2 * np.pi * np.arange(n) / n
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(n, float(z))])


def boss(m=32, n=32):
    plate = [circle(m, r, 0) for r in (2.2, 1.9, 1.6, 1.3)]
    tube = [circle(n, 0.9, z) for z in (0.4, 0.7, 1.0, 1.5)]
    return rings_object("Boss", plate, tube)


def select_boundaries(bm, near):
    for e in bm.edges:
        e.select = e.is_boundary and all(near(v.co) for v in e.verts)
    bm.select_flush_mode()


def at_fillet(co):
    return (co.z < 0.1 and co.xy.length < 1.4) or (0.3 < co.z < 0.5)


def off_fillet(points):
    return np.hypot(np.hypot(points[:, 0], points[:, 1]) - 1.3, points[:, 2] - 0.4) - 0.4


def fill(ob, near, **options):
    (bm,) = scenes.edit(ob, mode="EDGE")
    select_boundaries(bm, near)
    bmesh.update_edit_mesh(ob.data)
    old = len(bm.verts), len(bm.faces)
    assert smooth("EXEC_DEFAULT", True, **options) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    return bm, [np.array(v.co) for v in list(bm.verts)[old[0] :]], list(bm.faces)[old[1] :]


@pytest.mark.parametrize(("m", "n"), [(32, 32), (32, 24)])
def test_two_selected_boundaries_are_joined_by_a_tangent_ring(addon, m, n):
    bm, points, faces = fill(boss(m, n), at_fillet)
    off = off_fillet(np.array(points))
    assert abs(off).max() < 0.02 * 0.4 and np.sqrt((off**2).mean()) < 0.005 * 0.4
    assert all(len(face.verts) == 4 for face in faces)
    assert sum(e.is_boundary for e in bm.edges) == m + n
    assert all(e.is_contiguous for e in bm.edges if not e.is_boundary)
    ring = [v for v in bm.verts if any(f in faces for f in v.link_faces)]
    assert sum(len(v.link_edges) != 4 for v in ring) <= abs(m - n)


@pytest.mark.parametrize(("m", "n"), [(32, 32), (32, 24)])
def test_under_a_subdivision_modifier_a_cage_joins_them(addon, m, n):
    ob = boss(m, n)
    ob.modifiers.new("Subdivision", "SUBSURF")
    bm, _, faces = fill(ob, at_fillet)
    assert all(len(face.verts) == 4 for face in faces)
    assert sum(e.is_boundary for e in bm.edges) == m + n
    assert all(e.is_contiguous for e in bm.edges if not e.is_boundary)


def test_the_ends_of_a_bent_pipe_are_joined(addon):
    """Around a bend of 50 degrees."""

    def across(angle):
        c = circle(32, 0.5, 0)
        return np.column_stack([(2 + c[:, 0]) * np.cos(angle), (2 + c[:, 0]) * np.sin(angle), c[:, 1]])

    angles = np.radians(25) + 0.1 * np.arange(6)
    ob = rings_object("Pipe", [across(-angle) for angle in angles[::-1]], [across(angle) for angle in angles])
    bm, points, _ = fill(ob, lambda co: abs(co.y) < abs(co.x) * 0.5)
    assert sum(e.is_boundary for e in bm.edges) == 64
    points = np.array(points)
    off = np.hypot(np.hypot(points[:, 0], points[:, 1]) - 2, points[:, 2]) - 0.5
    assert np.abs(off).max() < 0.02 * 0.5 and np.sqrt((off**2).mean()) < 0.005 * 0.5


def test_undo_takes_the_ring_back(addon):
    ob = boss()
    bpy.ops.ed.undo_push(message="before")
    fill(ob, at_fillet)
    bpy.ops.ed.undo()
    assert len(bpy.data.objects["Boss"].data.polygons) == 6 * 32


def test_nothing_selected_joins_boundaries_that_face_each_other(addon):
    ob = boss()
    scenes.edit(ob, mode="EDGE")
    bpy.ops.mesh.select_all(action="DESELECT")
    assert smooth("EXEC_DEFAULT", True) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    assert sum(e.is_boundary for e in bm.edges) == 32, "the outer border of the plate is left open"


def test_weights_and_uvs_are_blended_from_one_boundary_to_the_other(addon):
    ob = boss()
    mesh = ob.data
    group = ob.vertex_groups.new(name="Boss")
    group.add([v.index for v in mesh.vertices if v.co.z > 0.2], 1.0, "REPLACE")
    layer = mesh.uv_layers.new(name="UV")
    for loop in mesh.loops:
        layer.data[loop.index].uv = mesh.vertices[loop.vertex_index].co.xy
    bm, points, faces = fill(ob, at_fillet)
    deform, uv = bm.verts.layers.deform.active, bm.loops.layers.uv.active
    weights = [v[deform].get(group.index, 0.0) for v in list(bm.verts)[-len(points) :]]
    assert 0 < min(weights) and max(weights) < 1
    assert np.corrcoef(weights, np.array(points)[:, 2])[0, 1] > 0.9
    spread = [(loop[uv].uv - loop.vert.co.xy).length for face in faces for loop in face.loops]
    assert max(spread) < 0.2


def test_a_ring_is_edited_again(addon):
    ob = boss()
    bm, _, faces = fill(ob, at_fillet)
    count = len(faces)
    scenes.select(bm, edges=faces[0].edges)
    bmesh.update_edit_mesh(ob.data)
    assert bpy.ops.mesh.edit_fill("EXEC_DEFAULT", True, rows=2) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    assert len(bm.faces) == 6 * 32 + count + 2 * 32
    assert sum(e.is_boundary for e in bm.edges) == 64


def sheet(size, missing, height=lambda x, y: 0.25 * np.sin(1.5 * x) + 0.1 * y * y):
    """A grid over [-1, 1]^2 without the faces whose middle is missing."""
    at = np.linspace(-1, 1, size + 1)
    vertices = [(x, y, height(x, y)) for y in at for x in at]
    faces = []
    for j in range(size):
        for i in range(size):
            if not missing((at[i] + at[i + 1]) / 2, (at[j] + at[j + 1]) / 2):
                k = j * (size + 1) + i
                faces.append((k, k + 1, k + size + 2, k + size + 1))
    mesh = bpy.data.meshes.new("Sheet")
    mesh.from_pydata(vertices, [], faces)
    bm = bmesh.new()
    bm.from_mesh(mesh)
    bmesh.ops.delete(bm, geom=[v for v in bm.verts if not v.link_faces], context="VERTS")
    bm.to_mesh(mesh)
    bm.free()
    ob = bpy.data.objects.new("Sheet", mesh)
    bpy.context.collection.objects.link(ob)
    return ob


def test_two_holes_of_one_surface_are_filled_each(addon):
    ob = sheet(16, lambda x, y: abs(abs(x) - 0.5) < 0.2 and abs(y) < 0.2)
    bm, _, _ = fill(ob, lambda co: max(abs(co.x), abs(co.y)) < 0.9)
    assert sum(e.is_boundary for e in bm.edges) == 64
    assert len(bm.faces) == 256


def test_a_notch_in_an_open_border_is_filled_up_to_an_edge_between_its_ends(addon):
    ob = sheet(24, lambda x, y: x > 0.4 and y > 0.4)
    uv = ob.data.uv_layers.new().data
    for loop in ob.data.loops:
        uv[loop.index].uv = ob.data.vertices[loop.vertex_index].co.xy
    bm, points, faces = fill(ob, lambda co: co.x > 0.35 and co.y > 0.35 and min(co.x, co.y) < 0.45)
    assert faces and sum(e.is_boundary for e in bm.edges) < 4 * 24
    assert all(e.is_contiguous for e in bm.edges if not e.is_boundary)
    assert all(v.link_faces for v in bm.verts)
    middles = np.array([f.calc_center_median() for f in faces])
    assert (middles[:, 0] + middles[:, 1] < 1.45).all(), "not beyond the edge between the ends"
    off = [p[2] - 0.25 * np.sin(1.5 * p[0]) - 0.1 * p[1] ** 2 for p in points]
    assert np.abs(off).max() < 0.01
    layer = bm.loops.layers.uv.active
    assert max((corner[layer].uv - corner.vert.co.xy).length for f in faces for corner in f.loops) < 0.05


def test_a_gap_between_two_chains_is_filled(addon):
    ob = sheet(24, lambda x, y: abs(x) < 0.25)
    bm, points, faces = fill(ob, lambda co: abs(abs(co.x) - 0.25) < 0.01 and abs(co.y) < 0.6)
    assert faces and all(abs(f.calc_center_median().y) < 0.65 for f in faces)
    assert all(e.is_contiguous for e in bm.edges if not e.is_boundary)
    off = [p[2] - 0.25 * np.sin(1.5 * p[0]) - 0.1 * p[1] ** 2 for p in points]
    assert np.abs(off).max() < 0.01


def two_balls():
    """Two spheres joined along the circle x = 0, radius 0.8, of 24 faces around each."""
    rings = []
    for angle in np.linspace(0.15, np.pi - np.arccos(0.6), 14):
        c = circle(48, np.sin(angle), 0)
        rings.append(np.column_stack([np.full(48, -0.6 - np.cos(angle)), c[:, 0], c[:, 1]]))
    other = [ring * (-1, 1, 1) for ring in rings[-2::-1]]
    return rings_object("Balls", [*rings, *other])


def select_seam(ob, reach):
    (bm,) = scenes.edit(ob, mode="FACE")
    for f in bm.faces:
        f.select = abs(f.calc_center_median().x) < reach
    bm.select_flush_mode()
    bmesh.update_edit_mesh(ob.data)
    return bm


def test_a_selected_ring_of_faces_is_replaced_by_a_tangent_ring(addon):
    ob = two_balls()
    bm = select_seam(ob, 0.3)
    kept = sum(not f.select for f in bm.faces)
    assert smooth("EXEC_DEFAULT", True) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    assert sum(e.is_boundary for e in bm.edges) == 96 and len(bm.faces) > kept
    sharpest = max(e.calc_face_angle(0) for e in bm.edges)
    assert sharpest < np.radians(30), "it was 106 degrees"


@pytest.mark.parametrize("width", [0.2, 0.35])
def test_a_seam_is_blended_over_a_width(addon, width):
    ob = two_balls()
    select_seam(ob, 0.2)
    assert smooth("EXEC_DEFAULT", True, width=width) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    assert sum(e.is_boundary for e in bm.edges) == 96
    new = {f for f in bm.faces if f.select}
    rim = {v for e in bm.edges if len({f in new for f in e.link_faces}) == 2 for v in e.verts}
    apart = [np.hypot(np.hypot(v.co.y, v.co.z) - 0.8, v.co.x) for v in rim]
    assert min(apart) > 0.95 * width and max(apart) < 1.05 * width
    assert max(e.calc_face_angle(0) for e in bm.edges if new & set(e.link_faces)) < np.radians(30)
