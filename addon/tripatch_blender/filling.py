# SPDX-License-Identifier: GPL-3.0-or-later
"""From rims of a BMesh to faces in it: everything is computed first, so that what is refused leaves the mesh untouched."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace

import bpy

from . import calls, outcomes, seam, selection, subdivision, writeback
from .library import index_lists, np, passages, tripatch, words
from .selection import NothingToFill, Surroundings, UnusableError

#: Condition of an object's matrix from which on float32, in which Blender has it, leaves no digit of its inverse.
SCALED_TO_NOTHING = 1e7


def world_matrix(name, matrix):
    """The (4, 4) array of an object's matrix; UnusableError if it cannot be inverted."""
    world = np.array(matrix, dtype=np.float64)
    if not np.isfinite(world).all() or not np.linalg.cond(world[:3, :3]) < SCALED_TO_NOTHING:
        raise UnusableError("scale_zero", name=name)
    return world


class _ToObject:
    """From world space to an object's own."""

    def __init__(self, world):
        self._world, self._inverse = world, np.linalg.inv(world[:3, :3])
        self._turn = world[:3, :3] * np.sign(np.linalg.det(world[:3, :3]))

    def points(self, p):
        return (p - self._world[:3, 3]) @ self._inverse.T

    def normals(self, n):
        n = n @ self._turn
        return n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-30)


def _tangent(report):
    """By side whether a fill is tangent to its surroundings; empty for one of no sides, such as the spline, or quads that
    continue as a grid."""
    if report.method == "polyharmonic_spline" or len(report.continuity) != max(len(report.corners), 1):
        return ()
    return tuple(each in ("G1", "G2") for each in report.continuity)


def _planned(bm, rim, world, fill, count):
    """A `Planned` fill; Refusal if its faces cannot be joined to the mesh. count: vertices that the fill counts as the mesh's."""
    own, vertex = _ToObject(world), {v.index: v for v in rim.vertices}
    planned = writeback.Planned(
        rim,
        fill,
        count,
        [vertex[v] for v in fill.rim.tolist()],
        own.points(fill.vertices),
        own.normals(fill.normals),
        own.normals(fill.rim_normals),
        _tangent(fill.report),
    )
    planned.moved = list(zip([vertex[v] for v in fill.moved[0].tolist()], own.points(fill.moved[1]), strict=True))
    obstacle = writeback.obstacle(bm, planned)
    if obstacle:
        raise tripatch.Refusal.of(obstacle)
    return planned


def _at_same_places(fill, in_key):
    """Where the vertices of a fill over a plane domain lie on the surface of the same hole in another shape, of another domain:
    at the places that have the same mean value coordinates in it."""
    first = in_key.rim.tolist().index(int(fill.rim[0]))
    rim = np.roll(in_key.rim_uv, -first, axis=0) if len(fill.loops) == 1 else in_key.rim_uv
    ends = np.stack([rim, rim[selection.following(fill.loops)]], axis=1).reshape(-1, 2)
    return in_key.patch.evaluate(tripatch.attribute_weights(fill)(ends))


def _in_shape_key(bm, planned, name, in_key, world):
    """Takes the fill of the same hole in a shape key, a Fill or a Refusal; returns notes."""
    own, fill = _ToObject(world), planned.fill
    cage = planned.cage
    if not isinstance(in_key, tripatch.Refusal) and cage:
        if index_lists(in_key.faces) != index_lists(fill.faces) or (in_key.split_edges[0] != fill.split_edges[0]).any():
            in_key = tripatch.Refusal.of(tripatch.Message("shape_key_other_faces"))
    elif (
        not isinstance(in_key, tripatch.Refusal)
        and in_key.report.method == "quad_rows"
        and index_lists(in_key.faces) == index_lists(fill.faces)
    ):
        planned.in_shape_keys[name] = own.points(in_key.vertices)
        return []
    elif not isinstance(in_key, tripatch.Refusal) and in_key.patch is None:
        in_key = tripatch.Refusal.of(tripatch.Message("shape_key_plain_triangles"))
    if isinstance(in_key, tripatch.Refusal):
        planned.in_shape_keys[name] = _moved_with_rim(planned, bm.verts.layers.shape[name])
        return [tripatch.Message("shape_key_follows_rim", {"name": name, "reason": words.refused(in_key)})]
    if fill.uv is not None:
        planned.in_shape_keys[name] = own.points(_at_same_places(fill, in_key))
        return []
    planned.in_shape_keys[name] = own.points(in_key.vertices if cage else in_key.patch.evaluate(fill.barycentric))
    if cage and (in_key.moved[0] == fill.moved[0]).all():
        planned.moved_in_shape_keys[name] = own.points(in_key.moved[1])
    return []


