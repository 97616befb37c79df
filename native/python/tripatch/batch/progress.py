"""How far a run is: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Callable
from typing import Any

from ..messages import Message
from . import record

#: Seconds between two looks at a bar, and between two plain lines.
_BAR, _LINES = 0.1, 30.0


def duration(seconds: float) -> str:
    """'2 h 05 min', '3 min 20 s' or '12 s'."""
    whole = round(seconds)
    if whole >= 3600:
        return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
    return f"{whole // 60} min {whole % 60:02d} s" if whole >= 60 else f"{whole} s"


class Progress:
    """Told of every entry; says so on stderr."""

    def __init__(self, total: int, stream: Any = None) -> None:
        self._total, self._stream = total, stream or sys.stderr
        self._begun = self._said = time.monotonic()
        self._done = self._again = self._holes = self._failed = 0
        self._terminal = self._stream.isatty()

    def add(self, entries: list[dict[str, Any]]) -> None:
        self._done += len(entries)
        self._again += sum(bool(entry.get("again")) for entry in entries)
        self._holes += sum(entry["lines"][0]["filled"] for entry in entries)
        self._failed += sum(entry["lines"][0]["status"] in record.FAILED for entry in entries)
        now = time.monotonic()
        if now - self._said >= (_BAR if self._terminal else _LINES):
            self._said = now
            self._say(now)

    def parts(self, name: str) -> Callable[[int, int], None]:
        """What is to be told how many parts of a file are filled."""

        def tell(done: int, parts: int) -> None:
            now = time.monotonic()
            if now - self._said >= (_BAR if self._terminal else _LINES) or done == parts:
                self._said = now
                text = Message("parts_progress", {"done": done, "parts": parts, "file": name})
                end = "" if self._terminal else "\n"
                print(f"\r{text}" if self._terminal else f"tripatch: {text}", end=end, file=self._stream, flush=True)

        return tell

    def end(self) -> None:
        """The last word, which also stands where there is no terminal."""
        if not self._done:
            return
        self._say(time.monotonic())
        if self._terminal:
            print(file=self._stream, flush=True)

    def _say(self, now: float) -> None:
        counts = {"holes": self._holes, "failed": self._failed, "again": self._again}
        said: dict[str, Any] = {"done": self._done, "files": self._total} | {name: n for name, n in counts.items() if n}
        fresh = self._done - self._again
        if fresh and self._done < self._total:
            said["left"] = duration((now - self._begun) / fresh * (self._total - self._done))
        text = Message("batch_progress", said)
        if not self._terminal:
            print(f"tripatch: {text}", file=self._stream, flush=True)
            return
        columns = shutil.get_terminal_size().columns
        width = max(0, min(30, columns - len(text) - 4))
        full = width * self._done // self._total
        bar = "[" + "#" * full + "." * (width - full) + "] " if width >= 5 else ""
        print(f"\r{(bar + text)[: columns - 1]:<{columns - 1}}", end="", file=self._stream, flush=True)
