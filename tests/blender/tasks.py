"""What a modeller fills, made by Blender's own primitives and tools where they serve. Every function leaves an object in edit
mode with a selection, ready to be filled, and returns a Task."""

from dataclasses import dataclass, field
from math import cos, sin

import bmesh
import bpy
import numpy as np
import scenes
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree


@dataclass
class Task:
    """A hole, and what a good fill of it is."""

    ob: object
    far: object  # far(points (k, 3)) -> distances (k,) to the surface that was there, or that anyone would expect
    size: float  # of the hole
    within: float = 0.02  # of the size: the fill is nowhere farther off
    bend: float = 45.0  # degrees between two faces of the fill, or one of it and one next to it, at most
    left: int = 0  # border edges that stay
    crossed: int = 0  # faces of a cage that cross themselves, at most
    options: dict = field(default_factory=dict)


def _mesh_of(bm, name="Task", smooth=True):
    mesh = bpy.data.meshes.new(name)
    bm.to_mesh(mesh)
    bm.free()
    return scenes.object_of(mesh, smooth)


def distance_to(bm):
    """Of points to the surface of a BMesh as it is now."""
    tree = BVHTree.FromBMesh(bm)
    return lambda points: np.array([tree.find_nearest(Vector(p))[3] for p in points])


def rings(vertex, count):
    """The faces within so many rings of faces round a vertex, and their vertices."""
    near, faces = {vertex}, set()
    for _ in range(count):
        faces |= {f for v in near for f in v.link_faces}
        near = {v for f in faces for v in f.verts}
    return faces, near


def _width(faces):
    points = np.array([v.co for f in faces for v in f.verts])
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def open_up(bm, gone, far=None, delete=True, outer=0, **values):
    """Deletes faces and selects the rim, or selects the faces."""
    far, size = far or distance_to(bm), _width(gone)
    rim = {tuple(v.co) for f in gone for v in f.verts if any(other not in gone for other in v.link_faces)}
    places = {tuple(f.calc_center_median()) for f in gone}
    if delete:
        bmesh.ops.delete(bm, geom=list(gone), context="FACES")
    ob = _mesh_of(bm)
    (bm,) = scenes.edit(ob, mode="EDGE" if delete else "FACE")
    if delete:
        scenes.select(bm, edges=[e for e in bm.edges if e.is_boundary and all(tuple(v.co) in rim for v in e.verts)])
    else:
        scenes.select(bm, faces=[f for f in bm.faces if tuple(f.calc_center_median()) in places])
    return Task(ob, far, size, left=outer, **values)


def sphere_distance(points):
    return np.abs(np.linalg.norm(np.asarray(points), axis=1) - 1)


def _icosphere(subdivisions):
    bm = bmesh.new()
    bmesh.ops.create_icosphere(bm, subdivisions=subdivisions, radius=1)
    bm.verts.ensure_lookup_table()
    return bm


def _bevelled(weights, segments, width=0.8):
    """A cube whose three edges at (1, 1, 1) are bevelled by a modifier, by weights."""
    bm = bmesh.new()
    bmesh.ops.create_cube(bm, size=2)
    corner = max(bm.verts, key=lambda v: sum(v.co))
    own = bm.edges.layers.bevel_weight.verify() if hasattr(bm.edges.layers, "bevel_weight") else None
    layer = own or bm.edges.layers.float.new("bevel_weight_edge")
    ends = sorted(corner.link_edges, key=lambda e: tuple(e.other_vert(corner).co))
    for edge, weight in zip(ends, weights, strict=True):
        edge[layer] = weight
    ob = _mesh_of(bm)
    modifier = ob.modifiers.new("Bevel", "BEVEL")
    modifier.limit_method, modifier.width, modifier.segments = "WEIGHT", width, segments
    bpy.ops.object.modifier_apply(modifier="Bevel")
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bpy.data.objects.remove(ob)
    return bm


