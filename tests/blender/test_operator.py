"""mesh.fill_three_sided on every kind of selection: what is filled, what is reported, what is left alone."""

import sys

import bmesh
import bpy
import numpy as np
import pytest
import scenes
import tripatch

fill = bpy.ops.mesh.fill_three_sided


def rims(ob):
    """Lengths of the border loops of the mesh, in object mode."""
    bpy.ops.object.mode_set(mode="OBJECT")
    bm = scenes.checked(ob)
    assert all(e.is_manifold or e.is_boundary for e in bm.edges)
    assert all(e.is_contiguous for e in bm.edges if e.is_manifold), "new faces are turned against their neighbors"
    lengths = [len(loop) for loop in scenes.border_loops(bm)]
    bm.free()
    return lengths


def test_nothing_selected_fills_the_only_three_sided_hole():
    ob = scenes.add_hole()
    scenes.edit(ob)
    assert fill() == {"FINISHED"}
    assert rims(ob) == [36]


def test_with_nothing_selected_the_outer_border_is_no_hole():
    """Its three edges would do for a rim."""
    angle = np.arange(3) * 2 * np.pi / 3
    inner = np.column_stack([np.cos(angle), np.sin(angle), 0.1 + 0 * angle])
    ring = [(k, (k + 1) % 3) for k in range(3)]
    ob = scenes.add_mesh(np.vstack([inner, 3 * inner]), [[3 + a, 3 + b, b, a] for a, b in ring])
    scenes.edit(ob)
    assert fill() == {"FINISHED"}
    assert rims(ob) == [3] and all(max(p.vertices) > 5 or set(p.vertices) == {0, 1, 2} for p in list(ob.data.polygons)[3:])


def test_where_the_only_hole_cannot_be_filled_the_outer_border_is_not_mentioned():
    scenes.edit(scenes.add_mesh(*scenes.square_hole()))
    with pytest.raises(RuntimeError, match="^Error: This method needs 3 corners"):
        fill(method="side_vertex")


@pytest.mark.parametrize("mode", ["VERT", "EDGE"])
def test_selected_rim(mode):
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode=mode)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    assert fill() == {"FINISHED"}
    assert rims(ob) == [36]


def test_one_selected_vertex_means_its_rim():
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob)
    scenes.select(bm, scenes.border_loops(bm)[0][:1])
    assert fill() == {"FINISHED"}
    assert rims(ob) == [36]


def test_three_selected_vertices_are_the_corners_of_a_round_rim():
    ob = scenes.add_mesh(*scenes.ring())
    (bm,) = scenes.edit(ob)
    scenes.select(bm, list(bm.verts)[:24:8])
    assert fill() == {"FINISHED"}
    assert rims(ob) == [24]


def test_selected_faces_around_a_hole():
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode="FACE")
    scenes.select(bm, faces={f for v in scenes.border_loops(bm)[0] for f in v.link_faces})
    assert fill() == {"FINISHED"}
    assert rims(ob) == [36]


def test_a_selected_region_is_replaced():
    points, outside, inside = scenes.lattice_parts()
    ob = scenes.add_mesh(scenes.bowl(points), outside + inside)
    filled = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode="FACE")
    scenes.select(bm, faces=list(bm.faces)[len(outside) :])
    assert fill() == {"FINISHED"}
    assert rims(ob) == [36]
    # the surroundings are those of the region still in place, which is the same bowl
    z = np.array([v.co.z - 0.6 * (v.co.x**2 + v.co.y**2) for v in ob.data.vertices])
    assert np.abs(z).max() < 2e-3
    assert len(ob.data.polygons) == len(outside) + sum(p.select for p in ob.data.polygons)
    scenes.edit(filled)
    assert fill() == {"FINISHED"}


def test_two_regions_each_by_itself():
    points, outside, inside = scenes.lattice_parts(size=18, holes=((2, 2, 4), (9, 3, 4)))
    ob = scenes.add_mesh(scenes.bowl(points), outside + inside)
    (bm,) = scenes.edit(ob, mode="FACE")
    scenes.select(bm, faces=list(bm.faces)[len(outside) :])
    assert fill(resolution=1) == {"FINISHED"}
    assert rims(ob) == [54]
    bm = scenes.checked(ob)
    assert sum(v.co.z > 1 for v in bm.verts) == 0


