# SPDX-License-Identifier: GPL-3.0-or-later
"""Fills holes so that the surface continues smoothly."""

bl_info = {
    "name": "TriPatch",
    "author": "TriPatch contributors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Edit Mode > Face > Fill Holes Smoothly",
    "description": "Fill holes so that the surface continues smoothly",
    "doc_url": "https://tripatch.example/guide.html",
    "tracker_url": "https://tripatch.example/issues",
    "category": "Mesh",
}

from . import (  # noqa: E402
    between_patches,
    blending,
    command_line,
    library,
    live_fills,
    operators,
    overlay,
    smooth,
    smooth_fill_node,
    tool,
    ui,
    waiting,
)

_modules = (waiting, operators, between_patches, blending, smooth, ui, overlay, live_fills, smooth_fill_node, tool, command_line)


def register():
    if hasattr(library, "vendored"):
        library.vendored.remember()  # switched off and on again
    if library.missing:
        print(library.missing)
    for module in _modules:
        module.register()


def unregister():
    for module in reversed(_modules):
        module.unregister()
    if hasattr(library, "vendored"):
        library.vendored.forget()
