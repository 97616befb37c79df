# SPDX-License-Identifier: GPL-3.0-or-later
"""The tool of edit mode that shapes a hole by hand: what mouse and keys do. What is done stands in shaping.py."""

import sys
import textwrap
from pathlib import Path

import bmesh
import bpy
from bpy.props import BoolProperty, EnumProperty, PointerProperty, StringProperty

from . import gizmos, layers, library, panel, sentences, shaping, shaping_view, waiting
from .shaping_view import changed, current, edited, on_screen, problem, start, stop

# Characters of a problem that a header shows, and how wide its whole sentence is, in Blender's units.
_BEGINNING, _WIDE = 48, 20
#: The key of undo, with Z.
_COMMAND = "oskey" if sys.platform == "darwin" else "ctrl"


def arguments(settings):
    """Of tripatch.fill, as far as they were chosen in the tool's settings."""
    return {"output": settings.chosen} if settings.chosen else {}


_OUTPUTS = library.items("output", "triangles", "quads")


class TripatchTool(bpy.types.PropertyGroup):
    """Settings of the tool."""

    output: EnumProperty(
        **library.named("output"),
        items=_OUTPUTS,
        get=lambda settings: [name for name, *_ in _OUTPUTS].index(_output(settings)),
        set=lambda settings, place: _choose_output(settings, _OUTPUTS[place][0]),
    )
    chosen: StringProperty(options={"HIDDEN"})  # of these, by a person; none: what continues with the faces around
    round: BoolProperty(
        **library.named("round"),
        get=lambda _: bool(current() and current().shape.round),
        set=lambda _, on: _set_round(on),
    )


def _output(settings):
    made = current()
    return settings.chosen or (made.arguments["output"] if made else _OUTPUTS[0][0])


def _choose_output(settings, output):
    """By a person: what would be taken anyway is no choice."""
    made = current()
    settings.chosen = ""
    if made:
        made.set_arguments({})
    if not made or made.arguments["output"] != output:
        settings.chosen = output
    if made:
        made.set_arguments(arguments(settings))
        made.preview()
        changed()


def _set_round(on):
    if current():
        current().set_round(on)
        current().preview()
        changed()


# Operators.


class _OfTool:
    @classmethod
    def poll(cls, context):
        return library.poll(cls, context, "EDIT_MESH", "needs_edit_mode")


class MESH_OT_shape_fill(_OfTool, bpy.types.Operator):
    bl_idname = "mesh.shape_fill"
    bl_label, bl_description = library.titled("shape_fill")
    bl_options = {"INTERNAL"}

    pick: BoolProperty(**library.named("under_mouse"), options={"SKIP_SAVE"})
    corner: BoolProperty(**library.named("corner"), options={"SKIP_SAVE"})

    def invoke(self, context, event):
        mouse = (event.mouse_region_x, event.mouse_region_y)
        if self.corner and current():
            screen = [on_screen(context, p) for p in current().points]
            place, apart = current().nearest_place(screen, mouse)
            if apart < shaping.REACH:
                current().add_corner(place)
                current().preview()
                changed()
            return {"FINISHED"}
        if not self.pick:
            return self.execute(context)
        for ob in context.objects_in_mode:
            bm = bmesh.from_edit_mesh(ob.data)
            bm.verts.index_update()
            bm.faces.index_update()
            rim = shaping.rims_at(bm, lambda v, ob=ob: on_screen(context, ob.matrix_world @ v.co), mouse)
            if rim and current() and current().is_of(ob, rim) and current().is_current(bm):
                return {"FINISHED"}
            if rim:
                return self._start(context, lambda ob=ob, bm=bm, rim=rim: shaping.Shaping(ob, bm, rim, self._arguments(context)))
        return {"CANCELLED", "PASS_THROUGH"}

    def execute(self, context):
        ob = context.edit_object
        bm = bmesh.from_edit_mesh(ob.data)
        return self._start(context, lambda: shaping.from_selection(ob, bm, self._arguments(context)))

    def _arguments(self, context):
        return arguments(context.window_manager.tripatch_tool)

    def _start(self, _context, make):
        try:
            start(make())
        except shaping.UnusableError as reason:
            self.report({"WARNING"}, sentences.for_people(reason))
            return {"CANCELLED"}
        if problem():
            self.report({"WARNING"}, problem())
        return {"FINISHED"}


class _OfShaping(_OfTool):
    """Works while a hole is being shaped."""

    @classmethod
    def poll(cls, context):
        return super().poll(context) and current() is not None


class MESH_OT_shape_fill_confirm(_OfShaping, waiting.Waiting, bpy.types.Operator):
    bl_idname = "mesh.shape_fill_confirm"
    bl_label, bl_description = library.titled("fill_as_shaped")
    bl_options = {"UNDO"}

    def invoke(self, context, _event):
        return self.run_and_wait(context)

    def perform(self, context):
        ob, made = edited(), current()
        if ob is None:
            stop()
            return {"CANCELLED"}
        with layers.standing_aside(context, [ob]):
            return self._write(ob, made)

    def _write(self, ob, made):
        bm = bmesh.from_edit_mesh(ob.data)
        selected = shaping.selection.Selected(bm)
        try:
            outcome, faces = made.write(ob, bm)
        except shaping.UnusableError as reason:
            self.report({"ERROR"}, sentences.for_people(reason))
            return {"CANCELLED"}
        if outcome.refused:
            self.report({"WARNING"}, sentences.for_people(outcome.refused[0].sentence))
            return {"CANCELLED"}
        selected.replace(bm, faces)
        shaping.selection.finish_edit(bm, ob.data)
        stop()
        self.report({"INFO"}, outcome.sentence())
        return {"FINISHED"}


