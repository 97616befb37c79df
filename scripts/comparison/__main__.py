"""python -m comparison: measures, and writes the pages of measurements."""

from __future__ import annotations

import argparse
import importlib
import shutil
from pathlib import Path

from .page import Setting

PARTS = ("accuracy", "fairness", "cages", "many_sides", "speed")  # modules with a function write(Setting)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}; default: all")
    parser.add_argument("--quick", action="store_true", help="few cases, to see that everything works")
    parser.add_argument("--docs", type=Path, required=True, help="the folder of the pages")
    parser.add_argument("--cache", type=Path, required=True, help="folder for what other programs write")
    parser.add_argument("--cgal", help="the compiled cgal_fill")
    parser.add_argument("--pmp", help="the compiled pmp_fill")
    parser.add_argument("--blender", default="blender")
    args = parser.parse_args()
    for part in args.parts:
        if part not in PARTS:
            parser.error(f"no part {part}; there are {', '.join(PARTS)}")
    args.cache.mkdir(parents=True, exist_ok=True)
    blender = shutil.which(args.blender) or ""
    setting = Setting(args.docs, args.cache, args.cgal or None, args.pmp or None, blender, args.quick)
    for part in args.parts or PARTS:
        print(f"== {part}", flush=True)
        importlib.import_module(f"comparison.{part}").write(setting)


if __name__ == "__main__":
    main()
