"""What people complain of in public, on the command line: a mesh comes in with its holes and goes out without them."""

import json

import numpy as np
import pytest
import tripatch
from shapes import cube_sphere
from test_borders import arc, box, cap_and_bowl, in_two_parts, open_edges, tube
from test_cli import run
from test_outer_borders import sheet, together


def scan():
    """A noisy closed body whose soles and crown are cut off flat, with pinholes."""
    vertices, faces = cube_sphere(16)
    vertices = vertices * [1, 0.6, 2] + np.random.default_rng(0).normal(0, 2e-4, vertices.shape)
    middle = np.array([vertices[face].mean(axis=0) for face in faces])
    gone = (middle[:, 2] > 1.85) | ((middle[:, 2] < -1.5) & (np.abs(middle[:, 0]) > 0.15))
    gone[np.random.default_rng(1).choice(np.flatnonzero(np.abs(middle[:, 2]) < 1), 20, replace=False)] = True
    return vertices, [face for face, left_out in zip(faces, gone) if not left_out]


def terrain():
    """Hills with five voids; one of them touches the outer border at a vertex."""
    voids = [(3, 3, 3, 4), (10, 4, 5, 2), (15, 14, 4, 4), (4, 15, 1, 1), (21, 11, 2, 2)]
    vertices, faces = sheet(24, 1.0, {24 * i + j for x, y, w, h in voids for i in range(x, x + w) for j in range(y, y + h)})
    triangles = [t for a, b, c, d in faces for t in ([a, b, c], [a, c, d])]
    triangles.remove([23 * 25 + 12, 24 * 25 + 13, 23 * 25 + 13])
    x, y, _ = vertices.T
    return np.column_stack([1e3 * x + 5e5, 1e3 * y + 4e6, 80 * np.sin(5 * x) * np.cos(4 * y)]), triangles


def house():
    """A gable roof of n-gons without one of its slopes."""
    vertices = np.array(
        [[0, 0, 0], [8, 0, 0], [8, 6, 0], [0, 6, 0], [0, 0, 3], [8, 0, 3], [8, 6, 3], [0, 6, 3], [0, 3, 5], [8, 3, 5.0]]
    )
    faces = [[0, 3, 2, 1], [0, 1, 5, 4], [2, 3, 7, 6], [1, 2, 6, 9, 5], [3, 0, 4, 8, 7], [8, 9, 6, 7]]
    return vertices, faces


def hose():
    """A torus with a crack, one quad wide, that ends in a round hole."""
    n, m = 96, 20
    u, v = np.meshgrid(2 * np.pi * np.arange(n) / n, 2 * np.pi * np.arange(m) / m, indexing="ij")
    vertices = np.stack([(4 + np.cos(v)) * np.cos(u), (4 + np.cos(v)) * np.sin(u), np.sin(v)], axis=-1).reshape(-1, 3)
    gone = {(i, 5) for i in range(10, 70)} | {(i, j) for i in range(70, 76) for j in range(3, 8)}
    corners = [(i, j) for i in range(n) for j in range(m) if (i, j) not in gone]
    return vertices, [[i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m] for i, j in corners]


def head():
    """A low-poly ball of triangles with a hole of ten vertices."""
    vertices, faces = cube_sphere(5)
    triangles = [t for a, b, c, d in faces for t in ([a, b, c], [a, c, d])]
    return vertices, [t for t in triangles if not ((vertices[t].mean(axis=0) @ [0.1, -0.98, 0.15]) > 0.86)]


def pipe():
    """Two pipes, between which an elbow is missing, with open ends."""
    return together(arc(0, 40), arc(70, 110))


CASES = {
    "a scan with its soles and crown cut off": (scan, [], 23),
    "a roof without a slope": (house, [], 1),
    "a crack of a hose": (hose, [], 1),
    "the bridge of a nose": (head, [], 1),
    "a pipe without its elbow": (pipe, [], 3),
    "a piece that floats in a hole": (lambda: cap_and_bowl(22, 50), [], 1),
    "two parts by material": (lambda: in_two_parts(*tube(0, 1), lambda p: p[2] > 0.5), [], 2),
    "two parts that nearly touch": (lambda: together(tube(0, 1), tube(1 + 2e-5, 2)), ["--join", 1e-3], 2),
}


@pytest.mark.parametrize("name", CASES)
def test_a_mesh_goes_out_without_holes(name, tmp_path, capsys):
    make, options, fills = CASES[name]
    tripatch.write(tmp_path / "in.obj", make())
    out, report = tmp_path / "out.obj", tmp_path / "report.json"
    code, said, err = run(capsys, "fill", tmp_path / "in.obj", "-o", out, "--all", "--report", report, *options)
    mesh, holes = tripatch.read(out), json.loads(report.read_text())["holes"]
    assert (code, len(holes)) == (0, fills), (said, err)
    assert open_edges(mesh.vertices, mesh.faces, []) == 0
    assert not any(hole["passes_through"] or hole["crosses_itself"] or hole["folds"] > hole["rim_folded"] for hole in holes)


def test_the_voids_of_a_terrain_are_filled_and_its_border_is_left(tmp_path, capsys):
    tripatch.write(tmp_path / "in.obj", terrain())
    code, said, _ = run(capsys, "fill", tmp_path / "in.obj", tmp_path / "out.obj", "--all")
    assert code == 0 and "Filled 5 holes" in said and "left open" in said
    mesh = tripatch.read(tmp_path / "out.obj")
    assert open_edges(mesh.vertices, mesh.faces, [], 1e-3) == 4 * 24


def test_flat_faces_of_a_house_stay_flat_without_a_vertex_inside(tmp_path, capsys):
    tripatch.write(tmp_path / "in.obj", house())
    assert run(capsys, "fill", tmp_path / "in.obj", tmp_path / "out.obj")[0] == 0
    mesh = tripatch.read(tmp_path / "out.obj")
    assert len(mesh.vertices) == 10 and sorted(map(len, mesh.faces[6:])) in ([3, 3], [4])


def test_slits_between_t_junctions_are_refused_by_name_and_joined_on_request(tmp_path, capsys):
    tripatch.write(tmp_path / "in.stl", box(2e-5))
    path, out = tmp_path / "in.stl", tmp_path / "out.stl"
    code, _, err = run(capsys, "fill", path, out, "--all")
    assert code in (1, 3) and "--join" in err
    assert run(capsys, "fill", path, out, "--all", "--join", 1e-3)[0] == 0
    mesh = tripatch.read(out)
    assert open_edges(mesh.vertices, mesh.faces, []) == 0


def test_a_tile_without_voids_is_copied(tmp_path, capsys):
    vertices, faces = sheet(12)
    tripatch.write(tmp_path / "in.obj", (vertices, faces))
    code, said, _ = run(capsys, "fill", tmp_path / "in.obj", tmp_path / "out.obj", "--all")
    assert code == 0 and said.startswith("Nothing to fill")
    assert (tmp_path / "out.obj").read_bytes() == (tmp_path / "in.obj").read_bytes()
