"""mesh.smooth_triangles: a smooth surface, a watertight mesh that keeps its attributes, refusals that change nothing."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes

smooth = bpy.ops.mesh.smooth_triangles


def library_surface(*arguments, **options):
    import tripatch  # there once the add-on is

    return tripatch.smooth_triangles(*arguments, **options)


def add_blob(levels=2, bend=True):
    """An icosphere (80 faces), bent so that it is no sphere."""
    bm = bmesh.new()
    bmesh.ops.create_icosphere(bm, subdivisions=levels, radius=1)
    p = np.array([v.co for v in bm.verts])
    faces = [[v.index for v in f.verts] for f in bm.faces]
    bm.free()
    if bend:
        p = p * (1 + 0.2 * np.sin(2 * p[:, [1, 2, 0]])) + 0.1 * p[:, [2, 0, 1]] ** 2
    return scenes.add_mesh(p, faces, "Blob")


def select_all(*objects):
    scenes.edit(*objects, mode="FACE")
    bpy.ops.mesh.select_all(action="SELECT")


def select_top(ob, mode="FACE"):
    """Selects the faces with all vertices above a plane; the indices of the faces."""
    (bm,) = scenes.edit(ob, mode=mode)
    top = [f for f in bm.faces if all(v.co.z > 0.1 for v in f.verts)]
    assert 10 < len(top) < len(bm.faces) - 10
    scenes.select(bm, faces=top)
    return [f.index for f in top]


def finished(ob):
    bpy.ops.object.mode_set(mode="OBJECT")
    return scenes.checked(ob)


def positions(ob):
    return np.array([v.co for v in ob.data.vertices])


def test_the_whole_mesh_is_the_surface_of_the_library():
    for curve in ("hermite", "smits"):
        ob = add_blob()
        before = positions(ob)
        faces = [list(p.vertices) for p in ob.data.polygons]
        expected = library_surface(before, faces, resolution=5, curve=curve)
        select_all(ob)
        assert smooth(resolution=5, curve=curve) == {"FINISHED"}
        bm = finished(ob)
        assert len(bm.faces) == 25 * 80
        assert all(e.is_manifold and e.is_contiguous for e in bm.edges)
        np.testing.assert_allclose(positions(ob), expected.vertices, atol=2e-6)
        assert positions(ob)[: len(before)].tobytes() == before.tobytes()
        assert all(p.select and p.use_smooth for p in ob.data.polygons)
        bm.free()


def angles_over_old_edges(resolution):
    """Angles in degrees between new faces on the two sides of an old edge, and the largest between the old faces."""
    ob = add_blob()
    with_old = bmesh.new()
    with_old.from_mesh(ob.data)
    old = max(np.degrees(e.calc_face_angle()) for e in with_old.edges)
    with_old.free()
    select_all(ob)
    smooth(resolution=resolution)
    bm = finished(ob)
    bm.faces.index_update()
    parts = resolution**2  # the new faces come in the order of the old ones
    over = [e for e in bm.edges if len({f.index // parts for f in e.link_faces}) == 2]
    assert len(over) == 120 * resolution
    angle = max(np.degrees(e.calc_face_angle()) for e in over)
    bm.free()
    return angle, old


def test_tangent_planes_agree_over_old_edges():
    # Flat faces on a smooth surface meet at angles that halve with their size; a crease keeps its angle.
    (coarse, old), (middle, _), (fine, _) = (angles_over_old_edges(r) for r in (8, 16, 32))
    assert old > 20
    assert 1.8 < coarse / middle < 2.2
    assert 1.8 < middle / fine < 2.2
    assert abs(8 * fine - 6 * middle + coarse) / 3 < 0.1, (coarse, middle, fine)  # extrapolated to faces without size


def test_unselected_neighbors_take_the_new_vertices():
    ob = add_blob()
    whole = add_blob()
    select_all(whole)
    smooth(resolution=4)
    all_points = {tuple(p) for p in np.round(positions_of(whole), 5).tolist()}
    count, before = len(ob.data.polygons), positions(ob)
    old = [set(p.vertices) for p in ob.data.polygons]
    top = select_top(ob)
    assert smooth(resolution=4) == {"FINISHED"}
    bm = finished(ob)
    assert all(e.is_manifold and e.is_contiguous for e in bm.edges), "the mesh is not watertight"
    assert len(bm.faces) == count + 15 * len(top)
    assert positions(ob)[: len(before)].tobytes() == before.tobytes()
    shared = 0
    for f in [f for f in bm.faces if not f.select]:
        corners = {v.index for v in f.verts if v.index < len(before)}
        assert corners in old
        borders = sum(len(corners & old[t]) == 2 for t in top)
        assert len(f.verts) == 3 + 3 * borders
        shared += borders
    assert shared > 5
    # the normals are those of the whole mesh, so that the smoothed part lies on the whole surface
    new = np.round(positions(ob), 5)
    assert all(tuple(p) in all_points for p in new.tolist())
    assert sum(f.select for f in bm.faces) == 16 * len(top)
    bm.free()


def positions_of(ob):
    bpy.ops.object.mode_set(mode="OBJECT")
    return positions(ob)


def test_edges_and_materials_are_kept():
    ob = add_blob()
    for name in ("a", "b"):
        ob.data.materials.append(bpy.data.materials.new(name))
    for p in ob.data.polygons:
        p.material_index, p.use_smooth = p.index % 2, p.index % 3 > 0
    top = select_top(ob)
    bm = bmesh.from_edit_mesh(ob.data)
    bm.edges.ensure_lookup_table()
    border = [e for e in bm.edges if {f.select for f in e.link_faces} == {True, False}]
    inner = [e for e in bm.edges if all(f.select for f in e.link_faces)]
    for e in (border[0], inner[0]):
        e.seam, e.smooth = True, False
    old = {f.index: (f.material_index, f.smooth) for f in bm.faces}
    smooth(resolution=3)
    bm = finished(ob)
    bm.faces.ensure_lookup_table()
    assert sum(e.seam for e in bm.edges) == sum(not e.smooth for e in bm.edges) == 6
    rest = [k for k in old if k not in top]
    for k, f in enumerate(bm.faces):
        source = rest[k] if k < len(rest) else top[(k - len(rest)) // 9]
        assert (f.material_index, f.smooth) == old[source]
    bm.free()


def test_loop_and_vertex_data_are_linear_in_every_triangle():
    # A map that is linear in each triangle, other in each: barycentric coordinates of the triangle, moved by its number.
    ob = add_blob()
    uv = ob.data.uv_layers.new(name="UV")
    for p in ob.data.polygons:
        for corner, at in zip(p.loop_indices, ((0, 0), (1, 0), (0, 1)), strict=True):
            uv.data[corner].uv = (at[0] + 2 * p.index, at[1])
    group = ob.vertex_groups.new(name="Height")
    for v in ob.data.vertices:
        group.add([v.index], 0.5 + 0.2 * v.co.z, "REPLACE")
    old = [list(p.vertices) for p in ob.data.polygons]
    top = select_top(ob)
    rest = [k for k in range(len(old)) if k not in top]
    n = 4
    smooth(resolution=n)
    bm = finished(ob)
    uv, deform = bm.loops.layers.uv["UV"], bm.verts.layers.deform.active
    bm.faces.ensure_lookup_table()
    for k, f in enumerate(bm.faces):
        at = np.array([c[uv].uv for c in f.loops])
        source = rest[k] if k < len(rest) else top[(k - len(rest)) // n**2]
        at[:, 0] -= 2 * source
        np.testing.assert_allclose(n * at, np.round(n * at), atol=1e-4)  # lattice points
        assert at.min() > -1e-5 and at.sum(axis=1).max() < 1 + 1e-5
        area = 0.5 * (at[:, 0] @ np.roll(at[:, 1], -1) - at[:, 1] @ np.roll(at[:, 0], -1))
        assert abs(area - (0.5 if k < len(rest) else 0.5 / n**2)) < 1e-5  # an n-gon covers what its triangle did
    bm.verts.ensure_lookup_table()
    weights = [bm.verts[v][deform][group.index] for v in old[top[0]]]
    for f in list(bm.faces)[len(rest) : len(rest) + n**2]:
        for c in f.loops:
            u, v = c[uv].uv[0] - 2 * top[0], c[uv].uv[1]
            assert abs(c.vert[deform][group.index] - np.dot([1 - u - v, u, v], weights)) < 1e-5
    bm.free()


def test_a_scaled_object_is_as_one_with_applied_scale():
    results = []
    for applied in (False, True):
        ob = add_blob()
        ob.rotation_euler, ob.location = (0.3, 0.7, -0.4), (1, 2, 3)
        ob.scale = (3, -1, 0.4)
        bpy.context.view_layer.update()
        if applied:
            matrix = ob.matrix_world.copy()
            ob.data.transform(matrix)
            ob.matrix_world.identity()
            bpy.context.view_layer.update()
        select_top_by_index(ob)
        assert smooth(resolution=4) == {"FINISHED"}
        points = positions_of(ob)
        world = np.array(ob.matrix_world)
        results.append(points @ world[:3, :3].T + world[:3, 3])
    np.testing.assert_allclose(*results, atol=1e-5)


def select_top_by_index(ob):
    (bm,) = scenes.edit(ob, mode="FACE")
    scenes.select(bm, faces=list(bm.faces)[:30])


def test_several_objects():
    objects = [add_blob(), add_blob()]
    objects[1].name = "Second"
    select_all(*objects)
    assert smooth(resolution=2) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [len(ob.data.polygons) for ob in objects] == [320, 320]


def test_shape_keys_are_smoothed_each_by_itself():
    ob = add_blob()
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Wide")
    for d in key.data:
        d.co = (2 * d.co.x, d.co.y, 0.5 * d.co.z)
    ob.active_shape_key_index = 0
    wide = np.array([d.co for d in key.data])
    faces = [list(p.vertices) for p in ob.data.polygons]
    before = positions(ob)
    select_all(ob)
    assert smooth(resolution=3) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, points in (("Basis", before), ("Wide", wide)):
        expected = library_surface(points, faces, resolution=3).vertices
        found = np.array([d.co for d in ob.data.shape_keys.key_blocks[name].data])
        np.testing.assert_allclose(found, expected, atol=4e-6)


def test_a_shape_key_that_cannot_be_smoothed_moves_with_its_triangles():
    ob = add_blob()
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Flat")
    faces = [list(p.vertices) for p in ob.data.polygons]
    key.data[faces[7][2]].co = key.data[faces[7][0]].co  # two faces without area
    ob.active_shape_key_index = 0
    moved = np.array([d.co for d in key.data]) - positions(ob)
    select_all(ob)
    assert smooth(resolution=2) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    found = np.array([d.co for d in key.data]) - positions(ob)
    for k, face in enumerate(faces):
        inner = ob.data.polygons[4 * k + 2], ob.data.polygons[4 * k + 1]
        for v in {v for p in inner for v in p.vertices if v >= len(moved)}:
            assert any(np.allclose(found[v], (moved[face[i]] + moved[face[i - 1]]) / 2, atol=1e-6) for i in range(3))
    assert np.abs(found[len(moved) :]).max() > 0.05


@pytest.mark.parametrize("mirrored", [False, True])
def test_custom_normals_give_the_surface_and_take_its_normals(mirrored):
    ob = add_blob(bend=False)
    ob.scale.y = -1 if mirrored else 1
    bpy.context.view_layer.update()
    axis = np.array([v.co for v in ob.data.vertices])
    ob.data.normals_split_custom_set_from_vertices([tuple(n) for n in (axis + [0, 0, 0.2]).tolist()])
    if hasattr(ob.data, "use_auto_smooth"):
        ob.data.use_auto_smooth = True
    before = dict(zip((c.vertex_index for c in ob.data.loops), scenes.corner_normals(ob.data), strict=True))
    given = np.array([before[v] for v in range(len(axis))])
    faces = [list(p.vertices) for p in ob.data.polygons]
    expected = library_surface(axis, faces, given, resolution=4)
    select_top(ob)
    assert smooth(resolution=4) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    points = positions(ob)
    nearest = [int(np.argmin(((expected.vertices - p) ** 2).sum(axis=1))) for p in points]
    np.testing.assert_allclose(points, expected.vertices[nearest], atol=2e-6)
    exact = expected.normals[[nearest[corner.vertex_index] for corner in ob.data.loops]]
    cosine = (scenes.corner_normals(ob.data) * exact).sum(axis=1)
    assert np.degrees(np.arccos(min(cosine.min(), 1))) < 0.2


def refusal(ob, words):
    """Calls the operator, which must refuse in these words and leave every bit."""
    bpy.ops.object.mode_set(mode="OBJECT")
    before = scenes.arrays(ob)
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match=words):
        smooth()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert scenes.arrays(ob) == before


def test_nothing_selected_is_refused():
    ob = add_blob()
    scenes.edit(ob)
    refusal(ob, "No face is selected; select the faces to be smoothed")


def test_quads_and_polygons_are_cut_into_the_triangles_that_blender_draws():
    ob = scenes.add_mesh(*scenes.square_hole())
    layer = ob.data.uv_layers.new(name="UV")
    for k, corner in enumerate(layer.data):
        corner.uv = tuple(ob.data.vertices[ob.data.loops[k].vertex_index].co.xy)
    (bm,) = scenes.edit(ob, mode="FACE")
    scenes.select(bm, faces=[f for f in bm.faces if f.index in (12, 13, 20)])
    chosen = [f for f in bm.faces if f.select]
    cut = [[v.vert.index for v in three] for three in bm.calc_loop_triangles() if three[0].face in chosen]
    count, vertices = len(bm.faces), positions(ob)
    assert smooth(resolution=3) == {"FINISHED"}
    bm = finished(ob)
    assert len(bm.faces) == count - len(chosen) + 9 * len(cut)
    bm.free()
    assert positions(ob)[: len(vertices)].tobytes() == vertices.tobytes()
    whole = library_surface(vertices, cut, resolution=3)
    assert len(ob.data.vertices) == len(whole.vertices)
    uv = ob.data.uv_layers["UV"].data
    apart = [
        np.linalg.norm(np.array(uv[k].uv) - np.array(ob.data.vertices[loop.vertex_index].co.xy))
        for k, loop in enumerate(ob.data.loops)
    ]
    assert max(apart) < 0.1, "texture coordinates go along"


def test_a_triangle_between_the_corners_of_a_quad_is_refused():
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    ob = scenes.add_mesh(points, [[0, 1, 2, 3], [2, 1, 0], [1, 2, 3]])
    (bm,) = scenes.edit(ob, mode="FACE")
    scenes.select(bm, faces=[f for f in bm.faces if f.index == 0])
    refusal(ob, "have the same vertices; delete one of them")


def test_a_face_with_another_on_its_back_is_refused_by_their_numbers():
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    ob = scenes.add_mesh(points, [[0, 1, 2], [1, 0, 3], [2, 1, 4], [0, 2, 5], [2, 1, 0]])
    scenes.edit(ob, mode="FACE")
    bpy.ops.mesh.select_all(action="SELECT")
    refusal(ob, "Faces 0 and 4 have the same vertices; delete one of them")


def test_a_face_without_area_is_refused_by_its_number():
    ob = add_blob()
    a, b, c = ob.data.polygons[7].vertices
    ob.data.vertices[c].co = (ob.data.vertices[a].co + ob.data.vertices[b].co) / 2
    ob.data.vertices[a].co, ob.data.vertices[b].co, ob.data.vertices[c].co = (0, 0, 0), (2, 0, 0), (1, 0, 0)
    (bm,) = scenes.edit(ob, mode="FACE")
    scenes.select(bm, faces=[f for f in bm.faces if f.index == 7])
    refusal(ob, "Face 7 has no area")


def test_a_coordinate_that_is_no_number_is_refused_by_its_vertex():
    ob = add_blob()
    ob.data.vertices[5].co.x = float("nan")
    scenes.edit(ob, mode="FACE")
    bpy.ops.mesh.select_all(action="SELECT")
    with pytest.raises(RuntimeError, match="vertex 5 is not finite"):
        smooth()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(ob.data.polygons) == 80


def test_three_faces_at_an_edge_share_its_new_vertices():
    ob = scenes.add_mesh([(0, 0, 0), (0, 0, 1), (1, 0, 0.5), (-1, 0.3, 0.5), (-1, -1, 0.5)], [[0, 1, 2], [1, 0, 3], [1, 0, 4]])
    select_all(ob)
    assert smooth(resolution=4) == {"FINISHED"}
    bm = finished(ob)
    assert (len(bm.faces), len(bm.verts)) == (48, 5 + 7 * 3 + 3 * 3)
    assert sorted(len(e.link_faces) for e in bm.edges).count(3) == 4
    bm.free()


def test_normals_that_cancel_are_refused_by_the_vertex():
    ob = scenes.add_mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [[0, 1, 2], [0, 2, 1]])
    select_all(ob)
    with pytest.raises(RuntimeError, match="The normal of vertex 0 is zero"):
        smooth()


def test_an_object_scaled_to_nothing_is_refused():
    ob = add_blob()
    ob.scale.z = 0
    bpy.context.view_layer.update()
    select_all(ob)
    refusal(ob, "a scale of zero")


def test_undo_brings_back_every_bit_and_redo_the_surface():
    ob = add_blob()
    ob.data.uv_layers.new(name="UV")
    select_top(ob)
    scenes.undone_and_redone(ob.name, lambda: smooth("EXEC_DEFAULT", True, resolution=3))


def test_both_operators_are_in_the_menus():
    assert smooth.get_rna_type().name == "Smooth Triangles"
    for menu in (bpy.types.VIEW3D_MT_edit_mesh_faces, bpy.types.VIEW3D_MT_edit_mesh_context_menu):
        drawn = []

        class Layout:
            """Takes whatever Blender's own entries ask for."""

            def __getattr__(self, _name):
                return lambda *_, **__: Layout()

            def operator(self, name, drawn=drawn, **_):
                drawn.append(name)
                return Layout()

        class Menu:
            bl_label = menu.bl_label
            layout = Layout()

        for draw in menu._dyn_ui_initialize():
            if draw.__module__.startswith(("tripatch_blender", "bl_ext")):
                draw(Menu(), bpy.context)
        assert {"mesh.fill_smooth", "mesh.smooth_triangles"} <= set(drawn)
