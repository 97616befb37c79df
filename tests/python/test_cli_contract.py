"""What every command keeps to: help, defaults, names of options, suggestions, exit status (https://clig.dev)."""

import argparse
import json
import re

import numpy as np
import pytest
import tripatch
from systems import missing_file
from test_cli import borders, sphere_hole, square, write_obj
from tripatch import __main__ as cli
from tripatch import files, messages

MAIN = cli.parser()
COMMANDS = next(a for a in MAIN._actions if a.dest == "command").choices
SHOWN = [
    (name, action)
    for name, command in COMMANDS.items()
    for action in command._actions
    if action.help != argparse.SUPPRESS and action.option_strings
]
IDS = [f"{name} {action.option_strings[-1]}" for name, action in SHOWN]


@pytest.fixture
def one(tmp_path):
    return write_obj(tmp_path / "in.obj", sphere_hole())


def run(capsys, *args):
    code = cli.main([str(a) for a in args])
    said = capsys.readouterr()
    return code, said.out, said.err


@pytest.mark.parametrize("command", [[], *([name] for name in COMMANDS if name != "methods")])
def test_a_bare_command_shows_its_help_with_examples_before_the_options(command, capsys):
    code, out, err = run(capsys, *command)
    assert (code, err) == (2, "")
    assert out.startswith("usage: tripatch")
    assert out.index("  tripatch ") < re.search(r"^(Arguments|General|Commands):", out, re.M).start()
    assert run(capsys, *command, "--help") == (0, out, "")


def test_the_version_is_printed(capsys):
    assert run(capsys, "--version") == (0, f"tripatch {tripatch.__version__}\n", "")


@pytest.mark.parametrize(("name", "action"), SHOWN, ids=IDS)
def test_every_option_has_help_and_says_its_default_in_one_form(name, action):
    said = action.help % {"default": action.default, "prog": "tripatch"} if "%(" in action.help else action.help
    assert said and not said.endswith(".")
    if action.default not in (None, False, argparse.SUPPRESS, []) and action.nargs != 0:
        assert "(default: " in said
    option = tripatch.OPTIONS.get(action.dest)
    if option is not None and action.default is argparse.SUPPRESS and option.kind in ("choice", "number", "whole", "position"):
        assert "(default: " in said
    if option is not None and isinstance(option.default, float):
        assert f"(default: {option.default:g})" in said


@pytest.mark.parametrize("name", COMMANDS)
def test_options_are_whole_names_in_groups(name):
    command = COMMANDS[name]
    assert not command.allow_abbrev
    titles = [group.title for group in command._action_groups if any(a.option_strings for a in group._group_actions)]
    assert len(titles) == len(set(titles))
    if name in ("fill", "batch"):
        for code in ("holes_group", "faces_group", "surface_group", "papers_group"):
            assert messages.label(code) in titles


def test_options_that_only_papers_need_are_in_their_group():
    group = next(g for g in COMMANDS["fill"]._action_groups if "papers" in (g.title or ""))
    assert {a.dest for a in group._group_actions} >= {"shape", "reading", "symmetric", "alpha"}
    assert not {a.dest for a in group._group_actions} & {"method", "continuity", "fairing", "bulge", "resolution"}


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        (["fil", "IN", "OUT"], "fill"),
        (["fill", "IN", "OUT", "--metod", "auto"], "--method"),
        (["fill", "IN", "OUT", "--face=quads"], "--faces"),
        (["batch", "IN", "-o", "OUT", "--worker", "2"], "--workers"),
        (["view", "IN", "OUT.png", "--zebr"], "--zebra"),
        (["fill", "IN", "OUT", "--quads"], "--faces quads"),
        (["fill", "IN", "OUT", "--polyharmonic-spline"], "--method polyharmonic_spline"),
        (["fill", "IN", "OUT", "--cage_rim", "exact"], "--cage-rim"),
    ],
)
def test_an_unknown_command_or_option_is_suggested_a_known_one(given, meant, capsys):
    code, out, err = run(capsys, *given)
    assert (code, out) == (2, "")
    assert f"Did you mean {meant}?" in err
    assert "mean --output?" not in run(capsys, "fill", "IN", "OUT", "--outputt", "quads")[2]  # a hidden name is not suggested


@pytest.mark.parametrize("given", ["--triangulate-it", "--smooth-it", "--frobnicate"])
def test_an_option_that_resembles_none_gets_no_suggestion(given, capsys):
    code, _, err = run(capsys, "fill", "IN", "OUT", given)
    assert code == 2 and "Did you mean" not in err


