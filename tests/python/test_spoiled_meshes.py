"""Meshes as people leave them behind: their holes are refused with a sentence, or filled so that no edge has a face too many."""

from __future__ import annotations

import os

import numpy as np
import pytest
import tripatch
from random_holes import directed
from spoiled_meshes import edges, spoiled_mesh

EXAMPLES = int(os.environ.get("TRIPATCH_EXAMPLES", "60"))


def options(rng, rim, points):
    chosen = {}
    for name, values in {
        "output": ["quads", "cage"],
        "resolution": [1, 2, 7],
        "continuity": ["Free", "G0", "G1", "G2"],
        "fairing": [None, "thin_plate", "third_derivative", "minimum_variation", "quadric_variation"],
        "bulge": [0.01, 3.0, 50.0],
        "center_offset": [-3.0, 0.1, 1e6],
        "odd": ["split", "triangle"],
        "corners": [rng.permutation(rim)[: int(rng.integers(6))].tolist()],
        "through": [[tuple(points[rim].mean(axis=0))]],
    }.items():
        if rng.random() < 0.12:
            chosen[name] = values[int(rng.integers(len(values)))]
    return chosen


def filled(points, faces, rim, given):
    """A fill or none: what is refused, or an argument for that hole, is said in a sentence."""
    try:
        return tripatch.fill(points, faces, rim=rim, **given)
    except ValueError as error:
        assert len(str(error)) > 10
        return None


@pytest.mark.parametrize("seed", range(EXAMPLES))
def test_a_hole_is_refused_or_filled_without_an_edge_too_many(seed):
    rng = np.random.default_rng(seed)
    points, faces, what = spoiled_mesh(rng)
    before = edges(faces)
    for rim in sorted(tripatch.find_holes(faces), key=len)[-2:]:
        given = options(rng, rim, points)
        fill = filled(points, faces, rim, given)
        if fill is None:
            continue
        said = what, given
        n = len(points)
        assert np.isfinite(fill.vertices).all() and np.isfinite(fill.normals).all(), said
        assert max(directed(fill.faces).values()) == 1, said
        assert all(len(set(face)) == len(face) for face in fill.faces), said
        used = {v for face in fill.faces for v in face}
        assert used >= set(range(n, n + len(fill.vertices))), said
        assert {v for v in used if v < n} <= set(fill.rim.tolist()), said
        if not len(fill.split_edges[0]):
            assert all(before.get(edge, 0) < 2 for edge in edges(fill.faces)), said


def are_apart(points):
    """Else what is merged for one hole is merged for others too."""
    with np.errstate(all="ignore"):
        gaps = np.linalg.norm(points[:, None] - points, axis=2) + np.diag(np.full(len(points), np.inf))
        return len(points) > 0 and bool((gaps > 1e-5 * np.ptp(points)).all())


@pytest.mark.parametrize("seed", range(1000, 1000 + EXAMPLES // 3))
def test_all_holes_at_once_come_as_each_by_itself(seed):
    points, faces, what = spoiled_mesh(np.random.default_rng(seed))
    rims = tripatch.find_holes(faces)
    apart = are_apart(points[sorted({int(v) for rim in rims for v in rim})])
    for rim, result in zip(rims, tripatch.fill_all(points, faces, rims=rims), strict=True):
        alone = filled(points, faces, rim, {})
        assert isinstance(result, tripatch.Refusal) == (alone is None), (what, result)
        if alone is not None and apart:
            np.testing.assert_array_equal(result.vertices, alone.vertices)
            assert [*map(list, result.faces)] == [*map(list, alone.faces)], what