def _beyond(bm, low):
    """The faces that lie wholly where all coordinates are more than these."""
    return {f for f in bm.faces if all(v.co[i] > low[i] - 1e-4 for v in f.verts for i in range(3))}


def _ball(center, radius):
    return lambda points: np.abs(np.linalg.norm(np.asarray(points) - center, axis=1) - radius)


def equal_fillets():
    bm = _bevelled((1, 1, 1), 8)
    return open_up(bm, _beyond(bm, (0.2, 0.2, 0.2)), _ball(0.2 * np.ones(3), 0.8), within=0.01, bend=25)


def mixed_fillets():
    bm = _bevelled((1, 0.7, 0.5), 8)
    return open_up(bm, _beyond(bm, (0.2, 0.2, 0.2)), within=0.06, bend=25)


def mixed_fillets_but_tips():
    """The three quads that end in the flat sides stay."""
    bm = _bevelled((1, 0.7, 0.5), 8)
    gone = _beyond(bm, (0.2, 0.2, 0.2))
    gone = {f for f in gone if not any(abs(max(v.co) - 1) < 1e-4 for v in f.verts)}
    return open_up(bm, gone, within=0.06)


def replaced_corner():
    bm = _bevelled((1, 1, 1), 8)
    gone = _beyond(bm, (0.2, 0.2, 0.2))
    rng = np.random.default_rng(3)
    for v in {v for f in gone for v in f.verts if all(other in gone for other in v.link_faces)}:
        v.co *= 1 + rng.uniform(-0.15, 0)  # dented
    return open_up(bm, gone, _ball(0.2 * np.ones(3), 0.8), delete=False, within=0.01, bend=25)


def _sheet(height, count=30, size=2.0):
    bm = bmesh.new()
    bmesh.ops.create_grid(bm, x_segments=count, y_segments=count, size=size)
    for v in bm.verts:
        v.co.z = height(v.co.x, v.co.y)
    return bm


def _fender(**values):
    bm = _sheet(lambda x, y: 1.2 * np.exp(-3 * (y - 0.15 * x * x) ** 2) - 0.12 * x * x + 0.05 * x)
    gone = {f for f in bm.faces if abs(f.calc_center_median().x) < 0.5 and abs(f.calc_center_median().y) < 0.4}
    return open_up(bm, gone, outer=_border(bm), **values)


def fender():
    """The crown of a wheel arch: bent hard across, softly along, flaring outwards."""
    return _fender(within=0.04, options={"output": "triangles", "method": "polyharmonic_spline"})


def fender_of_quads():
    """The same, as it was: its quads bend by 50 degrees."""
    return _fender(within=0.004, bend=51)


def _border(bm):
    return sum(e.is_boundary for e in bm.edges)


def jagged():
    bm = _icosphere(5)
    rng = np.random.default_rng(1)
    top = max(bm.verts, key=lambda v: v.co.z)
    gone = {f for f in bm.faces if f.calc_center_median().angle(top.co) < 0.35 + 0.1 * rng.random()}
    # no vertex with two openings, no island
    gone = _one_hole(bm, gone)
    return open_up(bm, gone, sphere_distance, within=0.005, bend=20)


def _one_hole(bm, gone):
    """Faces that are taken out so that one hole is left whose rim passes no vertex twice."""
    gone = set(gone)
    while True:
        kept = max(_parts([f for f in bm.faces if f not in gone]), key=len)
        gone = {f for f in bm.faces if f not in kept}
        twice = [v for v in bm.verts if sum(sum(f in gone for f in e.link_faces) == 1 for e in v.link_edges) > 2]
        if not twice:
            return max(_parts(gone), key=len)
        gone |= {f for v in twice for f in v.link_faces}


def _parts(faces):
    left, parts = set(faces), []
    while left:
        part, stack = set(), [left.pop()]
        while stack:
            face = stack.pop()
            part.add(face)
            for other in {f for e in face.edges for f in e.link_faces} & left:
                left.discard(other)
                stack.append(other)
        parts.append(part)
    return parts


