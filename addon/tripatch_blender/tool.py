# SPDX-License-Identifier: GPL-3.0-or-later
"""The tool of edit mode that shapes a hole by hand: what it shows, what mouse and keys do. What is done stands in shaping.py."""

import textwrap
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

import blf
import bmesh
import bpy
import gpu
from bpy.app.handlers import persistent
from bpy.props import BoolProperty, EnumProperty, PointerProperty, StringProperty
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Matrix, Vector

from . import layers, library, overlay, panel, sentences, shaping, shown, versions, waiting
from .library import np, quality

# Seconds without a change after which a handle rests; a fill that takes longer than so many waits until then.
_RESTS, _PROMPT = 0.25, 0.15
# Characters of a problem that a header shows, and how wide its whole sentence is, in Blender's units.
_BEGINNING, _WIDE = 48, 20
# Of a gizmo: how far outside the hole the label of a side is. Its text is so many pixels high.
_LABEL, _TEXT = 0.4, 11
_COLOR = (0.16, 0.36, 0.62)
_RIM, _EDGE = (1.0, 0.75, 0.2, 1.0), (0.05, 0.08, 0.12, 1.0)


class _State:
    """The hole that is being shaped."""

    def __init__(self):
        self.shaping: shaping.Shaping | None = None
        self.handle: Any = None
        self.drawn: Any = None
        self.problem = ""
        self.label_handle: Any = None


_state = _State()


def current():
    """The `Shaping` that is under way in this mode, or None."""
    return _state.shaping


def _object():
    ob = bpy.context.scene.objects.get(_state.shaping.name) if _state.shaping else None
    return ob if ob is not None and ob.mode == "EDIT" else None


def start(made):
    """Begins to shape a hole: shows the fill, changes nothing."""
    stop()
    _state.shaping = made
    made.preview()
    _state.handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")
    _state.label_handle = bpy.types.SpaceView3D.draw_handler_add(_draw_labels, (), "WINDOW", "POST_PIXEL")
    changed()


def stop():
    """Ends it, and leaves nothing behind."""
    for handle in filter(None, (_state.handle, _state.label_handle)):
        bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
    if bpy.app.timers.is_registered(_settle):
        bpy.app.timers.unregister(_settle)
    _state.__init__()
    overlay.redraw()


def changed():
    """After the fill was made again."""
    _state.drawn = None
    _state.problem = sentences.for_people(_state.shaping.refusal or "") if _state.shaping else ""
    overlay.redraw()


def _settle():
    """Of a timer: a handle rests, or was let go, of which Blender does not tell."""
    if current() and _object():
        current().end_drag()
        changed()


def _pulled():
    """After a handle has changed the shape."""
    if current().seconds < _PROMPT:
        current().preview()
        changed()
    if bpy.app.timers.is_registered(_settle):
        bpy.app.timers.unregister(_settle)
    bpy.app.timers.register(_settle, first_interval=_RESTS)


def arguments(settings):
    """Of tripatch.fill, as far as they were chosen in the tool's settings."""
    return {"output": settings.chosen} if settings.chosen else {}


def _drawn():
    """The preview on the graphics card."""
    if _state.drawn is None and _state.shaping.fill is not None:
        vertices, triangles, edges = _state.shaping.surface()
        used = triangles.ravel()
        normals = quality.corner_normals(vertices, triangles).reshape(-1, 3)
        colors = np.ones((len(used), 4), np.float32)
        colors[:, :3] = _COLOR
        made = shown.Shown(vertices[used].astype(np.float32), normals.astype(np.float32), colors)
        loop = _state.shaping.points
        rim = np.stack([loop, np.roll(loop, -1, axis=0)], axis=1).reshape(-1, 3)
        made.lines = np.vstack([vertices[edges.ravel()], rim]).astype(np.float32)
        made.line_colors = np.array([_EDGE] * 2 * len(edges) + [_RIM] * len(rim), np.float32)
        _state.drawn = overlay.Drawn(made, None)
    return _state.drawn


def _draw():
    """In every 3D view, after the scene."""
    try:
        if _object() is None:
            return
        drawn = _drawn()
        if drawn:
            gpu.state.depth_test_set("LESS_EQUAL")
            overlay.draw_colored(drawn, Vector(), bpy.context.region_data)
            gpu.state.depth_test_set("NONE")
    except Exception:  # one that leaves a callback would come again with every frame
        traceback.print_exc()
        stop()


