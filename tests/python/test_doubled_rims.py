"""Rims with several vertices at one place, as a boolean whose cutter lies on an axis of the mesh leaves them."""

from __future__ import annotations

import numpy as np
import pytest
import tripatch
from codes import refused, says
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from random_holes import closed_mesh, directed, hole_size, is_manifold, with_hole


def fan_at(faces, v):
    """The faces at a vertex of the border, side by side from one border edge to the other; none where they are no single fan."""
    at = [f for f, face in enumerate(faces) if v in face]
    entered = {face[face.index(v) - 1]: f for f in at for face in [faces[f]]}
    left = {face[(face.index(v) + 1) % len(face)]: f for f in at for face in [faces[f]]}
    (start,) = [x for x in left if x not in entered] if len(left.keys() - entered.keys()) == 1 else (None,)
    if start is None:
        return []
    fan, x = [], start
    while x in left:
        fan.append(left[x])
        x = next(y for y, f in entered.items() if f == left[x])
    return fan if len(fan) == len(at) else []


def doubled(points, faces, rim, rng, apart=0.0):
    """Some vertices of the rim are two or three, each with a part of the faces, and triangles without area between these."""
    points, faces = list(points), [list(map(int, face)) for face in faces]
    stands = {int(v): int(v) for v in rim}
    for v in rng.permutation(rim)[: max(1, len(rim) // 3)].tolist():
        for _ in range(int(rng.integers(1, 3))):
            fan = fan_at(faces, v)
            if len(fan) < 2:
                break
            cut = int(rng.integers(1, len(fan)))
            last = faces[fan[cut - 1]]  # of those that go over to the new vertex
            x, new = last[last.index(v) - 1], len(points)
            if x in stands:
                break  # a face between two vertices of the rim: its like are tested below
            points.append(points[v] + apart * rng.normal(size=3))
            stands[new] = stands[v]
            for f in fan[:cut]:
                faces[f] = [new if w == v else w for w in faces[f]]
            faces.append([new, x, v] if (x, new) in directed([faces[fan[cut - 1]]]) else [v, x, new])
    return np.array(points), faces, stands


def rim_of(faces, stands):
    return next(loop for loop in tripatch.find_holes(faces) if set(loop) == set(stands))


def with_split(faces, fill, first_new):
    """The faces of the mesh as the fill leaves them: an edge of the rim that it splits has one vertex more."""
    split = {tuple(sorted(map(int, edge))): first_new + k for k, edge in enumerate(fill.split_edges[0])}
    out = []
    for face in faces:
        edges = [(a, split.get((min(a, b), max(a, b)))) for a, b in zip(face, [*face[1:], face[0]])]
        out.append([v for pair in edges for v in pair if v is not None])
    return out


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["triangles", "quads"]), st.sampled_from([0.0, 1e-9]))
def test_the_fill_is_that_of_the_merged_mesh_and_joined_to_all_vertices(seed, output, apart):
    rng = np.random.default_rng(seed)
    points, faces, _ = closed_mesh(rng)
    faces = with_hole(faces, rng)
    rims = tripatch.find_holes(faces)
    assume(rims and is_manifold(faces))
    try:
        whole = tripatch.fill(points, faces, rim=rims[int(rng.integers(len(rims)))], output=output)
    except tripatch.Refusal:
        assume(False)
    size = hole_size(points, whole.rim)
    more, doubles, stands = doubled(points, faces, whole.rim, rng, apart * size)
    assume(len(more) > len(points))
    assert is_manifold(doubles)
    rim = rim_of(doubles, stands)
    fill = tripatch.fill(more, doubles, rim=rim, output=output)
    added = len(more) - len(points)
    assert fill.report.method == whole.report.method
    assert set(fill.rim) == set(rim) and len(fill.rim) == len(whole.rim) + added
    assert len(fill.faces) == len(whole.faces) + added
    assert len(fill.vertices) == len(whole.vertices)
    if len(whole.vertices) and apart == 0:
        assert np.abs(fill.vertices - whole.vertices).max() < 1e-6 * size
    at = dict(zip(whole.rim, whole.rim_normals))
    assert np.abs(fill.rim_normals - np.array([at[stands[v]] for v in fill.rim])).max() < 1e-3
    joined = directed([*with_split(doubles, fill, len(more)), *fill.faces])
    assert max(joined.values()) == 1
    assert not [e for e in joined if e[0] in stands and e[1] in stands and e[::-1] not in joined]
    assert says(fill.report, "edges_without_length")
    assert fill.report.triangles_folded == whole.report.triangles_folded


def open_ball():
    """A ball of triangles without its cap."""
    rng = np.random.default_rng(1)
    points, faces, _ = closed_mesh(rng, "icosphere", "none")
    faces = [f for f in faces if np.mean(points[list(f)], axis=0)[2] < 0.8]
    return points, [list(f) for f in faces]


def test_where_the_triangles_would_double_an_edge_the_fill_is_joined_otherwise():
    points, faces = open_ball()
    rim = tripatch.find_holes(faces)[0]
    a, b = rim[0], rim[1]
    face = next(f for f in faces if a in f and b in f)
    low, high = (a, b) if (a, b) in directed([face]) else (b, a)
    tip = len(points)  # upon a: an ear on the edge from a to b, without area
    more = np.vstack([points, points[[a]]])
    eared = [*faces, [high, low, tip]]
    (loop,) = tripatch.find_holes(eared)
    assert tip in loop
    fill = tripatch.fill(more, eared, rim=loop)
    joined = directed([*eared, *fill.faces])
    assert max(joined.values()) == 1 and all(e[::-1] in joined for e in joined)


