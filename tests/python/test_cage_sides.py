"""Cages in holes of other than three sides."""

import numpy as np
import pytest
import tripatch
from codes import says
from scipy.spatial import Delaunay, cKDTree
from shapes import cube_sphere
from tripatch import _arrays, _native


def sectors(n, size=5, inner=2, bend=1.0):
    """n sectors of size x size quads about a pole on a paraboloid of revolution, without those within `inner` of it.

    Vertices, faces, the rim and its n corners, each with three faces.
    """
    number, places, faces = {}, [], []

    def vertex(s, i, j):
        key = (s, i, j) if i and j else (s, i) if i else ((s + 1) % n, j) if j else ()
        if key not in number:
            number[key] = len(places)
            a, b = 2 * np.pi * s / n, 2 * np.pi * (s + 1) / n
            places.append((i * np.array([np.cos(a), np.sin(a)]) + j * np.array([np.cos(b), np.sin(b)])) / size)
        return number[key]

    for s in range(n):
        for i in range(size):
            for j in range(size):
                quad = [vertex(s, i, j), vertex(s, i + 1, j), vertex(s, i + 1, j + 1), vertex(s, i, j + 1)]
                if max(i, j) >= inner:
                    faces.append(quad)
    rim, corners = [], []
    for s in range(n):
        rim += [vertex(s, inner, j) for j in range(inner)]
        corners.append(vertex(s, inner, inner))
        rim += [vertex(s, i, inner) for i in range(inner, 0, -1)]
    plane = np.array(places)
    vertices = np.column_stack([plane, 0.2 * bend * (plane**2).sum(axis=1)])
    used = sorted({v for face in faces for v in face})
    new = {v: k for k, v in enumerate(used)}
    return vertices[used], [[new[v] for v in f] for f in faces], [new[v] for v in rim], [new[v] for v in corners]


@pytest.mark.parametrize("n", [4, 5, 6, 8])
def test_a_cage_of_many_sides_goes_on_as_its_surroundings(n):
    vertices, faces, rim, corners = sectors(n)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, output="cage")
    assert len(fill.faces) == 4 * n and {len(f) for f in fill.faces} == {4}  # the quads that were there
    assert [valence for _, valence in fill.report.poles] == ([] if n == 4 else [n])
    assert fill.report.seam_angle_max < 1e-5 and fill.report.triangles_folded == fill.report.folds == 0
    assert fill.report.corners == corners and len(fill.report.seam_angle_max_by_side) == n
    at = np.bincount(np.concatenate(fill.faces), minlength=len(vertices))
    assert all(at[v] == 1 for v in corners)
    surface, _ = fill.limit(3)
    off = surface[:, 2] - 0.2 * (surface[:, :2] ** 2).sum(axis=1)
    if n == 4:  # a cubic B-spline of edges h lies h^2 / 3 of the second differences off, everywhere
        np.testing.assert_allclose(off, 0.2 * 2 * 0.2**2 / 3, atol=3e-5)
    else:
        assert np.abs(off).max() < 0.2 * 0.2**2
    # and it turns with its rim
    middle = fill.vertices[np.argmin(np.linalg.norm(fill.vertices[:, :2], axis=1))]
    assert np.linalg.norm(middle[:2]) < 1e-6
    assert fill.uv.shape == (len(fill.vertices), 2) and len(fill.rim_uv) == len(rim)


@pytest.mark.parametrize("cage_rim", ["exact", "move"])
def test_exact_leaves_the_surroundings_alone_and_a_plane_is_a_plane(cage_rim):
    for bend in (0, 1):
        vertices, faces, rim, corners = sectors(5, bend=bend)
        fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, output="cage", cage_rim=cage_rim)
        assert fill.report.triangles_folded == 0
        assert (len(fill.creases[0]) > 0) == (cage_rim == "exact") and (len(fill.moved[0]) > 0) == (cage_rim == "move")
        if cage_rim == "exact":
            assert fill.report.surroundings_moved_max < 1e-12 and fill.report.seam_angle_max < 8
        if bend == 0:
            assert np.abs(fill.vertices[:, 2]).max() < 1e-12


