# SPDX-License-Identifier: GPL-3.0-or-later
"""object.fill_between_patches: the hole between surface objects, whose edges are known exactly, and mesh objects."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty, StringProperty

from . import calls, filling, library, limit_objects, panel, properties, selection, sentences, waiting
from .construction import Construction
from .library import np, tripatch, words
from .properties import OPTIONS
from .selection import UnusableError


def knots(count, order, cyclic, endpoint, bezier):
    """The knots that Blender gives to `count` points in one direction, those of a cyclic one repeated."""
    inner = order - 1 if bezier else 1  # how often a knot inside is repeated
    head = order - cyclic if endpoint else min(2, inner) if bezier else 1
    tail = 2 * order - 1 if cyclic else order if endpoint else 0
    total = count + order + (order - 1 if cyclic else 0)
    values, current, left = [], 0.0, head
    if endpoint and cyclic:
        values, current = [0.0], 1.0
    while len(values) < total - tail:
        values.append(current)
        left -= 1
        if left == 0:
            current, left = current + 1, inner
    for k in range(tail):
        values.append(current + values[k] - values[0])
    return values


def drawn_at(start, end, edges):
    """Where Blender evaluates a surface between two knots, from 0 to 1: it adds up single-precision steps, and the sum strays."""
    steps = np.full(edges + 1, np.float32(end - start) / np.float32(edges), np.float32)
    steps[0] = start
    t = (np.cumsum(steps, dtype=np.float32).astype(np.float64) - start) / (end - start)
    t[-1] = 1  # the corner
    return np.minimum(t, 1)


def _surface(ob, spline, matrix):
    """A tripatch.NurbsSurface in world space, and where Blender draws it along u and v, from 0 to 1."""
    m, n = spline.point_count_u, spline.point_count_v
    if m < 2 or n < 2:
        raise UnusableError("curve_not_surface", name=ob.name)
    points = np.empty(4 * m * n, np.float32)
    spline.points.foreach_get("co", points)
    points = points.reshape(n, m, 4).transpose(1, 0, 2).astype(np.float64)
    if not np.isfinite(points).all():
        raise UnusableError("points_not_finite", name=ob.name)
    if not (points[..., 3] > 0).all():
        raise UnusableError("weights_not_positive", name=ob.name)
    axes, drawn = [], []
    for k, name in enumerate("uv"):
        order, endpoint, bezier, cyclic, resolution = (
            getattr(spline, f"{key}_{name}") for key in ("order", "use_endpoint", "use_bezier", "use_cyclic", "resolution")
        )
        count = points.shape[k]
        order = min(order, count)
        axis = knots(count, order, cyclic, endpoint, bezier)
        edges = max(1, count * resolution - (not cyclic))
        if cyclic:
            count += order - 1
            points = np.concatenate([points, points.take(range(order - 1), axis=k)], axis=k)
        if not axis[count] > axis[order - 1]:
            raise UnusableError("too_few_points", name=ob.name, axis=name.upper())
        axes.append(axis)
        drawn.append(drawn_at(axis[order - 1], axis[count], edges))
    world = points[..., :3] @ matrix[:3, :3].T + matrix[:3, 3]
    try:
        return tripatch.NurbsSurface(world, points[..., 3], *axes), drawn
    except ValueError as reason:
        raise UnusableError("of_object", name=ob.name, reason=tripatch.errors.because(reason)) from None


def _surface_edges(ob):
    """The edges of every surface of an object. A cyclic one has none where it closes."""
    matrix = filling.world_matrix(ob.name, ob.matrix_world)
    mirrored = bool(np.linalg.det(matrix[:3, :3]) < 0)
    of = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    made = of.to_mesh()
    if made is None or not len(made.vertices):
        raise UnusableError("knots_unsuitable", name=ob.name)
    of.to_mesh_clear()
    found, refused = [], []
    for spline in ob.data.splines:
        surface, drawn = _surface(ob, spline, matrix)
        for edge in range(4):
            if spline.use_cyclic_v if edge % 2 == 0 else spline.use_cyclic_u:
                continue
            try:
                t = drawn[edge % 2] if edge < 2 else 1 - drawn[edge % 2][::-1]
                side = tripatch.Side(surface, edge)
                found.append(tripatch.between.SurfaceEdge(ob.name, side, t, not mirrored, (surface, edge)))
            except tripatch.Refusal as refusal:  # a single point: a corner of the surface; or flat to a line
                refused.append(refusal)
    if not found:
        flat = next((refusal for refusal in refused if refusal.code == "surface_flat_to_line"), None)
        raise UnusableError.of(flat.said) if flat else UnusableError("surface_closed", name=ob.name)
    return found


def _mesh_borders(ob):
    """The borders of a mesh as its modifiers leave it; where some of their edges are selected, only those."""
    matrix = filling.world_matrix(ob.name, ob.matrix_world)
    of = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = of.to_mesh()
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    faces = [list(p.vertices) for p in mesh.polygons]
    selected = {frozenset(e.vertices) for e in mesh.edges if e.select}
    everything = all(v.select for v in mesh.vertices)  # as in a mesh that was just made: nothing is meant by it
    of.to_mesh_clear()
    if not np.isfinite(points).all():
        raise UnusableError("object_vertices_not_finite", name=ob.name)
    if np.linalg.det(matrix[:3, :3]) < 0:
        faces = [face[::-1] for face in faces]
    world = points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    loops = [loop.tolist() for loop in tripatch.find_holes(faces)] if faces else []
    if not loops:
        raise UnusableError("object_without_border", name=ob.name)
    marked = [[frozenset(pair) in selected for pair in selection.pairs(loop)] for loop in loops]
    some = not everything and any(map(any, marked))
    found = []
    for loop, marks in zip(loops, marked, strict=True):
        if not some or all(marks):
            found.append(tripatch.between.MeshBorder(ob.name, world, faces, loop))
            continue
        starts = [k for k in range(len(loop)) if marks[k] and not marks[k - 1]]
        for k in starts:
            length = next(n for n in range(1, len(loop)) if not marks[(k + n) % len(loop)])
            found.append(tripatch.between.MeshBorder(ob.name, world, faces, loop[k:] + loop[:k], length))
    return found


def seam(report):
    """Parameters of a message on the seam: of sides that are met in tangent planes, if there are such."""
    angles = report.seam_angle_max_by_side
    kept = [angle for angle, met in zip(angles, report.continuity, strict=True) if met not in ("Free", "G0")]
    angle = words.degrees(max(kept or angles))
    return {"seam" if kept else "angle": angle}


def met(names, gap, tolerance, report):
    """Parameters of a message on edges of objects that meet."""
    *others, last = names
    return {"names": others, "last": last, "gap": gap, "tolerance": tolerance} | seam(report)


def selected(context):
    """The selected objects that have edges or borders, by name."""
    return sorted((ob for ob in context.selected_objects if ob.type in ("SURFACE", "MESH")), key=lambda ob: ob.name)


@dataclass
class Between:
    """What a mesh between objects was made from."""

    loop: tripatch.between.Loop
    sides: list
    patch: Any
    notes: list[str]  # of the patch
    edges: int  # along the side of a surface that has the most


def _patch_and_triangles(sides, drawn, arguments, progress=None):
    """The patch between some sides, its vertices and triangles, and what is to be said of it; drawn: of each side into how many
    edges, or where."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        patch = tripatch.patch(sides, **arguments, progress=progress)
    barycentric, faces = patch.triangles(drawn)
    return patch, patch.evaluate(barycentric), faces, [each.message.args[0] for each in told if isinstance(each.message, Warning)]


