"""The command line: `tripatch fill IN OUT`, `batch INPUT...`, `smooth IN OUT`, `view FILE OUT.png` and `methods`."""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import tripatch
from tripatch import arguments, borders, files, filling, messages, view, words
from tripatch.batch import command as batch
from tripatch.batch import creases
from tripatch.batch.record import SCHEMA, plain
from tripatch.errors import WrongValue, because
from tripatch.files import evidence
from tripatch.options import checked

FILLED, NOTHING, USAGE, SOME = 0, 1, 2, 3
INTERRUPTED = 130  # what shells say of SIGINT
MAX_TOLD = 20  # refusals: more run off the screen; of a mesh whose faces are not joined there is one for each face

#: The options of `tripatch.fill`; but the faces of a file stay.
OPTIONS = {name: option for name, option in tripatch.OPTIONS.items() if name != "replaced"}


def parser() -> argparse.ArgumentParser:
    """The parser of the command line."""
    main = arguments.Parser(prog="tripatch", description=messages.text("about_tripatch"))
    shown = arguments.flag_help
    main.add_argument("--version", action="version", version=f"tripatch {tripatch.__version__}", **shown("version_flag"))
    title, word = messages.label("commands_group"), messages.label("command")
    commands = main.add_subparsers(dest="command", required=True, metavar=word, title=title)
    fill = arguments.command(commands, "fill")
    fill.add_argument("input", type=Path, **shown("mesh_file_in"))
    arguments.add_out(fill, "mesh_file_out")
    fill.add_argument("--all", action="store_true", **shown("all_flag"))
    fill.add_argument("--report", type=Path, **shown("report_flag"))
    fill.add_argument("--deviation", action="store_true", **shown("deviation_flag"))
    fill.add_argument("--join", type=arguments.number, **shown("join_flag"))
    arguments.add_groups(fill, OPTIONS.values())
    arguments.add_talk(fill, json=True)
    batch.add(commands)
    smooth = arguments.command(commands, "smooth")
    smooth.add_argument("input", type=Path, **shown("mesh_file_in"))
    arguments.add_out(smooth, "mesh_file_out")
    smooth.add_argument("--resolution", type=arguments.whole, default=8, **shown("edge_parts_flag", default=8))
    smooth.add_argument("--curve", choices=("hermite", "smits"), default="hermite", **shown("curve_flag", default="hermite"))
    arguments.add_talk(smooth)
    strip = arguments.command(commands, "strip")
    strip.add_argument("input", type=Path, **shown("filled_file_in"))
    arguments.add_out(strip, "original_file_out")
    strip.add_argument("--report", type=Path, **shown("read_report_flag"))
    arguments.add_talk(strip)
    view.add(commands)
    arguments.command(commands, "methods")
    return main


def _say(text: str) -> None:
    print(f"tripatch: {arguments.worded(text)}", file=sys.stderr)


def _unheard(_: str) -> None:
    """What --quiet leaves out."""


def _progress(done: int, total: int) -> None:
    """A line that is written over, where somebody looks on."""
    if total > 1 and sys.stderr.isatty():
        said = tripatch.Message("holes_done", {"done": done, "total": total})
        print(f"\rtripatch: {said}", end="\n" if done == total else "", file=sys.stderr, flush=True)


def _refused(refusal: tripatch.Refusal, rim: Sequence[int] | None = None) -> None:
    said = words.refused(refusal)
    _say(said if rim is None else tripatch.Message("of_holes", {"count": 1, "reason": said}, [min(rim)]))


def _explain_numbers(args: argparse.Namespace, said: Sequence[str]) -> None:
    """Says from where vertices count, if messages name some and the lines of the file count otherwise."""
    if args.input.suffix.lower() == ".obj" and any(isinstance(each, tripatch.Message) and each.names_vertices for each in said):
        _say(tripatch.Message("obj_counts_from_one"))


def _said(rim: Sequence[int] | None, result: Any) -> tuple[int, list[str]]:
    """A vertex of a hole, and what its fill says."""
    if isinstance(result, tripatch.Refusal):
        return (0 if rim is None else min(rim)), []
    return int(min(result.rim)), result.report.warnings


