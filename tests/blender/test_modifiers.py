"""Modifiers before the subdivision that leave the rim where it is do not hinder a cage; a Mirror that cuts the hole in half."""

import sys

import bmesh
import bpy
import numpy as np
import pytest
import scenes
from test_subdivision import add_cage

smooth = bpy.ops.mesh.fill_smooth


def cage(change):
    """A cube sphere's cage with a hole, under a modifier and a Subdivision modifier, in edit mode with nothing selected."""
    ob = add_cage(levels=None)
    change(ob)
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 2
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    return ob


def armature(ob):
    bones = bpy.data.objects.new("Bones", bpy.data.armatures.new("Bones"))
    bpy.context.collection.objects.link(bones)
    ob.modifiers.new("Armature", "ARMATURE").object = bones


def bevel(ob):
    ob.modifiers.new("Bevel", "BEVEL").limit_method = "WEIGHT"


def solidify(ob):
    ob.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.05


def mirror(ob):
    ob.modifiers.new("Mirror", "MIRROR").use_axis = (False, False, False)


def nodes(ob):
    ob.modifiers.new("Nodes", "NODES").node_group = None


def cast(ob, **options):
    modifier = ob.modifiers.new("Cast", "CAST")
    modifier.factor = 0.9
    modifier.cast_type, modifier.show_in_editmode = "CYLINDER", True
    for name, value in options.items():
        setattr(modifier, name, value)


def hidden_in_edit_mode(ob):
    cast(ob, show_in_editmode=False)


def hidden(ob):
    cast(ob, show_viewport=False)


@pytest.mark.parametrize("change", [armature, bevel, solidify, mirror, nodes, hidden_in_edit_mode, hidden])
def test_what_leaves_the_rim_alone_does_not_hinder_a_cage(change):
    results = []
    for each in (change, lambda ob: None):
        ob = cage(each)
        old = len(ob.data.vertices)
        names = set(bpy.data.objects.keys()), set(bpy.data.meshes.keys())
        assert smooth() == {"FINISHED"}
        assert (set(bpy.data.objects.keys()), set(bpy.data.meshes.keys())) == names
        bpy.ops.object.mode_set(mode="OBJECT")
        assert not scenes.border_loops(scenes.checked(ob))
        results.append(np.array([v.co for v in ob.data.vertices]))
        assert len(results[-1]) > old
    np.testing.assert_allclose(*results, atol=1e-6)


def test_what_moves_the_rim_is_named():
    ob = cage(cast)
    before = [tuple(v.co) for v in bmesh.from_edit_mesh(ob.data).verts]
    with pytest.raises(
        RuntimeError, match="The modifier 'Cast' of Cage.* moves the boundary before the cage is subdivided; .*edit mode"
    ):
        smooth()
    assert [tuple(v.co) for v in bmesh.from_edit_mesh(ob.data).verts] == before


def group(kind):
    """A node group that makes nothing of a mesh."""
    made = bpy.data.node_groups.new("Group", "GeometryNodeTree")
    if hasattr(made, "interface"):
        made.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
        made.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        made.inputs.new("NodeSocketGeometry", "Geometry")
        made.outputs.new("NodeSocketGeometry", "Geometry")
    start = made.nodes.new("NodeGroupInput")
    if kind != "no output":
        end = made.nodes.new("NodeGroupOutput")
    if kind == "muted link":
        made.links.new(start.outputs[0], end.inputs[0]).is_muted = True
    return made


@pytest.mark.parametrize("kind", ["no output", "no link", "muted link"])
@pytest.mark.parametrize("first", [False, True])
def test_a_node_group_that_leaves_nothing_is_named(kind, first):
    """As Blender shows nothing of the mesh; another modifier before it is not blamed."""

    def change(ob):
        if not first:
            solidify(ob)
        ob.modifiers.new("Empty", "NODES").node_group = group(kind)

    ob = cage(change)
    with pytest.raises(RuntimeError, match="The modifier 'Empty' of Cage.* leaves nothing of the mesh before it is subdivided"):
        smooth()
    ob.modifiers["Empty"].show_in_editmode = False
    assert smooth() == {"FINISHED"}


def height(x, y):
    return 0.4 * np.cos(1.2 * x) * np.cos(y) + 0.1 * y


