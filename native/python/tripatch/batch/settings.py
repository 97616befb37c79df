"""What all files of a run have in common."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from ..options import OPTIONS

#: The options of `tripatch fill --all`; but the faces of a file stay.
BATCH_OPTIONS = {name: option for name, option in OPTIONS.items() if "fill_all" in option.functions and name != "replaced"}

FILL, LIST, CROP = "fill", "list", "crop"


@dataclass(frozen=True)
class Settings:
    """What all files of a run have in common; travels to the workers.

    Attributes:
        root: folder that all inputs lie in; records name them from there.
        out: folder of the results, laid out as below root.
        options: those of BATCH_OPTIONS that were given, and the distance `join`, as JSON holds them.
        version: of TriPatch, the same wherever a part of the run is.
        mode: FILL; LIST: say which holes there are; CROP: what the picture of some holes needs.
        time_limit: seconds a file; None: none.
        memory_limit: MB of memory that the process of a file may have; None: no limit.
        retries: how often a file is tried again whose process crashed.
        recycle: files that a process does before a new one takes its place.
        blender: the program for .blend files.
        addon: folder that holds tripatch_blender, where that Blender has the add-on not installed.
        threads: that a fill may work on, where the environment does not say; None: as many as there are cores.
    """

    root: str
    out: str
    options: dict[str, Any] = field(default_factory=dict)
    version: str = ""
    mode: str = FILL
    time_limit: float | None = None
    memory_limit: int | None = None
    retries: int = 1
    recycle: int = 1000
    blender: str = "blender"
    addon: str | None = None
    threads: int | None = None

    def choosing(self) -> dict[str, Any]:
        """The options that say which holes are meant."""
        return {name: value for name, value in self._of_fills().items() if "choose_holes" in OPTIONS[name].functions}

    def filling(self) -> dict[str, Any]:
        """The options that say how they are filled."""
        return {name: value for name, value in self._of_fills().items() if "choose_holes" not in OPTIONS[name].functions}

    def _of_fills(self) -> dict[str, Any]:
        return {name: value for name, value in self.options.items() if name != "join"}
