"""Creases that cross a hole: boxes, cylinders, corners, their meshes jittered; what is smooth or only noisy has none."""

import numpy as np
import pytest
import tripatch
from test_any_rim import hill, inner_rim, irregular


def creased(lift, n=20, seed=0, noise=0.0, rows=(0.0,), radius=0.45):
    """A jittered grid of triangles over [-1.2, 1.2]^2 with some rows kept straight, a disc of it taken out, lifted into space."""
    rng = np.random.default_rng(seed)
    grid = np.linspace(-1.2, 1.2, n + 1)
    x, y = np.meshgrid(grid, grid, indexing="ij")
    step = grid[1] - grid[0]
    points = np.column_stack([x.ravel(), y.ravel()])
    jitter = rng.uniform(-0.3, 0.3, points.shape) * step
    for row in rows:
        jitter[np.abs(points[:, 1] - row) < 1e-9, 1] = 0
    points += jitter
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = (q.ravel() for q in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    turn = (rng.random(len(a)) < 0.5)[:, None]
    first = np.where(turn, np.column_stack([a, b, c]), np.column_stack([a, b, d]))
    faces = np.vstack([first, np.where(turn, np.column_stack([a, c, d]), np.column_stack([b, c, d]))])
    faces = faces[np.linalg.norm(points[faces].mean(axis=1), axis=1) > radius]
    vertices = lift(*points.T)
    return vertices + noise * step * rng.normal(size=vertices.shape), faces.tolist()


def roof(degrees):
    """Two half planes, and the distance from them."""
    angle = np.radians(degrees)
    along, normal = np.array([0, np.cos(angle), -np.sin(angle)]), np.array([0, np.sin(angle), np.cos(angle)])

    def distance(p):
        to_edge = np.hypot(p[:, 1], p[:, 2])
        first = np.where(p[:, 1] <= 1e-9, np.abs(p[:, 2]), to_edge)
        return np.minimum(first, np.where(p @ along >= -1e-9, np.abs(p @ normal), to_edge))

    return (
        lambda x, y: np.outer(x, [1, 0, 0]) + np.outer(np.minimum(y, 0), [0, 1, 0]) + np.outer(np.maximum(y, 0), along),
        distance,
    )


def cylinder_top(radius):
    """The flat end of a cylinder and its side: the crease is a circle."""

    def lift(x, y):
        r = radius + np.minimum(y, 0)
        return np.column_stack([r * np.cos(x / radius), r * np.sin(x / radius), -np.maximum(y, 0)])

    def distance(p):
        r = np.hypot(p[:, 0], p[:, 1])
        return np.minimum(np.hypot(np.maximum(r - radius, 0), p[:, 2]), np.hypot(r - radius, np.maximum(p[:, 2], 0)))

    return lift, distance


def two_cylinders(other):
    """Of radius 1 and another, their axes at right angles; the mesh follows the curve in which they meet."""

    def lift(x, y):
        along = 0.55 + 0.2 * x
        across = np.sqrt(other**2 - 1 + along**2) + 0.2 * y
        return np.column_stack([along, across, np.sqrt(np.maximum(1 - along**2, other**2 - across**2))])

    return lift, lambda p: np.minimum(np.abs(np.hypot(p[:, 0], p[:, 2]) - 1), np.abs(np.hypot(p[:, 1], p[:, 2]) - other))


def distances(fill, vertices, distance):
    """Of the new vertices and of the middles of the crease's edges, over the hole's diameter."""
    rim = vertices[fill.rim]
    diameter = np.linalg.norm(rim[:, None] - rim[None], axis=2).max()
    everything = np.vstack([vertices, fill.vertices])
    return distance(fill.vertices) / diameter, distance(everything[fill.feature_edges].mean(axis=1)) / diameter


SOLIDS = [(roof(90), 1e-9), (roof(40), 1e-9), (cylinder_top(1.0), 1e-3), (two_cylinders(1.0), 1e-3), (two_cylinders(1.4), 1e-3)]


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize(("solid", "bound"), SOLIDS, ids=["box", "blunt", "cylinder's end", "pipes", "pipe in pipe"])
def test_a_crease_goes_on_across_a_jagged_hole(solid, bound, seed):
    lift, distance = solid
    vertices, faces = creased(lift, seed=seed)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces))
    of_vertices, of_crease = distances(fill, vertices, distance)
    assert fill.report.method == "polyharmonic_spline"
    assert "crease" in fill.report.method_reason
    assert len(fill.feature_edges) > 3
    assert of_vertices.max() < bound
    assert of_crease.max() < max(bound, 5e-3)  # chords of a curve
    assert fill.report.triangles_folded == 0


