"""Quads that continue from those around a hole: whatever its outline, what was there comes back."""

import numpy as np
import pytest
import tripatch
from shapes import cube_sphere


def blob(faces, count, seed, start=None):
    """A patch of so many faces, grown at random from one, that leaves a single rim which passes no vertex twice; else None."""
    rng = np.random.default_rng(seed)
    at = {(f[k], f[(k + 1) % len(f)]): i for i, f in enumerate(faces) for k in range(len(f))}
    gone = {int(rng.integers(len(faces))) if start is None else start}
    while len(gone) < count:
        f = faces[sorted(gone)[rng.integers(len(gone))]]
        k = int(rng.integers(len(f)))
        other = at.get((f[(k + 1) % len(f)], f[k]))
        if other is None:
            return None
        gone.add(other)
    border = [(a, b) for (a, b), f in at.items() if f in gone and at.get((b, a), -1) not in gone]
    following = dict(border)
    if len(following) < len(border) or any((b, a) not in at for a, b in border):
        return None
    rim = [border[0][0]]
    while following[rim[-1]] != rim[0]:
        rim.append(following[rim[-1]])
    return (sorted(gone), rim) if len(rim) == len(border) else None


def blobs(faces, count, start=None):
    return [found for seed in range(40) if (found := blob(faces, count, seed, start))]


def sheet(n=16):
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1))
    points = np.column_stack([x.ravel(), y.ravel(), 0.3 * np.sin(2 * x.ravel()) * np.cos(y.ravel())])
    w = n + 1
    return points, [[j * w + i, j * w + i + 1, (j + 1) * w + i + 1, (j + 1) * w + i] for j in range(n) for i in range(n)]


def without(vertices, faces, gone):
    """The mesh with faces taken out, and where its vertices are now."""
    left = [f for k, f in enumerate(faces) if k not in set(gone)]
    used = sorted({v for f in left for v in f})
    new = {v: k for k, v in enumerate(used)}
    return vertices[used], [[new[v] for v in f] for f in left], new


def corner_face(vertices, faces):
    return max(range(len(faces)), key=lambda f: vertices[faces[f]].mean(axis=0).sum())


@pytest.mark.parametrize("output", ["quads", "cage"])
@pytest.mark.parametrize("count", [5, 12, 25])
@pytest.mark.parametrize("pole", [False, True], ids=["grid", "round a pole"])
def test_what_was_cut_out_at_random_comes_back(output, count, pole):
    vertices, faces = cube_sphere(8) if pole else sheet()
    holes = blobs(faces, count, corner_face(vertices, faces) if pole else None)
    assert len(holes) >= 6
    same = 0
    for gone, rim in holes[:12]:
        points, left, new = without(vertices, faces, gone)
        fill = tripatch.fill(points, left, rim=[new[v] for v in rim], output=output)
        assert not fill.report.crosses_itself and fill.report.triangles_folded == 0
        same += len(fill.faces) == len(gone) and all(len(f) == 4 for f in fill.faces)
    # a convex outline is one of sides, and what lies at a pole with 1 quad on the rim is a choice
    assert same >= 0.8 * len(holes[:12])


def test_between_quads_no_triangle_is_left_where_the_rim_is_even_and_one_where_it_is_odd():
    vertices, faces = sheet()
    gone, rim = blobs(faces, 20)[0]
    points, left, new = without(vertices, faces, gone)
    rim = [new[v] for v in rim]
    even = tripatch.fill(points, left, rim=rim, output="quads")
    assert {len(f) for f in even.faces} == {4}
    middle = len(points)  # on an edge of the rim
    face = next(f for f in left if {rim[0], rim[1]} <= set(f))
    k = next(k for k in range(4) if {face[k], face[(k + 1) % 4]} == {rim[0], rim[1]})
    face.insert(k + 1, middle)
    points = np.vstack([points, points[rim[:2]].mean(axis=0)])
    odd = tripatch.fill(points, left, rim=[rim[0], middle, *rim[1:]], output="quads")
    assert sorted(len(f) for f in odd.faces)[:2] == [3, 4]


