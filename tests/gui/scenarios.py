"""Scenarios in a Blender window: generators that yield wherever Blender is to handle the events. Each begins with an empty scene
and ends with assertions on the mesh and a picture; pictures are of the window at rest (Window.picture)."""

import importlib
import threading

import bmesh
import bpy
import numpy as np
from hands import FOLDER, ball, clear, counts, jagged_ball, last_operator, mesh, positions, rounded_corner, sheet
from mathutils import Vector

ADDON = "tripatch_blender"
#: Whether parts of a panel are panels themselves.
PANELS = bpy.app.version >= (4, 1)
#: Over the 3D view, in every header of it.
FACE_MENU = (523, 14)


def set_patience(seconds=600.0):
    """How long Blender stands still for a fill before it waits for it awake: a machine that does much else may take seconds for
    fills that are made at once, and the scenarios mean those."""
    importlib.import_module(f"{ADDON}.waiting").PATIENCE = seconds


def _is_filled(before):
    now = counts()
    return now[1] < before[1] and now[0] > before[0]


def _fill_by_key(w):
    w.home()
    w.press("F", ctrl=True, alt=True)
    yield
    yield


def _open_panel(w):
    """By its header, if it is closed."""
    hud = w.region("HUD")
    if hud.height < 100:
        w.click(hud.x + 20, hud.y + hud.height - 10)
        yield
        yield


def face_menu(w):
    """The entry at the end fills."""
    rounded_corner(w)
    before = counts()
    assert before[1] == 30, f"a rim of 30 edges, not {before[1]}"
    yield
    header = w.region("HEADER")
    place = FACE_MENU[0], header.y + header.height - FACE_MENU[1]
    yield from w.click_at(*place)
    yield from w.picture("blender-face-menu")
    yield from w.choose_from_below(3)
    assert last_operator() and last_operator().bl_idname == "MESH_OT_fill_smooth", "the entry of the Face menu fills"
    assert counts()[1] == 0 and _is_filled(before)
    yield from w.picture("filled-from-the-menu")


def _more_density(w):
    """A click on the right arrow of the second row of the panel."""
    hud = w.region("HUD")
    yield from w.click_at(hud.x + hud.width - 14, hud.y + hud.height - 62)


def panel_rows(w):
    """The panel opens; among quads it shows them; an arrow of Density fills again; Sides unfolds."""
    rounded_corner(w)
    yield
    yield from _fill_by_key(w)
    filled = counts()
    assert filled[1] == 0
    yield from _open_panel(w)
    yield from w.picture("blender-redo-panel")
    assert last_operator().computed_output == "quads" and last_operator().rows == 0
    assert all(len(f.verts) == 4 for f in mesh().faces if f.select)
    yield from _more_density(w)
    assert last_operator().rows == 1, f"rows are {last_operator().rows} after a click on their arrow"
    assert last_operator().computed_output == "quads" and counts()[1] == 0 and counts()[0] != filled[0], "filled anew"
    hud = w.region("HUD")
    folded, place = hud.height, (hud.x + 20, hud.y + 18 + 4 * 23)  # the fifth row from below
    yield from w.click_at(*place)
    assert w.region("HUD").height > folded + 20 and (PANELS or last_operator().show_sides)
    yield from w.picture("sides-unfolded")
    hud = w.region("HUD")
    folded = hud.height
    yield from w.click_at(hud.x + 20, hud.y + 18)  # the lowest row
    assert w.region("HUD").height > folded + 60 and (PANELS or last_operator().show_choice), "Candidates unfolds"
    yield from w.picture("candidates-unfolded")


def panel_of_triangles(w):
    """Triangles among quads, for one who chooses them: an arrow of Density fills again, with triangles again."""
    rounded_corner(w)
    with w.override():
        bpy.ops.ed.undo_push(message="Corner")
        bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True, resolution=0, output="triangles")
    yield
    filled = counts()
    assert filled[1] == 0
    yield from _open_panel(w)
    yield from _more_density(w)
    assert last_operator().resolution == 11, f"resolution is {last_operator().resolution} after a click on its arrow"
    assert last_operator().output == "triangles" and counts()[1] == 0 and counts()[0] != filled[0], "filled anew"


def output_for_every_mesh(w):
    """By the key again and again: what one mesh was filled with is not remembered for the next."""
    for name, triangulated, modified, expected in (
        ("Quads", False, False, "quads"),
        ("Again", False, False, "quads"),
        ("Triangles", True, False, "triangles"),
        ("Cage", False, True, "cage"),
        ("After", False, False, "quads"),
        ("Cage again", False, True, "cage"),
    ):
        sheet(w, name)
        with w.override():
            bm = mesh()
            if triangulated:
                bmesh.ops.triangulate(bm, faces=bm.faces)
                bmesh.update_edit_mesh(bpy.context.object.data)
            if modified:
                bpy.context.object.modifiers.new("Subdivision", "SUBSURF")
            bpy.ops.ed.undo_push(message=name)
        before = counts()
        yield
        yield from _fill_by_key(w)
        assert _is_filled(before)
        assert last_operator().computed_output == expected, f"{name}: {last_operator().computed_output}, not {expected}"
        corners = {len(f.verts) for f in mesh().faces if f.select}
        assert corners == ({3} if expected == "triangles" else {4}), f"{name}: {corners}"
    last_operator().output = "triangles"  # as the panel would
    with w.override():
        bpy.ops.ed.undo_redo()
    yield
    assert {len(f.verts) for f in mesh().faces if f.select} == {3}
    sheet(w, "The next")
    yield
    yield from _fill_by_key(w)
    assert last_operator().output == "auto" and last_operator().computed_output == "quads"


