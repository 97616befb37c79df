"""Fills by other programs are kept between runs: they change with the program, its caller, the hole and the processor only."""

from __future__ import annotations

import hashlib
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np

from .holes import Hole
from .rivals import GIVEN_TRIANGLES, Filling

FAILURES = (RuntimeError, ValueError, StopIteration, subprocess.SubprocessError, OSError)
CALLERS = ("rivals.py", "occ.py", "cgal_fill.cpp", "pmp_fill.cpp")


def checksum(*parts) -> str:
    total = hashlib.sha1()
    for part in parts:
        array = np.ascontiguousarray(part)
        total.update(f"{array.dtype} {array.shape} ".encode())
        total.update(array.tobytes())
    return total.hexdigest()


class Kept:
    """A folder of fills, each in a file that is named by the checksum of all that it depends on."""

    def __init__(self, folder: Path, on: dict, versions: dict[str, str]) -> None:
        self.folder, self.versions = folder, versions
        callers = "".join(Path(__file__).with_name(name).read_text() for name in CALLERS)
        self.common = (callers, on["processor"], on["system"])
        folder.mkdir(parents=True, exist_ok=True)

    def of(self, name: str, call: Callable) -> Callable:
        """Calls it only for what is not kept yet. Programs whose version is not known are always called."""
        program = name.split(",")[0]
        if program not in self.versions:
            return call

        def fill(hole: Hole, ours) -> Filling:
            parts = [*self.common, name, self.versions[program], hole.vertices, hole.faces, hole.rim]
            if program in GIVEN_TRIANGLES:
                parts += [np.concatenate(ours.faces), len(ours.vertices)]
            path = self.folder / f"{checksum(*parts)}.npz"
            if path.exists():
                with np.load(path) as read:
                    if "failed" in read:
                        raise RuntimeError(str(read["failed"]))
                    return Filling(np.concatenate([hole.vertices, read["new"]]), read["faces"], float(read["cpu"]))
            try:
                made = call(hole, ours)
            except FAILURES as error:
                np.savez(path, failed=str(error)[:100] or type(error).__name__)
                raise
            np.savez_compressed(path, new=made.vertices[len(hole.vertices) :], faces=made.faces, cpu=made.cpu)
            return made

        return fill
