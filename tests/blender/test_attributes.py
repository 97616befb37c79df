"""What new faces take over from their surroundings."""

import math
import sys
import types

import bmesh
import bpy
import numpy as np
import pytest
import scenes
import tasks
from mathutils import Vector

fill = bpy.ops.mesh.fill_three_sided


def fill_in_edit_mode(ob, **options):
    """The number of vertices and faces before; the object is in object mode again."""
    before = len(ob.data.vertices), len(ob.data.polygons)
    scenes.edit(ob)
    assert fill(**options) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not ob.data.validate(verbose=True)
    return before


def test_material_and_smooth_shading_follow_the_nearest_side():
    points, faces = scenes.lattice()
    ob = scenes.add_mesh(scenes.bowl(points), faces, smooth=False)
    for name in "AB":
        ob.data.materials.append(bpy.data.materials.new(name))
    low = np.array([v.co.y for v in ob.data.vertices]).min()
    rim_low = min(p.y for p in rim_points(ob))
    for p in ob.data.polygons:
        if low <= p.center.y < rim_low:
            p.material_index, p.use_smooth = 1, True
    _, old = fill_in_edit_mode(ob)
    new = list(ob.data.polygons)[old:]
    assert {(p.material_index, p.use_smooth) for p in new} == {(0, False), (1, True)}
    lowest = min(new, key=lambda p: p.center.y)
    highest = max(new, key=lambda p: p.center.y)
    assert lowest.material_index == 1
    assert highest.material_index == 0


def rim_points(ob):
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    points = [v.co.copy() for v in scenes.border_loops(bm)[0]]
    bm.free()
    return points


def test_uvs_that_are_linear_stay_linear_and_go_through_the_seam():
    """Side-vertex interpolation reproduces linear functions of the parameter; over a flat hole that is position."""
    points, faces = scenes.lattice()
    ob = scenes.add_mesh(scenes.flat(points), faces)
    layer = ob.data.uv_layers.new(name="UV")
    for loop, uv in zip(ob.data.loops, layer.data, strict=True):
        x, y, _ = ob.data.vertices[loop.vertex_index].co
        uv.uv = 0.3 + x + 2 * y, 0.1 - x + y
    fill_in_edit_mode(ob)
    layer = ob.data.uv_layers["UV"]
    for loop, uv in zip(ob.data.loops, layer.data, strict=True):
        x, y, _ = ob.data.vertices[loop.vertex_index].co
        np.testing.assert_allclose(uv.uv, [0.3 + x + 2 * y, 0.1 - x + y], atol=1e-3)


def test_uvs_of_a_side_are_those_of_the_faces_beside_it():
    """Where UV islands meet in a corner of the hole, a new face at one side has the island of that side."""
    ob = scenes.add_hole()
    layer = ob.data.uv_layers.new(name="UV")
    rim = rim_points(ob)
    low = min(p.y for p in rim)
    for p in ob.data.polygons:
        for k in p.loop_indices:
            layer.data[k].uv = (5, 5) if p.center.y < low else (0, 0)
    _, old = fill_in_edit_mode(ob, method="side_vertex")
    mesh, seen = ob.data, 0
    for p in list(mesh.polygons)[old:]:
        at_low = [k for k in p.loop_indices if mesh.vertices[mesh.loops[k].vertex_index].co.y < low + 1e-6]
        if len(at_low) == 2:  # the face has an edge of the low side
            seen += 1
            assert any(tuple(mesh.uv_layers["UV"].data[k].uv) == (5, 5) for k in at_low)
    assert seen == 4


def test_vertex_groups_and_point_attributes_are_blended():
    points, faces = scenes.lattice()
    ob = scenes.add_mesh(scenes.flat(points), faces)
    group = ob.vertex_groups.new(name="G")
    mesh = ob.data
    mesh.attributes.new("V", "FLOAT", "POINT")
    mesh.attributes.new("N", "INT", "POINT")
    for k, (x, _y) in enumerate(points):
        group.add([k], 0.5 + 0.5 * x, "REPLACE")
    mesh.attributes["V"].data.foreach_set("value", points[:, 0] - points[:, 1])
    mesh.attributes["N"].data.foreach_set("value", [7] * len(points))
    old, _ = fill_in_edit_mode(ob)
    mesh = ob.data
    assert len(mesh.vertices) > old
    for v in list(mesh.vertices)[old:]:
        assert v.groups[0].weight == pytest.approx(0.5 + 0.5 * v.co.x, abs=1e-3)
        assert mesh.attributes["V"].data[v.index].value == pytest.approx(v.co.x - v.co.y, abs=1e-3)
        assert mesh.attributes["N"].data[v.index].value == 7


