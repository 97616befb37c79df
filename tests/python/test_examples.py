"""The Python reference: every public name is in it with an example, and the examples run."""

import re
from pathlib import Path

import pytest
import tripatch

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "python.md"


def sections():
    """Headings with their code, in the order of the page; the code before the first heading is that of ""."""
    parts = re.split(r"^##+ (.+)$", PAGE.read_text(), flags=re.MULTILINE)
    texts = zip(["", *parts[1::2]], parts[0::2], strict=True)
    return [(name, "\n".join(re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE))) for name, text in texts]


def test_the_examples_of_the_reference_run_one_after_another(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = {}
    for name, code in sections():
        exec(compile(code, f"{PAGE.name}: {name}", "exec"), names)


@pytest.mark.parametrize("name", tripatch.__all__)
def test_every_public_name_has_an_example_that_uses_it(name):
    (code,) = [code for heading, code in sections() if heading == name]
    assert re.search(rf"\btripatch\.{name}\b", code)
    assert f":: tripatch.{name}\n" in PAGE.read_text() or name in ("METHODS", "OPTIONS", "SURROUNDING_RINGS")
