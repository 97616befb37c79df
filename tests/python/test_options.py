"""The table of options: what follows from it agrees with it."""

import inspect
import math
import re
import runpy
from pathlib import Path

import pytest
import tripatch
from shapes import octant
from tripatch import __main__ as cli
from tripatch import arguments, options

ROOT = Path(__file__).resolve().parents[2]
ROWS = list(tripatch.OPTIONS.values())
NUMBERS = [row for row in ROWS if row.kind in ("number", "whole")]


def of_kind(row):
    """A method, and what else it needs, for which the row is read."""
    given = dict.fromkeys(name for name, _ in row.applies)
    return {name: next((v for n, v in row.applies if n == name), "") for name in given if name in ("method", "output")}


@pytest.mark.parametrize("function", ["fill", "fill_all", "patch", "blend", "choose_holes"])
def test_defaults_are_what_is_taken(function):
    given = {row.name: row.default for row in ROWS if function in row.functions}
    plain, explicit = options.checked(function, {}), options.checked(function, given)
    settings = [values.pop("subdivision", None) for values in (plain, explicit)]
    assert plain == explicit
    assert (settings[0] is None) == (settings[1] is None)


def test_the_core_is_handed_what_is_not_at_its_default():
    vertices, faces, rim = octant(4)
    every = options.checked("fill", {"rim": rim, "fairing": None, "bulge": 1.0})
    few = options.not_at_default("fill", every)
    assert {"rim", "fairing"} <= few.keys() <= {"rim", "fairing", "bulge", "subdivision"}
    one, other = (tripatch._native._fill(*tripatch._arrays.mesh(vertices, faces), given, None) for given in (every, few))
    assert (one.vertices == other.vertices).all()
    assert one.report.fairing == other.report.fairing == ""


@pytest.mark.parametrize("row", NUMBERS, ids=lambda row: row.name)
def test_what_is_out_of_range_is_refused_by_name(row):
    vertices, faces, rim = octant(4)
    outside = [row.range.most + 1] if math.isfinite(row.range.most) else [] if row.kind == "whole" else [math.inf]
    if math.isfinite(row.range.least):
        outside += [row.range.least - 1] + [row.range.least] * row.range.open
    assert outside
    for value in outside:
        value = int(value) if row.kind == "whole" else value
        value = (value,) * row.count if row.count > 1 else value
        with pytest.raises(ValueError, match=row.name) as caught:
            if "fill" in row.functions:
                tripatch.fill(vertices, faces, rim=rim, **of_kind(row), **{row.name: value})
            else:
                tripatch.choose_holes(vertices, faces, **{row.name: value})
        assert not isinstance(caught.value, tripatch.Refusal)


@pytest.mark.parametrize("row", [row for row in ROWS if row.kind == "choice"], ids=lambda row: row.name)
def test_a_choice_takes_its_names_and_no_others(row):
    for name in options.names(row):
        assert options.value(row, name) == ([name] if row.by_side else name)
    with pytest.raises(ValueError, match=f"{row.name} must be one of .*, not 'else'"):
        options.value(row, "else")
    with pytest.raises(TypeError, match=row.name):
        options.value(row, 1)


def test_options_that_only_papers_need_are_a_section_of_their_own():
    for function in (tripatch.fill, tripatch.fill_all, tripatch.fill_holes, tripatch.patch):
        usual, papers = inspect.getdoc(function).partition("\nReturns:")[0].split("Other Parameters:")
        assert all(f"    {name} (" in papers for name in ("shape", "reading", "symmetric", "alpha"))
        assert all(f"    {name} (" in usual for name in ("continuity", "bulge", "tension"))


def test_a_choice_takes_the_words_of_the_panel_too():
    vertices, faces, rim = octant(4)
    assert options.value(tripatch.OPTIONS["continuity"], ("Position", "tangent", "G1")) == ["G0", "G1", "G1"]
    for name, word in (("G0", "position"), ("G1", "Tangent")):
        one, other = (tripatch.fill(vertices, faces, rim=rim, method="side_vertex", continuity=each) for each in (name, word))
        assert one.report.continuity == other.report.continuity == [name] * 3 and (one.vertices == other.vertices).all()


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_help_says_what_the_table_says(row):
    said = " ".join(inspect.getdoc(getattr(tripatch, row.functions[0])).split())
    described = row.description.replace("; none: ", "; None: ")
    assert re.search(rf"(^|\W){row.name} \([^:]+\): {re.escape(described)}", said), "with its type"
    assert row.description and not row.description.endswith(".")
    assert all(each.description in said for each in row.choices)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--fairing", "none"], {"fairing": None}),
        (["--shape", "optimal"], {"shape": "optimal"}),
        (["--shape", "0.2,0.3,0.4"], {"shape": (0.2, 0.3, 0.4)}),
        (["--alpha", "none"], {"alpha": None}),
        (["--resolution", "NONE"], {"resolution": None}),
        (["--corners", "none"], {"corners": []}),
        (["--rim", "1,2,3"], {"rim": [1, 2, 3]}),
        (["--pole-offset", "0.1,-0.2"], {"pole_offset": (0.1, -0.2)}),
        (["--symmetric"], {"symmetric": True}),
        (["--continuity", "G1,auto,Free"], {"continuity": ("G1", "auto", "Free")}),
        (["--subdivision", '{"quality": null}'], {"subdivision": {"quality": None}}),
        ([], {}),
    ],
)
def test_texts_become_values(arguments, expected):
    found = vars(cli.parser().parse_args(["fill", "IN", "OUT", *arguments]))
    assert {name: found[name] for name in cli.OPTIONS if name in found} == expected


