# SPDX-License-Identifier: GPL-3.0-or-later
"""The Subdivision modifier of an object: its settings and the creases of the cage, as the library takes them."""

from __future__ import annotations

import bmesh
import bpy

from . import versions
from .library import np
from .selection import Rim, UnusableError, coordinates, edges_of, name_groups

# Modifiers that leave every vertex and edge where it is.
_HARMLESS = {
    "COLLISION",
    "NORMAL_EDIT",
    "PARTICLE_SYSTEM",
    "SURFACE",
    "UV_PROJECT",
    "UV_WARP",
    "VERTEX_WEIGHT_EDIT",
    "VERTEX_WEIGHT_MIX",
    "VERTEX_WEIGHT_PROXIMITY",
    "WEIGHTED_NORMAL",
}
# Before a subdivision this leaves the object's own mesh, to which a cage's faces are added, where it is.
_HARMLESS_BEFORE = _HARMLESS | {"MIRROR"}
# After a subdivision these add faces elsewhere, or part faces, and move nothing.
_HARMLESS_AFTER = _HARMLESS | {"ARRAY", "EDGE_SPLIT", "MIRROR", "TRIANGULATE"}


def modifier_of(ob):
    """The first Subdivision modifier that the viewport shows, or None."""
    return next((m for m in ob.modifiers if m.type == "SUBSURF" and m.show_viewport), None)


def _is_shown(ob, modifier):
    """Whether the viewport shows what a modifier does, in the mode that its object is in."""
    return modifier.show_viewport and (ob.mode != "EDIT" or modifier.show_in_editmode)


def usable(ob, limit=False):
    """`modifier_of`, or UnusableError if it does not smooth, or (limit) if its surface is changed; for what changes the cage
    there is `cage_before`."""
    modifier = modifier_of(ob)
    if modifier is None:
        if limit:
            raise UnusableError("no_subdivision_modifier", name=ob.name)
        return None
    if modifier.subdivision_type != "CATMULL_CLARK":
        raise UnusableError("subdivision_simple", modifier=modifier.name, name=ob.name)
    before = True
    for other in ob.modifiers:
        if other == modifier:
            before = False
        elif other.show_viewport and limit and not before:
            if other.type not in _HARMLESS_AFTER or (other.type == "MIRROR" and any(other.use_bisect_axis)):
                raise UnusableError("modifier_changes_limit", modifier=other.name, name=ob.name)
    if limit and not level_of(modifier):
        raise UnusableError("subdivision_without_levels", modifier=modifier.name, name=ob.name)
    return modifier


def _evaluated(ob, bm, names, read):
    """What `read` takes from the mesh that these modifiers of an object make of a BMesh."""
    mesh = bpy.data.meshes.new("TriPatch")
    bm.to_mesh(mesh)
    twin = ob.copy()
    twin.data = mesh
    name_groups(twin, ob)
    bpy.context.scene.collection.objects.link(twin)
    try:
        for other in list(twin.modifiers):
            if other.name not in names:
                twin.modifiers.remove(other)
        evaluated = twin.evaluated_get(bpy.context.evaluated_depsgraph_get())
        result = read(evaluated.to_mesh())
        evaluated.to_mesh_clear()
    finally:
        bpy.data.objects.remove(twin)
        bpy.data.meshes.remove(mesh)
    return result


def _as_bmesh(mesh):
    made = bmesh.new()
    made.from_mesh(mesh)
    return made


def _points(mesh):
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def _stays(points, places):
    """Whether there is a point at each of some places, to what single precision leaves of their extent."""
    within = 1e-5 * max(np.ptp(places, axis=0).max(), 1e-12)
    near = points[((points > places.min(axis=0) - within) & (points < places.max(axis=0) + within)).all(axis=1)]
    return all(len(near) and np.abs(near - place).max(axis=1).min() <= within for place in places)


def _refuse_first(ob, bm, modifiers, places):
    """UnusableError: the first of some modifiers that does not leave the rim, which is at some places, where it is."""
    names = [m.name for m in modifiers]
    for k, modifier in enumerate(modifiers):
        points = _evaluated(ob, bm, names[: k + 1], _points)
        if not len(points):  # as a node group makes it whose output nothing is linked to
            raise UnusableError("modifier_leaves_nothing", modifier=modifier.name, name=ob.name)
        if not _stays(points, places):
            raise UnusableError("modifier_moves_boundary", modifier=modifier.name, name=ob.name)


