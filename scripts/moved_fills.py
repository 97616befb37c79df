"""How far fills change when their mesh is turned, scaled or moved, on random holes: the larger ones are named by their seeds.

Of each fill: turned at random; 2.7 times, 1e9 times and 1.3e-9 times as large; moved by three sizes of the hole and by a million.
A million sizes off coordinates are rounded at 1e-10 of the hole; next to that fill stands what it would be near the origin, of
coordinates rounded in the same way: "far, but for that" tells what the place alone does.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import tripatch

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests/python"))
from random_holes import closed_mesh, hole_size, turned, wavy_hole, with_hole

SIDES = (0, 2, 3, 4, 5, 6, 7, 8)
SMALL, LARGE = 1e-7, 1e-3  # of the hole
MAX_ROWS = 5000  # of two sets of points, of which every distance is taken


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--holes", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0, help="of the first; each hole has the next one")
    parser.add_argument("--between", choices=("faces", "sides"), default="faces", help="faces: in closed meshes; or smooth sides")
    parser.add_argument("--output", choices=("triangles", "quads", "cage"), default="triangles")
    return parser.parse_args()


def hole(seed, between):
    """Points, faces, rim, and what the mesh is."""
    rng = np.random.default_rng(seed)
    if between == "faces":
        points, faces, what = closed_mesh(rng)
        left = with_hole(faces, rng)
        return points, left, max(tripatch.find_holes(left), key=len), what
    sides = SIDES[seed % len(SIDES)]
    points, left = wavy_hole(rng, sides)
    noisy = seed // len(SIDES) % 2
    points = points + noisy * 1e-3 * rng.normal(size=points.shape)
    rim = max(tripatch.find_holes(left), key=lambda loop: 0 in loop)
    return points, left, rim, f"{sides} sides" + ", noise" * noisy


def looks(points, size, seed):
    """The mesh elsewhere, and how to come back."""
    rng = np.random.default_rng(seed)
    turn, near = turned(rng), 3.1 * size * turned(rng)[0]
    away = 1e6 * size * turned(rng)[0]
    return {
        "turned": (points @ turn.T, lambda v: v @ turn),
        "2.7 times": (2.7 * points, lambda v: v / 2.7),
        "moved": (points + near, lambda v: v - near),
        "1e9 times": (1e9 * points, lambda v: v / 1e9),
        "1.3e-9 times": (1.3e-9 * points, lambda v: v / 1.3e-9),
        "far": (points + away, lambda v: v - away),
        "rounded": ((points + away) - away, lambda v: v),
    }


def filled(points, faces, rim, output):
    try:
        return tripatch.fill(points, faces, rim=rim, output=output)
    except tripatch.Refusal as refusal:
        return refusal


def apart(a, b):
    """The farthest that a point of either set is from the other."""
    if not len(a) or not len(b) or len(a) * len(b) > MAX_ROWS**2:
        return np.inf
    gaps = np.linalg.norm(a[:, None] - b, axis=2)
    return max(gaps.min(axis=0).max(), gaps.min(axis=1).max())


def change(fill, other, back, size):
    """Over the hole's size, or infinite where they are made in another way."""
    refused = [isinstance(each, tripatch.Refusal) for each in (fill, other)]
    if any(refused):
        return 0 if all(refused) and fill.reason == other.reason else np.inf
    if fill.report.method != other.report.method or len(fill.faces) != len(other.faces):
        return np.inf
    here, there = fill.vertices, back(other.vertices)
    by_row = np.abs(here - there).max(initial=0) if len(here) == len(there) else np.inf
    return (by_row if by_row < SMALL * size else min(by_row, apart(here, there))) / size


def changes(seed, between, output):
    points, faces, rim, what = hole(seed, between)
    size = hole_size(points, rim)
    fill, found, others = filled(points, faces, rim, output), {}, {}
    for name, (moved, back) in looks(points, size, seed).items():
        others[name] = filled(moved, faces, rim, output), back
        found[name] = change(fill, *others[name], size)
    found["far, but for that"] = change(others.pop("rounded")[0], *others["far"], size)
    found.pop("rounded")
    return what, found


def main():
    options = arguments()
    every = []
    try:
        for seed in range(options.seed, options.seed + options.holes):
            what, found = changes(seed, options.between, options.output)
            every.append(found)
            beyond = {name: f"{c:.1e}" for name, c in found.items() if c > SMALL}
            if beyond:
                print(f"seed {seed} ({what}): {beyond}", flush=True)
    except KeyboardInterrupt:
        pass
    print(f"\n| {len(every)} fills | beyond {SMALL:g} of the hole | beyond {LARGE:g} | within {SMALL:g} |\n|---|---|---|---|")
    for name in every[0] if every else ():
        of = np.array([found[name] for found in every])
        print(f"| {name} | {(of > SMALL).sum()} | {(of > LARGE).sum()} | {100 * (of <= SMALL).mean():.2f}% |")


if __name__ == "__main__":
    main()
