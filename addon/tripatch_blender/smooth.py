# SPDX-License-Identifier: GPL-3.0-or-later
"""mesh.smooth_triangles: selected triangles become a smooth surface. All is computed first, so that refusals change nothing."""

from __future__ import annotations

from dataclasses import dataclass, field

import bmesh
import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty

from . import attributes, filling, layers, library, normals, selection, sentences, writeback
from .library import np, tripatch
from .selection import UnusableError

# Of a triangle's area over its longest edge squared, below which it has none, as the library asks.
_MIN_AREA = 1e-12


def _unit(vectors):
    """Vectors (k, 3) at length 1; those that have none, or cancelled, are zero."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(length > 0, vectors / np.where(length > 0, length, 1), 0)


def _vertex_normals(faces, positions, given):
    """(n, 3) unit normals of the vertices of these faces. given: {face corner: normal} where the faces' own are not taken."""
    corners = [corner for f in faces for corner in f.loops]
    at_corners = np.array([given.get(corner, (0.0, 0.0, 0.0)) for corner in corners]) if given else None
    return tripatch.vertex_normals(positions, [[v.index for v in f.verts] for f in faces], at_corners)


@dataclass
class _Planned:
    """Smoothed triangles that are ready to be written: nothing in the BMesh has changed yet."""

    bm: bmesh.types.BMesh
    mesh: bpy.types.Mesh
    faces: list  # BMFace by triangle
    corners: list  # their face corners: all three, or of a face with more, which is cut
    triangles: list  # their vertices' indices
    smooth: object  # tripatch.SmoothMesh in world space, in the vertex numbers of the BMesh
    positions: np.ndarray  # (k, 3) of the new vertices in object space
    normals: np.ndarray  # (n + k, 3) of all vertices in object space
    weights: object  # tripatch.CutWeights
    custom: dict | None  # {face corner: normal} of the corners whose normals the change would turn
    in_shape_keys: dict = field(default_factory=dict)  # name: (k, 3)
    notes: list = field(default_factory=list)


def _triangles(bm):
    """The selected faces as triangles, as Blender draws those with more corners: the corners of each, by face."""
    found = [tuple(f.loops) for f in bm.faces if f.select and len(f.verts) == 3]
    if any(f.select and len(f.verts) > 3 for f in bm.faces):
        found += [corners for corners in bm.calc_loop_triangles() if corners[0].face.select and len(corners[0].face.verts) > 3]
    return sorted(found, key=lambda corners: corners[0].face.index)


def _check_backs(bm, faces, corners):
    """Two triangles between the same three vertices would be cut into some that are one."""
    first: dict = {}
    for face, three in zip(faces, corners, strict=True):
        verts = [corner.vert for corner in three]
        other = first.setdefault(frozenset(verts), face)
        there = bm.faces.get(verts) if len(face.verts) > 3 else None
        if other != face or there is not None:
            raise UnusableError("faces_doubled", first=(there or other).index, second=face.index)


def _check_positions(faces, triangles, positions):
    """The library sees no neighbors, and would number the selected faces only."""
    if not np.isfinite(positions).all():
        where = [int(np.argmin(np.isfinite(positions).all(axis=1)))]
        raise UnusableError.of(tripatch.Message("position_not_finite", {}, where))
    a, b, c = positions[triangles].transpose(1, 0, 2)
    longest = np.max([((b - a) ** 2).sum(axis=1), ((c - b) ** 2).sum(axis=1), ((a - c) ** 2).sum(axis=1)], axis=0)
    flat = np.linalg.norm(np.cross(b - a, c - a), axis=1) <= _MIN_AREA * longest
    if flat.any():
        raise UnusableError("face_without_area", face=faces[int(np.argmax(flat))].index)


