"""What the README shows runs as it is printed."""

import re
import shlex
from pathlib import Path

import pytest
import tripatch
from shapes import octant
from tripatch.__main__ import main

README = Path(__file__).resolve().parents[2] / "README.md"
BLOCKS = re.findall(r"^```python\n(.*?)^```", README.read_text(), re.DOTALL | re.MULTILINE)
COMMANDS = re.findall(r"^    (tripatch [^#\n]*)", README.read_text(), re.MULTILINE)


def test_there_are_python_and_commands():
    assert any("tripatch.fill_holes(" in block for block in BLOCKS)
    assert any(command.startswith("tripatch fill") for command in COMMANDS)


@pytest.mark.parametrize("block", BLOCKS, ids=[str(k) for k in range(len(BLOCKS))])
def test_python_runs(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(block, README.name, "exec"), {})


def test_commands_run_one_after_the_other(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    vertices, faces, *_ = octant()
    (tmp_path / "scans").mkdir()
    for path in ("scan.ply", "scans/scan.ply"):
        tripatch.write(path, (vertices, faces))
    for command in COMMANDS:
        assert main(shlex.split(command)[1:]) == 0, command
    assert Path("filled.ply").exists() and Path("zebra.png").exists() and any(Path("filled").glob("**/scan.ply"))
