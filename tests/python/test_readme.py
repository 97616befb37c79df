"""The README's Python runs as it is printed."""

import re
from pathlib import Path

import pytest

README = Path(__file__).resolve().parents[2] / "README.md"
BLOCKS = re.findall(r"^```python\n(.*?)^```", README.read_text(), re.DOTALL | re.MULTILINE)


def test_there_is_python():
    assert any("tripatch.fill(" in block for block in BLOCKS)


@pytest.mark.parametrize("block", BLOCKS, ids=[str(k) for k in range(len(BLOCKS))])
def test_it_runs(block):
    exec(compile(block, README.name, "exec"), {})
