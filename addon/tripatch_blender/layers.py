# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes that a BMesh cannot make new elements with, or that Python cannot read in it.

Where a mesh has a FLOAT4X4 attribute, Blender (4.5 and 5.0 at least) ends with a segmentation fault as soon as Python makes an
element of its domain in a BMesh: giving the default value supposes an address that the block of an element need not have. Other
types have no layer in Python, so that nothing could be blended, nor given to new face corners. While elements are made the values
stand in attributes that can be read.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass

import bpy

from . import versions
from .library import np

STAND_IN = "TriPatch"


@dataclass(frozen=True)
class _Type:
    """How the values of a type stand in attributes of another."""

    width: int  # numbers of a value
    stand_in: str
    parts: int  # attributes of the other type
    each: int  # numbers that each of them holds
    field: str  # of the type's own data
    domains: tuple  # where it has to stand aside


# Length of a blend of quaternions that point against each other: less is what float32 leaves of a sum of ones, and no direction.
_CANCELLED = 1e-6

_CORNER, _POINT = ("CORNER",), ("POINT",)
_ALL = ("POINT", "EDGE", "FACE", "CORNER")
_TYPES = {
    "FLOAT4X4": _Type(16, "FLOAT_VECTOR", 6, 3, "value", _ALL),
    "QUATERNION": _Type(4, "FLOAT_VECTOR", 2, 3, "value", _POINT + _CORNER),
    # at points an example gives them
    "INT8": _Type(1, "INT", 1, 1, "value", _CORNER),
    "INT16_2D": _Type(2, "INT", 2, 1, "value", _CORNER),
    "INT32_2D": _Type(2, "INT", 2, 1, "value", _CORNER),
    "FLOAT2": _Type(2, "FLOAT_VECTOR", 1, 3, "vector", _POINT),
}
_FIELDS = {"FLOAT_VECTOR": "vector", "INT": "value"}
if not versions.UV_MAPS_ARE_ATTRIBUTES:
    _TYPES["FLOAT2"] = _Type(2, "FLOAT_VECTOR", 1, 3, "vector", _POINT + _CORNER)
if not versions.HAS_BOOLEAN_LAYERS:
    _TYPES["BOOLEAN"] = _Type(1, "INT", 1, 1, "value", _CORNER)


def aside(mesh):
    """Names of the attributes that have to stand aside, but Blender's own."""
    return [
        attribute.name
        for attribute in mesh.attributes
        if (kind := _TYPES.get(attribute.data_type))
        and attribute.domain in kind.domains
        and attribute.name != "custom_normal"
        and not attribute.name.startswith(".")
    ]


def _numbers(attribute, field, width, whole):
    flat = np.empty(width * len(attribute.data), np.int32 if whole else np.float32)
    attribute.data.foreach_get(field, flat)
    return flat.reshape(-1, width)


def replaced(mesh):
    """The stand-ins of a mesh in object mode take over; returns what `restore` needs."""
    kept, active = [], mesh.attributes.active
    active = active.name if active else None
    for name in aside(mesh):
        attribute = mesh.attributes[name]
        domain, data_type = attribute.domain, attribute.data_type
        kind = _TYPES[data_type]
        whole = kind.stand_in == "INT"
        given = _numbers(attribute, kind.field, kind.width, whole and data_type != "BOOLEAN")
        values = np.zeros((len(given), kind.parts * kind.each), given.dtype)
        values[:, : kind.width] = given
        mesh.attributes.remove(attribute)
        parts = []
        for k in range(kind.parts):
            part = mesh.attributes.new(STAND_IN, kind.stand_in, domain)
            own = np.ascontiguousarray(values[:, kind.each * k : kind.each * (k + 1)])
            part.data.foreach_set(_FIELDS[kind.stand_in], own.astype(np.int32 if whole else np.float32).ravel())
            parts.append(part.name)
        kept.append((name, domain, data_type, parts, given))
    return kept, active


def restore(mesh, stand_ins):
    """The attributes themselves again, in that mesh or one that was made of it."""
    kept, active = stand_ins
    for name, domain, data_type, parts, given in kept:
        kind, values = _TYPES[data_type], []
        for part in parts:
            attribute = mesh.attributes[part]
            values.append(_numbers(attribute, _FIELDS[kind.stand_in], kind.each, kind.stand_in == "INT"))
            mesh.attributes.remove(attribute)
        values = np.ascontiguousarray(np.hstack(values)[:, : kind.width])
        if data_type == "QUATERNION":
            values = _normalized(values, given)
        mesh.attributes.new(name, data_type, domain).data.foreach_set(kind.field, values.ravel())
    if active and active in mesh.attributes:
        mesh.attributes.active = mesh.attributes[active]


def _normalized(values, given):
    """Blended quaternions at length 1; those that the mesh had keep theirs."""
    row = np.dtype((np.void, 4 * values.itemsize))
    # plus zero: Blender 5.1 makes 0 of -0
    old = np.isin((values + 0).view(row).ravel(), (np.ascontiguousarray(given, values.dtype) + 0).view(row).ravel())
    length = np.linalg.norm(values, axis=1, keepdims=True)
    return np.where(old[:, None] | (length < _CANCELLED), values, values / np.maximum(length, _CANCELLED)).astype(np.float32)


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
def standing_aside(context, objects):
    """Objects in edit mode have stand-ins inside. A BMesh of before is not valid inside, nor one of inside after."""
    meshes = [ob.data for ob in objects if aside(ob.data)]
    if not meshes:
        yield
        return
    with _object_mode(context):
        stand_ins = [replaced(mesh) for mesh in meshes]
    try:
        yield
    finally:
        with _object_mode(context):
            for mesh, kept in zip(meshes, stand_ins, strict=True):
                restore(mesh, kept)


@contextmanager
def mesh_standing_aside(mesh):
    """The same for a mesh that is not in edit mode."""
    stand_ins = replaced(mesh)
    try:
        yield
    finally:
        restore(mesh, stand_ins)
