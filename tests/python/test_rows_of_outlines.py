"""Rows of quads that continue across holes of any outline, and past a pole in them."""

import numpy as np
import pytest
import tripatch
from codes import refused
from test_grown_quads import cube_sphere
from test_quad_rows import bevel, far, grid, torus, tube

OUTLINES = {  # cells (column, row) that are taken out, from (3, 3) on
    "an L": [(i, j) for i in range(5) for j in range(5) if i < 2 or j < 2],
    "a T": [(i, j) for i in range(5) for j in range(4) if j == 0 or i in (2, 3)],
    "a U": [(i, j) for i in range(5) for j in range(4) if j == 0 or i in (0, 1, 4)],
    "a cross": [(i, j) for i in range(6) for j in range(6) if i in (2, 3) or j in (2, 3)],
    "a staircase": [(i, j) for i in range(5) for j in range(5) if j - 1 <= i <= j + 1],
    "a hook one wide": [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2)],
}


def without(vertices, faces, gone):
    """Faces without some, the rim of these, and the vertices that are left without a face."""
    left = [face for k, face in enumerate(faces) if k not in gone]
    lost = np.setdiff1d([v for k in gone for v in faces[k]], [v for face in left for v in face])
    near = {v for k in gone for v in faces[k]}
    return left, next(loop for loop in tripatch.find_holes(left) if set(loop) <= near), lost


def outline(name, at, rows=12):
    columns = 10 if at is bevel else 11
    vertices, quads, _ = grid(columns, rows, at)
    gone = {(3 + i) * rows + 3 + j for i, j in OUTLINES[name]}
    return vertices, *without(vertices, quads.reshape(-1, 4).tolist(), gone)


def wavy_sum(i, j):
    """A sum of functions of the columns and of the rows, and of products of either with the other's number."""
    rng = np.random.default_rng(5)
    a, b, c, d = rng.normal(size=(4, 16, 3))
    i, j = i.astype(int), j.astype(int)
    made = 3 * np.stack([i, j, 0 * i], axis=-1) + 0.3 * (a[i] + b[j]) + 0.03 * (c[i] * j[..., None] + d[j] * i[..., None])
    return np.moveaxis(made, -1, 0)


@pytest.mark.parametrize("output", ["quads", "triangles"])
@pytest.mark.parametrize("name", OUTLINES)
def test_what_is_a_sum_along_rows_and_across_comes_back_whatever_the_outline(name, output):
    vertices, faces, rim, lost = outline(name, wavy_sum)
    fill = tripatch.fill(vertices, faces, rim=rim, method="quad_rows", output=output)
    assert len(fill.vertices) == len(lost)
    assert not len(lost) or far(fill.vertices, vertices[lost]) < 1e-9
    assert len(fill.faces) == len(OUTLINES[name]) * (1 if output == "quads" else 2)


@pytest.mark.parametrize("at", [tube, torus, bevel], ids=["tube", "torus", "bevel"])
@pytest.mark.parametrize("name", ["an L", "a T", "a U", "a cross", "a staircase"])
def test_rows_are_taken_where_they_tell_more_and_are_ten_times_nearer(name, at):
    vertices, faces, rim, lost = outline(name, at)
    fill = tripatch.fill(vertices, faces, rim=rim, output="quads")
    assert fill.report.method == "quad_rows" and {len(face) for face in fill.faces} == {4}
    spline = tripatch.fill(vertices, faces, rim=rim, output="quads", method="polyharmonic_spline")
    assert far(fill.vertices, vertices[lost]) < 0.1 * far(spline.vertices, vertices[lost])
    assert fill.report.triangles_folded == 0


def box(n, at=lambda p: p):
    """Of n x n quads a side."""
    vertices, faces = cube_sphere(n)
    vertices = vertices / np.abs(vertices).max(axis=1, keepdims=True)
    return np.array([at(p) for p in vertices]), faces


def corner_of(vertices, faces, reach):
    middles = np.array([vertices[face].mean(axis=0) for face in faces])
    return set(np.flatnonzero((middles > 1 - reach).all(axis=1) | ((middles > 1 - reach).sum(axis=1) == 3)).tolist())


def twisted(p):
    turn = 0.4 * p[2]
    return np.array(
        [np.cos(turn) * p[0] - np.sin(turn) * p[1], np.sin(turn) * p[0] + np.cos(turn) * p[1], 1.5 * p[2] + 0.2 * p[0] ** 2]
    )


