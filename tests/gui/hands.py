"""What a person does in a Blender window with mouse and keys, by simulated events; the meshes it is done to; what is seen."""

import ctypes
import os
import sys
import time
from pathlib import Path

import bmesh
import bpy
import numpy as np
from mathutils import Vector

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])


#: Seconds in which the window must come to rest, on a machine that does much else.
AT_REST = 300
#: Seconds from one look to the next: a turn of Blender's main loop or more, each of which draws what is to be drawn.
BETWEEN_LOOKS = 0.15
#: Rows of the status bar, in which the text of a report is blended in and out for ten seconds.
STATUS_BAR = 24

_DIGITS = ("ZERO", "ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT", "NINE")
_KEYS = {" ": "SPACE", ".": "PERIOD"} | {str(k): name for k, name in enumerate(_DIGITS)}


def screen():
    """The bytes (800, 1280, 4) of the virtual screen, the highest row first: a shot by Blender takes half a second."""
    return np.fromfile(os.environ["TRIPATCH_SCREEN"], np.uint8)[-4 * 1280 * 800 :].reshape(800, 1280, 4)


def _save(shown, path):
    """Writes a picture (height, width, 3), the lowest row first, which it returns."""
    image = bpy.data.images.new("shown", shown.shape[1], shown.shape[0])
    image.pixels.foreach_set(np.dstack([shown, np.ones(shown.shape[:2], np.float32)]).ravel())
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()
    bpy.data.images.remove(image)
    return shown


class Window:
    """Positions from the lower left corner."""

    at = None  # the mouse

    @property
    def window(self):
        return bpy.context.window_manager.windows[0]

    def area(self):
        return next(a for a in self.window.screen.areas if a.type == "VIEW_3D")

    def region(self, kind):
        return next(r for r in self.area().regions if r.type == kind)

    def override(self):
        return bpy.context.temp_override(window=self.window, area=self.area(), region=self.region("WINDOW"))

    def event(self, kind, value, **given):
        x, y = self.at or self.middle()
        self.window.event_simulate(type=kind, value=value, x=int(x), y=int(y), **given)

    def press(self, key, **modifiers):
        self.event(key, "PRESS", **modifiers)
        self.event(key, "RELEASE", **modifiers)

    def move(self, x, y):
        self.at = x, y
        self.event("MOUSEMOVE", "NOTHING")

    def click(self, x=None, y=None, **modifiers):
        if x is not None:
            self.at = x, y
        self.press("LEFTMOUSE", **modifiers)

    def click_at(self, x, y):
        """Goes there, that what is there can light up, clicks and waits for what it does."""
        self.move(x, y)
        yield
        self.click(x, y)
        yield
        yield

    def choose_from_below(self, number):
        """Of the menu that is open, the entry with this number from below, by keys: where it is differs between Blenders."""
        self.press("END")
        yield
        for _ in range(number - 1):
            self.press("UP_ARROW")
            yield
        self.press("RET")
        yield
        yield

    def text(self, letters):
        for letter in letters:
            key = _KEYS.get(letter, letter.upper())
            self.event(key, "PRESS", unicode=letter)
            self.event(key, "RELEASE")

    def middle(self):
        r = self.region("WINDOW")
        return r.x + r.width // 2, r.y + r.height // 2

    def home(self):
        self.move(*self.middle())

    def on_screen(self, point):
        """Where in the window a point of the world is seen."""
        from bpy_extras.view3d_utils import location_3d_to_region_2d

        region = self.region("WINDOW")
        at = location_3d_to_region_2d(region, self.area().spaces.active.region_3d, Vector(point))
        return region.x + at.x, region.y + at.y

    def shot(self, name, window=None):
        """What the window, or another one, shows at this moment (height, width, 3), the lowest row first; into the folder."""
        path = str(FOLDER / f"{name}.png")
        with bpy.context.temp_override(window=window or self.window):
            bpy.ops.screen.screenshot(filepath=path)
        image = bpy.data.images.load(path)
        width, height = image.size
        shown = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(shown)
        bpy.data.images.remove(image)
        shown = shown.reshape(height, width, -1)[..., :3]
        if shown.any():
            return shown
        # Blender reads what it has drawn in the front of its two buffers, where Mesa 25 leaves nothing without a graphics card
        return _save(screen()[::-1, :, 2::-1] / np.float32(255), path)

    def picture(self, name):
        """A shot of the window at rest: `shown = yield from w.picture(name)`. Blender draws again between two looks at the
        screen, each time with one sample more of its anti-aliasing, with panels and hints blended in or out: only what is equal
        three times is the state that the scenario has brought about, however slow the machine."""
        equal, last, until = 0, None, time.monotonic() + AT_REST
        while True:
            assert time.monotonic() < until, f"the window does not come to rest in {AT_REST} s ({name})"
            yield BETWEEN_LOOKS
            now = screen()[:-STATUS_BAR]
            equal, last = equal + 1 if np.array_equal(now, last) else 0, now
            if equal >= 2:
                shown = self.shot(name)  # Blender asks the screen for it: what has been sent to the screen has arrived then
                if np.array_equal(screen()[:-STATUS_BAR], last):
                    return shown

    def view_of(self, shown):
        """The part of a picture that is the 3D view, below its headers and next to its panel, however much of it is unfolded."""
        r = self.region("WINDOW")
        return shown[r.y + 20 : r.y + r.height - 90, r.x + 370 : r.x + r.width - 80]