@pytest.mark.parametrize("degrees", [125, 140])
def test_an_edge_sharper_than_a_fold_goes_on_and_is_counted_as_the_rim_s_own(degrees):
    lift, distance = roof(degrees)
    vertices, faces = creased(lift)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces))
    assert distances(fill, vertices, distance)[0].max() < 1e-9
    assert fill.report.triangles_folded == fill.report.rim_folded == len(fill.feature_edges) > 3


@pytest.mark.parametrize("seed", [41, 44, 45])
def test_a_crease_that_gets_blunt_goes_on_all_the_same(seed):
    """Where two pipes meet, from 60 degrees on one side of a large hole to 34 and less on the other."""
    lift, distance = two_cylinders(1.0)
    vertices, faces = creased(lift, seed=seed, radius=0.7)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces))
    assert len(fill.feature_edges) > 3
    assert distances(fill, vertices, distance)[0].max() < 1e-3


def test_the_edges_of_the_crease_are_a_path_in_the_fill_between_two_rim_vertices():
    vertices, faces = creased(roof(90)[0])
    rim = inner_rim(faces)
    fill = tripatch.fill(vertices, faces, rim=rim)
    edges = {frozenset((a, b)) for f in fill.faces for a, b in zip(f, np.roll(f, -1), strict=True)}
    path = fill.feature_edges.tolist()
    assert all(frozenset(edge) in edges for edge in path)
    assert all(a[1] == b[0] for a, b in zip(path, path[1:], strict=False))
    assert {path[0][0], path[-1][1]} <= set(rim)
    assert not {v for _, v in path[:-1]} & set(rim)


def test_quads_do_not_bridge_a_crease():
    vertices, faces = creased(roof(30)[0])
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces), output="quads")
    edges = {frozenset((a, b)) for f in fill.faces for a, b in zip(f, np.roll(f, -1), strict=True)}
    assert any(len(f) == 4 for f in fill.faces)
    assert all(frozenset(edge) in edges for edge in fill.feature_edges.tolist())


def test_without_features_the_edge_is_rounded_off():
    lift, distance = roof(90)
    vertices, faces = creased(lift)
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces), features=False)
    assert len(fill.feature_edges) == 0
    assert distances(fill, vertices, distance)[0].max() > 1e-2


def test_two_parallel_edges_of_a_bar():
    def lift(x, y):
        return np.column_stack([x, np.clip(y, -0.24, 0.24), -np.maximum(np.abs(y) - 0.24, 0)])

    def distance(p):
        top = np.where(np.abs(p[:, 1]) <= 0.24 + 1e-9, np.abs(p[:, 2]), 9)
        return np.minimum(top, np.where(p[:, 2] <= 1e-9, np.abs(np.abs(p[:, 1]) - 0.24), 9))

    vertices, faces = creased(lift, rows=(-0.24, 0.24))
    fill = tripatch.fill(vertices, faces, rim=inner_rim(faces))
    of_vertices, of_crease = distances(fill, vertices, distance)
    assert of_vertices.max() < 1e-9
    assert of_crease.max() < 1e-9