@pytest.mark.parametrize("quads", ["FIXED", "ALTERNATE"])
def test_the_edges_of_a_box_that_come_back_are_sharp_as_those_that_are_left(quads):
    """A wall is gone with a part of two others: some of the new edges begin where no sharp edge ends, only diagonals of faces."""

    def is_gone(x, y, z):
        return z > 0.9 or (max(x, y) > 0.9 and z > 0.1)

    bm = bmesh.new()
    bmesh.ops.create_cube(bm, size=2)
    bmesh.ops.subdivide_edges(bm, edges=bm.edges[:], cuts=3, use_grid_fill=True)
    for edge in bm.edges:
        edge.smooth = edge.calc_face_angle() < 0.1
    bmesh.ops.delete(bm, geom=[f for f in bm.faces if is_gone(*f.calc_center_median())], context="FACES")
    bmesh.ops.triangulate(bm, faces=bm.faces[:], quad_method=quads)
    old = {tuple(sorted(tuple(v.co) for v in e.verts)) for e in bm.edges}
    mesh = bpy.data.meshes.new("box")
    bm.to_mesh(mesh)
    bm.free()
    ob = scenes.object_of(mesh)
    scenes.edit(ob, mode="EDGE")
    assert bpy.ops.mesh.fill_smooth(output="triangles") == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    assert all(len(e.link_faces) == 2 for e in bm.edges)
    new = [e for e in bm.edges if tuple(sorted(tuple(v.co) for v in e.verts)) not in old]
    assert sum(e.calc_face_angle() > 0.1 for e in new) >= 5
    assert all(e.smooth == (e.calc_face_angle() < 0.1) for e in new)


def test_creases_seams_and_sharp_edges_stay_and_do_not_spread():
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode="EDGE")
    layers = bm.edges.layers
    crease = layers.crease.verify() if hasattr(layers, "crease") else layers.float.new("crease_edge")
    loop = scenes.border_loops(bm)[0]
    edges = [bm.edges.get(pair) for pair in zip(loop, loop[1:] + loop[:1], strict=True)]
    edges[0].seam = True
    edges[1].smooth = False
    for e in edges:
        e[crease] = 0.75
    old = len(bm.edges)
    scenes.select(bm, edges=edges)
    assert fill() == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    crease = bm.edges.layers.crease.verify() if hasattr(layers, "crease") else bm.edges.layers.float["crease_edge"]
    everything = list(bm.edges)
    assert sum(e.seam for e in everything) == 1
    assert sum(not e.smooth for e in everything) == 1
    assert sum(e[crease] == 0.75 for e in everything) == len(edges)
    assert all(e[crease] == 0 and e.smooth and not e.seam for e in everything[old:])


def _edge_layer(bm, kind):
    """Creases and bevel weights as Blender 3 and as newer ones keep them."""
    layers = bm.edges.layers
    if hasattr(layers, kind):
        return getattr(layers, kind).verify()
    return layers.float.get(f"{kind}_edge") or layers.float.new(f"{kind}_edge")


def test_a_ridge_that_goes_on_across_the_hole_is_marked_as_its_ends_are():
    """Sharp and creased on both sides; the bevel weight goes from one value to the other; a number is the nearer end's."""
    task = tasks.crease()
    bm = bmesh.from_edit_mesh(task.ob.data)
    bm.edges.layers.int.new("N")
    _edge_layer(bm, "crease"), _edge_layer(bm, "bevel_weight")
    crease, weight, number = _edge_layer(bm, "crease"), _edge_layer(bm, "bevel_weight"), bm.edges.layers.int["N"]
    for e in bm.edges:
        if all(abs(v.co.y) < 1e-6 for v in e.verts):
            right = e.verts[0].co.x > 0
            e.smooth, e[crease], e[weight], e[number] = False, 0.75, 0.8 if right else 0.2, 3 if right else 2
    old = len(bm.edges)
    assert fill() == {"FINISHED"}
    bm = bmesh.from_edit_mesh(task.ob.data)
    crease, weight, number = _edge_layer(bm, "crease"), _edge_layer(bm, "bevel_weight"), bm.edges.layers.int["N"]
    new = list(bm.edges)[old:]
    ridge = [e for e in new if all(abs(v.co.y) < 1e-5 for v in e.verts)]
    assert len(ridge) > 3
    for e in ridge:
        x = (e.verts[0].co.x + e.verts[1].co.x) / 2
        assert not e.smooth and e[crease] == pytest.approx(0.75)
        assert e[number] == (3 if x > 0 else 2) or abs(x) < 0.05
    reach = max(abs(v.co.x) for e in ridge for v in e.verts)
    along = [(e.verts[0].co.x + e.verts[1].co.x) / 2 / reach for e in ridge]
    np.testing.assert_allclose([e[weight] for e in ridge], [0.5 + 0.3 * t for t in along], atol=0.01)
    assert all(e.smooth and e[crease] == e[weight] == e[number] == 0 for e in new if e not in ridge)


