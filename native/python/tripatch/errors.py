"""What can go wrong, in the user's words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from .messages import Message


class Refusal(ValueError):
    """A hole that cannot be filled. The mesh is untouched.

    Attributes:
        reason: a sentence a modeller understands.
        where: vertex indices of the place, possibly empty.
        code: a short name for the reason, such as "corner_lacks_planes"; empty if it has none.
        messages: the reason as a message with its code, then what else is to be said; empty if it has no code.
    """

    messages: tuple[Message, ...] = ()

    def __init__(self, reason: str, where: Iterable[int] = ()) -> None:
        super().__init__(reason)
        self.reason = str(reason)
        self.where = [int(v) for v in where]
        if isinstance(reason, Message):
            self.messages = (reason,)

    @classmethod
    def of(cls, message: Message, also: Iterable[Message] = ()) -> Refusal:
        """A refusal for the reason that a message says, and what else is to be said."""
        messages = (message, *also)
        refusal = cls(". ".join(messages), message.where)
        refusal.messages = messages
        return refusal

    @property
    def code(self) -> str:
        """A short name for the reason."""
        return self.messages[0].code if self.messages else ""

    @property
    def said(self) -> str:
        """All that is said, as one `Message` if it has a code."""
        if not self.messages:
            return self.reason
        said = self.messages[0]
        for also in self.messages[1:]:
            said = Message("and_also", {"reason": said, "also": also}, self.where)
        return said

    def worded(self, **style: Any) -> str:
        """The reason in the words of an interface; keywords as of `messages.wording`."""
        said = self.said
        return said.worded(**style) if isinstance(said, Message) else said

    def __reduce__(self) -> tuple[Any, ...]:
        if self.messages:
            return (_again, (type(self), self.messages, self.where))
        return (type(self), (self.reason, self.where))


def _again(kind: type[Refusal], messages: tuple[Message, ...], where: list[int]) -> Refusal:
    refusal = kind.of(messages[0], messages[1:])
    refusal.where = where
    return refusal


class Mistake(ValueError):
    """An argument that does not fit the others, in words that an interface can replace by its own.

    Attributes:
        said: the sentence as a message with its code.
    """

    def __init__(self, said: Message) -> None:
        super().__init__(said)
        self.said = said


class FillWarning(UserWarning):
    """What a person should know of a result that comes without a report.

    Attributes:
        code: a short name for the warning, as of those in reports; empty if it has none.
    """

    @property
    def code(self) -> str:
        """A short name for the warning."""
        return str(getattr(self.args[0], "code", "")) if self.args else ""
