# SPDX-License-Identifier: GPL-3.0-or-later
"""Where to read and ask. scripts/package puts the homepage of pyproject.toml in place of the website."""

WEBSITE = "https://tripatch.example"
GUIDE = f"{WEBSITE}/guide.html"
BUGS = f"{WEBSITE}/issues"

#: Pages on operators, by patterns of their names.
_PAGES = (
    ("bpy.ops.mesh.fill_smooth*", "guide.html"),
    ("bpy.ops.mesh.fill_three_sided*", "guide.html"),
    ("bpy.ops.mesh.edit_fill*", "guide.html"),
    ("bpy.ops.mesh.smooth_triangles*", "guide.html"),
    ("bpy.ops.mesh.shape_fill*", "shaping-and-live-fills.html"),
    ("bpy.ops.object.*_live_fill*", "shaping-and-live-fills.html"),
    ("bpy.types.TriPatchSmoothFillNode*", "shaping-and-live-fills.html"),
    ("bpy.ops.object.fill_between_patches*", "guide.html"),
    ("bpy.ops.object.blend_three_patches*", "shaping-and-live-fills.html"),
)


def manual_map():
    """For Online Manual in the context menu of buttons."""
    return f"{WEBSITE}/", _PAGES
