"""Labels and tooltips are rows of the tables. What panels show is made of rows too: in a language without ASCII letters nothing
else is left of it."""

import importlib
import re
import sys
import types

import bpy
import scenes
import tripatch
from test_messages import in_pseudo_language  # noqa: F401  a fixture


def module(addon, name):
    return importlib.import_module(f"{addon.__name__}.{name}")


def words_of_options(addon):
    """What the tables of options and methods call things in a panel, and say of them."""
    properties = module(addon, "properties")
    choices = [each for option in tripatch.OPTIONS.values() for each in (*option.choices, option.none) if each is not None]
    for option in tripatch.OPTIONS.values():
        yield from (properties.label(option), properties.seen(option))
    for each in choices:
        yield from (properties.label(each), properties.words(each.name), each.description)
    for method in tripatch.METHODS.values():
        yield from (properties.method_label(method.name), method.description)
    yield from (*properties.METHODS.values(), *properties.FAIRING.values())


def classes(addon):
    """The classes that Blender knows of the add-on."""
    for name, each in list(sys.modules.items()):
        if name.startswith(addon.__name__ + "."):
            found = [cls for cls in vars(each).values() if isinstance(cls, type) and cls.__module__ == name]
            yield from (cls for cls in found if "bl_rna" in vars(cls))


def rna_of(cls):
    if not issubclass(cls, bpy.types.Operator):
        return cls.bl_rna
    group, name = cls.bl_idname.split(".")
    return getattr(getattr(bpy.ops, group), name).get_rna_type()


def words_of(cls):
    """Labels and tooltips of a class and of its properties."""
    rna = rna_of(cls)
    if issubclass(cls, (bpy.types.Operator, bpy.types.Panel)):
        yield from (cls.bl_label, cls.bl_description, rna.description)
    for prop in rna.properties if issubclass(cls, (bpy.types.Operator, bpy.types.PropertyGroup)) else ():
        if prop.identifier in ("rna_type", "name") or (prop.is_hidden and not prop.description):
            continue
        yield from (prop.name, prop.description)
        for item in getattr(prop, "enum_items", ()):
            yield from (item.name, item.description)


def test_every_label_and_tooltip_is_of_a_table(addon):
    known = {""} | {text for row in tripatch.messages.TABLE.values() for text in (row.panel, row.sentence)}
    known |= set(words_of_options(addon)) | {tripatch.messages.text("side_number", number=k) for k in range(1, 13)}
    found = list(classes(addon))
    assert len([cls for cls in found if issubclass(cls, bpy.types.Operator)]) >= 10
    for cls in found:
        assert set(words_of(cls)) - known == set(), cls.__name__


def test_every_property_that_is_declared_is_there(addon):
    """Blender leaves out all properties of a class if it cannot read one."""
    for cls in classes(addon):
        declared = {name for base in cls.__mro__ for name in vars(base).get("__annotations__", {})}
        if issubclass(cls, (bpy.types.Operator, bpy.types.PropertyGroup)) and cls.__module__.startswith(addon.__name__):
            assert declared <= set(rna_of(cls).properties.keys()), cls.__name__


class Layout:
    """Takes down the words that are shown; every fold is open."""

    def __init__(self, said):
        vars(self)["said"] = said

    def __getattr__(self, kind):
        def call(*_, **given):
            self.said.extend(given[each] for each in ("text", "heading") if given.get(each))
            return (Layout(self.said),) * 2 if kind == "panel" else Layout(self.said)

        return call

    def __setattr__(self, _name, _value):
        pass


def draw_operator(cls, group, name, **values):
    def draw(said):
        rna = getattr(getattr(bpy.ops, group), name).get_rna_type()
        stub = types.SimpleNamespace(layout=Layout(said), properties=types.SimpleNamespace(bl_rna=rna), sides=3)
        for base in reversed(cls.__mro__):
            for function in (each for each in vars(base).values() if isinstance(each, types.FunctionType)):
                setattr(stub, function.__name__, types.MethodType(function, stub))
        for prop in rna.properties:
            count = getattr(prop, "array_length", 0)
            setattr(stub, prop.identifier, tuple(prop.default_array) if count else getattr(prop, "default", None))
        for key, value in values.items():
            setattr(stub, key, value)
        stub.draw(bpy.context)

    return draw


def draw_panel(cls):
    return lambda said: cls.draw(types.SimpleNamespace(layout=Layout(said)), bpy.context)


def draws(addon):
    """Functions that draw what the add-on shows into a list."""
    operators, between = module(addon, "operators"), module(addon, "between_patches")
    why = "bulge:sides corners:position fairing:fairing pole_offset:cage"
    for method in ("auto", "szilvasi_nagy_c1", "polyharmonic_spline"):
        values = {"individual": True, "all_holes": True, "method": method, "not_applied": why}
        yield draw_operator(operators.MESH_OT_fill_smooth, "mesh", "fill_smooth", **values)
    yield draw_operator(operators.MESH_OT_edit_fill, "mesh", "edit_fill")
    yield draw_operator(between.OBJECT_OT_fill_between_patches, "object", "fill_between_patches", individual=True)
    yield draw_operator(module(addon, "blending").OBJECT_OT_blend_three_patches, "object", "blend_three_patches")
    yield draw_operator(module(addon, "smooth").MESH_OT_smooth_triangles, "mesh", "smooth_triangles")
    yield draw_panel(module(addon, "ui").TripatchPreferences)
    yield draw_panel(module(addon, "live_fills").VIEW3D_PT_tripatch_live)
    for surface in ("ZEBRA", "CURVATURE"):
        settings = types.SimpleNamespace(show=True, surface=surface, seam=True, fixed_range=True)
        context = types.SimpleNamespace(window_manager=types.SimpleNamespace(tripatch_overlay=settings), region=None)
        yield lambda said, context=context: module(addon, "overlay").draw_settings(Layout(said), context)
    tool = module(addon, "tool")
    yield lambda said: tool.TRIPATCH_TOOL_shape.draw_settings(bpy.context, Layout(said), None)


def test_nothing_in_a_panel_is_glued_together(addon, in_pseudo_language):  # noqa: F811
    (bm,) = scenes.edit(scenes.add_hole())
    scenes.select_rim(bm, min(scenes.border_loops(bm), key=len))
    shaping = module(addon, "shaping")
    labels = {getattr(cls, "bl_label", "") for cls in classes(addon)}  # which Blender was given before
    known = [*{*words_of_options(addon), *labels} - {""}, "and"]
    silent, said = 0, []
    for draw in draws(addon):
        before = len(said)
        draw(said)
        silent += len(said) == before
    tool, view = module(addon, "tool"), module(addon, "shaping_view")
    view.start(shaping.from_selection(bpy.context.object, bm))
    try:
        tool.TRIPATCH_TOOL_shape.draw_settings(bpy.context, Layout(said), None)
    finally:
        view.stop()
    assert len(said) > 40 and silent <= 5
    for text in said:
        for name in sorted(known, key=len, reverse=True):
            text = text.replace(name, "")
        assert not re.search("[A-Za-z]", text), text
