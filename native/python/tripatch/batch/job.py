"""One mesh file: read, filled, written, recorded. Runs in a process that may end with it."""

from __future__ import annotations

import hashlib
import os
import stat
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .. import borders, files
from .._types import Array
from ..errors import Refusal, because
from ..filling import fill_all
from ..messages import Message
from ..options import checked
from . import creases, crops, record
from .settings import CROP, FILL, LIST, Settings

OUTER = Message("outer_border_skipped", {"option": "--outer"})


def sha256_of(path: Path) -> str | None:
    """Of a file's content; None where there is none."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return None


def work(path: str, settings: Settings, done_before: dict[str, Any] | None = None, holes: tuple[Any, ...] = ()) -> dict[str, Any]:
    """What became of one file.

    Args:
        path: of the input, absolute.
        done_before: what journals say of the file: key -> SHA-256 of its result, None where it had none.
        holes: CROP: of each its object, its number, and how many fills of the object come before it.

    Returns:
        An entry of the journal: name, key, output_sha256, seconds, lines. Of what need not be done again its key
        only, as "again".
    """
    begun = time.monotonic()
    file = Path(path)
    name = file.relative_to(settings.root).as_posix()
    sha256, known = opened(file, name, settings, done_before, begun)
    if known is not None:
        return known
    if file.suffix.lower() == ".blend":
        from . import blender

        return blender.work(file, name, sha256, settings, begun, holes)
    try:
        return _done(file, name, sha256, settings, begun, holes)
    except files.FileError as error:
        status, reason = record.UNREADABLE, str(error).replace(os.fspath(file), name)
    except MemoryError:
        status, reason = record.MEMORY_LIMIT, memory_reason(settings)
    return entry(settings, name, sha256, [record.of_file(settings, name, sha256=sha256, status=status, reason=reason)], begun)


def opened(
    file: Path, name: str, settings: Settings, done_before: dict[str, Any] | None, begun: float
) -> tuple[str, dict[str, Any] | None]:
    """The SHA-256 of a file's content, and an entry of the journal if there is nothing to do."""
    try:
        if not stat.S_ISREG(file.stat().st_mode):  # a pipe would keep its reader waiting
            raise OSError(Message("not_a_regular_file"))
        with file.open("rb") as content:
            sha256 = hashlib.file_digest(content, "sha256").hexdigest()
    except OSError as error:
        reason: str = Message("file_unreadable", {"path": name, "reason": because(error)})
        return "", entry(settings, name, None, [record.of_file(settings, name, status=record.UNREADABLE, reason=reason)], begun)
    key, before = record.key(settings, name, sha256), done_before or {}
    if settings.mode == FILL and key in before and (before[key] is None or sha256_of(Path(settings.out, name)) == before[key]):
        return sha256, {"again": key}
    return sha256, None


def memory_reason(settings: Settings) -> str:
    return Message("memory_not_enough", {"limit": settings.memory_limit} if settings.memory_limit else {})


def entry(settings: Settings, name: str, sha256: str | None, lines: list[dict[str, Any]], begun: float) -> dict[str, Any]:
    """An entry of the journal."""
    output = lines[0]["output"] and Path(settings.out, lines[0]["output"])
    # another Blender may read what this one did not
    blend = lines[0]["status"] == record.UNREADABLE and name.lower().endswith(".blend")
    passing = lines[0]["status"] in record.PASSING or blend
    return {
        "name": name,
        "key": None if passing or sha256 is None else record.key(settings, name, sha256),
        "output_sha256": sha256_of(output) if output else None,
        "seconds": round(time.monotonic() - begun, 4),
        "lines": lines,
    }


def _left(holes: borders.Holes, loops: list[Any], settings: Settings) -> dict[int, str]:
    """Why filters leave loops out: lowest vertex -> sentence. What none leaves out is an outer border."""
    choosing = settings.choosing()
    reasons: dict[int, str] = {}
    named = [name for name in choosing if name != "outer"]
    for name in named:
        asked = checked("choose_holes", {"outer": True, name: choosing[name]})
        chosen = {int(loop[0]) for loop in holes.connected.chosen(asked)}
        value = ",".join(map(str, np.atleast_1d(choosing[name])))
        said = Message("filter_leaves_out", {"option": f"--{name.replace('_', '-')}", "value": value})
        for loop in loops:
            if int(loop[0]) not in chosen:
                reasons.setdefault(int(loop[0]), said)
    return reasons


