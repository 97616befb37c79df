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
#: name -> greatest value, of the largest density
LIMIT_NORMAL = {"sphere": 0.05, "suitcase": 0.05, "suzanne": 0.13}
DISTANCE = {"sphere": 1.2e-2, "suitcase": 1.2e-2, "torus": 4e-3}
CONVERGE = ("sphere", "suitcase", "torus", "saddle")
SEAM, ORDER, TIMES_FASTER = 1e-4, 2.0, 20.0
WITHOUT_FAIRING = "TriPatch with fairing=None"
#: whose time is taken -> options
OPTIONS = {"TriPatch, default options": {}, WITHOUT_FAIRING: {"fairing": None}}
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

    def row(what, wanted, values, good):
        return f"| {what} | {wanted} | {values} | {'yes' if good else '**no**'} |"

    def all_of(limits, key):
        known = {name: limit for name, limit in limits.items() if name in results}
        values = ", ".join(f"{name} {results[name][last][key]:.3g}" for name in known)
        return values, len(known) == len(limits) and all(results[name][last][key] <= limit for name, limit in known.items())

    def bounds(limits):
        return "; ".join(f"{name} {limit:g}" for name, limit in limits.items())

    seam = max(results, key=lambda name: results[name][last]["seam"])
    folded = {name: folds for name, r in results.items() if (folds := r[last]["folds"] + r[last]["mesh_folds"])}
    orders = {name: metrics.order([results[name][n]["limit"] for n in densities]) for name in CONVERGE if name in results}
    lines = [
        f"## Summary (n = {last} unless said)",
        "",
        "| what | wanted | measured | reached |",
        "|---|---|---|---|",
        row(
            "largest angle between the patch and the surroundings used, degrees",
            f"{SEAM:g} or less, all cases",
            f"{results[seam][last]['seam']:.1e} ({seam})",
            results[seam][last]["seam"] <= SEAM,
        ),
        row("limit normals against the true normals, rms degrees", bounds(LIMIT_NORMAL), *all_of(LIMIT_NORMAL, "limit")),
        row(
            f"order of convergence of that, n = {', '.join(map(str, densities))}",
            f"{ORDER:g} or more",
            ", ".join(f"{name} {value:.2f}" for name, value in orders.items()),
            min(orders.values()) >= ORDER,
        ),
        row("rms distance to the truth / diameter, vertices", bounds(DISTANCE), *all_of(DISTANCE, "vertices")),
        row("the same, 10,000 area-uniform points of the patch", bounds(DISTANCE), *all_of(DISTANCE, "surface")),
        row("folds of patch and mesh, all cases", "0", folded or "0", not folded),
    ]
    for name in OPTIONS if CGAL[1] in times else ():
        ratio = times[CGAL[1]][1] / times[name][1]
        wanted = f"{TIMES_FASTER:g} times faster or more" if name == WITHOUT_FAIRING else ""
        reached = ratio >= TIMES_FASTER or not wanted
        lines.append(row(f"time of 10,000 triangles, {name}, against {CGAL[1]}", wanted, f"{ratio:.1f} times faster", reached))
    lines += ["", "## Every case", "", "Angles in degrees, distances over the diameter of the hole.", ""]
    lines += [
        "| hole | n | triangles | seam | surroundings known to | limit normals | exact normals | vertices | surface | folds |",
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


HEAD = """# Measurements

{provenance}

Ten holes with four rings of surroundings each (`scripts/comparison/holes.py`), n edges a side. The columns
(`scripts/comparison/metrics.py`):

- **seam**: the largest angle between the smooth patch and the tangent planes that it was given, from exact derivatives, 200
  points a side. **surroundings known to**: the fill's own report of how well the mesh determines those planes.
- **limit normals**: what the finished triangles say about the seam: the rms angle between the true normal of the surroundings at
  each rim vertex and the limit normal of the fill's triangles there, by a local cubic fit. The fit has
  an error of its own. **exact normals**: the same with the fill's own exact normals.
- **vertices**, **surface**: rms distance of the fill's vertices, and of 10,000 points spread evenly over the patch, to the true
  surface.
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
