"""docs/fairness.md and its pictures: every hole filled by TriPatch and by the baselines."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import subprocess
import textwrap
import time

import numpy as np
import tripatch

from . import baselines, exact, holes, metrics
from .page import Setting, provenance

N = 32
#: what the fills of the table of energies are called there -> options
ENERGIES = {
    "plain": {"fairing": None},
    "thin plate": {"fairing": "thin_plate"},
    "third derivative": {"fairing": "third_derivative"},
    "minimum variation": {"fairing": "minimum_variation"},
    "quadric variation": {"fairing": "quadric_variation"},
    "auto": {},
    "auto, G1": {"continuity": "G1"},
    "auto, G2": {"continuity": "G2"},
}
PICTURED = ("suitcase", "sphere", "torus", "saddle", "suzanne")
GRID, FILL = "Blender, Grid Fill", "Blender, Fill"
OURS, CHART, ARC = "TriPatch", "TriPatch, exact sides: chart", "TriPatch, exact sides: arc length"
SMOOTH = (OURS, CHART, ARC)

# ------------------------------------------------------------------------------------------------------------------ measuring


def points_of(filling: baselines.Filling) -> np.ndarray:
    """10,000 points uniform in the area of the filling's smooth surface, or of its triangles."""
    if filling.points is not None:
        return filling.points
    corners = filling.vertices[filling.faces]
    hit, weights = metrics.spread(corners)
    return np.einsum("nk,nkd->nd", weights, corners[hit])


def figures(hole: holes.Hole, filling: baselines.Filling, true_roughness: float | None, patch=None) -> dict:
    used = np.unique(filling.faces)
    out = {
        "triangles": len(filling.faces),
        "milliseconds": 1e3 * filling.seconds,
        "limit": metrics.rms(metrics.angle(metrics.limit_normals(filling.vertices, filling.faces, hole.rim), hole.rim_normals)),
        "folds": metrics.mesh_folds(filling.vertices, filling.faces),
    }
    if filling.seam is not None:
        out["seam"] = filling.seam
    if hole.nearest:
        out["points"] = metrics.distance(hole, metrics.surface_points(patch) if patch else points_of(filling))
        if len(used) > len(hole.rim):
            out["vertices"] = metrics.distance(hole, filling.vertices[used])
            out["roughness"] = metrics.roughness(filling.vertices, filling.faces) / true_roughness
    return out


def best_of(call, repetitions=5):
    least = np.inf
    for _ in range(repetitions):
        start = time.perf_counter()
        result = call()
        least = min(least, time.perf_counter() - start)
    return result, least


def of_sides(hole: holes.Hole, sides) -> dict:
    """A patch of exact sides: its seam is against the truth itself."""
    patch = tripatch.patch(sides, fairing="auto")
    forced = tripatch.patch(sides, fairing="auto", continuity="G2")
    out = {"seam": metrics.seam(patch, sides), "jump": metrics.curvature_jump(forced, sides)}
    if hole.nearest:
        out["points"] = metrics.distance(hole, metrics.surface_points(patch))
        out["vertices"] = metrics.distance(hole, patch.evaluate(patch.triangles(N)[0]))
    return out


def measure(hole: holes.Hole, others: dict) -> tuple[dict, dict]:
    """filler -> figures, and filler -> Filling."""

    def fill(**options):
        return tripatch.fill(hole.vertices, hole.faces, rim=hole.rim, corners=hole.corners, **options)

    ours, seconds = best_of(fill)
    vertices, faces = np.concatenate([hole.vertices, ours.vertices]), np.array(ours.faces)
    made = {OURS: baselines.Filling(vertices, faces, seconds)}
    true_roughness = None
    if hole.nearest:
        truth, used = vertices.copy(), np.unique(faces)
        truth[used] = hole.nearest(vertices[used])
        made["the truth"] = baselines.Filling(truth, faces, 0)
        true_roughness = metrics.roughness(truth, faces)
    result = {OURS: figures(hole, made[OURS], true_roughness, ours.patch)}
    mine = result[OURS]
    mine["folds"] += ours.report.folds
    mine["fairing"] = seconds - best_of(lambda: fill(fairing=None))[1]
    mine["quadratic"] = best_of(lambda: fill(fairing="third_derivative"))[1] - seconds + mine["fairing"]
    every = {name: fill(**options) for name, options in ENERGIES.items()}
    mine["seam"] = max(metrics.seam(f.patch, f.sides) for f in every.values() if f.sides)
    mine["energies"] = {name: {"folds": f.report.folds} for name, f in every.items()}
    if hole.nearest:
        for name, f in every.items():
            mine["energies"][name]["points"] = metrics.distance(hole, metrics.surface_points(f.patch))
    if hole.strip:
        result |= {CHART: of_sides(hole, exact.chart(hole)), ARC: of_sides(hole, exact.arc_length(hole))}
    for name, call in others.items():
        try:
            made[name] = call(hole, ours)
        except (RuntimeError, KeyError, subprocess.SubprocessError) as error:
            result[OURS].setdefault("failed", {})[name] = str(error)
            continue
        result[name] = figures(hole, made[name], true_roughness)
    return result, made


