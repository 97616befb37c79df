"""One Blender, told by its arguments what to do with the packaged extension; run by test_extension.py."""

import os
import sys
import time
from pathlib import Path

import bpy

import addon_utils  # isort: skip

MODULE = "bl_ext.user_default.tripatch"


def install(archive):
    assert bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True) == {"FINISHED"}
    assert addon_utils.check(MODULE)[1]


def enable():
    assert addon_utils.enable(MODULE) is not None


def fill():
    sys.path.append(str(Path(__file__).parent))
    import bmesh
    import scenes

    ob = scenes.add_hole()
    scenes.edit(ob)
    before = len(ob.data.polygons)
    assert bpy.ops.mesh.fill_smooth() == {"FINISHED"}
    assert len(bmesh.from_edit_mesh(ob.data).faces) > before
    bpy.ops.object.mode_set(mode="OBJECT")


def where():
    """The library is the installed wheel."""
    import tripatch

    assert ".local" in Path(tripatch.__file__).parts and "extensions" in Path(tripatch.__file__).parts, tripatch.__file__
    assert not any("tripatch" in path or "_vendor" in path for path in sys.path), "the extension adds no places to look"


def traces():
    """What an add-on that is on adds to Blender."""
    menus = [bpy.types.VIEW3D_MT_edit_mesh_faces, bpy.types.VIEW3D_MT_edit_mesh_context_menu, bpy.types.VIEW3D_MT_object]
    handlers = [
        f for each in ("depsgraph_update_post", "load_post", "undo_post", "redo_post") for f in getattr(bpy.app.handlers, each)
    ]
    drawn = [f for menu in menus for f in menu._dyn_ui_initialize()]
    functions = [f.__module__ for f in (*handlers, *drawn) if "tripatch" in getattr(f, "__module__", "")]
    classes = [name for name in dir(bpy.types) if "tripatch" in getattr(getattr(bpy.types, name), "__module__", "")]
    keys = bpy.context.window_manager.keyconfigs.addon
    maps = [item.idname for m in keys.keymaps for item in m.keymap_items if "fill_smooth" in item.idname] if keys else []
    own = [
        name for kind in (bpy.types.Scene, bpy.types.WindowManager, bpy.types.Object) for name in dir(kind) if "tripatch" in name
    ]
    return functions + classes + maps + own


def disable():
    assert traces()
    addon_utils.disable(MODULE)
    assert not traces(), traces()


def remove():
    repositories = bpy.context.preferences.extensions.repos
    index = next(k for k, r in enumerate(repositories) if r.module == "user_default")
    assert bpy.ops.extensions.package_uninstall(repo_index=index, pkg_id="tripatch") == {"FINISHED"}
    assert not traces(), traces()


def tell(path):
    Path(path).write_text("")


def wait(path):
    until = time.monotonic() + 120
    while not Path(path).exists():
        assert time.monotonic() < until, f"{path} never came"
        time.sleep(0.05)


for step in sys.argv[1:]:
    name, _, given = step.partition("=")
    globals()[name](*([given] if given else []))
print("all steps done", flush=True)
if bpy.app.version < (4, 3):  # conftest.py says how it would end
    os._exit(0)
