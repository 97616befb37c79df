"""What cannot be filled is refused in a sentence that names the place, and the mesh is left as it was, to the bit."""

import contextlib

import bmesh
import bpy
import numpy as np
import pytest
import scenes

fill = bpy.ops.mesh.fill_three_sided


def bits(ob):
    """Positions, faces and selection in edit mode."""
    bm = bmesh.from_edit_mesh(ob.data)
    points = np.array([v.co for v in bm.verts], np.float32).tobytes()
    return points, [[v.index for v in f.verts] for f in bm.faces], [e.select for e in bm.edges], [v.select for v in bm.verts]


@pytest.fixture
def refusal(capfd):
    """refusal(ob, ...) runs the operator, which must leave the mesh alone; returns its sentence."""

    def run(ob, method="side_vertex", **options):  # of three sides: any other rim is refused
        before = bits(ob)
        capfd.readouterr()
        try:
            assert fill(method=method, **options) == {"CANCELLED"}
            sentence = capfd.readouterr().out
        except RuntimeError as error:  # what Python makes of an error report
            sentence = str(error)
            assert "Traceback" not in sentence
        assert bits(ob) == before
        return sentence

    return run


def rim_of(ob, mode="EDGE"):
    """The shortest border loop, selected; the object is in edit mode."""
    (bm,) = scenes.edit(ob, mode=mode)
    loop = scenes.border_loops(bm)[0]
    scenes.select_rim(bm, loop)
    return bm, loop


def test_a_mesh_without_a_hole(refusal):
    bpy.ops.mesh.primitive_cube_add()
    ob = bpy.context.object
    scenes.edit(ob)
    assert "Nothing to fill: the mesh has no border" in refusal(ob)


def test_nothing_selected_and_a_method_of_three_sides():
    """As with --all of the command line."""
    points, faces = scenes.lattice(size=18, holes=((2, 2, 4), (9, 3, 4)))
    ob = scenes.add_mesh(scenes.bowl(points), faces)
    scenes.edit(ob)
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [len(loop) for loop in scenes.border_loops(scenes.checked(ob))] == [54]


def octahedron(*missing):
    """Without some of its faces; the object is in edit mode with nothing selected."""
    points = np.vstack([np.eye(3), -np.eye(3)])
    faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    ob = scenes.add_mesh(points, [face for k, face in enumerate(faces) if k not in missing])
    scenes.edit(ob, mode="EDGE")
    return ob


def test_an_octahedron_without_a_face():
    ob = octahedron(0)
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert sorted(ob.data.polygons[-1].vertices) == [0, 1, 2]
    assert len(ob.data.polygons) == 8
    assert not scenes.border_loops(scenes.checked(ob))


def test_holes_that_touch_at_a_vertex(refusal):
    ob = octahedron(0, 2)
    bm = bmesh.from_edit_mesh(ob.data)
    scenes.select(bm, edges=[e for e in bm.edges if e.is_boundary])
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not scenes.border_loops(scenes.checked(ob))


def test_the_border_of_a_single_face(refusal):
    ob = scenes.add_mesh(np.eye(3), [[0, 1, 2]])
    scenes.edit(ob)
    assert "outline of a loose face" in refusal(ob)


def test_hidden_rims_are_named(refusal):
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob)
    scenes.select(bm, scenes.border_loops(bm)[0])
    bpy.ops.mesh.hide()
    assert "Reveal Hidden shows the others" in refusal(ob)
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.hide()
    assert "Every boundary is hidden" in refusal(ob)


@pytest.mark.parametrize("name", ["fill_smooth", "smooth_triangles", "shape_fill"])
def test_an_object_that_was_hidden_in_edit_mode(name):
    ob = octahedron(0)
    ob.hide_set(True)
    operator = getattr(bpy.ops.mesh, name)
    assert not operator.poll()
    with pytest.raises(RuntimeError, match="The mesh in edit mode is hidden"):
        operator()
    ob.hide_set(False)
    assert operator.poll()


def test_a_mesh_that_is_linked_has_no_edit_mode(tmp_path, addon):
    scenes.add_hole()
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    with bpy.data.libraries.load(path, link=True) as (_, linked):
        linked.meshes = ["Hole"]
    ob = bpy.data.objects.new("Linked", linked.meshes[0])
    bpy.context.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    with contextlib.suppress(RuntimeError):  # Blender's own sentence
        bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.context.mode == "OBJECT"
    with pytest.raises(RuntimeError, match="poll"):
        fill()


def test_a_selected_edge_inside_the_mesh(refusal):
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode="EDGE")
    edge = next(e for e in bm.edges if not e.is_boundary)
    scenes.select(bm, edges=[edge])
    sentence = refusal(ob)
    assert "a face on both sides" in sentence
    assert all(str(v.index) in sentence for v in edge.verts)


