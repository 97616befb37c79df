"""Fills a hole with one allocation failing, for each of some, in a process of its own: prints what became of them as JSON.

fill_without_memory.py STEP, with the library of allocations.c preloaded: each of the first, in which Python makes objects of
bound classes, then one in STEP.
"""

import ctypes
import json
import os
import sys
from collections import Counter

import numpy as np
import tripatch
from shapes import cube_sphere

FIRST = 64
step = int(sys.argv[1])
fail_at = ctypes.CDLL(None).fail_at
fail_at.restype = ctypes.c_long
points, faces = cube_sphere(4)
faces = [face for k, face in enumerate(faces) if k not in (5, 6, 9, 10)]
before = points.copy()
good = tripatch.fill(points, faces)


def is_good(made):
    return np.array_equal(made.vertices, good.vertices) and np.array_equal(np.concatenate(made.faces), np.concatenate(good.faces))


def outcome(k):
    """Of one fill with a failure, and of the next one in the same process."""
    made = None
    fail_at(k)
    try:
        made = tripatch.fill(points, faces)
        what = "filled"
    except BaseException as error:
        what = error
    fail_at(-1)
    if made is not None and not is_good(made):
        return "another fill"
    if not np.array_equal(points, before):
        return "the mesh was changed"
    if not is_good(tripatch.fill(points, faces)):
        return "the next fill is another"
    return what if isinstance(what, str) else type(what).__name__


fail_at(-1)
assert is_good(tripatch.fill(points, faces))
requests = fail_at(-1)
became = {}
for k in (*range(FIRST), *range(FIRST, requests, step)):
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.write(writing, outcome(k).encode())
        os._exit(0)
    os.close(writing)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    became[k] = os.read(reading, 1000).decode() if status == 0 else f"ended with {status}"
    os.close(reading)
counts = Counter(became.values())
print(
    json.dumps(
        {"requests": requests, "outcomes": counts, "places": {w: [k for k in became if became[k] == w][:8] for w in counts}}
    )
)
