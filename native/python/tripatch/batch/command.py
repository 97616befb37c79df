"""`tripatch batch`."""

from __future__ import annotations

import argparse
import contextlib
import io
import math
import os
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .. import __version__, arguments, borders, messages, words
from ..errors import out_of_range
from ..filling import fill_all
from ..holes import choose_holes
from ..messages import Message
from . import emit, inputs, journal, keeper, large, local, memory, parts, pictures, record, scheduling
from .in_words import given
from .progress import Progress
from .settings import BATCH_OPTIONS, FILL, LIST, Settings

DONE, NOTHING, USAGE, SOME, STOPPED = 0, 1, 2, 3, 130
_WORST = 12  # seams in the picture
_NAMED = 20  # files that failed: the lines have each
_CUT = 500  # MB of a file: a mesh takes some twenty times as much where it is filled as a whole


def _range(text: str) -> tuple[int, int]:
    first, _, last = text.partition("-")
    try:
        of, to = int(first), int(last or first)
    except ValueError:
        of = to = 0
    if not 1 <= of <= to:
        raise arguments.unreadable(text, "51-100")
    return of, to


def _whole(least: int, most: float = math.inf) -> Any:
    def read(text: str) -> int:
        value = arguments.whole(text)
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(*out_of_range("N", value, least, most).args)
        return value

    return read


def _seconds(text: str) -> float:
    value = float(arguments.number(text))
    if not 0 < value < threading.TIMEOUT_MAX:
        raise argparse.ArgumentTypeError(*out_of_range("SECONDS", value, 0, threading.TIMEOUT_MAX, is_open=True).args)
    return value


def add(commands: Any) -> None:
    """The parser of `tripatch batch`."""
    batch, shown = arguments.command(commands, "batch", lines=journal.LINES, sheet=journal.SHEET), arguments.flag_help
    batch.add_argument("inputs", nargs="*", **shown("batch_inputs"))
    batch.add_argument("--files", type=Path, **shown("files_flag"))
    batch.add_argument("-o", "--out", type=Path, required=True, **shown("batch_out_flag"))
    batch.add_argument("--root", **shown("root_flag"))
    batch.add_argument("--dry-run", action="store_true", **shown("dry_run_flag"))
    where = batch.add_argument_group(messages.label("workers_group"))
    where.add_argument("--workers", type=_whole(0), **shown("workers_flag"))
    where.add_argument("--scheduler", **shown("scheduler_flag"))
    where.add_argument("--range", type=_range, **shown("range_flag"))
    where.add_argument("--emit", choices=emit.KINDS, **shown("emit_flag"))
    where.add_argument("--chunk", type=_whole(1), default=50, **shown("chunk_flag", default=50))
    limits = batch.add_argument_group(messages.label("limits_group"))
    limits.add_argument("--time-limit", type=_seconds, **shown("time_limit_flag"))
    limits.add_argument("--memory-limit", type=_whole(200, sys.maxsize >> 20), **shown("memory_limit_flag"))
    limits.add_argument("--cut-above", type=_whole(0, sys.maxsize >> 20), default=_CUT, **shown("cut_above_flag", default=_CUT))
    limits.add_argument("--retries", type=_whole(0), default=1, **shown("retries_flag", default=1))
    batch.add_argument("--worst", type=_whole(0), **shown("worst_flag", default=_WORST))
    batch.add_argument("--blender", default="blender", **shown("blender_flag", default="blender"))
    batch.add_argument("--addon", **shown("addon_flag"))
    batch.add_argument("--join", type=arguments.number, **shown("join_flag"))
    arguments.add_groups(batch, BATCH_OPTIONS.values())
    arguments.add_talk(batch)


def _say(text: str) -> None:
    print(f"tripatch: {arguments.worded(text)}", file=sys.stderr)


def _words(args: argparse.Namespace) -> list[str]:
    """What a portion of a farm needs of the command, as words."""
    words = [f"--root={args.root}"]
    for name in ("time_limit", "memory_limit", "cut_above", "retries", "worst", "blender", "addon"):
        value = getattr(args, name)
        if value is not None and (name, value) not in (("cut_above", _CUT), ("retries", 1), ("blender", "blender")):
            words += given({name: value})
    return words + given(args.options)