# -------------------------------------------------------------------------------------------------------------------- the page


def short(x, digits=2) -> str:
    """1.2e-4; the plain number where that is as short."""
    if x is None:
        return "-"
    if x == 0 or 0.1 <= abs(x) < 1000:
        return f"{x:.0f}" if abs(x) >= 10 else f"{x:.{digits}g}"
    return f"{x:.{digits - 1}e}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def rows(table: list[list[str]]) -> list[str]:
    lines = ["| " + " | ".join(row) + " |" for row in table]
    return [lines[0], "|" + "---|" * len(table[0]), *lines[1:], ""]


def nearest_baseline(result: dict, key: str) -> tuple[float, str]:
    return min((figures[key], name) for name, figures in result.items() if name not in SMOOTH and key in figures)


def distances(results: dict) -> list[str]:
    head = ["hole", "best other program: vertices", "points", "TriPatch, from the mesh: vertices", "points"]
    table = [[*head, "from exact sides, chart: vertices", "points", "arc length: vertices", "points"]]
    for name, result in results.items():
        if "points" not in result[OURS]:
            continue
        row = [name]
        for key in ("vertices", "points"):
            value, baseline = nearest_baseline(result, key)
            row.append(f"{short(value)} ({baseline})")
        for filler in SMOOTH:
            row += [short(result.get(filler, {}).get(key)) for key in ("vertices", "points")]
        table.append(row)
    return rows(table)


def lost(results: dict) -> list[str]:
    """Where a baseline is nearer to the truth than the fill from the mesh."""
    lines = []
    for name, result in results.items():
        if "points" not in result[OURS]:
            continue
        parts = []
        for key in ("vertices", "points"):
            value, baseline = nearest_baseline(result, key)
            if value < result[OURS][key]:
                parts.append(f"{key} {short(value)} ({baseline}) against {short(result[OURS][key])}")
        if parts:
            lines.append(f"- {name}: {'; '.join(parts)}")
    return lines


def failures(results: dict) -> list[str]:
    """Who gave nothing, and why."""
    given = {}
    for name, result in results.items():
        for baseline, reason in result[OURS].get("failed", {}).items():
            given.setdefault((reason, name), []).append(baseline)
    return [*(f"- {name}, {'; '.join(baselines)}: {reason}" for (reason, name), baselines in given.items()), ""]


def everyone(results: dict, key: str, fillers: list[str], lowest=True) -> list[str]:
    table = [["hole", *fillers]]
    for name, result in results.items():
        values = [result.get(filler, {}).get(key) for filler in fillers]
        known = [v for v in values if v is not None]
        if not known:
            continue
        best = min(known) if lowest else None
        table.append([name, *(f"**{short(v)}**" if v is not None and v == best else short(v) for v in values)])
    return rows(table)


def summary(results: dict, fillers: list[str]) -> list[str]:
    def of(filler, key):
        return {name: r[filler][key] for name, r in results.items() if key in r.get(filler, {})}

    def worst(values):
        name = max(values, key=values.get)
        return f"{short(values[name])} ({name})"

    table = [["what", "other programs", "TriPatch"]]
    smooth = [f for f in fillers if any("seam" in r.get(f, {}) for r in results.values()) and f not in SMOOTH]
    seams = (f"{f}: median {short(np.median(list(of(f, 'seam').values())))}, worst {worst(of(f, 'seam'))}" for f in smooth)
    what = "seam of the smooth patch, degrees, every hole, every energy and G2, against the planes used"
    table.append([what, "; ".join(seams) or "none is smooth", worst(of(OURS, "seam"))])
    table += [[f"the same, {filler[10:]}, against the truth", "", worst(of(filler, "seam"))] for filler in (CHART, ARC)]
    roughness = {f: np.median(list(of(f, "roughness").values())) for f in fillers if of(f, "roughness")}
    smoothest = min((f for f in roughness if f != OURS), key=roughness.get)
    what = "roughness over that of the truth, median"
    table.append([what, f"{short(roughness[smoothest])} ({smoothest})", short(roughness[OURS])])
    folds = {f: sum(of(f, "folds").values()) for f in fillers if of(f, "folds")}
    theirs = ", ".join(f"{f} {value}" for f, value in folds.items() if value and f != OURS)
    mine = ", ".join(f"{name} {value}" for name, value in of(OURS, "folds").items() if value)
    table.append(["folds, all holes", theirs, mine or "0"])
    for filler in (CHART, ARC):
        what = f'`continuity="G2"`, {filler[10:]}: jump of the normal curvature over the rim\'s largest, 1% off the corners'
        table.append([what, "", worst(of(filler, "jump"))])
    quickest = {f: of(f, "milliseconds") for f in fillers if f != OURS and "Blender" not in f}
    theirs = ", ".join(f"{f} {np.median(list(v.values())):.0f}" for f, v in quickest.items() if v)
    for what, key in (("`auto`", "fairing"), ("third derivative, one linear solve", "quadratic")):
        times = {name: 1e3 * value for name, value in of(OURS, key).items()}
        mine = f"{np.median(list(times.values())):.1f}, {max(times.values()):.1f} ({max(times, key=times.get)})"
        whole = f"all of the fill: {theirs}" if key == "fairing" else ""
        table.append([f"milliseconds of the fairing alone, {what}: median, maximum", whole, mine])
    return rows(table)


