# SPDX-License-Identifier: GPL-3.0-or-later
"""From rims of a BMesh to faces in it: everything is computed first, so that what is refused leaves the mesh untouched."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field

import bpy

from . import seam, selection, subdivision, writeback
from .library import np, tripatch, words
from .selection import Surroundings, UnusableError

#: Methods that fill holes with any number of corners.
ANY_RIM = ("auto", "polyharmonic_spline")


@dataclass
class Options:
    """Options of a fill: those of tripatch.fill, and what only Blender has."""

    arguments: dict = field(default_factory=dict)  # of tripatch.fill
    corner_offset: int = 0  # steps along the rim
    shading: str = "neighbors"  # "neighbors", "smooth", "flat"
    deviation: bool = False  # how well the new vertices are known, as attributes


@dataclass
class Outcome:
    """What became of the holes of one mesh or of several."""

    reports: list = field(default_factory=list)  # tripatch.Report of each filled hole
    refused: list = field(default_factory=list)  # sentences
    notes: list = field(default_factory=list)  # sentences on holes that were filled
    faces: int = 0
    cage_rim: str = ""  # of fills that are cages
    beside: list = field(default_factory=list)  # names of objects made
    live: list = field(default_factory=list)  # names of live fills made

    def add(self, other, name=""):
        prefix = f"{name}: " if name else ""
        self.reports += other.reports
        self.refused += [prefix + sentence for sentence in other.refused]
        self.notes += [prefix + sentence for sentence in other.notes]
        self.faces += other.faces
        self.cage_rim = other.cage_rim or self.cage_rim
        self.beside += other.beside
        self.live += other.live

    def sentence(self):
        """'Filled 2 holes; seam within 0.3 deg (surroundings known to 0.3 deg)'"""
        told = {"cage_rim": self.cage_rim, "quads": self.faces, "limit": bool(self.beside), "into": self.beside + self.live}
        return words.filled(self.reports, **told)


def world_matrix(name, matrix):
    """The (4, 4) array of an object's matrix; UnusableError if it cannot be inverted."""
    world = np.array(matrix, dtype=np.float64)
    if not np.isfinite(world).all() or not np.linalg.cond(world[:3, :3]) < 1e7:
        raise UnusableError(f"{name} is scaled to nothing along an axis; apply or correct its scale")
    return world


def corners_of(rim, loop, mesh, replaced, offset):
    """The corners to fill with, as vertex indices, or None for the library to find them."""
    first = rim.first.index if rim.first else None
    if rim.corners:
        corners = [v.index for v in rim.corners]
    elif first is None and not offset:
        return None
    else:
        corners = tripatch.find_corners(*mesh, loop, replaced=replaced).tolist()
    places = [loop.index(v) for v in corners]
    if first is not None:
        # The active vertex is the first corner: one of the three, or it takes the place of the nearest.
        count, active = len(loop), loop.index(first)
        steps = [min((p - active) % count, (active - p) % count) for p in places]
        nearest = steps.index(min(steps))
        places = [active] + [p for k, p in enumerate(places) if k != nearest]
    return [loop[(p + offset) % len(loop)] for p in places]


class _ToObject:
    """From world space to an object's own."""

    def __init__(self, world):
        self._world, self._inverse = world, np.linalg.inv(world[:3, :3])
        self._turn = world[:3, :3] * np.sign(np.linalg.det(world[:3, :3]))

    def points(self, p):
        return (p - self._world[:3, 3]) @ self._inverse.T

    def normals(self, n):
        n = n @ self._turn
        return n / np.linalg.norm(n, axis=1, keepdims=True)


def _planned(bm, rim, world, fill, count):
    """A `Planned` fill; Refusal if its faces cannot be joined to the mesh. count: vertices that the fill counts as the mesh's."""
    own, vertex = _ToObject(world), {v.index: v for v in rim.loop}
    planned = writeback.Planned(
        rim,
        fill,
        count,
        [vertex[v] for v in fill.rim.tolist()],
        own.points(fill.vertices),
        own.normals(fill.normals),
        own.normals(fill.rim_normals),
        tuple(continuity in ("G1", "G2") for continuity in fill.report.continuity),
    )
    planned.moved = list(zip([vertex[v] for v in fill.moved[0].tolist()], own.points(fill.moved[1]), strict=True))
    obstacle = writeback.obstacle(bm, planned)
    if obstacle:
        raise tripatch.Refusal(obstacle, [])
    return planned