def filters(w):
    """With nothing selected the panel has the filters of all holes; one of them keeps the hole out."""
    sheet(w, "Sheet")
    with w.override():
        bpy.ops.mesh.select_all(action="DESELECT")
        bpy.ops.ed.undo_push(message="nothing selected")
    before = counts()
    yield
    yield from _fill_by_key(w)
    assert counts()[1] < before[1], "the hole is filled"
    yield from _open_panel(w)
    hud = w.region("HUD")
    folded = hud.height
    yield from w.click_at(hud.x + 20, hud.y + 18 + 5 * 23)  # the sixth row from below
    hud = w.region("HUD")
    assert hud.height > folded + 60 and (PANELS or last_operator().show_holes), "Holes unfolds"
    yield from w.picture("holes-unfolded")
    if not PANELS:  # the box next to Max Edges, the first row of the part
        yield from w.click_at(hud.x + 131, hud.y + 18 + 9 * 23 - 3)
        yield from w.picture("holes-filtered")
        assert last_operator().use_max_edges, "the filter is on"


def undo_and_redo(w):
    """One step, to the bit."""
    rounded_corner(w)
    before, hole = counts(), positions()
    yield
    yield from _fill_by_key(w)
    filled, surface = counts(), positions()
    assert _is_filled(before)
    w.press("Z", ctrl=True)
    yield
    yield
    assert counts() == before and positions() == hole, "undone to the bit"
    w.press("Z", ctrl=True, shift=True)
    yield
    yield
    assert counts() == filled and positions() == surface, "redone"
    yield from w.picture("redone")


def shaded_at_once(w):
    """In edit mode, right after the fill, a ball is shaded as when the mode has changed."""
    ball(w)
    with w.override():
        w.area().spaces.active.overlay.show_faces = False
    yield
    yield from _fill_by_key(w)
    assert counts()[1] == 0
    stored = [v.normal.copy() for v in mesh().verts]
    at_once = yield from w.picture("ball-right-after-the-fill")
    for mode in ("OBJECT", "EDIT"):
        with w.override():
            bpy.ops.object.mode_set(mode=mode)
        yield
    after = yield from w.picture("ball-after-the-mode-changed")
    assert max(a.angle(v.normal) for a, v in zip(stored, mesh().verts, strict=True)) < 1e-3
    assert np.abs(w.view_of(at_once) - w.view_of(after)).max() < 0.02, "the same shading"


def search(w):
    """F3 finds it by each word of its name, of which one or two are what one would type."""
    rounded_corner(w)
    before = counts()
    yield
    for words in ("hole", "fill", "smooth", "holes smoothly"):
        w.home()
        w.press("F3")
        yield
        w.text(words)
        yield
        yield
        yield from w.picture(f"blender-search-{words.replace(' ', '-')}")
        if words != "holes smoothly":
            w.press("ESC")
            yield
            yield
    w.press("RET")
    yield
    yield
    assert last_operator().bl_idname == "MESH_OT_fill_smooth" and _is_filled(before)


def clean_up_menu(w):
    """Mesh > Clean Up has it below Fill Holes."""
    rounded_corner(w)
    before = counts()
    yield
    w.home()
    with w.override():
        bpy.ops.wm.call_menu(name="VIEW3D_MT_edit_mesh_clean")
    yield
    yield
    yield from w.picture("blender-clean-up-menu")
    yield from w.choose_from_below(1)
    assert last_operator().bl_idname == "MESH_OT_fill_smooth" and _is_filled(before)


def toolbar(w):
    """The tool has an icon of its own."""
    sheet(w, "Sheet")
    with w.override():
        bpy.ops.wm.tool_set_by_id(name="tripatch.shape_fill")
    yield
    yield
    yield from w.picture("blender-toolbar")


def preferences(w):
    """The preferences lead to the documentation and to reports of bugs."""
    import addon_utils

    with w.override():
        bpy.ops.screen.userpref_show("INVOKE_DEFAULT")
    yield
    bpy.context.preferences.active_section = "ADDONS"
    bpy.context.window_manager.addon_search = "TriPatch"
    listed = next(each for each in addon_utils.modules() if each.__name__ == ADDON)  # not the module that runs
    addon_utils.module_bl_info(listed)["show_expanded"] = True
    yield
    yield
    w.shot("blender-preferences", bpy.context.window_manager.windows[-1])


def context_menu(w):
    """The right button's menu has it at the end."""
    sheet(w, "Sheet")
    before = counts()
    yield
    w.home()
    w.press("RIGHTMOUSE")
    yield
    yield
    yield from w.picture("blender-context-menu")
    yield from w.choose_from_below(3)
    assert last_operator().bl_idname == "MESH_OT_fill_smooth" and _is_filled(before)


