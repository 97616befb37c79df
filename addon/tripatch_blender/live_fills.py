# SPDX-License-Identifier: GPL-3.0-or-later
"""Live fills in the interface: apply, fill again, and a list in the sidebar that says what could not be followed."""

from typing import Any

import bpy
from bpy.props import StringProperty

from . import following, library, live, panel, sentences

_PICK = {**library.named("live_fill_name"), "options": {"SKIP_SAVE", "HIDDEN"}}


def _meant(context, name):
    """The live fills that an operator means: the one named, else the active object, else those of the active object, else all."""
    fills = [fill for fill in live.fills() if fill.name in context.scene.objects]
    if name:
        return [fill for fill in fills if fill.name == name]
    active = context.view_layer.objects.active
    own = [fill for fill in fills if fill == active] or [fill for fill in fills if fill.parent == active and active]
    return own or fills


class _OfLiveFills:
    @classmethod
    def poll(cls: Any, context):
        if library.missing or context.mode not in ("OBJECT", "EDIT_MESH"):
            cls.poll_message_set(library.missing or sentences.said("needs_object_or_edit_mode"))
            return False
        if not live.fills():
            cls.poll_message_set(sentences.said("no_live_fill"))
            return False
        return True


class OBJECT_OT_apply_live_fill(_OfLiveFills, bpy.types.Operator):
    bl_idname = "object.apply_live_fill"
    bl_label, bl_description = library.titled("apply_live_fill")
    bl_options = {"REGISTER", "UNDO"}

    fill: StringProperty(**_PICK)

    def execute(self, context):
        applied, refused = [], []
        for fill in _meant(context, self.fill):
            name = fill.name
            try:
                live.apply(fill)
            except (live.UnusableError, library.tripatch.Refusal, ValueError) as reason:
                refused.append(sentences.said("of_object", name=name, reason=sentences.for_people(reason)))
            else:
                applied.append(name)
        following.scan()
        if refused:
            self.report({"WARNING" if applied else "ERROR"}, refused[0])
        else:
            done = sentences.said("live_fills_applied", names=applied) if applied else sentences.said("no_such_live_fill")
            self.report({"INFO"}, done)
        return {"FINISHED"} if applied else {"CANCELLED"}


class OBJECT_OT_update_live_fill(_OfLiveFills, bpy.types.Operator):
    bl_idname = "object.update_live_fill"
    bl_label, bl_description = library.titled("update_live_fill")
    bl_options = {"REGISTER", "UNDO"}

    fill: StringProperty(**_PICK)

    def execute(self, context):
        problems = []
        for fill in _meant(context, self.fill):
            problem = live.refill(fill)
            problems += [sentences.said("of_object", name=fill.name, reason=problem)] if problem else []
        if problems:
            self.report({"WARNING"}, problems[0])
        return {"FINISHED"}


class VIEW3D_PT_tripatch_live(bpy.types.Panel):
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "TriPatch"
    bl_label, bl_description = library.titled("live_fills")

    @classmethod
    def poll(cls, context):
        return not library.missing and any(live.is_live(ob) for ob in context.scene.objects)

    def draw(self, context):
        for fill in live.fills():
            if fill.name not in context.scene.objects:
                continue
            row = self.layout.split(factor=2 / 3, align=True)  # names are longer than what can be done
            row.label(text=fill.name, icon="ERROR" if live.problem_of(fill) else "MOD_MESHDEFORM")
            row = row.row(align=True)
            row.operator(OBJECT_OT_update_live_fill.bl_idname, text="", icon="FILE_REFRESH").fill = fill.name
            row.operator(OBJECT_OT_apply_live_fill.bl_idname, text=library.label("apply")).fill = fill.name
            if live.problem_of(fill):
                panel.sentence(self.layout, context, live.problem_of(fill))


_classes = (OBJECT_OT_apply_live_fill, OBJECT_OT_update_live_fill, VIEW3D_PT_tripatch_live)


def register():
    for cls in _classes:
        bpy.utils.register_class(cls)
    following.register()


def unregister():
    following.unregister()
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
