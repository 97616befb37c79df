# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrows in a 3D view that are pulled and let go."""

from typing import TYPE_CHECKING, Any


class Arrows:
    """Mixed into groups of gizmos. Blender tells that an arrow is let go by its `is_modal` only."""

    __slots__ = ()
    pulled = False

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...  # what the group has

    def arrow(self, get, put, color):
        """A new one with a box at its end. put(value) says whether that is another one."""

        def pull(value):
            self.pulled = bool(put(value)) or self.pulled

        gizmo = self.gizmos.new("GIZMO_GT_arrow_3d")
        gizmo.target_set_handler("offset", get=get, set=pull)
        gizmo.draw_style, gizmo.use_draw_value = "BOX", True
        gizmo.color, gizmo.alpha = color, 0.9
        gizmo.color_highlight, gizmo.alpha_highlight = (1, 1, 1), 1.0
        return gizmo

    def is_let_go(self):
        """Of each drawing: whether an arrow that was pulled no longer is."""
        if not self.pulled or any(gizmo.is_modal for gizmo in self.gizmos):
            return False
        self.pulled = False
        return True
