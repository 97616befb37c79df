"""Which borders are holes, and what is said of those that are left open."""

import copy
import json
import pickle

import numpy as np
import pytest
import tripatch
from codes import refused
from shapes import cube_sphere
from test_cli import run, sphere_hole, write_obj
from tripatch import words


def flanged_pipe(low, high):
    """A pipe of radius 1 with a flange at each end: vertices from 0 on are the border of the lower one, from 144 of the other."""
    profile = [(low, 0), ((1 + low) / 2, 0), (1, 0), (1, 1), (1, 2), ((1 + high) / 2, 2), (high, 2)]
    angle = 2 * np.pi * np.arange(24) / 24
    vertices = np.concatenate([np.column_stack([r * np.cos(angle), r * np.sin(angle), 0 * angle + z]) for r, z in profile])
    quads = [(24 * j + k, 24 * j + (k + 1) % 24) for j in range(len(profile) - 1) for k in range(24)]
    faces = [[a, b, b + 24, a + 24] for a, b in quads]
    return vertices, faces


def sheet(count, size=1.0, gone=()):
    """A plane of count x count quads without some of them."""
    x, y = np.meshgrid(*2 * [np.linspace(0, size, count + 1)], indexing="ij")
    quads = [[i * (count + 1) + j, (i + 1) * (count + 1) + j] for i in range(count) for j in range(count)]
    faces = [[a, b, b + 1, a + 1] for k, (a, b) in enumerate(quads) if k not in gone]
    return np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]), faces


def together(*meshes):
    vertices, faces = np.zeros((0, 3)), []
    for points, own in meshes:
        faces += [[v + len(vertices) for v in face] for face in own]
        vertices = np.concatenate([vertices, points])
    return vertices, faces


def lengths(loops):
    return sorted(len(loop) for loop in loops)


@pytest.mark.parametrize(("low", "high", "outer"), [(3, 2, [0]), (2, 3, [144]), (2, 2, [0, 144])])
def test_of_borders_that_turn_outwards_only_the_longest_of_a_component_is_outer(low, high, outer):
    vertices, faces = flanged_pipe(low, high)
    assert [int(loop[0]) for loop in tripatch.outer_borders(vertices, faces)] == outer
    assert [int(loop[0]) for loop in tripatch.choose_holes(vertices, faces)] == [v for v in (0, 144) if v not in outer]


def test_every_component_has_an_outer_border_of_its_own():
    large, quads = sheet(3, 9.0)
    vertices, faces = together(sheet(6, 1.0, [14]), (large + [20, 0, 0], quads))
    assert lengths(tripatch.outer_borders(vertices, faces)) == [12, 24]
    filled = tripatch.fill_all(vertices, faces)
    assert [len(fill.rim) for fill in filled] == [4]
    assert lengths(filled.outer_borders) == [12, 24]
    assert tripatch.fill_all(vertices, faces, outer=True).outer_borders == []
    for same in (copy.deepcopy(filled.outer_borders), pickle.loads(pickle.dumps(filled.outer_borders))):
        assert lengths(same) == [12, 24]


def test_a_sheet_without_a_hole_has_nothing_to_fill():
    vertices, faces = sheet(4)
    assert tripatch.choose_holes(vertices, faces) == []
    assert lengths(tripatch.outer_borders(vertices, faces)) == [16]
    with refused("only_outer_borders"):
        tripatch.fill(vertices, faces)
    rim = tripatch.find_holes(faces)[0]
    cover = tripatch.fill(vertices, faces, rim=rim)
    assert len(cover.faces) > 0 and cover.report.is_flawed and "lies_on_mesh" in [each.code for each in cover.report.warnings]
    vertices[:, 2] = vertices[:, 0] * vertices[:, 1]
    closed = tripatch.fill(vertices, faces, rim=rim)
    assert len(closed.faces) > 0 and "lies_on_mesh" not in [each.code for each in closed.report.warnings]


