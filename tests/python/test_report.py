"""What a report says of the faces that are delivered, against an independent count."""

import json

import numpy as np
import pytest
import tripatch
from shapes import corner_removed, cube_sphere, octant


def folded_edges(points, faces):
    """Edges whose triangles face more than 120 degrees apart, faces cut into fans, quads along the shorter diagonal."""

    def across(a, b):
        return np.linalg.norm(points[a] - points[b])

    faces = [[*f[1:], f[0]] if len(f) == 4 and across(f[1], f[3]) < across(f[0], f[2]) else list(f) for f in faces]
    triangles = [(f[0], a, b) for f in faces for a, b in zip(f[1:], f[2:], strict=False)]
    corners = points[np.array(triangles)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    first, count = {}, 0
    for i, t in enumerate(triangles):
        for k in range(3):
            j = first.setdefault(frozenset((t[k], t[(k + 1) % 3])), i)
            count += j != i and int(normals[i] @ normals[j] < -0.5)
    return count


def jagged(n, depth):
    """The octant with its rim's middle vertices pulled across the hole, so that a fill folds."""
    vertices, faces, rim = octant(n)
    vertices = vertices.copy()
    corners = [v for v in rim if np.isclose(np.abs(vertices[v]).max(), 1)]
    for v in rim[::2]:
        if v not in corners:
            vertices[v] += depth * (np.ones(3) / 3**0.5 - vertices[v])
    return vertices, faces, rim, corners


@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize("depth", [0.0, 0.6])
def test_folded_triangles_are_those_of_the_faces_delivered(output, depth):
    vertices, faces, rim, corners = jagged(8, depth)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, output=output, fairing=None, method="side_vertex")
    points = np.concatenate([vertices, fill.vertices])
    # those at the rim are folded over the mesh's own faces
    count = folded_edges(points, [*faces, *fill.faces]) - folded_edges(vertices, faces)
    assert fill.report.triangles_folded == count
    assert (count > folded_edges(points, fill.faces)) == (depth > 0)
    assert (count > 0) == (depth > 0)


def test_a_hole_that_leaves_no_other_way_may_fold_as_its_rim_does():
    """Three sides of a flat pyramid, of which the fourth is folded over each of them; and of a tall one, of which it is not."""
    for apex, folded in (([0.45, 0.4, 0.03], 3), ([0.45, 0.4, 0.9], 0)):
        vertices = np.array([[0, 0, 0], [1, 0, 0], [0.4, 1, 0], apex])
        faces = [[0, 1, 3], [1, 2, 3], [2, 0, 3]]
        fill = tripatch.fill(vertices, faces, rim=[0, 1, 2], method="polyharmonic_spline")
        assert fill.report.triangles_folded == fill.report.rim_folded == folded


@pytest.mark.parametrize("depth", [0.0, 3.0])
def test_of_a_cage_those_of_its_limit_surface_count(depth):
    vertices, faces = cube_sphere(8)
    faces, _ = corner_removed(vertices, faces, 2)
    rim = next(r for r in tripatch.find_holes(faces) if len(r) == 12)
    vertices = vertices.copy()
    corners = [v for v in rim if sum(v in face for face in faces) == 3]
    for v in rim[::2]:
        if v not in corners:
            vertices[v] += depth * (vertices[rim].mean(axis=0) - vertices[v])
    fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, output="cage", resolution=0, fairing=None)
    limit, quads = fill.limit(3)
    assert fill.report.triangles_folded == folded_edges(limit, quads.tolist())
    assert (fill.report.triangles_folded > 0) == (depth > 0)


def test_a_report_names_the_method_and_what_is_not_known_is_none():
    vertices, faces, rim = octant(4)
    fill = tripatch.fill(vertices, faces, rim=rim, method="side_vertex", fairing=None)
    told = json.loads(json.dumps(fill.report.as_dict()))
    assert told["method"] == fill.report.method
    assert (told["method_reason"], told["reason_codes"]) == (fill.report.method_reason, [fill.report.method_reason.code])
    assert told["deviation_max"] is None
    assert fill.deviation is None
    assert fill.uv is None
    assert fill.rim_uv is None


OF_ONE_RIM = [m.name for m in tripatch.METHODS.values() if m.fills_holes and m.name not in ("quad_rows", "annulus")]


@pytest.mark.parametrize("method", OF_ONE_RIM)
def test_the_method_used_is_the_one_asked_for(method):
    vertices, faces, rim = octant(6)
    assert tripatch.fill(vertices, faces, rim=rim, method=method).report.method == method