@pytest.mark.parametrize("active", [0, 1])
def test_new_vertices_have_their_place_in_every_shape_key(active):
    """Each shape is filled as a mesh of that shape alone would be."""
    points, faces = scenes.lattice()
    shapes = {"Basis": scenes.bowl(points), "Deep": scenes.bowl(points) * [1, 1, 3], "Moved": scenes.bowl(points) + [0, 0, 2]}
    alone = {}
    for name, vertices in shapes.items():
        ob = scenes.add_mesh(vertices, faces)
        old, _ = fill_in_edit_mode(ob)
        alone[name] = np.array([v.co for v in ob.data.vertices])
    ob = scenes.add_mesh(shapes["Basis"], faces)
    for name, vertices in shapes.items():
        key = ob.shape_key_add(name=name, from_mix=False)
        key.data.foreach_set("co", vertices.astype(np.float32).ravel())
    ob.active_shape_key_index = active
    fill_in_edit_mode(ob)
    keys = ob.data.shape_keys.key_blocks
    built = {name: np.array([d.co for d in keys[name].data]) for name in shapes}
    filled_in = list(shapes)[active]
    np.testing.assert_allclose(built[filled_in], alone[filled_in], atol=1e-6)
    for name, vertices in shapes.items():
        np.testing.assert_array_equal(built[name][:old], vertices.astype(np.float32))
    # The moved bowl is the first one moved: the same parameters on the same patch.
    np.testing.assert_allclose(built["Moved"][old:], built["Basis"][old:] + [0, 0, 2], atol=1e-5)
    # On a bowl the fill comes close to it in every shape.
    for name, depth in {"Basis": 0.6, "Deep": 1.8}.items():
        x, y, z = built[name][old:].T
        np.testing.assert_allclose(z, depth * (x**2 + y**2), atol=5e-3)


def test_a_shape_that_cannot_be_filled_follows_its_rim(capfd):
    points, faces = scenes.lattice()
    ob = scenes.add_mesh(scenes.bowl(points), faces)
    ob.shape_key_add(name="Basis", from_mix=False)
    key = ob.shape_key_add(name="Point", from_mix=False)
    key.data.foreach_set("co", np.tile(np.float32([1, 2, 3]), len(points)))
    ob.active_shape_key_index = 0
    old, _ = fill_in_edit_mode(ob)
    place = np.array([d.co for d in ob.data.shape_keys.key_blocks["Point"].data])
    np.testing.assert_allclose(place[old:], np.tile([1, 2, 3], (len(place) - old, 1)), atol=0.1)
    assert "Shape key 'Point' follows the boundary only" in capfd.readouterr().out


def test_a_shape_that_has_no_surface_follows_its_rim(capfd):
    """A mouth that closes to a point: only plain triangles would close its hole."""
    ob = scenes.add_mesh(*scenes.square_hole())
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Closed")
    for point, rim in zip(key.data, scenes.is_rim(ob), strict=True):
        if rim:
            point.co = (0.01, 0.02, 0.03)
    ob.active_shape_key_index = 0
    old = len(ob.data.vertices)
    fill_in_edit_mode(ob, method="polyharmonic_spline")
    assert "Shape key 'Closed' follows the boundary only" in capfd.readouterr().out
    places = np.array([point.co for point in ob.data.shape_keys.key_blocks["Closed"].data])
    assert np.abs(places[old:] - [0.01, 0.02, 0.03]).max() < 0.02


def custom_normals(ob, tilt=0.0):
    """Gives a bowl its true normals, tilted, as custom normals."""
    mesh = ob.data
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
    normals = []
    for v in mesh.vertices:
        x, y, _ = v.co
        n = np.array([-1.2 * x + tilt, -1.2 * y, 1])
        normals.append(n / np.linalg.norm(n))
    mesh.normals_split_custom_set_from_vertices(np.array(normals).tolist())


def angle(a, b):
    """Degrees, row by row."""
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)))


@pytest.mark.parametrize("tilt", [0, 0.5])
@pytest.mark.parametrize("smooth", [True, False])
def test_custom_normals_stay_and_those_of_the_fill_are_exact(smooth, tilt):
    points, faces = scenes.lattice(size=24, holes=((6, 6, 8),))
    ob = scenes.add_mesh(scenes.bowl(points), faces, smooth=smooth)
    uv = ob.data.uv_layers.new(name="UV").data
    rng = np.random.default_rng(1)
    uv.foreach_set("uv", rng.random(2 * len(uv)))
    custom_normals(ob, tilt)
    uvs = np.array([d.uv for d in ob.data.uv_layers["UV"].data])
    before = scenes.corner_normals(ob.data)
    at_rim = set(rim_indices(ob))
    vertex = np.array([loop.vertex_index for loop in ob.data.loops])
    fill_in_edit_mode(ob)
    assert ob.data.has_custom_normals
    after = scenes.corner_normals(ob.data)
    away = ~np.isin(vertex, list(at_rim))
    np.testing.assert_array_equal(after[: len(before)][away], before[away])
    assert angle(after[: len(before)], before).max() < 0.1  # Blender's own encoding
    np.testing.assert_array_equal(np.array([d.uv for d in ob.data.uv_layers["UV"].data])[: len(uvs)], uvs)
    new = np.array([loop.vertex_index for loop in ob.data.loops])[len(before) :]
    x, y, _ = np.array([v.co for v in ob.data.vertices])[new].T
    at_seam = np.isin(new, list(at_rim))
    true = np.column_stack([-1.2 * x + np.where(at_seam, tilt, 0), -1.2 * y, np.ones(len(x))])  # one shading over the seam
    assert angle(after[len(before) :], true).max() < 0.3
    assert not any(e.use_edge_sharp for e in ob.data.edges)


