"""What keeps the house easy to live in, told by its sources: small rooms, short functions, names that do not clash."""

import ast
import re
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = sorted((ROOT / "native" / "src").rglob("*.cpp"))
PUBLIC, PRIVATE = (ROOT / "native" / folder / "tripatch" for folder in ("include", "src/include"))
HEADERS = sorted([*PUBLIC.rglob("*.h"), *PRIVATE.rglob("*.h")])
BINDINGS = sorted((ROOT / "native" / "bindings").glob("*.cpp"))
MODULES = sorted(
    [*(ROOT / "native" / "python").rglob("*.py"), *(ROOT / "addon").rglob("*.py"), *(ROOT / "scripts").rglob("*.py")]
)
# lines of a function and of a module of Python, sources of a room, public headers
LONGEST, LINES, LARGEST, INSTALLED = 80, 500, 14, 25

pytestmark = pytest.mark.skipif(not SOURCES, reason="the sources of the library are not here")


def plain(text):
    """C++ without comments and literals, line for line."""

    def blank(match):
        return re.sub(r"[^\n]", " ", match[0])

    return re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|' + r"(?<![0-9])'(?:\\.|[^'\\\n])'", blank, text, flags=re.DOTALL)


def blocks(text):
    """(what stands before it, first line, last line) of everything in braces."""
    found, stack, start = [], [], 0
    for k, c in enumerate(text):
        if c == "{":
            before = text[start:k].strip()
            stack.append((before, text[:k].count("\n") + 1 - before.count("\n")))
            start = k + 1
        elif c == "}":
            before, line = stack.pop()
            found.append((before, line, text[:k].count("\n") + 1))
            start = k + 1
        elif c == ";" or (c == ":" and re.search(r"(public|private|protected)$", text[start:k])):
            start = k + 1
    assert not stack
    return found


def is_function(before):
    return re.search(r"\)\s*(const|noexcept|override|final|\s)*(->[^{]*|:[^{]*)?$", before) and not re.match(
        r"(if|for|while|switch|else|catch|struct|class|enum|namespace)\b", before
    )


def test_functions_are_read_as_written():
    function = 'int f(int a,\n      int b) {\n  if (a) {\n    return 1;  // }\n  }\n  return "{"[0];\n}\n'
    text = plain(function + "struct S {\n  S() : x(1) {}\n};\n")
    functions = [(line, end) for before, line, end in blocks(text) if is_function(before)]
    assert functions == [(1, 7), (9, 9)]


@pytest.mark.parametrize("path", [*SOURCES, *HEADERS, *BINDINGS], ids=lambda p: str(p.relative_to(ROOT / "native")))
def test_no_function_is_longer_than_a_screen(path):
    for before, line, end in blocks(plain(path.read_text())):
        assert not is_function(before) or end - line < LONGEST, f"line {line}: {before}"


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(ROOT)))
def test_no_function_of_python_is_longer_than_a_screen(path):
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            assert node.end_lineno - node.lineno < LONGEST, node.name


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(ROOT)))
def test_no_module_of_python_is_too_long(path):
    assert len(path.read_text().splitlines()) <= LINES


def rooms():
    found = defaultdict(list)
    for path in [*SOURCES, *BINDINGS]:
        found[path.parent].append(path)
    return found.items()


def test_no_room_is_crowded():
    assert {room.name: len(paths) for room, paths in rooms() if len(paths) > LARGEST} == {}


def test_few_headers_are_installed_and_they_include_no_others():
    assert len(list(PUBLIC.rglob("*.h"))) <= INSTALLED
    included = {name for header in PUBLIC.rglob("*.h") for name in re.findall(r'#include "(.*)"', header.read_text())}
    assert sorted(name for name in included if not (PUBLIC.parent / name).exists()) == []


def names(path):
    """What a source calls its own: in its anonymous namespaces, with the parameters of functions, which may be overloaded."""
    text, found = plain(path.read_text()), []
    lines = text.split("\n")
    for part in ("\n".join(lines[line:end]) for before, line, end in blocks(text) if before == "namespace"):
        found += re.findall(r"^(?:struct|class|enum class) (\w+)", part, flags=re.MULTILINE)
        found += re.findall(r"^(?:inline |static )*(?:constexpr|const) [\w:<>, ]+? (\w+)(?= =|\[)", part, flags=re.MULTILINE)
        declared = re.findall(r"^\w[\w:<>,*& \[\]]*? \*?&?(\w+)\(((?:[^(){};]|\([^()]*\))*)\)[^;{]*\{", part, flags=re.MULTILINE)
        found += [f"{name}({re.sub(r'[ ]*[a-z_0-9]*[ ]*(,|$)', ',', ' '.join(given.split()))})" for name, given in declared]
    return found


@pytest.mark.parametrize("room", [room for room, _ in rooms()], ids=lambda room: room.name)
def test_names_in_a_room_are_unique(room):
    """A wheel compiles each room as one source, and the bindings, in which every file sees the names of those before it."""
    owners = defaultdict(set)
    for path in dict(rooms())[room]:
        for name in names(path):
            owners[name].add(path.name)
    for header in [*(PUBLIC / room.name).glob("*.h"), *(PRIVATE / room.name).glob("*.h")]:
        for name in re.findall(r"^(?:struct|class|enum class) (\w+)(?!.*;)", plain(header.read_text()), flags=re.MULTILINE):
            owners[name].add(header.name)
    for function in [name for name in owners if "(" in name]:  # nor may it have the name of another file's constant
        if (value := function.split("(")[0]) in owners:
            owners[value] |= owners[function]
    assert {name: sorted(files) for name, files in owners.items() if len(files) > 1} == {}


def test_rooms_call_back_for_progress_and_samples_only():
    """The functions of a user, how far the work is, what vertices are called, what threads share, and terms made late."""
    allowed = {
        "piecewise_polynomial.h",
        "piecewise_polynomial.cpp",
        "fill.h",
        "interruption.h",
        "interruption.cpp",
        "messages.h",
        "messages.cpp",
        "parallel.h",
        "parallel.cpp",
        "point_formula.h",
        "point_formula.cpp",
    }
    holders = {path.name for path in [*SOURCES, *HEADERS] if "std::function" in plain(path.read_text())}
    assert holders <= allowed
