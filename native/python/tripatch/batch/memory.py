"""What memory a process may have, and what becomes of one that stays without."""

from __future__ import annotations

import re
import sys
import threading
from collections.abc import Callable
from pathlib import Path

#: Seconds between two looks at a process.
_LOOK = 1.0


#: Whether a process can limit itself: Windows has limits for jobs of processes only, and macOS ignores its own.
LIMITS = sys.platform not in ("win32", "darwin")


def limit(megabytes: int | None) -> None:
    """This process asks for no more than so much: what it asks for then fails as MemoryError. No effect without `LIMITS`."""
    if not megabytes or not LIMITS:
        return
    import resource

    for kind in (resource.RLIMIT_DATA, resource.RLIMIT_AS) if sys.platform != "linux" else (resource.RLIMIT_DATA,):
        _, hard = resource.getrlimit(kind)
        wanted = megabytes * 2**20
        resource.setrlimit(kind, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))


def _has_none(pid: int, megabytes: int) -> bool:
    """Whether a process has nothing left of its limit that a small request could have. False where the system does not say."""
    try:
        used = re.search(rb"VmData:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_bytes())
    except OSError:
        return False
    return used is not None and int(used[1]) > megabytes * 1024 - 256


class Watch:
    """Looks at a process and has it ended if it stays without memory.

    Some stay so for ever: CPython up to 3.11 at least has no memory for the MemoryError itself, tries again, and no thread of it
    runs meanwhile.

    Attributes:
        found: whether it has been ended so.
    """

    def __init__(self, pid: int, megabytes: int | None, end: Callable[[], object]) -> None:
        self.found = False
        self._over = threading.Event()
        if megabytes:
            threading.Thread(target=self._look, args=(pid, megabytes, end), daemon=True).start()

    def over(self) -> None:
        """The process has ended: there may be another of its number soon."""
        self._over.set()

    def _look(self, pid: int, megabytes: int, end: Callable[[], object]) -> None:
        before = False
        while not self._over.wait(_LOOK):
            now = _has_none(pid, megabytes)
            if now and before:
                self.found = True
                end()
                return
            before = now