def pipe_junction():
    """Three half pipes and the walls between them below: a rim of six corners, and where the pipes would meet a hole."""
    bm = bmesh.new()
    n, rows, radius, start = 12, 6, 0.5, 1.4
    turn = [Vector((np.cos(a), np.sin(a), 0)) for a in np.arange(3) * 2 * np.pi / 3]
    up, angle = Vector((0, 0, 1)), np.linspace(0, np.pi, n + 1)
    for k, along in enumerate(turn):
        side = up.cross(along)
        for i in range(rows):
            for a, b in zip(angle[:-1], angle[1:], strict=True):
                places = [(i, a), (i + 1, a), (i + 1, b), (i, b)]
                corners = [along * (start + 0.13 * j) + radius * (cos(t) * side + sin(t) * up) for j, t in places]
                bm.faces.new([bm.verts.new(p) for p in corners])
        other = turn[(k + 1) % 3]
        a, b = along * start + radius * side, other * start - radius * up.cross(other)
        reach = 0.75 * (a - b).length
        t = np.linspace(0, 1, n + 1).tolist()
        curve = [
            (1 - s) ** 3 * a + 3 * (1 - s) ** 2 * s * (a - reach * along) + 3 * (1 - s) * s * s * (b - reach * other) + s**3 * b
            for s in t
        ]
        for i in range(rows):
            for p, q in zip(curve[:-1], curve[1:], strict=True):
                down, below = Vector((0, 0, -0.13 * i)), Vector((0, 0, -0.13 * (i + 1)))
                bm.faces.new([bm.verts.new(c) for c in (p + down, p + below, q + below, q + down)])
    bmesh.ops.remove_doubles(bm, verts=bm.verts, dist=1e-5)
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces)
    inner = [e for e in bm.edges if e.is_boundary and all(-1e-6 < v.co.z < 0.51 and v.co.xy.length < 1.52 for v in e.verts)]
    inner = [e for e in inner if all(v.co.xy.length < start + 0.09 and v.co.z > -1e-6 for v in e.verts)]
    places, left = {tuple(v.co) for e in inner for v in e.verts}, _border(bm) - len(inner)
    ob = _mesh_of(bm)
    (bm,) = scenes.edit(ob, mode="EDGE")
    scenes.select(bm, edges=[e for e in bm.edges if e.is_boundary and all(tuple(v.co) in places for v in e.verts)])

    def far(points):  # between the floor and a little above the pipes
        z = np.asarray(points)[:, 2]
        return np.maximum(np.maximum(-0.02 - z, z - 1.35 * radius), 0)

    return Task(ob, far, 3.0, within=0.01, left=left)


def four_corners():
    bm = _sheet(lambda x, y: 0.2 * x * x - 0.15 * y * y + 0.05 * x * y)
    gone = {f for f in bm.faces if max(map(abs, f.calc_center_median().xy)) < 0.6}
    return open_up(bm, gone, within=0.005, bend=15, outer=_border(bm))


def _of_icosphere(valence):
    bm = _icosphere(5)
    fives = [v.co for v in bm.verts if len(v.link_edges) == 5]
    middles = [v for v in bm.verts if len(v.link_edges) == valence]
    gone, _ = rings(max(middles, key=lambda v: min((v.co - co).length for co in fives if co != v.co)), 4)
    return open_up(bm, gone, sphere_distance, within=0.005, bend=20)


def five_corners():
    return _of_icosphere(5)


def six_corners():
    return _of_icosphere(6)


def round_rim():
    bm = bmesh.new()
    bmesh.ops.create_uvsphere(bm, u_segments=32, v_segments=24, radius=1)
    gone = {f for f in bm.faces if f.calc_center_median().z > 0.8}
    return open_up(bm, gone, sphere_distance, within=0.005, bend=20)


def low_poly():
    bm = _icosphere(2)
    gone, _ = rings(max(bm.verts, key=lambda v: v.co.x + 0.3 * v.co.z), 1)
    return open_up(bm, gone, sphere_distance, within=0.06, bend=50)