class _Whole:
    """All of a mesh without what rims replace, through which fills may pass."""

    def __init__(self, bm, world, rims):
        self._bm = bm
        self._points, offsets, corners = flat_arrays(bm, world)
        kept = np.ones(len(bm.faces), bool)
        kept[[f.index for rim in rims for f in rim.replaced]] = False
        self._faces, sizes = np.flatnonzero(kept), np.diff(offsets)
        self._corners, self._offsets = corners[np.repeat(kept, sizes)], np.concatenate([[0], np.cumsum(sizes[kept])])

    def passages(self, fills):
        """For each fill a place where it passes through the mesh or another fill, or None; of a Refusal None."""
        made = [k for k, fill in enumerate(fills) if not isinstance(fill, tripatch.Refusal)]
        points, corners, sizes, of_face = [self._points], [self._corners], [], [np.full(len(self._faces), -1)]
        count = known = len(self._points)
        for number, k in enumerate(made):
            faces = index_lists(fills[k].faces)
            own = np.array([v for face in faces for v in face], np.int64)
            corners.append(np.where(own < known, own, own - known + count))
            sizes += [len(face) for face in faces]
            points.append(fills[k].vertices)
            of_face.append(np.full(len(faces), number))
            count += len(fills[k].vertices)
        offsets = np.concatenate([self._offsets, self._offsets[-1] + np.cumsum(sizes, dtype=np.int64)])
        found = passages.of_faces(np.vstack(points), offsets, np.concatenate(corners), np.concatenate(of_face).tolist())
        places = dict(zip(made, found, strict=True))
        return [places.get(k) for k in range(len(fills))]

    def beside(self, fills):
        """Faces of the mesh that lie in the boxes of fills, however far their vertices are along its edges."""
        if not len(self._faces):
            return []
        own = self._points[self._corners]
        low, high = (each.reduceat(own, self._offsets[:-1]) for each in (np.minimum, np.maximum))
        near = np.zeros(len(self._faces), bool)
        for fill in fills:
            points = np.vstack([self._points[fill.rim], fill.vertices])
            near |= ((low <= points.max(axis=0)) & (high >= points.min(axis=0))).all(axis=1)
        self._bm.faces.ensure_lookup_table()
        return [self._bm.faces[k] for k in self._faces[near].tolist()]


def _plans(bm, rims, there, world, keys, options, around, cage, progress):
    """For each rim a `Planned` fill and notes on it, or a Refusal and none.

    there: the rims in the mesh of which `around` and `cage` are: the BMesh, or the cage that modifiers make of it.
    """
    positions, faces, replaced = around.around(*there)
    of_cage = {"subdivision": cage.near(faces)} if cage else {}
    fills = calls.fills(rims, (positions, faces, replaced), options, progress, **of_cage)
    places = [None] * len(rims)
    if not cage:
        whole = _Whole(bm, world, rims)
        places = whole.passages(fills)
        if any(places):  # the library goes another way, if there is one, where it knows what is in the way
            also = whole.beside([fill for fill, place in zip(fills, places, strict=True) if place])
            fills = calls.fills(rims, around.around(*there, also=also), options, progress)
            places = whole.passages(fills)
    results = []
    for rim, fill, place in zip(rims, fills, places, strict=True):
        if not isinstance(fill, tripatch.Refusal):
            try:
                fill = _planned(bm, rim, world, fill, len(positions))
                fill.cage, fill.passes_through = cage is not None, place
            except tripatch.Refusal as refusal:
                fill = refusal
        results.append((fill, []))
    for name, shape in keys.items():
        _plan_shape_key(bm, rims, results, name, shape, options.arguments | of_cage, world)
    return results