def corner(n=10, seed=0, radius=0.55):
    """Three faces of a box, jittered in themselves, without what is near their corner."""
    rng = np.random.default_rng(seed)
    step, number, points, faces = 1.2 / n, {}, [], []
    for u, v in ((0, 1), (1, 2), (2, 0)):
        at = np.empty((n + 1, n + 1), int)
        for i in range(n + 1):
            for j in range(n + 1):
                key = [0, 0, 0]
                key[u], key[v] = i, j
                if tuple(key) not in number:
                    number[tuple(key)] = len(points)
                    points.append([-step * (k + (rng.uniform(-0.3, 0.3) if k else 0)) for k in key])
                at[i, j] = number[tuple(key)]
        for i in range(n):
            for j in range(n):
                a, b, c, d = at[i, j], at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]
                faces += [[a, b, c], [a, c, d]] if rng.random() < 0.5 else [[a, b, d], [b, c, d]]
    points, faces = np.array(points), np.array(faces)
    return points, faces[np.linalg.norm(points[faces].mean(axis=1), axis=1) > radius].tolist()


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_three_creases_meet_at_the_corner_of_a_box(seed):
    vertices, faces = corner(seed=seed)
    rim = min(tripatch.find_holes(faces), key=len)
    fill = tripatch.fill(vertices, faces, rim=rim)
    assert np.abs(fill.vertices.max(axis=1)).max() < 1e-9
    assert np.linalg.norm(fill.vertices, axis=1).min() < 1e-9  # the corner itself


def test_smooth_and_noisy_meshes_have_no_crease():
    for noise in (0, 0.02, 0.1):
        vertices, faces = irregular(hill, noise=noise)
        rim = inner_rim(faces)
        fill = tripatch.fill(vertices, faces, rim=rim)
        assert len(fill.feature_edges) == 0
        np.testing.assert_array_equal(fill.vertices, tripatch.fill(vertices, faces, rim=rim, features=False).vertices)


def test_the_surface_of_all_parts_is_one_patch():
    """Over places of the plane that fill.uv gives, with derivatives that agree with differences."""
    for lift, _ in (roof(90), cylinder_top(1.0)):
        vertices, faces = creased(lift)
        fill = tripatch.fill(vertices, faces, rim=inner_rim(faces))
        inner = slice(len(fill.feature_edges) - 1, None)  # those on the crease are the curve's
        at = fill.uv[inner]
        np.testing.assert_allclose(fill.patch.evaluate(at), fill.vertices[inner], atol=1e-9)
        step = 1e-5
        _, slopes, second = fill.patch.evaluate(at, 2)
        for axis in (0, 1):
            way = step * np.eye(2)[axis]
            ahead, behind = fill.patch.evaluate(at + way, 1), fill.patch.evaluate(at - way, 1)
            np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * step), slopes[:, axis], atol=1e-6)
            np.testing.assert_allclose((ahead[1][:, 0] - behind[1][:, 0]) / (2 * step), second[:, axis], atol=1e-3)


@pytest.mark.parametrize("short", [0.3, 1e-2, 1e-4])
def test_a_crease_has_no_more_edges_than_the_rim_however_short_those_at_its_ends_are(short):
    """It had up to two thousand, and the parts next to it tens of thousands of triangles: most of a minute."""
    vertices, faces = creased(roof(60)[0])
    rim = inner_rim(faces)
    ends = [v for v in rim if abs(vertices[v, 1]) < 1e-9 and abs(vertices[v, 2]) < 1e-9]
    assert len(ends) == 2
    for end in ends:
        for a, b in list(zip(rim, np.roll(rim, -1), strict=True)):
            if end not in (a, b):
                continue
            other = b if a == end else a
            vertices = np.vstack([vertices, vertices[end] + short * (vertices[other] - vertices[end])])
            for face in faces:
                for k in range(len(face)):
                    if {face[k - 1], face[k]} == {a, b}:
                        face.insert(k, len(vertices) - 1)
                        break
    rim = inner_rim(faces)
    fill = tripatch.fill(vertices, faces, rim=rim)
    assert 0 < len(fill.feature_edges) <= len(rim)
    assert len(fill.faces) < len(rim) ** 2


