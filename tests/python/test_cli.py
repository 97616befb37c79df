"""`tripatch fill` and `tripatch methods`, run as a shell runs them."""

from __future__ import annotations

import inspect
import json
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import tripatch
from systems import missing_file
from tripatch import __main__ as cli
from tripatch import files, words


def sphere_hole(n=6, rings=3, center=0.0):
    """A unit sphere around an octant hole: vertices, faces; the rim is 0 .. 3n - 1, its corners 0, n, 2n."""
    axes = np.eye(3)
    s = np.arange(n) / n * np.pi / 2
    rim = np.concatenate([np.outer(np.cos(s), axes[i]) + np.outer(np.sin(s), axes[(i + 1) % 3]) for i in range(3)])
    middle = np.ones(3) / np.sqrt(3)
    vertices, faces = [], []
    for j in range(rings + 1):
        p = middle + (1 + 0.15 * j) * (rim / (rim @ middle)[:, None] - middle)
        vertices.append(p / np.linalg.norm(p, axis=1, keepdims=True))
    m = 3 * n
    for j in range(rings):
        for k in range(m):
            a, b = j * m + k, j * m + (k + 1) % m
            faces += [[b, a, b + m], [a, a + m, b + m]]
    return np.concatenate(vertices) + [center, 0, 0], faces


#: After messages that name vertices of an OBJ file.
COUNTS_FROM_0 = "tripatch: These numbers count vertices from 0; the lines of an OBJ file count from 1\n"


def write_obj(path, *meshes):
    text, n = "# test\n", 0
    for vertices, faces in meshes:
        text += "".join("v {!r} {!r} {!r}\n".format(*map(float, p)) for p in vertices)
        text += "".join("f " + " ".join(str(v + n + 1) for v in f) + "\n" for f in faces)
        n += len(vertices)
    path.write_text(text)
    return path


@pytest.fixture
def one(tmp_path):
    return write_obj(tmp_path / "in.obj", sphere_hole())


@pytest.fixture
def two(tmp_path):
    return write_obj(tmp_path / "in.obj", sphere_hole(), sphere_hole(5, center=5))


