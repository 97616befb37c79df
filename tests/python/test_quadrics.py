"""Holes in spheres, ellipsoids, cylinders, cones and saddles: where nothing else tells enough, new vertices lie on them."""

import numpy as np
import pytest
import tripatch

TURN = np.linalg.qr(np.random.default_rng(7).normal(size=(3, 3)))[0]
SIZE, MIDDLE = 37.5, np.array([100.0, -20, 3])


def ellipsoid(u, v, axes=(1.6, 1, 0.7)):
    return np.stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)], -1) * axes


SURFACES = {
    "ellipsoid": (ellipsoid, lambda p: np.linalg.norm(p / [1.6, 1, 0.7], axis=1) - 1),
    "sphere": (lambda u, v: ellipsoid(u, v, 1), lambda p: np.linalg.norm(p, axis=1) - 1),
    "cylinder": (lambda u, v: np.stack([np.cos(u), np.sin(u), v], -1), lambda p: np.hypot(p[:, 0], p[:, 1]) - 1),
    "cone": (
        lambda u, v: np.stack([(1.3 + v) * np.cos(u), (1.3 + v) * np.sin(u), v], -1),
        lambda p: np.hypot(p[:, 0], p[:, 1]) - p[:, 2] - 1.3,
    ),
    "saddle": (lambda u, v: np.stack([u, v, 1.5 * (u * u - v * v)], -1), lambda p: p[:, 2] - 1.5 * (p[:, 0] ** 2 - p[:, 1] ** 2)),
}


def sheet(surface, seed, noise=0.0, n=15):
    """n x n uneven squares of a surface, two triangles each, turned and moved, without those of a blot in their middle."""
    rng = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij"), -1).reshape(-1, 2)
    uv = (grid + rng.uniform(-0.25, 0.25, grid.shape)) / n * 1.8 - 0.9
    a = np.array([i * (n + 1) + j for i in range(n) for j in range(n)])
    faces = np.concatenate([np.stack([a, a + n + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + 1], 1)])
    middles = uv[faces].mean(1)
    faces = faces[np.hypot(*middles.T) > 0.4 * rng.uniform(0.8, 1.2, len(faces))]
    components = tripatch.find_holes(faces)
    points = surface(*uv.T)
    points += noise * rng.normal(size=points.shape)
    return SIZE * points @ TURN.T + MIDDLE, faces, min((c for c in components if len(c) > 20), key=len)


def back(points):
    return (points - MIDDLE) @ TURN / SIZE


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", SURFACES)
def test_a_hole_in_a_quadric_is_filled_on_it(name, seed):
    surface, off = SURFACES[name]
    vertices, faces, rim = sheet(surface, seed)
    fill = tripatch.fill(vertices, faces, rim=rim)
    spline = tripatch.fill(vertices, faces, rim=rim, method="polyharmonic_spline")
    error, before = (np.abs(off(back(each.vertices))).max() for each in (fill, spline))
    if fill.report.method_reason.code != "lies_on_quadric":  # enough is known without
        assert fill.report.candidates[0].expected_error < 1e-4 * np.linalg.norm(np.ptp(vertices[rim], axis=0))
        return
    assert error < 1e-9 < before
    assert fill.report.triangles_folded == 0 and not fill.report.crosses_itself
    assert np.allclose(fill.patch.evaluate(fill.uv), fill.vertices, rtol=0, atol=1e-3 * SIZE)
    assert (np.sum(fill.normals * spline.normals, axis=1) > 0.9).all()
    assert np.allclose(np.linalg.norm(fill.normals, axis=1), 1)


def test_some_holes_are_filled_so_and_all_outputs_are():
    surface, off = SURFACES["ellipsoid"]
    vertices, faces, rim = sheet(surface, 1)
    for options in ({}, {"output": "quads"}, {"resolution": 12}):
        fill = tripatch.fill(vertices, faces, rim=rim, **options)
        assert fill.report.method_reason.code == "lies_on_quadric"
        assert np.abs(off(back(fill.vertices))).max() < 1e-9


def test_under_noise_and_on_other_surfaces_the_spline_stays_as_it_is():
    wave = lambda u, v: np.stack([u, v, 0.2 * np.sin(3 * u + 1) * np.cos(2.5 * v)], -1)  # noqa: E731
    roof = lambda u, v: np.stack([u, v, -np.abs(u)], -1)  # noqa: E731
    for surface, noise in ((SURFACES["ellipsoid"][0], 1e-3), (wave, 0), (roof, 0)):
        vertices, faces, rim = sheet(surface, 1, noise)
        fill = tripatch.fill(vertices, faces, rim=rim)
        assert fill.report.method_reason.code != "lies_on_quadric"


def test_what_else_is_asked_for_is_done():
    vertices, faces, rim = sheet(SURFACES["ellipsoid"][0], 1)
    through = SIZE * (np.array([[1.7, 0, 0]]) @ TURN.T) + MIDDLE
    for options in ({"through": through}, {"method": "polyharmonic_spline"}):
        assert tripatch.fill(vertices, faces, rim=rim, **options).report.method_reason.code != "lies_on_quadric"
