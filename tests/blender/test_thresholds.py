"""What decides in the add-on, on both sides of each threshold."""

import importlib
import math
from types import SimpleNamespace

import bmesh
import bpy
import numpy as np
import pytest
import scenes
from mathutils import Matrix, Vector
from mathutils.kdtree import KDTree


@pytest.fixture
def part(addon):
    """A module of the add-on by its name."""
    return lambda name: importlib.import_module(f"{addon.__name__}.{name}")


def test_an_object_is_scaled_to_nothing_by_ten_million(part):
    for scale, good in ((1 / 0.97e7, True), (1 / 1.03e7, False)):
        matrix = np.diag([1, 1, scale, 1])
        if good:
            part("filling").world_matrix("A", matrix)
        else:
            with pytest.raises(part("selection").UnusableError, match="a scale of zero"):
                part("filling").world_matrix("A", matrix)


def test_a_triangle_has_an_area_from_a_million_millionth_of_its_longest_edge_squared_on(part):
    faces = [SimpleNamespace(index=7)]
    for area, good in ((0.97e-12, False), (1.03e-12, True)):
        points = np.array([(0, 0, 0), (1, 0, 0), (0.5, area, 0)])
        if good:
            part("smooth")._check_positions(faces, np.array([(0, 1, 2)]), points)
        else:
            with pytest.raises(part("selection").UnusableError, match="Face 7 has no area"):
                part("smooth")._check_positions(faces, np.array([(0, 1, 2)]), points)


def test_mirror_planes_are_perpendicular_to_a_ten_thousandth(part):
    for cosine, both in ((0.97e-4, True), (1.03e-4, False)):
        planes = [SimpleNamespace(normal=Vector((1, 0, 0))), SimpleNamespace(normal=Vector((cosine, 1, 0)))]
        assert (part("mirrored")._planes_between(planes, {0}, {1}) == planes) == both


def tree_of(points):
    tree = KDTree(len(points))
    for k, point in enumerate(points):
        tree.insert(point, k)
    tree.balance()
    return tree


def test_a_drawn_point_is_the_computed_one_to_two_millionths_of_the_extent(part):
    drawn = np.array([(0.0, 0, 0), (1, 0, 0)])
    for off, missing in ((1.94e-6, 0), (2.06e-6, 1)):
        assert part("limit_objects")._read_off(np.array([(0, off, 0)]), drawn, tree_of(drawn))[1] == missing


def test_a_vertex_inside_is_taken_up_by_a_fill_that_has_one_within_a_hundred_thousandth_of_the_rim(part):
    for off, taken in ((0.97e-5, 1), (1.03e-5, 0)):
        inside = SimpleNamespace(co=(0.5, 0.5, off))
        planned = SimpleNamespace(
            cage=False,
            rim=SimpleNamespace(inside=[inside]),
            positions=np.array([(0.5, 0.5, 0.0)]),
            loop=[SimpleNamespace(co=(0, 0, 0)), SimpleNamespace(co=(1, 1, 0))],
            fill=SimpleNamespace(split_edges=([], [])),
        )
        assert len(part("writeback").guides_of(planned)) == taken


def test_normals_agree_that_are_half_a_degree_apart(part):
    for degrees, agree in ((0.5, True), (0.525, False)):
        angle = math.radians(degrees)
        seam = [np.array([0, 0, 1.0]), np.array([math.sin(angle), 0, math.cos(angle)])]
        exact = np.array([1.0, 0, 0])
        planned = SimpleNamespace(normals=[exact], rim_normals=[exact, exact], loop=[0, 1])
        custom = dict(zip(("a", "b"), seam, strict=True))
        part("writeback")._give_normals(planned, [True, True], custom, ["a", "b"], [("c", 0, [0, 1])])
        assert (custom["c"] is seam[0]) == agree


def test_blended_quaternions_have_a_length_from_a_millionth_on(part):
    given = np.zeros((0, 4), np.float32)
    for length, unit in ((0.97e-6, False), (1.03e-6, True)):
        made = part("layers")._normalized(np.array([(length, 0, 0, 0)], np.float32), given)
        assert (abs(made[0, 0] - 1) < 1e-6) == unit


def test_an_end_that_a_range_excludes_is_a_thousandth_away_in_the_panel(part):
    ends = SimpleNamespace(open=True, least=0.0, most=math.inf)
    option = SimpleNamespace(range=ends, soft=SimpleNamespace(least=0.0, most=5.0))
    assert part("properties").limits(option) == {"min": 0.001, "soft_min": 0.001, "soft_max": 5.0}


