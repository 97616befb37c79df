"""What decides in the Python package, on both sides of each threshold."""

import warnings
from types import SimpleNamespace

import numpy as np
import pytest
import tripatch
from codes import refused as refused_as
from tripatch import _arrays, between, quality, words
from tripatch.batch import emit, inputs, journal, record

UP = np.array([0.0, 0.0, 1.0])


def edge(start, end, outside=None, drawn=8):
    """Along a straight edge of a flat sheet that runs from start to end and lies on its right, or where `outside` says."""
    start, end = np.array(start, float), np.array(end, float)
    outside = np.cross(end - start, UP) if outside is None else np.array(outside, float)
    net = np.array([[start, start + outside], [end, end + outside]])
    return between.SurfaceEdge("A", tripatch.Side(tripatch.BezierRectangle(net), 0), drawn, True)


def refused(*given):
    try:
        edge(*given)
    except tripatch.Refusal:
        return True
    return False


def turned(degrees):
    return np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0])


def test_an_edge_without_extent_is_a_point_to_a_million_millionth_of_its_coordinates():
    whole = edge((1, 0, 0), (1, 1, 0)).side
    with refused_as("surface_edge_is_point"):
        between.SurfaceEdge("A", whole.part(0.0, 0.97e-12), 8, True)
    between.SurfaceEdge("A", whole.part(0.0, 1.03e-12), 8, True)


def test_derivatives_span_a_plane_from_a_sine_of_a_billionth_on():
    assert refused((0, 0, 0), (1, 0, 0), (1, 0.97e-9, 0))
    assert not refused((0, 0, 0), (1, 0, 0), (1, 1.03e-9, 0))


def test_an_edge_is_closed_whose_ends_are_a_millionth_of_its_extent_apart():
    for gap, closed in ((0.97e-6, True), (1.03e-6, False)):
        # the parabola's extent is half of that of its middle control point
        curve = np.array([(0, 0, 0), (0, 2.0, 0), (gap, 0, 0)])
        net = np.stack([curve, curve + UP], axis=1)
        assert between.SurfaceEdge("A", tripatch.Side(tripatch.BezierRectangle(net), 0), 8, True).closed == closed


def test_a_place_is_one_that_is_drawn_to_a_ten_millionth_of_the_edge():
    line = edge((0, 0, 0), (1, 0, 0))
    for off, there in ((0.97e-7, True), (1.03e-7, False)):
        assert (line.nearest([(0.5 + off, 0, 0)])[0][0] == 0.5) == there


def test_edges_cross_that_do_so_at_a_sine_of_a_fiftieth():
    line = edge((0, 0, 0), (1, 0, 0))
    for sine, cross in ((0.0195, False), (0.0205, True)):
        way = np.array([np.sqrt(1 - sine**2), sine, 0])
        found = between._crossings(line, edge((0.5, 0, 0) - 0.3 * way, (0.5, 0, 0) + 0.4 * way))
        assert bool(found) == cross


def test_a_border_turns_sharply_by_25_degrees():
    for degrees, corners in ((24.5, 0), (25.5, 1)):
        points = np.array([(0, 0, 0), (1, 0, 0), (1, 0, 0) + turned(degrees), (0, 3, 0)])
        border = between.MeshBorder("A", points, [(0, 1, 2, 3)], [0, 1, 2], chain=2)
        assert len(border.corners()) == corners


def test_pieces_go_on_that_turn_by_ten_degrees():
    first = edge((0, 0, 0), (1, 0, 0)).side
    for degrees, on in ((9.9, True), (10.1, False)):
        assert between._continues(first, edge((1, 0, 0), (1, 0, 0) + turned(degrees)).side) == on
        tilted = np.array([0, -np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
        assert between._continues(first, edge((1, 0, 0), (2, 0, 0), tilted).side) == on


def test_an_end_is_moved_by_two_ten_millionths_of_its_side():
    corners = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)])
    for share, moved in ((0.97, False), (1.03, True)):
        gap = np.array([0, 0, 2 * share * 2e-7])  # half of it each
        curves = [edge(corners[0], corners[1]), edge(corners[1], corners[2]), edge(corners[2], corners[0] + gap)]
        loop = between.Loop(curves, [(0.0, 1.0)] * 3)
        assert (loop.sides()[0][0] is not curves[0].side) == moved


