# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh from three surfaces over one hole, blended by the formulas of Szilvasi-Nagy and Szabo."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import bpy

from . import between_patches
from .library import constituents, np, tripatch


@dataclass
class Blended:
    """What a blend was made from."""

    names: list[str]  # of the objects, in the order of sides
    gap: float  # the largest between ends that meet
    edges: int  # along the side of a surface that has the most
    shape: list[float]  # lambda by side
    middles: list  # (3, 3) of the sides
    report: tripatch.Report
    notes: list[str]


def mesh_of(objects, tolerance, resolution, method, shape, mesh=None):
    """A mesh that blends three objects over the hole between their edges, and its `Blended`; UnusableError or ValueError if there
    is none. shape: lambda by side, or "optimal"; mesh: gets the blend instead of a new one."""
    loop, made = constituents.of_loop(tripatch.between.find_loop(between_patches.curves_of(objects), tolerance, whole=True))
    exact = [isinstance(curve, tripatch.between.SurfaceEdge) for curve in loop.curves]
    drawn = [resolution if resolution and known else t for known, (_, t) in zip(exact, made, strict=True)]
    surfaces = [surface for surface, _ in made]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        patch = tripatch.blend(*surfaces, method=method, shape=shape if isinstance(shape, str) else tuple(shape))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the same triangles whatever the weights, so that only vertices move
        barycentric, faces = tripatch.blend(*surfaces, method=method).triangles(drawn)
    mesh = mesh or bpy.data.meshes.new("Blend")
    between_patches.put(mesh, patch.evaluate(barycentric), faces, objects[0].data)
    return mesh, Blended(
        names=[curve.name for curve in loop.curves],
        gap=max(loop.gaps),
        edges=max((resolution or len(t) - 1 for known, (_, t) in zip(exact, made, strict=True) if known), default=0),
        shape=list(patch.shape),  # pyright: ignore[reportAttributeAccessIssue]
        middles=patch.evaluate((1 - np.eye(3)) / 2).tolist(),
        report=patch.report,
        notes=[each.message.args[0] for each in told if isinstance(each.message, Warning)],
    )
