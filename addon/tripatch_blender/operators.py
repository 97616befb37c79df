# SPDX-License-Identifier: GPL-3.0-or-later
"""mesh.fill_smooth, and mesh.fill_three_sided, which is its name of before."""

from collections import Counter
from contextlib import ExitStack, suppress
from dataclasses import replace
from functools import partial

import bmesh
import bpy

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
    records,
    seam,
    selection,
    sentences,
    subdivision,
    trimming,
    waiting,
    writeback,
)
from .construction import without_shape
from .fill_panel import FillPanel, of_cages_only, of_output
from .properties import OPTIONS


def _selected(bm, mesh):
    """What is, and whether all holes are meant."""
    selected = selection.Selected(bm, mesh)
    return selected, not selected.vertices or selected.is_all(bm)


def _refused_rims(outcome):
    """(rims that were refused and can be filled otherwise, the other refusals, why the first was)"""
    rims = [each.rim for each in outcome.refused if each.rim and all(v.is_valid for v in each.rim.loop)]
    kept = [each for each in outcome.refused if each.rim not in rims]
    return rims, kept, next((each.sentence for each in outcome.refused if each.rim in rims), "")


class FillSmooth(FillPanel, waiting.Waiting):
    """What the operator does under either of its names."""

    @classmethod
    def poll(cls, context):
        return library.poll(cls, context, "EDIT_MESH", "needs_edit_mode")

    def invoke(self, context, _event):
        self.by_hand = True
        return self.run_and_wait(context)

    def _fill_halves(self, ob, bm, matrix, options, halves, outer):
        """Fills the holes that a Mirror modifier cuts in half; returns (Outcome, new faces). outer: outer borders too."""
        modifier = subdivision.usable(ob) if self.faces() == "cage" else None
        active = ob.active_shape_key.name if ob.active_shape_key else None
        outcome, new_faces, filled = mirrored.fill_halves(ob, bm, matrix, halves, options, outer, active, modifier)
        if filled:
            seam.remember(bm, ob.data.name, [], filled[-1:], library.words.seam_angle(outcome.reports))
        return outcome, new_faces

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
        rows = library.words.candidates(reports[0], aligned=False) if len(reports) == 1 else []
        self.candidates = "\n".join(of_filled(row) for row in rows)
        filled[-1].left_open = nothing.left_open
        message = "; ".join(outcome.sentence() for outcome in filled)
        if refused:
            reasons = "; ".join([*told[:3], *["..."] * (len(told) > 3)])
            message += "; " + sentences.said("some_not_filled", count=len(refused), reasons=reasons)
        notes = list(dict.fromkeys(of_filled(note) for outcome in filled for note in outcome.notes))
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
        applying = {o.name for o in of_output() if library.tripatch.options.applies(o, {"output": "quads"})}
        arguments = {name: value for name, value in options.arguments.items() if name in applying or name not in of_cages_only()}
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