@pytest.mark.parametrize("output", ["quads", "cage"])
def test_they_hang_neither_on_numbers_nor_on_a_mirror(output):
    vertices, faces = sheet()
    gone, rim = blobs(faces, 18)[1]
    points, left, new = without(vertices, faces, gone)
    rim = [new[v] for v in rim]
    fill = tripatch.fill(points, left, rim=rim, output=output)
    order = np.random.default_rng(3).permutation(len(points))
    number = np.argsort(order)
    again = tripatch.fill(points[order], [[number[v] for v in f] for f in left[::-1]], rim=np.roll(number[rim], 5), output=output)
    mirrored = tripatch.fill(points * [-1, 1, 1], [f[::-1] for f in left], rim=rim[::-1], output=output)
    for other, sign in ((again, 1), (mirrored, -1)):
        apart = np.linalg.norm(fill.vertices[:, None] - other.vertices * [sign, 1, 1], axis=2)
        assert len(other.faces) == len(fill.faces) and apart.min(axis=1).max() < 1e-6


def test_the_deviation_of_quads_is_that_of_triangles_at_their_places():
    vertices, faces = sheet()
    gone, rim = blobs(faces, 25)[0]
    points, left, new = without(vertices, faces, gone)
    triangles, quads = (tripatch.fill(points, left, rim=[new[v] for v in rim], output=o) for o in ("triangles", "quads"))
    for v, deviation in zip(quads.vertices, quads.deviation, strict=True):
        near = np.linalg.norm(triangles.vertices - v, axis=1).argsort()[:4]
        assert 0.3 * triangles.deviation[near].min() < deviation < 3 * triangles.deviation[near].max()


@pytest.mark.parametrize(("n", "many"), [(14, False), (18, True)])
def test_a_cage_of_more_than_150_vertices_lies_at_once_where_the_mesh_goes_on(n, many):
    vertices, faces = cube_sphere(n)
    centers = np.array([vertices[f].mean(axis=0) for f in faces])
    axis = np.array([0.3, 0.2, 1.0]) / np.linalg.norm([0.3, 0.2, 1.0])
    gone = np.flatnonzero(centers @ axis > np.cos(np.radians(40)) * np.linalg.norm(centers, axis=1))
    points, left, _ = without(vertices, faces, gone)
    fill = tripatch.fill(points, left, output="cage")
    assert (len(fill.vertices) > 150) is many and all(len(face) == 4 for face in fill.faces)
    assert (fill.report.method_reason == "a cage of so many vertices lies on the surrounding surface") is many
    off = np.abs(np.linalg.norm(fill.vertices, axis=1) / np.linalg.norm(vertices[0]) - 1)
    assert off.max() < (5e-5 if many else 5e-3)
    assert fill.report.triangles_folded == 0 and not fill.report.crosses_itself


@pytest.mark.parametrize(("degrees", "on_mesh"), [(40, False), (60, True)])
def test_a_cage_lies_where_the_mesh_goes_on_unless_that_is_known_to_a_three_thousandth_of_the_hole(degrees, on_mesh):
    vertices, faces = cube_sphere(10)
    centers = np.array([vertices[f].mean(axis=0) for f in faces])
    axis = np.array([0.3, 0.2, 1.0]) / np.linalg.norm([0.3, 0.2, 1.0])
    gone = np.flatnonzero(centers @ axis > np.cos(np.radians(degrees)) * np.linalg.norm(centers, axis=1))
    points, left, _ = without(vertices, faces, gone)
    triangles = tripatch.fill(points, left, method="polyharmonic_spline")
    size = np.linalg.norm(points[triangles.rim][:, None] - points[triangles.rim], axis=2).max()
    assert bool(triangles.report.deviation_max > 3e-4 * size) is on_mesh
    cage = tripatch.fill(points, left, output="cage")
    off = np.abs(np.linalg.norm(cage.vertices, axis=1) / np.linalg.norm(vertices[0]) - 1).max()
    assert bool(off < 1e-3) is on_mesh  # on the ball as the mesh's own; the fairest cage brings its limit to it
    assert cage.report.method_reason == "the quads grow inwards from the boundary"


def test_a_large_cage_that_would_cross_itself_is_untangled():
    vertices, faces = cube_sphere(40)
    centers = np.array([vertices[f].mean(axis=0) for f in faces])
    axis = np.array([0.3, 0.2, 1.0]) / np.linalg.norm([0.3, 0.2, 1.0])
    gone = np.flatnonzero(centers @ axis > np.cos(np.radians(70)) * np.linalg.norm(centers, axis=1))
    points, left, _ = without(vertices, faces, gone)
    fill = tripatch.fill(points, left, output="cage")
    assert len(fill.vertices) > 1000 and not fill.report.crosses_itself and fill.report.triangles_folded == 0
    assert np.abs(np.linalg.norm(fill.vertices, axis=1) / np.linalg.norm(vertices[0]) - 1).max() < 2e-3


