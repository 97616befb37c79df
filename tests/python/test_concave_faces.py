"""Holes next to faces with many corners, concave or with corners in a line, as booleans and dissolved edges leave them."""

from __future__ import annotations

import numpy as np
import pytest
import tripatch
from codes import says

N = 24


def ball_of_quads(hole):
    """Quads over a part of a unit ball, those gone whose middles are in the hole: vertices, faces by (row, column)."""
    x, y = np.meshgrid(np.linspace(-0.6, 0.6, N + 1), np.linspace(-0.6, 0.6, N + 1), indexing="ij")
    vertices = np.stack([x, y, np.ones_like(x)], axis=-1).reshape(-1, 3)
    vertices /= np.linalg.norm(vertices, axis=1)[:, None]
    at = np.arange(len(vertices)).reshape(N + 1, -1)
    faces = {}
    for i in range(N):
        for j in range(N):
            if not hole((i + 0.5) / N * 2 - 1, (j + 0.5) / N * 2 - 1):
                faces[i, j] = [at[i, j], at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]]
    return vertices, faces


def outline(faces):
    """The loop around faces side by side, from whichever corner."""
    edges = {(a, b) for f in faces for a, b in zip(f, f[1:] + f[:1])}
    after = dict(e for e in edges if e[::-1] not in edges)
    loop = [next(iter(after))]
    while (v := after[loop[-1]]) != loop[0]:
        loop.append(v)
    assert len(loop) == len(after)
    return loop


def with_merged(vertices, faces, rng):
    """Three quads at a corner of the hole become one face of eight corners, five of them in lines; it begins at any of them."""
    rim = min(tripatch.find_holes(list(faces.values())), key=len)
    of_vertex = {}
    for place, face in faces.items():
        for v in face:
            of_vertex.setdefault(v, []).append(place)
    merged = 0
    for v in rim:
        places = of_vertex[v]
        if len(places) == 3 and all(p in faces for p in places):
            loop = outline([faces.pop(p) for p in places])
            turned = int(rng.integers(len(loop)))
            faces["merged", merged] = loop[turned:] + loop[:turned]
            merged += 1
    assert merged >= 4
    return list(faces.values())


@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize("seed", range(4))
def test_the_ball_beside_concave_faces_comes_back(output, seed):
    rng = np.random.default_rng(seed)
    x0, y0 = rng.uniform(-0.1, 0.1, 2)
    vertices, faces = ball_of_quads(lambda x, y: np.hypot(x - x0, y - y0) < 0.42)
    faces = with_merged(vertices, faces, rng)
    rim = min(tripatch.find_holes(faces), key=len)
    fill = tripatch.fill(vertices, faces, rim=rim, output=output)
    assert not says(fill.report, "least_bending", "rim_alone_followed")
    # the middle of the hole lies 0.03 above its rim
    assert np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max() < 1e-3
    assert fill.report.triangles_folded == 0
