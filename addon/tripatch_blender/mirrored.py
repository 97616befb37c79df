# SPDX-License-Identifier: GPL-3.0-or-later
"""Holes that a Mirror modifier cuts in half, or two in quarters: the mesh has one part of the rim, the modifier makes the others.

The surroundings of the part are mirrored into the BMesh for a moment, so that the hole is whole and is filled as any other; then
the fill is cut where it meets its images, and what was only there for the moment goes again.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import bmesh
import bpy
from mathutils import Matrix, Vector

from . import filling, normals, outcomes, selection
from .library import tripatch

# Of the mean length of a fill's edges: vertices that are nearer to the mirror plane are put on it, else slivers would be cut.
_NEAR = 0.25
# Cosine of the angle of two mirror planes: below it they are perpendicular, and one maps the other on itself.
_PERPENDICULAR = 1e-4
# Scene units: vertices that a cut puts on a mirror plane are as near, and a Mirror that merges nothing still has them on it.
_ON = 1e-6
_NONE = frozenset()
#: What is said of a border that is_joined.


@dataclass
class _Plane:
    """A mirror plane in an object's own space."""

    point: Vector
    normal: Vector
    within: float  # vertices that are as near count as on it
    flipped: dict = field(default_factory=dict)  # vertex groups, by number, that the modifier exchanges, as .L and .R

    def height(self, co):
        return (co - self.point).dot(self.normal)

    def on(self, co):
        return co - self.height(co) * self.normal

    def image(self, co):
        return co - 2 * self.height(co) * self.normal


def _flipped(ob):
    """{number of a vertex group: of the one of the other side} of an object, by their names."""
    number = {group.name: group.index for group in ob.vertex_groups}
    other = {group.index: number.get(bpy.utils.flip_name(group.name)) for group in ob.vertex_groups}
    return {own: flipped for own, flipped in other.items() if flipped not in (own, None)}


def planes_of(ob):
    """The mirror planes of the Mirror modifiers that join a mesh to its image."""
    for modifier in ob.modifiers:
        if modifier.type != "MIRROR" or not (modifier.show_viewport and modifier.use_mirror_merge):
            continue
        other, flipped = modifier.mirror_object, _flipped(ob) if modifier.use_mirror_vertex_groups else {}
        matrix = ob.matrix_world.inverted_safe() @ other.matrix_world if other else Matrix()
        for axis in range(3):
            if modifier.use_axis[axis]:
                normal = matrix.to_3x3().inverted_safe().transposed().col[axis].normalized()  # pyright: ignore[reportIndexIssue]
                yield _Plane(matrix.translation.copy(), normal, max(modifier.merge_threshold, _ON), flipped)


def is_joined(ob, rim):
    """Whether a Mirror modifier joins an edge of a rim to its image: then it is no hole, or a half of one."""
    for plane in planes_of(ob):
        on_plane = [abs(plane.height(v.co)) <= plane.within for v in rim.loop]
        if any(a and b for a, b in selection.pairs(on_plane)):
            return True
    return False


def _chain(start, on_planes):
    """The border vertices from one on a plane, along an edge off it, to the next on a plane; empty where that is not clear.

    on_planes: {vertex: the set of numbers of planes on which it is}.
    """

    def is_cut(edge):
        a, b = edge.verts
        return bool(on_planes.get(a, _NONE) & on_planes.get(b, _NONE))

    chain = [start]
    ahead = [e for e in start.link_edges if e.is_boundary and not is_cut(e)]
    if len(ahead) != 1:
        return []
    edge = ahead[0]
    while True:
        chain.append(edge.other_vert(chain[-1]))
        if chain[-1] in on_planes:
            return chain
        further = [e for e in chain[-1].link_edges if e.is_boundary and e is not edge]
        if len(further) != 1:
            return []
        edge = further[0]


