# SPDX-License-Identifier: GPL-3.0-or-later
"""Fills that take long: Blender stays awake meanwhile, says how far they are, and Esc ends them.

An operator runs as it always does, but what the library computes is computed in a thread, which knows nothing of Blender. Where
that takes longer than `PATIENCE`, `TakesLong` ends the operator before it has changed anything; when the thread is done the
operator runs again, and finds what it asks for made. So nothing of a mesh is held meanwhile, and a mesh that has changed is
filled as it is then. Of several objects all fills are made before the first is changed (`ahead`).

The panel of the last operator undoes it and runs it again without events, where nothing can be waited for. There the operator is
cancelled, which brings back what was; when the thread is done, it is undone and run once more (`_Again`).
"""

from __future__ import annotations

import hashlib
import pickle
import threading
import time
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

import bmesh
import bpy

from .library import np, titled, tripatch

#: Seconds that Blender may stand still.
PATIENCE = 0.5
#: Seconds between two looks at a fill that takes long.
_LOOK = 0.05
#: Where sides are compared.
_PLACES = 33
#: Events that turn the view meanwhile.
_VIEW = ("MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "TRACKPADPAN", "TRACKPADZOOM", "MOUSEROTATE", "NDOF_MOTION")


class Ends(Exception):
    """Ends an operator before it has changed anything."""


class TakesLong(Ends):
    """Its fill continues in a thread."""


class _Stopped(Exception):
    """Ends the work in the thread."""


class _Ahead(Ends):
    """It was only to have its fills made."""


class _Job:
    """A call of a function in a thread. It takes `progress`, as tripatch.fill_all has it; count: of the holes it fills."""

    def __init__(self, function, arguments, given, count):
        # nothing of Blender's goes along: it may be freed meanwhile
        self.call = function, arguments, pickle.loads(pickle.dumps(given))
        self.done, self.count = 0, count
        self._stopped, self._results, self._error = False, None, None
        self._thread = threading.Thread(target=self._work, name="TriPatch", daemon=True)
        self._thread.start()

    def _work(self):
        function, arguments, given = self.call
        try:
            self._results = function(*arguments, **given, progress=self._look)
        except BaseException as error:  # it is raised where the results are asked for
            self._error = error

    def _look(self, done, _count):
        self.done = done
        if self._stopped:
            raise _Stopped

    def is_done(self, wait=0.0):
        self._thread.join(wait)
        return not self._thread.is_alive()

    def stop(self):
        """Ends it; the library obeys within a tenth of a second."""
        self._stopped = True
        self._thread.join()

    def has_failed(self):
        return self._error is not None

    def results(self):
        if self._error is not None:
            raise self._error
        return self._results


def _key(call):
    """The same for calls that have the same results."""
    found = hashlib.blake2b()

    def take(value):
        if isinstance(value, np.ndarray):
            found.update(f"{value.dtype}{value.shape}".encode() + np.ascontiguousarray(value).tobytes())
        elif isinstance(value, tripatch.Side):
            take(value.evaluate(np.linspace(0, 1, _PLACES)))
        elif callable(value):
            found.update(value.__qualname__.encode())
        elif isinstance(value, dict):
            for name in sorted(value):
                found.update(name.encode())
                take(value[name])
        elif isinstance(value, (list, tuple)) and not all(isinstance(each, (int, float, str)) for each in value):
            found.update(f"{len(value)}:".encode())
            for each in value:
                take(each)
        else:
            found.update(repr(value).encode())

    take(call)
    return found.digest()


class Making:
    """What was made for one run of an operator."""

    def __init__(self):
        self.began = time.monotonic()
        self._until, self._job, self._made = 0.0, None, {}
        self._ahead = False

    def begin(self):
        """A run of the operator begins."""
        self._until = time.monotonic() + PATIENCE
        if self._job is not None:
            self._made[_key(self._job.call)] = self._job
            self._job = None

    def must_finish(self):
        """From now on the operator must not end: it has changed something."""
        if self._ahead:
            raise _Ahead
        self._until = float("inf")

    def make(self, function, arguments, given, count):
        key = _key((function, arguments, given))
        if made := self._made.get(key) or _before.get(key):
            self._made[key] = made
            return made.results()
        job = _Job(function, arguments, given, count)
        if not job.is_done(max(0.0, min(self._until - time.monotonic(), threading.TIMEOUT_MAX))):
            self._job = job
            raise TakesLong
        self._made[key] = job
        return job.results()

    def ahead(self, steps, refusals):
        self._ahead = True
        try:
            for step in steps:
                with suppress(_Ahead, *refusals):
                    step()
        finally:
            self._ahead = False

    def is_done(self):
        return self._job.is_done()

    def stop(self):
        if self._job is not None:
            self._job.stop()

    def made(self):
        return {key: job for key, job in self._made.items() if not job.has_failed()}

    def sentence(self):
        """How far it is."""
        count, passed = self._job.count, int(time.monotonic() - self.began)
        if count == 1:
            return str(tripatch.Message("filling_hole", {"seconds": passed}))
        return str(tripatch.Message("filling_holes", {"hole": min(self._job.done + 1, count), "total": count, "seconds": passed}))


_making = None
#: What the last run made: Blender runs an operator once more if a part of its panel is unfolded.
_before: dict[bytes, _Job] = {}


def make(function, *arguments, progress=None, count=1, **given):
    """A function of the library, or one that knows nothing of Blender, with these arguments; in a run of an operator that can
    wait in a thread. It takes `progress`, as tripatch.fill_all has it; count: of the holes it fills."""
    if _making is None:
        return function(*arguments, **given, progress=progress)
    return _making.make(function, arguments, given, count)


def fill_all(*arguments, **given):
    """tripatch.fill_all(vertices, faces, rims, ...), likewise."""
    return make(tripatch.fill_all, *arguments, count=len(arguments[2]), **given)


def ahead(steps, *refusals):
    """Has the fills of several steps of an operator made before the first changes anything, so that all can be waited for and
    ended: does each up to where it would. refusals: what they may raise, which they raise again when they are done."""
    if _making is not None and len(steps) > 1:
        _making.ahead(steps, refusals)


def must_finish():
    """To be called before anything is changed that a second run of the operator would find."""
    if _making is not None:
        _making.must_finish()


@contextmanager
def _in(making):
    global _making, _before
    outer, _making = _making, making
    making.begin()
    try:
        yield
    finally:
        _making, _before = outer, making.made()


def _state(context):
    """Tells whether an operator runs where it ran before."""
    if context.mode != "EDIT_MESH":
        return sorted(ob.name for ob in context.scene.objects)
    bms = {ob.name: bmesh.from_edit_mesh(ob.data) for ob in context.objects_in_mode_unique_data}
    return sorted((name, len(bm.verts), len(bm.edges), len(bm.faces)) for name, bm in bms.items())


class _Again:
    """What an operator was asked for once more, and takes long."""

    def __init__(self, operator, making, undone):
        self.operator, self.making, self.undone = operator.bl_idname, making, undone
        given = operator.as_keywords().items()
        self.arguments = {name: value for name, value in given if operator.properties.is_property_set(name)}

    def wait(self):
        """When Blender takes events again."""
        global _again
        _again = self
        with bpy.context.temp_override(**_view()):
            bpy.ops.wm.wait_for_fill("INVOKE_DEFAULT")  # pyright: ignore[reportAttributeAccessIssue]

    def finish(self):
        """When the thread is done and nothing waits any more."""
        group, name = self.operator.lower().split("_ot_") if "_OT_" in self.operator else self.operator.split(".")
        with bpy.context.temp_override(**_view()), _in(self.making):
            self.making.must_finish()
            if self.undone:
                bpy.ops.ed.undo()
            getattr(getattr(bpy.ops, group), name)("EXEC_DEFAULT", True, **self.arguments)


_again = None


def _view():
    """A window and its 3D view."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                region = next(region for region in area.regions if region.type == "WINDOW")
                return {"window": window, "area": area, "region": region}
    return {"window": bpy.context.window_manager.windows[0]}


class Waiting:
    """Mixed into operators whose `perform` fills: called by hand they wait for what takes long."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...  # what the operator has, its `perform` among them

    def execute(self, context):
        found = _state(context)
        if _making is None and hasattr(self, "_found") and not bpy.app.background:
            return self._once_more(context, found)
        result = self.perform(context)
        if _making is not None:
            self._found, self._left = found, _state(context)
        return result

    def _once_more(self, context, found):
        """With other values, where the panel has undone it, or as it was, where the mesh is as it left it."""
        making = Making()
        try:
            with _in(making):
                return self.execute(context)
        except TakesLong:
            again = _Again(self, making, found == self._found and found != self._left)
            bpy.app.timers.register(again.wait, first_interval=0)
            return {"CANCELLED"}

    def run_and_wait(self, context):
        """What `invoke` returns."""
        if bpy.app.background:  # no one could press a key
            return self.execute(context)
        self._making, self._timer = Making(), None
        return self._run(context)

    def _run(self, context):
        try:
            with _in(self._making):
                result = self.execute(context)
        except TakesLong:
            self._begin_waiting(context)
            return {"RUNNING_MODAL"}
        except BaseException:
            self._end_waiting(context)
            raise
        self._end_waiting(context)
        return result

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, str(tripatch.Message("stopped")))
            return {"CANCELLED"}
        if event.type == "TIMER":
            if not self.poll(context):
                self.cancel(context)
                return {"CANCELLED"}
            if self._making.is_done():
                return self._run(context)
            self._tell(context)
        return {"PASS_THROUGH"} if event.type in _VIEW else {"RUNNING_MODAL"}

    def cancel(self, context):
        """Also called by Blender, where a file is opened or the window is closed."""
        self._making.stop()
        self._end_waiting(context)

    def _begin_waiting(self, context):
        if self._timer is None:
            self._timer = context.window_manager.event_timer_add(_LOOK, window=context.window)
            context.window_manager.modal_handler_add(self)
            context.window.cursor_modal_set("WAIT")
        self._tell(context)

    def _tell(self, context):
        sentence = self._making.sentence()
        if sentence != getattr(self, "_told", None):
            self._told = sentence
            context.workspace.status_text_set(sentence)
            if context.area:
                context.area.header_text_set(sentence)

    def _end_waiting(self, context):
        if self._timer is None:
            return
        context.window_manager.event_timer_remove(self._timer)
        self._timer = None
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)
        if context.area:
            context.area.header_text_set(None)


class WM_OT_wait_for_fill(Waiting, bpy.types.Operator):
    bl_idname = "wm.wait_for_fill"
    bl_label, bl_description = titled("wait_for_fill")
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context):
        return _again is not None

    def invoke(self, context, _event):
        self._making, self._timer = _again.making, None
        self._begin_waiting(context)
        return {"RUNNING_MODAL"}

    def _run(self, context):
        self._end_waiting(context)
        bpy.app.timers.register(_again.finish, first_interval=0)
        return {"FINISHED"}


def register():
    bpy.utils.register_class(WM_OT_wait_for_fill)


def unregister():
    bpy.utils.unregister_class(WM_OT_wait_for_fill)
