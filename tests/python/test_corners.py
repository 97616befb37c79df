"""Balls of faces taken out of solids at edges and corners: the planes around such a hole continue until they meet."""

import numpy as np
import pytest
import tripatch


def closed_volume_and_area(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    return (a * normal).sum() / 6, np.linalg.norm(normal, axis=1).sum() / 2


def voxels(cells, cut):
    """The surface of unit cubes as triangles, `cut` x `cut` squares a face."""
    cells = set(map(tuple, cells))
    number, faces = {}, []

    def vertex(p):
        return number.setdefault(tuple(p), len(number))

    for cell in sorted(cells):
        for axis in range(3):
            for side in (0, 1):
                step = np.zeros(3, int)
                step[axis] = 2 * side - 1
                if tuple(np.array(cell) + step) in cells:
                    continue
                u, v = (
                    np.roll(np.eye(3, dtype=int), axis, axis=1)[1:]
                    if side
                    else np.roll(np.eye(3, dtype=int), axis, axis=1)[:0:-1]
                )
                origin = cut * (np.array(cell) + side * np.eye(3, dtype=int)[axis])
                for i in range(cut):
                    for j in range(cut):
                        q = [vertex(origin + (i + a) * u + (j + b) * v) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                        faces += (
                            [[q[0], q[1], q[2]], [q[0], q[2], q[3]]] if (i + j) % 2 else [[q[0], q[1], q[3]], [q[1], q[2], q[3]]]
                        )
    return np.array(list(number), float) / cut, np.array(faces)


def refined(points, polygons, cut):
    """A polyhedron's faces as fans of triangles, each cut into cut^2."""
    number, faces = {}, []

    def vertex(p):
        return number.setdefault(tuple(np.round(p, 9)), len(number))

    for polygon in polygons:
        corners = np.array(points, float)[polygon]
        for k in range(2, len(corners)):
            a, b, c = corners[0], corners[k - 1], corners[k]
            at = {(i, j): vertex(a + (b - a) * i / cut + (c - a) * j / cut) for i in range(cut + 1) for j in range(cut + 1 - i)}
            for i, j in at:
                if i + j < cut:
                    faces.append([at[i, j], at[i + 1, j], at[i, j + 1]])
                if i + j < cut - 1:
                    faces.append([at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]])
    return np.array(list(number), float), np.array(faces)


def prism(n, cut):
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.vstack([np.column_stack([ring, np.zeros(n)]), np.column_stack([ring, np.full(n, 1.2)])])
    sides = [[k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)]
    return refined(points, [*sides, list(range(n))[::-1], list(range(n, 2 * n))], cut)


def bevelled_box(cut):
    """The corner at (1, 1, 1) of a box is cut off."""
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 0.5], [1, 0.4, 1], [0.3, 1, 1]]
    polygons = [[0, 3, 2, 1], [0, 1, 5, 4], [0, 4, 6, 3], [1, 2, 7, 8, 5], [2, 3, 6, 9, 7], [4, 5, 8, 9, 6], [7, 9, 8]]
    return refined(points, polygons, cut)


LETTER_T = [(x, 0, 3) for x in range(3)] + [(1, 0, z) for z in range(3)]
STAIRS = [(x, y, z) for x in range(3) for y in range(2) for z in range(3 - x)]
NOTCHED = [(x, y, z) for x in range(2) for y in range(2) for z in range(2) if (x, y, z) != (1, 1, 1)]
SOLIDS = {
    "letter": voxels(LETTER_T, 4),
    "stairs": voxels(STAIRS, 4),
    "notched cube": voxels(NOTCHED, 6),
    "prism of five": prism(5, 6),
    "prism of six": prism(6, 8),
    "bevelled box": bevelled_box(6),
}


def corners_of(vertices, faces):
    """Vertices at which three planes or more meet."""
    normals = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    at = [set() for _ in vertices]
    for face, normal in zip(faces, np.round(normals, 6) + 0.0, strict=True):
        for v in face:
            at[v].add(tuple(normal))
    return [k for k, planes in enumerate(at) if len(planes) >= 3], [k for k, planes in enumerate(at) if len(planes) == 2]


def cut_ball(vertices, faces, rng, corner):
    """Faces without those in a ball at a corner or an edge; None where no single hole is left."""
    corners, along = corners_of(vertices, faces)
    edge = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1).mean()
    center = vertices[rng.choice(corners if corner else along)] + rng.normal(size=3) * edge / 2
    left = faces[np.linalg.norm(vertices[faces].mean(axis=1) - center, axis=1) > edge * rng.uniform(1.2, 2.6)]
    edges = {(a, b) for t in left.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True)}
    after = {}
    for a, b in edges:
        if (b, a) not in edges and after.setdefault(b, a) != a:
            return None
    loop = [next(iter(after), None)]
    while loop[0] is not None and after.get(loop[-1]) not in (None, loop[0]):
        loop.append(after[loop[-1]])
    gone = len(set(faces.ravel()) - set(left.ravel()))
    return left if gone >= 2 and loop[0] is not None and len(loop) == len(after) else None


def holes(name, corner, count=8):
    rng = np.random.default_rng(len(name) + 100 * corner)
    vertices, faces = SOLIDS[name]
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    while count:
        if (left := cut_ball(vertices, faces, rng, corner)) is not None:
            yield vertices @ turn.T, left, closed_volume_and_area(vertices, faces)
            count -= 1


@pytest.mark.parametrize("corner", [False, True], ids=["edge", "corner"])
@pytest.mark.parametrize("name", SOLIDS)
def test_planes_around_a_hole_meet_in_it_as_the_solid_s_do(name, corner):
    exact = 0
    for vertices, left, (volume, area) in holes(name, corner):
        (fill,) = tripatch.fill_all(vertices, left, outer=True)
        closed = np.vstack([left, *(np.array([[f[0], f[k - 1], f[k]] for k in range(2, len(f))]) for f in fill.faces)])
        now = closed_volume_and_area(np.vstack([vertices, fill.vertices]), closed)
        exact += abs(now[0] - volume) < 1e-6 * volume and abs(now[1] - area) < 1e-6 * area
    assert exact >= 7  # of 8: a hole may have lost a whole wall


def test_a_crease_begins_in_a_corner_on_the_boundary():
    """Without the faces around the vertex next to a box's corner no edge of the crease between them is left at the corner."""
    vertices, faces = voxels([(0, 0, 0)], 5)
    volume, area = closed_volume_and_area(vertices, faces)
    corners, along = corners_of(vertices, faces)
    tried = 0
    for w in along:
        left = faces[~(faces == w).any(axis=1)]
        near = [v for v in corners if np.isclose(np.linalg.norm(vertices[v] - vertices[w]), 0.2)]
        if not near or (left == near[0]).any(axis=1).sum() < 3:
            continue
        (fill,) = tripatch.fill_all(vertices, left, outer=True)
        closed = np.vstack([left, *(np.array([[f[0], f[k - 1], f[k]] for k in range(2, len(f))]) for f in fill.faces)])
        now = closed_volume_and_area(np.vstack([vertices, fill.vertices]), closed)
        assert now == pytest.approx((volume, area), rel=1e-9)
        tried += 1
    assert tried > 0
