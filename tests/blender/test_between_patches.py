"""object.fill_between_patches, against Blender's own evaluation of the surfaces."""

import itertools
import sys

import bpy
import numpy as np
import pytest
from mathutils import Matrix

fill = bpy.ops.object.fill_between_patches

# A sphere's octant open at (1, 1, 1): three patches around it, each from a side of it outwards.
CORNERS = np.eye(3)


def add_surface(points, name="Surface", weights=None, order=(4, 4), endpoint=True, bezier=False, resolution=4):
    """points (m, n, 3), the first index along u."""
    m, n = points.shape[:2]
    curve = bpy.data.curves.new(name, "SURFACE")
    ob = bpy.data.objects.new(name, curve)
    bpy.context.collection.objects.link(ob)
    for _ in range(n):
        spline = curve.splines.new("NURBS")
        spline.points.add(m - 1)
        for point in spline.points:
            point.select = True
    bpy.ops.object.select_all(action="DESELECT")
    bpy.context.view_layer.objects.active = ob
    ob.select_set(True)
    if n > 1:
        # The only way to a surface: Blender joins rows, whose places it reads.
        for k, spline in enumerate(curve.splines):
            for j, point in enumerate(spline.points):
                point.co = (j, k, 0, 1)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.curve.make_segment()
        bpy.ops.object.mode_set(mode="OBJECT")
    (spline,) = curve.splines
    assert {spline.point_count_u, spline.point_count_v} == {m, n}
    if spline.point_count_u != m or (m == n and spline.points[1].co.x == spline.points[0].co.x):
        points = points.transpose(1, 0, 2)
        weights = None if weights is None else np.asarray(weights).T
        order = order[::-1]
    flat = np.ones((points.shape[1], points.shape[0], 4))
    flat[..., :3] = points.transpose(1, 0, 2)
    if weights is not None:
        flat[..., 3] = np.asarray(weights).T
    spline.points.foreach_set("co", flat.ravel())
    spline.order_u, spline.order_v = order
    spline.use_endpoint_u = spline.use_endpoint_v = endpoint
    spline.use_bezier_u = spline.use_bezier_v = bezier
    spline.resolution_u = spline.resolution_v = resolution
    curve.resolution_u = curve.resolution_v = resolution
    return ob


def patch_points(i, m=4, n=5, seed=0):
    """Control points of a surface whose edge v = 0 goes from corner i + 1 to corner i + 2, and which leaves it outwards."""
    rng = np.random.default_rng(seed + i)
    a, b = CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3]
    out = (a + b) / 2 - np.ones(3) / 3
    u, v = np.meshgrid(np.linspace(0, 1, m), np.linspace(0, 1, n), indexing="ij")
    points = a + u[..., None] * (b - a) + v[..., None] * (out - 0.4 * np.ones(3))
    points[1:-1] += 0.25 * np.ones(3)
    points[:, 1:] += 0.05 * rng.normal(size=(m, n - 1, 3))
    return points


def turned(points, k):
    """The same surface with other edges first."""
    for _ in range(k % 4):
        points = points.transpose(1, 0, 2)[::-1]
    return points if k < 4 else points.transpose(1, 0, 2)


def three(turns=(0, 0, 0), **options):
    obs = []
    for i in range(3):
        points = turned(patch_points(i), turns[i])
        obs.append(add_surface(points, "ABC"[i], **options))
    return obs


def run(obs, **options):
    bpy.ops.object.select_all(action="DESELECT")
    for ob in obs:
        ob.select_set(True)
    before = set(bpy.data.objects)
    assert fill(**options) == {"FINISHED"}
    (new,) = set(bpy.data.objects) - before
    assert bpy.context.view_layer.objects.active == new and not new.data.validate(verbose=True)
    return new


def drawn(ob):
    """World positions and faces that Blender makes of an object."""
    of = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = of.to_mesh()
    points = np.array([ob.matrix_world @ v.co for v in mesh.vertices])
    turn = np.linalg.inv(np.array(ob.matrix_world)[:3, :3])
    normals = np.array([v.normal for v in mesh.vertices]) @ turn
    of.to_mesh_clear()
    return points, normals


def border(ob):
    count = {}
    for p in ob.data.polygons:
        for edge in p.edge_keys:
            count[edge] = count.get(edge, 0) + 1
    return sorted({v for edge, faces in count.items() if faces == 1 for v in edge})


