"""The code of the documentation runs; the Python reference has an example of every public name."""

import doctest
import importlib.util
import re
import shlex
import shutil
from pathlib import Path

import pytest
import tripatch
from tripatch.__main__ import main

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "reference" / "python.md"
TUTORIAL = ROOT / "docs" / "tutorial.md"


def blocks(text):
    """The Python code of a page."""
    return re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


PAGES = [page for page in sorted((ROOT / "docs").rglob("*.md")) if page != PAGE and blocks(page.read_text())]


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A folder that has the examples where a checkout has them, and may be written into."""
    shutil.copytree(ROOT / "docs" / "examples", tmp_path / "docs" / "examples")
    monkeypatch.chdir(tmp_path)


def sections():
    """Headings with their code, in the order of the page; the code before the first heading is that of ""."""
    parts = re.split(r"^##+ (.+)$", PAGE.read_text(), flags=re.MULTILINE)
    texts = zip(["", *parts[1::2]], parts[0::2], strict=True)
    return [(name, "\n".join(blocks(text))) for name, text in texts]


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


@pytest.mark.parametrize("name", [name for name in tripatch.__all__ if ">>>" in (getattr(tripatch, name).__doc__ or "")])
def test_the_example_of_a_docstring_runs(name):
    (example,) = doctest.DocTestFinder(recurse=False).find(getattr(tripatch, name), name, globs={"tripatch": tripatch})
    said = []
    assert doctest.DocTestRunner().run(example, out=said.append).failed == 0, "".join(said)


def test_functions_that_fill_have_an_example():
    names = ("fill", "fill_all", "fill_holes", "merge", "find_holes", "choose_holes", "outer_borders", "find_corners")
    assert [name for name in names if ">>>" not in getattr(tripatch, name).__doc__] == []


@pytest.mark.filterwarnings("error")
@pytest.mark.usefixtures("checkout")
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_code_of_each_page_runs_by_itself(page):
    names = {}
    for code in blocks(page.read_text()):
        if "write_step" in code and not importlib.util.find_spec("OCP"):
            with pytest.raises(ImportError, match=r"tripatch\[step\]"):
                exec(compile(code, page.name, "exec"), names)
        else:
            exec(compile(code, page.name, "exec"), names)


@pytest.mark.usefixtures("checkout")
def test_the_commands_of_the_tutorial_print_what_it_says(capsys):
    text = TUTORIAL.read_text(encoding="utf-8")
    commands = re.findall(r"^    env/bin/(tripatch .+)$", text, re.MULTILINE)
    assert [main(shlex.split(command)[1:]) for command in commands] == [0, 0]
    printed = re.search(r"The first command prints\n\n((?:    .+\n)+)", text)[1]
    assert capsys.readouterr().out.splitlines()[:2] == [line.strip() for line in printed.splitlines()]
