"""Options of shape are applied, or the report names them; the method that fills a hole depends on none of them."""

import numpy as np
import pytest
import tripatch
from shapes import octant
from test_outer_borders import sheet


def holed_grid(height, gone, n=16, triangles=False):
    """A grid of quads over -1 .. 1, or of triangles, without the faces whose middle `gone` names; and the rim of the hole."""
    side = np.linspace(-1, 1, n + 1)
    points = np.array([(x, y, height(x, y)) for y in side for x in side])
    quads = [
        (r * (n + 1) + c, r * (n + 1) + c + 1, (r + 1) * (n + 1) + c + 1, (r + 1) * (n + 1) + c)
        for r in range(n)
        for c in range(n)
    ]
    faces = [f for f in quads if not gone(*points[list(f), :2].mean(axis=0))]
    if triangles:
        faces = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    rim = min(tripatch.find_holes(faces), key=lambda loop: np.abs(points[loop][:, :2]).max())
    return points, faces, rim


def dome(x, y):
    return -0.4 * (x * x + y * y) + 0.1 * np.sin(3 * x)


def jagged():
    """A hole for the spline: no smooth sides, no rows."""
    return holed_grid(dome, lambda x, y: np.hypot(x, y) < 0.5, triangles=True)


def block():
    """A hole for rows of quads."""
    return holed_grid(dome, lambda x, y: abs(x) < 0.5 and abs(y) < 0.4)


def smooth_sides():
    """A hole for a patch between three sides."""
    return octant()


HOLES = {"polyharmonic_spline": (jagged, {}), "quad_rows": (block, {"output": "quads"}), "side_vertex": (smooth_sides, {})}
OPTIONS = {
    "bulge": 1.5,
    "tension": 3.0,
    "center_offset": 0.1,
    "continuity": "G0",
    "fairing": None,
    "cross_boundary": "given",
}


def fill(method, **options):
    make, given = HOLES[method]
    vertices, faces, rim = make()
    return tripatch.fill(vertices, faces, rim=rim, **given, **options)


@pytest.mark.parametrize("name", OPTIONS)
@pytest.mark.parametrize("method", HOLES)
def test_an_option_is_applied_or_named_and_changes_nothing(method, name):
    plain, made = fill(method), fill(method, **{name: OPTIONS[name]})
    assert plain.report.method == method and name in tripatch.OPTIONS
    if name in made.report.not_applied:
        assert plain.report.not_applied[name] == made.report.not_applied[name]
        assert np.array_equal(plain.vertices, made.vertices) and np.array_equal(plain.faces, made.faces)
        assert made.report.method == method
    elif name == "continuity":  # with a kink: another surface
        assert set(made.report.continuity) == {"G0"}
    else:
        assert made.report.method == method
        assert np.abs(made.vertices - plain.vertices).max() > 1e-3


@pytest.mark.parametrize("method", HOLES)
def test_bulge_tension_and_the_middle_work_for_every_method(method):
    assert not {"bulge", "tension", "center", "center_offset"} & set(fill(method).report.not_applied)


@pytest.mark.parametrize("method", ["polyharmonic_spline", "quad_rows"])
@pytest.mark.parametrize("name", ["bulge", "tension", "center_offset"])
def test_tangent_planes_along_the_rim_stay(method, name):
    plain, made = fill(method), fill(method, **{name: OPTIONS[name]})
    along = plain.patch.normal(plain.rim_uv), made.patch.normal(made.rim_uv)
    assert np.abs(along[0] - along[1]).max() < 1e-9
    adjacent = made.rim_uv + 1e-4 * (made.rim_uv.mean(axis=0) - made.rim_uv)
    assert np.abs(plain.patch.normal(adjacent) - made.patch.normal(adjacent)).max() < 0.02
    assert np.abs(np.linalg.norm(made.normals, axis=1) - 1).max() < 1e-12
    np.testing.assert_allclose(made.patch.evaluate(made.uv), made.vertices, atol=1e-12)


