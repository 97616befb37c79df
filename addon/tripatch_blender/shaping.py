# SPDX-License-Identifier: GPL-3.0-or-later
"""A hole that is being shaped by hand: corners, bulge by side, the middle. The mesh stays as it is until the end.

Nothing here needs a window: the gizmos and the operators of the tool call what is here.
"""

from __future__ import annotations

import copy
import math
import time
from dataclasses import dataclass, field
from typing import Any

from . import calls, filling, mirrored, records, selection, writeback
from .library import index_lists, np, tripatch
from .selection import Rim, UnusableError

#: Pixels within which a click still means a rim.
REACH = 60
#: Of the size of the hole: an arrow at bulge 1. The arrows of three sides do not meet in the middle.
ARROW = 0.14
MIN_BULGE = 0.05
#: Relative difference that is none.
_SAME = 1e-6
#: What a click on the label of a side goes through.
CONTINUITIES = ("G0", "G1", "G2")
#: Of the way from a side to the middle: where the arrow of the side ends at the most, so that none meets another.
_CLEAR = 0.8


@dataclass
class Shape:
    """What can be changed, by hand or by undoing a drag."""

    corners: list = field(default_factory=list)  # places in the rim, in its order
    bulges: list = field(default_factory=list)  # for the part of the rim from each corner on; one where there are no corners
    middle: float = 0.0  # of the fill, along its normal, in scene units
    round: bool = False  # no corners are wanted
    continuity: list = field(default_factory=list)  # of the same parts as bulges; "auto" where nobody has chosen

    def __post_init__(self):
        self.continuity = self.continuity or ["auto"] * len(self.bulges)


def _same_or_each(values):
    return tuple(values) if len(set(values)) > 1 else values[0]


def _bulge(bulges):
    """The option of tripatch.fill from the arrows, in the order of sides."""
    return tuple(bulges) if len(bulges) > 2 and len(set(bulges)) > 1 else sum(bulges) / len(bulges)


