"""Attributes of every type that the running Blender has: a fill changes none of what the mesh had before."""

import sys

import bmesh
import bpy
import numpy as np
import pytest
import scenes

fill = bpy.ops.mesh.fill_three_sided

TYPES = [item.identifier for item in bpy.types.Attribute.bl_rna.properties["data_type"].enum_items]


def field_of(layer):
    """The property of an element that holds its value."""
    return next(name for name in ("value", "vector", "color") if hasattr(layer.data[0], name))


def give(mesh, kind, domain):
    """A new attribute with a value of its own on every element."""
    layer = mesh.attributes.new("Own", kind, domain)
    count, field = len(layer.data), field_of(layer)
    if kind == "STRING":
        for k, item in enumerate(layer.data):
            item.value = f"s{k}".encode() if isinstance(item.value, bytes) else f"s{k}"
        return
    width = np.size(getattr(layer.data[0], field))
    whole = np.arange(count * width)
    values = {"BOOLEAN": whole % 2 == 0, "INT8": whole % 120, "INT": whole}.get(kind)
    if kind.startswith(("INT16", "INT32")):
        values = whole % 3000
    if values is None:
        values = np.random.default_rng(1).random(count * width, np.float32)
    layer.data.foreach_set(field, values)


def values_of(mesh, kind):
    """(elements, width) of what `give` gave, in bytes that can be compared."""
    layer = mesh.attributes["Own"]
    assert layer.data_type == kind
    values = [getattr(item, field_of(layer)) for item in layer.data]
    return values if kind == "STRING" else [np.ravel(value).tolist() for value in values]


def hole(custom):
    ob = scenes.add_hole()
    if custom:
        if hasattr(ob.data, "use_auto_smooth"):
            ob.data.use_auto_smooth = True
        ob.data.normals_split_custom_set_from_vertices([(0.0, 0.6, 0.8)] * len(ob.data.vertices))
    return ob


@pytest.mark.parametrize("custom", [False, True], ids=["plain", "custom normals"])
@pytest.mark.parametrize("domain", ["POINT", "EDGE", "FACE", "CORNER"])
@pytest.mark.parametrize("kind", TYPES)
def test_what_elements_had_before_stays(kind, domain, custom):
    ob = hole(custom)
    give(ob.data, kind, domain)
    before = values_of(ob.data, kind)
    scenes.edit(ob)
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    after = values_of(ob.data, kind)
    assert len(after) > len(before) > 80
    assert after[: len(before)] == before
    assert [a.name for a in ob.data.attributes if "tripatch" in a.name.lower()] == ["tripatch_fill"]


@pytest.mark.skipif("FLOAT4X4" not in TYPES, reason="this Blender has no matrices")
def test_matrices_are_blended_at_new_vertices():
    points, faces = scenes.lattice()
    ob = scenes.add_mesh(scenes.flat(points), faces)
    layer = ob.data.attributes.new("Own", "FLOAT4X4", "POINT")
    slopes = np.arange(16) / 16
    layer.data.foreach_set("value", (0.5 + points[:, :1] * slopes).astype(np.float32).ravel())
    old = len(ob.data.vertices)
    scenes.edit(ob)
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    got = np.array(values_of(ob.data, "FLOAT4X4"))
    x = np.array([v.co.x for v in ob.data.vertices])
    order = np.ravel(np.array(got[0]))  # rows or columns first: as the vertices that were there have it
    assert order.shape == (16,)
    np.testing.assert_allclose(got[old:] - 0.5, (x[old:, None] / x[0]) * (got[0] - 0.5), atol=1e-3)


@pytest.mark.skipif("FLOAT4X4" not in TYPES, reason="this Blender has no matrices")
def test_matrices_do_not_end_the_mode_or_the_selection_of_other_objects():
    obs = [hole(False) for _ in range(2)]
    give(obs[0].data, "FLOAT4X4", "POINT")
    bms = scenes.edit(*obs)
    scenes.select_rim(bms[0], scenes.border_loops(bms[0])[0])
    obs[1].select_set(False)
    assert fill() == {"FINISHED"}
    assert all(ob.mode == "EDIT" for ob in obs)
    assert [ob.select_get() for ob in obs] == [True, False]
    assert "FLOAT4X4" == obs[0].data.attributes["Own"].data_type
    bm = bmesh.from_edit_mesh(obs[0].data)
    assert any(f.select for f in bm.faces) and len(scenes.border_loops(bm)) == 1


