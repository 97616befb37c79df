"""Run by tests/gui/run in a Blender window, by mouse and keys: a hole is filled from the Face menu, the redo panel opened, used,
all undone; filled by the key, by the search, from the context menu; a refusal is read and corrected in the panel; and all is
repeated on another mesh."""

import os
import sys
import traceback
from pathlib import Path

import addon_utils
import bmesh
import bpy
from mathutils import Vector

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
ROOT = Path(__file__).resolve().parents[2]
STEP = 1.0
bpy.context.preferences.view.show_splash = False  # later is too late


def enable_addon():
    archive = os.environ.get("TRIPATCH_ZIP")
    if archive:
        bpy.ops.preferences.addon_install(filepath=archive, overwrite=True)
    else:
        sys.path[:0] = [str(ROOT / "native" / "python"), str(ROOT / "addon")]
    assert addon_utils.enable("tripatch_blender"), "the add-on could not be enabled"


def rounded_corner():
    """A cube with three rounded edges, and a hole where they meet."""
    cube = bpy.data.objects["Cube"]
    bm = bmesh.new()
    bm.from_mesh(cube.data)
    corner = max(bm.verts, key=lambda v: v.co.x - v.co.y + v.co.z)
    radius, middle = 0.8, [s * 0.2 for s in (1, -1, 1)]
    edges = list(corner.link_edges)
    bmesh.ops.bevel(bm, geom=edges, offset=radius, offset_type="OFFSET", segments=10, profile=0.5, affect="EDGES")
    inside = [
        f for f in bm.faces if all(s * (c - m) > 1e-4 for s, c, m in zip((1, -1, 1), f.calc_center_median(), middle, strict=True))
    ]
    bmesh.ops.delete(bm, geom=inside, context="FACES")
    for f in bm.faces:
        f.smooth = True
    bm.to_mesh(cube.data)
    bm.free()
    # The normals of the rounded box, as a CAD program would export them.
    normals = []
    for face in cube.data.polygons:
        flat = max(abs(c) for c in face.normal) > 1 - 1e-6
        for v in face.vertices:
            away = Vector(
                s * max(s * c - abs(m), 0) for s, c, m in zip((1, -1, 1), cube.data.vertices[v].co, middle, strict=True)
            )
            normals.append(face.normal.copy() if flat else away.normalized())
    cube.data.use_auto_smooth = True
    cube.data.normals_split_custom_set(normals)
    return cube


class Window:
    """What a person does with mouse and keys; positions from the lower left corner."""

    def __init__(self):
        self.window = bpy.context.window_manager.windows[0]
        self.at = None  # the mouse

    def area(self):
        return next(a for a in self.window.screen.areas if a.type == "VIEW_3D")

    def region(self, kind):
        return next(r for r in self.area().regions if r.type == kind)

    def press(self, key, **modifiers):
        x, y = self.at or self.middle()
        self.window.event_simulate(type=key, value="PRESS", x=int(x), y=int(y), **modifiers)
        self.window.event_simulate(type=key, value="RELEASE", x=int(x), y=int(y), **modifiers)

    def move(self, x, y):
        self.at = x, y
        self.window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=int(x), y=int(y))

    def click(self, x, y):
        self.window.event_simulate(type="LEFTMOUSE", value="PRESS", x=int(x), y=int(y))
        self.window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=int(x), y=int(y))

    def middle(self):
        r = self.region("WINDOW")
        return r.x + r.width // 2, r.y + r.height // 2

    def picture(self, name):
        with bpy.context.temp_override(window=self.window, screen=self.window.screen):
            bpy.ops.screen.screenshot(filepath=str(FOLDER / name))


def counts():
    bm = bmesh.from_edit_mesh(bpy.context.view_layer.objects.active.data)
    return len(bm.verts), sum(e.is_boundary for e in bm.edges)


def positions():
    bm = bmesh.from_edit_mesh(bpy.context.view_layer.objects.active.data)
    return [tuple(v.co) for v in bm.verts]


def last_operator():
    operators = bpy.context.window_manager.operators
    return operators[-1] if operators else None


