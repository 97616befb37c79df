"""`tripatch batch` with .blend files: by Debian's Blender where it is installed, and by programs that fail in its place."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from test_batch import _HOG, heads, is_gone, lines, run
from tripatch.batch import journal

ADDON = Path(__file__).resolve().parents[2] / "addon"
needs_shell = pytest.mark.skipif(os.name != "posix", reason="a shell script stands for Blender")
needs_blender = pytest.mark.skipif(shutil.which("blender") is None, reason="no Blender on the PATH")

_SCENE = """
import sys
import bmesh
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
for k in range(2):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, location=(3 * k, 0, 0))
    bm = bmesh.new()
    bm.from_mesh(bpy.context.object.data)
    bmesh.ops.delete(bm, geom=[v for v in bm.verts if v.co.z > 0.8 or (k and v.co.z < -0.8)], context="VERTS")
    bm.to_mesh(bpy.context.object.data)
    bm.free()
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1])
"""
_LOOK = """
import sys
import bpy
bpy.ops.wm.open_mainfile(filepath=sys.argv[-1])
for ob in bpy.context.scene.objects:
    uses = {}
    for face in ob.data.polygons:
        for key in face.edge_keys:
            uses[key] = uses.get(key, 0) + 1
    print("FOUND", ob.name, len(ob.data.polygons), sum(n == 1 for n in uses.values()))
"""


def blender(script, path):
    command = ["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python-expr", script, "--", path]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


@needs_blender
def test_a_blend_is_filled_beside_a_broken_one(tmp_path, capsys):
    source, out = tmp_path / "in", tmp_path / "out"
    source.mkdir()
    blender(_SCENE, source / "spheres.blend")
    (source / "broken.blend").write_bytes((source / "spheres.blend").read_bytes()[:5000])
    options = [source, "--out", out, "--workers", 0, "--addon", ADDON]
    listed = run(capsys, *options, "--dry-run")
    assert "spheres.blend: Sphere.001, Hole through vertex " in listed[1]
    assert listed[1].endswith("3 holes in 2 files would be filled\n")
    code, said, _ = run(capsys, *options, "--worst", 3)
    assert code == 3
    assert "Filled 3 holes in 1 of 2 files; 1 file failed (1 unreadable)" in said
    assert (out / journal.SHEET).stat().st_size > 20_000
    reason = heads(out)["broken.blend"]["reason"]
    assert reason.startswith("Blender cannot open it")
    assert "broken.blend" in reason
    assert str(tmp_path) not in reason  # lines are the same on every machine
    holes = [line for line in lines(out) if line["line"] == "hole"]
    assert [(hole["object"], hole["edges"], hole["status"]) for hole in holes] == [
        ("Sphere", 24, "filled"),
        ("Sphere.001", 24, "filled"),
        ("Sphere.001", 24, "filled"),
    ]
    assert all(0 < hole["crease_max"] < 20 and hole["new_faces"] >= 24 for hole in holes)
    assert sorted(path.name for path in out.glob("*.blend*")) == ["spheres.blend"]
    found = [line.split() for line in blender(_LOOK, out / "spheres.blend").splitlines() if line.startswith("FOUND")]
    assert [words[-1] for words in found] == ["0", "0"]  # no border is left
    assert sum(int(words[-2]) for words in found) == heads(out)["spheres.blend"]["faces"] + sum(h["new_faces"] for h in holes)
    assert "1 done before" in run(capsys, *options, "--worst", 0)[2]


_WITH_SCRIPTS = (
    _SCENE.rpartition("bpy.ops.wm.save")[0]
    + """
