# SPDX-License-Identifier: GPL-3.0-or-later
"""What the node Smooth Fill shows: each node has a hidden tree that joins its input with a fill, a mesh object in no scene.

The tree is plain Blender, so that a file opened without the add-on still shows the last fill. Objects can share a node, as
copies of an object do: the tree has a fill for each different input, and compares the input to know which one fits.
"""

from __future__ import annotations

import zlib
from typing import Any

import bmesh
import bpy

from . import calls, copies, filling, joining, layers, live, selection, sentences, versions, writeback
from .library import np, tripatch
from .selection import NothingToFill, UnusableError

ID = "TriPatchSmoothFillNode"
NAME = ".Smooth Fill"
_STATE, _PROBLEM = "tripatch_state", "tripatch_problem"
_KINDS = {"Mesh": "Geometry", "Max Edges": "Int", "Density": "Int", "Bulge": "Float"}
#: The numbers of the node: value, least value, tooltip.
_GIVEN = {
    "Max Edges": (64, 0, "Skip holes with more boundary edges (0: fill all)"),
    "Density": (0, 0, "Edges of the new triangles along a side, or extra rows of quads (0: as the boundary)"),
    "Bulge": (1.0, 0.0, "How far the fill bulges (1: as the surrounding surface continues)"),
}
#: What inputs are distinguished by: the mean of the positions along a direction that no symmetry of a model has.
_ALONG = (0.5403, 0.2919, 0.7892)
#: Of the size of an input: by how much that mean may differ, which Blender computes in single precision.
_SAME = 1e-5


def new_tree():
    """A hidden tree that shows its input as it is."""
    tree = bpy.data.node_groups.new(NAME, "GeometryNodeTree")
    versions.new_sockets(tree, _KINDS)
    for name, (value, least, about) in _GIVEN.items():
        socket: Any = versions.input_socket(tree, name)
        socket.default_value, socket.min_value, socket.description = value, least, about
    tree[_STATE] = ""
    joining.group()  # now, in the step of undo that adds the node
    _show(tree, [])
    return tree


def _nodes(tree) -> list[Any]:
    """The nodes Smooth Fill of a tree."""
    return [node for node in tree.nodes if node.bl_idname == ID and node.node_tree is not None]


def trees():
    """Names of the hidden trees of this file."""
    return [tree.name for tree in bpy.data.node_groups if _STATE in tree and tree.library is None]


def part_copies():
    """Gives copies of nodes and of their trees hidden trees of their own; returns their names. That cannot be done while Blender
    copies: users of data-blocks are not counted yet."""
    seen, made = set(), []
    for tree in bpy.data.node_groups:
        for node in _nodes(tree) if tree.library is None else ():
            if node.node_tree.name in seen:
                node.node_tree = new_tree()
                made.append(node.node_tree.name)
            seen.add(node.node_tree.name)
    return made


def problem_of(node):
    """What the node could not fill, or nothing."""
    return node.node_tree.get(_PROBLEM, "") if node.node_tree else ""


def _modifiers(objects):
    """(object, modifier, node) of the nodes in modifiers of some objects."""
    for ob in objects:
        for modifier in getattr(ob, "modifiers", ()):
            if modifier.type == "NODES" and modifier.node_group:
                for node in _nodes(modifier.node_group):
                    yield ob, modifier, node


def used_by(blocks):
    """Names of the hidden trees that some data-blocks show."""
    objects = [block for block in blocks if isinstance(block, bpy.types.Object)]
    return {node.node_tree.name for _, _, node in _modifiers(objects)}


# The hidden tree.


