"""Points, normals and curves inside a hole that the fill meets exactly."""

import numpy as np
import pytest
import tripatch
from codes import says
from shapes import octant
from test_any_rim import inner_rim, irregular, wave
from test_features import creased, roof
from test_polygon import around, flat_sides, lens_around
from test_round import revolved


def met(patch, point, tries=2000):
    """Distance of a point from a patch, and the normal there: Gauss-Newton from the nearest of many places."""
    uv = np.random.default_rng(0).uniform(-1, 1, size=(tries, 2)) * np.abs(patch.domain).max(axis=0) * 0.7
    best = ((patch.evaluate(uv) - point) ** 2).sum(axis=1).argmin()
    at = uv[best]
    for _ in range(15):
        p, d = patch.evaluate(at[None], 1)
        at = at + np.linalg.lstsq(d[0].T, point - p[0], rcond=None)[0]
    return np.linalg.norm(patch.evaluate(at[None])[0] - point), patch.normal(at[None])[0]


HOLES = {
    "lens": (*lens_around(10), 20),
    "three": (*around(3), 24),
    "five": (*around(5), 40),
    "round": (*revolved("paraboloid", 24), (), 24),
}


@pytest.mark.parametrize("name", HOLES)
def test_points_normals_and_curves_inside_are_met(name):
    vertices, faces, corners, edges = HOLES[name]
    options = {"rim": np.arange(edges), "corners": corners}
    plain = (
        tripatch.fill(vertices, faces, **options, method="multi_sided")
        if name != "three"
        else tripatch.fill(vertices, faces, **options)
    )
    size = np.ptp(vertices[:edges], axis=0).max()
    middle, spread = vertices[:edges].mean(axis=0), 0.12 * size
    top = plain.vertices[:, 2].max() if name != "round" else plain.vertices[:, 2].mean()
    tip = np.array([middle[0], middle[1], top + 0.04 * size])
    slanted = np.array([[middle[0] + spread, middle[1], top], [0.1, -0.05, 1]])
    curve = tip + spread * np.array([[-1, -0.4, -0.3], [-1, 0, -0.25], [-1, 0.4, -0.3]])
    fill = tripatch.fill(vertices, faces, **options, through=[tip, slanted, curve])
    assert fill.report.method == "multi_sided" and fill.report.seam_angle_max < 1e-5
    for point in (tip, slanted[0], *curve):
        assert met(fill.patch, point)[0] < 1e-12 * size
    assert tripatch.angles(met(fill.patch, slanted[0])[1][None], slanted[1:] / np.linalg.norm(slanted[1])).max() < 1e-7


def nearest_vertices(fill, points):
    return np.array([np.linalg.norm(fill.vertices - point, axis=1).argmin() for point in points])


@pytest.mark.parametrize("name", HOLES)
@pytest.mark.parametrize("count", [1, 4])
def test_quads_of_a_patch_between_sides_have_vertices_there(name, count):
    vertices, faces, corners, edges = HOLES[name]
    options = {"rim": np.arange(edges), "corners": corners, "output": "quads", "resolution": 2}
    size = np.ptp(vertices[:edges], axis=0).max()
    plain = tripatch.fill(vertices, faces, **options, through=[vertices[:edges].mean(axis=0) + [0, 0, 0.05 * size]])
    order = np.linalg.norm(plain.vertices - plain.vertices.mean(axis=0), axis=1).argsort()[: 8 * count : 8]
    apart = np.linalg.norm(plain.vertices[order, None] - plain.vertices, axis=2)
    nearest = plain.vertices[apart.argsort(axis=1)[:, 1]]
    points = 0.7 * plain.vertices[order] + 0.3 * nearest  # between the vertices that the quads have
    fill = tripatch.fill(vertices, faces, **options, through=list(points))
    assert fill.report.method == "multi_sided" and {len(face) for face in fill.faces} == {4}
    at = nearest_vertices(fill, points)
    assert len(set(at)) == count and np.abs(fill.vertices[at] - points).max() < 1e-12 * size
    assert not says(fill.report, "points_without_vertices")
    assert fill.report.triangles_folded == 0
    uv = np.vstack([np.zeros((len(vertices), 2)), fill.uv])
    uv[fill.rim] = fill.rim_uv
    corners_of_faces = uv[np.array(fill.faces)]
    ahead, back = (np.roll(corners_of_faces, by, axis=1) - corners_of_faces for by in (-1, 1))
    assert (ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]).min() > 0, "a quad is turned over"


