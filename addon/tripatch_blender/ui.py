# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the operators are found: the Face menu and the context menu of edit mode."""

import bpy

from .operators import MESH_OT_fill_three_sided


def _draw(self, _context):
    self.layout.separator()
    self.layout.operator(MESH_OT_fill_three_sided.bl_idname)


def _menus():
    return (bpy.types.VIEW3D_MT_edit_mesh_faces, bpy.types.VIEW3D_MT_edit_mesh_context_menu)


def register():
    for menu in _menus():
        menu.append(_draw)


def unregister():
    for menu in _menus():
        menu.remove(_draw)
