"""HoleBench: fills every hole by TriPatch and by other programs, measures all by one code, writes results as JSON and a page."""

from __future__ import annotations

import argparse
import json
import shutil
import time
from pathlib import Path

import numpy as np
import tripatch

from . import metrics, page, rivals, sets
from .holes import Hole
from .kept import FAILURES, Kept
from .page import OURS, TRUTH

QUICK = 7  # --quick: no multiple of what the sets repeat


def of_truth(hole: Hole, made: rivals.Filling) -> rivals.Filling:
    """TriPatch's triangles with their vertices on the true surface: what triangles of that size cannot avoid."""
    vertices = made.vertices.copy()
    vertices[len(hole.vertices) :] = hole.nearest(vertices[len(hole.vertices) :])
    return rivals.Filling(vertices, made.faces, 0)


def measured(hole: Hole, others: dict) -> tuple[dict, dict]:
    """What is stored of a hole: filler -> figures, or the reason why there are none; and filler -> Filling."""
    row: dict = {"set": hole.group, "mesh": hole.mesh, "edges": len(hole.rim), "fillers": {}}
    made: dict = {}
    try:
        fill, made[OURS] = rivals.ours(hole)
    except tripatch.Refusal as refusal:
        row["fillers"][OURS] = {"failed": refusal.reason}
        return row, made
    if hole.nearest and hole.normals is not None:
        made[TRUTH] = of_truth(hole, made[OURS])
    for name, call in others.items():
        try:
            made[name] = call(hole, fill)
        except FAILURES as error:
            row["fillers"][name] = {"failed": str(error)[:100] or type(error).__name__}
    for name, each in made.items():
        row["fillers"][name] = metrics.measure(hole, each.vertices, each.faces) | {"cpu": each.cpu}
    mine, deviation = row["fillers"][OURS], fill.deviation
    mine["method"] = fill.report.method
    if hole.distance and deviation is not None and len(deviation):
        stated = np.asarray(deviation) > 1e-12 * hole.diameter
        errors = hole.distance(fill.vertices[stated]) / np.hypot(np.asarray(deviation)[stated], hole.off)
        row["ratios"] = [float(f"{ratio:.3g}") for ratio in errors]
    return row, made


def in_turn(settings: argparse.Namespace) -> list[Hole]:
    """The holes of all sets: each seventh first, so that a run that is stopped has some of every set."""
    chosen = settings.sets.split(",") if settings.sets else None
    found = []
    for group, make in sets.all_sets(settings.data, blender=settings.blender, cache=settings.cache):
        if not chosen or group in chosen:
            for k, hole in enumerate(make()):
                hole.group = group
                found.append((k % QUICK, k // QUICK, len(found), hole))
    return [hole for turn, *_, hole in sorted(found, key=lambda each: each[:3]) if not settings.quick or not turn]


def run(settings: argparse.Namespace, others: dict, results: dict) -> None:
    """Fills `results`, which is written after each hole: what has been done is kept if it is stopped."""
    start, found, count = time.perf_counter(), in_turn(settings), 0
    results["of"] = len(found)
    for hole in found:
        key = f"{hole.group}: {hole.name}"
        if key in results["holes"]:
            continue
        if settings.minutes and time.perf_counter() - start > 60 * settings.minutes:
            break
        row, made = measured(hole, others)
        results["holes"][key] = row
        count += 1
        if settings.pictures and hole.name in page.PICTURED and made:
            from . import pictures

            pictures.draw(settings.pictures / f"{hole.name}.png", hole, made, row["fillers"])
        part = settings.json.with_suffix(".part")
        part.write_text(json.dumps(results, indent=0, default=float) + "\n")
        part.replace(settings.json)
        if count % 20 == 0:
            print(f"{len(results['holes'])} of {len(found)} holes, {time.perf_counter() - start:.0f} s", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(prog="holebench", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="every seventh hole of each set: ten minutes")
    parser.add_argument("--minutes", type=float, help="stop after as many; what is done by then has holes of every set")
    parser.add_argument("--data", type=Path, help="a folder of meshes, or of NAME_original and NAME_gt (its truth) each")
    parser.add_argument(
        "--rival", action="append", default=[], metavar="NAME=COMMAND", help="a program that takes IN.obj OUT.obj"
    )
    parser.add_argument(
        "--without", default="", help="rivals to leave out, by the beginnings of their names, with commas between"
    )
    parser.add_argument("--sets", default="", help="names of some sets, with commas between")
    parser.add_argument("--json", type=Path, required=True, help="where the results go")
    parser.add_argument("--page", type=Path, help="where the page goes")
    parser.add_argument("--pictures", type=Path, help="the folder of the pictures")
    parser.add_argument("--resume", action="store_true", help="keep the holes that the results have")
    parser.add_argument("--only-page", action="store_true", help="write the page of results that are there")
    parser.add_argument("--cache", type=Path, required=True, help="folder for what Blender makes, and other programs' fills")
    for name, what in (("cgal", "the compiled cgal_fill"), ("pmp", "the compiled pmp_fill"), ("blender", "Blender")):
        parser.add_argument(f"--{name}", default="", help=what)
    settings = parser.parse_args()
    settings.blender = shutil.which(settings.blender) or ""
    settings.cache.mkdir(parents=True, exist_ok=True)
    if not settings.only_page:
        commands = dict(word.split("=", 1) for word in settings.rival)
        others, versions, skipped = rivals.available(settings.cgal, settings.pmp, settings.blender, commands)
        left_out = tuple(filter(None, settings.without.split(",")))
        others = {name: call for name, call in others.items() if not name.startswith(left_out or "\n")}
        for line in skipped:
            print(f"skipped: {line}")
        sources = [sets.origin(p) for p in sorted(settings.data.rglob("*")) if p.is_file()] if settings.data else []
        known = {"versions": versions, "skipped": skipped, "data": sources}
        results = {**page.measured_on(), **known, "holes": {}}
        kept = Kept(settings.cache / "rivals", results, versions)
        others = {name: kept.of(name, call) for name, call in others.items()}
        if settings.resume and settings.json.exists():
            results["holes"] = json.loads(settings.json.read_text())["holes"]
        run(settings, others, results)
    results = json.loads(settings.json.read_text())
    if settings.pictures:
        from . import pictures

        rows = list(results["holes"].values())
        pictures.distances(settings.pictures / "distances.png", rows, page.fillers_of(rows))
    if settings.page:
        settings.page.write_text(page.page(results))


if __name__ == "__main__":
    main()
