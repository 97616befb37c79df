"""Makes objects of bound classes with one allocation failing, for each of its allocations: prints what became of them as JSON.

make_without_memory.py, with the library of allocations.c preloaded. Each try is a process of its own.
"""

import ctypes
import gc
import json
import os
import pickle
from collections import Counter

import numpy as np
import tripatch
from tripatch import _native

fail_at = ctypes.CDLL(None).fail_at
fail_at.restype = ctypes.c_long
net = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 1], [1, 1, 0], [0, 2, 0.0]])
grid = np.stack([*np.meshgrid([0, 1.0], [0, 1.0]), np.ones((2, 2))], axis=2)
triangle = _native.BezierTriangle(net)
side = _native.Side(triangle, 0, False)
kept = pickle.dumps(side)
rows = b"\3" + np.array([0, 1, 2], "<i4").tobytes()

MADE = {
    "shared, constructed": lambda: _native.BezierTriangle(net),
    "shared, of a method": triangle.elevated,
    "shared, of a function": lambda: _native._rational_triangle(net, np.ones(len(net))),
    "shared, of a rectangle": lambda: tripatch.NurbsSurface(grid, None, [0, 0, 1, 1], [0, 0, 1, 1]),
    "own, constructed": lambda: _native.Side(triangle, 0, False),
    "own, from a pickle": lambda: pickle.loads(kept),
    "own, of a buffer": lambda: _native.FaceRows(rows, 0, 1, [(0, "B", 4)], 0, 0, "i", False, 3),
}


def outcome(make, k):
    """Of one object with a failure, and of the next one in the same process."""
    fail_at(k)
    try:
        made = make()
        what = "made"
    except BaseException as error:
        made = None
        what = error
    fail_at(-1)
    del made
    what = what if isinstance(what, str) else type(what).__name__
    for _ in range(3):  # what was freed once too often is found by the next ones
        make()
    triangle.elevated()
    gc.collect()
    return what


results = {}
for name, make in MADE.items():
    make()
    fail_at(-1)
    made = make()
    requests = fail_at(-1)
    became = Counter()
    for k in range(requests):
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.write(writing, outcome(make, k).encode())
            os._exit(0)
        os.close(writing)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        became[os.read(reading, 1000).decode() if status == 0 else f"ended with {status}"] += 1
        os.close(reading)
    results[name] = became
print(json.dumps(results))