def square():
    """A plane frame around a square hole."""
    v = [[0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0], [1, 1, 0], [2, 1, 0], [2, 2, 0], [1, 2, 0]]
    return np.array(v, float) - [9, 0, 0], [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


def run(capsys, *args):
    code = cli.main([str(a) for a in args])
    said = capsys.readouterr()
    return code, said.out, said.err


def borders(path):
    return tripatch.find_holes(files.read(path).faces)


def test_fills_the_only_hole(one, tmp_path, capsys):
    out = tmp_path / "out.obj"
    code, text, err = run(capsys, "fill", one, out, "--method", "side_vertex", "--report", tmp_path / "r.json")
    assert (code, err) == (0, "")
    assert text.startswith("Filled 1 hole; seam within ")
    assert text.endswith("°)\n1 outer border left open (18 edges); use --all --outer to fill it\n")
    assert out.read_bytes().startswith(one.read_bytes())
    assert [len(loop) for loop in borders(out)] == [18]  # the outer one
    (hole,) = json.loads((tmp_path / "r.json").read_text())["holes"]
    assert hole["corners"] == [0, 6, 12]
    assert hole["rim"] == list(range(18))
    assert hole["seam_angle_max"] < 1e-4
    assert hole["new_faces"] == len(files.read(out).faces) - len(files.read(one).faces)


def test_the_same_as_the_library(one, tmp_path, capsys):
    out = tmp_path / "out.obj"
    rim = ",".join(map(str, range(17, -1, -1)))
    code, _, _ = run(
        capsys,
        "fill",
        one,
        out,
        "--rim",
        rim,
        "--corners",
        "6,0,12",
        "--resolution",
        "4",
        "--bulge",
        "1,1.2,0.8",
        "--fairing",
        "none",
    )
    assert code == 0
    mesh, filled = files.read(one), files.read(out)
    fill = tripatch.fill(
        mesh.vertices, mesh.faces, rim=range(18), corners=[6, 0, 12], resolution=4, bulge=(1, 1.2, 0.8), fairing=None
    )
    assert filled.faces == [*mesh.faces, *fill.faces.tolist()]
    assert (filled.vertices[len(mesh.vertices) :] == fill.vertices).all()


def test_in_place(one, capsys):
    assert run(capsys, "fill", one, one)[0] == 0
    assert len(borders(one)) == 1


@pytest.mark.parametrize("suffix", [".off", ".ply", ".stl", ".vtk"])
def test_other_formats(one, suffix, tmp_path, capsys):
    if suffix == ".vtk":
        pytest.importorskip("meshio")
    code, _, err = run(capsys, "fill", one, tmp_path / f"a{suffix}")
    assert code == 0
    assert "vertices and faces only; all else of" in err
    assert [len(loop) for loop in borders(tmp_path / f"a{suffix}")] == [18]


def test_two_holes(two, tmp_path, capsys):
    out = tmp_path / "out.obj"
    code, _, err = run(capsys, "fill", two, out)
    assert code == 1
    assert "The mesh has 2 holes, which start at vertices 0 and 72" in err
    assert not out.exists()
    code, text, err = run(capsys, "fill", two, out, "--all", "--method", "side_vertex", "--report", tmp_path / "r.json")
    assert (code, err) == (0, "")
    assert text.startswith("Filled 2 holes; seam within ")
    assert sorted(len(loop) for loop in borders(out)) == [15, 18]
    assert [h["corners"] for h in json.loads((tmp_path / "r.json").read_text())["holes"]] == [[72, 77, 82], [0, 6, 12]]


def test_some_refused(tmp_path, capsys):
    path, out = write_obj(tmp_path / "in.obj", sphere_hole(), square()), tmp_path / "out.obj"
    needs = "This method needs 3 corners, but the hole has 4. Name three, or use method auto"
    code, text, err = run(capsys, "fill", path, out, "--all", "--method", "side_vertex", "--report", tmp_path / "r.json")
    assert code == 3
    assert text.startswith("Filled 1 hole;")
    assert err == f"tripatch: Hole at vertex 76: {needs} (vertices 76, 77, 78 and 79)\n{COUNTS_FROM_0}"
    assert out.exists()
    first, second = json.loads((tmp_path / "r.json").read_text())["holes"]
    assert (first["refused"], first["codes"]) == (needs, ["not_three_corners"])
    assert first["where"] == [76, 77, 78, 79]
    assert second["corners"] == [0, 6, 12]


def test_what_is_said_of_several_holes_is_said_once_with_their_names(tmp_path, capsys):
    path, out = write_obj(tmp_path / "in.obj", sphere_hole(), sphere_hole(center=9.0), square()), tmp_path / "out.obj"
    said = "--shape has no effect: it is an option of szilvasi_nagy_c0, szilvasi_nagy_c1\n"
    code, _, err = run(capsys, "fill", path, out, "--all", "--shape", "0.3")
    assert code == 0 and err == "tripatch: 3 holes at vertices 148, 0 and 72: " + said + COUNTS_FROM_0
    code, _, err = run(capsys, "fill", path, out, "--all", "--method", "side_vertex", "--shape", "0.3")
    assert code == 3 and err.endswith("tripatch: 2 holes at vertices 0 and 72: " + said)
    code, _, err = run(capsys, "fill", path, out, "--all", "--max-edges", "4", "--shape", "0.3")
    assert code == 0 and err == "tripatch: " + said
    code, _, err = run(capsys, "fill", path, out, "--rim", ",".join(map(str, range(18))), "--shape", "0.3")
    assert code == 0 and err == "tripatch: " + said


def test_sentences_on_one_hole_of_several_name_it():
    told = [(4, ["It folds", "It is odd"]), (7, []), *[(k, ["It is odd"]) for k in range(10, 20)]]
    named = "4, 10, 11, 12, 13, 14, 15, 16 and more"
    assert words.gathered(told) == ["Hole at vertex 4: It folds", f"11 holes at vertices {named}: It is odd"]
    assert words.gathered(told[:1]) == ["It folds", "It is odd"]
    assert words.gathered(told[:2]) == ["Hole at vertex 4: It folds", "Hole at vertex 4: It is odd"]


def test_all_rims_may_be_called_round(two, tmp_path, capsys):
    out = tmp_path / "out.obj"
    for none in (["--corners", "none"], ["--corners="], ["--corners", ""]):
        code, text, _ = run(capsys, "fill", two, out, "--all", *none, "--report", tmp_path / "r.json")
        assert code == 0 and text.startswith("Filled 2 holes")
        assert [hole["corners"] for hole in json.loads((tmp_path / "r.json").read_text())["holes"]] == [[], []]


def test_all_refused(tmp_path, capsys):
    path, out = write_obj(tmp_path / "in.obj", square()), tmp_path / "out.obj"
    for more in ([], ["--all"], ["--rim", "4,5,6,7"]):
        code, text, err = run(capsys, "fill", path, out, "--method", "side_vertex", *more)
        assert (code, text) == (1, "")
        assert "This method needs 3 corners" in err
        assert not out.exists()


def test_outer_borders(tmp_path):
    vertices, faces = sphere_hole()
    assert [len(loop) for loop in tripatch.choose_holes(vertices, faces)] == [18]
    assert [len(loop) for loop in tripatch.choose_holes(vertices, faces, outer=True)] == [18, 18]
    assert tripatch.choose_holes(vertices, faces)[0][0] == 0
    # a part of the mesh with one border only: that is a hole
    closed = [*faces, [*range(54, 72)]]
    assert [len(loop) for loop in tripatch.choose_holes(vertices, closed)] == [18]


def test_both_ends_of_a_tube_are_holes():
    # neither turns the other way; the lower row of quads comes first
    angle = 2 * np.pi * np.arange(12) / 12
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(12)])
    vertices = np.concatenate([ring + [0, 0, z] for z in range(4)])
    tube = [[12 * z + k, 12 * z + (k + 1) % 12, 12 * z + 12 + (k + 1) % 12, 12 * z + 12 + k] for z in range(3) for k in range(12)]
    assert [loop[0] for loop in tripatch.choose_holes(vertices, tube)] == [0, 36]
    # next to a plane, whose border is an outer one
    plane = np.array([[5, 0, 0], [6, 0, 0], [6, 1, 0], [5, 1, 0]], float)
    both = [*tube, [48, 49, 50, 51]]
    assert [loop[0] for loop in tripatch.choose_holes(np.concatenate([vertices, plane]), both)] == [0, 36]