def cage_before(ob, bm, modifier, rims=None, mirrored=False):
    """The cage that the modifiers before make of a BMesh: the BMesh itself, or a new one in which it comes first, vertices and
    faces (a mirror image follows it). UnusableError if they leave nothing of it.

    rims: of a cage that is to be filled in the BMesh itself: of what else modifiers do only that counts which moves them, in the
    mode that the object is in; mirrored: what a Mirror makes is in the BMesh already.
    """
    stack = list(ob.modifiers)
    changing = [m for m in stack[: stack.index(modifier)] if m.show_viewport and m.type not in _HARMLESS]
    changing = [m for m in changing if not (mirrored and m.type == "MIRROR")]
    if rims is not None:
        changing = [m for m in changing if _is_shown(ob, m)]
        places = coordinates(v for rim in rims for v in rim.loop)
        others = [m for m in changing if m.type not in _HARMLESS_BEFORE]
        names = [m.name for m in changing]
        if others and not _stays(_evaluated(ob, bm, names, _points), places):
            _refuse_first(ob, bm, changing, places)
        changing = [m for m in changing if m not in others]
    if not changing:
        return bm
    made = _evaluated(ob, bm, [m.name for m in changing], _as_bmesh)
    for elements in (made.verts, made.edges, made.faces):
        elements.ensure_lookup_table()
        elements.index_update()
    same = len(made.verts) >= len(bm.verts) and len(made.faces) >= len(bm.faces)
    if not same or any([v.index for v in f.verts] != [v.index for v in g.verts] for f, g in zip(bm.faces, made.faces)):
        made.free()
        raise UnusableError("modifier_changes_cage", modifier=changing[0].name, name=ob.name)
    return made


def in_cage(ob, cage, bm, rim):
    """The rim of a BMesh in the cage that modifiers make of it."""
    if cage is bm:
        return rim
    vertex = {v: cage.verts[v.index] for v in (*rim.loop, *rim.corners, *([rim.first] if rim.first else []))}
    loop = [vertex[v] for v in rim.loop]
    replaced = {cage.faces[f.index] for f in rim.replaced}
    for edge, a in zip(edges_of(cage, loop), loop, strict=True):
        if edge is None or len([f for f in edge.link_faces if f not in replaced]) != 1:
            raise UnusableError("modifier_closes_hole", [bm.verts[a.index]], name=ob.name)
    return Rim(loop, [vertex[v] for v in rim.corners], vertex.get(rim.first), replaced, fill=rim.fill)


def level_of(modifier):
    """Subdivisions in the viewport."""
    render = bpy.context.scene.render
    return min(modifier.levels, render.simplify_subdivision) if render.use_simplify else modifier.levels


def edge_crease_layer(bm):
    """The layer of edge creases, which is made where it is missing; handles of other layers may end."""
    return versions.crease_layer(bm.edges, "edge", create=True)


class Cage:
    """What a BMesh and a Subdivision modifier (or None: a new one) say about the limit surface. Indices must be up to date."""

    def __init__(self, bm, modifier):
        self._settings, self._edges, self._vertices = {}, {}, {}
        creased = True
        if modifier is not None:
            self._settings = {
                "boundary_smooth": modifier.boundary_smooth.lower(),
                "quality": modifier.quality,
                "use_limit_surface": modifier.use_limit_surface,
            }
            creased = modifier.use_creases
        self.creased = creased
        edges, vertices = versions.crease_layer(bm.edges, "edge"), versions.crease_layer(bm.verts, "vert")
        if edges and creased:
            self._edges = {frozenset(v.index for v in e.verts): min(max(e[edges], 0.0), 1.0) for e in bm.edges if e[edges] > 0}
        if vertices and creased:
            self._vertices = {v.index: min(max(v[vertices], 0.0), 1.0) for v in bm.verts if v[vertices] > 0}
        self._loose = {v.index for e in bm.edges if e.is_wire for v in e.verts}

    def near(self, faces):
        """The argument `subdivision` of tripatch.fill for some of the faces, as index lists."""
        used = {v for f in faces for v in f}
        edges = {}
        if self._edges:
            present = {frozenset(pair) for f in faces for pair in zip(f, f[1:] + f[:1], strict=True)}
            edges = {edge: value for edge, value in self._edges.items() if edge in present}
        vertices = {v: value for v, value in self._vertices.items() if v in used}
        return dict(
            self._settings,
            edge_creases=(np.array([sorted(e) for e in edges], np.int64).reshape(-1, 2), np.array(list(edges.values()))),
            vertex_creases=(np.array(list(vertices), np.int64), np.array(list(vertices.values()))),
            loose_vertices=np.array(sorted(self._loose & used), np.int64),
        )


def add_modifier(ob):
    """A new Subdivision modifier, with the settings that Blender gives it and two levels."""
    modifier = ob.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 2
    return modifier


_SETTINGS = ("subdivision_type", "levels", "quality", "boundary_smooth", "use_limit_surface", "use_creases", "uv_smooth")


def evaluated_points(bm, modifier):
    """(n, 3) float32: what the modifier makes of a BMesh, by Blender itself."""
    mesh = bpy.data.meshes.new("TriPatch")
    bm.to_mesh(mesh)
    ob = bpy.data.objects.new("TriPatch", mesh)
    bpy.context.scene.collection.objects.link(ob)
    try:
        twin = ob.modifiers.new("Subdivision", "SUBSURF")
        for name in _SETTINGS:
            setattr(twin, name, getattr(modifier, name))
        evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
        made = evaluated.to_mesh()
        points = np.empty(3 * len(made.vertices), np.float32)
        made.vertices.foreach_get("co", points)
        evaluated.to_mesh_clear()
    finally:
        bpy.data.objects.remove(ob)
        bpy.data.meshes.remove(mesh)
    return points.reshape(-1, 3)