def refusal_and_correction(w):
    """A method of three sides on a hole of four: the panel says so, and another method fills it, as one undo step."""
    sheet(w, "Sheet")
    before = counts()
    with w.override():
        assert bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True, method="side_vertex", show_advanced=True) == {"FINISHED"}
    yield
    yield
    yield from _open_panel(w)
    yield from w.picture("blender-refusal")
    assert counts() == before, "nothing but the selection has changed"
    assert "the hole has 4" in last_operator().reasons
    assert sum(v.select for v in mesh().verts) == 4, "the corners are selected"
    if PANELS:  # a script cannot open them
        hud = w.region("HUD")
        place = hud.x + 20, hud.y + 45  # Advanced, in the second row
        yield from w.click_at(*place)
        for _ in range(5):  # to its end: with other parts unfolded the panel is higher than the window
            w.press("WHEELDOWNMOUSE")
            yield
        yield from w.picture("blender-refusal-unfolded")
    hud = w.region("HUD")
    place = hud.x + 160, hud.y + 18 + (26 if PANELS else 23) * 11  # Automatic, in the twelfth row from below
    yield from w.click_at(*place)
    yield from w.picture("blender-corrected")
    assert last_operator().method == "auto" and last_operator().reasons == ""
    assert _is_filled(before)
    w.home()
    yield
    w.press("Z", ctrl=True)
    yield
    yield
    assert counts() == before, "one undo step"


def repeated_elsewhere(w):
    """Shift R on another mesh chooses again what was automatic."""
    sheet(w, "Other")
    before = counts()
    with w.override():
        bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True, resolution=0, output="triangles")
    yield
    first = last_operator().resolution
    assert first > 1 and _is_filled(before)
    sheet(w, "Finer", finer=True)
    before = counts()
    yield
    w.home()
    w.press("R", shift=True)
    yield
    yield
    assert last_operator().bl_idname == "MESH_OT_fill_smooth" and _is_filled(before)
    assert last_operator().resolution >= 1.9 * first, "16 edges around, and then 32"
    yield from w.picture("repeated")


def replaced_region(w):
    """Selected faces are replaced by a smooth surface."""
    sheet(w, "Sheet", whole=True)
    with w.override():
        bpy.ops.mesh.select_mode(type="FACE")
        bm = mesh()
        rough = [f for f in bm.faces if max(map(abs, f.calc_center_median().xy)) < 0.6]
        for f in rough:
            f.select = True
        for v in {v for f in rough for v in f.verts if all(g in rough for g in v.link_faces)}:
            v.co.z -= 0.4
        bmesh.update_edit_mesh(bpy.context.object.data)
        bpy.ops.ed.undo_push(message="Select")
    before = counts()
    yield
    yield from w.picture("region-before")
    yield from _fill_by_key(w)
    yield from w.picture("region-replaced")
    off = [v.co.z - (0.2 * v.co.x**2 - 0.1 * v.co.y**2 + 0.5) for v in mesh().verts]
    assert counts()[1] == before[1] and max(map(abs, off)) < 5e-3, "on the surface that was there before the dent"


def cage(w):
    """Under a Subdivision modifier a cage is made, and the panel says so."""
    rounded_corner(w, segments=2)
    bpy.context.object.modifiers.new("Subdivision", "SUBSURF").levels = 3
    before = counts()
    yield
    yield from _fill_by_key(w)
    yield from w.picture("cage")
    assert last_operator().computed_output == "cage" and last_operator().rows >= 0
    assert counts()[1] == 0 and _is_filled(before)
    assert all(len(f.verts) == 4 for f in mesh().faces if f.select)


def points_inside(w):
    """Loose vertices and an edge in a hole, selected with its rim, become the fill's own; undo brings them back."""
    rounded_corner(w)
    with w.override():
        bm = mesh()
        rim = [v for v in bm.verts if v.is_boundary]
        middle = sum((v.co for v in rim), Vector()) / len(rim)
        out = sum((v.normal for v in rim), Vector()).normalized()
        along = (rim[0].co - middle).normalized() * 0.1
        made = [bm.verts.new(middle + by * along + 0.35 * out) for by in (-1, 1)]
        bm.edges.new(made)
        for element in (*rim, *made, *(e for e in bm.edges if e.is_boundary or e.is_wire)):
            element.select = True
        bm.select_flush_mode()
        bmesh.update_edit_mesh(bpy.context.object.data)
        bpy.ops.ed.undo_push(message="Points")
        places = [v.co.copy() for v in made]
    before = counts()
    yield
    yield from w.picture("points-inside")
    yield from _fill_by_key(w)
    yield from w.picture("points-met")
    bm = mesh()
    assert not any(v.is_wire or not v.link_faces for v in bm.verts), "nothing is left loose"
    assert all(any((v.co - place).length < 1e-6 for v in bm.verts) for place in places) and _is_filled(before)
    w.press("Z", ctrl=True)
    yield
    yield
    assert counts() == before and sum(not v.link_faces for v in mesh().verts) == 2, "one undo step"


