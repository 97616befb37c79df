"""The README's Python runs as it is printed."""

import re
from pathlib import Path


def test_the_sample_runs_as_printed_and_the_fill_lies_near_the_paraboloid():
    text = (Path(__file__).parents[2] / "README.md").read_text()
    (sample,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    names = {}
    exec(sample, names)
    x, y, z = names["fill"].vertices.T
    assert len(names["fill"].faces) == 25
    assert abs(z - x**2 - y**2).max() < 1e-4
