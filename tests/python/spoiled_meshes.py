"""Closed meshes with a hole, as people leave them behind: what is next to it is no surface. Everything follows from a seed."""

from __future__ import annotations

from collections import Counter

import numpy as np
import tripatch
from random_holes import closed_mesh, directed, with_hole

MAX_FACES = 900


def _longest_rim(faces):
    return [int(v) for v in max(tripatch.find_holes(faces), key=len, default=())]


def faces_on_backs(points, faces, rng):
    return points, faces + [face[::-1] for face in faces if rng.random() < 0.3]


def second_skin(points, faces, rng):
    """From behind and a little smaller, joined at the rim."""
    n, rim = len(points), {v for loop in tripatch.find_holes(faces) for v in loop}
    own = [v if v in rim and rng.random() < 0.9 else v + n for v in range(n)]
    return np.vstack([points, 0.9995 * points]), faces + [[own[v] for v in face[::-1]] for face in faces]


def twice(points, faces, _rng):
    return np.vstack([points, points]), faces + [[v + len(points) for v in face] for face in faces]


def turned_over(points, faces, rng):
    share = rng.choice([0.02, 0.2, 0.5])
    return points, [face[::-1] if rng.random() < share else face for face in faces]


def flaps(points, faces, rng):
    """Triangles that hang into the hole, or over it."""
    rim, new = _longest_rim(faces), []
    for k in rng.permutation(len(rim))[:3]:
        a, b = rim[k], rim[(k + 1) % len(rim)]
        share = rng.choice([0.2, 0.5, 0.9, 1.5])
        new.append((1 - share) * (points[a] + points[b]) / 2 + share * points[rim].mean(axis=0))
        face = [a, b, len(points) + len(new) - 1]
        faces = [*faces, face if rng.random() < 0.5 else face[::-1]]
    return np.vstack([points, *new]), faces


def bridges(points, faces, rng):
    rim = _longest_rim(faces)
    for _ in range(2 if len(rim) > 4 else 0):
        face = [rim[k] for k in sorted(rng.permutation(len(rim))[:3])]
        faces = [*faces, face if rng.random() < 0.7 else face[::-1]]
    return points, faces


def faces_without_area(points, faces, rng):
    points = points.copy()
    for k in rng.integers(len(faces), size=4):
        a, b, *_, last = faces[k]
        points[a] = points[b] if rng.random() < 0.5 else (points[b] + points[last]) / 2
    return points, faces


def vertices_in_rim_edges(points, faces, rng):
    rim, new = _longest_rim(faces), []
    for k in rng.permutation(len(rim))[:4]:
        a, b = rim[k], rim[(k + 1) % len(rim)]
        share = rng.choice([0, 0.5, 1e-9, rng.random()])
        new.append((1 - share) * points[a] + share * points[b])
        faces = [*faces, [a, b, len(points) + len(new) - 1]]
    return np.vstack([points, *new]), faces


def doubled_vertices(points, faces, rng):
    faces, points = [list(face) for face in faces], [*points]
    for k in rng.integers(len(faces), size=6):
        points.append(points[faces[k][0]])
        faces[k][0] = len(points) - 1
    return np.array(points), faces


def holes_that_touch(points, faces, rng):
    rim = _longest_rim(faces) or [0, 1]
    a, b = rng.permutation(rim)[:2].tolist()
    joined = [[a if v == b else v for v in face] for face in faces]
    return points, [face for face in joined if len(set(face)) == len(face)]


def not_finite(points, faces, rng):
    points = points.copy()
    points[rng.integers(len(points)), rng.integers(3)] = rng.choice([np.nan, np.inf, 1e308, -1e200, 1e39])
    return points, faces


def in_a_plane(points, faces, rng):
    return points * [1, 1, rng.choice([0, 1e-12, 1e-200])], faces


def at_a_point(points, faces, _rng):
    return 0 * points, faces


def bow_ties(points, faces, rng):
    faces = [list(face) for face in faces]
    for k in rng.integers(len(faces), size=3):
        if len(faces[k]) == 4:
            faces[k][1:3] = faces[k][2:0:-1]
    return points, faces


def folded_over_the_hole(points, faces, rng):
    rim, points = _longest_rim(faces), points.copy()
    middle = points[rim].mean(axis=0) if rim else points.mean(axis=0)
    for v in {v for face in faces if set(rim) & set(face) for v in face} - set(rim):
        points[v] = middle + rng.choice([0.2, 0.6, -0.5]) * (points[v] - middle)
    return points, faces


def spikes(points, faces, rng):
    rim, points = _longest_rim(faces) or [0], points.copy()
    points[rng.choice(rim)] += rng.normal(0, rng.choice([0.5, 5, 1e4]), 3)
    return points, faces


def mixed_up(points, faces, rng):
    return np.roll(points, int(rng.integers(1, 4)), axis=0), faces


SPOILT = (
    faces_on_backs, second_skin, twice, turned_over, flaps, bridges, faces_without_area, vertices_in_rim_edges, doubled_vertices,
    holes_that_touch, not_finite, in_a_plane, at_a_point, bow_ties, folded_over_the_hole, spikes, mixed_up,
)  # fmt: skip


def spoiled_mesh(rng):
    """Points, faces, and what was done to them."""
    points, faces, what = closed_mesh(rng)
    while len(faces) > MAX_FACES:
        points, faces, what = closed_mesh(rng)
    faces = with_hole(faces, rng)
    chosen = [SPOILT[k] for k in rng.permutation(len(SPOILT))[: int(rng.choice([1, 1, 2, 3]))]]
    for spoil in chosen:
        points, faces = spoil(points, faces, rng)
    return points, [[int(v) for v in face] for face in faces], ", ".join([what, *(spoil.__name__ for spoil in chosen)])


def edges(faces):
    """{pair of vertices, the lower first: faces there}."""
    count: Counter = Counter()
    for (a, b), faces_there in directed(faces).items():
        count[min(a, b), max(a, b)] += faces_there
    return count