def _tool(w):
    """Chooses the workspace tool; returns the module that has its hole."""
    with w.override():
        bpy.ops.wm.tool_set_by_id(name="tripatch.shape_fill")
    return importlib.import_module(f"{ADDON}.shaping_view")


def _drag(w, start, end, steps=6, cancel=False):
    """By the left button, in steps; what takes long is shown in between."""
    w.move(*start)
    yield
    yield
    w.event("LEFTMOUSE", "PRESS")
    yield
    for k in range(1, steps + 1):
        w.move(*(a + (b - a) * k / steps for a, b in zip(start, end, strict=True)))
        yield
    if cancel:
        w.press("ESC")
        yield
    w.event("LEFTMOUSE", "RELEASE")
    yield


def gizmos(w):
    """Click a hole, drag a corner, drag an arrow, Enter: one undo step."""
    rounded_corner(w)
    before = counts()
    tool, shaping = _tool(w), importlib.import_module(f"{ADDON}.shaping")
    yield
    bm = mesh()
    rim = next(v for v in bm.verts if v.is_boundary)
    w.move(*w.on_screen(rim.co))
    yield
    w.click()
    yield
    yield
    made = tool.current()
    assert made is not None, "a click beside a rim chooses its hole"
    assert counts() == before
    yield from w.picture("gizmos")
    corner = made.shape.corners[0]
    yield from _drag(w, w.on_screen(made.points[corner]), w.on_screen(made.points[(corner + 3) % len(made.points)]))
    assert made.shape.corners[0] == corner + 3, f"the corner is at {made.shape.corners[0]}, not {corner + 3}"
    yield from w.picture("corner-dragged")
    across = w.on_screen(made.points[corner + 3]), w.on_screen(made.points[corner])
    yield from _drag(w, *across, cancel=True)
    assert made.shape.corners[0] == corner + 3, "escape brings back what was before the drag"
    yield from _drag(w, *across)
    _, point, direction = made.side_handles()[0]
    tip = point + direction * made.shape.bulges[0] * shaping.ARROW * made.size  # the box at the end of the arrow
    yield from _drag(w, w.on_screen(tip), w.on_screen(tip + direction * shaping.ARROW * made.size))
    bulges = made.shape.bulges
    yield from w.picture("arrow-dragged")
    assert bulges[0] > 1.5, f"the arrow changes its side's bulge: {bulges}"
    pulled = bulges[0]
    tip = point + direction * pulled * shaping.ARROW * made.size
    yield from _drag(w, w.on_screen(tip), w.on_screen(tip - 0.3 * direction * shaping.ARROW * made.size))
    again = made.shape.bulges[0]
    assert abs(again - pulled) > 0.1, "it is pulled once more"
    w.home()
    for shift, wanted in ((False, pulled), (False, 1.0), (True, pulled), (True, again), (False, pulled)):
        w.press("Z", ctrl=True, shift=shift)
        yield
        yield
        assert tool.current() is made and counts() == before, "the shape is undone, not the mesh"
        assert made.shape.bulges[0] == wanted, f"shift {shift}: {made.shape.bulges}"
    w.move(*w.on_screen(made.points[0]))
    yield
    w.click()
    yield
    yield
    assert tool.current() is made, "a click on the hole that is shaped keeps its shape"
    w.home()
    w.press("RET")
    yield
    yield
    assert tool.current() is None and counts()[1] == 0 and _is_filled(before)
    yield from w.picture("filled-as-shaped")
    w.press("Z", ctrl=True)
    yield
    yield
    assert counts() == before, "one undo step"


def continuity_labels(w):
    """A click on the label of a side takes the next continuity there; Enter inserts that fill."""
    rounded_corner(w)
    tool, shaping = _tool(w), importlib.import_module(f"{ADDON}.shaping")
    with w.override():
        bpy.ops.mesh.shape_fill()
    yield
    yield
    made = tool.current()
    before = made.continuities()
    assert len(before) == 3, before
    yield from w.picture("labels")
    with w.override():
        place, text = tool.label_places(bpy.context)[0]
    assert text == before[0]
    w.move(*w.on_screen(place))
    yield
    yield
    w.event("LEFTMOUSE", "PRESS")
    yield
    w.event("LEFTMOUSE", "RELEASE")
    yield
    yield
    assert tool.current() is made, "no other hole was chosen"
    now = made.continuities()
    assert now[0] != before[0] and now[0] in shaping.CONTINUITIES and now[1:] == before[1:], (before, now)
    yield from w.picture("label-clicked")
    shown = made.surface()
    w.home()
    w.press("RET")
    yield
    yield
    assert tool.current() is None
    found, expected = _inserted(shown)
    assert np.abs(found.mean(axis=1) - expected.mean(axis=1)).max() < 1e-5 * made.size
    yield from w.picture("filled-with-label")