def curves_of(objects):
    """The curves of each object that may hold a side of the hole; UnusableError where one has none."""
    return [_mesh_borders(ob) if ob.type == "MESH" else _surface_edges(ob) for ob in objects]


def put(mesh, points, faces, like):
    """Makes a mesh these smooth triangles, with the materials of another."""
    mesh.clear_geometry()
    limit_objects.take_materials(mesh, like)
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))


def mesh_between(objects, tolerance, resolution, construction, mesh=None):
    """A mesh that fills the hole between objects, and its `Between`; UnusableError or ValueError if there is none. mesh: gets
    the fill instead of a new one."""
    loop = tripatch.between.find_loop(curves_of(objects), tolerance)
    sides = loop.joined_sides()
    exact = [isinstance(curve, tripatch.between.SurfaceEdge) for curve in loop.curves]
    by_number = [resolution and all(exact[k] for k in group) for group in loop.groups]
    drawn = [resolution if number else t for number, (_, t) in zip(by_number, sides, strict=True)]
    own = calls.for_sides(construction, len(sides))
    patch, points, faces, notes = waiting.make(_patch_and_triangles, [side for side, _ in sides], drawn, own)
    mesh = mesh or bpy.data.meshes.new("Fill")
    put(mesh, points, faces, objects[0].data)
    edges = max(
        (resolution or len(t) - 1 for group, (_, t) in zip(loop.groups, sides, strict=True) if exact[group[0]]), default=0
    )
    return mesh, Between(loop, sides, patch, notes, edges)