def test_ends_of_sides_are_moved_together_beyond_rounding_with_a_warning():
    corners = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)])
    for share, told in ((0.97, False), (1.03, True)):
        gap = np.array([0, 0, 2 * share * 1e-12])
        sides = [edge(corners[k], corners[(k + 1) % 3] + (gap if k == 2 else 0)).side for k in range(3)]
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            tripatch.patch(sides, tolerance=1e-3)
        assert any("moved together" in str(w.message) for w in said) == told


def test_barycentric_coordinates_are_inside_to_a_billionth():
    for off, good in ((0.97e-9, True), (1.03e-9, False)):
        for b in ((-off, 0.5, 0.5 + off), (0.5, 0.5, off)):
            if good:
                _arrays.barycentric([b])
            else:
                with pytest.raises(ValueError, match="outside the triangle"):
                    _arrays.barycentric([b])


def test_a_direction_sums_to_nothing_to_a_million_millionth():
    triangle = tripatch.BezierTriangle(np.random.default_rng(0).normal(size=(6, 3)))
    triangle.derivative((1, -1, 0.97e-12))
    with pytest.raises(ValueError, match="sum to 0"):
        triangle.derivative((1, -1, 1.03e-12))


def flaps(degrees):
    """Two triangles at an edge, turned against each other."""
    points = np.array([(0, 0, 0), (1, 0, 0), (0.5, -1, 0), (0.5, 0, 0)]) + np.outer(
        [0, 0, 0, 1], [0, np.cos(np.radians(degrees)), np.sin(np.radians(degrees))]
    )
    return points, np.array([(1, 0, 2), (0, 1, 3)])


def test_triangles_fold_that_face_more_than_120_degrees_apart():
    assert not quality.folded(*flaps(119.9)).any()
    assert quality.folded(*flaps(120.1)).all()


def test_what_lies_behind_an_edge_of_40_degrees_does_not_speak_for_the_seam():
    for degrees, seen in ((39.5, 4), (40.5, 3)):
        points, triangles = flaps(degrees)
        around = quality._Around(points, triangles, np.array([(0, 2)]))
        (start,) = around.of_edge[frozenset((0, 2))]
        assert len(around.side(start, past_corners=True)[0]) == seen


def test_angles_and_lengths_that_are_as_good_as_none_are_told_so():
    assert (words.degrees(0.00101), words.degrees(0.0001)) == ("0.001°", "0.001°")
    assert words.degrees(0.0014) == "0.0014°"
    assert (words.degrees(99.4), words.degrees(99.6)) == ("99°", "100°")
    assert (words.length(0.97e-9), words.length(1.03e-9)) == ("0", "1e-09")


def test_a_refusal_names_32_vertices_in_a_line():
    settings = SimpleNamespace(version="", options={})
    for count in (32, 33):
        line = record.of_hole(settings, "a", tripatch.Refusal("No.", list(range(count))))
        assert line["where"] == list(range(32))


def test_portions_are_of_32_files_or_eight_million_bytes_or_a_quarter_of_a_workers_share(monkeypatch):
    monkeypatch.setattr(inputs, "size", lambda path: path)  # sizes for files

    def portions(sizes):
        return [len(portion) for portion in inputs.portions(sizes, 1)]

    assert portions([1] * 200) == [32] * 6 + [8]
    assert portions([4_000_000] * 16) == [2] * 8
    assert portions([4_000_001] * 16) == [1] * 16
    assert portions([1] * 30 + [8192] * 10)[0] == 12  # a small file counts 4096 bytes, and all together 4 * 12.5 of them


def test_a_farm_gets_a_thousand_tasks(tmp_path):
    journal.prepare(tmp_path)
    for count, tasks in ((1000, 1000), (1001, 501)):
        text, _ = emit.emitted("commands", [tmp_path / f"{k}.obj" for k in range(count)], tmp_path, ["tripatch"], 1, None)
        assert len(text.splitlines()) == tasks
