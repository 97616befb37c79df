# SPDX-License-Identifier: GPL-3.0-or-later
"""An object in edit mode for a while, whatever is edited now."""

from contextlib import contextmanager

import bpy

from .selection import UnusableError


def _check_is_shown(ob):
    """UnusableError if Blender would not edit an object here."""
    if not ob.users_scene:
        raise UnusableError("live_in_no_scene", name=ob.name)
    if bpy.context.scene not in ob.users_scene:
        raise UnusableError("live_in_other_scene", name=ob.name, scene=ob.users_scene[0].name)
    if ob.library or ob.data.library:
        raise UnusableError("live_linked", name=ob.name)
    if bpy.context.view_layer.objects.get(ob.name) != ob or ob.hide_viewport:
        raise UnusableError("live_switched_off", name=ob.name)


@contextmanager
def edited(ob):
    """Edit mode of an object inside, and again of those that are edited now. UnusableError if it cannot be."""
    if ob.mode == "EDIT":
        yield
        return
    _check_is_shown(ob)
    objects, others = bpy.context.view_layer.objects, []
    if bpy.context.mode == "EDIT_MESH":
        others = [objects.active, *(other for other in bpy.context.objects_in_mode if other != objects.active)]
        bpy.ops.object.mode_set(mode="OBJECT")
    selected = bpy.context.selected_objects
    _only_selected([ob])
    try:
        bpy.ops.object.mode_set(mode="EDIT")
        yield
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
        if others:
            _only_selected(others)
            bpy.ops.object.mode_set(mode="EDIT")
        for other in bpy.context.view_layer.objects:
            other.select_set(other in selected)


def _only_selected(objects):
    """The first becomes the active one."""
    for other in bpy.context.selected_objects:
        other.select_set(False)
    for ob in objects:
        ob.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]
