# SPDX-License-Identifier: GPL-3.0-or-later
"""mesh.fill_smooth, and mesh.fill_three_sided, which is its name of before."""

from collections import Counter
from contextlib import ExitStack, suppress
from dataclasses import replace
from functools import partial

import bmesh
import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from . import (
    calls,
    filling,
    following,
    layers,
    library,
    limit_objects,
    live,
    mirrored,
    notches,
    outcomes,
    panel,
    properties,
    records,
    seam,
    selection,
    sentences,
    subdivision,
    trimming,
    waiting,
    writeback,
)
from .construction import Construction, plain, without_shape
from .properties import OPTIONS

_HIDDEN = {"HIDDEN", "SKIP_SAVE"}
#: Rows that go into the folded part of the panel on subdivision.
_OF_CAGES = ("surroundings", "cage_rim", "odd", "pole_offset", "tolerance")


def _of(function, but):
    """The options of a function that a person sets, without those of another."""
    return [o for o in OPTIONS.values() if o.panel and function in o.functions and but not in o.functions]


def _of_output():
    """The options that say what a hole is filled with and how finely."""
    return _of("fill", "patch")


def _of_cages_only():
    """Names of the options of the output that mean something for cages and for nothing else."""
    applies = library.tripatch.options.applies
    return {o.name for o in _of_output() if applies(o, {"output": "cage"}) and not applies(o, {"output": "quads"})}


def _of_holes():
    """The options that say which holes are meant where none is selected."""
    return _of("choose_holes", "fill")


def _declared():
    """`resolution` is two properties, since no value means different things: 0 as the rim, -1 within the tolerance."""
    made = {
        option.name: properties.of(option, **({"default": 0, "min": 0} if option.optional else {})) for option in _of_output()
    }
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


def _selected(bm, mesh):
    """What is, and whether all holes are meant."""
    selected = selection.Selected(bm, mesh)
    return selected, not selected.vertices or selected.is_all(bm)


def _refused_rims(outcome):
    """(rims that were refused and can be filled otherwise, the other refusals, why the first was)"""
    rims = [each.rim for each in outcome.refused if each.rim and all(v.is_valid for v in each.rim.loop)]
    kept = [each for each in outcome.refused if each.rim not in rims]
    return rims, kept, next((each.sentence for each in outcome.refused if each.rim in rims), "")


#: What filters begin with.
_FILTERS = {"max_edges": 64, "max_diameter": 1.0, "corner_count": (2, 6)}


#: Properties that say how the last run went.
_OF_A_RUN = ("by_hand", "reasons", "candidates", "all_holes", "sides", "keep_live")

#: What the properties computed_... are where nothing was.
_NEVER = {"odd": "", "resolution": 0, "rows": -1, "tolerance": 0}


