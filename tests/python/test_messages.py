"""What users read has a code, and its sentence is made of one pattern."""

import argparse
import ast
import copy
import json
import pickle
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tripatch
from tripatch import arguments, messages, words

ROOT = Path(__file__).resolve().parents[2]
OCTAHEDRON = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]], float)
FACES = [[1, 2, 3], [2, 0, 4], [0, 1, 5], [3, 4, 5], [2, 4, 3], [0, 5, 4], [1, 3, 5]]


def fields(pattern):
    return re.findall(r"\{(\w+)(?::([^}]*))?\}", pattern)


@pytest.mark.parametrize("code", [code for code, row in messages.TABLE.items() if row.kind != "label"])
def test_patterns_are_well_formed(code):
    row = messages.TABLE[code]
    assert row.kind in ("refusal", "warning", "report", "reason", "note")
    for pattern in filter(None, (row.sentence, row.panel)):
        assert pattern.count("{") == pattern.count("}") == len(fields(pattern))
        assert pattern.count("[") == pattern.count("]")
        assert not re.search(r"\[[^\]]*\[", pattern)
        for _, kind in fields(pattern):
            assert kind in ("", "if", "degrees", "side", "names", "option", "problem", "vertices", "Vertices") or "|" in kind
        begins_small = row.kind == "reason" or code.startswith("shape_key_")
        assert begins_small or pattern[0].isupper() or pattern[0] in "{["
        assert not pattern.endswith(".")


def test_the_page_of_messages_is_current():
    script = ROOT / "scripts" / "messages"
    assert subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True, check=False).stderr == ""


def test_a_refusal_has_a_code_and_keeps_it_when_it_is_pickled_or_copied():
    with pytest.raises(tripatch.Refusal) as caught:
        tripatch.fill(OCTAHEDRON, FACES, rim=[0, 1])
    refusal = caught.value
    assert refusal.code == "rim_too_short"
    assert isinstance(refusal.reason, str)
    assert isinstance(refusal, ValueError)
    for again in (pickle.loads(pickle.dumps(refusal)), copy.deepcopy(refusal)):
        assert (again.code, again.reason, again.where) == (refusal.code, refusal.reason, refusal.where)
    assert tripatch.Refusal("Another reason", [3]).code == ""


def test_warnings_are_strings_with_a_code():
    fill = tripatch.fill(OCTAHEDRON, FACES, output="quads", odd="triangle")
    assert [each.code for each in fill.report.warnings] == fill.report.as_dict()["codes"]
    for each in (*fill.report.warnings, tripatch.Message("side_sharp", {"angle": 30, "side": 1})):
        again = pickle.loads(pickle.dumps(each))
        assert (again, again.code, again.parameters) == (each, each.code, each.parameters)
        assert json.loads(json.dumps(each)) == each


def test_a_window_counts_sides_from_one_and_names_no_vertices():
    warning = tripatch.Message("corner_planes_differ", {"angle": 2.0, "corner": 0, "spread": 3.0}, [7])
    assert "(vertex 7)" in warning
    assert "corner 0" in warning
    told = warning.worded(panel=True, vertices="unnamed")
    assert "7" not in told
    assert "corner 1" in told
    assert "2°" in told
    refused = tripatch.Message("edge_without_length", {}, [5, 6])
    assert "vertices 5 and 6" in refused
    assert "the selected vertices" in refused.worded(panel=True, vertices="selected")


def test_counts_have_their_plural():
    assert "1 place" in tripatch.Message("patch_folds", {"places": 1})
    assert "2 places" in tripatch.Message("patch_folds", {"places": 2})


def test_options_that_a_sentence_names_have_the_name_of_the_interface():
    said = tripatch.Message("rim_on_borders", {}, [3])
    assert "(join=DISTANCE)" in said and "(--join=DISTANCE)" in said.worded(names={"join": "--join"})


def test_of_many_vertices_the_first_are_named():
    assert "1, 2, 3, 4, 5, 6, 7, 8 and more" in tripatch.Message("faces_flipped", {}, range(1, 20))


def test_options_and_methods_have_the_names_of_the_interface():
    told = tripatch.Message("options_not_taken", {"method": "quintic", "options": ["bulge", "shape"]})
    assert told.worded(names={"quintic": "Quintic", "bulge": "Bulge"}).startswith("Quintic ignores Bulge, shape")


