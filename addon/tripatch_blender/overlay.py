# SPDX-License-Identifier: GPL-3.0-or-later
"""The overlay that shows the quality of surfaces: its settings, what it draws, where it is switched on."""

import traceback
from typing import Any

import blf
import bpy
import gpu
from bpy.app.handlers import persistent
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, PointerProperty
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Matrix, Vector

from . import library, panel, shown, versions
from .library import np

# Towards the eye, of the depth between the clipping planes: enough not to flicker with the surface that Blender draws.
_LIFT = 2e-5

_VERTEX = """
void main()
{
  normal_of_surface = normal;
  color_of_surface = color;
  to_eye = (eye.w > 0.5) ? eye.xyz - position : eye.xyz;
  gl_Position = view_projection * vec4(position, 1.0);
  gl_Position.z -= lift * gl_Position.w;
}
"""
# The stripes of tripatch.quality.stripes, sharp to a pixel. Where a surface is colored (folds), the color goes first.
_FRAGMENT = """
void main()
{
  vec3 n = normalize(normal_of_surface);
  vec3 v = normalize(to_eye);
  if (dot(n, v) < 0.0) {
    n = -n;
  }
  if (color_of_surface.a > 0.5) {
    float light = (kind < 0.5) ? 1.0 : 0.35 + 0.65 * abs(dot(n, v));
    result = vec4(color_of_surface.rgb * light, opacity);
    return;
  }
  if (kind < 0.5) {
    discard;
  }
  vec3 seen = (kind < 1.5) ? 2.0 * dot(n, v) * n - v : n;
  float phase = stripes.w * acos(clamp(dot(seen, stripes.xyz), -1.0, 1.0)) / 3.14159265;
  float width = max(fwidth(phase), 1e-6);
  float wave = abs(fract(phase) - 0.5);
  float edge = (kind < 1.5) ? 0.25 : 0.08;
  float dark = clamp(0.5 + (edge - wave) / width, 0.0, 1.0);
  result = vec4(vec3(mix(0.92, 0.04, dark)), opacity);
}
"""
_KIND = {"NONE": 0.0, "CURVATURE": 0.0, "DEVIATION": 0.0, "ZEBRA": 1.0, "HIGHLIGHT": 2.0}


def _shader():
    """Compiled when it is first drawn."""
    if _state.shader is None:
        info, between = gpu.types.GPUShaderCreateInfo(), gpu.types.GPUStageInterfaceInfo("tripatch_overlay")
        between.smooth("VEC3", "normal_of_surface")
        between.smooth("VEC3", "to_eye")
        between.smooth("VEC4", "color_of_surface")
        for kind, name in (("MAT4", "view_projection"), ("VEC4", "eye"), ("VEC4", "stripes")):
            info.push_constant(kind, name)
        for name in ("kind", "opacity", "lift"):
            info.push_constant("FLOAT", name)
        for place, (kind, name) in enumerate((("VEC3", "position"), ("VEC3", "normal"), ("VEC4", "color"))):
            info.vertex_in(place, kind, name)
        info.vertex_out(between)
        info.fragment_out(0, "VEC4", "result")
        info.vertex_source(_VERTEX)
        info.fragment_source(_FRAGMENT)
        _state.shader = gpu.shader.create_from_info(info)
    return _state.shader


class Drawn:
    """One object on the graphics card."""

    def __init__(self, made, turn):
        self.made, self.turn = made, turn
        self.surface = self.lines = None
        if made.colors is not None or made.normals is not None:
            count = len(made.positions)
            form = gpu.types.GPUVertFormat()
            values = {"position": made.positions, "normal": made.normals, "color": made.colors}
            for name, width in (("position", 3), ("normal", 3), ("color", 4)):
                form.attr_add(id=name, comp_type="F32", len=width, fetch_mode="FLOAT")
                if values[name] is None:
                    values[name] = np.zeros((count, width), np.float32)
                    values[name][:, 2:3] = width == 3  # any normal will do for plain colors
            buffer = gpu.types.GPUVertBuf(form, count)
            for name, array in values.items():
                buffer.attr_fill(name, np.ascontiguousarray(array, np.float32))
            self.surface = gpu.types.GPUBatch(type="TRIS", buf=buffer)
        if len(made.lines):
            form = gpu.types.GPUVertFormat()
            form.attr_add(id="pos", comp_type="F32", len=3, fetch_mode="FLOAT")
            form.attr_add(id="color", comp_type="F32", len=4, fetch_mode="FLOAT")
            buffer = gpu.types.GPUVertBuf(form, len(made.lines))
            buffer.attr_fill("pos", made.lines)
            buffer.attr_fill("color", made.line_colors)
            self.lines = gpu.types.GPUBatch(type="LINES", buf=buffer)
        made.positions = made.normals = made.colors = None  # on the card now


class _State:
    """Of the overlay while it is on."""

    def __init__(self):
        self.shader: Any = None
        self.handles, self.drawn, self.changed = [], {}, set()

    def on(self):
        return bool(self.handles)