def with_four_corners():
    return scenes.add_mesh(*scenes.square_hole())


def torn():
    """A triangular hole with one side gone: no corners are found, or others than there are."""
    points, faces = scenes.lattice(size=24, holes=((6, 6, 8), (9, 3, 5)))
    return scenes.add_mesh(scenes.bowl(points), faces)


@pytest.mark.parametrize("make", [with_four_corners, torn])
@pytest.mark.parametrize("method", ["auto", "polyharmonic_spline"])
@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize("tilt", [0, 0.5])
def test_custom_normals_go_over_the_seam_of_any_rim(make, method, output, tilt):
    ob = make()
    custom_normals(ob, tilt)
    before, count = scenes.corner_normals(ob.data), len(ob.data.vertices)
    fill_in_edit_mode(ob, method=method, output=output)
    after = scenes.corner_normals(ob.data)
    assert angle(after[: len(before)], before).max() < 0.1
    assert not any(e.use_edge_sharp for e in ob.data.edges), "nothing parts the seam"
    x, y, _ = np.array([ob.data.vertices[loop.vertex_index].co for loop in ob.data.loops]).T
    inside = np.array([loop.vertex_index for loop in ob.data.loops]) >= count
    true = np.column_stack([-1.2 * x, -1.2 * y, np.ones(len(x))])
    assert angle(after[inside], true[inside]).max() < 3


def test_a_side_met_in_position_only_has_the_normals_of_the_fill():
    """The seam of the others has those of the surroundings, here tilted ones."""
    points, faces = scenes.lattice(size=24, holes=((6, 6, 8),))
    ob = scenes.add_mesh(scenes.bowl(points), faces)
    custom_normals(ob, 0.5)
    before, at_rim = len(ob.data.loops), rim_indices(ob)
    fill_in_edit_mode(ob, individual=True, continuity_0="G0")
    new = np.array([loop.vertex_index for loop in ob.data.loops])[before:]
    x, y, _ = np.array([v.co for v in ob.data.vertices])[new].T
    off = angle(scenes.corner_normals(ob.data)[before:], np.column_stack([-1.2 * x, -1.2 * y, np.ones(len(x))]))
    own = {v for v, a in zip(new.tolist(), off, strict=True) if a < 1} & set(at_rim)
    assert 7 <= len(own) <= 9  # of the 24 vertices of the rim


def test_custom_normals_around_a_replaced_region_stay():
    points, outside, inside = scenes.lattice_parts()
    ob = scenes.add_mesh(scenes.bowl(points), inside + outside)  # new faces take the first places in Blender's memory
    custom_normals(ob, 0.5)
    before = scenes.corner_normals(ob.data)[3 * len(inside) :]
    by_face = {
        tuple(np.array(ob.data.vertices[v].co).tobytes() for v in f): before[3 * k : 3 * k + 3] for k, f in enumerate(outside)
    }
    (bm,) = scenes.edit(ob, mode="FACE")
    scenes.select(bm, faces=list(bm.faces)[: len(inside)])
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    after, found = scenes.corner_normals(ob.data), 0
    for p in ob.data.polygons:
        old = by_face.get(tuple(np.array(ob.data.vertices[v].co).tobytes() for v in p.vertices))
        if old is not None:
            found += 1
            assert angle(after[list(p.loop_indices)], old).max() < 0.5  # Blender drops an angle under 0.8 degrees in its code
    assert found == len(outside)


def in_basis_and_key(points, faces, key, **options):
    """The places in both shape keys of a mesh whose holes are filled. key: the points in the second one."""
    ob = scenes.add_mesh(points, faces)
    ob.shape_key_add(name="Basis")
    ob.shape_key_add(name="Key").data.foreach_set("co", key.astype(np.float32).ravel())
    scenes.edit(ob)
    ob.active_shape_key_index = 0
    assert fill(**options) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    basis, in_key = (np.array([p.co for p in each.data]) for each in ob.data.shape_keys.key_blocks)
    assert len(basis) > len(points)
    return basis, in_key


def in_basis_and_twice_as_large(points, faces, **options):
    return in_basis_and_key(points, faces, 2 * points, **options)


def noisy_bowl():
    points, faces = scenes.lattice()
    return scenes.bowl(points) + np.random.default_rng(0).normal(scale=0.02, size=(len(points), 3)), faces


@pytest.mark.parametrize("options", [{"continuity": "Free"}, {"fairing": "thin_plate"}, {"bulge": 2.0}])
def test_options_that_auto_does_not_apply_hinder_no_shape_key(options):
    basis, wide = in_basis_and_twice_as_large(*noisy_bowl(), output="triangles", all_holes=True, **options)
    assert np.abs(wide - 2 * basis).max() < 1e-5


def test_the_middle_is_lifted_as_far_in_a_shape_key():
    """The offset is a length: twice as large with half of it is the same shape."""
    _, wide = in_basis_and_twice_as_large(*noisy_bowl(), output="triangles", all_holes=True, center_offset=0.1)
    basis, _ = in_basis_and_twice_as_large(*noisy_bowl(), output="triangles", all_holes=True, center_offset=0.05)
    assert np.abs(wide - 2 * basis).max() < 1e-5