def give_focus():
    """What a window manager does: without it Blender counts no window as the active one, and its status bar tells nothing."""
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = x11.XDefaultRootWindow.restype = ctypes.c_void_p
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    root, parent, children = ctypes.c_ulong(), ctypes.c_ulong(), ctypes.POINTER(ctypes.c_ulong)()
    count = ctypes.c_uint()
    top = ctypes.c_ulong(x11.XDefaultRootWindow(display))
    x11.XQueryTree(display, top, *map(ctypes.byref, (root, parent, children, count)))
    for k in range(count.value):
        x11.XSetInputFocus(display, ctypes.c_ulong(children[k]), 1, 0)
        x11.XSync(display, 0)
    x11.XCloseDisplay(display)


# What is there.


def mesh():
    return bmesh.from_edit_mesh(bpy.context.view_layer.objects.active.data)


def counts():
    """Vertices and border edges."""
    bm = mesh()
    return len(bm.verts), sum(e.is_boundary for e in bm.edges)


def positions():
    return [tuple(v.co) for v in mesh().verts]


def last_operator():
    operators = bpy.context.window_manager.operators
    return operators[-1] if operators else None


def clear(w):
    """An empty scene in object mode, no other window, and the operator with its defaults instead of what it was last given."""
    for window in bpy.context.window_manager.windows[1:]:
        with bpy.context.temp_override(window=window):
            bpy.ops.wm.window_close()
    kept = bpy.context.window_manager.operator_properties_last("mesh.fill_smooth")
    for name in list(kept.keys()):
        kept.property_unset(name)
    with w.override():
        if bpy.context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        for ob in list(bpy.data.objects):
            bpy.data.objects.remove(ob)
        space = w.area().spaces.active
        space.region_3d.view_rotation = Vector((0.9, -1, 0.75)).to_track_quat("Z", "Y")
        space.region_3d.view_location = (0, 0, 0)
        space.region_3d.view_distance = 5
        space.shading.type, space.shading.light = "SOLID", "MATCAP"
        space.overlay.show_cursor = space.overlay.show_edge_sharp = False


def _edit(w, ob, chosen):
    """Into edit mode, the border edges of which `chosen` says so selected, as an undo step."""
    with w.override():
        bpy.ops.object.select_all(action="DESELECT")
        ob.select_set(True)
        bpy.context.view_layer.objects.active = ob
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.wm.tool_set_by_id(name="builtin.select_box")
        bpy.ops.mesh.select_mode(type="EDGE")
        bpy.ops.mesh.select_all(action="DESELECT")
        bm = bmesh.from_edit_mesh(ob.data)
        for e in bm.edges:
            e.select = e.is_boundary and chosen(e)
        bm.select_flush_mode()
        bmesh.update_edit_mesh(ob.data)
        bpy.ops.ed.undo_push(message=ob.name)
    return ob