def by_method(method, arguments):
    """The arguments of the method that auto took, which said of the others that it did not apply them."""
    left_out = {"cap", *tripatch.options.not_taken(method, arguments)}
    return {name: value for name, value in arguments.items() if name not in left_out} | {"method": method}


def _asked_corners(plan, rim):
    """The corners with which the same hole is filled in another shape, so that auto takes the same way."""
    if plan.fill.report.cage_in_rows:  # which needs a hole without given corners
        return None
    if plan.fill.report.corners or plan.cage or rim.round:
        return plan.fill.report.corners
    return [v.index for v in rim.corners] or None


def _is_alike(plan, fill, arguments):
    """Whether the hole of a plan is filled in the same way in another shape, by these arguments."""
    if isinstance(fill, tripatch.Refusal):
        return False
    if fill.report.method != plan.fill.report.method or list(fill.report.corners) != list(plan.fill.report.corners):
        return False
    # A flat cap meets walls that lean outward at no sharp edges.
    return arguments.get("cap") == "flat" or writeback.has_lid(fill) == writeback.has_lid(plan.fill)


def _plan_shape_key(bm, rims, results, name, shape, arguments, world):
    """Fills the same holes in another shape, and adds that to the plans and the notes on them."""
    left = {k: plan for k, (plan, _) in enumerate(results) if not isinstance(plan, tripatch.Refusal)}
    if not left:
        return
    *in_shape, arguments["replaced"] = shape.around(*rims)
    loops = {k: [v.index for v in rims[k].loop] for k in left}
    same = {k: plan.fill.report.corners for k, plan in left.items()}
    method = {k: plan.fill.report.method for k, plan in left.items()}
    made = {}
    for k, plan in left.items():
        if guides := writeback.guides_of(plan):
            moved = _moved_with_rim(plan, bm.verts.layers.shape[name])[list(guides)]
            points = moved @ world[:3, :3].T + world[:3, 3]
            own = by_method(method[k], arguments)
            made[k] = calls.alone(
                in_shape, replace(rims[k], inside=[*guides.values()]), same[k], own, len(same[k] or ()) or 1, points
            )
        elif rims[k].islands:
            made[k] = calls.alone(in_shape, rims[k], None, by_method(method[k], arguments), 1)

    def fill(keys, corners, given):
        found = calls.shared_or_each(in_shape, [loops[k] for k in keys], [corners[k] for k in keys], given) if keys else []
        return zip(keys, found, strict=True)

    # What auto takes may differ from shape to shape: then the hole gets what it has in the mesh, by its name. Cages are compared
    # by their faces, since one that auto puts where the faces around continue is no method's own.
    asked = {k: _asked_corners(plan, rims[k]) for k, plan in left.items() if k not in made}
    made |= {k: each for k, each in fill([*asked], asked, arguments) if left[k].cage or _is_alike(left[k], each, arguments)}
    if arguments.get("method", "auto") == "auto":
        lids = [k for k in left if k not in made and writeback.has_lid(left[k].fill)]
        flat = arguments | {"cap": "flat"}
        made |= {k: each for k, each in fill(lids, asked, flat) if _is_alike(left[k], each, flat)}
    for each in sorted({method[k] for k in left if k not in made}):
        made |= fill([k for k in left if k not in made and method[k] == each], same, by_method(each, arguments))
    for k, plan in left.items():
        results[k][1].extend(_in_shape_key(bm, plan, name, made[k], world))


