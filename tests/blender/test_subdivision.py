"""Fills under a Subdivision modifier, cages and objects on the limit surface, against Blender's own evaluated modifier."""

import sys

import bmesh
import bpy
import numpy as np
import pytest
import scenes
import tripatch
from mathutils.bvhtree import BVHTree

fill = bpy.ops.mesh.fill_three_sided


def add_cage(rings=2, holes=1, remove=True, change=None, n=6, levels=2, **settings):
    """A cube sphere with n x n quads a side, under a Subdivision modifier. remove: faces around so many of its corners, else
    they are selected. change: a function of the BMesh, applied before."""
    bm = bmesh.new()
    bmesh.ops.create_cube(bm, size=2)
    bmesh.ops.subdivide_edges(bm, edges=bm.edges, cuts=n - 1, use_grid_fill=True)
    corners = [v for v in bm.verts if len(v.link_faces) == 3][:holes]
    for v in bm.verts:
        v.co.normalize()
    bm.verts.index_update()
    gone = set()
    for corner in corners:
        front, near = {corner}, set()
        for _ in range(rings):
            near |= {f for v in front for f in v.link_faces}
            front = {v for f in near for v in f.verts}
        gone |= near
    if change:
        change(bm, gone)
    gone = [f for f in gone if f.is_valid]
    if remove:
        bmesh.ops.delete(bm, geom=gone, context="FACES")
    else:
        for f in gone:
            f.select = True
    mesh = bpy.data.meshes.new("Cage")
    bm.to_mesh(mesh)
    bm.free()
    ob = bpy.data.objects.new("Cage", mesh)
    bpy.context.collection.objects.link(ob)
    bpy.ops.object.select_all(action="DESELECT")
    ob.select_set(True)
    bpy.context.view_layer.objects.active = ob
    ob.rotation_euler, ob.location, ob.scale = (0.3, 0.5, -0.2), (1, 2, 3), (1, 1.5, 0.75)
    bpy.context.view_layer.update()
    if levels is not None:
        modifier = ob.modifiers.new("Subdivision", "SUBSURF")
        modifier.levels = levels
        for name, value in settings.items():
            setattr(modifier, name, value)
    return ob


def around(bm, gone):
    """The rim of faces that are to be removed, and the faces outside that touch it."""
    bm.edges.index_update()
    bm.faces.index_update()
    rim = sorted({e for f in gone for e in f.edges if any(o not in gone for o in e.link_faces)}, key=lambda e: e.index)
    outside = {f for e in rim for v in e.verts for f in v.link_faces} - gone
    return rim, sorted(outside, key=lambda f: f.index)


def noise(bm, _gone):
    rng = np.random.default_rng(5)
    for v in bm.verts:
        v.co += type(v.co)(0.04 * rng.normal(size=3))


def edge_creases(bm, gone):
    layer = bm.edges.layers.crease.verify() if hasattr(bm.edges.layers, "crease") else bm.edges.layers.float.new("crease_edge")
    noise(bm, gone)
    rim, outside = around(bm, gone)
    for e in rim[:3]:
        e[layer] = 0.37
    for e in outside[4].edges:
        e[layer] = 0.81


def vertex_creases(bm, gone):
    layer = bm.verts.layers.crease.verify() if hasattr(bm.verts.layers, "crease") else bm.verts.layers.float.new("crease_vert")
    noise(bm, gone)
    rim, _ = around(bm, gone)
    for e in rim[::3]:
        e.verts[0][layer] = 0.6


def triangles_and_ngons(bm, gone):
    noise(bm, gone)
    _, outside = around(bm, gone)
    bmesh.ops.triangulate(bm, faces=outside[:3])
    pair = next(e for e in outside[8].edges if all(f not in gone and len(f.verts) == 4 for f in e.link_faces))
    bmesh.ops.dissolve_edges(bm, edges=[pair])


def extraordinary(bm, gone):
    """A rim vertex and one next to it get another valence: an edge between two faces outside is turned."""
    noise(bm, gone)
    _, outside = around(bm, gone)
    bmesh.ops.poke(bm, faces=[outside[5]])