def _add(name, bm):
    data = bpy.data.meshes.new(name)
    bm.to_mesh(data)
    bm.free()
    data.polygons.foreach_set("use_smooth", [True] * len(data.polygons))
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    return ob


def rounded_corner(w, segments=10):
    """A cube with three rounded edges, and a hole where they meet; its normals are those that a CAD program would export."""
    bm = bmesh.new()
    bmesh.ops.create_cube(bm, size=2)
    corner = max(bm.verts, key=lambda v: v.co.x - v.co.y + v.co.z)
    signs, middle = (1, -1, 1), [s * 0.2 for s in (1, -1, 1)]
    edges = list(corner.link_edges)
    bmesh.ops.bevel(bm, geom=edges, offset=0.8, offset_type="OFFSET", segments=segments, profile=0.5, affect="EDGES")
    inside = [
        f for f in bm.faces if all(s * (c - m) > 1e-4 for s, c, m in zip(signs, f.calc_center_median(), middle, strict=True))
    ]
    bmesh.ops.delete(bm, geom=inside, context="FACES")
    for f in bm.faces:
        f.smooth = True
    ob = _add("Cube", bm)
    normals = []
    for face in ob.data.polygons:
        flat = max(abs(c) for c in face.normal) > 1 - 1e-6
        for v in face.vertices:
            co = ob.data.vertices[v].co
            away = Vector(s * max(s * c - abs(m), 0) for s, c, m in zip(signs, co, middle, strict=True))
            normals.append(face.normal.copy() if flat else away.normalized())
    if hasattr(ob.data, "use_auto_smooth"):
        ob.data.use_auto_smooth = True
    ob.data.normals_split_custom_set(normals)
    return _edit(w, ob, lambda e: True)


def sheet(w, name, finer=False, whole=False):
    """A bent sheet with a hole of four sides (unless it is whole), in edit mode with its rim selected."""
    if bpy.context.mode != "OBJECT":
        with w.override():
            bpy.ops.object.mode_set(mode="OBJECT")
    bm = bmesh.new()
    bmesh.ops.create_grid(bm, x_segments=14, y_segments=14, size=2)
    for v in bm.verts:
        v.co.z = 0.2 * v.co.x**2 - 0.1 * v.co.y**2 + 0.5
    if not whole:
        bmesh.ops.delete(bm, geom=[f for f in bm.faces if max(map(abs, f.calc_center_median().xy)) < 0.6], context="FACES")
    if finer:
        bmesh.ops.subdivide_edges(bm, edges=bm.edges, cuts=1, use_grid_fill=True)
    return _edit(w, _add(name, bm), lambda e: max(map(abs, e.verts[0].co.xy)) < 1)


def ball(w):
    """A smooth ball of quads with a hole, in edit mode with its rim selected."""
    bm = bmesh.new()
    bmesh.ops.create_uvsphere(bm, u_segments=32, v_segments=16, radius=1)
    there = Vector((0.55, -0.65, 0.45))
    bmesh.ops.delete(bm, geom=[f for f in bm.faces if (f.calc_center_median() - there).length < 0.45], context="FACES")
    return _edit(w, _add("Ball", bm), lambda e: True)


def jagged_ball(w):
    """A ball of triangles with a hole of no sides, its rim selected."""
    bm = bmesh.new()
    bmesh.ops.create_icosphere(bm, subdivisions=4, radius=1)
    gone = Vector((0.55, -0.6, 0.45)).normalized()
    bmesh.ops.delete(bm, geom=[f for f in bm.faces if (f.calc_center_median() - gone).length < 0.55], context="FACES")
    return _edit(w, _add("Ball", bm), lambda e: True)