def label_places(context):
    """[(point in the world, "G0", "G1" or "G2")] next to the parts of the rim, outside the hole."""
    made = current()
    shown = made.continuities() if made else []
    sides = made.side_handles() if made else []
    return [
        (Vector(point) - _LABEL * _pixel(context, point) * _gizmo_size() * Vector(direction), text)
        for (_, point, direction), text in zip(sides, shown, strict=False)
    ]


def _draw_labels():
    """Over the gizmos, which are what is clicked."""
    try:
        context = bpy.context
        if _object() is None or not _shows_gizmos(context):
            return
        size = round(_TEXT * bpy.context.preferences.system.ui_scale)
        versions.set_font_size(size)
        blf.color(0, 1, 1, 1, 1)
        for point, text in label_places(context):
            x, y = on_screen(context, point)
            wide, high = blf.dimensions(0, text)
            if x == x:  # not behind the eye
                blf.position(0, x - wide / 2, y - high / 2, 0)
                blf.draw(0, text)
    except Exception:
        traceback.print_exc()
        stop()


def _shows_gizmos(context):
    tool = context.workspace.tools.from_space_view3d_mode(context.mode)
    return context.space_data.show_gizmo and tool is not None and tool.idname == TRIPATCH_TOOL_shape.bl_idname


@persistent
def _on_undo(*_):
    """What was undone may have changed the rim."""
    ob = _object()
    if _state.shaping and (ob is None or not _state.shaping.is_current(bmesh.from_edit_mesh(ob.data))):
        stop()


@persistent
def _on_load(*_):
    stop()


_OUTPUTS = [(name, *library.titled(f"output_{name}")) for name in ("triangles", "quads")]


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
        get=lambda _: bool(_state.shaping and _state.shaping.shape.round),
        set=lambda _, on: _set_round(on),
    )


def _output(settings):
    made = _state.shaping
    return settings.chosen or (made.arguments["output"] if made else _OUTPUTS[0][0])


def _choose_output(settings, output):
    """By a person: what would be taken anyway is no choice."""
    made = _state.shaping
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
    if _state.shaping:
        _state.shaping.set_round(on)
        _state.shaping.preview()
        changed()


def on_screen(context, point):
    """Pixels of a point in the world, nan behind the eye."""
    at = location_3d_to_region_2d(context.region, context.region_data, Vector(point))
    return (float("nan"),) * 2 if at is None else (at.x, at.y)


def _pixel(context, point):
    """The length of a pixel at a point."""
    at = Vector(point)
    one = context.region_data.view_matrix.inverted().col[0].to_3d()
    a, b = (Vector(on_screen(context, p)) for p in (at, at + one))
    return 1 / max((b - a).length, 1e-6)


def _gizmo_size():
    """Pixels of a gizmo at the scale 1."""
    preferences = bpy.context.preferences
    return preferences.view.gizmo_size * preferences.system.ui_scale


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
        if _state.problem:
            self.report({"WARNING"}, _state.problem)
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
        ob, made = _object(), current()
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


class MESH_OT_shape_fill_cancel(_OfShaping, bpy.types.Operator):
    bl_idname = "mesh.shape_fill_cancel"
    bl_label, bl_description = library.titled("leave_the_hole")
    bl_options = {"INTERNAL"}

    def execute(self, context):
        stop()
        return {"FINISHED"}


# Gizmos.

_DISC = (
    [(np.cos(a), np.sin(a), 0.0) for k in range(16) for a in (0, 2 * np.pi * k / 16, 2 * np.pi * (k + 1) / 16)]
    if np is not None
    else []
)
for _k in range(0, len(_DISC), 3):
    _DISC[_k] = (0.0, 0.0, 0.0)