def test_new_faces_are_selected_and_nothing_else():
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode="EDGE")
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    old = len(bm.faces)
    fill()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [p.select for p in ob.data.polygons] == [k >= old for k in range(len(ob.data.polygons))]
    held = {v for p in ob.data.polygons if p.select for v in p.vertices}
    assert {v.index for v in ob.data.vertices if v.select} == held


def test_the_rim_keeps_its_vertices_bit_for_bit():
    ob = scenes.add_hole()
    before = np.array([v.co for v in ob.data.vertices], np.float32)
    scenes.edit(ob)
    fill()
    bpy.ops.object.mode_set(mode="OBJECT")
    after = np.array([v.co for v in ob.data.vertices], np.float32)
    assert after[: len(before)].tobytes() == before.tobytes()


def test_two_holes_in_one_call():
    points, faces = scenes.lattice(size=18, holes=((2, 2, 4), (9, 3, 4)))
    ob = scenes.add_mesh(scenes.bowl(points), faces)
    (bm,) = scenes.edit(ob, mode="EDGE")
    for loop in scenes.border_loops(bm)[:2]:
        scenes.select_rim(bm, loop)
    assert fill() == {"FINISHED"}
    assert len(rims(ob)) == 1


def test_holes_of_a_mesh_are_handed_to_the_library_together(addon, monkeypatch):
    """It shares them out to threads and walks around all of them at once; a refusal of one is its own."""
    filling = sys.modules[addon.__name__ + ".filling"]
    asked, fill_all = [], filling.tripatch.fill_all
    monkeypatch.setattr(filling.tripatch, "fill_all", lambda *a, **k: asked.append(len(a[2])) or fill_all(*a, **k))
    monkeypatch.delattr(filling.tripatch, "fill")
    for output in ("triangles", "quads", "cage"):
        asked.clear()
        points, faces = scenes.lattice(size=18, holes=((2, 2, 4), (9, 3, 4)))
        ob = scenes.add_mesh(scenes.bowl(points), faces)
        (bm,) = scenes.edit(ob, mode="EDGE")
        for loop in scenes.border_loops(bm):
            scenes.select_rim(bm, loop)
        assert fill(output=output) == {"FINISHED"}
        assert asked == [3]
        assert len(rims(ob)) <= 1


@pytest.mark.parametrize("make", ["lattice", "ball_with_hole", "ring"])
def test_with_nothing_selected_it_is_the_hole_that_the_library_takes(make):
    points, faces = getattr(scenes, make)()
    vertices = scenes.bowl(points) if make == "lattice" else points
    ob = scenes.add_mesh(vertices, faces)
    scenes.edit(ob)
    try:
        expected = set(tripatch.fill(vertices, faces).rim.tolist())
    except tripatch.Refusal:
        with pytest.raises(RuntimeError):
            fill()
        return
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    new = {v for p in list(ob.data.polygons)[len(faces) :] for v in p.vertices}
    assert {v for v in new if v < len(points)} == expected


def test_two_objects_in_one_call_and_one_of_them_without_selection():
    obs = [scenes.add_hole() for _ in range(3)]
    for k, ob in enumerate(obs):
        ob.location.x = 3 * k
    bms = scenes.edit(*obs, mode="EDGE")
    for bm in bms[:2]:
        scenes.select_rim(bm, scenes.border_loops(bm)[0])
    assert fill() == {"FINISHED"}
    assert [rims(ob) for ob in obs] == [[36], [36], [12, 36]]


def test_one_filled_and_one_refused():
    obs = [scenes.add_hole(), scenes.add_mesh(*scenes.square_hole())]
    bms = scenes.edit(*obs, mode="EDGE")
    for bm in bms:
        scenes.select_rim(bm, scenes.border_loops(bm)[0])
    assert fill(method="side_vertex") == {"FINISHED"}
    assert rims(obs[0]) == [36]
    assert len(rims(obs[1])) == 2


