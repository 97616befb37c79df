# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the operators are found: the Face menu and the context menu of edit mode, the Object menu."""

import bpy

from .between_patches import OBJECT_OT_fill_between_patches
from .operators import MESH_OT_fill_three_sided
from .smooth import MESH_OT_smooth_triangles


def _draw(self, _context):
    self.layout.separator()
    self.layout.operator(MESH_OT_fill_three_sided.bl_idname)
    self.layout.operator(MESH_OT_smooth_triangles.bl_idname)


def _draw_between(self, _context):
    self.layout.separator()
    self.layout.operator(OBJECT_OT_fill_between_patches.bl_idname)


def _menus():
    return (bpy.types.VIEW3D_MT_edit_mesh_faces, bpy.types.VIEW3D_MT_edit_mesh_context_menu)


def register():
    for menu in _menus():
        menu.append(_draw)
    bpy.types.VIEW3D_MT_object.append(_draw_between)


def unregister():
    for menu in _menus():
        menu.remove(_draw)
    bpy.types.VIEW3D_MT_object.remove(_draw_between)
