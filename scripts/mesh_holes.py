"""Fills holes in all meshes of a folder and says how that went: the meshes' own, and patches of faces taken out at random.

A table: filled, refused and why, the worst time and the worst seam. Ends with 1 where a fill came out wrong: an edge of three
faces, or numbers that are not finite.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import tripatch
from tripatch.files import read

KINDS = {".obj", ".off", ".ply", ".stl", ".vtk"}
MOST_EDGES = 200


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--holes", type=int, default=500, help="how many, over all meshes")
    parser.add_argument("--csv", type=Path, help="a row for every hole")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


def directed(faces):
    return Counter((int(a), int(b)) for face in faces for a, b in zip(face, [*face[1:], face[0]]))


def taken_out(faces, rng):
    """The faces without some rings around a random one."""
    at = {}
    for f, face in enumerate(faces):
        for v in face:
            at.setdefault(v, []).append(f)
    gone = {int(rng.integers(len(faces)))}
    for _ in range(int(rng.integers(0, 5))):
        gone |= {g for f in list(gone) for v in faces[f] for g in at[v]}
    return [face for f, face in enumerate(faces) if f not in gone] if len(gone) < len(faces) / 2 else faces


def fill_one(vertices, faces, rim, directed_before):
    start = time.process_time()
    row = {"edges": len(rim)}
    try:
        fill = tripatch.fill(vertices, faces, rim=rim)
    except tripatch.Refusal as refusal:
        row |= {"result": "refused", "reason": refusal.reason}
    else:
        added = directed(fill.faces)
        doubled = any(count > 1 or directed_before.get(edge) for edge, count in added.items())
        wrong = doubled or not np.isfinite(fill.vertices).all()
        row |= {"result": "WRONG" if wrong else "filled", "method": fill.report.method, "faces": len(fill.faces)}
        row |= {"folded": fill.report.triangles_folded, "seam": fill.report.seam_angle_max}
    return row | {"seconds": time.process_time() - start}


def holes_of(path, rng, most):
    """Rows: of the mesh's own holes, then of such as are cut."""
    mesh = read(path)
    faces = [[int(v) for v in face] for face in mesh.faces]
    count = 0
    for cut in range(1 + most):
        left = taken_out(faces, rng) if cut else faces
        before = directed(left)
        rims = [rim for rim in tripatch.find_holes(left) if len(rim) <= MOST_EDGES]
        if cut:
            rims = [rims[int(rng.integers(len(rims)))]] if rims else []
        for rim in rims[: most - count]:
            yield {"mesh": path.name, "cut": cut > 0} | fill_one(mesh.vertices, left, rim, before)
            count += 1
        if count >= most:
            return


def table(rows):
    filled = [row for row in rows if row["result"] == "filled"]
    print(f"{len(rows)} holes in {len({row['mesh'] for row in rows})} meshes: {len(filled)} filled", end="")
    print(f" ({sum(row['folded'] > 0 for row in filled)} of them with folds)")
    for reason, count in Counter(row["reason"] for row in rows if row["result"] == "refused").most_common():
        print(f"  {count} refused: {reason}")
    if filled:
        slowest = max(rows, key=lambda row: row["seconds"])
        exact = [row for row in filled if row["method"] != "polyharmonic_spline"]
        print(f"  longest: {slowest['seconds']:.2f} s, {slowest['edges']} edges, {slowest['mesh']}")
        print(f"  methods: {dict(Counter(row['method'] for row in filled))}")
        if exact:
            worst = max(exact, key=lambda row: row["seam"])
            print(f"  worst seam of exact patches: {worst['seam']:.3g} deg, {worst['edges']} edges, {worst['mesh']}")
    wrong = [row for row in rows if row["result"] == "WRONG"]
    for row in wrong:
        print(f"WRONG: {row}")
    return 1 if wrong else 0


def main():
    given = arguments()
    paths = sorted(path for path in given.folder.rglob("*") if path.suffix.lower() in KINDS)
    rng = np.random.default_rng(given.seed)
    rows = []
    for k, path in enumerate(paths):
        share = max(1, (given.holes - len(rows)) // (len(paths) - k))
        try:
            rows += holes_of(path, rng, share)
        except (ValueError, OSError) as error:
            print(f"{path.name}: {error}", file=sys.stderr)
    if given.csv:
        names = ["mesh", "cut", "edges", "result", "method", "faces", "folded", "seam", "seconds", "reason"]
        with given.csv.open("w", newline="") as file:
            writer = csv.DictWriter(file, names)
            writer.writeheader()
            writer.writerows(rows)
    return table(rows)


if __name__ == "__main__":
    sys.exit(main())
