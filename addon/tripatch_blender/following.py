# SPDX-License-Identifier: GPL-3.0-or-later
"""When live fills and Smooth Fill nodes are filled again: after a change, ten times a second at most. Files without any cost
nothing, and files with some nothing while nothing changes."""

import time
import traceback

import bpy
from bpy.app.handlers import persistent

from . import joining, library, live, node_fills, sentences, versions

#: Seconds between a change and the fill, and between two fills.
INTERVAL = 0.1
#: A fill that takes long leaves Blender twice that time.
_REST = 2.0
_MODES = ("OBJECT", "EDIT")


class _Following:
    def __init__(self):
        self.names = []  # of the live fills of this file
        self.stale = False  # whether there are others
        self.pending = set()  # of those whose surroundings may have changed
        self.trees = []  # names of the hidden trees of Smooth Fill nodes
        self.pending_trees = set()  # of those whose input may have changed
        self.states = {}  # what each was last filled for
        self.wait = INTERVAL
        self.looking = False  # what changes now is what a look at the input of a node does


_following = _Following()


def _fill(name):
    """The live fill of this name, or None."""
    fill = bpy.data.objects.get((name, None))  # of this file
    return fill if fill is not None and live.is_live(fill) else None


def _is_new(block):
    return (
        isinstance(block, bpy.types.Object)
        and live.is_live(block)
        and block.name not in _following.names
        and not live.is_deleted(block)
    )


def _follows(fill, changed):
    """Whether a fill follows something of what Blender says has changed, or cannot and has not said so."""
    try:
        objects = live.around(fill)
    except live.UnusableError as reason:
        return live.problem_of(fill) != sentences.for_people(reason)
    keys = {ob.data.shape_keys for ob in objects if ob.type == "MESH"}
    return not changed.isdisjoint({fill, *objects, *(ob.data for ob in objects), *keys})


@persistent
def _on_change(_scene, depsgraph):
    """After an update, and after another frame was set."""
    if _following.looking or depsgraph.mode != "VIEWPORT":  # a render has objects of its own, in a thread of its own
        return
    changed = {
        u.id.original
        for u in depsgraph.updates
        if u.is_updated_geometry or u.is_updated_transform or isinstance(u.id, bpy.types.Key)
    }
    if not changed:
        return
    if _following.trees and (trees := node_fills.used_by(changed)):
        _following.pending_trees |= trees
        _look_soon()
    fills = {name: _fill(name) for name in _following.names}
    if any(fill is None or live.is_deleted(fill) for fill in fills.values()) or any(map(_is_new, changed)):
        _look_for_all()
        return
    for name, fill in fills.items():
        if _follows(fill, changed):
            _following.pending.add(name)
            _look_soon()


def _look_soon():
    if not bpy.app.timers.is_registered(_tick):
        # persistent, as one that opening a file removes hangs Blender 4.5 at its end
        bpy.app.timers.register(_tick, first_interval=_following.wait, persistent=True)


def _look_for_all():
    """Has the file looked through soon: fills have come, are gone or have other names."""
    _following.stale = True
    _look_soon()


def _stop_timer():
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)


def _tick():
    """Fills again what has changed; comes again only if something is left."""
    return 1.0 if versions.is_rendering() else _fill_pending()


def _at_once():
    """What else would be done soon, where nothing would be done later: without a window there are no timers."""
    if _following.stale or _following.pending or _following.pending_trees:
        _stop_timer()
        if _fill_pending() is not None:
            _look_soon()


def _fill_pending():
    """Fills again what has changed. Returns the seconds until what is left, or None."""
    began = time.perf_counter()
    if _following.stale or not all(map(_fill, _following.pending)):
        _following.stale = False
        scan()
        joining.remove_empty(live.is_deleted)
        _mark_all()
    pending, _following.pending = _following.pending, set()
    for name in sorted(pending):
        follow(name)
    _fill_nodes()
    _following.wait = max(INTERVAL, _REST * (time.perf_counter() - began))
    return _following.wait if _following.pending or _following.pending_trees else None


