"""Mutants: one small change to the sources at a time, which a test ought to notice. Prints those that none does, and their share.

C++: the core is built in build/mutation with the change, and the tests run that include the changed file's header or have its
name, else those of its room; --thorough: all others too, where those notice nothing. Python: the package with the change, and
the tests named in TESTS. Which changes: drawn with --seed from all that the tables of this file allow, but for those in
equivalent.txt, which nobody could see; --set: those that a file like core.txt lists, which people have chosen.
"""

from __future__ import annotations

import argparse
import ast
import importlib.util
import os
import random
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TREE = ROOT / "build" / "mutation"
EQUIVALENT = Path(__file__).with_name("equivalent.txt")
# of the processor for the tests of a mutant: one that takes more is noticed, on a busy machine no sooner than on an idle one
SECONDS = 300

COMPARISONS = [(" < ", " >= "), (" > ", " <= "), (" <= ", " > "), (" >= ", " < "), (" == ", " != "), (" != ", " == ")]
ARITHMETIC = [(" + ", " - "), (" - ", " + "), (" * ", " / "), (" / ", " * "), (" += ", " -= "), (" -= ", " += ")]
CPP = [
    *COMPARISONS,
    *ARITHMETIC,
    (" && ", " || "),
    (" || ", " && "),
    ("std::min(", "std::max("),
    ("std::max(", "std::min("),
    ("return true;", "return false;"),
    ("return false;", "return true;"),
    ("if (!", "if ("),
    ("clearly_less(", "clearly_more("),
    ("clearly_more(", "clearly_less("),
    ("continue;", "break;"),
]
PYTHON = [
    *COMPARISONS,
    *ARITHMETIC,
    (" and ", " or "),
    (" or ", " and "),
    ("if not ", "if "),
    ("True", "False"),
    ("False", "True"),
    (" in ", " not in "),
    (" is None", " is not None"),
    (" is not None", " is None"),
]
NUMBER = re.compile(r"(?<![\w.\"'])(\d+\.\d+(?:e-?\d+)?|\d+e-?\d+|[1-9]\d*)(?![\w.\"'])")
ITERATION = re.compile(r"for _ in range\((?!1\))\d+\)|for \(int (it|step|round|pass) = 0; \w+ < (?!1\b)\d+;")

#: Tests of the package's files and folders; those of what is not named here run for all others.
TESTS = {
    "arguments": ["test_small_parts", "test_options", "test_cli", "test_files"],
    "attributes": ["test_attributes"],
    "batch/in_blender": ["test_batch_blender"],
    "batch": ["test_small_parts", "test_batch", "test_batch_farms"],
    "between": ["test_small_parts", "test_between"],
    "files": ["test_files", "test_file_attacks", "test_faults"],
    "patches": ["test_api", "test_blend", "test_polygon", "test_methods", "test_surfaces"],
    "quality": ["test_quality"],
    "view": ["test_quality", "test_small_parts"],
    "": [
        "test_api",
        "test_bad_input",
        "test_options",
        "test_controls",
        "test_report",
        "test_surfaces",
        "test_blend",
        "test_cage",
    ],
}


def cpp_lines(text):
    """Numbers of the lines that hold code in which changes can be seen."""
    for number, line in enumerate(text.splitlines()):
        code = line.split("//")[0].rstrip()
        if not code.strip() or code.lstrip().startswith(("#", "template", "using", "namespace", "static_assert", "case")):
            continue
        if "throw " in code or '"' in code or "check_interruption" in code or "reserve(" in code:
            continue
        yield number, code


def python_lines(text):
    docs = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            docs |= set(range(node.lineno - 1, node.end_lineno))
    for number, line in enumerate(text.splitlines()):
        code = line.split("  #")[0]
        plain = code.lstrip()
        if number in docs or not plain or plain.startswith(("#", "import", "from", "@", "def ", "class ")) or "raise " in plain:
            continue
        if '"' not in code or code.count('"') % 2 == 0:
            yield number, code


