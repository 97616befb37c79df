"""Holes between surfaces and meshes: which of their edges, or pieces of edges, run round the hole.

Each object gives its edges as curves (`SurfaceEdge`, `MeshBorder`); `find_loop` finds the pieces, one of each, whose ends meet.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from . import _native
from ._native import Side
from ._types import Array
from .curves import Curve, MeshBorder, SurfaceEdge, Way, place_of_nearest
from .errors import Refusal
from .messages import Message

_SMOOTH = 10  # degrees: pieces that meet within them are one side, as the library joins them
_END = 1e-6  # of a curve's parameter: curves that cross so near to an end meet there
_ROUNDED = 2e-7  # of a side's extent: an end is not moved by less, which is what float32 leaves of a coordinate
_ALONG = 0.02  # sine of the angle between two curves that run along each other and do not cross


@dataclass
class Joint:
    """Where two curves meet, or nearly do."""

    a: float  # parameter on the first curve
    b: float
    gap: float
    whole: bool  # an end of both, or a place where a mesh has a vertex


@dataclass
class Loop:
    """Pieces of curves round a hole: curves[k] from ends[k][0] to ends[k][1], which is near to the start of the next."""

    curves: list[Curve]
    ends: list[tuple[float, float]]
    gaps: list[float] = field(default_factory=list)  # behind each piece
    groups: list[list[int]] = field(default_factory=list)  # pieces of each side, once these are joined
    ring: bool = False  # two whole curves, which do not meet: the hole between them is a ring

    def sides(self) -> list[tuple[Side, Array]]:
        """The sides, with ends that meet exactly (each moves to the middle of its gap), and the parameters where they are
        drawn."""
        n = len(self.curves)
        if self.ring:
            return [curve.pieces([way])[0] for curve, way in zip(self.curves, self.ends, strict=True)]
        made: list[Any] = [None] * n
        for k in range(n):
            if made[k] is None and self.curves[k] is self.curves[(k + 1) % n]:
                made[k], made[(k + 1) % n] = self.curves[k].pieces([self.ends[k], self.ends[(k + 1) % n]])
        for k in range(n):
            if made[k] is None:
                (made[k],) = self.curves[k].pieces([self.ends[k]])
        ends = [side.evaluate([0.0, 1.0])[0] for side, _ in made]
        for k, (side, t) in enumerate(made):
            start, end = 0.5 * (ends[k - 1][1] - ends[k][0]), 0.5 * (ends[(k + 1) % n][0] - ends[k][1])
            if max(np.linalg.norm(start), np.linalg.norm(end)) > _ROUNDED * np.ptp(ends[k], axis=0).max():
                made[k] = (side._moved(start.tolist(), end.tolist()), t)
        return made

    def joined_sides(self) -> list[tuple[Side, Array]]:
        """As `sides`, those that continue smoothly from one object to the next as one; all of them are a round rim. Three sides
        stay three. `groups` then holds which curves each is made of."""
        made = self.sides()
        n = len(made)
        if self.ring:
            self.groups = [[0], [1]]
            return made
        continues = [_continues(made[k][0], made[(k + 1) % n][0]) for k in range(n)]  # behind piece k
        if n == 3 or sum(continues) == n - 1:  # no patch is made for a rim of one corner
            continues = [False] * n
        first = next((k for k in range(n) if not continues[k - 1]), 0)
        self.groups = []
        for k in range(first, first + n):
            if self.groups and continues[(k - 1) % n]:
                self.groups[-1].append(k % n)
            else:
                self.groups.append([k % n])
        whole = []
        for group in self.groups:
            pieces = [made[k] for k in group]
            whole.append(_native._joined_side([side for side, _ in pieces], [t.tolist() for _, t in pieces]))
        return [(side, np.array(t)) for side, t in whole]


def _continues(side: Side, after: Side) -> bool:
    """Whether a side continues smoothly in the one after it: tangents and planes."""
    (_, along, _, normal), (_, there, _, theirs) = side.evaluate([1.0]), after.evaluate([0.0])

    angles = _native._angles(np.vstack([along, normal]), np.vstack([there, theirs]))
    return bool(angles.max() <= _SMOOTH)


def _surface_joints(a: SurfaceEdge, b: SurfaceEdge) -> list[Joint]:
    """Ends with ends, ends with places between, and places where the curves cross."""
    joints = []
    ends_a, ends_b = ([] if curve.closed else [0.0, 1.0] for curve in (a, b))
    for s, t in itertools.product(ends_a, ends_b):
        joints.append(Joint(s, t, float(np.linalg.norm(a.at(s) - b.at(t))), True))
    if ends_a:
        joints += [Joint(s, t, d, False) for s, t, d in zip(ends_a, *b.nearest(a.at(ends_a)), strict=True)]
    if ends_b:
        joints += [Joint(s, t, d, False) for t, s, d in zip(ends_b, *a.nearest(b.at(ends_b)), strict=True)]
    joints += _crossings(a, b)
    return [Joint(float(j.a), float(j.b), float(j.gap), j.whole) for j in joints]


def _crossings(a: SurfaceEdge, b: SurfaceEdge) -> list[Joint]:
    """Where the distance between two curves has a least value inside both, and they run in different directions."""
    s, t = np.linspace(0, 1, 129), np.linspace(0, 1, 129)
    gaps = np.linalg.norm(a.at(s)[:, None] - b.at(t)[None], axis=2)
    around = np.stack([np.roll(gaps, (i, j), (0, 1)) for i, j in itertools.product((-1, 0, 1), repeat=2) if (i, j) != (0, 0)])
    lowest = (gaps < around.min(axis=0)) | ((gaps <= around.min(axis=0)) & (gaps < around.max(axis=0)))
    for curve, edge in ((a, lowest), (b, lowest.T)):
        edge[-1] = False
        if not curve.closed:
            edge[0] = False
    found = []
    for i, j in sorted(np.argwhere(lowest).tolist(), key=lambda at: gaps[at[0], at[1]])[:8]:
        x, y = s[i], t[j]
        for _ in range(30):  # Gauss-Newton for the shortest connection
            (pa, da), (pb, db) = (
                [v[0] for v in curve.side.evaluate([p % 1 if curve.closed else p])[:2]] for curve, p in ((a, x), (b, y))
            )
            step = np.linalg.lstsq(np.stack([da, -db], axis=1), pb - pa, rcond=1e-9)[0].clip(-0.01, 0.01)
            x, y = (v % 1 if curve.closed else min(max(v, 0.0), 1.0) for curve, v in ((a, x + step[0]), (b, y + step[1])))
            if np.abs(step).max() < 1e-14:
                break
        inside = all(curve.closed or _END < v < 1 - _END for curve, v in ((a, x), (b, y)))
        across = np.linalg.norm(np.cross(da, db)) > _ALONG * np.linalg.norm(da) * np.linalg.norm(db)
        if inside and across:
            found.append(Joint(x, y, float(np.linalg.norm(pa - pb)), False))
    return found


def _mesh_joints(a: MeshBorder, b: Curve, tolerance: float) -> list[Joint]:
    """Vertices of a mesh's border next to a curve: where the two run along each other only the first and the last of them."""
    t, gaps = b.nearest(a.points)
    near = gaps <= tolerance
    if not near.any():
        places = [int(gaps.argmin())]
    else:
        before, after = np.roll(near, 1), np.roll(near, -1)
        if not a.closed:
            before[0] = after[-1] = False
        places = np.nonzero(near & ~(before & after))[0].tolist()
    joints = [Joint(a.t[k], t[k], gaps[k], isinstance(b, MeshBorder)) for k in places]
    if not b.closed:
        ends = np.array([0.0, 1.0])
        joints += [Joint(s, e, d, True) for e, s, d in zip(ends, *a.nearest(b.at(ends)), strict=True)]
    if not a.closed:
        joints += [Joint(a.t[k], t[k], gaps[k], True) for k in (0, -1)]
    return [Joint(float(j.a), float(j.b), float(j.gap), j.whole) for j in joints]