@pytest.mark.parametrize(
    ("arguments", "filled"),
    [
        ([], [15, 18]),
        (["--max-edges", "17"], [15]),
        (["--max-edges", "18"], [15, 18]),
        (["--corner-count", "3,3"], [15, 18]),
        (["--corner-count", "0,2"], []),
        (["--corner-count", "4,12"], []),
        (["--max-diameter", "1.5"], [15, 18]),  # an octant's corners are sqrt(2) apart
        (["--max-diameter", "1.4"], []),
    ],
)
def test_holes_are_chosen(two, tmp_path, capsys, arguments, filled):
    out = tmp_path / "out.obj"
    code, _, err = run(capsys, "fill", two, out, "--all", *arguments)
    assert code == (0 if filled else 1)
    assert filled or "all holes were excluded by your filters" in err
    assert out.exists() == bool(filled)
    left = Counter([15, 15, 18, 18]) - Counter(filled)  # each part has an outer border too
    assert not filled or Counter(len(loop) for loop in borders(out)) == left


def test_a_fill_that_folds_is_no_success(one, tmp_path, capsys):
    vertices, faces = sphere_hole()
    inward = vertices[:18] + 0.9 * (np.ones(3) / np.sqrt(3) - vertices[:18])
    vertices[[k for k in range(18) if k % 2 and k % 6]] = inward[[k for k in range(18) if k % 2 and k % 6]]
    path, out = write_obj(tmp_path / "in.obj", (vertices, faces)), tmp_path / "out.obj"
    code, _, err = run(capsys, "fill", path, out, "--corners", "0,6,12", "--fairing", "none", "--method", "side_vertex")
    assert code == 3
    assert out.exists()
    assert "1 fill folds over itself (at vertex 0)" in err