def _border(bm, selected):
    """The vertices of the borders that the selected ones are on, or of all where none is selected."""
    if not selected:
        return selection.border_vertices(bm)
    stack = [v for v in selected if v.is_boundary]
    border = set(stack)
    while stack:
        for edge in stack.pop().link_edges:
            for other in edge.verts if edge.is_boundary else ():
                if other not in border:
                    border.add(other)
                    stack.append(other)
    return border


def half_rims(ob, bm, selected):
    """[(planes, chain of vertices)] of the holes that a Mirror cuts in half, or two in quarters: those with a selected vertex, or
    else all.

    Between two of them on one plane the mesh lies on it; a mesh that only touches the plane has none.
    """
    planes = list(planes_of(ob))
    if not planes:  # then no border is looked for
        return []
    on_planes, joined = {}, set()
    for v in _border(bm, selected):
        held = {k for k, plane in enumerate(planes) if abs(plane.height(v.co)) <= plane.within}
        if held:
            on_planes[v] = held
    for v, held in on_planes.items():
        if any(e.is_boundary and held & on_planes.get(e.other_vert(v), _NONE) for e in v.link_edges):
            joined.add(v)
    found, done = [], set()
    for start in selection.by_index(joined):
        if start in done:
            continue
        chain = _chain(start, on_planes)
        if not chain or chain[-1] not in joined or chain[-1] is start:
            continue
        done |= {chain[0], chain[-1]}
        between = _planes_between(planes, on_planes[chain[0]], on_planes[chain[-1]])
        inside = chain[1:-1]
        if between and (not selected or (any(v.select for v in inside) if inside else all(v.select for v in chain))):
            found.append((between, chain))
    return found


def _planes_between(planes, first, last):
    """The plane on which both ends of a chain are, or the two of them; none where these are not perpendicular."""
    if first & last:
        return [planes[min(first & last)]]
    pair = [planes[min(first)], planes[min(last)]]
    return pair if abs(pair[0].normal.dot(pair[1].normal)) < _PERPENDICULAR else []


def _around(vertices):
    """The faces around that a fill reads."""
    front, seen, faces = list(vertices), set(vertices), set()
    for _ in range(selection.RINGS):
        ring = {f for v in front for f in v.link_faces} - faces
        faces |= ring
        front = {v for f in ring for v in f.verts} - seen
        seen |= front
    return selection.by_index(faces)


def _weights(bm, vertex):
    """Of a vertex in its vertex groups, as a dictionary that is of use when they have changed."""
    layer = bm.verts.layers.deform.active
    return dict(vertex[layer].items()) if layer else {}


def _give_weights(bm, vertex, weights):
    layer = bm.verts.layers.deform.active
    vertex[layer].clear()
    for group, weight in weights.items():
        vertex[layer][group] = weight


def _evened(weights, flipped):
    """Weights on a mirror plane, where the Mirror modifier gives both groups of a pair their mean."""
    of_both = {**weights, **{flipped[group]: 0.0 for group in weights if flipped.get(group, group) not in weights}}
    return {group: (weight + of_both[flipped.get(group, group)]) / 2 for group, weight in of_both.items()}


def _even_out(bm, vertices, plane):
    """Gives vertices on a mirror plane the weights that they are seen with. Returns what they had."""
    had = {v: _weights(bm, v) for v in vertices} if plane.flipped else {}
    for v, weights in had.items():
        _give_weights(bm, v, _evened(weights, plane.flipped))
    return had


def _add_image(bm, faces, plane):
    """Mirrors faces into the BMesh, joined to it on the plane. Returns the new vertices."""
    edges, own = {e for f in faces for e in f.edges}, {v for f in faces for v in f.verts}
    made = bmesh.ops.duplicate(bm, geom=[*faces, *edges, *own])
    vertices = [g for g in made["geom"] if isinstance(g, bmesh.types.BMVert)]
    copies = [g for g in made["geom"] if isinstance(g, bmesh.types.BMFace)]
    original = {made["vert_map"][v]: v for v in own}
    for v in vertices:
        v.co = plane.image(v.co)
        for layer in bm.verts.layers.shape.values():
            v[layer] = plane.image(v[layer])
        if plane.flipped:
            _give_weights(bm, v, {plane.flipped.get(group, group): weight for group, weight in _weights(bm, v).items()})
    bmesh.ops.reverse_faces(bm, faces=copies)
    on_plane = {v: original[v] for v in vertices if abs(plane.height(original[v].co)) <= plane.within}
    bmesh.ops.weld_verts(bm, targetmap=on_plane)
    return [v for v in vertices if v.is_valid]


