# SPDX-License-Identifier: GPL-3.0-or-later
"""object.blend_three_patches: three surfaces over one hole become one; its weights lambda are handles in the view."""

from __future__ import annotations

import traceback

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from mathutils import Matrix, Vector

from . import between_patches, blends, following, handles, library, live, panel, properties, sentences
from .properties import OPTIONS

#: Blender sets a handle again, in single precision, wherever it draws while the mouse rests: that changes nothing.
_SAME = 1e-6
_METHODS = ("szilvasi_nagy_c1", "szilvasi_nagy_c0")


def _between(names, i):
    """What lambda i weighs against each other: its surface, and the one before."""
    return f"{names[i]} - {names[(i + 2) % 3]}"


class OBJECT_OT_blend_three_patches(between_patches.FromEdges, bpy.types.Operator):
    bl_idname = "object.blend_three_patches"
    bl_label, bl_description = library.titled("blend_three_patches")
    bl_options = {"REGISTER", "UNDO"}

    optimal_shape: BoolProperty(**library.named("optimal_shape"), default=False)

    names: StringProperty(options={"HIDDEN", "SKIP_SAVE"})  # of the objects, by side

    @classmethod
    def poll(cls, context):
        if not library.poll(cls, context, "OBJECT", "needs_object_mode"):
            return False
        if len(between_patches.selected(context)) != 3:
            cls.poll_message_set(sentences.said("needs_three_objects"))
            return False
        return True

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        panel.reasons(layout, context, self.reasons)
        layout.prop(self, "method")
        layout.prop(self, "optimal_shape")
        names = self.names.split("\n")
        if len(names) == 3:
            column = layout.column(align=True)
            column.active = not self.optimal_shape
            for i in range(3):
                column.prop(self, "shape", index=i, text=_between(names, i))
        layout.prop(self, "tolerance")
        layout.prop(self, "resolution")

    def invoke(self, context, _event):
        self.by_hand = True
        return self.execute(context)

    def execute(self, context):
        objects = between_patches.selected(context)
        given = {**self.asked(), "method": self.method}  # pyright: ignore
        self.reasons = self.names = ""
        try:
            mesh, made = blends.mesh_of(objects, shape="optimal" if self.optimal_shape else list(self.shape), **given)
        except ValueError as reason:  # Refusal, UnusableError, InvalidArgument
            return self.refuse(reason)
        if not given["resolution"]:
            self.resolution = self.computed_resolution = made.edges
        self.names, self.shape = "\n".join(made.names), made.shape
        new = bpy.data.objects.new("Blend", mesh)
        context.collection.objects.link(new)
        for ob in context.selected_objects:
            ob.select_set(False)
        new.select_set(True)
        context.view_layer.objects.active = new
        live.keep_blend(new, objects, made, shape=made.shape, **given)
        following.begin(new)
        met = between_patches.met(made.names, made.gap, self.tolerance, made.report)
        message = sentences.said("patches_blended", **met)
        notes = [sentences.for_people(note) for note in made.notes]
        self.report({"WARNING" if notes else "INFO"}, ". ".join([message, *notes[:2]]))
        return {"FINISHED"}


if OPTIONS:
    _items = [
        (name, properties.method_label(name), library.tripatch.METHODS[name].description)  # pyright: ignore
        for name in _METHODS
    ]
    _declared = {
        "method": EnumProperty(**library.named("method_of_blend"), items=_items),
        "shape": properties.by_side(OPTIONS["shape"]),
    }
    properties.declare(OBJECT_OT_blend_three_patches, _declared)


# Weights in the view and in the sidebar.


def weights_of(ob):
    """Lambda of a live blend, by side."""
    return live.settings_of(ob)["blend"]["shape"] if live.is_blend(ob) else (0.5, 0.5, 0.5)


def set_weights(ob, values):
    """Makes a live blend again with other weights."""
    if live.is_blend(ob) and list(values) != weights_of(ob):
        live.reshape(ob, values)