def check(obs, new, within=2e-6):
    """Every point of the fill's border is one that Blender draws, and the normals agree there but at the corners."""
    surfaces = [drawn(ob) for ob in obs]
    points, normals = (np.vstack(parts) for parts in zip(*surfaces, strict=True))
    extent = np.ptp(points, axis=0).max()
    corners = [min(border(new), key=lambda v: np.linalg.norm(np.array(new.data.vertices[v].co) - c)) for c in CORNERS]
    for v in border(new):
        gaps = np.linalg.norm(points - np.array(new.data.vertices[v].co), axis=1)
        nearest = int(np.argmin(gaps))
        assert gaps[nearest] < within * extent
        if v not in corners:
            assert normals[nearest] @ np.array(new.data.vertices[v].normal) > 0, "the fill faces the other way"


@pytest.mark.parametrize("turns", [(0, 0, 0), (1, 2, 3), (4, 5, 6), (7, 1, 4)])
def test_any_edge_in_any_direction(turns):
    obs = three(turns, order=(4, 4))
    new = run(obs)
    # Surfaces that face different ways cannot all agree with the fill.
    same = len({t < 4 for t in turns}) == 1
    if same:
        check(obs, new)
    assert len(border(new)) == sum(4 * n - 1 for n in (4, 4, 4))


@pytest.mark.parametrize(("order", "bezier"), [(2, False), (3, False), (4, False), (2, True), (4, True)])
def test_orders_and_knots(order, bezier):
    obs = three(order=(order, 3), bezier=bezier)
    check(obs, run(obs))


def test_knots_are_those_of_blender(addon):
    from tripatch import NurbsSurface

    knots = sys.modules[addon.__name__ + ".between_patches"].knots
    rng = np.random.default_rng(2)
    for order, count, endpoint, bezier in itertools.product((2, 3, 4, 5), (5, 7), (False, True), (False, True)):
        k = knots(count, order, False, endpoint, bezier)
        if not k[count] > k[order - 1]:
            continue
        points = rng.normal(size=(count, 3, 3))
        weights = rng.uniform(0.5, 2, size=(count, 3))
        ob = add_surface(points, weights=weights, order=(order, 2), endpoint=endpoint, bezier=bezier)
        spline = ob.data.splines[0]
        spline.use_bezier_v = spline.use_bezier_u = bezier
        flipped = spline.point_count_u != count
        across = knots(3, 2, False, endpoint, bezier)
        surface = NurbsSurface(points, weights, k, across)
        made = drawn(ob)[0]
        u = np.linspace(k[order - 1], k[count], 4 * count)
        v = np.linspace(across[1], across[3], 12)
        u, v = np.meshgrid(u, v, indexing="ij" if not flipped else "xy")
        own = surface.evaluate(np.stack([u.ravel(), v.ravel()], axis=1))
        gaps = np.linalg.norm(own[:, None] - made[None], axis=2)
        assert gaps.min(axis=1).max() < 1e-5 * np.ptp(made) and len(made) == len(own)
        bpy.data.objects.remove(ob)


def test_weights_and_transforms():
    obs = three(weights=np.array([[1, 1, 1, 1, 1]] + [[2, 1, 1.5, 1, 1]] * 2 + [[1, 1, 1, 1, 1]]))
    for k, ob in enumerate(obs):
        turn = Matrix.Rotation(0.7 * k, 4, (1, 2, 3)) @ Matrix.Diagonal((1, 2, -0.5, 1))
        spline = ob.data.splines[0]
        for p in spline.points:
            p.co.xyz = turn.inverted() @ p.co.xyz
        ob.matrix_world = turn
    bpy.context.view_layer.update()
    check(obs, run(obs))


def refused(obs, sentence, **options):
    bpy.ops.object.select_all(action="DESELECT")
    for ob in obs:
        ob.select_set(True)
    before = set(bpy.data.objects)
    with pytest.raises(RuntimeError, match=sentence):
        fill(**options)
    assert set(bpy.data.objects) == before


def test_a_gap_is_named():
    obs = three()
    obs[2].location.z = 0.1
    bpy.context.view_layer.update()
    refused(obs, "do not meet: their ends are 0.1")
    new = run(obs, tolerance=0.11)
    assert new.data.polygons


def test_a_gap_within_the_tolerance_is_closed():
    obs = three()
    obs[2].location.z = 5e-4
    bpy.context.view_layer.update()
    check(obs, run(obs), within=5e-4)


def test_bad_surfaces():
    obs = three()
    obs[0].data.splines[0].points[3].co[3] = 0
    refused(obs, "A has points with weights of zero or below")
    obs[0].data.splines[0].points[3].co[3] = 1
    obs[1].data.splines[0].use_cyclic_u = True
    refused(obs, "B is cyclic")
    obs[1].data.splines[0].use_cyclic_u = False
    obs[2].scale = (0, 1, 1)
    bpy.context.view_layer.update()
    refused(obs, "C is scaled to nothing")
    refused(obs[:2], "three surface objects")
