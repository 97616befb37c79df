"""Random holes in random closed meshes. Longer by scripts/nightly: TRIPATCH_EXAMPLES is how many."""

from __future__ import annotations

import os

import numpy as np
import pytest
import tripatch
from hypothesis import given, settings
from hypothesis import strategies as st
from random_holes import SHAPES, as_seen, closed_mesh, directed, hole_size, is_manifold, turned, with_hole

EXAMPLES = int(os.environ.get("TRIPATCH_EXAMPLES", "30"))
SPOILT = ["none", "triangles", "noise", "stretched", "bumps"]


@st.composite
def holes(draw, spoilt=SPOILT):
    """Points, faces, rims, and a generator for more."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    points, faces, _ = closed_mesh(rng, draw(st.sampled_from(sorted(SHAPES))), draw(st.sampled_from(spoilt)))
    left = with_hole(faces, rng)
    return points, left, tripatch.find_holes(left), rng


def filled(points, faces, rim, **options):
    try:
        return tripatch.fill(points, faces, rim=rim, **options)
    except tripatch.Refusal as refusal:
        return refusal


def check_refusal(refusal, points, rim):
    """It names vertices that are there, in a sentence."""
    assert refusal.reason[:1].isupper() and len(refusal.reason) > 10
    assert all(0 <= v < len(points) for v in refusal.where)


@settings(max_examples=EXAMPLES, deadline=None, derandomize=EXAMPLES == 30)
@given(holes(), st.sampled_from(["triangles", "quads"]), st.sampled_from(["auto", "auto", "polyharmonic_spline"]))
def test_the_filled_mesh_is_closed_and_oriented(hole, output, method):
    points, faces, rims, _ = hole
    before = points.copy()
    whole = [list(face) for face in faces]
    added = []
    count = len(points)
    for rim in rims:
        fill = filled(points, faces, rim, output=output, method=method)
        assert (points == before).all()
        if isinstance(fill, tripatch.Refusal):
            check_refusal(fill, points, rim)
            return
        assert np.isfinite(fill.vertices).all() and np.isfinite(fill.normals).all()
        assert set(fill.rim) == {int(v) for v in rim}
        shift = count - len(points)
        new = [[int(v) + (shift if v >= len(points) else 0) for v in face] for face in fill.faces]
        if len(fill.split_edges[0]):
            return
        # of default triangles never more than the rim asks for
        assert len(new) <= 5 * len(rim) ** 2
        added += new
        count += len(fill.vertices)
    assert is_manifold(faces)
    together = directed(whole + added)
    assert max(together.values()) == 1
    assert all((b, a) in together for a, b in together), "no border is left"


LOOKS = ["as it is", "mirrored", "relabelled"]


@settings(max_examples=EXAMPLES, deadline=None, derandomize=EXAMPLES == 30)
@given(holes(), st.sampled_from(LOOKS), st.sampled_from(["triangles", "quads"]))
def test_however_it_is_written_down_the_rim_stays_and_sides_are_met(hole, look, output):
    points, faces, rims, rng = hole
    points, faces, number = as_seen(points, faces, look, rng)
    before = points.copy()
    for rim in rims:
        fill = filled(points, faces, number[rim], output=output)
        assert (points == before).all()
        if isinstance(fill, tripatch.Refusal):
            check_refusal(fill, points, rim)
            continue
        assert set(fill.rim) == set(number[rim].tolist())
        added, there = directed(fill.faces), directed(faces)
        assert max(added.values()) == 1 and not any(edge in there for edge in added)
        if not len(fill.split_edges[0]):  # else the face next to it is to take the new vertex
            assert all((b, a) in added or (b, a) in there for a, b in added), "the fill is closed, and its rim is the mesh's"
        # degrees: of exact derivatives, so that what is left is rounding, at corners with a kink most
        kept = [a for a, side in zip(fill.report.seam_angle_max_by_side, fill.report.continuity) if side in ("G1", "G2")]
        assert max(kept, default=0) < 1e-4


def more_folded_than_rim(seed):
    """What the mesh is, and the edges of its rims whose fills fold more than they do."""
    rng = np.random.default_rng(1000 + seed)
    points, faces, what = closed_mesh(rng)
    points, faces, number = as_seen(points, with_hole(faces, rng), LOOKS[seed % 3], rng)
    folded = []
    for rim in tripatch.find_holes(faces):
        fill = filled(points, faces, rim, output=("triangles", "quads")[seed % 2])
        if not isinstance(fill, tripatch.Refusal) and fill.report.triangles_folded > fill.report.rim_folded:
            folded.append((seed, what, len(rim)))
    return folded


def test_fills_fold_only_where_their_rims_do():
    """But for one in a hundred: those are counted, so that they become no more."""
    folded = [found for seed in range(max(100, EXAMPLES)) for found in more_folded_than_rim(seed)]
    assert len(folded) <= max(100, EXAMPLES) // 100, folded


@pytest.mark.parametrize("seed", [193, 667, 19347, 19415])
def test_quads_of_triangles_fold_no_more_than_those(seed):
    assert not more_folded_than_rim(seed)


@settings(max_examples=EXAMPLES // 2, deadline=None, derandomize=EXAMPLES == 30)
@given(holes(["none", "triangles", "noise", "bumps"]))
def test_a_fill_is_the_same_moved_and_scaled(hole):
    points, faces, rims, rng = hole
    rim = rims[0]
    fill = filled(points, faces, rim)
    if isinstance(fill, tripatch.Refusal) or fill.report.triangles_folded:
        return
    size = hole_size(points, rim)
    turn, factor = turned(rng), 10 ** rng.uniform(-9, 9)
    there = filled(factor * (points @ turn.T), faces, rim)
    assert not isinstance(there, tripatch.Refusal) and there.report.method == fill.report.method
    assert len(there.vertices) == len(fill.vertices)
    change = np.abs(there.vertices @ turn / factor - fill.vertices).max(initial=0) / size
    assert change < (1e-7 if EXAMPLES == 30 else 1e-3)


@settings(max_examples=EXAMPLES // 2, deadline=None, derandomize=EXAMPLES == 30)
@given(holes(["noise"]), st.sampled_from(["mirrored", "relabelled"]))
def test_a_fill_is_the_same_however_the_mesh_is_written(hole, look):
    """Of uneven meshes: in even ones a hole may be its own image."""
    points, faces, rims, rng = hole
    rim = rims[0]
    fill = filled(points, faces, rim)
    there, others, number = as_seen(points, faces, look, rng)
    other = filled(there, others, number[rim])
    assert isinstance(other, tripatch.Refusal) == isinstance(fill, tripatch.Refusal)
    if isinstance(fill, tripatch.Refusal) or fill.report.triangles_folded:
        return
    assert other.report.method == fill.report.method and len(other.vertices) == len(fill.vertices)
    back = [-1, 1, 1] if look == "mirrored" else [1, 1, 1]
    gaps = np.linalg.norm((other.vertices * back)[:, None] - fill.vertices, axis=2)
    change = max(gaps.min(axis=0).max(), gaps.min(axis=1).max()) / hole_size(points, rim) if gaps.size else 0
    assert change < (1e-7 if EXAMPLES == 30 else 1e-3)


@settings(max_examples=EXAMPLES // 2, deadline=None, derandomize=EXAMPLES == 30)
@given(holes(["none", "triangles", "noise", "bumps"]))
def test_all_at_once_backwards_and_one_by_one_are_the_same(hole):
    """And so on one thread and on several: a fill alone is computed on all cores, those of several at once on one core each."""
    points, faces, rims, rng = hole
    more = with_hole(faces, rng, 0.02)
    rims = tripatch.find_holes(more)
    order = rng.permutation(len(rims))
    together = tripatch.fill_all(points, more, [rims[k] for k in order])
    for k, result in zip(order, together):
        alone = filled(points, more, rims[k])
        assert isinstance(result, tripatch.Refusal) == isinstance(alone, tripatch.Refusal)
        if isinstance(alone, tripatch.Refusal):
            assert result.reason == alone.reason
        else:
            assert (result.vertices == alone.vertices).all()


@settings(max_examples=EXAMPLES // 2, deadline=None, derandomize=EXAMPLES == 30)
@given(holes(["none", "triangles", "bumps"]))
def test_in_single_precision_it_is_nearly_the_same_hole(hole):
    points, faces, rims, _ = hole
    rough = points.astype(np.float32).astype(np.float64)
    for rim in rims[:1]:
        a, b = filled(points, faces, rim), filled(rough, faces, rim)
        assert isinstance(a, tripatch.Refusal) == isinstance(b, tripatch.Refusal)
        if not isinstance(b, tripatch.Refusal):
            assert np.isfinite(b.vertices).all()
            together = directed([*faces, *[list(face) for face in b.faces]])
            assert max(together.values()) == 1


@pytest.mark.parametrize("shape", sorted(SHAPES))
def test_the_meshes_are_closed(shape):
    points, faces, _ = closed_mesh(np.random.default_rng(1), shape, "triangles")
    assert is_manifold(faces) and all((b, a) in directed(faces) for a, b in directed(faces))
    p = points[np.array(faces)]
    assert np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() > 0, "outwards"
