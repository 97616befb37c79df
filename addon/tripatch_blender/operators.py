# SPDX-License-Identifier: GPL-3.0-or-later
"""mesh.fill_three_sided"""

from __future__ import annotations

import bmesh
import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty

from . import beside, filling, layers, library, selection, subdivision
from .construction import Construction


class MESH_OT_fill_three_sided(Construction, bpy.types.Operator):
    """Fill selected three-sided holes so that the surface continues smoothly"""

    bl_idname = "mesh.fill_three_sided"
    bl_label = "Fill Three-Sided Hole"
    bl_options = {"REGISTER", "UNDO"}

    output: EnumProperty(
        name="Output",
        description="What the hole is filled with",
        items=[
            ("triangles", "Triangles", "Triangles with their vertices on the patch"),
            ("quads", "Quads", "Quads with their vertices on the patch"),
            ("cage", "Subdivision Cage", "A few quads whose limit surface under a Subdivision modifier is the patch"),
        ],
        default="triangles",
        options={"SKIP_SAVE"},  # decided by the modifiers where it is not given
    )
    resolution: IntProperty(
        name="Resolution",
        description="Edges per side inside the fill, 0 to follow the rim",
        min=0,
        max=10000,
        soft_max=128,
        default=0,
    )
    rows: IntProperty(
        name="Rows",
        description="Extra rows of quads round the poles; -1: as many, up to four, as the tolerance asks for",
        min=-1,
        soft_max=8,
        max=100,
        default=-1,
    )
    tolerance: FloatProperty(
        name="Tolerance",
        description="Largest distance from the patch in scene units; 0: a thousandth of the hole's diameter",
        min=0.0,
        precision=4,
        default=0.0,
    )
    cage_rim: EnumProperty(
        name="Cage Rim",
        description="What happens along the rim",
        items=[
            ("smooth", "Smooth", "The whole cage is smooth; the surroundings move as little as possible"),
            (
                "exact",
                "Exact",
                "The rim is creased: the surface around an open hole does not move, the fill is made tangent to it",
            ),
            ("move", "Move", "As Smooth, and the vertices of the rim may move too"),
        ],
        default="smooth",
    )
    odd: EnumProperty(
        name="Odd Rim",
        description="Quads need an even number of edges around",
        items=[
            ("split", "Split", "The longest edge of the rim is split"),
            ("triangle", "Triangle", "A triangle is left in the middle"),
        ],
        default="split",
    )
    pole_offset: FloatVectorProperty(
        name="Pole Offset",
        description="Slide the pole, in fractions of the hole: along the side of the first two corners, and towards the third",
        size=2,
        soft_min=-0.3,
        soft_max=0.3,
        min=-1.0,
        max=1.0,
        default=(0.0, 0.0),
        options={"SKIP_SAVE"},
    )
    add_modifier: BoolProperty(
        name="Add Modifier",
        description="Give the object a Subdivision modifier if it has none",
        default=True,
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
        items=[
            ("mesh", "Mesh", "Estimated from the faces around the hole"),
            (
                "limit",
                "Limit",
                "The surface that the Subdivision modifier draws; the fill becomes an object of its own, since a cage's vertices "
                "do not lie on that surface",
            ),
        ],
        default="mesh",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        return library.poll(cls, context, "EDIT_MESH", "Works on a mesh in edit mode")

    def draw(self, context):
        row = self.panel()
        cage, quads = self.output == "cage", self.output == "quads"
        row("output")
        if cage:
            row("rows", "tolerance")
            row("cage_rim")
            row("odd")
            row("pole_offset")
            self.sides_rows(row)
            self.fairing_rows(row)
            self.construction_rows(row)
            row("corner_offset", "shading")
            row("add_modifier", active=not all(map(subdivision.modifier_of, context.objects_in_mode_unique_data)))
            return
        if quads:
            row("rows", "odd")
        else:
            row("resolution")
        self.sides_rows(row)
        self.fairing_rows(row)
        self.construction_rows(row)
        row("corner_offset")
        row("shading")
        row("surroundings", active=any(map(subdivision.modifier_of, context.objects_in_mode_unique_data)))

    def _options(self):
        names = ["output"]
        if self.output != "triangles":
            names += ["odd", "pole_offset"]
        if self.output == "cage":
            names += ["cage_rim"]
        else:
            names += ["surroundings"]
        arguments = self.construction() | {name: getattr(self, name) for name in names}
        if self.output == "triangles":
            arguments["resolution"] = self.resolution or None
        else:
            arguments["resolution"] = None if self.rows < 0 else self.rows
            arguments["tolerance"] = self.tolerance or None
        return filling.Options(arguments, self.corner_offset, self.shading)

    def execute(self, context):
        with layers.without_matrices(context, context.objects_in_mode_unique_data):
            return self._execute(context)

    def _execute(self, context):
        objects = context.objects_in_mode_unique_data
        selected = [ob for ob in objects if ob.data.total_vert_sel]
        if not self.properties.is_property_set("output"):
            # Who models under a Subdivision modifier wants a cage; an object of its own is asked for by name.
            caged = self.surroundings == "mesh" and all(map(subdivision.modifier_of, selected or objects))
            self.output = "cage" if caged else "triangles"
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
        any_rim = self.takes_any_rim() and self.output != "cage" and self.surroundings != "limit"
        if selected.vertices and not (any_rim and selected.is_all(bm)):
            rims, refused = selection.selected_rims(bm, selected)
        else:
            rims = filling.open_holes(bm, matrix, any_rim)
        options = self._options()
        if options.arguments.get("surroundings") == "limit":
            outcome, _ = beside.fill_rims(ob, bm, matrix, rims, options)
            outcome.refused += refused
            return outcome
        cage = self.output == "cage"
        modifier = subdivision.usable(ob) if cage else None
        active = ob.active_shape_key
        outcome, new_faces = filling.fill_rims(bm, mesh, matrix, rims, options, active.name if active else None, modifier)
        outcome.refused += refused
        if new_faces:
            selected.replace(bm, new_faces)
            bmesh.update_edit_mesh(mesh)
            if cage and modifier is None and self.add_modifier:
                subdivision.add_modifier(ob)
        return outcome


def register():
    bpy.utils.register_class(MESH_OT_fill_three_sided)


def unregister():
    bpy.utils.unregister_class(MESH_OT_fill_three_sided)
