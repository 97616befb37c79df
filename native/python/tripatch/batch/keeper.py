"""Has files done by a process that may crash, run out of time or of memory: a new one takes its place."""

from __future__ import annotations

import contextlib
import functools
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

from ..messages import Message
from . import child, job, memory, record
from .journal import Journal
from .settings import FILL, Settings


class Stopped(Exception):
    """Nobody wants to know any more."""


class Ended(Exception):
    """The process is gone; says why."""

    def __init__(self, status: str, reason: str) -> None:
        super().__init__(reason)
        self.status, self.reason = status, reason


def _kill(process: subprocess.Popen[bytes]) -> None:
    """Ends it and what it has started."""
    if process.poll() is None:
        _kill_group(process)


def _kill_group(process: subprocess.Popen[bytes]) -> None:
    """Ends what it has started too where it is gone itself, but not long: its number may be another's by then."""
    with contextlib.suppress(OSError):
        if os.name == "posix":
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()


class Keeper:
    """Does one file at a time in a process of its own, which is made when first needed and again after `recycle` files."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._process: subprocess.Popen[bytes] | None = None
        self._done = 0
        self._stopped = False
        self._journal = Journal(Path(settings.out)) if settings.mode == FILL else None

    def __enter__(self) -> Keeper:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
        if self._journal:
            self._journal.close()

    def work(self, path: str, done_before: dict[str, Any] | None = None) -> dict[str, Any]:
        """`job.work`, whatever becomes of the process; what it answers is in a journal by then."""
        entry = self._worked(path, done_before)
        self.keep(entry, path, done_before)
        return entry

    def keep(self, entry: dict[str, Any], path: str, done_before: dict[str, Any] | None) -> None:
        """Puts what became of a file into a journal."""
        if not self._journal:
            return
        before = done_before or {}
        known, result = (True, before[entry["again"]]) if "again" in entry else (entry["key"], entry["output_sha256"])
        if known and not result:
            self._remove_old(path, before)
        if "again" not in entry:
            self._journal.add(entry)

    def _remove_old(self, path: str, before: dict[str, Any]) -> None:
        """Of a file that has no result: what a run with other options, or with another content, has written for it."""
        old = Path(self._settings.out, Path(path).relative_to(self._settings.root))
        if old.exists() and job.sha256_of(old) in before.values():
            with contextlib.suppress(OSError):
                old.unlink()

    def _worked(self, path: str, done_before: dict[str, Any] | None) -> dict[str, Any]:
        begun = time.monotonic()
        try:
            entry: dict[str, Any] = self.tried("tripatch.batch.job", "work", path, self._settings, done_before)
            return entry
        except Ended as end:
            status, reason = end.status, end.reason
        name = Path(path).relative_to(self._settings.root).as_posix()
        line = record.of_file(self._settings, name, sha256=job.sha256_of(Path(path)), status=status, reason=reason)
        return job.entry(self._settings, name, line["sha256"], [line], begun)

    def tried(self, module: str, function: str, *arguments: Any) -> Any:
        """As `call`, with further tries after a crash.

        Raises:
            Ended: none came to an end.
            Stopped: nobody wants to know any more.
        """
        for trial in range(self._settings.retries + 1):
            try:
                return self.call(module, function, *arguments)
            except Ended as end:
                if self._stopped:
                    raise Stopped from None
                if end.status == record.TIME_LIMIT or trial == self._settings.retries:
                    raise
        raise AssertionError

    def call(self, module: str, function: str, *arguments: Any) -> Any:
        """The value of a function, computed by the process.

        Raises:
            Ended: the process is gone, or the function has failed.
        """
        if self._done >= self._settings.recycle:
            self.close()
        process = self._process or self._started()
        if self._stopped:
            self.close()
            raise Stopped
        try:
            if not self._done:
                child.receive(process.stdout)  # it is ready
        except (EOFError, OSError):
            raise self._ended(False) from None
        self._done += 1
        late = threading.Event()

        def stop() -> None:
            late.set()
            _kill(process)

        limit = self._settings.time_limit
        timer = threading.Timer(limit, stop) if limit else None
        if timer:
            timer.daemon = True
            timer.start()
        try:
            child.send(process.stdin, (module, function, arguments))
            good, answer = child.receive(process.stdout)
        except (EOFError, OSError):
            raise self._ended(late.is_set()) from None
        finally:
            if timer:
                timer.cancel()
        if not good and answer == "MemoryError":
            self.close()
            raise Ended(record.MEMORY_LIMIT, job.memory_reason(self._settings))
        if not good:
            raise Ended(record.CRASHED, Message("failed_on_file", {"reason": str(answer)}))
        return answer

    def stop(self) -> None:
        """From another thread: the process ends at once, and who waits for it gets Stopped."""
        self._stopped = True
        process = self._process
        if process is not None:
            _kill(process)

    def close(self) -> None:
        """Ends the process."""
        process, self._process = self._process, None
        if process is not None and process.stdin and process.stdout:
            self._watch.over()
            with contextlib.suppress(OSError):
                process.stdin.close()
            _kill(process)
            process.wait()
            os.close(self._line)
            process.stdout.close()
            self._said.close()

    def _started(self) -> subprocess.Popen[bytes]:
        self._said = tempfile.TemporaryFile()  # what it writes to stderr: read if it ends
        package = os.fspath(Path(__file__).resolve().parents[2])  # the same TriPatch, installed or in a source tree
        paths = [package, *filter(None, [os.environ.get("PYTHONPATH")])]
        # -P: not the folder that the command was started in; one thread of BLAS: there is a process for each core
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "OPENBLAS_NUM_THREADS": "1"}
        if self._settings.threads:
            environment.setdefault("TRIPATCH_THREADS", str(self._settings.threads))
        line, self._line = os.pipe()
        command = [sys.executable, "-P", "-m", "tripatch.batch.child", str(self._settings.memory_limit or 0), str(line)]
        streams: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": self._said}
        group: dict[str, Any] = {"process_group": 0, "pass_fds": [line]} if os.name == "posix" else {}
        self._process = subprocess.Popen(command, env=environment, **streams, **group)
        os.close(line)
        self._done = 0
        self._watch = memory.Watch(self._process.pid, self._settings.memory_limit, functools.partial(_kill, self._process))
        return self._process

    def _ended(self, late: bool) -> Ended:
        process = self._process
        assert process is not None
        if process.poll() is None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(1)  # it is about to end by itself: its own code says more than SIGKILL
        _kill_group(process)
        code = process.wait()
        self._said.seek(0)
        lines = self._said.read().decode(errors="replace").strip().splitlines()
        self.close()
        if self._watch.found:
            return Ended(record.MEMORY_LIMIT, job.memory_reason(self._settings))
        if late:
            return Ended(record.TIME_LIMIT, Message("time_not_enough", {"seconds": f"{self._settings.time_limit:g}"}))
        if code < 0:  # Windows has no signals, not even their numbers
            said = {"signal": signal.Signals(-code).name}
            said |= {"memory": "1"} if said["signal"] == "SIGKILL" else {}
        else:
            shown = f"0x{code:08X}" if code > 0xFFFF else str(code)  # of an exception of Windows, as its manuals write it
            said = {"code": shown} | ({"reason": lines[-1][:200]} if lines else {})
        return Ended(record.CRASHED, Message("process_ended", {"program": "TriPatch", **said}))