def test_the_border_of_a_bowl_without_another_hole_is_filled():
    vertices, faces = cube_sphere(4)
    bowl = [face for face in faces if vertices[face][:, 2].mean() < 0.2]
    assert tripatch.outer_borders(vertices, bowl) == []
    assert len(tripatch.choose_holes(vertices, bowl)) == 1


@pytest.mark.parametrize("more", [[], ["--all"]])
def test_the_command_line_copies_a_sheet_and_says_what_is_left_open(tmp_path, capsys, more):
    path, out, report = write_obj(tmp_path / "in.obj", sheet(4)), tmp_path / "out.obj", tmp_path / "report.json"
    code, text, err = run(capsys, "fill", path, out, *more, "--report", report)
    option = "--outer" if more else "--all --outer"
    assert (code, err) == (0, "")
    assert text == f"Nothing to fill: 1 outer border left open (16 edges); use {option} to fill it\n"
    assert out.read_bytes() == path.read_bytes()
    told = json.loads(report.read_text())
    assert told["holes"] == []
    assert [(each["code"], each["edges"], len(each["rim"])) for each in told["outer_borders"]] == [
        ("outer_border_left_open", 16, 16)
    ]


def test_a_closed_mesh_is_copied(tmp_path, capsys):
    path, out = write_obj(tmp_path / "in.obj", cube_sphere(2)), tmp_path / "out.obj"
    assert run(capsys, "fill", path, out) == (0, "Nothing to fill: the mesh has no border\n", "")
    assert out.read_bytes() == path.read_bytes()


def test_the_command_line_says_which_outer_borders_it_leaves_open(tmp_path, capsys):
    path, out = write_obj(tmp_path / "in.obj", sphere_hole(), sheet(5)), tmp_path / "out.obj"
    code, text, err = run(capsys, "fill", path, out, "--all")
    assert (code, err) == (0, "")
    assert text.splitlines()[1] == "2 outer borders left open (18 and 20 edges); use --outer to fill them"
    code, text, err = run(capsys, "fill", path, out, "--all", "--outer")
    assert code == 3 and "The fill lies on the mesh: this is the border of a flat sheet" in err
    assert text.startswith("Filled 3 holes") and "left open" not in text


def test_many_borders_are_told_by_the_smallest_and_the_largest():
    assert words.left_open([]) == ""
    assert words.left_open([7, 4, 5]) == "3 outer borders left open (4, 5 and 7 edges)"
    assert words.left_open([6, 6]) == "2 outer borders left open (6 edges each)"
    assert words.left_open([9, 4, 5, 6, 7], "--outer") == "5 outer borders left open (4 to 9 edges); use --outer to fill them"


def test_a_batch_of_files_without_holes_succeeds_and_says_what_is_left_open(tmp_path, capsys):
    (tmp_path / "in").mkdir()
    write_obj(tmp_path / "in" / "closed.obj", cube_sphere(2))
    write_obj(tmp_path / "in" / "sheet.obj", sheet(4))
    out = tmp_path / "out"
    for more in ([], ["--dry-run"]):
        code, text, _ = run(capsys, "batch", tmp_path / "in", "--out", out, "--workers", 0, *more)
        assert code == 0
        assert "1 outer border left open (16 edges); use --outer to fill it" in text.splitlines()
    lines = [json.loads(line) for line in (out / "tripatch-batch.jsonl").read_text().splitlines()]
    assert [line["outer"] for line in lines if line["line"] == "hole"] == [True]


def test_a_batch_whose_filters_leave_every_hole_has_filled_nothing(tmp_path, capsys):
    (tmp_path / "in").mkdir()
    write_obj(tmp_path / "in" / "hole.obj", sphere_hole())
    assert run(capsys, "batch", tmp_path / "in", "--out", tmp_path / "out", "--workers", 0, "--max-edges", 5)[0] == 1