def smooth_fill_node(w):
    """The node is in the Add menu, fills the hole of the modifier's input, and follows when a number is changed."""
    ball(w)
    with w.override():
        bpy.ops.object.mode_set(mode="OBJECT")
    ob = bpy.context.view_layer.objects.active
    versions = importlib.import_module(f"{ADDON}.versions")
    tree = bpy.data.node_groups.new("Fill", "GeometryNodeTree")
    versions.new_sockets(tree, {"Geometry": "Geometry"})
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    start.location, end.location = (-250, 0), (250, 0)
    tree.links.new(start.outputs[0], end.inputs[0])
    ob.modifiers.new("Fill", "NODES").node_group = tree
    area = next(a for a in w.window.screen.areas if a.type == "PROPERTIES")
    was, area.type = area.ui_type, "NODE_EDITOR"
    area.ui_type = "GeometryNodeTree"
    area.spaces.active.node_tree = tree
    yield
    region = next(r for r in area.regions if r.type == "WINDOW")
    with bpy.context.temp_override(window=w.window, area=area, region=region):
        bpy.ops.node.view_all()
        bpy.ops.node.add_node(type="TriPatchSmoothFillNode", use_transform=False)
    yield
    node = next(n for n in tree.nodes if n.bl_idname == "TriPatchSmoothFillNode")
    tree.links.new(start.outputs[0], node.inputs[0])
    tree.links.new(node.outputs[0], end.inputs[0])
    node.location = (0, 0)

    def faces():
        return len(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.polygons)

    for _ in range(8):
        yield
        if faces() > len(ob.data.polygons):
            break
    plain = faces()
    assert plain > len(ob.data.polygons), "the hole is filled"
    with bpy.context.temp_override(window=w.window, area=area, region=region):
        bpy.ops.node.view_all()
    yield from w.picture("smooth-fill-node")
    node.inputs["Density"].default_value = 6
    for _ in range(8):
        yield
        if faces() != plain:
            break
    assert faces() > plain, "it follows its numbers"
    yield from w.picture("smooth-fill-node-denser")
    with bpy.context.temp_override(window=w.window, area=area, region=region):
        bpy.ops.wm.call_menu(name="NODE_MT_add")
    yield
    yield
    yield from w.picture("smooth-fill-node-menu")
    w.press("ESC")
    yield
    area.ui_type = was
    yield


def _inserted(made):
    """Ends of the edges of the faces that Enter has inserted, and of those that were shown, in one order."""
    vertices, _, edges = made
    found = np.array([[tuple(v.co) for v in e.verts] for e in {e for f in mesh().faces if f.select for e in f.edges}])
    shown = vertices[edges]
    nearest = np.linalg.norm(shown.mean(axis=1)[:, None] - found.mean(axis=1)[None], axis=2).argmin(axis=1)
    return found[nearest], shown


def preview_is_the_result(w):
    """While an arrow is held what is shown is the fill that Enter inserts, on holes for a patch, rows, and the surface around."""
    for name, make in (("corner", rounded_corner), ("sheet", lambda w: sheet(w, "Sheet")), ("ball", jagged_ball)):
        make(w)
        tool, shaping = _tool(w), importlib.import_module(f"{ADDON}.shaping")
        with w.override():
            bpy.ops.mesh.shape_fill()
        yield
        yield
        made = tool.current()
        plain = made.fill
        _, point, direction = made.side_handles()[0]
        reach = shaping.ARROW * made.size
        tip = point + direction * made.shape.bulges[0] * reach
        w.move(*w.on_screen(tip))
        yield
        yield
        w.event("LEFTMOUSE", "PRESS")
        yield
        for k in range(1, 7):
            w.move(*w.on_screen(tip + direction * reach * k / 6))
            yield
        while not made.is_shown:  # a fill that takes long waits until the mouse rests
            yield
        yield from w.picture(f"held-{name}")
        held = made.surface()
        assert made.shape.bulges[0] > 1.5 and made.fill is not plain, name
        w.event("LEFTMOUSE", "RELEASE")
        yield
        w.home()
        w.press("RET")
        yield
        yield
        assert tool.current() is None, name
        found, shown = _inserted(held)
        assert np.abs(found.mean(axis=1) - shown.mean(axis=1)).max() < 1e-5 * made.size, name
        yield from w.picture(f"inserted-{name}")
        clear(w)
        yield


def tool_left(w):
    """Esc leaves the hole as it was."""
    sheet(w, "Sheet")
    before, hole = counts(), positions()
    tool = _tool(w)
    with w.override():
        bpy.ops.mesh.shape_fill()
    yield
    yield
    shown = w.view_of((yield from w.picture("preview")))
    assert tool.current() is not None and counts() == before
    w.home()
    w.press("ESC")
    yield
    yield
    left = w.view_of((yield from w.picture("tool-left")))
    assert tool.current() is None and positions() == hole
    assert np.abs(shown - left).max() > 0.1, "the preview has gone"


def _filled_sheet(w):
    sheet(w, "Sheet")
    with w.override():
        bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True)


