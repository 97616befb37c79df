"""Commands and jobs for render farms: every one a portion of a list of files, which needs nothing but the list."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..messages import Message
from . import journal
from .inputs import InputError

#: Of all but plain commands: what their managers do with them has not been tried.
NOT_TRIED = "It has not run under a manager yet"

KINDS = ("commands", "slurm", "openjd", "flamenco")

#: OpenJD allows 1024 values of a task parameter, SLURM 1001 tasks of an array unless configured otherwise.
_MAX_TASKS = 1000


def written_list(files: Sequence[Path], out: Path) -> Path:
    """The list of files, in the folder of the results."""
    broken = next((file for file in files if "\n" in str(file) or "\r" in str(file)), None)
    if broken:
        raise InputError(Message("line_break_in_name", {"path": repr(str(broken))}))
    path = out / journal.FOLDER / "files.txt"
    path.write_text("".join(f"{file}\n" for file in files), encoding="utf-8", errors="surrogateescape")
    return path


def _ranges(count: int, chunk: int) -> list[str]:
    return [f"{first}-{min(first + chunk - 1, count)}" for first in range(1, count + 1, chunk)]


def _line(command: list[str]) -> str:
    """The command for a shell of this system."""
    return subprocess.list2cmdline(command) if sys.platform == "win32" else shlex.join(command)


def _command(listed: Path, out: Path, words: list[str], range_: str | None) -> list[str]:
    part = ["--range", range_] if range_ else ["--workers", "0"]
    return ["tripatch", "batch", "--files", str(listed), *part, "--out", str(out), *words]


def _slurm(count: int, chunk: int, listed: Path, out: Path, words: list[str], memory: int | None) -> str:
    tasks = len(_ranges(count, chunk))
    portion = shlex.join(_command(listed, out, words, "RANGE")).replace(
        "--range RANGE", f'--range "$first-$((first + {chunk - 1}))"'
    )
    return f"""\
#!/bin/bash
# {NOT_TRIED}.
# {count} files in portions of {chunk}; then what gathers their lines and the picture of the worst seams. Saved as fill.sbatch:
#   job=$(sbatch --parsable fill.sbatch) && sbatch --dependency=afterany:$job --array=0 fill.sbatch gather
#SBATCH --job-name=tripatch
#SBATCH --array=0-{tasks - 1}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --mem={(memory or 2000) + 500}M
set -eu
if [ "${{1:-}}" = gather ]; then
  exec {shlex.join(_command(listed, out, words, None))}
fi
first=$((SLURM_ARRAY_TASK_ID * {chunk} + 1))
exec {portion}
"""


def _openjd(count: int, chunk: int, words: list[str], listed: Path, out: Path) -> str:
    def step(name: str, part: list[str]) -> dict[str, Any]:
        arguments = ["batch", "--files", "{{Param.Files}}", *part, "--out", "{{Param.Out}}", *words]
        return {"name": name, "script": {"actions": {"onRun": {"command": "tripatch", "args": arguments}}}}

    ranges = [{"name": "Range", "type": "STRING", "range": _ranges(count, chunk)}]
    fill = step("Fill", ["--range", "{{Task.Param.Range}}"]) | {"parameterSpace": {"taskParameterDefinitions": ranges}}
    gather = step("Gather", ["--workers", "0"]) | {"dependencies": [{"dependsOn": "Fill"}]}
    template = {
        "specificationVersion": "jobtemplate-2023-09",
        "name": "TriPatch: fill holes",
        "parameterDefinitions": [
            # strings: paths with defaults must lie next to the template, which is wherever the text is put
            {"name": "Files", "type": "STRING", "default": str(listed)},
            {"name": "Out", "type": "STRING", "default": str(out)},
        ],
        "steps": [fill, gather],
    }
    return json.dumps(template, indent=2) + "\n"


def _flamenco(count: int, chunk: int, words: list[str], listed: Path, out: Path) -> str:
    platform = {"win32": "windows"}.get(sys.platform, sys.platform)
    settings = {"files": str(listed), "out": str(out), "count": count, "chunk_size": chunk, "options": json.dumps(words)}
    job = {"name": "TriPatch: fill holes", "type": "tripatch-batch", "priority": 50, "submitter_platform": platform}
    return json.dumps(job | {"settings": settings, "metadata": {}}, indent=2) + "\n"


def emitted(kind: str, files: Sequence[Path], out: Path, words: list[str], chunk: int, memory: int | None) -> tuple[str, str]:
    """The text for the farm, and what a person has to know of it."""
    listed, count = written_list(files, out), len(files)
    chunk = max(chunk, -(-count // _MAX_TASKS))
    if kind == "commands":
        text = "".join(_line(_command(listed, out, words, range_)) + "\n" for range_ in _ranges(count, chunk))
        return text, Message("commands_emitted", {"command": _line(_command(listed, out, words, None))})
    if kind == "slurm":
        return _slurm(count, chunk, listed, out, words, memory), Message("script_emitted")
    if kind == "openjd":
        return _openjd(count, chunk, words, listed, out), Message("template_emitted")
    return _flamenco(count, chunk, words, listed, out), Message("job_emitted")