def add_half(n=20, **values):
    """The half x >= 0 of a sheet that a Mirror modifier completes, with a round hole on the mirror plane."""
    steps = np.linspace(-1, 1, n + 1)
    points = np.array([(x, y, height(x, y)) for y in steps for x in steps if x >= -1e-9])
    columns = n // 2 + 1
    faces = [
        [j * columns + i, j * columns + i + 1, (j + 1) * columns + i + 1, (j + 1) * columns + i]
        for j in range(n)
        for i in range(columns - 1)
    ]
    faces = [f for f in faces if np.linalg.norm(points[f, :2].mean(axis=0)) > 0.42]
    used = sorted({v for f in faces for v in f})
    new = {v: k for k, v in enumerate(used)}
    ob = scenes.add_mesh(points[used], [[new[v] for v in f] for f in faces], name="Half")
    ob.modifiers.new("Mirror", "MIRROR").use_axis = (True, False, False)
    return ob


def evaluated(ob):
    bpy.context.view_layer.update()
    made = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    bm = bmesh.new()
    bm.from_mesh(made)
    return bm


def filled_part(ob, output, choice, inward):
    """Fills the part of a hole that mirror planes leave, chosen by nothing, its rim or its vertex of the largest `inward`; where
    the new vertices are, which come after the old ones."""
    old, first = len(ob.data.vertices), [tuple(v.co) for v in ob.data.vertices]
    (bm,) = scenes.edit(ob)
    rim = [v for v in bm.verts if v.is_boundary and np.hypot(*v.co.xy) < 0.7]
    if choice == "rim":
        scenes.select(bm, rim)
    elif choice == "one vertex":
        scenes.select(bm, [max(rim, key=inward)])
    assert smooth(output=output) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not ob.data.validate(verbose=True)
    points = np.array([v.co for v in ob.data.vertices])
    assert [tuple(p) for p in points[:old].tolist()] == first and len(points) > old
    return points[old:]


def meets_its_images(ob, off_planes):
    """The whole that the modifiers show is closed but for its border, and smooth where the images meet."""
    whole = evaluated(ob)
    loops = scenes.border_loops(whole)
    assert len(loops) == 1 and len(loops[0]) == 80, "only the outer border of the sheet is left"
    middle = [e for e in whole.edges if all(off_planes(v) < 1e-6 and np.hypot(*v.co.xy) < 0.41 for v in e.verts)]
    assert middle and all(len(e.link_faces) == 2 for e in middle)
    assert max(np.degrees(e.calc_face_angle()) for e in middle) < 8  # faces of this size: a smooth surface has that


@pytest.mark.parametrize("choice", ["nothing", "rim", "one vertex"])
@pytest.mark.parametrize("output", ["triangles", "quads"])
def test_half_of_a_hole_on_the_mirror_plane_is_filled_and_meets_its_image(output, choice):
    ob = add_half()
    new = filled_part(ob, output, choice, lambda v: v.co.x)
    assert new[:, 0].min() == 0 and (new[:, 0] == 0).sum() >= 2, "vertices on the plane, none beyond"
    assert np.abs(new[:, 2] - height(new[:, 0], new[:, 1])).max() < 5e-3
    assert sum(p.select for p in ob.data.polygons) == len([p for p in ob.data.polygons if p.index >= 0 and p.select])
    meets_its_images(ob, lambda v: abs(v.co.x))


