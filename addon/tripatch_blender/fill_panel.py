# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person chooses for mesh.fill_smooth: its properties, its panel, and what these say to the library."""

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from . import calls, library, panel, properties, subdivision
from .construction import Construction, plain
from .properties import OPTIONS

_HIDDEN = {"HIDDEN", "SKIP_SAVE"}
#: Rows that go into the folded part of the panel on subdivision.
_OF_CAGES = ("surroundings", "cage_rim", "odd", "pole_offset", "tolerance")


def _of(function, but):
    """The options of a function that a person sets, without those of another."""
    return [o for o in OPTIONS.values() if o.panel and function in o.functions and but not in o.functions]


def of_output():
    """The options that say what a hole is filled with and how finely."""
    return _of("fill", "patch")


def of_cages_only():
    """Names of the options of the output that mean something for cages and for nothing else."""
    applies = library.tripatch.options.applies
    return {o.name for o in of_output() if applies(o, {"output": "cage"}) and not applies(o, {"output": "quads"})}


def _of_holes():
    """The options that say which holes are meant where none is selected."""
    return _of("choose_holes", "fill")


def _declared():
    """`resolution` is two properties, since no value means different things: 0 as the rim, -1 within the tolerance."""
    made = {option.name: properties.of(option, **({"default": 0, "min": 0} if option.optional else {})) for option in of_output()}
    density = OPTIONS["resolution"]
    made["resolution"] = properties.of(
        density,
        **library.named("density"),
        default=0,
        soft_min=1,
    )
    kinds = [(each.name, properties.label(each), each.description) for each in OPTIONS["output"].choices]
    made["output"] = properties.of(
        OPTIONS["output"],
        items=[("auto", *library.titled("output_auto")), *kinds],
        default="auto",
    )
    made["rows"] = properties.of(
        density,
        **library.named("extra_rows"),
        min=-1,
        soft_min=0,
        soft_max=8,
        max=100,
        default=-1,
    )
    for option in _of_holes():
        if option.kind == "flag":
            made[option.name] = properties.of(option)
            continue
        said = {"name": properties.label(option), "description": properties.seen(option)}
        made["use_" + option.name] = BoolProperty(**said, default=False)
        made[option.name] = properties.of(option, default=_FILTERS[option.name])
    return made


#: What filters begin with.
_FILTERS = {"max_edges": 64, "max_diameter": 1.0, "corner_count": (2, 6)}


#: Properties that say how the last run went.
_OF_A_RUN = ("by_hand", "reasons", "candidates", "all_holes", "sides", "keep_live")

#: What the properties computed_... are where nothing was.
_NEVER = {"odd": "", "resolution": 0, "rows": -1, "tolerance": 0}