def other_number(code, value):
    if ITERATION.search(code):
        return "1"  # a step more of what has converged is seen by nobody
    return str(int(value) + 1) if value.isdigit() else f"{3 * float(value) or 1:g}"


def changes(text, python):
    """All mutants of a file: (line, what stands there, what is put there, column)."""
    found = []
    for number, code in (python_lines if python else cpp_lines)(text):
        strings = [m.span() for m in re.finditer(r'"[^"]*"', code)]
        outside = lambda at, strings=strings: not any(a <= at < b for a, b in strings)  # noqa: E731
        for old, new in PYTHON if python else CPP:
            found += [(number, old, new, m.start()) for m in re.finditer(re.escape(old), code) if outside(m.start())]
        for m in NUMBER.finditer(code):
            if outside(m.start()):
                found.append((number, m.group(), other_number(code, m.group()), m.start()))
    return found


def sources(python):
    folder = ROOT / ("native/python/tripatch" if python else "native/src")
    return sorted(path for path in folder.rglob("*.py" if python else "*.cpp") if "__" not in path.stem)


def drawn(python, count, seed, only, again):
    """Mutants of all files, or those that an earlier run has printed into the file `again`."""
    rng = random.Random(seed)
    known = {line.rsplit(" # ", 1)[0].strip() for line in EQUIVALENT.read_text().splitlines() if line.strip()}
    pool = []
    for path in sources(python):
        name = str(path.relative_to(ROOT))
        if only and not re.search(only, name):
            continue
        text = (TREE / name).read_text()  # as it was copied, whatever happens to the sources meanwhile
        pool += [(name, change, label(name, text, change) in known) for change in changes(text, python)]
    if again:
        named = {line.rsplit("  (line ")[0] for line in again.read_text().splitlines()}
        return [(name, change) for name, change, _ in pool if label(name, (TREE / name).read_text(), change) in named]
    sample = rng.sample(pool, min(count, len(pool)))  # what becomes known later does not change which others are drawn
    return [(name, change) for name, change, seen_by_nobody in sample if not seen_by_nobody]


def listed(path):
    """The mutants of a file, a line each: FILE: LINE | what stands there -> what is put there @ column # what it breaks."""
    found = []
    for line in path.read_text().splitlines():
        mutant = line.rsplit(" # ", 1)[0]
        name, rest = mutant.split(": ", 1)
        code, change = rest.rsplit(" | ", 1)
        old, new, column = re.fullmatch(r"(.*) -> (.*?) ?@ (\d+)", change).groups()
        lines = (TREE / name).read_text().splitlines()
        places = [n for n, there in enumerate(lines) if there.strip() == code and there.startswith(old, int(column))]
        if len(places) != 1:
            sys.exit(f"{path.name}: {len(places)} lines of the sources are that of {mutant}")
        found.append((name, (places[0], old, new, int(column))))
    return found


def label(name, text, change):
    number, old, new, column = change
    return f"{name}: {text.splitlines()[number].strip()} | {old.strip()} -> {new.strip()} @ {column}"


def changed(text, change):
    number, old, new, column = change
    lines = text.splitlines(keepends=True)
    lines[number] = lines[number][:column] + new + lines[number][column + len(old) :]
    return "".join(lines)


def run(command, seconds=None, **more):
    """Whether it ends well; a command that computes for too long does not, nor one that waits for ever."""
    if seconds:
        command = ["bash", "-c", f'ulimit -t {seconds}; exec "$@"', "bash", *command]
    with subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True, **more
    ) as process:
        try:
            return process.wait(timeout=20 * seconds if seconds else None) == 0
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            return False


def copied(folders):
    """What has changed only: a file that a mutant has left is newer than what was compiled from the mutant, and stays so."""
    for name in folders:
        own = ROOT / name
        files = [p for p in own.rglob("*") if p.is_file() and "__pycache__" not in p.parts] if own.is_dir() else [own]
        wanted = {TREE / path.relative_to(ROOT): path for path in files}
        for there, path in wanted.items():
            if not there.is_file() or there.read_bytes() != path.read_bytes():
                there.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, there)
        for there in (TREE / name).rglob("*"):
            if there.is_file() and there not in wanted:
                there.unlink()


