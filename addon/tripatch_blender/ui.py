# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the operators are found: the Face menu and the context menu of edit mode, the Object menu, a key, the preferences."""

import bpy

from . import library
from .between_patches import OBJECT_OT_fill_between_patches
from .operators import MESH_OT_fill_smooth
from .smooth import MESH_OT_smooth_triangles

#: Blender's entries that ours follows: the first of each menu or column that is there. The last are for single modes.
_FACE_MENU = ("mesh.fill_grid",)
_CONTEXT_MENU = ("mesh.fill", "mesh.edge_face_add", "mesh.poke")


class _Layout:
    """A layout of Blender's that calls `add(layout)` behind an entry: menus know only their two ends."""

    def __init__(self, layout, follows, state):
        for name, value in (("_layout", layout), ("_follows", follows), ("_state", state)):
            object.__setattr__(self, name, value)

    def __getattr__(self, name):
        return getattr(self._layout, name)

    def __setattr__(self, name, value):
        setattr(self._layout, name, value)

    def _within(self, name, *arguments, **given):
        return _Layout(getattr(self._layout, name)(*arguments, **given), self._follows, self._state)

    def row(self, *arguments, **given):
        return self._within("row", *arguments, **given)

    def column(self, *arguments, **given):
        return self._within("column", *arguments, **given)

    def operator(self, name, *arguments, **given):
        made = self._layout.operator(name, *arguments, **given)
        if self._follows(name):
            _draw(self._layout)
            self._state.append(name)
        return made


class _Menu:
    """What a menu's own draw function takes for the menu."""

    def __init__(self, menu, follows, state):
        self._menu = menu
        self.layout = _Layout(menu.layout, follows, state)

    def __getattr__(self, name):
        return getattr(self._menu, name)


def _draw(layout):
    layout.operator(MESH_OT_fill_smooth.bl_idname)
    layout.operator(MESH_OT_smooth_triangles.bl_idname)


def _follows_grid_fill(_context):
    return lambda name: name in _FACE_MENU


def _follows_fill(context):
    """Edges have Fill where more than one is selected; vertices and single edges have New Face; faces have Poke."""
    mesh = context.edit_object.data if context.edit_object else None
    edges = context.tool_settings.mesh_select_mode[1] and mesh is not None and mesh.total_edge_sel > 1
    followed = []

    def follows(name):
        here = name in ("mesh.fill",) if edges else name in _CONTEXT_MENU
        if here and not followed:
            followed.append(name)
            return True
        return False

    return follows


def _draw_at_end(menu, _context):
    menu.layout.separator()
    _draw(menu.layout)


def _with_entries(draw, choose):
    """A menu's draw function with our entries inside, or at the end where Blender's are not found."""

    def drawn(self, context):
        state = []
        draw(_Menu(self, choose(context), state), context)
        if not state:
            _draw_at_end(self, context)

    drawn.tripatch_draw = draw  # pyright: ignore[reportFunctionMemberAccess]
    return drawn


def _menus():
    return (
        (bpy.types.VIEW3D_MT_edit_mesh_faces, _follows_grid_fill),
        (bpy.types.VIEW3D_MT_edit_mesh_context_menu, _follows_fill),
    )


def _draw_functions(menu):
    """The list of functions that draw a menu, Blender's own among them."""
    menu.append(_nothing)
    menu.remove(_nothing)
    return menu.draw._draw_funcs


def _nothing(_self, _context):
    pass


def _insert():
    for menu, choose in _menus():
        functions = _draw_functions(menu)
        own = [k for k, f in enumerate(functions) if f.__module__.endswith("space_view3d")]
        if own:
            functions[own[0]] = _with_entries(functions[own[0]], choose)
        else:
            menu.append(_draw_at_end)


def _take_out():
    for menu, _ in _menus():
        functions = _draw_functions(menu)
        functions[:] = [getattr(f, "tripatch_draw", f) for f in functions if f is not _draw_at_end]


def _draw_between(self, _context):
    self.layout.separator()
    self.layout.operator(OBJECT_OT_fill_between_patches.bl_idname)


_keys = []


def _propose_key():
    """Ctrl-Alt-F, beside F, Alt-F and Ctrl-F, is free in Blender's own key maps of edit mode."""
    configuration = bpy.context.window_manager.keyconfigs.addon
    if configuration:  # not in background
        keymap = configuration.keymaps.new(name="Mesh", space_type="EMPTY")
        _keys.append((keymap, keymap.keymap_items.new(MESH_OT_fill_smooth.bl_idname, "F", "PRESS", ctrl=True, alt=True)))


class TripatchPreferences(bpy.types.AddonPreferences):
    """The key, and where to read more"""

    bl_idname = __package__ or ""

    def draw(self, context):
        layout = self.layout
        if library.missing:
            layout.label(text=library.missing, icon="ERROR")
        layout.label(text="Face > Smooth Fill in edit mode, or by this key:")
        user = context.window_manager.keyconfigs.user
        keymap = user.keymaps.get("Mesh") if user else None
        item = keymap.keymap_items.find_from_operator(MESH_OT_fill_smooth.bl_idname) if keymap else None
        if item:
            row = layout.row()
            row.prop(item, "active", text="")
            row.prop(item, "type", text="", full_event=True)


def register():
    bpy.utils.register_class(TripatchPreferences)
    _insert()
    bpy.types.VIEW3D_MT_object.append(_draw_between)
    _propose_key()


def unregister():
    for keymap, item in _keys:
        keymap.keymap_items.remove(item)
    _keys.clear()
    bpy.types.VIEW3D_MT_object.remove(_draw_between)
    _take_out()
    bpy.utils.unregister_class(TripatchPreferences)