def _in_shape_key(bm, planned, name, in_key, world):
    """Takes the fill of the same hole in a shape key, a Fill or a Refusal; returns notes."""
    own, fill = _ToObject(world), planned.fill
    cage = planned.cage
    if not isinstance(in_key, tripatch.Refusal) and cage:
        if in_key.faces != fill.faces or (in_key.split_edges[0] != fill.split_edges[0]).any():
            in_key = tripatch.Refusal("its cage would have other faces", [])
    if isinstance(in_key, tripatch.Refusal):
        planned.in_shape_keys[name] = _follow_rim(planned, bm.verts.layers.shape[name])
        return [f"Shape key '{name}' follows its rim only: {words.refused(in_key)}"]
    if fill.uv is not None:  # a plane domain is laid out for one shape
        planned.in_shape_keys[name] = _follow_rim(planned, bm.verts.layers.shape[name])
        return [f"Shape key '{name}' follows its rim only"]
    planned.in_shape_keys[name] = own.points(in_key.vertices if cage else in_key.patch.evaluate(fill.barycentric))
    if cage and (in_key.moved[0] == fill.moved[0]).all():
        planned.moved_in_shape_keys[name] = own.points(in_key.moved[1])
    return []


def fills(rims, arrays, options, progress=None, **arguments):
    """A tripatch.Fill or Refusal for each rim, all made at once; the rims' vertices are numbered as in the arrays.

    arrays: positions, faces, replaced faces, as Surroundings gathers them around all rims; arguments: of tripatch.fill_all,
    besides the options'.
    """
    positions, faces, replaced = arrays
    loops = [[v.index for v in rim.loop] for rim in rims]
    results, corners = [None] * len(rims), {}
    any_rim = options.arguments.get("method", "auto") in ANY_RIM and options.arguments.get("output") != "cage"
    for k, (rim, loop) in enumerate(zip(rims, loops, strict=True)):
        try:
            corners[k] = corners_of(rim, loop, (positions, faces), replaced, options.corner_offset)
        except tripatch.Refusal as refusal:
            if options.corner_offset or not any_rim:
                results[k] = refusal
            else:  # the active vertex is no corner of a rim that has not three
                corners[k] = None
    made = tripatch.fill_all(
        positions,
        faces,
        [loops[k] for k in corners],
        corners=list(corners.values()),
        progress=progress,
        **(options.arguments | {"replaced": replaced} | arguments),
    )
    for k, fill in zip(corners, made, strict=True):
        results[k] = fill
    return results


def _plans(bm, rims, there, world, keys, options, around, cage, progress):
    """For each rim a `Planned` fill and notes on it, or a Refusal and none.

    there: the rims in the mesh of which `around` and `cage` are: the BMesh, or the cage that modifiers make of it.
    """
    positions, faces, replaced = around.around(*there)
    of_cage = {"subdivision": cage.near(faces)} if cage else {}
    results = []
    for rim, fill in zip(rims, fills(rims, (positions, faces, replaced), options, progress, **of_cage), strict=True):
        if not isinstance(fill, tripatch.Refusal):
            try:
                fill = _planned(bm, rim, world, fill, len(positions))
                fill.cage = cage is not None
            except tripatch.Refusal as refusal:
                fill = refusal
        results.append((fill, []))
    left = [k for k, (plan, _) in enumerate(results) if not isinstance(plan, tripatch.Refusal)]
    loops = [[v.index for v in rims[k].loop] for k in left]
    same = [results[k][0].fill.report.corners for k in left]
    arguments = options.arguments | of_cage
    for name, shape in keys.items() if left else ():
        *in_shape, arguments["replaced"] = shape.around(*rims)
        for k, fill in zip(left, tripatch.fill_all(*in_shape, loops, corners=same, **arguments), strict=True):
            planned, notes = results[k]
            notes += _in_shape_key(bm, planned, name, fill, world)
    return results


def _follow_rim(planned, layer):
    """New vertices in a shape in which no patch can be built: moved as the rim is."""
    moved = np.array([v[layer] - v.co for v in planned.loop])
    blend = tripatch.attribute_weights(planned.fill)
    ends = np.stack([moved, np.roll(moved, -1, axis=0)], axis=1).reshape(-1, 3)
    return planned.positions + blend(ends)


def _shapes(bm, matrix, active_shape, count=0):
    """Surroundings in each shape key but the one whose shape the vertices have now; count: see Surroundings."""
    others = [(name, layer) for name, layer in bm.verts.layers.shape.items() if name != active_shape]
    return {name: Surroundings(bm, matrix, layer, count) for name, layer in others}


def _clear_of_each_other(rims):
    """The rims in groups that can be filled at once: no rim of a group has a vertex on another or on what another replaces."""
    groups = []
    for rim in rims:
        own = set(rim.loop) | {v for f in rim.replaced for v in f.verts}
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
    made = subdivision.cage_before(ob, bm, modifier) if modifier else bm
    try:
        there = [subdivision.in_cage(ob, made, bm, rim) for rim in rims]
        around, keys = Surroundings(made, matrix), _shapes(bm, matrix, active_shape, len(made.verts))
        cage = subdivision.Cage(made, modifier) if cages else None
        with _progress(len(rims)) as progress:
            return _plans(bm, rims, there, matrix, keys, options, around, cage, progress)
    finally:
        if made is not bm:
            made.free()