def corner_sines(points, faces):
    """Of quads, of all corners."""
    at = points[np.array(faces)]
    a, b = np.roll(at, -1, axis=1) - at, np.roll(at, 1, axis=1) - at
    turn = np.cross(a, b)
    up = turn.sum(axis=1)
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    return np.einsum("fkc,fc->fk", turn, up) / np.linalg.norm(a, axis=2) / np.linalg.norm(b, axis=2)


@pytest.mark.parametrize("number", range(6))
def test_extra_rows_are_rings_along_the_rim(number):
    vertices, faces = sheet()
    gone, rim = blobs(faces, 20)[number]
    points, left, new = without(vertices, faces, gone)
    rim = [new[v] for v in rim]
    plain, none, one, three = (
        tripatch.fill(points, left, rim=rim, output="quads", resolution=rows, method="polyharmonic_spline")
        for rows in (None, 0, 1, 3)
    )
    assert np.array_equal(none.faces, plain.faces) and (none.vertices == plain.vertices).all() and one.report.rows == 1
    assert len(one.faces) == len(plain.faces) + len(rim), "a ring more of quads"
    for fill in (one, three):
        assert {len(f) for f in fill.faces} == {4} and not fill.report.crosses_itself and not fill.report.triangles_folded
        assert corner_sines(np.vstack([points, fill.vertices]), fill.faces).min() > 0
        own = np.bincount(np.concatenate(fill.faces), minlength=len(points) + len(fill.vertices))[len(points) :]
        assert sorted(v - len(points) for v, _ in fill.report.poles) == np.flatnonzero(own != 4).tolist()
        x, y, z = fill.vertices.T
        assert np.abs(z - 0.3 * np.sin(2 * x) * np.cos(y)).max() < 2e-3


def test_rows_where_no_quads_grow_are_no_coarser_than_none():
    """Pairs of triangles are as long as the rim's edges, whatever rows are asked for."""
    vertices, faces = sheet()
    triangles = [t for a, b, c, d in faces for t in ([a, b, c], [a, c, d])]
    gone, rim = blobs(faces, 20)[0]
    points, left, new = without(vertices, triangles, [t for f in gone for t in (2 * f, 2 * f + 1)])
    rim = [new[v] for v in rim]
    point = vertices[faces[gone[0]]].mean(axis=0)  # quads that run through a point are pairs
    fills = [tripatch.fill(points, left, rim=rim, output="quads", resolution=k, through=[point]) for k in (None, 0, 2)]
    assert all([*map(list, fill.faces)] == [*map(list, fills[0].faces)] for fill in fills[1:])


def ball_with_hole(n, lobes, corner=(0.3, 0.5, 0.8)):
    """A unit ball of triangles with a jagged hole that has so many lobes: vertices and faces."""
    vertices, quads = cube_sphere(n)
    faces = [[q[a], q[b], q[c]] for q in quads for a, b, c in ((0, 1, 2), (0, 2, 3))]
    axis = np.array(corner) / np.linalg.norm(corner)
    across = np.linalg.svd(axis[None])[2][1:]
    kept = []
    for face in faces:
        middle = vertices[face].mean(axis=0)
        turn = np.arctan2(*(across @ middle))
        if np.arccos(middle @ axis / np.linalg.norm(middle)) > 0.5 + 0.15 * np.cos(lobes * turn):
            kept.append(face)
    return vertices, kept


@pytest.mark.parametrize("lobes", [0, 3, 5])
@pytest.mark.parametrize("n", [12, 20])
def test_quads_fill_a_jagged_hole_among_triangles_where_none_grow_in(n, lobes):
    vertices, faces = ball_with_hole(n, lobes)
    quads, triangles = (tripatch.fill(vertices, faces, output=output, odd="triangle") for output in ("quads", "triangles"))
    sizes = [len(face) for face in quads.faces]
    assert set(sizes) <= {3, 4} and sizes.count(3) <= max(1, 0.05 * len(sizes))
    assert quads.report.triangles_folded <= triangles.report.triangles_folded
    off = [np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max() for fill in (quads, triangles)]
    assert off[0] < 1.5 * off[1] + 1e-9