class FromEdges:
    """Mixed into operators that fill the hole between edges of objects."""

    tolerance: FloatProperty(
        **library.named("gap_tolerance"),
        unit="LENGTH",
        min=0.0,
        precision=5,
        default=0.001,
    )
    resolution: IntProperty(
        **library.named("edges_along_sides"),
        min=0,
        soft_min=1,
        soft_max=128,
        max=10000,
        default=0,
    )
    computed_resolution: IntProperty(default=0, options={"HIDDEN"})  # -1: of no surface; still the same, nobody chose it
    by_hand: BoolProperty(**library.named("by_hand"), options={"HIDDEN", "SKIP_SAVE"})
    reasons: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def asked(self):
        """The tolerance and the resolution that somebody chose, else 0."""
        return {"tolerance": self.tolerance, "resolution": 0 if self.resolution == self.computed_resolution else self.resolution}

    def refuse(self, reason):
        """What the operator returns for a refusal, which the panel shows to who can correct it there."""
        self.reasons = sentences.for_people(reason)
        self.report({"WARNING" if self.by_hand else "ERROR"}, self.reasons)  # pyright: ignore
        return {"FINISHED" if self.by_hand else "CANCELLED"}


class OBJECT_OT_fill_between_patches(FromEdges, Construction, waiting.Waiting, bpy.types.Operator):
    bl_idname = "object.fill_between_patches"
    bl_label, bl_description = library.titled("fill_between_patches")
    bl_options = {"REGISTER", "UNDO"}

    keep_live: BoolProperty(**library.named("keep_live"), default=False)

    @classmethod
    def poll(cls, context):
        if not library.poll(cls, context, "OBJECT", "needs_object_mode"):
            return False
        objects = selected(context)
        if not 2 <= len(objects) <= calls.MAX_SIDES:
            cls.poll_message_set(sentences.said("needs_two_to_twelve_objects"))
            return False
        return True

    def draw(self, context):
        row = self.panel()
        panel.reasons(self.layout, context, self.reasons)
        row("tolerance")
        if self.resolution or not (self.reasons or self.computed_resolution):
            row("resolution")
        row("keep_live")
        self.shape_rows(row)
        with panel.folded(self, "sides") as row:
            self.sides_rows(row)
        with panel.folded(self, "advanced") as row:
            self.construction_rows(row)
        with panel.folded(self, "papers") as row:
            self.papers_rows(row)

    def invoke(self, context, _event):
        self.by_hand = True
        return self.run_and_wait(context)

    def perform(self, context):
        objects = selected(context)
        between = {**self.asked(), "construction": self.construction()}
        self.reasons = ""
        try:
            mesh, made = mesh_between(objects, **between)
        except (tripatch.Refusal, ValueError) as reason:  # and UnusableError, InvalidArgument
            return self.refuse(reason)
        waiting.must_finish()
        if not between["resolution"]:
            self.resolution, self.computed_resolution = made.edges, made.edges or -1
        new = bpy.data.objects.new("Fill", mesh)
        context.collection.objects.link(new)
        for ob in context.selected_objects:
            ob.select_set(False)
        new.select_set(True)
        context.view_layer.objects.active = new
        if self.keep_live:
            from . import following, live  # they use what is above

            between["construction"] = calls.for_sides(between["construction"], len(made.sides))
            live.keep_patches(new, objects, **between)
            following.begin(new)
        names = list(dict.fromkeys(curve.name for curve in made.loop.curves))
        self.sides = len(made.sides)
        code = "ring_filled_between" if made.loop.ring else "hole_filled_between"
        message = sentences.said(code, **met(names, max(made.loop.gaps), self.tolerance, made.patch.report))
        notes = [sentences.for_people(note) for note in made.notes]
        self.report({"WARNING" if notes else "INFO"}, ". ".join([message, *notes[:2]]))
        return {"FINISHED"}


if OPTIONS:
    can = {"items": properties.method_items(lambda method: method.joins_sides)}
    properties.declare(OBJECT_OT_fill_between_patches, {"method": properties.of(OPTIONS["method"], **can)})


def register():
    bpy.utils.register_class(OBJECT_OT_fill_between_patches)


def unregister():
    bpy.utils.unregister_class(OBJECT_OT_fill_between_patches)
