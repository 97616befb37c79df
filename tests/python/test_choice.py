"""What `auto` chooses, and what it says of its choice."""

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
import tripatch
from shapes import octant
from systems import WINE
from tripatch import __main__ as cli
from tripatch import files, messages

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


def candidates(*args, **options):
    return tripatch.fill(*args, **options).report.candidates


def test_the_used_candidate_comes_first_and_is_the_fill():
    vertices, faces, rim = octant()
    report = tripatch.fill(vertices, faces, rim=rim).report
    first, *others = report.candidates
    assert (first.status, first.method, first.why) == ("used", report.method, report.method_reason)
    assert {each.status for each in others} <= {"made", "skipped", "refused"}
    assert (first.folds, first.crosses, first.exceeds_hole_bounds) == (0, False, False)
    assert first.seam_deg == report.seam_angle_max


def test_of_valid_candidates_the_one_with_the_least_expected_error_is_used():
    vertices, faces, rim = octant(8)
    first, *others = candidates(vertices, faces, rim=rim)
    made = [
        each for each in others if each.status == "made" and not each.folds and not each.crosses and not each.exceeds_hole_bounds
    ]
    assert made and all(first.expected_error <= each.expected_error for each in made)


def test_a_spline_is_skipped_if_the_patch_is_exact_and_tried_between_three_sides_if_not():
    vertices, faces, rim = octant(24)
    ways = {each.method: each.status for each in candidates(vertices, faces, rim=rim) if each.status != "refused"}
    assert ways["side_vertex"] == "used" and ways["polyharmonic_spline"] == "skipped"
    stretched = vertices * [1, 1.7, 0.6] + 0.1 * np.sin(3 * vertices[:, [1, 2, 0]])
    assert [each for each in candidates(stretched, faces, rim=rim) if each.method == "polyharmonic_spline" and each.folds == 0]


def test_a_patch_whose_tangent_planes_are_too_uncertain_to_beat_the_spline_is_not_made():
    vertices, faces, rim = octant(12)
    rough = vertices + 0.01 * np.random.default_rng(3).normal(size=vertices.shape)
    used, *others = candidates(rough, faces, rim=rim)
    assert used.method == "polyharmonic_spline"
    assert ("skipped", "cannot be more accurate than polyharmonic_spline") in {(each.status, each.why) for each in others}
    patch = tripatch.fill(rough, faces, rim=rim, method="side_vertex").report
    assert used.expected_error < np.radians(patch.surroundings_error) / 8 * np.sqrt(2)  # the least error that such planes allow


def test_candidates_that_are_not_made_say_why_and_have_no_numbers():
    vertices, faces, rim = octant(24)
    others = [each for each in candidates(vertices, faces, rim=rim) if each.status in ("skipped", "refused")]
    assert others
    for each in others:
        assert each.why and each.expected_error is each.folds is each.crosses is each.exceeds_hole_bounds is each.seam_deg is None


def test_expected_errors_are_lengths():
    vertices, faces, rim = octant()
    one, large = (candidates(size * vertices, faces, rim=rim)[0] for size in (1, 1000))
    assert large.expected_error == pytest.approx(1000 * one.expected_error, rel=1e-3)


@pytest.mark.parametrize(
    "options", [{"method": "side_vertex"}, {"method": "polyharmonic_spline"}, {"output": "cage"}, {"bulge": 0.3}]
)
def test_each_fill_is_listed_with_its_numbers_whatever_made_it(options):
    vertices, faces, rim = octant()
    report = tripatch.fill(vertices, faces, rim=rim, **options).report
    used, *others = report.candidates
    assert (used.status, used.method) == ("used", report.method)
    assert used.expected_error >= 0 and used.seam_deg == report.seam_angle_max
    assert used.why and bool(others) == (options in ({"bulge": 0.3}, {"output": "cage"}))
    assert not any(each.status == "used" for each in others)


def test_a_small_fill_is_listed_with_why():
    vertices = np.array([(x, y, 0.1 * x * y) for y in range(7) for x in range(7)], float)
    quads = [(v, v + 1, v + 8, v + 7) for v in range(41) if v % 7 < 6]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d)) if 24 not in t]
    (fill,) = tripatch.fill_all(vertices, faces)
    (used,) = fill.report.candidates
    assert (used.status, used.method, used.why) == ("used", fill.report.method, fill.report.method_reason)
    assert 0 < used.expected_error < 1


def test_candidates_are_pickled_and_plain_in_json():
    vertices, faces, rim = octant()
    report = tripatch.fill(vertices, faces, rim=rim).report
    again = pickle.loads(pickle.dumps(report)).candidates
    assert again == report.candidates
    assert [each.why.code for each in again] == [each.why.code for each in report.candidates]
    told = json.loads(json.dumps(report.as_dict()["candidates"]))
    assert [row["codes"] for row in told] == [sorted(each.why.codes) for each in report.candidates]
    assert told[0]["method"] == report.method and told[0]["expected_error"] == report.candidates[0].expected_error


