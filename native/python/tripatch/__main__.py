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
from tripatch import arguments, files, view, words
from tripatch.batch import command as batch
from tripatch.batch.record import plain

FILLED, NOTHING, USAGE, SOME = 0, 1, 2, 3
INTERRUPTED = 130  # what shells say of SIGINT
MOST_TOLD = 20  # refusals: more run off the screen; of a mesh whose faces are not joined there is one for each face

_DESCRIPTION = """\
Fills a hole of the mesh in IN and writes the mesh with the fill to OUT; with --all every hole.
OBJ, OFF, PLY and STL files keep everything that is in them; VTK and other files go through meshio. Vertices are counted
from 0, in the order of the file (STL: of their first use)."""
_EXIT = """\
exit status: 0 all filled, or nothing to fill (OUT is a copy); 3 some were refused or fold more than their rims do (OUT is
written); 1 nothing was filled (the reason on stderr, OUT is not written); 2 bad usage, unreadable input or output that cannot be
written; 130 interrupted"""

#: The options of `tripatch.fill`; but the faces of a file stay.
OPTIONS = {name: option for name, option in tripatch.OPTIONS.items() if name != "replaced"}


def parser() -> argparse.ArgumentParser:
    """The parser of the command line."""
    main = argparse.ArgumentParser(
        prog="tripatch", description="Fills holes in meshes with surfaces that continue their surroundings."
    )
    main.add_argument("--version", action="version", version=f"tripatch {tripatch.__version__}")
    commands = main.add_subparsers(dest="command", required=True, metavar="COMMAND")
    fill = commands.add_parser(
        "fill",
        help="fill holes of a mesh file",
        description=_DESCRIPTION,
        epilog=_EXIT,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    fill.add_argument("input", metavar="IN", type=Path, help="mesh file")
    fill.add_argument("out", metavar="OUT", type=Path, help="mesh file to write; may be IN")
    fill.add_argument("--all", action="store_true", help="fill every hole")
    fill.add_argument("--report", type=Path, metavar="FILE.json", help="for rims, corners, seam angles and refusals")
    fill.add_argument(
        "--deviation", action="store_true", help="write how well new vertices are known as their property, into OUT.ply only"
    )
    for option in OPTIONS.values():
        arguments.add(fill, option)
    batch.add(commands)
    smooth = commands.add_parser(
        "smooth",
        help="smooth a mesh of triangles",
        description="Every triangle becomes a curved patch that meets its neighbors smoothly; the normals at the vertices are "
        "those of the faces around. OUT holds vertices and faces only.",
    )
    smooth.add_argument("input", metavar="IN", type=Path, help="mesh file")
    smooth.add_argument("out", metavar="OUT", type=Path, help="mesh file to write; may be IN")
    smooth.add_argument("--resolution", type=int, metavar="N", default=8, help="edges that every edge is cut into (8)")
    smooth.add_argument("--curve", choices=("hermite", "smits"), default="hermite", help="over the edges (hermite)")
    view.add(commands)
    commands.add_parser("methods", help="list the constructions", description="Lists the constructions.")
    return main


def _say(text: str) -> None:
    print(f"tripatch: {text}", file=sys.stderr)


def _progress(done: int, total: int) -> None:
    """A line that is written over, where somebody looks on."""
    if total > 1 and sys.stderr.isatty():
        print(f"\rtripatch: {done} of {total} holes", end="\n" if done == total else "", file=sys.stderr, flush=True)


def _refused(refusal: tripatch.Refusal, rim: Sequence[int] | None = None) -> None:
    hole = "" if rim is None else f"Hole through vertex {min(rim)}: "
    _say(hole + words.refused(refusal))


def _said(rim: Sequence[int] | None, result: Any) -> tuple[int, list[str]]:
    """A vertex of a hole, and what its fill says."""
    if isinstance(result, tripatch.Refusal):
        return (0 if rim is None else min(rim)), []
    return int(min(result.rim)), result.report.warnings


def _write_report(path: Path, holes: list[Any], left: Sequence[Any]) -> None:
    entries = []
    for rim, result in holes:
        if isinstance(result, tripatch.Refusal):
            entries.append({"rim": rim, "refused": result.reason, "where": result.where})
        else:
            added = {"rim": result.rim, "new_vertices": len(result.vertices), "new_faces": len(result.faces)}
            if len(result.creases[0]):
                added["creases"] = result.creases[0]
            entries.append({**added, **result.report.as_dict()})
    borders = [{"code": "outer_border_left_open", "edges": len(loop), "rim": loop} for loop in left]
    text = json.dumps({"holes": plain(entries), "outer_borders": plain(borders)}, indent=2) + "\n"

    def save(part: Path) -> None:
        part.write_text(text)

    files.write_over(path, save)


def _options(args: argparse.Namespace) -> dict[str, Any]:
    """Those that were given, if they go with each other."""
    options = {name: getattr(args, name) for name in OPTIONS if hasattr(args, name)}
    for name in options:
        flag = f"--{name.replace('_', '-')}"
        if args.all and name == "corners" and len(options[name]) == 0:
            continue  # all of them are round
        if args.all and "fill_all" not in OPTIONS[name].functions:
            raise ValueError(f"--all chooses the rims and corners itself; leave out {flag}")
        if not args.all and "fill" not in OPTIONS[name].functions:
            raise ValueError(f"{flag} goes with --all")
    return options


def _left_open(args: argparse.Namespace, left: Sequence[Any]) -> str:
    return words.left_open([len(loop) for loop in left], "use --outer" if args.all else "use --all --outer")


def _write(args: argparse.Namespace, out: files.MeshFile) -> None:
    out.write(args.out)
    if args.out.suffix.lower() != args.input.suffix.lower():
        _say(f"{args.out} holds vertices and faces only; what else {args.input.suffix} files hold was left behind")


def _copied(args: argparse.Namespace, out: files.MeshFile, left: Sequence[Any]) -> int:
    """OUT is written as it is read: the mesh has no hole."""
    if args.report:
        _write_report(args.report, [], left)
    _write(args, out)
    print(f"Nothing to fill: {_left_open(args, left) or 'the mesh has no border'}")
    return FILLED


def _fill(args: argparse.Namespace) -> int:
    options = _options(args)
    choosing = {name: options.pop(name) for name in list(options) if "choose_holes" in OPTIONS[name].functions}
    if args.report and os.path.realpath(args.report) in map(os.path.realpath, (args.input, args.out)):
        raise ValueError(f"--report would write over {args.report}, which is IN or OUT; give it a file of its own")
    mesh = files.read(args.input)
    same_format = args.out.suffix.lower() == args.input.suffix.lower()
    out = mesh if same_format else files.converted(mesh, args.out.suffix)
    if args.deviation:
        out = out.with_deviation()

    holes: list[tuple[Any, ...]] = []
    named = bool(options.keys() & {"rim", "corners"}) and not args.all
    borders = [] if named else tripatch.find_holes(mesh.faces)
    left = tripatch.outer_borders(mesh.vertices, mesh.faces) if borders and not choosing.get("outer") else []
    if not named and len(left) == len(borders):
        return _copied(args, out, left)
    if args.all:
        rims = tripatch.choose_holes(mesh.vertices, mesh.faces, **choosing)
        results = tripatch.fill_all(mesh.vertices, mesh.faces, rims, progress=_progress, **options)
        holes = list(zip(rims, results, strict=True))
        if not holes:
            _say("Nothing to fill: no hole is as it was asked for")
    else:
        try:
            holes = [(options.get("rim"), tripatch.fill(mesh.vertices, mesh.faces, **options))]
        except tripatch.Refusal as refusal:
            holes = [(options.get("rim"), refusal)]
    refused = [(rim, result) for rim, result in holes if isinstance(result, tripatch.Refusal)]
    for rim, result in refused[:MOST_TOLD]:
        _refused(result, rim if args.all else None)
    if len(refused) > MOST_TOLD:
        more = len(refused) - MOST_TOLD
        _say(f"{more} more {'hole was' if more == 1 else 'holes were'} refused; --report FILE.json names each")
    if args.report:
        _write_report(args.report, holes, left)

    fills: list[tripatch.Fill] = [result for _, result in holes if not isinstance(result, tripatch.Refusal)]
    if not fills:
        return NOTHING
    if any(len(fill.creases[0]) for fill in fills):
        _say("Exact cages want their rims creased, which no file holds: crease them where the cage is subdivided (see --report)")
    for fill in fills:
        out.append(fill)
    told = words.gathered([_said(*hole) for hole in holes])
    for warning in told[:MOST_TOLD]:
        _say(warning)
    if len(told) > MOST_TOLD:
        _say(f"{len(told) - MOST_TOLD} more warnings; --report FILE.json has each")
    unknown = sum(fill.deviation is None for fill in fills) if args.deviation else 0
    if unknown:
        _say(f"How well it is known cannot be told of {unknown} of {len(fills)} fills, the deviation there is -1")
    _write(args, out)
    cage_rim = options.get("cage_rim", "smooth") if options.get("output") == "cage" else ""
    limit, faces = options.get("surroundings") == "limit", [face for fill in fills for face in fill.faces]
    triangles = sum(len(face) == 3 for face in faces) if options.get("output") == "quads" else 0
    reports = [fill.report for fill in fills]
    print(words.filled(reports, cage_rim=cage_rim, quads=len(faces), triangles=triangles, limit=limit))
    if left:
        print(_left_open(args, left))
    folded = sum(fill.report.triangles_folded > fill.report.rim_folded for fill in fills)
    if folded:
        _say(f"{folded} of the fills {'folds' if folded == 1 else 'fold'} over {'itself' if folded == 1 else 'themselves'}")
    crossed = sum(fill.report.crosses_itself for fill in fills)  # its warning says where
    return FILLED if len(fills) == len(holes) and not folded and not crossed else SOME


def _smooth(args: argparse.Namespace) -> int:
    mesh = files.read(args.input)
    smooth = tripatch.smooth_triangles(mesh.vertices, mesh.faces, resolution=args.resolution, curve=args.curve)
    files.converted(files.MeshFile(smooth.vertices, smooth.faces.tolist()), args.out.suffix).write(args.out)
    print(f"Smoothed {len(mesh.faces)} triangles into {len(smooth.faces)}")
    return FILLED


def _methods() -> int:
    for name, method in tripatch.METHODS.items():
        least, most = method.sides
        sides = "any rim" if most is None else f"{least} sides" if least == most else f"{least} to {most} sides"
        fills = "" if method.fills_holes else "; blends surfaces, does not fill holes"
        options = f"; options: {', '.join(method.options)}" if method.options else ""
        print(f"{name}\n    {method.description}\n    {method.continuity}, {sides}{fills}{options}\n    {method.citation}")
    return FILLED


def _run(argv: list[str] | None) -> int:
    try:
        args = parser().parse_args(argv)
    except SystemExit as end:  # --help, --version, bad usage: already said
        return int(end.code or 0)
    if args.command == "methods":
        return _methods()
    if args.command == "batch":
        return batch.run(args)
    if args.command == "view":
        return view.run(args)
    return _smooth(args) if args.command == "smooth" else _fill(args)


def main(argv: list[str] | None = None) -> int:
    """Runs the command line and returns the exit status."""
    try:
        status = _run(argv)
        sys.stdout.flush()  # while it can be said that this fails
        return status
    except tripatch.Refusal as refusal:  # of what is asked for, not of a hole
        _refused(refusal)
        return NOTHING
    except (ValueError, TypeError) as error:  # a FileError, or an option that `fill` does not take
        _say(str(error))
        return USAGE
    except OSError as error:
        _say(f"The output cannot be written: {error.strerror or error}")
        with contextlib.suppress(OSError, ValueError):  # what is left of it shall not fail again at the end
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return USAGE
    except MemoryError:
        _say("There is not enough memory for this; a smaller --resolution needs less")
        return USAGE
    except KeyboardInterrupt:
        _say("Interrupted; nothing is half written")
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