def _settings(args: argparse.Namespace) -> tuple[list[Path], Settings]:
    """The files and what they have in common; ValueError where they do not go together."""
    if not args.inputs and not args.files:
        raise inputs.InputError(Message("inputs_unnamed"))
    if args.range and not args.files:
        raise inputs.InputError(Message("option_needs", {"option": "--range", "needed": "--files"}))
    for first, second, both in (
        ("INPUT", "--files", args.inputs and args.files),
        ("--scheduler", "--workers", args.scheduler and args.workers is not None),
        ("--emit", "--dry-run", args.emit and args.dry_run),
    ):
        if both:
            raise inputs.InputError(Message("options_exclusive", {"first": first, "second": second}))
    out = args.out.absolute()
    if out.exists() and not out.is_dir():
        raise inputs.InputError(Message("not_a_folder", {"path": str(args.out)}))
    found = inputs.from_list(args.files) if args.files else inputs.listed(args.inputs, out)
    root = inputs.root_of(found, args.root)
    given = {name: getattr(args, name) for name in BATCH_OPTIONS if hasattr(args, name)}
    joining = {} if args.join is None else {"join": args.join}
    blend = next((str(file) for file in found if file.suffix.lower() == ".blend"), None)
    if joining and blend:
        raise inputs.InputError(Message("options_exclusive", {"first": "--join", "second": blend}))
    # what no file could be filled with is said before the first
    asked = Settings("", "", given)
    choose_holes(np.eye(3), [[0, 1, 2]], **asked.choosing())
    fill_all(np.eye(3), [[0, 1, 2]], [], **asked.filling())
    borders.find(np.eye(3), [[0, 1, 2]], **joining)
    args.root, args.options = str(root), record.plain(given | joining)
    wanted = found
    if args.range:
        wanted = found[args.range[0] - 1 : args.range[1]]
        if found and not wanted:
            raise out_of_range("--range", args.range[0], 1, len(found))
    if not args.dry_run:
        inputs.check_places(wanted, found, root, out)
    # who does the files may stand in another folder
    args.addon = args.addon and os.path.abspath(args.addon)
    args.blender = os.path.abspath(args.blender) if os.path.dirname(args.blender) else args.blender
    common = {name: getattr(args, name) for name in ("time_limit", "memory_limit", "retries", "blender", "addon")}
    mode = LIST if args.dry_run else FILL
    return wanted, Settings(args.root, str(out), args.options, __version__, mode, **common)


def _run(args: argparse.Namespace, found: Sequence[Path], settings: Settings) -> tuple[list[dict[str, Any] | None], bool]:
    """An entry for each file, None for those that Ctrl-C left undone, and whether it came."""
    entries: list[dict[str, Any] | None] = [None] * len(found)
    progress = Progress(len(found), io.StringIO() if args.quiet else None)
    kept = journal.Journal(Path(settings.out)).before() if settings.mode == FILL else {}
    known = [kept.get(file.relative_to(settings.root).as_posix(), {}) for file in found]

    def take(done: list[tuple[int, dict[str, Any]]]) -> None:
        found = {k: {**known[k][entry["again"]], "again": True} if "again" in entry else entry for k, entry in done}
        for k, entry in found.items():
            entries[k] = entry
        progress.add(list(found.values()))

    before = [{key: entry["output_sha256"] for key, entry in each.items()} for each in known]
    workers = 1 if args.range else args.workers

    def run_parts(tasks: Iterator[parts.Task]) -> parts.Answers:
        if args.scheduler:
            return scheduling.run_parts(tasks, settings, args.scheduler)
        return local.run_parts(tasks, settings, workers)

    def cut(k: int) -> bool:
        """Whether a file was filled in parts."""
        if not large.is_cut(found[k], settings, args.cut_above * 10**6):
            return False
        with keeper.Keeper(settings) as kept:
            entry = large.work(found[k], settings, before[k], run_parts, progress.parts(found[k].name))
            if entry:
                kept.keep(entry, str(found[k]), before[k])
                take([(k, entry)])
        return entry is not None

    stopped = False
    try:
        whole = [k for k in range(len(found)) if not cut(k)]

        def take_whole(done: list[tuple[int, dict[str, Any]]]) -> None:
            take([(whole[i], entry) for i, entry in done])

        left, journals = [found[k] for k in whole], [before[k] for k in whole]
        if left and args.scheduler:
            scheduling.run(left, settings, journals, take_whole, args.scheduler)
        elif left:
            local.run(left, settings, journals, take_whole, workers)
    except KeyboardInterrupt:
        stopped = True
    finally:
        progress.end()
    return entries, stopped