def grid(gone, columns=8, rows=8):
    x, y = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1))
    vertices = np.column_stack([x.ravel(), y.ravel(), (0.05 * (x - 4.0) ** 2 - 0.05 * (y - 4.0) ** 2).ravel()]).astype(float)
    quads = [
        [j * (columns + 1) + i, j * (columns + 1) + i + 1, (j + 1) * (columns + 1) + i + 1, (j + 1) * (columns + 1) + i]
        for j in range(rows)
        for i in range(columns)
    ]
    return vertices, [q for k, q in enumerate(quads) if not gone(k % columns, k // columns)], quads


def test_a_rectangle_in_a_grid_is_the_grid():
    vertices, faces, quads = grid(lambda i, j: 2 <= i < 6 and 3 <= j < 5)
    corners = [9 * 3 + 2, 9 * 3 + 6, 9 * 5 + 6, 9 * 5 + 2]
    open_hole = tripatch.fill(vertices, faces, corners=corners, output="cage")
    assert len(open_hole.faces) == 8 and open_hole.report.poles == []
    assert open_hole.report.cage_deviation_max < 1e-3
    rim = [9 * 3 + i for i in range(2, 6)] + [9 * 3 + 6, 9 * 4 + 6]
    rim += [9 * 5 + i for i in range(6, 2, -1)] + [9 * 5 + 2, 9 * 4 + 2]
    region = [k for k, q in enumerate(quads) if q not in faces]
    put_back = tripatch.fill(vertices, quads, rim=rim, corners=corners, replaced=region, output="cage")
    truth = 0.05 * (put_back.vertices[:, 0] - 4) ** 2 - 0.05 * (put_back.vertices[:, 1] - 4) ** 2
    assert np.abs(put_back.vertices[:, 2] - truth).max() < 1e-4
    assert put_back.report.surroundings_moved_max < 1e-5


@pytest.mark.parametrize("odd", ["split", "triangle"])
def test_an_odd_rim_of_many_sides(odd):
    vertices, faces, rim, corners = sectors(5)
    a, b = rim[1], rim[2]
    middle = len(vertices)
    vertices = np.vstack([vertices, vertices[[a, b]].mean(axis=0)])
    for face in faces:
        k = next((k for k in range(4) if {face[k], face[(k + 1) % len(face)]} == {a, b}), None)
        if k is not None:
            face.insert(k + 1, middle)
            break
    fill = tripatch.fill(vertices, faces, rim=[*rim[:2], middle, *rim[2:]], corners=corners, output="cage", odd=odd)
    assert sum(len(f) == 3 for f in fill.faces) == (odd == "triangle")
    assert len(fill.split_edges[0]) == (odd == "split")
    assert fill.report.triangles_folded == 0 and fill.report.seam_angle_max < 1e-3


def test_extra_rows_that_do_not_fit_are_left_out():
    # a jagged rim: rows next to it would cross each other
    rng = np.random.default_rng(3)
    plane = rng.uniform(-1, 1, (500, 2))
    vertices = np.column_stack([plane, 0.2 * (plane**2).sum(axis=1)])
    triangles = Delaunay(plane).simplices
    faces = triangles[np.linalg.norm(plane[triangles].mean(axis=1), axis=1) > 0.4].tolist()
    rim = next(hole for hole in tripatch.find_holes(faces) if np.linalg.norm(plane[hole], axis=1).max() < 0.6)
    plain = tripatch.fill(vertices, faces, rim=rim, output="cage", resolution=0)
    fill = tripatch.fill(vertices, faces, rim=rim, output="cage", resolution=3)
    assert says(fill.report, "fewer_rows") and fill.report.rows == 0
    tried = [each for each in fill.report.candidates if each.why.code == "cage_with_rows"]
    assert sorted(each.why.parameters["rows"] for each in tried) == [1, 3]
    assert all(each.status == "refused" or each.crosses or each.folds for each in tried)
    assert np.array_equal(fill.faces, plain.faces) and (fill.vertices == plain.vertices).all()


def test_rows_shape_and_several_holes():
    vertices, faces, rim, corners = sectors(5)
    rows = tripatch.fill(vertices, faces, rim=rim, corners=corners, output="cage", resolution=1)
    assert rows.report.rows == 1 and len(rows.faces) == 20 + len(rim) and rows.report.triangles_folded == 0
    plain = tripatch.fill(vertices, faces, rim=rim, corners=corners, output="cage", resolution=0)
    bulged = tripatch.fill(vertices, faces, rim=rim, corners=corners, output="cage", resolution=0, bulge=1.5)
    assert bulged.vertices[:, 2].min() < plain.vertices[:, 2].min() - 1e-3
    two = np.vstack([vertices, vertices + [9, 0, 0]])
    n = len(vertices)
    both = tripatch.fill_all(
        two,
        faces + [[v + n for v in f] for f in faces],
        [rim, [v + n for v in rim]],
        corners=[corners, [v + n for v in corners]],
        output="cage",
    )
    for fill, by in zip(both, (0, 9), strict=True):
        np.testing.assert_allclose(fill.vertices, plain.vertices + [by, 0, 0], atol=1e-9)


def open_ball(around, ring, rings=12):
    """A ball of quads and triangles about its lower pole, open above `ring`: vertices, faces."""
    polar = np.pi * np.arange(ring, rings) / rings
    turn = 2 * np.pi * np.arange(around) / around
    lines = [[(np.sin(p) * np.cos(t), np.sin(p) * np.sin(t), np.cos(p)) for t in turn] for p in polar]
    vertices = np.array([*sum(lines, []), (0, 0, -1)])
    faces = [
        [j * around + k, (j + 1) * around + k, (j + 1) * around + (k + 1) % around, j * around + (k + 1) % around]
        for j in range(len(polar) - 1)
        for k in range(around)
    ]
    last = (len(polar) - 1) * around
    return vertices, faces + [[last + k, len(vertices) - 1, last + (k + 1) % around] for k in range(around)]


@pytest.mark.parametrize("corners", [None, ()], ids=["found", "none"])
@pytest.mark.parametrize(("around", "ring"), [(8, 2), (11, 1), (16, 3), (32, 2)])
def test_a_round_rim_has_a_cage_between_four_of_its_vertices(around, ring, corners):
    vertices, faces = open_ball(around, ring)
    fill = tripatch.fill(vertices, faces, output="cage", corners=corners)
    assert len(fill.report.corners) == 4 and "no clear corners" in fill.report.method_reason
    assert fill.report.triangles_folded == fill.report.folds == 0
    surface, _ = fill.limit(2)
    radius = np.linalg.norm(surface, axis=1)  # the limit of a coarse ball is a smaller one
    assert 0.93 < radius.min() and radius.max() < 1.05
    (rim,) = tripatch.find_holes(faces)
    steps = np.sort([list(rim).index(v) for v in fill.report.corners])
    counts = np.diff([*steps, steps[0] + len(rim)])
    assert abs(counts[0] - counts[2]) <= 1 and abs(counts[1] - counts[3]) <= 1 and np.ptp(counts) <= 1


def rounded_box(cells, width):
    """A cube of 2 whose edges are bevelled that wide: so many quads a side, those in the middle large."""
    points, faces = cube_sphere(cells)
    return (1 - width) * np.sign(points) + width * points, [list(f) for f in faces]


def without_rings(vertices, faces, direction, rings):
    """The faces in so many rings about the one that is farthest in a direction taken out; they are returned too."""
    gone = {int(np.argmax([vertices[f].mean(0) @ direction for f in faces]))}
    for _ in range(rings):
        near = {v for f in gone for v in faces[f]}
        gone |= {f for f, face in enumerate(faces) if near & set(face)}
    return [face for f, face in enumerate(faces) if f not in gone], [faces[f] for f in sorted(gone)]


def farthest_off(vertices, left, gone, surface):
    """The farthest point of the limit of the faces that are gone from a surface's points, of its size."""
    truth, _ = _native._sample_limit(vertices, *_arrays.faces(left + gone), _native.Subdivision(), len(left), 3)
    return cKDTree(surface).query(truth)[0].max() / np.linalg.norm(np.ptp(truth, axis=0))


@pytest.mark.parametrize(
    ("cells", "width", "rings"), [(3, 0.05, 2), (3, 0.1, 2), (3, 0.3, 2), (3, 0.1, 1), (5, 0.1, 1), (5, 0.1, 2), (5, 0.2, 1)]
)
@pytest.mark.parametrize("direction", [(0, 0, 1), (1, 1.01, 1.02)], ids=["top", "corner"])
def test_between_bevels_a_cage_goes_on_as_the_mesh_does(cells, width, rings, direction):
    """The fairest cage went on as the narrow strips leave and became a ball: 1.9 of a box of 1 beyond its top."""
    vertices, faces = rounded_box(cells, width)
    left, gone = without_rings(vertices, faces, direction, rings)
    fill = tripatch.fill(vertices, left, output="cage")
    assert fill.report.triangles_folded == 0 and not fill.report.crosses_itself
    surface, _ = fill.limit(3)
    assert np.abs(surface).max() < 1.05
    assert farthest_off(vertices, left, gone, surface) < 0.12


@pytest.mark.parametrize(("cells", "width"), [(5, 0.2), (7, 0.2), (7, 0.3)])
def test_a_cage_between_bevels_is_flat_where_the_mesh_is(cells, width):
    """The fairest cage bulges there by a twentieth of the hole, and how the mesh continues is well known."""
    vertices, faces = rounded_box(cells, width)
    left, gone = without_rings(vertices, faces, (0, 0, 1), 1)
    fill = tripatch.fill(vertices, left, output="cage")
    assert farthest_off(vertices, left, gone, fill.limit(3)[0]) < 0.02


@pytest.mark.parametrize(("cells", "direction"), [(4, (0, 0, 1)), (5, (1, 0.2, 0.1)), (6, (1, 0.2, 0.1))])
def test_the_end_of_an_egg_goes_on_in_a_cage(cells, direction):
    """The fairest cage is blunt there, by 0.034 to 0.054 of the hole's size, and how the mesh continues is known better."""
    vertices, faces = cube_sphere(cells)
    vertices = vertices * [1, 0.7, 0.5]
    left, gone = without_rings(vertices, [list(f) for f in faces], direction, 2)
    fill = tripatch.fill(vertices, left, output="cage")
    assert farthest_off(vertices, left, gone, fill.limit(3)[0]) < 0.025


@pytest.mark.parametrize(("edges", "turned"), [(4, True), (6, False)])
def test_corners_of_faces_that_turn_back_are_told_where_the_surface_is_good(edges, turned):
    at = [(0.99, 0.38), (0.47, 0.89), (-0.39, 0.99), (-0.85, 0.52), (-0.94, -0.31), (-0.51, -0.92), (0.37, -1.01), (0.84, -0.5)]
    corners, n = np.array(at), 8 * edges
    t = np.arange(edges)[:, None] / edges
    rim = np.concatenate([corners[k] + t * (corners[(k + 1) % 8] - corners[k]) for k in range(8)])
    plane = np.concatenate([(1 + 1.5 / edges * row) * rim for row in range(5)])
    vertices = np.column_stack([plane, np.zeros(len(plane))])
    faces = [[j * n + (k + 1) % n, j * n + k, (j + 1) * n + k, (j + 1) * n + (k + 1) % n] for j in range(4) for k in range(n)]
    fill = tripatch.fill(vertices, faces, rim=np.arange(n), corners=range(0, n, edges), output="cage")
    assert fill.report.triangles_folded == 0
    moved = vertices.copy()
    moved[fill.moved[0]] = fill.moved[1]
    quads = np.concatenate([moved, fill.vertices])[np.array(fill.faces)][..., :2]
    ahead, back = (np.roll(quads, by, axis=1) - quads for by in (-1, 1))
    assert ((ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]).min() < 0) == turned
    assert says(fill.report, "cage_corner_turns_back") == turned