def _joints(a: Curve, b: Curve, tolerance: float) -> list[Joint]:
    if isinstance(a, MeshBorder) and a is b:  # two sides of one mesh
        return [Joint(float(t), float(t), 0.0, True) for t in a.corners()]
    if isinstance(a, MeshBorder):
        found = _mesh_joints(a, b, tolerance)
    elif isinstance(b, MeshBorder):
        found = [Joint(j.b, j.a, j.gap, j.whole) for j in _mesh_joints(b, a, tolerance)]
    else:
        assert isinstance(a, SurfaceEdge) and isinstance(b, SurfaceEdge)
        found = _surface_joints(a, b)
    # Next to ends that meet, a place between is no joint of its own.
    kept = [j for j in found if j.whole]
    met = [(a.at(j.a)[0], b.at(j.b)[0]) for j in kept if j.gap <= tolerance]
    for j in found:
        near = any(min(np.linalg.norm(a.at(j.a)[0] - p), np.linalg.norm(b.at(j.b)[0] - q)) <= 2 * tolerance for p, q in met)
        if not j.whole and not near:
            kept.append(j)
    return kept


def _arcs(curve: Curve, start: float, end: float) -> list[tuple[float, float]]:
    """The ways along a curve from one parameter to another."""
    if not curve.closed:
        return [(start, end)] if start != end else []
    if start == end:
        return []
    low, high = min(start, end), max(start, end)
    ways = [(low, high), (high, low + 1)]
    return [way if (way[0] % 1.0) == start else way[::-1] for way in ways]