def overlay_on_and_off(w):
    """Stripes on the surface, and nothing of them afterwards."""
    _filled_sheet(w)
    yield
    yield
    plain, before = w.view_of((yield from w.picture("overlay-before"))), positions()
    settings = bpy.context.window_manager.tripatch_overlay
    settings.surface, settings.show = "ZEBRA", True
    yield
    yield
    striped = w.view_of((yield from w.picture("overlay-zebra")))
    light, dark = striped.min(axis=-1) > plain.max(axis=-1) + 0.2, striped.max(axis=-1) < plain.min(axis=-1) - 0.2
    assert min(light.mean(), dark.mean()) > 0.02, "stripes"
    settings.surface = "CURVATURE"
    yield
    yield
    colored = w.view_of((yield from w.picture("overlay-curvature")))
    assert (np.ptp(colored, axis=-1) > 0.25).mean() > 0.02, "colors"
    settings.show = False
    yield
    yield
    after = w.view_of((yield from w.picture("overlay-after")))
    assert np.abs(after - plain).max() < 0.02, "nothing is left"
    assert positions() == before


def overlay_in_the_sidebar(w):
    """Its panel is in the sidebar, behind a tab, and a click on it shows stripes."""
    _filled_sheet(w)
    yield
    w.home()
    w.press("N")
    yield
    yield
    region = w.region("UI")
    assert region.width > 100
    settings = bpy.context.window_manager.tripatch_overlay
    settings.surface = "ZEBRA"
    yield from w.click_at(region.x + region.width - 10, region.y + region.height - 170)  # the tab
    yield from w.picture("sidebar")
    yield from w.click_at(region.x + 20, region.y + region.height - 42)  # the first row
    assert settings.show, "switched on by the click"
    yield
    yield from w.picture("sidebar-on")
    settings.show = False
    panel = importlib.import_module(f"{ADDON}.overlay").VIEW3D_PT_tripatch_quality
    assert panel.is_registered and panel.bl_category == "TriPatch"
    w.press("N")
    yield
    assert counts()[1] == 56, "the outer border of the sheet"


def _filling():
    return any(thread.name == "TriPatch" for thread in threading.enumerate())


def _until_filled():
    """Waits for a long fill; then none is waited for by hand any more."""
    for _ in range(3000):
        yield 0.1
        if not _filling():
            break
    set_patience()
    yield
    yield


def long_fill(w):
    """Blender stays awake and says how far it is; Esc ends it; one that is waited for is one undo step."""
    sheet(w, "Sheet")
    before, hole = counts(), positions()
    set_patience(0.1)
    with w.override():
        assert bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True, resolution=1000) == {"RUNNING_MODAL"}
    yield
    yield
    w.shot("long-fill")
    assert _filling() and positions() == hole
    w.home()
    w.press("A")
    yield
    assert sum(v.select for v in mesh().verts) == 16, "the mesh is left alone meanwhile"
    w.press("ESC")
    yield
    yield
    assert not _filling() and positions() == hole and counts() == before
    w.press("A")
    yield
    assert all(v.select for v in mesh().verts), "Blender is free again"
    w.press("Z", ctrl=True)
    yield
    with w.override():
        assert bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True, resolution=300) == {"RUNNING_MODAL"}
    yield from _until_filled()
    assert _is_filled(before) and last_operator().resolution == 300
    w.press("Z", ctrl=True)
    yield
    yield
    assert counts() == before, "one undo step"


def long_redo(w):
    """What the panel asks for and takes long is waited for too: Esc keeps what was, or it takes its place, as one undo step."""
    sheet(w, "Sheet")
    with w.override():
        bpy.ops.ed.undo_push(message="Sheet")  # to which the last step goes back
    before = counts()
    with w.override():
        bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True, output="triangles")
    yield
    filled = counts()
    assert _is_filled(before)
    set_patience(0.1)
    last_operator().resolution = 1000
    with w.override():
        bpy.ops.ed.undo_redo()
    yield
    yield
    w.shot("long-redo")
    assert _filling() and counts() == filled, "the fill of before stands meanwhile"
    w.press("ESC")
    yield
    yield
    assert not _filling() and counts() == filled
    last_operator().resolution = 300
    with w.override():
        bpy.ops.ed.undo_redo()
    yield
    yield from _until_filled()
    assert _is_filled(before) and counts()[0] > filled[0] and last_operator().resolution == 300
    last_operator().resolution = 4
    with w.override():
        bpy.ops.ed.undo_redo()
    yield
    assert _is_filled(before) and counts()[0] < filled[0] + 100, "what is quick is made at once"
    w.press("Z", ctrl=True)
    yield
    yield
    assert counts() == before, "one undo step"


def _live(w):
    """A sheet with a live fill; returns the fill's name."""
    sheet(w, "Sheet")
    with w.override():
        bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True, keep_live=True)
    return next(ob.name for ob in bpy.data.objects if ob.name != "Sheet")


def _heights(name):
    return np.array([v.co.z for v in bpy.data.objects[name].data.vertices])