def turned(radius):
    """A tube without its ends, as a surface of revolution. radius: of the height, from 0 to 1."""
    count, heights = 24, np.linspace(0, 1, 6)
    t = np.arange(count) * 2 * np.pi / count
    points = np.vstack([np.column_stack([radius(z) * np.cos(t), radius(z) * np.sin(t), np.full(count, z)]) for z in heights])
    at = [[k * count + j for j in range(count)] for k in range(len(heights))]
    faces = [(a[j - 1], a[j], b[j], b[j - 1]) for a, b in zip(at, at[1:]) for j in range(count)]
    return points, faces


@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize(
    "options", [{}, {"bulge": 2.0}, {"tension": 0.5}, {"fairing": "thin_plate"}, {"cap": "dome"}, {"cap": "flat"}]
)
@pytest.mark.parametrize("radius", [lambda z: 1.0, lambda z: 1 - z / 2, lambda z: math.sqrt(1 - (z - 0.3) ** 2)])
def test_ends_of_tubes_are_closed_alike_in_shape_keys(radius, options, output):
    basis, wide = in_basis_and_twice_as_large(*turned(radius), output=output, all_holes=True, outer=True, **options)
    assert np.abs(wide - 2 * basis).max() < 1e-5


@pytest.mark.parametrize("output", ["triangles", "quads"])
def test_a_flat_lid_stays_flat_where_the_tube_bulges_in_a_shape_key(output):
    points, faces = turned(lambda z: 1.0)
    bulging, _ = turned(lambda z: 1 + 4 * z * (1 - z))
    basis, in_key = in_basis_and_key(points, faces, bulging, output=output, all_holes=True, outer=True)
    for places in (basis, in_key):
        z = places[len(points) :, 2]
        assert np.minimum(np.abs(z), np.abs(z - 1)).max() < 1e-5


def test_custom_normals_where_the_rim_of_a_replaced_region_is_split():
    points, outside, inside = scenes.lattice_parts()
    ob = scenes.add_mesh(scenes.bowl(points), inside + outside)
    custom_normals(ob, 0.5)
    (bm,) = scenes.edit(ob, mode="FACE")
    bm.faces.ensure_lookup_table()
    apart = [f for f in bm.faces if not any(v.is_boundary for v in f.verts)][::7]
    scenes.select(bm, faces=apart[:3])
    count = len(bm.verts)
    assert fill(output="quads", rows=0, odd="split") == {"FINISHED"}
    assert len(bm.verts) > count
    bpy.ops.object.mode_set(mode="OBJECT")
    assert ob.data.has_custom_normals


def rim_indices(ob):
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    indices = [v.index for v in scenes.border_loops(bm)[0]]
    bm.free()
    return indices


def test_no_custom_normals_where_the_mesh_has_none():
    ob = scenes.add_hole()
    fill_in_edit_mode(ob)
    assert not ob.data.has_custom_normals


def test_custom_normals_of_a_mirrored_stretched_object():
    """Normals go back into object space as normals, not as directions."""
    points, faces = scenes.lattice(size=24, holes=((6, 6, 8),))
    ob = scenes.add_mesh(scenes.bowl(points), faces)
    ob.scale = (-1, 1, 2.5)
    bpy.context.view_layer.update()
    custom_normals(ob)
    before = len(ob.data.loops)
    fill_in_edit_mode(ob)
    new = np.array([loop.vertex_index for loop in ob.data.loops])[before:]
    x, y, _ = np.array([v.co for v in ob.data.vertices])[new].T
    true = np.column_stack([-1.2 * x, -1.2 * y, np.ones(len(x))])
    assert angle(scenes.corner_normals(ob.data)[before:], true).max() < 1


@pytest.mark.skipif(bpy.app.version < (4, 5), reason="custom normals as plain vectors came with 4.5")
def test_custom_normals_that_are_plain_vectors():
    points, faces = scenes.lattice(size=24, holes=((6, 6, 8),))
    ob = scenes.add_mesh(scenes.bowl(points), faces)
    before = np.tile(np.float32([0, 0.6, 0.8]), (len(ob.data.loops), 1))
    layer = ob.data.attributes.new("custom_normal", "FLOAT_VECTOR", "CORNER")
    layer.data.foreach_set("vector", before.ravel())
    assert ob.data.has_custom_normals
    fill_in_edit_mode(ob)
    after = np.array([d.vector for d in ob.data.attributes["custom_normal"].data])
    np.testing.assert_array_equal(after[: len(before)], before)
    np.testing.assert_allclose(np.linalg.norm(after, axis=1), 1, atol=1e-6)


def test_sides_of_rims_with_any_number_of_corners(addon):
    """Of three corners, side i is opposite corner i; of others it starts there; a round rim is one side."""
    writeback = sys.modules[addon.__name__ + ".writeback"]
    rim = [7, 3, 9, 4, 1, 8]
    assert [list(side) for side in writeback.sides(rim, [7, 9, 1])] == [[2, 3], [4, 5], [0, 1]]
    assert [list(side) for side in writeback.sides(rim, [7, 9, 4, 8])] == [[0, 1], [2], [3, 4], [5]]
    assert [list(side) for side in writeback.sides(rim, [7, 4])] == [[0, 1, 2], [3, 4, 5]]
    assert [list(side) for side in writeback.sides(rim, [])] == [[0, 1, 2, 3, 4, 5]]


