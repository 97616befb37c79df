"""Fills that pass through other faces of the mesh."""

import json

import numpy as np
import pytest
import tripatch
from test_cli import run, write_obj
from test_outer_borders import sheet, together
from tripatch import _arrays, passages

PLATE = sheet(8, 1.0, [k for k in range(64) if 2 <= k // 8 < 6 and 2 <= k % 8 < 6])
FIN = np.array([[0.55, 0.4, -0.3], [0.55, 0.6, -0.3], [0.55, 0.6, 0.35], [0.55, 0.4, 0.35]])


def test_a_fill_that_passes_through_the_mesh_is_reported_with_its_place(tmp_path, capsys):
    vertices, faces = together(PLATE, (FIN, [[0, 1, 2], [0, 2, 3]]))
    (fill,) = tripatch.fill_all(vertices, faces)
    x, y, z = fill.passes_through
    assert abs(x - 0.55) < 1e-9 and 0.4 <= y <= 0.6 and abs(z) < 0.35
    assert tripatch.fill(*PLATE).passes_through is None
    report = tmp_path / "report.json"
    path = write_obj(tmp_path / "in.obj", (vertices, faces))
    code, text, err = run(capsys, "fill", path, tmp_path / "out.obj", "--all", "--report", report)
    assert code == 3 and "passes through the mesh near (0.55, " in err
    assert json.loads(report.read_text())["holes"][0]["passes_through"] == [x, y, z]


def at_fin(place):
    return place is not None and abs(place[0] - 0.55) < 1e-9 and 0.4 <= place[1] <= 0.6 and abs(place[2]) < 0.3


@pytest.mark.parametrize("options", [{"output": "cage"}, {"surroundings": "limit", "corners": [20, 56, 60]}], ids=str)
def test_of_a_cage_its_limit_surface_is_looked_at(options):
    """The limit surface of a single quad keeps off its corners: of two fins whose cages cross the fill one passes through it."""
    hole = next(loop.tolist() for loop in tripatch.find_holes(PLATE[1]) if len(loop) == 16)
    for top, passes in ((0.35, True), (0.01, False)):
        fin = FIN.copy()
        fin[2:, 2] = top
        fill = tripatch.fill(*together(PLATE, (fin, [[0, 1, 2, 3]])), rim=hole, **options)
        assert at_fin(fill.passes_through) if passes else fill.passes_through is None
        corners = [options["corners"]] if "corners" in options else None
        given = {name: each for name, each in options.items() if name != "corners"}
        (filled,) = tripatch.fill_all(*together(PLATE, (fin, [[0, 1, 2, 3]])), [hole], corners=corners, **given)
        assert filled.passes_through == fill.passes_through


def test_what_passes_through_the_mesh_is_avoided_where_another_fill_does_not():
    """A plate under the top of a cap of a sphere: the cap goes through it, a flatter fill does not."""
    polar, angle = np.meshgrid(np.radians(np.arange(40, 141, 10)), 2 * np.pi * np.arange(24) / 24, indexing="ij")
    vertices = np.stack([np.sin(polar) * np.cos(angle), np.sin(polar) * np.sin(angle), np.cos(polar)], axis=-1).reshape(-1, 3)
    faces = [
        [24 * i + j, 24 * (i + 1) + j, 24 * (i + 1) + (j + 1) % 24, 24 * i + (j + 1) % 24] for i in range(10) for j in range(24)
    ]
    loop, top = list(range(24)), vertices[0, 2]
    tip = np.array([[0, 0.2, 0], [-0.2, -0.1, 0], [0.2, -0.1, 0]]) + [0, 0, 0.5 + top / 2]
    tip[0, 2] += 1  # from under the cap to above it
    (fill,) = tripatch.fill_all(*together((vertices, faces), (tip, [[0, 1, 2]])), [loop])
    free = tripatch.fill(vertices, faces, rim=loop)
    assert fill.passes_through is None and free.vertices[:, 2].max() > tip[1:, 2].max()
    assert tripatch.fill(*together((vertices, faces), (tip, [[0, 1, 2]])), rim=loop).passes_through is None
    asked = tripatch.fill(*together((vertices, faces), (tip, [[0, 1, 2]])), rim=loop, continuity="G1")
    assert asked.passes_through is not None


def test_fills_that_pass_through_each_other_are_reported():
    upright = PLATE[0] @ np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]]) + [0.55, 0, -0.47]
    vertices, faces = together(PLATE, (upright, PLATE[1]))
    fills = tripatch.fill_all(vertices, faces, islands="none")
    assert len(fills) == 2 and all(fill.passes_through for fill in fills)
    assert all(abs(fill.passes_through[0] - 0.55) < 1e-9 and abs(fill.passes_through[2]) < 1e-9 for fill in fills)