def filled(pick, **options):
    """Positions after a fill; pick selects, given the BMesh and the rim from its lowest corner on."""
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob)
    loop = scenes.border_loops(bm)[0]
    first = loop.index(min(loop, key=lambda v: (round(v.co.y, 5), v.co.x)))
    pick(bm, loop[first:] + loop[:first])
    assert fill(method="side_vertex", **options) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    return np.array([v.co for v in ob.data.vertices])


def same(a, b):
    """The same points, in any order."""
    return len(a) == len(b) and max(np.linalg.norm(b - p, axis=1).min() for p in a) < 1e-6


def test_corner_offset_slides_the_corners_along_the_rim():
    plain = filled(scenes.select_rim)
    assert same(filled(scenes.select_rim, corner_offset=4), plain)  # each side has four edges
    moved = filled(scenes.select_rim, corner_offset=1)
    given = [filled(lambda bm, rim, k=k: scenes.select(bm, [rim[k], rim[k + 4], rim[(k + 8) % 12]])) for k in (1, 3)]
    assert any(same(moved, points) for points in given)
    assert not any(same(plain, points) for points in given)


def test_active_vertex_is_a_corner():
    def active(bm, rim):
        scenes.select_rim(bm, rim)
        bm.select_history.add(rim[1])

    result = filled(active)
    given = filled(lambda bm, rim: scenes.select(bm, [rim[1], rim[4], rim[8]]))
    assert same(result, given)


def test_corner_offset_is_not_remembered():
    properties = fill.get_rna_type().properties
    assert properties["corner_offset"].is_skip_save
    assert not properties["shading"].is_skip_save


def test_resolution_and_bulge_do_what_they_say():
    counts, middles = [], []
    for options in ({"resolution": 2}, {"resolution": 6}, {"bulge": 0.5}, {"bulge": 2.0}):
        ob = scenes.add_hole()
        scenes.edit(ob)
        fill(**options)
        bpy.ops.object.mode_set(mode="OBJECT")
        counts.append(len(ob.data.vertices))
        middles.append(min(v.co.z for v in ob.data.vertices))
    assert counts[0] < counts[1]
    assert middles[2] != middles[3]


def world_points(ob):
    return np.array([ob.matrix_world @ v.co for v in ob.data.vertices])


def test_geometry_is_that_of_the_world(addon):
    """A stretched, sheared and mirrored object is filled as its applied mesh is."""
    matrix = np.array([[-3, 0.5, 0, 5], [0, 0.2, 0.1, -7], [0, 0, 1.5, 2], [0, 0, 0, 1]])
    points, faces = scenes.lattice()
    bent = scenes.bowl(points)
    inverse = np.linalg.inv(matrix)
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    ob = scenes.add_mesh((np.column_stack([bent, np.ones(len(bent))]) @ inverse.T)[:, :3], faces)
    ob.parent = parent
    ob.matrix_parent_inverse = matrix.T.tolist()
    bpy.context.view_layer.update()
    np.testing.assert_allclose(world_points(ob), bent, atol=1e-5)
    plain = scenes.add_mesh(bent, faces)
    for each in (ob, plain):
        scenes.edit(each)
        assert fill(method="side_vertex") == {"FINISHED"}
        assert rims(each) == [36]
    np.testing.assert_allclose(world_points(ob), world_points(plain), atol=2e-5)


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e6])
def test_any_scale(scale):
    points, faces = scenes.lattice()
    ob = scenes.add_mesh(scenes.bowl(points) * scale, faces)
    plain = scenes.add_mesh(scenes.bowl(points), faces)
    for each in (ob, plain):
        scenes.edit(each)
        assert fill() == {"FINISHED"}
        bpy.ops.object.mode_set(mode="OBJECT")
    a, b = (np.array([v.co for v in each.data.vertices]) for each in (ob, plain))
    np.testing.assert_allclose(a / scale, b, atol=1e-6)


def test_undo_brings_back_every_bit_and_redo_the_fill():
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode="EDGE")
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    scenes.undone_and_redone(ob.name, lambda: fill("EXEC_DEFAULT", True))


