"""Fills of holes that share a vertex have one tangent plane there when they are made in one call."""

import numpy as np
import pytest
import tripatch
from shapes import cube


def height(x, y):
    return 0.15 * np.sin(1.3 * x + 0.4) * np.cos(1.1 * y) + 0.05 * x * y


def lattice(n=12, spacing=0.25):
    """A wave over a lattice of triangles: vertices, faces, number of a place (i, j)."""
    index = {(i, j): k for k, (i, j) in enumerate((i, j) for i in range(-n, n + 1) for j in range(-n, n + 1) if abs(i + j) <= n)}
    x = spacing * np.array([i + j / 2 for i, j in index])
    y = spacing * np.array([j * np.sqrt(3) / 2 for _, j in index])
    faces = []
    for i, j in index:
        for three in (((i, j), (i + 1, j), (i, j + 1)), ((i + 1, j), (i + 1, j + 1), (i, j + 1))):
            if all(place in index for place in three):
                faces.append(three)
    return np.column_stack([x, y, height(x, y)]), faces, index


#: The six directions of a lattice, one after the other.
AROUND = [(1, 0), (0, 1), (-1, 1), (-1, 0), (0, -1), (1, -1)]


def sector(k, size):
    """The places of a triangle of the lattice with a corner at (0, 0), between two directions."""
    (a, b), (c, d) = AROUND[k], AROUND[(k + 1) % 6]
    return {(a * s + c * t, b * s + d * t) for s in range(size + 1) for t in range(size + 1 - s)}


def without(faces, regions):
    return [face for face in faces if not any(set(face) <= region for region in regions)]


def fan(sectors=(0, 2, 4), size=4):
    """Holes with three sides that meet at one vertex: vertices, faces, rims, vertex."""
    vertices, faces, index = lattice()
    left = [[index[p] for p in face] for face in without(faces, [sector(k, size) for k in sectors])]
    rims = [rim for rim in tripatch.find_holes(left) if len(rim) == 3 * size]
    assert len(rims) == len(sectors)
    return vertices, left, rims, index[0, 0]


def squares(size=3):
    """Two holes in a grid of quads that touch at a corner of both."""
    n = 16
    x, y = np.meshgrid(np.linspace(-2, 2, n + 1), np.linspace(-2, 2, n + 1), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), height(x, y).ravel()])
    gone = {(8 + i, 8 + j) for i in range(size) for j in range(size)}
    gone |= {(7 - i, 7 - j) for i in range(size) for j in range(size)}

    def at(i, j):
        return i * (n + 1) + j

    faces = [[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)] for i in range(n) for j in range(n) if (i, j) not in gone]
    return vertices, faces, [rim for rim in tripatch.find_holes(faces) if len(rim) < 4 * n]


def rounds():
    """Two round holes in a lattice of triangles that touch at a vertex: each a disc of three rings."""
    vertices, faces, index = lattice()

    def disc(x, y, size=3):
        return {(i, j) for i, j in index if max(abs(i - x), abs(j - y), abs(i - x + j - y)) <= size}

    left = [[index[p] for p in face] for face in without(faces, [disc(3, 0), disc(-3, 0)])]
    return vertices, left, [rim for rim in tripatch.find_holes(left) if len(rim) == 18]


def hexagons():
    """Two holes of six edges in a lattice of triangles that touch at a vertex."""
    vertices, faces, index = lattice()
    left = [[index[p] for p in face] for face in faces if not {(1, 0), (-1, 0)} & set(face)]
    return vertices, left, [rim for rim in tripatch.find_holes(left) if len(rim) == 6]


def shared(rims):
    """Vertices of two rims or more."""
    every = np.concatenate(rims)
    return [int(v) for v in np.unique(every) if (every == v).sum() > 1]


def apart(fills, vertex):
    """The largest angle, degrees, between the fills' normals at a vertex."""
    normals = np.array([f.rim_normals[list(f.rim).index(vertex)] for f in fills if vertex in f.rim])
    assert len(normals) > 1
    return max(tripatch.angles(normals, np.roll(normals, k, axis=0)).max() for k in range(1, len(normals)))