@pytest.mark.parametrize("command", ["fill", "batch"])
@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["--method", "side_vertx"], "not 'side_vertx'. Did you mean side_vertex?"),
        (["--faces", "quad"], "faces must be one of triangles, quads, cage, not 'quad'. Did you mean quads?"),
        (["--continuity", "G11"], "not 'G11'. Did you mean G1?"),
    ],
)
def test_an_unknown_value_is_suggested_a_known_one(command, given, said, one, tmp_path, capsys):
    code, _, err = run(capsys, command, one, "-o", tmp_path / "out.obj", *given)
    assert code == 2 and said in err


def test_a_picture_is_a_png_file(one, tmp_path, capsys):
    code, _, err = run(capsys, "view", one, tmp_path / "a.jpg")
    assert code == 2 and "a.jpg must end in .png" in err and not (tmp_path / "a.jpg").exists()


@pytest.mark.parametrize("where", [lambda out: [out], lambda out: ["-o", out], lambda out: ["--out", out]])
@pytest.mark.parametrize("how", [["--faces", "quads"], ["--output", "quads"], ["--output=quads"]])
def test_the_file_to_write_and_the_faces_may_be_named_either_way(where, how, one, tmp_path, capsys):
    out = tmp_path / "out.obj"
    assert run(capsys, "fill", one, *where(out), *how, "--resolution", "0")[0] == 0
    assert {len(face) for face in files.read(out).faces[108:]} == {4}


def test_one_file_to_write_is_named(one, tmp_path, capsys):
    expected = "tripatch fill IN [-o] OUT [options]"
    code, _, err = run(capsys, "fill", one)
    assert code == 2 and f"Name the file to write: {expected}\n" in err
    a, b, c = (tmp_path / f"{name}.obj" for name in "abc")
    for more in ([a, "-o", b], [b, a], [b, c, a]):
        code, _, err = run(capsys, "fill", one, *more)
        left = " ".join(map(str, more[1:] if b in more[:1] else more[:1]))
        assert code == 2 and f"Too many files: {left}. Expected {expected}; tripatch batch fills many files" in err
    assert not any(path.exists() for path in (a, b, c))


def test_a_report_that_cannot_be_read_is_named(one, tmp_path, capsys):
    report = tmp_path / "report.json"
    for reason in ("No such file", "The JSON file is damaged"):
        code, out, err = run(capsys, "strip", one, "-o", tmp_path / "out.obj", "--report", report)
        assert (code, out) == (2, "") and f"{report} cannot be read: {reason}" in err
        report.write_text("no report")


def test_a_folder_is_for_batch(tmp_path, capsys):
    code, _, err = run(capsys, "fill", tmp_path, "-o", tmp_path / "out.obj")
    assert (code, err) == (2, f"tripatch: {tmp_path} is a folder. Fill its files: tripatch batch {tmp_path} -o FOLDER\n")
    code, _, err = run(capsys, "view", tmp_path, "-o", tmp_path / "a.png")
    assert (code, err) == (2, f"tripatch: {tmp_path} cannot be read: It is a folder\n")


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply", ".stl"])
def test_a_file_without_faces_is_called_so(suffix, tmp_path, capsys):
    path = tmp_path / f"in{suffix}"
    tripatch.write(path, (np.eye(3), np.zeros((0, 3), int)))
    for command, out in (("fill", "out.obj"), ("view", "a.png"), ("smooth", "out.obj")):
        code, _, err = run(capsys, command, path, "-o", tmp_path / out)
        assert (code, "in" + suffix + " cannot be read: It has no faces" in err) == (2, True)
        assert suffix == ".stl" or "only 3 points" in err


def test_a_cloud_of_points_is_called_so(tmp_path, capsys):
    properties = "".join(f"property float {axis}\n" for axis in "xyz")
    (tmp_path / "in.ply").write_text(f"ply\nformat ascii 1.0\nelement vertex 2\n{properties}end_header\n0 0 0\n1 0 0\n")
    code, _, err = run(capsys, "fill", tmp_path / "in.ply", "-o", tmp_path / "out.ply")
    assert code == 2 and "It has no faces, only 2 points. Make a surface of them first" in err


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["--resolution", "x"], "--resolution: 'x' cannot be read. Write, for example, 12"),
        (["--join", "near"], "--join: 'near' cannot be read. Write, for example, 0.5"),
        (["--resolution"], "--resolution needs N"),
        (["--faces"], "--faces needs triangles|quads|cage"),
        (["--all", "--rim", "0,1,2"], "--all and --rim cannot be used together"),
        (["--rim", "0,1,5000"], "--rim names vertex 5000"),
        (["--faces", "cages"], "--faces must be one of triangles, quads, cage, not 'cages'. Did you mean cage?"),
    ],
)
def test_messages_name_options_as_the_command_line_does(given, said, one, tmp_path, capsys):
    code, _, err = run(capsys, "fill", one, tmp_path / "out.obj", *given)
    assert code == 2 and f": {said}" in err


