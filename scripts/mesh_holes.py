"""Fills holes in all meshes of a folder and says how that went: the meshes' own, and patches of faces taken out at random.

A table: filled, refused and why, the worst time and the worst seam, fills that fold or cross themselves. Ends with 1 where one
came out wrong: an edge of three faces, or numbers that are not finite. Ctrl-C ends it with the table of what was done.
"""

from __future__ import annotations

import argparse
import csv
import io
import re
import sys
import time
from collections import Counter
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import tripatch
from tripatch.files import read

KINDS = {".obj", ".off", ".ply", ".stl", ".vtk"}
MAX_EDGES = 200
MAX_FACES = 50_000  # larger meshes cost the time of many
MAX_AT_ONCE, RINGS_BETWEEN = 8, 3
MAX_CROSSED = 400  # triangles of a fill that are compared, each with each
TOUCHING = 1e-6  # of the fill's size: what passes by less touches, as seams that lie upon each other do


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--holes", type=int, default=500, help="how many, over all meshes")
    parser.add_argument("--csv", type=Path, help="a row for every hole")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


def directed(faces):
    return {(int(a), int(b)) for face in faces for a, b in zip(face, [*face[1:], face[0]])}


def as_given(faces):
    """An array where all faces have one size, which is read faster."""
    return np.array(faces) if len({len(face) for face in faces}) == 1 else faces


def taken_out(faces, rng):
    """The faces without some rings around random ones, far from each other."""
    at = {}
    for f, face in enumerate(faces):
        for v in face:
            at.setdefault(v, []).append(f)

    def wider(some):
        return some | {g for f in some for v in faces[f] for g in at[v]}

    gone, taken = set(), set()
    for _ in range(MAX_AT_ONCE):
        part = {int(rng.integers(len(faces)))}
        for _ in range(int(rng.integers(0, 5))):
            part = wider(part)
        around = part
        for _ in range(RINGS_BETWEEN):
            around = wider(around)
        if not around & taken and len(gone) + len(part) < len(faces) / 2:
            gone, taken = gone | part, taken | around
    return [face for f, face in enumerate(faces) if f not in gone]


def crosses(points, triangles):
    """Whether an edge of some triangles goes through another of them that it has no vertex in common with."""
    edges = np.unique(np.sort(np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1), axis=0)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    near = TOUCHING * np.ptp(points[triangles.ravel()], axis=0).max()
    p, q = points[edges[:, 0]][:, None], points[edges[:, 1]][:, None]
    over, under = ((p - a) * normal).sum(axis=2), ((q - a) * normal).sum(axis=2)
    apart = ~(edges[:, :, None, None] == triangles[None, None]).any(axis=(1, 3))
    e, t = np.nonzero((over * under < 0) & (np.minimum(abs(over), abs(under)) > near) & apart)
    at = points[edges[e, 0]] + (over[e, t] / (over[e, t] - under[e, t]))[:, None] * (points[edges[e, 1]] - points[edges[e, 0]])
    left = [
        (np.cross(y[t] - x[t], at - x[t]) * normal[t]).sum(axis=1) > near * np.linalg.norm(y[t] - x[t], axis=1)
        for x, y in ((a, b), (b, c), (c, a))
    ]
    return bool(np.logical_and.reduce(left).any())


def of_fill(vertices, fill, before):
    added = [(int(a), int(b)) for face in fill.faces for a, b in zip(face, [*face[1:], face[0]])]
    wrong = len(set(added)) < len(added) or not before.isdisjoint(added) or not np.isfinite(fill.vertices).all()
    triangles = np.array([[f[0], f[k], f[k + 1]] for f in fill.faces for k in range(1, len(f) - 1)])
    row = {"result": "WRONG" if wrong else "filled", "method": fill.report.method, "faces": len(fill.faces)}
    row |= {"folded": fill.report.triangles_folded, "rim_folded": fill.report.rim_folded}
    # not along sides that are left free, as those where the mesh meets the hole at an angle are
    tangent = [a for a, c in zip(fill.report.seam_angle_max_by_side, fill.report.continuity) if c in ("G1", "G2")]
    row |= {"seam": max(tangent, default=0), "crossing": "", "reason": fill.report.method_reason}
    if len(triangles) <= MAX_CROSSED:
        row["crossing"] = int(crosses(np.concatenate([vertices, fill.vertices]), triangles))
    return row


def fill_one(vertices, faces, rim, before):
    start = time.process_time()
    row = {"edges": len(rim)}
    try:
        fill = tripatch.fill(vertices, faces, rim=rim)
    except tripatch.Refusal as refusal:
        return row | {"result": "refused", "reason": refusal.reason, "seconds": time.process_time() - start}
    return row | {"seconds": time.process_time() - start} | of_fill(vertices, fill, before)


def holes_of(path, rng, most):
    """Rows: of the mesh's own holes, then of such as are cut."""
    mesh = read(path)
    faces = [[int(v) for v in face] for face in mesh.faces]
    if not 0 < len(faces) <= MAX_FACES:
        return
    count, own = 0, set()
    for cut in range(1 + most):
        left = taken_out(faces, rng) if cut else faces
        before, given = directed(left), as_given(left)
        found = tripatch.choose_holes(mesh.vertices, given)  # not the borders of pieces that a cut has left
        rims = [rim for rim in found if len(rim) <= MAX_EDGES and tuple(rim) not in own]
        own |= {tuple(rim) for rim in rims} if not cut else set()
        for rim in rims[: most - count]:
            yield {"mesh": path.name, "cut": cut > 0} | fill_one(mesh.vertices, given, rim, before)
            count += 1
        if count >= most:
            return


def table(rows):
    filled = [row for row in rows if row["result"] == "filled"]
    print(f"{len(rows)} holes in {len({row['mesh'] for row in rows})} meshes: {len(filled)} filled", end="")
    tried = [row["crossing"] for row in filled if row["crossing"] != ""]
    folded, more = sum(row["folded"] > 0 for row in filled), sum(row["folded"] > row["rim_folded"] for row in filled)
    print(f" ({folded} of them with folds, {more} with more than their rims; {sum(tried)} of {len(tried)} cross themselves)")
    # sentences but for their numbers
    refused = [re.sub(r"[\d., ]*\d( and \d+)?", " N", row["reason"]) for row in rows if row["result"] == "refused"]
    for reason, count in Counter(refused).most_common():
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


NAMES = "mesh cut edges result method faces folded rim_folded crossing seam seconds reason".split()


def all_rows(paths, holes, rng):
    """Rows of all meshes, in any order: what has been done when it is stopped is a sample of all. Each mesh has as many holes."""
    done = 0
    for k, place in enumerate(rng.permutation(len(paths))):
        path = paths[place]
        try:
            for row in holes_of(path, rng, max(1, (holes - done) // (len(paths) - k))):
                done += 1
                yield row
        except (ValueError, OSError) as error:
            print(f"{path.name}: {error}", file=sys.stderr)


def main():
    given = arguments()
    paths = sorted(path for path in given.folder.rglob("*") if path.suffix.lower() in KINDS)
    rows = []
    with given.csv.open("w", newline="") if given.csv else nullcontext(io.StringIO()) as file:
        writer = csv.DictWriter(file, NAMES)
        writer.writeheader()
        try:
            for row in all_rows(paths, given.holes, np.random.default_rng(given.seed)):
                rows.append(row)
                writer.writerow(row)
                file.flush()
        except KeyboardInterrupt:
            print("stopped", file=sys.stderr)
    return table(rows)


if __name__ == "__main__":
    sys.exit(main())
