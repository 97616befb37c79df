# SPDX-License-Identifier: GPL-3.0-or-later
"""The node Smooth Fill of Geometry Nodes: it fills the holes of the mesh that goes into it."""

import bpy

from . import following, library, node_fills, panel


class _SmoothFill:
    bl_idname = node_fills.ID
    bl_label, bl_description = library.titled("smooth_fill")

    def init(self, _context):
        self.node_tree = node_fills.new_tree()  # pyright: ignore[reportAttributeAccessIssue]
        if not library.missing:
            following.begin_node(self.node_tree.name)

    def draw_buttons(self, context, layout):
        problem = library.missing or node_fills.problem_of(self)
        if problem:
            panel.sentence(layout, context, problem)


def _draw(menu, context):
    if getattr(context.space_data, "tree_type", "") == "GeometryNodeTree" and not library.missing:
        menu.layout.separator()
        made = menu.layout.operator("node.add_node", text=_SmoothFill.bl_label)
        made.type, made.use_transform = node_fills.ID, True


_registered: list[type] = []


def register():
    # again each time: Blender 5.2 makes another type of a node's base when a class of it is unregistered
    node = type(node_fills.ID, (_SmoothFill, bpy.types.GeometryNodeCustomGroup), {})
    bpy.utils.register_class(node)
    _registered.append(node)
    bpy.types.NODE_MT_add.append(_draw)


def unregister():
    bpy.types.NODE_MT_add.remove(_draw)
    bpy.utils.unregister_class(_registered.pop())
