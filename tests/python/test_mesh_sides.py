"""What a plain mesh says of the surface around a hole, seen through the fill's normals at the rim."""

from itertools import pairwise

import numpy as np
import pytest
import shapes
import tripatch


def with_edges_split(vertices, faces, edges):
    """Each edge gets a vertex in its middle, and the triangles beside it become two."""
    vertices, faces = [np.asarray(v) for v in vertices], [list(face) for face in faces]
    for a, b in edges:
        middle = len(vertices)
        vertices.append((vertices[a] + vertices[b]) / 2)
        for face in [face for face in faces if a in face and b in face]:
            faces.remove(face)
            faces += [[middle if v == w else v for v in face] for w in (a, b)]
    return np.array(vertices), faces


def rim_error(vertices, faces, rim):
    """Largest angle, in degrees, between the fill's normals at the rim of a sphere's hole and the sphere's."""
    fill = tripatch.fill(vertices, faces, rim=rim, fairing=None)
    b = np.array([np.roll([0, 1 - t, t], i) for i in range(3) for t in np.linspace(0.02, 0.98, 25)])
    positions, normals = fill.patch.evaluate(b), fill.patch.normal(b)
    normals *= np.sign((normals * positions).sum(1, keepdims=True))
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(positions, normals), axis=1), (positions * normals).sum(1))).max()


@pytest.mark.parametrize("where", ["outer border", "inside"])
def test_vertices_put_on_edges_are_not_taken_for_points_of_the_surface(where):
    vertices, faces, rim = shapes.octant(16, 4)
    on_rim = set(map(int, rim))
    count = {}
    for face in faces:
        for edge in pairwise([*face, face[0]]):
            key = tuple(sorted(map(int, edge)))
            count[key] = count.get(key, 0) + 1
    edges = [
        e for e, n in count.items() if not on_rim & set(e) and (n == 1 if where == "outer border" else n == 2 and sum(e) % 7 == 0)
    ]
    taken, apart = set(), []  # no two in one triangle
    for e in edges:
        beside = [k for k, face in enumerate(faces) if set(e) <= set(map(int, face))]
        if not taken & set(beside):
            taken |= set(beside)
            apart.append(e)
    assert len(apart) > 20
    clean = rim_error(vertices, faces, rim)
    assert rim_error(*with_edges_split(vertices, faces, apart), rim) < 1.5 * clean


def test_nor_are_those_that_have_no_other_neighbours():
    vertices, faces = shapes.cube_sphere(12)
    faces, _ = shapes.corner_removed(vertices, faces, 3)
    (rim,) = tripatch.find_holes(faces)
    clean = rim_error(vertices, faces, rim)
    edges = {tuple(sorted(e)) for face in faces for e in pairwise([*face, face[0]]) if not set(e) & set(map(int, rim))}
    vertices, faces = list(vertices), [list(face) for face in faces]
    for a, b in sorted(edges)[::5]:
        for face in faces:
            for k in range(len(face)):
                if {face[k - 1], face[k]} == {a, b}:
                    face.insert(k, len(vertices))
                    break
        vertices.append((vertices[a] + vertices[b]) / 2)
    assert rim_error(np.array(vertices), faces, rim) < 1.5 * clean