def sheet(name):
    """A bent sheet with a hole of four sides, in edit mode with its rim selected."""
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.select_all(action="DESELECT")
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=14, y_subdivisions=14, size=4)
    ob = bpy.context.object
    ob.name = name
    for v in ob.data.vertices:
        v.co.z = 0.2 * v.co.x**2 - 0.1 * v.co.y**2 + 0.5
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type="EDGE")
    bm = bmesh.from_edit_mesh(ob.data)
    bmesh.ops.delete(bm, geom=[f for f in bm.faces if max(map(abs, f.calc_center_median().xy)) < 0.6], context="FACES")
    bpy.ops.mesh.select_all(action="DESELECT")
    for e in bm.edges:
        e.select = e.is_boundary and max(map(abs, e.verts[0].co.xy)) < 1
    bm.select_flush_mode()
    bmesh.update_edit_mesh(ob.data)
    bpy.ops.ed.undo_push(message=name)
    return ob


def row_from_below(w, number):
    """Over the field of a row of the redo panel, counted from its last."""
    hud = w.region("HUD")
    return hud.x + 200, hud.y + 18 + 23 * number


def refusal_and_correction(w):
    """A method of three sides on a hole of four: the panel says so, and another method fills it."""
    with bpy.context.temp_override(window=w.window, area=w.area(), region=w.region("WINDOW")):
        sheet("Sheet")
        before = counts()
        assert bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True, method="side_vertex", show_advanced=True) == {"FINISHED"}
    yield
    yield
    w.picture("blender-refusal.png")
    assert counts() == before, "nothing but the selection has changed"
    assert "Rim has 4 corners" in last_operator().reasons
    bm = bmesh.from_edit_mesh(bpy.context.view_layer.objects.active.data)
    assert sum(v.select for v in bm.verts) == 4, "the corners are selected"
    place = row_from_below(w, 5)
    w.move(*place)
    yield
    w.click(*place)  # Method
    yield
    w.press("A")  # Auto
    yield
    yield
    w.picture("blender-corrected.png")
    assert last_operator().method == "auto" and last_operator().reasons == ""
    assert counts()[1] < before[1], "filled"
    w.move(*w.middle())
    yield
    w.press("Z", ctrl=True)
    yield
    yield
    assert counts() == before, "one undo step"
    w.press("Z", ctrl=True, shift=True)
    yield
    yield
    assert counts()[1] < before[1]


def repeated_elsewhere(w):
    """Shift R on another mesh chooses anew what was automatic."""
    with bpy.context.temp_override(window=w.window, area=w.area(), region=w.region("WINDOW")):
        sheet("Other")
        before = counts()
        bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True, resolution=0)
    yield
    first = last_operator().resolution
    assert first > 1 and counts()[1] < before[1]
    with bpy.context.temp_override(window=w.window, area=w.area(), region=w.region("WINDOW")):
        ob = sheet("Finer")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.subdivide(number_cuts=1)
        bpy.ops.mesh.select_all(action="DESELECT")
        bm = bmesh.from_edit_mesh(ob.data)
        for e in bm.edges:
            e.select = e.is_boundary and max(map(abs, e.verts[0].co.xy)) < 1
        bmesh.update_edit_mesh(ob.data)
        bpy.ops.ed.undo_push(message="Finer")
        repeated = bpy.context.window_manager.operators[-1]
        assert repeated.bl_idname != "MESH_OT_fill_smooth" or repeated.resolution == first
        bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True)
    yield
    assert (first, last_operator().resolution) == (5, 11), "a third of the edges around, 16 and then 32"


