"""docs/speed.md: times and CGAL's by density, how they grow, peak memory, many holes in one mesh, and Blender's operators."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from types import ModuleType

import numpy as np
import tripatch

from . import baselines, holes
from .page import ROOT, Setting, compiler, provenance

EDGES = (32, 100, 316, 1000)  # of a side: 1,000 to 1,000,000 triangles
REPETITIONS = 7
#: of what is compared, one after the other, as machines are faster at one time than at another; and repetitions in each
ROUNDS, OURS, THEIRS = 4, 7, 2
TURNS = 2  # of what takes half a minute
CONTINUITY = {"None": 1, "auto": 2}  # fairing -> continuity of CGAL that does as much
OF_CGAL = 3  # the first of EDGES: CGAL takes minutes for the last
#: edges of a hole's side; of 900 and 10,000 holes the cells and the holes along an edge
SIDE, MANY, MORE = 6, (975, 30), (1300, 100)
POINTS = 1_000_000
OWN_SIDE = 32  # edges along a side of the hole in which the operator's own part is measured


def module(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


def alone(words: list, cores: int | None = None) -> dict:
    """What a module of this folder prints, in a process of its own on all cores or on so many."""
    some = sorted(os.sched_getaffinity(0))[:cores]
    command = ["taskset", "-c", ",".join(map(str, some)), sys.executable, "-m", *map(str, words)]
    folder = Path(__file__).resolve().parents[1]
    run = subprocess.run(command, check=True, capture_output=True, text=True, cwd=folder)
    return json.loads(run.stdout)


def of_cgal(program: str, folder: Path, edges: int, continuity: int, repetitions: int) -> list[float]:
    given = folder / f"sphere-{edges}.txt"
    baselines.write_hole(holes.sphere(edges), given)
    command = [program, str(given), str(continuity), str(repetitions)]
    return [float(word) for word in subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()[1:]]


def exponent(made: list[dict]) -> float:
    """Of the triangles in the time, by least squares of the logarithms."""
    return float(np.polyfit(np.log([m["triangles"] for m in made]), np.log([min(m["seconds"]) for m in made]), 1)[0])


def best(call, repetitions: int) -> list[float]:
    seconds = []
    for _ in range(repetitions):
        start = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - start)
    return seconds


def ms(seconds: list[float]) -> str:
    return f"{1e3 * min(seconds):.4g} | {1e3 * float(np.median(seconds)):.4g}"


def densities(setting: Setting) -> list[str]:
    edges, rounds = (EDGES[:2], 1) if setting.quick else (EDGES, ROUNDS)
    lines = [
        "## A sphere octant by density",
        "",
        "Milliseconds from arrays to arrays. CGAL's refine and fair is measured without building its data structure. The",
        "programs take turns in separate processes. The last column is the peak memory of the first fill, without",
        "its input and output.",
        "",
        "| filler | triangles | minimum | median | times faster than CGAL | MB of input and output | MB of memory |",
        "|---|---|---|---|---|---|---|",
    ]
    growth = [
        "",
        "| filler | time grows as triangles to the power of | the last two densities |",
        "|---|---|---|",
    ]
    for fairing, continuity in CONTINUITY.items():
        made = []
        for k, n in enumerate(edges):
            mine, theirs = {}, []
            for _ in range(rounds):
                again = alone(["comparison.one_fill", n, fairing, OURS])
                mine = {**again, **mine, "seconds": mine.get("seconds", []) + again["seconds"]}
                if setting.cgal and k < OF_CGAL:
                    theirs += of_cgal(setting.cgal, setting.cache, n, continuity, THEIRS)
            made.append(mine)
            against = f"{min(theirs) / min(mine['seconds']):.1f}" if theirs else ""
            memory = f"{(mine['input'] + mine['output']) / 1e6:.1f} | {mine['beyond'] / 1e6:.1f}"
            lines.append(f"| TriPatch, fairing {fairing} | {mine['triangles']} | {ms(mine['seconds'])} | {against} | {memory} |")
            if theirs:
                lines.append(f"| CGAL, continuity {continuity} | | {ms(theirs)} | | | |")
            print(lines[-2 if theirs else -1], flush=True)
        growth.append(f"| TriPatch, fairing {fairing} | {exponent(made):.2f} | {exponent(made[-2:]):.2f} |")
    return lines + growth


def many_holes(setting: Setting) -> list[str]:
    mesh = module(ROOT / "native" / "benchmarks" / "many_holes.py").mesh
    cells, along = (195, 6) if setting.quick else MANY
    vertices, faces, rims = mesh(cells, along, SIDE)
    lines = [
        "",
        "## Many holes in one mesh",
        "",
        f"{len(rims)} holes of {3 * SIDE} edges in {len(faces)} triangles, seconds with {len(os.sched_getaffinity(0))} cores:",
        "",
        "| fairing | minimum | median | CPU |",
        "|---|---|---|---|",
    ]
    for fairing in CONTINUITY:
        option = None if fairing == "None" else fairing
        cpu = time.process_time()
        seconds = best(lambda option=option: tripatch.fill_all(vertices, faces, rims, fairing=option), 3)
        cpu = (time.process_time() - cpu) / 3
        lines.append(f"| {fairing} | {min(seconds):.2f} | {float(np.median(seconds)):.2f} | {cpu:.2f} |")
        print(lines[-1], flush=True)
    cells, along = (195, 6) if setting.quick else MORE
    turns = [[alone(["comparison.all_holes", cells, along, SIDE], cores)["seconds"] for cores in (1, 2)] for _ in range(TURNS)]
    one, two = map(min, zip(*turns, strict=True))
    lines += [
        "",
        f"{along**2} holes in one mesh without fairing, minimum of {TURNS}: {one:.1f} s on one core, {two:.1f} s on two",
        f"({one / two:.2f} times as fast).",
    ]
    print(lines[-1], flush=True)
    return lines


def points() -> list[str]:
    hole = holes.sphere(32)
    b = np.random.default_rng(0).dirichlet([1, 1, 1], POINTS)
    lines = ["", f"## {POINTS:,} points", "", "Milliseconds, minimum of several:", ""]
    lines += ["| patch | positions | positions and normals | copying both arrays |", "|---|---|---|---|"]
    for fairing in CONTINUITY:
        patch = tripatch.fill(hole.vertices, hole.faces, rim=hole.rim, fairing=None if fairing == "None" else fairing).patch
        result = patch.positions_and_normals(b)
        calls = (patch.evaluate, patch.positions_and_normals, lambda _, arrays=result: [a.copy() for a in arrays])
        positions, both, copying = (1e3 * min(best(lambda call=call: call(b), REPETITIONS)) for call in calls)
        lines.append(f"| fairing {fairing} | {positions:.0f} | {both:.0f} | {copying:.0f} |")
    return lines


def in_blender(setting: Setting) -> list[str]:
    """Smooth Fill and Grid Fill, and its sliders: what in_blender.py measures inside of Blender."""
    script = Path(__file__).with_name("in_blender.py")
    words = [setting.blender, "--background", "--factory-startup", "--python-exit-code", 1, "--python", script, "--"]
    octant = holes.sphere(OWN_SIDE)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "octant.npz"
        np.savez(file, vertices=octant.vertices, faces=octant.faces, rim=octant.rim)
        words += [Path(tripatch.__file__).parents[1], file, 2 if setting.quick else REPETITIONS]
        run = subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True)
    made = json.loads(next(line for line in run.stdout.splitlines() if line.startswith("MEASURED "))[len("MEASURED ") :])
    lines = [
        "",
        f"## In Blender {made['version']}",
        "",
        "Milliseconds of the operators in edit mode with the boundary selected, in a wavy mesh of squares. Median of several;",
        "each fill is undone before the next.",
        "",
        "| hole | Grid Fill | Fill Holes Smoothly | ratio |",
        "|---|---|---|---|",
    ]
    for name, row in made["beside"].items():
        grid, smooth = (1e3 * float(np.median(row[key])) for key in ("grid", "smooth"))
        lines.append(f"| {name} | {grid:.0f} | {smooth:.0f} | {smooth / grid:.2f} |")
    lines += [
        "",
        "One step of a slider, hole of 48 edges in 100,000 faces. *Blender* is the time in which Blender passes the mesh",
        "to Python and takes it back; *TriPatch* is the rest.",
        "",
        "| slider | median | maximum | Blender | TriPatch |",
        "|---|---|---|---|---|",
    ]
    for name, row in made["sliders"].items():
        (median, blender), most = (1e3 * float(np.median(row[key])) for key in ("all", "blender")), 1e3 * max(row["all"])
        lines.append(f"| {name} | {median:.0f} | {most:.0f} | {blender:.0f} | {median - blender:.0f} |")
    operator, library = (np.array(made["part"][key]) for key in ("operator", "library"))
    own = 1e3 * float(np.median(operator - library))
    lines += [
        "",
        f"A sphere octant with sides of {OWN_SIDE} edges, filled with triangles: the operator takes",
        f"{1e3 * float(np.median(operator)):.1f} ms. The library takes {1e3 * float(np.median(library)):.1f} ms of it,",
        f"the add-on {own:.1f} ms.",
    ]
    print("\n".join(lines), flush=True)
    return lines


def write(setting: Setting) -> None:
    load = os.getloadavg()[0]
    lines = densities(setting) + many_holes(setting) + points() + in_blender(setting)
    head = [
        "# Speed",
        "",
        provenance("vertices, faces, the rim and what the tables say; all else at its default", setting.quick),
        f"Compiler: {compiler()}. Load of the machine at the start {load:.2f}, {os.cpu_count()} processors.",
        "`scripts/batch_figures.py` measures batches, `native/benchmarks/evaluate.cpp` single formulas,",
        "`scripts/instructions` instructions.",
        "",
    ]
    (setting.docs / "speed.md").write_text("\n".join(head + lines) + "\n")