def test_a_point_that_would_turn_a_quad_over_stays_without_a_vertex():
    """Three in a small part of one quad: the surface meets them, and the quads stay as good as they are."""
    vertices, faces, corners, edges = HOLES["five"]
    options = {"rim": np.arange(edges), "corners": corners, "output": "quads", "resolution": 0}
    plain = tripatch.fill(vertices, faces, **options, through=[(0, 0, 1.2)])
    close = [(0, 0, 1.2), (0.002, 0, 1.2), (0.001, 0.0015, 1.2)]
    fill = tripatch.fill(vertices, faces, **options, through=close)
    assert says(fill.report, "points_without_vertices")
    assert len(fill.faces) == len(plain.faces) and fill.report.triangles_folded == 0
    for point in close:
        assert met(fill.patch, np.array(point))[0] < 1e-12


def test_points_far_from_the_origin_and_options_by_side_of_three():
    vertices, faces, corners, edges = HOLES["three"]
    tip = np.array([0.02, 0.01, 1.05])
    options = {"rim": np.arange(edges), "corners": corners, "continuity": ("G1", "Free", "G1"), "bulge": (1, 1, 1.5)}
    here = tripatch.fill(vertices, faces, **options, through=[tip])
    assert here.report.continuity == ["G1", "Free", "G1"]
    assert here.report.seam_angle_max_by_side[1] > 0.1 > 1e-4 > max(np.array(here.report.seam_angle_max_by_side)[[0, 2]])
    far = np.array([1e6, -2e6, 3e6])
    there = tripatch.fill(vertices + far, faces, **options, through=[tip + far])
    assert met(here.patch, tip)[0] < 1e-12
    assert np.abs(there.vertices - far - here.vertices).max() < 1e-6


def test_between_three_sides():
    corners = np.array([(0, 0, 0), (1, 0, 0), (0.3, 0.9, 0)])
    patch = tripatch.patch(flat_sides(corners), fairing="auto", through=[(0.4, 0.3, 0.1)])
    assert met(patch, np.array([0.4, 0.3, 0.1]))[0] < 1e-12


@pytest.mark.parametrize("method", ["auto", "multi_sided"])
def test_a_point_of_the_true_surface_inside_three_sides_costs_no_accuracy(method):
    vertices, faces, rim = octant(12)
    points = np.array([[1.0, 1.0, 1.0], [1.0, 0.5, 0.7]])
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    without = tripatch.fill(vertices, faces, rim=rim)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=without.report.corners, method=method, through=list(points))
    plain, met = (np.abs(np.linalg.norm(f.vertices, axis=1) - 1).max() for f in (without, fill))
    assert met < 3 * plain
    assert np.abs(fill.vertices[nearest_vertices(fill, points)] - points).max() < 1e-9


@pytest.mark.parametrize("noise", [0, 0.05], ids=["smooth", "rough"])
@pytest.mark.parametrize("output", ["triangles", "quads"])
def test_a_hole_with_a_jagged_rim_meets_them_too_and_they_are_vertices(noise, output):
    vertices, faces = irregular(wave, noise=noise)
    rim = inner_rim(faces)
    tip, curve = np.array([0.1, 0.05, 0.2]), np.array([[-0.2, -0.15, 0.05], [-0.2, 0, 0.08], [-0.2, 0.15, 0.05]])
    slanted = np.array([[0.05, -0.25, -0.05], [0.2, 0.1, 1]])
    plain = tripatch.fill(vertices, faces, rim=rim, output=output)
    fill = tripatch.fill(vertices, faces, rim=rim, output=output, through=[tip, slanted, curve])
    assert fill.report.method == "polyharmonic_spline"
    assert not any("through" in warning for warning in fill.report.warnings)
    points = np.array([tip, slanted[0], *curve])
    at = nearest_vertices(fill, points)
    assert np.abs(fill.vertices[at] - points).max() < 1e-12
    assert np.abs(fill.patch.evaluate(fill.uv[at]) - points).max() < 1e-12
    assert tripatch.angles(fill.normals[at[1:2]], slanted[1:] / np.linalg.norm(slanted[1])).max() < 1e-7
    # the surroundings are continued as before, and where a point is nothing is left to know
    assert tripatch.angles(fill.rim_normals, plain.rim_normals).max() < 0.5
    assert fill.deviation[at].max() < 1e-4 * plain.deviation.max()
    assert fill.report.triangles_folded == 0