def loose_edge(bm, gone):
    noise(bm, gone)
    rim, _ = around(bm, gone)
    vertex = rim[4].verts[0]
    bm.edges.new((vertex, bm.verts.new(vertex.co * 1.5)))


CHANGES = [noise, edge_creases, vertex_creases, triangles_and_ngons, extraordinary, loose_edge]


def evaluated(ob):
    """float32 positions, edges that border on one face only, and faces of what the modifiers make."""
    of = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = of.to_mesh()
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    faces = [tuple(p.vertices) for p in mesh.polygons]
    of.to_mesh_clear()
    count = {}
    for face in faces:
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            count[frozenset((a, b))] = count.get(frozenset((a, b)), 0) + 1
    border = {v for edge, faces_at in count.items() if faces_at == 1 for v in edge}
    return points.reshape(-1, 3), border, faces


def bits(points):
    return {p.tobytes() for p in np.asarray(points, np.float32) + np.float32(0)}


def part(addon, name):
    return sys.modules[f"{addon.__name__}.{name}"]


def set_output(ob, **options):
    """Runs the operator with nothing selected but what is; returns the new object, or None. The plain layout, unless given."""
    options.setdefault("rows", 0)
    before = set(bpy.data.objects)
    bpy.ops.object.mode_set(mode="EDIT")
    assert fill(**options) == {"FINISHED"}
    assert bpy.context.mode == "EDIT_MESH"
    bpy.ops.object.mode_set(mode="OBJECT")
    return next(iter(set(bpy.data.objects) - before), None)