def pseudo(pattern):
    """A pattern in a language that has no ASCII letters: what is left of them in a sentence was not in the table."""
    wide = str.maketrans({chr(c): chr(c + 0xFEE0) for c in (*range(0x41, 0x5B), *range(0x61, 0x7B))})

    def kind(match):
        return (
            "{"
            + match[1]
            + (":" + match[2].translate(wide) if "|" in (match[2] or "") else match[0][len(match[1]) + 1 : -1])
            + "}"
        )

    parts = re.split(r"(\{\w+(?::[^}]*)?\})", pattern)
    return "".join(
        re.sub(r"\{(\w+)(?::([^}]*))?\}", kind, part) if part.startswith("{") else part.translate(wide) for part in parts
    )


#: What `format` itself says: vertices by number, and units.
OF_FORMAT = re.compile(r"[Vv]ert(ex|ices)|[Tt]he selected|and more|and|degrees|auto|multi_sided|rim|join|fill_all")


def names_in(message):
    """The values in a message that are names or text."""
    for value in message.parameters.values():
        if isinstance(value, tripatch.Message):
            yield from names_in(value)
        elif isinstance(value, str):
            yield value
        elif isinstance(value, list):
            yield from (each for each in value if isinstance(each, str))


def provoked():
    """Refusals and warnings of several kinds."""
    cases = [
        {"rim": [0, 1]},
        {"rim": [0, 2, 1], "corners": [0, 1]},
        {"method": "multi_sided", "corners": [0, 1, 5]},
        {"method": "gordon_coons", "continuity": "G1"},
        {"method": "quad_rows"},
        {"output": "cage", "corners": []},
        {"output": "quads", "resolution": 40},
        {"continuity": "G2", "method": "quintic"},
        {"center_offset": 1e9},
        {"method": "polyharmonic_spline", "surroundings": "limit", "subdivision": {}},
        {"bulge": 2.0, "corners": []},
        {"shape": (0.2, 0.5, 0.5)},
    ]
    shut = [*FACES, [0, 2, 1]]
    two = [FACES[k] for k in (0, 1, 2, 3, 4, 5)]
    flipped = [FACES[0][::-1], *FACES[1:]]
    broken = OCTAHEDRON.copy()
    broken[1] = np.nan
    touching = OCTAHEDRON.copy()
    touching[1] = touching[0]
    meshes = [(OCTAHEDRON, FACES, case) for case in cases]
    meshes += [(OCTAHEDRON, shut, {}), (OCTAHEDRON, two, {}), (OCTAHEDRON, flipped, {}), (broken, FACES, {"rim": [0, 2, 1]})]
    meshes += [(touching, FACES, {"method": "quintic", "rim": [0, 2, 1]}), (touching, FACES, {"rim": [0, 2, 1]})]
    for vertices, faces, options in meshes:
        try:
            fill = tripatch.fill(vertices, faces, **options)
        except tripatch.Refusal as refusal:
            yield from refusal.messages
            yield tripatch.Message("hole_not_filled", {"reason": refusal.said})
        except ValueError:
            pass
        else:
            yield from fill.report.warnings
            yield from (fill.report.method_reason, *(each.why for each in fill.report.candidates))


@pytest.fixture
def in_pseudo_language(monkeypatch):
    """Every pattern of the table in it."""
    table = {code: replace(row, sentence=pseudo(row.sentence), panel=pseudo(row.panel)) for code, row in messages.TABLE.items()}
    monkeypatch.setattr(messages, "TABLE", table)


def test_nothing_in_a_sentence_is_glued_on(in_pseudo_language):
    seen = set()
    for message in provoked():
        seen.add(message.code)
        for said in (
            str(message),
            message.worded(panel=True, vertices="selected"),
            message.worded(panel=True, vertices="unnamed"),
        ):
            for name in names_in(message):
                said = said.replace(name, "")
            assert not re.search("[A-Za-z]", OF_FORMAT.sub("", said)), said
    assert len(seen) > 10