def _report(holes: list[Any], left: Sequence[Any], out: files.MeshFile) -> str:
    """The JSON report of all holes, of borders left open, and of what was added to the file."""
    entries = []
    for rim, result in holes:
        if isinstance(result, tripatch.Refusal):
            codes = [each.code for each in result.messages]
            entries.append({"rim": rim, "refused": result.reason, "codes": codes, "where": result.where})
        else:
            added = {"rim": result.rim, "new_vertices": len(result.vertices), "new_faces": len(result.faces)}
            if len(result.creases[0]):
                added["creases"] = result.creases[0]
            entries.append({**added, **result.report.as_dict(), "passes_through": result.passes_through})
    borders = [{"code": "outer_border_left_open", "edges": len(loop), "rim": loop} for loop in left]
    said = {"schema": SCHEMA, "tripatch": tripatch.__version__, "holes": entries, "outer_borders": borders, **out.evidence()}
    return json.dumps(plain(said), indent=2) + "\n"


def _tell(args: argparse.Namespace, holes: list[Any], left: Sequence[Any], out: files.MeshFile) -> None:
    """Writes and prints what is asked for of all holes."""
    if args.report:
        files.write_over(args.report, lambda part: part.write_bytes(_report(holes, left, out).encode()))
    if args.json:
        print(_report(holes, left, out), end="")
        if left:
            _say(_left_open(args, left))
    elif args.verbose or args.why:
        print("".join(f"{line}\n" for line in _lines(holes, args.why)), end="")


def _lines(holes: list[Any], why: bool) -> list[str]:
    """Of each hole what became of it; why: and all candidates for its fill."""
    said = list[str]()
    for rim, result in holes:
        if isinstance(result, tripatch.Refusal):
            said.append(tripatch.Message("hole_refused", {}, [] if rim is None else [min(rim)]))
        else:
            report = result.report
            filled = {"faces": len(result.faces), "method": report.method, "reason": report.method_reason}
            said.append(tripatch.Message("hole_filled_by", filled, [min(result.rim)]))
            said += [f"  {row}" for row in words.candidates(report)] if why else []
    return said


def _options(args: argparse.Namespace) -> dict[str, Any]:
    """Those that were given, if they go with each other."""
    options = {name: getattr(args, name) for name in OPTIONS if hasattr(args, name)}
    if isinstance(options.get("islands"), str):
        options.pop("islands")
    for name in options:
        if args.all and name == "corners" and len(options[name]) == 0:
            continue  # all of them are round
        if args.all and "fill_all" not in OPTIONS[name].functions:
            raise WrongValue(tripatch.Message("options_exclusive", {"first": "--all", "second": name}))
        if not args.all and "fill" not in OPTIONS[name].functions:
            raise WrongValue(tripatch.Message("option_needs", {"option": name, "needed": "--all"}))
        if args.join is not None and name == "rim":
            raise WrongValue(tripatch.Message("options_exclusive", {"first": "--join", "second": name}))
    checked("fill_all" if args.all else "fill", {name: given for name, given in options.items() if name != "corners"})
    return options


def _gathering(args: argparse.Namespace) -> dict[str, Any]:
    """What is asked of borders that lie on others, and of islands."""
    islands = getattr(args, "islands", "auto")
    return {"join": args.join, "islands": islands if isinstance(islands, str) else "none"}


def _left_open(args: argparse.Namespace, left: Sequence[Any]) -> str:
    return words.left_open([len(loop) for loop in left], _option_of_outer(args))


def _option_of_outer(args: argparse.Namespace) -> str:
    return "--outer" if args.all else "--all --outer"


def _out(args: argparse.Namespace, mesh: files.MeshFile, joined: borders.Joined | None = None) -> files.MeshFile:
    """The mesh in the format of OUT, before fills are added."""
    same_format = args.out.suffix.lower() == args.input.suffix.lower()
    out = (mesh if same_format else files.converted(mesh, args.out.suffix, joined)).marked()
    out = out.with_deviation() if args.deviation else out
    if joined and same_format:
        out.join(joined)
    return out


def _write(args: argparse.Namespace, out: files.MeshFile) -> None:
    out.write(args.out)
    args.written = {"path": str(args.out)}
    if args.out.suffix.lower() != args.input.suffix.lower() and not args.quiet:
        _say(f"{args.out}: {tripatch.Message('only_geometry_written', {'suffix': args.input.suffix})}")


