"""Constituents of a blend from surfaces and meshes at a hole."""

import numpy as np
import pytest
import tripatch
from test_papers import largest
from tripatch import constituents
from tripatch.between import MeshBorder, SurfaceEdge, find_loop

CORNERS = np.array([[0, 0, 0], [1, 0, 0.2], [0.3, 0.9, 0.1]])
T = np.linspace(0, 1, 17)


def sheet(i, sign, seed=0, beyond=0.0):
    """A biquadratic surface with an edge along side i, and beyond its corners: over the hole (sign 1) or next to it."""
    rng = np.random.default_rng(seed + i)
    a, b, opposite = CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3], CORNERS[i]
    a, b = a + beyond * (a - b), b + beyond * (b - a)
    u, v = np.meshgrid([0, 0.5, 1], [0, 0.5, 1], indexing="ij")
    net = a + u[..., None] * (b - a) + sign * v[..., None] * (opposite - (a + b) / 2)
    net[:, 1:] += 0.1 * rng.normal(size=(3, 2, 3))
    net[1, 0] += [0, 0, 0 if beyond else 0.1]
    if sign < 0:
        net = net[::-1]  # the normals of both face the same way
    return tripatch.NurbsSurface(net, None, [0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 1])


def edges(name, surface, own):
    return [SurfaceEdge(name, tripatch.Side(surface, e), 8, own, (surface, e)) for e in range(4)]


def loop_of(signs, beyond=0.0, shift=0.0):
    found = []
    for i, sign in enumerate(signs):
        surface = sheet(i, sign, beyond=beyond)
        if shift and i == 0:
            points = surface.evaluate(np.array([(u, v) for u in (0, 0.5, 1) for v in (0, 0.5, 1)]))
            assert points.shape == (9, 3)
        found.append(edges("ABC"[i], surface, True))
    return find_loop(found, 1e-6)


@pytest.mark.parametrize("signs", [(1, 1, 1), (-1, -1, -1), (1, -1, 1), (-1, -1, 1)])
@pytest.mark.parametrize("beyond", [0.0, 0.4])
def test_the_blend_meets_each_surface_in_its_planes(signs, beyond):
    loop, made = constituents.of_loop(loop_of(signs, beyond))
    patch = tripatch.blend(*(surface for surface, _ in made))
    assert patch.report.seam_angle_max < 1e-4
    for i, (side, _) in enumerate(loop.sides()):
        b = np.zeros((17, 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - T, T
        c, _, _, normal = side.evaluate(T)
        assert largest(patch.evaluate(b) - c) < 1e-7
        angles = tripatch.angles(patch.normal(b)[1:-1], normal[1:-1])
        assert min(angles.max(), (180 - angles).max()) < 1e-4


def test_a_surface_over_the_hole_is_a_constituent_as_it_is():
    loop, made = constituents.of_loop(loop_of((1, 1, 1)))
    for i, (piece, _) in enumerate(made):
        surface, edge = loop.curves[i].origin
        assert edge == 0
        places = np.array([[0.5, 1], [0.0, 0], [1.0, 0]])
        if loop.ends[i][0] > loop.ends[i][1]:
            places = places[[0, 2, 1]]
        b = np.random.default_rng(0).dirichlet([1, 1, 1], 20)
        assert largest(piece.evaluate(np.roll(b, i, axis=1)) - surface.evaluate(b @ places)) < 1e-14


def test_lambda_moves_the_blend_where_it_is_seen():
    _, made = constituents.of_loop(loop_of((1, 1, 1)))
    b = np.random.default_rng(0).dirichlet([1, 1, 1], 200)
    low, high = (tripatch.blend(*(s for s, _ in made), shape=(x, 0.5, 0.5)).evaluate(b) for x in (0.1, 0.9))
    assert largest(low - high) > 0.01


def test_the_direction_is_that_in_which_most_surfaces_face():
    """Over the hole a fill faces the other way along the same edge than next to it."""
    up = []
    for own in (True, False):
        found = [edges("ABC"[i], sheet(i, 1), own) for i in range(3)]
        _, made = constituents.of_loop(find_loop(found, 1e-6))
        up.append(tripatch.blend(*(s for s, _ in made)).normal(np.full((1, 3), 1 / 3))[0, 2])
    assert up[0] * up[1] < 0


def test_gaps_within_the_tolerance_are_closed():
    """The ends of sides move to their middles, and what lies between along with them."""
    nets = [sheet(i, 1) for i in range(3)]
    found = [edges("ABC"[i], nets[i], True) for i in range(3)]
    moved = sheet(0, 1)
    lifted = tripatch.triangle_on(moved, [(0, 0), (1, 0), (0.5, 1)], [[0, 0, 0.1], [0, 0, 0], [0.2, 0, 0]])
    b = np.random.default_rng(1).dirichlet([1, 1, 1], 20)
    plain = tripatch.triangle_on(moved, [(0, 0), (1, 0), (0.5, 1)])
    by = b @ np.array([[0, 0, 0.1], [0, 0, 0], [0.2, 0, 0]])
    assert largest(lifted.evaluate(b) - plain.evaluate(b) - by) < 1e-15
    d, own = lifted.evaluate(b, derivatives=1)[1], plain.evaluate(b, derivatives=1)[1]
    assert np.abs(d - own - [[-0.2, 0, 0.1], [-0.2, 0, 0]]).max() < 1e-14
    loop = find_loop(found, 1e-6)
    _, made = constituents.of_loop(loop)
    assert tripatch.blend(*(s for s, _ in made)).report.boundary_gap < 1e-9


def test_a_mesh_beside_the_hole_is_continued_from_its_border():
    found = [edges("ABC"[i], sheet(i, -1), True) for i in range(2)]
    surface, n = sheet(2, -1), 12
    uv = np.array([(i / n, j / n) for i in range(n + 1) for j in range(n + 1)])
    quads = [
        [i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1]
        for i in range(n)
        for j in range(n)
    ]
    vertices = surface.evaluate(uv)
    border = tripatch.find_holes(quads)[0].tolist()
    loop = find_loop([*found, [MeshBorder("C", vertices, quads, border)]], 1e-6)
    loop, made = constituents.of_loop(loop)
    patch = tripatch.blend(*(s for s, _ in made))
    k = next(k for k, curve in enumerate(loop.curves) if curve.name == "C")
    t = made[k][1]
    assert len(t) == n + 1
    b = np.zeros((n + 1, 3))
    b[:, (k + 1) % 3], b[:, (k + 2) % 3] = 1 - t, t
    assert np.linalg.norm(patch.evaluate(b)[:, None] - vertices, axis=2).min(axis=1).max() < 1e-6
