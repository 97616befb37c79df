"""Which pieces of edges run round a hole between surfaces and meshes."""

import itertools

import numpy as np
import pytest
import tripatch
from codes import refused
from tripatch import between

CORNERS = np.array([(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.5, 1.5, 0.3)])


def sheet(start, end, outside, before=0.0, after=0.0, degree=3):
    """A Bezier surface whose edge v = 0 runs from start to end, and so much (of its length) further at both ends."""
    along = end - start
    u = np.linspace(-before, 1 + after, degree + 1)
    rows = [start + u[:, None] * along + v * outside for v in np.linspace(0, 1, degree + 1)]
    return tripatch.BezierRectangle(np.stack(rows, axis=1))


def edges(name, surface, drawn=8, own=True):
    return [between.SurfaceEdge(name, tripatch.Side(surface, e), drawn, own) for e in range(4)]


def three(before=(0, 0, 0), after=(0, 0, 0)):
    found = []
    for i in range(3):
        a, b = CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3]
        outside = (a + b) / 2 - CORNERS.mean(axis=0) + (0, 0, 0.2)
        found.append(edges("ABC"[i], sheet(a, b, outside, before[i], after[i])))
    return found


def checked(loop, corners=CORNERS):
    """The patch on the loop's sides, which run from corner to corner without a gap."""
    sides = loop.sides()
    patch = tripatch.patch([side for side, _ in sides])
    ends = np.array([side.evaluate([0.0, 1.0])[0] for side, _ in sides])
    assert np.abs(ends[:, 1] - np.roll(ends, -1, axis=0)[:, 0]).max() < 1e-6
    for p in ends[:, 0]:
        assert np.linalg.norm(corners - p, axis=1).min() < 1e-6
    assert all(t[0] == 0 and t[-1] == 1 and (np.diff(t) > 0).all() for _, t in sides)
    b, faces = patch.triangles([t for _, t in sides])
    assert np.isfinite(patch.evaluate(b)).all() and len(faces)
    return patch, sides


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
def test_whole_edges_in_any_order(order):
    objects = three()
    loop = between.find_loop([objects[k] for k in order], 1e-3)
    assert set(loop.ends) <= {(0.0, 1.0), (1.0, 0.0)} and max(loop.gaps) < 1e-12
    checked(loop)


@pytest.mark.parametrize("before", [(0.4, 0, 0), (0.3, 0.2, 0), (0.5, 0.5, 0.5)])
@pytest.mark.parametrize("after", [(0, 0, 0), (0.3, 0, 0.7), (0.2, 0.3, 0.4)])
def test_pieces_of_edges(before, after):
    """Where an edge continues beyond the corner its piece counts; where two continue they cross there."""
    loop = between.find_loop(three(before, after), 1e-3)
    assert max(loop.gaps) < 1e-9
    patch, sides = checked(loop)
    for (side, _), curve, (start, end) in zip(sides, loop.curves, loop.ends):
        t = np.linspace(0, 1, 9)
        c, _, r, _ = side.evaluate(t)
        own = curve.side.evaluate(start + t * (end - start))
        assert np.abs(c - own[0]).max() < 1e-9 and np.abs(r - own[2]).max() < 1e-9


def many(n, beyond=0.0):
    """n sheets round a hole in a saddle."""
    angle = 2 * np.pi * np.arange(n) / n
    corners = np.column_stack([np.cos(angle), np.sin(angle), 0.2 * np.cos(2 * angle)])
    found = []
    for i in range(n):
        a, b = corners[i], corners[(i + 1) % n]
        found.append(edges("ABCDEFGHIJKL"[i], sheet(a, b, (a + b) / 2 + (0, 0, 0.1), beyond, beyond)))
    return found, corners


@pytest.mark.parametrize(("n", "beyond"), [(4, 0), (5, 0.3), (7, 0), (12, 0)])
def test_a_side_of_each_of_many_in_any_order(n, beyond):
    objects, corners = many(n, beyond)
    order = np.random.default_rng(n).permutation(n)
    loop = between.find_loop([objects[k] for k in order], 1e-3)
    assert len(loop.curves) == n and {curve.name for curve in loop.curves} == {own[0].name for own in objects}
    patch, sides = checked(loop, corners)
    b, faces = patch.triangles(6)
    count = np.unique(
        np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0, return_counts=True
    )[1]
    assert (count == 1).sum() == 6 * n and count.max() == 2  # a disc
    t = np.linspace(0.05, 0.95, 7)
    for i, (side, _) in enumerate(sides):
        at = np.outer(1 - t, patch.domain[i]) + np.outer(t, patch.domain[(i + 1) % n])
        assert np.abs(patch.evaluate(at) - side.evaluate(t)[0]).max() < 1e-9
        assert tripatch.angles(patch.normal(at), side.evaluate(t)[3]).max() < 1e-4


