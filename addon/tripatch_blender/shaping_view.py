# SPDX-License-Identifier: GPL-3.0-or-later
"""The hole that is being shaped, as 3D views show it: its preview, its labels, and what its handles read and write."""

import traceback
from typing import Any

import blf
import bmesh
import bpy
import gpu
from bpy.app.handlers import persistent
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

from . import overlay, sentences, shaping, shown, versions
from .library import np, quality

#: Name of the tool whose handles these are.
TOOL = "tripatch.shape_fill"
# Seconds without a change after which a handle rests; a fill that takes longer than so many waits until then.
_RESTS, _PROMPT = 0.25, 0.15
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


def problem():
    """Why its last fill was refused, or nothing."""
    return _state.problem


def edited():
    """Its object, or None."""
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
    _stop_timers()
    _state.__init__()
    overlay.redraw()


def changed():
    """After the fill was made again."""
    _state.drawn = None
    _state.problem = sentences.for_people(_state.shaping.refusal or "") if _state.shaping else ""
    overlay.redraw()


def _stop_timers():
    for timer in (_rest, _release):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)


def _rest():
    """Of a timer: a handle rests, and its fill takes long."""
    if current() and edited() and not current().is_shown:
        current().preview()
        changed()


def _release():
    """Of a timer, as nothing is filled while a view is drawn."""
    if current() and edited():
        current().end_drag()
        changed()


def pulled():
    """After a handle has changed the shape."""
    if current().seconds < _PROMPT:
        current().preview()
        changed()
    _stop_timers()
    bpy.app.timers.register(_rest, first_interval=_RESTS)


def let_go():
    """After an arrow was pulled."""
    _stop_timers()
    bpy.app.timers.register(_release, first_interval=0.0)


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
        if edited() is None:
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
        (Vector(point) - _LABEL * pixel(context, point) * gizmo_size() * Vector(direction), text)
        for (_, point, direction), text in zip(sides, shown, strict=False)
    ]


def _draw_labels():
    """Over the gizmos, which are what is clicked."""
    try:
        context = bpy.context
        if edited() is None or not _shows_gizmos(context):
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
    return context.space_data.show_gizmo and tool is not None and tool.idname == TOOL


@persistent
def _on_undo(*_):
    """What was undone may have changed the rim."""
    ob = edited()
    if _state.shaping and (ob is None or not _state.shaping.is_current(bmesh.from_edit_mesh(ob.data))):
        stop()


@persistent
def _on_load(*_):
    stop()


def on_screen(context, point):
    """Pixels of a point in the world, nan behind the eye."""
    at = location_3d_to_region_2d(context.region, context.region_data, Vector(point))
    return (float("nan"),) * 2 if at is None else (at.x, at.y)


def pixel(context, point):
    """The length of a pixel at a point."""
    at = Vector(point)
    one = context.region_data.view_matrix.inverted().col[0].to_3d()
    a, b = (Vector(on_screen(context, p)) for p in (at, at + one))
    return 1 / max((b - a).length, 1e-6)


def gizmo_size():
    """Pixels of a gizmo at the scale 1."""
    preferences = bpy.context.preferences
    return preferences.view.gizmo_size * preferences.system.ui_scale


def drag_to(context, number, mouse):
    """Moves a corner to the vertex of the rim under the mouse; the fill follows where it has moved."""
    made = current()
    corners = made.shape.corners
    screen = [on_screen(context, p) for p in made.points]
    place, _ = made.nearest_place(screen, mouse, [c for k, c in enumerate(corners) if k != number])
    before = corners[number]
    if made.drag_corner(number, place) != before:
        pulled()


def bulge_handlers(k):
    """What an arrow of a side reads and writes: its offset in scene units. Writing says whether it is another one."""

    def get():
        made = current()
        return made.shape.bulges[k] * shaping.ARROW * made.size if made and k < len(made.shape.bulges) else 0.0

    def put(value):
        made = current()
        is_new = made and k < len(made.shape.bulges) and made.set_bulge(k, value / (shaping.ARROW * made.size))
        if is_new:
            pulled()
        return is_new

    return get, put


def middle_handlers():
    def get():
        return current().shape.middle if current() else 0.0

    def put(value):
        is_new = current() and current().set_middle(value)
        if is_new:
            pulled()
        return is_new

    return get, put


#: What Blender calls.
HANDLERS = (("undo_post", _on_undo), ("redo_post", _on_undo), ("load_pre", _on_load))
