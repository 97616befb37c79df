"""The process that does files: it may crash or be ended, and costs the file that it was at.

Requests come as pickles on stdin, answers go as pickles to stdout; it ends when nobody asks any more.
"""

from __future__ import annotations

import importlib
import os
import pickle
import queue
import re
import signal
import struct
import sys
import threading
from pathlib import Path
from typing import Any

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


def limit_memory(megabytes: int | None) -> None:
    """This process asks for no more than so much: what it asks for then fails as MemoryError. No effect on Windows."""
    if not megabytes:
        return
    try:
        import resource
    except ImportError:
        return
    for kind in (resource.RLIMIT_DATA, resource.RLIMIT_AS) if sys.platform != "linux" else (resource.RLIMIT_DATA,):
        _, hard = resource.getrlimit(kind)
        wanted = megabytes * 2**20
        resource.setrlimit(kind, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))


def out_of_memory(pid: int, megabytes: int) -> bool:
    """Whether a process has nothing left of its limit that a small request could have. False where the system does not say.

    Some stay so for ever: CPython up to 3.11 at least has no memory for the MemoryError itself, tries again, and no thread of it
    runs meanwhile.
    """
    try:
        used = re.search(rb"VmData:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_bytes())
    except OSError:
        return False
    return used is not None and int(used[1]) > megabytes * 1024 - 256


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
    limit_memory(int(sys.argv[1]))
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