class FillSmooth(Construction, waiting.Waiting):
    """What the operator does under either of its names."""

    add_modifier: BoolProperty(**library.named("add_modifier"), default=True)
    corner_offset: IntProperty(**library.named("slide_corners"), default=0, options={"SKIP_SAVE"})
    span: IntProperty(**library.named("span"), min=0, default=0, options={"SKIP_SAVE"})
    shading: EnumProperty(
        **library.named("shading"),
        items=[(name, *library.titled(f"shading_{name}")) for name in ("neighbors", "smooth", "flat")],
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

    @classmethod
    def poll(cls, context):
        return library.poll(cls, context, "EDIT_MESH", "needs_edit_mode")

    def invoke(self, context, _event):
        self.by_hand = True
        return self.run_and_wait(context)

    def _applying(self):
        """The options of the output that mean something for the one that is chosen."""
        return [option for option in _of_output() if library.tripatch.options.applies(option, {"output": self.faces()})]

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

    def _fill_halves(self, ob, bm, matrix, options, halves, outer):
        """Fills the holes that a Mirror modifier cuts in half; returns (Outcome, new faces). outer: outer borders too."""
        modifier = subdivision.usable(ob) if self.faces() == "cage" else None
        active = ob.active_shape_key.name if ob.active_shape_key else None
        outcome, new_faces, filled = mirrored.fill_halves(ob, bm, matrix, halves, options, outer, active, modifier)
        if filled:
            seam.remember(bm, ob.data.name, [], filled[-1:], library.words.seam_angle(outcome.reports))
        return outcome, new_faces

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

    def perform(self, context):
        live_ones = self.keep_live and self.surroundings != "limit"  # they are made in copies
        self._looked_at = {}
        with layers.standing_aside(context, [] if live_ones else context.objects_in_mode_unique_data):
            try:
                return self._execute(context)
            finally:
                self._looked_at.clear()

    def _choose_output(self, ob):
        """What nobody has chosen, for one object."""
        if self.output == "auto":
            # Who models under a Subdivision modifier wants a cage; an object of its own is asked for by name.
            caged = self.surroundings == "mesh" and subdivision.modifier_of(ob)
            # A script that says how many edges its triangles have has chosen them.
            counted = self.properties.is_property_set("resolution") and not self._is_computed("resolution", 0)
            adjacent = Counter() if caged or counted else self._adjacent_sizes(ob)
            self.computed_output = "cage" if caged else calls.matching_faces(adjacent)["output"]
        if self._is_computed("odd", None):
            continues = self.output == "auto" and self.computed_output == "quads"
            self.odd = self.computed_odd = "triangle" if continues else OPTIONS["odd"].default

    def _adjacent_sizes(self, ob):
        """Of the faces along the rims of an object that are to be filled: how many have so many corners. The rims are kept for
        the fill, unless the mesh is changed before, by halves of holes or by layers, which end the validity of what was found."""
        bm = bmesh.from_edit_mesh(ob.data)
        bm.verts.index_update()
        bm.faces.index_update()
        selected, everything = _selected(bm, ob.data)
        halves = self._half_rims(ob, bm, selected, everything) if self.surroundings != "limit" else []
        rims = [selection.Rim(chain) for _, chain in halves]
        with suppress(selection.UnusableError, selection.OptionsError):
            found = self._rims(ob, bm, filling.world_matrix(ob.name, ob.matrix_world), selected, everything)
            if not halves:
                self._looked_at[ob.name] = bm, selected, everything, found
            rims += [*found[0], *(reason.rim for reason in found[1] if reason.rim)]
        return selection.adjacent_sizes(bm, rims)

    def _fill_as_chosen(self, ob):
        """Each object by itself. Returns its Outcome, and the output that it was filled with."""
        self._choose_output(ob)
        return self._fill(ob), self.faces()

    def _execute(self, context):
        objects = context.objects_in_mode_unique_data
        selected = [ob for ob in objects if ob.data.total_vert_sel]
        self.reasons, self.candidates, self.all_holes = "", "", False
        meant = self._meant(selected or objects)
        with ExitStack() as kept:
            for ob in [] if self.keep_live or self.surroundings == "limit" else meant:
                kept.enter_context(writeback.layers_of_fills(bmesh.from_edit_mesh(ob.data), self.deviation))
            return self._fill_objects(context, objects, selected, meant)

    def _meant(self, objects):
        """Those of some objects that may have what is to be filled."""
        return objects

    def _fill_objects(self, context, objects, selected, meant):
        by_output: dict[str, outcomes.Outcome] = {}
        nothing, unusable = outcomes.Outcome(), []
        refusals = selection.UnusableError, selection.OptionsError
        waiting.ahead([partial(self._fill_as_chosen, ob) for ob in meant], *refusals)
        for ob in meant:
            name = ob.name if len(objects) > 1 else ""
            try:
                outcome, output = self._fill_as_chosen(ob)
            except selection.NothingToFill as reason:
                nothing.left_open += reason.left
            except refusals as reason:
                unusable.append(outcomes.Refused.because(reason, ob).of(name))
            else:
                nothing.left_open += outcome.left_open
                by_output.setdefault(output, outcomes.Outcome()).add(replace(outcome, left_open=[]), name)
        if by_output:  # the panel shows the first
            if self.output == "auto":
                self.computed_output = next(iter(by_output))
            self._show_computed(context, next(iter(by_output.values())))
        filled = [outcome for outcome in by_output.values() if outcome.reports]
        refused = [each for outcome in by_output.values() for each in outcome.refused]
        refused += unusable if selected or not filled else []
        in_words, of_filled = (
            (sentences.of_selected, sentences.of_filled) if self.by_hand else (sentences.for_people, sentences.for_people)
        )
        told = [in_words(each.sentence) for each in refused]
        self.reasons = "\n".join(told)
        if not filled:
            return self._refuse(context, refused, told) if refused else self._leave(nothing)
        reports = [report for outcome in filled for report in outcome.reports]
        self.candidates = "\n".join(library.words.candidates(reports[0])) if len(reports) == 1 else ""
        filled[-1].left_open = nothing.left_open
        message = "; ".join(outcome.sentence() for outcome in filled)
        if refused:
            reasons = "; ".join([*told[:3], *["..."] * (len(told) > 3)])
            message += "; " + sentences.said("some_not_filled", count=len(refused), reasons=reasons)
        notes = [of_filled(note) for outcome in filled for note in outcome.notes]
        if notes:
            message += f". {'. '.join(notes[:2])}"
        alarms = refused or any(outcome.alarms() for outcome in filled)
        self.report({"WARNING" if alarms else "INFO"}, message)
        return {"FINISHED"}

    def _leave(self, nothing):
        """There is no hole, which is no mistake. By hand the panel comes: it has what fills outer borders."""
        self.reasons = str(selection.NothingToFill(nothing.left_open))
        self.all_holes = True
        self.report({"INFO"}, self.reasons)
        return {"FINISHED" if self.by_hand else "CANCELLED"}

    def _refuse(self, context, refused, told):
        """Nothing could be filled. By hand the panel must come, which it does after what has changed something."""
        message = sentences.said("and_more", reason=told[0], count=len(told) - 1) if len(told) > 1 else told[0]
        if not self.by_hand:
            self.report({"ERROR"}, message)
            return {"CANCELLED"}
        selection.show(context, {each.ob: each.vertices for each in refused if each.vertices})
        self.report({"WARNING"}, message)
        return {"FINISHED"}

    def _half_rims(self, ob, bm, selected, everything):
        """What the selection means of the holes that a Mirror modifier cuts in half."""
        return mirrored.half_rims(ob, bm, [] if everything else selected.vertices)

    def _rims(self, ob, bm, matrix, selected, everything):
        """The rims that the selection means, an UnusableError for each part that means none, and how many edges each outer border
        has that is left open."""
        rims, refused, left = self._rims_meant(ob, bm, matrix, selected, everything)
        if self.surroundings != "limit":
            found = [*rims, *left, *(reason.rim for reason in refused if reason.rim)]
            joined = [rim for rim in found if mirrored.is_joined(ob, rim)]
            rims, left = ([rim for rim in each if rim not in joined] for each in (rims, left))
            refused = [reason for reason in refused if reason.rim not in joined]
            if joined and not rims and not refused:
                raise selection.UnusableError("mirror_joins_boundary", [v for rim in joined for v in rim.loop])
        if not (everything or self.outer):
            rims = filling.without_outer(bm, matrix, rims)
        return rims, refused, [len(rim.loop) for rim in left]

    def _rims_meant(self, ob, bm, matrix, selected, everything):
        """Those that the selection means, those that a Mirror modifier joins among them, reasons for other parts of it, and outer
        borders that are left open."""
        self.all_holes = everything or self.all_holes
        if everything:
            rims, left = filling.open_holes(bm, matrix, self._filters())
            return rims, [], left
        rims, refused = selection.selected_rims(bm, selected)
        if len(rims) > 1 and self.surroundings != "limit":
            rims, _ = selection.join_islands(rims, *selection.Surroundings(bm, matrix).around(*rims)[:2])
        return rims, refused, []

    def _fill_unshaped(self, bm, mesh, matrix, outcome, options, active, modifier):
        """Cages that would fold if they are pulled at stay as they are. Returns the new faces; the outcome takes theirs."""
        arguments, pulled = without_shape(options.arguments)
        rims, kept, reason = _refused_rims(outcome)
        if not rims or not pulled:
            return []
        plain_options = replace(options, arguments=arguments)
        made, new_faces = filling.fill_rims(bm, mesh, matrix, rims, plain_options, active, modifier)
        if made.reports:
            said = {"options": list(pulled.values()), "reason": reason}
            made.notes.insert(0, library.tripatch.Message("filled_unshaped", said))
            made.left_out += pulled
        outcome.refused = kept
        outcome.add(made)
        return new_faces

    def _fill_with_quads(self, bm, mesh, matrix, outcome, options):
        """Nobody asked for a cage by name: a hole that gets none, such as one of five corners, gets quads, which the modifier
        smooths too. Returns the new faces; the outcome takes theirs."""
        rims, kept, reason = _refused_rims(outcome)
        if not rims:
            return []
        applying = {o.name for o in _of_output() if library.tripatch.options.applies(o, {"output": "quads"})}
        arguments = {name: value for name, value in options.arguments.items() if name in applying or name not in _of_cages_only()}
        quads = replace(options, arguments=arguments | {"output": "quads"})
        try:
            made, new_faces = filling.fill_rims(bm, mesh, matrix, rims, quads)
        except selection.OptionsError:  # the cages that were made stay
            return []
        outcome.refused = kept
        outcome.cage_rim = outcome.cage_rim if outcome.reports else ""
        if made.reports:
            count = len(made.reports)
            made.notes.insert(0, library.tripatch.Message("quads_instead_of_cages", {"count": count, "reason": reason}))
            made.instead = True
        outcome.add(made)
        return new_faces

    def _fill(self, ob):
        mesh, bm = ob.data, bmesh.from_edit_mesh(ob.data)
        bm.verts.index_update()
        bm.faces.index_update()
        matrix = filling.world_matrix(ob.name, ob.matrix_world)
        _, selected, everything, known = self._looked_at.get(ob.name) or (bm, *_selected(bm, mesh), None)
        options = self._options()
        halved, new_faces = outcomes.Outcome(), []
        if self.surroundings != "limit":
            halves = self._half_rims(ob, bm, selected, everything)
            outer = self.outer or not (everything or len(halves) > 1)
            if self.keep_live:
                halved = live.keep(ob, [], options, halves, outer)
            else:
                halved, new_faces = self._fill_halves(ob, bm, matrix, options, halves, outer)
        try:
            rims, refused, left = known or self._rims(ob, bm, matrix, selected, everything)
        except selection.UnusableError:
            if not halved.reports and not halved.refused:
                raise
            rims, refused, left = [], [], []
        if self.width > 0:
            rims, refused = trimming.rims(bm, matrix, selected.faces, self.width, options), []
        if self.span and self.faces() == "quads":
            selection.span(rims, self.span, self.corner_offset)
            options = replace(options, corner_offset=0)
        notch = notches.close(bm, refused) if self._closes_notches() else None
        if notch:
            rims, refused = [*rims, notch.rim], []
        try:
            return self._fill_found(ob, bm, rims, refused, left, options, selected, halved, new_faces)
        finally:
            if notch:
                notches.end(bm, notch)
                records.find_again(bm, mesh)
                selection.finish_edit(bm, mesh)

    def _closes_notches(self):
        """Whether a part of an open border may be filled up to new edges."""
        return self.faces() != "cage" and self.surroundings == "mesh" and not self.keep_live

    def _fill_found(self, ob, bm, rims, refused, left, options, selected, halved, new_faces):
        mesh, matrix = ob.data, filling.world_matrix(ob.name, ob.matrix_world)
        rest = outcomes.Outcome(refused=[outcomes.Refused.because(reason, ob) for reason in refused], left_open=left)
        if options.arguments.get("surroundings") == "limit":
            outcome, _ = limit_objects.fill_rims(ob, bm, matrix, rims, options)
            outcome.add(rest)
            return outcome
        if self.keep_live:
            outcome = live.keep(ob, rims, options)
            outcome.add(halved)
            for name in outcome.live:
                following.begin(bpy.data.objects.get((name, None)))
            outcome.add(rest)
            return outcome
        cage = self.faces() == "cage"
        modifier = subdivision.usable(ob) if cage else None
        active = ob.active_shape_key
        outcome, made = filling.fill_rims(bm, mesh, matrix, rims, options, active.name if active else None, modifier)
        new_faces += made
        if cage and outcome.refused:
            name = active.name if active else None
            new_faces += self._fill_unshaped(bm, mesh, matrix, outcome, options, name, modifier)
        if cage and outcome.refused and self.output == "auto":
            new_faces += self._fill_with_quads(bm, mesh, matrix, outcome, options)
        outcome.add(halved)
        for each in outcome.refused:
            each.ob = ob
        outcome.add(rest)
        if new_faces:
            selected.replace(bm, new_faces)
            selection.finish_edit(bm, mesh)
            if cage and modifier is None and self.add_modifier:
                subdivision.add_modifier(ob)
        return outcome


if OPTIONS:
    properties.declare(FillSmooth, _declared())


class MESH_OT_fill_smooth(FillSmooth, bpy.types.Operator):
    bl_idname = "mesh.fill_smooth"
    bl_label, bl_description = library.titled("fill_holes_smoothly")
    bl_options = {"REGISTER", "UNDO"}


class MESH_OT_fill_three_sided(FillSmooth, bpy.types.Operator):
    bl_idname = "mesh.fill_three_sided"
    bl_label, bl_description = library.titled("fill_three_sided")
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}  # for scripts: not in the search


