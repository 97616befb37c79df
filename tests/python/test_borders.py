"""Borders that lie on other borders, islands in holes, and fills that pass through the mesh."""

import json
import re
import types

import numpy as np
import pytest
import tripatch
from shapes import cube, cube_sphere
from test_cli import run, write_obj
from test_outer_borders import sheet, together
from tripatch import words
from tripatch.batch import journal


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
        adjacent = {(b, a) for face in fill.faces for a, b in zip(face, [*face[1:], face[0]])} & old
        assert len(adjacent) == 24  # every edge of the rim is shared with the face beyond it


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
    assert code == 0 and text.startswith("Joined borders: 24 vertices moved\nFilled 2 holes")
    code, text, _ = run(capsys, "fill", apart, out, "--all", "--join", 1e-12)
    assert run(capsys, "fill", apart, out, "--rim", "0,1,2", "--join", 1)[0] == 2, "nothing is joined at a boundary that is named"
    assert code == 3 and text.startswith("Joined no borders: none are within 1e-12 of each other")


def test_what_was_joined_is_said_in_numbers():
    assert words.joined(1, 0) == "Joined borders: 1 vertex moved"
    assert words.joined(0, 1) == "Joined borders: 1 vertex put into an edge"
    assert words.joined(12, 3) == "Joined borders: 12 vertices moved, 3 vertices put into edges"


def test_a_slit_between_t_junctions_is_refused_and_no_hole():
    vertices, faces = sheet(2)
    vertices = np.concatenate([vertices, [[0.5, 0.25, 0]]])
    left = next(face for face in faces if {3, 4} <= set(face) and vertices[face][:, 0].mean() < 0.5)
    k = next(k for k in range(4) if {left[k], left[(k + 1) % 4]} == {3, 4})
    left.insert(k + 1, 9)
    fills = tripatch.fill_all(vertices, faces)
    assert len(fills) == 1 and isinstance(fills[0], tripatch.Refusal)
    assert fills[0].code == "slit_without_width" and fills.joined is None


def test_a_hole_with_an_unjoined_crack_is_refused_and_filled_once_it_is_joined():
    """The crack's sides have their vertices at other places: a fill through it would lie on the faces there."""
    vertices, faces = sheet(6, 6.0, [14])
    n, (end, middle) = len(vertices), (3 * 7 + 3, 3 * 7 + 4)
    vertices = np.concatenate([vertices, [vertices[end], [3, 4.4, 0]]])
    for face in faces:
        x, y = vertices[face][:, :2].mean(axis=0)
        if x == 2.5 and y in (3.5, 4.5):
            face[:] = [{end: n, middle: n + 1}.get(v, v) for v in face]
    (refusal,) = tripatch.fill_all(vertices, faces)
    assert refusal.code == "edges_on_borders" and "4 of the 8 edges" in refusal.reason
    (fill,) = tripatch.fill_all(vertices, faces, join=0.01)
    assert len(fill.rim) == 4


