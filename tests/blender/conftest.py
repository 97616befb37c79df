"""These tests run in a Blender: `bpy` as a module (pytest), or Debian's (blender --background --python tests/blender/run.py).

TRIPATCH_ZIP names the packaged add-on, which is then installed as a user would install it, into a user folder of its own: that is
what scripts/test does. Without it, while developing, the add-on and the package come from the source tree; TRIPATCH_PACKAGES
names a folder where the package is installed instead.
"""

import atexit
import os
import site
import sys
import tempfile
from pathlib import Path

import pytest

if "bpy" not in sys.modules and not os.environ.get("BLENDER_USER_RESOURCES"):
    os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="tripatch-blender-")  # never the user's own settings

import bpy  # makes Blender's own modules importable

import addon_utils  # isort: skip

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(Path(__file__).parent))  # for scenes.py


def _install(archive: str) -> str:
    """Installs and enables a packaged add-on; returns the name of its Python module."""
    if bpy.app.version >= (4, 2):
        bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True)
        return "bl_ext.user_default.tripatch"
    bpy.ops.preferences.addon_install(filepath=archive, overwrite=True)
    bpy.ops.preferences.addon_enable(module="tripatch_blender")
    return "tripatch_blender"


def _enable() -> str:
    archive = os.environ.get("TRIPATCH_ZIP")
    if archive:
        name = _install(archive)
    else:
        packages = os.environ.get("TRIPATCH_PACKAGES")
        sys.path[:0] = [packages or str(ROOT / "native" / "python"), str(ROOT / "addon")]
        for folder in () if packages else (ROOT / "build" / "env" / "dev").glob("lib/python3.*/site-packages"):
            site.addsitedir(str(folder))  # what pip install -e . made there finds the compiled module
        name = "tripatch_blender"
        addon_utils.enable(name)
    assert addon_utils.check(name)[1], f"{name} could not be enabled"
    return name


ADDON = _enable()  # before the tests are read: they import the package that the add-on brings


@pytest.fixture(scope="session", autouse=True)
def addon():
    """The enabled add-on: its Python module."""
    yield sys.modules[ADDON]
    addon_utils.disable(ADDON)  # a class that is still registered hangs bpy 4.5 at exit


def pytest_sessionfinish(exitstatus):
    """bpy 4.2 crashes at exit once any class of properties with an `update` function was registered, unregistered or not."""
    if (4, 2) <= bpy.app.version < (4, 3):
        atexit.register(os._exit, exitstatus)


@pytest.fixture(autouse=True)
def empty_scene(addon):
    """Nothing is left of the test before."""
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    for data in (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.node_groups, bpy.data.libraries):
        for block in list(data):
            data.remove(block)


@pytest.fixture
def live(addon):
    """Its module of live fills."""
    return sys.modules[addon.__name__ + ".live"]


@pytest.fixture
def following(addon):
    """Its module that fills them again, which follows nothing before and after."""
    module = sys.modules[addon.__name__ + ".following"]
    module._on_load()
    yield module
    module._on_load()
