"""object.fill_between_patches, against Blender's own evaluation of the surfaces."""

import itertools
import sys

import bmesh
import bpy
import numpy as np
import pytest
from mathutils import Matrix

fill = bpy.ops.object.fill_between_patches

# A sphere's octant open at (1, 1, 1): three patches around it, each from a side of it outwards.
CORNERS = np.eye(3)


def add_surface(points, name="Surface", weights=None, order=(4, 4), endpoint=True, bezier=False, cyclic=False, resolution=4):
    """points (m, n, 3), the first index along u; cyclic: in u."""
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
    spline.use_cyclic_u, spline.use_cyclic_v = cyclic, False
    if spline.point_count_u != m or (m == n and spline.points[1].co.x == spline.points[0].co.x):
        points = points.transpose(1, 0, 2)
        weights = None if weights is None else np.asarray(weights).T
        order = order[::-1]
        spline.use_cyclic_u, spline.use_cyclic_v = False, cyclic
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
    normals = np.array([v.normal for v in mesh.vertices]).reshape(-1, 3) @ turn
    of.to_mesh_clear()
    return points, normals


def border(ob):
    count = {}
    for p in ob.data.polygons:
        for edge in p.edge_keys:
            count[edge] = count.get(edge, 0) + 1
    return sorted({v for edge, faces in count.items() if faces == 1 for v in edge})


def check(obs, new, within=1e-6):
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

    part = sys.modules[addon.__name__ + ".between_patches"]
    knots = part.knots
    rng = np.random.default_rng(2)
    for order, count, endpoint, bezier, cyclic in itertools.product((2, 3, 4, 5), (5, 7), *[(False, True)] * 3):
        k = knots(count, order, cyclic, endpoint, bezier)
        last = count + (order - 1) * cyclic
        torn = any(k[j] == k[j + order - 1] and k[order - 1] < k[j] < k[last] for j in range(order, last - order + 1))
        if torn or not k[last] > k[order - 1]:
            continue
        points = rng.normal(size=(count, 3, 3))
        weights = rng.uniform(0.5, 2, size=(count, 3))
        ob = add_surface(points, weights=weights, order=(order, 2), endpoint=endpoint, bezier=bezier, cyclic=cyclic)
        spline = ob.data.splines[0]
        spline.use_bezier_v = spline.use_bezier_u = bezier
        flipped = spline.point_count_u != count
        across = knots(3, 2, False, endpoint, bezier)
        around = np.arange(last) % count
        surface = NurbsSurface(points[around], weights[around], k, across)
        made = drawn(ob)[0]
        if not len(made):
            assert bezier and cyclic and count % (order - 1), "Blender draws it not"
            continue
        u = k[order - 1] + (k[last] - k[order - 1]) * part.drawn_at(k[order - 1], k[last], 4 * count - (not cyclic))[: 4 * count]
        v = across[1] + (across[3] - across[1]) * part.drawn_at(across[1], across[3], 11)
        u, v = np.meshgrid(u, v, indexing="ij" if not flipped else "xy")
        own = surface.evaluate(np.stack([u.ravel(), v.ravel()], axis=1))
        gaps = np.linalg.norm(own[:, None] - made[None], axis=2)
        assert len(made) == len(own)
        nearest = gaps.min(axis=1) / np.ptp(made, axis=0).max()
        ends = ((u == k[last]) | (v == across[3])).ravel()  # Blender's last step strays, ours is at the end
        assert nearest[~ends].max() < 1e-6 and nearest.max() < 1e-5, (order, count, endpoint, bezier, cyclic)
        bpy.data.objects.remove(ob)


def test_finely_drawn_surfaces_are_closed_where_blender_draws_them():
    """Blender adds up single-precision steps along an edge: after hundreds they have strayed."""
    obs = [add_surface(patch_points(i, m=9, n=2), "ABC"[i], order=(4, 2), resolution=32) for i in range(3)]
    for ob in obs:
        spline = ob.data.splines[0]
        setattr(spline, "resolution_u" if spline.point_count_u == 2 else "resolution_v", 1)
    bpy.context.view_layer.update()
    check(obs, run(obs))


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


