# SPDX-License-Identifier: GPL-3.0-or-later
"""mesh.fill_three_sided"""

from __future__ import annotations

import bmesh
import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty

from . import filling, library, selection


def _method_items():
    if library.missing:
        return [("side_vertex", "Side Vertex", "")]
    return [
        (name, name.replace("_", " ").title(), f"{method.description} ({method.citation})")
        for name, method in library.tripatch.METHODS.items()
        if method.fills_holes
    ]


class MESH_OT_fill_three_sided(bpy.types.Operator):
    """Fill selected three-sided holes so that the surface continues smoothly"""

    bl_idname = "mesh.fill_three_sided"
    bl_label = "Fill Three-Sided Hole"
    bl_options = {"REGISTER", "UNDO"}

    output: EnumProperty(
        name="Output",
        description="What the hole is filled with",
        items=[("triangles", "Triangles", "Triangles with their vertices on the patch")],
        default="triangles",
    )
    resolution: IntProperty(
        name="Resolution",
        description="Edges per side inside the fill, 0 to follow the rim",
        min=0,
        max=10000,
        soft_max=128,
        default=0,
    )
    continuity: EnumProperty(
        name="Continuity",
        description="How the fill meets the surrounding faces",
        items=[
            ("auto", "Auto", "The best that the method keeps"),
            ("G0", "Position", "Meets the rim (G0)"),
            ("G1", "Tangent", "Continues the surrounding tangent planes (G1)"),
        ],
        default="auto",
    )
    method: EnumProperty(name="Method", description="Construction of the patch", items=_method_items(), default="side_vertex")
    bulge: FloatProperty(
        name="Bulge",
        description="Scale of the slopes with which the fill leaves its sides; the corners are kept",
        min=0.01,
        soft_max=4.0,
        max=100.0,
        default=1.0,
    )
    corner_offset: IntProperty(
        name="Corner Offset",
        description="Slide the three corners along the rim by this many vertices",
        default=0,
        options={"SKIP_SAVE"},
    )
    shading: EnumProperty(
        name="Shading",
        description="Shading of the new faces",
        items=[
            ("neighbors", "Neighbors", "As the faces at the nearest side"),
            ("smooth", "Smooth", "Smooth"),
            ("flat", "Flat", "Flat"),
        ],
        default="neighbors",
    )
    surroundings: EnumProperty(
        name="Surroundings",
        description="Where the tangent planes along the rim come from",
        items=[("mesh", "Mesh", "Estimated from the faces around the hole")],
        default="mesh",
    )

    @classmethod
    def poll(cls, context):
        if library.missing:
            cls.poll_message_set(library.missing)
            return False
        if context.mode != "EDIT_MESH":
            cls.poll_message_set("Works on a mesh in edit mode")
            return False
        return True

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "output")
        layout.prop(self, "resolution")
        tangent = self._keeps_tangents()
        row = layout.row()
        row.active = tangent
        row.prop(self, "continuity")
        layout.prop(self, "method")
        row = layout.row()
        row.active = tangent and self.continuity != "G0"
        row.prop(self, "bulge")
        layout.prop(self, "corner_offset")
        layout.prop(self, "shading")

    def _keeps_tangents(self):
        return library.tripatch.METHODS[self.method].continuity != "G0"

    def _options(self):
        names = ("output", "continuity", "method", "bulge", "surroundings")
        arguments = {name: getattr(self, name) for name in names}
        if not self._keeps_tangents():
            arguments["continuity"] = "auto"  # the row is greyed out
        return filling.Options(dict(arguments, resolution=self.resolution or None), self.corner_offset, self.shading)

    def execute(self, context):
        objects = context.objects_in_mode_unique_data
        selected = [ob for ob in objects if ob.data.total_vert_sel]
        outcome, unusable = filling.Outcome(), []
        for ob in selected or objects:
            prefix = f"{ob.name}: " if len(objects) > 1 else ""
            try:
                outcome.add(self._fill(ob), prefix[:-2])
            except selection.UnusableError as reason:
                unusable.append(prefix + str(reason))
        refused = outcome.refused + (unusable if selected or not outcome.reports else [])
        if not outcome.reports:
            several = f" (and {len(refused) - 1} more)" if len(refused) > 1 else ""
            self.report({"WARNING" if outcome.refused else "ERROR"}, refused[0] + several)
            return {"CANCELLED"}
        message = outcome.sentence()
        if refused:
            message += f"; {len(refused)} not filled: {'; '.join(refused[:3])}{'; ...' if len(refused) > 3 else ''}"
        if outcome.notes:
            message += f". {'. '.join(outcome.notes[:2])}"
        self.report({"WARNING" if refused or outcome.notes else "INFO"}, message)
        return {"FINISHED"}

    def _fill(self, ob):
        mesh = ob.data
        bm = bmesh.from_edit_mesh(mesh)
        bm.verts.index_update()
        bm.faces.index_update()
        matrix = filling.world_matrix(ob.name, ob.matrix_world)
        selected, refused = selection.Selected(bm), []
        if selected.vertices:
            rims, refused = selection.selected_rims(bm, selected)
        else:
            rims = filling.only_hole(bm, matrix)
        active = ob.active_shape_key
        outcome, new_faces = filling.fill_rims(bm, mesh, matrix, rims, self._options(), active.name if active else None)
        outcome.refused += refused
        if new_faces:
            selected.replace(bm, new_faces)
            bmesh.update_edit_mesh(mesh)
        return outcome


def register():
    bpy.utils.register_class(MESH_OT_fill_three_sided)


def unregister():
    bpy.utils.unregister_class(MESH_OT_fill_three_sided)
