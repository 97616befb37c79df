# SPDX-License-Identifier: GPL-3.0-or-later
"""Filling holes without a window: scripts/fill_holes.py, and `blender --command tripatch` from Blender 4.2 on."""

from __future__ import annotations

import json
import os
import sys

import bmesh
import bpy

from . import (
    calls,
    filling,
    layers,
    library,
    limit_objects,
    mirrored,
    outcomes,
    records,
    selection,
    subdivision,
    versions,
    writeback,
)
from .library import arguments as by_table
from .library import tripatch
from .properties import OPTIONS

EXIT_ALL, EXIT_NONE, EXIT_USAGE, EXIT_SOME = 0, 1, 2, 3

#: The options of the library's table; the modifier and the mesh say the others.
_OPTIONS = {name: option for name, option in OPTIONS.items() if name not in ("subdivision", "level", "replaced")}
#: Why an object of several has nothing that is meant.
_NONE_MEANT = ("holes_hidden", "all_boundaries_hidden", "holes_filtered")
_METHOD = "auto"  # unless another is asked for, as in the operator and in the library


def _parser(prog):
    shown, text = by_table.flag_help, tripatch.messages.text
    parser = by_table.Parser(prog=prog, description=text("about_blender"), epilog=text("exit_blender"))
    parser.add_argument("file", nargs="?", **shown("blend_file_in"))
    parser.add_argument("--out", required=True, **shown("blend_file_out"))
    parser.add_argument("--object", action="append", default=[], **shown("object_flag"))
    parser.add_argument("--all", action="store_true", help=text("all_in_blender_flag"))
    parser.add_argument("--add-modifier", action="store_true", help=text("add_modifier"))
    for option in _OPTIONS.values():
        by_table.add(parser, option)
    parser.add_argument("--corner-offset", type=int, default=0, help=text("slide_corners"))
    parser.add_argument("--shading", choices=["neighbors", "smooth", "flat"], default="neighbors", help=text("shading"))
    parser.add_argument("--deviation", action="store_true", help=text("deviation"))
    parser.add_argument("--report", **shown("report_flag"))
    return parser


def _objects(names):
    """The mesh objects to work on, one for each mesh."""
    if names:
        for name in names:
            ob = bpy.context.scene.objects.get(name)
            if ob is None or ob.type != "MESH":
                raise _UsageError("no_such_object", name=name, scene=bpy.context.scene.name)
        objects = [bpy.context.scene.objects[name] for name in names]
    else:
        objects = [ob for ob in bpy.context.scene.objects if ob.type == "MESH"]
    first = {}
    for ob in objects:
        first.setdefault(ob.data, ob)
    return list(first.values())


class _UsageError(Exception):
    """A mistake in the command, not in a mesh."""

    def __init__(self, code, **parameters):
        super().__init__(tripatch.Message(code, parameters))


def _vertices(bm, numbers, option):
    for number in numbers:
        if not 0 <= number < len(bm.verts):
            raise _UsageError("no_such_vertex", option=f"--{option}", vertex=number, count=len(bm.verts))
    return [bm.verts[number] for number in numbers]


def _given(arguments, function):
    """The options of a function of the library that were given."""
    return {
        name: getattr(arguments, name) for name in _OPTIONS if hasattr(arguments, name) and function in _OPTIONS[name].functions
    }


def _chosen(bm, matrix, arguments):
    """The visible border loops that the library chooses, and the outer borders that it leaves open."""
    bm.verts.index_update()
    bm.faces.index_update()
    mesh, chosen = filling.mesh_arrays(bm, matrix), _given(arguments, "choose_holes")
    try:
        loops = tripatch.choose_holes(*mesh, **chosen)
    except tripatch.Refusal as refusal:
        raise selection.UnusableError.of(refusal.said) from None
    outer = [] if chosen.get("outer") else tripatch.outer_borders(*mesh)
    found = [{frozenset(loop.tolist()) for loop in each} for each in (loops, outer)]
    every = selection.all_rims(bm)
    rims, left = ([rim for rim in every if frozenset(v.index for v in rim.loop) in each] for each in found)
    if not rims and len(left) < len(every):
        raise selection.UnusableError("holes_filtered", count=len(every) - len(left))
    return rims, left


