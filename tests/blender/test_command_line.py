"""Holes filled without a window: exit codes, messages, and what is written."""

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import bmesh
import bpy
import numpy as np
import pytest
import scenes

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "fill_holes.py"


@pytest.fixture
def run(addon, tmp_path, capsys):
    """run(*objects, "--option", ...) saves the scene, fills it, and returns (exit status, stdout, stderr); OUT is out.blend."""
    command_line = importlib.import_module(addon.__name__ + ".command_line")

    def fill(*arguments):
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "in.blend"))
        capsys.readouterr()
        status = command_line.main([*arguments, "--out", str(tmp_path / "out.blend")])
        text = capsys.readouterr()
        return status, text.out, text.err

    fill.out = tmp_path / "out.blend"
    return fill


def rims(name):
    bm = scenes.checked(bpy.data.objects[name])
    lengths = [len(loop) for loop in scenes.border_loops(bm)]
    bm.free()
    return lengths


def test_all_filled(run):
    scenes.add_hole().name = "A"
    scenes.add_hole().name = "B"
    status, out, err = run()
    assert (status, err) == (0, "")
    assert "A: Filled 1 hole; seam within" in out
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    assert rims("A") == rims("B") == [36]


@pytest.mark.skipif(bpy.app.version < (4, 5), reason="this Blender has no matrices")
def test_attributes_that_are_matrices_stay(run):
    """Making elements next to them would end Blender."""
    ob = scenes.add_hole()
    ob.name = "A"
    layer = ob.data.attributes.new("M", "FLOAT4X4", "POINT")
    before = np.arange(16 * len(layer.data), dtype=np.float32)
    layer.data.foreach_set("value", before)
    assert run()[0] == 0
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    layer = bpy.data.objects["A"].data.attributes["M"]
    after = np.empty(16 * len(layer.data), np.float32)
    layer.data.foreach_get("value", after)
    np.testing.assert_array_equal(after[: len(before)], before)


def test_named_objects_only(run):
    scenes.add_hole().name = "A"
    scenes.add_hole().name = "B"
    status, _, _ = run("--object", "B")
    assert status == 0
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    assert rims("A") == [12, 36]
    assert rims("B") == [36]


def test_some_refused(run):
    scenes.add_hole().name = "A"
    scenes.add_mesh(*scenes.square_hole()).name = "B"
    report = run.out.with_suffix(".json")
    status, _, err = run("--all", "--method", "side_vertex", "--report", str(report))
    assert status == 3
    assert "B: This method needs 3 corners, but the hole has 4" in err
    assert run.out.exists()
    a, b = json.loads(report.read_text())
    assert (a["object"], len(a["filled"]), a["refused"]) == ("A", 1, [])
    assert a["filled"][0]["seam_angle_max"] < 1e-4
    assert (b["object"], b["filled"], len(b["refused"])) == ("B", [], 1)


def test_any_rim_is_filled_by_default(run):
    """As by the operator and by the library."""
    scenes.add_mesh(*scenes.square_hole()).name = "B"
    report = run.out.with_suffix(".json")
    status, _, err = run("--report", str(report))
    assert (status, err) == (0, "")
    assert json.loads(report.read_text())[0]["filled"][0]["method"] == "quad_rows"


@pytest.mark.parametrize(("flawed", "status"), [(True, 3), (False, 0)])
def test_a_flawed_fill_is_counted_in_the_status(run, addon, monkeypatch, flawed, status):
    filling = importlib.import_module(addon.__name__ + ".filling")

    class Folded:
        is_flawed = flawed

        def __init__(self, report):
            self.report = report

        def __getattr__(self, name):
            return getattr(self.report, name)

    fill_rims = filling.fill_rims

    def folded(*arguments):
        outcome, faces = fill_rims(*arguments)
        outcome.reports = [Folded(report) for report in outcome.reports]
        return outcome, faces

    monkeypatch.setattr(filling, "fill_rims", folded)
    scenes.add_hole()
    assert run()[0] == status


