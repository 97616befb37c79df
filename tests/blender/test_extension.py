"""The packaged extension as users have it: installed into a Blender with its own settings, used, switched off, removed. Nothing
is left, also where two Blenders use one folder of extensions."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

STEPS = Path(__file__).with_name("extension_steps.py")
ARCHIVE = os.environ.get("TRIPATCH_ZIP", "")

pytestmark = pytest.mark.skipif(
    not ARCHIVE or bpy.app.version < (4, 2) or not getattr(bpy.app, "module", bpy.app.version < (4, 3)),
    reason="TRIPATCH_ZIP names no extension, or this Blender has none",
)


def start(resources, *steps):
    """A Blender that does these steps."""
    own = {name: value for name, value in os.environ.items() if not name.startswith("BLENDER_USER_") and name != "PYTHONPATH"}
    environment = own | {"BLENDER_USER_RESOURCES": str(resources)}
    command = [sys.executable, str(STEPS), *steps]
    return subprocess.Popen(command, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def finish(blender):
    out, _ = blender.communicate(timeout=300)
    assert blender.returncode == 0 and "all steps done" in out, out


def left(resources):
    """Files that name the add-on or its library."""
    return [p for p in Path(resources).rglob("*") if "tripatch" in p.name.lower()]


def test_what_is_installed_fills_and_leaves_nothing_when_it_is_removed(tmp_path):
    finish(start(tmp_path, f"install={ARCHIVE}", "where", "fill"))
    assert left(tmp_path)
    finish(start(tmp_path, "enable", "where", "fill", "disable", "enable", "fill", "remove"))
    assert not left(tmp_path)


def test_two_blenders_share_a_folder_of_extensions(tmp_path):
    """One continues filling while the other removes the add-on and installs it again."""
    finish(start(tmp_path, f"install={ARCHIVE}"))
    ready, gone = tmp_path / "ready", tmp_path / "gone"
    one = start(tmp_path, "enable", "fill", f"tell={ready}", f"wait={gone}", "fill", "disable")
    finish(start(tmp_path, f"wait={ready}", "enable", "fill", "remove", f"tell={gone}"))
    finish(one)
    assert not left(tmp_path)
    finish(start(tmp_path, f"install={ARCHIVE}", "where", "fill", "remove"))
    assert not left(tmp_path)
