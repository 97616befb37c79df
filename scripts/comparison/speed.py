"""docs/speed.md: times beside CGAL's by density, how they grow, peak memory, many holes in one mesh, and Blender's operators."""

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
#: fairing -> (continuity of CGAL that does as much, times faster than it that are wanted at the first three densities)
BESIDE = {"None": (1, (12, 100, 400)), "auto": (2, (6, 60, 600))}
EXPONENT = 1.05
BEYOND = 0.1, 64e6  # of input and output; bytes: the greater of them
#: of 900 holes the cells, the holes along an edge, and seconds wanted by fairing; of 10,000 also the rate of two threads over one
SIDE, MANY, WANTED_MANY, MORE, TWO_OVER_ONE = 6, (975, 30), {"auto": 4.0}, (1300, 100), 1.7
POINTS, WANTED_POINTS = 1_000_000, 2.5  # with normals; times copying the result
SLIDER_STEP = 60.0  # milliseconds wanted
#: of the operator, and the side of the hole in which it is measured
OWN_PART, OWN_SIDE = 15.0, 32  # milliseconds wanted


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


def yes(good: bool) -> str:
    return "yes" if good else "**no**"


def densities(setting: Setting) -> list[str]:
    edges, rounds = (EDGES[:2], 1) if setting.quick else (EDGES, ROUNDS)
    lines = [
        "## A sphere octant by density",
        "",
        "Milliseconds, arrays in, arrays out; CGAL's refine and fair without the making of its data structure. Both in turns, in",
        "processes of their own. Memory is the peak of the first fill beyond its input and output, which are the MB before it.",
        "",
        "| filler | triangles | least | median | times CGAL | wanted | reached | MB in and out | MB beyond | reached |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    growth = [
        "",
        "| filler | time grows as triangles to the power of | the last two | wanted | reached |",
        "|---|---|---|---|---|",
    ]
    for fairing, (continuity, wanted) in BESIDE.items():
        made = []
        for k, n in enumerate(edges):
            mine, theirs = {}, []
            for _ in range(rounds):
                again = alone(["comparison.one_fill", n, fairing, OURS])
                mine = {**again, **mine, "seconds": mine.get("seconds", []) + again["seconds"]}
                if setting.cgal and k < len(wanted):
                    theirs += of_cgal(setting.cgal, setting.cache, n, continuity, THEIRS)
            made.append(mine)
            ratio = min(theirs) / min(mine["seconds"]) if theirs else 0
            against = f"{ratio:.1f} | {wanted[k]} | {yes(ratio >= wanted[k])}" if theirs else " | | "
            both = mine["input"] + mine["output"]
            small = yes(mine["beyond"] <= max(BEYOND[0] * both, BEYOND[1]))
            memory = f"{both / 1e6:.1f} | {mine['beyond'] / 1e6:.1f} | {small}"
            lines.append(f"| TriPatch, fairing {fairing} | {mine['triangles']} | {ms(mine['seconds'])} | {against} | {memory} |")
            if theirs:
                lines.append(f"| CGAL, continuity {continuity} | | {ms(theirs)} | | | | | | |")
            print(lines[-2 if theirs else -1], flush=True)
        last = exponent(made[-2:])
        good = yes(max(exponent(made), last) <= EXPONENT)
        growth.append(f"| TriPatch, fairing {fairing} | {exponent(made):.2f} | {last:.2f} | {EXPONENT} | {good} |")
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
        "| fairing | least | median | CPU | wanted | reached |",
        "|---|---|---|---|---|---|",
    ]
    for fairing in BESIDE:
        option = None if fairing == "None" else fairing
        cpu = time.process_time()
        seconds = best(lambda option=option: tripatch.fill_all(vertices, faces, rims, fairing=option), 3)
        cpu = (time.process_time() - cpu) / 3
        wanted = WANTED_MANY.get(fairing)
        reached = f"{wanted} | {yes(min(seconds) <= wanted)}" if wanted else " | "
        lines.append(f"| {fairing} | {min(seconds):.2f} | {float(np.median(seconds)):.2f} | {cpu:.2f} | {reached} |")
        print(lines[-1], flush=True)
    cells, along = (195, 6) if setting.quick else MORE
    turns = [[alone(["comparison.all_holes", cells, along, SIDE], cores)["seconds"] for cores in (1, 2)] for _ in range(TURNS)]
    one, two = map(min, zip(*turns, strict=True))
    lines += [
        "",
        f"{along**2} holes in one mesh without fairing, the least of {TURNS} in turns: {one:.1f} s on one core, {two:.1f} s on",
        f"two, {one / two:.2f} times as fast (wanted {TWO_OVER_ONE}: {yes(one / two >= TWO_OVER_ONE)}).",
    ]
    print(lines[-1], flush=True)
    return lines