def _diameter(points: Array) -> float:
    """Of the box around a rim, which says how large a hole is without all pairs of its points."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _done(file: Path, name: str, sha256: str, settings: Settings, begun: float, wanted: tuple[Any, ...]) -> dict[str, Any]:
    mesh = files.read(file)
    vertices, faces = mesh.vertices, mesh.faces
    holes = borders.find(vertices, faces, join=settings.options.get("join"), **settings.choosing())
    results: list[Any] = []
    try:
        if holes.rims and settings.mode != LIST:
            results = fill_all(vertices, faces, holes, **settings.filling())
    except Refusal as refusal:  # of what is asked for, not of one hole
        results = [refusal] * len(holes.rims)
    if settings.mode == CROP:
        loops, meant = filled_loops(holes), {loop[0]: k for k, loop in enumerate(holes.rims)}
        return {"crops": [crops.of_fill(vertices, faces, results[meant[int(loops[k][0])]]) for _, k, _ in wanted]}

    sharp = largest_creases(vertices, faces, results)

    def line(k: int) -> dict[str, Any]:
        return record.of_hole(settings, name, results[k], crease_max=sharp[k])

    lines = lines_of_holes(holes, vertices, settings, name, line)
    values = {"sha256": sha256, "vertices": len(vertices), "faces": len(faces), **record.outcome(lines)}
    if not len(faces):
        values["reason"] = str(files.without_faces(len(vertices)))
    if values["filled"]:
        obstacle = _obstacle(mesh, holes.joined, [r for r in results if not isinstance(r, Refusal)], name, settings)
        if obstacle:
            failed = record.of_file(settings, name, sha256=sha256, status=record.NOT_WRITTEN, reason=obstacle)
            return entry(settings, name, sha256, [failed], begun)
        values["output"] = name
    return entry(settings, name, sha256, [record.of_file(settings, name, **values), *lines], begun)


def filled_loops(holes: borders.Holes) -> list[Any]:
    """The borders that have a line: not those that are filled with the hole around them."""
    inside = {loop[0] for islands in holes.islands for loop in islands}
    return [loop for loop in holes.borders if loop[0] not in inside]


def lines_of_holes(
    holes: borders.Holes,
    vertices: Array,
    settings: Settings,
    name: str,
    line_of: Callable[[int], dict[str, Any]],
    number: Callable[[int], int] = int,
) -> list[dict[str, Any]]:
    """The lines of all holes of a file.

    Args:
        line_of: what is said of the k-th of `holes.rims`, but for its place.
        number: of a vertex in the file.
    """
    meant = {loop[0]: k for k, loop in enumerate(holes.rims)}
    loops = filled_loops(holes)
    others = [loop for loop in loops if loop[0] not in meant]
    reasons = _left(holes, others, settings) if others else {}
    refusals = holes.connected.refusals(holes.rims) if settings.mode == LIST else []
    lines = []
    for k, loop in enumerate(loops):
        first = int(loop[0])
        place = {"hole": k, "vertex": number(first), "edges": len(loop), "diameter": _diameter(vertices[loop])}
        if first not in meant:
            left = {"outer": first not in reasons, "reason": reasons.get(first, OUTER)}
            line = record.of_hole(settings, name, **left, status=record.LEFT)
        elif settings.mode == LIST:
            no_hole = holes.refused.get(meant[first]) or refusals[meant[first]]
            said = {} if no_hole else {"status": record.LISTED}
            line = record.of_hole(settings, name, no_hole and no_hole.renumbered(number), **said)
        else:
            line = line_of(meant[first])
        lines.append(line | record.plain(place))
    return lines


def largest_creases(vertices: Array, faces: Any, results: Sequence[Any]) -> dict[int, float | None]:
    """By the place in `results`."""
    made = [k for k, result in enumerate(results) if not isinstance(result, Refusal)]
    fills = [(results[k].vertices, results[k].faces, np.asarray(results[k].rim, np.int64)) for k in made]
    return dict.fromkeys(range(len(results))) | dict(zip(made, creases.largest(vertices, faces, fills), strict=True))


def _obstacle(mesh: files.MeshFile, joined: borders.Joined | None, fills: list[Any], name: str, settings: Settings) -> str:
    """Writes the file, its borders joined, with its fills; why that cannot be done, else nothing."""
    out = Path(settings.out, name)
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        mesh = mesh.marked()
        if joined:
            mesh.join(joined)
        mesh.append_all(fills)
        mesh.write(out)
    except (files.FileError, OSError) as error:
        return str(error).replace(os.fspath(out), name)
    return ""
