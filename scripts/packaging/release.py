"""What scripts/release changes in the source tree: the version in each file that has it, and the head of the changelog.

release.py [--check] VERSION; with --check nothing is changed, only what would be in the way is named.
"""

from __future__ import annotations

import datetime
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLACEHOLDER = "tripatch.example"
#: Files that name the version, and the line that does; tests/python/test_versions.py compares them.
PLACES = {
    "pyproject.toml": r'(?m)^(version = ")[^"]+(")$',
    "CMakeLists.txt": r"(?m)^(project\(tripatch VERSION )\S+( )",
    "CITATION.cff": r"(?m)^(version: )\S+()$",
    "native/python/tripatch/__init__.py": r'(?m)^(__version__ = ")[^"]+(")$',
    "addon/tripatch_blender/blender_manifest.toml": r'(?m)^(version = ")[^"]+(")$',
}


class NotReady(Exception):
    """Why there can be no release; the message is a sentence."""


def check(version: str, project: str, changelog: str) -> None:
    """Raises NotReady if there can be no such version, whatever has changed since the last one."""
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        raise NotReady(f"{version!r} is no version such as 1.2.3")
    if PLACEHOLDER in project:
        lines = [line for line in project.splitlines() if PLACEHOLDER in line]
        raise NotReady("These addresses in pyproject.toml are placeholders:\n  " + "\n  ".join(lines))
    if f"## [{version}]" in changelog:
        raise NotReady(f"CHANGELOG.md has a section {version} already")


def check_news(changelog: str) -> None:
    """Raises NotReady if the changelog has no news since the last release."""
    unreleased = re.search(r"(?ms)^## \[Unreleased\]\n(.*?)(?=^## \[|\Z)", changelog)
    if not unreleased or not re.search(r"(?m)^- ", unreleased[1]):
        raise NotReady("CHANGELOG.md lists nothing under Unreleased")


def with_section(changelog: str, version: str, date: str) -> str:
    """The changelog with what was unreleased as the section of a version."""
    return changelog.replace("## [Unreleased]\n", f"## [Unreleased]\n\n## [{version}] - {date}\n", 1)


def with_version(text: str, name: str, version: str) -> str:
    """The text of one of PLACES with another version."""
    new, count = re.subn(PLACES[name], rf"\g<1>{version}\g<2>", text)
    if count != 1:
        raise NotReady(f"{name} names its version {count} times where once is expected")
    return new


def main(version: str, *, only_check: bool) -> None:
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    check(version, (ROOT / "pyproject.toml").read_text(encoding="utf-8"), changelog)
    if only_check:
        return
    check_news(changelog)
    new = {name: with_version((ROOT / name).read_text(encoding="utf-8"), name, version) for name in PLACES}
    add_on = "addon/tripatch_blender/__init__.py"
    numbers = ", ".join(version.split("."))
    new[add_on] = re.sub(r'("version": )\([^)]*\)', rf"\g<1>({numbers})", (ROOT / add_on).read_text(encoding="utf-8"), count=1)
    today = datetime.datetime.now(datetime.UTC).date().isoformat()
    new["CHANGELOG.md"] = with_section(changelog, version, today)
    for name, text in new.items():
        (ROOT / name).write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    try:
        main(sys.argv[-1], only_check="--check" in sys.argv)
    except NotReady as fault:
        sys.exit(f"error: {fault}")
