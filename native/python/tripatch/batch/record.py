"""The lines of a batch: one for each file and one for each of its holes, JSON with always the same names.

Nothing in them depends on when, where or next to what a file was done, so that the same files give the same bytes. docs/batch.md
describes every name; SCHEMA counts up when one changes its meaning or goes.
"""

from __future__ import annotations

import hashlib
import json
import math
from typing import Any

import numpy as np

from .. import arguments
from ..errors import Refusal
from .settings import Settings

SCHEMA = 1

FILLED, PARTLY, REFUSED, NOTHING = "filled", "partly", "refused", "nothing"
UNREADABLE, NOT_WRITTEN, CRASHED, TIME_LIMIT, MEMORY_LIMIT = "unreadable", "not written", "crashed", "time limit", "memory limit"
#: What may go otherwise the next time: the next run tries these again.
PASSING = (NOT_WRITTEN, CRASHED, TIME_LIMIT, MEMORY_LIMIT)
#: Files of which nothing was made.
FAILED = (UNREADABLE, *PASSING)
LISTED, LEFT = "listed", "left"

#: Codes of rims that lie upon other borders: faces meet there without being joined.
_UNJOINED = {"edges_on_borders", "rim_on_borders"}

#: Vertices of a refusal that a line names at most: a rim can have thousands.
_WHERE = 32

_FILE = {
    "sha256": None,
    "output": None,
    "status": None,
    "reason": None,
    "vertices": None,
    "faces": None,
    "new_vertices": 0,
    "new_faces": 0,
    "holes": None,
    "filled": 0,
    "refused": 0,
    "left": 0,
    "folded": 0,
    "unjoined": 0,
}
_REPORTED = {
    "method": None,
    "method_reason": None,
    "corners": None,
    "continuity": None,
    "fairing": None,
    "seam_angle_max": None,
    "seam_angle_rms": None,
    "surroundings_error": None,
    "deviation_max": None,
    "cage_deviation_max": None,
    "surroundings_moved_max": None,
    "folds": None,
    "triangles_folded": None,
    "rim_folded": None,
    "is_flawed": None,
    "crosses_itself": None,
    "passes_through": None,
    "warnings": None,
    "codes": None,
}
_HOLE = {
    "object": None,
    "hole": None,
    "outer": False,
    "vertex": None,
    "edges": None,
    "diameter": None,
    "status": None,
    "reason": None,
    "where": None,
    "new_vertices": None,
    "new_faces": None,
    "crease_max": None,
    **_REPORTED,
}


def plain(value: Any) -> Any:
    """What JSON can hold; numbers that are not finite become null."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(v) for v in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def text(line: Any) -> str:
    """A line as it is written."""
    return json.dumps(line, ensure_ascii=False, separators=(",", ":"))


def key(settings: Settings, name: str, sha256: str) -> str:
    """What a result depends on, in short: the content of the file, its name, options and version."""
    said = text([SCHEMA, settings.version, plain(settings.options), name, sha256])
    return hashlib.sha256(said.encode("utf-8", "surrogatepass")).hexdigest()


def _begun(settings: Settings, kind: str, name: str) -> dict[str, Any]:
    own = {"schema": SCHEMA, "line": kind, "tripatch": settings.version, "options": settings.options}
    return {**own, "input": name}


def of_file(settings: Settings, name: str, **values: Any) -> dict[str, Any]:
    """The line of a file."""
    assert values.keys() <= _FILE.keys()
    line: dict[str, Any] = plain({**_begun(settings, "file", name), **_FILE, **values})
    return line


def of_hole(settings: Settings, name: str, result: Any = None, **values: Any) -> dict[str, Any]:
    """The line of a hole: `result` is a Fill or a Refusal."""
    if isinstance(result, Refusal):
        values |= {"status": REFUSED, "reason": result.worded(names=arguments.NAMES), "where": list(result.where)[:_WHERE]}
        values |= {"codes": [each.code for each in result.messages]}
    elif result is not None:
        values |= {"status": FILLED, "new_vertices": len(result.vertices), "new_faces": len(result.faces)}
        values |= reported({**result.report.as_dict(), "passes_through": result.passes_through})
    assert values.keys() <= _HOLE.keys()
    line: dict[str, Any] = plain({**_begun(settings, "hole", name), **_HOLE, **values})
    return line


def reported(report: dict[str, Any]) -> dict[str, Any]:
    """What a line says of a fill's report."""
    values = {name: report.get(name) for name in _REPORTED}
    return values | {name: values[name] or None for name in ("fairing", "cage_deviation_max", "surroundings_moved_max")}


def outcome(holes: list[dict[str, Any]]) -> dict[str, Any]:
    """What the line of a file says of its holes."""
    count = {status: sum(hole["status"] == status for hole in holes) for status in (FILLED, REFUSED, LEFT, LISTED)}
    folded = sum((hole["triangles_folded"] or 0) > (hole["rim_folded"] or 0) for hole in holes)
    if count[FILLED]:
        flawed = any(hole["is_flawed"] or hole["passes_through"] for hole in holes)
        status = PARTLY if count[REFUSED] or flawed else FILLED
    else:
        status = LISTED if count[LISTED] else REFUSED if count[REFUSED] else NOTHING
    values = {"status": status, "holes": len(holes), "folded": folded, "left": count[LEFT]}
    values |= {"unjoined": sum(not _UNJOINED.isdisjoint(hole["codes"] or ()) for hole in holes)}
    values |= {"filled": count[FILLED], "refused": count[REFUSED]}
    values |= {name: sum(hole[name] or 0 for hole in holes) for name in ("new_vertices", "new_faces")}
    return values