class MESH_OT_edit_fill(FillSmooth, bpy.types.Operator):
    bl_idname = "mesh.edit_fill"
    bl_label, bl_description = library.titled("edit_fill")
    bl_options = {"REGISTER", "UNDO"}

    def perform(self, context):
        for ob in context.objects_in_mode_unique_data:
            bm = bmesh.from_edit_mesh(ob.data)
            for number, _ in records.selected(bm):
                self._take(records.of_fill(ob.data, number))
                return super().perform(context)
        self.report({"WARNING" if self.by_hand else "ERROR"}, sentences.said("no_fill_selected"))
        return {"CANCELLED"}

    def _take(self, record):
        """The options of a fill, but those that are chosen now."""
        for name, value in (record or {}).get("properties", {}).items():
            if hasattr(self.properties, name) and not self.properties.is_property_set(name):
                setattr(self, name, value)

    def _meant(self, objects):
        return [ob for ob in objects if records.selected(bmesh.from_edit_mesh(ob.data))]

    def _half_rims(self, ob, bm, selected, everything):
        return []

    def _rims_meant(self, ob, bm, matrix, selected, everything):
        rims, refused = [], []
        for number, faces in records.selected(bm):
            record = records.of_fill(ob.data, number) or {}
            try:
                rims.append(selection.rim_of_fill(faces, number, record.get("corners", [])))
            except selection.UnusableError as reason:
                refused.append(reason)
        return rims, refused, []


_classes = (MESH_OT_fill_smooth, MESH_OT_fill_three_sided, MESH_OT_edit_fill)


def register():
    for cls in _classes:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