def test_how_sharply_faces_meet_is_told_of_what_is_tangent_to_nothing(tmp_path, capsys):
    x, y = np.meshgrid(np.arange(9.0), np.arange(9.0))
    vertices = np.column_stack([x.ravel(), y.ravel(), 0.02 * (x**2 + y**2).ravel()])
    quads = [(i, j) for j in range(8) for i in range(8) if not (3 <= i < 5 and 3 <= j < 5)]
    faces = [[9 * j + i, 9 * j + i + 1, 9 * j + i + 10, 9 * j + i + 9] for i, j in quads]
    fill = tripatch.fill(vertices, faces)
    assert fill.report.continuity == [] and fill.report.seam_angle_max > 1
    _, text, _ = run(capsys, "fill", write_obj(tmp_path / "in.obj", (vertices, faces)), tmp_path / "out.obj")
    angle = words.degrees(fill.report.seam_angle_max)
    assert text.startswith(f"Filled 1 hole; boundary bends by up to {angle}")


def test_values_by_side_are_not_ignored_in_silence(one, tmp_path, capsys):
    _, _, err = run(capsys, "fill", one, tmp_path / "out.obj", "--method", "polyharmonic_spline", "--bulge", "3,2,1,7")
    assert "bulge had no effect" in err


def test_a_protected_file_is_not_written_over(one, tmp_path, capsys, monkeypatch):
    (out := tmp_path / "out.obj").write_text("mine")
    monkeypatch.setattr("os.access", lambda path, mode: False)  # root may write everything
    code, _, err = run(capsys, "fill", one, out)
    assert code == 2 and "ermission denied" in err and out.read_text() == "mine"


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (["--method", "none_such"], "--method must be one of"),
        (["--resolution", "0"], "--resolution must be from 1 to 10000, not 0"),
        (["--resolution", "10001"], "--resolution must be from 1 to 10000, not 10001"),
        (["--faces", "quads", "--resolution", "-1"], "--resolution must be from 0 to 100, not -1"),
        (["--faces", "quads", "--resolution", "101"], "--resolution must be from 0 to 100, not 101"),
        (["--resolution", "x"], "--resolution: 'x' cannot be read"),
        (["--bulge", ",".join("1" * 13)], "for example, 1,0.5,1"),
        (["--bulge", "-1"], "bulge"),
        (["--shape", "a"], "'a' cannot be read"),
        (["--corners", "1"], "One corner is too few"),
        (["--corners", "0,6,6"], "--corners names vertex 6 twice"),
        (["--rim", "0,1,two"], "'0,1,two' cannot be read"),
        (["--rim", "0,1,5000"], "5000"),
        (["--all", "--corners", "0,6,12"], "--all and --corners cannot be used together"),
        (["--outer"], "--outer needs --all"),
        (["--max-edges", "9"], "--max-edges needs --all"),
        (["--all", "--max-edges", "2"], "--max-edges must be 3 or more, not 2"),
        (["--all", "--corner-count", "6,2"], "--corner-count must be the smallest and the largest"),
        (["--frobnicate"], "Unknown arguments: --frobnicate"),
        (["--report", "/none/such/r.json"], f"folder {Path('/none/such')} does not exist"),
    ],
)
def test_bad_usage(args, said, one, tmp_path, capsys):
    code, _, err = run(capsys, "fill", one, tmp_path / "out.obj", *args)
    assert code == 2
    assert said in err
    assert not (tmp_path / "out.obj").exists()


