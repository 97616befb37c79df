"""python -m comparison.one_fill EDGES FAIRING REPETITIONS: a sphere octant filled in a process of its own.

Prints JSON: triangles, seconds of each repetition, and in bytes the input, the output, and the peak beyond both.
"""

from __future__ import annotations

import json
import re
import sys
import time
from pathlib import Path

import tripatch

from . import holes


def memory(what: str) -> int:
    """VmRSS, what the process has, or VmHWM, the most that it had."""
    return 1024 * int(re.search(rf"{what}:\s+(\d+)", Path("/proc/self/status").read_text())[1])


def arrays(fill: tripatch.Fill) -> int:
    """Bytes of what is delivered."""
    native = fill._native
    parts = [fill.vertices, fill.normals, fill.barycentric, native.face_offsets, native.face_corners]
    return sum(part.nbytes for part in parts)


def main() -> None:
    edges, fairing, repetitions = int(sys.argv[1]), sys.argv[2], int(sys.argv[3])

    def fill(hole: holes.Hole) -> tripatch.Fill:
        options = {"rim": hole.rim, "corners": hole.corners, "fairing": None if fairing == "None" else fairing}
        return tripatch.fill(hole.vertices, hole.faces, **options)

    hole = holes.sphere(edges)
    fill(holes.sphere(8))  # what is made once is made
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins again
    before = memory("VmRSS")
    made = fill(hole)
    beyond = memory("VmHWM") - before - arrays(made)
    seconds = []
    for _ in range(repetitions):
        start = time.perf_counter()
        made = fill(hole)
        seconds.append(time.perf_counter() - start)
    result = {
        "triangles": len(made._native.face_offsets) - 1,
        "seconds": seconds,
        "input": hole.vertices.nbytes + hole.faces.nbytes + hole.rim.nbytes,
        "output": arrays(made),
        "beyond": max(beyond, 0),
    }
    print(json.dumps(result))


if __name__ == "__main__":
    main()