def scan():
    """Triangles of uneven size with noise, torn open."""
    bpy.ops.mesh.primitive_monkey_add()
    ob = bpy.context.object
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 2
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bpy.data.objects.remove(ob)
    bmesh.ops.triangulate(bm, faces=bm.faces)
    rng = np.random.default_rng(4)
    bm.normal_update()
    for v in bm.verts:
        v.co += Vector(rng.normal(size=3)) * 0.1 * np.mean([e.calc_length() for e in v.link_edges])
    bm.normal_update()
    crown = min(bm.verts, key=lambda v: (v.co - Vector((0.4, 0.1, 0.9))).length)
    gone = {f for f in bm.faces if (f.calc_center_median() - crown.co).length < 0.2 + 0.06 * rng.random()}
    return open_up(bm, max(_parts(gone), key=len), within=0.06, outer=_border(bm), bend=60)


def twenty_holes():
    bm = _icosphere(6)
    rng = np.random.default_rng(0)
    bm.verts.ensure_lookup_table()
    taken, gone, made = set(), set(), 0
    for k in rng.permutation(len(bm.verts)):
        _, guard = rings(bm.verts[k], 6)
        if made < 20 and not guard & taken:
            faces, _ = rings(bm.verts[k], 1 + made % 3)
            gone |= faces
            taken |= guard
            made += 1
    assert made == 20
    bmesh.ops.delete(bm, geom=list(gone), context="FACES")
    ob = _mesh_of(bm)
    scenes.edit(ob)
    return Task(ob, sphere_distance, 0.15, bend=20)


def evaluated(ob):
    """A BMesh of what the modifiers make."""
    bpy.context.view_layer.update()
    of = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    bm = bmesh.new()
    bm.from_mesh(of.to_mesh())
    of.to_mesh_clear()
    return bm


def under_subdivision(bm, gone, **values):
    """A cage with a hole, under a Subdivision modifier; the surface that it had is what is wanted."""
    whole = bpy.data.meshes.new("Whole")
    bm.to_mesh(whole)
    ob = bpy.data.objects.new("Whole", whole)
    bpy.context.collection.objects.link(ob)
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 3
    surface = evaluated(ob)
    far = distance_to(surface)
    surface.free()
    bpy.data.objects.remove(ob)
    task = open_up(bm, gone, far, **values)
    task.ob.modifiers.new("Subdivision", "SUBSURF").levels = 3
    return task


def _cage(segments):
    bm = _bevelled((1, 1, 1), segments)
    return under_subdivision(bm, _beyond(bm, (0.2, 0.2, 0.2)), within=0.06)


def cage_of_2_segments():
    return _cage(2)


def cage_of_3_segments():
    """Sides of an odd number of edges."""
    return _cage(3)


def cage_of_4_segments():
    return _cage(4)


def suzanne(levels=0):
    bpy.ops.mesh.primitive_monkey_add()
    ob = bpy.context.object
    if levels:
        ob.modifiers.new("Subdivision", "SUBSURF").levels = levels
        bpy.ops.object.modifier_apply(modifier="Subdivision")
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    mesh = ob.data
    bpy.data.objects.remove(ob)
    bpy.data.meshes.remove(mesh)
    bm.verts.ensure_lookup_table()
    return bm


def _pole(near, valence, count, within, crossed=0):
    bm = suzanne()
    middle = min((v for v in bm.verts if len(v.link_edges) == valence), key=lambda v: (v.co - Vector(near)).length)
    return under_subdivision(bm, rings(middle, count)[0], within=within, outer=_border(bm), crossed=crossed)


def pole_of_3_edges():
    """Three quads about it, as there were."""
    return _pole((0.33, -0.4, -0.91), 3, 1, 0.08)


def pole_of_5_edges():
    """Over the ear, of which its rim holds the root."""
    return _pole((0.5, 0.3, 0.6), 5, 1, 0.15, crossed=2)