class InPlane:
    """A fill as a patch over a plane domain makes it, of another fill of a flat hole: without corners and sides."""

    def __init__(self, fill):
        self.__dict__ |= {name: getattr(fill, name) for name in ("vertices", "faces", "normals", "rim", "rim_normals", "moved")}
        self.split_edges, self.creases, self.patch = fill.split_edges, fill.creases, fill.patch
        self.feature_edges = fill.feature_edges
        self.loops, self.barycentric, self.rim_barycentric = fill.loops, None, None
        self.uv, self.rim_uv = fill.vertices[:, :2], None
        self.report = types.SimpleNamespace(method="polyharmonic_spline", corners=[], continuity=(), warnings=[])


def test_a_fill_over_a_plane_domain_takes_over_what_the_rim_has(addon):
    """Mean value coordinates reproduce linear functions of the place."""
    filling, calls = (sys.modules[f"{addon.__name__}.{name}"] for name in ("filling", "calls"))
    points, faces = scenes.lattice()
    ob = scenes.add_mesh(scenes.flat(points), faces)
    mesh = ob.data
    for name in "AB":
        mesh.materials.append(bpy.data.materials.new(name))
    mesh.polygons.foreach_set("material_index", [1] * len(faces))
    mesh.attributes.new("V", "FLOAT", "POINT").data.foreach_set("value", points[:, 0] - points[:, 1])
    layer = mesh.uv_layers.new(name="UV")
    for loop, uv in zip(mesh.loops, layer.data, strict=True):
        uv.uv = mesh.vertices[loop.vertex_index].co.xy
    bm = bmesh.new()
    bm.from_mesh(mesh)
    rim = filling.open_holes(bm, np.eye(4))[0][0]
    around = filling.Surroundings(bm, np.eye(4))
    arrays = around.around(rim)
    (fill,) = calls.fills([rim], arrays, calls.Options())
    made = InPlane(fill)
    made.rim_uv = arrays[0][fill.rim][:, :2]
    planned = filling._planned(bm, rim, np.eye(4), made, len(bm.verts))
    new = filling.writeback.write(bm, mesh, [planned], calls.Options())
    bm.to_mesh(mesh)
    bm.free()
    assert len(new) == len(mesh.polygons) - len(faces) > 0
    for v in list(mesh.vertices)[len(points) :]:
        assert mesh.attributes["V"].data[v.index].value == pytest.approx(v.co.x - v.co.y, abs=1e-5)
    for loop, uv in zip(mesh.loops, mesh.uv_layers["UV"].data, strict=True):
        np.testing.assert_allclose(uv.uv, mesh.vertices[loop.vertex_index].co.xy, atol=1e-5)
    assert {p.material_index for p in mesh.polygons} == {1}
    assert not mesh.validate(verbose=True)


def new_faces(ob, old):
    return list(ob.data.polygons)[old:]


@pytest.mark.parametrize("shape", ["three sides", "four sides", "round"])
def test_a_border_between_two_materials_is_continued_across(shape):
    """Half of the surroundings has another material: so has half of the fill, and its border is one line from rim to rim."""
    make = {"three sides": scenes.lattice, "four sides": scenes.square_hole, "round": scenes.ring}[shape]
    points, faces = make()
    ob = scenes.add_mesh(scenes.flat(points) if shape == "three sides" else points * [1, 1, 0], faces)
    for name in "AB":
        ob.data.materials.append(bpy.data.materials.new(name))
    for p in ob.data.polygons:
        p.material_index = int(p.center.x > 0)
    _, old = fill_in_edit_mode(ob)
    wrong = [p for p in new_faces(ob, old) if (p.center.x > 0) != p.material_index]
    edge = max(np.linalg.norm(np.subtract(*(ob.data.vertices[v].co for v in e.vertices))) for e in ob.data.edges)
    assert all(abs(p.center.x) < edge for p in wrong)
    assert len(wrong) < 0.3 * len(new_faces(ob, old))
    assert {p.material_index for p in new_faces(ob, old)} == {0, 1}


def test_face_data_come_from_the_nearest_face():
    points, faces = scenes.square_hole()
    ob = scenes.add_mesh(points, faces)
    layer = ob.data.attributes.new("set", "INT", "FACE")
    for p in ob.data.polygons:
        layer.data[p.index].value = 1 + 2 * (p.center.x > 0) + (p.center.y > 0)
    _, old = fill_in_edit_mode(ob)
    values = ob.data.attributes["set"].data
    assert {values[p.index].value for p in new_faces(ob, old)} == {1, 2, 3, 4}
    for p in new_faces(ob, old):
        if min(abs(p.center.x), abs(p.center.y)) > 0.12:
            assert values[p.index].value == 1 + 2 * (p.center.x > 0) + (p.center.y > 0)