def test_unreadable_input(tmp_path, capsys):
    code, _, err = run(capsys, "fill", tmp_path / "none.obj", tmp_path / "out.obj")
    assert code == 2
    assert err == f"tripatch: {tmp_path / 'none.obj'} cannot be read: {missing_file()}\n"
    (tmp_path / "bad.obj").write_text("v 1 2\n")
    code, _, err = run(capsys, "fill", tmp_path / "bad.obj", tmp_path / "out.obj")
    assert code == 2
    assert "Line 1 of the file cannot be read" in err
    assert run(capsys)[0] == 2
    assert run(capsys, "none_such")[0] == 2


def test_more_than_the_method_keeps_is_refused(one, tmp_path, capsys):
    code, _, err = run(capsys, "fill", one, tmp_path / "out.obj", "--continuity", "G2", "--method", "gordon_coons")
    assert code == 1
    assert "G2" in err


@pytest.mark.parametrize("every", [[], ["--all"]])
def test_deviation_is_the_fills(one, every, tmp_path, capsys):
    mesh, out = files.read(one), tmp_path / "out.ply"
    spline = [*every, "--method", "polyharmonic_spline"]
    assert run(capsys, "fill", one, out, "--deviation", *spline)[0] == 0
    fill = tripatch.fill(mesh.vertices, mesh.faces, method="polyharmonic_spline")
    told = files.read(out).deviation
    assert (told[: len(mesh.vertices)] == 0).all() and fill.deviation.max() > 0
    assert np.array_equal(told[len(mesh.vertices) :], fill.deviation.astype(np.float32))
    code, _, err = run(capsys, "fill", one, out, "--deviation", *every, "--fairing", "none", "--method", "side_vertex")
    assert code == 0 and "1 of 1 fill has no error estimate" in err
    told = files.read(out).deviation
    assert (told[: len(mesh.vertices)] == 0).all() and (told[len(mesh.vertices) :] == -1).all()
    assert run(capsys, "fill", one, out, *spline)[0] == 0
    assert files.read(out).deviation is None  # nobody asked