@pytest.mark.parametrize("cuts", [1, 2, 4])
def test_a_box_that_has_lost_a_wall_and_what_is_beside_it_is_closed(cuts):
    """Loop cuts in Blender's cube, its upper wall deleted with the upper part of two others: what is left tells all of it."""
    n = cuts + 1
    vertices, faces = box(n)
    middles = np.array([vertices[face].mean(axis=0) for face in faces])
    gone = (middles[:, 2] > 0.99) | ((middles[:, :2].max(axis=1) > 0.99) & (middles[:, 2] > 1 - 2 / n))
    left = [face for face, lost in zip(faces, gone, strict=True) if not lost]
    (fill,) = tripatch.fill_all(vertices, left)
    assert "walls" in fill.report.method_reason and fill.report.warnings == []
    assert np.abs(np.abs(fill.vertices).max(axis=1) - 1).max() < 1e-12
    assert np.abs(fill.vertices - 1).max(axis=1).min() < 1e-12  # the corner is there
    (rounded,) = tripatch.fill_all(vertices, left, features=False)
    assert np.abs(np.vstack([vertices[np.unique(left)], rounded.vertices]) - 1).max(axis=1).min() > 0.05


def box(n):
    """The cube from -1 to 1 with n x n quads a face, vertices shared."""
    grid = np.linspace(-1, 1, n + 1)
    points, faces = [], []
    for axis in range(3):
        for side in (-1, 1):
            u, v = np.meshgrid(grid, grid, indexing="ij")
            own = np.stack([np.full_like(u, side), u, v], axis=-1).reshape(-1, 3)
            at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1) + sum(map(len, points))
            points.append(np.roll(own, axis, axis=1))
            quads = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], axis=-1).reshape(-1, 4)
            faces.append(quads if side > 0 else quads[:, ::-1])
    vertices, number = np.unique(np.round(np.concatenate(points), 12), axis=0, return_inverse=True)
    return vertices, number.ravel()[np.concatenate(faces)].tolist()


def half_cylinder(cut):
    """Triangles around the corner (1, 0, 1) of a half cylinder: its round wall, its flat side and its end."""
    number, faces, steps = {}, [], np.linspace(0, 1, cut + 1)
    walls = [
        lambda s, a: (np.cos(a), np.sin(a), 1 - s),
        lambda t, s: (1 - t, 0, 1 - s),
        lambda a, t: ((1 - t) * np.cos(a), (1 - t) * np.sin(a), 1),
    ]
    for wall in walls:
        for i in range(cut):
            for j in range(cut):
                at = [wall(steps[i + di], steps[j + dj]) for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1))]
                a, b, c, d = (number.setdefault(tuple(np.round(p, 9)), len(number)) for p in at)
                two = [[a, b, c], [a, c, d]] if (i + j) % 2 else [[a, b, d], [b, c, d]]
                faces += [t for t in two if len(set(t)) == 3]
    return np.array(list(number)), np.array(faces)


def corner_filled(cut, radius):
    """Of new vertices: which are on creases, and how far off each of the three walls all are, over the size of the hole."""
    vertices, faces = half_cylinder(cut)
    corner, size = np.array([1, 0, 1]), radius / 6
    left = faces[np.linalg.norm(vertices[faces].mean(axis=1) - corner, axis=1) > size / 2]
    (rim,) = (rim for rim in tripatch.find_holes(left) if np.linalg.norm(vertices[rim] - corner, axis=1).max() < size)
    fill = tripatch.fill(vertices, left, rim=rim)
    off = np.abs(np.column_stack([np.hypot(*fill.vertices[:, :2].T) - 1, fill.vertices[:, 1], fill.vertices[:, 2] - 1]))
    return np.unique(fill.feature_edges[fill.feature_edges >= len(vertices)]) - len(vertices), off / size


@pytest.mark.parametrize("radius", [1.5, 2.5, 3.5])
def test_a_round_wall_and_two_flat_ones_meet_in_a_corner_inside_the_hole(radius):
    _, off = corner_filled(12, radius)
    assert off.min(axis=1).max() < 2e-3
    assert np.linalg.norm(off, axis=1).min() < 1e-3


@pytest.mark.parametrize("radius", [1.5, 2.5])
def test_a_round_wall_and_a_flat_one_meet_in_an_arc_not_in_its_chords(radius):
    on_creases, off = corner_filled(40, radius)
    arc = off[on_creases]
    arc = arc[(arc[:, 2] < 1e-6) & (arc[:, 1] > 1e-3)]
    assert len(arc) > 3
    assert arc[:, 0].max() < 1e-6
