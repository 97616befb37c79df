"""The files on this machine: by threads, each of which has them done by a process of its own."""

from __future__ import annotations

import dataclasses
import os
import queue
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from . import inputs
from .keeper import Keeper
from .settings import Settings


def cores() -> int:
    """Those that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run(
    files: Sequence[Path],
    settings: Settings,
    before: Sequence[dict[str, Any] | None],
    take: Callable[[list[tuple[int, dict[str, Any]]]], None],
    workers: int | None = None,
) -> None:
    """Does every file, and hands over (place in the list, entry) of each as it is done.

    Args:
        before: of each file what `job.work` wants of journals.
        workers: processes; None: as many as there are cores.
    """
    number = max(1, min(cores() if workers is None else workers, len(files)))
    order = list(range(len(files)))
    if number > 1:
        # a fill takes the cores that no other process has: more threads than that only take turns
        settings = dataclasses.replace(settings, threads=max(1, cores() // number))
        order.sort(key=lambda k: -inputs.size(files[k]))  # the longest first: none is last alone
    keepers = [Keeper(settings) for _ in range(number)]
    free: queue.SimpleQueue[Keeper] = queue.SimpleQueue()
    for keeper in keepers:
        free.put(keeper)

    def work(k: int) -> tuple[int, dict[str, Any]]:
        keeper = free.get()
        try:
            return k, keeper.work(str(files[k]), before[k])
        finally:
            free.put(keeper)

    pool = ThreadPoolExecutor(number)
    try:
        for done in as_completed([pool.submit(work, k) for k in order]):
            take([done.result()])
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for keeper in keepers:
            keeper.stop()
        pool.shutdown()
        for keeper in keepers:
            keeper.__exit__()