def test_deviation_is_written_where_asked(run):
    scenes.add_mesh(*scenes.square_hole()).name = "B"
    assert run("--deviation")[0] == 0
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    attributes = bpy.data.objects["B"].data.attributes
    assert attributes["deviation"].domain == "POINT"
    assert attributes["reconstructed"].domain == "FACE"


@pytest.mark.parametrize("arguments", [("--all",), ("--object", "A"), ()])
def test_rims_may_be_called_round(run, arguments):
    scenes.add_hole(size=24, holes=((6, 6, 8),)).name = "A"
    scenes.add_mesh(*scenes.ring()).name = "B"
    report = run.out.with_suffix(".json")
    found = {}
    for more in ((), ("--corners", "none")):
        assert run(*arguments, *more, "--report", str(report))[0] == 0
        found[more] = [hole["corners"] for each in json.loads(report.read_text()) for hole in each["filled"]]
        bpy.ops.wm.open_mainfile(filepath=str(run.out.with_name("in.blend")))
    assert any(found[()]) and found[("--corners", "none")] == [[]] * len(found[()])


def test_nothing_to_fill_copies_the_file(run):
    bpy.ops.mesh.primitive_cube_add()
    status, out, _ = run()
    assert status == 0 and run.out.exists()
    assert "Nothing to fill: the mesh has no border" in out


@pytest.mark.parametrize(("options", "advice"), [((), "--all --outer"), (("--all",), "--outer")])
def test_a_sheet_with_outer_borders_only_is_copied_and_they_are_named(run, options, advice):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4)
    report = run.out.with_suffix(".json")
    status, out, _ = run(*options, "--report", str(report))
    assert status == 0 and run.out.exists()
    assert f"Nothing to fill: 1 outer border left open (16 edges); use {advice} to fill it" in out


def test_all_refused(run):
    scenes.add_mesh(*scenes.square_hole()).name = "B"
    status, _, err = run("--object", "B", "--corners", "0,1,11")
    assert status == 1
    assert "B: The corners do not lie on one border" in err
    assert not run.out.exists()


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--object", "Nobody"], "Nobody"),
        (["--method", "magic"], "magic"),
        (["--bulge", "-1"], "bulge"),
        (["--rim", "0,1,x"], "--rim"),
        (["--rim", "0,1,99999"], "99999"),
        (["--corners", "1,2", "--method", "side_vertex"], "three"),
        (["no such file.blend"], "no such file"),
    ],
)
def test_bad_usage(run, arguments, word):
    scenes.add_hole()
    status, out, err = run(*arguments)
    assert status == 2
    assert word in out + err
    assert not run.out.exists()


def test_given_corners_and_rim(run):
    ob = scenes.add_mesh(*scenes.ring())
    ob.name = "Ring"
    assert run("--object", "Ring", "--corners", "0,8,16")[0] == 0
    rim = ",".join(str(k) for k in range(23, -1, -1))
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    assert rims("Ring") == [24]
    first = np.array([v.co for v in bpy.data.objects["Ring"].data.vertices])
    bpy.ops.wm.open_mainfile(filepath=str(run.out.with_name("in.blend")))
    assert run("--object", "Ring", "--rim", rim, "--corners", "0,8,16")[0] == 0
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    np.testing.assert_array_equal(first, [v.co for v in bpy.data.objects["Ring"].data.vertices])


def test_all_leaves_the_outer_border_unless_asked(run):
    points, faces = scenes.lattice(size=18, holes=((2, 2, 4), (9, 3, 4)))
    scenes.add_mesh(scenes.bowl(points), faces).name = "A"
    status, out, err = run("--method", "side_vertex")
    assert status == 0 and "Filled 2 holes" in out
    bpy.ops.wm.open_mainfile(filepath=str(run.out.with_name("in.blend")))
    status, out, _ = run("--all")
    assert status == 0
    assert "Filled 2 holes" in out
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    assert rims("A") == [54]
    bpy.ops.wm.open_mainfile(filepath=str(run.out.with_name("in.blend")))
    assert run("--all", "--outer", "--method", "side_vertex")[0] == 3  # seen from outside, the border turns the wrong way round