def summaries():
    """What is said of fills, and of borders that stay open."""
    report = tripatch.fill(OCTAHEDRON, FACES).report
    yield from (words.filled([]), words.filled([report] * 2, into=["A", "B"], triangles=1, quads=3, bend=4.0))
    yield words.filled([report], limit=True)
    cage = tripatch.fill(OCTAHEDRON, FACES, output="cage").report
    yield words.filled([cage], cage_rim="exact", quads=12)
    for edges in ([3], [3, 4], [5, 5], [3, 4, 5, 6, 7], []):
        yield words.nothing_to_fill(edges, "--outer")
    yield from (words.joined(1, 0), words.joined(0, 2), words.joined(3, 1))


def test_nothing_in_a_summary_is_glued_on(in_pseudo_language):
    for message in summaries():
        said = str(message)
        for name in (*names_in(message), "--outer"):
            said = said.replace(name, "")
        assert not re.search("[A-Za-z]", OF_FORMAT.sub("", said)), said


#: Arguments that do not fit, of Python and of the core; files that do not.
MISTAKES = [
    lambda: tripatch.fill(OCTAHEDRON, FACES, resolution=0),
    lambda: tripatch.fill(OCTAHEDRON, FACES, resolution="many"),
    lambda: tripatch.fill(OCTAHEDRON, FACES, output="quad"),
    lambda: tripatch.fill(OCTAHEDRON, FACES, outputs="quads"),
    lambda: tripatch.fill(OCTAHEDRON, FACES, bulge=(1, np.nan, 1)),
    lambda: tripatch.fill(OCTAHEDRON, FACES, method="side_vertex", bulge=(1, 2)),
    lambda: tripatch.fill(OCTAHEDRON, FACES, pole_offset=(1, 2, 3)),
    lambda: tripatch.fill(OCTAHEDRON, FACES, through=7),
    lambda: tripatch.fill(OCTAHEDRON, FACES, corners=[3]),
    lambda: tripatch.fill(OCTAHEDRON, FACES, corners=[0, 2, 0]),
    lambda: tripatch.fill(OCTAHEDRON, FACES, corners=[0, 2, 99]),
    lambda: tripatch.fill(OCTAHEDRON, FACES, replaced=[99]),
    lambda: tripatch.fill(OCTAHEDRON, FACES, fairing=None, tension=1),
    lambda: tripatch.fill(OCTAHEDRON, FACES, method="side_vertex", center=(0, 0, 0), center_offset=1),
    lambda: tripatch.fill(OCTAHEDRON, FACES, cap="flat", method="quintic"),
    lambda: tripatch.blend(*[tripatch.BezierTriangle(np.eye(3))] * 3, method="quintic"),
    lambda: tripatch.fill(OCTAHEDRON, [[0, 1]]),
    lambda: tripatch.fill(OCTAHEDRON, [[0, 1, 9]]),
    lambda: tripatch.fill(OCTAHEDRON[:, :2], FACES),
    lambda: tripatch.fill("mesh", FACES),
    lambda: tripatch.fill_holes(7),
    lambda: tripatch.read("no such file"),
    lambda: tripatch.read("no such file.obj"),
    lambda: tripatch.set_threads(0),
    lambda: tripatch.BezierTriangle(np.zeros((4, 3))),
    lambda: tripatch.BezierTriangle(np.full((3, 3), np.inf)),
    lambda: tripatch.BezierRectangle(np.zeros((1, 2, 3))),
    lambda: tripatch.Side(tripatch.BezierTriangle(np.eye(3)), 3),
    lambda: tripatch.coons_bezier([np.zeros((2, 3)), np.zeros((3, 3)), np.zeros((2, 3))]),
    lambda: tripatch.coons_bezier([np.zeros((2, 3)), np.ones((2, 3)), np.zeros((2, 3))]),
    lambda: tripatch.coons_bezier([np.zeros((2, 3))] * 3, alpha=1.0),
    lambda: tripatch.NurbsSurface(np.zeros((2, 2, 3)), None, [0, 1], [0, 0, 1, 1]),
    lambda: tripatch.NurbsSurface(np.zeros((2, 2, 3)), None, [0, 1, 0, 1], [0, 0, 1, 1]),
    lambda: tripatch.patch([1, 2, 3]),
    lambda: tripatch.blend(1, 2, 3),
    lambda: arguments.indices("1,two"),
]


def test_nothing_in_a_mistake_is_glued_on(in_pseudo_language):
    seen = set()
    for call in MISTAKES:
        with pytest.raises((ValueError, TypeError, argparse.ArgumentTypeError)) as caught:
            call()
        (message,) = caught.value.args
        seen |= message.codes
        for said in (str(message), message.worded(panel=True)):
            for name in sorted(names_in(message), key=len, reverse=True):
                said = said.replace(name, "")
            assert not re.search("[A-Za-z]", OF_FORMAT.sub("", said)), said
    assert len(seen) > 25