@pytest.mark.parametrize("long_first", [False, True])
def test_of_two_edges_between_the_same_corners_the_shorter_is_taken(long_first):
    objects, corners = many(5)
    (a, b), out = corners[:2], corners[:2].mean(axis=0)
    u, v = np.meshgrid(np.linspace(0, 1, 3), np.linspace(0, 1, 3), indexing="ij")
    bow = a + u[..., None] * (b - a) + (0.4 * (u == 0.5) + v)[..., None] * (out + (0, 0, 0.1))
    bowed = edges("A", tripatch.BezierRectangle(bow))
    objects[0] = bowed + objects[0] if long_first else objects[0] + bowed
    loop = between.find_loop(objects, 1e-3)
    (curve,) = [c for c in loop.curves if c.name == "A"]
    assert np.linalg.norm(np.diff(curve.at(np.linspace(0, 1, 65)), axis=0), axis=1).sum() < 1.001 * np.linalg.norm(b - a)


def arched(sign, name="arch", high=0.4):
    """A sheet along a parabola from (-1, 0, 0) to (1, 0, 0), or back below it, and away from the other."""
    u, v = np.meshgrid(np.linspace(-1, 1, 3), np.linspace(0, 1, 3), indexing="ij")
    arch = np.array([0, 2 * high, 0])[:, None]
    net = np.stack([u, sign * (arch + 0.5 * v), 0.2 * v], axis=2)
    return edges(name, tripatch.BezierRectangle(net if sign < 0 else net[::-1]))


def test_two_objects_with_a_side_each():
    loop = between.find_loop([arched(-1, "lower"), arched(1, "upper")], 1e-3)
    assert len(loop.curves) == 2 and max(loop.gaps) < 1e-12
    sides = loop.joined_sides()
    patch = tripatch.patch([side for side, _ in sides], fairing="auto")
    t = np.linspace(0.01, 0.99, 21)
    for i, (side, _) in enumerate(sides):
        c, _, _, normal = side.evaluate(t)
        assert np.abs(patch.evaluate(patch.on_side(i, t)) - c).max() < 1e-12
        assert tripatch.angles(patch.normal(patch.on_side(i, t)), normal).max() < 1e-5
    b, faces = patch.triangles([t for _, t in sides])
    border = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, count = np.unique(border, axis=0, return_counts=True)
    assert (count == 1).sum() == 16 and count.max() == 2


def test_objects_that_go_on_smoothly_are_one_side():
    objects, corners = many(4)
    a, b = corners[1], corners[2]
    cuts = [a + share * (b - a) for share in (0, 0.3, 0.65, 1)]
    out = (a + b) / 2 + (0, 0, 0.1)
    pieces = [edges(f"B{k}", sheet(p, q, out)) for k, (p, q) in enumerate(itertools.pairwise(cuts))]
    loop = between.find_loop([objects[0], pieces[1], objects[2], pieces[0], objects[3], pieces[2]], 1e-3)
    assert len(loop.curves) == 6
    sides = loop.joined_sides()
    assert sorted(map(len, loop.groups)) == [1, 1, 1, 3]
    (whole,) = [k for k, group in enumerate(loop.groups) if len(group) == 3]
    assert len(sides[whole][1]) == 3 * 8 + 1 and (np.diff(sides[whole][1]) > 0).all()
    patch = tripatch.patch([side for side, _ in sides])
    t = np.linspace(0, 1, 9)
    on = patch.evaluate(patch.on_side(whole, t))
    ends = [corners[2], corners[1]] if np.linalg.norm(on[0] - corners[2]) < 1e-6 else [corners[1], corners[2]]
    np.testing.assert_allclose(on, np.outer(1 - t, ends[0]) + np.outer(t, ends[1]), atol=1e-9)


def test_all_that_goes_on_smoothly_is_a_round_rim():
    whole = [edge for edge in edges("tube", ring()) if edge.closed][1].side
    halves = [[between.SurfaceEdge(name, whole.part(*way), 8, True)] for name, way in (("A", (0, 0.4)), ("B", (0.4, 1)))]
    loop = between.find_loop(halves, 1e-3)
    ((side, t),) = loop.joined_sides()
    patch = tripatch.patch([side], fairing="auto")
    places, faces = patch.triangles([t])
    assert len(t) == 17 and len(faces) and patch.domain.shape == (64, 2)
    assert tripatch.angles(patch.normal(patch.on_side(0, t)), side.evaluate(t)[3]).max() < 0.05
    assert (
        np.abs(
            np.linalg.norm(patch.evaluate(places)[:16, :2], axis=1) - np.linalg.norm(side.evaluate(t)[0][:16, :2], axis=1)
        ).max()
        < 1e-4
    )


