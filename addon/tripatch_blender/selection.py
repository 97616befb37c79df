# SPDX-License-Identifier: GPL-3.0-or-later
"""Which holes of a BMesh the user means: selection -> rims -> arrays around them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from itertools import chain, compress
from operator import attrgetter, itemgetter

import bmesh
from mathutils import Vector

from .library import np, tripatch, words

#: Of the extent of a rim: Blender's positions have seven digits.
SAME_PLACE = 1e-5
#: The option that fills outer borders, as the panel has it.
OUTER = "Outer Borders"
# Rings of faces around a rim that are handed to the library.
RINGS = tripatch.SURROUNDING_RINGS if tripatch else 0


class UnusableError(ValueError):
    """Nothing that is selected can be filled; the message says why. code: of the library's messages; vertices: BMVert that are
    concerned; rim: the Rim that it is about, if it is about one; parameters: of the message."""

    def __init__(self, code, vertices=(), rim=None, **parameters):
        self.vertices, self.rim = list(vertices), rim
        self._say(tripatch.Message(code, parameters, [v.index for v in self.vertices]))

    @classmethod
    def of(cls, said, vertices=()):
        """For a reason that the library gives: a message, or text."""
        made = cls.__new__(cls)
        made.vertices, made.rim = list(vertices), None
        made._say(said)
        return made

    def _say(self, said):
        self.said, self.code, self.args = said, getattr(said, "code", ""), (said,)


class NothingToFill(UnusableError):
    """There are outer borders at most. left: how many edges each of them has."""

    def __init__(self, left=(), vertices=(), option=OUTER):
        self.left, self.vertices, self.rim = list(left), list(vertices), None
        self._say(words.nothing_to_fill(self.left, option))


class OptionsError(ValueError):
    """Options that a person has chosen do not go together; the message says which."""

    vertices = ()

    @property
    def said(self):
        """What the message says, as of an `UnusableError`."""
        return self.args[0]


@dataclass
class Rim:
    """A hole to be filled, by vertices of the BMesh."""

    loop: list  # BMVert, in the direction in which new faces traverse the rim
    corners: list = field(default_factory=list)  # three BMVert that the user gave, or none
    first: object = None  # BMVert that is to be the first corner
    replaced: set = field(default_factory=set)  # BMFace of a region that the fill replaces
    round: bool = False  # it is to have no corners
    inside: list = field(default_factory=list)  # BMVert without faces that the fill goes through
    fill: int = 0  # the number of the earlier fill that is replaced, which says nothing of the surface
    islands: list = field(default_factory=list)  # further loops, of boundaries that one surface joins to the first

    @property
    def loops(self):
        return [self.loop, *self.islands]

    @property
    def vertices(self):
        return [v for loop in self.loops for v in loop]


def pairs(loop):
    """Each element of a closed list with the next."""
    return zip(loop, loop[1:] + loop[:1], strict=True)


def following(counts):
    """Of the elements of several closed lists, one after the other, the places of the next ones. counts: their lengths."""
    starts = [sum(counts[:k]) for k in range(len(counts))]
    return [first + (k + 1) % count for first, count in zip(starts, counts, strict=True) for k in range(count)]


def edges_of(bm, loop):
    """The edges of a loop of vertices, from each vertex to the next."""
    return [bm.edges.get((a, b)) for a, b in pairs(loop)]


def adjacent_sizes(bm, rims):
    """Counter of the numbers of corners of the faces that rims run along, but those that are replaced: one for each edge."""
    edges = [(edge, rim) for rim in rims for loop in rim.loops for edge in edges_of(bm, loop) if edge]
    return Counter(len(face.verts) for edge, rim in edges for face in edge.link_faces if face not in rim.replaced)


def by_index(elements):
    """Elements of a BMesh in its order."""
    return sorted(elements, key=attrgetter("index"))


def coordinates(vertices, shape=None):
    """(k, 3) of vertices of a BMesh, or of their places in a shape key, without a list of Vectors, of which NumPy makes an array
    ten times as slowly."""
    read = attrgetter("co") if shape is None else itemgetter(shape)
    return np.fromiter(chain.from_iterable(map(read, vertices)), np.float64).reshape(-1, 3)


def _loops(faces):
    """The border loops of some faces as lists of vertices."""
    vertices = by_index({v for f in faces for v in f.verts})
    number = {v: k for k, v in enumerate(vertices)}
    return [[vertices[k] for k in loop] for loop in tripatch.find_holes([[number[v] for v in f.verts] for f in faces])]


def border_loops(seeds) -> list:
    """The border loops of the mesh through the vertices `seeds`."""
    loops, done = [], set()
    for seed in by_index(seeds):
        if seed in done:
            continue
        border, stack = {seed}, [seed]
        while stack:
            vertex = stack.pop()
            for edge in vertex.link_edges:
                other = edge.other_vert(vertex)
                if edge.is_boundary and other not in border:
                    border.add(other)
                    stack.append(other)
        done |= border
        # All faces around the border: where they end on their other side there are loops too, but none through these vertices.
        faces = by_index({f for v in border for f in v.link_faces})
        loops += [loop for loop in _loops(faces) if border.issuperset(loop)]
    return loops


def is_hidden(bm, loop):
    return any(v.hide for v in loop) or any(e is not None and e.hide for e in edges_of(bm, loop))


def border_vertices(bm):
    """Those on a border of the mesh: of all loops over a mesh in Python the fastest, since it makes no lists of edges."""
    return list(compress(bm.verts, map(attrgetter("is_boundary"), bm.verts)))


def all_rims(bm):
    """Every visible border loop of the mesh, the shortest first."""
    loops = [loop for loop in border_loops(border_vertices(bm)) if not is_hidden(bm, loop)]
    return [Rim(loop) for loop in sorted(loops, key=lambda loop: (len(loop), min(v.index for v in loop)))]


def _regions(faces):
    """Faces, parted into regions that hang together by edges."""
    left = set(faces)
    for seed in faces:
        if seed not in left:
            continue
        left.discard(seed)
        region, stack = [seed], [seed]
        while stack:
            for edge in stack.pop().edges:
                for face in edge.link_faces:
                    if face in left:
                        left.discard(face)
                        region.append(face)
                        stack.append(face)
        yield by_index(region)


def _region_to_replace(region, holes, by_faces):
    """The rim of a region that is to be replaced, or None for one that only lies around selected holes."""
    held = {v for hole in holes for v in hole.vertices}
    border = [e for f in region for e in f.edges if e.is_boundary]
    if border and all(v in held for e in border for v in e.verts):
        return None
    # Selecting the vertices of a rim selects the faces that have no other vertices.
    if holes and not by_faces and all(v in held for f in region for v in f.verts):
        return None
    near = [region[0].verts[0].index]
    if border:
        raise UnusableError("faces_touch_border", [v for e in border for v in e.verts], near=near)
    loops = [loop[::-1] for loop in _loops(region)]
    vertices = [v for loop in loops for v in loop]
    if not loops or len(vertices) > len(set(vertices)):
        code = "faces_borders_touch" if loops else "faces_without_border"
        raise UnusableError(code, vertices or [v for f in region for v in f.verts], near=near)
    loop, *islands = sorted(loops, key=_extent, reverse=True)
    return Rim(loop, replaced=set(region), islands=islands)


def rims_of_faces(faces):
    """The rims of regions that are to be replaced."""
    return [_region_to_replace(region, [], True) for region in _regions(by_index(faces))]


def _extent(loop):
    return np.ptp(coordinates(loop), axis=0).max()


def join_islands(rims, positions, faces, others=(), parts=False):
    """Rims, of which those that lie in another one belong to it: one surface joins them. Indices must be up to date.

    positions, faces: of the mesh around them; others: loops of outer borders that may belong to a rim too; parts: only borders of
    different parts of the mesh do. Returns the rims, and the others that are left.
    """
    plain = [rim for rim in rims if not (rim.corners or rim.replaced or rim.round)]
    loops = [*(rim.loop for rim in plain), *others]
    if len(loops) < 2 or not plain:
        return rims, list(others)
    inside = tripatch.borders.islands_of(positions, faces, [[v.index for v in loop] for loop in loops], parts)
    joined, gone = {}, set()
    for k, held in enumerate(inside):
        if not held:
            continue
        outer, *islands = [loops[k], *(loops[i] for i in held)]
        rim = next((rim for rim in plain if rim.loop in (outer, *islands)), None)
        if rim is None:
            continue
        gone.update(i for i in (k, *held))
        joined[id(rim)] = Rim(outer, first=rim.first, inside=[v for i in (k, *held) if i < len(plain) for v in plain[i].inside])
        joined[id(rim)].islands = islands
    away = {id(plain[i]) for i in gone if i < len(plain)} - set(joined)
    left = [loop for i, loop in enumerate(others, len(plain)) if i not in gone]
    return [joined.get(id(rim), rim) for rim in rims if id(rim) not in away], left


def rim_of_fill(faces, number, corners):
    """The rim of an earlier fill, which is to be replaced. corners: the places of those that a person gave it."""
    loops, region = [loop[::-1] for loop in _loops(faces)], set(faces)
    if not loops:
        raise UnusableError("fill_without_boundary", [v for f in faces for v in f.verts])
    loop, *islands = sorted(loops, key=_extent, reverse=True)
    if any(len(e.link_faces) != 2 for f in faces for e in f.edges):
        raise UnusableError("fill_changed_around", loop)
    within = SAME_PLACE * np.ptp(coordinates(loop), axis=0).max()
    nearest = [min(loop, key=lambda v, at=at: (v.co - Vector(at)).length) for at in corners]
    kept = [v for v, at in zip(nearest, corners, strict=True) if (v.co - Vector(at)).length <= within]
    given = kept if len(kept) == len(corners) else []
    return Rim(loop, corners=given, replaced=region, fill=number, islands=islands)


def _no_hole(edges, vertices):
    """UnusableError: why the selection holds no rim."""
    if not vertices:
        return UnusableError("nothing_selected")
    if not edges:
        return UnusableError("vertices_not_on_border", vertices)
    for edge in edges:
        count = len(edge.link_faces)
        if count != 1:
            code = {0: "no_face_at_edge", 2: "faces_on_both_sides"}.get(count, "non_manifold_edge")
            return UnusableError(code, edge.verts, faces=count)
    return UnusableError("edges_bound_no_hole", vertices)


def _edges_alone(vertices):
    """The edges between some vertices if every one of them has one, else none."""
    held = set(vertices)
    edges = {e for v in held for e in v.link_edges if all(end in held for end in e.verts) and not e.hide}
    return edges if held == {v for e in edges for v in e.verts} else set()


def finish_edit(bm, mesh):
    """Ends every change of a mesh in edit mode as Blender's own operators do: with normals, selection and numbers up to date.
    `update_edit_mesh` sees to none of these."""
    bm.normal_update()
    bm.select_flush_mode()
    for elements in (bm.verts, bm.edges, bm.faces):
        elements.index_update()
    bmesh.update_edit_mesh(mesh)


def show(context, concerned):
    """Selects these vertices and nothing else, {object: indices}, in vertex mode where edge mode could not show them."""
    objects, bms = context.objects_in_mode_unique_data, {}
    for ob in objects:
        bms[ob] = bm = bmesh.from_edit_mesh(ob.data)
        bm.verts.ensure_lookup_table()
    count = {ob: len(bm.verts) for ob, bm in bms.items()}
    found = {ob: [bms[ob].verts[k] for k in where if 0 <= k < count[ob]] for ob, where in concerned.items() if ob in bms}
    found = {ob: [v for v in vertices if not v.hide] for ob, vertices in found.items()}
    if not any(found.values()):
        return
    tools = context.tool_settings
    by_edges = tools.mesh_select_mode[1] and all(map(_edges_alone, found.values()))
    if not (tools.mesh_select_mode[0] or by_edges):
        tools.mesh_select_mode = (True, False, False)
    for ob, bm in bms.items():
        if not by_edges:
            bm.select_mode |= {"VERT"}
        Selected(bm).replace(bm, [])
        vertices = found.get(ob, [])
        for element in (*vertices, *(_edges_alone(vertices) if by_edges else ())):
            element.select = True
        finish_edit(bm, ob.data)


#: Vertices that were selected the last time, by mesh: a slider of the last operator undoes it and runs it again with the same. Of
#: more than this many it takes no less time to look at each than to look for them.
_MAX_REMEMBERED = 10_000
_remembered: dict[str, list[int]] = {}


def _selected_vertices(bm, mesh):
    """In the order of the mesh. Blender counts them: those of the last time need not be looked for where they still are all."""
    if mesh.total_vert_sel == 0:
        return []
    last = _remembered.get(mesh.name, [])
    if len(last) == mesh.total_vert_sel and last[-1] < len(bm.verts):
        bm.verts.ensure_lookup_table()
        vertices = [bm.verts[k] for k in last]
        if all(v.select for v in vertices):
            return vertices
    return list(compress(bm.verts, map(attrgetter("select"), bm.verts)))


class Selected:
    """What is selected in a BMesh, in the order of the mesh. A selected edge or face has selected vertices, so that only these
    are looked for in all of a large mesh."""

    def __init__(self, bm, mesh=None):
        """mesh: that the BMesh is of, its indices up to date: where it is known, what was selected is remembered."""
        if mesh is None:
            self.vertices = list(compress(bm.verts, map(attrgetter("select"), bm.verts)))
        else:
            self.vertices = _selected_vertices(bm, mesh)
            _remembered.clear()
            if len(self.vertices) <= _MAX_REMEMBERED:
                _remembered[mesh.name] = [v.index for v in self.vertices]
        self.edges = by_index({e for v in self.vertices for e in v.link_edges if e.select})
        self.faces = by_index({f for e in self.edges for f in e.link_faces if f.select})

    def is_all(self, bm):
        """Whether everything that is visible is selected."""
        seen = all(v.select or v.hide for v in bm.verts)  # which mostly ends at once
        return seen and all(f.select or f.hide for f in bm.faces)  # a ring of faces may have all vertices

    def replace(self, bm, faces):
        """Selects these faces instead; `finish_edit` selects what goes with them."""
        for element in (*self.faces, *self.edges, *self.vertices):
            if element.is_valid:
                element.select = False
        bm.select_history.clear()
        for face in faces:
            face.select = True


def name_groups(ob, like):
    """Gives an object whose mesh is new the vertex groups that another has, by which the weights of its vertices are numbered:
    their names live in the mesh, and what writes a BMesh into it writes none."""
    for group in like.vertex_groups[len(ob.vertex_groups) :]:
        ob.vertex_groups.new(name=group.name)


def _part_of_border(count, loop, vertices):
    """UnusableError: no fill closes more than what is selected."""
    return UnusableError("part_of_border", vertices, Rim(loop), count=count, edges=len(loop))


def _are_corners(given, loop, joined):
    """Whether these selected vertices of a rim are its corners: two or more that no selected edge joins to others, or three that
    are no stretch of it, as three of four always are. joined: how many of its edges are selected."""
    if any(f.select for v in given for f in v.link_faces):
        return False
    if len(given) == 3:
        return joined < 2 or len(loop) == 4
    return len(given) > 1 and not any(e.select for v in given for e in v.link_edges)


def _apart(vertex, loop):
    """How far a vertex is from the middle of a loop, over how far the loop's own are."""
    middle = sum((v.co for v in loop[1:]), loop[0].co.copy()) / len(loop)
    return (vertex.co - middle).length / max(max((v.co - middle).length for v in loop), 1e-30)