def mirrored(x):
    """Half a sheet under a Mirror modifier, with a hole round (x, 0)."""
    bm = _sheet(lambda x, y: 0.4 * np.cos(0.8 * x) * np.cos(0.6 * y) + 0.1 * y)
    far = distance_to(bm)
    bmesh.ops.delete(bm, geom=[f for f in bm.faces if f.calc_center_median().x < 0], context="FACES")
    gone = {f for f in bm.faces if (f.calc_center_median().xy - Vector((x, 0))).length < 0.5}
    task = open_up(bm, gone, far, within=0.005, bend=15)
    task.ob.modifiers.new("Mirror", "MIRROR")
    (bm,) = [bmesh.from_edit_mesh(task.ob.data)]
    bpy.ops.mesh.select_all(action="DESELECT")
    scenes.select(
        bm,
        edges=[
            e
            for e in bm.edges
            if e.is_boundary
            and all((v.co.xy - Vector((x, 0))).length < 0.8 for v in e.verts)
            and not all(abs(v.co.x) < 1e-6 for v in e.verts)
        ],
    )
    return task


def on_the_mirror_plane():
    return mirrored(0.0)


def off_the_mirror_plane():
    return mirrored(1.0)


def crease():
    """A roof; its ridge runs through the hole."""
    bm = _sheet(lambda x, y: -0.6 * abs(y), count=24)
    gone = {f for f in bm.faces if f.calc_center_median().xy.length < 0.6}
    return open_up(bm, gone, within=0.01, bend=65, outer=_border(bm))


def tube_side():
    """A window in the side of a pipe."""
    bm = bmesh.new()
    bmesh.ops.create_cone(bm, cap_ends=False, segments=48, radius1=1, radius2=1, depth=4)
    long = [e for e in bm.edges if abs(e.verts[0].co.z - e.verts[1].co.z) > 1]
    bmesh.ops.subdivide_edges(bm, edges=long, cuts=24)
    gone = {f for f in bm.faces if f.calc_center_median().x > 0.75 and abs(f.calc_center_median().z) < 0.8}

    def far(points):
        return np.abs(np.linalg.norm(np.asarray(points)[:, :2], axis=1) - 1)

    return open_up(bm, gone, far, within=0.01, bend=20, outer=_border(bm))


def character():
    """A rigged body with a shape key, its neck open."""
    bm = bmesh.new()
    bmesh.ops.create_uvsphere(bm, u_segments=24, v_segments=16, radius=1, matrix=Matrix.Diagonal((0.8, 0.6, 1.2, 1)))
    far = distance_to(bm)
    gone = {f for f in bm.faces if f.calc_center_median().z > 0.95}
    task = open_up(bm, gone, far, within=0.03, bend=40)
    bpy.ops.object.mode_set(mode="OBJECT")
    ob = task.ob
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Wide")
    for point in key.data:
        point.co.x *= 1.5
    group = ob.vertex_groups.new(name="Head")
    group.add(list(range(len(ob.data.vertices))), 0.5, "REPLACE")
    bones = bpy.data.objects.new("Bones", bpy.data.armatures.new("Bones"))
    bpy.context.collection.objects.link(bones)
    ob.modifiers.new("Armature", "ARMATURE").object = bones
    bpy.ops.object.mode_set(mode="EDIT")
    return task


def quads():
    """A square hole filled with quads."""
    task = four_corners()
    task.options = {"output": "quads"}
    return task


#: All that work on one mesh; another, three NURBS surfaces, is object.fill_between_patches.
ALL = [
    equal_fillets,
    mixed_fillets,
    mixed_fillets_but_tips,
    replaced_corner,
    fender,
    fender_of_quads,
    jagged,
    pipe_junction,
    four_corners,
    five_corners,
    six_corners,
    round_rim,
    low_poly,
    scan,
    twenty_holes,
    cage_of_2_segments,
    cage_of_3_segments,
    cage_of_4_segments,
    pole_of_3_edges,
    pole_of_5_edges,
    on_the_mirror_plane,
    off_the_mirror_plane,
    crease,
    tube_side,
    character,
    quads,
]