HEAD = """# Comparison with other programs

{provenance}

{count} holes cut out of known surfaces ([holes.py](../scripts/comparison/holes.py)), {n} edges a side, filled by TriPatch
and by other programs in one run, and measured by the same code ([metrics.py](../scripts/comparison/metrics.py),
[baselines.py](../scripts/comparison/baselines.py)). [Fairing](mathematics/fairing.md) explains how TriPatch makes its fills fair.

{versions}

## What it looks like

Above: reflection lines (old surface blue, fill orange). They break at a crease, bend sharply if the curvature jumps, and undulate
if the surface is not fair. Below: mean curvature on one scale, from the triangles of each. Each picture shows the original, the
two nearest other programs and TriPatch. The number is the rms distance of 10,000 points to the original over the diameter of the
hole.
"""

CAPTIONS = {
    "suitcase": "The corner of a suitcase: three fillets of equal radius meet at the corner of a cube. At the rim the curvature "
    "rightly jumps from a cylinder's to a ball's. A fill that continues the outside curvature is wrong.",
    "sphere": "An octant of a sphere.",
    "torus": "On a torus, from positive to negative Gauss curvature.",
    "saddle": "A saddle, z = x^2 - y^2.",
    "suzanne": "Suzanne's forehead, on the limit surface of her subdivision.",
}

TELLS = """## How it was measured

- **vertices**: rms distance of the fill's vertices to the true surface, divided by the diameter of the hole (the largest distance
  between two vertices of its boundary). **points**: the same for 10,000 points spread evenly over the smooth patch (TriPatch,
  OpenCASCADE) or the triangles. At this density the flat triangles alone cost 2e-5 (sphere10) to 4e-4.
- **from the mesh**: TriPatch gets four rings of triangles, like CGAL, PMP, libigl and Blender. **exact sides**: it gets functions
  ([exact.py](../scripts/comparison/exact.py)) through `Side.from_functions` with `q`, as OpenCASCADE gets B-spline surfaces.
  They follow the hole's own chart with its derivatives across, or run by arc length with unit conormals. Suzanne has none.
- **seam**: largest angle between the smooth patch and the tangent planes along the sides, from exact derivatives. OpenCASCADE's
  seam is compared with the true planes, without its ends.
- **limit normals**: rms angle at the boundary between the true normal and a one-sided cubic fit to the new vertices. The same
  fit to the true vertices is off by {floor}.
- **roughness**: integral of the squared gradient of mean curvature, divided by that of the true surface at TriPatch's vertices.
  On spheres the divisor is almost zero, so compare the median only.
- **folds**: edges whose triangles face more than 120 degrees apart; for TriPatch also folds of the patch on a grid of 64.
- libigl does not fill holes: it gets a flat triangulation, regular or that of TriPatch's fill, and finds the positions. Blender's
  Fill has no vertices inside.
- Times include the whole fill, from arrays to arrays; OpenCASCADE's are those of the surface alone. They are the minimum of three
  runs, TriPatch's of five.
- OpenCASCADE's settings (degree, points a curve, tolerance over the diameter, segments): *default* as installed; *finer* 3, 30,
  1e-5, 30; *finest* 4, 40, 1e-6, 60.
"""


