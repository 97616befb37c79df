"""Networks of curves: one tangent plane at each vertex, and across every edge."""

import numpy as np
import pytest
import tripatch
from codes import refused
from test_papers import curve, largest


def hexagon(seed=3):
    """Six triangles round a vertex: vertices, triangles, and a normal at each vertex."""
    rng = np.random.default_rng(seed)
    angle = np.arange(6) * np.pi / 3 + 0.2 * rng.uniform(-1, 1, 6)
    vertices = np.vstack([np.zeros(3), np.column_stack([np.cos(angle), np.sin(angle), 0.4 * rng.normal(size=6)])])
    normals = np.array([0, 0, 1]) + 0.3 * rng.normal(size=(7, 3))
    return vertices, [(0, k + 1, (k + 1) % 6 + 1) for k in range(6)], normals / np.linalg.norm(normals, axis=1)[:, None]


def edges_of(triangles):
    return sorted({tuple(sorted((t[k], t[(k + 1) % 3]))) for t in triangles for k in range(3)})


def cubics(vertices, triangles, normals, seed=8):
    """Cubic Bezier curves over the edges with tangents in the planes of the vertices, otherwise of any length and direction."""
    rng, curves = np.random.default_rng(seed), {}
    for a, b in edges_of(triangles):
        ends = []
        for v, along in ((a, vertices[b] - vertices[a]), (b, vertices[a] - vertices[b])):
            along = along + 0.15 * rng.normal(size=3)
            ends.append(vertices[v] + (0.3 + 0.1 * rng.uniform()) * (along - normals[v] * (normals[v] @ along)))
        curves[a, b] = np.array([vertices[a], *ends, vertices[b]])
    return curves


def near(patch, corner, distance, n=9):
    """Normals of a patch at some distance from a corner, on rays into the triangle."""
    places = []
    for s in np.linspace(0, 1, n):
        b = np.zeros(3)
        b[corner], b[(corner + 1) % 3], b[(corner + 2) % 3] = 1 - distance, distance * (1 - s), distance * s
        places.append(b)
    return patch.normal(np.array(places))


@pytest.mark.parametrize("kind", ["bezier", "hermite", "smits"])
@pytest.mark.parametrize("first", [0, 1, 2])
def test_six_triangles_around_a_vertex_have_one_tangent_plane_there(kind, first):
    for seed in range(3, 9):
        vertices, triangles, normals = hexagon(seed)
        triangles = [(*triangle[first:], *triangle[:first]) for triangle in triangles]
        curves = cubics(vertices, triangles, normals) if kind == "bezier" else kind
        made = tripatch.network(vertices, triangles, curves, normals)
        assert len(made.patches) == 6
        corner = (-first) % 3
        there = np.vstack([patch.normal(np.eye(3)[corner : corner + 1]) for patch in made.patches])
        assert max(tripatch.angles(there, np.roll(there, k, axis=0)).max() for k in range(1, 6)) < 1e-9
        assert tripatch.angles(made.normals[:7], normals).max() < 1e-9


def test_near_a_vertex_the_normals_turn_in_proportion_to_the_distance():
    """So what they differ by there is the surface's own curvature, no gap of the construction."""
    vertices, triangles, normals = hexagon()
    made = tripatch.network(vertices, triangles, cubics(vertices, triangles, normals), normals)
    angles = {}
    for distance in (1e-3, 1e-5, 1e-7):
        seen = np.vstack([near(patch, 0, distance) for patch in made.patches])
        angles[distance] = tripatch.angles(seen, np.broadcast_to(normals[0], seen.shape)).max()
    assert angles[1e-3] / angles[1e-5] == pytest.approx(100, rel=0.05)
    assert angles[1e-5] / angles[1e-7] == pytest.approx(100, rel=0.05)


@pytest.mark.parametrize("kind", ["bezier", "functions", "hermite"])
def test_patches_meet_in_the_given_curve_with_the_given_planes(kind):
    vertices, triangles, normals = hexagon()
    curves = cubics(vertices, triangles, normals)
    given = curves
    if kind == "functions":  # backwards, which is the same network
        given = {(b, a): (lambda t, c=c: curve(c, 1 - t), lambda t, c=c: -curve(c, 1 - t, 1)) for (a, b), c in curves.items()}
    made = tripatch.network(vertices, triangles, "hermite" if kind == "hermite" else given, normals)
    t = np.linspace(0, 1, 33)
    for a, b in ((0, k) for k in range(1, 7)):
        points, planes = [], []
        for triangle, patch in zip(triangles, made.patches, strict=True):
            if b not in triangle:
                continue
            places = np.zeros((33, 3))
            places[:, triangle.index(a)], places[:, triangle.index(b)] = 1 - t, t
            points.append(patch.evaluate(places))
            planes.append(patch.normal(places))
        assert len(points) == 2 and largest(points[0] - points[1]) < 1e-12
        assert tripatch.angles(*planes).max() < 1e-6
        if kind != "hermite":
            assert largest(points[0] - curve(curves[a, b], t)) < 1e-12
            along = curve(curves[a, b], t, 1)
            mixed = np.outer(1 - t, normals[a]) + np.outer(t, normals[b])
            mixed -= along * ((mixed * along).sum(axis=1) / (along**2).sum(axis=1))[:, None]
            assert tripatch.angles(planes[0], mixed).max() < 1e-6


def test_given_fields_of_normals_are_met():
    vertices, triangles, normals = hexagon()
    curves = cubics(vertices, triangles, normals)
    fields = {}
    for a, b in curves:  # bends in between, at a right angle to the curve
        fields[b, a] = lambda t, a=a, b=b: (
            np.outer(1 - t, normals[b]) + np.outer(t, normals[a]) + np.outer(t * (1 - t), [1, 2, 0])
        )
    made = tripatch.network(vertices, triangles, curves, fields)
    t = np.linspace(0, 1, 17)
    a, b = 0, 1
    along, field = curve(curves[a, b], t, 1), fields[b, a](1 - t)
    field = field - along * ((field * along).sum(axis=1) / (along**2).sum(axis=1))[:, None]
    assert tripatch.angles(made.patches[0].normal(np.column_stack([1 - t, t, 0 * t])), field).max() < 1e-6


def test_what_is_no_network_is_refused_with_its_vertices():
    vertices, triangles, normals = hexagon()
    curves = cubics(vertices, triangles, normals)
    missing = {edge: c for edge, c in curves.items() if edge != (0, 3)}
    with refused("no_curve_given") as caught:
        tripatch.network(vertices, triangles, missing, normals)
    assert list(caught.value.where) == [0, 3]
    moved = curves | {(0, 3): curves[0, 3] + [[0.01, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]}
    with refused("curve_off_vertices"):
        tripatch.network(vertices, triangles, moved, normals)
    bent = curves | {(0, 3): curves[0, 3] + [[0, 0, 0], [0, 0, 0.05], [0, 0, 0], [0, 0, 0]]}
    with refused("curve_planes_differ") as caught:
        tripatch.network(vertices, triangles, bent, normals)
    assert list(caught.value.where) == [0]
    with pytest.raises(ValueError, match="normals has nothing for the edge from 0 to 1"):
        tripatch.network(vertices, triangles, curves, {(1, 2): normals[:2]})
    with pytest.raises(TypeError, match="curves must be of type str"):
        tripatch.network(vertices, triangles, [1], normals)
    with pytest.raises(ValueError, match="curves must be one of hermite, smits"):
        tripatch.network(vertices, triangles, "straight", normals)
