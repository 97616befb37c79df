"""A fill that passes through a part of the mesh far from its boundary: said with the place, and counted."""

import importlib
import json

import bmesh
import bpy
import numpy as np
import pytest
import scenes

FIN = np.array([[0.06, -0.1, -0.3], [0.06, 0.1, -0.3], [0.06, 0.1, 0.35], [0.06, -0.1, 0.35]])
CAGES = ({"output": "cage"}, {"surroundings": "limit"})


def add_plate(fin, subdivided, corners=False):
    """A plate of 20 x 20 quads with a hole in its middle, and a fin that stands in the hole: no face of the plate is near it."""
    side = np.linspace(-1, 1, 21)
    vertices = np.column_stack([*(each.ravel() for each in np.meshgrid(side, side, indexing="ij")), np.zeros(441)])
    middle = range(8, 12)
    faces = [
        [21 * i + j, 21 * (i + 1) + j, 21 * (i + 1) + j + 1, 21 * i + j + 1]
        for i in range(20)
        for j in range(20)
        if not (i in middle and j in middle)
    ]
    fins = [[441, 442, 443, 444]] if fin else []
    ob = scenes.add_mesh(np.vstack([vertices, FIN]) if fin else vertices, faces + fins)
    if subdivided:
        ob.modifiers.new("Subdivision", "SUBSURF").levels = 2
    (bm,) = scenes.edit(ob, mode="EDGE")
    loop = next(loop for loop in scenes.border_loops(bm) if len(loop) == 16)
    if corners:
        bpy.ops.mesh.select_mode(type="VERT")
        scenes.select(bm, [loop[0], loop[4], loop[8]])
    else:
        scenes.select_rim(bm, loop)
    bmesh.update_edit_mesh(ob.data)
    return ob


@pytest.mark.parametrize("options", [{"output": "triangles"}, {"output": "quads"}, *CAGES], ids=str)
def test_it_is_said_with_its_place(options, capfd):
    for fin in (True, False):
        add_plate(fin, options in CAGES, "surroundings" in options)
        assert bpy.ops.mesh.fill_smooth(**options) == {"FINISHED"}
        told = capfd.readouterr().out
        assert ("Warning" in told and "passes through the mesh near (0.06, " in told) == fin
        assert ("Warning" in told or "passes" in told) == fin
        bpy.ops.object.mode_set(mode="OBJECT")


def test_another_fill_is_taken_where_one_is_free(capfd):
    """A ball with a round hole, and a fin above the hole's plane that reaches out of the ball: no edge connects the two."""
    angle, lean = 2 * np.pi * np.arange(24) / 24, 0.6 + 0.15 * np.arange(12)
    rings = [np.column_stack([np.sin(t) * np.cos(angle), np.sin(t) * np.sin(angle), np.full(24, np.cos(t))]) for t in lean]
    faces = [
        [24 * j + k, 24 * (j + 1) + k, 24 * (j + 1) + (k + 1) % 24, 24 * j + (k + 1) % 24] for j in range(11) for k in range(24)
    ]
    fin = np.array([[-0.2, 0, 0.9], [0.2, 0, 0.9], [0.2, 0, 1.2], [-0.2, 0, 1.2]])
    for in_the_way in (False, True):
        vertices = np.vstack([*rings, fin] if in_the_way else rings)
        ob = scenes.add_mesh(vertices, [*faces, [288, 289, 290, 291]] if in_the_way else faces)
        (bm,) = scenes.edit(ob, mode="EDGE")
        scenes.select_rim(bm, next(loop for loop in scenes.border_loops(bm) if len(loop) == 24 and loop[0].co.z > 0))
        bmesh.update_edit_mesh(ob.data)
        assert bpy.ops.mesh.fill_smooth(output="triangles") == {"FINISHED"}
        assert "passes" not in capfd.readouterr().out
        bpy.ops.object.mode_set(mode="OBJECT")
        highest = max(v.co.z for v in ob.data.vertices if v.index >= len(vertices))
        assert (highest < 0.9) == in_the_way


def test_on_the_command_line_it_counts(addon, tmp_path):
    command_line = importlib.import_module(f"{addon.__name__}.command_line")
    add_plate(True, False)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "in.blend"))
    report = tmp_path / "report.json"
    assert command_line.main(["--all", "--out", str(tmp_path / "out.blend"), "--report", str(report)]) == command_line.EXIT_SOME
    (ob,) = json.loads(report.read_text())
    assert [hole["passes_through"][0] == pytest.approx(0.06) for hole in ob["filled"]] == [True]
