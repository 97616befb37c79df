# SPDX-License-Identifier: GPL-3.0-or-later
"""The options that concern a patch, as properties that operators share, rows of a panel, and arguments."""

from bpy.props import BoolProperty

from . import library, properties
from .properties import OPTIONS

#: Options that may be absent and whose numbers leave no room to say so: the property that says it, and what it says.
_SWITCHES = {
    "shape": ("optimal_shape", False, "Optimal Shape", "The shape parameters of least thin-plate energy"),
    "alpha": ("permanence", True, "Permanence Patch", "A net by the mask of alpha instead of the Coons patch"),
}
_EXACT = "side_vertex"  # what auto takes between three smooth sides
_ALPHA = -2 / 3  # in degree 3 the Coons patch


def options(function="patch"):
    """The options of a function that are of interest to a person."""
    return [option for option in OPTIONS.values() if option.panel and function in option.functions]


def _about(method):
    """What the library says of a method; of auto, what it says of the one whose options auto has."""
    return library.tripatch.METHODS[_EXACT if method == "auto" else method]


def _of_methods(option):
    return any(name == "method" for name, _ in option.applies)


def _declared():
    made = {}
    for option in options():
        if option.kind == "choice" and option.by_side:
            made[option.name] = properties.of(option)
            for i in range(3):
                made[f"{option.name}_{i}"] = properties.of(option, name=f"Side {i + 1}")
        elif option.name == "shape":
            made[option.name] = properties.by_side(option)
        elif option.name == "alpha":
            made[option.name] = properties.of(option, default=_ALPHA, precision=4)
        else:
            made[option.name] = properties.of(option, **({"default": option.default or "none"} if option.none else {}))
            if option.by_side:
                made[option.name + "s"] = properties.by_side(option)
    made["individual"] = BoolProperty(
        name="Individual Sides", description="Continuity and bulge are chosen for each side by itself", default=False
    )
    for name, _, label, description in _SWITCHES.values():
        made[name] = BoolProperty(name=label, description=description, default=False)
    return made


class Construction:
    """Mixed into operators."""

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
        """The fairing, and what shapes a patch of any method."""
        row("fairing")
        for option in options():
            if option.kind == "number" and not _of_methods(option):
                row(option.name, active=not option.applies or self.fairing != "none")

    def construction_rows(self, row):
        """The method and the options that it has."""
        row("method")
        for name in _about(self.method).options:
            if not OPTIONS[name].panel:
                continue
            if name in _SWITCHES:
                switch, on, _, _ = _SWITCHES[name]
                row(switch)
                row(name, active=getattr(self, switch) == on)
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

    def _argument(self, option):
        """What the property of an option says to the library."""
        value = getattr(self, option.name)
        if option.name in _SWITCHES:
            switch, on, _, _ = _SWITCHES[option.name]
            value = tuple(value) if option.by_side else value
            return value if getattr(self, switch) == on else option.none.name if option.none else None
        if option.by_side and self.individual:
            return tuple(getattr(self, option.name + "s"))
        return None if option.none and value == option.none.name else value

    def construction(self):
        """Arguments of `tripatch.fill` and `tripatch.patch`."""
        arguments = {"continuity": self.continuities() if self.keeps_tangents() else "auto"}  # else greyed out
        for option in options():
            if option.name in arguments or (_of_methods(option) and option.name not in _about(self.method).options):
                continue
            greyed = option.applies and not _of_methods(option) and self.fairing == "none"
            arguments[option.name] = option.default if greyed else self._argument(option)
        return arguments


if OPTIONS:
    properties.declare(Construction, _declared())
