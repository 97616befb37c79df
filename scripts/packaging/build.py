"""build.py OPENSUBDIV FOLDER [PLATFORM...]: compiles the module for platforms and writes their wheels into a folder."""

from __future__ import annotations

import sys
import time
from pathlib import Path

from cross import modules
from platforms import PLATFORMS
from wheels import write


def main(opensubdiv: Path, folder: Path, names: list[str]) -> None:
    for name in names or list(PLATFORMS):
        if name not in PLATFORMS:
            sys.exit(f"error: no platform {name}; there are {', '.join(PLATFORMS)}")
        begun = time.monotonic()
        for python, module in modules(PLATFORMS[name], opensubdiv).items():
            print(write(PLATFORMS[name], python, module, opensubdiv, folder))
        print(f"{name}: {time.monotonic() - begun:.0f} s")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
