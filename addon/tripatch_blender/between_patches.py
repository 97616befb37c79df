# SPDX-License-Identifier: GPL-3.0-or-later
"""object.fill_between_patches: the three-sided hole between three surface objects, whose edges are known exactly."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty

from . import filling, library
from .construction import Construction
from .library import np, tripatch
from .selection import UnusableError


@dataclass
class _Edge:
    """An edge of a surface, in one direction."""

    name: str  # of the object
    side: object  # tripatch.Side
    ends: np.ndarray  # (2, 3)
    own_normal: bool  # a fill along it faces as Blender draws the surface
    count: int  # of edges that Blender draws along it


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
    return values + [current + values[k] - values[0] for k in range(tail)]


def _surface(ob, spline, matrix):
    """A tripatch.NurbsSurface in world space."""
    m, n = spline.point_count_u, spline.point_count_v
    if m < 2 or n < 2:
        raise UnusableError(f"{ob.name} holds a curve, not a surface")
    if spline.use_cyclic_u or spline.use_cyclic_v:
        raise UnusableError(f"{ob.name} is cyclic: none of its edges has two ends")
    points = np.empty(4 * m * n, np.float32)
    spline.points.foreach_get("co", points)
    points = points.reshape(n, m, 4).transpose(1, 0, 2).astype(np.float64)
    if not np.isfinite(points).all():
        raise UnusableError(f"{ob.name} has points that are not finite")
    if not (points[..., 3] > 0).all():
        raise UnusableError(f"{ob.name} has points with weights of zero or below")
    axes = []
    for name, count in (("u", m), ("v", n)):
        order, endpoint, bezier = (getattr(spline, f"{key}_{name}") for key in ("order", "use_endpoint", "use_bezier"))
        order = min(order, count)
        axis = knots(count, order, False, endpoint, bezier)
        if not axis[count] > axis[order - 1]:
            raise UnusableError(f"{ob.name} has too few points in {name.upper()} for its order; Blender does not draw it either")
        axes.append(axis)
    world = points[..., :3] @ matrix[:3, :3].T + matrix[:3, 3]
    return tripatch.NurbsSurface(world, points[..., 3], *axes)


def _edges(ob):
    """Every edge of every surface of an object, in both directions."""
    matrix = filling.world_matrix(ob.name, ob.matrix_world)
    mirrored = bool(np.linalg.det(matrix[:3, :3]) < 0)
    found = []
    for spline in ob.data.splines:
        surface = _surface(ob, spline, matrix)
        drawn = (spline.point_count_u * spline.resolution_u - 1, spline.point_count_v * spline.resolution_v - 1)
        for edge, turned in itertools.product(range(4), (False, True)):
            try:
                side = tripatch.Side(surface, edge, turned)
            except tripatch.Refusal:
                continue  # a single point: a corner of the surface
            found.append(
                _Edge(ob.name, side, side.evaluate(np.array([0.0, 1.0]))[0], turned == mirrored, max(1, drawn[edge % 2]))
            )
    if not found:
        raise UnusableError(f"{ob.name} has no edge that could be the side of a hole")
    return found


def _loop(objects, tolerance):
    """Three edges, one of each object, that run round the hole, and the largest gap between their ends."""
    edges = [_edges(ob) for ob in objects]
    size = max(np.ptp([e.ends for of in edges for e in of], axis=(0, 1)))
    candidates = []
    for order in ((0, 1, 2), (0, 2, 1)):
        a, b, c = ([e for e in edges[k] if np.linalg.norm(e.ends[1] - e.ends[0]) > 1e-9 * size] for k in order)
        if not (a and b and c):
            raise UnusableError("One of the surfaces has closed edges only: none has two ends")
        gaps = [
            np.linalg.norm(np.array([e.ends[1] for e in x])[:, None] - np.array([e.ends[0] for e in y])[None], axis=2)
            for x, y in ((a, b), (b, c), (c, a))
        ]
        largest = np.maximum(np.maximum(gaps[0][:, :, None], gaps[1][None]), gaps[2].T[:, None, :])
        own = sum(
            np.array([e.own_normal for e in of], int).reshape(shape)
            for of, shape in ((a, (-1, 1, 1)), (b, (1, -1, 1)), (c, (1, 1, -1)))
        )
        # Both ways round have the same gaps: the one with the surfaces' own normals counts.
        i, j, k = np.unravel_index(np.argmin(largest - 1e-9 * size * own), largest.shape)
        joints = [gaps[0][i, j], gaps[1][j, k], gaps[2][k, i]]
        candidates.append((largest[i, j, k] - 1e-9 * size * own[i, j, k], joints, (a[i], b[j], c[k])))
    _, joints, loop = min(candidates, key=lambda candidate: candidate[0])
    worst = int(np.argmax(joints))
    gap = joints[worst]
    if gap > tolerance:
        raise UnusableError(
            f"The edges of {loop[worst].name} and {loop[(worst + 1) % 3].name} do not meet: their ends are {gap:.3g} apart, the "
            f"tolerance is {tolerance:.3g} (scene units)"
        )
    return loop, gap


def _joined(loop):
    """The sides, with ends that meet exactly: each end moves to the middle of its gap."""
    sides = []
    for k, edge in enumerate(loop):
        before, after = loop[k - 1], loop[(k + 1) % 3]
        start = 0.5 * (before.ends[1] - edge.ends[0])
        end = 0.5 * (after.ends[0] - edge.ends[1])
        if max(np.linalg.norm(start), np.linalg.norm(end)) < 2e-7 * np.linalg.norm(edge.ends[1] - edge.ends[0]):
            sides.append(edge.side)  # the library closes it
            continue
        evaluate = edge.side.evaluate
        sides.append(
            tripatch.Side.from_functions(
                lambda t, e=evaluate, s=start, d=end - start: e(t)[0] + s + t[:, None] * d,
                lambda t, e=evaluate, d=end - start: e(t)[1] + d,
                lambda t, e=evaluate: e(t)[2],
            )
        )
    return sides


def _seam(patch, loop):
    """The largest angle in degrees between patch and surfaces, ends left out."""
    t, largest = np.linspace(0.01, 0.99, 99), 0.0
    for i, edge in enumerate(loop):
        b = np.zeros((len(t), 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
        own, others = patch.normal(b), edge.side.evaluate(t)[3]
        angle = np.arctan2(np.linalg.norm(np.cross(own, others), axis=1), (own * others).sum(axis=1))
        largest = max(largest, np.degrees(angle.max()))
    return largest


class OBJECT_OT_fill_between_patches(Construction, bpy.types.Operator):
    """Fill the three-sided hole between three selected surface objects by a new mesh that continues them"""

    bl_idname = "object.fill_between_patches"
    bl_label = "Fill Between Patches"
    bl_options = {"REGISTER", "UNDO"}

    tolerance: FloatProperty(
        name="Tolerance",
        description="Largest gap between the ends of two edges that still meet",
        unit="LENGTH",
        min=0.0,
        precision=5,
        default=0.001,
    )
    resolution: IntProperty(
        name="Resolution",
        description="Edges along each side, 0 as Blender draws the surfaces",
        min=0,
        soft_max=128,
        max=10000,
        default=0,
    )
    continuity: EnumProperty(
        name="Continuity",
        description="How the fill meets the surfaces",
        items=[
            ("auto", "Auto", "The best that the method keeps"),
            ("G0", "Position", "Meets the edges (G0)"),
            ("G1", "Tangent", "Continues the tangent planes (G1)"),
        ],
        default="auto",
    )

    @classmethod
    def poll(cls, context):
        if library.missing:
            cls.poll_message_set(library.missing)
            return False
        if context.mode != "OBJECT":
            cls.poll_message_set("Works in object mode")
            return False
        if len([ob for ob in context.selected_objects if ob.type == "SURFACE"]) != 3:
            cls.poll_message_set("Select three surface objects")
            return False
        return True

    def draw(self, context):
        row = self.panel()
        row("tolerance")
        row("resolution")
        row("continuity", active=self.keeps_tangents())
        self.construction_rows(row)

    def execute(self, context):
        objects = sorted((ob for ob in context.selected_objects if ob.type == "SURFACE"), key=lambda ob: ob.name)
        try:
            loop, gap = _loop(objects, self.tolerance)
            patch = tripatch.patch(_joined(loop), **self.construction())
            barycentric, faces = patch.triangles(tuple(self.resolution or edge.count for edge in loop))
        except ValueError as reason:  # Refusal, UnusableError, InvalidArgument
            self.report({"ERROR"}, str(reason))
            return {"CANCELLED"}
        mesh = bpy.data.meshes.new("Fill")
        mesh.from_pydata(patch.evaluate(barycentric).tolist(), [], faces.tolist())
        mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
        for material in objects[0].data.materials:
            mesh.materials.append(material)
        mesh.update()
        new = bpy.data.objects.new("Fill", mesh)
        context.collection.objects.link(new)
        for ob in context.selected_objects:
            ob.select_set(False)
        new.select_set(True)
        context.view_layer.objects.active = new
        names = " and ".join((", ".join(edge.name for edge in loop[:2]), loop[2].name))
        seam = max(_seam(patch, loop), 0.001)
        self.report(
            {"INFO"},
            f"Filled the hole between {names}; ends meet within {gap:.2g} (tolerance {self.tolerance:.2g}, scene units), "
            f"seam within {seam:.2g} deg",
        )
        return {"FINISHED"}


def register():
    bpy.utils.register_class(OBJECT_OT_fill_between_patches)


def unregister():
    bpy.utils.unregister_class(OBJECT_OT_fill_between_patches)
