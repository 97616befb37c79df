# SPDX-License-Identifier: GPL-3.0-or-later
"""Custom normals of a BMesh, read and written as vectors.

Blender stores a custom normal relative to the fan of face corners around its vertex, so the faces of a fill would turn the
normals of their neighbors. Python cannot reach that encoding in a BMesh, but a small mesh with the same fans can decode and
encode it, and corners can be copied from one BMesh to another. Corners elsewhere keep their bits.
"""

from __future__ import annotations

import bmesh
import bpy

from . import versions
from .library import np
from .selection import by_index

_LAYERS = ("uv", "color", "float_color", "float_vector", "float", "int", "bool", "string")


def has_custom_normals(bm, mesh):
    return mesh.has_custom_normals or free_layer(bm) is not None


def free_layer(bm):
    """The layer of custom normals that are plain vectors (Blender 4.5 and newer), or None."""
    return bm.loops.layers.float_vector.get("custom_normal")


def _encoded_template(of):
    """A mesh of one triangle with the layer of encoded custom normals and every attribute that the corners of a mesh have."""
    mesh = bpy.data.meshes.new("TriPatch")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    for attribute in of.attributes:
        # A name with a dot is Blender's own, as the vertices of corners are.
        if attribute.domain == "CORNER" and not attribute.name.startswith(".") and attribute.name not in mesh.attributes:
            if attribute.name != "custom_normal":
                mesh.attributes.new(attribute.name, attribute.data_type, "CORNER")
    mesh.normals_split_custom_set([(0, 0, 1)] * 3)
    return mesh


def _copy_of(bm, faces, template):
    """A BMesh of these faces with the same fans: vertices, sharp edges, smooth faces, encoded normals."""
    copy = bmesh.new()
    copy.from_mesh(template)
    bmesh.ops.delete(copy, geom=copy.verts, context="VERTS")
    # A corner copied back brings a default for every layer that its own BMesh lacks.
    for kind in _LAYERS:
        for name in getattr(bm.loops.layers, kind).keys() if hasattr(bm.loops.layers, kind) else ():
            if name not in getattr(copy.loops.layers, kind):
                getattr(copy.loops.layers, kind).new(name)
    vertices = {}
    for face in faces:
        for v in face.verts:
            if v not in vertices:
                vertices[v] = copy.verts.new(v.co)
        twin = copy.faces.new([vertices[v] for v in face.verts])
        twin.smooth = face.smooth
        for loop, other in zip(face.loops, twin.loops, strict=True):
            other.edge.smooth = loop.edge.smooth
            other.copy_from(loop)  # from Blender 4 on this ends the validity of `other` in Python
    copy.normal_update()
    return copy


class _Scratch:
    """A mesh for decoding or encoding, removed again."""

    def __init__(self, bm, mesh, faces):
        self._template = _encoded_template(mesh)
        self.bm = _copy_of(bm, faces, self._template)
        self.mesh = bpy.data.meshes.new("TriPatch")

    def __enter__(self):
        self.bm.to_mesh(self.mesh)
        versions.use_custom_normals(self.mesh)
        return self

    def __exit__(self, *_):
        self.bm.free()
        bpy.data.meshes.remove(self.mesh)
        bpy.data.meshes.remove(self._template)

    def decoded(self):
        return versions.corner_normals(self.mesh).astype(np.float64)


def corner_normals(bm, mesh, vertices):
    """{face corner: unit normal} for all corners at these vertices."""
    free = free_layer(bm)
    if free is not None:
        return {loop: np.array(loop[free]) for v in vertices for loop in v.link_loops}
    faces = by_index({f for v in vertices for f in v.link_faces})
    with _Scratch(bm, mesh, faces) as scratch:
        values = scratch.decoded()
    at, normals = set(vertices), {}
    for loop, normal in zip((corner for f in faces for corner in f.loops), values, strict=True):
        if loop.vert in at:
            normals[loop] = normal
    return normals


def set_corner_normals(bm, mesh, normals):
    """Sets custom normals at all corners of some vertices: {face corner: unit normal}."""
    free = free_layer(bm)
    if free is not None:
        for loop, normal in normals.items():
            loop[free] = normal
        return
    # A closed fan is counted from its first face on, so the order of the faces matters.
    bm.faces.index_update()
    faces = by_index({f for loop in normals for f in loop.vert.link_faces})
    with _Scratch(bm, mesh, faces) as scratch:
        corners = [corner for f in faces for corner in f.loops]
        scratch.mesh.normals_split_custom_set([tuple(normals.get(corner, (0.0, 0.0, 0.0))) for corner in corners])
        encoded = bmesh.new()
        encoded.from_mesh(scratch.mesh)
        for loop, other in zip(corners, (corner for f in encoded.faces for corner in f.loops), strict=True):
            if loop in normals:
                # Different normals within one fan part it, as Blender does it: by a sharp edge.
                for edge, own in ((other.edge, loop.edge), (other.link_loop_prev.edge, loop.link_loop_prev.edge)):
                    if not edge.smooth:
                        own.smooth = False
                loop.copy_from(other)
        encoded.free()
