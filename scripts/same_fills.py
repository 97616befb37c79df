"""Whether other machines make the same fills: part of a release.

same_fills.py holes HOLES.npz --count 1000     generated holes
same_fills.py fill HOLES.npz FILLS.npz         on each machine: their fills
same_fills.py compare FILLS.npz OTHERS.npz     same faces, vertices within 1e-9 of the hole, or exit code 1

The holes are in a file, as other systems' NumPy makes other last bits.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

SAME = 1e-9  # of the hole: a hundred thousand times what a renderer shows


def make(path: Path, count: int, seed: int) -> None:
    """Half of the holes lie in faces of closed meshes, half between smooth sides."""
    from moved_fills import hole, hole_size

    arrays = {}
    for k in range(count):
        points, faces, rim, what = hole(seed + k, ("faces", "sides")[k % 2])
        arrays |= {f"{k}.points": points, f"{k}.corners": np.concatenate(faces), f"{k}.counts": [len(face) for face in faces]}
        arrays |= {f"{k}.rim": rim, f"{k}.size": hole_size(points, rim), f"{k}.what": f"seed {seed + k}, {what}"}
    np.savez_compressed(path, count=count, **arrays)


def split(corners: np.ndarray, counts: np.ndarray) -> list[list[int]]:
    return [part.tolist() for part in np.split(corners, np.cumsum(counts)[:-1])]


def fill(path: Path, out: Path, most: int | None) -> None:
    import tripatch

    with np.load(path) as holes:
        count = min(int(holes["count"]), most or sys.maxsize)
        arrays, begun = {}, time.monotonic()
        for k in range(count):
            name = f"{k}."
            faces = split(holes[name + "corners"], holes[name + "counts"])
            try:
                made = tripatch.fill(holes[name + "points"], faces, rim=holes[name + "rim"].tolist())
                arrays |= {name + "vertices": made.vertices, name + "refusal": ""}
                arrays |= {name + "corners": np.concatenate(made.faces), name + "counts": [len(face) for face in made.faces]}
                arrays[name + "method"] = made.report.method
            except tripatch.Refusal as refusal:
                arrays |= {name + "vertices": np.zeros((0, 3)), name + "refusal": refusal.reason, name + "method": "none"}
                arrays |= {name + "corners": np.zeros(0, int), name + "counts": np.zeros(0, int)}
            arrays |= {name + "size": holes[name + "size"], name + "what": holes[name + "what"]}
        np.savez_compressed(out, count=count, **arrays)
        print(f"{count} fills in {time.monotonic() - begun:.0f} s")


def compare(path: Path, other_path: Path) -> int:
    """How many fills differ."""
    with np.load(path) as one, np.load(other_path) as other:
        count = min(int(one["count"]), int(other["count"]))
        different, worst, refused = 0, 0.0, 0
        for k in range(count):
            name = f"{k}."

            def same(what: str, name: str = name) -> bool:
                return np.array_equal(one[name + what], other[name + what])

            refused += bool(str(one[name + "refusal"]))
            fault = ""
            if not same("refusal"):
                fault = f"refusal {str(one[name + 'refusal'])!r} or {str(other[name + 'refusal'])!r}"
            elif not (same("corners") and same("counts")):
                fault = f"other faces, by {one[name + 'method']} and {other[name + 'method']}"
            elif len(one[name + "vertices"]):
                away = float(np.abs(one[name + "vertices"] - other[name + "vertices"]).max() / one[name + "size"])
                worst = max(worst, away) if away <= SAME else worst
                fault = f"vertices {away:.1e} of the hole apart, by {one[name + 'method']}" if not away <= SAME else ""
            if fault:
                different += 1
                print(f"{one[name + 'what']}: {fault}")
        print(f"{count} fills, {refused} of them refused; {different} differ; the others by at most {worst:.1e} of the hole")
        return different


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=("holes", "fill", "compare"))
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE.npz")
    parser.add_argument("--count", type=int, help="holes (default: 1000, or all that the file has)")
    parser.add_argument("--seed", type=int, default=0, help="of the first hole (default: 0)")
    args = parser.parse_args()
    if args.command == "holes":
        make(args.files[0], args.count or 1000, args.seed)
    elif args.command == "fill":
        fill(args.files[0], args.files[1], args.count)
    else:
        return min(compare(args.files[0], args.files[1]), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
