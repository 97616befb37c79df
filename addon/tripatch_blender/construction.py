# SPDX-License-Identifier: GPL-3.0-or-later
"""The options that concern a patch, as properties that operators share, rows of a panel, and arguments."""

from collections import Counter
from typing import TYPE_CHECKING, Any

from bpy.props import BoolProperty, StringProperty

from . import calls, library, panel, properties, sentences
from .properties import OPTIONS

#: Options that may be absent and whose numbers leave no room to say so: the property that says it, and its value if they count.
_SWITCHES = {"shape": ("optimal_shape", False), "alpha": ("permanence", True)}
_EXACT = "side_vertex"  # what auto takes between three smooth sides
_ALPHA = -2 / 3  # in degree 3 the Coons patch


def options(function="patch"):
    """The options of a function that are of interest to a person."""
    return [option for option in OPTIONS.values() if option.panel and function in option.functions]


def _shape_options():
    """The options that pull at a fill."""
    return [OPTIONS["bulge"], *(o for o in options() if o.kind == "number" and not _of_methods(o) and o.name != "bulge")]


def without_shape(arguments):
    """(arguments without what pulls at the fill, {name: label} of what did)"""
    pulled = {o.name: properties.label(o) for o in _shape_options() if arguments.get(o.name, o.default) != o.default}
    return {name: value for name, value in arguments.items() if name not in pulled}, pulled


def _about(method):
    """What the library says of a method; of auto, what it says of the one whose options auto has."""
    return library.tripatch.METHODS[_EXACT if method == "auto" else method]


def _of_methods(option):
    return any(name == "method" for name, _ in option.applies)


#: The folded parts of panels, where Blender cannot fold them itself.
_FOLDED = ("holes", "sides", "subdivision", "advanced", "papers", "choice")
#: The library's codes for why a fill follows no such option, of which each has a message.
_WHY = ("sides", "three_sides", "poles", "position", "fairing", "vertices", "cage")


def _declared():
    made = {}
    for option in options():
        if option.name == "shape":
            made[option.name] = properties.by_side(option)
        elif option.name == "alpha":
            made[option.name] = properties.of(option, default=_ALPHA, precision=4)
        else:
            made[option.name] = properties.of(option, **({"default": option.default or "none"} if option.none else {}))
            if option.by_side:
                for i in range(calls.MAX_SIDES):
                    made[f"{option.name}_{i}"] = properties.of(option, name=sentences.said("side_number", number=i + 1))
    made["not_applied"] = StringProperty(options={"HIDDEN", "SKIP_SAVE"})  # of the last fills: "option:code option:code ..."
    made["individual"] = BoolProperty(**library.named("by_side"), default=False, options={"SKIP_SAVE"})
    for name, _ in _SWITCHES.values():
        made[name] = BoolProperty(**library.named(name), default=False)
    for name in _FOLDED:
        made[f"show_{name}"] = BoolProperty(**library.named("show_section"), default=False, options={"HIDDEN"})
    return made


def plain(value):
    """Of a property: several numbers as a tuple, which stays what it is when the operator is gone."""
    return value if isinstance(value, (bool, int, float, str)) else tuple(value)


