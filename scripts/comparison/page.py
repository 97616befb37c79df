"""The page of HoleBench, docs/holebench.md, and what every generated page says of itself."""

from __future__ import annotations

import datetime
import platform
import subprocess
import textwrap
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np
import tripatch
from known_holes import NEGLIGIBLE

from .metrics import calibration

ROOT = Path(__file__).resolve().parents[2]
OURS, TRUTH, UNIT = "TriPatch", "the truth", "CGAL, continuity 1"
PICTURED = {
    "suitcase": "The corner of a suitcase: three fillets of equal radius meet at the corner of a cube. At the rim the curvature "
    "rightly jumps from a cylinder's to a ball's.",
    "torus": "On a torus, from positive to negative Gauss curvature.",
    "suzanne": "Suzanne's forehead, on the limit surface of her subdivision.",
}
LENGTHS = (3, 13, 31, 81, 201)  # edges of a boundary from which on the times are counted together
ENOUGH = 25  # vertices of a mesh from which on its error estimates are judged
RIGHT = {"within_1": (0.58, 0.80), "within_2": (0.90, 0.99), "rms": (0.75, 1.3)}


def processor() -> str:
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":")[1].strip()
    return platform.machine()


def commit() -> str:
    """The short name of the commit that is measured, and whether the sources differ from it."""

    def git(*words):
        return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True).stdout.strip()

    changed = git("status", "--porcelain", "--untracked-files=no", "--", "native", "CMakeLists.txt", "pyproject.toml")
    return (git("rev-parse", "--short=10", "HEAD") or "unknown") + (" with changes" if changed else "")


def measured_on() -> dict:
    return {
        "date": str(datetime.date.today()),
        "commit": commit(),
        "version": tripatch.__version__,
        "processor": processor(),
        "python": platform.python_version(),
        "system": platform.platform(),
    }


def written_by(script: str, on: dict) -> str:
    """The first line of every generated page."""
    where = f"{on['date']}, commit {on['commit']}, version {on['version']}, {on['processor']}"
    return f"Written by `scripts/{script}`; do not edit. {where}."


def short(x, digits=2) -> str:
    """1.2e-4; the plain number where that is as short."""
    if x is None or not np.isfinite(x):
        return "-"
    if x == 0 or 0.01 <= abs(x) < 1000:
        return f"{x:.0f}" if abs(x) >= 10 else f"{x:.{digits}g}"
    return f"{x:.{digits - 1}e}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def table(rows: list[list[str]]) -> list[str]:
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return [lines[0], "|" + "---|" * len(rows[0]), *lines[1:], ""]


def over_ours(row: dict, name: str, *keys: str) -> float | None:
    """Distance to the truth over that of TriPatch: the first of these figures that both have."""
    other, mine = row["fillers"].get(name, {}), row["fillers"][OURS]
    for key in keys:
        if key in other and key in mine:
            return max(other[key], NEGLIGIBLE) / max(mine[key], NEGLIGIBLE)
    return None


def mean(ratios: list[float]) -> float | None:
    return float(np.exp(np.mean(np.log(ratios)))) if ratios else None


def fillers_of(rows: list[dict]) -> list[str]:
    """In the order in which they appear, TriPatch first; without the truth."""
    return [name for name in dict.fromkeys([OURS, *(name for row in rows for name in row["fillers"])]) if name != TRUTH]


def figures(rows: list[dict], name: str, key: str) -> list[float]:
    return [row["fillers"][name][key] for row in rows if key in row["fillers"].get(name, {})]


def relative_times(rows: list[dict], name: str) -> list[float]:
    both = [row["fillers"] for row in rows if "cpu" in row["fillers"].get(name, {}) and "cpu" in row["fillers"].get(UNIT, {})]
    return [each[name]["cpu"] / max(each[UNIT]["cpu"], 1e-5) for each in both]


def spread_of(ratios: list[float]) -> str:
    return f"{short(np.median(ratios))} / {short(np.quantile(ratios, 0.9))}" if ratios else "-"


def summary(rows: list[dict]) -> list[str]:
    sets = list(dict.fromkeys(row["set"] for row in rows if "distance" in row["fillers"].get(OURS, {})))
    counts = [sum(row["set"] == s for row in rows) for s in sets]
    head = ["program", "filled", *(f"{s} ({n})" for s, n in zip(sets, counts))]
    out = [[*head, "surface", "normals", "seam", "folds", "crossings", "CPU"]]
    for name in [*fillers_of(rows), TRUTH]:
        tried = [row for row in rows if name in row["fillers"]]
        filled = [row for row in tried if row["fillers"][name].get("open") == 0]
        line = [name, f"{len(filled)} of {len(tried)}" if name != TRUTH else ""]
        for s in sets:
            ratios = [over_ours(row, name, "vertices") for row in filled if row["set"] == s and name != TRUTH]
            line.append(short(mean([r for r in ratios if r is not None])))
        ratios = [over_ours(row, name, "distance") for row in filled]
        line.append(short(mean([r for r in ratios if r is not None])))
        for key in ("normals", "seam"):
            values = figures(filled, name, key)
            line.append(short(np.median(values)) if values else "-")
        counted = [figures(tried, name, key) for key in ("folds", "crossings")]
        line += [f"{sum(value > 0 for value in values)} of {len(values)}" for values in counted]
        out.append([*line, spread_of(relative_times(tried, name)) if name != TRUTH else ""])
    return table(out)