EACH_OPTION = [
    {"corners": []},
    {"cap": "flat"},
    {"cap": "dome"},
    {"bulge": 0.3},
    {"through": [(0.6, 0.6, 0.6)]},
    {"method": "quintic"},
    {"output": "quads"},
    {"output": "cage"},
    {"output": "cage", "cage_rim": "exact"},
    {"output": "cage", "resolution": 1},
]


@pytest.mark.parametrize("options", EACH_OPTION)
def test_the_reasons_of_a_fill_have_codes(options):
    for n in (4, 12):
        vertices, faces, rim = octant(n)
        report = tripatch.fill(vertices, faces, rim=rim, **options).report
        for why in (report.method_reason, *(each.why for each in report.candidates)):
            assert messages.TABLE[why.code].kind == "reason"
            assert {messages.TABLE[code].kind for code in why.codes} <= {"reason", "refusal"}


def test_what_is_refused_is_a_reason_without_what_to_do():
    refused = tripatch.Message("edge_without_length", {}, [5, 6])
    why = tripatch.Message("flat_wall", {"reason": tripatch.Message("not_made", {"reason": refused})})
    assert refused.endswith(". Merge the two")
    assert why == "as a flat wall: The edge between vertices 5 and 6 has no length"
    assert why.codes == {"flat_wall", "not_made", "edge_without_length"}


def test_a_cage_lists_the_cages_that_were_not_tried_and_why():
    vertices, faces, rim = octant(4)
    used, *others = candidates(vertices, faces, rim=rim, output="cage")
    ways = {"cage_in_rows", "cage_on_surface", "fairest_cage"}
    assert used.status == "used" and len(others) == 2
    assert {each.why.code for each in others} < ways and {each.status for each in others} == {"skipped"}
    exact = candidates(vertices, faces, rim=rim, output="cage", cage_rim="exact")[1:]
    assert {each.why.code for each in exact} == ways
    assert {each.why.parameters["reason"].code for each in exact} == {"options_ask_otherwise"}


def test_why_prints_a_row_for_each_candidate_the_used_one_first(tmp_path, capsys):
    vertices, faces, _ = octant(4)
    files.write(tmp_path / "in.obj", (vertices, faces))
    assert cli.main(["fill", str(tmp_path / "in.obj"), str(tmp_path / "out.obj"), "--why", "--rim", "0,1"]) == 1
    capsys.readouterr()
    rim = ",".join(map(str, octant(4)[2]))
    assert cli.main(["fill", str(tmp_path / "in.obj"), str(tmp_path / "out.obj"), "--why", "--rim", rim]) == 0
    rows = [line for line in capsys.readouterr().out.splitlines() if line.startswith("  ")]
    report = tripatch.fill(vertices, faces, rim=octant(4)[2]).report
    assert len(rows) == len(report.candidates)
    assert rows[0].split()[:2] == ["used", f"{report.method}:"] and "expected error" in rows[0]
    assert any("skipped" in row for row in rows)


@pytest.mark.parametrize("make", [octant, lambda: octant(4), lambda: octant(12)])
def test_rows_of_candidates_differ_and_do_not_ask_for_auto(make):
    vertices, faces, rim = make()
    rows = candidates(vertices, faces, rim=rim)
    assert len({(each.method, each.why.partition(": ")[0]) for each in rows if each.status == "skipped"}) == len(
        [each for each in rows if each.status == "skipped"]
    )
    assert {"as a lower cap", "as a flat wall", "as a patch that folds", "as a flat fill"} <= {
        each.why.partition(": ")[0] for each in rows
    }
    assert not any("method auto" in each.why for each in rows)


@pytest.mark.skipif(not SCRIPTS.exists(), reason="the scripts are not here")
@pytest.mark.skipif(WINE, reason="known_holes.py takes complex exponentials, and wine 8 has none")
def test_the_choice_costs_little_on_held_out_holes(monkeypatch):
    """Error of what auto chose over that of the best candidate: patches continue a sphere exactly, splines know a hill better."""
    pytest.importorskip("scipy")
    monkeypatch.syspath_prepend(str(SCRIPTS))
    known = __import__("known_holes")
    found = []
    for hole in known.known_holes(31, spacings=(0.16,), surfaces=("sphere", "hill")):
        each = known.regret({method: hole.error(fill) for method, fill in hole.fills().items()})
        found += [] if each is None else [each]
    mean, worst = known.summary(found)
    assert len(found) > 15
    assert mean < 1.15
    assert worst < 8