@pytest.mark.parametrize("shape", ["three sides", "four sides"])
def test_a_uv_seam_is_continued_and_no_face_is_stretched(shape):
    """The maps of two islands, one of them far away, turned and larger: in the fill too every face has one of the two."""
    points, faces = scenes.lattice(size=24, holes=((6, 6, 8),)) if shape == "three sides" else scenes.square_hole()
    ob = scenes.add_mesh(points[:, :2] @ np.eye(2, 3), faces)
    mesh = ob.data
    layer = mesh.uv_layers.new(name="UV")

    def island(right, x, y):
        return (5 - 2 * y, 7 + 2 * x) if right else (x, y)

    for p in mesh.polygons:
        for k in p.loop_indices:
            x, y, _ = mesh.vertices[mesh.loops[k].vertex_index].co
            layer.data[k].uv = island(p.center.x > 0, x, y)
    bm = bmesh.new()
    bm.from_mesh(mesh)
    for e in bm.edges:
        if len(e.link_faces) == 2:
            a, b = (f.calc_center_median().x > 0 for f in e.link_faces)
            e.seam = a != b
    seams = sum(e.seam for e in bm.edges)
    bm.to_mesh(mesh)
    bm.free()
    _, old = fill_in_edit_mode(ob)
    layer, on = ob.data.uv_layers["UV"], [0, 0]
    for p in new_faces(ob, old):
        places = [ob.data.vertices[ob.data.loops[k].vertex_index].co for k in p.loop_indices]
        got = np.array([layer.data[k].uv for k in p.loop_indices])
        off = [np.abs(got - [island(right, x, y) for x, y, _ in places]).max() for right in (False, True)]
        assert min(off) < 1e-3
        on[int(np.argmin(off))] += 1
    assert min(on) > 0.3 * sum(on)
    bm = scenes.checked(ob)
    between = [e for e in bm.edges if e.seam]
    assert len(between) > seams
    ends = [v for v in bm.verts if sum(e.seam for e in v.link_edges) == 1]
    assert all(any(e.is_boundary for e in v.link_edges) for v in ends), "the seam goes on from rim to rim"


def with_seams(ob):
    """Edit mode; seams are where the UVs jump."""
    (bm,) = scenes.edit(ob)
    layer = bm.loops.layers.uv.active
    for e in bm.edges:
        e.seam = len(e.link_loops) == 2 and jumps(e, layer)
    return bm


def jumps(edge, layer):
    """Whether the UVs of the faces on both sides differ."""
    a, b = edge.link_loops
    ends = (b.link_loop_next, b) if a.vert != b.vert else (b, b.link_loop_next)
    return any((x[layer].uv - y[layer].uv).length > 1e-3 for x, y in zip((a, a.link_loop_next), ends, strict=True))


def sphere():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=16)


def ball():
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=6)
    bpy.ops.transform.tosphere(value=1)
    bpy.ops.object.mode_set(mode="OBJECT")


@pytest.mark.parametrize(
    "make, at",
    [(sphere, (-0.56, 0, -0.83)), (sphere, (-0.98, 0, 0.2)), (sphere, (0, 0, 1)), (ball, (-1, 1, 1)), (ball, (-0.1, 0.7, 0.7))],
)
def test_wherever_the_uvs_of_a_fill_jump_there_is_a_seam(make, at):
    make()
    ob = bpy.context.object
    bm = with_seams(ob)
    near = min((v for v in bm.verts if any(e.seam for e in v.link_edges)), key=lambda v: (v.co.normalized() - Vector(at)).length)
    faces = {f for g in near.link_faces for v in g.verts for f in v.link_faces}
    bmesh.ops.delete(bm, geom=list(faces), context="FACES")
    seams = sum(e.seam for e in bm.edges)
    bmesh.update_edit_mesh(ob.data)
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    bm = scenes.checked(ob)
    layer = bm.loops.layers.uv.active
    assert sum(e.seam for e in bm.edges) > seams
    assert [e for e in bm.edges if jumps(e, layer) != e.seam] == []


def test_the_mask_of_sculpting_is_blended():
    ob = scenes.add_hole()
    mesh = ob.data
    if hasattr(mesh, "vertex_paint_masks"):  # Blender 3
        bm = bmesh.new()
        bm.from_mesh(mesh)
        layer = bm.verts.layers.paint_mask.verify()
        for v in bm.verts:
            v[layer] = 0.5 + 0.5 * v.co.x
        bm.to_mesh(mesh)
    else:
        mask = mesh.attributes.new(".sculpt_mask", "FLOAT", "POINT")
        for v in mesh.vertices:
            mask.data[v.index].value = 0.5 + 0.5 * v.co.x
    old = len(mesh.vertices)
    fill_in_edit_mode(ob)
    bm = scenes.checked(ob)
    layer = bm.verts.layers.paint_mask.active if hasattr(mesh, "vertex_paint_masks") else bm.verts.layers.float[".sculpt_mask"]
    off = [abs(v[layer] - 0.5 - 0.5 * v.co.x) for v in list(bm.verts)[old:]]
    assert len(off) > 2 and max(off) < 0.01


