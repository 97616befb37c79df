"""Shape control through the Python interface and the command line: continuity by side, tension, the middle of the patch."""

import numpy as np
import pytest
import tripatch
from codes import says
from shapes import corner_removed, cube_sphere, octant
from test_fairing import curvature_across, octant_sides
from tripatch import __main__ as cli
from tripatch import files, words

MIDDLE = [[1 / 3, 1 / 3, 1 / 3]]


def hole(**options):
    vertices, faces, rim = octant()
    return tripatch.fill(vertices, faces, rim=rim, **options)


def middle(fill):
    return fill.patch.evaluate(MIDDLE)[0]


def test_tension_lowers_the_middle_and_keeps_the_seam():
    heights = []
    for tension in (0, 1, 10):
        fill = hole(tension=tension)
        assert fill.report.seam_angle_max < 1e-5
        heights.append(np.linalg.norm(middle(fill)))
    assert heights[0] > heights[1] + 0.005 > heights[2] + 0.01


@pytest.mark.parametrize("fairing", [None, "thin_plate", "auto"])
@pytest.mark.parametrize("continuity", ["auto", "G0", "G1"])
def test_the_middle_is_where_it_is_asked_for(fairing, continuity):
    center = middle(hole(fairing=fairing)) * 1.1
    fill = hole(fairing=fairing, continuity=continuity, center=center)
    np.testing.assert_allclose(middle(fill), center, rtol=0, atol=1e-12)
    if continuity != "G0":
        assert fill.report.seam_angle_max < 1e-5
    moved = hole(fairing=fairing, continuity=continuity, center_offset=0.1)
    plain = hole(fairing=fairing, continuity=continuity)
    np.testing.assert_allclose(middle(moved), middle(plain) + 0.1 * plain.patch.normal(MIDDLE)[0], rtol=0, atol=1e-12)


def test_g2_is_kept_where_the_middle_moves():
    patch = tripatch.patch(octant_sides(), continuity="G2", fairing="auto", center=(0.6, 0.55, 0.65))
    np.testing.assert_allclose(patch.evaluate(MIDDLE)[0], (0.6, 0.55, 0.65), rtol=0, atol=1e-12)
    for i in range(3):
        assert np.abs(curvature_across(patch, i, np.linspace(0.01, 0.99, 99)) + 1).max() < 1e-5


def curvature_of_surroundings(side, t, h=1e-6):
    """Normal curvature at a right angle to a side, from its own second derivative and differences of r and c'."""
    _, along, r, n = side.evaluate(t)
    after, before = side.evaluate(t + h), side.evaluate(t - h)
    xx = np.sum(n * side.second_derivative(t), 1)
    yy, xy = (np.sum(n * (after[k] - before[k]), 1) / (2 * h) for k in (1, 2))
    slant = np.sum(r * along, 1) / np.sum(along**2, 1)
    return (xx - 2 * slant * xy + slant**2 * yy) / np.sum((r - slant[:, None] * along) ** 2, 1)


@pytest.mark.parametrize(("n", "rings"), [(8, 2), (5, 2), (10, 3)])
@pytest.mark.parametrize("stands", [True, False])
def test_the_curvature_of_a_limit_surface_is_followed_and_met(n, rings, stands):
    vertices, faces = cube_sphere(n)
    left, gone = corner_removed(vertices, faces, rings)
    rim = tripatch.find_holes(left)[0]
    vertices = vertices * (1, 1.1, 0.95)
    jump = {}
    for continuity in ("G1", "auto", "G2"):
        options = {"rim": rim, "surroundings": "limit", "continuity": continuity}
        if stands:
            fill = tripatch.fill(vertices, faces, replaced=gone, **options)
        else:
            fill = tripatch.fill(vertices, left, **options)
        edges = len(rim) // 3  # cage edges a side: the curvature has kinks between them
        t = (np.arange(edges)[:, None] + [0.06, 0.31, 0.62, 0.94]).ravel() / edges
        t = t[(t > 0.01) & (t < 0.99)]
        jump[continuity] = 0
        for i, side in enumerate(fill.sides):
            asked = curvature_of_surroundings(side, t)
            jump[continuity] = max(
                jump[continuity], np.abs(curvature_across(fill.patch, i, t) - asked).max() / np.abs(asked).max()
            )
    assert jump["G2"] < 1e-5
    if stands:  # an open cage's border is flat across, and nothing to be followed
        assert jump["auto"] < 0.75 * jump["G1"]
    else:
        assert jump["auto"] == jump["G1"]