def test_the_stubs_follow():
    script = runpy.run_path(str(ROOT / "scripts" / "stubs"))
    text = script["STUB"].read_text()
    assert script["written"](text) == text
    assert script["written"](text.replace("    tension: float = 0.0,\n", "")) == text


@pytest.mark.parametrize(
    "given",
    [
        {"bulge": 10**400},
        {"bulge": [1, 10**400, 1]},
        {"pole_offset": (10**400, 0)},
        {"pole_offset": {}},
        {"rim": [2**63, 2**63 + 1]},
        {"replaced": [2**64 - 1]},
        {"islands": 3},
        {"islands": [[2**63]]},
        {"subdivision": 5, "output": "cage"},
        {"subdivision": [1], "output": "cage"},
        {"subdivision": {"edge_creases": 3}, "output": "cage"},
        {"subdivision": {"edge_creases": ([[0, 1]], ["a"])}, "output": "cage"},
        {"subdivision": {"vertex_creases": ([2**63], [1])}, "output": "cage"},
        {"subdivision": {"vertex_creases": ([0], [1.01])}, "output": "cage"},
    ],
    ids=str,
)
def test_values_of_any_kind_are_refused_by_name(given):
    """Found by fuzzing: numbers beyond 64 bits ended in an OverflowError or what the binding says, others without a name."""
    with pytest.raises((TypeError, ValueError), match=f"{next(iter(given))}|creases") as caught:
        options.checked("fill", given)
    assert caught.value.code and "incompatible function" not in str(caught.value)


def test_points_to_meet_are_points_pairs_with_a_normal_and_polylines():
    row = tripatch.OPTIONS["through"]
    found = options._points([[1, 2, 3], ([1, 2, 3], [0, 0, 1]), [[0, 0, 0], [1, 0, 0], [2, 0, 1]]], row)
    assert found == [([1, 2, 3], None), ([1, 2, 3], [0, 0, 1]), ([0, 0, 0], None), ([1, 0, 0], None), ([2, 0, 1], None)]
    for wrong in (7, "text"):
        with pytest.raises(TypeError, match=f"through must hold points .*, not {wrong!r}"):
            options._points(wrong, row)


def test_settings_of_a_modifier_are_read():
    given = {"quality": 1, "vertex_creases": ([3, 4], [0.5, 1]), "edge_creases": ([[0, 1]], [0.25]), "loose_vertices": [7]}
    settings = options.subdivision(given, 3)
    assert (settings.quality, settings.level, settings.loose_vertices) == (1, 3, [7])
    assert (settings.crease_vertices, settings.vertex_creases) == ([3, 4], [0.5, 1])
    assert (settings.crease_edges, settings.edge_creases) == ([[0, 1]], [0.25])
    for quality in (0, 11):
        with pytest.raises(ValueError, match="quality"):
            options.subdivision({"quality": quality})


def test_the_page_of_options_lists_the_names_that_differ():
    """Those of the table whose row in Blender has another name, and what the command line calls them."""
    page = (ROOT / "docs" / "options.md").read_text()
    found = re.findall(r"^\| (?:\w[\w ]*: )?([^|]+) \| `(\w+)` \| `(--[\w-]+)`", page, re.MULTILINE)
    rows = {name: (row, flag) for row, name, flag in found}
    differ = {name: row.label for name, row in tripatch.OPTIONS.items() if row.label}
    assert {name: rows[name][0] for name in differ} == differ
    assert rows.keys() - differ.keys() == {"output", "resolution"}, "its label is not in the table; --faces"
    assert {name: flag for name, (_, flag) in rows.items()} == {name: arguments.flag(name) for name in rows}
    others = [name for name in tripatch.OPTIONS if name not in rows]
    assert [name for name in others if arguments.flag(name) != f"--{name.replace('_', '-')}"] == []