def box(noise=0.0):
    """A cube whose sides have rows of triangles of different sizes, so that their vertices lie within edges of other sides."""
    rng, points, faces = np.random.default_rng(0), [], []
    for side, count in enumerate((1, 2, 3, 4, 3, 5)):
        u, v = np.meshgrid(np.arange(count + 1.0), np.arange(count + 1.0), indexing="ij")
        flat = np.stack([30 * u / count, 30 * v / count, np.full(u.shape, 30.0 * (side // 3))], axis=-1).reshape(-1, 3)
        first = sum(map(len, points))
        points.append(np.roll(flat, side % 3, axis=1) + noise * rng.uniform(-1, 1, flat.shape))
        for i in range(count):
            for j in range(count):
                a = first + i * (count + 1) + j
                quad = [a, a + count + 1, a + count + 2, a + 1]
                quad = quad if side // 3 else quad[::-1]
                faces += [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]
    return np.concatenate(points), np.array(faces)


def min_height(vertices, faces):
    """Of triangles, the smallest height over the longest edge."""
    corners = np.asarray(vertices)[np.asarray(faces)]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return (area / longest).min()


@pytest.mark.parametrize("noise", [0, 2e-5])
@pytest.mark.parametrize("kind", [np.asarray, np.ndarray.tolist])
def test_join_puts_vertices_into_the_edges_that_they_lie_on(noise, kind):
    vertices, faces = box(noise)
    joined, all_faces = tripatch.fill_holes(vertices, kind(faces), join=1e-3)
    assert type(all_faces) is type(kind(faces)) and len(joined) == len(vertices)
    assert open_edges(joined, all_faces, []) == 0 and min_height(joined, all_faces) > 1
    fills = tripatch.fill_all(vertices, kind(faces), join=1e-3)
    assert fills == [] and len(fills.joined.splits) > 0
    assert np.array_equal(tripatch.merge(vertices, kind(faces), fills)[1], all_faces)


@pytest.mark.parametrize("distance", [-1.0, np.nan, np.inf])
def test_join_is_a_distance(distance, tmp_path, capsys):
    with pytest.raises(ValueError, match="join (must be 0 or more|is not finite)"):
        tripatch.fill_all(*tube(0, 1), join=distance)
    path = write_obj(tmp_path / "in.obj", tube(0, 1))
    code, _, err = run(capsys, "fill", path, tmp_path / "out.obj", "--all", f"--join={distance}")
    assert code == 2 and re.search("join (must be 0 or more|is not finite)", err)


def test_join_moves_no_vertex_that_is_in_place():
    vertices, faces = in_two_parts(*tube(0, 1), lambda p: p[2] > 0.5)
    fills = tripatch.fill_all(vertices, faces, join=1e-3)
    assert len(fills) == 2 and fills.joined is None


@pytest.mark.parametrize("noise", [0, 2e-5])
def test_a_trimesh_is_joined_with_its_colors(noise):
    trimesh = pytest.importorskip("trimesh")
    vertices, faces = box(noise)
    colors = np.random.default_rng(1).integers(0, 255, (len(faces), 4))
    mesh = trimesh.Trimesh(vertices, faces, process=False, face_colors=colors)
    joined = tripatch.fill_holes(mesh, join=1e-3)
    assert open_edges(joined.vertices, joined.faces, []) == 0 and min_height(joined.vertices, joined.faces) > 1
    middle = joined.triangles_center
    for k in range(len(joined.faces)):
        inside = [f for f in range(len(faces)) if np.abs(mesh.face_normals[f] @ (middle[k] - vertices[faces[f][0]])) < 1e-3]
        weights = [trimesh.triangles.points_to_barycentric(vertices[faces[f]][None], middle[k][None])[0] for f in inside]
        (old,) = [f for f, w in zip(inside, weights) if w.min() > 0]
        assert np.array_equal(joined.visual.face_colors[k], colors[old])


def test_a_textured_trimesh_is_joined_where_its_texture_goes_on():
    trimesh = pytest.importorskip("trimesh")
    vertices, faces = box()
    uv = vertices @ np.array([[1.0, 0.3], [0.2, 1], [0.5, 0.4]]) / 60
    mesh = trimesh.Trimesh(vertices, faces, process=False, visual=trimesh.visual.TextureVisuals(uv=uv))
    joined = tripatch.fill_holes(mesh, join=1e-3)
    assert open_edges(joined.vertices, joined.faces, []) == 0
    assert np.abs(joined.visual.uv - joined.vertices @ np.array([[1.0, 0.3], [0.2, 1], [0.5, 0.4]]) / 60).max() < 1e-6


def test_a_hole_beside_t_junctions_is_filled_as_one_of_the_joined_mesh():
    vertices, faces = box()
    gone = np.flatnonzero((vertices[faces].mean(axis=1) < [20, 20, 1]).all(axis=1) & (vertices[faces][:, :, 2] == 0).all(axis=1))
    left = np.delete(faces, gone, axis=0)
    assert len(gone) > 0
    made, all_faces = tripatch.fill_holes(vertices, left, join=1e-3)
    assert open_edges(made, all_faces, []) == 0


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".glb", ".3mf"])
def test_a_fill_in_a_joined_file_leaves_no_gap(suffix, tmp_path, capsys):
    vertices, faces = box(2e-5)
    at = vertices[faces].mean(axis=1)
    left = faces[~((at[:, 2] < 1) & (at[:, 0] < 22) & (at[:, 1] < 22))]
    assert len(left) < len(faces)
    tripatch.write(tmp_path / f"in{suffix}", (vertices, left))
    code, text, _ = run(capsys, "fill", tmp_path / f"in{suffix}", tmp_path / f"out{suffix}", "--all", "--join", 1e-3)
    mesh = tripatch.read(tmp_path / f"out{suffix}")
    assert code == 0 and "\nFilled 1 hole" in text and open_edges(mesh.vertices, mesh.faces, []) == 0


@pytest.mark.parametrize("noise", [0, 2e-5])
@pytest.mark.parametrize("suffix", [".stl", ".obj", ".ply", ".off", ".glb", ".3mf"])
def test_joined_files_have_no_slits(noise, suffix, tmp_path, capsys):
    tripatch.write(tmp_path / f"in{suffix}", box(noise))
    if suffix == ".stl":  # as text
        corners = [f"vertex {x!r} {y!r} {z!r}" for x, y, z in box(noise)[0][box(noise)[1]].reshape(-1, 3).tolist()]
        facets = [
            "\n".join(["facet normal 0 0 0", "outer loop", *corners[k : k + 3], "endloop", "endfacet"])
            for k in range(0, len(corners), 3)
        ]
        (tmp_path / "text.stl").write_text("solid\n" + "\n".join(facets) + "\nendsolid\n")
    for path in sorted(tmp_path.glob(f"*{suffix}")):
        out = tmp_path / f"out{suffix}"
        code, text, err = run(capsys, "fill", path, out, "--all", "--join", 1e-3)
        assert code == 0 and err == "" and text.endswith("\nNothing to fill: the mesh has no border\n")
        assert re.match(r"Joined borders: (\d+ vertices moved, )?\d+ vertices put into edges\n", text)
        mesh = tripatch.read(out)
        assert open_edges(mesh.vertices, mesh.faces, []) == 0
        assert suffix != ".stl" or min_height(mesh.vertices, mesh.faces) > 1


def test_joining_an_stl_file_is_undone_by_its_report(tmp_path, capsys):
    path, out, back, report = (tmp_path / name for name in ("in.stl", "out.stl", "back.stl", "r.json"))
    tripatch.write(path, box(2e-5))
    assert run(capsys, "fill", path, out, "--all", "--join", 1e-3, "--report", report)[0] == 0
    mesh, told = tripatch.read(path), json.loads(report.read_text())["joined"]
    assert told == tripatch.fill_all(mesh.vertices, mesh.faces, join=1e-3).joined.as_dict()
    assert told == tripatch.fill_holes(mesh, join=1e-3, return_report=True)[1].as_dict()["joined"]
    assert len(told["moved"]) > 0 and len(told["splits"]) > 0
    assert run(capsys, "strip", out, back, "--report", report)[0] == 0
    assert back.read_bytes() == path.read_bytes()


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
        adjacent = next(f for f, face in enumerate(faces) if f != top and set(face) & set(faces[top]))
        outside = [face for f, face in enumerate(faces) if f not in (top, adjacent)]
        parts = [(vertices, outside), (0.9 * vertices, [face[::-1] for f, face in enumerate(faces) if f != top])]
    vertices, faces = together(*parts)
    fills = tripatch.fill_all(vertices, faces)
    assert len(fills) == len(tripatch.find_holes(faces))


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


@pytest.mark.parametrize("cut", [False, True])
def test_the_lid_of_a_box_is_two_triangles(cut):
    vertices, quads = cube(1)
    faces = [t for a, b, c, d in quads[1:] for t in ([a, b, c], [a, c, d])] if cut else quads[1:]
    fill = tripatch.fill(vertices, faces)
    assert fill.faces.shape == (2, 3) and len(fill.vertices) == len(fill.normals) == 0
    assert open_edges(vertices, faces, [fill]) == 0


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


def with_doubled_faces(closed=True):
    """A tube of which one face at its upper end is there twice, its lower end closed or not."""
    vertices, faces = tube(0, 1)
    return vertices, [*faces, faces[-1]] + [list(range(24))[::-1]] * closed


def test_a_border_beside_a_doubled_face_is_refused_with_its_place():
    vertices, faces = with_doubled_faces()
    fills = tripatch.fill_all(vertices, faces)
    assert [fill.code for fill in fills] == ["border_not_closed"]
    assert sorted(fills[0].where) == list(range(96, 120)) and {fills[0].where[0], fills[0].where[-1]} == {96, 119}
    with pytest.raises(tripatch.Refusal) as refused:
        tripatch.fill(vertices, faces)
    assert refused.value.code == "border_not_closed" and refused.value.where == fills[0].where


def test_other_holes_are_filled_beside_a_border_that_does_not_close():
    fills = tripatch.fill_all(*with_doubled_faces(closed=False))
    assert [isinstance(fill, tripatch.Refusal) for fill in fills] == [False, True]


def test_the_command_says_that_a_border_does_not_close(tmp_path, capsys):
    for closed, code in ((True, 1), (False, 3)):
        mesh = write_obj(tmp_path / "in.obj", with_doubled_faces(closed))
        assert run(capsys, "fill", mesh, tmp_path / "out.obj", "--all")[0] == code
        assert run(capsys, "fill", mesh, tmp_path / "out.obj")[0] == code


def test_a_batch_says_that_a_border_does_not_close(tmp_path, capsys):
    (tmp_path / "in").mkdir()
    write_obj(tmp_path / "in" / "a.obj", with_doubled_faces(closed=False))
    assert run(capsys, "batch", tmp_path / "in", "--out", tmp_path / "out", "--quiet")[0] == 3
    lines = [json.loads(line) for line in (tmp_path / "out" / journal.LINES).read_text().splitlines()]
    assert [line["codes"] for line in lines if line["line"] == "hole" and line["status"] == "refused"] == [["border_not_closed"]]


def doubled_sheet():
    """A grid of two parts that meet along y = 4 with vertices of their own, with a hole of an odd number of edges across that."""
    numbers: dict = {}

    def number(part, x, y):
        return numbers.setdefault((part if y == 4 else 0, x, y), len(numbers))

    faces = []
    for x, y in np.ndindex(8, 8):
        if not (3 <= x < 5 and 3 <= y < 5):
            part = int(y >= 4)
            faces.append([number(part, x + i, y + j) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))])
    faces.append([number(0, 3, 3), number(0, 4, 3), number(0, 3, 4)])
    places = np.array([(x, y + 2 * (y > 4), 0.05 * x * y) for _, x, y in numbers])  # the longest edges of the hole end at y = 4
    return places, faces


@pytest.mark.parametrize("options", [{"odd": "split"}, {"cage_rim": "move"}, {"odd": "split", "cage_rim": "move"}])
def test_a_cage_across_doubled_vertices_leaves_no_gap(options):
    """Edges that are split, and vertices that move, are those of both parts."""
    vertices, faces = doubled_sheet()
    made, all_faces = tripatch.fill_holes(vertices, faces, output="cage", **options)
    places = [tuple(p) for p in np.round(made, 9).tolist()]
    count: dict = {}
    for face in all_faces:
        for a, b in zip(face, [*face[1:], face[0]], strict=True):
            edge = frozenset((places[a], places[b]))
            count[edge] = count.get(edge, 0) + 1
    assert sum(each == 1 for each in count.values()) == 32, "the outer border alone"