def test_a_fill_that_folds_says_so(capfd):
    obs = three()
    run(obs)
    assert "folds over itself" not in capfd.readouterr().out
    new = run(obs, bulge=40.0, fairing="none")
    told = capfd.readouterr().out
    assert "Warning: Filled the hole between" in told and "The patch folds over itself at" in told
    normals = np.array([p.normal for p in new.data.polygons])
    assert (normals @ normals.mean(axis=0) < 0).any()


def refused(obs, sentence, **options):
    bpy.ops.object.select_all(action="DESELECT")
    for ob in obs:
        ob.select_set(True)
    before = set(bpy.data.objects)
    with pytest.raises(RuntimeError, match=sentence):
        fill(**options)
    assert set(bpy.data.objects) == before


def test_a_refusal_by_hand_is_a_step_with_its_reason(capfd):
    obs = three()
    obs[2].location.z = 0.1
    bpy.ops.object.select_all(action="DESELECT")
    for ob in obs:
        ob.select_set(True)
    before = set(bpy.data.objects)
    assert fill(by_hand=True) == {"FINISHED"}
    assert set(bpy.data.objects) == before
    assert "Warning" in capfd.readouterr().out


def test_a_gap_is_named():
    obs = three()
    obs[2].location.z = 0.1
    bpy.context.view_layer.update()
    refused(obs, "do not meet: they are 0.1 apart")
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
    spline = obs[1].data.splines[0]
    spline.use_cyclic_u = spline.use_cyclic_v = True
    refused(obs, "B is closed: it has no edge")
    spline.use_cyclic_u = spline.use_cyclic_v = False
    obs[2].scale = (0, 1, 1)
    bpy.context.view_layer.update()
    refused(obs, "C has a scale of zero")
    refused(obs[:1], "two to twelve surface or mesh objects")
    obs[2].scale = (1, 1, 1)
    bpy.context.view_layer.update()
    refused(obs[:2], "enclose no hole|do not meet")


def arch(name, sign, high=0.4):
    """A surface along a parabola between (-1, 0, 0) and (1, 0, 0), and away from there."""
    u, v = np.meshgrid(np.linspace(-1, 1, 3), np.linspace(0, 1, 3), indexing="ij")
    points = np.stack([u, sign * (np.array([0, 2 * high, 0])[:, None] + 0.5 * v), 0.2 * v], axis=2)
    return add_surface(points if sign < 0 else points[::-1], name, order=(3, 3), resolution=8)


def test_two_objects_with_a_side_each():
    obs = [arch("Lower", -1), arch("Upper", 1)]
    new = run(obs)
    points = np.vstack([drawn(ob)[0] for ob in obs])
    rim = [np.array(new.data.vertices[v].co) for v in border(new)]
    assert len(rim) == 2 * (3 * 8 - 1)
    assert max(np.linalg.norm(points - p, axis=1).min() for p in rim) < 1e-6
    assert len(new.data.polygons) > len(rim) and max(abs(v.co.y) for v in new.data.vertices) < 0.41


def test_more_objects_than_sides():
    """Two of five continue smoothly one after the other: four sides, and a fill as with one object in their place."""
    corners = np.array([(1.0, 0, 0), (0, 1, 0.2), (-1, 0, 0), (0, -1, 0.2)])

    def sheet(name, a, b, out):
        u, v = np.meshgrid(np.linspace(0, 1, 3), np.linspace(0, 1, 3), indexing="ij")
        return add_surface(a + u[..., None] * (b - a) + v[..., None] * out, name, order=(3, 3), resolution=8)

    sides = list(zip(corners, np.roll(corners, -1, axis=0)))
    outs = [(a + b) / 2 + (0, 0, 0.1) for a, b in sides]
    whole = [sheet("ABCD"[k], *sides[k], outs[k]) for k in range(4)]
    one = run(whole)
    (a, b), out = sides[1], outs[1]
    middle = a + 0.4 * (b - a)
    cut = [whole[0], whole[2], whole[3], sheet("B1", a, middle, out), sheet("B2", middle, b, out)]
    two = run(cut)
    assert len(border(two)) == len(border(one)) + 3 * 8 - 1
    points = np.array([v.co for v in one.data.vertices])
    off = max(np.linalg.norm(points - np.array(v.co), axis=1).min() for v in two.data.vertices)
    assert off < 0.1 * np.ptp(points, axis=0).max()


