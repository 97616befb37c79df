# SPDX-License-Identifier: GPL-3.0-or-later
"""Filling holes without a window: scripts/fill_holes.py, and `blender --command tripatch` from Blender 4.2 on."""

from __future__ import annotations

import argparse
import json
import os
import sys

import bmesh
import bpy

from . import beside, filling, layers, library, selection, subdivision

EXIT_ALL, EXIT_NONE, EXIT_USAGE, EXIT_SOME = 0, 1, 2, 3

_EPILOG = "Exit status: 0 all filled; 3 some were refused, OUT is written; 1 nothing filled, OUT is not written; 2 bad usage."


_ADVICE = "name one by --rim or --corners, or fill them by --all"


def _indices(text):
    return [int(part) for part in text.split(",")]


def _three(text):
    corners = _indices(text)
    if len(corners) != 3:
        raise argparse.ArgumentTypeError("three vertex indices are needed")
    return corners


def _by_side(kind):
    """One value or three."""

    def read(text):
        values = tuple(kind(part) for part in text.split(","))
        return values[0] if len(values) == 1 else values

    read.__name__ = f"{kind.__name__} or three"
    return read


def _shape(text):
    if text == "optimal":
        return text
    try:
        return _by_side(float)(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is neither numbers nor optimal") from None


def _parser(prog):
    methods = ["auto"] + [name for name, method in library.tripatch.METHODS.items() if method.fills_holes]
    parser = argparse.ArgumentParser(prog=prog, description="Fills three-sided holes in the meshes of a .blend.", epilog=_EPILOG)
    parser.add_argument("file", nargs="?", help=".blend to be opened first (default: the one that Blender has open)")
    parser.add_argument("--out", required=True, help=".blend to be written")
    parser.add_argument("--object", action="append", default=[], metavar="NAME", help="may be repeated (default: every mesh)")
    parser.add_argument("--all", action="store_true", help="fill every hole with three corners, not only a mesh's only one")
    parser.add_argument(
        "--outer",
        action="store_true",
        help="with --all: also the outer borders of open meshes, which count only where there is no hole",
    )
    parser.add_argument("--rim", type=_indices, metavar="V,V,...", help="vertex indices along the rim (one object)")
    parser.add_argument("--corners", type=_three, metavar="A,B,C", help="vertex indices of the three corners (one object)")
    parser.add_argument("--method", choices=methods, default="side_vertex")
    parser.add_argument("--output", choices=["triangles", "quads", "cage"], help="default: cage with a Subdivision modifier")
    parser.add_argument(
        "--resolution",
        type=int,
        help="edges per side inside (default: as the rim); quads, cage: extra rows (default: the fewest within TOLERANCE)",
    )
    parser.add_argument("--tolerance", type=float, help="quads, cage: largest distance from the patch in scene units")
    parser.add_argument("--cage-rim", choices=["smooth", "exact", "move"], default="smooth")
    parser.add_argument("--odd", choices=["split", "triangle"], default="split", help="quads, cage: round an odd rim")
    parser.add_argument("--pole-offset", type=float, nargs=2, default=(0.0, 0.0), metavar=("U", "V"))
    parser.add_argument("--add-modifier", action="store_true", help="cage: give the object a Subdivision modifier if it has none")
    parser.add_argument("--continuity", type=_by_side(str), default="auto", metavar="C[,C,C]", help="auto, Free, G0, G1 or G2")
    parser.add_argument(
        "--fairing",
        choices=["auto", "none", "thin_plate", "third_derivative", "minimum_variation", "quadric_variation"],
        default="auto",
    )
    parser.add_argument(
        "--surroundings", choices=["mesh", "limit"], default="mesh", help="limit: as the modifier draws them, the fill beside"
    )
    parser.add_argument("--bulge", type=_by_side(float), default=1.0, metavar="B[,B,B]", help="scales the slopes of the sides")
    parser.add_argument("--tension", type=float, default=0.0, help="pulls the fill tight")
    parser.add_argument("--center-offset", type=float, default=0.0, help="moves the middle of the fill along its normal")
    parser.add_argument("--cross-boundary", choices=["given", "consistent", "as_printed"], default="consistent")
    parser.add_argument("--shape", type=_shape, default=0.5, metavar="L[,L,L]", help="lambda, from 0 to 1, by side; or optimal")
    parser.add_argument("--reading", choices=["corrected", "as_printed"], default="corrected")
    parser.add_argument("--symmetric", action="store_true", help="coons_extremal: favour no corner")
    parser.add_argument("--alpha", type=float, help="coons_bezier: the permanence patch with this alpha")
    parser.add_argument("--corner-offset", type=int, default=0, help="slide the corners along the rim by so many vertices")
    parser.add_argument("--shading", choices=["neighbors", "smooth", "flat"], default="neighbors")
    parser.add_argument("--report", metavar="FILE.json")
    return parser


def _objects(names):
    """The mesh objects to work on, one for each mesh."""
    if names:
        for name in names:
            ob = bpy.context.scene.objects.get(name)
            if ob is None or ob.type != "MESH":
                raise _UsageError(f"there is no mesh object '{name}' in the scene '{bpy.context.scene.name}'")
        objects = [bpy.context.scene.objects[name] for name in names]
    else:
        objects = [ob for ob in bpy.context.scene.objects if ob.type == "MESH"]
    first = {}
    for ob in objects:
        first.setdefault(ob.data, ob)
    return list(first.values())


class _UsageError(Exception):
    """A mistake in the command, not in a mesh."""


def _vertices(bm, numbers, option):
    for number in numbers:
        if not 0 <= number < len(bm.verts):
            raise _UsageError(f"--{option} names vertex {number}; the mesh has {len(bm.verts)} vertices")
    return [bm.verts[number] for number in numbers]


def _rims(bm, matrix, arguments):
    """The rims that the arguments mean in one mesh."""
    bm.verts.ensure_lookup_table()
    corners = _vertices(bm, arguments.corners or [], "corners")
    if arguments.rim:
        return [selection.Rim(_vertices(bm, arguments.rim, "rim"), corners=corners)]
    if corners:
        loops = selection.border_loops(v for v in corners if v.is_boundary)
        around = [loop for loop in loops if set(corners) <= set(loop)]
        if len(around) != 1:
            raise selection.UnusableError("The three corners do not lie on one border of the mesh")
        return [selection.Rim(around[0], corners=corners)]
    if arguments.all:
        return selection.all_rims(bm) if arguments.outer else filling.holes(bm, matrix)
    any_rim = arguments.method in ("auto", "polyharmonic_spline") and arguments.output != "cage"
    any_rim = any_rim and arguments.surroundings != "limit"
    if arguments.object:
        return filling.open_holes(bm, matrix, any_rim, _ADVICE)
    if any_rim:
        return filling.holes(bm, matrix)
    found, _ = filling.three_sided(bm, matrix, filling.holes(bm, matrix))
    if len(found) > 1:
        raise filling.a_choice(found, _ADVICE)
    return found


_OF_FILL = (
    *("method", "continuity", "surroundings", "bulge", "resolution", "tolerance", "cage_rim", "odd", "pole_offset"),
    *("tension", "center_offset", "cross_boundary", "shape", "reading", "symmetric", "alpha"),
)


def _options(ob, arguments):
    settings = {name: getattr(arguments, name) for name in _OF_FILL}
    settings["fairing"] = None if arguments.fairing == "none" else arguments.fairing
    caged = arguments.surroundings == "mesh" and subdivision.modifier_of(ob)
    settings["output"] = arguments.output or ("cage" if caged else "triangles")
    return filling.Options(settings, arguments.corner_offset, arguments.shading)


def _fill(ob, arguments, options):
    """The Outcome for one object."""
    mesh = ob.data
    if ob.library or mesh.library or mesh.override_library:
        raise selection.UnusableError(f"The mesh '{mesh.name}' is linked from another file; make it local first")
    matrix = filling.world_matrix(ob.name, ob.matrix_world)
    with layers.mesh_without_matrices(mesh):
        return _fill_mesh(ob, matrix, arguments, options)


def _fill_mesh(ob, matrix, arguments, options):
    mesh, bm = ob.data, bmesh.new()
    try:
        bm.from_mesh(mesh)
        rims = _rims(bm, matrix, arguments)
        if options.arguments["surroundings"] == "limit":
            return beside.fill_rims(ob, bm, matrix, rims, options)[0]
        keys = mesh.shape_keys
        cage = options.arguments["output"] == "cage"
        modifier = subdivision.usable(ob) if cage else None
        active = keys.reference_key.name if keys else None
        outcome, new_faces = filling.fill_rims(bm, mesh, matrix, rims, options, active, modifier)
        if new_faces:
            bm.to_mesh(mesh)
            mesh.update()
            if cage and modifier is None and arguments.add_modifier:
                subdivision.add_modifier(ob)
        return outcome
    finally:
        bm.free()


def _run(arguments):
    if arguments.file:
        try:
            bpy.ops.wm.open_mainfile(filepath=os.path.abspath(arguments.file))
        except RuntimeError as error:
            raise _UsageError(str(error).strip()) from None
    if not bpy.data.filepath:
        raise _UsageError("no .blend is open")
    if not os.path.isdir(os.path.dirname(os.path.abspath(arguments.out))):
        raise _UsageError(f"the folder of '{arguments.out}' does not exist")
    objects = _objects(arguments.object)
    if (arguments.rim or arguments.corners) and len(objects) != 1:
        raise _UsageError("--rim and --corners need one --object")
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")

    total, reports = filling.Outcome(), []
    for ob in objects:
        try:
            outcome = _fill(ob, arguments, _options(ob, arguments))
        except selection.UnusableError as reason:
            if str(reason) == "The mesh has no hole" and not arguments.object:
                continue
            outcome = filling.Outcome(refused=[str(reason)])
        if outcome.reports:
            print(f"{ob.name}: {outcome.sentence()}")
        for sentence in outcome.notes:
            print(f"{ob.name}: {sentence}")
        for sentence in outcome.refused:
            print(f"{ob.name}: {sentence}", file=sys.stderr)
        holes = [report.as_dict() for report in outcome.reports]
        reports.append({"object": ob.name, "filled": holes, "refused": outcome.refused})
        total.add(outcome, ob.name)
    if arguments.report:
        with open(arguments.report, "w", encoding="utf-8") as file:
            json.dump(reports, file, indent=1)
    if not total.reports:
        if not total.refused:
            print("Nothing to fill: no mesh has a three-sided hole", file=sys.stderr)
        return EXIT_NONE
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(arguments.out), copy=True)
    return EXIT_SOME if total.refused else EXIT_ALL


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
    if hasattr(bpy.utils, "register_cli_command"):
        _command = bpy.utils.register_cli_command("tripatch", main)


def unregister():
    global _command
    if _command is not None:
        bpy.utils.unregister_cli_command(_command)
        _command = None
