"""The fills that `auto` chooses from."""

from __future__ import annotations

from typing import Literal, NamedTuple

from .messages import Message


class Candidate(NamedTuple):
    """One way to fill a hole, and what became of it. Numbers are None unless the fill was made and they are known."""

    method: str
    status: Literal["used", "made", "skipped", "refused"]
    expected_error: float | None
    folds: int | None
    crosses: bool | None
    exceeds_hole_bounds: bool | None
    seam_deg: float | None
    why: Message


#: What `help` and the reference say of the fields.
_FIELDS = {
    "method": "Name of the method, a key of `METHODS`.",
    "status": "Whether this fill is used, was only made, was skipped, or was refused.",
    "expected_error": "Expected distance of the new vertices from the true surface, in units of the mesh.",
    "folds": "Folded edges beyond those that the boundary forces.",
    "crosses": "Whether the fill crosses itself.",
    "exceeds_hole_bounds": "Whether the fill reaches farther from the boundary than the hole is wide.",
    "seam_deg": "Largest angle at the seam, in degrees. It is not compared.",
    "why": "Why it has this status.",
}
for _name, _text in _FIELDS.items():
    getattr(Candidate, _name).__doc__ = _text
