"""No symbol of the shipped module binds to the copy of OpenSubdiv that Blender itself has loaded, nor to its C++ library."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

# Blender subdivides first, so that its own OpenSubdiv is loaded and in use when the module comes.
SCRIPT = """
import sys, bpy
bpy.ops.mesh.primitive_cube_add()
bpy.context.object.modifiers.new("Subdivision", "SUBSURF")
assert len(bpy.context.object.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices) > 8
sys.path.insert(0, {folder!r})
import numpy as np
from tripatch import _native
cube = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1.0, 1) for z in (-1.0, 1)])
faces = np.array([0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3])
assert np.abs(_native.limit_points(cube, np.arange(0, 25, 4), faces) - cube / 2).max() < 1e-15
"""


@pytest.mark.skipif("TRIPATCH_ZIP" not in os.environ, reason="only the shipped build hides its symbols")
def test_opensubdiv_is_our_own(addon, tmp_path):
    from tripatch import _native

    module = Path(_native.__file__)
    script = tmp_path / "use_both.py"
    script.write_text(SCRIPT.format(folder=str(module.parents[1])))
    if bpy.app.binary_path and bpy.app.background and Path(bpy.app.binary_path).name.startswith("blender"):
        command = [bpy.app.binary_path, "--background", "--factory-startup", "--python-exit-code", "1", "--python", script]
    else:
        command = [sys.executable, script]
    log = tmp_path / "bindings"
    debug = {"LD_DEBUG": "bindings", "LD_DEBUG_OUTPUT": str(log)}
    run = subprocess.run(command, env={**os.environ, **debug}, capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stdout + run.stderr

    bound, to_us = [], []
    for part in tmp_path.glob("bindings.*"):
        with part.open(errors="replace") as lines:
            for line in lines:
                if "binding file" in line and str(module) in line:
                    source, target = line.split("binding file ")[1].split(" to ", 1)
                    (bound if str(module) in source else to_us).append(target)
    assert any("PyErr_SetString" in b for b in bound), "the module's own bindings were not logged"
    assert [b for b in bound if "OpenSubdiv" in b or "libstdc++" in b] == []
    assert to_us == [] or all("PyInit__native" in t for t in to_us)
