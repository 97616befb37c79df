"""What a plain mesh says of the surface around a hole, seen through the fill's normals at the rim."""

from itertools import pairwise

import numpy as np
import pytest
import shapes
import tripatch


def with_edges_split(vertices, faces, edges):
    """Each edge gets a vertex in its middle, and the triangles next to it become two."""
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
        adjacent = [k for k, face in enumerate(faces) if set(e) <= set(map(int, face))]
        if not taken & set(adjacent):
            taken |= set(adjacent)
            apart.append(e)
    assert len(apart) > 20
    clean = rim_error(vertices, faces, rim)
    assert rim_error(*with_edges_split(vertices, faces, apart), rim) < 1.5 * clean


def test_nor_are_those_that_have_no_other_neighbors():
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


def filleted_box(segments, size, radius=0.8):
    """A box whose three edges at the corner `size` are rounded, as CAD programs write it: fillets are strips of long triangles,
    flat faces fans; the hole is the eighth of a sphere at the corner. Vertices, faces, rim and corners."""
    vertex, faces = shapes.Vertices(), []
    axes, center = np.eye(3), np.array(size) - radius
    angles = np.linspace(0, np.pi / 2, segments + 1)
    arcs = [[center + radius * (np.cos(a) * axes[k] + np.sin(a) * axes[k - 2]) for a in angles] for k in range(3)]
    far = [[p * (1 - axes[k - 1]) for p in arc] for k, arc in enumerate(arcs)]
    for near, end, k in zip(arcs, far, range(3)):
        for (a, b), (d, c) in zip(pairwise(near), pairwise(end)):
            faces += [[vertex(b), vertex(a), vertex(d)], [vertex(b), vertex(d), vertex(c)]]
        loop = [size * axes[k], *end, size * axes[k - 2]]  # the end of the box
        faces += [[vertex(np.zeros(3)), vertex(q), vertex(p)] for p, q in pairwise(loop)]
    for k in range(3):  # the flat side across axis k
        a, b = center + radius * axes[k], size * axes[k]
        u, v = axes[k - 2] * (size - radius), axes[k - 1] * (size - radius)
        faces += [[vertex(b), vertex(b + u), vertex(a)], [vertex(b), vertex(a), vertex(b + v)]]
    rim = [vertex(p) for arc in arcs for p in arc[:-1]]
    return np.array(vertex.points), faces, rim, [vertex(arc[0]) for arc in arcs], center


@pytest.mark.parametrize(("segments", "size"), [(22, (2, 3, 4)), (32, (2, 3, 4)), (39, (3, 3, 2)), (16, (5, 1.5, 2))])
def test_planes_beside_fillets_are_those_of_the_fillets(segments, size):
    """Strips of one row whose far end is a sharp edge, flat faces next to them: nothing but the strip itself tells its planes."""
    vertices, faces, rim, corners, center = filleted_box(segments, np.array(size, float))
    fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, method="side_vertex")
    out = (vertices[fill.rim] - center) / 0.8
    angles = np.degrees(np.arccos(np.clip((fill.rim_normals * out).sum(1), -1, 1)))
    inner = ~np.isin(fill.rim, corners)
    assert angles[inner].max() < 0.05 and angles.max() < 0.2
    assert fill.report.surroundings_error < 0.1
    assert np.abs(np.linalg.norm(fill.vertices - center, axis=1) - 0.8).max() < 5e-4


def plate(n, m, radius, shift, center):
    """A round hole of radius 1 in a plate of triangles from the hole to the plate's edge, which is rounded down."""
    inner, outer = 2 * np.pi * np.arange(n) / n, 2 * np.pi * np.arange(m) / m
    bend = np.linspace(0, np.pi / 2, 9)
    profile = [*zip(radius + 0.4 * np.sin(bend), 0.4 * np.cos(bend) - 0.4, strict=True), (radius + 0.4, -0.7), (radius + 0.4, -1)]
    loops = [np.column_stack([np.cos(inner), np.sin(inner), 0 * inner])]
    loops += [np.column_stack([r * np.cos(outer) + center[0], r * np.sin(outer) + center[1], 0 * outer + z]) for r, z in profile]
    faces, i, j = [], 0, 0
    while i < n or j < m:
        if j == m or (i < n and (i + 1) * m <= (j + 1) * n):
            faces.append([(i + 1) % n, i % n, n + (j + shift) % m])
            i += 1
        else:
            faces.append([i % n, n + (j + shift) % m, n + (j + 1 + shift) % m])
            j += 1
    for row in range(len(profile) - 1):
        for k in range(m):
            a, b = n + row * m + k, n + row * m + (k + 1) % m
            faces += [[b, a, a + m], [b, a + m, b + m]]
    return np.concatenate(loops), faces, list(range(n))


@pytest.mark.parametrize(("n", "m", "radius", "shift", "center"), [(16, 83, 2.1, 5, (-0.4, -0.1)), (9, 66, 2.0, -7, (0.4, 0.1))])
def test_a_plane_in_long_triangles_is_a_plane(n, m, radius, shift, center):
    """As CAD programs mesh planes: beyond the first faces the surface bends."""
    vertices, faces, rim = plate(n, m, radius, shift, center)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=[0, n // 3, 2 * n // 3], method="side_vertex")
    assert np.abs(fill.vertices[:, 2]).max() < 1e-12
    assert fill.report.surroundings_error < 0.01