@pytest.mark.parametrize("count", [2, 4, 5])
def test_rims_with_other_than_three_corners(refusal, count):
    """A disc with a polygon cut out; two corners: a lens."""
    if count == 2:
        turn = np.linspace(0, np.pi / 2, 9)[:-1]
        arc = np.column_stack([np.cos(turn + np.pi / 4), np.sin(turn + np.pi / 4) - np.sqrt(0.5)])
        inner = np.vstack([arc, -arc])
    else:
        corner = np.arange(count) * 2 * np.pi / count
        corners = np.column_stack([np.cos(corner), np.sin(corner)])
        inner = np.vstack(
            [a + (b - a) * np.arange(4)[:, None] / 4 for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)]
        )
    n = len(inner)
    rings = [np.column_stack([inner * s, np.full(n, 0.1 * s)]) for s in (1, 1.3, 1.7)]
    faces = [[r * n + k, (r + 1) * n + k, (r + 1) * n + (k + 1) % n, r * n + (k + 1) % n] for r in range(2) for k in range(n)]
    ob = scenes.add_mesh(np.vstack(rings), faces)
    (bm,) = scenes.edit(ob, mode="EDGE")
    bm.verts.ensure_lookup_table()
    scenes.select_rim(bm, [bm.verts[k] for k in range(n)])
    sentence = refusal(ob)
    assert f"needs 3 corners, but the hole has {count}" in sentence


def test_a_patch_that_would_fold_is_refused_and_auto_fills_the_hole(refusal):
    """Every second vertex of a round rim pulled inwards, and three of the others for its corners."""
    points, faces = scenes.ring(24)
    points = np.array(points, float)
    points[1:24:2] *= (0.45, 0.45, 1)
    ob = scenes.add_mesh(points, faces)
    (bm,) = scenes.edit(ob)
    bm.verts.ensure_lookup_table()
    scenes.select(bm, [bm.verts[k] for k in (0, 8, 16)])
    sentence = refusal(ob)
    assert "A fill by Side Vertex would fold over itself" in sentence and "Method: Automatic" in sentence
    assert fill() == {"FINISHED"}


def test_two_loops_that_touch_are_told_apart_by_the_faces_between():
    holes = (3, 3, 4), (7, 3, 4)
    points, faces = scenes.lattice(size=18, holes=holes)
    at_holes = scenes.lattice_parts(size=18, holes=holes)
    at_holes = {tuple(at_holes[0][v].round(5)) for f in at_holes[2] for v in f}
    ob = scenes.add_mesh(scenes.bowl(points), faces)
    (bm,) = scenes.edit(ob, mode="EDGE")
    assert [sum(e.is_boundary for e in v.link_edges) for v in bm.verts].count(4) == 1
    bm.verts.ensure_lookup_table()
    on_rim = [tuple(p.round(5)) in at_holes for p in points]
    scenes.select(bm, edges=[e for e in bm.edges if e.is_boundary and all(on_rim[v.index] for v in e.verts)])
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [len(loop) for loop in scenes.border_loops(scenes.checked(ob))] == [54]


def test_a_wire_across_the_rim(refusal):
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode="EDGE")
    loop = scenes.border_loops(bm)[0]
    wire = bm.edges.new((loop[0], loop[5]))
    scenes.select(bm, edges=[wire])
    sentence = refusal(ob)
    assert "has no face, so nothing can be continued there" in sentence
    assert str(loop[0].index) in sentence


def test_a_fin_on_the_rim(refusal):
    ob = scenes.add_hole()
    bm, loop = rim_of(ob)
    tip = bm.verts.new((0, 0, 1))
    bm.faces.new([loop[0], loop[1], tip])
    bm.faces.new([loop[1], loop[0], bm.verts.new((0, 0, -1))])
    bm.verts.index_update()
    sentence = refusal(ob)
    assert "3 faces" in sentence
    assert str(loop[0].index) in sentence


def test_a_fin_on_a_rim_that_is_not_selected(refusal):
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob)
    a, b = (v.index for v in scenes.border_loops(bm)[0][:2])
    bm.verts.ensure_lookup_table()
    for face, height in (((a, b), 1), ((b, a), -1)):
        tip = bm.verts.new((0, 0, height))
        bm.verts.ensure_lookup_table()
        bm.faces.new([*(bm.verts[v] for v in face), tip])
    bm.verts.index_update()
    sentence = refusal(ob)
    assert "Non-manifold: the edge between vertices" in sentence
    assert f" {a} " in sentence and f" {b} " in sentence


def test_vertices_at_the_same_place(refusal):
    ob = scenes.add_hole()
    bm, loop = rim_of(ob)
    loop[5].co = loop[6].co
    sentence = refusal(ob)
    assert "no length" in sentence or "same place" in sentence
    assert str(loop[5].index) in sentence