def story():
    """One step between two yields, so that Blender handles the events."""
    w = Window()
    enable_addon()
    cube = rounded_corner()
    yield
    with bpy.context.temp_override(window=w.window, area=w.area(), region=w.region("WINDOW")):
        cube.select_set(True)
        bpy.context.view_layer.objects.active = cube
        bpy.ops.ed.undo_push(message="Rounded corner")
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_mode(type="EDGE")
        bpy.ops.mesh.select_all(action="DESELECT")
        bpy.ops.mesh.select_non_manifold()
        space = w.area().spaces.active
        space.region_3d.view_rotation = Vector((0.9, -1, 0.75)).to_track_quat("Z", "Y")
        space.region_3d.view_distance = 5
        space.shading.type = "SOLID"
        space.shading.light = "MATCAP"
        space.overlay.show_cursor = False
        space.overlay.show_edge_sharp = False
        bpy.ops.ed.undo_push(message="Select")
    yield
    before, hole = counts(), positions()
    assert before[1] == 30, f"a rim of 30 edges, not {before[1]}"

    header = w.region("HEADER")
    w.move(523, header.y + header.height - 14)  # Face
    yield
    w.click(523, header.y + header.height - 14)
    yield
    yield
    w.picture("blender-face-menu.png")
    w.move(590, 487)  # Smooth Fill
    yield
    w.click(590, 487)
    yield
    yield
    filled = counts()
    assert last_operator() and last_operator().bl_idname == "MESH_OT_fill_smooth", "the entry of the Face menu fills"
    assert filled[1] == 0, f"{filled[1]} border edges are left"
    assert filled[0] > before[0]

    hud = w.region("HUD")
    w.click(hud.x + 20, hud.y + hud.height - 10)  # its header
    yield
    yield
    w.picture("blender-redo-panel.png")
    hud = w.region("HUD")
    w.move(hud.x + hud.width - 14, hud.y + hud.height - 62)  # arrow of the second row, Density
    yield
    w.click(hud.x + hud.width - 14, hud.y + hud.height - 62)
    yield
    yield
    w.picture("blender-redo-panel-changed.png")
    assert last_operator().resolution == 11, f"resolution is {last_operator().resolution} after a click on its arrow"
    coarse = counts()
    assert coarse[1] == 0
    assert coarse[0] != filled[0], "the operator ran again with another resolution"

    w.move(*w.middle())
    yield
    w.press("Z", ctrl=True)
    yield
    yield
    assert counts() == before, "undone"
    assert positions() == hole, "undone to the bit"
    w.press("Z", ctrl=True, shift=True)
    yield
    yield
    assert counts() == coarse, "redone"
    w.press("Z", ctrl=True)
    yield
    yield
    w.press("F", ctrl=True, alt=True)
    yield
    yield
    by_key = counts()
    assert by_key[1] == 0 and by_key[0] > before[0], "the key fills"
    w.press("Z", ctrl=True)
    yield
    yield
    assert counts() == before

    w.press("F3")
    yield
    for letter in "smooth fill":
        x, y = map(int, w.middle())
        w.window.event_simulate(type="SPACE" if letter == " " else letter.upper(), value="PRESS", unicode=letter, x=x, y=y)
        w.window.event_simulate(type="SPACE" if letter == " " else letter.upper(), value="RELEASE", x=x, y=y)
    yield
    yield
    w.picture("blender-search.png")
    w.press("RET")
    yield
    yield
    assert last_operator().bl_idname == "MESH_OT_fill_smooth" and counts() == by_key, "the search finds it"
    w.press("Z", ctrl=True)
    yield

    w.window.event_simulate(type="RIGHTMOUSE", value="PRESS", x=int(w.middle()[0]), y=int(w.middle()[1]))
    w.window.event_simulate(type="RIGHTMOUSE", value="RELEASE", x=int(w.middle()[0]), y=int(w.middle()[1]))
    yield
    yield
    w.picture("blender-context-menu.png")
    w.press("ESC")
    yield

    yield from refusal_and_correction(w)
    yield from repeated_elsewhere(w)


steps = story()


def tick():
    try:
        next(steps)
        return STEP
    except StopIteration:
        print("window: all steps passed", flush=True)
        code = 0
    except Exception:
        traceback.print_exc()
        Window().picture("blender-failed.png")
        code = 1
    sys.stdout.flush()
    os._exit(code)  # no question about the unsaved file


bpy.app.timers.register(tick, first_interval=2)