class FillPanel(Construction):
    """Mixed into the operators that fill the holes of a mesh."""

    add_modifier: BoolProperty(**library.named("add_modifier"), default=True)
    corner_offset: IntProperty(**library.named("slide_corners"), default=0, options={"SKIP_SAVE"})
    span: IntProperty(**library.named("span"), min=0, default=0, options={"SKIP_SAVE"})
    shading: EnumProperty(
        **library.named("shading"),
        items=library.items("shading", "neighbors", "smooth", "flat"),
        default="neighbors",
    )
    keep_live: BoolProperty(**library.named("keep_live"), default=False)
    width: FloatProperty(**library.named("width"), unit="LENGTH", min=0.0, default=0.0, options={"SKIP_SAVE"})
    deviation: BoolProperty(**library.named("deviation"), default=False)
    computed_output: StringProperty(options=_HIDDEN)  # what "auto" means for this selection
    # What was computed the last time: a value that is still the same was not chosen by anyone, and is computed again.
    computed_odd: StringProperty(options={"HIDDEN"})
    computed_resolution: IntProperty(default=0, options={"HIDDEN"})
    computed_rows: IntProperty(default=-1, options={"HIDDEN"})
    computed_tolerance: FloatProperty(options={"HIDDEN"})
    # Of the last run.
    by_hand: BoolProperty(**library.named("by_hand"), options=_HIDDEN)
    reasons: StringProperty(options=_HIDDEN)
    candidates: StringProperty(options=_HIDDEN)  # lines, of the only hole that was filled
    all_holes: BoolProperty(options=_HIDDEN)
    sides: IntProperty(default=3, options=_HIDDEN)

    def _applying(self):
        """The options of the output that mean something for the one that is chosen."""
        return [option for option in of_output() if library.tripatch.options.applies(option, {"output": self.faces()})]

    def faces(self):
        """What the new faces are: triangles, quads or a cage."""
        return self.output if self.output != "auto" else self.computed_output or "triangles"

    def density(self):
        """The property that says how fine the fill is."""
        return "resolution" if self.faces() == "triangles" else "rows"

    def _no_density(self):
        """Its value until something has been filled: it says nothing, and is not shown next to a refusal."""
        return 0 if self.faces() == "triangles" else -1

    def draw(self, context):
        row = self.panel()
        panel.reasons(self.layout, context, self.reasons)
        row("output")
        if not self.reasons or getattr(self, self.density()) != self._no_density():
            row(self.density())
        self.shape_rows(row)
        if self.all_holes:
            with panel.folded(self, "holes") as row:
                self._holes_rows(row)
        with panel.folded(self, "sides") as row:
            self.sides_rows(row)
            row("span", active=self.faces() == "quads")
            row("corner_offset", active=not self.why_not("corners"))
            self.why_rows(row, {"corners": library.label("slide_corners")})
        with panel.folded(self, "subdivision") as row:
            self._subdivision_rows(row, context)
        with panel.folded(self, "advanced") as row:
            self.construction_rows(row)
            row("cap", active=self.faces() != "cage")
            row("features", active=self.faces() != "cage")
            row("width")
            row("shading")
            row("keep_live", active=self.surroundings != "limit")
            row("deviation", active=self.faces() != "cage")
        with panel.folded(self, "papers") as row:
            self.papers_rows(row)
        if self.candidates:
            with panel.folded(self, "choice") as row:
                row.reasons(self.candidates.split("\n"))

    def _holes_rows(self, row):
        for option in _of_holes():
            if option.kind == "flag":
                row(option.name)
            else:
                row.optional("use_" + option.name, option.name)

    def _subdivision_rows(self, row, context):
        applying = {option.name for option in self._applying()}
        modified = list(map(subdivision.modifier_of, context.objects_in_mode_unique_data))
        row("surroundings", active=any(modified) and "surroundings" in applying)
        for name in _OF_CAGES[1:]:
            if name != "tolerance" or self.tolerance:  # computed by a fill that it applies to; until then it says nothing
                row(name, active=name in applying and not self.why_not(name))
        row("add_modifier", active=self.faces() == "cage" and not all(modified))
        self.why_rows(row, {"pole_offset": properties.label(OPTIONS["pole_offset"])})

    def _is_computed(self, name, none):
        """Whether nobody has chosen a property: then it is computed."""
        value, last = getattr(self, name), getattr(self, "computed_" + name)
        # what the menu remembers from the last time counts as not set, but then there is what was computed
        return value in (none, last) or (last == _NEVER[name] and not self.properties.is_property_set(name))

    def _options(self):
        arguments = self.construction() | {option.name: plain(getattr(self, option.name)) for option in self._applying()}
        arguments["output"] = self.faces()
        self._computes = self._is_computed(self.density(), self._no_density())
        arguments["resolution"] = None if self._computes else getattr(self, self.density())
        if self.faces() != "triangles":
            arguments["tolerance"] = None if self._is_computed("tolerance", 0) else self.tolerance
        return calls.Options(arguments, self.corner_offset, self.shading, self.deviation, record=self._record())

    def _record(self):
        """The properties that somebody or something has chosen, for Edit Fill."""
        chosen = {}
        for p in self.properties.bl_rna.properties:
            if p.identifier != "rna_type" and p.identifier not in _OF_A_RUN and not p.identifier.startswith("show_"):
                value = plain(getattr(self, p.identifier))
                if value != (tuple(p.default_array) if getattr(p, "is_array", False) else p.default):
                    chosen[p.identifier] = value
        return {"properties": chosen}

    def _filters(self):
        """The arguments of `tripatch.choose_holes`."""
        set_by_script = self.properties.is_property_set
        given = {}
        for option in _of_holes():
            if option.kind == "flag":
                given[option.name] = getattr(self, option.name)
                continue
            switch = "use_" + option.name
            if getattr(self, switch) or (set_by_script(option.name) and not set_by_script(switch)):
                value = getattr(self, option.name)
                given[option.name] = tuple(value) if option.count > 1 else value
        return given

    def _show_computed(self, context, outcome):
        """The panel shows the numbers that were taken."""
        self.take_not_applied(outcome.reports, outcome.left_out)
        if outcome.reports:
            self.sides = max(len(report.corners) for report in outcome.reports)
            density = self.density()
            if self._computes and (computed := outcome.density(self.faces())) is not None:
                setattr(self, density, computed)
                setattr(self, "computed_" + density, computed)
            if self.faces() != "triangles" and outcome.diameters and self._is_computed("tolerance", 0):
                self.tolerance = self.computed_tolerance = calls.TOLERANCE * max(outcome.diameters)
        for region in context.area.regions if context.area else ():
            if region.type == "HUD":
                region.tag_redraw()  # it shows what an operator before had, until the mouse goes over it


if OPTIONS:
    properties.declare(FillPanel, _declared())
