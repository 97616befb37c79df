"""Quads and cages in holes of four sides and more."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes

smooth = bpy.ops.mesh.fill_smooth


def add_sectors(n, size=5, inner=2):
    """n sectors of quads about a pole on a paraboloid, without those within `inner` of the pole; and the hole's corners."""
    bm, at = bmesh.new(), {}

    def vertex(s, i, j):
        key = (s, i, j) if i and j else (s, i) if i else ((s + 1) % n, j) if j else ()
        if key not in at:
            a, b = 2 * np.pi * s / n, 2 * np.pi * (s + 1) / n
            x, y = (i * np.array([np.cos(a), np.sin(a)]) + j * np.array([np.cos(b), np.sin(b)])) / size
            at[key] = bm.verts.new((x, y, 0.2 * (x * x + y * y)))
        return at[key]

    for s in range(n):
        for i in range(size):
            for j in range(size):
                if max(i, j) >= inner:
                    bm.faces.new(
                        [vertex(s, i, j), vertex(s, i + 1, j), vertex(s, i + 1, j + 1), vertex(s, i, j + 1)]
                    ).smooth = True
    keep = [vertex(s, inner, inner) for s in range(n)]
    bm.verts.index_update()
    corners = [v.index for v in keep]
    mesh = bpy.data.meshes.new("Sectors")
    bm.to_mesh(mesh)
    bm.free()
    ob = bpy.data.objects.new("Sectors", mesh)
    bpy.context.collection.objects.link(ob)
    return ob, corners


def filled(ob, corners, **options):
    """The new faces, as positions of their corners; corners: selected, else the rim is."""
    (bm,) = scenes.edit(ob)
    bm.verts.ensure_lookup_table()
    loop = min(scenes.border_loops(bm), key=len)
    if corners:
        scenes.select(bm, [bm.verts[v] for v in corners])
    else:
        scenes.select_rim(bm, loop)
    count = len(ob.data.polygons)
    assert smooth(**options) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not ob.data.validate(verbose=True)
    return [[np.array(ob.data.vertices[v].co) for v in p.vertices] for p in list(ob.data.polygons)[count:]]


@pytest.mark.parametrize("n", [4, 5, 6])
def test_corners_that_are_selected_give_quads(n):
    ob, corners = add_sectors(n)
    faces = filled(ob, corners, output="quads", method="multi_sided")
    assert {len(f) for f in faces} == {4}
    for p in faces:
        normal = np.cross(p[2] - p[0], p[3] - p[1])
        assert all(np.cross(p[(k + 1) % 4] - p[k], p[k - 1] - p[k]) @ normal > 0 for k in range(4))
    off = [abs(c[2] - 0.2 * (c[0] ** 2 + c[1] ** 2)) for p in faces for c in p]
    assert max(off) < (1e-3 if n == 4 else 0.03)  # sides of other sectors have a bend in their middle


@pytest.mark.parametrize("selected", [True, False])
@pytest.mark.parametrize("n", [4, 5, 8])
def test_under_a_subdivision_modifier_they_give_a_cage(n, selected):
    ob, corners = add_sectors(n)
    modifier = ob.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = 2
    faces = filled(ob, corners if selected else [])
    assert len(faces) == 4 * n and {len(f) for f in faces} == {4}  # the quads that were there
    evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    places = np.array([v.co for v in evaluated.vertices])
    inside = places[np.linalg.norm(places[:, :2], axis=1) < 0.4]
    off = inside[:, 2] - 0.2 * (inside[:, :2] ** 2).sum(axis=1)
    assert len(inside) > 50 and np.abs(off).max() < 0.01  # a cage of edges of 0.2 has its surface 0.005 off


def add_inside(ob, points, edges=()):
    """Vertices without faces, joined by edges."""
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    made = [bm.verts.new(p) for p in points]
    for a, b in edges:
        bm.edges.new((made[a], made[b]))
    bm.to_mesh(ob.data)
    bm.free()


@pytest.mark.parametrize("method", ["auto", "polyharmonic_spline"])
@pytest.mark.parametrize("corners", [False, True])
@pytest.mark.parametrize("output", [{"resolution": 24}, {"output": "quads", "rows": 3}], ids=["triangles", "quads"])
def test_loose_vertices_and_edges_that_are_selected_are_met(output, corners, method):
    ob, at = add_sectors(4)
    points = np.array([(0, 0, 0.12), (0.12, 0.1, 0.06), (0.12, 0, 0.08), (0.12, -0.1, 0.06)])
    add_inside(ob, points, [(1, 2), (2, 3)])
    before = len(ob.data.polygons)
    (bm,) = scenes.edit(ob)
    bm.verts.ensure_lookup_table()
    loose = [v for v in bm.verts if not v.link_faces]
    rim = [bm.verts[v] for v in at] if corners else min(scenes.border_loops(bm), key=len)
    scenes.select(bm, [*rim, *loose])
    assert smooth(**output, method=method) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    new = list(ob.data.polygons)[before:]
    assert new and not ob.data.validate(verbose=True)
    at = np.array([ob.data.vertices[v].co for p in new for v in p.vertices])
    for point in points:
        assert np.linalg.norm(at - point, axis=1).min() < 1e-6
    assert len([v for v in ob.data.vertices if np.abs(points - np.array(v.co)).sum(axis=1).min() < 1e-6]) == len(points)
    adjacent = {v for p in ob.data.polygons for v in p.vertices}
    assert adjacent == set(range(len(ob.data.vertices))), "the loose vertices are those of the fill"
    assert not any(edge.is_loose for edge in ob.data.edges)