class _Dot:
    """A disc that faces the eye, some pixels large."""

    __slots__ = ()

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    def setup(self):
        if not hasattr(self, "shape"):
            self.shape = self.new_custom_shape("TRIS", _DISC)
            self.number, self.seen = 0, Matrix()

    def _facing(self, context):
        """Towards the eye, some pixels large."""
        turn = context.region_data.view_matrix.to_3x3().inverted().to_4x4()
        return (
            Matrix.Translation(self.matrix_basis.translation)
            @ turn
            @ Matrix.Scale(self.scale_basis * _pixel(context, self.matrix_basis.translation), 4)
        )

    def draw(self, context):
        self.seen = self._facing(context)
        self.draw_custom_shape(self.shape, matrix=self.seen)

    def draw_select(self, _context, select_id):
        # As it was drawn: while Blender picks, the view's matrices are those of a few pixels round the mouse.
        self.draw_custom_shape(self.shape, matrix=self.seen, select_id=select_id)


class VIEW3D_GT_tripatch_side(_Dot, bpy.types.Gizmo):
    """The label of a side: a click takes the next continuity."""

    bl_idname = "VIEW3D_GT_tripatch_side"

    __slots__ = ("number", "seen", "shape")

    def invoke(self, _context, _event):
        return {"RUNNING_MODAL"}

    def modal(self, _context, _event, _tweak):
        return {"RUNNING_MODAL"}  # until the button is let go

    def exit(self, _context, cancel):
        if current() is not None and not cancel:
            current().next_continuity(self.number)
            changed()


class VIEW3D_GT_tripatch_corner(_Dot, bpy.types.Gizmo):
    """A corner that is dragged along the rim."""

    bl_idname = "VIEW3D_GT_tripatch_corner"

    __slots__ = ("number", "seen", "shape")

    def invoke(self, _context, _event):
        current().begin_drag()
        return {"RUNNING_MODAL"}

    def modal(self, context, event, _tweak):
        if current() is None:
            return {"CANCELLED"}
        if event.type == "MOUSEMOVE":
            drag_to(context, self.number, (event.mouse_region_x, event.mouse_region_y))
        return {"RUNNING_MODAL"}

    def exit(self, _context, cancel):
        if current() is not None:
            (current().cancel_drag if cancel else current().end_drag)()
            changed()


def drag_to(context, number, mouse):
    """Moves a corner to the vertex of the rim under the mouse; the fill follows where it has moved."""
    made = current()
    corners = made.shape.corners
    screen = [on_screen(context, p) for p in made.points]
    place, _ = made.nearest_place(screen, mouse, [c for k, c in enumerate(corners) if k != number])
    before = corners[number]
    if made.drag_corner(number, place) != before:
        _pulled()