def _length(curve: Curve, way: tuple[float, float]) -> float:
    p = curve.at(np.linspace(*way, 17)) if not isinstance(curve, MeshBorder) else curve.at(_steps_between(curve, way))
    return float(np.linalg.norm(np.diff(p, axis=0), axis=1).sum())


def _steps_between(curve: MeshBorder, way: tuple[float, float]) -> Array:
    low, high = sorted(way)
    return np.arange(round(low * curve._steps), round(high * curve._steps) + 1) / curve._steps


def _search(objects: Any, joints: Any, limit: float, cost: Any, least: float) -> tuple[float, Loop] | None:
    """The loop of least finite cost(gaps, whole, length) whose joints are within the limit; pieces are longer than `least`."""
    best, lengths = None, {}

    def ways(curve: Any, start: float, end: float) -> Any:
        key = (id(curve), start, end)
        if key not in lengths:
            lengths[key] = [(way, n) for way in _arcs(curve, start, end) if (n := _length(curve, way)) > least]
        return lengths[key]

    for a, b, c in itertools.product(*objects):
        near = [[j for j in joints[id(x), id(y)] if j.gap <= limit] for x, y in ((a, b), (b, c), (c, a))]
        for ab, bc, ca in itertools.product(*near):
            pieces = ways(a, ca.b, ab.a), ways(b, ab.b, bc.a), ways(c, bc.b, ca.a)
            for (wa, la), (wb, lb), (wc, lc) in itertools.product(*pieces):
                taken = [(a, wa), (b, wb), (c, wc)]
                if any(x is y and not _follow(v, w) for (x, v), (y, w) in itertools.combinations(taken, 2)):
                    continue
                value = cost([ab.gap, bc.gap, ca.gap], [ab.whole, bc.whole, ca.whole], la + lb + lc)
                if value < (np.inf if best is None else best[0] - 1e-9 * abs(best[0])):  # of equals the first
                    best = (value, Loop([a, b, c], [wa, wb, wc], [ab.gap, bc.gap, ca.gap]))
    return best


def _follow(v: tuple[float, float], w: tuple[float, float]) -> bool:
    """Two pieces of one curve run in the same direction and do not overlap."""
    return (v[1] > v[0]) == (w[1] > w[0]) and abs(v[1] - v[0]) + abs(w[1] - w[0]) <= 1 + 1e-9


def facing(loop: Loop, over: Sequence[bool] | None = None) -> Loop:
    """The loop in the direction in which most of its curves have the normals of their objects. over: whose objects lie over the
    hole, not next to it."""
    over = over or [False] * len(loop.curves)
    own = sum((curve.own == (way[1] > way[0])) != above for curve, way, above in zip(loop.curves, loop.ends, over, strict=True))
    if 2 * own >= len(loop.curves):
        return loop
    gaps = loop.gaps[:-1][::-1] + loop.gaps[-1:]
    return Loop(loop.curves[::-1], [way[::-1] for way in loop.ends[::-1]], gaps)


