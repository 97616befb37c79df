"""The corners that a rim has, asked for without filling it."""

import numpy as np
import pytest
import tripatch
from codes import refused
from shapes import corner_removed, cube_sphere
from tripatch import _arrays, _native


def sheet():
    """A triangular lattice of 8 edges a side, bent a little, and which of its triangles lie in one of 3 edges a side."""
    number = {(i, j): k for k, (i, j) in enumerate((i, j) for j in range(9) for i in range(9 - j))}
    x, y = np.array([(i + j / 2, j * np.sqrt(3) / 2) for i, j in number]).T
    faces, inside = [], []
    for i, j in number:
        for face in ([(i, j), (i + 1, j), (i, j + 1)], [(i + 1, j), (i + 1, j + 1), (i, j + 1)]):
            if all(corner in number for corner in face):
                inside.append(all(a >= 2 and b >= 2 and a + b <= 7 for a, b in face))
                faces.append([number[corner] for corner in face])
    corners = {number[2, 2], number[5, 2], number[2, 5]}
    return np.column_stack([x, y, 0.02 * x * y]), faces, np.array(inside), corners


def test_corners_are_those_of_the_fill_in_the_direction_of_new_faces():
    vertices, faces, inside, expected = sheet()
    faces = [f for f, cut in zip(faces, inside, strict=True) if not cut]
    rim = tripatch.find_holes(faces)[0]
    corners = tripatch.find_corners(vertices, faces, rim[::-1])
    assert set(corners.tolist()) == expected
    places = [rim.tolist().index(v) for v in corners]
    assert [(b - a) % 9 for a, b in zip(places, places[1:] + places[:1], strict=True)] == [3, 3, 3]
    assert list(tripatch.fill(vertices, faces, rim=rim).report.corners) == corners.tolist()


def test_a_region_to_be_replaced():
    vertices, faces, inside, expected = sheet()
    region = np.nonzero(inside)[0]
    (rim,) = tripatch.find_holes([faces[k] for k in region])
    assert set(tripatch.find_corners(vertices, faces, rim, replaced=region).tolist()) == expected


def test_the_outer_border_turns_the_other_way():
    vertices, faces, inside, _ = sheet()
    faces = [f for f, cut in zip(faces, inside, strict=True) if not cut]
    inner, outer = tripatch.find_holes(faces)
    assert not tripatch.is_outer_border(vertices, faces, inner)
    assert tripatch.is_outer_border(vertices, faces, outer)
    with pytest.raises(ValueError, match="rim names vertex 99"):
        tripatch.is_outer_border(vertices, faces, [0, 1, 99])


def test_what_is_no_rim_is_refused():
    vertices, faces, _, _ = sheet()
    with pytest.raises(tripatch.Refusal):
        tripatch.find_corners(vertices, faces, [0, 1, 2, 3])


@pytest.mark.parametrize("replaced", [False, True])
def test_where_the_lines_of_quads_turn_themselves_the_corners_are_those_of_the_grid(replaced):
    # the cage whose limit lies on a sphere turns by 20 to 40 degrees more where its lines pass the edges of the cube
    vertices, faces = cube_sphere(8)
    wanted = vertices.copy()
    for _ in range(40):
        vertices = vertices + wanted - _native.limit_points(*_arrays.mesh(vertices, faces))
    left, gone = corner_removed(vertices, faces, 2)
    rim = next(r for r in tripatch.find_holes(left) if len(r) == 12)
    expected = {int(v) for v in rim if sum(int(v) in face for face in left) == 3}
    found = tripatch.find_corners(vertices, faces, rim, replaced=gone) if replaced else tripatch.find_corners(vertices, left, rim)
    assert set(found.tolist()) == expected
    # six corners of a hexagon are not made three
    hexagon = np.array([[np.cos(a), np.sin(a), 0] for a in np.arange(6) * np.pi / 3])
    points = np.concatenate([hexagon, 2 * hexagon])
    ring = [[(k + 1) % 6, k, 6 + k, 6 + (k + 1) % 6] for k in range(6)]
    with refused("not_three_corners"):
        tripatch.find_corners(points, ring, np.arange(6))


@pytest.mark.parametrize(("turn", "found"), [(17.0, 4), (40.0, 0)])
def test_a_bend_within_an_edge_of_a_corner_is_none_of_its_own(turn, found):
    """As edges of CAD programs have where fillets meet; one of 40 degrees leaves open which is the corner."""
    t = np.arange(10)[:, None] / 10
    square = np.array([(0.0, 0), (1, 0), (1, 1), (0, 1)])
    rim = np.concatenate([square[k] + t * (square[(k + 1) % 4] - square[k]) for k in range(4)])
    bend = np.radians(turn)
    rim[0] = rim[1] - 0.1 * np.array((np.cos(bend), -np.sin(bend)))  # the first edge leans
    rim[0, 1] = max(rim[0, 1], -1)
    rows = [rim + 0.1 * j * (rim - 0.5) for j in range(4)]
    vertices = np.column_stack([np.concatenate(rows), np.zeros(160)])
    faces = []
    for j in range(3):
        for k in range(40):
            a, b = j * 40 + k, j * 40 + (k + 1) % 40
            faces += [[b, a, a + 40], [b, a + 40, b + 40]]
    assert len(tripatch.find_corners(vertices, faces, np.arange(40), any_number=True)) == found