def _put_inside(loose, rims):
    """Vertices without faces to the rims in which they are: to the nearest, within twice its radius."""
    for vertex in loose:
        apart, rim = min(((_apart(vertex, rim.loop), rim) for rim in rims), key=lambda pair: pair[0])
        if apart < 2:
            rim.inside.append(vertex)


def selected_rims(bm, selection):
    """The rims that the selection means, and an UnusableError for each selected part that means none.

    Whole border loops are holes. Isolated selected vertices of a loop, two or more, are its corners. Faces: each connected region
    by itself; one without mesh border in it is to be replaced. Else whatever border loop the selection touches. Vertices without
    faces are points inside, and so are those of edges without faces.
    """
    loose = [v for v in selection.vertices if not v.link_faces]
    vertices, edges, faces = selection.vertices, selection.edges, selection.faces
    if loose and len(loose) < len(vertices):
        alone = set(loose)
        vertices = [v for v in vertices if v not in alone]
        edges = [e for e in edges if not alone.intersection(e.verts)]
    active = bm.select_history.active
    selected = set(vertices)
    loops = border_loops(v for v in vertices if v.is_boundary)
    visible = [loop for loop in loops if not is_hidden(bm, loop)]

    rims, touched, parts, refused = [], [], [], []
    for loop in visible:
        given = [v for v in loop if v in selected]
        chosen = [e for e in edges_of(bm, loop) if e is not None and e.select]
        if len(chosen) == len(loop):
            rims.append(Rim(loop))
        elif "VERT" in bm.select_mode and _are_corners(given, loop, len(chosen)):
            rims.append(Rim(loop, corners=given))
        elif not chosen:
            touched.append(Rim(loop))
        elif not any(f.select for e in chosen for f in e.link_faces):  # else the region of these says it
            parts.append(_part_of_border(len(chosen), loop, given))
    for region in _regions(faces):
        try:
            rim = _region_to_replace(region, rims, "FACE" in bm.select_mode)
        except UnusableError as reason:
            refused.append(reason)
        else:
            rims += [rim] if rim else []
    if not rims and not refused:
        if not (touched or parts) or not all(e.is_boundary for e in edges):
            raise (UnusableError("boundary_hidden") if loops and not visible else _no_hole(edges, vertices))
        rims = [] if parts else touched
    refused += parts
    for rim in rims:
        if active in rim.loop:
            rim.first = active
    if rims:
        _put_inside(loose, rims)
    return rims, refused