def _moved_with_rim(planned, layer):
    """The new vertices, moved as the rim is in a shape."""
    moved = selection.coordinates(planned.loop, layer) - selection.coordinates(planned.loop)
    blend = tripatch.attribute_weights(planned.fill)
    ends = np.stack([moved, moved[selection.following(planned.fill.loops)]], axis=1).reshape(-1, 3)
    return planned.positions + blend(ends)


def _shapes(bm, matrix, active_shape, count=0):
    """Surroundings in each shape key but the one whose shape the vertices have now; count: see Surroundings."""
    others = [(name, layer) for name, layer in bm.verts.layers.shape.items() if name != active_shape]
    return {name: Surroundings(bm, matrix, layer, count) for name, layer in others}


def _clear_of_each_other(rims):
    """The rims in groups that can be filled at once: no rim of a group has a vertex on another or on what another replaces."""
    groups = []
    for rim in rims:
        own = set(rim.vertices) | {v for f in rim.replaced for v in f.verts}
        for taken, group in groups:
            if not taken & own:
                taken |= own
                group.append(rim)
                break
        else:
            groups.append((own, [rim]))
    return [group for _, group in groups]


@contextmanager
def _progress(count):
    """A function for tripatch.fill_all that shows on the cursor how many of `count` holes are done."""
    window = bpy.context.window_manager
    window.progress_begin(0, count)
    try:
        yield lambda done, _: window.progress_update(done)
    finally:
        window.progress_end()


def _plan_group(bm, rims, matrix, options, active_shape, cages, modifier):
    """`_plans` in the BMesh, or of cages in what the modifier subdivides: modifiers before it may have added to the BMesh."""
    bm.verts.index_update()
    bm.faces.index_update()
    ob = modifier.id_data if modifier else None
    made = subdivision.cage_before(ob, bm, modifier, rims, options.mirrored) if modifier else bm
    try:
        there = [subdivision.in_cage(ob, made, bm, rim) for rim in rims]
        around, keys = Surroundings(made, matrix), _shapes(bm, matrix, active_shape, len(made.verts))
        cage = subdivision.Cage(made, modifier) if cages else None
        with _progress(len(rims)) as progress:
            return _plans(bm, rims, there, matrix, keys, options, around, cage, progress)
    finally:
        if made is not bm:
            made.free()


def refusals(bm, rims, matrix, options):
    """What would be said of rims that cannot be filled; nothing is changed."""
    plans = [
        plan for group in _clear_of_each_other(rims) for plan, _ in _plan_group(bm, group, matrix, options, None, False, None)
    ]
    return [words.refused(plan) for plan in plans if isinstance(plan, tripatch.Refusal)]


def _gathered(bm, said):
    """Sentences on holes, each once: of several with vertices of those that it is said of. said: [(loop, sentences)]."""
    if len(said) > 1 and any(sentences for _, sentences in said):
        bm.verts.index_update()
    return words.gathered([(min((v.index for v in loop if v.is_valid), default=0), sentences) for loop, sentences in said])