@pytest.mark.parametrize("output", ["quads", "triangles"])
@pytest.mark.parametrize(("at", "within"), [(lambda p: p, 1e-9), (twisted, 0.01)], ids=["straight", "twisted"])
def test_the_corner_of_a_box_comes_back_with_its_edges(at, within, output):
    vertices, faces = box(8)
    gone = corner_of(vertices, faces, 0.8)
    vertices = np.array([at(p) for p in vertices])
    left, rim, lost = without(vertices, faces, gone)
    fill = tripatch.fill(vertices, left, rim=rim, output=output)
    assert fill.report.method == "quad_rows"
    assert len(fill.vertices) == len(lost) and far(fill.vertices, vertices[lost]) < within
    assert len(fill.report.poles) == 1 and fill.report.poles[0][1] == 3
    assert len(fill.feature_edges) == 9 and fill.report.triangles_folded == 0  # three edges of the box, three quads long


def test_creases_are_not_marked_where_that_is_not_wanted():
    vertices, faces = box(8)
    left, rim, _ = without(vertices, faces, corner_of(vertices, faces, 0.8))
    assert not len(tripatch.fill(vertices, left, rim=rim, output="quads", features=False, method="quad_rows").feature_edges)


def test_a_ball_in_rows_that_meet_at_angles_stays_round():
    """Its rim alone is met to a hundred thousandth of what the rows miss at their pole."""
    vertices, faces = cube_sphere(22)
    axis = np.array([0.3, 0.2, 1.0])
    middles = np.array([vertices[face].mean(axis=0) for face in faces])
    gone = np.flatnonzero(middles @ axis > np.cos(np.radians(40)) * np.linalg.norm(middles, axis=1) * np.linalg.norm(axis))
    left, rim, lost = without(vertices, faces, set(gone.tolist()))
    fill = tripatch.fill(vertices, left, rim=rim, output="quads")
    radius = np.linalg.norm(vertices[0])
    assert np.abs(np.linalg.norm(fill.vertices, axis=1) / radius - 1).max() < 1e-4
    rows = tripatch.fill(vertices, left, rim=rim, output="quads", method="quad_rows")
    off = np.abs(np.linalg.norm(rows.vertices, axis=1) - radius)
    assert np.sqrt((off**2).mean()) < rows.report.deviation_max, "what it says of how well it is known is so"


@pytest.mark.parametrize("noise", [0.01, 0.03])
def test_of_outlines_the_deviation_is_honest(noise):
    rng = np.random.default_rng(2)
    known = []
    for name in ("an L", "a T", "a cross"):
        vertices, faces, rim, lost = outline(name, torus)
        moved = vertices + noise * rng.normal(size=vertices.shape)
        fill = tripatch.fill(moved, faces, rim=rim, output="quads", method="quad_rows")
        apart = vertices[lost][None] - fill.vertices[:, None]
        nearest = apart[np.arange(len(apart)), np.linalg.norm(apart, axis=-1).argmin(axis=1)]
        across = np.sum(nearest * fill.normals, axis=1)
        known.append(np.sqrt((across**2).mean()) / fill.report.deviation_max)
    assert np.sqrt(np.mean(np.square(known))) < 2.5


def test_they_hang_neither_on_numbers_nor_on_place_or_a_mirror():
    vertices, faces, rim, _ = outline("a T", torus)
    fill = tripatch.fill(vertices, faces, rim=rim, output="quads")
    order = np.random.default_rng(3).permutation(len(vertices))
    number = np.argsort(order)
    again = tripatch.fill(
        3.1 * vertices[order] + 1e3,
        [[number[v] for v in face] for face in faces[::-1]],
        rim=np.roll(number[rim], 5),
        output="quads",
    )
    assert far((again.vertices - 1e3) / 3.1, fill.vertices) < 1e-9
    mirrored = tripatch.fill(vertices * [-1, 1, 1], [face[::-1] for face in faces], rim=rim[::-1], output="quads")
    assert far(mirrored.vertices * [-1, 1, 1], fill.vertices) < 1e-9