def test_of_many_holes_those_with_a_fin_are_found_in_any_order_of_the_faces():
    """Next to a face that has a vertex nowhere, which no fill touches."""
    cells = 12
    vertices, faces = sheet(cells, 1.0, [k for k in range(cells**2) if k // cells % 4 in (1, 2) and k % cells % 4 in (1, 2)])
    loops = [loop for loop in tripatch.find_holes(faces) if len(loop) == 8]
    middles = np.array([vertices[loop].mean(axis=0) for loop in loops])
    with_fin = [0, 4, 7]
    mesh = vertices, faces
    for middle in middles[with_fin]:
        upright = middle + 0.02 * np.array([[1, 0, -1], [-1, 0, -1], [0, 0.5, 2]])
        mesh = together(mesh, (upright, [[0, 1, 2]]))
    points, rows = together(mesh, (np.array([[0, 0, 9], [1, 0, 9], [np.nan, 0, 9]]), [[0, 1, 2]]))
    rows = [*rows[:5], rows[-1], *rows[5:-1]]
    for order in (range(len(rows)), np.random.default_rng(1).permutation(len(rows))):
        fills = tripatch.fill_all(points, [rows[k] for k in order], loops)
        assert [k for k, fill in enumerate(fills) if fill.passes_through] == with_fin
        assert all(np.linalg.norm(fills[k].passes_through - middles[k]) < 0.05 for k in with_fin)


@pytest.mark.parametrize("output", ["triangles", "cage"])
def test_fills_that_are_faces_of_the_mesh_pass_through_it_as_before(output):
    vertices, faces = together(PLATE, (FIN, [[0, 1, 2, 3]]))
    (fill,) = tripatch.fill_all(vertices, faces, output=output)
    whole = [*faces, *_arrays.index_lists(fill.faces)]
    made = np.concatenate([vertices, fill.vertices])
    made[fill.moved[0]] = fill.moved[1]
    of_face = [-1] * len(faces) + [0] * len(fill.faces)
    assert passages.of_faces(made, *_arrays.faces(whole), of_face, {} if output == "cage" else None) == [fill.passes_through]
    assert at_fin(fill.passes_through)
    without_fin = [k for k, face in enumerate(whole) if min(face) < len(PLATE[0]) or of_face[k] == 0]
    assert passages.of_faces(made, *_arrays.faces([whole[k] for k in without_fin]), [of_face[k] for k in without_fin]) == [None]


def test_the_place_does_not_depend_on_the_other_fills():
    fin = FIN @ np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]]) + [0.41, -0.19, 0]
    one = together(PLATE, (fin, [[0, 1, 2], [0, 2, 3]]))
    (alone,) = tripatch.fill_all(*one)
    for count in range(2, 6):
        first, *_ = tripatch.fill_all(*together(one, *[(PLATE[0] + [0, 0, 3 * k], PLATE[1]) for k in range(1, count)]))
        assert first.passes_through == alone.passes_through is not None


def test_in_a_window_no_vertex_is_named():
    said = tripatch.Message("fill_passes_through", {"place": "(0, 1, 2)"}, [4])
    assert str(said) == "The fill at vertex 4 passes through the mesh near (0, 1, 2)"
    assert said.worded(panel=True, vertices="unnamed") == "The fill passes through the mesh near (0, 1, 2)"