def test_nan_at_the_rim_and_far_away(refusal):
    ob = scenes.add_hole()
    bm, loop = rim_of(ob)
    loop[2].co.x = float("nan")
    sentence = refusal(ob)
    assert "finite" in sentence
    assert str(loop[2].index) in sentence
    bpy.ops.object.mode_set(mode="OBJECT")

    points, faces = scenes.lattice(size=36, holes=((16, 2, 4),))
    vertices = scenes.bowl(points)
    vertices[np.argmax(points[:, 1])] = np.nan
    ob = scenes.add_mesh(vertices, faces)
    bm, loop = rim_of(ob)
    assert fill() == {"FINISHED"}


def test_flipped_neighbors(refusal):
    ob = scenes.add_hole()
    bm, loop = rim_of(ob)
    face = next(e for e in loop[1].link_edges if e.is_boundary).link_faces[0]
    face.normal_flip()
    assert "face the other way" in refusal(ob)


def test_a_face_in_the_hole_already(refusal):
    """A rim of three edges whose hole is closed by a face on the other side of the sheet is none."""
    points, outside, inside = scenes.lattice_parts(holes=((4, 4, 1),))
    ob = scenes.add_mesh(scenes.bowl(points), outside)
    (bm,) = scenes.edit(ob, mode="EDGE")
    bm.verts.ensure_lookup_table()
    bm.faces.new([bm.verts[k] for k in inside[0]])
    scenes.select(bm, edges=[bm.edges.get((bm.verts[a], bm.verts[b])) for a, b in ((inside[0][0], inside[0][1]),)])
    assert "a face on both sides" in refusal(ob)


def test_selected_faces_at_the_border_of_the_mesh(refusal):
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode="FACE")
    bm.faces.ensure_lookup_table()
    scenes.select(bm, faces=[next(f for f in bm.faces if any(e.is_boundary for e in f.edges))])
    assert "border of the mesh" in refusal(ob)


def test_a_selected_closed_surface_and_a_region_with_two_borders(refusal):
    bpy.ops.mesh.primitive_cube_add()
    ob = bpy.context.object
    scenes.edit(ob, mode="FACE")
    bpy.ops.mesh.select_all(action="SELECT")
    assert "Nothing to fill: the mesh has no border" in refusal(ob)
    bm = bmesh.from_edit_mesh(ob.data)
    for f in bm.faces:
        f.select = abs(f.normal.z) < 0.5
    assert "Side Vertex does not take Islands" in refusal(ob)  # a ring with all vertices of the mesh is not the mesh
    assert "loose face" in refusal(ob, method="auto")  # that is left on each side


def test_a_flattened_object(refusal):
    ob = scenes.add_hole()
    ob.scale.z = 0
    bpy.context.view_layer.update()
    rim_of(ob)
    sentence = refusal(ob)
    assert ob.name in sentence
    assert "scale" in sentence


def test_as_little_as_a_hole_can_have():
    """Three triangles round a triangle."""
    points = np.array([(0, 0, 0), (1, 0, 0), (0.5, 0.9, 0), (0.5, -0.9, 0.3), (1.4, 0.9, 0.3), (-0.4, 0.9, 0.3)])
    ob = scenes.add_mesh(points, [(1, 0, 3), (2, 1, 4), (0, 2, 5)])
    (bm,) = scenes.edit(ob, mode="EDGE")
    bm.verts.ensure_lookup_table()
    scenes.select_rim(bm, [bm.verts[k] for k in range(3)])
    assert fill(resolution=4) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert np.isfinite([v.co for v in ob.data.vertices]).all()
    assert len(scenes.border_loops(scenes.checked(ob))) == 1


def test_a_flat_plane_is_filled_flat():
    ob = scenes.add_hole(shape=scenes.flat)
    rim_of(ob)
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert max(abs(v.co.z) for v in ob.data.vertices) < 1e-6


def test_a_rim_of_three_edges():
    ob = scenes.add_hole(holes=((4, 4, 1),))
    rim_of(ob)
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [len(loop) for loop in scenes.border_loops(scenes.checked(ob))] == [36]


def test_a_rim_of_thousands_of_edges():
    points, faces = scenes.lattice(size=6, holes=((1, 1, 3),))
    ob = scenes.add_mesh(scenes.bowl(points), faces)
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    loop = scenes.border_loops(bm)[0]
    rim = [bm.edges.get(pair) for pair in zip(loop, loop[1:] + loop[:1], strict=True)]
    assert len(rim) == 9
    bmesh.ops.subdivide_edges(bm, edges=rim, cuts=333)
    bm.to_mesh(ob.data)
    bm.free()
    (bm,) = scenes.edit(ob)
    loop = max(scenes.border_loops(bm), key=len)
    scenes.select_rim(bm, loop)
    assert len(loop) == 9 * 334
    assert fill(resolution=8) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [len(loop) for loop in scenes.border_loops(scenes.checked(ob))] == [18]