def fill_rims(bm, mesh, matrix, rims, options, active_shape=None, modifier=None):
    """Fills rims of a BMesh; returns (Outcome, new faces). Cages of holes that touch each other are made one after the other, all
    others together.

    active_shape: name of the shape key whose shape the vertices have now; modifier: the Subdivision modifier, for cages.
    """
    cages, outcome, new_faces = options.arguments.get("output") == "cage", Outcome(), []
    if cages:
        outcome.cage_rim = options.arguments.get("cage_rim", "smooth")
        if outcome.cage_rim == "exact" and modifier is not None and not modifier.use_creases:
            raise UnusableError(f"Cage Rim: Exact creases the rim, and the modifier '{modifier.name}' does not use creases")
    # What one rim replaces would be missing around another that it touches; cages are fitted to what cages before have changed.
    apart = cages or any(rim.replaced for rim in rims)
    planned, loops = [], []
    for group in _clear_of_each_other(rims) if apart else [rims]:
        usable = [rim for rim in group if all(element.is_valid for element in (*rim.loop, *rim.replaced))]
        outcome.refused += ["A fill before has replaced a part of this rim"] * (len(group) - len(usable))
        if not usable:
            continue
        for plan, notes in _plan_group(bm, usable, matrix, options, active_shape, cages, modifier if cages else None):
            if isinstance(plan, tripatch.Refusal):
                outcome.refused.append(words.refused(plan))
                continue
            planned.append(plan)
            loops.append(plan.loop)
            outcome.reports.append(plan.fill.report)
            outcome.notes += [*plan.fill.report.warnings, *notes]
        if planned and cages:
            new_faces += writeback.write(bm, mesh, planned, options.shading, options.deviation)
            planned = []
    if planned:
        new_faces += writeback.write(bm, mesh, planned, options.shading, options.deviation)
    new_faces = [face for face in new_faces if face.is_valid]
    outcome.faces = len(new_faces)
    if loops:
        seam.remember(bm, mesh.name, loops)
    return outcome, new_faces


def holes(bm, matrix):
    """Every visible border loop but outer borders, which count where there is no other; the shortest first."""
    bm.verts.index_update()
    bm.faces.index_update()
    around, rims = Surroundings(bm, matrix), selection.all_rims(bm)
    if len(rims) < 2:
        return rims
    inner = [rim for rim in rims if not tripatch.is_outer_border(*around.around(rim)[:2], [v.index for v in rim.loop])]
    return inner or rims


def three_sided(bm, matrix, rims):
    """Those of some rims that have three corners, and why the others have not: [(vertex, sentence)]."""
    bm.verts.index_update()
    bm.faces.index_update()
    around, found, others = Surroundings(bm, matrix), [], []
    for rim in rims:
        positions, faces, _ = around.around(rim)
        loop = [v.index for v in rim.loop]
        try:
            tripatch.find_corners(positions, faces, loop)
        except tripatch.Refusal as refusal:
            others.append((min(loop), refusal.reason))
        else:
            found.append(rim)
    return found, others


def a_choice(found, advice):
    """UnusableError for several holes of which one is meant."""
    places = ", ".join(str(min(v.index for v in rim.loop)) for rim in found[:5]) + (", ..." if len(found) > 5 else "")
    return UnusableError(f"{len(found)} holes have three corners (rims at vertices {places}); {advice}")


def open_holes(bm, matrix, any_rim, advice="select the rim of one"):
    """Every hole where any rim can be filled, else the mesh's only three-sided one; UnusableError if there is none, or a choice:
    how to choose is the advice."""
    rims = holes(bm, matrix)
    hidden = any(e.is_boundary and e.hide for e in bm.edges)
    if not rims:
        raise UnusableError("The rims of the mesh are hidden; reveal them first" if hidden else "The mesh has no hole")
    if not hidden and (any_rim or len(rims) == 1):
        return rims  # the library says what is wrong with it
    found, others = three_sided(bm, matrix, rims)
    if len(found) == 1:
        return found
    if found:
        raise a_choice(found, advice)
    reasons = "; ".join(f"at vertex {vertex}: {reason}" for vertex, reason in others[:3]) + ("; ..." if len(others) > 3 else "")
    none = (
        "No visible hole can be filled as it is, and others are hidden"
        if hidden
        else f"None of the {len(rims)} holes can be filled"
    )
    raise UnusableError(f"{none}: {reasons}")