def _fill_nodes():
    """To look at an input counts as a change in Blender, which must not come back as one."""
    if not _following.pending_trees:
        return
    bpy.context.view_layer.update()  # what has changed before
    pending, _following.pending_trees = _following.pending_trees, set()
    _following.looking = True
    try:
        for name in sorted(pending.union(node_fills.part_copies())):
            follow_node(name)
        bpy.context.view_layer.update()
    finally:
        _following.looking = False


def _mark_all():
    _following.pending.update(_following.names)
    _following.pending_trees.update(_following.trees)


def follow_node(name):
    """Fills what goes into a Smooth Fill node if that has changed; whether it did. name: of its hidden tree."""
    try:
        return node_fills.follow(name)
    except Exception:  # the last fill stays
        traceback.print_exc()
        return False


def follow(name):
    """Fills a live fill again if what it follows has changed; whether it did."""
    fill = _fill(name)
    if fill is None:
        return False
    try:
        if fill.mode == "EDIT" or any(ob.mode not in _MODES for ob in live.around(fill)):
            return False  # leaving the mode is a change
        state = live.state_of(fill)
        if _following.states.get(name) == state:
            return False
        live.refill(fill)
        # what was found about the rim may be new
        _following.states[name] = live.state_of(fill)
    except live.UnusableError as reason:
        live.say(fill, reason)
        return False
    except Exception:  # the last fill stays
        traceback.print_exc()
        live.say(fill, sentences.said("live_fill_failed"))
        return False
    return True


def begin(fill):
    """A live fill that was just made is up to date."""
    scan()
    _following.states[fill.name] = live.state_of(fill)


def begin_node(name):
    """A Smooth Fill node that was just made is filled soon. name: of its hidden tree."""
    scan()
    _following.pending_trees.add(name)
    _look_soon()


def scan():
    """Finds the live fills and nodes of the file, and listens to changes only if there are some."""
    _following.names, _following.trees = [fill.name for fill in live.fills()], node_fills.trees()
    some = _following.names or _following.trees
    for handlers in _changes():
        if some and _on_change not in handlers:
            handlers.append(_on_change)
        elif not some and _on_change in handlers:
            handlers.remove(_on_change)


def _changes():
    """What Blender calls after a change; only the second after one of the frame."""
    return bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post


@persistent
def _on_load(*_):
    _stop_timer()
    _following.__init__()
    scan()


@persistent
def _before_undo(*_):
    node_fills.before_undo()


@persistent
def _on_undo(*_):
    """A fill that was brought back may be of another moment than what lies around it."""
    _following.states.clear()
    before = _following.names or _following.trees
    scan()
    if before or _following.names or _following.trees:
        _look_for_all()


@persistent
def _on_import(*_):
    scan()


@persistent
def _before_save(*_):
    """The file has what was asked for: opened again it would not know that something is left to do."""
    _at_once()


@persistent
def _before_render(scene, *_):
    """Before each frame that is rendered without a window. With one, Blender renders in a thread of its own, in which nothing of
    the file may be changed; and there is someone who has keyed not all that was changed."""
    if bpy.app.background and (_following.names or _following.trees):
        scene.frame_set(scene.frame_current, subframe=scene.frame_subframe)
        _mark_all()
        _at_once()


_HANDLERS = [("load_post", _on_load), ("undo_post", _on_undo), ("redo_post", _on_undo)]
_HANDLERS += [("undo_pre", _before_undo), ("redo_pre", _before_undo)]
_HANDLERS += [("save_pre", _before_save), ("render_pre", _before_render)]
if versions.TELLS_OF_IMPORTS:
    _HANDLERS.append(("blend_import_post", _on_import))


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
    for name, function in (*_HANDLERS, ("depsgraph_update_post", _first_change)):
        if function in getattr(bpy.app.handlers, name):
            getattr(bpy.app.handlers, name).remove(function)
    for handlers in _changes():
        if _on_change in handlers:
            handlers.remove(_on_change)
    _stop_timer()
    _following.__init__()