def _of_unjoined(heads: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """A parameter of a message, or none."""
    rims = [head["unjoined"] for head in heads if head["unjoined"]]
    return {"reason": Message("rims_on_borders", {"count": sum(rims), "files": len(rims)})} if rims else {}


def _listing(entries: Sequence[dict[str, Any]]) -> int:
    """What a dry run says."""
    meant = 0
    for entry in entries:
        head, *holes = entry["lines"]
        if not holes:
            print(f"{head['input']}: {head['reason'] or Message('no_hole_in_file')}")
        for hole in holes:
            meant += hole["status"] == record.LISTED
            ob = f"{hole['object']}, " if hole["object"] else ""
            of_loop: dict[str, Any] = {"edges": hole["edges"]}
            of_loop |= {} if hole["diameter"] is None else {"size": f"{hole['diameter']:.3g}"}
            place = "" if hole["vertex"] is None else Message("hole_listed", of_loop, [hole["vertex"]])
            filled = [Message("would_be_filled")] if hole["status"] == record.LISTED else []
            what = ". ".join(filter(None, [*filled, hole["reason"]]))
            print(f"{head['input']}: {ob}{place}: {what}")
    unjoined = _of_unjoined([entry["lines"][0] for entry in entries])
    print(Message("batch_planned", {"holes": meant, "files": len(entries)} | unjoined))
    _tell_left_open(entries)
    return NOTHING if _filters_leave_all(entries) else DONE


def _lines_of_holes(entries: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    return [line for entry in entries for line in entry["lines"][1:]]


def _tell_left_open(entries: Sequence[dict[str, Any]]) -> None:
    edges = [line["edges"] for line in _lines_of_holes(entries) if line["outer"]]
    if edges:
        print(words.left_open(edges, "--outer"))


def _filters_leave_all(entries: Sequence[dict[str, Any]]) -> bool:
    """Whether nothing was filled that was asked for."""
    holes = [line["status"] for line in _lines_of_holes(entries) if not line["outer"]]
    return record.LEFT in holes and not {record.FILLED, record.LISTED} & set(holes)


def _summary(entries: Sequence[dict[str, Any]]) -> str:
    """'Filled 950 holes in 900 of 1000 files; 50 holes refused; 2 files failed: 1 unreadable, 1 crashed'"""
    heads = [entry["lines"][0] for entry in entries]
    holes = sum(head["filled"] for head in heads)
    said: dict[str, Any] = {"holes": holes, "changed": sum(head["output"] is not None for head in heads), "files": len(heads)}
    counts = {name: sum(head[name] for head in heads) for name in ("refused", "folded")}
    said |= {name: count for name, count in counts.items() if count} | _of_unjoined(heads)
    bad = [head["status"] for head in heads if head["status"] in record.FAILED]
    if bad:
        said |= {"failed": len(bad), "kinds": [f"{bad.count(kind)} {kind}" for kind in dict.fromkeys(sorted(bad))]}
    return Message("batch_done", said)


def _end(args: argparse.Namespace, entries: Sequence[dict[str, Any]], settings: Settings) -> int:
    """The lines, the picture, and the last words; the exit status."""
    out = Path(settings.out)
    lines = journal.write_lines(out, entries)
    heads = [entry["lines"][0] for entry in entries]
    failed = [head for head in heads if head["status"] in record.FAILED]
    for head in failed[:_NAMED]:
        _say(Message("batch_file_failed", {"file": head["input"], "reason": head["reason"]}))
    print(_summary(entries))
    _tell_left_open(entries)
    print(Message("lines_written", {"path": str(lines)}))
    total = sum(line["status"] == record.FILLED for entry in entries for line in entry["lines"][1:])
    shown = _WORST if args.worst is None else args.worst
    # for a picture a file is read as a whole
    least = args.cut_above * 10**6
    seen = [entry for entry in entries if not large.is_cut(Path(settings.root, entry["name"]), settings, least)]
    if shown and total:
        try:
            if pictures.sheet(out / journal.SHEET, pictures.worst(seen, shown), settings, total):
                print(Message("sheet_written", {"path": str(out / journal.SHEET)}))
        except ImportError:
            needed = {"what": "--worst", "package": "Pillow", "install": "'tripatch[batch]'"}
            if args.worst is not None:
                _say(Message("package_needed", needed))
    if all(head["status"] in (record.FILLED, record.NOTHING) for head in heads):
        return NOTHING if _filters_leave_all(entries) else DONE
    return SOME if total else NOTHING


def _stops() -> None:
    """SIGTERM, by which clusters take a machine back, ends a run as Ctrl-C does."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, signal.default_int_handler)


def run(args: argparse.Namespace) -> int:
    """Runs `tripatch batch`; the exit status."""
    if isinstance(sys.stdout, io.TextIOWrapper):  # names of files need not be text
        sys.stdout.reconfigure(errors="surrogateescape" if args.emit else "backslashreplace")
    found, settings = _settings(args)
    if not found:
        _say(Message("no_file_to_fill", {"suffixes": list(inputs.SUFFIXES)}))
        return NOTHING
    if args.emit or not args.dry_run:
        journal.prepare(Path(settings.out))
    if args.emit:
        out = Path(settings.out)
        text, told = emit.emitted(args.emit, found, out, _words(args), args.chunk, args.memory_limit)
        print(text, end="")
        _say(told)
        return DONE
    if args.memory_limit and not memory.LIMITS:
        _say(Message("no_memory_limit"))
    _stops()
    try:
        entries, stopped = _run(args, found, settings)
    except scheduling.SchedulerError as error:
        _say(str(error))
        return USAGE
    done = [entry for entry in entries if entry is not None]
    if settings.mode == LIST:
        return STOPPED if stopped else _listing(done)
    if stopped:
        _say(Message("batch_stopped", {"done": len(done), "files": len(entries)}))
        return STOPPED
    with contextlib.redirect_stdout(io.StringIO() if args.quiet else sys.stdout):
        if args.range:  # others are at work: who calls without a range gathers
            print(_summary(done))
            return DONE
        return _end(args, done, settings)
