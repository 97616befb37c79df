"""Fills that take long are made in a thread: an operator that is ended meanwhile leaves the mesh to the bit as it was, one that
runs again afterwards fills as if it had not been ended, and a fill that is stopped stops. That Esc does it is tried in a window
(tests/gui)."""

import contextlib
import importlib
import threading
import types

import bmesh
import bpy
import numpy as np
import pytest
import scenes
import tripatch


@pytest.fixture
def waiting(addon, monkeypatch):
    """Its module, for which every fill takes long: in its thread none comes to its end before finish or stop."""
    module = importlib.import_module(f"{addon.__name__}.waiting")

    class Job(module._Job):
        def __init__(self, *call):
            self._may_end = threading.Event()
            super().__init__(*call)

        def _work(self):
            super()._work()
            assert self._may_end.wait(60)

        def _look(self, *progress):
            assert self._may_end.wait(60)
            super()._look(*progress)

        def finish(self):
            self._may_end.set()
            self._thread.join()

        def stop(self):
            self._stopped = True
            self._may_end.set()
            super().stop()

    monkeypatch.setattr(module, "PATIENCE", 0.0)
    monkeypatch.setattr(module, "_Job", Job)
    monkeypatch.setattr(module, "_before", {})
    return module


def run(waiting, making, **options):
    """One run of the operator: whether it came to its end."""
    try:
        with waiting._in(making):
            assert bpy.ops.mesh.fill_smooth(**options) == {"FINISHED"}
    except RuntimeError as error:
        assert "TakesLong" in str(error)
        return False
    return True


def with_shape_keys():
    ob = scenes.add_hole()
    ob.shape_key_add(name="Basis")
    for k, name in enumerate(("Up", "Down")):
        key = ob.shape_key_add(name=name)
        for point, v in zip(key.data, ob.data.vertices, strict=True):
            point.co = v.co * (1.2 + k)
    return ob


def half(_=None):
    """A hole that a Mirror modifier completes."""
    points, faces = scenes.square_hole()
    keep = [f for f in faces if points[f][:, 0].mean() > 0]
    ob = scenes.add_mesh(points, keep)
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bmesh.ops.delete(bm, geom=[v for v in bm.verts if not v.link_faces], context="VERTS")
    for v in bm.verts:
        if abs(v.co.x) < 0.06:
            v.co.x = 0.0
    bm.to_mesh(ob.data)
    bm.free()
    ob.modifiers.new("Mirror", "MIRROR")
    return ob


def with_odd_attributes():
    ob = scenes.add_hole()
    for kind in ("FLOAT2", "INT8"):
        with contextlib.suppress(TypeError):
            ob.data.attributes.new(kind, kind, "CORNER")
    ob.data.attributes.new("pair", "FLOAT2", "POINT")
    return ob


CASES = {
    "plain": (scenes.add_hole, {}),
    "shape keys": (with_shape_keys, {}),
    "quads by side": (lambda: scenes.add_mesh(*scenes.square_hole()), {"output": "quads", "individual": True, "bulge_1": 1.5}),
    "cage": (scenes.add_hole, {"output": "cage"}),
    "half": (half, {}),
    "odd attributes": (with_odd_attributes, {"deviation": True}),
}


def all_of(ob):
    bpy.ops.object.mode_set(mode="OBJECT")
    found = scenes.arrays(ob)
    bpy.ops.object.mode_set(mode="EDIT")
    return found


@pytest.mark.parametrize("name", CASES)
def test_ended_meanwhile_and_run_again_it_fills_as_in_one_go(waiting, name):
    make, options = CASES[name]
    ob = make()
    (bm,) = scenes.edit(ob)
    scenes.select_rim(bm, scenes.border_loops(bm)[0]) if name != "half" else None
    bmesh.update_edit_mesh(ob.data)
    before, making, runs = all_of(ob), waiting.Making(), 1
    while not run(waiting, making, **options):
        assert all_of(ob) == before, "nothing has changed"
        making._job.finish()
        runs += 1
        assert runs < 8
    assert runs == (4 if name == "shape keys" else 2), "once for each call that takes long"
    waited = all_of(ob)
    bpy.ops.object.mode_set(mode="OBJECT")
    other = make()
    (bm,) = scenes.edit(other)
    scenes.select_rim(bm, scenes.border_loops(bm)[0]) if name != "half" else None
    bmesh.update_edit_mesh(other.data)
    assert bpy.ops.mesh.fill_smooth(**options) == {"FINISHED"}
    assert len(waited["faces"]) > len(before["faces"])
    assert all_of(other) == waited