def fill_rims(bm, mesh, matrix, rims, options, active_shape=None, modifier=None, touching=()):
    """Fills rims of a BMesh; returns (Outcome, new faces). Cages of holes that touch each other are made one after the other, all
    others together.

    active_shape: name of the shape key whose shape the vertices have now; modifier: the Subdivision modifier, for cages.
    touching: other rims with which these share tangent planes, but for cages, and which stay open.
    """
    cages, outcome, new_faces = options.arguments.get("output") == "cage", outcomes.Outcome(), []
    if cages:
        outcome.cage_rim = options.arguments.get("cage_rim", "smooth")
        if outcome.cage_rim == "exact" and modifier is not None and not modifier.use_creases:
            raise UnusableError("exact_needs_creases", modifier=modifier.name)
    # What one rim replaces would be missing around another that it touches; cages are fitted to what cages before have changed.
    apart = cages or any(rim.replaced for rim in rims)
    planned, loops, said, made = [], [], [], []
    for group in _clear_of_each_other(rims) if apart else [rims]:
        usable = [rim for rim in group if all(element.is_valid for element in (*rim.vertices, *rim.replaced))]
        outcome.refused += [outcomes.Refused(tripatch.Message("boundary_replaced"))] * (len(group) - len(usable))
        if not usable:
            continue
        others = [] if apart else touching
        plans = _plan_group(bm, [*usable, *others], matrix, options, active_shape, cages, modifier if cages else None)
        for rim, (plan, notes) in zip(usable, plans[: len(usable)], strict=True):
            if isinstance(plan, tripatch.Refusal):
                where = list(plan.where) or [v.index for v in rim.loop]
                outcome.refused.append(outcomes.Refused(words.refused(plan), where, rim=rim))
                said.append((rim.loop, []))
                continue
            planned.append(plan)
            loops += plan.loops
            outcome.rim_edges.append(len(rim.vertices))
            if options.arguments.get("output", "triangles") != "triangles":
                outcome.diameters.append(diameter(rim.loop, matrix))
            outcome.reports.append(plan.fill.report)
            unknown = options.deviation and plan.fill.deviation is None
            said.append((plan.loop, [*plan.fill.report.warnings, *notes, *[tripatch.Message("no_error_estimate")] * unknown]))
            made.append((said[-1], len(plan.fill.faces)))
            outcome.passages.append(plan.passes_through)
        if planned and cages:
            new_faces += writeback.write(bm, mesh, planned, options)
            planned = []
    if planned:
        new_faces += writeback.write(bm, mesh, planned, options)
    if made and cages:
        outcome.passages = _passages_of_cages(bm, matrix, new_faces, [count for _, count in made], modifier)
    for ((loop, told), _), place in zip(made, outcome.passages, strict=True):
        told += passes(place, loop)
    new_faces = [face for face in new_faces if face.is_valid]
    outcome.notes += _gathered(bm, said)
    outcome.count([face.verts for face in new_faces], options.arguments.get("output"))
    if loops:
        seam.remember(bm, mesh.name, loops, angle=None if cages else words.seam_angle(outcome.reports))
    return outcome, new_faces


def _passages_of_cages(bm, matrix, new_faces, counts, modifier):
    """For each cage a place where its limit surface passes through that of the mesh that it is in now, or None. counts: how many
    of the new faces are its own; modifier: what subdivides them."""
    bm.verts.index_update()
    bm.faces.index_update()
    positions, offsets, corners = flat_arrays(bm, matrix)
    fill_of_face = np.full(len(bm.faces), -1)
    for face, fill in zip(new_faces, np.repeat(np.arange(len(counts)), counts).tolist(), strict=True):
        if face.is_valid:
            fill_of_face[face.index] = fill
    subdivided = subdivision.Cage(bm, modifier).near(_lists(offsets, corners))
    return passages.of_faces(positions, offsets, corners, fill_of_face.tolist(), subdivided)


def passes(place, loop):
    """What is said of a fill that passes through the mesh at a place; None: nothing."""
    return [tripatch.Message("fill_passes_through", {"place": words.place(place)}, [loop[0].index])] if place else []


def diameter(loop, matrix):
    """Of a hole, in the world: the largest distance of two vertices of its rim."""
    points = selection.coordinates(loop) @ matrix[:3, :3].T
    return float(max(np.linalg.norm(points - p, axis=1).max() for p in points))


def flat_arrays(bm, matrix):
    """Positions (n, 3) in the world of all of a BMesh, and offsets (m + 1,) of its faces into their corners. Indices must be up
    to date."""
    mesh = bpy.data.meshes.new("TriPatch")  # a copy is read ten times as fast as the BMesh
    try:
        bm.to_mesh(mesh)
        places, corners = np.empty(3 * len(mesh.vertices), np.float32), np.empty(len(mesh.loops), np.int32)
        sizes = np.empty(len(mesh.polygons), np.int32)
        mesh.vertices.foreach_get("co", places)
        mesh.loops.foreach_get("vertex_index", corners)
        mesh.polygons.foreach_get("loop_total", sizes)
    finally:
        bpy.data.meshes.remove(mesh)
    offsets = np.concatenate([[0], np.cumsum(sizes, dtype=np.int64)])
    return places.reshape(-1, 3).astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3], offsets, corners.astype(np.int64)


