"""Lines of the C++ core that its tests do not run, by function: scripts/lines.py LINES.json OUT.md, as scripts/coverage does.

LINES.json: of gcovr. A line that several instances of a template share is run where one of them is.
"""

from __future__ import annotations

import json
import re
import sys
from collections import defaultdict
from pathlib import Path


def short(demangled: str) -> str:
    """The name of a function without its arguments, room and templates; of a lambda, that it is one of another function."""
    inside = " (a lambda)" if "{lambda" in demangled else ""
    name = re.sub(r"\{lambda.*", "", demangled).replace("(anonymous namespace)::", "").replace("tripatch::", "")
    while (plain := re.sub(r"<[^<>]*>", "", name)) != name:
        name = plain
    name = re.sub(r"\[[^\]]*\]", "", name).split("(")[0].strip()
    return (name.split(" ")[-1].removesuffix("::") or demangled) + inside


def of_file(lines: list) -> tuple[int, dict[str, list[int]]]:
    """How many lines there are, and by function those that nothing has run."""
    counts: dict[int, int] = defaultdict(int)
    owners: dict[int, str] = {}
    for line in lines:
        number = line["line_number"]
        counts[number] += line["count"]
        owners.setdefault(number, line.get("function_name") or "")
    missing: dict[str, list[int]] = defaultdict(list)
    for number in sorted(counts):
        if not counts[number]:
            missing[short(owners[number])].append(number)
    return len(counts), missing


def ranges(numbers: list[int]) -> str:
    """3, 4, 5, 9: "3-5, 9"."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number <= parts[-1][1] + 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in parts)


def main() -> None:
    files = json.loads(Path(sys.argv[1]).read_text())["files"]
    total, rows = 0, []
    for file in sorted(files, key=lambda each: each["file"]):
        count, missing = of_file(file["lines"])
        total += count
        name = file["file"].removeprefix("native/").removeprefix("src/").removeprefix("include/tripatch/")
        rows += [(name, function, numbers) for function, numbers in missing.items()]
    never = sum(len(numbers) for _, _, numbers in rows)
    text = f"{total - never} of {total} lines ({100 * (total - never) / max(total, 1):.1f}%) are run.\n\n"
    text += "| file | function | lines | which |\n|---|---|---|---|\n"
    text += "".join(f"| {name} | `{function}` | {len(numbers)} | {ranges(numbers)} |\n" for name, function, numbers in rows)
    Path(sys.argv[2]).write_text(text)
    print(text, end="")


if __name__ == "__main__":
    main()
