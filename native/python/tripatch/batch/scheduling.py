"""The files shared out by the workers of a Dask scheduler.

Files travel in portions, so that what a scheduler does for a task counts little. A worker that is lost costs Dask a repetition
of its portion; a portion that Dask gives up, because worker after worker was lost with it, is done file by file, and so the file
is found that costs the workers.
"""

from __future__ import annotations

import contextlib
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from .. import __version__
from ..messages import Message
from . import inputs, job, record
from .keeper import Ended, Keeper
from .parts import Answers, Task
from .settings import Settings

#: Seconds after which a process that has nothing to do ends: a worker of somebody else's may live for weeks.
_IDLE = 10.0

_keepers: dict[str, dict[Keeper, threading.Timer]] = {}  # those that are free, and what ends them
_lock = threading.Lock()


class SchedulerError(RuntimeError):
    """No scheduler to be had; the argument is a `Message`."""


@contextlib.contextmanager
def _a_keeper(settings: Settings) -> Any:
    """One that is free in this worker: processes outlive a portion."""
    label = repr(settings)
    with _lock:
        free = _keepers.setdefault(label, {})
        if free:
            keeper, idle = free.popitem()
            idle.cancel()
        else:
            keeper = Keeper(settings)
    try:
        yield keeper
    finally:
        idle = threading.Timer(_IDLE, _end_idle, (free, keeper))
        idle.daemon = True
        with _lock:
            free[keeper] = idle
        idle.start()


def _end_idle(free: dict[Keeper, threading.Timer], keeper: Keeper) -> None:
    with _lock:
        if free.get(keeper) is not threading.current_thread():
            return  # it has been asked since
        del free[keeper]
    keeper.__exit__()


def do_portion(portion: list[tuple[int, str, dict[str, Any] | None]], settings: Settings) -> list[tuple[int, dict[str, Any]]]:
    """On a worker: (place, path, what was before) of files -> (place, entry)."""
    if settings.version != __version__:
        raise SchedulerError(Message("other_version", {"found": __version__, "wanted": settings.version}))
    with _a_keeper(settings) as keeper:
        return [(k, keeper.work(path, before)) for k, path, before in portion]


def do_part(task: Task, settings: Settings) -> Any:
    """What became of a part of a mesh, or the status and the reason of its end."""
    with _a_keeper(settings) as keeper:
        try:
            return keeper.tried("tripatch.batch.parts", "fill", task, settings)
        except Ended as end:
            return end.status, str(end)


def run_parts(tasks: Iterator[Task], settings: Settings, address: str) -> Answers:
    """As `local.run_parts`, by the workers of a scheduler.

    Raises:
        SchedulerError: as of `run`.
        Ended: a part cost too many workers.
    """
    client = _client(address)
    from distributed import KilledWorker, as_completed

    waiting, places = as_completed(raise_errors=False), dict[str, int]()
    ahead = 2 * max(1, len(client.scheduler_info(n_workers=-1)["workers"]))

    def one() -> tuple[int, Any]:
        future = next(waiting)
        place, error = places.pop(future.key), future.exception() if future.status == "error" else None
        if isinstance(error, KilledWorker):
            raise Ended(record.CRASHED, Message("workers_lost"))
        if error:
            raise error
        if future.status != "finished":
            raise SchedulerError(Message("scheduler_gone", {"address": address}))
        answer = future.result()
        if isinstance(answer, tuple):
            raise Ended(*answer)
        return place, answer

    try:
        for place, task in enumerate(tasks):
            future = client.submit(do_part, task, settings, pure=False, retries=settings.retries)
            places[future.key] = place
            waiting.add(future)
            if len(places) > ahead:
                yield one()
        while places:
            yield one()
    finally:
        with contextlib.suppress(Exception):
            client.close(timeout=5)


def _client(address: str) -> Any:
    try:
        import distributed
    except ImportError:
        needed = {"what": "--scheduler", "package": "Dask", "install": "'tripatch[dask]'"}
        raise SchedulerError(Message("package_needed", needed)) from None
    try:
        return distributed.Client(address, timeout=30)
    except (OSError, ValueError) as error:
        raise SchedulerError(Message("no_scheduler", {"address": address, "reason": str(error)})) from error


def _given_up(k: int, file: Path, settings: Settings) -> tuple[int, dict[str, Any]]:
    name = file.relative_to(settings.root).as_posix()
    reason = Message("workers_lost")
    line = record.of_file(settings, name, sha256=job.sha256_of(file), status=record.CRASHED, reason=reason)
    return k, {"name": name, "key": None, "output_sha256": None, "seconds": 0.0, "lines": [line]}


def run(
    files: Sequence[Path],
    settings: Settings,
    before: Sequence[dict[str, Any] | None],
    take: Callable[[list[tuple[int, dict[str, Any]]]], None],
    address: str,
) -> None:
    """Does every file, and hands over (place in the list, entry) of those of each portion as it is done.

    Args:
        before: of each file what `job.work` wants of journals.
        address: of the scheduler; its workers see the files under the same paths.

    Raises:
        SchedulerError: Dask is not installed, or its scheduler cannot be had.
    """
    client = _client(address)
    from distributed import KilledWorker, as_completed

    submitted: dict[str, Any] = {}
    try:
        number = len(client.scheduler_info(n_workers=-1)["workers"])
        if not number:
            said = Message("scheduler_without_workers", {"address": address})
            print(f"tripatch: {said}", file=sys.stderr, flush=True)
            number = 1
        parts = inputs.portions(files, number)
        parts.sort(key=lambda part: -sum(inputs.size(files[k]) for k in part))  # the longest first: no worker is last alone

        def submit(places: Any) -> object:
            task = [(k, str(files[k]), before[k]) for k in places]
            # a portion is never another's: its key counts, and results are not kept from run to run
            future = client.submit(do_portion, task, settings, pure=False, retries=settings.retries)
            submitted[future.key] = future, places
            return future

        waiting = as_completed([submit(part) for part in parts], raise_errors=False)
        for future in waiting:
            _, places = submitted.pop(future.key)
            if future.status == "finished":
                take(future.result())
            elif future.status != "error":
                raise SchedulerError(Message("scheduler_gone", {"address": address}))
            elif isinstance(error := future.exception(), KilledWorker):
                if len(places) == 1:
                    take([_given_up(places[0], files[places[0]], settings)])
                else:
                    waiting.update([submit([k]) for k in places])
            else:
                raise error
            future.release()
    finally:
        with contextlib.suppress(Exception):
            client.cancel([future for future, _ in submitted.values()])
        with contextlib.suppress(Exception):
            client.close(timeout=5)
