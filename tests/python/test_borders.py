"""Borders that lie on other borders, islands in holes, and fills that pass through the mesh."""

import json
import types

import numpy as np
import pytest
import tripatch
from shapes import cube_sphere
from test_cli import run, write_obj
from test_outer_borders import sheet, together
from tripatch import words


def tube(low, high, count=24, radius=1.0, rows=4):
    """A tube along z from one height to another."""
    angle = 2 * np.pi * np.arange(count) / count
    ring = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle])
    vertices = np.concatenate([ring + [0, 0, z] for z in np.linspace(low, high, rows + 1)])
    quads = [(count * j + k, count * j + (k + 1) % count) for j in range(rows) for k in range(count)]
    return vertices, [[a, b, b + count, a + count] for a, b in quads]


def arc(first, last, count=16, rows=6):
    """A part of a torus with radii 4 and 1, between two angles in degrees."""
    turn, angle = np.radians(np.linspace(first, last, rows + 1)), 2 * np.pi * np.arange(count) / count
    rings = [np.column_stack([(4 + np.cos(angle)) * np.cos(t), (4 + np.cos(angle)) * np.sin(t), np.sin(angle)]) for t in turn]
    quads = [(count * j + k, count * j + (k + 1) % count) for j in range(rows) for k in range(count)]
    return np.concatenate(rings), [[b, a, a + count, b + count] for a, b in quads]


def open_edges(vertices, faces, fills, within=1e-9):
    """Of the mesh with its fills, after vertices at one place were joined."""
    points, all_faces = np.asarray(vertices), [list(face) for face in faces]
    for fill in fills:
        first = len(points)
        points = np.concatenate([points, fill.vertices])
        all_faces += [[v if v < len(vertices) else v - len(vertices) + first for v in face] for face in fill.faces]
    _, same = np.unique(np.round(points / within), axis=0, return_inverse=True)
    same = same.reshape(-1)
    edges = {}
    for face in all_faces:
        for a, b in zip(face, [*face[1:], face[0]]):
            edges[tuple(sorted((same[a], same[b])))] = edges.get(tuple(sorted((same[a], same[b]))), 0) + 1
    return sum(count != 2 for count in edges.values())


def in_two_parts(vertices, faces, side):
    """The same faces, those of one side with vertices of their own."""
    moved = [[v + len(vertices) for v in face] if side(vertices[face].mean(axis=0)) else face for face in faces]
    return np.concatenate([vertices, vertices]), moved


@pytest.mark.parametrize("side", [lambda p: p[2] > 0.5, lambda p: p[0] > 0.01], ids=["across", "along"])
def test_parts_that_lie_against_each_other_have_no_holes_there(side):
    vertices, faces = in_two_parts(*tube(0, 1), side)
    fills = tripatch.fill_all(vertices, faces)
    assert [len(rim) for rim in fills.rims] == [24, 24]
    assert {float(height) for rim in fills.rims for height in vertices[rim][:, 2]} == {0.0, 1.0}
    assert open_edges(vertices, faces, fills) == 0


def test_new_faces_use_the_vertices_of_the_faces_beside_them():
    vertices, faces = in_two_parts(*tube(0, 1), lambda p: p[0] > 0.01)
    fills = tripatch.fill_all(vertices, faces)
    old = {edge for face in faces for edge in zip(face, [*face[1:], face[0]])}
    for fill in fills:
        beside = {(b, a) for face in fill.faces for a, b in zip(face, [*face[1:], face[0]])} & old
        assert len(beside) == 24  # every edge of the rim is shared with the face beyond it


@pytest.fixture
def apart(tmp_path):
    """A tube in two parts, a hundred-thousandth of its size apart."""
    vertices, faces = together(tube(0, 1), tube(1 + 2e-5, 2))
    return write_obj(tmp_path / "in.obj", (vertices, faces))


def test_near_duplicate_borders_are_refused_by_name(apart, tmp_path, capsys):
    report = tmp_path / "report.json"
    code, text, err = run(capsys, "fill", apart, tmp_path / "out.obj", "--all", "--report", report)
    assert code == 3 and text.startswith("Filled 2 holes")
    assert err.count("lie on other borders") == 2 and "--join" in err
    holes = json.loads(report.read_text())["holes"]
    assert sum("refused" in hole for hole in holes) == 2


def test_join_joins_borders_within_a_distance(apart, tmp_path, capsys):
    out = tmp_path / "out.obj"
    code, text, _ = run(capsys, "fill", apart, out, "--all", "--join", 1e-3)
    assert code == 0 and text.startswith("Filled 2 holes")


def test_a_slit_between_t_junctions_is_refused_and_no_hole():
    vertices, faces = sheet(2)
    vertices = np.concatenate([vertices, [[0.5, 0.25, 0]]])
    left = next(face for face in faces if {3, 4} <= set(face) and vertices[face][:, 0].mean() < 0.5)
    k = next(k for k in range(4) if {left[k], left[(k + 1) % 4]} == {3, 4})
    left.insert(k + 1, 9)
    fills = tripatch.fill_all(vertices, faces)
    assert len(fills) == 1 and isinstance(fills[0], tripatch.Refusal)
    assert "T-junctions" in fills[0].reason


def cap_and_bowl(low, high):
    """A sphere without a belt between two angles from its pole: a bowl with a hole, and a cap that floats in it."""
    vertices, faces = cube_sphere(14)
    angle = [
        np.degrees(np.arccos(vertices[face].mean(axis=0)[2] / np.linalg.norm(vertices[face].mean(axis=0)))) for face in faces
    ]
    return vertices, [face for face, a in zip(faces, angle) if not low < a < high]


