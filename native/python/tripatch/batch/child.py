"""The process that does files: it may crash or be ended, and costs the file that it was at.

Requests come as pickles on stdin, answers go as pickles to stdout; it ends when nobody asks any more.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import pickle
import queue
import select
import signal
import struct
import sys
import threading
from typing import Any

from . import memory

SIZE = struct.Struct("<Q")


def send(stream: Any, what: Any) -> None:
    """A pickle after its length."""
    data = pickle.dumps(what, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(SIZE.pack(len(data)) + data)
    stream.flush()


def receive(stream: Any) -> Any:
    """What `send` sent; EOFError at the end."""
    head = stream.read(SIZE.size)
    if len(head) < SIZE.size:
        raise EOFError
    (size,) = SIZE.unpack(head)
    data = stream.read(size)
    if len(data) < size:
        raise EOFError
    return pickle.loads(data)


def _end() -> None:
    """Ends this process and the Blender that it may have started."""
    if hasattr(os, "killpg") and os.getpgid(0) == os.getpid():
        os.killpg(0, signal.SIGKILL)
    os._exit(0)


def _end_with(line: int) -> None:
    """Has Linux do that when nobody holds the other end of a pipe any more, into which nobody writes.

    At once, also where a library keeps all code of Python waiting, or no memory is left for any.
    """
    if sys.platform == "linux":
        import fcntl

        with contextlib.suppress(OSError):  # what only looks like Linux may not know all of this
            fcntl.fcntl(line, fcntl.F_SETOWN, -os.getpgid(0))
            fcntl.fcntl(line, fcntl.F_SETSIG, signal.SIGKILL)
            fcntl.fcntl(line, fcntl.F_SETFL, fcntl.fcntl(line, fcntl.F_GETFL) | os.O_ASYNC)
        if select.select([line], [], [], 0)[0]:  # it has happened already
            _end()


def _read(requests: Any, waiting: queue.SimpleQueue[Any]) -> None:
    """Ends the process when the one that asks is gone, where the system has not."""
    while True:
        try:
            waiting.put(receive(requests))
        except (EOFError, OSError):
            _end()


def main() -> None:
    """Does what is asked for, one after the other."""
    _end_with(int(sys.argv[2]))
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that shares the work out
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)  # what a library prints is no answer
    memory.limit(int(sys.argv[1]))
    waiting: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(requests, waiting), daemon=True).start()
    importlib.import_module("tripatch.batch.job")  # before the time of the first file counts
    send(answers, "ready")
    while True:
        module, function, arguments = waiting.get()
        try:
            answer = True, getattr(importlib.import_module(module), function)(*arguments)
        except MemoryError:
            answer = False, "MemoryError"
        except Exception as error:
            answer = False, f"{type(error).__name__}: {error}"
        send(answers, answer)
        del answer  # which may be large


if __name__ == "__main__":
    main()
