# SPDX-License-Identifier: GPL-3.0-or-later
"""Calls of the library: what is asked of it for some rims, and the fills that it makes."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field

from . import waiting
from .library import ANY_RIM, np, tripatch
from .selection import OptionsError, UnusableError, coordinates


@dataclass
class Options:
    """Options of a fill: those of tripatch.fill, and what only Blender has."""

    arguments: dict = field(default_factory=dict)  # of tripatch.fill
    corner_offset: int = 0  # steps along the rim
    shading: str = "neighbors"  # "neighbors", "smooth", "flat"
    deviation: bool = False  # how well the new vertices are known, as attributes
    mirrored: bool = False  # what a Mirror modifier makes is in the BMesh
    record: dict = field(default_factory=dict)  # what Edit Fill needs to make the fill again


def matching_faces(corners):
    """What holes are filled with where a person has not chosen, as arguments of tripatch.fill: with what they lie among. corners:
    as selection.next to counts them."""
    if not corners or corners[3] > corners[4]:
        return {"output": "triangles"}
    # What lies around stays quads: where an edge is split, one becomes a pentagon.
    return {"output": "quads", "odd": "triangle"}


#: Of a hole's diameter: the tolerance of quads and cages where none is given, as the library's option says.
TOLERANCE = 1e-3
#: A panel has rows for so many sides.
MAX_SIDES = 12


class BySide(tuple):
    """MAX_SIDES values, for the sides that a hole has; how many shows when its corners are found."""


def for_sides(arguments, count):
    """The arguments for a hole of so many sides."""
    own = {name: value[:count] for name, value in arguments.items() if isinstance(value, BySide)}
    return arguments | {name: tuple(value) if len(set(value)) > 1 else value[0] for name, value in own.items()}


def slid_corners(fill, loop, offset):
    """Its corners so many steps along the rim; None where the fill follows none."""
    if "corners" in fill.report.not_applied:
        return None
    return [loop[(loop.index(v) + offset) % len(loop)] for v in fill.report.corners]


def corners_of(rim, loop, mesh, replaced, any_rim):
    """The corners to fill with, as vertex indices, or None for the library to find them."""
    if rim.round:
        return []
    first = rim.first.index if rim.first else None
    if rim.corners:
        corners = [v.index for v in rim.corners]
    elif first is None:
        return None
    else:
        try:
            many = tripatch.find_corners(mesh[0], mesh[1], loop, replaced=replaced, any_number=True).tolist() if any_rim else []
            corners = many or tripatch.find_corners(mesh[0], mesh[1], loop, replaced=replaced).tolist()
        except tripatch.Refusal:
            if not any_rim:
                raise
            return None  # the active vertex is no corner of a rim that has none
    places = [loop.index(v) for v in corners]
    if first is not None:
        # The active vertex is the first corner: one of them, or it takes the place of the nearest.
        count, active = len(loop), loop.index(first)
        steps = [min((p - active) % count, (active - p) % count) for p in places]
        nearest = steps.index(min(steps))
        places = [active] + [p for k, p in enumerate(places) if k != nearest]
    return [loop[p] for p in places]


def is_a_point(rim):
    """Whether all of a rim lies at one point, to what the last digit of float32 leaves."""
    places = coordinates(rim.loop)
    return np.ptp(places, axis=0).max() <= np.finfo(np.float32).eps * np.abs(places).max()


def fills(rims, arrays, options, progress=None, **arguments):
    """A tripatch.Fill or Refusal for each rim, all made at once; the rims' vertices are numbered as in the arrays.

    arrays: positions, faces, replaced faces, as Surroundings gathers them around all rims; arguments: of tripatch.fill_all,
    besides the options'.
    """
    positions, faces, replaced = arrays
    loops = [[v.index for v in rim.loop] for rim in rims]
    corners = {}
    results: list[tripatch.Fill | tripatch.Refusal | None] = [None] * len(rims)
    given = options.arguments
    caged, any_rim = given.get("output") == "cage", given.get("method", "auto") in ANY_RIM
    whatever = any_rim and not caged and given.get("surroundings") != "limit"
    for k, (rim, loop) in enumerate(zip(rims, loops, strict=True)):
        if is_a_point(rim):
            results[k] = tripatch.Refusal.of(tripatch.Message("rim_is_point"))
            continue
        try:
            corners[k] = corners_of(rim, loop, (positions, faces), replaced, whatever)
        except tripatch.Refusal as refusal:
            if caged and any_rim:
                corners[k] = None  # the active vertex is no corner of three; those of a cage are seen by its quads
            else:
                results[k] = refusal
    found = list(corners)
    counts = {}
    if _is_by_side(options.arguments):
        counts = {k: _sides(corners[k], loops[k], positions, faces, replaced) for k in found}
    given = options.arguments | {"replaced": replaced, "progress": progress} | arguments
    by_themselves = [k for k in found if rims[k].inside or rims[k].islands]
    shared = [k for k in found if k not in by_themselves]
    own = [counts[k] for k in shared if k in counts]
    made = shared_or_each((positions, faces), [loops[k] for k in shared], [corners[k] for k in shared], given, own)
    if options.corner_offset:
        slid = {
            k: slid_corners(fill, loops[k], options.corner_offset)
            for k, fill in zip(shared, made, strict=True)
            if not isinstance(fill, tripatch.Refusal)
        }
        made = shared_or_each(
            (positions, faces), [loops[k] for k in shared], [slid.get(k) or corners[k] for k in shared], given, own
        )
    for k, fill in zip(shared, made, strict=True):
        results[k] = fill
    for k in by_themselves:
        results[k] = alone((positions, faces), rims[k], corners[k], given, counts.get(k))
    return results


def alone(mesh, rim, corners, arguments, count, points=None):
    """A tripatch.Fill or Refusal that goes through vertices, or joins several boundaries. points: where the vertices are, if not
    where the mesh has them."""
    loop, *islands = [[v.index for v in each] for each in rim.loops]
    if count:
        arguments = for_sides(arguments, 2 if len(islands) == 1 else count)
    points = [mesh[0][v.index] for v in rim.inside] if points is None else points
    corners = None if islands else corners
    try:
        return waiting.make(tripatch.fill, *mesh, rim=loop, corners=corners, islands=islands, through=list(points), **arguments)
    except tripatch.Refusal as refusal:
        return refusal
    except ValueError as reason:  # a method that meets no points, or joins no boundaries
        return tripatch.Refusal(tripatch.errors.because(reason), [v.index for v in rim.inside or rim.loop])


def _is_by_side(arguments):
    return any(isinstance(value, BySide) for value in arguments.values())


@contextmanager
def saying_what_does_not_go():
    """What the library says of options that do not go together, as a person may choose them, is an OptionsError."""
    try:
        yield
    except (UnusableError, tripatch.Refusal):
        raise
    except ValueError as reason:
        raise OptionsError(tripatch.errors.because(reason)) from None


def _fill_all(*mesh, **arguments):
    with saying_what_does_not_go():
        return waiting.fill_all(*mesh, **arguments)


def shared_or_each(mesh, loops, corners, arguments, counts=None):
    """tripatch.fill_all; where values differ by side each number of sides has a call of its own. counts: the numbers of sides
    where the corners do not say them."""
    if not _is_by_side(arguments):
        return _fill_all(*mesh, loops, corners=corners, **arguments)
    counts = counts or [len(each or ()) or 1 for each in corners]
    results: list[tripatch.Fill | tripatch.Refusal | None] = [None] * len(loops)
    for count in set(counts):
        same = [k for k, each in enumerate(counts) if each == count]
        own = for_sides(arguments, count)
        made = _fill_all(*mesh, [loops[k] for k in same], corners=[corners[k] for k in same], **own)
        for k, fill in zip(same, made, strict=True):
            results[k] = fill
    return results


def _sides(corners, loop, positions, faces, replaced):
    """How many sides a rim has."""
    if corners is not None:
        return len(corners) or 1
    try:
        return len(tripatch.find_corners(positions, faces, loop, replaced=replaced, any_number=True)) or 1
    except tripatch.Refusal:
        return 1
