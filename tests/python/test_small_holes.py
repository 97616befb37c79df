"""Holes of few edges, which meshes made by programs have by the thousand, are closed without a patch."""

import numpy as np
import pytest
import tripatch

HEIGHT = 3


def surface(x, y):
    return HEIGHT * np.sin(0.11 * x) * np.cos(0.13 * y)


def perforated(seed, height=surface, noise=0.0, n=29):
    """An irregular sheet over the plane with sixteen holes of 3 to 8 edges."""
    rng = np.random.default_rng(seed)
    j, i = np.divmod(np.arange(n * n), n)
    x, y = i + rng.uniform(-0.25, 0.25, n * n), j + rng.uniform(-0.25, 0.25, n * n)
    vertices = np.column_stack([x, y, height(x, y) + noise * rng.normal(size=n * n)])
    faces = []
    for q in range(n - 1):
        for p in range(n - 1):
            a, b, c, d = q * n + p, q * n + p + 1, q * n + n + p + 1, q * n + n + p
            faces += [[a, b, d], [b, c, d]] if rng.random() < 0.5 else [[a, b, c], [a, c, d]]
    removed = set()
    for k, (p, q) in enumerate((p, q) for p in range(5, n - 5, 6) for q in range(5, n - 5, 6)):
        first = 2 * (q * (n - 1) + p)
        if k % 2:
            removed |= {f for f, face in enumerate(faces) if q * n + p in face}
        else:
            removed |= set(range(first, first + 1 + k // 2 % 4))
    return vertices, [face for f, face in enumerate(faces) if f not in removed]


def fills_of(vertices, faces):
    return tripatch.fill_all(vertices, faces, [loop for loop in tripatch.find_holes(faces) if len(loop) <= 8])


def test_the_mesh_is_closed_and_stays_a_manifold():
    vertices, faces = perforated(1)
    fills = fills_of(vertices, faces)
    assert {len(fill.rim) for fill in fills} >= {3, 4, 5, 6}
    closed = tripatch.merge(vertices, faces, fills)[1]
    directed = [(a, b) for face in closed for a, b in zip(face, [*face[1:], face[0]], strict=True)]
    assert len(set(directed)) == len(directed)
    assert [len(loop) for loop in tripatch.find_holes(closed)] == [4 * 28]


def test_new_vertices_are_as_near_as_those_of_a_fill_with_a_patch():
    own, other = [], []
    for seed in range(8):
        vertices, faces = perforated(seed, noise=0.02)
        for fill in fills_of(vertices, faces):
            if fill.patch is not None or len(fill.vertices) == 0:
                continue
            large = tripatch.fill(vertices, faces, rim=fill.rim, resolution=3, method="polyharmonic_spline")
            for one, found in ((fill, own), (large, other)):
                found += list(np.abs(one.vertices[:, 2] - surface(*one.vertices[:, :2].T)))
    assert len(own) > 15
    assert np.sqrt(np.mean(np.square(own))) < 1.5 * np.sqrt(np.mean(np.square(other)))


def test_errors_are_as_large_as_is_said():
    ratios = []
    for seed in range(20):
        for fill in fills_of(*perforated(seed, noise=0.02)):
            if fill.patch is None and len(fill.vertices):
                ratios += list(np.abs(fill.vertices[:, 2] - surface(*fill.vertices[:, :2].T)) / fill.deviation)
    assert len(ratios) > 40
    assert 0.5 < np.sqrt(np.mean(np.square(ratios))) < 2


def test_a_plane_is_kept_and_no_vertex_is_wasted_on_a_square():
    vertices, faces = perforated(0, height=lambda x, y: 0.2 * x - 0.1 * y)
    for fill in fills_of(vertices, faces):
        assert np.abs(fill.vertices[:, 2] - 0.2 * fill.vertices[:, 0] + 0.1 * fill.vertices[:, 1]).max(initial=0) < 1e-12
        assert len(fill.rim) > 4 or (len(fill.vertices) == 0 and len(fill.faces) == len(fill.rim) - 2)


def test_numbering_changes_nothing():
    vertices, faces = perforated(3)
    order = np.random.default_rng(0).permutation(len(vertices))
    where = np.argsort(order)
    other = [[int(where[v]) for v in face] for face in faces]
    for fill in fills_of(vertices, faces):
        again = tripatch.fill(vertices[order], other, rim=[int(where[v]) for v in fill.rim])
        assert len(again.vertices) == len(fill.vertices)
        for place in fill.vertices:
            assert np.linalg.norm(again.vertices - place, axis=1).min() < 1e-9


def test_a_ridge_goes_on_through_the_hole():
    n = 23
    j, i = np.divmod(np.arange(n * n), n)
    vertices = np.column_stack([i, j, -np.abs(i - 11.0)])
    faces = [[v, v + 1, v + n + 1, v + n] for v in range(n * n) if v % n < n - 1 and v < n * (n - 1)]
    left = [face for face in faces if 11 * n + 11 not in face]
    fill = tripatch.fill(vertices, left)
    assert len(fill.feature_edges) or np.abs(fill.vertices[:, 2] + np.abs(fill.vertices[:, 0] - 11)).max() < 1e-9
    assert len(fill.rim) == 8


def test_one_triangle_closes_three_edges():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 1.0]])
    fill = tripatch.fill(vertices, [[0, 1, 3], [1, 2, 3], [2, 0, 3]], rim=[0, 1, 2])
    assert [set(face) for face in fill.faces] == [{0, 1, 2}]
    assert len(fill.vertices) == 0 and fill.patch is None


@pytest.mark.parametrize(("width", "is_small"), [(0.27, True), (0.31, False)])
def test_a_needle_nearby_is_no_crease_however_it_is_turned(width, is_small):
    n = 10
    vertices = np.array([[i, j, 0.0] for j in range(n) for i in range(n)])
    quads = [(j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i) for i in range(n - 1) for j in range(n - 1)]
    faces = [three for a, b, c, d in quads if a != 4 * n + 4 for three in ([a, b, c], [a, c, d])]
    vertices[7 * n + 4] = [
        3.6,
        6 + width,
        width * np.tan(np.radians(30)),
    ]  # over the edge from (3, 6)
    fill = tripatch.fill(vertices, faces, rim=[4 * n + 4, 4 * n + 5, 5 * n + 5, 5 * n + 4])
    assert (fill.patch is None) == is_small


def test_options_that_exclude_each_other_are_refused_where_nothing_is_shaped():
    vertices = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5]]
    with pytest.raises(ValueError, match="center_offset"):
        tripatch.fill(vertices, faces, center=(1, 1, 1), center_offset=0.1)