@pytest.mark.parametrize("name", ["an L", "a staircase"])
def test_of_whatever_shape_an_outline_has_the_same_faces(name):
    """Of shape keys each vertex takes the place of the same one."""
    fills = []
    for at in (torus, tube, wavy_sum):
        vertices, faces, rim, lost = outline(name, at)
        fills.append(tripatch.fill(vertices, faces, rim=rim, method="quad_rows", output="quads"))
    assert all([*map(list, fill.faces)] == [*map(list, fills[0].faces)] for fill in fills[1:])
    assert len(fills[0].vertices) == len(lost)


def test_of_a_cage_the_rows_of_its_points_go_on_past_a_pole():
    vertices, faces = box(8, twisted)
    whole, _ = box(8)
    left, rim, lost = without(vertices, faces, corner_of(whole, faces, 0.8))
    cage = tripatch.fill(vertices, left, rim=rim, output="cage")
    assert len(cage.vertices) == len(lost) and far(cage.vertices, vertices[lost]) < 0.01


def test_where_no_rows_go_on_something_else_is_made():
    vertices, faces = box(8)
    middles = np.array([vertices[face].mean(axis=0) for face in faces])
    end = set(np.flatnonzero(middles[:, 2] > 0.6).tolist())  # four poles in it
    left, rim, _ = without(vertices, faces, end)
    with refused("no_rows_of_quads"):
        tripatch.fill(vertices, left, rim=rim, output="quads", method="quad_rows")
    vertices, faces, rim, _ = outline("an L", torus)
    cut = [part for face in faces for part in ([face] if rim[3] not in face else [face[:3], [face[0], *face[2:]]])]
    for made_of, options in ((cut, {}), (faces, {"through": [vertices[rim].mean(axis=0) * 1.1]})):
        fill = tripatch.fill(vertices, made_of, rim=rim, output="quads", **options)
        assert fill.report.method != "quad_rows", options


def test_four_corners_of_a_ragged_rim_get_a_grid():
    """Sides that zigzag, among triangles: no patch lies between them, and no rows continue."""
    n = 16
    at = np.linspace(-1, 1, n + 1)
    x, y = (each.ravel() for each in np.meshgrid(at, at, indexing="ij"))
    v = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = np.stack([v[:-1, :-1], v[1:, :-1], v[1:, 1:], v[:-1, 1:]], axis=-1)
    gone = np.zeros((n, n), bool)
    gone[4:12, 4:12] = True
    faces = [t for q in quads[~gone] for t in ([q[0], q[1], q[2]], [q[0], q[2], q[3]])]
    ragged = 0.6 * 2 / n * (-1.0) ** np.arange(5, 12)
    y[v[5:12, 4]] -= ragged
    y[v[5:12, 12]] += ragged
    x[v[4, 5:12]] -= ragged
    x[v[12, 5:12]] += ragged
    vertices = np.column_stack([x, y, 0.3 * x * x - 0.2 * y * y])
    (rim,) = [loop for loop in tripatch.find_holes(faces) if len(loop) != 4 * n]
    corners = [int(v[i, j]) for i, j in ((4, 4), (12, 4), (12, 12), (4, 12))]
    fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, output="quads")
    assert {len(face) for face in fill.faces} == {4}
    assert len(fill.faces) == 8 * 8
    count = np.bincount(np.concatenate(fill.faces), minlength=len(vertices) + len(fill.vertices))
    assert (count[len(vertices) :] == 4).all()
    assert (count[corners] == 1).all()


@pytest.mark.parametrize("seed", [5, 9, 10])
def test_a_very_ragged_rim_among_triangles_gets_quads(seed):
    n = 24
    at = np.linspace(-1, 1, n + 1)
    x, y = (each.ravel() for each in np.meshgrid(at, at, indexing="ij"))
    v = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = np.stack([v[:-1, :-1], v[1:, :-1], v[1:, 1:], v[:-1, 1:]], axis=-1).reshape(-1, 4)
    vertices = np.column_stack([x, y, 0.2 * x * x - 0.1 * y * y])
    middle = vertices[quads].mean(axis=1)
    within = 0.42 + 0.25 * np.random.default_rng(seed).random(len(quads))
    left = quads[np.hypot(middle[:, 0], middle[:, 1]) >= within]
    faces = [t for q in left.tolist() for t in (q[:3], [q[0], q[2], q[3]])]
    rim = max((loop for loop in tripatch.find_holes(faces) if len(loop) != 4 * n), key=len)
    fill = tripatch.fill(vertices, faces, rim=rim, output="quads")
    assert sum(len(face) == 3 for face in fill.faces) <= 0.05 * len(fill.faces)
