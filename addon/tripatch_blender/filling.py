# SPDX-License-Identifier: GPL-3.0-or-later
"""From rims of a BMesh to faces in it: everything is computed first, so that what is refused leaves the mesh untouched."""

from __future__ import annotations

from dataclasses import dataclass, field

from . import selection, subdivision, writeback
from .library import np, tripatch
from .selection import Surroundings, UnusableError


@dataclass
class Options:
    """Options of a fill: those of tripatch.fill, and what only Blender has."""

    arguments: dict = field(default_factory=dict)  # of tripatch.fill
    corner_offset: int = 0  # steps along the rim
    shading: str = "neighbors"  # "neighbors", "smooth", "flat"


@dataclass
class Outcome:
    """What became of the holes of one mesh or of several."""

    reports: list = field(default_factory=list)  # tripatch.Report of each filled hole
    refused: list = field(default_factory=list)  # sentences
    notes: list = field(default_factory=list)  # sentences on holes that were filled
    faces: int = 0
    cage_rim: str = ""  # of fills that are cages
    beside: list = field(default_factory=list)  # names of objects made

    def add(self, other, name=""):
        prefix = f"{name}: " if name else ""
        self.reports += other.reports
        self.refused += [prefix + sentence for sentence in other.refused]
        self.notes += [prefix + sentence for sentence in other.notes]
        self.faces += other.faces
        self.cage_rim = other.cage_rim or self.cage_rim
        self.beside += other.beside

    def sentence(self):
        """'Filled 2 holes; seam within 0.3 deg (surroundings known to 0.3 deg)'"""
        count = len(self.reports)
        if not count:
            return "No hole filled"
        holes = "1 hole" if count == 1 else f"{count} holes"
        seam = max(report.seam_angle_max for report in self.reports)
        if self.cage_rim:
            within = max(report.cage_deviation_max for report in self.reports)
            moved = max(report.surroundings_moved_max for report in self.reports)
            angle = f", seam within {_degrees(seam)}" if self.cage_rim == "exact" else ""
            return (
                f"Filled {holes} with a cage of {self.faces} quads{angle}; within {_length(within)} of the patch, "
                f"surroundings moved {_length(moved)} (scene units)"
            )
        known = max(report.surroundings_error for report in self.reports)
        seam = max(known, seam)
        if self.beside:
            return f"Filled {holes} in {', '.join(self.beside)}; seam with the limit surface within {_degrees(seam)}"
        return f"Filled {holes}; seam within {_degrees(seam)} (surroundings known to {_degrees(known)})"


def _degrees(angle):
    """An upper bound for a person."""
    return f"{max(angle, 0.001):.2g} deg"


def _length(value):
    return f"{value:.2g}" if value > 1e-9 else "0"


def world_matrix(name, matrix):
    """The (4, 4) array of an object's matrix; UnusableError if it cannot be inverted."""
    world = np.array(matrix, dtype=np.float64)
    if not np.isfinite(world).all() or not np.linalg.cond(world[:3, :3]) < 1e7:
        raise UnusableError(f"{name} is scaled to nothing along an axis; apply or correct its scale")
    return world


def place(refusal):
    """The reason, with the place if it does not name one."""
    where = list(refusal.where)
    if not where or any(str(v) in refusal.reason for v in where[:3]):
        return refusal.reason
    names = ", ".join(map(str, where[:5])) + (", ..." if len(where) > 5 else "")
    return f"{refusal.reason} ({'vertex' if len(where) == 1 else 'vertices'} {names})"


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


def _plan(bm, rim, world, keys, options, around, cage=None):
    """A `Planned` fill and notes on it. around: Surroundings in the shape that the vertices have now.
    cage: its subdivision.Cage, for output="cage"."""
    loop = [v.index for v in rim.loop]
    positions, faces, replaced = around.around(rim)
    corners = corners_of(rim, loop, (positions, faces), replaced, options.corner_offset)
    arguments = dict(options.arguments, rim=loop, replaced=replaced)
    if cage is not None:
        arguments["subdivision"] = cage.near(faces)
    fill = tripatch.fill(positions, faces, corners=corners, **arguments)

    inverse, notes = np.linalg.inv(world[:3, :3]), []
    turn = world[:3, :3] * np.sign(np.linalg.det(world[:3, :3]))

    def to_object(points):
        return (points - world[:3, 3]) @ inverse.T

    def normals_to_object(n):
        n = n @ turn
        return n / np.linalg.norm(n, axis=1, keepdims=True)

    vertex = {v.index: v for v in rim.loop}
    planned = writeback.Planned(
        rim,
        fill,
        [vertex[v] for v in fill.rim.tolist()],
        to_object(fill.vertices),
        normals_to_object(fill.normals),
        normals_to_object(fill.rim_normals),
        arguments.get("continuity") != "G0" and tripatch.METHODS[arguments.get("method", "side_vertex")].continuity != "G0",
    )
    planned.moved = list(zip([vertex[v] for v in fill.moved[0].tolist()], to_object(fill.moved[1]), strict=True))
    obstacle = writeback.obstacle(bm, planned, len(positions))
    if obstacle:
        raise tripatch.Refusal(obstacle, [])
    for name, shape in keys.items():
        try:
            in_key = tripatch.fill(*shape.around(rim)[:2], corners=fill.report.corners, **arguments)
            same = cage is None or (in_key.faces == fill.faces and (in_key.split_edges[0] == fill.split_edges[0]).all())
            if not same:
                raise tripatch.Refusal("its cage would have other faces", [])
            inside = in_key.patch.evaluate(fill.barycentric) if cage is None else in_key.vertices
            planned.in_shape_keys[name] = to_object(inside)
            if cage is not None and (in_key.moved[0] == fill.moved[0]).all():
                planned.moved_in_shape_keys[name] = to_object(in_key.moved[1])
        except tripatch.Refusal as refusal:
            notes.append(f"Shape key '{name}' follows its rim only: {place(refusal)}")
            planned.in_shape_keys[name] = _follow_rim(planned, bm.verts.layers.shape[name])
    return planned, notes