def test_a_live_fill_leaves_no_object_before_it_is_made(waiting):
    ob = scenes.add_hole()
    scenes.edit(ob)
    making, objects, meshes = waiting.Making(), len(bpy.data.objects), len(bpy.data.meshes)
    while not run(waiting, making, keep_live=True):
        assert (len(bpy.data.objects), len(bpy.data.meshes)) == (objects, meshes)
        assert not ob.modifiers
        making._job.finish()
    assert len(bpy.data.objects) == objects + 1 and len(ob.modifiers) == 1


def test_a_mesh_that_has_changed_meanwhile_is_filled_as_it_is_then(waiting):
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob)
    making = waiting.Making()
    assert not run(waiting, making)
    making._job.finish()
    bm = bmesh.from_edit_mesh(ob.data)
    for v in bm.verts:
        v.co.z *= 2
    assert not run(waiting, making), "what was made is of no use"
    making._job.finish()
    assert run(waiting, making)
    new = np.array([v.co for v in bmesh.from_edit_mesh(ob.data).verts])
    assert np.abs(new[:, 2] - 1.2 * (new[:, :2] ** 2).sum(axis=1)).max() < 0.01


@pytest.mark.parametrize("options", [{}, {"keep_live": True}], ids=["mesh", "live"])
def test_the_fills_of_several_objects_are_made_before_the_first_is_changed(waiting, options):
    """Each can be waited for and ended; else the second would be waited for while the first is in its mesh."""
    objects = [scenes.add_hole(), scenes.add_hole(size=14), scenes.add_hole(size=13)]
    for bm in scenes.edit(*objects):
        scenes.select_rim(bm, scenes.border_loops(bm)[0])
    before, made = [len(bmesh.from_edit_mesh(ob.data).faces) for ob in objects], len(bpy.data.objects)
    making, runs = waiting.Making(), 1
    while not run(waiting, making, **options):
        assert [len(bmesh.from_edit_mesh(ob.data).faces) for ob in objects] == before
        assert len(bpy.data.objects) == made
        making._job.finish()
        runs += 1
        assert runs < 8
    assert runs == 4, "once for each"
    if options:
        assert len(bpy.data.objects) == made + 3
        return
    for ob in objects:
        assert len(scenes.border_loops(bmesh.from_edit_mesh(ob.data))) == 1


def through_a_point():
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob)
    rim = scenes.border_loops(bm)[0]
    middle = sum((v.co for v in rim), bm.verts[0].co * 0) / len(rim)
    point = bm.verts.new(middle + middle.__class__((0, 0, 0.1)))
    scenes.select_rim(bm, rim)
    scenes.select(bm, [point])
    return ob, point.co.copy()


def test_a_fill_through_a_point_is_waited_for_and_can_be_ended(waiting):
    ob, point = through_a_point()
    before, making = all_of(ob), waiting.Making()
    assert not run(waiting, making, resolution=300)
    making.stop()
    assert making.is_done() and all_of(ob) == before
    making = waiting.Making()
    while not run(waiting, making):
        making._job.finish()
    bm = bmesh.from_edit_mesh(ob.data)
    new = {v for f in bm.faces if f.select for v in f.verts}
    assert len(scenes.border_loops(bm)) == 1
    assert min((v.co - point).length for v in new) < 1e-6


def test_what_the_last_run_has_made_is_not_made_again(waiting):
    """Blender undoes an operator and runs it again when a part of its panel is unfolded."""
    making = waiting.Making()
    for run_again, options in enumerate(({}, {"show_advanced": True}, {"resolution": 7})):
        ob = scenes.add_hole()
        (bm,) = scenes.edit(ob)
        scenes.select_rim(bm, scenes.border_loops(bm)[0])
        assert run(waiting, making, **options) == (run_again == 1)
        if run_again == 0:
            making._job.finish()
            assert run(waiting, making, **options)
        bpy.ops.object.mode_set(mode="OBJECT")
        making.stop()
        making = waiting.Making()


def test_a_fill_between_patches_is_waited_for_and_can_be_ended(waiting):
    import test_between_patches

    for ob in test_between_patches.three():
        ob.select_set(True)
    making, count = waiting.Making(), len(bpy.data.objects)
    with waiting._in(making), pytest.raises(RuntimeError, match="TakesLong"):
        bpy.ops.object.fill_between_patches(resolution=400)
    making.stop()
    assert making.is_done()
    assert (len(bpy.data.objects), len(bpy.data.meshes)) == (count, 0)
    making = waiting.Making()
    with waiting._in(making), pytest.raises(RuntimeError, match="TakesLong"):
        bpy.ops.object.fill_between_patches(keep_live=True)
    making._job.finish()
    with waiting._in(making):
        assert bpy.ops.object.fill_between_patches(keep_live=True) == {"FINISHED"}
    assert len(bpy.data.objects) == count + 1


