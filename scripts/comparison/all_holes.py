"""python -m comparison.all_holes CELLS HOLES SIDE: all holes of a mesh of native/benchmarks/many_holes.py, not faired."""

from __future__ import annotations

import json
import sys
import time

import tripatch

from .page import ROOT
from .speed import module


def main() -> None:
    mesh = module(ROOT / "native" / "benchmarks" / "many_holes.py").mesh
    vertices, faces, rims = mesh(*map(int, sys.argv[1:4]))
    tripatch.fill_all(vertices, faces, rims[:2], fairing=None)
    start = time.perf_counter()
    fills = tripatch.fill_all(vertices, faces, rims, fairing=None)
    print(json.dumps({"seconds": time.perf_counter() - start, "fills": sum(isinstance(fill, tripatch.Fill) for fill in fills)}))


if __name__ == "__main__":
    main()
