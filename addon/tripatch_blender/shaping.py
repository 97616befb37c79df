# SPDX-License-Identifier: GPL-3.0-or-later
"""A hole that is being shaped by hand: corners, bulge by side, the middle. The mesh stays as it is until the end.

Nothing here needs a window: the gizmos and the operators of the tool call what is here.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from typing import Any

from . import filling, mirrored, records, selection, writeback
from .library import index_lists, np, tripatch
from .selection import Rim, UnusableError

#: Pixels within which a click still means a rim.
REACH = 60
#: Of the size of the hole: an arrow at bulge 1. The arrows of three sides do not meet in the middle.
ARROW = 0.14
LEAST_BULGE = 0.05
#: Of the way from a side to the middle: where the arrow of the side ends at the most, so that none meets another.
_CLEAR = 0.8
#: Vertices of a rim from which on a step of a drag looks at fewer rings of the surroundings, and a mesh for it is coarser inside.
_MANY = 72
_FEW_RINGS = 2
_COARSE = 12  # edges a side
_ROWS = 8  # from the rim to the middle, as it is shown without a mesh
_PATCHES = ("side_vertex", "multi_sided")
# While an arrow is dragged, what is shown between fills that lie so near to each other, in bulge and in the middle's height over
# the hole's size, is blended of them: each would take as long as any fill.
_STEP_OF_BULGE, _STEP_OF_MIDDLE = 0.1, 0.05
_MOST_KEPT = 32  # such fills


@dataclass
class Shape:
    """What can be changed, by hand or by undoing a drag."""

    corners: list = field(default_factory=list)  # places in the rim, in its order
    bulges: list = field(default_factory=list)  # for the part of the rim from each corner on; one where there are no corners
    middle: float = 0.0  # of the fill, along its normal, in scene units
    round: bool = False  # no corners are wanted


@dataclass
class _Net:
    """What of a fill is shown, beside its rim."""

    places: Any  # of its points in the domain
    vertices: Any  # (k, 3)
    normals: Any  # (k, 3)
    triangles: Any  # (t, 3) of the mesh's vertices and, after these, its own

    @classmethod
    def of_mesh(cls, fill):
        triangles = [(f[0], f[k], f[k + 1]) for f in index_lists(fill.faces) for k in range(1, len(f) - 1)]
        return cls(writeback.parameters(fill)[1], fill.vertices, fill.normals, np.array(triangles, np.int64).reshape(-1, 3))

    @classmethod
    def of_rows(cls, fill, count):
        """In rows from its rim to its middle, which take no mesh to be made; None where not all of the rim is seen from there, or
        edges are continued across. count: vertices of the mesh."""
        if fill.patch is None:  # plain triangles
            return None
        rim = writeback.parameters(fill)[0]
        if fill.sides:
            middle = _middle_place(fill.patch)
        else:
            middle = rim.mean(axis=0, keepdims=True)
            after = np.roll(rim, -1, axis=0) - middle
            turns = (rim - middle)[:, 0] * after[:, 1] - (rim - middle)[:, 1] * after[:, 0]
            if len(fill.feature_edges) or turns.min() * turns.max() <= 0:
                return None
        shares = np.arange(_ROWS - 1, 0, -1)[:, None, None] / _ROWS
        places = np.vstack([(middle + shares * (rim - middle)).reshape(-1, rim.shape[1]), middle])
        last = count + len(places) - 1
        a = np.vstack([fill.rim, np.arange(count, last).reshape(-1, len(rim)), np.full(len(rim), last)])
        b = np.roll(a, -1, axis=1)
        beside = [np.stack(three, axis=-1).reshape(-1, 3) for three in ((a[:-1], b[:-1], a[1:]), (b[:-1], b[1:], a[1:]))]
        triangles = np.vstack([beside[0], beside[1][: -len(rim)]])  # at the middle there is but one
        points, normals = fill.patch.positions_and_normals(places)
        return cls(places, points, normals, triangles)


class _Between:
    """The exact patches between the sides of a fill, by bulges and the middle, as points at the places of a net."""

    def __init__(self, fill, net, shape, size, fairing="auto"):
        """net: what of the fill is shown. shape: (*bulges, middle), of the fill. fairing: of the patches; None where the sides
        were found to allow none."""
        self.fill, self.net = fill, net
        self._sides, self._method, self._places = fill.sides, fill.report.method, net.places
        self._fairing = fairing
        self._steps = [_STEP_OF_BULGE] * (len(shape) - 1) + [_STEP_OF_MIDDLE * size]
        self._known, self._centers = {}, {}
        if fill.report.fairing or not fairing:
            self._known[shape] = net.vertices, net.normals
        if not shape[-1] and fill.report.fairing:
            self._centers[_bulge(shape[:-1])] = _middle_of(fill.patch)

    def begun(self, shape):
        """`at` of a shape whose middle is not moved, if none is known so far: the first patch is a step of its own."""
        if self._known:
            return None
        patch = self._patch(bulge=_bulge(shape[:-1]))
        self._centers[_bulge(shape[:-1])] = _middle_of(patch)
        return self._keep((*shape[:-1], 0.0), patch)

    def _keep(self, shape, patch):
        if len(self._known) >= _MOST_KEPT:
            self._known.clear()
        self._known[shape] = patch.positions_and_normals(self._places)
        return self._known[shape]

    def at(self, shape):
        """(vertices, normals): exact, or blended of two exact ones where what was asked for before is near. A ValueError where no
        patch can be."""
        if shape in self._known:
            return self._known[shape]
        near = [self._neighbors(shape, axis) for axis in range(len(shape))]
        axis, pair = next(((axis, pair) for axis, pair in enumerate(near) if pair), (0, None))
        if pair is None:
            return self._exact(shape)
        (low, first), (high, second) = ((value, self._exact(self._with(shape, axis, value))) for value in pair)
        share = (shape[axis] - low) / (high - low)
        vertices, normals = ((1 - share) * a + share * b for a, b in zip(first, second, strict=True))
        return vertices, normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)

    @staticmethod
    def _with(shape, axis, value):
        return (*shape[:axis], value, *shape[axis + 1 :])

    def _neighbors(self, shape, axis):
        """Two values along an axis, no farther apart than a step, between which the shape is, of which one is known at least."""
        value, step = shape[axis], self._steps[axis]
        known = [each[axis] for each in self._known if self._with(each, axis, value) == shape]
        below = max((v for v in known if v < value), default=-np.inf)
        above = min((v for v in known if v > value), default=np.inf)
        if above - below <= 1.001 * step:
            return below, above
        if value - below <= step:
            return below, below + step
        if above - value <= step and (axis == len(shape) - 1 or above - step >= LEAST_BULGE):
            return above - step, above
        return None

    def _exact(self, shape):
        if shape not in self._known:
            *bulges, middle = shape
            given = {"bulge": _bulge(bulges)}
            if middle:  # as center_offset, but the patch whose middle is moved is made once
                point, normal = self._center(given["bulge"])
                given["center"] = point + middle * normal
            patch = self._patch(**given)
            if not len(self._places):
                return self._places, self._places
            return self._keep(shape, patch)
        return self._known[shape]

    def _patch(self, **given):
        return tripatch.patch(self._sides, method=self._method, fairing=self._fairing, **given)

    def _center(self, bulge):
        """The middle of the patch of a bulge and its normal."""
        if bulge not in self._centers:
            self._centers = {bulge: _middle_of(self._patch(bulge=bulge))}
        return self._centers[bulge]


def _middle_of(patch: Any):
    """The middle of a patch and its normal."""
    position, normal = patch.positions_and_normals(_middle_place(patch))
    return position[0], normal[0]


def _middle_place(patch: Any):
    """(1, 2 or 3): of the middle in the domain."""
    return patch.domain.mean(axis=0)[None] if hasattr(patch, "domain") else np.full((1, 3), 1 / 3)


def _bulge(bulges):
    """The option of tripatch.fill from the arrows, in the order of sides."""
    return tuple(bulges) if len(bulges) > 2 and len(set(bulges)) > 1 else sum(bulges) / len(bulges)


class Shaping:
    """One hole of one mesh in edit mode."""

    def __init__(self, ob, bm, rim, arguments=None):
        """UnusableError if there is nothing that could be filled. Indices must be up to date."""
        if rim.replaced:
            raise UnusableError("The tool shapes holes; delete the selected faces first")
        if mirrored.is_joined(ob, rim):
            raise UnusableError("A Mirror modifier joins this border to its image: Smooth Fill fills such halves, the tool none")
        if filling.is_a_point(rim):
            raise UnusableError(filling.A_POINT, rim.loop)
        self.name = ob.name
        self._going_on = filling.going_on(selection.beside(bm, [rim]))
        self.set_arguments(arguments or {})
        matrix = filling.world_matrix(ob.name, ob.matrix_world)
        positions, faces, _ = selection.Surroundings(bm, matrix).around(rim)
        used = sorted({v for face in faces for v in face})
        number = {v: k for k, v in enumerate(used)}
        self._positions, self._faces = positions[used], [[number[v] for v in face] for face in faces]
        self.rim = [v.index for v in rim.loop]
        self._nearest = self._faces
        self._loop = [number[v] for v in self.rim]
        self._local = [tuple(v.co) for v in rim.loop]
        self.points = self._positions[self._loop]  # (r, 3) of the rim, in the world
        self.size = float(np.linalg.norm(np.ptp(self.points, axis=0)))
        self.shape = Shape()
        if len(self.rim) > _MANY:
            self._nearest = self._rings(_FEW_RINGS)
        self._start_corners(rim)
        self.fill: tripatch.Fill | None = None
        self.refusal: tripatch.Refusal | str | None = None
        self.vertices: Any = None  # (k, 3) of the fill as it is shown
        self.normals: Any = None
        self._net: Any = None  # on which it is
        self._no_patch = False  # is between the corners that are being dragged
        self._in_rows = True  # is what steps of a drag show, where they are no patches too
        self._filled = None  # what of the shape the surroundings were read for
        self._between: _Between | None = None  # fills between its sides; none where arrows change nothing
        self._asked: tuple | None = None  # bulges and the middle of the last fill,
        self._read_last: Any = None  # and the rest of its shape
        self._before = None

    def set_arguments(self, given):
        """Of tripatch.fill, in place of those that go on with what lies around."""
        self.arguments = self._going_on | given

    def _rings(self, count):
        near, faces = set(self._loop), []
        for _ in range(count):
            faces = [face for face in self._faces if not near.isdisjoint(face)]
            near.update(v for face in faces for v in face)
        return faces

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
        return place

    def set_round(self, on):
        """No corners at all, or those that the rim has (three at equal distances where it has none)."""
        if on == self.shape.round:
            return
        self.shape.round = on
        if not on and not self.shape.corners:
            self.shape.corners = self._thirds()
        self.shape.bulges = [1.0] * (1 if on else len(self.shape.corners))

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

    # Bulge and middle.

    def set_bulge(self, k, value):
        self.shape.bulges[k] = max(float(value), LEAST_BULGE)

    def set_middle(self, value):
        self.shape.middle = float(value)

    # Drags.

    def begin_drag(self):
        self._before = copy.deepcopy(self.shape)

    def cancel_drag(self):
        if self._before is not None:
            self.shape, self._before = self._before, None
            self.preview()

    def end_drag(self):
        self._before = None
        if self._between is None and self._filled == self._read_for():
            self._asked = self._asked_shape()  # by arrows that change nothing
        else:
            self.preview()

    # The fill.

    def _by_side(self):
        """Bulges in the order of sides: of three, side i is opposite corner i."""
        bulges = self.shape.bulges
        if len(bulges) == 3 and not self.shape.round:
            return bulges[1:] + bulges[:1]
        return bulges

    def options(self):
        """The arguments of tripatch.fill that the shape makes."""
        return dict(self.arguments, center_offset=self.shape.middle, bulge=_bulge(self._by_side()))

    def corners(self):
        """Places of the corners, none on a round rim."""
        return [] if self.shape.round else self.shape.corners

    def preview(self, quick=False):
        """Fills, and keeps the fill or its refusal. quick: where only bulges and the middle have changed, from the sides that
        were read before; else without a mesh inside where none is needed to show it, and without a patch's fairing."""
        if quick:
            return self.fill if self._shape_anew() or self._read_sides() else self._preview_corners()
        given, self._no_patch = self.options(), False
        try:
            self._show(self._filled_with(self._faces, given))
            if self.fill.sides:
                self._shape_between(self.fill, given, "auto" if self.fill.report.fairing else None)
        except (tripatch.Refusal, ValueError) as reason:
            self.refusal = str(reason)
        return self.fill

    def _filled_with(self, faces, given):
        return tripatch.fill(self._positions, faces, rim=self._loop, corners=[self._loop[k] for k in self.corners()], **given)

    def _show(self, fill, net=None):
        self.fill, self.refusal, self._net = fill, None, net or _Net.of_mesh(fill)
        self.vertices, self.normals = self._net.vertices, self._net.normals
        self._filled = self._between = None
        self._asked, self._read_last = self._asked_shape(), self._read_for()

    def _preview_corners(self):
        """A step of a drag of a corner. Where no patch lies between the corners, or one that folds, this step and the next ones
        have none."""
        given = self._quick(self.options())
        may_change = self.arguments.get("method", "auto") == "auto" and given["method"] in _PATCHES
        try:
            fill = self._filled_with(self._nearest, given)
            if not (fill.report.folds and may_change):
                return self._show_step(fill, given)
        except (tripatch.Refusal, ValueError) as reason:
            self.refusal = str(reason)
        if not may_change:
            return self.fill
        self._no_patch = True
        return self._preview_corners()

    def _show_step(self, fill, given):
        net = _Net.of_rows(fill, len(self._positions)) if self._in_rows or fill.sides else None
        if net is None and self._in_rows:  # a mesh for this one and the next ones
            self._in_rows = False
            fill = self._filled_with(self._nearest, self._quick(self.options()))
        self._show(fill, net)
        if fill.sides:
            self._shape_between(fill, given, "auto")
        return fill

    def _shape_between(self, fill, given, fairing, net=None):
        """net: what of it will be shown, where that is not what is."""
        self._filled = self._read_for()
        shape = (*self._by_side(), given["center_offset"])
        self._between = _Between(fill, net or self._net, shape, self.size, fairing)

    def _read_sides(self):
        """The first step of a drag of an arrow where the fill is no patch: reads the sides of the one that the next steps shape,
        and goes on showing the fill. Where the patch would fold there is none, and arrows change nothing, as at the end. Whether
        this is such a step."""
        if self.fill is None or self.fill.sides or self.arguments.get("method", "auto") != "auto":
            return False
        if self._asked == self._asked_shape() or self._read_last != self._read_for():
            return False
        self._filled = self._read_for()
        given = self.options() | {"output": "triangles", "resolution": 1, "fairing": None, "center_offset": 0.0}
        given["method"] = "side_vertex" if len(self.corners()) == 3 else "multi_sided"
        try:
            plain = self._filled_with(self._nearest, given)
        except (tripatch.Refusal, ValueError):
            return True
        if plain.sides and not plain.report.folds:
            self._shape_between(plain, given, "auto", _Net.of_rows(plain, len(self._positions)))
        return True

    def _read_for(self):
        return [*self.corners()], self.shape.round, dict(self.arguments)

    def _asked_shape(self):
        return (*self._by_side(), self.shape.middle)

    def _shape_anew(self):
        """The patch between the sides of the last fill, with other bulges or another middle, at the same places; whether that is
        what has changed. Reading the surroundings again is what takes long."""
        if self._filled is None or self._filled != self._read_for():
            return False
        if self._between is None:
            return True
        try:
            shape = self._asked_shape()
            self.vertices, self.normals = self._between.begun(shape) or self._between.at(shape)
        except ValueError:  # Refusal, InvalidArgument
            return False
        self.fill, self._net = self._between.fill, self._between.net
        self.refusal = None
        return True

    def _quick(self, given):
        """The options of a step: just the surface where that serves, without a mesh and, of sides, as they alone tell."""
        method = self._quick_method(given.get("method", "auto"))
        given = (given if method == "auto" else filling.by_method(method, given)) | {"method": method, "output": "triangles"}
        if method in _PATCHES and self.corners():
            given["fairing"] = None
        if method in _PATCHES or self._in_rows:
            given["resolution"] = 1
        elif len(self.rim) > _MANY:
            given["resolution"] = _COARSE
        return given

    def _quick_method(self, asked):
        """Where nothing but corners has moved since the last fill, the method that it took is not looked for again."""
        if asked != "auto":
            return asked
        if self._no_patch:
            return "polyharmonic_spline"
        if len(self.corners()) == 3:
            return "side_vertex"
        kept = self.fill.report.method if self.fill is not None and self._asked == self._asked_shape() else "auto"
        return kept if kept in ("multi_sided", "polyharmonic_spline") else "auto"

    def surface(self):
        """(vertices (n, 3), triangles (t, 3)) of the fill, with the mesh's own vertices as far as it uses them."""
        return np.vstack([self._positions, self.vertices]), self._net.triangles

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
        if self.fill is None or not len(self.vertices):
            return self.points.mean(axis=0), np.array([0.0, 0.0, 1.0])
        rim = writeback.parameters(self.fill)[0]  # places in the domain: they stay where the surface moves
        k = int(np.linalg.norm(self._net.places - rim.mean(axis=0), axis=1).argmin())
        normal = self.normals[k]
        return self.vertices[k] - self.shape.middle * normal, normal

    # The mesh.

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
        """Fills the hole in the mesh. Returns (filling.Outcome, new faces); UnusableError if the mesh has changed."""
        with writeback.layers_of_fills(bm):
            return self._write(ob, bm)

    def _write(self, ob, bm):
        bm.verts.index_update()
        bm.faces.index_update()
        if not self.is_current(bm):
            raise UnusableError("The mesh has changed; choose the hole again")
        loop = [bm.verts[k] for k in self.rim]
        rim = Rim(loop, corners=[loop[k] for k in self.corners()], round=self.shape.round)
        active = ob.active_shape_key.name if ob.active_shape_key else None
        matrix = filling.world_matrix(ob.name, ob.matrix_world)
        arguments = self.options()
        options = filling.Options(arguments, record=records.of_arguments(arguments))
        return filling.fill_rims(bm, ob.data, matrix, [rim], options, active)


#: How large arrows are beside Blender's own, and how small they get in a hole that is small in the view.
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
        raise UnusableError(refused[0])
    rims = halves or rims
    if len(rims) != 1:
        raise UnusableError(f"{len(rims)} holes are selected; the tool shapes one")
    return Shaping(ob, bm, rims[0], arguments)