@pytest.mark.skipif("FLOAT4X4" not in TYPES, reason="this Blender has no matrices")
def test_matrices_of_a_mesh_that_is_refused_stay():
    ob = scenes.add_mesh(*scenes.square_hole())
    give(ob.data, "FLOAT4X4", "CORNER")
    before = values_of(ob.data, "FLOAT4X4")
    scenes.edit(ob)
    with pytest.raises(RuntimeError, match="needs 3 corners"):
        fill(method="side_vertex")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert values_of(ob.data, "FLOAT4X4") == before


@pytest.mark.skipif("FLOAT4X4" not in TYPES, reason="this Blender has no matrices")
@pytest.mark.parametrize("domain", ["POINT", "EDGE", "FACE", "CORNER"])
def test_smoothed_triangles_keep_the_matrices_of_others(domain):
    ob = scenes.add_hole()
    give(ob.data, "FLOAT4X4", domain)
    (bm,) = scenes.edit(ob, mode="FACE")
    scenes.select(bm, faces=list(bm.faces)[-2:])
    assert bpy.ops.mesh.smooth_triangles(resolution=4) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert ob.data.attributes["Own"].data_type == "FLOAT4X4"
    assert not ob.data.validate(verbose=True)


@pytest.mark.skipif("FLOAT4X4" not in TYPES, reason="this Blender has no matrices")
def test_a_clash_of_names_is_no_trouble():
    """The stand-ins of a matrix take names that are free."""
    ob = hole(False)
    give(ob.data, "FLOAT4X4", "POINT")
    ob.data.attributes.new("TriPatch", "INT", "POINT")
    scenes.edit(ob)
    assert fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert ob.data.attributes["TriPatch"].data_type == "INT"


@pytest.mark.skipif("FLOAT4X4" not in TYPES, reason="this Blender has no matrices")
def test_undo_brings_matrices_back():
    ob = hole(False)
    give(ob.data, "FLOAT4X4", "CORNER")
    scenes.edit(ob)
    scenes.undone_and_redone(ob.name, lambda: fill("EXEC_DEFAULT", True))


@pytest.mark.parametrize("mode", ["EDIT", "OBJECT"])
@pytest.mark.parametrize("domain", ["POINT", "EDGE", "FACE", "CORNER"])
@pytest.mark.parametrize("kind", TYPES)
def test_a_live_fill_has_them_follows_and_is_applied(kind, domain, mode, addon):
    live = sys.modules[addon.__name__ + ".live"]
    ob = hole(False)
    give(ob.data, kind, domain)
    before = values_of(ob.data, kind)
    (bm,) = scenes.edit(ob)
    assert fill(keep_live=True, deviation=True) == {"FINISHED"}
    (made,) = live.fills()
    place = made.data.vertices[0].co.z
    for v in bm.verts:
        v.co.z += 0.5
    bmesh.update_edit_mesh(ob.data)
    bpy.ops.object.mode_set(mode=mode)
    assert bpy.ops.object.update_live_fill() == {"FINISHED"} and live.problem_of(made) == ""
    assert made.data.vertices[0].co.z == pytest.approx(place + 0.5, abs=1e-5)
    assert len(values_of(made.data, kind)) > 8
    assert bpy.ops.object.apply_live_fill() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    after = values_of(ob.data, kind)
    assert len(after) > len(before) > 80 and after[: len(before)] == before
    assert [a.name for d in bpy.data.meshes for a in d.attributes if "tripatch" in a.name.lower()] == ["tripatch_fill"]


@pytest.mark.skipif("FLOAT4X4" not in TYPES, reason="this Blender has no matrices")
def test_the_tool_fills_a_mesh_with_matrices():
    ob = hole(False)
    give(ob.data, "FLOAT4X4", "CORNER")
    before = values_of(ob.data, "FLOAT4X4")
    (bm,) = scenes.edit(ob)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    assert bpy.ops.mesh.shape_fill() == {"FINISHED"}
    assert bpy.ops.mesh.shape_fill_confirm() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    after = values_of(ob.data, "FLOAT4X4")
    assert len(after) > len(before) and after[: len(before)] == before