def _whole_rim(chain):
    """The rim of the whole hole once the image is there, or None."""
    held = set(chain)
    loops = [loop for loop in selection.border_loops(chain[1:2]) if held <= set(loop)]
    return selection.Rim(loops[0]) if len(loops) == 1 else None


@contextmanager
def image_of(bm, half):
    """The Rim of the whole hole inside, with the images of its surroundings in the BMesh, and a function that cuts new faces and
    returns those of this part."""
    planes, chain = half
    sides = [1 if sum(plane.height(v.co) for v in chain) > 0 else -1 for plane in planes]
    bm.faces.index_update()
    around, image, had = _around(chain), [], {}
    for plane in planes:
        had = _even_out(bm, _on_plane(chain, plane), plane) | had
        images = selection.by_index({f for v in image for f in v.link_faces})
        image += _add_image(bm, [*around, *images], plane)
        bm.verts.index_update()
        bm.faces.index_update()
    cut = []

    def keep(faces):
        for plane, side in zip(planes, sides, strict=True):
            faces = _cut(bm, faces, plane, side, set(image) | set(chain))
            _put_shapes_on(bm, faces, plane, chain)
            _even_out(bm, _new_on_plane(faces, plane, chain), plane)
        cut.extend(faces)
        return cut

    try:
        yield _whole_rim(chain), keep
    finally:
        bmesh.ops.delete(bm, geom=[v for v in image if v.is_valid], context="VERTS")
        for v, weights in had.items():
            _give_weights(bm, v, weights)
        bm.verts.index_update()
        bm.faces.index_update()
        cut[:] = [f for f in cut if f.is_valid]


def fill(bm, mesh, matrix, half, options, outer=True, active=None, modifier=None):
    """Fills a hole that a Mirror cuts in half. Returns (Outcome, new faces), or (None, []) for the outer border of a mesh
    where that is left. active, modifier: see filling.fill_rims."""
    told = _NormalsOnPlane(bm, mesh, half[0], [half[1][0], half[1][-1]])
    try:
        return _fill(bm, mesh, matrix, half, options, told, outer, active, modifier)
    finally:
        told.write()


def fill_halves(ob, bm, matrix, halves, options, outer, active=None, modifier=None):
    """Fills the holes that a Mirror modifier cuts in half. Returns (Outcome, new faces, chains of the holes that were
    filled). outer: outer borders too."""
    outcome, new_faces, filled = outcomes.Outcome(), [], []
    for half in halves:
        made, faces = fill(bm, ob.data, matrix, half, options, outer, active, modifier)
        if made is None:
            continue
        new_faces += faces
        for each in made.refused:
            each.ob = ob
        outcome.add(made)
        if made.reports:
            filled.append(half[1])
    return outcome, new_faces, filled


def _fill(bm, mesh, matrix, half, options, told, outer, active, modifier):
    own = [v.index for v in half[1]]
    with image_of(bm, half) as (rim, keep):
        told.write()
        if rim is None:
            return outcomes.Outcome(refused=[outcomes.Refused(tripatch.Message("mirrored_hole_unclear"), own)]), []
        if not outer and filling.is_outer(bm, matrix, rim):
            return None, []
        options = replace(options, mirrored=True)
        outcome, new_faces = filling.fill_rims(bm, mesh, matrix, [rim], options, active, modifier)
        new_faces = keep(new_faces)
        told.read(new_faces)
        outcome.count([face.verts for face in new_faces], options.arguments.get("output"))
    for each in outcome.refused:
        each.vertices = own
    return outcome, new_faces


