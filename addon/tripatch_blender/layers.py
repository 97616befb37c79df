# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes that a BMesh cannot make new elements with.

Where a mesh has a FLOAT4X4 attribute, Blender (4.5 and 5.0 at least) ends with a segmentation fault as soon as Python makes an
element of its domain in a BMesh: giving the default value supposes an address that the block of an element need not have. While
elements are made the values stand in attributes of vectors.
"""

from __future__ import annotations

from contextlib import contextmanager

import bpy

from .library import np

STAND_IN = "TriPatch"
_PARTS = 6  # vectors that hold the 16 numbers of a matrix


def _matrices(mesh):
    return [attribute.name for attribute in mesh.attributes if attribute.data_type == "FLOAT4X4"]


def _replaced(mesh):
    """Matrices of a mesh in object mode become vectors; returns what `_restore` needs."""
    kept, active = [], mesh.attributes.active
    active = active.name if active else None
    for name in _matrices(mesh):
        attribute = mesh.attributes[name]
        domain, count = attribute.domain, len(attribute.data)
        values = np.zeros((count, 3 * _PARTS), np.float32)
        flat = np.empty(16 * count, np.float32)
        attribute.data.foreach_get("value", flat)
        values[:, :16] = flat.reshape(count, 16)
        mesh.attributes.remove(attribute)
        parts = []
        for k in range(_PARTS):
            part = mesh.attributes.new(STAND_IN, "FLOAT_VECTOR", domain)
            part.data.foreach_set("vector", values[:, 3 * k : 3 * k + 3].ravel())
            parts.append(part.name)
        kept.append((name, domain, parts))
    return kept, active


def _restore(mesh, replaced):
    kept, active = replaced
    for name, domain, parts in kept:
        values = []
        for part in parts:
            attribute = mesh.attributes[part]
            flat = np.empty(3 * len(attribute.data), np.float32)
            attribute.data.foreach_get("vector", flat)
            values.append(flat.reshape(-1, 3))
            mesh.attributes.remove(attribute)
        mesh.attributes.new(name, "FLOAT4X4", domain).data.foreach_set("value", np.hstack(values)[:, :16].ravel())
    if active and active in mesh.attributes:
        mesh.attributes.active = mesh.attributes[active]


@contextmanager
def _object_mode(context):
    """Out of edit mode and back, with all objects that are in it."""
    unselected = [ob for ob in context.objects_in_mode if not ob.select_get()]
    for ob in unselected:
        ob.select_set(True)  # else they would not enter edit mode again
    bpy.ops.object.mode_set(mode="OBJECT")
    try:
        yield
    finally:
        bpy.ops.object.mode_set(mode="EDIT")
        for ob in unselected:
            ob.select_set(False)


@contextmanager
def without_matrices(context, objects):
    """Objects in edit mode have vectors for matrices inside. A BMesh of before is not valid inside, nor one of inside after."""
    meshes = [ob.data for ob in objects if _matrices(ob.data)]
    if not meshes:
        yield
        return
    with _object_mode(context):
        replaced = [_replaced(mesh) for mesh in meshes]
    try:
        yield
    finally:
        with _object_mode(context):
            for mesh, kept in zip(meshes, replaced, strict=True):
                _restore(mesh, kept)


@contextmanager
def mesh_without_matrices(mesh):
    """The same for a mesh that is not in edit mode."""
    replaced = _replaced(mesh)
    try:
        yield
    finally:
        _restore(mesh, replaced)
