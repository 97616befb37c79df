# SPDX-License-Identifier: GPL-3.0-or-later
"""The method and the options that only some methods have, as properties that operators share, rows of a panel, and arguments."""

from __future__ import annotations

from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty

from . import library


def _method_items():
    if library.missing:
        return [("side_vertex", "Side Vertex", "")]
    return [
        (name, name.replace("_", " ").title(), f"{method.description} ({method.citation})")
        for name, method in library.tripatch.METHODS.items()
        if method.fills_holes
    ]


class Construction:
    """Mixed into operators."""

    method: EnumProperty(name="Method", description="Construction of the patch", items=_method_items(), default="side_vertex")
    bulge: FloatProperty(
        name="Bulge",
        description="Scale of the slopes with which the fill leaves its sides; the corners are kept",
        min=0.01,
        soft_max=4.0,
        max=100.0,
        default=1.0,
    )
    fairing: EnumProperty(
        name="Fairing",
        description="What the freedom that is left between the sides is used for",
        items=[
            ("auto", "Auto", "Nearest to what the surroundings suggest: curvature varies least, unless near a quadric"),
            ("none", "None", "The method's patch as it is"),
            ("thin_plate", "Thin Plate", "Least bending"),
            ("third_derivative", "Third Derivative", "Least change of bending, over the triangle"),
            ("minimum_variation", "Minimum Variation", "Least variation of curvature: spheres, cylinders"),
            ("quadric_variation", "Quadric Variation", "Nearest to quadrics: ellipsoids, saddles, cones"),
        ],
        default="auto",
    )
    cross_boundary: EnumProperty(
        name="Slopes",
        description="Length and direction of the slopes across the sides, within the tangent planes (Liu, Ma and Cheng 2008)",
        items=[
            ("consistent", "Consistent", "Such that they agree with the sides' tangents at the corners"),
            ("given", "Given", "As the surroundings have them"),
            ("as_printed", "As Printed", "By the paper's own equations, which lose its theorems"),
        ],
        default="consistent",
    )
    optimal_shape: BoolProperty(
        name="Optimal Shape", description="The shape parameters of least thin-plate energy", default=False
    )
    shape: FloatVectorProperty(
        name="Shape",
        description="Shape parameters lambda, one a side: how the surfaces over the sides weigh against each other",
        size=3,
        min=0.001,
        max=0.999,
        default=(0.5, 0.5, 0.5),
    )
    reading: EnumProperty(
        name="Reading",
        description="The formulas of Szilvasi-Nagy and Szabo",
        items=[
            ("corrected", "Corrected", "Such that the fill meets its surroundings"),
            ("as_printed", "As Printed", "As their paper has them, mistakes included"),
        ],
        default="corrected",
    )
    symmetric: BoolProperty(
        name="Symmetric",
        description="Favour no corner: the functional is summed over all three pairs of coordinates",
        default=False,
    )
    permanence: BoolProperty(
        name="Permanence Patch", description="A net by the mask of alpha instead of the Coons patch", default=False
    )
    alpha: FloatProperty(
        name="Alpha",
        description="Weight of the far neighbors in the mask of the permanence patch; in degree 3, -2/3 is the Coons patch. From "
        "degree 4 on some values have no patch",
        soft_min=-2.0,
        soft_max=1.0,
        default=-2 / 3,
        precision=4,
    )

    def panel(self):
        """row(*names, active=True) puts properties into the panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False

        def row(*names, active=True):
            made = layout.row(align=True)
            made.active = active
            for name in names:
                made.prop(self, name)

        return row

    def keeps_tangents(self):
        return library.tripatch.METHODS[self.method].continuity != "G0"

    def construction_rows(self, row):
        """The method and the options that it has."""
        row("method")
        for name in library.tripatch.METHODS[self.method].options:
            if name == "shape":
                row("optimal_shape")
                row("shape", active=not self.optimal_shape)
            elif name == "alpha":
                row("permanence")
                row("alpha", active=self.permanence)
            elif name in ("cross_boundary", "bulge"):
                row(name, active=self.continuity != "G0")
            else:
                row(name)

    def construction(self):
        """Arguments of `tripatch.fill` and `tripatch.patch`."""
        arguments = {"method": self.method, "continuity": self.continuity if self.keeps_tangents() else "auto"}  # greyed out
        arguments["fairing"] = None if self.fairing == "none" else self.fairing
        for name in library.tripatch.METHODS[self.method].options:
            if name == "shape":
                arguments[name] = "optimal" if self.optimal_shape else tuple(self.shape)
            elif name == "alpha":
                arguments[name] = self.alpha if self.permanence else None
            else:
                arguments[name] = getattr(self, name)
        return arguments