def times(rows: list[dict]) -> list[str]:
    bins = list(zip(LENGTHS, [*LENGTHS[1:], 1 << 30]))
    named = [f"{low} to {high - 1}" if high < 1 << 30 else f"{low} and more" for low, high in bins]
    groups = [[row for row in rows if low <= row["edges"] < high] for low, high in bins]
    out = [["program", *(f"{name} edges ({len(group)})" for name, group in zip(named, groups) if group)]]
    for name in fillers_of(rows):
        out.append([name, *(spread_of(relative_times(group, name)) for group in groups if group)])
    seconds = [row["fillers"][OURS].get("cpu", 0) for row in rows]
    slow = f"TriPatch took {short(max(seconds))} s for the slowest hole; {sum(s > 1 for s in seconds)} took more than a second."
    return [*table(out), slow, ""]


def is_right(found: dict) -> bool:
    return all(low <= found[key] <= high for key, (low, high) in RIGHT.items())


def estimates(rows: list[dict]) -> list[str]:
    """By set, and for files by mesh."""
    out = [["holes", "vertices", "within 1", "within 2", "rms", "meshes in range"]]
    for s in dict.fromkeys(row["set"] for row in rows):
        by_mesh = defaultdict(list)
        for row in rows:
            if row["set"] == s:
                by_mesh[row["mesh"]] += row.get("ratios", [])
        ratios = [ratio for own in by_mesh.values() for ratio in own]
        if not ratios:
            continue
        judged = {mesh: calibration(own, np.ones(len(own))) for mesh, own in by_mesh.items() if len(own) >= ENOUGH}
        right = f"{sum(map(is_right, judged.values()))} of {len(judged)}"
        lines = [(s, calibration(ratios, np.ones(len(ratios))), right)]
        lines += [(f"{s}: {mesh}", found, "yes" if is_right(found) else "no") for mesh, found in judged.items() if mesh]
        for name, found, word in lines if s not in ("formulas", "more sides", "CAD bodies") else lines[:1]:
            out.append([name, str(found["count"]), *(short(found[key]) for key in RIGHT), word])
    return table(out)


def nearer(results: dict) -> list[str]:
    """Where another program is nearer to the truth, the worst first."""
    lost = []
    for name, row in results.items():
        ratios = {other: over_ours(row, other, "vertices", "distance") for other in row["fillers"] if other not in (OURS, TRUTH)}
        known = {other: ratio for other, ratio in ratios.items() if ratio is not None}
        if known:
            best = min(known, key=known.get)
            lost.append((known[best], name, best))
    worse = sorted(each for each in lost if each[0] < 1)
    twice = sum(ratio < 0.5 for ratio, *_ in worse)
    lines = [f"In {len(worse)} of {len(lost)} holes; in {twice} of these by more than a factor of 2. The first 20:", ""]
    return [*lines, *(f"- {name}: {best}, {short(1 / ratio)} times as near" for ratio, name, best in worse[:20]), ""]


