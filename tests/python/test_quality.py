"""Curvature, seam angles, folds and stripes on surfaces where they are known; pictures from the command line."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest
import tripatch
from tripatch import __main__ as cli
from tripatch import files, quality, view

N = 24


def grid(height, n=N, twist=0.3):
    """A square from -1 to 1 with a height over every point, its points pushed off the lattice, two triangles a cell."""
    axis = np.linspace(-1, 1, n + 1)
    x, y = (a.ravel() for a in np.meshgrid(axis, axis, indexing="ij"))
    inside = (np.abs(x) < 1) & (np.abs(y) < 1)
    shift = twist / n * np.random.default_rng(7).uniform(-1, 1, (2, len(x))) * inside * (np.abs(y) > 1e-9)
    x, y = x + shift[0], y + shift[1]
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    return np.column_stack([x, y, height(x, y)]), np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def middle_row(n=N):
    """The edges along y = 0."""
    row = np.arange(n + 1) * (n + 1) + n // 2
    return np.column_stack([row[:-1], row[1:]])


def inner(vertices):
    return (np.abs(vertices[:, :2]) < 0.8).all(axis=1)


def test_curvature_of_a_ball_is_that_of_its_radius():
    vertices, triangles = grid(lambda x, y: np.sqrt(9 - x**2 - y**2))
    mean, gauss = quality.curvatures(vertices, triangles)
    assert np.abs(mean[inner(vertices)] - 1 / 3).max() < 0.02
    assert np.abs(gauss[inner(vertices)] - 1 / 9).max() < 0.02


def test_curvature_changes_its_sign_with_the_side_and_a_saddle_has_none_in_the_mean():
    vertices, triangles = grid(lambda x, y: np.sqrt(9 - x**2 - y**2))
    hollow, gauss = quality.curvatures(vertices, triangles[:, ::-1])
    assert np.abs(hollow[inner(vertices)] + 1 / 3).max() < 0.02 and gauss[inner(vertices)].min() > 0
    saddle, triangles = grid(lambda x, y: 0.1 * x * y)
    mean, gauss = quality.curvatures(saddle, triangles)
    assert np.abs(mean[inner(saddle)]).max() < 0.02 and np.abs(gauss[inner(saddle)] + 0.01).max() < 3e-3


def bevel_arcs(turn):
    """The edges of the three quarter circles in the planes of coordinates."""
    for x in range(3):
        points = np.zeros((len(turn), 3))
        points[:, (x + 1) % 3], points[:, (x + 2) % 3] = np.cos(turn), np.sin(turn)
        yield from zip(points[:-1], points[1:], strict=True)


def loop_of(edges):
    after = dict(edges)
    loop = [edges[0][0]]
    while after[loop[-1]] != loop[0]:
        loop.append(after[loop[-1]])
    return loop


def test_a_crease_has_its_angle_and_a_smooth_seam_none():
    vertices, triangles = grid(lambda x, y: np.where(y > 0, np.tan(np.radians(30)) * y, 0))
    assert quality.seam_angles(vertices, triangles, middle_row()) == pytest.approx(np.full(N, 30.0), abs=1e-6)
    for shape in (lambda x, y: 0.4 * x * x + 0.2 * x * y - 0.3 * y * y, lambda x, y: np.sqrt(4 - x**2 - y**2)):
        vertices, triangles = grid(shape)
        edges, facets = quality.edge_angles(vertices, triangles)
        along = np.isin(edges, middle_row()).all(axis=1)
        assert facets[along].max() > 1, "the triangles do turn"
        assert quality.seam_angles(vertices, triangles, middle_row()).max() < 0.1


def test_along_a_crease_that_goes_on_beyond_the_seam_the_angle_is_the_difference_to_it():
    """A part of a ridge of 60 degrees, as it is and where the middle vertex has moved down."""
    vertices, triangles = grid(lambda x, y: -np.tan(np.radians(30)) * np.abs(y))
    part = middle_row()[3:-3]
    assert quality.seam_angles(vertices, triangles, middle_row()) == pytest.approx(np.full(N, 60.0), abs=1e-6)
    assert quality.seam_angles(vertices, triangles, part).max() < 1e-6
    vertices[part[len(part) // 2][0], 2] -= 0.1
    assert quality.seam_angles(vertices, triangles, part).max() > 5


def test_a_small_angle_is_told_from_the_curvature():
    """Half a degree, where neighboring triangles turn by more."""
    vertices, triangles = grid(lambda x, y: 0.4 * y * y + np.where(y > 0, np.tan(np.radians(0.5)) * y, 0))
    assert quality.seam_angles(vertices, triangles, middle_row()) == pytest.approx(np.full(N, 0.5), abs=0.05)


@pytest.mark.parametrize("count", [4, 8])
def test_the_strips_of_a_bevel_are_tangent_to_its_corner(count):
    """Two rows of points say nothing of how a strip bends along itself, nor those of the next strip, past the corner."""
    vertices, triangles, number = [], [], {}

    def at(*point):
        key = tuple(np.round(point, 9))
        if key not in number:
            number[key] = len(vertices)
            vertices.append(point)
        return number[key]

    turn = np.pi / 2 * np.arange(count + 1) / count
    for x in range(3):  # the quarter cylinder along axis x
        y, z = (x + 1) % 3, (x + 2) % 3

        def strip_point(k, along, x=x, y=y, z=z):
            point = [0.0] * 3
            point[x], point[y], point[z] = along, np.cos(turn[k]), np.sin(turn[k])
            return at(*point)

        for k in range(count):
            a, b, c, d = strip_point(k, 0), strip_point(k + 1, 0), strip_point(k + 1, -4), strip_point(k, -4)
            triangles += [(a, c, b), (a, d, c)]
    seam = [(at(*a), at(*b)) for a, b in bevel_arcs(turn)]
    filled = tripatch.fill(np.array(vertices), triangles, rim=loop_of(seam), corners=[at(1, 0, 0), at(0, 1, 0), at(0, 0, 1)])
    assert filled.report.seam_angle_max < 0.1
    new = [tuple(face) for face in filled.faces]
    found = quality.seam_angles(np.vstack([vertices, filled.vertices]), np.array(triangles + new), np.array(seam))
    assert found.max() < 90 / count / 4, "a quarter of what the facets turn by"


def test_a_seam_angle_is_less_wrong_the_finer_the_mesh():
    """By the third power of the edges: eight times at twice as many, half of it asked for."""

    def error(n):
        vertices, triangles = grid(lambda x, y: np.cos(1.5 * x + 0.4) * np.cos(2 * y + 0.3), n, twist=0)
        return quality.seam_angles(vertices, triangles, middle_row(n)).max()

    assert error(48) < error(24) / 4


def test_a_seam_in_stairs_over_a_smooth_surface_has_no_angle():
    """Past every corner lies the other side of the seam, and little else near it."""
    n = 8
    vertices, triangles = grid(lambda x, y: 0.4 * (x * x + y * y), n, twist=0)
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    stairs = [edge for i in range(2, 6) for edge in ((at[i, i], at[i + 1, i]), (at[i + 1, i], at[i + 1, i + 1]))]
    assert quality.seam_angles(vertices, triangles, np.array(stairs)).max() < 0.5


def test_what_lies_behind_a_corner_of_a_seam_goes_along_another_side():
    vertices, triangles = grid(lambda x, y: 0 * x, 4, twist=0)
    at = np.arange(25).reshape(5, 5)
    straight = np.array([(at[i, 2], at[i + 1, 2]) for i in range(4)])
    around = quality._Around(vertices + [3, 2, 1], triangles, straight)
    assert around._turned == around._seam
    bent = np.array([(at[0, 2], at[1, 2]), (at[1, 2], at[2, 2]), (at[2, 2], at[2, 3]), (at[2, 3], at[2, 4])])
    around = quality._Around(vertices + [3, 2, 1], triangles, bent)
    assert around._turned - around._seam == {pair for pair in around.of_edge if at[2, 2] in pair} - around._seam


def test_normals_of_corners_are_those_of_vertices_but_at_sharp_edges():
    for degrees, smooth in ((20, True), (100, False)):  # half of it from the normal of the vertex
        angle = np.radians(degrees)
        vertices = np.array([(0, 0, 0), (0, 1, 0), (1, 0.5, 0), (-np.cos(angle), 0.5, np.sin(angle))])
        triangles = np.array([(0, 2, 1), (0, 1, 3)])
        corners = quality.corner_normals(vertices, triangles)
        own = quality.unit(quality.triangle_normals(vertices, triangles))
        expected = quality.vertex_normals(vertices, triangles)[triangles] if smooth else np.repeat(own[:, None], 3, axis=1)
        assert corners == pytest.approx(expected, abs=1e-12)
        assert quality.edge_angles(vertices, triangles)[1] == pytest.approx([degrees])


def test_an_edge_that_is_none_has_no_angle():
    vertices, triangles = grid(lambda x, y: 0 * x)
    assert np.isnan(quality.seam_angles(vertices, triangles, [(0, 1), (0, N * N)])).all()
    assert quality.seam_angles(vertices, triangles, np.zeros((0, 2), int)).shape == (0,)


def test_a_flap_turned_over_is_folded_and_a_roof_is_not():
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.2, 0.9, 0.05), (-1, 0, 0.8)])
    triangles = np.array([(0, 1, 2), (3, 2, 1), (0, 2, 4)])
    turned = triangles.copy()
    turned[1] = (1, 3, 2)  # lies on the first, upside down
    vertices[3] = (0.2, 0.2, 0.02)
    assert quality.folded(vertices, np.array([(0, 1, 2), (2, 1, 3), (0, 2, 4)])).tolist() == [True, True, False]
    vertices[3] = (1, 1, 0.3)
    assert not quality.folded(vertices, np.array([(0, 1, 2), (2, 1, 3), (0, 2, 4)])).any()


def test_triangles_of_mixed_faces():
    triangles, of = quality.triangulated([[0, 1, 2], [3, 4, 5, 6], [7, 8], [1, 2, 3, 4, 5]])
    assert triangles.tolist() == [[0, 1, 2], [3, 4, 5], [3, 5, 6], [1, 2, 3], [1, 3, 4], [1, 4, 5]]
    assert of.tolist() == [0, 1, 1, 3, 3, 3]
    array, _ = quality.triangulated(np.array([[3, 4, 5, 6]]))
    assert array.tolist() == [[3, 4, 5], [3, 5, 6]]


ELL = np.array([(0, 0, 0), (4, 0, 0), (4, 4, 0), (3, 4, 0), (3, 1, 0), (0, 1, 0)], float)  # an L on its side
ELL_FACE = [0, 1, 2, 3, 4, 5]


@pytest.mark.parametrize("first", range(6))
def test_triangles_of_a_concave_face_lie_in_it(first):
    face = ELL_FACE[first:] + ELL_FACE[:first]
    triangles, of = quality.triangulated([[0, 1, 5], face], ELL)
    assert of.tolist() == [0, 1, 1, 1, 1]
    assert quality.triangle_normals(ELL, triangles[1:])[:, 2].min() > 0
    assert quality.triangle_normals(ELL, triangles[1:])[:, 2].sum() == pytest.approx(2 * 7)


def test_quads_are_cut_along_the_shorter_diagonal_unless_that_lies_outside():
    kite = np.array([(0, 0, 0), (5, -1, 0), (6, 0, 0), (5, 1, 0)], float)
    triangles, _ = quality.triangulated(np.array([[0, 1, 2, 3]]), kite)
    assert sorted(map(sorted, triangles.tolist())) == [[0, 1, 3], [1, 2, 3]]
    kite[2, 0] = 4.5  # an arrow: from 1 to 3 is outside
    triangles, _ = quality.triangulated([[0, 1, 2, 3]], kite)
    assert sorted(map(sorted, triangles.tolist())) == [[0, 1, 2], [0, 2, 3]]


def test_triangles_of_odd_faces():
    with pytest.raises(ValueError, match=r"faces\[1\] names vertex 6; the mesh has 6 vertices"):
        quality.triangulated([[0, 1, 2], [0, 1, 2, 6]], ELL)
    nowhere = ELL.copy()
    nowhere[3] = np.nan
    triangles, of = quality.triangulated([ELL_FACE, [0, 1], [0, 1, 2]], nowhere)
    assert triangles[:4].tolist() == [[0, k, k + 1] for k in range(1, 5)] and of.tolist() == [0, 0, 0, 0, 2]
    for none in ([], np.zeros((0, 4), int)):
        triangles, of = quality.triangulated(none, ELL)
        assert triangles.shape == (0, 3) and of.shape == (0,)


def test_a_picture_of_a_concave_face_leaves_out_what_is_outside():
    for first in range(6):
        image, _ = view.picture(ELL, [ELL_FACE[first:] + ELL_FACE[:first]], "folds", size=(40, 40), toward=(0, 0, 1))
        seen = (image != image[0, 0]).any(axis=2)
        assert not seen[:26, :26].any() and seen[10:34, 31:34].all() and seen[31:34, 6:34].all()


def test_highlight_lines_stay_and_zebra_moves_with_the_eye():
    normals = quality.unit(np.random.default_rng(1).normal(size=(50, 3)))
    assert np.ptp(quality.stripes(normals, (0, 0, 1), 0)) == 0
    a, b = (quality.stripes(normals, (0, 0, 1), 8, quality.unit(np.array(eye, float))) for eye in ((0, 1, 0), (1, 1, 1)))
    assert np.abs(a - b).max() > 0.5
    assert quality.stripes(normals, (0, 0, 5), 8) == pytest.approx(quality.stripes(normals, (0, 0, 1), 8))
    turn = np.array([(0, 1, 0), (-1, 0, 0), (0, 0, 1.0)])  # about the direction: equal slopes stay equal
    assert quality.stripes(normals @ turn, (0, 0, 1), 8) == pytest.approx(quality.stripes(normals, (0, 0, 1), 8))


@pytest.mark.parametrize("inside_out", [False, True])
def test_a_picture_has_the_lines_of_the_side_that_is_seen(inside_out):
    tilt = quality.unit(np.array([0.3, 0.1, 1.0]))
    across = np.stack([quality.unit(np.cross(tilt, [0, 1.0, 0])), np.zeros(3)])
    across[1] = np.cross(tilt, across[0])
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) @ across
    face = [3, 2, 1, 0] if inside_out else [0, 1, 2, 3]
    image, _ = view.picture(square, [face], "highlight", size=(40, 40), toward=(0, 0, 1), direction=(1, 0, 0), lines=3)
    (stripe,) = quality.stripes(tilt[None], (1, 0, 0), 3)
    assert abs(stripe - 0.5) > 0.05  # turned over it would be another
    assert np.abs(image[20, 20] - 255 * (0.06 + 0.88 * np.clip(0.5 + 4 * (stripe - 0.5), 0, 1))).max() <= 2


def test_a_picture_has_the_normal_of_a_vertex_where_that_lies():
    hill = grid(lambda x, y: -0.35 * (x * x + y * y), 2, twist=0)  # its top in the middle
    image, _ = view.picture(*hill, "highlight", size=(60, 60), toward=(0, 0, 1), direction=(1, 0, 0), lines=4.5)
    assert image[28:32, 28:32].min() > 225  # a bright stripe, for the normal is across the direction


def test_the_brightest_light_is_as_bright_as_colors_are():
    normals = quality.unit(np.random.default_rng(3).normal(size=(5000, 3)))
    lit = view._lit(normals, np.eye(3))
    assert 0.35 <= lit.min() < 0.36 and 0.99 < lit.max() < 1.005


def read_png(path):
    """Our own unfiltered kind only."""
    data, at, body = path.read_bytes(), 8, b""
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, part = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + part)
        if kind == b"IHDR":
            assert part[8:] == bytes([8, 2, 0, 0, 0])  # eight bits of red, green and blue each
            width, height = struct.unpack(">II", part[:8])
        body += part if kind == b"IDAT" else b""
        at += 12 + length
    rows = np.frombuffer(zlib.decompress(body), np.uint8).reshape(height, 1 + 3 * width)
    assert not rows[:, 0].any()
    return rows[:, 1:].reshape(height, width, 3).astype(int)


def write(path, vertices, faces):
    text = "".join("v {!r} {!r} {!r}\n".format(*map(float, p)) for p in vertices)
    path.write_text(text + "".join("f " + " ".join(str(v + 1) for v in f) + "\n" for f in np.asarray(faces).tolist()))
    return path


def test_the_foremost_triangle_is_seen():
    vertices = np.array([(0, 0, 0), (4, 0, 0), (4, 4, 0), (0, 4, 0), (1, 1, 1), (3, 1, 1), (3, 3, 1), (1, 3, 1)], float)
    canvas = view.Canvas(vertices, (0, 0, 1), 40, 40)
    canvas.draw(np.array([(4, 5, 6), (4, 6, 7), (0, 1, 2), (0, 2, 3)]))
    seen = canvas.triangle.reshape(40, 40)
    assert set(seen[15:25, 15:25].ravel()) == {0, 1} and set(seen[4:8, 4:36].ravel()) == {2, 3} and seen[0, 0] == -1


def known(path, vertices, triangles, deviation):
    """A PLY file that says how well its vertices are known."""
    head = f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\n" + "".join(f"property float {c}\n" for c in "xyz")
    head += f"property float deviation\nelement face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [" ".join(map(str, [*p, d])) for p, d in zip(vertices, deviation(vertices), strict=True)]
    path.write_text(head + "\n".join([*rows, *(f"3 {a} {b} {c}" for a, b, c in triangles)]) + "\n")
    return path


def test_deviation_is_red_where_it_is_large_and_grey_where_nobody_knows(tmp_path, capsys):
    flat = grid(lambda x, y: 0 * x)

    def values(v):
        return np.where(v[:, 1] > 0.1, -1, np.maximum(v[:, 0], 0))

    mesh, out = known(tmp_path / "in.ply", *flat, values), tmp_path / "o.png"
    assert cli.main(["view", str(mesh), "--deviation", str(out), "--from", "0,0,1", "--size", "100,100"]) == 0
    told = capsys.readouterr().out
    assert f"Deviation up to {flat[0][:, 0].max():.3g}" in told and f"unknown at {(values(flat[0]) < 0).sum()} vertices" in told
    image = read_png(out).astype(int)
    upper, left, right = image[20, 50], image[80, 20], image[80, 90]
    assert np.ptp(upper) <= 2 and left[2] > left[0] + 40 and right[0] > right[2] + 40
    _, told = view.picture(*flat, kind="deviation", size=(20, 20), deviation=np.ones(len(flat[0])))
    assert told == "Deviation up to 1 (red from 1)"
    assert cli.main(["view", str(mesh), "--deviation", str(out), "--max", "100", "--from", "0,0,1"]) == 0
    assert "red from 100" in capsys.readouterr().out
    assert cli.main(["view", str(mesh), "--deviation", str(out), "--most", "100"]) == 0
    assert "red from 100" in capsys.readouterr().out, "the first name of --max"
    other = write(tmp_path / "in.obj", *flat)
    assert cli.main(["view", str(other), "--deviation", str(out)]) == 2
    assert "has no error estimates" in capsys.readouterr().err
    with pytest.raises(ValueError, match="deviation must have shape"):
        view.picture(*flat, kind="deviation", deviation=[1, 2])


@pytest.mark.parametrize("kind", sorted(view.KINDS))
def test_every_kind_of_picture(tmp_path, capsys, kind):
    mesh = write(tmp_path / "in.obj", *grid(lambda x, y: 0.5 * np.cos(2 * x) * np.cos(2 * y)))
    if kind == "deviation":
        mesh = known(tmp_path / "in.ply", *grid(lambda x, y: 0.5 * np.cos(2 * x) * np.cos(2 * y)), lambda v: v[:, 0] ** 2)
    assert cli.main(["view", str(mesh), f"--{kind}", str(tmp_path / "out.png"), "--size", "80,60"]) == 0
    image = read_png(tmp_path / "out.png")
    assert image.shape == (60, 80, 3)
    assert (image[0, 0] == image[-1, -1]).all() and len(np.unique(image.reshape(-1, 3), axis=0)) > 50
    assert str(tmp_path / "out.png") in capsys.readouterr().out


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".glb", ".gltf", ".3mf", ".usda"])
def test_the_stripes_of_fills_are_orange(tmp_path, capsys, suffix):
    if suffix == ".usda":
        pytest.importorskip("pxr")
    vertices, triangles = grid(lambda x, y: 0.2 * x * y)
    middle = np.linalg.norm(vertices[triangles].mean(axis=1), axis=1) < 0.3
    mesh, filled, out = write(tmp_path / "in.obj", vertices, triangles[~middle]), tmp_path / f"out{suffix}", tmp_path / "o.png"
    if suffix == ".ply":
        mesh = known(tmp_path / "in.ply", vertices, triangles[~middle], lambda v: 0 * v[:, 0])
    assert cli.main(["fill", str(mesh), str(filled), "--all"]) == 0
    assert files.read(filled).fill_faces.sum() == len(files.read(filled).faces) - (~middle).sum()
    for file, orange in ((filled, True), (mesh, False)):
        assert cli.main(["view", str(file), str(out), "--zebra", "--from", "0,0,1", "--size", "100,100", "--lines", "40"]) == 0
        image = read_png(out).astype(int)
        warm = image[:, :, 0] > image[:, :, 2] + 60
        assert warm.any() == orange and not (warm[:20].any() or warm[80:].any()), file
    capsys.readouterr()


def test_a_rim_that_is_a_crease_is_red_and_named(tmp_path, capsys):
    vertices, triangles = grid(lambda x, y: 0.3 * np.abs(y))
    mesh = write(tmp_path / "in.obj", vertices, triangles)
    row = middle_row()
    rim = ",".join(map(str, [row[0, 0], *row[:, 1]]))
    assert (
        cli.main(["view", str(mesh), "--seam", str(tmp_path / "o.png"), "--rim", rim, "--from", "0,0,1", "--size", "320,240"])
        == 0
    )
    assert f"Seam within {2 * np.degrees(np.arctan(0.3)):.3g}°" in capsys.readouterr().out
    image = read_png(tmp_path / "o.png")
    reddish = (image[:, :, 0] > 1.6 * image[:, :, 2]).sum(axis=1)
    assert reddish.argmax() == pytest.approx(image.shape[0] / 2, abs=5) and reddish.max() > 100


def test_what_cannot_be_drawn_is_said(tmp_path, capsys):
    mesh = write(tmp_path / "in.obj", *grid(lambda x, y: 0 * x, 2))
    assert cli.main(["view", str(mesh), "--seam", str(tmp_path / "o.png"), "--rim", "1,2,99"]) == 2
    assert "rim names vertex 99; the mesh has 9 vertices" in capsys.readouterr().err
    assert cli.main(["view", str(mesh), str(tmp_path / "none" / "o.png"), "--size", "40,30"]) == 2
    assert "cannot be written" in capsys.readouterr().err
    assert cli.main(["view", str(mesh), "--zebra", str(tmp_path / "o.png"), "--direction", "0,0,0"]) == 2
    bad = {"--direction=inf,0,0": "finite", "--from=nan,1,1": "finite", "--lines=nan": "finite"}
    bad |= {"--lines=0": "greater than 0, not 0", "--rim=0,2,8": "No edge of --rim lies between"}
    bad |= {"--max=nan": "is not finite", "--max=-1": "greater than 0, not -1", "--max=0": "greater than 0"}
    for option, word in bad.items():
        assert cli.main(["view", str(mesh), "--seam", str(tmp_path / "o.png"), option]) == 2
        assert word in capsys.readouterr().err
    assert not (tmp_path / "o.png").exists()
    (tmp_path / "empty.obj").write_text("v 0 0 0\n")
    assert cli.main(["view", str(tmp_path / "empty.obj"), str(tmp_path / "o.png")]) == 2


def test_the_normal_of_one_side_is_that_of_the_paraboloid_through_its_points():
    """Tilted along the edge and across it, about any axes."""
    rng = np.random.default_rng(4)
    x, y = rng.uniform(-1, 1, (2, 30))
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    along, across = turn[0], turn[1]
    normal = np.cross(along, across)
    points = np.outer(x, along) + np.outer(y, across) + np.outer(0.3 * x - 0.2 * y + 0.1 * x * y + 0.2 * x * x, normal)
    expected = normal - 0.3 * along + 0.2 * across
    found = quality._normal_at(points + [1, 2, 3], np.array([1.0, 2.0, 3.0]), along, normal)
    assert found == pytest.approx(expected / np.linalg.norm(expected), abs=1e-12)
    assert quality._normal_at(points[:5], np.zeros(3), along, normal) is normal


def test_scales_of_color_go_one_way_and_back():
    """From good to bad blue falls, red grows for three quarters, green has one hill; with signs the middle is nearly gray."""
    red, green, blue = quality.scale_colors(np.linspace(0, 2, 101), 2).T
    assert (np.diff(red)[:75] >= 0).all() and red[0] < 0.2 and red[-1] > 0.8
    assert blue[0] > 0.8 and blue[-1] < 0.2 and (np.diff(blue) <= 1e-12).all()
    hill = np.diff(green)
    assert np.count_nonzero(np.diff(np.sign(hill[np.abs(hill) > 1e-12]))) == 1
    middle = quality.signed_colors(np.array([0.0]), 1)[0]
    assert np.ptp(middle) < 0.05
    beyond, ends = np.array([-1.0, 3.0, np.nan]), np.array([0.0, 2.0, 0.0])
    assert np.array_equal(quality.scale_colors(beyond, 2), quality.scale_colors(ends, 2))
    assert np.array_equal(quality.signed_colors(2 * ends, 4), quality.signed_colors(ends, 2))
    half = quality.signed_colors(np.array([-1, -0.5, 0, 0.5, 1]), 1)
    assert len(np.unique(half, axis=0)) == 5  # it ends where it says
    shares = np.concatenate([red, green, blue, quality.FOLD_COLOR, quality.signed_colors(np.linspace(-1, 1, 9), 1).ravel()])
    assert 0 <= shares.min() and shares.max() <= 1
