# SPDX-License-Identifier: GPL-3.0-or-later
"""mesh.fill_three_sided"""

import bmesh
import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty

from . import beside, filling, following, layers, library, live, properties, selection, subdivision, writeback
from .construction import Construction
from .properties import OPTIONS


def _of_output():
    """The options that say what a hole is filled with and how finely."""
    return [
        option for option in OPTIONS.values() if option.panel and "fill" in option.functions and "patch" not in option.functions
    ]


def _declared():
    """`resolution` is two properties, since no value means different things: 0 as the rim, -1 within the tolerance."""
    made = {
        option.name: properties.of(option, **({"default": 0, "min": 0} if option.optional else {})) for option in _of_output()
    }
    description = "Edges per side inside the fill, 0 to follow the rim"
    made["resolution"] = properties.of(OPTIONS["resolution"], default=0, description=description)
    made["rows"] = properties.of(
        OPTIONS["resolution"],
        name="Rows",
        description="Extra rows of quads round the poles; -1: as many, up to four, as the tolerance asks for",
        min=-1,
        soft_max=8,
        max=100,
        default=-1,
    )
    return made


class MESH_OT_fill_three_sided(Construction, bpy.types.Operator):
    """Fill selected three-sided holes so that the surface continues smoothly"""

    bl_idname = "mesh.fill_three_sided"
    bl_label = "Fill Three-Sided Hole"
    bl_options = {"REGISTER", "UNDO"}

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

    keep_live: BoolProperty(
        name="Keep Live",
        description="The fill is an object of its own that follows when the mesh around it changes, until it is applied",
        default=False,
    )
    deviation: BoolProperty(
        name="Deviation",
        description="Write how well each new vertex is known (one standard deviation in scene units) as the vertex attribute "
        '"deviation", and mark the new faces by the face attribute "reconstructed"',
        default=False,
    )

    @classmethod
    def poll(cls, context):
        return library.poll(cls, context, "EDIT_MESH", "Works on a mesh in edit mode")

    def _applying(self):
        """The options of the output that mean something for the one that is chosen."""
        return [option for option in _of_output() if library.tripatch.options.applies(option, {"output": self.output})]

    def draw(self, context):
        row = self.panel()
        modified = list(map(subdivision.modifier_of, context.objects_in_mode_unique_data))
        row("output")
        row(*(["resolution"] if self.output == "triangles" else ["rows", "tolerance"]))
        for option in self._applying():
            if option.applies and option.name not in ("tolerance", "surroundings"):
                row(option.name)
        self.sides_rows(row)
        self.fairing_rows(row)
        self.construction_rows(row)
        row("corner_offset")
        row("shading")
        row("keep_live", active=self.surroundings != "limit")
        row("deviation", active=self.output != "cage")
        if self.output == "cage":
            row("add_modifier", active=not all(modified))
        else:
            row("surroundings", active=any(modified))

    def _options(self):
        arguments = self.construction() | {option.name: getattr(self, option.name) for option in self._applying()}
        if self.output == "triangles":
            arguments["resolution"] = self.resolution or None
        else:
            arguments["resolution"] = None if self.rows < 0 else self.rows
            arguments["tolerance"] = self.tolerance or None
        return filling.Options(arguments, self.corner_offset, self.shading, self.deviation)

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
        bm = bmesh.from_edit_mesh(ob.data)
        with writeback.deviation_layers(bm, self.deviation):
            return self._fill_mesh(ob, ob.data, bm)

    def _fill_mesh(self, ob, mesh, bm):
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
        if self.keep_live:
            outcome, made = live.keep_rims(ob, bm, rims, options)
            for fill in made:
                following.begin(fill)
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


if OPTIONS:
    properties.declare(MESH_OT_fill_three_sided, _declared())


def register():
    bpy.utils.register_class(MESH_OT_fill_three_sided)


def unregister():
    bpy.utils.unregister_class(MESH_OT_fill_three_sided)
