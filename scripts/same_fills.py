"""Whether other machines make the same fills: part of a release.

same_fills.py holes HOLES.npz --count 1000            generated holes; --edges 16: with so many edges at most
same_fills.py fill HOLES.npz FILLS.npz                on each machine: their fills; --jobs 4: by so many processes
same_fills.py compare HOLES.npz FILLS.npz OTHERS.npz  same faces, vertices within 1e-9 of the hole, or exit code 1

The holes are in a file, as other systems' NumPy makes other last bits. Where vertices are farther apart, the hole is filled
here a few times more, its mesh moved by last bits: what that moves half as far is decided by rounding, on one machine as well.
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import itertools
import multiprocessing
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import tripatch

SAME = 1e-9  # of the hole: a hundred thousand times what a renderer shows
MOVED = 8  # times: other compilers round otherwise at every step, each of these at the first one only


def make(path: Path, count: int, seed: int, edges: int) -> None:
    """Half of the seeds are holes in faces of closed meshes, half between smooth sides."""
    from moved_fills import hole, hole_size

    arrays: dict[str, object] = {}
    every = ((at, *hole(at, ("faces", "sides")[(at - seed) % 2])) for at in itertools.count(seed))
    wanted = (each for each in every if len(each[3]) <= edges)
    for k, (at, points, faces, rim, what) in enumerate(itertools.islice(wanted, count)):
        arrays |= {f"{k}.points": points, f"{k}.corners": np.concatenate(faces), f"{k}.counts": [len(face) for face in faces]}
        arrays |= {f"{k}.rim": rim, f"{k}.size": hole_size(points, rim), f"{k}.what": f"seed {at}, {what}"}
    np.savez_compressed(path, count=count, **arrays)


def split(corners: np.ndarray, counts: np.ndarray) -> list[list[int]]:
    return [part.tolist() for part in np.split(corners, np.cumsum(counts)[:-1])]


def filled(holes: Mapping[str, np.ndarray], name: str, points: np.ndarray) -> tripatch.Fill:
    import tripatch

    return tripatch.fill(points, split(holes[name + "corners"], holes[name + "counts"]), rim=holes[name + "rim"].tolist())


def moved_by_rounding(holes: Mapping[str, np.ndarray], name: str, vertices: np.ndarray) -> float:
    """The farthest that these vertices of a fill are, over the hole's size, from those of its mesh moved by a last bit."""
    import tripatch

    points, farthest = holes[name + "points"], 0.0
    for seed in range(MOVED):
        bits = np.random.default_rng(seed).integers(-1, 2, points.shape)
        try:
            moved = filled(holes, name, points + bits * np.spacing(points)).vertices
        except tripatch.Refusal:
            return np.inf
        farthest = max(farthest, float(np.abs(moved - vertices).max()) if moved.shape == vertices.shape else np.inf)
    return farthest / float(holes[name + "size"])


@functools.cache
def opened(path: Path) -> Mapping[str, np.ndarray]:
    """For one process: processes that share an open file read what others skipped."""
    return np.load(path)


def filled_one(path: Path, k: int) -> dict[str, object]:
    import tripatch

    holes, name = opened(path), f"{k}."
    about: dict[str, object] = {name + "size": holes[name + "size"], name + "what": holes[name + "what"]}
    try:
        made = filled(holes, name, holes[name + "points"])
    except tripatch.Refusal as refusal:
        about |= {name + "vertices": np.zeros((0, 3)), name + "refusal": refusal.reason, name + "method": "none"}
        return about | {name + "corners": np.zeros(0, int), name + "counts": np.zeros(0, int)}
    about |= {name + "vertices": made.vertices, name + "refusal": "", name + "method": made.report.method}
    return about | {name + "corners": np.concatenate(made.faces), name + "counts": [len(face) for face in made.faces]}


def fill(path: Path, out: Path, most: int | None, jobs: int) -> None:
    with np.load(path) as holes:
        count = min(int(holes["count"]), most or sys.maxsize)
    arrays, begun = {}, time.monotonic()
    with multiprocessing.Pool(jobs) if jobs > 1 else contextlib.nullcontext() as pool:
        for k, one in enumerate((pool.imap if pool else map)(functools.partial(filled_one, path), range(count)), 1):
            arrays |= one
            if k % 100 == 0 or k == count:
                print(f"{k} of {count} fills, {time.monotonic() - begun:.0f} s", flush=True)
    np.savez_compressed(out, count=count, **arrays)


def compare(holes_path: Path, path: Path, other_path: Path) -> int:
    """How many fills differ by more than rounding."""
    with np.load(holes_path) as holes, np.load(path) as one, np.load(other_path) as other:
        count = min(int(one["count"]), int(other["count"]))
        different, rounded, worst, refused = 0, 0, 0.0, 0
        for k in range(count):
            name = f"{k}."

            def same(what: str, name: str = name) -> bool:
                return np.array_equal(one[name + what], other[name + what])

            refused += bool(str(one[name + "refusal"]))
            fault, within = "", False
            if not same("refusal"):
                fault = f"refusal {str(one[name + 'refusal'])!r} or {str(other[name + 'refusal'])!r}"
            elif not (same("corners") and same("counts")):
                fault = f"other faces, by {one[name + 'method']} and {other[name + 'method']}"
            elif len(one[name + "vertices"]):
                away = float(np.abs(one[name + "vertices"] - other[name + "vertices"]).max() / one[name + "size"])
                if away <= SAME:
                    worst = max(worst, away)
                    continue
                alone = moved_by_rounding(holes, name, one[name + "vertices"])
                fault = f"vertices {away:.1e} of the hole apart, by {one[name + 'method']}; last bits move it here by {alone:.1e}"
                within = away <= 2 * alone  # each of the two is that far from where no rounding would have it
            if fault:
                different += not within
                rounded += within
                print(f"{'decided by rounding' if within else 'DIFFERENT'}: {one[name + 'what']}: {fault}")
        print(f"{count} fills, {refused} of them refused; {different} differ, {rounded} more are decided by rounding;")
        print(f"the others are at most {worst:.1e} of the hole apart")
        return different


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=("holes", "fill", "compare"))
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE.npz")
    parser.add_argument("--count", type=int, help="holes (default: 1000, or all that the file has)")
    parser.add_argument("--seed", type=int, default=0, help="of the first hole (default: 0)")
    parser.add_argument("--edges", type=int, default=sys.maxsize, help="that a hole has at most")
    parser.add_argument("--jobs", type=int, default=1, help="processes that fill")
    args = parser.parse_args()
    if args.command == "holes":
        make(args.files[0], args.count or 1000, args.seed, args.edges)
    elif args.command == "fill":
        fill(args.files[0], args.files[1], args.count, args.jobs)
    else:
        return min(compare(*args.files), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