def _turning(points):
    """By how much a loop (n, 3) turns to its inside at each point, as seen along its area: radians."""
    into, out = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    area = np.cross(points - points.mean(axis=0), out).sum(axis=0)
    area /= max(np.linalg.norm(area), 1e-30)
    return np.arctan2(np.cross(into, out) @ area, (into * out).sum(axis=1))


def span(rims, edges, offset):
    """Gives rims four corners, with so many edges from the first to the second, as Grid Fill does.

    The first is the active vertex, or where the corners turn most; so many vertices on with an offset. Rims that have corners
    keep them, but for the offset. Those with an odd number of edges stay."""
    for rim in rims:
        count, half = len(rim.loop), len(rim.loop) // 2
        if not rim.corners and not (rim.islands or rim.round or count % 2) and 0 < edges < half:
            steps = [0, edges, half, half + edges]
            turning = _turning(coordinates(rim.loop))
            most = int(np.sum([np.roll(turning, -k) for k in steps], axis=0)[:half].argmax())
            first = rim.loop.index(rim.first) if rim.first else most
            rim.corners = [rim.loop[(first + k) % count] for k in steps]
        rim.corners = [rim.loop[(rim.loop.index(v) + offset) % count] for v in rim.corners]
        rim.first = None if offset else rim.first