_state = _State()


def _objects(context):
    """Those whose surfaces are shown: the selected ones, those in edit mode and the active one."""
    chosen = {ob.name: ob for ob in context.selected_objects if ob.type in ("MESH", "SURFACE")}
    active = context.view_layer.objects.active
    if active is not None and active.type in ("MESH", "SURFACE") and active.visible_get():
        chosen[active.name] = active
    if context.mode == "EDIT_MESH":
        chosen |= {ob.name: ob for ob in context.objects_in_mode}
    return chosen


def _drawn(ob, depsgraph, settings):
    """What is on the card for an object, made again where it has changed; None where there is nothing."""
    turn = [tuple(row[:3]) for row in ob.matrix_world][:3]
    known = _state.drawn.get(ob.name)
    stale = ob.name in _state.changed or (ob.data and ob.data.name in _state.changed)
    if known is None or stale or (known and known.turn != turn):
        made = shown.of_object(ob, depsgraph, settings)
        known = _state.drawn[ob.name] = Drawn(made, turn) if made else False
    return known or None


def _draw_surface():
    """In every 3D view, after the scene."""
    try:
        context = bpy.context
        settings, space = context.window_manager.tripatch_overlay, context.space_data
        if space is None or space.type != "VIEW_3D" or not space.overlay.show_overlays:
            return
        depsgraph, view = context.evaluated_depsgraph_get(), context.region_data
        chosen = _objects(context)
        current = [(ob, _drawn(ob, depsgraph, settings)) for ob in chosen.values()]
        _state.changed.clear()
        for name in set(_state.drawn) - set(chosen):
            del _state.drawn[name]
        gpu.state.depth_test_set("LESS_EQUAL")
        gpu.state.blend_set("ALPHA")
        for ob, drawn in current:
            if drawn:
                _draw_one(drawn, ob.matrix_world.translation, view, settings)
        gpu.state.depth_test_set("NONE")
        gpu.state.blend_set("NONE")
    except Exception:  # one that leaves a callback would come again with every frame
        traceback.print_exc()
        stop()


def draw_colored(drawn, place, view):
    """A surface that has its own colors, lit, with lines."""
    _draw_one(drawn, place, view, _PLAIN)


class _PLAIN:  # settings of an overlay whose colors are lit, as those on stripes are
    surface, direction, density, opacity = "ZEBRA", (0, 0, 1), 1, 1.0


def _draw_one(drawn, place, view, settings):
    matrix = view.perspective_matrix @ Matrix.Translation(place)
    inverse = view.view_matrix.inverted()
    if drawn.surface:
        shader = _shader()
        shader.bind()
        shader.uniform_float("view_projection", matrix)
        eye = (*(inverse.translation - place), 1.0) if view.is_perspective else (*inverse.col[2][:3], 0.0)
        shader.uniform_float("eye", eye)
        shader.uniform_float("stripes", (*Vector(settings.direction).normalized(), settings.density))
        shader.uniform_float("kind", _KIND[settings.surface])
        shader.uniform_float("opacity", settings.opacity)
        shader.uniform_float("lift", _LIFT)
        drawn.surface.draw(shader)
    if drawn.lines:
        shader, region = gpu.shader.from_builtin(versions.line_shader()), bpy.context.region
        gpu.matrix.push()
        gpu.matrix.translate(place)
        shader.bind()
        shader.uniform_float("viewportSize", (region.width, region.height))
        shader.uniform_float("lineWidth", 5.0)
        gpu.state.depth_test_set("NONE")
        drawn.lines.draw(shader)
        gpu.state.depth_test_set("LESS_EQUAL")
        gpu.matrix.pop()


def told():
    """Sentences on what is shown, one a line."""
    several = len(_state.drawn) > 1
    return [f"{name}: {line}" if several else line for name, drawn in _state.drawn.items() if drawn for line in drawn.made.told]


def _write(text, x, y, size=12.0, centered=False):
    """White with a dark outline: stripes are white too."""
    versions.set_font_size(size)
    if centered:
        x -= blf.dimensions(0, text)[0] / 2
    for dx, dy, light in ((-1, -1, 0), (1, -1, 0), (-1, 1, 0), (1, 1, 0), (0, 0, 1)):
        blf.color(0, light, light, light, 1)
        blf.position(0, x + dx, y + dy, 0)
        blf.draw(0, text)


def _draw_text():
    """In pixels, over it."""
    try:
        context = bpy.context
        space, region = context.space_data, context.region
        if space is None or space.type != "VIEW_3D" or not space.overlay.show_overlays:
            return
        scale = context.preferences.system.ui_scale
        for k, line in enumerate(reversed(told())):
            # in the middle: on the left there is the panel of the last operator
            _write(line, region.width / 2, (20 + 18 * k) * scale, 12 * scale, centered=True)
        for name, drawn in _state.drawn.items():
            ob = context.scene.objects.get(name)
            if drawn and ob and drawn.made.worst:
                place, angle = drawn.made.worst
                at = location_3d_to_region_2d(region, context.region_data, ob.matrix_world.translation + Vector(place.tolist()))
                if at is not None:
                    _write(library.words.degrees(angle), at.x + 8, at.y + 8, 13 * scale)
    except Exception:
        traceback.print_exc()
        stop()


