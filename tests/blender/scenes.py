"""Meshes with three-sided holes that the tests build: a triangular lattice with a triangle cut out, bent into space."""

import bmesh
import bpy
import numpy as np


def lattice_parts(size=12, holes=((3, 3, 4),)):
    """Points (n, 2) of a triangular lattice with `size` edges a side, 1 long in all, its triangles outside and those inside
    of triangular holes, counter-clockwise. holes: (i, j, edges a side), the first corner at lattice point (i, j)."""
    number = {(i, j): k for k, (i, j) in enumerate((i, j) for j in range(size + 1) for i in range(size + 1 - j))}
    points = np.array([(i + j / 2, j * np.sqrt(3) / 2) for i, j in number])
    outside, inside = [], []
    for i, j in number:
        for face in ([(i, j), (i + 1, j), (i, j + 1)], [(i + 1, j), (i + 1, j + 1), (i, j + 1)]):
            if all(corner in number for corner in face):
                in_hole = any(all(a >= x and b >= y and a + b <= x + y + edges for a, b in face) for x, y, edges in holes)
                (inside if in_hole else outside).append([number[corner] for corner in face])
    return (points - points.mean(axis=0)) / size, outside, inside


def lattice(**size):
    """The points and triangles outside, without the vertices that only the holes have."""
    points, faces, _ = lattice_parts(**size)
    used = sorted({v for f in faces for v in f})
    new = {v: k for k, v in enumerate(used)}
    return points[used], [[new[v] for v in f] for f in faces]


def square_hole():
    """A sheet of quads with a hole of four corners."""
    n, faces = 10, []
    points = np.array([(i, j) for j in range(n) for i in range(n)]) / n - 0.45
    for j in range(n - 1):
        for i in range(n - 1):
            if not (3 <= i < 6 and 3 <= j < 6):
                faces.append([j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i])
    used = sorted({v for f in faces for v in f})
    new = {v: k for k, v in enumerate(used)}
    return bowl(points[used]), [[new[v] for v in f] for f in faces]


def ring(count=24):
    """A cone of quads between a circle and a smaller one, which is the rim of a round hole and comes first."""
    angle = np.arange(count) * 2 * np.pi / count
    circle = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    following = [(k + 1) % count for k in range(count)]
    faces = [[k, count + k, count + following[k], following[k]] for k in range(count)]
    return np.vstack([0.5 * circle + [0, 0, 0.3], circle]), faces


