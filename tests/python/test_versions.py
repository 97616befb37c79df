"""One version, written in the files that different tools read."""

import ast
import os
import re
import sys
import tomllib
from importlib.metadata import version
from pathlib import Path

import pytest
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
        "CITATION.cff": re.search(r"^version: (\S+)", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)[1],
        "bl_info": ".".join(map(str, bl_info["version"])),
    }
    assert found == dict.fromkeys(found, expected)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems have other C libraries")
def test_built_on_debian_12_it_runs_with_older_c_libraries():
    """What is shipped, the C++ library inside, with glibc 2.17; else with that of Rocky 9 and Ubuntu 22.04."""
    if tuple(map(int, os.confstr("CS_GNU_LIBC_VERSION").split()[1].split("."))) > (2, 36):
        pytest.skip("built with a newer C library, it asks for that")
    module = Path(tripatch._native.__file__).read_bytes()
    wanted = re.findall(rb"GLIBC_2\.(\d+)", module)
    assert wanted and max(map(int, wanted)) <= (34 if b"libstdc++.so" in module else 17)