def test_all_takes_the_only_hole_of_a_mesh(run):
    """It is the longest border of its part, and no outer one."""
    scenes.add_mesh(*scenes.ball_with_hole()).name = "A"
    status, out, err = run("--all")
    assert (status, err) == (0, "")
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    assert rims("A") == []


@pytest.mark.parametrize(("filters", "filled"), [(["--max-edges", "11"], 0), (["--max-edges", "12", "--corner-count", "3,3"], 1)])
def test_holes_are_chosen_as_by_the_library(run, filters, filled):
    scenes.add_hole().name = "A"
    status, _, _ = run("--all", *filters)
    assert status == (0 if filled else 1)
    assert run.out.exists() == bool(filled)
    assert run(*filters)[0] == 2  # they go with --all


def test_the_same_fill_as_in_edit_mode(run):
    """Shape keys, custom normals and the rest go the same way."""
    ob = scenes.add_hole()
    ob.name, ob.scale = "A", (1, 2, 1)
    ob.shape_key_add(name="Basis", from_mix=False)
    ob.shape_key_add(name="Key", from_mix=False).data[0].co.z += 0.1
    ob.active_shape_key_index = 1
    if hasattr(ob.data, "use_auto_smooth"):
        ob.data.use_auto_smooth = True
    ob.data.normals_split_custom_set_from_vertices([(0.6, 0, 0.8)] * len(ob.data.vertices))
    assert run()[0] == 0
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    without = scenes.arrays(bpy.data.objects["A"])
    bpy.ops.wm.open_mainfile(filepath=str(run.out.with_name("in.blend")))
    ob = bpy.data.objects["A"]
    ob.active_shape_key_index = 0
    scenes.edit(ob)
    bpy.ops.mesh.fill_three_sided()
    bpy.ops.object.mode_set(mode="OBJECT")
    within = scenes.arrays(ob)
    for name in ("vertices", "edges", "shapes", "normals"):
        assert without[name] == within[name], name


def test_hidden_objects_and_objects_in_edit_mode_are_filled(run):
    hidden, editing = scenes.add_hole(), scenes.add_hole()
    hidden.name, editing.name = "Hidden", "Editing"
    hidden.hide_set(True)
    hidden.hide_viewport = True
    scenes.edit(editing)
    assert run()[0] == 0
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    assert rims("Hidden") == rims("Editing") == [36]


def test_linked_meshes_are_refused(run, tmp_path):
    scenes.add_hole().name = "Far"
    bpy.data.objects["Far"].data.name = "Far"
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other.blend"))
    bpy.data.objects.remove(bpy.data.objects["Far"])
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.objects = ["Far"]
    bpy.context.collection.objects.link(wanted.objects[0])
    status, _, err = run("--object", "Far")
    assert status == 1
    assert "linked" in err
    assert "Far" in err


#: Where a package is installed that is to be tested, it comes before that of the source tree, which the script would take.
INSTALLED = "import tripatch" if os.environ.get("TRIPATCH_PACKAGES") else ""


def blender(blend, *arguments, script=SCRIPT, setup=INSTALLED):
    """Runs a script as a program would: in Debian's Blender, or in a Python with bpy that opens the file first."""
    if bpy.app.binary_path and Path(bpy.app.binary_path).name.startswith("blender"):
        command = [bpy.app.binary_path, "--background", str(blend), "--python", str(script), "--", *arguments]
        if setup:
            command[3:3] = ["--python-expr", setup]
    else:
        start = f"{setup}\nimport bpy, os, sys, runpy\nbpy.ops.wm.open_mainfile(filepath={str(blend)!r})\n"
        start += f"sys.argv = ['blender', '--', *{list(arguments)!r}]\n"
        start += f"try: runpy.run_path({str(script)!r}, run_name='__main__')\n"
        start += "except SystemExit as end: sys.stdout.flush(); os._exit(end.code)"  # conftest.py says how bpy 4.2 would end
        command = [sys.executable, "-c", start]
    return subprocess.run(command, capture_output=True, text=True, timeout=100, env=dict(os.environ), check=False)


