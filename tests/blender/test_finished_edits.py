"""After every operator of the add-on a mesh in edit mode is as Blender's own Grid Fill leaves it, without a change of mode. The
normals are those of its faces, selections are complete, elements are numbered, and all of the mesh is drawn."""

import math
import sys

import bmesh
import bpy
import pytest
import scenes


def _angle(stored, fresh):
    return math.degrees(stored.angle(fresh, 0.0 if stored == fresh else math.pi))


def left(ob):
    """How an operator has left a mesh in edit mode."""
    mesh = ob.data
    bm = bmesh.from_edit_mesh(mesh)
    elements, history = (bm.verts, bm.edges, bm.faces), bm.select_history
    of_selection = [[e.select for e in each] for each in elements]
    found = {
        "numbered": [[e.index for e in each] == list(range(len(each))) for each in elements],
        "counted": [mesh.total_vert_sel, mesh.total_edge_sel, mesh.total_face_sel] == [sum(each) for each in of_selection],
        "history": [e for e in map(history.__getitem__, range(len(history))) if not e.select],  # Blender 4.3 cannot iterate
        "hidden and selected": [e for each in elements for e in each if e.hide and e.select],
    }
    facing = [*bm.verts, *bm.faces]
    stored = [e.normal.copy() for e in facing]
    bm.normal_update()
    found["degrees that normals are stale"] = round(max(_angle(n, e.normal) for n, e in zip(stored, facing, strict=True)), 3)
    bm.select_flush_mode()
    found["flushed"] = of_selection == [[e.select for e in each] for each in elements]
    evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    if not ob.modifiers:
        found["drawn"] = len(evaluated.to_mesh().vertices) == len(bm.verts)
    return found


def sheet(**custom):
    """A hole of four corners in quads, selected."""
    ob = scenes.add_mesh(*scenes.square_hole())
    if custom.get("normals"):
        ob.data.normals_split_custom_set_from_vertices([(0.6, 0, 0.8)] * len(ob.data.vertices))
    if custom.get("matrices") and bpy.app.version >= (4, 2):
        ob.data.attributes.new("matrix", "FLOAT4X4", "POINT")
    if custom.get("subdivided"):
        ob.modifiers.new("Subdivision", "SUBSURF")
    (bm,) = scenes.edit(ob)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    return ob


def by_options(name="fill_smooth", **options):
    return lambda: getattr(bpy.ops.mesh, name)(**options)


def of_sheet(step, **custom):
    def run(mode):
        ob = sheet(**custom)
        bpy.ops.mesh.select_mode(type=mode)
        assert step() == {"FINISHED"}
        return [bpy.data.objects[ob.name]]

    return run


def grid_fill(mode):
    ob = sheet()
    bpy.ops.mesh.select_mode(type="EDGE")  # the only one that it works in
    assert bpy.ops.mesh.fill_grid() == {"FINISHED"}
    bpy.ops.mesh.select_mode(type=mode)
    return [ob]


def all_holes(mode):
    ob = scenes.add_hole(size=16, holes=((2, 2, 3), (7, 2, 3)))
    scenes.edit(ob, mode=mode)
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
    return [ob]


def several_objects(mode):
    objects = [scenes.add_hole(), scenes.add_mesh(*scenes.square_hole())]
    scenes.edit(*objects, mode=mode)
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
    return objects


def replaced(mode):
    points, outside, inside = scenes.lattice_parts()
    ob = scenes.add_mesh(scenes.bowl(points), [*outside, *inside])
    (bm,) = scenes.edit(ob, mode="FACE")
    bm.faces.ensure_lookup_table()
    scenes.select(bm, faces=bm.faces[len(outside) :])
    bpy.ops.mesh.select_mode(type=mode)
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
    return [ob]


def half(mode):
    """A hole that a Mirror modifier cuts in half."""
    points, faces = scenes.square_hole()
    right = [face for face in faces if points[face, 0].min() > -0.06]
    used = sorted({v for face in right for v in face})
    new = {v: k for k, v in enumerate(used)}
    ob = scenes.add_mesh(points[used] + [0.05, 0, 0], [[new[v] for v in face] for face in right])
    ob.modifiers.new("Mirror", "MIRROR")
    scenes.edit(ob, mode=mode)
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
    return [ob]