def test_the_ways_out_are_those_of_the_command_line_or_of_python(tmp_path, capsys):
    path = write_obj(tmp_path / "in.obj", sphere_hole(), sphere_hole(5, center=5))
    _, _, err = run(capsys, "fill", path, tmp_path / "out.obj")
    assert "Name one (--rim=...), or fill all (--all)" in err
    mesh = tripatch.read(path)
    with pytest.raises(tripatch.Refusal, match=r"Name one \(rim=\.\.\.\), or fill all \(fill_all\)"):
        tripatch.fill(mesh.vertices, mesh.faces)
    assert "--shape has no effect" in run(capsys, "fill", path, tmp_path / "out.obj", "--all", "--shape", "0.3")[2]


def test_an_interrupt_after_the_file_is_written_says_that_it_is(one, tmp_path, capsys, monkeypatch):
    def interrupt(*_args, **_options):
        raise KeyboardInterrupt

    out = tmp_path / "out.obj"
    monkeypatch.setattr(cli.words, "filled", interrupt)
    code, _, err = run(capsys, "fill", one, out)
    assert (code, err) == (130, f"tripatch: Interrupted; {out} is written\n") and out.exists()
    out.unlink()
    monkeypatch.setattr(cli.tripatch, "fill", interrupt)
    assert run(capsys, "fill", one, out) == (130, "", "tripatch: Interrupted\n") and not out.exists()


def test_json_is_all_that_is_printed(one, tmp_path, capsys):
    code, out, err = run(capsys, "fill", one, "-o", tmp_path / "out.obj", "--json", "--report", tmp_path / "r.json")
    said = json.loads(out)
    assert code == 0 and err == "tripatch: 1 outer border left open (18 edges); use --all --outer to fill it\n"
    assert said == json.loads((tmp_path / "r.json").read_text())
    assert (said["schema"], said["tripatch"]) == (1, tripatch.__version__)
    assert len(said["holes"]) == 1 and said["holes"][0]["new_faces"] > 0
    path = write_obj(tmp_path / "square.obj", square())
    code, out, err = run(capsys, "fill", path, "-o", tmp_path / "b.obj", "--json", "--method", "side_vertex")
    assert code == 1 and "refused" in json.loads(out)["holes"][0] and err


def test_quiet_prints_errors_only_and_verbose_a_line_for_each_hole(one, tmp_path, capsys):
    out = tmp_path / "out.obj"
    more = ["--shape", "0.3"]  # of which a warning says that it is not applied
    assert run(capsys, "fill", one, out, *more)[2]
    assert run(capsys, "fill", one, out, "-q", *more) == (0, "", "")
    code, said, _ = run(capsys, "fill", one, out, "-v")
    assert code == 0 and re.search(r"^Hole at vertex 0: \d+ new faces by \w+", said, re.M)
    assert "Filled 1 hole" in said
    path = write_obj(tmp_path / "square.obj", square())
    assert "needs 3 corners" in run(capsys, "fill", path, out, "-q", "--method", "side_vertex")[2]
    for command in (["view", one, "-o", tmp_path / "a.png"], ["smooth", one, "-o", tmp_path / "b.obj"]):
        assert run(capsys, *command)[1]
        assert run(capsys, *command, "--quiet") == (0, "", "")
    assert len(borders(tmp_path / "b.obj")) == 2


def test_an_input_that_is_not_there_or_has_no_suffix_is_named(tmp_path, capsys):
    (tmp_path / "mesh").write_text("v 0 0 0\n")
    for name, said in (("-", missing_file()), (tmp_path / "none.xyz", missing_file()), (tmp_path / "mesh", "no suffix")):
        code, out, err = run(capsys, "fill", name, "-o", tmp_path / "out.obj")
        assert (code, out) == (2, "") and f"{name} cannot be read" in err and said in err