def test_a_fill_that_is_stopped_ends_and_leaves_the_mesh(waiting):
    ob = scenes.add_hole()
    scenes.edit(ob)
    before, making = all_of(ob), waiting.Making()
    assert not run(waiting, making, resolution=600)
    assert "Esc: stop" in making.sentence()
    making.stop()
    assert isinstance(making._job._error, waiting._Stopped)
    assert all_of(ob) == before
    assert not any(thread.is_alive() for thread in threading.enumerate() if thread is making._job._thread)


def test_what_the_library_refuses_in_a_thread_is_refused(waiting):
    ob = scenes.add_hole(size=12, holes=((3, 3, 4),))
    scenes.edit(ob)
    making = waiting.Making()
    with waiting._in(making), pytest.raises(waiting.TakesLong):
        waiting.fill_all(np.zeros((3, 3)), [[0, 1, 2]], [[0, 1, 2]], nonsense=1)
    making._job.finish()
    with waiting._in(making), pytest.raises(TypeError):
        waiting.fill_all(np.zeros((3, 3)), [[0, 1, 2]], [[0, 1, 2]], nonsense=1)


class Desk:
    """A context that takes down what is asked of Blender's window."""

    def __init__(self):
        self.timers, self.texts, self.cursor = 0, [], "DEFAULT"
        self.window_manager = self.window = self.workspace = self.area = self

    def event_timer_add(self, _seconds, window):
        self.timers += 1
        return self.timers

    def event_timer_remove(self, _timer):
        self.timers -= 1

    def modal_handler_add(self, _operator):
        pass

    def cursor_modal_set(self, cursor):
        self.cursor = cursor

    def cursor_modal_restore(self):
        self.cursor = "DEFAULT"

    def status_text_set(self, text):
        self.texts.append(text)

    header_text_set = status_text_set


@pytest.fixture
def operator(waiting, monkeypatch):
    """One that fills a hole of some size, as in a window."""
    monkeypatch.setattr(waiting, "bpy", types.SimpleNamespace(app=types.SimpleNamespace(background=False)))
    points, faces = scenes.lattice()
    rim = min(tripatch.find_holes(faces), key=len)

    class Fills(waiting.Waiting):
        resolution, reported, usable = 4, (), True

        def execute(self, _context):
            (self.fill,) = waiting.fill_all(scenes.bowl(points), faces, [rim], resolution=self.resolution)
            return {"FINISHED"}

        def poll(self, _context):
            return self.usable

        def report(self, kind, sentence):
            self.reported += (sentence,)

    return Fills()


def event(kind, value="PRESS"):
    return types.SimpleNamespace(type=kind, value=value)


def test_an_operator_waits_tells_and_comes_to_its_end(operator):
    desk = Desk()
    assert operator.run_and_wait(desk) == {"RUNNING_MODAL"}
    assert desk.timers == 1 and desk.cursor == "WAIT" and "Esc: stop" in desk.texts[-1]
    assert operator.modal(desk, event("A")) == {"RUNNING_MODAL"}, "keys do nothing to the mesh"
    assert operator.modal(desk, event("MIDDLEMOUSE")) == {"PASS_THROUGH"}, "the view can be turned"
    operator._making._job.finish()
    assert operator.modal(desk, event("TIMER", "NOTHING")) == {"FINISHED"}
    assert len(operator.fill.vertices) and desk.timers == 0 and desk.cursor == "DEFAULT" and desk.texts[-1] is None


@pytest.mark.parametrize("how", ["Esc", "closed", "left"])
def test_an_operator_that_waits_is_ended(operator, how):
    desk, operator.resolution = Desk(), 1000
    assert operator.run_and_wait(desk) == {"RUNNING_MODAL"}
    if how == "Esc":
        assert operator.modal(desk, event("ESC")) == {"CANCELLED"}
        assert operator.reported == ("Stopped; the mesh is unchanged",)
    elif how == "closed":
        operator.cancel(desk)
    else:
        operator.usable = False  # no longer in edit mode
        assert operator.modal(desk, event("TIMER", "NOTHING")) == {"CANCELLED"}
    assert operator._making.is_done() and not hasattr(operator, "fill")
    assert desk.timers == 0 and desk.cursor == "DEFAULT" and desk.texts[-1] is None