def _show(tree, fills):
    """Builds the nodes of a hidden tree.

    fills: (object of the fill, distance to merge within, `_signature` of the input, {name: value} of the sockets).
    """
    tree.nodes.clear()

    def node(kind, x, **settings):
        new = tree.nodes.new(kind)
        new.location = (x, -200 * len(tree.nodes))
        for name, value in settings.items():
            setattr(new, name, value)
        return new

    def compared(value: Any, wanted, within=None):
        kind = {"data_type": "INT", "operation": "EQUAL"} if within is None else {"data_type": "FLOAT", "operation": "EQUAL"}
        made = node("FunctionNodeCompare", -200, **kind)
        given = [socket for socket in made.inputs if socket.enabled]
        tree.links.new(value, given[0])
        given[1].default_value = wanted
        if within is not None:
            given[2].default_value = within
        return made.outputs[0]

    def all_of(conditions):
        first, *rest = conditions
        for each in rest:
            both = node("FunctionNodeBooleanMath", 0, operation="AND")
            tree.links.new(first, both.inputs[0])
            tree.links.new(each, both.inputs[1])
            first = both.outputs[0]
        return first

    start, end = node("NodeGroupInput", -600), node("NodeGroupOutput", 600)
    shown = start.outputs["Mesh"]
    sizes: Any = None
    mean_of = None
    if len(fills) > 1:
        size = node("GeometryNodeAttributeDomainSize", -400)
        tree.links.new(start.outputs["Mesh"], size.inputs[0])
        sizes = size.outputs
        place = node("GeometryNodeInputPosition", -600)
        along = node("ShaderNodeVectorMath", -500, operation="DOT_PRODUCT")
        along.inputs[1].default_value = _ALONG
        tree.links.new(place.outputs[0], along.inputs[0])
        mean = node("GeometryNodeAttributeStatistic", -400)
        tree.links.new(start.outputs["Mesh"], mean.inputs[0])
        tree.links.new(along.outputs["Value"], next(s for s in mean.inputs if s.enabled and s.name == "Attribute"))
        mean_of = next(s for s in mean.outputs if s.enabled and s.name == "Mean")
    for fill, distance, (points, faces, middle, tolerance), values in fills:
        joined = node("GeometryNodeGroup", 200, node_tree=joining.group())
        joined.inputs["Fill"].default_value, joined.inputs["Distance"].default_value = fill, distance
        tree.links.new(start.outputs["Mesh"], joined.inputs["Geometry"])
        if len(fills) == 1:  # one step late rather than none while the input moves
            shown = joined.outputs[0]
            continue
        fits = [
            compared(sizes["Point Count"], points),
            compared(sizes["Face Count"], faces),
            compared(mean_of, middle, tolerance),
        ]
        fits += [compared(start.outputs[name], v, 1e-6 if name == "Bulge" else None) for name, v in values.items()]
        choice = node("GeometryNodeSwitch", 400, input_type="GEOMETRY")
        sockets = [socket for socket in choice.inputs if socket.enabled]
        tree.links.new(all_of(fits), sockets[0])
        tree.links.new(shown, sockets[1])
        tree.links.new(joined.outputs[0], sockets[2])
        shown = next(socket for socket in choice.outputs if socket.enabled)
    tree.links.new(shown, end.inputs[0])


def _fills_of(tree):
    """The objects whose meshes a hidden tree joins."""
    groups = [node for node in tree.nodes if node.bl_idname == "GeometryNodeGroup"]
    return list(dict.fromkeys(node.inputs["Fill"].default_value for node in groups if node.inputs["Fill"].default_value))


# The input.


def _users(name):
    """[(object, modifier, node)] that show a hidden tree."""
    return [user for user in _modifiers(bpy.data.objects) if user[2].node_tree.name == name and not live.is_deleted(user[0])]


def _value(modifier, node, name):
    """What an input of the node is: its own number, or that of the modifier it is linked to."""
    socket = node.inputs[name]
    if not socket.is_linked:
        return socket.default_value
    source = socket.links[0].from_socket
    if source.node.bl_idname != "NodeGroupInput":
        raise UnusableError("node_input_computed", name=name)
    return versions.modifier_input(modifier, source.name)


def _tree_of_input(node):
    """A copy of the node's tree that ends where the node's mesh comes from; None if nothing is linked to it."""
    if not node.inputs["Mesh"].is_linked:
        return None
    tree = node.id_data.copy()
    source = tree.nodes[node.name].inputs["Mesh"].links[0].from_socket
    end = next((n for n in tree.nodes if n.bl_idname == "NodeGroupOutput" and n.is_active_output), None)
    if end is None:
        bpy.data.node_groups.remove(tree)
        return None
    tree.links.new(source, end.inputs[0])
    return tree


def _input_mesh(ob, modifier, node):
    """A new mesh with what goes into the node, or None. It is evaluated in a scene of its own, of which the user's sees nothing:
    what both would share would count as changed there."""
    tree = _tree_of_input(node)
    if tree is None:
        return None
    now = bpy.context.scene
    scene, copy = bpy.data.scenes.new("TriPatch"), ob.copy()
    data = None
    try:
        if ob.type == "MESH":
            data = copy.data = copies.mesh_now(ob)
        scene.frame_current, scene.frame_subframe = now.frame_current, now.frame_subframe
        live.forget(copy)
        at = ob.modifiers.find(modifier.name)
        for each in list(copy.modifiers)[at + 1 :]:
            copy.modifiers.remove(each)
        copy.modifiers[at].node_group = tree
        copy.hide_viewport = False
        scene.collection.objects.link(copy)
        layer = scene.view_layers[0]
        layer.update()
        return bpy.data.meshes.new_from_object(
            copy.evaluated_get(layer.depsgraph), preserve_all_data_layers=True, depsgraph=layer.depsgraph
        )
    finally:
        bpy.data.objects.remove(copy)
        if data is not None:
            bpy.data.meshes.remove(data)
        bpy.data.scenes.remove(scene)
        bpy.data.node_groups.remove(tree)


def _arrays(mesh):
    """Positions (n, 3) and the vertices of the corners of a mesh."""
    places, corners = np.empty(3 * len(mesh.vertices), np.float32), np.empty(len(mesh.loops), np.int32)
    mesh.vertices.foreach_get("co", places)
    mesh.loops.foreach_get("vertex_index", corners)
    return places.reshape(-1, 3), corners


