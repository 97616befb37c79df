# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group that joins a live fill to the mesh around it. It is plain Blender: files with it open without the add-on."""

from __future__ import annotations

from contextlib import suppress
from functools import cache

import bpy

from . import versions
from .selection import UnusableError

NAME = "Join Live Fill"
#: Of the shortest rim edge: what the merge may close. Both borders have the same positions to the bit of a float.
WITHIN = 1e-3


def group():
    """The node group of this file, made where it is missing. Only what lies at a border is merged: doubles inside of the mesh
    stay."""
    made = bpy.data.node_groups.get(NAME)
    if made is not None and made.bl_idname == "GeometryNodeTree" and {"Fill", "Distance"} <= set(versions.input_names(made)):
        return made
    made = bpy.data.node_groups.new(NAME, "GeometryNodeTree")
    versions.new_sockets(made, {"Geometry": "Geometry", "Fill": "Object", "Distance": "Float"})

    def node(kind, x, y, **settings):
        new = made.nodes.new(kind)
        new.location = (x, y)
        for name, value in settings.items():
            setattr(new, name, value)
        return new

    start, end = node("NodeGroupInput", -600, 0), node("NodeGroupOutput", 600, 0)
    fill = node("GeometryNodeObjectInfo", -400, -100, transform_space="ORIGINAL")
    join, merge = node("GeometryNodeJoinGeometry", -100, 0), node("GeometryNodeMergeByDistance", 400, 0)
    adjacent = node("GeometryNodeInputMeshEdgeNeighbors", -400, -400)
    one = node("FunctionNodeCompare", -200, -400, data_type="INT", operation="EQUAL")
    border = node("GeometryNodeFieldOnDomain", 100, -300, domain="EDGE", data_type="BOOLEAN")
    link = made.links.new
    link(start.outputs["Fill"], fill.inputs["Object"])
    link(fill.outputs["Geometry"], join.inputs[0])
    link(start.outputs["Geometry"], join.inputs[0])
    link(join.outputs[0], merge.inputs["Geometry"])
    link(start.outputs["Distance"], merge.inputs["Distance"])
    compared = [s for s in one.inputs if s.enabled]
    link(adjacent.outputs["Face Count"], compared[0])
    compared[1].default_value = 1  # pyright: ignore[reportAttributeAccessIssue]
    link(one.outputs[0], next(s for s in border.inputs if s.enabled))
    link(next(s for s in border.outputs if s.enabled), merge.inputs["Selection"])
    link(merge.outputs[0], end.inputs[0])
    return made


def _first(ob, modifier):
    """Moves a modifier to the top of the stack: what deforms or subdivides the mesh does so to the fill too. Returns the one that
    it cannot pass, or None."""
    while at := ob.modifiers.find(modifier.name):
        with suppress(RuntimeError):
            versions.move_up(ob, modifier, at - 1)
        if ob.modifiers.find(modifier.name) == at:
            return ob.modifiers[at - 1]
    return None


def _joining(ob):
    """The modifiers of an object that join fills to it."""
    found = [m for m in ob.modifiers if m.type == "NODES" and m.node_group and m.node_group.name.startswith(NAME)]
    return [m for m in found if "Fill" in versions.input_names(m.node_group)]


def _fill_of(modifier):
    return versions.modifier_input(modifier, "Fill")


def modifier_of(ob, fill):
    """The modifier that joins a fill to an object, or None."""
    return next((modifier for modifier in _joining(ob) if _fill_of(modifier) == fill), None)


def join(ob, fill, distance):
    """Makes an object show its mesh and a fill as one. UnusableError where another modifier stays before it, as Multiresolution
    does, whose details are those of the object's own mesh."""
    modifier = ob.modifiers.new(fill.name, "NODES")
    modifier.node_group = group()
    modifier.show_in_editmode = True
    versions.set_modifier_inputs(modifier, Fill=fill, Distance=float(distance))
    before = _first(ob, modifier)
    if before is not None:
        name = before.name
        ob.modifiers.remove(modifier)
        raise UnusableError("modifier_must_be_first", modifier=name, name=ob.name)
    return modifier


def by_groups(ob):
    """The first modifier of an object that goes by its vertex groups, or None."""
    for modifier in ob.modifiers if ob.vertex_groups else ():
        names = [p.identifier for p in modifier.bl_rna.properties if p.identifier.startswith("vertex_group")]
        if modifier.type == "ARMATURE" and modifier.use_vertex_groups or any(getattr(modifier, name) for name in names):
            return modifier
    return None


@cache
def keeps_groups():
    """Whether a mesh that is joined keeps its vertex groups: Blender 3.4 makes attributes of them. It is tried."""
    objects = []
    for name in ("TriPatch", "TriPatch Fill"):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
        objects.append(bpy.data.objects.new(name, mesh))
        objects[-1].vertex_groups.new(name="Group").add([0, 1, 2], 1, "REPLACE")
        bpy.context.scene.collection.objects.link(objects[-1])
    try:
        join(objects[0], objects[1], 0)
        evaluated = objects[0].evaluated_get(bpy.context.evaluated_depsgraph_get())
        kept = all(len(v.groups) for v in evaluated.to_mesh().vertices)
        evaluated.to_mesh_clear()
    finally:
        for ob in objects:
            bpy.data.meshes.remove(ob.data)  # and the object with it
    return kept


def part(ob, fill):
    """Ends that."""
    modifier = modifier_of(ob, fill)
    if modifier is not None:
        ob.modifiers.remove(modifier)


def remove_empty(is_deleted):
    """Removes the modifiers whose fill has been deleted. is_deleted: of an object that is still in the file."""
    for ob in bpy.data.objects if NAME in bpy.data.node_groups else ():
        if ob.library is None and ob.override_library is None:
            for modifier in _joining(ob):
                fill = _fill_of(modifier)
                if fill is None or is_deleted(fill):
                    ob.modifiers.remove(modifier)