def test_points_on_the_surface_that_is_there_leave_it_there():
    vertices, faces = irregular(wave)
    rim = inner_rim(faces)
    at = np.array([(0.1, 0.2), (-0.2, 0.05), (0.0, -0.3)])
    fill = tripatch.fill(vertices, faces, rim=rim, through=list(np.column_stack([at, wave(*at.T)])))
    assert np.abs(fill.vertices[:, 2] - wave(*fill.vertices[:, :2].T)).max() < 1e-6


@pytest.mark.parametrize("point", [(0.1, -0.2, 0.15), (0.05, 0.1, 0.1)], ids=["one side", "on the crease"])
def test_a_hole_across_a_crease_meets_them_too(point):
    vertices, faces = creased(roof(60)[0])
    point = np.array(point) if point[1] < 0 else np.zeros(3)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces), through=[point])
    assert np.abs(fill.vertices[nearest_vertices(fill, [point])] - point).max() < 1e-12
    assert (len(fill.feature_edges) > 0) == (point[1] < 0)
    assert fill.report.triangles_folded == 0


@pytest.mark.parametrize("height", [0.3, 0.8, 1.2])
@pytest.mark.parametrize("name", ["five", "round"])
def test_a_point_far_above_the_hole_pulls_the_spline_without_folds(name, height):
    vertices, faces, _, edges = HOLES[name]
    size = np.ptp(vertices[:edges], axis=0).max()
    tip = vertices[:edges].mean(axis=0) + [0, 0, height * size]
    fill = tripatch.fill(vertices, faces, rim=np.arange(edges), method="polyharmonic_spline", through=[tip])
    assert np.abs(fill.vertices[nearest_vertices(fill, [tip])] - tip).max() < 1e-12
    assert fill.report.triangles_folded == 0 and len(fill.vertices) > 10
    assert fill.vertices[:, 2].max() < tip[2] + 0.05 * size


def test_what_cannot_be_met_is_said():
    vertices, faces, corners, edges = HOLES["five"]
    options = {"rim": np.arange(edges), "corners": corners}
    with pytest.raises(ValueError, match="points"):
        tripatch.fill(vertices, faces, **options, through=[(0, 1)])
    with pytest.raises(ValueError, match="through must not be zero"):
        tripatch.fill(vertices, faces, **options, through=[[(0, 0, 1), (0, 0, 0)]])
    for wrong in (3.5, "0,0,1", [10**400], [[(0, 0, 1), (0,)]], [(0, 0, "up")]):
        with pytest.raises(TypeError, match="through must hold points"):
            tripatch.fill(vertices, faces, **options, through=wrong)
    with pytest.raises(ValueError, match="through is an option of auto, multi_sided, polyharmonic_spline, not of gregory"):
        tripatch.fill(vertices, faces, rim=np.arange(edges), method="gregory", through=[(0, 0, 1)])


def test_on_the_command_line(tmp_path):
    from tripatch.__main__ import main

    vertices, faces, _, edges = HOLES["round"]
    source, out = tmp_path / "in.obj", tmp_path / "out.obj"
    lines = [f"v {x:.17g} {y:.17g} {z:.17g}" for x, y, z in vertices] + ["f " + " ".join(str(v + 1) for v in f) for f in faces]
    source.write_text("\n".join(lines) + "\n")
    rim = ",".join(map(str, range(edges)))
    assert main(["fill", str(source), str(out), "--rim", rim, "--corners", "none", "--through", "0,0,0.1;0.2,0,0,0.3,0,1"]) == 0
    new = np.array([line.split()[1:4] for line in out.read_text().splitlines() if line.startswith("v ")], float)[len(vertices) :]
    assert new[:, 2].max() > 0.05
