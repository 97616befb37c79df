"""The files on this machine: by threads, each of which has them done by a process of its own."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import queue
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, as_completed, wait
from pathlib import Path
from typing import Any

from . import inputs
from .keeper import Keeper
from .parts import Answers, Task
from .settings import Settings


def cores() -> int:
    """Those that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextlib.contextmanager
def _processes(number: int, settings: Settings) -> Iterator[Callable[..., Future[Any]]]:
    """Begins work: a function gets the keeper of a process that is free, and what else is given, on a thread of its own."""
    keepers = [Keeper(settings) for _ in range(number)]
    free: queue.SimpleQueue[Keeper] = queue.SimpleQueue()
    for keeper in keepers:
        free.put(keeper)

    def work(function: Callable[..., Any], *given: Any) -> Any:
        keeper = free.get()
        try:
            return function(keeper, *given)
        finally:
            free.put(keeper)

    pool = ThreadPoolExecutor(number)
    try:
        yield lambda function, *given: pool.submit(work, function, *given)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for keeper in keepers:
            keeper.stop()
        pool.shutdown()
        for keeper in keepers:
            keeper.__exit__()


def run_parts(tasks: Iterator[Task], settings: Settings, workers: int | None) -> Answers:
    """Has parts of a mesh filled: of each its place and what became of it, as they are done. Few are held at a time.

    Raises:
        Ended: the process of a part, again and again.
    """
    number = max(1, cores() if workers is None else workers)
    settings = dataclasses.replace(settings, threads=max(1, cores() // number))

    def work(keeper: Keeper, place: int, task: Task) -> tuple[int, Any]:
        return place, keeper.tried("tripatch.batch.parts", "fill", task, settings)

    with _processes(number, settings) as submit:
        waiting = set[Future[tuple[int, Any]]]()
        for place, task in enumerate(tasks):
            waiting.add(submit(work, place, task))
            if len(waiting) > number:
                done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                yield from (each.result() for each in done)
        for each in as_completed(waiting):
            yield each.result()


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

    def work(keeper: Keeper, k: int) -> tuple[int, dict[str, Any]]:
        return k, keeper.work(str(files[k]), before[k])

    with _processes(number, settings) as submit:
        for done in as_completed([submit(work, k) for k in order]):
            take([done.result()])