def _signature(mesh, places):
    """(points, faces, mean of the positions along a direction, tolerance) by which the hidden tree knows an input again."""
    far = float(np.abs(places).max(initial=0))
    mean = float((places.astype(np.float64) @ _ALONG).mean()) if len(places) else 0.0
    return len(mesh.vertices), len(mesh.polygons), mean, _SAME * far


# Filling.


def _arguments(bm, rims, values):
    """Of tripatch.fill: quads among quads, triangles among triangles. Density 0 leaves it to the library."""
    given = calls.matching_faces(selection.adjacent_sizes(bm, rims)) | {"bulge": max(values["Bulge"], 1e-3)}
    return given | {"resolution": values["Density"] if values["Density"] > 0 else None}


def _fill_mesh(fill, ob, mesh, values):
    """Gives an object the fills of all holes; returns (distance to merge within, sentences on holes that are not filled)."""
    stand_ins = layers.replaced(mesh)
    bm = bmesh.new()
    try:
        bm.from_mesh(mesh)
        for elements in (bm.verts, bm.faces):
            elements.ensure_lookup_table()
            elements.index_update()
        matrix = filling.world_matrix(ob.name, ob.matrix_world)
        limit = {"max_edges": values["Max Edges"]} if values["Max Edges"] > 0 else {}
        try:
            rims, _ = filling.open_holes(bm, matrix, limit)
        except (NothingToFill, UnusableError):
            rims = []
        shortest = min(((a.co - b.co).length for rim in rims for a, b in selection.pairs(rim.loop)), default=0.0)
        new, refused = [], []
        if rims:
            with writeback.layers_of_fills(bm):
                outcome, new = filling.fill_rims(bm, mesh, matrix, rims, calls.Options(_arguments(bm, rims, values)))
            refused = [sentences.of_filled(each.sentence) for each in outcome.refused]
        live.write(fill, bm, set(new), mesh)
    finally:
        bm.free()
    layers.restore(fill.data, stand_ins)
    return joining.WITHIN * shortest, refused


def follow(name):
    """Fills what goes into the node of a hidden tree, if that has changed; whether it did."""
    tree = bpy.data.node_groups.get((name, None))
    if tree is None or _STATE not in tree:
        return False
    users = _users(name)
    inputs, states = [], []
    try:
        for ob, modifier, node in users:
            mesh = _input_mesh(ob, modifier, node)
            if mesh is None:
                continue
            values = {each: _value(modifier, node, each) for each in _GIVEN}
            places, corners = _arrays(mesh)
            state = zlib.crc32(np.array([*values.values()], np.float64), zlib.crc32(corners, zlib.crc32(places)))
            state = zlib.crc32(np.array(ob.matrix_world, np.float64)[:3, :3].copy(), state)
            if state in states:
                bpy.data.meshes.remove(mesh)
                continue
            states.append(state)
            inputs.append((ob, mesh, values, _signature(mesh, places)))
        state = " ".join(map(str, sorted(states)))
        if not users:
            tree[_STATE], tree[_PROBLEM] = "", sentences.said("node_in_group")
        if not inputs or tree[_STATE] == state:
            return False
        tree[_STATE] = state
        _fill(tree, inputs)
        return True
    except (UnusableError, tripatch.Refusal, ValueError) as reason:
        tree[_PROBLEM] = sentences.for_people(reason)
        return False
    finally:
        for _, mesh, _, _ in inputs:
            bpy.data.meshes.remove(mesh)


#: {name of a hidden tree: names of its objects that were made between steps of undo}
_made: dict[str, list[str]] = {}


def before_undo():
    """Removes the objects that were made between steps: undo would free them, and the trees would keep their pointers to them
    (`live.write`). They are made again afterwards."""
    for name, objects in _made.items():
        tree = bpy.data.node_groups.get((name, None))
        if tree is not None and _STATE in tree:
            for ob in _fills_of(tree):
                if ob.name in objects:
                    bpy.data.meshes.remove(ob.data)  # and the object with it
            tree[_STATE] = ""
    _made.clear()


def _fill(tree, inputs):
    objects, fills, problems = _fills_of(tree), [], []
    for k, (ob, mesh, values, signature) in enumerate(inputs):
        if k == len(objects):
            objects.append(bpy.data.objects.new(NAME, bpy.data.meshes.new(NAME)))
            _made.setdefault(tree.name, []).append(objects[k].name)
        distance, refused = _fill_mesh(objects[k], ob, mesh, values)
        fills.append((objects[k], distance, signature, values))
        problems += refused
    if len(fills) == 1 and _fills_of(tree) == objects[:1]:
        joined = next(node for node in tree.nodes if node.bl_idname == "GeometryNodeGroup")
        joined.inputs["Distance"].default_value = fills[0][1]
    else:
        _show(tree, fills)
    for ob in objects[len(fills) :]:
        bpy.data.meshes.remove(ob.data)  # and the object with it
    some = {"count": len(problems), "reason": problems[0]} if problems else {}
    tree[_PROBLEM] = sentences.said("some_holes_not_filled", **some) if some else ""