def _constituents():
    """Three surfaces over one hole, of different heights, in object mode."""
    corners = [Vector((1.2 * np.cos(a), 1.2 * np.sin(a), 0)) for a in np.radians((90, 210, 330))]
    made = []
    for i, high in enumerate((1.6, 0.2, 0.2)):
        a, b, opposite = corners[(i + 1) % 3], corners[(i + 2) % 3], corners[i]
        curve = bpy.data.curves.new("ABC"[i], "SURFACE")
        ob = bpy.data.objects.new("ABC"[i], curve)
        bpy.context.collection.objects.link(ob)
        for k in range(4):
            spline = curve.splines.new("NURBS")
            spline.points.add(3)
            for j, point in enumerate(spline.points):
                co = a + (b - a) * j / 3 + (opposite - (a + b) / 2) * k / 3 + Vector((0, 0, high * min(k, 1)))
                point.co, point.select = (*co, 1), True
        bpy.ops.object.select_all(action="DESELECT")
        bpy.context.view_layer.objects.active = ob
        ob.select_set(True)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.curve.make_segment()
        bpy.ops.object.mode_set(mode="OBJECT")
        for spline in curve.splines:
            spline.use_endpoint_u = spline.use_endpoint_v = True
            spline.order_u = spline.order_v = 4
        made.append(ob)
    return made


def blended_patches(w):
    """Three surfaces are blended; a handle is dragged, and letting it go is one step of undo."""
    blending = importlib.import_module(f"{ADDON}.blending")
    with w.override():
        surfaces = _constituents()
        bpy.ops.ed.undo_push(message="Surfaces")
        for ob in surfaces:
            ob.select_set(True)
        bpy.ops.object.blend_three_patches("INVOKE_DEFAULT", True)
        for ob in surfaces:
            ob.hide_set(True)
        bpy.ops.ed.undo_push(message="Hide")
        bpy.context.space_data.show_region_ui = True
        bpy.ops.view3d.view_all()
    yield
    yield
    name = bpy.context.view_layer.objects.active.name
    before = _heights(name)
    yield from w.picture("blend")
    start, end = blending.tracks(bpy.data.objects[name])[0]
    yield from _drag(w, w.on_screen(start.lerp(end, 0.5)), w.on_screen(start.lerp(end, 0.15)))
    yield
    yield from w.picture("blend-weighed")
    weight = bpy.data.objects[name].tripatch_lambda[0]
    assert weight < 0.4, f"the handle moves its weight: {weight:.2f}"
    assert np.abs(_heights(name) - before).max() > 0.02, "the surface follows"
    w.home()
    w.press("Z", ctrl=True)
    yield
    yield
    yield
    yield from w.picture("blend-undone")
    assert np.abs(_heights(name) - before).max() < 1e-5, "one undo step"
    assert list(bpy.data.objects[name].tripatch_lambda) == [0.5] * 3
    with w.override():
        bpy.context.space_data.show_region_ui = False


def live_fill(w):
    """Vertices are moved by hand, and the fill follows."""
    fill = _live(w)
    yield
    yield
    yield from w.picture("live-fill")
    before = _heights(fill)
    w.home()
    w.press("N")
    yield
    yield
    region = w.region("UI")
    yield from w.click_at(region.x + region.width - 10, region.y + region.height - 170)  # the tab
    yield from w.picture("live-fill-listed")
    w.home()
    w.press("N")
    yield
    yield
    with w.override():
        bpy.ops.mesh.select_all(action="DESELECT")
        bm = mesh()
        for v in bm.verts:
            v.select = v.is_boundary and v.co.x > 0.5 and max(map(abs, v.co.xy)) < 1
        bm.select_flush(True)
        bmesh.update_edit_mesh(bpy.context.object.data)
        bpy.ops.ed.undo_push(message="Select")
    yield
    w.press("G")
    yield
    w.press("Z")
    yield
    w.text("0.5")
    yield
    w.press("RET")
    yield
    yield
    yield
    yield from w.picture("live-fill-followed")
    after = _heights(fill)
    assert after.max() > before.max() + 0.2, f"it follows: {before.max():.2f}, {after.max():.2f}"
    w.press("Z", ctrl=True)
    yield
    yield
    yield
    assert abs(_heights(fill).max() - before.max()) < 1e-3, "undone"


def live_fill_played(w):
    """While an animation plays the fill follows a keyed shape key."""
    sheet(w, "Sheet")
    ob = bpy.data.objects["Sheet"]
    bpy.ops.object.mode_set(mode="OBJECT")
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Up")
    for point in key.data:
        point.co.z += 1
    for frame, key.value in ((1, 0), (24, 1)):
        key.keyframe_insert("value", frame=frame)
    ob.active_shape_key_index, bpy.context.scene.frame_end = 0, 200
    bpy.context.scene.frame_set(1)
    bpy.ops.object.mode_set(mode="EDIT")
    with w.override():
        bpy.ops.mesh.fill_smooth("INVOKE_DEFAULT", True, keep_live=True)
        bpy.ops.object.mode_set(mode="OBJECT")
    fill = next(each.name for each in bpy.data.objects if each.name != "Sheet")
    yield
    yield
    before = _heights(fill)
    w.home()
    w.press("SPACE")
    for _ in range(60):
        yield
        if bpy.context.scene.frame_current >= 30:
            break
    yield
    yield
    assert np.abs(_heights(fill) - before - 1).max() < 1e-3, "it follows what is played"
    w.press("SPACE")
    yield
    bpy.data.meshes.remove(ob.data)  # a file that is saved would have its keys without it