def test_the_script_as_a_program(tmp_path):
    scenes.add_hole().name = "A"
    scenes.add_mesh(*scenes.square_hole()).name = "B"
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "in.blend"))
    out = tmp_path / "out.blend"
    done = blender(tmp_path / "in.blend", "--object", "A", "--out", str(out))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "A: Filled 1 hole" in done.stdout
    assert out.exists()
    done = blender(tmp_path / "in.blend", "--all", "--out", str(out))
    assert done.returncode == 0, done.stdout + done.stderr
    patch = ("--method", "side_vertex")
    done = blender(tmp_path / "in.blend", "--all", *patch, "--out", str(out))
    assert done.returncode == 3, done.stdout + done.stderr
    done = blender(tmp_path / "in.blend", "--object", "B", *patch, "--out", str(tmp_path / "never.blend"))
    assert done.returncode == 1, done.stdout + done.stderr
    assert "needs 3 corners" in done.stderr
    assert not (tmp_path / "never.blend").exists()
    done = blender(tmp_path / "in.blend")
    assert done.returncode == 2, done.stdout + done.stderr
    assert "--out" in done.stdout, "a bare command shows its help"


def test_without_numpy_one_sentence_names_the_package(tmp_path):
    scenes.add_hole()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "in.blend"))
    hide = "import sys; sys.modules['numpy'] = None"
    done = blender(tmp_path / "in.blend", "--out", str(tmp_path / "out.blend"), setup=hide)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "python3-numpy" in done.stderr
    # Blender 5.1 has add-ons of its own that want it
    frames = [line for line in (done.stdout + done.stderr).splitlines() if line.startswith('  File "')]
    assert not any("tripatch_blender" in line or "fill_holes.py" in line for line in frames)


@pytest.mark.skipif(bpy.app.version < (4, 2), reason="blender --command came with 4.2")
def test_the_command_is_registered(addon):
    command_line = importlib.import_module(addon.__name__ + ".command_line")
    assert command_line._command is not None


def cage():
    """A cube sphere without the faces around one of its corners, under a Subdivision modifier."""
    bpy.ops.mesh.primitive_cube_add(size=2)
    ob = bpy.context.object
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bmesh.ops.subdivide_edges(bm, edges=bm.edges, cuts=5, use_grid_fill=True)
    corner = next(v for v in bm.verts if len(v.link_faces) == 3)
    gone = {f for other in corner.link_faces for v in other.verts for f in v.link_faces}
    for v in bm.verts:
        v.co.normalize()
    bmesh.ops.delete(bm, geom=list(gone), context="FACES")
    bm.to_mesh(ob.data)
    bm.free()
    ob.name = "Cage"
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 2
    return ob


def test_cages_where_there_is_a_modifier(run):
    cage()
    status, out, _ = run("--cage-rim", "exact", "--resolution", "0")
    assert status == 0
    assert "Cage: Filled 1 hole with a cage of 12 quads, seam within" in out and "surroundings moved 0 (scene units)" in out
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    assert rims("Cage") == []


def test_limit_surroundings_make_an_object(run):
    faces = len(cage().data.polygons)
    status, out, _ = run("--surroundings", "limit", "--output", "quads", "--resolution", "0")
    assert status == 0 and "Filled 1 hole in Cage Fill" in out
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    assert len(bpy.data.objects["Cage"].data.polygons) == faces
    assert rims("Cage Fill") == [48]


def test_a_modifier_is_added_where_asked(run):
    cage().modifiers.clear()
    assert run("--output", "cage", "--resolution", "0", "--add-modifier")[0] == 0
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    assert [m.type for m in bpy.data.objects["Cage"].modifiers] == ["SUBSURF"]


def test_a_mirror_joins_its_cut_and_halves_of_holes_are_filled(run):
    from test_modifiers import add_half_with_holes, whole_borders

    add_half_with_holes((0, -1), (1, 0.8))
    assert run("--all")[0] == 0
    bpy.ops.wm.open_mainfile(filepath=str(run.out))
    assert whole_borders(bpy.data.objects["Half"]) == [80]


def test_a_half_without_a_hole_is_left(run):
    from test_modifiers import add_half_with_holes

    add_half_with_holes()
    status, said, _ = run("--all")
    assert status == 0 and "Nothing to fill" in said