def _tell_joined(args: argparse.Namespace, found: borders.Holes | None) -> None:
    if found and found.joined:
        print(words.joined(len(found.joined.moved[0]), len(found.joined.splits)))
    elif found and args.join is not None:
        print(tripatch.Message("no_borders_joined", {"distance": args.join}))


def _copied(args: argparse.Namespace, out: files.MeshFile, found: borders.Holes) -> int:
    """OUT is written without fills: the mesh has no hole."""
    _tell(args, [], found.outer_borders, out)
    _write(args, out)
    if not args.json and not args.quiet:
        _tell_joined(args, found)
        print(words.nothing_to_fill([len(loop) for loop in found.outer_borders], _option_of_outer(args)))
    return FILLED


def _check_files(args: argparse.Namespace) -> None:
    """Whether files are named that can be read and written, before the work is done."""
    if args.input.is_dir():
        raise WrongValue(tripatch.Message("folder_given", {"path": str(args.input)}))
    args.out = arguments.out_of(args)
    if args.report and os.path.realpath(args.report) in map(os.path.realpath, (args.input, args.out)):
        raise WrongValue(tripatch.Message("would_overwrite", {"path": str(args.report), "option": "--report"}))
    files.check_output(args.out)
    if args.report:
        files.check_folder(args.report)


def _fill(args: argparse.Namespace) -> int:
    _check_files(args)
    options = _options(args)
    choosing = {name: options.pop(name) for name in list(options) if "choose_holes" in OPTIONS[name].functions}
    mesh = files.read_faces(args.input)
    out = _out(args, mesh)

    holes: list[tuple[Any, ...]] = []
    found, left = None, list[Any]()
    if args.all or not options.keys() & {"rim", "corners", "islands"}:
        found = borders.find(mesh.vertices, mesh.faces, **_gathering(args), **choosing)
        left = found.outer_borders
        if found.joined:
            out = _out(args, mesh, found.joined)
        if not found.rims and not (choosing.keys() - {"outer"} and tripatch.choose_holes(mesh.vertices, mesh.faces)):
            return _copied(args, out, found)
    if found and (args.all or (len(found.rims) - len(found.refused) <= 1 and not found.is_plain)):
        results = filling.fill_all(mesh.vertices, mesh.faces, found, progress=_progress, **options)
        holes = list(zip(results.rims, results, strict=True))
        if not holes:
            _say(tripatch.Message("all_holes_filtered"))
    else:
        try:
            holes = [(options.get("rim"), tripatch.fill(mesh.vertices, mesh.faces, **options))]
        except tripatch.Refusal as refusal:
            holes = [(options.get("rim"), refusal)]
    refused = [(rim, result) for rim, result in holes if isinstance(result, tripatch.Refusal)]
    for rim, result in refused[:MAX_TOLD]:
        _refused(result, rim if args.all else None)
    if len(refused) > MAX_TOLD:
        _say(tripatch.Message("more_refused", {"count": len(refused) - MAX_TOLD}))
    if refused:
        _explain_numbers(args, [words.refused(result) for _, result in refused])
    note = _unheard if args.quiet else _say

    fills: list[tripatch.Fill] = [result for _, result in holes if not isinstance(result, tripatch.Refusal)]
    out.append_all(fills)
    _tell(args, holes, left, out)
    if not fills:
        return NOTHING
    if any(len(fill.creases[0]) for fill in fills):
        note(tripatch.Message("creases_not_stored"))
    told = words.gathered([_said(*hole) for hole in holes])
    for warning in told[:MAX_TOLD]:
        note(warning)
    if len(told) > MAX_TOLD:
        note(tripatch.Message("more_warnings", {"count": len(told) - MAX_TOLD}))
    if told and not refused and not args.quiet:
        _explain_numbers(args, told)
    unknown = sum(fill.deviation is None for fill in fills) if args.deviation else 0
    if unknown:
        note(tripatch.Message("no_error_estimates", {"unknown": unknown, "count": len(fills)}))
    _write(args, out)
    cage_rim = options.get("cage_rim", "smooth") if options.get("output") == "cage" else ""
    limit, faces = options.get("surroundings") == "limit", [face for fill in fills for face in fill.faces]
    triangles = sum(len(face) == 3 for face in faces) if options.get("output") == "quads" else 0
    reports = [fill.report for fill in fills]
    if not args.json and not args.quiet:
        rims = [(fill.vertices, fill.faces, fill.rim) for fill in fills]
        bends = [] if cage_rim or limit else creases.largest(mesh.vertices, mesh.faces, rims)
        bend = max((bend for bend in bends if bend is not None), default=float("inf"))
        _tell_joined(args, found)
        print(words.filled(reports, cage_rim=cage_rim, quads=len(faces), triangles=triangles, limit=limit, bend=bend))
        if left:
            print(_left_open(args, left))
    folded = [min(fill.rim) for fill in fills if fill.report.triangles_folded > fill.report.rim_folded]
    if folded:
        note(tripatch.Message("fills_fold", {"count": len(folded)}, folded))
    flawed = any(report.is_flawed for report in reports)
    through = [(min(fill.rim), fill.passes_through) for fill in fills if fill.passes_through]
    for vertex, where in through[:MAX_TOLD]:
        note(tripatch.Message("fill_passes_through", {"place": words.place(where)}, [vertex]))
    return FILLED if len(fills) == len(holes) and not flawed and not through else SOME