def save_and_reopen(w):
    """A live fill continues to follow in a file that is opened again."""
    from hands import FOLDER

    fill = _live(w)
    yield
    before, path = _heights(fill), str(FOLDER / "saved.blend")
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    # A file is opened by a key: from a timer Blender waits for ever.
    keymap = bpy.context.window_manager.keyconfigs.addon.keymaps.new(name="Window")
    item = keymap.keymap_items.new("wm.open_mainfile", "F19", "PRESS")
    item.properties.filepath, item.properties.display_file_selector, item.properties.load_ui = path, False, False
    clear(w)
    yield
    w.home()
    w.press("F19")
    yield
    yield
    yield
    assert np.allclose(_heights(fill), before)
    yield from w.picture("reopened")
    for v in bpy.data.objects["Sheet"].data.vertices:
        v.co.z += 0.25
    bpy.data.objects["Sheet"].data.update()
    yield
    yield
    yield
    yield from w.picture("reopened-and-followed")
    assert np.abs(_heights(fill) - before - 0.25).max() < 1e-3, "it follows"


def status_bar(w):
    """What a fill reports stands in the status bar, for whoever has a window that is active."""
    from hands import STATUS_BAR, give_focus, screen

    def text():
        return screen()[-STATUS_BAR:, 600:-100].astype(int)

    bpy.context.preferences.system.viewport_aa = "OFF"  # one drawing after each change, not eight
    rounded_corner(w)
    give_focus()
    yield
    yield from w.picture("status-bar-before")
    before, seen = text(), False
    w.home()
    for _ in range(8):  # it is there for five seconds, in which a machine that does much else may not draw at all
        w.press("F", ctrl=True, alt=True)
        for _ in range(50):
            yield 0.1
            seen = (np.abs(text() - before).max(axis=-1) > 50).mean() > 0.01
            if seen:
                break
        if seen:
            break
        assert counts()[1] == 0
        w.press("Z", ctrl=True)
        yield
    assert seen, "no text in the status bar"
    w.shot("status-bar")
    bpy.context.preferences.system.viewport_aa = "8"
    assert counts()[1] == 0


def switched_off(w):
    """The tool's keys go with the add-on, and come back with it."""
    import addon_utils

    def keys():
        configurations = bpy.context.window_manager.keyconfigs
        configurations.update()
        return {each.name: len(k.keymap_items) for each in configurations for k in each.keymaps if "Shape Fill" in k.name}

    before = keys()
    assert len(before) == 3, before
    for _ in range(2):
        addon_utils.disable(ADDON)
        yield
        assert not keys(), keys()
        assert addon_utils.enable(ADDON)
        yield
        assert keys() == before, keys()


def moving_picture(w):
    """The pictures of which scripts/moving_picture makes the animation of the README: a hole is filled by the menu, and its Bulge
    is changed. The file `frames` has their names, where the mouse is, and for how many hundredths of a second each is shown."""
    rounded_corner(w)
    frames = []

    def frame(name, at, shown=25):
        yield from w.picture(name)
        frames.append((f"{name}.png", *map(round, at), shown))

    rest = 760, 330
    w.move(*rest)
    yield from frame("frame-hole", rest, 130)
    header = w.region("HEADER")
    face = FACE_MENU[0], header.y + header.height - FACE_MENU[1]
    yield from w.click_at(*face)
    entry = 590, 295
    w.move(*entry)
    yield
    yield from frame("frame-menu", entry, 150)
    yield from w.click_at(*entry)
    yield from _open_panel(w)
    hud = w.region("HUD")
    bulge = hud.x + 0.69 * hud.width, hud.y + hud.height - 112
    yield from frame("frame-filled", entry, 130)
    values = ("1.3", "1.6", "2", "2.5", "1.6", "1", "0.5", "0.1", "0.5", "1")
    for k, value in enumerate(values):
        yield from w.click_at(*bulge)
        w.text(value)
        w.press("RET")
        yield
        assert abs(last_operator().bulge - float(value)) < 1e-6, (last_operator().bulge, value)
        yield from frame(f"frame-bulge-{k}", bulge, 80 if value in ("2.5", "0.1", "1") else 22)
    (FOLDER / "frames").write_text("\n".join(" ".join(map(str, each)) for each in frames) + "\n")


#: Made by name only.
PICTURES = [moving_picture]
ALL = [
    face_menu,
    filters,  # before others unfold more of the panel
    panel_rows,
    panel_of_triangles,
    output_for_every_mesh,
    undo_and_redo,
    shaded_at_once,
    search,
    clean_up_menu,
    toolbar,
    preferences,
    context_menu,
    refusal_and_correction,
    repeated_elsewhere,
    replaced_region,
    points_inside,
    cage,
    gizmos,
    continuity_labels,
    smooth_fill_node,
    preview_is_the_result,
    tool_left,
    overlay_on_and_off,
    overlay_in_the_sidebar,
    status_bar,
    long_fill,
    long_redo,
    blended_patches,
    switched_off,
    live_fill_played,
    live_fill,
    save_and_reopen,  # the last: the window has another file then
]
