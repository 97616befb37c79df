"""docs/figures.md: distances, angles, folds and order of convergence on ten holes with known answers, and the time of a fill."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

import numpy as np
import tripatch

from . import baselines, holes, metrics
from .page import Setting, provenance

DENSITIES = (8, 16, 32)
#: holes of the summary
LIMIT_NORMAL = ("sphere", "suitcase", "suzanne")
DISTANCE = ("sphere", "suitcase", "torus")
CONVERGE = ("sphere", "suitcase", "torus", "saddle")
#: whose time is taken -> options
OPTIONS = {"TriPatch, default options": {}, "TriPatch with fairing=None": {"fairing": None}}
CGAL = {k: f"CGAL's refine and fair, continuity {k}" for k in (1, 2)}


def measure(hole: holes.Hole) -> dict:
    fill = tripatch.fill(hole.vertices, hole.faces, rim=hole.rim, corners=hole.corners, method="side_vertex")
    vertices, faces = np.concatenate([hole.vertices, fill.vertices]), np.array(fill.faces)
    normals = metrics.limit_normals(vertices, faces, hole.rim)
    exact = fill.rim_normals[np.argsort(fill.rim)][np.argsort(np.argsort(hole.rim))]
    result = {
        "triangles": len(faces),
        "seam": metrics.seam(fill.patch, fill.sides),
        "surroundings": fill.report.surroundings_error,
        "limit": metrics.rms(metrics.angle(normals, hole.rim_normals)),
        "exact": metrics.rms(metrics.angle(exact, hole.rim_normals)),
        "folds": fill.report.folds,
        "mesh_folds": metrics.mesh_folds(vertices, faces),
    }
    if hole.nearest:
        result["vertices"] = metrics.distance(hole, vertices[np.unique(faces)])
        result["surface"] = metrics.distance(hole, metrics.surface_points(fill.patch))
    return result


def timings(cgal: str | None, folder: Path, repetitions: int) -> dict:
    """Seconds, the least of the repetitions, of a sphere octant with 100 edges a side: arrays in, arrays out."""
    hole = holes.sphere(100)
    result = {}
    for name, options in OPTIONS.items():
        least = np.inf
        for _ in range(repetitions):
            start = time.perf_counter()
            fill = tripatch.fill(hole.vertices, hole.faces, rim=hole.rim, corners=hole.corners, **options)
            least = min(least, time.perf_counter() - start)
        result[name] = (len(fill.faces), least)
    if cgal:
        given = folder / "sphere-100.txt"
        baselines.write_hole(hole, given)
        for continuity in (1, 2):
            command = [cgal, str(given), str(continuity), str(repetitions)]
            words = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
            result[CGAL[continuity]] = (int(words[0]), min(map(float, words[1:])))
    return result


def table(results: dict, times: dict, densities: tuple) -> str:
    last = densities[-1]

    def row(what, values):
        return f"| {what} | {values} |"

    def all_of(names, key):
        return ", ".join(f"{name} {results[name][last][key]:.3g}" for name in names if name in results)

    seam = max(results, key=lambda name: results[name][last]["seam"])
    folded = {name: folds for name, r in results.items() if (folds := r[last]["folds"] + r[last]["mesh_folds"])}
    orders = {name: metrics.order([results[name][n]["limit"] for n in densities]) for name in CONVERGE if name in results}
    lines = [
        f"## Summary (n = {last} unless said)",
        "",
        "| what | measured |",
        "|---|---|",
        row("largest angle between the patch and the surroundings used, degrees", f"{results[seam][last]['seam']:.1e} ({seam})"),
        row("limit normals against the true normals, rms degrees", all_of(LIMIT_NORMAL, "limit")),
        row(
            f"order of convergence of that, n = {', '.join(map(str, densities))}",
            ", ".join(f"{name} {value:.2f}" for name, value in orders.items()),
        ),
        row("rms distance to the truth / diameter, vertices", all_of(DISTANCE, "vertices")),
        row("the same, 10,000 area-uniform points of the patch", all_of(DISTANCE, "surface")),
        row("folds of patch and mesh, all cases", folded or "0"),
    ]
    for name in OPTIONS if CGAL[1] in times else ():
        ratio = times[CGAL[1]][1] / times[name][1]
        lines.append(row(f"time of 10,000 triangles, {name}, against {CGAL[1]}", f"{ratio:.1f} times faster"))
    lines += ["", "## Every case", "", "Angles in degrees, distances over the diameter of the hole.", ""]
    lines += [
        "| hole | n | triangles | seam | accuracy of the mesh | limit normals | exact normals | vertices | surface | folds |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for name, by_density in results.items():
        for n, r in by_density.items():
            numbers = [f"{r[key]:.2g}" for key in ("seam", "surroundings", "limit", "exact")]
            numbers += [f"{r[key]:.2e}" if key in r else "" for key in ("vertices", "surface")]
            lines.append(f"| {name} | {n} | {r['triangles']} | {' | '.join(numbers)} | {r['folds'] + r['mesh_folds']} |")
    lines += ["", "## Time of one fill, sphere, 100 edges a side", "", "| filler | triangles | seconds |", "|---|---|---|"]
    lines += [f"| {name} | {count} | {seconds:.5f} |" for name, (count, seconds) in times.items()]
    return "\n".join(lines) + "\n"


HEAD = """# Accuracy

{provenance}

Ten holes with four rings of faces around each (`scripts/comparison/holes.py`), n edges a side. The columns
(`scripts/comparison/metrics.py`):

- **seam**: the largest angle between the smooth patch and the tangent planes used, from exact derivatives at 200 points a side.
  **accuracy of the mesh**: how accurately the mesh defines those planes, as the fill reports it.
- **limit normals**: rms angle at the boundary between the true normal of the surroundings and the limit normal of the new
  triangles, by a local cubic fit. The fit has an error of its own. **exact normals**: the same with the fill's exact normals.
- **vertices**, **surface**: rms distance to the true surface, of the fill's vertices and of 10,000 points spread evenly over the
  patch.
- **folds**: of the patch (on a grid) and of the triangles.

"""


def write(setting: Setting) -> None:
    densities = DENSITIES[:2] if setting.quick else DENSITIES
    cases = holes.ten(setting.cache, setting.blender)
    if setting.quick:
        cases = {name: cases[name] for name in ("sphere", "suitcase")}
    results = {}
    for name, make in cases.items():
        results[name] = {n: measure(make(n)) for n in densities}
        print(name, {key: f"{value:.3g}" for key, value in results[name][densities[-1]].items()}, flush=True)
    times = timings(setting.cgal, setting.cache, 1 if setting.quick else 15)
    options = (
        "vertices, faces, the rim with its corners and the method side_vertex; all else at its default, but for the time "
        "said to be without fairing"
    )
    text = HEAD.format(provenance=provenance(options, setting.quick)) + table(results, times, densities)
    (setting.docs / "figures.md").write_text(text)