def add_quarter(n=20, middle=(0.0, 0.0), objects=False, radius=0.42):
    """The quarter x, y >= 0 of a sheet that is symmetric to both planes, with a hole in the middle."""
    steps = np.linspace(0, 1, n // 2 + 1)
    points = np.array([(x, y, 0.4 * np.cos(1.2 * x) * np.cos(y)) for y in steps for x in steps])
    k = len(steps)
    faces = [[j * k + i, j * k + i + 1, (j + 1) * k + i + 1, (j + 1) * k + i] for j in range(k - 1) for i in range(k - 1)]
    faces = [f for f in faces if np.linalg.norm(points[f, :2].mean(axis=0) - middle) > radius]
    used = sorted({v for f in faces for v in f})
    new = {v: number for number, v in enumerate(used)}
    ob = scenes.add_mesh(points[used], [[new[v] for v in f] for f in faces], name="Quarter")
    if objects:
        for k in range(2):
            ob.modifiers.new("Mirror", "MIRROR").use_axis = (k == 0, k == 1, False)
    else:
        ob.modifiers.new("Mirror", "MIRROR").use_axis = (True, True, False)
    return ob


@pytest.mark.parametrize("choice", ["nothing", "rim", "one vertex"])
@pytest.mark.parametrize(("output", "two"), [("triangles", False), ("triangles", True), ("quads", False)])
def test_a_quarter_of_a_hole_between_two_mirror_planes_is_filled_and_meets_its_images(output, two, choice):
    ob = add_quarter(objects=two)
    new = filled_part(ob, output, choice, lambda v: min(v.co.xy))
    assert new[:, :2].min() == 0 and np.abs(new[:, :2]).sum(axis=1).min() == 0, "a vertex on both planes, none beyond"
    assert np.abs(new[:, 2] - 0.4 * np.cos(1.2 * new[:, 0]) * np.cos(new[:, 1])).max() < 5e-3
    meets_its_images(ob, lambda v: min(abs(v.co.x), abs(v.co.y)))


@pytest.mark.parametrize("choice", ["nothing", "rim"])
@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize("make", [add_half, add_quarter])
def test_a_live_fill_of_such_a_part_follows_and_is_applied(make, output, choice, addon):
    live, modes = sys.modules[addon.__name__ + ".live"], ("EDIT", "OBJECT")
    ob = make()

    def off_planes(v):
        return abs(v.co.x) if make is add_half else min(abs(v.co.x), abs(v.co.y))

    (bm,) = scenes.edit(ob)
    if choice == "rim":
        scenes.select(bm, [v for v in bm.verts if v.is_boundary and np.hypot(*v.co.xy) < 0.7])
    assert smooth(output=output, keep_live=True) == {"FINISHED"}
    (fill,) = live.fills()
    for by, mode in zip((0.5, 0.25), modes, strict=True):
        before = np.array([v.co for v in fill.data.vertices])
        bpy.ops.object.mode_set(mode="EDIT")
        bm = bmesh.from_edit_mesh(ob.data)
        for v in bm.verts:
            v.co.z += by
        bmesh.update_edit_mesh(ob.data)
        bpy.ops.object.mode_set(mode=mode)
        assert live.refill(fill) == ""
        assert np.array([v.co for v in fill.data.vertices]) == pytest.approx(before + [0, 0, by], abs=1e-5)
        meets_its_images(ob, off_planes)
    assert bpy.ops.object.apply_live_fill() == {"FINISHED"}
    assert not live.fills() and [m.type for m in ob.modifiers] == ["MIRROR"]
    meets_its_images(ob, off_planes)


def test_a_live_fill_says_so_when_its_mirror_is_gone(addon):
    live = sys.modules[addon.__name__ + ".live"]
    ob = add_half()
    scenes.edit(ob)
    smooth(keep_live=True)
    (fill,) = live.fills()
    ob.modifiers.remove(ob.modifiers["Mirror"])
    assert live.refill(fill) == "The hole is gone: the mesh has no border where it was"


@pytest.mark.parametrize("middle", [(0.0, 0.5), (0.5, 0.0), (0.5, 0.5)])
def test_with_two_mirror_planes_a_hole_on_one_or_none_of_them_is_half_or_whole(middle):
    ob = add_quarter(middle=middle, radius=0.25)
    scenes.edit(ob)
    assert smooth() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert [len(loop) for loop in scenes.border_loops(evaluated(ob))] == [80]


def subdivided_with_its_whole(ob):
    """What an object's Mirror modifiers make of it, as an object of its own; both get a Subdivision modifier."""
    mesh = bpy.data.meshes.new("Whole")
    evaluated(ob).to_mesh(mesh)
    whole = bpy.data.objects.new("Whole", mesh)
    bpy.context.collection.objects.link(whole)
    for each in (ob, whole):
        each.modifiers.new("Subdivision", "SUBSURF")
    return whole


def test_a_cage_of_a_quarter_is_that_of_the_whole():
    ob = add_quarter(n=12)
    whole = subdivided_with_its_whole(ob)
    surfaces = []
    for each in (ob, whole):
        scenes.edit(each)
        assert smooth() == {"FINISHED"}
        bpy.ops.object.mode_set(mode="OBJECT")
        assert len(scenes.border_loops(evaluated(each))) == 1
        surfaces.append(evaluated(each))
    points = [np.array([v.co for v in bm.verts]) for bm in surfaces]
    apart = np.linalg.norm(points[0][:, None] - points[1][None], axis=2)
    assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 0.02


def test_attributes_of_a_half():
    ob = add_half()
    uv = ob.data.uv_layers.new(name="UV")
    for loop, data in zip(ob.data.loops, uv.data, strict=True):
        data.uv = ob.data.vertices[loop.vertex_index].co.xy
    for name in "AB":
        ob.data.materials.append(bpy.data.materials.new(name))
    for p in ob.data.polygons:
        p.material_index = int(p.center.y > 0)
    old = len(ob.data.polygons)
    scenes.edit(ob)
    assert smooth() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    mesh = ob.data
    new = list(mesh.polygons)[old:]
    assert {p.material_index for p in new} == {0, 1}
    assert all(p.material_index == (p.center.y > 0) for p in new if abs(p.center.y) > 0.15)
    assert len({tuple(v.co) for v in mesh.vertices}) == len(mesh.vertices), "nothing of the image is left"


def weights_of(ob, names=("Arm.L", "Arm.R")):
    """(vertices, names)"""
    numbers = {ob.vertex_groups[name].index: k for k, name in enumerate(names)}
    found = np.zeros((len(ob.data.vertices), len(names)))
    for v in ob.data.vertices:
        for g in v.groups:
            if g.group in numbers:
                found[v.index, numbers[g.group]] = g.weight
    return found


@pytest.mark.parametrize("smoothly", [False, True])
@pytest.mark.parametrize("output", ["triangles", "quads"])
def test_groups_of_two_sides_are_those_of_the_whole(output, smoothly):
    """A Mirror exchanges .L and .R in the image: a half has the weights that a fill of the whole has, on the plane both the same.
    smoothly: the modeller's weights are even on the plane; else all of the half has the one group."""

    def weighted(ob):
        arm = [ob.vertex_groups.new(name=name) for name in ("Arm.L", "Arm.R", "Spine")]
        for v in ob.data.vertices:
            share = 0.5 + 0.5 * min(v.co.x / 0.8, 1) if smoothly else 1.0
            for g, weight in zip(arm, (share, 1 - share, 0.25), strict=True):
                if weight:
                    g.add([v.index], weight, "REPLACE")

    ob = add_half()
    weighted(ob)
    old = len(ob.data.vertices)
    before = weights_of(ob)
    new = filled_part(ob, output, "nothing", None)
    weights = weights_of(ob)
    assert (weights[:old] == before).all()
    weights = weights[old:]
    on_plane = abs(new[:, 0]) < 1e-5
    assert on_plane.sum() > 2
    assert weights[on_plane] == pytest.approx(0.5, abs=1e-5)
    assert (weights[~on_plane, 0] > weights[~on_plane, 1]).all()
    assert weights.sum(axis=1) == pytest.approx(1, abs=1e-5)
    assert weights_of(ob, ["Spine"])[old:] == pytest.approx(0.25, abs=1e-5)
    if smoothly:
        right = 0.5 + 0.5 * np.minimum(new[:, 0] / 0.8, 1)
        assert np.abs(weights[:, 0] - right).max() < 0.05


def test_groups_stay_on_their_side_where_the_mirror_does_not_exchange_them():
    ob = add_half()
    ob.modifiers["Mirror"].use_mirror_vertex_groups = False
    for name, weight in (("Arm.L", 1.0), ("Arm.R", 0.0)):
        ob.vertex_groups.new(name=name).add(range(len(ob.data.vertices)), weight, "REPLACE")
    filled_part(ob, "triangles", "nothing", None)
    assert weights_of(ob) == pytest.approx(np.tile([1.0, 0.0], (len(ob.data.vertices), 1)), abs=1e-6)


def test_a_half_that_cannot_be_filled_is_left_as_it_was():
    ob = add_half()
    scenes.edit(ob)
    count = len(ob.data.vertices), len(ob.data.polygons)
    with pytest.raises(RuntimeError, match="needs 3 corners"):
        smooth(method="side_vertex")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert (len(ob.data.vertices), len(ob.data.polygons)) == count
    assert not ob.data.validate(verbose=True)


def test_a_hole_off_the_plane_is_filled_as_any_other():
    points, faces = scenes.lattice()
    ob = scenes.add_mesh(scenes.bowl(points) + [3, 0, 0], faces)
    ob.modifiers.new("Mirror", "MIRROR")
    scenes.edit(ob)
    assert smooth() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(scenes.border_loops(scenes.checked(ob))) == 1


def add_half_with_holes(*middles, size=20):
    """The half x >= 0 of a sheet that a Mirror modifier completes, with square holes around these points."""
    bm = bmesh.new()
    bmesh.ops.create_grid(bm, x_segments=size, y_segments=size, size=2)

    def missing(face):
        x, y, _ = face.calc_center_median()
        return x < 0 or any(max(abs(x - a), abs(y - b)) < 0.45 for a, b in middles)

    bmesh.ops.delete(bm, geom=[f for f in bm.faces if missing(f)], context="FACES")
    for v in bm.verts:
        v.co.x = 0 if abs(v.co.x) < 1e-5 else v.co.x
        v.co.z = height(*v.co.xy)
    mesh = bpy.data.meshes.new("Half")
    bm.to_mesh(mesh)
    ob = scenes.object_of(mesh)
    ob.modifiers.new("Mirror", "MIRROR")
    return ob


def whole_borders(ob):
    bpy.ops.object.mode_set(mode="OBJECT")
    return [len(loop) for loop in scenes.border_loops(evaluated(ob))]


@pytest.mark.parametrize("action", ["DESELECT", "SELECT"])
@pytest.mark.parametrize("middles", [[(1, 0)], [(0, -1), (1, 0.8)]], ids=["beside the plane", "on the plane and beside it"])
def test_with_a_mirror_all_holes_are_those_of_the_whole_without_its_outer_border(middles, action):
    ob = add_half_with_holes(*middles)
    scenes.edit(ob)
    bpy.ops.mesh.select_all(action=action)
    assert smooth() == {"FINISHED"}
    assert whole_borders(ob) == [80]


def test_the_cut_of_a_mirror_is_no_hole():
    ob = add_half_with_holes()
    (bm,) = scenes.edit(ob)
    for action in ("DESELECT", "SELECT"):
        bpy.ops.mesh.select_all(action=action)
        assert smooth() == {"CANCELLED"}, "there is nothing to fill"
    bpy.ops.mesh.select_all(action="DESELECT")
    scenes.select(bm, [min((v for v in bm.verts if v.co.x == 0), key=lambda v: v.co.length)])
    with pytest.raises(RuntimeError, match="plane of a Mirror.*apply the modifier"):
        smooth()
    assert whole_borders(ob) == [80]


def test_selected_holes_on_the_plane_and_beside_it_are_both_filled():
    ob = add_half_with_holes((0, -1), (1, 0.8))
    (bm,) = scenes.edit(ob)
    inner = [v for v in bm.verts if v.is_boundary and max(abs(v.co.x), abs(v.co.y)) < 1.9 and v.co.x > 0.01]
    scenes.select(bm, inner)
    assert smooth() == {"FINISHED"}
    assert whole_borders(ob) == [80]


def test_a_cage_of_half_a_hole_is_that_of_the_whole():
    ob = add_half_with_holes((0, 0))
    whole = subdivided_with_its_whole(ob)
    found = []
    for each in (ob, whole):
        scenes.edit(each)
        assert smooth() == {"FINISHED"}
        bpy.ops.object.mode_set(mode="OBJECT")
        found.append(np.array([v.co for v in each.data.vertices]))
    half, every = found
    every = every[every[:, 0] > -1e-5]
    assert len(half) == len(every)
    apart = np.linalg.norm(half[:, None] - every[None], axis=2)
    assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-3


def posed(ob, by=(0, 2, 0)):
    """An armature of one bone, moved, that moves all of a mesh by a vertex group."""
    bones = bpy.data.objects.new("Bones", bpy.data.armatures.new("Bones"))
    bpy.context.collection.objects.link(bones)
    bpy.context.view_layer.objects.active = bones
    bpy.ops.object.mode_set(mode="EDIT")
    bone = bones.data.edit_bones.new("Bone")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    bones.pose.bones["Bone"].location = by
    ob.vertex_groups.new(name="Other")
    ob.vertex_groups.new(name="Bone").add(range(len(ob.data.vertices)), 1, "REPLACE")
    modifier = ob.modifiers.new("Armature", "ARMATURE")
    modifier.object, modifier.show_in_editmode = bones, True
    bpy.context.view_layer.objects.active = ob
    bpy.context.view_layer.update()


def test_what_a_modifier_moves_by_a_vertex_group_is_noticed():
    cage(posed)
    with pytest.raises(RuntimeError, match="Armature.*moves the boundary"):
        smooth(output="cage")


def test_a_live_fill_goes_with_the_vertex_groups_of_its_mesh(addon):
    ob = scenes.add_mesh(*scenes.square_hole())
    posed(ob)
    (bm,) = scenes.edit(ob)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    if not sys.modules[addon.__name__ + ".joining"].keeps_groups():
        assert bpy.app.version < (4, 5)
        with pytest.raises(RuntimeError, match="cannot join vertex groups, which Armature needs"):
            smooth(keep_live=True)
        assert not ob.children and len(ob.modifiers) == 1
        return
    assert smooth(keep_live=True) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    made = evaluated(ob)
    moved = np.array([v.co.z for v in made.verts]) - np.array([0.6 * (v.co.x**2 + v.co.y**2) for v in made.verts])
    assert len(made.verts) > len(ob.data.vertices) and np.ptp(moved) < 0.02 and abs(moved.mean()) > 1
    (fill,) = (o for o in bpy.data.objects if o.parent == ob)
    assert [g.name for g in fill.vertex_groups] == [g.name for g in ob.vertex_groups] == ["Other", "Bone"]


@pytest.mark.parametrize("output", ["triangles", "quads"])
def test_custom_normals_at_a_mirror_plane_stay(output):
    ob = add_half()
    mesh = ob.data
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
    wanted = scenes.corner_normals(mesh) + np.random.default_rng(0).normal(size=(len(mesh.loops), 3)) * 0.2
    mesh.normals_split_custom_set((wanted / np.linalg.norm(wanted, axis=1, keepdims=True)).tolist())
    before = scenes.corner_normals(mesh)
    filled_part(ob, output, "rim", lambda v: v.co.x)
    after = scenes.corner_normals(mesh)[: len(before)]
    turned = np.degrees(np.arccos(np.clip((before * after).sum(axis=1), -1, 1)))
    assert turned.max() < 0.5
    on_plane = [k for k, c in enumerate(mesh.loops) if k >= len(before) and abs(mesh.vertices[c.vertex_index].co.x) < 1e-6]
    flat = np.array([p.normal for p in mesh.polygons for _ in p.loop_indices])
    assert (scenes.corner_normals(mesh)[on_plane] * flat[on_plane]).sum(axis=1).min() > 0.7


@pytest.mark.parametrize("output", ["triangles", "quads"])
def test_shapes_of_half_a_fill_stay_on_the_mirror_plane(output):
    ob = add_half()
    for v in ob.data.vertices:
        v.co.y += 0.03 * np.sin(7 * v.co.x)  # so that the triangles of the halves are none of each other's images
    ob.shape_key_add(name="Basis")
    for p in ob.shape_key_add(name="Wide").data:
        p.co.x *= 2.5
        p.co.z += 0.2 * p.co.x + 0.2
    filled_part(ob, output, "rim", lambda v: v.co.x)
    basis, wide = ([np.array(p.co) for p in ob.data.shape_keys.key_blocks[name].data] for name in ("Basis", "Wide"))
    assert max(abs(w[0]) for b, w in zip(basis, wide) if abs(b[0]) < 1e-6) < 1e-6
    ob.data.shape_keys.key_blocks["Wide"].value = 1
    assert len(scenes.border_loops(evaluated(ob))) == 1


def test_the_tool_leaves_halves_to_the_operator(addon):
    shaping = sys.modules[addon.__name__ + ".shaping"]
    (bm,) = scenes.edit(add_half())
    scenes.select(bm, [v for v in bm.verts if v.is_boundary and np.hypot(*v.co.xy) < 0.7])
    with pytest.raises(shaping.UnusableError, match="Mirror"):
        shaping.from_selection(bpy.context.object, bm)