def test_a_surface_flat_to_a_line():
    obs = three()
    for point in obs[1].data.splines[0].points:
        point.co.x = point.co.y = 0
    refused(obs, "B has no tangent planes along an edge")


def test_patches_that_overlap():
    """Two of the three in one place: no edges run round a hole."""
    obs = three()
    points = np.array([p.co for p in obs[0].data.splines[0].points])
    obs[1].data.splines[0].points.foreach_set("co", points.ravel())
    refused(obs, "do not meet|enclose no hole")


def cut_back(points, before, after):
    """A bilinear surface through the corners of another, which continues beyond its edge v = 0 at both ends."""
    a, b = points[0, 0], points[-1, 0]
    u = np.linspace(-before, 1 + after, 4)
    return a + u[:, None, None] * (b - a) + np.linspace(0, 1, 4)[None, :, None] * (points[2, -1] - points[2, 0])


@pytest.mark.parametrize("beyond", [((0.5, 0.3), (0, 0), (0, 0)), ((0, 0.4), (0.3, 0), (0, 0.2)), ((0.4, 0.4),) * 3])
def test_pieces_of_edges(beyond):
    """Edges that continue beyond the hole: ends meet somewhere along them, or two edges cross."""
    obs = [add_surface(cut_back(patch_points(i), *beyond[i]), "ABC"[i], order=(2, 2), resolution=16) for i in range(3)]
    new = run(obs)
    corners = [np.array(new.data.vertices[v].co) for v in border(new)]
    for corner in CORNERS:
        assert min(np.linalg.norm(corner - p) for p in corners) < 1e-6
    surfaces = np.vstack([drawn(ob)[0] for ob in obs])
    gaps = np.array([np.linalg.norm(surfaces - p, axis=1).min() for p in corners])
    assert np.count_nonzero(gaps > 1e-6 * np.ptp(surfaces, axis=0).max()) <= 3, "only a corner may lie between drawn points"
    assert len(corners) > 3 * 16


def add_mesh(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(vertices).tolist(), [], faces)
    mesh.update()
    ob = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(ob)
    return ob


def select_edges(ob, of):
    """Selects the edges whose two ends are `of` so."""
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bm.select_mode = {"EDGE"}
    for e in bm.edges:
        e.select_set(all(of(v.co) for v in e.verts))
    bm.to_mesh(ob.data)
    bm.free()


