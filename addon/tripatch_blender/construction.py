# SPDX-License-Identifier: GPL-3.0-or-later
"""The method and the options that only some methods have, as properties that operators share, rows of a panel, and arguments."""

from __future__ import annotations

from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty

from . import library

_CONTINUITY = [
    ("auto", "Auto", "The best that the method keeps"),
    ("Free", "Free", "Meets the rim; the slope there is the fairing's choice"),
    ("G0", "Position", "Meets the rim (G0)"),
    ("G1", "Tangent", "Continues the surrounding tangent planes (G1)"),
    ("G2", "Curvature", "Continues the curvature as well (G2)"),
]


def _continuity(name, description):
    return EnumProperty(name=name, description=description, items=_CONTINUITY, default="auto")


def _method_items():
    if library.missing:
        return [("auto", "Auto", "")]
    automatic = ("auto", "Auto", "Between three smooth sides the exact patch (Side Vertex), else Polyharmonic Spline")
    return [automatic] + [
        (name, name.replace("_", " ").title(), f"{method.description} ({method.citation})")
        for name, method in library.tripatch.METHODS.items()
        if method.fills_holes
    ]


def _about(method):
    """The method, or the one that auto takes between three sides."""
    return library.tripatch.METHODS["side_vertex" if method == "auto" else method]


class Construction:
    """Mixed into operators."""

    method: EnumProperty(name="Method", description="Construction of the patch", items=_method_items(), default="auto")
    bulge: FloatProperty(
        name="Bulge",
        description="Scale of the slopes with which the fill leaves its sides; the corners are kept",
        min=0.01,
        soft_max=4.0,
        max=100.0,
        default=1.0,
    )
    continuity: _continuity("Continuity", "How the fill meets what surrounds it")
    individual: BoolProperty(
        name="Individual Sides", description="Continuity and bulge are chosen for each side by itself", default=False
    )
    continuity_0: _continuity("Side 1", "How the fill meets the side opposite its first corner")
    continuity_1: _continuity("Side 2", "How the fill meets the side opposite its second corner")
    continuity_2: _continuity("Side 3", "How the fill meets the side opposite its third corner")
    bulges: FloatVectorProperty(
        name="Bulge",
        description="Scale of the slopes with which the fill leaves each of its sides; the corners are kept",
        size=3,
        min=0.01,
        soft_max=4.0,
        max=100.0,
        default=(1.0, 1.0, 1.0),
    )
    tension: FloatProperty(
        name="Tension",
        description="Pulls the fill tight; the tangent planes are kept. Needs a fairing",
        min=0.0,
        soft_max=20.0,
        max=1e6,
        default=0.0,
    )
    center_offset: FloatProperty(
        name="Center Offset",
        description="Moves the middle of the fill along its normal, in scene units; the tangent planes are kept",
        soft_min=-10.0,
        soft_max=10.0,
        precision=4,
        default=0.0,
        options={"SKIP_SAVE"},
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

    def takes_any_rim(self):
        """Whether a hole may have any number of corners."""
        return self.method in ("auto", "polyharmonic_spline")

    def keeps_tangents(self):
        return _about(self.method).continuity != "G0"

    def sides_rows(self, row):
        """How the sides are met, for all or for each."""
        keeps = self.keeps_tangents()
        row("continuity", active=keeps and not self.individual)
        row("individual", active=keeps)
        if self.individual and keeps:
            for name in ("continuity_0", "continuity_1", "continuity_2"):
                row(name)

    def fairing_rows(self, row):
        row("fairing")
        row("tension", active=self.fairing != "none")
        row("center_offset")

    def construction_rows(self, row):
        """The method and the options that it has."""
        row("method")
        for name in _about(self.method).options:
            if name == "shape":
                row("optimal_shape")
                row("shape", active=not self.optimal_shape)
            elif name == "alpha":
                row("permanence")
                row("alpha", active=self.permanence)
            elif name == "bulge" and self.individual:
                row("bulges")
            elif name in ("cross_boundary", "bulge"):
                row(name, active=self.individual or self.continuity not in ("Free", "G0"))
            else:
                row(name)

    def continuities(self):
        """By side."""
        each = (self.continuity_0, self.continuity_1, self.continuity_2)
        return each if self.individual else (self.continuity,) * 3

    def construction(self):
        """Arguments of `tripatch.fill` and `tripatch.patch`."""
        arguments = {"method": self.method, "continuity": "auto", "center_offset": self.center_offset}
        if self.keeps_tangents():  # else greyed out
            arguments["continuity"] = self.continuities()
        arguments["fairing"] = None if self.fairing == "none" else self.fairing
        arguments["tension"] = 0.0 if self.fairing == "none" else self.tension
        for name in _about(self.method).options:
            if name == "shape":
                arguments[name] = "optimal" if self.optimal_shape else tuple(self.shape)
            elif name == "alpha":
                arguments[name] = self.alpha if self.permanence else None
            elif name == "bulge" and self.individual:
                arguments[name] = tuple(self.bulges)
            else:
                arguments[name] = getattr(self, name)
        return arguments