def test_hidden_faces_are_surroundings_and_hidden_rims_are_left():
    results = []
    for hide in (False, True):
        ob = scenes.add_hole()
        (bm,) = scenes.edit(ob, mode="VERT")
        rim = set(scenes.border_loops(bm)[0])
        if hide:
            far = [v for v in bm.verts if not any(w in rim for e in v.link_edges for w in e.verts)]
            scenes.select(bm, far)
            bpy.ops.mesh.hide()
            assert sum(f.hide for f in bm.faces) > 20
        assert fill() == {"FINISHED"}
        bpy.ops.object.mode_set(mode="OBJECT")
        results.append(np.array([v.co for v in ob.data.vertices]))
    np.testing.assert_array_equal(*results)

    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode="VERT")
    scenes.select(bm, scenes.border_loops(bm)[0])
    bpy.ops.mesh.hide()
    bpy.ops.mesh.select_all(action="SELECT")
    with pytest.raises(RuntimeError, match="Reveal Hidden shows the others"):  # what Python makes of an error report
        fill()
    assert rims(ob) == [12, 36]


@pytest.mark.parametrize("output", ["triangles", "quads"])
def test_any_rim_is_filled_by_default(output):
    ob = scenes.add_mesh(*scenes.square_hole())
    scenes.edit(ob)
    before = len(ob.data.polygons)
    assert fill(output=output) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(ob.data.polygons) > before
    assert len(scenes.border_loops(scenes.checked(ob))) == 1  # the outer border is left


def test_with_nothing_selected_every_hole_is_filled():
    points, faces = scenes.lattice(size=18, holes=((2, 2, 4), (9, 3, 4)))
    ob = scenes.add_mesh(scenes.bowl(points), faces)
    scenes.edit(ob)
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(scenes.border_loops(scenes.checked(ob))) == 1


