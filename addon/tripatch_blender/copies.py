# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of the mesh of an object as it is now, in edit mode or as its shape keys mix it."""

from __future__ import annotations

import bmesh
import bpy

from . import layers
from .library import np
from .selection import UnusableError


def mixed(mesh):
    """The vertices (n, 3) of a mesh in object mode as its shape keys mix them."""
    count = len(mesh.vertices)

    def read(elements):
        values = np.empty(3 * count, np.float32)
        elements.foreach_get("co", values)
        return values.reshape(-1, 3)

    keys = mesh.shape_keys
    if not keys or not keys.key_blocks:
        return read(mesh.vertices)
    if not keys.use_relative:
        raise UnusableError("shape_keys_absolute")
    shapes = {key.name: read(key.data) for key in keys.key_blocks}
    positions = shapes[keys.reference_key.name].copy()
    for key in keys.key_blocks:
        if not key.mute and key.value and key != keys.reference_key:
            positions += key.value * (shapes[key.name] - shapes[key.relative_key.name]) * _weights(mesh, key)
    return positions


def _weights(mesh, key):
    """How much each vertex takes part in a shape key, 1 or (n, 1)."""
    owner = next((ob for ob in bpy.data.objects if ob.data == mesh), None)
    group = owner.vertex_groups.get(key.vertex_group) if owner and key.vertex_group else None
    if group is None:
        return 1
    held = [next((g.weight for g in v.groups if g.group == group.index), 0.0) for v in mesh.vertices]
    return np.array(held, np.float32)[:, None]


def _shown_key(ob):
    """The only shape key that the object shows, or None for the mix of all."""
    return ob.active_shape_key if ob.show_only_shape_key else None


def mesh_now(ob):
    """A new mesh with what an object's mesh is now."""
    if ob.mode == "EDIT":
        mesh = bpy.data.meshes.new("TriPatch")
        bmesh.from_edit_mesh(ob.data).to_mesh(mesh)
        return mesh
    co, only = mixed(ob.data), _shown_key(ob)
    if only is not None:
        only.data.foreach_get("co", flat := np.empty(3 * len(co), np.float32))
        co = flat
    mesh = ob.data.copy()
    mesh.vertices.foreach_set("co", co.ravel())
    return mesh


def copy(ob):
    """A BMesh of an object's mesh as it is now, without its other shapes, and the stand-ins in it, for layers.restore."""
    stand_ins: tuple = ([], None)
    if ob.mode == "EDIT" and not layers.aside(ob.data):
        bm = bmesh.from_edit_mesh(ob.data).copy()
    else:
        mesh = mesh_now(ob)
        try:
            stand_ins = layers.replaced(mesh)
            bm = bmesh.new()
            bm.from_mesh(mesh)
        finally:
            bpy.data.meshes.remove(mesh)
    for layer in list(bm.verts.layers.shape.values()):
        bm.verts.layers.shape.remove(layer)
    bm.verts.ensure_lookup_table()
    bm.verts.index_update()
    bm.faces.index_update()
    return bm, stand_ins