def as_mesh(ob):
    """The mesh that Blender draws of a surface, in its place."""
    mesh = bpy.data.meshes.new_from_object(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    new = bpy.data.objects.new(ob.name, mesh)
    new.matrix_world = ob.matrix_world
    bpy.data.objects.remove(ob)
    bpy.context.collection.objects.link(new)
    new.name = mesh.name
    bpy.context.view_layer.update()
    return new


@pytest.mark.parametrize("meshes", ["A", "BC", "ABC"])
def test_any_mix_with_meshes(meshes):
    obs = three(resolution=8)
    obs = [as_mesh(ob) if ob.name in meshes else ob for ob in obs]
    new = run(obs)
    check(obs, new)
    assert len(border(new)) == sum(8 * n - 1 for n in (4, 4, 4))


def test_a_mirrored_mesh():
    obs = three(resolution=8)
    mesh = as_mesh(obs[1])
    mesh.data.transform(Matrix.Diagonal((-1, 1, 1, 1)))
    mesh.matrix_world = Matrix.Diagonal((-1, 1, 1, 1))
    bpy.context.view_layer.update()
    obs = [obs[0], mesh, obs[2]]
    new = run(obs)
    points = drawn(mesh)[0]
    mine = np.array([new.data.vertices[v].co for v in border(new)])
    assert np.count_nonzero(np.linalg.norm(mine[:, None] - points, axis=2).min(axis=1) < 1e-6) == 8 * 4


def l_shape(n=8):
    """A bent sheet over the square from 0 to 2 without that from 0 to 1."""
    side = np.linspace(0, 2, n + 1)
    vertices = [(x, y, 0.1 * x * y) for x in side for y in side]
    quads = [
        [i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1]
        for i in range(n)
        for j in range(n)
    ]
    kept = [f for f in quads if max(min(vertices[v][k] for v in f) for k in (0, 1)) > 0.99]
    used = sorted({v for f in kept for v in f})
    return [vertices[v] for v in used], [[used.index(v) for v in f] for f in kept]


def ruled(start, end, out):
    """Points of a surface (cubic, quadratic) whose edge v = 0 runs from start to end and which goes `out` from there."""
    start, end, out = (np.asarray(p, float) for p in (start, end, out))
    return np.array([[start + u * (end - start) + v * out for v in (0, 0.5, 1)] for u in np.linspace(0, 1, 4)])


def strip():
    return ruled((0, 1, 0), (1, 0, 0), (-0.5, -0.5, 0.1))


@pytest.mark.parametrize("both_meshes", [False, True])
def test_two_sides_of_one_mesh(both_meshes):
    sheet = add_mesh("Sheet", *l_shape())
    other = add_surface(strip(), "Strip", order=(4, 3))
    if both_meshes:
        other = as_mesh(other)
    new = run([sheet, other])
    points = np.vstack([drawn(sheet)[0], drawn(other)[0]])
    mine = np.array([new.data.vertices[v].co for v in border(new)])
    assert np.linalg.norm(mine[:, None] - points, axis=2).min(axis=1).max() < 1e-6 * np.ptp(points, axis=0).max()
    for corner in ((0, 1, 0), (1, 0, 0), (1, 1, 0.1)):
        assert np.linalg.norm(mine - corner, axis=1).min() < 1e-6
    assert len(mine) == 4 + 4 + 15


def test_selected_edges_of_a_mesh_count():
    """The sheet's inner border is selected; without the half of it towards the strip's end there is no hole."""
    sheet = add_mesh("Sheet", *l_shape())
    other = add_surface(strip(), "Strip", order=(4, 3))
    select_edges(sheet, lambda p: max(p.x, p.y) < 1 + 1e-6)
    assert len(border(run([sheet, other]))) == 4 + 4 + 15
    select_edges(sheet, lambda p: max(p.x, p.y) < 1 + 1e-6 and (p.x < 0.6 or p.y > 0.9))
    refused([sheet, other], "Sheet and Strip do not meet|Strip and Sheet do not meet|enclose no hole")


def test_a_modifier_of_a_mesh_counts():
    """The border is that of the evaluated mesh."""
    vertices, faces = l_shape()
    sheet = add_mesh("Sheet", [(x, y - 5, z) for x, y, z in vertices], faces)
    move = sheet.modifiers.new("Move", "DISPLACE")
    move.direction, move.strength, move.mid_level = "Y", 5, 0
    new = run([sheet, add_surface(strip(), "Strip", order=(4, 3))])
    assert len(border(new)) == 4 + 4 + 15


@pytest.mark.parametrize("turn", [0.0, 2.0, 6.0])
def test_a_piece_of_a_cyclic_surface(turn):
    """A tube that is cyclic in one direction: a piece of its closed edge is a side, also across the place where it starts."""
    angle = np.arange(8) * np.pi / 4 + turn
    points = np.stack([np.stack([np.cos(angle), np.sin(angle), np.full(8, z)], axis=1) for z in (-1.0, -0.5, 0.0)], axis=1)
    tube = add_surface(points, "Tube", order=(4, 3), endpoint=False, cyclic=True, resolution=8)
    spline = tube.data.splines[0]
    spline.use_endpoint_u, spline.use_endpoint_v = not spline.use_cyclic_u, not spline.use_cyclic_v
    bpy.context.view_layer.update()
    rim = drawn(tube)[0]
    rim = rim[np.abs(rim[:, 2]) < 1e-6]
    assert len(rim) == 64
    start, end = (rim[np.argmin(np.linalg.norm(rim - (np.cos(x), np.sin(x), 0), axis=1))] for x in (-0.5, 0.5))
    tip = np.array((2.0, 0, 0))
    others = [
        add_surface(ruled(end, tip, (0, 0.5, 0.2)), "B", order=(4, 3)),
        add_surface(ruled(tip, start, (0, -0.5, 0.2)), "C", order=(4, 3)),
    ]
    new = run([tube, *others])
    mine = np.array([new.data.vertices[v].co for v in border(new)])
    every = np.vstack([drawn(ob)[0] for ob in [tube, *others]])
    assert np.linalg.norm(mine[:, None] - every, axis=2).min(axis=1).max() < 1e-6 * np.ptp(every, axis=0).max()
    assert np.count_nonzero(np.linalg.norm(mine[:, None] - rim, axis=2).min(axis=1) < 1e-5) > 8


def test_two_tubes_are_joined_by_a_ring(addon):
    """Both are cyclic in one direction, and bend around a quarter of a torus from one to the other."""

    def tube(name, ends):
        angle = np.arange(12) * np.pi / 6
        rings = [middle + 0.5 * (np.cos(angle)[:, None] * up + np.sin(angle)[:, None] * (0, 1, 0)) for middle, up in ends]
        made = add_surface(np.stack(rings, axis=1), name, order=(4, 2), endpoint=False, cyclic=True, resolution=4)
        spline = made.data.splines[0]
        spline.use_endpoint_u, spline.use_endpoint_v = not spline.use_cyclic_u, not spline.use_cyclic_v
        return made

    low = [(np.array([x, 0, 0]), np.array([0, 0, 1.0])) for x in (-1.0, -0.5, 0.0)]
    high = [(np.array([2, 0, 2 + z]), np.array([-1.0, 0, 0])) for z in (0.0, 0.5, 1.0)]
    first, second = tube("Low", low), tube("High", high)
    bpy.context.view_layer.update()
    new = run([first, second])
    points = np.array([v.co for v in new.data.vertices])
    off = np.hypot(np.hypot(points[:, 0], points[:, 2] - 2) - 2, points[:, 1])
    radius = off[len(off) // 2 :].mean()  # of B-splines less than that of their points
    assert abs(off - radius).max() < 0.02 * radius
    every = np.vstack([drawn(ob)[0] for ob in (first, second)])
    edge = points[border(new)]
    assert len(edge) == 2 * 48
    assert np.linalg.norm(edge[:, None] - every, axis=2).min(axis=1).max() < 1e-5


@pytest.mark.parametrize("n", [4, 6])
def test_four_surfaces_and_more(n):
    angle = 2 * np.pi * np.arange(n) / n
    corners = np.column_stack([np.cos(angle), np.sin(angle), 0.1 * np.cos(2 * angle)])
    u, v = np.meshgrid(np.linspace(0, 1, 4), np.linspace(0, 1, 4), indexing="ij")
    objects = []
    for i in range(n):
        a, b = corners[i], corners[(i + 1) % n]
        out = (a + b) / 2 + (0, 0, 0.2)
        rows = a + u[..., None] * (b - a) + v[..., None] * out
        objects.append(add_surface(rows, name=f"Side {i}"))
    for ob in objects:
        ob.select_set(True)
    assert fill() == {"FINISHED"}
    made = bpy.context.active_object.data
    points = np.array([vertex.co for vertex in made.vertices])
    border = [e for e in made.edges if sum(set(e.vertices) <= set(p.vertices) for p in made.polygons) == 1]
    assert len(border) % n == 0 and len(made.vertices) - len(made.edges) + len(made.polygons) == 1
    for corner in corners:
        assert np.linalg.norm(points - corner, axis=1).min() < 1e-6
