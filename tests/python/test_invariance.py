"""A fill does not hang on round-off: the mesh turned, moved, scaled, or its rim given otherwise, it is the same fill."""

from __future__ import annotations

import numpy as np
import pytest
import tripatch
from random_holes import closed_mesh, hole_size, ring_mesh, turned, with_hole
from shapes import cube, cube_sphere


def moves(points, size, seed):
    """The mesh elsewhere, and how to come back."""
    rng = np.random.default_rng(seed)
    turn, away = turned(rng), 1e6 * size * turned(rng)[0]
    return {
        "turned": (points @ turn.T, lambda v: v @ turn),
        "scaled and moved": (2 * points + 3.1, lambda v: (v - 3.1) / 2),
        "enlarged": (1e9 * points, lambda v: v / 1e9),
        "shrunk": (1.3e-9 * points, lambda v: v / 1.3e-9),
        "far away": (points + away, lambda v: v - away),
    }


def changes(points, faces, rim, seed, **options):
    """How far the new vertices move by each way of looking at the mesh, over the hole's size; of a fill that does not fold."""
    size = hole_size(points, rim)
    fill = tripatch.fill(points, faces, rim=rim, **options)
    found = {}
    for name, (moved, back) in moves(points, size, seed).items():
        other = tripatch.fill(moved, faces, rim=rim, **options)
        assert other.report.method == fill.report.method, name
        assert len(other.vertices) == len(fill.vertices), name
        found[name] = np.abs(back(other.vertices) - fill.vertices).max(initial=0) / size
    other = tripatch.fill(points, faces, rim=np.roll(rim, 2)[::-1], **options)
    assert len(other.vertices) == len(fill.vertices)
    gaps = np.linalg.norm(other.vertices[:, None] - fill.vertices[None], axis=2)
    found["rim backwards"] = gaps.min(axis=0).max() / size if gaps.size else 0
    return found


@pytest.mark.parametrize(
    ("mesh", "gone"),
    [
        (lambda: cube_sphere(4), 4),
        (lambda: cube_sphere(6), 20),
        (lambda: cube(4), 5),
        (lambda: ring_mesh(12, 6), 1),
        (lambda: ring_mesh(16, 8), 9),
    ],
    ids=["ball", "half a ball", "box", "one quad of a ring", "ring"],
)
def test_where_much_is_equal_rounding_does_not_choose(mesh, gone):
    """Symmetric meshes: angles, areas and lengths that are the same but for their last bits."""
    points, faces = mesh()
    left = faces[gone:]
    rim = max(tripatch.find_holes(left), key=len)
    found = changes(points, left, rim, 3, method="polyharmonic_spline")
    assert max(found.values()) < 1e-7, found


#: Boxes whose creases fit each other equally well in several ways, run along the rim or over its vertices, or meet a rim in
#: a line, and whose corners have two feet on what is laid under them.
HARD = [1099, 1100, 1178, 10031, 10065, 10477, 10520, 10946, 10982, 11014, 20377, 21242, 31759, 50545]


#: Sides that meet at corners where a plane is known well along one of them only, and rims whose triangulations are equally good.
CORNERS = [
    (100938, "quads", "bumps"),
    (101639, "ring", "bumps"),
    (201378, "quads", "bumps"),
    (200368, "quads", "triangles"),
    (200626, "honeycomb", "triangles"),
    (501060, "box", "none"),  # a rim that steps in and out of its own plane
]


@pytest.mark.parametrize(("seed", "shape", "spoil"), CORNERS)
def test_planes_at_corners_and_choices_among_triangles_do_not_hang_on_rounding(seed, shape, spoil):
    rng = np.random.default_rng(seed)
    points, faces, _ = closed_mesh(rng, shape, spoil)
    left = with_hole(faces, rng)
    found = changes(points, left, tripatch.find_holes(left)[0], seed)
    assert max(found.values()) < 1e-7, found


@pytest.mark.parametrize("seed", [*range(30), *HARD])
def test_random_holes(seed):
    rng = np.random.default_rng(seed)
    points, faces, _ = closed_mesh(rng, spoil=str(rng.choice(["none", "triangles", "noise", "bumps"])))
    left = with_hole(faces, rng)
    rims = [rim for rim in tripatch.find_holes(left) if len(rim) < 60]
    for rim in rims[:1]:
        try:
            fill = tripatch.fill(points, left, rim=rim)
        except tripatch.Refusal:
            with pytest.raises(tripatch.Refusal):
                tripatch.fill(2 * points + 3.1, left, rim=rim)
            continue
        if fill.report.triangles_folded:
            continue
        found = changes(points, left, rim, seed)
        assert max(found.values()) < 1e-7, found