def _smooth(args: argparse.Namespace) -> int:
    args.out = arguments.out_of(args)
    files.check_output(args.out)
    mesh = files.read_faces(args.input)
    smooth = tripatch.smooth_triangles(mesh.vertices, mesh.faces, resolution=args.resolution, curve=args.curve)
    files.write(args.out, smooth)
    if not args.quiet:
        print(tripatch.Message("faces_smoothed", {"count": len(mesh.faces), "triangles": len(smooth.faces)}))
    return FILLED


def _strip(args: argparse.Namespace) -> int:
    args.out = arguments.out_of(args)
    mesh, report = files.read(args.input), files.read_report(args.report) if args.report else None
    try:
        data = evidence.undone(args.input.read_bytes(), report) if args.report else mesh.stripped()
    except (files.FileError, OSError, ValueError) as error:
        _say(f"{args.input}: {tripatch.Message('not_stripped', {'reason': str(error)})}")
        return NOTHING
    files.write_over(args.out, lambda part: part.write_bytes(data))
    if not args.quiet:
        left = len(mesh.faces) - len(files.read(args.out).faces)
        print(f"{args.out}: {tripatch.Message('fills_removed', {'count': left})}")
    return FILLED


def _methods() -> int:
    for name, method in tripatch.METHODS.items():
        least, most = method.sides
        said: dict[str, Any] = {"continuity": method.continuity}
        said |= {"any": 1} if most is None else {"sides": least} if least == most else {"least": least, "most": most}
        said |= {} if method.fills_holes else {"blends": 1}
        said |= {"options": list(method.options)} if method.options else {}
        print(f"{name}\n    {method.description}\n    {tripatch.Message('method_listed', said)}\n    {method.citation}")
    return FILLED


def _run(args: argparse.Namespace) -> int:
    if args.command == "methods":
        return _methods()
    if args.command == "batch":
        return batch.run(args)
    if args.command == "view":
        return view.run(args)
    if args.command == "strip":
        return _strip(args)
    return _smooth(args) if args.command == "smooth" else _fill(args)


def main(argv: list[str] | None = None) -> int:
    """Runs the command line and returns the exit status."""
    args = argparse.Namespace(written={})
    try:
        parser().parse_args(argv, args)
        status = _run(args)
        sys.stdout.flush()  # while it can be said that this fails
        return status
    except SystemExit as end:  # --help, --version, bad usage: already said
        return int(end.code or 0)
    except tripatch.Refusal as refusal:  # of what is asked for, not of a hole
        _refused(refusal)
        return NOTHING
    except (ValueError, TypeError) as error:  # a FileError, or an option that `fill` does not take
        _say(because(error))
        return USAGE
    except OSError as error:
        _say(tripatch.Message("output_not_written", {"reason": str(error.strerror or error)}))
        with contextlib.suppress(OSError, ValueError):  # what is left of it shall not fail again at the end
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return USAGE
    except MemoryError:
        _say(tripatch.Message("out_of_memory"))
        return USAGE
    except KeyboardInterrupt:
        _say(tripatch.Message("interrupted", args.written))
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