class MESH_OT_shape_fill_step(_OfShaping, bpy.types.Operator):
    bl_idname = "mesh.shape_fill_step"
    bl_label, bl_description = library.titled("undo_shape")
    bl_options = {"INTERNAL"}

    forward: BoolProperty(**library.named("redo_shape"), options={"SKIP_SAVE"})

    def execute(self, context):
        if not current().step(self.forward):
            return {"PASS_THROUGH"}  # the mesh's own step
        changed()
        return {"FINISHED"}


class MESH_OT_shape_fill_cancel(_OfShaping, bpy.types.Operator):
    bl_idname = "mesh.shape_fill_cancel"
    bl_label, bl_description = library.titled("leave_the_hole")
    bl_options = {"INTERNAL"}

    def execute(self, context):
        stop()
        return {"FINISHED"}


class VIEW3D_PT_tripatch_problem(bpy.types.Panel):
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_label, bl_description = library.titled("why_not")
    bl_ui_units_x = _WIDE

    def draw(self, context):
        panel.sentence(self.layout, context, problem(), panel.UNIT * _WIDE)


def _draw_problem(context, layout):
    """In the sidebar in lines; in a header, which is one line, its beginning, and a click shows it in whole."""
    if not problem():
        return
    if context.region is not None and context.region.type == "UI":
        panel.sentence(layout, context, problem())
        return
    beginning = textwrap.shorten(problem(), _BEGINNING, placeholder=" ...")
    layout.popover(VIEW3D_PT_tripatch_problem.__name__, text=beginning, icon="ERROR")


class TRIPATCH_TOOL_shape(bpy.types.WorkSpaceTool):
    bl_space_type = "VIEW_3D"
    bl_context_mode = "EDIT_MESH"
    bl_idname = shaping_view.TOOL
    bl_label = library.label("shape_fill")
    bl_description = sentences.said("tool_keys") if library.tripatch else ""
    bl_icon = str(Path(__file__).parent / "icons" / "shape_fill")  # drawn by scripts/tool_icon.py
    bl_widget = "VIEW3D_GGT_tripatch"
    bl_keymap = (
        ("mesh.shape_fill", {"type": "LEFTMOUSE", "value": "CLICK"}, {"properties": [("pick", True)]}),
        ("mesh.shape_fill", {"type": "LEFTMOUSE", "value": "CLICK", "ctrl": True}, {"properties": [("corner", True)]}),
        ("mesh.shape_fill_confirm", {"type": "RET", "value": "PRESS"}, None),
        ("mesh.shape_fill_confirm", {"type": "NUMPAD_ENTER", "value": "PRESS"}, None),
        ("mesh.shape_fill_cancel", {"type": "ESC", "value": "PRESS"}, None),
        ("mesh.shape_fill_step", {"type": "Z", "value": "PRESS", _COMMAND: True}, None),
        (
            "mesh.shape_fill_step",
            {"type": "Z", "value": "PRESS", "shift": True, _COMMAND: True},
            {"properties": [("forward", True)]},
        ),
    )

    def draw_settings(context, layout, _tool):  # noqa: N805  Blender calls it so
        settings, made = context.window_manager.tripatch_tool, current()  # pyright: ignore[reportAttributeAccessIssue]
        layout.prop(settings, "output")
        if made is None:
            layout.operator("mesh.shape_fill", text=library.label("shape_selected_hole"))
            return
        layout.prop(settings, "round")
        layout.operator("mesh.shape_fill_confirm", text=library.label("fill"))
        layout.operator("mesh.shape_fill_cancel", text=library.label("leave"))
        _draw_problem(context, layout)


_classes = (
    TripatchTool,
    MESH_OT_shape_fill,
    MESH_OT_shape_fill_confirm,
    MESH_OT_shape_fill_step,
    MESH_OT_shape_fill_cancel,
    *gizmos.classes,
    VIEW3D_PT_tripatch_problem,
)


def register():
    for cls in _classes:
        bpy.utils.register_class(cls)
    bpy.types.WindowManager.tripatch_tool = PointerProperty(type=TripatchTool)  # pyright: ignore
    for name, function in shaping_view.HANDLERS:
        getattr(bpy.app.handlers, name).append(function)
    if not bpy.app.background:
        bpy.utils.register_tool(TRIPATCH_TOOL_shape, after={"builtin.poly_build"}, separator=True)


def unregister():
    stop()
    if not bpy.app.background:
        name = TRIPATCH_TOOL_shape._bl_tool.keymap[0]  # pyright: ignore[reportAttributeAccessIssue]
        bpy.utils.unregister_tool(TRIPATCH_TOOL_shape)
        user = bpy.context.window_manager.keyconfigs.user
        if keymap := user.keymaps.get(name):  # which Blender leaves
            user.keymaps.remove(keymap)
    for name, function in shaping_view.HANDLERS:
        getattr(bpy.app.handlers, name).remove(function)
    del bpy.types.WindowManager.tripatch_tool  # pyright: ignore
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