@pytest.mark.parametrize("boundary", ["ALL", "PRESERVE_CORNERS"])
@pytest.mark.parametrize("change", CHANGES)
def test_limit_points_of_the_library_are_those_of_the_modifier(addon, change, boundary):
    ob = add_cage(change=change, levels=3, boundary_smooth=boundary)
    calls, limit_objects, filling, selection = (part(addon, n) for n in ("calls", "limit_objects", "filling", "selection"))
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    rims = selection.all_rims(bm)
    corners = [v for k, v in enumerate(rims[0].loop) if k % (len(rims[0].loop) // 3) == 0][:3]
    rims[0].corners = corners
    options = calls.Options({"surroundings": "limit"})
    outcome, new = limit_objects.fill_rims(ob, bm, filling.world_matrix("", ob.matrix_world), rims, options)
    bm.free()
    assert outcome.reports and not any("not on the surface" in note for note in outcome.notes)
    points, border, _ = evaluated(ob)
    own, own_border, _ = evaluated(new)
    assert bits(own[list(own_border)]) == bits(points[list(border)])  # no crack, to the last bit


@pytest.mark.parametrize("levels", [1, 2, 3, 4])
@pytest.mark.parametrize("output", ["triangles", "quads"])
def test_limit_closes_the_evaluated_model(levels, output):
    ob = add_cage(levels=levels)
    before = bits([v.co for v in ob.data.vertices])
    new = set_output(ob, surroundings="limit", output=output)
    assert bits([v.co for v in ob.data.vertices]) == before and len(new.modifiers) == 0
    points, border, _ = evaluated(ob)
    own, own_border, faces = evaluated(new)
    assert bits(own[list(own_border)]) == bits(points[list(border)])
    assert np.allclose(new.matrix_world, ob.matrix_world)
    assert {len(f) for f in faces} == ({3} if output == "triangles" else {4})


def test_limit_of_selected_faces_is_that_of_the_whole_cage():
    ob = add_cage(remove=False, change=noise)
    faces = len(ob.data.polygons)
    new = set_output(ob, surroundings="limit")
    assert len(ob.data.polygons) == faces
    points, border, _ = evaluated(ob)
    own, own_border, _ = evaluated(new)
    assert not border and own_border
    assert bits(own[list(own_border)]) <= bits(points)


def test_vertex_groups_stay_where_a_limit_surface_is_filled(addon):
    ob = add_cage()
    ob.vertex_groups.new(name="Bone").add(range(len(ob.data.vertices)), 0.7, "REPLACE")
    set_output(ob, surroundings="limit")
    assert [g.name for g in ob.vertex_groups] == ["Bone"]
    assert {round(g.weight, 3) for v in ob.data.vertices for g in v.groups} == {0.7}
    (made,) = (o for o in bpy.data.objects if o.type == "MESH" and o != ob)
    assert not made.vertex_groups


def test_materials_and_shading_come_along():
    ob = add_cage()
    for name in "AB":
        ob.data.materials.append(bpy.data.materials.new(name))
    ob.data.polygons.foreach_set("material_index", [1] * len(ob.data.polygons))
    ob.data.polygons.foreach_set("use_smooth", [True] * len(ob.data.polygons))
    new = set_output(ob, surroundings="limit")
    assert [s.material.name for s in new.material_slots] == ["A", "B"]
    assert {(p.material_index, p.use_smooth) for p in new.data.polygons} == {(1, True)}
    set_output(ob)
    assert {(p.material_index, p.use_smooth) for p in ob.data.polygons} == {(1, True)}


def test_a_modifier_makes_the_cage_the_default():
    ob = add_cage()
    assert set_output(ob) is None
    bm = scenes.checked(ob)
    assert all(e.is_manifold for e in bm.edges) and {len(f.verts) for f in bm.faces} == {4}
    bm.free()
    plain = add_cage(levels=None)
    set_output(plain, output="triangles")
    assert 3 in {len(p.vertices) for p in plain.data.polygons}


def rms_to_surface(points, of):
    """Of points to a surface (points, faces), each quad as two triangles."""
    tree = BVHTree.FromPolygons(of[0].tolist(), of[2])
    return np.sqrt(np.mean([tree.find_nearest(p)[3] ** 2 for p in points.tolist()]))


def test_a_replaced_region_comes_back_on_the_surface_that_it_had():
    ob = add_cage(remove=False, levels=3, n=8)
    ob.matrix_world.identity()
    old = evaluated(ob)
    set_output(ob, rows=-1)
    new = evaluated(ob)
    assert not new[1]
    assert rms_to_surface(new[0], old) < 5e-4 * 2


def test_an_exact_rim_moves_nothing_around():
    ob = add_cage(levels=3, change=noise)
    before, border, _ = evaluated(ob)
    set_output(ob, cage_rim="exact")
    after, left, _ = evaluated(ob)
    assert not left
    tree = BVHTree.FromPolygons(after.tolist(), evaluated(ob)[2])
    assert max(tree.find_nearest(p)[3] for p in before.tolist()) < 2e-6
    edges = ob.data.attributes.get("crease_edge")
    creased = [d.value for d in edges.data] if edges else [e.crease for e in ob.data.edges]
    assert sum(c > 0.99 for c in creased) == 12


def test_a_moved_rim_moves():
    ob = add_cage(change=noise)
    before = bits([v.co for v in ob.data.vertices])
    set_output(ob, cage_rim="move")
    assert 0 < len(before - bits([v.co for v in ob.data.vertices])) <= 12


@pytest.mark.parametrize("levels", [1, 2, 3, 4])
def test_a_cage_closes_without_a_crack(levels):
    ob = add_cage(levels=levels, change=triangles_and_ngons)
    bpy.ops.object.mode_set(mode="EDIT")
    bm = bmesh.from_edit_mesh(ob.data)
    loop = scenes.border_loops(bm)[0]
    bpy.ops.mesh.select_mode(type="VERT")
    bpy.ops.mesh.select_all(action="DESELECT")
    scenes.select(bm, loop[:: len(loop) // 3][:3])
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not evaluated(ob)[1]


def odd_rim(bm, gone):
    """One of the faces to be removed keeps half of itself."""
    rim, _ = around(bm, gone)
    edge, face = next((e, f) for e in rim for f in e.link_faces if f in gone and sum(o in rim for o in f.edges) == 1)
    gone.discard(face)
    parts = bmesh.ops.triangulate(bm, faces=[face])["faces"]
    gone.add(next(f for f in parts if edge not in f.edges))


def edit_with_corners(ob, first=0):
    """Edit mode, with three corners of the rim selected, the first so many steps from the first vertex with the fewest faces.
    Returns that vertex's index and the rim's length."""
    bpy.ops.object.mode_set(mode="EDIT")
    bm = bmesh.from_edit_mesh(ob.data)
    loop = scenes.border_loops(bm)[0]
    tip = min(range(len(loop)), key=lambda k: len(loop[k].link_faces))
    bpy.ops.mesh.select_mode(type="VERT")
    bpy.ops.mesh.select_all(action="DESELECT")
    scenes.select(bm, [loop[(tip + first + k) % len(loop)] for k in (0, 4, 8)])
    return loop[tip].index, len(loop)


@pytest.mark.parametrize("odd", ["split", "triangle"])
@pytest.mark.parametrize("output", ["cage", "quads"])
def test_an_odd_rim(odd, output):
    ob = add_cage(rings=2, change=odd_rim)
    ob.data.uv_layers.new(name="Map")
    vertices, edges, faces = len(ob.data.vertices), len(ob.data.edges), len(ob.data.polygons)
    extent = np.ptp(evaluated(ob)[0], axis=0).max()
    assert edit_with_corners(ob, 2)[1] % 2
    assert fill(output=output, odd=odd, rows=0, method="side_vertex", fairing="none") == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    bm = scenes.checked(ob)
    assert all(e.is_manifold and e.is_contiguous for e in bm.edges) and len(bm.edges) > edges and len(bm.verts) > vertices
    new = list(bm.faces)[faces:]
    assert sum(len(f.verts) == 3 for f in new) == (odd == "triangle")
    assert max(len(f.verts) for f in bm.faces) == (5 if odd == "split" else 4)
    assert np.ptp([v.co for v in bm.verts], axis=0).max() < 1.5 * extent
    bm.free()


@pytest.mark.parametrize("odd", ["split", "triangle"])
def test_a_corner_with_two_edges_in_the_closed_cage_is_refused(odd):
    """The limit surface has no tangent plane there; the fill would run away, beyond what float32 holds."""
    ob = add_cage(rings=2, change=odd_rim)
    before = bits([v.co for v in ob.data.vertices]), len(ob.data.polygons)
    tip, _ = edit_with_corners(ob)
    with pytest.raises(RuntimeError, match=f"no tangent plane at vertex {tip}"):
        fill(odd=odd, output="cage")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert (bits([v.co for v in ob.data.vertices]), len(ob.data.polygons)) == before


@pytest.mark.parametrize("remove", [True, False])
def test_several_holes_that_share_surroundings_are_fitted_together(remove):
    """Mirrored holes get mirrored fills, which they would not one after the other."""
    ob = add_cage(holes=8, n=6, remove=remove)
    ob.matrix_world.identity()
    if remove:
        bpy.ops.object.mode_set(mode="EDIT")
        bm = bmesh.from_edit_mesh(ob.data)
        bpy.ops.mesh.select_mode(type="VERT")
        bpy.ops.mesh.select_all(action="DESELECT")
        scenes.select(bm, [v for v in bm.verts if v.is_boundary and len(v.link_faces) == 3])
        bpy.ops.object.mode_set(mode="OBJECT")
    else:
        bpy.context.tool_settings.mesh_select_mode = (False, False, True)
    set_output(ob)
    assert not evaluated(ob)[1] and len(ob.data.polygons) == 6 * 6 * 6
    new = np.unique([ob.data.vertices[v].co for p in ob.data.polygons if p.select for v in p.vertices], axis=0)
    assert sum(p.select for p in ob.data.polygons) == 96
    for mirror in ((-1, 1, 1), (1, -1, 1), (1, 1, -1)):
        assert np.linalg.norm((new * mirror)[:, None] - new, axis=2).min(axis=1).max() < 1e-3


def test_several_holes_at_once():
    ob = add_cage(holes=2, n=6)
    bpy.ops.object.mode_set(mode="EDIT")
    bm = bmesh.from_edit_mesh(ob.data)
    bpy.ops.mesh.select_mode(type="EDGE")
    for loop in scenes.border_loops(bm):
        scenes.select_rim(bm, loop)
    assert fill(rows=1) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not evaluated(ob)[1]


def test_add_modifier():
    ob = add_cage(levels=None)
    set_output(ob, output="cage")
    assert [(m.type, m.levels) for m in ob.modifiers] == [("SUBSURF", 2)]
    ob = add_cage(levels=None)
    set_output(ob, output="cage", add_modifier=False)
    assert not ob.modifiers


def test_undo_removes_what_was_made():
    for options in ({"rows": 0}, {"surroundings": "limit"}, {"cage_rim": "exact", "rows": 0}):
        bpy.ops.object.mode_set(mode="OBJECT") if bpy.context.mode != "OBJECT" else None
        ob = add_cage()
        before = scenes.arrays(ob)
        bpy.ops.ed.undo_push(message="made")
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.ed.undo_push(message="before")
        names = {o.name for o in bpy.data.objects}
        assert fill(**options) == {"FINISHED"}
        bpy.ops.ed.undo_push(message="filled")
        bpy.ops.ed.undo()
        assert {o.name for o in bpy.data.objects} == names
        bpy.ops.object.mode_set(mode="OBJECT")
        assert scenes.arrays(bpy.context.view_layer.objects.active) == before


def refused(ob, sentence, **options):
    before = scenes.arrays(ob)
    names = set(bpy.data.objects.keys())
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match=sentence):
        fill(**options)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert scenes.arrays(ob) == before and set(bpy.data.objects.keys()) == names


def test_what_changes_the_cage_is_refused_by_name():
    ob = add_cage(levels=None)
    ob.modifiers.new("Half", "MIRROR")
    ob.modifiers.new("Subdivision", "SUBSURF")
    ob.modifiers[0].use_bisect_axis = (True, False, False)
    refused(ob, "'Half' of Cage changes the cage")
    refused(ob, "'Half' of Cage changes the cage", surroundings="limit")
    ob.modifiers[0].show_viewport = False
    set_output(ob)
    ob = add_cage(levels=None)
    ob.modifiers.new("Fewer", "DECIMATE").ratio = 0.5
    ob.modifiers.new("Subdivision", "SUBSURF")
    refused(ob, f"'Fewer' of {ob.name} changes the cage", surroundings="limit")
    set_output(ob)  # it is off in edit mode


def half(bm, gone):
    """Only what lies at x < 0 is kept: a mirror image completes it. The hole is next to that plane, not on it."""
    noise(bm, gone)
    for v in bm.verts:
        if abs(v.co.x) < 0.16:
            v.co.x = 0
    bmesh.ops.delete(bm, geom=[v for v in bm.verts if v.co.x > 0.01], context="VERTS")


@pytest.mark.parametrize("where", ["before", "after"])
def test_a_mirror_is_read(where):
    """Before the Subdivision modifier the cage is that of both halves; the new object is mirrored as the original is."""
    ob = add_cage(levels=None, change=half if where == "before" else noise, n=6, rings=1)
    ob.matrix_world.identity()
    if where == "before":
        ob.modifiers.new("Mirror", "MIRROR")
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 2
    if where == "after":
        mirror = ob.modifiers.new("Mirror", "MIRROR")
        mirror.use_axis, mirror.use_mirror_merge = (False, False, True), False
    bpy.ops.object.mode_set(mode="EDIT")
    bm = bmesh.from_edit_mesh(ob.data)
    loops = [loop for loop in scenes.border_loops(bm) if all(abs(v.co.x) > 0.01 for v in loop)]
    assert len(loops) == 1
    bpy.ops.mesh.select_mode(type="VERT")
    bpy.ops.mesh.select_all(action="DESELECT")
    scenes.select(bm, loops[0][:: len(loops[0]) // 3][:3])
    before = set(bpy.data.objects)
    assert fill(surroundings="limit") == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    (new,) = set(bpy.data.objects) - before
    assert [m.type for m in new.modifiers] == ["MIRROR"]
    points, border, _ = evaluated(ob)
    own, own_border, _ = evaluated(new)
    own, points = own[list(own_border)], points[list(border)]
    # An image is subdivided by Blender again before and copied after: bit for bit where there is but one computation.
    gaps = np.linalg.norm(own[:, None].astype(float) - points[None], axis=2)
    assert len(own) == len(points) and gaps.min(axis=1).max() < 2e-6 * 2 and gaps.min(axis=0).max() < 2e-6 * 2
    first = [p[p[:, 0] < 0] if where == "before" else p for p in (own, points)]
    assert len(first[0]) and bits(first[0]) == bits(first[1])


def beside_the_plane(ob, **options):
    """Fills the hole of half a cage that is not on the plane, by default with a cage; returns the new vertices."""
    before = len(ob.data.vertices)
    bpy.ops.object.mode_set(mode="EDIT")
    bm = bmesh.from_edit_mesh(ob.data)
    loop = next(loop for loop in scenes.border_loops(bm) if all(v.co.x < -0.01 for v in loop))
    bpy.ops.mesh.select_mode(type="VERT")
    bpy.ops.mesh.select_all(action="DESELECT")
    scenes.select(bm, loop[:: len(loop) // 3][:3])
    assert fill(rows=1, **options) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    return np.array([v.co for v in ob.data.vertices[before:]])


@pytest.mark.parametrize("cage_rim", ["smooth", "exact", "move"])
def test_a_cage_is_fitted_to_both_halves_of_a_mirror(cage_rim):
    """As if the Mirror modifier had been applied before: the image of the hole is still open when the first is fitted."""
    made = []
    for applied in (False, True):
        ob = add_cage(levels=None, change=half, n=4, rings=1)
        ob.matrix_world.identity()
        ob.modifiers.new("Mirror", "MIRROR")
        ob.modifiers.new("Subdivision", "SUBSURF").levels = 2
        if applied:
            bpy.ops.object.modifier_apply(modifier="Mirror")
        made.append(beside_the_plane(ob, cage_rim=cage_rim))
        if not applied:
            assert not evaluated(ob)[1]  # the modifier mirrors the fill
    assert len(made[0]) and np.abs(made[0] - made[1]).max() < 1e-6


def test_shape_keys_of_a_mirrored_cage():
    ob = add_cage(levels=None, change=half, n=6, rings=1)
    ob.modifiers.new("Mirror", "MIRROR")
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 2
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Large")
    for point in key.data:
        point.co *= 1.5
    new = len(beside_the_plane(ob))
    keys = ob.data.shape_keys.key_blocks
    basis, large = (np.array([point.co for point in keys[name].data])[-new:] for name in ("Basis", "Large"))
    assert np.abs(large - 1.5 * basis).max() < 1e-2


def test_a_hole_on_a_mirror_plane_is_refused():
    ob = add_cage(levels=None, remove=False, change=half)
    ob.modifiers.new("Mirror", "MIRROR")
    ob.modifiers.new("Subdivision", "SUBSURF")
    bpy.ops.object.mode_set(mode="EDIT")
    bm = bmesh.from_edit_mesh(ob.data)
    bpy.ops.mesh.select_all(action="DESELECT")
    scenes.select(bm, scenes.border_loops(bm)[0][::8][:3])
    with pytest.raises(RuntimeError, match="closes the hole at vertex"):
        fill(surroundings="limit")
    with pytest.raises(RuntimeError, match="plane of a Mirror"):
        fill()
    bpy.ops.object.mode_set(mode="OBJECT")


def test_what_changes_the_surface_is_refused_by_name():
    ob = add_cage()
    ob.modifiers.new("Waves", "DISPLACE")
    refused(ob, "'Waves' of Cage changes the subdivided surface", surroundings="limit")
    set_output(ob, output="cage")


def test_a_modifier_that_does_not_smooth():
    ob = add_cage()
    ob.modifiers[0].subdivision_type = "SIMPLE"
    refused(ob, "Simple")
    ob.modifiers[0].subdivision_type = "CATMULL_CLARK"
    ob.modifiers[0].levels = 0
    refused(ob, "no levels", surroundings="limit")
    ob.modifiers[0].use_creases = False
    refused(ob, "does not use creases", cage_rim="exact")
    ob.modifiers.clear()
    refused(ob, "no Subdivision modifier", surroundings="limit")


@pytest.mark.parametrize("cage_rim", ["smooth", "move"])
def test_shape_keys_follow_a_cage(cage_rim):
    ob = add_cage(change=noise)
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Large")
    for point in key.data:
        point.co *= 1.5
    set_output(ob, cage_rim=cage_rim)
    keys = ob.data.shape_keys.key_blocks
    new = [v for p in list(ob.data.polygons)[-6:] for v in p.vertices]
    basis, large = (np.array([keys[name].data[v].co for v in new]) for name in ("Basis", "Large"))
    assert np.abs(large - 1.5 * basis).max() < 1e-4


@pytest.mark.parametrize("change", [noise, odd_rim])
def test_custom_normals_elsewhere_keep(change):
    ob = add_cage(change=change)
    mesh = ob.data
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
    mesh.normals_split_custom_set([tuple(mesh.vertices[loop.vertex_index].co.normalized()) for loop in mesh.loops])
    before = {tuple(sorted(p.vertices)): scenes.corner_normals(mesh)[list(p.loop_indices)] for p in mesh.polygons}
    edit_with_corners(ob, 2)
    assert fill(rows=0) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    after = {tuple(sorted(p.vertices)): scenes.corner_normals(mesh)[list(p.loop_indices)] for p in mesh.polygons}
    same = [np.abs(after[f] - normals).max() < 1e-3 for f, normals in before.items() if f in after]
    assert len(same) >= len(before) - 1 and np.mean(same) > 0.9
    far = [f for f in before if f in after and not set(f) & {v.index for v in mesh.vertices if v.select}]
    assert far and all(np.abs(after[f] - before[f]).max() < 1e-3 for f in far)


def test_a_region_of_suzanne_by_blenders_own_modifier():
    """Three rings round the vertex of three edges at the jaw: the evaluated modifier before and after."""
    bpy.ops.mesh.primitive_monkey_add()
    ob = bpy.context.object
    modifier = ob.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = 4
    points, _, faces = evaluated(ob)
    tree = BVHTree.FromPolygons(points.tolist(), faces)
    vertices = np.array([v.co for v in ob.data.vertices], float)
    cage = [list(p.vertices) for p in ob.data.polygons]
    valence = np.bincount(np.concatenate(cage), minlength=len(vertices))
    near, gone = {int(np.argmin(np.linalg.norm(vertices - [0.33, -0.4, -0.91], axis=1) + 10 * (valence != 3)))}, set()
    for _ in range(3):
        gone |= {f for f, face in enumerate(cage) if near & set(face)}
        near = {v for f in gone for v in cage[f]}
    left = [face for f, face in enumerate(cage) if f not in gone]
    rim = next(r for r in tripatch.find_holes(left) if set(r.tolist()) <= near)
    corners = next(r for r in (rim[k::6].tolist() for k in range(6)) if all(sum(v in f for f in left) >= 3 for v in r))
    result = tripatch.fill(vertices, cage, rim=rim, corners=corners, replaced=sorted(gone), output="cage")
    assert len(result.faces) == 27
    mesh = bpy.data.meshes.new("Filled")
    mesh.from_pydata(np.concatenate([vertices, result.vertices]).tolist(), [], [*left, *result.faces.tolist()])
    ob.data = mesh
    modifier.levels = 3
    after = evaluated(ob)[0][::3]
    distance = np.array([tree.find_nearest(p)[3] for p in after.tolist()])
    width = np.ptp(vertices, axis=0).max()
    print(f"FIGURE suzanne cage rms {np.sqrt(np.mean(distance**2)) / width:.1e} of the width, most {distance.max() / width:.1e}")
    assert np.sqrt(np.mean(distance**2)) < 2e-3 * width
    assert distance.max() < 3e-2 * width
