"""Patches in concave outlines and with loops of sides inside: exact along all sides, without folds."""

import numpy as np
import pytest
import tripatch
from codes import refused


def height(x, y):
    return np.sqrt(4 - x * x - y * y) + 0.1 * np.sin(2 * x + y)


def slopes(x, y):
    z, c = np.sqrt(4 - x * x - y * y), 0.1 * np.cos(2 * x + y)
    return -x / z + 2 * c, -y / z + c


def on_surface(p):
    return np.column_stack([p, height(*p.T)])


def normals(p):
    by_x, by_y = slopes(*p.T)
    n = np.column_stack([-by_x, -by_y, np.ones(len(p))])
    return n / np.linalg.norm(n, axis=1)[:, None]


def lifted(p, ways):
    """Directions of the plane in the tangent planes."""
    by_x, by_y = slopes(*p.T)
    return np.column_stack([ways, by_x * ways[:, 0] + by_y * ways[:, 1]])


def line(a, b):
    """A side over a line, the patch on its left."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    way, out = b - a, np.array([b[1] - a[1], a[0] - b[0]])

    def at(t):
        return a + np.outer(t, way)

    side = tripatch.Side.from_functions(
        lambda t: on_surface(at(t)),
        lambda t: lifted(at(t), np.tile(way, (len(t), 1))),
        lambda t: lifted(at(t), np.tile(out, (len(t), 1))),
    )
    return side, lambda p: np.abs((p - a) @ out) / np.linalg.norm(out)


def arc(radius, start, end):
    """A side over an arc about the origin; backwards the patch is outside."""

    def at(t):
        turn = start + (end - start) * t
        return radius * np.column_stack([np.cos(turn), np.sin(turn)])

    def along(t):
        turn = start + (end - start) * t
        return radius * (end - start) * np.column_stack([-np.sin(turn), np.cos(turn)])

    side = tripatch.Side.from_functions(
        lambda t: on_surface(at(t)),
        lambda t: lifted(at(t), along(t)),
        lambda t: lifted(at(t), np.sign(end - start) * at(t)),
    )
    return side, lambda p: np.abs(np.linalg.norm(p, axis=1) - radius)


def polygon(corners):
    return [line(a, b) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]


def regular(n, radius, turn=0.0, inside=False, middle=(0.0, 0.0)):
    at = turn + 2 * np.pi * np.arange(n) / n * (-1 if inside else 1)
    return polygon(middle + radius * np.column_stack([np.cos(at), np.sin(at)]))


L = np.array([(-1, -1), (1, -1), (1, 0), (0, 0), (0, 1), (-1, 1)], float)
U = np.array([(-1, -1), (1, -1), (1, 1), (0.4, 1), (0.4, -0.4), (-0.4, -0.4), (-0.4, 1), (-1, 1)], float)
SQUARE = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)

OUTLINES = {
    "L": [polygon(L)],
    "U": [polygon(U)],
    "square with a turned square inside": [polygon(SQUARE), regular(4, 0.5, 0.3, inside=True)],
    "square with a circle inside": [polygon(SQUARE), [arc(0.4, 2 * np.pi, 0)]],
    "L with a triangle inside": [polygon(L), regular(3, 0.25, inside=True, middle=(-0.5, -0.5))],
    "square with two squares inside": [
        polygon(SQUARE),
        regular(4, 0.3, inside=True, middle=(-0.5, 0.2)),
        regular(4, 0.3, 0.5, inside=True, middle=(0.45, -0.3)),
    ],
} | {f"ring of twice {n} sides": [regular(n, 1.2), regular(n, 0.5, inside=True)] for n in (3, 5, 8)}


@pytest.mark.parametrize("name", OUTLINES)
def test_patch_in_an_outline_is_tangent_along_all_sides_and_does_not_fold(name):
    outer, *inner = [[side for side, _ in loop] for loop in OUTLINES[name]]
    patch = tripatch.patch(outer, islands=inner)
    t = np.linspace(0, 1, 400)[1:-1]
    degrees = 1e-4 if "circle" in name else 1e-6  # chords meet at an angle there
    for i, (_, off) in enumerate(side for loop in OUTLINES[name] for side in loop):
        places = patch.on_side(i, t)
        points = patch.evaluate(places)
        assert np.abs(points - on_surface(points[:, :2])).max() < 1e-9 and off(points[:, :2]).max() < 1e-9
        assert np.degrees(np.linalg.norm(np.cross(patch.normal(places), normals(points[:, :2])), axis=1)).max() < degrees
    assert patch.report.seam_angle_max < degrees and patch.report.folds == 0 and not patch.report.warnings
    places, faces = patch.triangles(12)
    points = patch.evaluate(places)
    a, b, c = (points[faces[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    assert (np.sum(across * normals(points[:, :2])[faces[:, 0]], axis=1) > 0).all()
    assert np.abs(points[:, 2] - height(*points[:, :2].T)).max() < 0.02


def test_derivatives_belong_to_the_surface():
    patch = tripatch.patch([side for side, _ in OUTLINES["L"][0]])
    places = np.array([[-0.3, -0.4], [0.4, -0.5], [-0.6, 0.5]]) + patch.domain.mean(axis=0)
    _, first, second = patch.evaluate(places, derivatives=2)
    step = 1e-5
    for axis, way in enumerate(np.eye(2) * step):
        ahead, behind = patch.evaluate(places + way, derivatives=1), patch.evaluate(places - way, derivatives=1)
        assert np.allclose((ahead[0] - behind[0]) / (2 * step), first[:, axis], atol=1e-7)
        assert np.allclose((ahead[1][:, axis] - behind[1][:, axis]) / (2 * step), second[:, 2 * axis], atol=1e-4)


def test_loops_that_cross_are_refused():
    outer = [side for side, _ in polygon(SQUARE)]
    inner = [side for side, _ in regular(4, 0.5, inside=True, middle=(0.9, 0))]
    with refused("loops_not_over_plane"):
        tripatch.patch(outer, islands=[inner])


def test_options_that_are_ignored_are_named():
    outer = [side for side, _ in polygon(SQUARE)]
    inner = [side for side, _ in regular(4, 0.5, inside=True)]
    with pytest.warns(tripatch.FillWarning) as told:
        patch = tripatch.patch(outer, islands=[inner], fairing="auto", bulge=2.0)
    assert [warning.code for warning in patch.report.warnings] == ["options_not_taken"]
    assert [str(each.message) for each in told] == ["islands ignores bulge, fairing"]