class Cpp:
    def __init__(self, thorough):
        self.thorough = thorough
        copied(["CMakeLists.txt", "native", "tests/native"])
        self.build = TREE / "build/dev"  # as deep as a developer's, so that ccache knows what it has compiled there
        configure = ["cmake", "-S", TREE, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DTRIPATCH_TESTS=ON"]
        if not (run(configure) and self.made()):
            sys.exit(f"The core could not be built in {self.build}")

    def made(self):
        return run(["ninja", "-C", self.build, "tripatch_tests"])

    def noticed(self, name):
        """None where the mutant does not compile."""
        if not self.made():
            return None
        path = Path(name)
        texts = {test.stem: test.read_text() for test in (TREE / "tests/native").glob("test_*.cpp")}
        room = path.parent.name
        for header in (f"{room}/{path.stem}.h", f"tripatch/{room}/"):  # what has no tests of its own has those of its room
            near = [test for test, text in texts.items() if header in text or test == f"test_{path.stem}"]
            if near:
                break
        tests = [",".join(f"[#{test}]" for test in near)]
        if self.thorough:
            tests.append("".join(f"~[#{test}]" for test in near))
        return not all(run([self.build / "tripatch_tests", "-#", "-a", test], SECONDS) for test in tests)


class Python:
    def __init__(self, thorough):
        copied(["native/python/tripatch"])
        package = TREE / "native/python/tripatch"
        if not list(package.glob("_native.*.so")):  # the module of the installed package
            shutil.copy2(importlib.util.find_spec("tripatch._native").origin, package)
        self.thorough = thorough
        self.environment = os.environ | {"PYTHONPATH": str(TREE / "native/python"), "PYTHONDONTWRITEBYTECODE": "1"}

    def noticed(self, name):
        path = Path(name).relative_to("native/python/tripatch").with_suffix("")
        tests = TESTS.get(path.as_posix()) or TESTS.get(path.parts[0]) or TESTS[""]
        paths = [ROOT / "tests/python" / f"{test}.py" for test in tests]
        pytest = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
        stages = [paths] + ([[ROOT / "tests/python"]] if self.thorough else [])
        return not all(run([*pytest, *stage], SECONDS, env=self.environment, cwd=ROOT) for stage in stages)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("language", choices=["cpp", "python"])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", help="pattern that paths of files contain")
    parser.add_argument("--set", type=Path, help="a file that lists mutants: these, instead of drawn ones")
    parser.add_argument("--again", type=Path, help="what an earlier run has printed: those mutants only")
    parser.add_argument("--least", type=float, default=0, help="share that must be noticed, else the exit status is 1")
    parser.add_argument("--thorough", action="store_true")
    given = parser.parse_args()
    python = given.language == "python"
    bench = (Python if python else Cpp)(given.thorough)
    alive = noticed = 0
    if given.set:
        chosen = listed(given.set)
    else:
        chosen = drawn(python, given.count, given.seed, given.only, given.again)
    texts = {name: (TREE / name).read_text() for name, _ in chosen}
    for number, (name, change) in enumerate(chosen):
        print(f"{number} of {len(chosen)}, {alive} alive", file=sys.stderr, flush=True)
        place, text = TREE / name, texts[name]
        place.write_text(changed(text, change))
        result = bench.noticed(name)
        place.write_text(text)
        if result is None:
            continue
        noticed += result
        alive += not result
        if not result:
            print(f"{label(name, text, change)}  (line {change[0] + 1})", flush=True)
    print(f"{noticed} of {noticed + alive} mutants are noticed", flush=True)
    return 1 if noticed < given.least * (noticed + alive) else 0


if __name__ == "__main__":
    sys.exit(main())