def _rims(bm, matrix, arguments):
    """The rims that the arguments mean in one mesh, round where they are to have no corners, and the outer borders left open."""
    rims, left = _rims_meant(bm, matrix, arguments)
    for rim in rims:
        rim.round = hasattr(arguments, "corners") and not arguments.corners
    return rims, left


def _rims_meant(bm, matrix, arguments):
    bm.verts.ensure_lookup_table()
    corners = _vertices(bm, getattr(arguments, "corners", []), "corners")
    if rim := getattr(arguments, "rim", []):
        return [selection.Rim(_vertices(bm, rim, "rim"), corners=corners)], []
    if corners:
        loops = selection.border_loops(v for v in corners if v.is_boundary)
        around = [loop for loop in loops if set(corners) <= set(loop)]
        if len(around) != 1:
            raise selection.UnusableError("corners_not_on_one_border")
        return [selection.Rim(around[0], corners=corners)], []
    return _chosen(bm, matrix, arguments) if arguments.all else filling.open_holes(bm, matrix)


def _options(ob, arguments):
    settings = {name: value for name, value in _given(arguments, "fill_all").items() if "fill" in _OPTIONS[name].functions}
    settings.setdefault("method", _METHOD)
    settings.setdefault("surroundings", _OPTIONS["surroundings"].default)
    caged = settings["surroundings"] == "mesh" and subdivision.modifier_of(ob)
    settings.setdefault("output", "cage" if caged else "triangles")
    tripatch.options.checked("fill_all", settings)
    return calls.Options(
        settings,
        arguments.corner_offset,
        arguments.shading,
        arguments.deviation,
        record=records.of_arguments(settings | {"corner_offset": arguments.corner_offset, "shading": arguments.shading}),
    )


def _fill(ob, arguments, options):
    """The Outcome for one object."""
    mesh = ob.data
    if ob.library or mesh.library or mesh.override_library:
        raise selection.UnusableError("mesh_linked", name=mesh.name)
    matrix = filling.world_matrix(ob.name, ob.matrix_world)
    with layers.mesh_standing_aside(mesh):
        return _fill_mesh(ob, matrix, arguments, options)


def _fill_mesh(ob, matrix, arguments, options):
    mesh, bm = ob.data, bmesh.new()
    try:
        bm.from_mesh(mesh)
        with writeback.layers_of_fills(bm, options.deviation):
            return _fill_rims(ob, bm, matrix, arguments, options)
    finally:
        bm.free()


def _fill_rims(ob, bm, matrix, arguments, options):
    mesh = ob.data
    if options.arguments["surroundings"] == "limit":
        rims, left = _rims(bm, matrix, arguments)
        outcome = limit_objects.fill_rims(ob, bm, matrix, rims, options)[0]
        outcome.left_open = [len(rim.loop) for rim in left]
        return outcome
    keys = mesh.shape_keys
    cage = options.arguments["output"] == "cage"
    modifier = subdivision.usable(ob) if cage else None
    active = keys.reference_key.name if keys else None
    named = bool(getattr(arguments, "rim", []) or getattr(arguments, "corners", []))
    bm.verts.index_update()
    cut = [] if named else mirrored.half_rims(ob, bm, [])
    outer = getattr(arguments, "outer", False)
    halves, new_faces, _ = mirrored.fill_halves(ob, bm, matrix, cut, options, outer, active, modifier)
    try:
        found = _rims(bm, matrix, arguments)
        rims, left = ([rim for rim in each if not mirrored.is_joined(ob, rim)] for each in found)
        if named and not rims:
            raise selection.UnusableError("mirror_joins_boundary")
    except selection.UnusableError:
        if not halves.reports and not halves.refused:
            raise
        rims = left = []
    left = [len(rim.loop) for rim in left]
    if not rims and not halves.reports and not halves.refused:
        raise selection.NothingToFill(left)
    outcome, made = filling.fill_rims(bm, mesh, matrix, rims, options, active, modifier)
    outcome.add(halves)
    outcome.left_open += left
    new_faces += made
    if new_faces:
        bm.to_mesh(mesh)
        mesh.update()
        if cage and modifier is None and arguments.add_modifier:
            subdivision.add_modifier(ob)
    return outcome