def with_guides(*points, edges=()):
    """A hole of four corners with vertices in it, all selected: (object, BMesh, the vertices)."""
    ob, _ = add_sectors(4)
    add_inside(ob, points, edges)
    (bm,) = scenes.edit(ob)
    guides = [v for v in bm.verts if not v.link_faces]
    scenes.select(bm, [*min(scenes.border_loops(bm), key=len), *guides])
    return ob, bm, guides


def test_a_loose_vertex_that_is_taken_up_keeps_what_it_has():
    ob, bm, (guide,) = with_guides((0.02, 0, 0.1))
    deform, number = bm.verts.layers.deform.verify(), bm.verts.layers.float.new("number")
    for name in ("A", "B"):
        ob.vertex_groups.new(name=name)
    bm.verts.ensure_lookup_table()
    (guide,) = [v for v in bm.verts if not v.link_faces]
    for v in bm.verts:
        v[number], v[deform][0] = 1.0, 1.0
    guide[number] = 5.0
    guide[deform].clear()
    guide[deform][1] = 0.25
    place = guide.co.copy()
    assert smooth(resolution=6) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    (taken,) = [v for v in bm.verts if (v.co - place).length < 1e-6]
    assert taken.link_faces and taken.co == place and taken.select
    assert taken[bm.verts.layers.float["number"]] == 5.0 and taken[bm.verts.layers.deform.active].items() == [(1, 0.25)]
    others = [v for v in bm.verts if v is not taken]
    assert all(abs(v[bm.verts.layers.float["number"]] - 1) < 1e-6 for v in others)


def test_undoing_brings_back_the_loose_vertices_and_edges():
    ob, _, _ = with_guides((0.12, 0.1, 0.06), (0.12, 0, 0.08), (0.12, -0.1, 0.06), edges=[(0, 1), (1, 2)])
    scenes.undone_and_redone(ob.name, lambda: bpy.ops.mesh.fill_smooth("EXEC_DEFAULT", True, resolution=6))


def test_a_loose_vertex_without_weights_takes_those_of_the_fill():
    ob, bm, (guide,) = with_guides((0.02, 0, 0.1))
    deform = bm.verts.layers.deform.verify()
    ob.vertex_groups.new(name="A")
    for v in bm.verts:
        if v.link_faces:
            v[deform][0] = 0.5
    (place,) = [v.co.copy() for v in bm.verts if not v.link_faces]
    assert smooth(resolution=6) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(ob.data)
    (taken,) = [v for v in bm.verts if (v.co - place).length < 1e-6]
    assert taken[bm.verts.layers.deform.active][0] == pytest.approx(0.5)


def test_the_shapes_of_a_hole_go_through_its_loose_vertices_too():
    """What is moved with all of the mesh is moved with it in its own fill."""
    ob, _ = add_sectors(4)
    place = np.array([0.02, 0, 0.1])
    add_inside(ob, [place])
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Up")
    for each in key.data:
        each.co.z += 0.5
    (bm,) = scenes.edit(ob)
    ob.active_shape_key_index = 0
    bm = bmesh.from_edit_mesh(ob.data)
    scenes.select(bm, [*min(scenes.border_loops(bm), key=len), *[v for v in bm.verts if not v.link_faces]])
    assert smooth(resolution=6) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    basis, up = (np.array([v.co for v in block.data]) for block in ob.data.shape_keys.key_blocks)
    assert np.linalg.norm(basis - place, axis=1).min() < 1e-6
    assert np.abs(up - basis - [0, 0, 0.5]).max() < 1e-4


def test_a_loose_vertex_far_away_does_nothing():
    ob, _ = add_sectors(5)
    add_inside(ob, [(9, 9, 9)])
    before = len(ob.data.polygons)
    (bm,) = scenes.edit(ob)
    scenes.select(bm, [*min(scenes.border_loops(bm), key=len), *[v for v in bm.verts if not v.link_faces]])
    assert smooth() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    heights = [ob.data.vertices[v].co.z for p in list(ob.data.polygons)[before:] for v in p.vertices]
    assert max(heights) < 0.2
