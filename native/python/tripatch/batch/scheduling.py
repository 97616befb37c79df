"""The files shared out by Dask: workers on this machine, or those of any scheduler.

Files travel in portions, so that what a scheduler does for a task counts little. A worker that is lost costs Dask a repetition
of its portion; a portion that Dask gives up, because worker after worker was lost with it, is done file by file, and so the file
is found that costs the workers.
"""

from __future__ import annotations

import contextlib
import dataclasses
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .. import __version__
from . import inputs, job, record
from .keeper import Keeper, Stopped
from .settings import Settings

NEEDED = (
    "Sharing the work out needs Dask: pip install 'tripatch[batch]'. Without it --workers 0 does the files one after the other, "
    "and --emit makes commands for a render farm"
)

#: Seconds after which a process that has nothing to do ends: a worker of somebody else's may live for weeks.
_IDLE = 10.0

_keepers: dict[str, dict[Keeper, threading.Timer]] = {}  # those that are free, and what ends them
_all: set[Keeper] = set()
_over = threading.Event()  # in the process that shares the work out: nothing more is to be begun
_lock = threading.Lock()


class SchedulerError(RuntimeError):
    """No scheduler to be had; the message is a sentence."""


@contextlib.contextmanager
def _a_keeper(settings: Settings) -> Any:
    """One that is free in this worker: processes outlive a portion."""
    label = repr(settings)
    with _lock:
        if _over.is_set():
            raise Stopped
        free = _keepers.setdefault(label, {})
        if free:
            keeper, idle = free.popitem()
            idle.cancel()
        else:
            keeper = Keeper(settings)
            _all.add(keeper)
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
        _all.discard(keeper)
    keeper.__exit__()


def do_portion(portion: list[tuple[int, str, dict[str, Any] | None]], settings: Settings) -> list[tuple[int, dict[str, Any]]]:
    """On a worker: (place, path, what was before) of files -> (place, entry)."""
    if settings.version != __version__:
        raise SchedulerError(f"The workers have TriPatch {__version__}, and {settings.version} is asked for")
    with _a_keeper(settings) as keeper:
        return [(k, keeper.work(path, before)) for k, path, before in portion]


def _end_keepers() -> None:
    """Where the workers are threads of this process: theirs end at once, and nobody waits for what they are at."""
    with _lock:
        _over.set()
        for keeper in _all:
            keeper.stop()
        for free in _keepers.values():
            while free:
                keeper, idle = free.popitem()
                idle.cancel()
                keeper.__exit__()
        _keepers.clear()
        _all.clear()


def _client(workers: int | None, address: str | None, files: int) -> Any:
    try:
        import dask
        import distributed
    except ImportError:
        raise SchedulerError(NEEDED) from None
    if address:
        try:
            return distributed.Client(address, timeout=30), None
        except (OSError, ValueError) as error:
            raise SchedulerError(f"There is no Dask scheduler at {address}: {error}") from error
    settings = {
        "distributed.worker.memory.target": False,  # entries are small; the processes that fill have a limit of their own
        "distributed.worker.memory.spill": False,
        "distributed.worker.memory.pause": False,
        "distributed.worker.memory.terminate": False,
        "distributed.worker.profile.enabled": False,  # nobody looks at it, and each process wakes up a hundred times a second
        "distributed.admin.tick.interval": "500ms",
        "distributed.admin.system-monitor.interval": "2s",
        "distributed.admin.system-monitor.gil.enabled": False,
    }
    with dask.config.set(settings):
        cluster = distributed.LocalCluster(
            n_workers=min(workers or max(1, dask.system.CPU_COUNT), files),
            threads_per_worker=1,
            processes=False,  # each file is done by a process of its keeper's: workers only wait for it
            memory_limit=0,
            dashboard_address=":0",  # any free port: two batches at once must not argue over one
            silence_logs=50,
        )
    return distributed.Client(cluster), cluster


def _given_up(k: int, file: Path, settings: Settings) -> tuple[int, dict[str, Any]]:
    name = file.relative_to(settings.root).as_posix()
    reason = "Every worker that was given it was lost"
    line = record.of_file(settings, name, sha256=job.sha256_of(file), status=record.CRASHED, reason=reason)
    return k, {"name": name, "key": None, "output_sha256": None, "seconds": 0.0, "lines": [line]}


def run(
    files: Sequence[Path],
    settings: Settings,
    before: Sequence[dict[str, Any] | None],
    take: Callable[[list[tuple[int, dict[str, Any]]]], None],
    workers: int | None = None,
    address: str | None = None,
) -> None:
    """Does every file, and hands over (place in the list, entry) of those of each portion as it is done.

    Args:
        before: of each file what `job.work` wants of journals.
        workers: processes on this machine; None: as many as it has cores.
        address: of a scheduler instead; its workers see the files under the same paths.

    Raises:
        SchedulerError: Dask is not installed, or its scheduler cannot be had.
    """
    client, cluster = _client(workers, address, len(files))
    _over.clear()
    import dask
    from distributed import KilledWorker, as_completed

    try:
        if cluster is None:
            number = len(client.scheduler_info(n_workers=-1)["workers"])
        else:
            number = len(cluster.workers)
            # a fill takes the cores that no other process has: more threads than that only take turns
            settings = dataclasses.replace(settings, threads=max(1, dask.system.CPU_COUNT // number))
        if not number:
            print(f"tripatch: The scheduler at {address} has no worker yet; the files wait for one", file=sys.stderr, flush=True)
            number = 1
        parts = inputs.portions(files, number)
        parts.sort(key=lambda part: -sum(inputs.size(files[k]) for k in part))  # the longest first: no worker is last alone
        submitted = {}

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
                raise SchedulerError(f"The scheduler at {address} is gone; the same command goes on with what is left")
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
        if cluster is not None:
            _end_keepers()
        with contextlib.suppress(Exception):
            client.close(timeout=5)
        if cluster is not None:
            with contextlib.suppress(Exception):
                cluster.close(timeout=5)