ran = repr(sys.argv[-1] + ".ran")
text = bpy.data.texts.new("run.py")
text.from_string(f"open({ran}, 'w')")
text.use_module = True
driver = bpy.context.object.driver_add("location", 0).driver
driver.type = "SCRIPTED"
driver.expression = f"open({ran}, 'w').write('')"
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1])
"""
)


@needs_blender
def test_scripts_in_a_blend_are_never_run(tmp_path, capsys):
    source, ran = tmp_path / "in", tmp_path / "in" / "spheres.blend.ran"
    source.mkdir()
    blender(_WITH_SCRIPTS, source / "spheres.blend")
    ran.unlink(missing_ok=True)  # the driver runs when it is written
    blender("import bpy, sys; bpy.ops.wm.open_mainfile(filepath=sys.argv[-1], use_scripts=True)", source / "spheres.blend")
    assert ran.exists()
    ran.unlink()
    code, said, _ = run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--addon", ADDON)
    assert code == 0
    assert said.startswith("Filled 3 holes in 1 of 1 file")
    assert not ran.exists()


def program(tmp_path, text):
    path = tmp_path / "blender"
    path.write_text("#!/bin/sh\n" + text)
    path.chmod(0o755)
    return path


@needs_shell
@pytest.mark.parametrize(
    ("text", "status", "reason"),
    [
        ("kill -SEGV $$\n", "crashed", "Blender ended by signal 11"),
        ("echo Error: no such thing; exit 9\n", "crashed", "Blender ended with code 9: Error: no such thing"),
        ("sleep 100\n", "time limit", "It took more than 1 s"),
    ],
)
def test_a_blender_that_fails_costs_its_file(tmp_path, capsys, text, status, reason):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.blend").write_bytes(b"BLENDER")
    (tmp_path / "in" / "b.obj").write_text("v 0 0 0\n")
    options = ["--workers", 0, "--time-limit", 1, "--retries", 0, "--blender", program(tmp_path, text)]
    assert run(capsys, tmp_path / "in", "--out", tmp_path / "out", *options)[0] == 1
    made = heads(tmp_path / "out")
    assert (made["a.blend"]["status"], made["a.blend"]["reason"]) == (status, reason)
    assert made["b.obj"]["status"] == "nothing"


@needs_shell
def test_a_blender_ends_with_the_process_that_has_opened_it(tmp_path, capsys):
    """As where the system is short of memory and ends that one."""
    (tmp_path / "a.blend").write_bytes(b"BLENDER")
    text = f"echo $$ >'{tmp_path / 'seen'}'; kill -KILL $PPID; exec sleep 60\n"
    options = ["--workers", 0, "--retries", 0, "--blender", program(tmp_path, text)]
    run(capsys, tmp_path / "a.blend", "--out", tmp_path / "out", *options)
    assert "ended by signal SIGKILL, as if memory were short" in heads(tmp_path / "out")["a.blend"]["reason"]
    assert is_gone(int((tmp_path / "seen").read_text()))


@pytest.mark.skipif(sys.platform != "linux", reason="Linux says how much memory a process has")
def test_a_blender_that_stays_without_memory_is_ended(tmp_path, capsys):
    (tmp_path / "a.blend").write_bytes(b"BLENDER")
    (tmp_path / "hog.py").write_text(_HOG + "take_all()\n")
    hog = program(tmp_path, f"exec '{sys.executable}' '{tmp_path / 'hog.py'}'\n")
    options = ["--workers", 0, "--retries", 0, "--memory-limit", 300, "--time-limit", 30, "--blender", hog]
    run(capsys, tmp_path / "a.blend", "--out", tmp_path / "out", *options)
    line = heads(tmp_path / "out")["a.blend"]
    assert (line["status"], line["reason"]) == ("memory limit", "The memory of 300 MB that a file may use was not enough")


def test_no_blender_is_said(tmp_path, capsys):
    (tmp_path / "a.blend").write_bytes(b"BLENDER")
    run(capsys, tmp_path / "a.blend", "--out", tmp_path / "out", "--workers", 0, "--blender", "no-such-program")
    assert "Name Blender with --blender" in heads(tmp_path / "out")["a.blend"]["reason"]
