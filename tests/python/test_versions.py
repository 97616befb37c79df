"""One version, written in the files that different tools read."""

import ast
import re
import tomllib
from importlib.metadata import version
from pathlib import Path

import tripatch

ROOT = Path(__file__).resolve().parents[2]


def test_the_version_is_the_same_everywhere():
    expected = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    addon = ROOT / "addon" / "tripatch_blender"
    bl_info = next(
        ast.literal_eval(node.value)
        for node in ast.parse((addon / "__init__.py").read_text()).body
        if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info"
    )
    found = {
        "installed package": version("tripatch"),
        "tripatch.__version__": tripatch.__version__,
        "CMakeLists.txt": re.search(r"project\(tripatch VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1],
        "blender_manifest.toml": tomllib.loads((addon / "blender_manifest.toml").read_text())["version"],
        "bl_info": ".".join(map(str, bl_info["version"])),
    }
    assert found == dict.fromkeys(found, expected)