def points() -> list[str]:
    hole = holes.sphere(32)
    b = np.random.default_rng(0).dirichlet([1, 1, 1], POINTS)
    lines = ["", f"## {POINTS:,} points", "", "Milliseconds, the least of several:", ""]
    lines += ["| patch | positions | positions and normals | copying both into new memory | times copying | wanted | reached |"]
    lines += ["|---|---|---|---|---|---|---|"]
    for fairing in BESIDE:
        patch = tripatch.fill(hole.vertices, hole.faces, rim=hole.rim, fairing=None if fairing == "None" else fairing).patch
        result = patch.positions_and_normals(b)
        calls = (patch.evaluate, patch.positions_and_normals, lambda _, arrays=result: [a.copy() for a in arrays])
        positions, both, copying = (1e3 * min(best(lambda call=call: call(b), REPETITIONS)) for call in calls)
        reached = f"{both / copying:.1f} | {WANTED_POINTS} | {yes(both <= WANTED_POINTS * copying)}"
        lines.append(f"| fairing {fairing} | {positions:.0f} | {both:.0f} | {copying:.0f} | {reached} |")
    return lines


def in_blender(setting: Setting) -> list[str]:
    """Smooth Fill beside Grid Fill, and its sliders: what in_blender.py measures inside of Blender."""
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
        "The operators as scripts call them, in edit mode with the rim selected, in a wavy mesh of squares; milliseconds, the",
        "median of several, each fill undone before the next.",
        "",
        "| hole | Grid Fill | Smooth Fill | times Grid Fill | wanted | reached |",
        "|---|---|---|---|---|---|",
    ]
    for name, row in made["beside"].items():
        grid, smooth = (1e3 * float(np.median(row[key])) for key in ("grid", "smooth"))
        good = yes(smooth <= row["wanted"] * grid)
        lines.append(f"| {name} | {grid:.0f} | {smooth:.0f} | {smooth / grid:.2f} | {row['wanted']} | {good} |")
    lines += [
        "",
        "A step of a slider, 48 edges in 100,000 faces: median and most; Blender's part of it, which is what it takes to show",
        "the mesh to Python (one vertex, edge and face of it) and to take it back; and the rest, the add-on's and the library's:",
        "",
        "| slider | median | most | Blender's part | own | wanted | reached |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, row in made["sliders"].items():
        (median, blender), most = (1e3 * float(np.median(row[key])) for key in ("all", "blender")), 1e3 * max(row["all"])
        own = median - blender
        good = yes(own <= SLIDER_STEP)
        lines.append(f"| {name} | {median:.0f} | {most:.0f} | {blender:.0f} | {own:.0f} | {SLIDER_STEP:.0f} | {good} |")
    operator, library = (np.array(made["part"][key]) for key in ("operator", "library"))
    own = 1e3 * float(np.median(operator - library))
    lines += [
        "",
        f"A sphere octant with sides of {OWN_SIDE} edges filled with triangles: the operator takes",
        f"{1e3 * float(np.median(operator)):.1f} ms, of which {1e3 * float(np.median(library)):.1f} ms are the library's, and",
        f"{own:.1f} ms its own (wanted {OWN_PART:.0f}: {yes(own <= OWN_PART)}).",
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
        "Batches are measured by `scripts/batch_figures.py`, single formulas by `native/benchmarks/evaluate.cpp` (Google",
        "Benchmark), and instructions by `scripts/instructions`.",
        "",
    ]
    (setting.docs / "speed.md").write_text("\n".join(head + lines) + "\n")
