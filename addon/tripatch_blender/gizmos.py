# SPDX-License-Identifier: GPL-3.0-or-later
"""The handles of a hole that is being shaped."""

from typing import TYPE_CHECKING, Any

import bpy
from mathutils import Matrix, Vector

from . import handles, library, shaping
from .library import np
from .shaping_view import (
    bulge_handlers,
    changed,
    current,
    drag_to,
    edited,
    gizmo_size,
    label_places,
    let_go,
    middle_handlers,
    pixel,
)

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
            @ Matrix.Scale(self.scale_basis * pixel(context, self.matrix_basis.translation), 4)
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


class VIEW3D_GGT_tripatch(handles.Arrows, bpy.types.GizmoGroup):
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
        gizmo = self.arrow(get, put, color)
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
        if made is None or edited() is None:
            self.gizmos.clear()
            self.corners, self.arrows, self.middle, self.labels = [], [], None, []
            return
        self._make(made)
        if self.is_let_go():
            let_go()
        for gizmo, place in zip(self.corners, made.corners()):
            gizmo.matrix_basis = Matrix.Translation(Vector(made.points[place]))
        for gizmo, (point, _) in zip(self.labels, label_places(context), strict=False):
            gizmo.matrix_basis = Matrix.Translation(point)
        handles = [(point, direction) for _, point, direction in made.side_handles()] + [made.middle_handle()]
        for k, (gizmo, handle) in enumerate(zip(self.arrows, made.side_handles())):
            gizmo.scale_basis = shaping.arrow_scale(made.room(k, handle) / max(pixel(context, handle[1]), 1e-30), gizmo_size())
        for gizmo, (point, direction) in zip((*self.arrows, self.middle), handles):
            turn = Vector(direction).to_track_quat("Z", "Y").to_matrix().to_4x4()
            gizmo.matrix_basis = Matrix.Translation(Vector(point)) @ turn


classes = (VIEW3D_GT_tripatch_side, VIEW3D_GT_tripatch_corner, VIEW3D_GGT_tripatch)