def test_a_gap_between_many_is_named():
    objects, _ = many(5)
    far = edges("far", sheet(np.array([5.0, 0, 0]), np.array([6.0, 0, 0]), np.array([0, 1.0, 0])))
    with pytest.raises(tripatch.Refusal, match="far and . do not meet"):
        between.find_loop([*objects[:4], far], 1e-3)


def test_the_fill_faces_as_most_objects_do():
    for own in ((False, False, False), (True, False, True), (False, True, False)):
        objects = three()
        for curves, mine in zip(objects, own):
            for curve in curves:
                curve.own = mine
        loop = between.find_loop(objects, 1e-3)
        same = [curve.own == (way[1] > way[0]) for curve, way in zip(loop.curves, loop.ends)]
        assert sum(same) >= 2
        assert (
            sum(
                np.linalg.norm(c.at(w[1]) - d.at(v[0]))
                for c, w, d, v in zip(loop.curves, loop.ends, loop.curves[1:] + loop.curves[:1], loop.ends[1:] + loop.ends[:1])
            )
            < 1e-9
        )


def test_a_gap_is_named():
    objects = three()
    far = sheet(CORNERS[0] + (0, 0, 0.05), CORNERS[1] + (0, 0, 0.05), np.array((0, -1.0, 0)))
    objects[2] = edges("C", far)
    with pytest.raises(tripatch.Refusal, match=r"The edges of ([AB] and C|C and [AB]) do not meet: they are 0\.05 apart"):
        between.find_loop(objects, 1e-3)
    loop = between.find_loop(objects, 0.06)
    assert sorted(loop.gaps) == pytest.approx([0, 0.05, 0.05], abs=1e-9)
    checked(loop, np.vstack([CORNERS, CORNERS + (0, 0, 0.025)]))


def ring(n=4):
    """A closed cubic B-spline tube about the z axis, from z = -1 up to z = 0, cyclic in u."""
    angle = np.arange(n + 3) * 2 * np.pi / n
    points = np.stack([np.stack([np.cos(angle), np.sin(angle), np.full(n + 3, z)], axis=1) for z in (-1.0, 0.0)], axis=1)
    return tripatch.NurbsSurface(points, None, np.arange(n + 7.0), [0, 0, 1, 1])


@pytest.mark.parametrize("turn", [0.0, 1.0, 3.0, 6.2])
def test_a_piece_of_a_closed_edge(turn):
    """Also across the place where the edge starts and ends."""
    surface = ring()
    tube = [between.SurfaceEdge("Tube", tripatch.Side(surface, e), 32, True) for e in (0, 2)]
    assert all(curve.closed for curve in tube)
    turned = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    radius = np.linalg.norm(tube[1].points[0])
    tip = turned @ (2.0, 0, 0)
    ends = [tube[1].at(tube[1].nearest(turned @ (np.cos(x), np.sin(x), 0))[0])[0] for x in (-0.5, 0.5)]
    others = [
        edges("B", sheet(ends[1], tip, turned @ (0, 0.5, 0.3))),
        edges("C", sheet(tip, ends[0], turned @ (0, -0.5, 0.3))),
    ]
    loop = between.find_loop([tube, *others], 1e-6)
    patch, sides = checked(loop, np.array([tip, *ends]))
    k = loop.curves.index(tube[1])
    c, dc, _, _ = sides[k][0].evaluate(np.linspace(0, 1, 50))
    assert np.linalg.norm(dc, axis=1).min() > 0.5 * radius  # no jump at the seam
    assert np.abs(tube[1].nearest(c)[1]).max() < 1e-9
    assert np.linalg.norm(np.diff(c, axis=0), axis=1).sum() < 2 * radius  # the short way