def test_bulge_scales_the_slope_into_the_fill():
    plain, made = fill("polyharmonic_spline"), fill("polyharmonic_spline", bulge=2.0)
    inward = made.rim_uv.mean(axis=0) - made.rim_uv
    step = 1e-4
    before, after = (
        each.patch.evaluate(each.rim_uv + step * inward) - each.patch.evaluate(each.rim_uv) for each in (plain, made)
    )
    ratio = np.linalg.norm(after, axis=1) / np.linalg.norm(before, axis=1)
    assert np.median(ratio) == pytest.approx(2, rel=0.05)


@pytest.mark.parametrize("method", ["polyharmonic_spline", "quad_rows"])
def test_the_middle_moves_along_its_normal_or_to_a_point(method):
    plain, made = fill(method), fill(method, center_offset=0.1)
    place = [plain.rim_uv.mean(axis=0)]
    steps = np.linalg.norm(np.roll(plain.rim_uv, -1, axis=0) - plain.rim_uv, axis=1)
    place = [(steps[:, None] * (plain.rim_uv + np.roll(plain.rim_uv, -1, axis=0)) / 2).sum(axis=0) / steps.sum()]
    at, normal = plain.patch.evaluate(place)[0], plain.patch.normal(place)[0]
    np.testing.assert_allclose(made.patch.evaluate(place)[0], at + 0.1 * normal, atol=1e-9)
    to = fill(method, center=at + [0.05, 0, 0.1])
    np.testing.assert_allclose(to.patch.evaluate(place)[0], at + [0.05, 0, 0.1], atol=1e-9)


@pytest.mark.parametrize("method", ["polyharmonic_spline", "quad_rows"])
def test_tension_pulls_a_dome_down(method):
    heights = [fill(method, tension=tension).vertices[:, 2].mean() for tension in (0, 1, 10)]
    assert heights[0] > heights[1] + 1e-3 > heights[2] + 2e-3


def test_bulge_by_side_shapes_the_side_that_it_names():
    vertices, faces, rim = jagged()
    corners = [int(v) for v in rim[:: len(rim) // 4][:4]]
    plain = tripatch.fill(vertices, faces, rim=rim, corners=corners)
    if plain.report.method != "polyharmonic_spline":
        pytest.skip("a patch")
    for i in range(4):
        bulge = [1.0] * 4
        bulge[i] = 2.0
        made = tripatch.fill(vertices, faces, rim=rim, corners=corners, bulge=tuple(bulge))
        assert made.report.method == plain.report.method
        moved = np.linalg.norm(made.vertices - plain.vertices, axis=1)
        place = made.rim.tolist().index(made.report.corners[i])
        middle = vertices[made.rim[(place + len(rim) // 8) % len(rim)]]
        assert np.linalg.norm(plain.vertices[moved.argmax()] - middle) < 0.45


def test_a_hole_without_new_vertices_has_nothing_to_move():
    vertices, faces, rim = holed_grid(dome, lambda x, y: abs(x) < 0.1 and 0 < y < 0.1)
    made = tripatch.fill(vertices, faces, rim=rim, output="quads", bulge=2.0)
    assert len(made.vertices) == 0 and made.report.not_applied["bulge"] == "vertices"


def test_poles_of_quads_between_three_sides_are_told():
    vertices, faces = sheet(8, gone=[8 * i + j for i in range(2, 6) for j in range(2, 6)])
    rim = next(loop for loop in tripatch.find_holes(faces) if len(loop) == 16)
    given = {"rim": rim, "corners": rim[[0, 2, 6]], "output": "quads", "method": "side_vertex", "resolution": 0}
    plain, moved = (tripatch.fill(vertices, faces, pole_offset=offset, **given) for offset in ((0, 0), (0.15, 0.1)))
    counts = np.bincount(np.concatenate(plain.faces), minlength=len(vertices))
    assert plain.report.poles == [[v, k] for v, k in enumerate(counts) if v >= len(vertices) and k != 4] != []
    assert np.abs(plain.vertices - moved.vertices).max() > 1e-3 and "pole_offset" not in moved.report.not_applied
