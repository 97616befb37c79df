"""Where the faces of a file come from: which are fills, of which method, how well known, and how the file was before."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterable
from typing import Any

from ..messages import Message
from .writing import FileError

#: Of every face: 0, the mesh's own; k, of the k-th fill. Called as Blender's attribute.
FILL = "tripatch_fill"


def about(fill: Any, hashes: dict[int, tuple[Any, str]] | None = None) -> dict[str, Any]:
    """What a file says of a fill: the method, the error estimate (in units of the mesh; None: not known), a hash of the options,
    the version, and how many vertices and faces it added.

    Args:
        hashes: keeps those of options that many fills share, by their place in memory, with the options.
    """
    from .. import __version__
    from ..batch.record import plain

    given, known = fill.options, {} if hashes is None else hashes
    if id(given) not in known:
        options = json.dumps(plain(given), sort_keys=True, separators=(",", ":"))
        known[id(given)] = given, hashlib.sha256(options.encode()).hexdigest()
    return {
        "method": fill.report.method,
        "error_estimate": plain(fill.report.deviation_max),
        "options_sha256": known[id(given)][1],
        "tripatch": __version__,
        "vertices": len(fill.vertices),
        "faces": len(fill.faces),
    }


def line(value: Any) -> bytes:
    """JSON of one line, of ASCII characters only."""
    return json.dumps(value, separators=(",", ":")).encode("ascii")


def faces_of(lines: Iterable[bytes]) -> int:
    """How many faces the fills have of which these lines speak; 0 if one is not as `line` writes it."""
    try:
        return sum(max(int(json.loads(each)["faces"]), 0) for each in lines)
    except (KeyError, TypeError, ValueError, RecursionError):
        return 0


def sha256(data: bytes) -> str:
    """Of a file's content."""
    return hashlib.sha256(data).hexdigest()


def original(found: Iterable[bytes], expected: str) -> bytes:
    """The one of several contents that a file had.

    Raises:
        FileError: none of them is.
    """
    for data in found:
        if sha256(data) == expected:
            return data
    raise FileError(Message("original_lost"))


def edits(pieces: Iterable[tuple[bytes, bytes]]) -> list[list[Any]]:
    """What makes a file of (new, old) pieces the old one again: places in the new file, how many bytes there, the old ones."""
    made, at = [], 0
    for new, old in pieces:
        if new != old:
            made.append([at, len(new), base64.b64encode(old).decode()])
        at += len(new)
    return made


def undone(data: bytes, report: Any) -> bytes:
    """A file without its fills, by the report that was written with it.

    Raises:
        FileError: the report is of another file, or has nothing of that kind.
    """
    try:
        restore = report["restore"]
        for at, length, old in reversed(restore["edits"]):
            data = data[:at] + base64.b64decode(old) + data[at + length :]
        return original([data], restore["sha256"])
    except (KeyError, TypeError, ValueError) as error:
        if isinstance(error, FileError):
            raise
        raise FileError(Message("original_not_in_report")) from None