def test_a_piece_that_floats_in_a_hole_is_joined_by_its_fill():
    vertices, faces = cap_and_bowl(22, 50)
    (fill,) = fills = tripatch.fill_all(vertices, faces)
    assert fills.outer_borders == [] and open_edges(vertices, faces, fills) == 0
    assert np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max() < 0.02
    assert fill.passes_through is None
    alone = tripatch.fill_all(vertices, faces, islands="none")
    assert len(alone) + len(alone.outer_borders) == 2


def test_the_gap_of_a_pipe_is_joined_and_its_ends_are_closed():
    vertices, faces = together(arc(0, 30), arc(60, 90))
    fills = tripatch.fill_all(vertices, faces)
    assert sorted(len(fill.rim) for fill in fills) == [16, 16, 32]
    assert open_edges(vertices, faces, fills) == 0


@pytest.mark.parametrize("name", ["beside", "stacked", "shells"])
def test_holes_that_do_not_face_each_other_are_no_islands(name):
    if name == "beside":
        parts = [tube(0, 1), (tube(0, 1)[0] + [3, 0, 0], tube(0, 1)[1])]
    elif name == "stacked":  # farther apart than they are wide
        parts = [tube(0, 1), tube(6, 7)]
    else:  # a wall with a pinhole on both sides
        vertices, faces = cube_sphere(20)
        top = int(np.argmax([vertices[face].mean(axis=0)[2] for face in faces]))
        beside = next(f for f, face in enumerate(faces) if f != top and set(face) & set(faces[top]))
        outside = [face for f, face in enumerate(faces) if f not in (top, beside)]
        parts = [(vertices, outside), (0.9 * vertices, [face[::-1] for f, face in enumerate(faces) if f != top])]
    vertices, faces = together(*parts)
    fills = tripatch.fill_all(vertices, faces)
    assert len(fills) == len(tripatch.find_holes(faces))


def test_a_fill_that_passes_through_the_mesh_is_reported_with_its_place(tmp_path, capsys):
    plate = sheet(8, 1.0, [k for k in range(64) if 2 <= k // 8 < 6 and 2 <= k % 8 < 6])
    fin = np.array([[0.55, 0.4, -0.3], [0.55, 0.6, -0.3], [0.55, 0.6, 0.3], [0.55, 0.4, 0.3]])
    vertices, faces = together(plate, (fin, [[0, 1, 2], [0, 2, 3]]))
    (fill,) = tripatch.fill_all(vertices, faces)
    x, y, z = fill.passes_through
    assert abs(x - 0.55) < 1e-9 and 0.4 <= y <= 0.6 and abs(z) < 0.3
    assert tripatch.fill(*plate).passes_through is None
    report = tmp_path / "report.json"
    path = write_obj(tmp_path / "in.obj", (vertices, faces))
    code, text, err = run(capsys, "fill", path, tmp_path / "out.obj", "--all", "--report", report)
    assert code == 3 and "passes through the mesh near (0.55, " in err
    assert json.loads(report.read_text())["holes"][0]["passes_through"] == [x, y, z]


@pytest.mark.parametrize(
    ("out", "said"),
    [
        ("-", "no suffix"),
        ("out", "no suffix"),
        ("out.step3", "cannot be written"),
        ("nowhere/out.obj", "folder"),
    ],
)
def test_where_the_result_goes_is_checked_before_the_work(out, said, tmp_path, capsys, monkeypatch):
    path = write_obj(tmp_path / "in.obj", sheet(8, 1.0, [27]))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(tripatch.files, "read", lambda path: pytest.fail("the file was read before"))
    for arguments in (["fill", path, out], ["smooth", path, out]):
        code, _, err = run(capsys, *arguments)
        assert code == 2 and said in err


@pytest.mark.parametrize("method", ["auto", "polyharmonic_spline"])
def test_a_flat_hole_of_four_corners_gets_two_triangles(method):
    vertices, faces = sheet(3, 1.0, [4])
    fill = tripatch.fill(vertices, faces, method=method)
    assert len(fill.faces) == 2 and len(fill.vertices) == 0


def test_a_hole_of_four_corners_in_a_curved_mesh_keeps_its_shape():
    vertices, faces = cube_sphere(4)
    (fill,) = tripatch.fill_all(vertices, faces[:5] + faces[6:], method="polyharmonic_spline")
    assert len(fill.vertices) > 0


def test_a_seam_is_not_said_to_bend_more_than_the_faces_do():
    coarse = types.SimpleNamespace(seam_angle_max_by_side=[0.1], continuity=["G1"], surroundings_error=55.0)
    assert "seam within 0.1° (accuracy of the mesh: 55°)" in words.filled([coarse])
    assert "seam within 0.1° (accuracy of the mesh: 33°)" in words.filled([coarse], bend=33.0)


def test_holes_that_touch_at_a_vertex_are_no_islands_of_each_other():
    """A spiral strip is cut out of a vase, three quads a row: each part touches the next at a corner."""
    n, m = 48, 80
    j, i = np.divmod(np.arange(n * (m + 1)), n)
    radius, turn = 0.6 + 0.25 * np.sin(3 * j / m), 2 * np.pi * i / n
    vertices = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), 2 * j / m - 1])
    gone = {(10 + k) * n + k // 3 for k in range(60)}
    quads = [[v, v - v % n + (v + 1) % n, v - v % n + (v + 1) % n + n, v + n] for v in range(n * m) if v not in gone]
    loops = [loop.tolist() for loop in tripatch.find_holes(quads) if len(loop) < n]
    assert len(loops) > 10
    assert not any(tripatch.borders.islands_of(vertices, quads, loops, parts=False))
