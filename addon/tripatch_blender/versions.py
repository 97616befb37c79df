# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender 3.4 to 5.2 do differently, in one place. Code elsewhere asks no version."""

from __future__ import annotations

import math

import blf
import bmesh
import bpy

from .library import np

#: Whether Python reads and writes strings of edges and of face corners in a BMesh.
READS_STRINGS = bpy.app.version >= (4, 0)
#: Whether UV maps are attributes, of the type FLOAT2.
UV_MAPS_ARE_ATTRIBUTES = bpy.app.version >= (3, 5)
#: Whether a BMesh has layers of booleans.
HAS_BOOLEAN_LAYERS = hasattr(bmesh.types.BMLayerAccessLoop, "bool")
#: Whether Blender has commands of add-ons (blender --command NAME).
HAS_COMMANDS = hasattr(bpy.utils, "register_cli_command")
#: Whether Blender shows the links of an add-on next to its preferences.
LINKS_ADDONS = bpy.app.version < (4, 2)
#: Whether Blender says that objects have come from another file.
TELLS_OF_IMPORTS = hasattr(bpy.app.handlers, "blend_import_post")


def boolean_layers(layers):
    """Those of booleans of an element of a BMesh; of integers in Blender 3."""
    return layers.bool if hasattr(layers, "bool") else layers.int


def crease_layer(elements, kind, create=False):
    """The layer of creases of bm.edges or bm.verts; kind: "edge", "vert"."""
    layers = elements.layers
    if hasattr(layers, "crease"):  # Blender 3
        return layers.crease.verify() if create else layers.crease.active
    name = f"crease_{kind}"
    return layers.float.get(name) or (layers.float.new(name) if create else None)


def corner_normals(mesh):
    """(corners, 3) float32 of a mesh in object mode."""
    values = np.empty(3 * len(mesh.loops), np.float32)
    if hasattr(mesh, "corner_normals"):
        mesh.corner_normals.foreach_get("vector", values)
    else:  # to 4.0
        mesh.calc_normals_split()
        mesh.loops.foreach_get("normal", values)
    return values.reshape(-1, 3)


def use_custom_normals(mesh):
    """Has Blender to 4.0 show the custom normals of a mesh; the angle does not count where there are some."""
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True


def show_sharp_edges(mesh):
    """Has Blender to 4.0 show the sharp edges of a mesh, and no others that it did not show."""
    if hasattr(mesh, "use_auto_smooth") and not mesh.use_auto_smooth:
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = math.pi


def new_sockets(group, kinds):
    """Gives a group of geometry nodes these inputs, {name: kind}, and a geometry as its output."""
    if hasattr(group, "interface"):  # from 4.0
        for name, kind in kinds.items():
            group.interface.new_socket(name=name, in_out="INPUT", socket_type=f"NodeSocket{kind}")
        group.interface.new_socket(name="Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        for name, kind in kinds.items():
            group.inputs.new(f"NodeSocket{kind}", name)
        group.outputs.new("NodeSocketGeometry", "Geometry")


def input_names(group):
    """{name: identifier} of the inputs of a group of nodes."""
    if hasattr(group, "interface"):
        return {s.name: s.identifier for s in group.interface.items_tree if s.item_type == "SOCKET" and s.in_out == "INPUT"}
    return {s.name: s.identifier for s in group.inputs}


def input_socket(group, name):
    """An input of a group of nodes, which has its default value, limits and tooltip."""
    if hasattr(group, "interface"):
        return next(s for s in group.interface.items_tree if s.item_type == "SOCKET" and s.in_out == "INPUT" and s.name == name)
    return group.inputs[name]


def _input(modifier, name):
    """Of a Geometry Nodes modifier from Blender 5.2 on."""
    return getattr(modifier.properties.inputs, input_names(modifier.node_group)[name])


def modifier_input(modifier, name):
    """The value of an input of a Geometry Nodes modifier."""
    if hasattr(modifier, "properties"):
        return _input(modifier, name).value
    return modifier.get(input_names(modifier.node_group)[name])


def set_modifier_inputs(modifier, **values):
    """Gives inputs of a Geometry Nodes modifier these values."""
    for name, value in values.items():
        if hasattr(modifier, "properties"):
            _input(modifier, name).value = value
        else:
            modifier[input_names(modifier.node_group)[name]] = value
    modifier.id_data.update_tag()


def move_up(ob, modifier, place):
    """Moves a modifier to this place from the one below. A RuntimeError if the modifier there stays first."""
    if hasattr(ob.modifiers, "move"):
        ob.modifiers.move(place + 1, place)
    else:
        with bpy.context.temp_override(object=ob, active_object=ob):
            bpy.ops.object.modifier_move_to_index(modifier=modifier.name, index=place)


def is_rendering():
    return bpy.app.is_job_running("RENDER") if hasattr(bpy.app, "is_job_running") else False


def line_shader():
    """Blender's name of the shader of wide lines in colors."""
    return "POLYLINE_SMOOTH_COLOR" if bpy.app.version >= (4, 0) else "3D_POLYLINE_SMOOTH_COLOR"


def set_font_size(size):
    """In pixels."""
    if bpy.app.version >= (4, 0):
        blf.size(0, size)
    else:
        blf.size(0, int(size), 72)  # pyright: ignore[reportCallIssue]
