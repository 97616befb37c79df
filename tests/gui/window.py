"""Run by tests/gui/run in a Blender window: the scenarios of scenarios.py, all or those that are named, by mouse and keys. Each
leaves pictures in the folder; one that fails does not hinder the others."""

import os
import site
import sys
import traceback
from pathlib import Path

import addon_utils
import bpy

HERE = Path(__file__).resolve().parent
sys.path.append(str(HERE))
import scenarios  # noqa: E402
from hands import FOLDER, Window, clear  # noqa: E402

#: Seconds between two steps, in which Blender handles the events.
STEP = float(os.environ.get("TRIPATCH_STEP", "0.5"))
bpy.context.preferences.view.show_splash = False  # later is too late


def enable_addon():
    archive = os.environ.get("TRIPATCH_ZIP")
    if archive:
        bpy.ops.preferences.addon_install(filepath=archive, overwrite=True)
    else:
        root = HERE.parents[1]
        sys.path.insert(0, os.environ.get("TRIPATCH_PACKAGES") or str(root / "native" / "python"))
        addons = Path(bpy.utils.user_resource("SCRIPTS", path="addons", create=True))  # where the preferences look
        (addons / scenarios.ADDON).symlink_to(root / "addon" / scenarios.ADDON)
        sys.path.append(str(addons))
        for folder in (root / "build" / "env" / "dev").glob("lib/python3.*/site-packages"):
            site.addsitedir(str(folder))  # what pip install -e . made there finds the compiled module
    assert addon_utils.enable(scenarios.ADDON, default_set=True), "the add-on could not be enabled"


def chosen():
    names = sys.argv[sys.argv.index(str(FOLDER)) + 1 :] if str(FOLDER) in sys.argv else []
    return [s for s in scenarios.ALL + scenarios.PICTURES if s.__name__ in names] or scenarios.ALL[:]


class Run:
    """Goes through the scenarios step by step."""

    def __init__(self):
        enable_addon()
        self.window, self.left, self.passed, self.failed = Window(), chosen(), [], []
        self.name, self.steps = "", iter(())

    def step(self):
        """Seconds until the next one; None after the last."""
        try:
            wait = next(self.steps)
        except StopIteration:
            if self.name:
                self.passed.append(self.name)
            return self._begin()
        except Exception:
            traceback.print_exc()
            self.failed.append(self.name)
            self.window.shot(f"failed-{self.name}")
            return self._begin()
        return wait or STEP

    def _begin(self):
        if self.name:
            print(f"window: {'FAILED' if self.name in self.failed else 'passed'}: {self.name}", flush=True)
        if not self.left:
            return None
        scenarios.set_patience()
        scenario = self.left.pop(0)
        self.name = scenario.__name__
        self.window.press("ESC")
        clear(self.window)
        self.steps = scenario(self.window)
        return STEP


run = None


def tick():
    global run
    try:
        run = run or Run()
        wait = run.step()
        if wait:
            return wait
        code = int(bool(run.failed))
    except Exception:
        traceback.print_exc()
        code = 1
    if run:
        print(f"window: {len(run.passed)} scenarios passed, {len(run.failed)} failed", flush=True)
    sys.stdout.flush()
    os._exit(code)  # no question about the unsaved file


bpy.app.timers.register(tick, first_interval=2, persistent=True)
