"""What became of the files so far, in the folder of the results: the next run continues from there."""

from __future__ import annotations

import json
import os
import socket
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TextIO

from ..files.writing import unwritable, write_over
from . import record

FOLDER = ".tripatch-batch"
LINES = "tripatch-batch.jsonl"
SHEET = "tripatch-batch.png"

#: Names of files need not be text: bytes that are none are written as JSON's escapes, which every reader takes.
_NO_TEXT = "backslashreplace"


class Journal:
    """Entries of one process in a file of its own: runs at the same time, on other machines too, do not meet in one."""

    def __init__(self, out: Path) -> None:
        self._folder = out / FOLDER
        self._file: TextIO | None = None

    def before(self) -> dict[str, dict[str, dict[str, Any]]]:
        """What runs before have left: name -> key -> entry, the latest of each."""
        found: dict[str, dict[str, dict[str, Any]]] = {}
        for path in sorted(self._folder.glob("journal-*.jsonl")):
            for line in path.read_bytes().splitlines():
                try:
                    entry = json.loads(line)
                    found.setdefault(entry["name"], {})[entry["key"]] = entry
                except (ValueError, KeyError):
                    continue  # the run was killed while it wrote the line
        return found

    def add(self, entry: dict[str, Any]) -> None:
        """Kept from now on, also if this process is killed next; what has to be tried again is not kept."""
        if not entry["key"]:
            return
        if self._file is None:
            self._folder.mkdir(parents=True, exist_ok=True)
            name = f"journal-{time.time_ns():x}-{socket.gethostname()}-{os.getpid()}.jsonl"
            self._file = (self._folder / name).open("a", encoding="utf-8", errors=_NO_TEXT)
        self._file.write(record.text(entry) + "\n")
        self._file.flush()

    def close(self) -> None:
        if self._file:
            self._file.close()
            self._file = None


def prepare(out: Path) -> None:
    """Makes the folder of the results; FileError if nothing can be written there, which nobody wants to hear in the end."""
    try:
        (out / FOLDER).mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out / FOLDER):
            pass
    except OSError as error:
        raise unwritable(out, error) from error


def write_lines(out: Path, entries: Iterable[dict[str, Any]]) -> Path:
    """All lines, in the order of the files."""

    def save(part: Path) -> None:
        with part.open("w", encoding="utf-8", errors=_NO_TEXT, newline="\n") as file:
            for entry in entries:
                file.writelines(record.text(line) + "\n" for line in entry["lines"])

    write_over(out / LINES, save)
    return out / LINES