def test_every_sentence_of_an_error_is_in_the_table():
    """What Python raises has a message, or is made by what makes one; texts are for programmers only."""
    of_programs = {"AttributeError", "NotImplementedError", "IndexError", "EOFError", "Stopped"}
    for file in (ROOT / "native" / "python" / "tripatch").rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            raised = node.exc if isinstance(node, ast.Raise) else None
            name = getattr(raised.func, "attr", getattr(raised.func, "id", "")) if isinstance(raised, ast.Call) else ""
            if name.lstrip("_")[:1].isupper() and name not in of_programs:
                texts = [ast.unparse(each) for each in raised.args if isinstance(each, ast.JoinedStr | ast.Constant)]
                assert not [each for each in texts if " " in each], f"{file.name}:{node.lineno}: {texts}"


def test_the_add_on_glues_no_sentence_together():
    """A text that is made of parts, or handed on, has no two words in its code: sentences are in the table."""
    two_words = re.compile(r"[A-Za-z]{2,} [a-z]{2,}|\b[a-z]{2,} \Z|\A [a-z]{2,}\b")
    for file in (ROOT / "addon" / "tripatch_blender").glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            parts = node.values if isinstance(node, ast.JoinedStr) else node.args if isinstance(node, ast.Call) else []
            for part in parts:
                text = part.value if isinstance(part, ast.Constant) and isinstance(part.value, str) else ""
                assert " " not in text or not two_words.search(text), f"{file.name}:{part.lineno}: {text}"


def codes_in(node):
    """The codes that an expression may be."""
    if isinstance(node, ast.IfExp):
        return codes_in(node.body) | codes_in(node.orelse)
    return {node.value} if isinstance(node, ast.Constant) and isinstance(node.value, str) else set()


def test_every_reason_of_the_table_is_given_by_the_core():
    core = "".join(file.read_text() for file in (ROOT / "native" / "src").rglob("*.*"))
    given = set(re.findall(r"Code::(\w+)", core))
    assert {code for code, row in messages.TABLE.items() if row.kind == "reason"} <= given


def test_codes_that_python_names_are_in_the_table():
    makers = {"Message", "UnusableError", "_LeftOut", "_UsageError", "said"}
    named = set()
    folders = (ROOT / "addon" / "tripatch_blender", ROOT / "native" / "python" / "tripatch")
    for file in (file for folder in folders for file in folder.rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) in makers and node.args:
                named |= codes_in(node.args[0])
    assert named - set(messages.TABLE) == set()
    assert len(named) > 180


def test_the_sentences_for_a_missing_library_are_those_of_the_table():
    tree = ast.parse((ROOT / "addon" / "tripatch_blender" / "library.py").read_text())
    values = {n.targets[0].id: n.value for n in tree.body if isinstance(n, ast.Assign) and isinstance(n.targets[0], ast.Name)}
    for code in ("needs_numpy", "library_missing"):
        assert ast.literal_eval(values[code.upper()]) == messages.TABLE[code].sentence


def test_errors_for_wrong_input_have_codes_that_survive_pickling(tmp_path):
    def caught(kind, call):
        with pytest.raises(kind) as found:
            call()
        return found.value

    errors = [
        caught(ValueError, lambda: tripatch.fill(OCTAHEDRON, FACES, bulge=-1.0)),  # found by the core
        caught(ValueError, lambda: tripatch.fill(OCTAHEDRON, FACES, method="none_such")),
        caught(TypeError, lambda: tripatch.fill(OCTAHEDRON, FACES, no_option=1)),
        caught(TypeError, lambda: tripatch.fill(OCTAHEDRON, 3)),
        caught(tripatch.FileError, lambda: tripatch.read(tmp_path / "none.obj")),
    ]
    assert [error.code for error in errors] == ["out_of_range", "not_one_of", "no_such_option", "wrong_type", "file_unreadable"]
    for error in errors:
        again = pickle.loads(pickle.dumps(error))
        assert (type(again), again.code, str(again)) == (type(error), error.code, str(error))
        assert again.args[0].parameters == error.args[0].parameters