def _around(objects: Any, joints: Any, limit: float, least: float) -> Loop | None:
    """The shortest loop of one piece of each of many objects, in any order, whose joints are within the limit."""
    best: list[Any] = [np.inf, None]

    def extend(curves: list[Curve], path: list[Joint], left: frozenset[int], taken: list[Way], length: float) -> None:
        """path: joints so far, each from one of the curves to the next; taken: the pieces between them."""
        here = curves[-1]
        goals: list[tuple[int | None, Curve]] = [(k, c) for k in left for c in objects[k]] if left else [(None, curves[0])]
        for k, there in goals:
            for joint in joints[id(here), id(there)]:
                if joint.gap > limit:
                    continue
                ways: list[Way | None] = [*_arcs(here, path[-1].b, joint.a)] if path else [None]
                for way in ways:
                    long = 0.0 if way is None else _length(here, way)
                    if (way is not None and long <= least) or length + long >= best[0]:
                        continue
                    pieces = taken if way is None else [*taken, way]
                    if k is not None:
                        extend([*curves, there], [*path, joint], left - {k}, pieces, length + long)
                        continue
                    for first in _arcs(there, joint.b, path[0].a):
                        whole = length + long + (own := _length(there, first))
                        if own > least and whole < best[0] * (1 - 1e-9):
                            gaps = [j.gap for j in [*path, joint]]
                            best[:] = whole, Loop(list(curves), [first, *pieces], gaps)

    for start in objects[0]:
        extend([start], [], frozenset(range(1, len(objects))), [], 0.0)
    found: Loop | None = best[1]
    return found


def _loop_of_many(objects: Any, tolerance: float, size: float) -> Loop:
    """`find_loop` for four objects or more, each of which gives a side."""
    joints = {}
    for own, other in itertools.combinations(objects, 2):
        for x, y in itertools.product(own, other):
            found = joints[id(x), id(y)] = _joints(x, y, tolerance)
            joints[id(y), id(x)] = [Joint(j.b, j.a, j.gap, j.whole) for j in found]
    loop = _around(objects, joints, tolerance, max(2 * tolerance, 1e-6 * size))
    if loop:
        return facing(loop)
    # who is met by fewer than two others stands apart; of those the farthest
    apart = (-1.0, "", "")
    for own in objects:
        nearest = []
        for other in objects:
            if other is not own:
                gaps = [j.gap if j.whole else 10 * j.gap for x in own for y in other for j in joints[id(x), id(y)]]
                nearest.append((min(gaps, default=np.inf), other[0].name))
        gap, name = sorted(nearest)[1]
        apart = max(apart, (gap, own[0].name, name))
    if apart[0] > tolerance:
        raise _apart(apart[1], apart[2], apart[0], tolerance)
    names = [own[0].name for own in objects]
    raise Refusal.of(Message("edges_enclose_no_hole", {"names": names}))


def _apart(first: str, second: str, gap: float, tolerance: float) -> Refusal:
    """Of two surfaces whose edges do not meet."""
    return Refusal.of(Message("edges_apart", {"first": first, "second": second, "gap": float(gap), "tolerance": tolerance}))


def _loop_of_two(objects: Sequence[Sequence[Curve]], tolerance: float, least: float) -> tuple[float, Loop] | None:
    """The shortest loop of one piece of each of two objects. A piece of a mesh's border has no corner inside."""
    best = None
    for x, y in itertools.product(*objects):
        near = [joint for joint in _joints(x, y, tolerance) if joint.gap <= tolerance]
        for first, second in itertools.permutations(near, 2):  # from one joint along x to the other, and back along y
            for there, back in itertools.product(_arcs(x, first.a, second.a), _arcs(y, second.b, first.b)):
                lengths = _length(x, there), _length(y, back)
                turns = any(isinstance(c, MeshBorder) and c.turns_within(way) for c, way in ((x, there), (y, back)))
                if turns or min(lengths) <= least or (best and sum(lengths) >= best[0] * (1 - 1e-9)):
                    continue
                best = (sum(lengths), Loop([x, y], [there, back], [second.gap, first.gap]))
    return best