def _follow_rim(planned, layer):
    """New vertices in a shape in which no patch can be built: moved as the rim is."""
    moved = np.array([v[layer] - v.co for v in planned.loop])
    blend = writeback.attributes.Blend(planned.fill.rim_barycentric, planned.fill.barycentric)
    ends = np.stack([moved, np.roll(moved, -1, axis=0)], axis=1).reshape(-1, 3)
    return planned.positions + blend(ends)


def _shapes(bm, matrix, active_shape):
    """Surroundings in each shape key but the one whose shape the vertices have now."""
    others = [(name, layer) for name, layer in bm.verts.layers.shape.items() if name != active_shape]
    return {name: Surroundings(bm, matrix, layer) for name, layer in others}


def fill_rims(bm, mesh, matrix, rims, options, active_shape=None, modifier=None):
    """Fills rims of a BMesh; returns (Outcome, new faces).

    active_shape: name of the shape key whose shape the vertices have now; modifier: the Subdivision modifier, for cages.
    """
    if options.arguments.get("output") == "cage":
        return _fill_with_cages(bm, mesh, matrix, rims, options, active_shape, modifier)
    bm.verts.index_update()
    bm.faces.index_update()
    outcome, planned = Outcome(), []
    around, keys = Surroundings(bm, matrix), _shapes(bm, matrix, active_shape)
    for rim in rims:
        try:
            plan, notes = _plan(bm, rim, matrix, keys, options, around)
        except tripatch.Refusal as refusal:
            outcome.refused.append(place(refusal))
        else:
            planned.append(plan)
            outcome.reports.append(plan.fill.report)
            outcome.notes += [*plan.fill.report.warnings, *notes]
    new_faces = writeback.write(bm, mesh, planned, options.shading) if planned else []
    outcome.faces = len(new_faces)
    return outcome, new_faces


def _fill_with_cages(bm, mesh, matrix, rims, options, active_shape, modifier):
    """One hole after the other: each fill is part of the cage around the next."""
    outcome, new_faces = Outcome(cage_rim=options.arguments.get("cage_rim", "smooth")), []
    if outcome.cage_rim == "exact" and modifier is not None and not modifier.use_creases:
        raise UnusableError(f"Cage Rim: Exact creases the rim, and the modifier '{modifier.name}' does not use creases")
    for rim in rims:
        if not all(element.is_valid for element in (*rim.loop, *rim.replaced)):
            outcome.refused.append("A fill before has replaced a part of this rim")
            continue
        bm.verts.index_update()
        bm.faces.index_update()
        around, keys = Surroundings(bm, matrix), _shapes(bm, matrix, active_shape)
        try:
            plan, notes = _plan(bm, rim, matrix, keys, options, around, subdivision.Cage(bm, modifier))
        except tripatch.Refusal as refusal:
            outcome.refused.append(place(refusal))
        else:
            new_faces += writeback.write(bm, mesh, [plan], options.shading)
            outcome.reports.append(plan.fill.report)
            outcome.notes += [*plan.fill.report.warnings, *notes]
    new_faces = [face for face in new_faces if face.is_valid]
    outcome.faces = len(new_faces)
    return outcome, new_faces


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


def only_hole(bm, matrix):
    """The mesh's only three-sided hole; UnusableError if there is none, or a choice."""
    rims = selection.all_rims(bm)
    if not rims:
        raise UnusableError("The mesh has no hole")
    if len(rims) == 1:
        return rims  # the library says what is wrong with it
    found, others = three_sided(bm, matrix, rims)
    if len(found) == 1:
        return found
    if found:
        places = ", ".join(str(min(v.index for v in rim.loop)) for rim in found[:5]) + (", ..." if len(found) > 5 else "")
        raise UnusableError(f"{len(found)} holes have three corners (rims at vertices {places}); select the rim of one")
    reasons = "; ".join(f"at vertex {vertex}: {reason}" for vertex, reason in others[:3]) + ("; ..." if len(others) > 3 else "")
    raise UnusableError(f"None of the {len(rims)} holes has three corners: {reasons}")
