# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the operators are found: menus of edit mode and object mode, a key, the preferences, the manual."""

import bpy

from . import library, links, sentences, versions
from .between_patches import OBJECT_OT_fill_between_patches
from .blending import OBJECT_OT_blend_three_patches
from .operators import MESH_OT_edit_fill, MESH_OT_fill_smooth
from .smooth import MESH_OT_smooth_triangles


def _draw_fill(menu, _context):
    menu.layout.operator(MESH_OT_fill_smooth.bl_idname)


def _draw_both(menu, context):
    menu.layout.separator()
    _draw_fill(menu, context)
    menu.layout.operator(MESH_OT_edit_fill.bl_idname)
    menu.layout.operator(MESH_OT_smooth_triangles.bl_idname)


def _draw_between(menu, _context):
    menu.layout.separator()
    menu.layout.operator(OBJECT_OT_fill_between_patches.bl_idname)
    menu.layout.operator(OBJECT_OT_blend_three_patches.bl_idname)


#: What is added at the end of Blender's menus; in Mesh > Clean Up that is below Fill Holes.
_MENUS = (
    ("VIEW3D_MT_edit_mesh_faces", _draw_both),
    ("VIEW3D_MT_edit_mesh_context_menu", _draw_both),
    ("VIEW3D_MT_edit_mesh_clean", _draw_fill),
    ("VIEW3D_MT_object", _draw_between),
)


_keys = []


def _propose_key():
    """Ctrl-Alt-F, next to F, Alt-F and Ctrl-F, is free in Blender's own key maps of edit mode."""
    configuration = bpy.context.window_manager.keyconfigs.addon
    if configuration:  # not in background
        keymap = configuration.keymaps.new(name="Mesh", space_type="EMPTY")
        _keys.append((keymap, keymap.keymap_items.new(MESH_OT_fill_smooth.bl_idname, "F", "PRESS", ctrl=True, alt=True)))


class TripatchPreferences(bpy.types.AddonPreferences):
    """The key, and where to read and ask"""

    bl_idname = __package__ or ""

    def draw(self, context):
        layout = self.layout
        if library.missing:
            layout.label(text=library.missing, icon="ERROR")
        if not versions.LINKS_ADDONS:
            row = layout.row()
            row.operator("wm.url_open", text=library.label("documentation"), icon="HELP").url = links.GUIDE
            row.operator("wm.url_open", text=library.label("report_a_bug"), icon="URL").url = links.BUGS
        if not library.missing:
            layout.label(text=sentences.said("menu_and_key", operator=MESH_OT_fill_smooth.bl_label))
        user = context.window_manager.keyconfigs.user
        keymap = user.keymaps.get("Mesh") if user else None
        item = keymap.keymap_items.find_from_operator(MESH_OT_fill_smooth.bl_idname) if keymap else None
        if item:
            row = layout.row()
            row.prop(item, "active", text="")
            row.prop(item, "type", text="", full_event=True)


def register():
    bpy.utils.register_class(TripatchPreferences)
    for name, draw in _MENUS:
        getattr(bpy.types, name).append(draw)
    bpy.utils.register_manual_map(links.manual_map)
    _propose_key()


def unregister():
    for keymap, item in _keys:
        keymap.keymap_items.remove(item)
    _keys.clear()
    bpy.utils.unregister_manual_map(links.manual_map)
    for name, draw in _MENUS:
        getattr(bpy.types, name).remove(draw)
    bpy.utils.unregister_class(TripatchPreferences)