def ball_with_hole(n=5):
    """A ball in eight triangles of n^2 each, one of them missing."""
    grid = [(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]
    at = {place: k for k, place in enumerate(grid)}
    upright = [[(i, j, k), (i - 1, j + 1, k), (i - 1, j, k + 1)] for i, j, k in grid if i]
    between = [[(i, j, k), (i - 1, j, k + 1), (i, j - 1, k + 1)] for i, j, k in grid if i and j]
    triangles = np.array([[at[place] for place in f] for f in upright + between])
    points, faces = [], []
    for octant in range(1, 8):
        signs = np.where([octant & 1, octant & 2, octant & 4], -1, 1)
        faces += (triangles[:, :: int(signs.prod())] + len(grid) * (octant - 1)).tolist()
        points.append(np.array(grid) * signs)
    places, new = np.unique(np.vstack(points), axis=0, return_inverse=True)
    return places / np.linalg.norm(places, axis=1, keepdims=True), np.ravel(new)[faces].tolist()


def bowl(points):
    """A paraboloid over the plane."""
    return np.column_stack([points, 0.6 * (points**2).sum(axis=1)])


def flat(points):
    return np.column_stack([points, 0 * points[:, 0]])


def object_of(mesh, smooth=True):
    """The active object, alone selected, in object mode."""
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    mesh.update()
    ob = bpy.data.objects.new(mesh.name, mesh)
    bpy.context.collection.objects.link(ob)
    bpy.ops.object.select_all(action="DESELECT")
    ob.select_set(True)
    bpy.context.view_layer.objects.active = ob
    return ob


def add_mesh(vertices, faces, name="Hole", smooth=True):
    """A new active object in object mode."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(vertices).tolist(), [], [list(f) for f in faces])
    return object_of(mesh, smooth)


def add_hole(shape=bowl, **size):
    points, faces = lattice(**size)
    return add_mesh(shape(points), faces)


def edit(*objects, mode="VERT"):
    """Edit mode with nothing selected."""
    bpy.ops.object.select_all(action="DESELECT")
    for ob in objects:
        ob.select_set(True)
        bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type=mode)
    bpy.ops.mesh.select_all(action="DESELECT")
    return [bmesh.from_edit_mesh(ob.data) for ob in objects]


def border_loops(bm):
    """Border loops as lists of vertices, the shortest first, each from its lowest vertex towards the lower neighbor."""
    bm.verts.index_update()
    bm.verts.ensure_lookup_table()
    left, loops = {tuple(sorted(v.index for v in e.verts)) for e in bm.edges if e.is_boundary}, []
    while left:
        loop = list(min(left))
        left.discard(tuple(loop))
        while True:
            ahead = sorted(e for e in left if loop[-1] in e)
            if not ahead:
                break
            left.discard(ahead[0])
            loop.append(sum(ahead[0]) - loop[-1])
        loops.append([bm.verts[k] for k in loop[:-1]])
    return sorted(loops, key=len)


def is_rim(ob):
    """For each vertex of a mesh in object mode whether it is on its shortest border loop."""
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    rim = {v.index for v in border_loops(bm)[0]}
    bm.free()
    return [v.index in rim for v in ob.data.vertices]


def select(bm, vertices=(), edges=(), faces=()):
    for element in (*vertices, *edges, *faces):
        element.select = True
    bm.select_flush_mode()


def select_rim(bm, loop):
    select(bm, edges=[bm.edges.get((a, b)) for a, b in zip(loop, loop[1:] + loop[:1], strict=True)])


def arrays(ob):
    """Everything of a mesh that an undo must bring back, as bytes. The object must be in object mode."""
    mesh, state = ob.data, {}
    for attribute in mesh.attributes:
        if attribute.domain in {"POINT", "EDGE", "FACE", "CORNER"} and not attribute.name.startswith("."):
            # numbers, not vectors: the rows of a matrix continue reading its memory
            state[attribute.name] = [
                np.ravel(getattr(d, _field(d))).tolist() if _long(d) else getattr(d, _field(d)) for d in attribute.data
            ]
    state["vertices"] = np.array([v.co for v in mesh.vertices], np.float32).tobytes()
    state["edges"] = [tuple(e.vertices) for e in mesh.edges]
    state["faces"] = [(tuple(p.vertices), p.material_index, p.use_smooth, p.select) for p in mesh.polygons]
    state["selection"] = [v.select for v in mesh.vertices], [e.select for e in mesh.edges]
    if mesh.shape_keys:
        keys = mesh.shape_keys.key_blocks
        state["shapes"] = {k.name: np.array([d.co for d in k.data], np.float32).tobytes() for k in keys}
    state["normals"] = corner_normals(mesh).tobytes()
    return state


def state(name):
    """What `arrays` says of an object in edit mode, by name: undo makes new objects."""
    bpy.ops.object.mode_set(mode="OBJECT")
    result = arrays(bpy.data.objects[name])
    bpy.ops.object.mode_set(mode="EDIT")
    return result


def undone_and_redone(name, step):
    """What `step` does in edit mode is undone to the last bit, and redone."""
    bpy.ops.ed.undo_push(message="before")
    before = state(name)
    bpy.ops.ed.undo_push(message="before")
    assert step() == {"FINISHED"}
    after = state(name)
    assert after != before
    bpy.ops.ed.undo()
    assert state(name) == before
    bpy.ops.ed.redo()
    assert state(name) == after


def _field(value):
    return next(name for name in ("vector", "color", "value") if hasattr(value, name))


def _long(value):
    return hasattr(getattr(value, _field(value)), "__len__")


def corner_normals(mesh):
    """(corners, 3)"""
    if hasattr(mesh, "corner_normals"):
        return np.array([n.vector for n in mesh.corner_normals], np.float32)
    mesh.calc_normals_split()
    return np.array([loop.normal for loop in mesh.loops], np.float32)


def checked(ob):
    """A BMesh copy of an object's mesh, after Blender found nothing wrong with it."""
    assert not ob.data.validate(verbose=True)
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    return bm