@pytest.mark.skipif(
    "QUATERNION" not in [i.identifier for i in bpy.types.Attribute.bl_rna.properties["data_type"].enum_items],
    reason="this Blender has no quaternions",
)
@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
def test_quaternions_are_blended_and_normalized(domain):
    ob = scenes.add_hole(shape=scenes.flat)
    mesh = ob.data
    layer = mesh.attributes.new("Q", "QUATERNION", domain)
    at = [v.co.x for v in mesh.vertices] if domain == "POINT" else [mesh.vertices[c.vertex_index].co.x for c in mesh.loops]
    turns = np.array(at) * 0.5
    layer.data.foreach_set(
        "value", np.column_stack([np.cos(turns), np.sin(turns), 0 * turns, 0 * turns]).astype(np.float32).ravel()
    )
    old = len(layer.data)
    before = np.array([np.ravel(d.value) for d in layer.data], np.float32)
    fill_in_edit_mode(ob)
    mesh = ob.data
    layer = mesh.attributes["Q"]
    got = np.array([np.ravel(d.value) for d in layer.data], np.float32)
    np.testing.assert_array_equal(got[:old], before)
    np.testing.assert_allclose(np.linalg.norm(got[old:], axis=1), 1, atol=1e-6)
    at = [v.co.x for v in mesh.vertices] if domain == "POINT" else [mesh.vertices[c.vertex_index].co.x for c in mesh.loops]
    np.testing.assert_allclose(2 * np.arctan2(got[old:, 1], got[old:, 0]), np.array(at)[old:], atol=0.02)


@pytest.mark.parametrize("kind", ["INT8", "INT16_2D", "INT32_2D", "INT", "BOOLEAN", "STRING"])
@pytest.mark.parametrize("domain", ["POINT", "FACE", "CORNER"])
def test_what_cannot_be_blended_is_the_nearest(kind, domain):
    if kind not in [i.identifier for i in bpy.types.Attribute.bl_rna.properties["data_type"].enum_items]:
        pytest.skip("this Blender has no such type")
    ob = scenes.add_hole()
    layer = ob.data.attributes.new("N", kind, domain)
    values = {"INT8": 7, "INT": 7, "BOOLEAN": True, "STRING": "seven"}.get(kind, (7, 9))
    if kind == "STRING" and isinstance(layer.data[0].value, bytes):
        values = b"seven"
    for d in layer.data:
        d.value = values
    old = len(layer.data)
    fill_in_edit_mode(ob)
    got = [
        d.value if not hasattr(d.value, "__len__") or kind == "STRING" else tuple(d.value) for d in ob.data.attributes["N"].data
    ]
    assert len(got) > old and set(got) == {values}


@pytest.mark.parametrize("shape", ["four sides", "round"])
def test_shapes_of_holes_of_any_kind_are_filled_within_half_a_percent(shape):
    """Over the surface that the shape has; the rim alone would leave 5% and more."""
    points, faces = scenes.square_hole() if shape == "four sides" else scenes.ring()
    plane = points[:, :2]
    deep = np.column_stack([plane, 0.5 * np.sqrt(np.maximum(4 - (plane**2).sum(axis=1), 0))])
    bent = np.column_stack([1.3 * plane[:, 0], plane[:, 1], 0.4 * plane[:, 0] ** 2 - 0.2 * plane[:, 1] ** 2 + 1])
    ob = scenes.add_mesh(deep, faces)
    ob.shape_key_add(name="Basis", from_mix=False)
    ob.shape_key_add(name="Bent", from_mix=False).data.foreach_set("co", bent.astype(np.float32).ravel())
    ob.active_shape_key_index = 0
    old, _ = fill_in_edit_mode(ob)
    place = np.array([d.co for d in ob.data.shape_keys.key_blocks["Bent"].data])
    np.testing.assert_array_equal(place[: len(bent)], bent.astype(np.float32))
    x, y, z = place[old:].T
    size = 0.43 if shape == "four sides" else 1.3
    assert np.abs(z - (0.4 * (x / 1.3) ** 2 - 0.2 * y**2 + 1)).max() < 0.005 * size


def test_multires_and_armature_go_on_working():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=10)
    ob = bpy.context.object
    group = ob.vertex_groups.new(name="Bone")
    group.add(range(len(ob.data.vertices)), 1.0, "REPLACE")
    ob.modifiers.new("Multires", "MULTIRES")
    bpy.ops.object.multires_subdivide(modifier="Multires", mode="CATMULL_CLARK")
    (bm,) = scenes.edit(ob, mode="FACE")
    bm.faces.ensure_lookup_table()
    top = [f for f in bm.faces if f.calc_center_median().x > 0.8]
    bmesh.ops.delete(bm, geom=top, context="FACES")
    bmesh.update_edit_mesh(ob.data)
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not ob.data.validate(verbose=True)
    assert ob.modifiers["Multires"].total_levels == 1
    made = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    radius = np.linalg.norm([v.co for v in made.vertices], axis=1)
    assert len(radius) > len(ob.data.vertices) and 0.8 < radius.min() and radius.max() < 1.2
    assert all(v.groups and abs(v.groups[0].weight - 1) < 1e-5 for v in ob.data.vertices)
