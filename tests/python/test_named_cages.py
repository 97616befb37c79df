"""A cage by a method that is named is that method's, or there is none."""

import numpy as np
import pytest
import tripatch
from codes import says
from shapes import corner_removed, cube_sphere

THREE = [m for m, about in tripatch.METHODS.items() if about.fills_holes and about.sides == (3, 3)]


def hole(rings=2, n=8):
    vertices, faces = cube_sphere(n)
    left, gone = corner_removed(vertices, faces, rings)
    rim = next(r for r in tripatch.find_holes(left) if len(r) == 6 * rings)
    return vertices, faces, left, gone, rim, np.linalg.norm(vertices[rim][:, None] - vertices[rim], axis=-1).max()


@pytest.mark.parametrize("cage_rim", ["smooth", "exact"])
@pytest.mark.parametrize("region", [False, True])
def test_each_method_makes_its_own_cage_and_states_its_distance_from_its_patch(cage_rim, region):
    vertices, faces, left, gone, rim, diameter = hole()
    made = {}
    for method in THREE:
        options = {"replaced": gone} if region else {}
        try:
            fill = tripatch.fill(
                vertices, faces if region else left, rim=rim, method=method, output="cage", cage_rim=cage_rim, **options
            )
        except tripatch.Refusal as refusal:
            assert method in str(refusal)
            continue
        report = fill.report
        assert report.method == method
        assert len(report.corners) == 3
        far = report.cage_deviation_rms > 1e-3 * diameter
        assert far == says(report, "cage_off_patch")
        made[method] = fill.limit(2)[0]
    assert {"gordon_coons", "triangular_coons", "side_vertex", "szilvasi_nagy_c0"} <= set(made)
    apart = [
        np.abs(made[a] - made[b]).max()
        for a, b in (("gordon_coons", "side_vertex"), ("triangular_coons", "side_vertex"), ("triangular_coons", "coons_mask"))
        if a in made and b in made and made[a].shape == made[b].shape
    ]
    assert all(off > 1e-4 for off in apart)


@pytest.mark.parametrize("rings", [1, 3])
def test_a_cage_that_runs_off_a_ball_says_how_far(rings):
    vertices, _, left, _, rim, diameter = hole(rings, 4 * rings)
    seen = 0
    for method in THREE:
        try:
            fill = tripatch.fill(vertices, left, rim=rim, method=method, output="cage", cage_rim="exact")
        except tripatch.Refusal:
            continue
        off = np.abs(np.linalg.norm(fill.limit(2)[0], axis=1) - 1).max()
        told = [each for each in fill.report.warnings if each.code == "cage_runs_off"]
        assert off < 0.1 * diameter or told, (method, off)
        seen += len(told)
    assert seen


@pytest.mark.parametrize("n", [4, 8])
@pytest.mark.parametrize("method", ["szilvasi_nagy_c1", "quintic"])
def test_an_exact_rim_around_an_octant_that_bulges_is_reported(method, n):
    vertices, faces = cube_sphere(n)
    left = [face for face in faces if not (vertices[face].mean(axis=0) > 0).all()]
    rim = min(tripatch.find_holes(left), key=len)
    fill = tripatch.fill(vertices, left, rim=rim, method=method, output="cage", cage_rim="exact")
    diameter = np.linalg.norm(vertices[rim][:, None] - vertices[rim], axis=-1).max()
    off = np.abs(np.linalg.norm(fill.limit(2)[0], axis=1) - 1).max()
    assert off < 0.04 * diameter or says(fill.report, "cage_runs_off")


def test_auto_keeps_its_choices():
    vertices, _, left, _, rim, _ = hole()
    fill = tripatch.fill(vertices, left, rim=rim, output="cage")
    assert not says(fill.report, "cage_off_patch")
