"""The fills that `auto` chooses from."""

from __future__ import annotations

from typing import Literal, NamedTuple

from .messages import Message


class Candidate(NamedTuple):
    """One way to fill a hole, and what became of it. Numbers are None unless the fill was made and they are known."""

    method: str
    status: Literal["used", "made", "skipped", "refused"]
    #: How far off the new vertices are expected to be, in units of the mesh.
    expected_error: float | None
    #: Folded edges beyond those that the boundary forces.
    folds: int | None
    #: Whether it crosses itself.
    crosses: bool | None
    #: Whether it reaches farther from the boundary than the hole is wide.
    exceeds_hole_bounds: bool | None
    #: Largest seam angle, in degrees: not compared.
    seam_deg: float | None
    why: Message