def test_deviation_and_new_faces_become_attributes_where_asked():
    """A square hole in a bowl that is scaled: in scene units, larger in the middle, and only at new vertices."""
    points, faces = scenes.square_hole()
    wavy = [(x, y, 0.1 * np.sin(2 * x) * np.cos(3 * y)) for x, y, *_ in points]
    ob = scenes.add_mesh(wavy, faces)
    scenes.edit(ob)
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not {"deviation", "reconstructed"} & {layer.name for layer in ob.data.attributes}

    largest = []
    for scale in (1, 3):
        ob = scenes.add_mesh(wavy, faces)
        ob.scale = (scale,) * 3
        bpy.context.view_layer.update()
        scenes.edit(ob)
        assert fill(deviation=True) == {"FINISHED"}
        bpy.ops.object.mode_set(mode="OBJECT")
        marked = np.array([bool(x.value) for x in ob.data.attributes["reconstructed"].data])
        assert marked.tolist() == [k >= len(faces) for k in range(len(ob.data.polygons))]
        known = np.array([x.value for x in ob.data.attributes["deviation"].data])
        assert (known[: len(points)] == 0).all()
        assert (known[len(points) :] > 0).all()
        largest.append(known.max())
    assert largest[1] == pytest.approx(3 * largest[0], rel=1e-3)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_isolated_selected_vertices_of_a_rim_are_its_corners(count, addon, monkeypatch):
    library = sys.modules[addon.__name__ + ".library"].tripatch
    asked, made = [], library.fill_all
    monkeypatch.setattr(library, "fill_all", lambda *a, **kw: asked.append(kw["corners"]) or made(*a, **kw))
    ob = scenes.add_mesh(*scenes.square_hole())
    (bm,) = scenes.edit(ob)
    rim = min(scenes.border_loops(bm), key=len)
    corners = rim[:: len(rim) // count][:count]
    scenes.select(bm, corners)
    assert fill() == {"FINISHED"}
    assert [sorted(c) for c in asked[0]] == [sorted(v.index for v in corners)]


def test_an_active_vertex_does_not_hinder_a_rim_without_three_corners():
    ob = scenes.add_mesh(*scenes.square_hole())
    (bm,) = scenes.edit(ob)
    rim = min(scenes.border_loops(bm), key=len)
    scenes.select_rim(bm, rim)
    bm.select_history.add(rim[2])
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(scenes.border_loops(scenes.checked(ob))) == 1


@pytest.mark.parametrize("mode", [("VERT",), ("EDGE",), ("FACE",), ("VERT", "FACE"), ("EDGE", "FACE")])
def test_the_new_selection_is_as_blender_would_flush_it(addon, mode):
    """Between two strips of new faces lies an old one that has no other vertices: selected with them by vertices, and by edges
    where it has no other edges."""
    selection = sys.modules[f"{addon.__name__}.selection"]
    found = []
    for flush in (False, True):
        points = np.array([(i, j, 0) for j in range(4) for i in range(6)], float)
        faces = [[6 * j + i, 6 * j + i + 1, 6 * j + i + 7, 6 * j + i + 6] for j in range(3) for i in range(5)]
        ob = scenes.add_mesh(points, faces)
        (bm,) = scenes.edit(ob)
        bm.faces.ensure_lookup_table()
        bm.faces[2].hide = True
        for k in (10, 11):
            bm.faces[k].select = True
        bm.select_mode = set(mode)
        bm.select_flush_mode()
        new = [bm.faces[k] for k in (0, 1, 3, 5, 7, 8)]
        if flush:
            for element in (*bm.faces, *bm.edges, *bm.verts):
                element.select = False
            for face in new:
                face.select = True
            bm.select_flush_mode()
        else:
            selection.Selected(bm).replace(bm, new)
            selection.finish_edit(bm, ob.data)
        selected = [[e.index for e in all_of if e.select] for all_of in (bm.verts, bm.edges, bm.faces)]
        found.append((selected, ob.data.total_vert_sel))
        bpy.ops.object.mode_set(mode="OBJECT")
    assert found[0] == found[1]


def filled_and_undone(**options):
    """Positions after a fill, as bytes, and its vertices; the mesh is as it was again."""
    assert bpy.ops.mesh.fill_smooth("EXEC_DEFAULT", True, **options) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(bpy.context.object.data)
    positions = np.array([v.co for v in bm.verts], np.float32).tobytes()
    vertices = {v.index for v in bm.verts if v.select}
    bpy.ops.ed.undo()
    return positions, vertices


def test_the_selection_of_the_last_time_is_not_taken_for_another():
    """What is selected is remembered from run to run: another rim of as many vertices in the same mesh is another."""
    scenes.edit(scenes.add_hole(size=16, holes=((2, 2, 3), (7, 2, 3))))
    for which in (0, 1, 0):
        bm = bmesh.from_edit_mesh(bpy.context.object.data)
        bpy.ops.mesh.select_all(action="DESELECT")
        loop = [loop for loop in scenes.border_loops(bm) if len(loop) == 9][which]
        scenes.select_rim(bm, loop)
        rim = {v.index for v in loop}
        bpy.ops.ed.undo_push(message="selected")
        for _ in range(2):
            assert rim <= filled_and_undone()[1]


def test_a_slider_gives_what_a_first_run_gives():
    """Undone and run again with another value, with what is kept from step to step, the mesh is that of a first run."""
    plain = {"output": "triangles", "bulge": 1.0, "center_offset": 0.0, "resolution": 0, "rows": -1, "tension": 0.0}
    steps = [{}, {"bulge": 1.25}, {"center_offset": 0.02}, {}, {"resolution": 6}, {"tension": 0.5}]
    steps += [{"output": "quads"} | step for step in ({}, {"bulge": 1.25}, {"rows": 2}, {})]
    steps = [plain | step for step in steps]

    def start():
        if bpy.context.mode == "EDIT_MESH":
            bpy.ops.object.mode_set(mode="OBJECT")
        (bm,) = scenes.edit(scenes.add_mesh(*scenes.square_hole()))
        scenes.select_rim(bm, scenes.border_loops(bm)[0])
        bpy.ops.ed.undo_push(message="before")

    first = []
    for step in steps:
        start()
        first.append(filled_and_undone(**step)[0])
    start()
    assert [filled_and_undone(**step)[0] for step in steps] == first
    assert len({(step["output"], made) for step, made in zip(steps, first)}) == 8