class Shaping:
    """One hole of one mesh in edit mode."""

    def __init__(self, ob, bm, rim, arguments=None):
        """UnusableError if there is nothing that could be filled. Indices must be up to date."""
        if rim.replaced:
            raise UnusableError("tool_needs_open_hole")
        if mirrored.is_joined(ob, rim):
            raise UnusableError("tool_takes_no_halves")
        if calls.is_a_point(rim):
            raise UnusableError("rim_is_point", rim.loop)
        self.name = ob.name
        self._matching = calls.matching_faces(selection.adjacent_sizes(bm, [rim]))
        self.set_arguments(arguments or {})
        matrix = filling.world_matrix(ob.name, ob.matrix_world)
        positions, faces, _ = selection.Surroundings(bm, matrix).around(rim)
        used = sorted({v for face in faces for v in face})
        number = {v: k for k, v in enumerate(used)}
        self._positions, self._faces = positions[used], [[number[v] for v in face] for face in faces]
        self.rim = [v.index for v in rim.loop]
        self._loop = [number[v] for v in self.rim]
        self._local = [tuple(v.co) for v in rim.loop]
        self.points = self._positions[self._loop]  # (r, 3) of the rim, in the world
        self.size = float(np.linalg.norm(np.ptp(self.points, axis=0)))
        self.shape = Shape()
        self._start_corners(rim)
        self.fill: tripatch.Fill | None = None
        self.refusal: tripatch.Refusal | str | None = None
        self.is_shown = False  # what is asked for
        self.seconds = 0.0  # that the last fill took
        self._middle: Any = None  # where its handle is without an offset: (point, normal)
        self._before = None
        self._settled = copy.deepcopy(self.shape)
        self._past: list[Shape] = []
        self._future: list[Shape] = []

    def set_arguments(self, given):
        """Of tripatch.fill, in place of those that continue with what lies around."""
        self.arguments = self._matching | given

    def _start_corners(self, rim):
        if rim.corners:
            at = {v.index: k for k, v in enumerate(rim.loop)}
            corners = sorted(at[v.index] for v in rim.corners)
        else:
            try:
                found = tripatch.find_corners(self._positions, self._faces, self._loop, any_number=True)
                corners = sorted(self._loop.index(v) for v in found.tolist())
            except tripatch.Refusal:
                corners = []
            corners = corners if len(corners) > 1 else []
        self.shape = Shape(corners, [1.0] * max(1, len(corners)), 0.0, not corners)

    # Corners.

    def nearest_place(self, screen, mouse, taken=()):
        """The place in the rim that is nearest to the mouse, among those that are no other corner, and its distance in pixels.

        screen: (r, 2) of the rim's vertices, nan behind the eye.
        """
        apart = np.linalg.norm(np.asarray(screen, float) - np.asarray(mouse, float), axis=1)
        apart[~np.isfinite(apart)] = np.inf
        apart[list(taken)] = np.inf
        place = int(apart.argmin())
        return place, float(apart[place])

    def drag_corner(self, k, place):
        """Moves corner k along the rim, not past its neighbors. Returns where it is."""
        corners, count = self.shape.corners, len(self.rim)
        if len(corners) > 1:
            before, after = corners[k - 1], corners[(k + 1) % len(corners)]
            span = (after - before) % count or count
            step = (place - before) % count
            if not 0 < step < span:
                return corners[k]
        corners[k] = place
        self.is_shown = False
        return place

    def set_round(self, on):
        """No corners at all, or those that the rim has (three at equal distances where it has none)."""
        if on == self.shape.round:
            return
        self.shape.round = on
        if not on and not self.shape.corners:
            self.shape.corners = self._thirds()
        count = 1 if on else len(self.shape.corners)
        self.shape.bulges, self.shape.continuity = [1.0] * count, ["auto"] * count
        self.settle()

    def _thirds(self):
        steps = np.linalg.norm(np.roll(self.points, -1, axis=0) - self.points, axis=1)
        along = np.concatenate([[0], np.cumsum(steps)[:-1]]) / steps.sum()
        return sorted({int(np.abs(along - t).argmin()) for t in (0, 1 / 3, 2 / 3)})

    def add_corner(self, place):
        """A further corner, or one less where there is one."""
        corners = self.shape.corners if not self.shape.round else []
        corners = sorted(set(corners) ^ {place})
        if len(corners) < 2:
            self.set_round(True)
            return
        self.shape = Shape(corners, [1.0] * len(corners), self.shape.middle, False)
        self.settle()

    # Bulge and middle.

    # Blender sets an arrow again wherever it draws while the mouse rests, in single precision: that changes nothing.

    def set_bulge(self, k, value):
        """Whether it is another one."""
        value = max(float(value), MIN_BULGE)
        if math.isclose(value, self.shape.bulges[k], rel_tol=_SAME):
            return False
        self.shape.bulges[k], self.is_shown = value, False
        return True

    def set_middle(self, value):
        """Whether it is another one."""
        if math.isclose(value, self.shape.middle, rel_tol=_SAME, abs_tol=_SAME * self.size):
            return False
        self.shape.middle, self.is_shown = float(value), False
        return True

    # Drags.

    def begin_drag(self):
        self._before = copy.deepcopy(self.shape)

    def cancel_drag(self):
        if self._before is not None:
            self.shape, self._before = self._before, None
            self.preview()

    def end_drag(self):
        self._before = None
        self.settle()
        if not self.is_shown:
            self.preview()

    # Undo.

    def settle(self):
        """The shape as it is now is a step of undo, if it is another one."""
        if self.shape == self._settled:
            return
        self._past.append(self._settled)
        self._future.clear()
        self._settled = copy.deepcopy(self.shape)

    def step(self, forward):
        """Takes the last change back, or makes it again. Whether there is one."""
        self.settle()
        come_from, go_to = (self._past, self._future) if forward else (self._future, self._past)
        if not go_to:
            return False
        come_from.append(self._settled)
        self._settled = go_to.pop()
        self.shape = copy.deepcopy(self._settled)
        self.preview()
        return True

    # The fill.

    def _by_side(self, values):
        """Values of the parts of the rim in the order of sides: of three, side i is opposite corner i."""
        return values[1:] + values[:1] if len(values) == 3 and not self.shape.round else values

    def options(self):
        """The arguments of tripatch.fill that the shape makes."""
        made = dict(self.arguments, center_offset=self.shape.middle, bulge=_bulge(self._by_side(self.shape.bulges)))
        if set(self.shape.continuity) != {"auto"}:
            made["continuity"] = _same_or_each(self._by_side(self.shape.continuity))
        return made

    # Continuity.

    def continuities(self):
        """What each part of the rim is met with, "G0", "G1" or "G2"; one for all if the fill has no sides, none if there is no
        choice."""
        if not self.honors("continuity"):
            return []
        kept = ["G0" if each == "Free" else each for each in self.fill.report.continuity]
        if len(kept) != len(self.shape.bulges):
            return kept[:1] if len(set(kept)) == 1 else []
        return kept[-1:] + kept[:-1] if len(kept) == 3 and not self.shape.round else kept

    def next_continuity(self, k):
        """Meets a part of the rim with the next continuity that the fill can keep there. Whether there is another."""
        shown, before = self.continuities(), list(self.shape.continuity)
        if k >= len(shown):
            return False
        start = CONTINUITIES.index(shown[k])
        for wanted in (*CONTINUITIES[start + 1 :], *CONTINUITIES[:start]):
            parts = [k] if len(shown) == len(before) else range(len(before))
            self.shape.continuity = [wanted if part in parts else each for part, each in enumerate(before)]
            self.preview()
            now = self.continuities()
            if self.refusal is None and k < len(now) and now[k] == wanted:
                self.settle()
                return True
        self.shape.continuity = before
        self.preview()
        return False

    def corners(self):
        """Places of the corners, none on a round rim."""
        return [] if self.shape.round else self.shape.corners

    def preview(self):
        """Makes the fill that `write` puts into the mesh, and keeps it or its refusal."""
        begun = time.perf_counter()
        self.is_shown = True
        try:
            corners = [self._loop[k] for k in self.corners()]
            self.fill = tripatch.fill(self._positions, self._faces, rim=self._loop, corners=corners, **self.options())
            self.refusal = None
            self._keep_middle()
        except (tripatch.Refusal, ValueError) as reason:
            self.refusal = tripatch.errors.because(reason)
        self.seconds = time.perf_counter() - begun
        return self.fill

    def _keep_middle(self):
        """Where the handle of the middle stands: while only the middle moves it stays."""
        read_for = [*self.corners()], [*self.shape.bulges], self.shape.round, dict(self.arguments)
        if not len(self.fill.vertices) or (self._middle is not None and self._middle[0] == read_for):
            return
        rim, places = writeback.parameters(self.fill)
        k = int(np.linalg.norm(places - rim.mean(axis=0), axis=1).argmin())
        normal = self.fill.normals[k]
        self._middle = read_for, self.fill.vertices[k] - self.shape.middle * normal, normal

    def honors(self, option):
        """Whether the fill that is shown follows an option, by its name: there is no handle for others."""
        return self.fill is not None and option not in self.fill.report.not_applied

    def surface(self):
        """(vertices (n, 3), triangles (t, 3), edges (e, 2)) of the fill, with the mesh's own vertices as far as it uses them."""
        faces = index_lists(self.fill.faces)
        triangles = [(f[0], f[k], f[k + 1]) for f in faces for k in range(1, len(f) - 1)]
        edges = {(min(a, b), max(a, b)) for f in faces for a, b in zip(f, (*f[1:], f[0]))}
        return (
            np.vstack([self._positions, self.fill.vertices]),
            np.array(triangles, np.int64).reshape(-1, 3),
            np.array(sorted(edges), np.int64).reshape(-1, 2),
        )

    # Where the handles are.

    def side_handles(self):
        """For each bulge: (place in the rim, its point, the direction into the hole)."""
        corners, count = self.corners() or [0], len(self.rim)
        middle, handles = self.points.mean(axis=0), []
        for k, a in enumerate(corners):
            length = (corners[(k + 1) % len(corners)] - a) % count or count
            place = (a + length // 2) % count
            away = middle - self.points[place]
            handles.append((place, self.points[place], away / max(np.linalg.norm(away), 1e-30)))
        return handles

    def room(self, k, handle):
        """How much of an arrow of the hole's size at the handle of a side still ends before the middle, where all meet."""
        _, point, _ = handle
        way = np.linalg.norm(self.points.mean(axis=0) - point)
        return max(_CLEAR * way - self.shape.bulges[k] * ARROW * self.size, 0.0)

    def middle_handle(self):
        """(point, normal) of the fill's middle without its offset."""
        return self._middle[1:] if self._middle is not None else (self.points.mean(axis=0), np.array([0.0, 0.0, 1.0]))

    # The mesh.

    def is_of(self, ob, rim):
        """Whether this is what is being shaped already."""
        return ob.name == self.name and {v.index for v in rim.loop} == set(self.rim)

    def is_current(self, bm):
        """Whether the mesh still has this rim, with its vertices where they were."""
        if max(self.rim) >= len(bm.verts):
            return False
        bm.verts.ensure_lookup_table()
        loop = [bm.verts[k] for k in self.rim]
        if any(tuple(v.co) != co for v, co in zip(loop, self._local, strict=True)):
            return False
        return all(e is not None and e.is_boundary for e in selection.edges_of(bm, loop))

    def write(self, ob, bm):
        """Fills the hole in the mesh. Returns (outcomes.Outcome, new faces); UnusableError if the mesh has changed."""
        with writeback.layers_of_fills(bm):
            return self._write(ob, bm)

    def _write(self, ob, bm):
        bm.verts.index_update()
        bm.faces.index_update()
        if not self.is_current(bm):
            raise UnusableError("mesh_changed")
        loop = [bm.verts[k] for k in self.rim]
        rim = Rim(loop, corners=[loop[k] for k in self.corners()], round=self.shape.round)
        active = ob.active_shape_key.name if ob.active_shape_key else None
        matrix = filling.world_matrix(ob.name, ob.matrix_world)
        arguments = self.options()
        options = calls.Options(arguments, record=records.of_arguments(arguments))
        return filling.fill_rims(bm, ob.data, matrix, [rim], options, active)


#: How large arrows are next to Blender's own, and how small they get in a hole that is small in the view.
LARGE, SMALL = 0.9, 0.1


def arrow_scale(room, size):
    """How large an arrow is drawn that has room for so many pixels. size: pixels of one at the scale 1."""
    return min(LARGE, max(SMALL, room / size))  # the smallest where nothing is known of the room


def rims_at(bm, screen_of, mouse):
    """The hole whose rim is nearest to the mouse, or None. screen_of: BMVert -> its pixel or None."""
    best, reach = None, REACH
    for rim in selection.all_rims(bm):
        for v in rim.loop:
            at = screen_of(v)
            apart = float("inf") if at is None else ((at[0] - mouse[0]) ** 2 + (at[1] - mouse[1]) ** 2) ** 0.5
            if apart < reach:
                best, reach = rim, apart
    return best


def from_selection(ob, bm, arguments=None):
    """A `Shaping` of the one hole that is selected. UnusableError if none or several are."""
    bm.verts.index_update()
    bm.faces.index_update()
    rims, refused = selection.selected_rims(bm, selection.Selected(bm))
    halves = [reason.rim for reason in refused if reason.rim and mirrored.is_joined(ob, reason.rim)]
    if refused and not halves:
        raise refused[0]
    rims = halves or rims
    if len(rims) != 1:
        raise UnusableError("tool_shapes_one", count=len(rims))
    return Shaping(ob, bm, rims[0], arguments)