def test_a_hole_that_has_moved_by_half_of_its_extent_is_gone(part, monkeypatch):
    live = part("live")
    corners = np.array([(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    for moved, gone in ((0.49, False), (0.51, True)):
        shift = Vector((0, 0, moved * math.sqrt(2)))
        border = [SimpleNamespace(co=Vector(c) + shift) for c in corners]
        monkeypatch.setattr(live, "_same_loop", lambda bm, rim: None)
        monkeypatch.setattr(live.selection, "border_vertices", lambda bm: bm)
        monkeypatch.setattr(live.selection, "border_loops", lambda vertices: [vertices])
        settings = {"rim": [], "corners": None, "positions": corners.tolist()}
        if gone:
            with pytest.raises(part("selection").UnusableError, match="The hole is gone"):
                live.find_rim(border, settings)
        else:
            assert live.find_rim(border, settings)[0] is border


def test_a_vertex_is_on_a_mirror_plane_as_near_as_the_mirror_merges_and_to_a_millionth(part):
    modifier = SimpleNamespace(
        type="MIRROR",
        show_viewport=True,
        use_mirror_merge=True,
        use_mirror_vertex_groups=False,
        mirror_object=None,
        use_axis=(True, False, False),
        merge_threshold=0.0,
    )
    ob = SimpleNamespace(modifiers=[modifier], matrix_world=Matrix())
    (plane,) = part("mirrored").planes_of(ob)
    assert plane.within == 1e-6
    modifier.merge_threshold = 0.01
    (plane,) = part("mirrored").planes_of(ob)
    assert plane.within == 0.01


def test_a_vertex_of_a_fill_is_put_on_a_mirror_plane_that_is_nearer_than_a_quarter_of_an_edge(part):
    plane = part("mirrored")._Plane(Vector((0, 0, 0)), Vector((1, 0, 0)), 1e-6)
    for share, put in ((0.245, True), (0.255, False)):
        bm = bmesh.new()
        rim = [bm.verts.new(co) for co in ((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))]
        inside = bm.verts.new((0, 0, 0))
        faces = [bm.faces.new((rim[k - 1], rim[k], inside)) for k in range(4)]
        for _ in range(10):  # the mean length depends on where it lies
            inside.co.x = share * sum(e.calc_length() for e in bm.edges) / len(bm.edges)
        kept = part("mirrored")._cut(bm, faces, plane, 1, set(rim))
        assert kept and (inside.co.x == 0) == put
        bm.free()


def test_maps_of_a_uv_layer_are_parted_where_they_differ_by_a_ten_thousandth_of_their_extent(part):
    attributes, selection = part("attributes"), part("selection")
    for apart, parted in ((0.97e-4, False), (1.03e-4, True)):
        bm = bmesh.new()
        points, faces = scenes.ring()
        vertices = [bm.verts.new(co) for co in points]
        layer = bm.loops.layers.uv.new("UV")
        for k, face in enumerate(faces):
            for corner in bm.faces.new([vertices[v] for v in face]).loops:  # over the rim, which comes first, one unit wide
                corner[layer].uv = corner.vert.co.x + (apart if k < 12 else 0), corner.vert.co.y
        rim = vertices[:24]
        edges = selection.edges_of(bm, rim)
        ends = attributes.rim_loops(edges, attributes.rim_faces(edges, ()))
        found = attributes.uv_charts(bm, ends, lambda values: values[:0], points[:24], [list(range(24))])
        assert (list(found) == ["UV"]) == parted
        bm.free()


def border_of_the_whole(ob):
    """Of an object as it is shown: how many edges have a face on one side only."""
    evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    bm = bmesh.new()
    bm.from_mesh(evaluated.to_mesh())
    evaluated.to_mesh_clear()
    count = sum(e.is_boundary for e in bm.edges)
    bm.free()
    return count


def test_a_live_fill_is_joined_to_the_mesh_across_a_thousandth_of_the_shortest_edge(addon):
    ob = scenes.add_hole(scenes.flat)
    scenes.edit(ob)
    assert bpy.ops.mesh.fill_three_sided(keep_live=True) == {"FINISHED"}
    fill = bpy.data.objects["Hole Fill"]
    bpy.ops.object.mode_set(mode="OBJECT")
    closed = border_of_the_whole(ob)
    at_rim = fill.data.vertices[0]
    assert any((at_rim.co - v.co).length == 0 for v in ob.data.vertices)
    for share, joined in ((0.97e-3, True), (1.03e-3, False)):
        at_rim.co.z = share / 12  # all of the rim's edges are as long
        fill.data.update()
        assert (border_of_the_whole(ob) == closed) == joined


def test_a_click_means_a_rim_that_is_sixty_pixels_away(part):
    bm = bmesh.new()
    bm.from_mesh(scenes.add_mesh(*scenes.ring()).data)
    for pixels, meant in ((59, True), (61, False)):
        rim = part("shaping").rims_at(bm, lambda v: (100, 200), (100, 200 + pixels))
        assert (rim is not None) == meant
    bm.free()


def test_an_arrow_goes_down_to_a_bulge_of_a_twentieth(part):
    shaping = part("shaping")
    shaped = SimpleNamespace(shape=shaping.Shape(bulges=[1.0]))
    for value, taken in ((0.051, 0.051), (0.049, 0.05)):
        shaping.Shaping.set_bulge(shaped, 0, value)
        assert shaped.shape.bulges == [taken]