@pytest.mark.parametrize("suffix", [".obj", ".off", ".stl", ".vtk"])
def test_deviation_goes_into_ply_files_only(one, suffix, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(tripatch, "fill", lambda *_, **__: pytest.fail("something was computed"))
    out = tmp_path / f"out{suffix}"
    code, _, err = run(capsys, "fill", one, out, "--deviation")
    assert code == 2 and "--deviation needs OUT.ply" in err and not out.exists()


def test_every_option_of_fill_is_there():
    fill = next(a for a in cli.parser()._actions if a.dest == "command").choices["fill"]
    parameters = {*inspect.signature(tripatch.fill).parameters, *inspect.signature(tripatch.choose_holes).parameters}
    options = parameters - {"vertices", "faces", "replaced", "progress"}
    assert options == set(cli.OPTIONS) and options <= {action.dest for action in fill._actions}


def test_methods(capsys):
    code, text, _ = run(capsys, "methods")
    assert code == 0
    for name, method in tripatch.METHODS.items():
        assert f"{name}\n" in text
        assert method.citation in text


def test_as_a_program(one, tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "tripatch", "fill", str(one), str(tmp_path / "out.obj")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("Filled 1 hole")
    assert subprocess.run([sys.executable, "-m", "tripatch"], capture_output=True, check=False).returncode == 2


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply", ".vtk"])
def test_an_odd_rim_is_split_in_the_file(suffix, tmp_path, capsys):
    rim = np.array([[np.cos(a), np.sin(a), 0] for a in 2 * np.pi * np.arange(15) / 15])
    points = np.concatenate([rim, 1.5 * rim - [0, 0, 0.2], 2 * rim - [0, 0, 0.5]])
    faces = [[r + (k + 1) % 15, r + k, r + k + 15, r + (k + 1) % 15 + 15] for r in (0, 15) for k in range(15)]
    path, out = write_obj(tmp_path / "in.obj", (points, faces)), tmp_path / f"out{suffix}"
    where = ["--rim", ",".join(map(str, range(15))), "--corners", "0,5,10"]
    code, _, errors = run(capsys, "fill", path, out, *where, "--output", "quads", "--odd", "split", "--resolution", 0)
    assert code == 0, errors
    given, found = files.read(path), files.read(out)
    expected = tripatch.fill(
        given.vertices, given.faces, rim=range(15), corners=[0, 5, 10], output="quads", odd="split", resolution=0
    )
    ((a, b),), (t,) = expected.split_edges
    assert np.abs(found.vertices - np.concatenate([given.vertices, expected.vertices])).max() < 1e-12
    pentagon = next(face for face in found.faces if len(face) == 5)
    assert {pentagon[pentagon.index(45) - 1], pentagon[(pentagon.index(45) + 1) % 5]} == {a, b}
    without = [v for v in pentagon if v != 45]
    start = without.index(min(without))
    kept = [f[f.index(min(f)) :] + f[: f.index(min(f))] for f in found.faces if len(f) != 5]
    assert sorted([*kept, without[start:] + without[:start]]) == sorted(
        f[f.index(min(f)) :] + f[: f.index(min(f))] for f in [*given.faces, *map(list, expected.faces)]
    )
    assert len(borders(out)) == 1


def test_quads_of_an_odd_rim_leave_every_face_of_the_file(one, tmp_path, capsys):
    code, _, _ = run(capsys, "fill", str(one), str(tmp_path / "out.obj"), "--output", "quads", "--resolution", "0")
    assert code == 0
    assert (tmp_path / "out.obj").read_bytes().startswith(one.read_bytes())


def test_triangles_among_quads_are_counted(tmp_path, capsys):
    one = write_obj(tmp_path / "in.obj", sphere_hole(5))
    for options, told in (([], False), (["--output", "quads", "--odd", "triangle", "--resolution", "0"], True)):
        code, said, _ = run(capsys, "fill", one, tmp_path / "out.obj", *options)
        new = [len(face) for face in files.read(tmp_path / "out.obj").faces[len(files.read(one).faces) :]]
        assert code == 0 and (f"; {new.count(3)} of {len(new)} new faces " in said) == told


def test_cages_say_what_a_file_cannot_hold(one, tmp_path, capsys):
    out = tmp_path / "out.obj"
    code, _, errors = run(
        capsys, "fill", one, out, "--output", "cage", "--cage-rim", "exact", "--report", tmp_path / "r.json", "--resolution", 0
    )
    assert code == 0 and "No file format stores creases" in errors and len(borders(out)) == 1
    creases = json.loads((tmp_path / "r.json").read_text())["holes"][0]["creases"]
    assert len(creases) == 18 and all(max(edge) < 18 for edge in creases)


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply", ".vtk"])
def test_a_moved_rim_is_moved_in_the_file(one, suffix, tmp_path, capsys):
    out = tmp_path / f"out{suffix}"
    code, _, errors = run(capsys, "fill", one, out, "--output", "cage", "--cage-rim", "move", "--resolution", 0)
    assert code == 0, errors
    given, found = files.read(one), files.read(out)
    expected = tripatch.fill(given.vertices, given.faces, output="cage", cage_rim="move", resolution=0, odd="triangle")
    moved, places = expected.moved
    assert len(moved) == 18 and np.abs(places - given.vertices[moved]).max() > 1e-4
    wanted = np.concatenate([given.vertices, expected.vertices])
    wanted[moved] = places
    assert np.abs(found.vertices - wanted).max() < 1e-12
    assert sorted(map(sorted, found.faces)) == sorted(map(sorted, [*given.faces, *map(list, expected.faces)]))


def test_stl_files_move_nothing(one, tmp_path, capsys):
    out = tmp_path / "out.stl"
    code, _, errors = run(capsys, "fill", one, out, "--output", "cage", "--cage-rim", "move", "--resolution", 0)
    assert code == 2 and "another format" in errors and not out.exists()


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply", ".stl"])
def test_smooth(suffix, tmp_path, capsys):
    vertices = np.array([(1, 1, 1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1)], float)
    faces = [[0, 1, 3], [0, 3, 2], [0, 2, 1], [1, 2, 3]]
    path, out = write_obj(tmp_path / "in.obj", (vertices, faces)), tmp_path / f"out{suffix}"
    code, text, err = run(capsys, "smooth", path, out, "--resolution", 5, "--curve", "smits")
    assert (code, text, err) == (0, "Smoothed 4 faces into 100 triangles\n", "")
    expected = tripatch.smooth_triangles(vertices, faces, resolution=5, curve="smits")
    mesh = files.read(out)
    assert len(mesh.faces) == 100 and len(mesh.vertices) == len(expected.vertices)
    found, wanted = (np.array([m.vertices[f] for f in m.faces]) for m in (mesh, expected))
    assert np.abs(found - wanted).max() < 1e-6  # STL has single precision


def test_smooth_refuses_what_is_no_triangle(tmp_path, capsys):
    path, out = write_obj(tmp_path / "in.obj", square()), tmp_path / "out.obj"
    code, _, err = run(capsys, "smooth", path, out)
    assert code == 1 and "Face 0 has 4 corners" in err and not out.exists()
    code, _, err = run(capsys, "smooth", path, out, "--resolution", 0)
    assert code == 2 and "resolution" in err


def unjoined(vertices, faces):
    """The same faces, each with vertices of its own."""
    order = np.concatenate([np.asarray(face) for face in faces])
    ends = np.cumsum([len(face) for face in faces])
    return np.asarray(vertices)[order], [list(range(end - len(face), end)) for face, end in zip(faces, ends)]


def test_faces_that_are_not_joined_are_filled_as_if_they_were(tmp_path, capsys):
    path = write_obj(tmp_path / "in.obj", unjoined(*square()))
    for more in ([], ["--all"]):
        code, text, err = run(capsys, "fill", path, tmp_path / "out.obj", *more)
        assert (code, err) == (0, "") and text.startswith("Filled 1 hole")
    (fill,) = tripatch.fill_all(*unjoined(*square()))
    assert len(fill.rim) == 4


def test_a_seam_that_ends_at_a_hole_is_no_part_of_its_rim(tmp_path, capsys):
    vertices, faces = sphere_hole()
    half = [v + len(vertices) * (k % 36 < 18) for k, face in enumerate(faces) for v in face]  # three of six sectors
    path = write_obj(tmp_path / "in.obj", (np.concatenate([vertices, vertices]), np.reshape(half, (-1, 3))))
    code, text, err = run(capsys, "fill", path, tmp_path / "out.obj", "--all")
    assert (code, err) == (0, "") and text.startswith("Filled 1 hole")


@pytest.mark.parametrize("more", [0, 1])
def test_of_many_refusals_twenty_are_told_and_the_rest_counted(tmp_path, capsys, more):
    count = cli.MAX_TOLD + more
    write_obj(tmp_path / "in.obj", *[(np.eye(3) + k, [[0, 1, 2]]) for k in range(count)])
    assert cli.main(["fill", str(tmp_path / "in.obj"), str(tmp_path / "out.obj"), "--all"]) == 1
    said = capsys.readouterr().err.splitlines()
    assert sum("outline of a loose face" in line for line in said) == cli.MAX_TOLD == 20
    assert sum("1 more hole was refused; --report FILE.json names each" in line for line in said) == more