def plan(ob, bm, resolution, curve):
    """What becomes of the selected faces of a BMesh with the mesh of an object, or None where none is selected. UnusableError."""
    mesh = ob.data
    bm.verts.index_update()
    bm.faces.index_update()
    loops = _triangles(bm)
    faces, triangles = [three[0].face for three in loops], [[corner.vert.index for corner in three] for three in loops]
    if not faces:
        return None
    world = filling.world_matrix(ob.name, ob.matrix_world)
    linear, inverse = world[:3, :3], np.linalg.inv(world[:3, :3])
    outer = np.sign(np.linalg.det(linear))
    around = selection.by_index({f for face in {*faces} for v in face.verts for f in v.link_faces})
    near = list({v for f in around for v in f.verts})
    count = len(bm.verts)

    def smoothed(shape, given):
        positions = np.zeros((count, 3))
        positions[[v.index for v in near]] = selection.coordinates(near, shape) @ linear.T + world[:3, 3]
        _check_positions(faces, triangles, positions)
        # A mirrored object's faces are turned in the world.
        at_vertices = outer * _vertex_normals(around, positions, {corner: outer * n for corner, n in given.items()})
        return tripatch.smooth_triangles(positions, triangles, at_vertices, resolution, curve)

    def to_object(smooth):
        return (smooth.vertices[count:] - world[:3, 3]) @ inverse.T

    custom, given = None, {}
    if normals.has_custom_normals(bm, mesh):
        changed = {f for face in {*faces} for e in face.edges for f in e.link_faces}
        custom = normals.corner_normals(bm, mesh, {v for f in changed for v in f.verts})
        given = dict(zip(custom, _unit(np.array(list(custom.values())) @ inverse), strict=True))
    try:
        smooth = smoothed(None, given)
    except tripatch.Refusal as refusal:
        raise UnusableError.of(refusal.said) from None
    _check_backs(bm, faces, loops)
    weights = tripatch.CutWeights(smooth, triangles, count)
    at_all = _unit(smooth.normals @ linear)
    planned = _Planned(bm, mesh, faces, loops, triangles, smooth, to_object(smooth), at_all, weights, custom)

    active = ob.active_shape_key
    for name, layer in bm.verts.layers.shape.items():
        if active and name == active.name:
            continue
        try:
            planned.in_shape_keys[name] = to_object(smoothed(layer, {}))
        except (tripatch.Refusal, UnusableError) as refusal:
            planned.notes.append(sentences.said("shape_key_not_smoothed", name=name, reason=refusal.said))
            moved = selection.coordinates(bm.verts, layer) - selection.coordinates(bm.verts)
            planned.in_shape_keys[name] = planned.positions + weights.at_new_vertices(moved, smooth.edges, triangles)
    return planned


def _cut(edge, start, end, points) -> list:
    """Cuts an edge of the BMesh at these points (k, 3) from vertex `start` to `end`; all its faces take the new vertices."""
    made = []
    for k, point in enumerate(points):
        other, vertex = bmesh.utils.edge_split(edge, made[-1] if made else start, 1 / (len(points) + 1 - k))
        vertex.co = point
        made.append(vertex)
        if end not in edge.verts:
            edge = other
    return made


def _neighbor_normals(custom, faces, start, end, edge, exact, weights):
    """{unselected face at an edge: normals (k, 3) of its corners at the points that will cut the edge}. A face whose corners have
    the normals `exact` at `start` and `end` shares them between too."""
    found = {}
    for corner in edge.link_loops:
        if corner.face in faces:
            continue
        ends = [custom[corner], custom[corner.link_loop_next]]
        if corner.vert is not start:
            ends.reverse()
        smooth = all(n @ exact[v.index] > writeback.SAME_NORMAL for n, v in zip(ends, (start, end), strict=True))
        found[corner.face] = None if smooth else _unit(weights @ np.array(ends))
    return found


def _cut_faces(planned):
    """Cuts the faces that have more corners than three into their triangles. Returns all triangles."""
    made, cut = [], []
    for face, corners in zip(planned.faces, planned.corners, strict=True):
        if len(face.verts) == 3:
            made.append(face)
            continue
        made.append(planned.bm.faces.new([corner.vert for corner in corners], face))
        made[-1].smooth = face.smooth
        for new, old in zip(list(made[-1].loops), corners, strict=True):
            new.copy_from(old)
        cut.append(face)
    if planned.custom is not None:
        gone = set(cut)
        planned.custom = {corner: normal for corner, normal in planned.custom.items() if corner.face not in gone}
    for face in dict.fromkeys(cut):
        planned.bm.faces.remove(face)
    return made


