"""What every page of measurements says of itself, and where the measuring takes place."""

from __future__ import annotations

import datetime
import platform
import subprocess
from dataclasses import dataclass
from pathlib import Path

import tripatch

ROOT = Path(__file__).resolve().parents[2]
MARKS = "<!-- measurements: scripts/figures -->", "<!-- end of measurements -->"


@dataclass
class Setting:
    docs: Path  # where the pages are written
    cache: Path  # what other programs write
    cgal: str | None  # the compiled cgal_fill
    pmp: str | None  # the compiled pmp_fill
    blender: str
    quick: bool  # a try of everything on little; its pages are not for docs/


def processor() -> str:
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":")[1].strip()
    return platform.machine()


def compiler() -> str:
    """That of this machine, which makes its wheels."""
    return subprocess.run(["c++", "--version"], capture_output=True, text=True).stdout.partition("\n")[0] or "unknown"


def commit() -> str:
    """The short name of the commit that is measured, and whether the sources differ from it."""

    def git(*words):
        return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True).stdout.strip()

    changed = git("status", "--porcelain", "--untracked-files=no", "--", "native", "scripts", "CMakeLists.txt", "pyproject.toml")
    return (git("rev-parse", "--short=10", "HEAD") or "unknown") + (" with changes" if changed else "")


def provenance(options: str, quick: bool = False) -> str:
    """The line that every page has. options: those of the fills on it."""
    tried = " A try on few cases (--quick)." if quick else ""
    return (
        f"Written by `scripts/figures`; do not edit. {datetime.date.today()}, commit {commit()}, version {tripatch.__version__}, "
        f"{processor()}.\nOptions: {options}.{tried}"
    )


def write_table(setting: Setting, page: str, options: str, table: str) -> None:
    """Into a page that people write, between its two marks."""
    text = (ROOT / "docs" / page).read_text()
    before, rest = text.split(MARKS[0])
    after = rest.split(MARKS[1])[1]
    made = f"{provenance(options, setting.quick)}\n\n{table}"
    (setting.docs / page).parent.mkdir(exist_ok=True)
    (setting.docs / page).write_text(f"{before}{MARKS[0]}\n{made}{MARKS[1]}{after}")
