"""How open ends are closed: flat lids and domes."""

import numpy as np
import pytest
import tripatch


def tube(sides, rings=((1, -1), (1, 0), (1, 1))):
    """A surface of revolution about z through (radius, height), closed below, open above; and the rim."""
    turns = 2 * np.pi * np.arange(sides) / sides
    vertices = np.array([(r * np.cos(t), r * np.sin(t), z) for r, z in rings for t in turns])
    faces = [list(range(sides))[::-1]]
    for k in range(len(rings) - 1):
        a, b = k * sides, (k + 1) * sides
        faces += [[a + i, a + (i + 1) % sides, b + (i + 1) % sides, b + i] for i in range(sides)]
    return vertices, faces


def ball(sides, rings, below=60):
    """A unit ball from the south pole up to a latitude, degrees."""
    heights = np.radians(np.linspace(-80, below, rings))
    return tube(sides, [(np.cos(h), np.sin(h)) for h in heights])


@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize("sides", [6, 8, 12, 14, 15, 16, 24, 32, 64])
def test_a_straight_tube_of_any_number_of_sides_gets_a_flat_lid_with_sharp_edges(sides, output):
    vertices, faces = tube(sides)
    fill = tripatch.fill(vertices, faces, output=output)
    assert np.abs(fill.vertices[:, 2] - 1).max(initial=0) < 1e-6
    rim = {frozenset(pair) for pair in zip(fill.rim.tolist(), np.roll(fill.rim, -1).tolist(), strict=True)}
    assert {frozenset(edge) for edge in fill.feature_edges.tolist()} == rim


@pytest.mark.parametrize("sides", [12, 14, 15, 16, 24, 32, 64])
def test_the_dome_of_a_straight_tube_is_half_a_ball(sides):
    vertices, faces = tube(sides)
    fill = tripatch.fill(vertices, faces, cap="dome")
    assert fill.vertices[:, 2].max() - 1 == pytest.approx(1, abs=0.03)
    assert len(fill.feature_edges) == 0


def test_the_end_of_a_ball_stays_round_and_is_flat_where_that_is_asked_for():
    vertices, faces = ball(32, 16, 20)
    rim = max(tripatch.find_holes(faces), key=lambda loop: vertices[loop][:, 2].mean())
    fill, flat = (tripatch.fill(vertices, faces, rim=rim, **o) for o in ({}, {"cap": "flat"}))
    assert fill.vertices[:, 2].max() == pytest.approx(1, abs=0.02)
    assert len(fill.feature_edges) == 0
    assert np.ptp(flat.vertices[:, 2]) < 1e-6
    assert len(flat.feature_edges) == 32


@pytest.mark.parametrize("corners", [None, [24, 30, 36, 42]])
@pytest.mark.parametrize("continuity", ["auto", "G0"])
def test_the_seam_of_a_flat_lid_is_the_angle_of_its_sharp_edges(corners, continuity):
    vertices, faces = tube(24)
    rim = next(rim for rim in tripatch.find_holes(faces) if min(rim) == 48)
    corners = corners and [v + 24 for v in corners]
    report = tripatch.fill(vertices, faces, rim=rim, corners=corners, continuity=continuity).report
    assert set(report.continuity) == {"G0"} and report.seam_angle_max == pytest.approx(90, abs=0.1)


def test_a_cap_that_is_asked_of_another_method_is_a_mistake():
    vertices, faces = tube(16)
    with pytest.raises(ValueError, match="cap"):
        tripatch.fill(vertices, faces, method="polyharmonic_spline", cap="dome")