def adjacent(mode):
    """The fill of a cage's limit surface is an object of its own."""
    ob = scenes.add_hole()
    ob.modifiers.new("Subdivision", "SUBSURF")
    (bm,) = scenes.edit(ob, mode=mode)
    scenes.select_rim(bm, scenes.border_loops(bm)[0])
    assert bpy.ops.mesh.fill_smooth(surroundings="limit") == {"FINISHED"}
    return [ob]


def shaped(mode):
    ob = sheet()
    assert bpy.ops.mesh.shape_fill() == {"FINISHED"}
    bpy.ops.mesh.select_mode(type=mode)
    assert bpy.ops.mesh.shape_fill_confirm() == {"FINISHED"}
    return [ob]


def live_fill_applied(mode):
    ob = sheet()
    bpy.ops.mesh.select_mode(type=mode)
    assert bpy.ops.mesh.fill_smooth(keep_live=True) == {"FINISHED"}
    assert bpy.ops.object.apply_live_fill() == {"FINISHED"}
    return [ob]


def smoothed(mode):
    ob = scenes.add_hole()
    (bm,) = scenes.edit(ob, mode=mode)
    bm.faces.ensure_lookup_table()
    scenes.select(bm, faces=bm.faces[3:9])
    assert bpy.ops.mesh.smooth_triangles(resolution=3) == {"FINISHED"}
    return [ob]


def refused(mode):
    """By hand: a refusal selects what is wrong."""
    ob = sheet()
    bpy.ops.mesh.select_mode(type=mode)
    assert bpy.ops.mesh.fill_smooth(by_hand=True, method="side_vertex") == {"FINISHED"}
    return [ob]


CHANGES = {
    "triangles": of_sheet(by_options(output="triangles")),
    "quads": of_sheet(by_options(output="quads")),
    "old name": of_sheet(by_options("fill_three_sided")),
    "cage": of_sheet(by_options(output="cage"), subdivided=True),
    "exact cage": of_sheet(by_options(output="cage", cage_rim="exact"), subdivided=True),
    "limit surface": adjacent,
    "custom normals": of_sheet(by_options(), normals=True),
    "deviation": of_sheet(by_options(deviation=True)),
    "attributes that stand aside": of_sheet(by_options(), matrices=True),
    "kept live": of_sheet(by_options(keep_live=True)),
    "all holes": all_holes,
    "several objects": several_objects,
    "faces replaced": replaced,
    "half a hole": half,
    "Shape Fill": shaped,
    "live fill applied": live_fill_applied,
    "Smooth Triangles": smoothed,
    "refusal": refused,
}


@pytest.mark.parametrize("mode", ["VERT", "EDGE", "FACE"])
@pytest.mark.parametrize("change", CHANGES)
def test_a_mesh_is_left_as_grid_fill_leaves_it(change, mode):
    (grid,) = grid_fill(mode)
    as_blender = left(grid)
    assert as_blender["degrees that normals are stale"] == 0 and as_blender["flushed"]
    bpy.ops.object.mode_set(mode="OBJECT")
    for ob in CHANGES[change](mode):
        found = left(ob)
        assert found == {name: as_blender[name] for name in found}


def test_moving_along_normals_right_after_a_fill_of_a_ball_makes_a_ball():
    """Shrink/Fatten reads the normals of the edit mesh."""
    ob = scenes.add_mesh(*scenes.ball_with_hole(8))
    scenes.edit(ob)
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.shrink_fatten(value=0.2)
    radii = [v.co.length for v in bmesh.from_edit_mesh(ob.data).verts]
    assert max(radii) - min(radii) < 0.004


def test_every_change_of_an_edit_mesh_ends_in_one_function(addon):
    """No other code calls what Blender needs at the end of one, which is easily done by half."""
    from pathlib import Path

    package = Path(sys.modules[addon.__name__].__file__).parent
    calls = {p.name: p.read_text().count("update_edit_mesh(") for p in package.glob("*.py")}
    assert {name: n for name, n in calls.items() if n} == {"selection.py": 1}