TELLS = f"""## What is measured

Every program gets the same mesh with a hole, TriPatch with all options at their defaults. Lengths are over the diameter of the
hole, angles in degrees.

- **filled**: holes that are closed, with no open and no triple edge.
- **the sets**: rms distance of the new vertices to the true surface, over TriPatch's; geometric mean over the closed holes of
  the set. Distances below 1e-5 of the hole count as that. **surface**: the same of 2,000 points spread evenly over the new
  triangles, in all sets; there the size of the triangles counts too.
- **normals**: rms angle between the new triangles and the true surface, median over all holes. Flat triangles cannot reach 0:
  *the truth* has TriPatch's triangles with vertices on the true surface, where that is smooth.
- **seam**: rms angle along the boundary to the true tangent planes, median over all holes. On smooth surfaces it is that of limit
  normals, by a one-sided cubic fit to the new vertices; else that of the new triangles to the triangles that were there.
- **folds**, **crossings**: fills with edges folded by more than 120 degrees; fills that go through themselves or the mesh.
- **CPU**: over that of CGAL's refine and fair with continuity 1 on the same hole: median / 90th percentile. It is the CPU time of
  the process with all its threads, the least of three runs, so other work on the machine matters little. Programs that were given
  by `--rival` are charged for their start too.
- **Error estimates**: only TriPatch states a standard deviation for each new vertex. Right are shares of 0.68 and 0.95 within one
  and two deviations, and 1 for the rms of error over deviation; less than 1 is too cautious. If a mesh itself is off its truth
  along the boundary, that is added. Errors within a hole go together, perhaps like two independent numbers. Then right
  deviations put the rms of a single hole in range in 4 of 10 cases only. *In range* is a mesh of {ENOUGH} vertices or more with
  0.58 to 0.80, 0.90 to 0.99 and 0.75 to 1.3.

libigl does not fill holes: it places the vertices of TriPatch's triangles. OpenCASCADE is given smooth surfaces instead of
meshes, so it takes part in the first two sets only. Its settings: *default* as installed; *finer* 30 points a curve, tolerance
1e-5, 30 segments; *finest* degree 4, 40 points, 1e-6, 60 segments. MeshLab refines to the mean edge of the boundary,
MeshLib to the longest, as it would split that otherwise.

## The sets

- **formulas**: 20 holes between three smooth sides of 32 edges; **more sides**: 32 of four to eight sides
  ([holes.py](../scripts/comparison/holes.py)).
- **irregular**: holes in irregular triangles of eight surfaces, half of them with noise of 3% of an edge
  ([known_holes.py](../scripts/known_holes.py)).
- **CAD bodies**: at edges and on faces of extruded and turned bodies ([cuts.py](../scripts/comparison/cuts.py)).
- **primitives**: in Blender's primitives, at sharp edges and elsewhere ([sets.py](../scripts/comparison/sets.py)).
- Others, such as real holes without a truth, come from files of `--data`: **semigcn** from
  [SeMIGCN](https://github.com/astaka-pe/SeMIGCN) (MIT), **meshes** and **with_holes** from
  [CGAL](https://github.com/CGAL/cgal/tree/main/Data/data/meshes) (CC0). `sources.json` has their checksums.

## Run it

    scripts/holebench --quick                        # every seventh hole
    scripts/holebench --minutes 60                   # as many as can be done in that time, of every set
    scripts/holebench --data FOLDER                  # all of them, and those of your files
    scripts/holebench --rival NAME='COMMAND'         # another program: COMMAND IN.obj OUT.obj

`FOLDER` has meshes, closed or with holes, or pairs NAME_original.obj and NAME_gt.obj, where the second is the truth. All figures
of every hole are in `build/holebench/results.json`. The fills of other programs are kept in `build/holebench/rivals`, so a second
run calls these only if a hole, a program, its caller or the processor has changed.

A program joins by a command that reads a mesh with a hole and writes it filled, such as
[a fan of triangles by trimesh](examples/trimesh_rival.py), ten lines:

    scripts/holebench --rival trimesh='python docs/examples/trimesh_rival.py'
"""


def page(results: dict) -> str:
    named, rows = results["holes"], [row for row in results["holes"].values() if len(fillers_of([row])) > 1]
    versions = "; ".join(f"{name} {version}" for name, version in results["versions"].items())
    some = f" of {results['of']} holes, some of each set." if len(named) < results["of"] else " holes."
    tried = f" {len(named)}{some}"
    refused = Counter(failed for row in named.values() if (failed := row["fillers"][OURS].get("failed")))
    lines = ["# Comparison with other programs: HoleBench", "", written_by("holebench", results) + tried, ""]
    lines += [f"Left out are {count} that TriPatch refused: *{reason}.*\n" for reason, count in refused.items()]
    lines += [f"Other programs: {versions}.", *(f"Skipped: {line}." for line in results["skipped"]), ""]
    lines += [
        *summary(rows),
        "2 is twice as far from the true surface as TriPatch. [The columns](#what-is-measured).",
        "",
    ]
    lines += ["![Distance to the true surface over TriPatch's, by program](images/holebench/distances.png)", ""]
    for name, caption in PICTURED.items():
        if not any(hole.endswith(f": {name}") for hole in named):
            continue
        lines += [
            f"![{name}: the truth, the two nearest others and TriPatch](images/holebench/{name}.png)",
            "",
            textwrap.fill(caption, 130),
            "",
        ]
    lines += ["## CPU time by boundary length", "", "Over CGAL, continuity 1: median / 90th percentile.", "", *times(rows)]
    lines += [
        "## Error estimates",
        "",
        f"Of {len(named)} holes.",
        "",
        *estimates(list(named.values())),
        "## Where another program is nearer",
        "",
        *nearer(named),
    ]
    return "\n".join(lines) + "\n" + TELLS