class VIEW3D_GGT_tripatch(bpy.types.GizmoGroup):
    """The handles of the hole that is being shaped."""

    bl_idname = "VIEW3D_GGT_tripatch"
    bl_label = library.label("shape_fill")
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"3D", "SHOW_MODAL_ALL"}

    @classmethod
    def poll(cls, context):
        return context.mode == "EDIT_MESH"

    def setup(self, _context):
        self.corners, self.arrows, self.middle, self.labels = [], [], None, []

    def _dot(self, kind, k, color, size, highlight=(1, 1, 1)):
        gizmo: Any = self.gizmos.new(kind.bl_idname)
        gizmo.color, gizmo.alpha = color, 0.9
        gizmo.color_highlight, gizmo.alpha_highlight = highlight, 1.0
        gizmo.scale_basis, gizmo.use_draw_scale, gizmo.number = size, False, k
        return gizmo

    def _arrow(self, get, put, color):
        gizmo = self.gizmos.new("GIZMO_GT_arrow_3d")
        gizmo.target_set_handler("offset", get=get, set=put)
        gizmo.draw_style, gizmo.use_draw_value = "BOX", True  # pyright: ignore[reportAttributeAccessIssue]
        gizmo.color, gizmo.alpha = color, 0.8
        gizmo.color_highlight, gizmo.alpha_highlight = (1, 1, 1), 1.0
        gizmo.scale_basis, gizmo.line_width = shaping.LARGE, 3.0
        return gizmo

    def _make(self, made):
        """As many handles as the hole has corners and sides; those that the fill does not follow are not there."""
        count, sides, labels = len(made.corners()), len(made.shape.bulges), len(made.continuities())
        # not by labels, of which a drag changes the number: Blender crashes when the gizmo that is dragged is removed
        if (len(self.corners), len(self.arrows)) != (count, sides) or self.middle is None:
            self.gizmos.clear()
            self.corners = [self._dot(VIEW3D_GT_tripatch_corner, k, (0.95, 0.3, 0.15), 8.0) for k in range(count)]
            blue = (0.1, 0.3, 0.6), 13.0, (0.2, 0.5, 0.95)
            self.labels = [self._dot(VIEW3D_GT_tripatch_side, k, *blue) for k in range(sides)]
            self.arrows = [self._arrow(*bulge_handlers(k), (0.3, 0.8, 0.4)) for k in range(sides)]
            self.middle = self._arrow(*middle_handlers(), (0.35, 0.6, 1.0))
        for k, label in enumerate(self.labels):
            label.hide = k >= labels
        for arrow in self.arrows:
            arrow.hide = not made.honors("bulge")
        self.middle.hide = not made.honors("center_offset")

    def refresh(self, context):
        self.draw_prepare(context)

    def draw_prepare(self, context):
        made = current()
        if made is None or _object() is None:
            self.gizmos.clear()
            self.corners, self.arrows, self.middle, self.labels = [], [], None, []
            return
        self._make(made)
        for gizmo, place in zip(self.corners, made.corners()):
            gizmo.matrix_basis = Matrix.Translation(Vector(made.points[place]))
        for gizmo, (point, _) in zip(self.labels, label_places(context), strict=False):
            gizmo.matrix_basis = Matrix.Translation(point)
        handles = [(point, direction) for _, point, direction in made.side_handles()] + [made.middle_handle()]
        for k, (gizmo, handle) in enumerate(zip(self.arrows, made.side_handles())):
            gizmo.scale_basis = shaping.arrow_scale(made.room(k, handle) / max(_pixel(context, handle[1]), 1e-30), _gizmo_size())
        for gizmo, (point, direction) in zip((*self.arrows, self.middle), handles):
            turn = Vector(direction).to_track_quat("Z", "Y").to_matrix().to_4x4()
            gizmo.matrix_basis = Matrix.Translation(Vector(point)) @ turn


def bulge_handlers(k):
    """What an arrow of a side reads and writes: its offset in scene units."""

    def get():
        made = current()
        return made.shape.bulges[k] * shaping.ARROW * made.size if made and k < len(made.shape.bulges) else 0.0

    def put(value):
        made = current()
        if made and k < len(made.shape.bulges) and made.set_bulge(k, value / (shaping.ARROW * made.size)):
            _pulled()

    return get, put


def middle_handlers():
    def get():
        return current().shape.middle if current() else 0.0

    def put(value):
        if current() and current().set_middle(value):
            _pulled()

    return get, put


class VIEW3D_PT_tripatch_problem(bpy.types.Panel):
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_label, bl_description = library.titled("why_not")
    bl_ui_units_x = _WIDE

    def draw(self, context):
        panel.sentence(self.layout, context, _state.problem, panel.UNIT * _WIDE)


def _draw_problem(context, layout):
    """In the sidebar in lines; in a header, which is one line, its beginning, and a click shows it in whole."""
    if not _state.problem:
        return
    if context.region is not None and context.region.type == "UI":
        panel.sentence(layout, context, _state.problem)
        return
    beginning = textwrap.shorten(_state.problem, _BEGINNING, placeholder=" ...")
    layout.popover(VIEW3D_PT_tripatch_problem.__name__, text=beginning, icon="ERROR")


class TRIPATCH_TOOL_shape(bpy.types.WorkSpaceTool):
    bl_space_type = "VIEW_3D"
    bl_context_mode = "EDIT_MESH"
    bl_idname = "tripatch.shape_fill"
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
    MESH_OT_shape_fill_cancel,
    VIEW3D_GT_tripatch_side,
    VIEW3D_GT_tripatch_corner,
    VIEW3D_GGT_tripatch,
    VIEW3D_PT_tripatch_problem,
)
_HANDLERS = (("undo_post", _on_undo), ("redo_post", _on_undo), ("load_pre", _on_load))


def register():
    for cls in _classes:
        bpy.utils.register_class(cls)
    bpy.types.WindowManager.tripatch_tool = PointerProperty(type=TripatchTool)  # pyright: ignore
    for name, function in _HANDLERS:
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
    for name, function in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(function)
    del bpy.types.WindowManager.tripatch_tool  # pyright: ignore
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