def test_curvature_at_a_kink_inside_a_side_is_told():
    vertices, faces = cube_sphere(3)
    left, gone = corner_removed(vertices, faces, 3)  # extraordinary vertices in the middles of the sides
    rim = tripatch.find_holes(left)[0]
    fill = tripatch.fill(vertices, faces, rim=rim, replaced=gone, surroundings="limit", continuity="G2")
    assert [each.code for each in fill.report.warnings].count("side_kink") == 3
    t = np.array([0.03, 0.11, 0.19, 0.81, 0.88, 0.95])
    for i, side in enumerate(fill.sides):
        asked = curvature_of_surroundings(side, t)
        assert np.abs(curvature_across(fill.patch, i, t) - asked).max() < 1e-5 * np.abs(asked).max()


def test_a_middle_that_folds_is_told():
    report = hole(center=(-9, -9, -9), method="side_vertex").report
    assert report.folds > 0
    assert says(report, "patch_folds")


def test_free_sides_follow_the_energy():
    free, fixed = (hole(continuity=(first, "G1", "G1")) for first in ("Free", "G0"))
    assert free.report.continuity == ["Free", "G1", "G1"]
    assert fixed.report.continuity == ["G0", "G1", "G1"]
    assert free.report.fairing == fixed.report.fairing == "auto"
    angles = [fill.report.seam_angle_max_by_side for fill in (free, fixed)]
    assert angles[0][0] < 0.1 < 5 < angles[1][0]  # degrees; the energy finds the sphere's own planes
    assert max(angles[0][1:] + angles[1][1:]) < 1e-5
    known, bend = words.degrees(fixed.report.surroundings_error), words.degrees(angles[1][0])
    assert words.filled([fixed.report]) == (
        f"Filled 1 hole; seam within 0.001° (accuracy of the mesh: {known}); bends by up to {bend} at sides met in position only"
    )


def test_auto_says_what_it_took():
    assert hole().report.continuity == ["G1"] * 3
    assert hole(method="gordon_coons").report.continuity == ["G0"] * 3
    assert hole(continuity="G2").report.continuity == ["G2"] * 3


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"tension": -0.1}, ValueError),
        ({"tension": float("inf")}, ValueError),
        ({"tension": "high"}, TypeError),
        ({"tension": 1, "fairing": None}, ValueError),
        ({"center": (0, 1)}, ValueError),
        ({"center": (0, 1, float("nan"))}, ValueError),
        ({"center": "here"}, TypeError),
        ({"center": (0, 0, 1), "center_offset": 0.1}, ValueError),
        ({"center_offset": None}, TypeError),
        ({"continuity": "free"}, ValueError),
    ],
)
def test_what_means_nothing_is_refused(options, error):
    with pytest.raises(error):
        hole(**options)


def test_one_center_is_not_that_of_several_holes():
    vertices, faces, rim = octant()
    with pytest.raises(ValueError, match="center_offset"):
        tripatch.fill_all(vertices, faces, [rim, rim], center=(0, 0, 1))
    (fill,) = tripatch.fill_all(vertices, faces, [rim], center=(0.7, 0.6, 0.6))
    np.testing.assert_allclose(middle(fill), (0.7, 0.6, 0.6), rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "options"),
    [
        (["--tension", "3"], {"tension": 3}),
        (["--center", "0.6,0.6,0.7"], {"center": (0.6, 0.6, 0.7)}),
        (["--center-offset", "-0.1"], {"center_offset": -0.1}),
        (["--continuity", "Free,G1,G0"], {"continuity": ("Free", "G1", "G0")}),
        (["--bulge", "1,2,1"], {"bulge": (1, 2, 1)}),
    ],
)
def test_the_command_line_hands_them_on(tmp_path, capsys, arguments, options):
    vertices, faces, rim = octant()
    source, out = tmp_path / "in.obj", tmp_path / "out.obj"
    source.write_text(
        "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in vertices.tolist())
        + "".join(f"f {' '.join(str(v + 1) for v in face)}\n" for face in faces)
    )
    around = ",".join(map(str, rim))
    assert cli.main(["fill", str(source), str(out), "--rim", around, *arguments]) == 0
    np.testing.assert_allclose(files.read(out).vertices[len(vertices) :], hole(**options).vertices, atol=1e-9)
    capsys.readouterr()


def test_a_center_of_two_numbers_is_named(tmp_path, capsys):
    assert cli.main(["fill", "in.obj", str(tmp_path / "out.obj"), "--center", "1,2"]) == 2
    assert "0,0.5,1" in capsys.readouterr().err