@persistent
def _on_change(_scene, depsgraph):
    """What was changed is made again when it is next drawn."""
    for update in depsgraph.updates:
        if update.is_updated_geometry:
            _state.changed.add(update.id.name)


@persistent
def _on_load(*_):
    """Another file: nothing of the old one is held."""
    _state.drawn.clear()
    _state.changed.clear()


def redraw():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def start():
    """Switches the overlay on."""
    if _state.on() or library.missing:
        return
    add = bpy.types.SpaceView3D.draw_handler_add
    _state.handles = [add(_draw_surface, (), "WINDOW", "POST_VIEW"), add(_draw_text, (), "WINDOW", "POST_PIXEL")]
    bpy.app.handlers.depsgraph_update_post.append(_on_change)
    bpy.app.handlers.load_pre.append(_on_load)
    redraw()


def stop():
    """Switches it off; nothing is left of it."""
    for handle in _state.handles:
        bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
    for handlers, function in (
        (bpy.app.handlers.depsgraph_update_post, _on_change),
        (bpy.app.handlers.load_pre, _on_load),
    ):
        if function in handlers:
            handlers.remove(function)
    _state.__init__()
    redraw()


def _renew(_settings, _context):
    """After a setting has changed."""
    _state.drawn.clear()
    redraw()


def _move(_settings, _context):
    """After one that only the shader asks for."""
    redraw()


class TripatchOverlay(bpy.types.PropertyGroup):
    """What the overlay shows."""

    show: BoolProperty(
        **library.named("surface_quality"),
        get=lambda _: _state.on(),
        set=lambda _, on: start() if on else stop(),
    )
    surface: EnumProperty(
        **library.named("shown_surface"),
        items=library.items("shown", "NONE", "ZEBRA", "HIGHLIGHT", "CURVATURE", "DEVIATION"),
        default="ZEBRA",
        update=_renew,
    )
    seam: BoolProperty(**library.named("shown_seam"), default=True, update=_renew)
    folds: BoolProperty(**library.named("shown_folds"), default=True, update=_renew)
    direction: FloatVectorProperty(**library.named("stripe_direction"), subtype="DIRECTION", default=(0, 0, 1), update=_move)
    density: FloatProperty(**library.named("stripe_density"), default=12, min=1, soft_max=60, max=500, update=_move)
    opacity: FloatProperty(**library.named("opacity"), subtype="FACTOR", default=1, min=0, max=1, update=_move)
    seam_most: FloatProperty(**library.named("red_from"), default=1, min=0.001, soft_max=30, max=180, update=_renew)
    fixed_range: BoolProperty(**library.named("fixed_range"), update=_renew)
    curvature: FloatProperty(**library.named("curvature_range"), default=1, min=1e-6, update=_renew)
    deviation: FloatProperty(
        **library.named("deviation_range"), subtype="DISTANCE", default=0.01, min=1e-9, precision=4, update=_renew
    )


def draw_settings(layout, context):
    """The rows of the sidebar and of the overlay pop-over."""
    settings = context.window_manager.tripatch_overlay
    layout.prop(settings, "show")
    column = layout.column()
    column.active = settings.show
    column.prop(settings, "surface", text="")
    if settings.surface in ("ZEBRA", "HIGHLIGHT"):
        row = column.row()
        row.prop(settings, "direction", text="")
        row.column().prop(settings, "density")
    elif settings.surface in ("CURVATURE", "DEVIATION"):
        column.prop(settings, "fixed_range")
        if settings.fixed_range:
            column.prop(settings, settings.surface.lower())
    column.prop(settings, "opacity", slider=True)
    column.prop(settings, "seam")
    if settings.seam:
        column.prop(settings, "seam_most")
    column.prop(settings, "folds")
    for text in told() if settings.show else ():
        panel.sentence(column, context, text)


class VIEW3D_PT_tripatch_quality(bpy.types.Panel):
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "TriPatch"
    bl_label, bl_description = library.titled("surface_quality")

    @classmethod
    def poll(cls, _context):
        return not library.missing

    def draw(self, context):
        draw_settings(self.layout, context)


def _draw_popover(self, context):
    if not library.missing:
        self.layout.separator()
        draw_settings(self.layout, context)


_classes = (TripatchOverlay, VIEW3D_PT_tripatch_quality)


def register():
    for cls in _classes:
        bpy.utils.register_class(cls)
    bpy.types.WindowManager.tripatch_overlay = PointerProperty(type=TripatchOverlay)  # pyright: ignore
    bpy.types.VIEW3D_PT_overlay.append(_draw_popover)


def unregister():
    stop()
    bpy.types.VIEW3D_PT_overlay.remove(_draw_popover)
    del bpy.types.WindowManager.tripatch_overlay  # pyright: ignore
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
