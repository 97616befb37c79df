"""What can go wrong, in the user's words."""

from __future__ import annotations

from collections.abc import Iterable


class Refusal(ValueError):
    """A hole that cannot be filled. The mesh is untouched.

    Attributes:
        reason: a sentence a modeller understands.
        where: vertex indices of the place, possibly empty.
    """

    def __init__(self, reason: str, where: Iterable[int] = ()) -> None:
        super().__init__(reason)
        self.reason = reason
        self.where = [int(v) for v in where]

    def __reduce__(self) -> tuple[type[Refusal], tuple[str, list[int]]]:
        return (Refusal, (self.reason, self.where))


class FillWarning(UserWarning):
    """What a person should know of a result that comes without a report."""