def write(planned):
    """Puts the smoothed triangles into the BMesh in place of the flat ones. Returns the new faces."""
    bm, faces, weights, custom = planned.bm, _cut_faces(planned), planned.weights, planned.custom
    old, gone, cuts = list(bm.verts), set(faces), len(weights.edge)
    ends = [corner for f in faces for corner in f.loops]
    if custom is not None:
        custom = {corner: normal for corner, normal in custom.items() if corner.face not in gone}
    points = planned.positions.tolist()
    vertices = list(old)
    for a, b in planned.smooth.edges.tolist():
        start, end = old[a], old[b]
        edge, first = bm.edges.get((start, end)), len(vertices)
        adjacent: dict = {}
        if custom is not None:
            adjacent = _neighbor_normals(custom, gone, start, end, edge, planned.normals, weights.edge)
        made = _cut(edge, start, end, points[first - len(old) : first - len(old) + cuts])
        attributes.blend_vertices(bm, [start, end], made, lambda values: weights.edge @ values)
        vertices += made
        for k, vertex in enumerate(made if adjacent else []):
            for corner in vertex.link_loops:
                if corner.face in adjacent:
                    own = adjacent[corner.face]
                    custom[corner] = planned.normals[first + k] if own is None else own[k]
    for corners in planned.triangles:
        first = len(vertices) - len(old)
        # A vertex made without an example would pass for the first of the mesh in shape keys.
        made = [bm.verts.new(co, old[corners[0]]) for co in points[first : first + len(weights.inside)]]
        attributes.blend_vertices(bm, [old[v] for v in corners], made, lambda values: weights.inside @ values)
        vertices += made
    for name, layer in bm.verts.layers.shape.items():
        for vertex, co in zip(vertices[len(old) :], planned.in_shape_keys.get(name, planned.positions).tolist(), strict=True):
            vertex[layer] = co

    new_faces, rows = [], planned.smooth.faces.tolist()
    for k, row in enumerate(rows):
        model = faces[k * len(faces) // len(rows)]
        made = bm.faces.new([vertices[v] for v in row], model)
        made.smooth, made.hide = model.smooth, False
        new_faces.append(made)
    corners = [corner for f in new_faces for corner in f.loops]
    attributes.blend_corners(bm, ends, [(corner, k, ()) for k, corner in enumerate(corners)], weights, weights.nearest)
    for face in faces:
        bm.faces.remove(face)
    if custom is not None:
        bm.normal_update()
        at = planned.smooth.faces.ravel().tolist()
        for corner, v in zip(corners, at, strict=True):
            custom[corner] = planned.normals[v] if corner.face.smooth else np.array(corner.face.normal)
        normals.set_corner_normals(bm, planned.mesh, custom)
    return new_faces


def chosen(bm):
    """The selected faces of a BMesh as lists of vertices by number; None: all."""
    faces = [[v.index for v in f.verts] for f in bm.faces if f.select]
    return None if len(faces) == len(bm.faces) else faces


def smooth_copy(ob, bm, faces, resolution, curve):
    """Smooths faces of a copy of the mesh of an object. faces: as of `chosen`. Returns the new faces; UnusableError."""
    found = list(bm.faces)
    if faces is not None:
        count = len(bm.verts)
        found = [bm.faces.get([bm.verts[v] for v in face]) if max(face) < count else None for face in faces]
    if not found or None in found:
        raise UnusableError("smoothed_faces_gone")
    for face in bm.faces:
        face.hide = face.select = False
    for face in found:
        face.select = True
    return write(plan(ob, bm, resolution, curve))


class MESH_OT_smooth_triangles(bpy.types.Operator):
    bl_idname = "mesh.smooth_triangles"
    bl_label, bl_description = library.titled("smooth_triangles")
    bl_options = {"REGISTER", "UNDO"}

    resolution: IntProperty(**library.named("edge_parts"), min=2, max=256, soft_max=32, default=3)
    curve: EnumProperty(
        **library.named("curve"),
        items=library.items("curve", "hermite", "smits"),
        default="hermite",
    )
    keep_live: BoolProperty(**library.named("keep_live"), default=False)

    @classmethod
    def poll(cls, context):
        return library.poll(cls, context, "EDIT_MESH", "needs_edit_mode")

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "resolution")
        layout.prop(self, "curve")
        layout.prop(self, "keep_live")

    def execute(self, context):
        if self.keep_live:
            return self._keep_live(context)
        with layers.standing_aside(context, context.objects_in_mode_unique_data):
            return self._execute(context)

    def _refuse(self, ob, objects, reason):
        said = str(reason)  # with the numbers of faces, which no selection shows here
        self.report({"ERROR"}, sentences.said("of_object", name=ob.name, reason=said) if len(objects) > 1 else said)
        return {"CANCELLED"}

    def _keep_live(self, context):
        from . import following, live  # they use what is above

        objects, made = context.objects_in_mode_unique_data, []
        for ob in objects:
            bm = bmesh.from_edit_mesh(ob.data)
            bm.verts.index_update()
            faces = chosen(bm)
            if faces == []:
                continue
            try:
                made.append(live.keep_smooth(ob, faces, self.resolution, self.curve))
            except (UnusableError, tripatch.Refusal) as reason:
                for other in made:
                    bpy.data.meshes.remove(other.data)  # and the object with it
                return self._refuse(ob, objects, reason)
        if not made:
            return self._refuse_nothing()
        for each in made:
            following.begin(each)
        self.report({"INFO"}, sentences.said("smoothed_into", names=[each.name for each in made]))
        return {"FINISHED"}

    def _refuse_nothing(self):
        self.report({"ERROR"}, sentences.said("no_face_selected"))
        return {"CANCELLED"}

    def _execute(self, context):
        objects = context.objects_in_mode_unique_data
        plans = {}
        for ob in objects:
            try:
                planned = plan(ob, bmesh.from_edit_mesh(ob.data), self.resolution, self.curve)
            except UnusableError as reason:
                return self._refuse(ob, objects, reason)
            if planned:
                plans[ob] = planned
        if not plans:
            return self._refuse_nothing()
        before = after = 0
        for ob, planned in plans.items():
            selected = selection.Selected(planned.bm)
            count = len(set(planned.faces))
            new_faces = write(planned)
            selected.replace(planned.bm, new_faces)
            selection.finish_edit(planned.bm, ob.data)
            before, after = before + count, after + len(new_faces)
        notes = [note for planned in plans.values() for note in planned.notes]
        message = sentences.said("faces_smoothed", count=before, triangles=after)
        self.report({"WARNING" if notes else "INFO"}, ". ".join([message, *notes[:2]]))
        return {"FINISHED"}


def register():
    bpy.utils.register_class(MESH_OT_smooth_triangles)


def unregister():
    bpy.utils.unregister_class(MESH_OT_smooth_triangles)
