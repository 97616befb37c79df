# SPDX-License-Identifier: GPL-3.0-or-later
"""Fills that take long: Blender stays awake meanwhile, says how far they are, and Esc ends them.

An operator runs as it always does, but what the library computes is computed in a thread, which knows nothing of Blender. Where
that takes longer than `PATIENCE`, `TakesLong` ends the operator before it has changed anything; when the thread is done the
operator runs again, and finds what it asks for made. So nothing of a mesh is held meanwhile, and a mesh that has changed is
filled as it is then.
"""

from __future__ import annotations

import hashlib
import pickle
import threading
import time
from contextlib import contextmanager

import bpy

from .library import np, tripatch

#: Seconds that Blender may stand still.
PATIENCE = 0.5
#: Seconds between two looks at a fill that takes long.
_LOOK = 0.05
#: Events that turn the view meanwhile.
_VIEW = ("MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "TRACKPADPAN", "TRACKPADZOOM", "MOUSEROTATE", "NDOF_MOTION")


class TakesLong(Exception):
    """Ends an operator whose fill goes on in a thread."""


class _Stopped(Exception):
    """Ends the work in the thread."""


class _Job:
    """A call of tripatch.fill_all in a thread."""

    def __init__(self, arguments, given):
        self.call = arguments, pickle.loads(pickle.dumps(given))  # nothing of Blender's goes along: it may be freed meanwhile
        self.done, self.count = 0, len(arguments[2])
        self._stopped, self._results, self._error = False, None, None
        self._thread = threading.Thread(target=self._work, name="TriPatch", daemon=True)
        self._thread.start()

    def _work(self):
        arguments, given = self.call
        try:
            self._results = tripatch.fill_all(*arguments, **given, progress=self._look)
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

    def begin(self):
        """A run of the operator begins."""
        self._until = time.monotonic() + PATIENCE
        if self._job is not None:
            self._made[_key(self._job.call)] = self._job
            self._job = None

    def goes_on(self):
        """From now on the operator must not end: it has changed something."""
        self._until = float("inf")

    def fill_all(self, *arguments, **given):
        call = arguments, given
        if self._made and (made := self._made.get(_key(call))):
            return made.results()
        job = _Job(*call)
        if not job.is_done(max(0.0, min(self._until - time.monotonic(), threading.TIMEOUT_MAX))):
            self._job = job
            raise TakesLong
        return job.results()

    def is_done(self):
        return self._job.is_done()

    def stop(self):
        if self._job is not None:
            self._job.stop()

    def sentence(self):
        """How far it is."""
        count, passed = self._job.count, int(time.monotonic() - self.began)
        which = f"hole {min(self._job.done + 1, count)} of {count}" if count > 1 else "the hole"
        return f"Filling {which} ({passed} s)   Esc: stop"


_making = None


def fill_all(*arguments, progress=None, **given):
    """tripatch.fill_all(vertices, faces, rims, ...), in a run of an operator that can wait in a thread."""
    if _making is None:
        return tripatch.fill_all(*arguments, **given, progress=progress)
    return _making.fill_all(*arguments, **given)


def goes_on():
    """To be called before anything is changed that a second run of the operator would find."""
    if _making is not None:
        _making.goes_on()


@contextmanager
def _in(making):
    global _making
    before, _making = _making, making
    making.begin()
    try:
        yield
    finally:
        _making = before


class Waiting:
    """Mixed into operators whose `execute` fills: called by hand they wait for what takes long."""

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
            self.report({"INFO"}, "Stopped; the mesh is as it was")
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
