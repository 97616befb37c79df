# SPDX-License-Identifier: GPL-3.0-or-later
"""Fills holes of a .blend without a window:

blender --background FILE.blend --python scripts/fill_holes.py -- --object NAME --out OUT.blend

`--help` after the `--` lists the options. The add-on must be installed, or this script lie in TriPatch's source tree.
"""

import importlib
import os
import sys

import addon_utils

NAME, EXTENSION = "tripatch_blender", "tripatch"  # its folder, and its id among extensions


def command_line():
    """The add-on's command line: of the installed add-on, else of the source tree."""
    installed = [module.__name__ for module in addon_utils.modules() if module.__name__.split(".")[-1] in (NAME, EXTENSION)]
    if installed:
        addon_utils.enable(installed[0])
        return importlib.import_module(installed[0] + ".command_line")
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    sys.path[:0] = [os.path.join(root, "native", "python"), os.path.join(root, "addon")]
    return importlib.import_module(NAME + ".command_line")


if __name__ == "__main__":
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    sys.exit(command_line().main(arguments, prog="fill_holes.py"))