def active_blend(context):
    """The active object if it is a live blend that is seen, else None."""
    ob = context.view_layer.objects.active
    return ob if live.is_blend(ob) and ob.visible_get() else None


def tracks(ob):
    """For each weight the ends of its handle's way in the world: where it is 0, amid its surface's side, and where it is 1, amid
    that of the surface before."""
    middles = [ob.matrix_world @ Vector(point) for point in live.settings_of(ob)["middles"]]
    return [(middles[i], middles[(i + 2) % 3]) for i in range(3)]


def _let_go():
    """Of a timer, as no step of undo is made while a view is drawn."""
    bpy.ops.ed.undo_push(message=library.label("weigh_patches"))


def handlers(k):
    """What the handle of a weight reads and writes: its way from the start of its track. Writing says whether it is new."""

    def length(ob):
        start, end = tracks(ob)[k]
        return (end - start).length

    def get():
        ob = active_blend(bpy.context)
        return weights_of(ob)[k] * length(ob) if ob else 0.0

    def put(value):
        ob = active_blend(bpy.context)
        if ob is None or not length(ob):
            return False
        values, limits = [*weights_of(ob)], properties.limits(OPTIONS["shape"])
        weight = min(max(value / length(ob), limits["min"]), limits["max"])
        if abs(weight - values[k]) < _SAME:
            return False
        values[k] = weight
        set_weights(ob, values)
        return True

    return get, put


class VIEW3D_GGT_tripatch_blend(handles.Arrows, bpy.types.GizmoGroup):
    """The handles of the weights of the active blend."""

    bl_idname = "VIEW3D_GGT_tripatch_blend"
    bl_label = library.label("weigh_patches")
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"3D", "PERSISTENT", "SHOW_MODAL_ALL"}

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and active_blend(context) is not None

    def setup(self, _context):
        self.arrows = [self.arrow(*handlers(k), (0.95, 0.75, 0.2)) for k in range(3)]

    def refresh(self, context):
        self.draw_prepare(context)

    def draw_prepare(self, context):
        try:
            ob = active_blend(context)
            if self.is_let_go():  # persistent, as a timer that opening a file removes hangs Blender 4.5 at its end
                bpy.app.timers.register(_let_go, first_interval=0.0, persistent=True)
            for gizmo, (start, end) in zip(self.arrows, tracks(ob) if ob else ()):
                turn = (end - start).to_track_quat("Z", "Y").to_matrix().to_4x4()
                gizmo.matrix_basis = Matrix.Translation(start) @ turn
        except Exception:  # one that leaves a callback would come again with every frame
            traceback.print_exc()


class VIEW3D_PT_tripatch_blend(bpy.types.Panel):
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "TriPatch"
    bl_label, bl_description = library.titled("blend")

    @classmethod
    def poll(cls, context):
        return not library.missing and active_blend(context) is not None

    def draw(self, context):
        ob = active_blend(context)
        names = live.settings_of(ob)["names"]
        column = self.layout.column(align=True)
        for i in range(3):
            column.prop(ob, "tripatch_lambda", index=i, text=_between(names, i), slider=True)
        panel.sentence(self.layout, context, sentences.said("lambda_scale"))
        if live.problem_of(ob):
            panel.sentence(self.layout, context, live.problem_of(ob))


_classes = (OBJECT_OT_blend_three_patches, VIEW3D_GGT_tripatch_blend, VIEW3D_PT_tripatch_blend)


def register():
    for cls in _classes:
        bpy.utils.register_class(cls)
    if OPTIONS:
        bpy.types.Object.tripatch_lambda = properties.by_side(  # pyright: ignore[reportAttributeAccessIssue]
            OPTIONS["shape"], name=library.label("lambda"), get=weights_of, set=set_weights, options=set()
        )


def unregister():
    if bpy.app.timers.is_registered(_let_go):
        bpy.app.timers.unregister(_let_go)
    if OPTIONS:
        del bpy.types.Object.tripatch_lambda  # pyright: ignore[reportAttributeAccessIssue]
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