class Surroundings:
    """World positions of what lies around rims, in the vertex numbers of the BMesh, so that refusals name its vertices."""

    def __init__(self, bm, matrix, shape=None, count=0):
        """count: of the vertices, where there are more than those of the BMesh."""
        self._matrix, self._shape = matrix, shape
        self.positions = np.zeros((max(len(bm.verts), count), 3))

    def around(self, *rims, also=()):
        """(positions (n, 3), faces as index lists, indices of the replaced ones) for the faces around rims, and others."""
        front = [v for rim in rims for v in rim.vertices]
        seen, faces = set(front), set()
        filled = set().union(*(rim.replaced for rim in rims if rim.fill))
        for _ in range(RINGS):
            ring = {f for v in front for f in v.link_faces} - faces - filled
            faces |= ring
            front = {v for f in ring for v in f.verts} - seen
            seen |= front
        faces |= set(also) - filled
        seen.update(v for f in also for v in f.verts)
        ordered, near = by_index(faces), [*seen, *(v for rim in rims for v in rim.inside)]
        self.positions[[v.index for v in near]] = coordinates(near, self._shape) @ self._matrix[:3, :3].T + self._matrix[:3, 3]
        gone = set().union(*(rim.replaced for rim in rims))
        replaced = [k for k, f in enumerate(ordered) if f in gone]
        return self.positions, [[v.index for v in f.verts] for f in ordered], replaced