@pytest.mark.parametrize("options", [{}, {"method": "side_vertex"}, {"method": "polyharmonic_spline"}, {"output": "quads"}])
@pytest.mark.parametrize("sectors", [(0, 2, 4), (0, 3), (1, 3)])
def test_fills_around_a_vertex_have_one_tangent_plane_there(options, sectors):
    vertices, faces, rims, vertex = fan(sectors)
    fills = tripatch.fill_all(vertices, faces, rims, **options)
    assert apart(fills, vertex) < 1e-6
    for fill, rim in zip(fills, rims, strict=True):
        alone = tripatch.fill(vertices, faces, rim=rim, **options)
        assert fill.report.method == alone.report.method
        turned = tripatch.angles(*(f.rim_normals[[list(f.rim).index(vertex)]] for f in (fill, alone)))
        assert turned < max(3 * alone.report.surroundings_error, 0.05)


@pytest.mark.parametrize("options", [{}, {"method": "multi_sided"}, {"method": "polyharmonic_spline"}, {"output": "quads"}])
def test_holes_of_four_sides_that_touch_have_one_tangent_plane_there(options):
    vertices, faces, rims = squares()
    (vertex,) = shared(rims)
    assert apart(tripatch.fill_all(vertices, faces, rims, **options), vertex) < 1e-6


def test_holes_of_few_edges_that_touch_have_one_tangent_plane_there():
    vertices, faces, rims = hexagons()
    (vertex,) = shared(rims)
    fills = tripatch.fill_all(vertices, faces, rims)
    assert apart(fills, vertex) < 1e-6
    x, y, _ = vertices[vertex]
    step = 1e-6
    slope = [(height(x + step, y) - height(x - step, y)) / (2 * step), (height(x, y + step) - height(x, y - step)) / (2 * step)]
    normal = np.array([[-slope[0], -slope[1], 1]]) / np.linalg.norm([*slope, 1])
    assert tripatch.angles(fills[0].rim_normals[[list(fills[0].rim).index(vertex)]], normal)[0] < 1


def test_the_plane_does_not_depend_on_the_order_of_the_holes():
    vertices, faces, rims, vertex = fan()
    first = tripatch.fill_all(vertices, faces, rims)
    second = tripatch.fill_all(vertices, faces, [list(rim)[3:] + list(rim)[:3] for rim in rims[::-1]])[::-1]
    for a, b in zip(first, second, strict=True):
        at = [f.rim_normals[list(f.rim).index(vertex)] for f in (a, b)]
        assert tripatch.angles(at[0][None], at[1][None])[0] < 1e-6


def test_where_a_cube_is_sharp_each_fill_keeps_its_own_plane():
    vertices, faces = cube(6)
    middle = np.array([vertices[face].mean(axis=0) for face in faces])
    x, y, z = middle.T
    top = (z > 0.99) & (x > 1 / 3) & (y > 0) & (y < 2 / 3)
    front = (x > 0.99) & (z > 1 / 3) & (y < 0) & (y > -2 / 3)
    left = [face for face, gone in zip(faces, top | front, strict=True) if not gone]
    rims = tripatch.find_holes(left)
    assert len(rims) == 2 and shared(rims) == [int(np.argmin(np.linalg.norm(vertices - [1, 0, 1], axis=1)))]
    for fill, rim in zip(tripatch.fill_all(vertices, left, rims), rims, strict=True):
        alone = tripatch.fill(vertices, left, rim=rim)
        assert np.abs(fill.vertices - alone.vertices).max() < 1e-12
        assert np.abs(np.abs(fill.vertices).max(axis=1) - 1).max() < 1e-6


@pytest.mark.parametrize("method", ["auto", "polyharmonic_spline"])
def test_quads_of_a_hole_leave_the_gap_of_another_that_touches_it(method):
    """A ragged hole in a grid, at four of whose outer corners single quads are missing too: its rows continue."""
    n = 16
    x, y = np.meshgrid(np.linspace(-2, 2, n + 1), np.linspace(-2, 2, n + 1), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), height(x, y).ravel()])
    hole = {(i, j) for i in range(n) for j in range(n) if np.hypot(i - 7.5, j - 7.5) < 4}
    others = {(10, 3), (5, 3), (12, 5), (3, 5)}
    assert not hole & others
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    cells = [(i, j) for i in range(n) for j in range(n) if (i, j) not in hole | others]
    faces = [[int(at[p]) for p in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))] for i, j in cells]
    (rim,) = [rim for rim in tripatch.find_holes(faces) if 4 < len(rim) < 4 * n]
    fill = tripatch.fill(vertices, faces, rim=rim, output="quads", method=method)
    assert len(fill.faces) == len(hole)
    count = np.bincount(np.concatenate(fill.faces), minlength=len(vertices) + len(fill.vertices))
    assert (count[len(vertices) :] == 4).all()