def _run(arguments):
    if arguments.file:
        try:
            bpy.ops.wm.open_mainfile(filepath=os.path.abspath(arguments.file))
        except RuntimeError as error:
            raise ValueError(str(error).strip()) from None
    if not bpy.data.filepath:
        raise _UsageError("no_file_open")
    if not os.path.isdir(os.path.dirname(os.path.abspath(arguments.out))):
        raise _UsageError("folder_missing", path=os.path.dirname(os.path.abspath(arguments.out)))
    objects = _objects(arguments.object)
    if (hasattr(arguments, "rim") or getattr(arguments, "corners", [])) and len(objects) != 1:
        raise _UsageError("one_object_needed")
    if getattr(arguments, "method", _METHOD) not in library.ANY_RIM and len(getattr(arguments, "corners", (0,) * 3)) != 3:
        raise _UsageError("three_corners_named")
    for name in _given(arguments, "choose_holes"):
        if not arguments.all:
            raise _UsageError("option_needs", option=f"--{name.replace('_', '-')}", needed="--all")
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")

    total, reports, option = outcomes.Outcome(), [], "--outer" if arguments.all else "--all --outer"
    filtered = False
    for ob in objects:
        try:
            outcome = _fill(ob, arguments, _options(ob, arguments))
        except selection.NothingToFill as reason:
            total.left_open += reason.left
            continue
        except selection.UnusableError as reason:
            filtered |= reason.code == "holes_filtered"
            if reason.code in _NONE_MEANT and not arguments.object:
                continue
            outcome = outcomes.Outcome(refused=[outcomes.Refused(reason.said)])
        if outcome.reports:
            print(f"{ob.name}: {outcome.sentence(option)}")
        for sentence in outcome.notes:
            print(f"{ob.name}: {sentence}")
        refused = [each.sentence for each in outcome.refused]
        for sentence in refused:
            print(f"{ob.name}: {sentence}", file=sys.stderr)
        through = zip(outcome.reports, outcome.passages, strict=True)
        holes = [report.as_dict() | {"passes_through": place} for report, place in through]
        borders = [{"code": "outer_border_left_open", "edges": edges} for edges in outcome.left_open]
        reports.append({"object": ob.name, "filled": holes, "refused": refused, "outer_borders": borders})
        total.add(outcome, ob.name)
    if arguments.report:
        with open(arguments.report, "w", encoding="utf-8") as file:
            json.dump(reports, file, indent=1)
    if (total.refused or filtered) and not total.reports:
        return EXIT_NONE
    if not total.reports:
        print(selection.NothingToFill(total.left_open, option=option))
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(arguments.out), copy=True)
    flawed = any(total.passages) or any(report.is_flawed for report in total.reports)
    return EXIT_SOME if total.refused or flawed else EXIT_ALL


def main(argv, prog="blender --command tripatch"):
    """Runs the command line; returns the exit status."""
    if library.missing:
        print(library.missing, file=sys.stderr)
        return EXIT_NONE
    try:
        return _run(_parser(prog).parse_args(argv))
    except SystemExit as done:  # argparse: usage or help
        return done.code or EXIT_ALL
    except (_UsageError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_USAGE


_command = None


def register():
    global _command
    if versions.HAS_COMMANDS:
        _command = bpy.utils.register_cli_command("tripatch", main)


def unregister():
    global _command
    if _command is not None:
        bpy.utils.unregister_cli_command(_command)
        _command = None