def page(results: dict, versions: list[str], pictures: list[str], setting: Setting) -> str:
    ten = {name: r for name, r in results.items() if name not in holes.FURTHER}
    further = {name: r for name, r in results.items() if name in holes.FURTHER}
    fillers = list(dict.fromkeys(name for r in results.values() for name in r if name not in (CHART, ARC)))
    head = HEAD.format(
        provenance=provenance(
            "vertices, faces and the rim with its corners; all else at its default unless a table says so", setting.quick
        ),
        count=len(results),
        n=N,
        versions="Other programs: " + "; ".join(versions) + ".",
    )
    lines = [head]
    for name in pictures:
        lines += [f"![{name}: the truth, two baselines and TriPatch](images/fairness/{name}.png)"]
        lines += [textwrap.fill(CAPTIONS[name], 130), ""]
    lines += ["## Distance to the original: ten holes", ""]
    lines += ["Rms distance over the diameter of the hole.", "", *distances(ten)]
    if further:
        lines += [
            "## Distance to the original: ten further holes",
            "",
            "The same for holes in other surfaces.",
            "",
            *distances(further),
        ]
    lines += [
        "## Where another program is nearer",
        "",
        "The best other program, against TriPatch from the mesh:",
        "",
        *(lost(results) or ["nowhere"]),
        "",
    ]
    lines += ["## Seam, roughness, folds, curvature, time", "", "Over all holes.", "", *summary(results, fillers)]
    energies = {name: r[OURS]["energies"] for name, r in results.items()}
    lines += ["## Every energy", "", "Distance of points of TriPatch's fills from the mesh, by `fairing` and `continuity`.", ""]
    lines += everyone(energies, "points", list(ENERGIES))
    folded = [f"{name} {kind}: {v['folds']}" for name, r in energies.items() for kind, v in r.items() if v["folds"]]
    lines += [f"Folds (grid of 64) among these: {'; '.join(folded) or 'none'}.", ""]
    lines += ["## Every filler", "", *failures(results), "### Distance of points", "", *everyone(results, "points", fillers)]
    lines += ["### Distance of vertices", "", *everyone(results, "vertices", [f for f in fillers if f != FILL])]
    lines += ["### Limit normals at the rim, degrees, rms", "", *everyone(results, "limit", fillers)]
    lines += [
        "### Roughness over the truth's",
        "",
        *everyone(results, "roughness", [f for f in fillers if f != FILL], lowest=False),
    ]
    lines += ["### Milliseconds", "", *everyone(results, "milliseconds", fillers)]
    floors = {name: r[OURS]["floor"] for name, r in results.items() if "floor" in r[OURS]}
    worst = max(floors, key=floors.get)
    floor = f"{short(np.median(list(floors.values())))} degrees (median; {short(floors[worst])} on {worst})"
    return "\n".join([*lines, TELLS.format(floor=floor)])


# ------------------------------------------------------------------------------------------------------------------------ main


def installed() -> list[str]:
    """The Python packages among the baselines, with their versions."""
    packages = {"igl": ("libigl", "libigl"), "OCP": ("OpenCASCADE", "cadquery-ocp")}
    return [f"{name} {importlib.metadata.version(p)}" for m, (name, p) in packages.items() if importlib.util.find_spec(m)]


def write(setting: Setting) -> None:
    cases = holes.ten(setting.cache, setting.blender) | holes.FURTHER
    cases = {name: make(N) for name, make in cases.items() if not setting.quick or name in ("sphere", "cone")}
    others = baselines.available(setting.cgal, setting.pmp)
    versions = [f"{name} {baselines.version(path)}" for name, path in (("CGAL", setting.cgal), ("PMP", setting.pmp)) if path]
    versions += installed()
    if setting.blender:
        version, fills = baselines.blender(cases, setting.blender)
        versions.append(f"Blender {version}")
        others |= {name: lambda hole, _, mode=mode: fills[hole.name, mode] for name, mode in ((GRID, "grid"), (FILL, "fill"))}

    results, drawn = {}, []
    for name, hole in cases.items():
        start = time.perf_counter()
        results[name], made = measure(hole, others)
        if "the truth" in made:
            truth = made["the truth"]
            normals = metrics.limit_normals(truth.vertices, truth.faces, hole.rim)
            results[name][OURS]["floor"] = metrics.rms(metrics.angle(normals, hole.rim_normals))
        print(f"{name}: {time.perf_counter() - start:.0f} s", flush=True)
        if name in PICTURED and not setting.quick:
            from . import pictures

            pictures.draw(setting.docs / "images" / "fairness" / f"{name}.png", hole, made, results[name])
            drawn.append(name)
    (setting.docs / "fairness.md").write_text(page(results, versions, sorted(drawn, key=PICTURED.index), setting))