def mesh_arrays(bm, matrix):
    """Positions (n, 3) in the world and faces of all of a BMesh, for the library. Indices must be up to date."""
    positions, offsets, corners = flat_arrays(bm, matrix)
    sizes = np.diff(offsets)
    same = len(sizes) and sizes[0] in (3, 4) and (sizes == sizes[0]).all()
    return positions, corners.reshape(-1, sizes[0]) if same else _lists(offsets, corners)


def _lists(offsets, corners):
    return [face.tolist() for face in np.split(corners, offsets[1:-1])]


def _numbers(rim):
    return frozenset(v.index for v in rim.loop)


def _outer(bm, matrix):
    """The borders of a mesh that are left open as outer ones, as sets of vertex indices."""
    bm.verts.index_update()
    bm.faces.index_update()
    return {frozenset(loop.tolist()) for loop in tripatch.outer_borders(*mesh_arrays(bm, matrix))} if bm.faces else set()


def is_outer(bm, matrix, rim):
    """Whether a rim turns the other way than a hole, as an outer border does."""
    return tripatch.is_outer_border(*Surroundings(bm, matrix).around(rim)[:2], [v.index for v in rim.loop])


def without_outer(bm, matrix, rims):
    """Those of some rims that are meant if only a vertex of each is selected, or the faces around: no outer border. Rims whose
    edges are selected by themselves are all meant. NothingToFill if none is left."""

    def is_pointed_at(rim):
        edges = [e for e in selection.edges_of(bm, rim.loop) if e]
        among_faces = all(f.select for e in edges for f in e.link_faces)
        return not (rim.replaced or rim.corners) and (among_faces or not all(e.select for e in edges))

    asked = [rim for rim in rims if is_pointed_at(rim)]
    outer = _outer(bm, matrix) if asked else set()
    left = [rim for rim in asked if _numbers(rim) in outer]
    if left and len(left) == len(rims):
        raise NothingToFill([len(rim.loop) for rim in left], [v for rim in left for v in rim.loop])
    return [rim for rim in rims if rim not in left]


def filtered(bm, matrix, rims, filters):
    """Those of some rims that the filters of `tripatch.choose_holes` let through."""
    if not {"max_edges", "max_diameter", "corner_count"} & set(filters):
        return rims
    positions, faces, _ = Surroundings(bm, matrix).around(*rims)
    # The far borders of the faces around rims are no rims.
    with calls.saying_what_does_not_go():
        chosen = {frozenset(loop.tolist()) for loop in tripatch.choose_holes(positions, faces, **(filters | {"outer": True}))}
    return [rim for rim in rims if frozenset(v.index for v in rim.loop) in chosen]


def open_holes(bm, matrix, filters=None):
    """Every visible hole, of which the library says where a method does not fill it, and the outer borders that are left open.
    UnusableError if there is no hole. filters: arguments of `tripatch.choose_holes`."""
    filters = filters or {}
    outer = set() if filters.get("outer", False) else _outer(bm, matrix)
    visible = selection.all_rims(bm)
    left = [rim for rim in visible if _numbers(rim) in outer]
    every = [rim for rim in visible if rim not in left]
    if every and len(visible) > 1:
        every, outside = selection.join_islands(every, *mesh_arrays(bm, matrix), [rim.loop for rim in left], parts=True)
        left = [rim for rim in left if rim.loop in outside]
    if not every:
        hidden = any(e.is_boundary and e.hide for v in selection.border_vertices(bm) for e in v.link_edges)
        if hidden:
            raise UnusableError("holes_hidden" if left else "all_boundaries_hidden")
        raise NothingToFill([len(rim.loop) for rim in left], [v for rim in left for v in rim.loop])
    rims = filtered(bm, matrix, every, filters)
    if not rims:
        raise UnusableError("holes_filtered", [v for rim in every for v in rim.loop], count=len(every))
    return rims, left