def _on_plane(chain, plane):
    """The ends of the rim that are on a mirror plane."""
    return [v for v in (chain[0], chain[-1]) if abs(plane.height(v.co)) <= plane.within]


def _new_on_plane(faces, plane, chain):
    """The new vertices of some faces that are on it."""
    return [v for v in {v for f in faces for v in f.verts} - set(chain) if abs(plane.height(v.co)) <= _ON]


def _put_shapes_on(bm, faces, plane, chain):
    """New vertices on a mirror plane are on it in all shapes in which the ends of the rim are."""
    ends = _on_plane(chain, plane)
    layers = [layer for layer in bm.verts.layers.shape.values() if all(abs(plane.height(v[layer])) <= plane.within for v in ends)]
    for v in _new_on_plane(faces, plane, chain):
        for layer in layers:
            v[layer] = plane.on(v[layer])


class _NormalsOnPlane:
    """Custom normals come from the faces around a vertex: they are computed again while images are there, and once more when
    these are gone."""

    def __init__(self, bm, mesh, planes, ends):
        self._bm, self._mesh, self._planes, self._ends = bm, mesh, planes, ends
        self._told = normals.has_custom_normals(bm, mesh) and normals.free_layer(bm) is None
        self._smooth = {e: e.smooth for v in ends for e in v.link_edges}
        self._values = {}  # by face and vertex: writing ends the validity of a corner
        self._take(ends)

    def _take(self, vertices):
        if self._told:
            found = normals.corner_normals(self._bm, self._mesh, vertices)
            self._values = {(corner.face, corner.vert): normal for corner, normal in found.items()}

    def read(self, new_faces):
        """With the images, at new vertices too."""
        on_planes = {v for f in new_faces for v in f.verts if any(abs(p.height(v.co)) <= p.within for p in self._planes)}
        self._take(on_planes | set(self._ends))

    def write(self):
        for edge, smooth in self._smooth.items() if self._told else ():
            edge.smooth = smooth  # images are of no account for what parts normals now
        left = {(f, v): n for (f, v), n in self._values.items() if f.is_valid and v.is_valid}
        if left:
            corners = {next(c for c in f.loops if c.vert == v): n for (f, v), n in left.items()}
            normals.set_corner_normals(self._bm, self._mesh, corners)


def _cut(bm, faces, plane, side, old):
    """Cuts the faces of a fill at the plane and removes those beyond it; returns those that stay."""
    inside = {v for f in faces for v in f.verts} - old
    edges = {e for f in faces for e in f.edges}
    near = _NEAR * sum(e.calc_length() for e in edges) / max(len(edges), 1)
    for v in inside:
        if abs(plane.height(v.co)) < near:
            v.co = plane.on(v.co)
    new_edges = {e for e in edges if any(v in inside for v in e.verts) or not e.is_boundary}
    count = {len(f.verts) for f in faces}
    geometry = [*faces, *new_edges, *{v for f in faces for v in f.verts}]
    bm.normal_update()  # Blender cuts faces by theirs
    made = bmesh.ops.bisect_plane(bm, geom=geometry, dist=_ON, plane_co=plane.point, plane_no=plane.normal)
    for element in made["geom_cut"]:
        if isinstance(element, bmesh.types.BMVert):
            element.co = plane.on(element.co)
    pieces = {f for f in (*faces, *made["geom"]) if isinstance(f, bmesh.types.BMFace) and f.is_valid}
    beyond = [f for f in pieces if side * plane.height(f.calc_center_median()) < 0]
    kept = pieces - set(beyond)
    bmesh.ops.delete(bm, geom=beyond, context="FACES")
    if count == {3}:
        larger = [f for f in kept if len(f.verts) > 3]
        kept -= set(larger)
        kept |= set(bmesh.ops.triangulate(bm, faces=larger)["faces"]) if larger else set()
    return selection.by_index(f for f in kept if f.is_valid)