@pytest.mark.parametrize("part, merged", [(0.3e-6, True), (3e-6, False)])
def test_vertices_nearer_than_a_millionth_of_the_rim_are_one(part, merged):
    points, faces = open_ball()
    rim = tripatch.find_holes(faces)[0]
    length = np.linalg.norm(points[rim] - points[np.roll(rim, 1)], axis=1).sum()
    more, doubles, stands = doubled(points, faces, rim, np.random.default_rng(2))
    away = np.random.default_rng(4).normal(size=(len(more) - len(points), 3))
    more[len(points) :] += part * length * away / np.linalg.norm(away, axis=1)[:, None]
    fill = tripatch.fill(more, doubles, rim=rim_of(doubles, stands))
    assert says(fill.report, "edges_without_length") == merged


def test_all_holes_at_once_and_the_only_hole_unnamed():
    rng = np.random.default_rng(5)
    points, faces, _ = closed_mesh(rng, "icosphere", "none")
    z = np.array([points[list(f)].mean(axis=0)[2] for f in faces])
    for one in (True, False):
        left = [list(f) for f, h in zip(faces, z) if h < 0.8 and (one or h > -0.8)]
        more, doubles = points, left
        for rim in tripatch.find_holes(left):
            more, doubles, _ = doubled(more, doubles, rim, rng)
        rims = tripatch.find_holes(doubles)
        fills = [tripatch.fill(more, doubles)] if one else tripatch.fill_all(more, doubles, rims)
        for fill, rim in zip(fills, rims):
            assert fill.report.method == tripatch.fill(points, left, rim=tripatch.find_holes(left)[0]).report.method
            assert set(fill.rim) == set(rim)
            assert says(fill.report, "edges_without_length", "edge_without_length")


@pytest.mark.parametrize("options", [{"output": "cage"}, {"method": "side_vertex", "corners": [0, 4, 8]}])
def test_cages_and_methods_that_are_insisted_on_ask_for_a_clean_rim(options):
    rng = np.random.default_rng(3)
    points, faces, _ = closed_mesh(rng, "icosphere", "none")
    left = [list(f) for f in faces if points[list(f)].mean(axis=0)[2] < 0.8]
    more, doubles, stands = doubled(points, left, tripatch.find_holes(left)[0], rng)
    rim = rim_of(doubles, stands)
    if "corners" in options:
        options = {**options, "corners": [rim[k] for k in options["corners"]]}
    with refused("edge_without_length"):
        tripatch.fill(more, doubles, rim=rim, **options)


def test_two_corners_at_one_place_are_a_mistake():
    rng = np.random.default_rng(3)
    points, faces, _ = closed_mesh(rng, "icosphere", "none")
    left = [list(f) for f in faces if points[list(f)].mean(axis=0)[2] < 0.8]
    more, doubles, stands = doubled(points, left, tripatch.find_holes(left)[0], rng)
    rim = rim_of(doubles, stands)
    new = next(v for v in rim if stands[v] != v)
    others = [v for v in rim if stands[v] not in (new, stands[new])]
    for corners in ([stands[new], new], [new, others[0], stands[new]], [stands[new], others[0], others[5], new]):
        said = "Corners {} and {} are at the same place. Name one of them".format(*[v for v in corners if v not in others])
        for method in ("auto", "polyharmonic_spline"):
            with pytest.raises(ValueError, match=said):
                tripatch.fill(more, doubles, rim=rim, corners=corners, method=method)
            with pytest.raises(ValueError, match=said):
                tripatch.fill_all(more, doubles, [rim], corners=[corners], method=method)
    with pytest.raises(ValueError, match="names vertex .* twice"):
        tripatch.fill(more, doubles, rim=rim, corners=[new, new, others[0], others[3]])
    fill = tripatch.fill(more, doubles, rim=rim, corners=[new, others[4]])
    assert len(fill.report.corners) == 2


def test_islands_with_doubled_vertices():
    n = 14
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    points = np.stack([x, y, 0.02 * (x - 7) ** 2], axis=-1).reshape(-1, 3)
    cells = [(i, j) for i in range(n) for j in range(n) if max(abs(i - 6.5), abs(j - 6.5)) not in (2.5, 3.5)]
    faces = [[i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1] for i, j in cells]
    inside = {v for v in range(len(points)) if np.abs(points[v, :2] - 7).max() <= 2}
    more, doubles, stands = points, faces, {}
    for rim in tripatch.find_holes(faces):
        if np.abs(points[rim][:, :2] - 7).max() < 6:
            more, doubles, own = doubled(more, doubles, rim, np.random.default_rng(len(rim)))
            stands.update(own)
    loops = [r for r in tripatch.find_holes(doubles) if set(r) <= set(stands)]
    (island,) = [r for r in loops if stands[r[0]] in inside]
    (rim,) = [r for r in loops if stands[r[0]] not in inside]
    assert len(island) > 16 and len(rim) > 32
    fill = tripatch.fill(more, doubles, rim=rim, islands=[island])
    assert says(fill.report, "edges_without_length")
    assert set(fill.rim) == {*rim, *island} and len(fill.rim_normals) == len(fill.rim)
    assert np.abs(fill.vertices[:, 2] - 0.02 * (fill.vertices[:, 0] - 7) ** 2).max() < 0.02
    joined = directed([*doubles, *fill.faces])
    assert max(joined.values()) == 1
    assert not [e for e in joined if e[0] in stands and e[1] in stands and e[::-1] not in joined]