class Construction:
    """Mixed into operators."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...  # what the operator has, its properties among them

    sides = 3  # of the hole that was filled last

    def panel(self):
        """row(*names, active=True) puts properties into the panel."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return panel.Rows(self, self.layout)

    def keeps_tangents(self):
        return _about(self.method).continuity != "G0"

    def _has(self, name):
        return _about(self.method).takes(name)

    def why_not(self, name):
        """The code for why the last fills follow no such option; empty: they do, or nothing has been filled."""
        return dict(each.split(":") for each in self.not_applied.split()).get(name, "")

    def take_not_applied(self, reports, left_out=()):
        """Of several fills: what none of them follows. left_out: names of options that cages were made without."""
        each = [report.not_applied for report in reports]
        common = set(each[0]).intersection(*each) if each else set()
        codes = {name: Counter(codes[name] for codes in each).most_common(1)[0][0] for name in common}
        codes |= dict.fromkeys(left_out, "cage")
        self.not_applied = " ".join(f"{name}:{codes[name]}" for name in sorted(codes))

    def why_rows(self, row, labels):
        """Why rows above are greyed. labels: {option: what its row is called}"""
        said = {}
        for name, label in labels.items():
            if (code := self.why_not(name)) in _WHY:
                said.setdefault(code, []).append(label)
        row.reasons(sentences.said(f"inactive_{code}", options=names) for code, names in said.items())

    def shape_rows(self, row):
        """How the fill meets its surroundings and what shape it takes."""
        row("continuity", active=self.keeps_tangents() and not self.individual and not self.why_not("continuity"))
        bulges = self._has("bulge") and not self.why_not("bulge") and self.continuity not in ("Free", "G0")
        row("bulge", active=bulges and not self.individual)
        numbers = [option for option in options() if option.kind == "number" and not _of_methods(option)]
        for option in numbers:
            faired = not option.applies or self.fairing != "none"
            row(option.name, active=faired and not self.why_not(option.name))
        shown = [OPTIONS["continuity"], OPTIONS["bulge"], *numbers]
        self.why_rows(row, {option.name: properties.label(option) for option in shown})

    def sides_rows(self, row):
        """The same for each side."""
        has_sides = self.keeps_tangents() and not self.why_not("corners")
        row("individual", active=has_sides)
        if self.individual and self.keeps_tangents():
            for i in range(min(self.sides, calls.MAX_SIDES)):
                row(f"continuity_{i}", active=has_sides)
                if self._has("bulge"):
                    tangent = getattr(self, f"continuity_{i}") not in ("Free", "G0")
                    row(f"bulge_{i}", text=properties.label(OPTIONS["bulge"]), active=has_sides and tangent)

    def construction_rows(self, row):
        """The method and whether it is made fair."""
        method, fairing = (properties.label(OPTIONS[name]) for name in ("method", "fairing"))
        row.choices("method", properties.METHODS, heading=method)
        energies = {name: called for name, called in properties.FAIRING.items() if name != "isometric"}
        row.choices("fairing", energies, heading=fairing, active=not self.why_not("fairing"))
        isometric = {"isometric": properties.FAIRING["isometric"]}  # of any fill, whether it has sides or not
        row.choices("fairing", isometric, heading=" ", active=self.why_not("fairing") != "vertices")
        self.why_rows(row, {"fairing": fairing})

    def papers_rows(self, row):
        """Constructions and energies of papers, and the options that only the method has that is chosen."""
        methods = [m for m in library.tripatch.METHODS.values() if m.fills_holes and m.name not in properties.METHODS]
        row.choices("method", {m.name: properties.method_label(m.name) for m in methods})
        for name in _about(self.method).options:
            if not OPTIONS[name].panel or name == "bulge":
                continue
            if name in _SWITCHES:
                switch, on = _SWITCHES[name]
                row(switch)
                row(name, active=getattr(self, switch) == on)
                if name == "shape" and self.fairing != "none":
                    row.reasons([sentences.said("lambda_with_fairing")])
            elif name == "cross_boundary":
                tangent = self.individual or self.continuity not in ("Free", "G0")
                row(name, active=tangent and not self.why_not(name))
            else:
                row(name)
        energies = [each for each in OPTIONS["fairing"].choices if each.name not in properties.FAIRING]
        labels = {each.name: properties.label(each) for each in energies}
        row.choices("fairing", labels, active=not self.why_not("fairing"))
        self.why_rows(row, {"cross_boundary": properties.label(OPTIONS["cross_boundary"])})

    def _each(self, name):
        """A value a side, for a hole of however many sides."""
        return calls.BySide([getattr(self, f"{name}_{i}") for i in range(calls.MAX_SIDES)])

    def continuities(self):
        """One, or a BySide."""
        return self._each("continuity") if self.individual else self.continuity

    def _argument(self, option):
        """What the property of an option says to the library."""
        value = plain(getattr(self, option.name))
        if option.name in _SWITCHES:
            switch, on = _SWITCHES[option.name]
            return value if getattr(self, switch) == on else option.none.name if option.none else None
        if option.by_side and self.individual:
            return self._each(option.name)
        return None if option.none and value == option.none.name else value

    def _is_asked_for(self, option):
        """Whether a script has set an option, which the panel may not show: the library says what it makes of it."""
        names = [option.name, *_SWITCHES.get(option.name, ())[:1]]
        if self.individual and option.name in ("continuity", "bulge"):
            names += [f"{option.name}_{i}" for i in range(calls.MAX_SIDES)]
        return not self.by_hand and any(map(self.properties.is_property_set, names))

    def construction(self):
        """Arguments of `tripatch.fill` and `tripatch.patch`."""
        shown = self.keeps_tangents() or self._is_asked_for(OPTIONS["continuity"])  # else greyed out
        arguments = {"continuity": self.continuities() if shown else "auto"}
        for option in options():
            of_another = _of_methods(option) and not self._has(option.name)
            if option.name in arguments or (of_another and not self._is_asked_for(option)):
                continue
            greyed = option.applies and not _of_methods(option) and self.fairing == "none"
            arguments[option.name] = option.default if greyed else self._argument(option)
        return arguments


if OPTIONS:
    properties.declare(Construction, _declared())
