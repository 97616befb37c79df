# SPDX-License-Identifier: GPL-3.0-or-later
"""When live fills are filled anew: after a change, ten times a second at most. Files without live fills cost nothing, and files
with some nothing while nothing changes."""

import time
import traceback

import bpy
from bpy.app.handlers import persistent

from . import library, live

#: Seconds between a change and the fill, and between two fills.
INTERVAL = 0.1
#: A fill that takes long leaves Blender twice that time.
_REST = 2.0
_MODES = ("OBJECT", "EDIT")


class _Following:
    def __init__(self):
        self.names = []  # of the live fills of this file
        self.pending = set()  # of those whose surroundings may have changed
        self.states = {}  # what each was last filled for
        self.wait = INTERVAL


_following = _Following()


def _sources(name):
    """Everything that a fill follows, by what Blender says has changed."""
    fill = bpy.data.objects.get(name)
    if fill is None or not live.is_live(fill):
        return set()
    try:
        objects = live.around(fill)
    except live.UnusableError:
        return set()
    keys = {ob.data.shape_keys for ob in objects if ob.type == "MESH"}
    return {*objects, *(ob.data for ob in objects), *keys}


@persistent
def _on_change(_scene, depsgraph):
    changed = {
        u.id.original
        for u in depsgraph.updates
        if u.is_updated_geometry or u.is_updated_transform or isinstance(u.id, bpy.types.Key)
    }
    for name in _following.names if changed else ():
        if changed & _sources(name):
            _wish(name)


def _wish(name):
    """Has a fill looked at soon."""
    _following.pending.add(name)
    if not bpy.app.timers.is_registered(_tick):
        # persistent, as one that opening a file removes hangs Blender 4.5 at its end
        bpy.app.timers.register(_tick, first_interval=_following.wait, persistent=True)


def _stop_timer():
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)


def _busy():
    return any(bpy.app.is_job_running(job) for job in ("RENDER",)) if hasattr(bpy.app, "is_job_running") else False


def _tick():
    """Fills anew what has changed; comes again only if something is left."""
    if _busy():
        return 1.0
    began = time.perf_counter()
    pending, _following.pending = _following.pending, set()
    for name in sorted(pending):
        follow(name)
    _following.wait = max(INTERVAL, _REST * (time.perf_counter() - began))
    return _following.wait if _following.pending else None


def follow(name):
    """Fills a live fill anew if what it follows has changed; whether it did."""
    fill = bpy.data.objects.get(name)
    if fill is None or not live.is_live(fill):
        return False
    try:
        if any(ob.mode not in _MODES for ob in live.around(fill)):
            return False  # leaving the mode is a change
        state = live.state_of(fill)
        if _following.states.get(name) == state:
            return False
        live.refill(fill)
        # what was found about the rim may be new
        _following.states[name] = live.state_of(fill)
    except live.UnusableError as reason:
        fill["tripatch_problem"] = str(reason)
        return False
    except Exception:  # the last fill stays
        traceback.print_exc()
        fill["tripatch_problem"] = "It could not be filled; see the system console"
        return False
    return True


def begin(fill):
    """A live fill that was just made is up to date."""
    scan()
    _following.states[fill.name] = live.state_of(fill)


def scan():
    """Finds the live fills of the file, and listens to changes only if there are some."""
    _following.names = [fill.name for fill in live.fills()]
    handlers = bpy.app.handlers.depsgraph_update_post
    if _following.names and _on_change not in handlers:
        handlers.append(_on_change)
    elif not _following.names and _on_change in handlers:
        handlers.remove(_on_change)


@persistent
def _on_load(*_):
    _stop_timer()
    _following.__init__()
    scan()


@persistent
def _on_undo(*_):
    """A fill that was brought back may be of another moment than what lies around it."""
    _following.states.clear()
    scan()
    for name in _following.names:
        _wish(name)


_HANDLERS = (("load_post", _on_load), ("undo_post", _on_undo), ("redo_post", _on_undo))


@persistent
def _first_change(*_):
    """After registering, when Blender lets data be read again; a timer instead would hang Blender 4.5 at its end."""
    bpy.app.handlers.depsgraph_update_post.remove(_first_change)
    scan()


def register():
    if library.missing:
        return
    for name, function in _HANDLERS:
        getattr(bpy.app.handlers, name).append(function)
    bpy.app.handlers.depsgraph_update_post.append(_first_change)


def unregister():
    for name, function in (*_HANDLERS, ("depsgraph_update_post", _on_change), ("depsgraph_update_post", _first_change)):
        if function in getattr(bpy.app.handlers, name):
            getattr(bpy.app.handlers, name).remove(function)
    _stop_timer()
    _following.__init__()