def grid(n, at):
    """Vertices at(i / n, j / n) and quads, whose normals point to d/du x d/dv."""
    u, v = (x.ravel() / n for x in np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij"))
    quads = [
        [i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1]
        for i in range(n)
        for j in range(n)
    ]
    return np.array([at(a, b) for a, b in zip(u, v)]), quads


def mesh_of(surface, n=12):
    return grid(n, lambda u, v: surface.evaluate([(u, v)])[0])


def test_a_chain_of_a_border_has_its_two_ends():
    vertices, faces = grid(3, lambda u, v: (u, v, 0))
    (loop,) = tripatch.find_holes(faces)
    chain, whole = between.MeshBorder("A", vertices, faces, loop, 3), between.MeshBorder("B", vertices, faces, loop)
    assert not chain.closed and np.allclose(chain.points, vertices[loop[:4]]) and np.allclose(chain.t, [0, 1 / 3, 2 / 3, 1])
    assert whole.closed and np.allclose(whole.points, vertices[loop]) and np.allclose(whole.t, np.arange(12) / 12)


@pytest.mark.parametrize("meshes", [(0,), (0, 2), (0, 1, 2)])
def test_sides_of_meshes(meshes):
    """A mesh's side runs through its vertices, with the tangent planes of the surface that it stands for."""
    objects = three()
    for k in meshes:
        vertices, faces = mesh_of(
            sheet(
                CORNERS[(k + 1) % 3],
                CORNERS[(k + 2) % 3],
                (CORNERS[(k + 1) % 3] + CORNERS[(k + 2) % 3]) / 2 - CORNERS.mean(axis=0) + (0, 0, 0.2),
            )
        )
        objects[k] = [between.MeshBorder("ABC"[k], vertices, faces, loop) for loop in tripatch.find_holes(faces)]
    exact = between.find_loop(three(), 1e-3)
    loop = between.find_loop(objects, 1e-3)
    patch, sides = checked(loop)
    for k in meshes:
        (place,) = [i for i, curve in enumerate(loop.curves) if curve.name == "ABC"[k]]
        side, t = sides[place]
        assert len(t) == 13
        assert np.linalg.norm(loop.curves[place].points[:, None] - side.evaluate(t)[0], axis=2).min(axis=0).max() < 1e-9
        (other,) = [s for (s, _), curve in zip(exact.sides(), exact.curves) if curve.name == "ABC"[k]]
        angle = np.abs((side.evaluate([0.5])[3] * other.evaluate([0.5])[3]).sum())
        assert angle > 1 - 1e-6


def test_two_sides_of_one_mesh():
    """An L-shaped sheet and a strip across its corner."""
    n = 8
    vertices, faces = grid(n, lambda u, v: (2 * u, 2 * v, 0.3 * u * v))
    kept = [f for f in faces if max(vertices[f][:, 0].min(), vertices[f][:, 1].min()) >= 1 - 1e-9]
    strip = sheet(np.array((0, 1, 0.0)), np.array((1.0, 0, 0)), np.array((-0.5, -0.5, 0)))
    mesh = [between.MeshBorder("L", vertices, kept, loop) for loop in tripatch.find_holes(kept)]
    loop = between.find_loop([mesh, edges("Strip", strip)], 1e-3)
    corners = np.array([(0, 1.0, 0), (1.0, 0, 0), (1, 1, 0.075)])
    patch, sides = checked(loop, corners)
    assert sorted(curve.name for curve in loop.curves) == ["L", "L", "Strip"]
    assert sorted(len(t) for _, t in sides) == [5, 5, 9]
    t = np.linspace(0, 1, 9)
    for curve, (side, _) in zip(loop.curves, sides):
        if curve.name == "L":
            c, _, _, normal = side.evaluate(t)
            exact = np.stack([-0.075 * c[:, 1], -0.075 * c[:, 0], np.ones(9)], axis=1)
            exact /= np.linalg.norm(exact, axis=1, keepdims=True)
            assert np.abs(c[:, 2] - 0.075 * c[:, 0] * c[:, 1]).max() < 1e-5
            assert (normal * exact).sum(axis=1).min() > 1 - 1e-5


def test_bad_input():
    flat = tripatch.BezierRectangle([[[u, 0, 0], [u + 0.1, 0, 0]] for u in (0.0, 0.3, 1.0)])
    with refused("surface_flat_to_line"):
        between.SurfaceEdge("F", tripatch.Side(flat, 0), 8, True)
    sides = [side for side, _ in between.find_loop(three(), 1e-3).sides()]
    along = sides[0].evaluate
    line = tripatch.Side.from_functions(lambda t: along(t)[0], lambda t: along(t)[1], lambda t: along(t)[1])
    with pytest.raises(tripatch.Refusal, match="Side 0 has no tangent planes"):
        tripatch.patch([line, *sides[1:]])
    assert tripatch.patch([line, *sides[1:]], continuity="G0")
    same = three()[0]
    with pytest.raises(tripatch.Refusal, match="do not meet|no three-sided hole"):
        between.find_loop([same, edges("A2", sheet(CORNERS[1], CORNERS[2], np.array((1.0, 1, 0)))), three()[2]], 1e-3)


def test_pieces_of_sides():
    side = tripatch.Side(sheet(CORNERS[0], CORNERS[1], np.array((0, -1.0, 0.4))), 0)
    t = np.linspace(0, 1, 11)
    for start, end in ((0.2, 0.9), (0.9, 0.2), (0.0, 1.0), (1.0, 0.0)):
        piece = side.part(start, end)
        mine, own = piece.evaluate(t), side.evaluate(start + t * (end - start))
        assert np.abs(mine[0] - own[0]).max() < 1e-14 and np.abs(mine[2] - own[2]).max() < 1e-13
        assert np.abs(mine[1] - (end - start) * own[1]).max() < 1e-13
    for start, end in ((0.5, 0.5), (-0.1, 0.5), (0.5, 1.2)):
        with pytest.raises(ValueError):
            side.part(start, end)
    with pytest.raises(TypeError):
        side.part("0", 1)


def bezier3():
    """The bicubic nets of bezier3 in scripts/comparison/holes.py: tangent planes that agree at the corners only."""
    turn = 2 * np.pi * np.arange(3) / 3

    def unit(v):
        return v / np.linalg.norm(v, axis=-1, keepdims=True)

    corners = np.stack([np.cos(turn), np.sin(turn), np.array([0, 0.25, -0.1])], axis=1)
    normals = unit(np.array([[-0.35, 0.15, 1], [0.3, 0.25, 1], [-0.1, -0.45, 1]]))
    outward = corners - corners.mean(0)
    outward = 1.2 * unit(outward - (outward * normals).sum(1)[:, None] * normals)
    shared, nets = [], []
    for p, normal, o, bump in zip(corners, normals, outward, (0.25, -0.15, 0.1)):
        second = p + 2 * o / 3 - 0.15 * normal
        shared.append(np.array([p, p + o / 3, second, second + o / 3 + bump * normal]))
    for i, tilts in enumerate([(0.35, 0.10), (-0.30, 0.05), (0.05, -0.40)]):
        a, b = i, (i + 1) % 3
        chord = corners[b] - corners[a]
        ends = [unit(chord - (chord @ normals[k]) * normals[k]) * np.linalg.norm(chord) / 3 for k in (a, b)]
        net = np.zeros((4, 4, 3))
        net[0] = corners[a], corners[a] + ends[0], corners[b] - ends[1], corners[b]
        net[:, 0], net[:, 3] = shared[a], shared[b]
        out = 1.2 * unit(np.array([chord[1], -chord[0], 0])) / 3
        for k, tilt in zip((1, 2), tilts):
            for row, height in zip((1, 2, 3), (0.5, -0.3, 0.2)):
                net[row, k] = net[row - 1, k] + out + [0, 0, tilt * height]
        nets.append(net)
    return nets


@pytest.mark.parametrize("fairing", [None, "auto"])
def test_three_bicubic_patches(fairing):
    """Seam angle at 200 points a side, against normals from the nets' own Bernstein polynomials."""
    nets = bezier3()
    loop = between.find_loop([edges("ABC"[i], tripatch.BezierRectangle(net)) for i, net in enumerate(nets)], 1e-6)
    patch = tripatch.patch([side for side, _ in loop.sides()], fairing=fairing)
    t = np.linspace(0, 1, 200)
    bernstein = np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3], axis=1)
    slope = 3 * np.stack([-((1 - t) ** 2), (1 - t) * (1 - 3 * t), t * (2 - 3 * t), t * t], axis=1)
    worst = 0.0
    for i, curve in enumerate(loop.curves):
        net = nets["ABC".index(curve.name)]
        exact = np.cross(slope @ net[0], 3 * bernstein @ (net[1] - net[0]))
        b = np.zeros((200, 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
        if np.linalg.norm(patch.evaluate(b[:1]) - net[0, 0]) > 1e-9:
            b = b[::-1]
        assert np.abs(patch.evaluate(b) - bernstein @ net[0]).max() < 1e-12
        normal = patch.normal(b)
        angle = np.degrees(np.arctan2(np.linalg.norm(np.cross(normal, exact), axis=1), np.abs((normal * exact).sum(axis=1))))
        worst = max(worst, angle.max())
    print(f"FIGURE bezier3 fairing {fairing} seam {worst:.1e}")
    assert worst < 1e-5