def _leads_to(curve: SurfaceEdge, other: SurfaceEdge) -> bool:
    """Whether a surface, continued over its edge, leads to another edge in the mean."""
    c, _, across, _ = curve.side.evaluate(curve.t)
    way = other.points[place_of_nearest(other.points, c)] - c
    return bool((way * across).sum(axis=1).mean() < 0)


def _ring_of_two(objects: Sequence[Sequence[Curve]]) -> Loop | None:
    """The two closed edges of surfaces, one of each object, that face each other and are nearest, as the two sides of a ring."""
    closed = [[c for c in own if isinstance(c, SurfaceEdge) and c.closed] for own in objects]
    best = None
    for x, y in itertools.product(*closed):
        if not (_leads_to(x, y) and _leads_to(y, x)):
            continue
        apart = np.linalg.norm(y.points[place_of_nearest(y.points, x.points)] - x.points, axis=1).mean()
        if best is None or apart < best[0] * (1 - 1e-9):
            ends = [(0.0, 1.0) if curve.own else (1.0, 0.0) for curve in (x, y)]
            best = (apart, Loop([x, y], ends, [0.0, 0.0], ring=True))
    return best[1] if best else None


def find_loop(objects: Sequence[Sequence[Curve]], tolerance: float, whole: bool = False) -> Loop:
    """The smallest loop of pieces of curves whose ends meet.

    Args:
        objects: the curves of each of two to twelve objects, which give a side each; or of two, of which a mesh gives two
            sides.
        tolerance: largest gap between ends that still meet.
        whole: of three objects, pieces that meet in ends of both edges are taken first: edges of surfaces that lie over each
            other cross too.

    Returns:
        The loop; if nothing of two objects meets, but each has a closed edge of a surface, and these face each other, the two of
        them, as a ring.

    Raises:
        Refusal: no such pieces meet; names the two objects of the widest gap, and the gap.
    """
    curves = [curve for own in objects for curve in own]
    size = float(np.ptp(np.concatenate([curve.points for curve in curves]), axis=0).max())
    if len(objects) > 3:
        return _loop_of_many(objects, tolerance, size)
    if len(objects) == 3:
        ways = [list(objects)]
    else:
        doubled = [[c for c in own if isinstance(c, MeshBorder)] for own in objects]
        ways = [[objects[1 - k], own, own] for k, own in enumerate(doubled) if own]
    joints = {}
    for order in ways:
        for first, second in itertools.combinations(range(3), 2):
            for x, y in itertools.product(order[first], order[second]):
                if (id(x), id(y)) not in joints:
                    found = joints[id(x), id(y)] = _joints(x, y, tolerance)
                    joints[id(y), id(x)] = [Joint(j.b, j.a, j.gap, j.whole) for j in found]

    def least(limit: Any, cost: Any, shortest: Any) -> Any:
        found = [best for order in ways if (best := _search(order, joints, limit, cost, shortest))]
        return min(found, key=lambda best: best[0], default=None)

    shortest = max(2 * tolerance, 1e-6 * size)
    best = least(tolerance, lambda _, ends, length: length if all(ends) else np.inf, shortest) if whole else None
    if best is None:
        best = least(tolerance, lambda _, ends, length: length, shortest)
    if len(objects) == 2:
        lens = _loop_of_two(objects, tolerance, shortest)
        best = min((found for found in (best, lens) if found), key=lambda found: found[0], default=None)
    if best:
        return facing(best[1])
    if len(objects) == 2 and (ring := _ring_of_two(objects)):
        return ring
    names = list(dict.fromkeys(curve.name for curve in curves))
    nearly = least(np.inf, lambda gaps, whole, _: max(g if w else 10 * g for g, w in zip(gaps, whole)), 1e-3 * size)
    if nearly is None or max(nearly[1].gaps) <= tolerance:
        of_two = len(objects) == 2
        raise Refusal.of(Message("edges_enclose_no_lens" if of_two else "edges_enclose_no_triangle", {"names": names}))
    loop = nearly[1]
    k = int(np.argmax(loop.gaps))
    raise _apart(loop.curves[k].name, loop.curves[(k + 1) % 3].name, float(loop.gaps[k]), tolerance)
