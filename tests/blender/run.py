"""Runs pytest inside a Blender program, which has none of its own:

    blender --background --factory-startup --python-exit-code 1 --python tests/blender/run.py -- PYTEST_FOLDER [pytest arguments]

PYTEST_FOLDER holds pytest and hypothesis, and nothing of TriPatch.
"""

import sys

folder, *arguments = sys.argv[sys.argv.index("--") + 1 :]
sys.path.append(folder)

import pytest  # noqa: E402

code = pytest.main(arguments)
if code != 0:
    raise SystemExit(int(code))
