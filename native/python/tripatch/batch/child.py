"""The process that does files: it may crash or be ended, and costs the file that it was at.

Requests come as pickles on stdin, answers go as pickles to stdout; it ends when nobody asks any more.
"""

from __future__ import annotations

import importlib
import os
import pickle
import queue
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


def _read(requests: Any, waiting: queue.SimpleQueue[Any]) -> None:
    """Ends the process, and the Blender that it may have started, at once when the one that asks is gone."""
    while True:
        try:
            waiting.put(receive(requests))
        except (EOFError, OSError):
            if hasattr(os, "killpg") and os.getpgid(0) == os.getpid():
                os.killpg(0, signal.SIGKILL)
            os._exit(0)


def main() -> None:
    """Does what is asked for, one after the other."""
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
