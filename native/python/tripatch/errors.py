"""What can go wrong, in the user's words."""

from __future__ import annotations

import difflib
import math
import numbers
from collections.abc import Callable, Iterable
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

    def renumbered(self, number: Callable[[int], int]) -> Refusal:
        """The same of a mesh whose vertices have other numbers."""
        where, messages = [number(v) for v in self.where], [each.renumbered(number) for each in self.messages]
        return _again(type(self), tuple(messages), where) if messages else type(self)(self.reason, where)

    def __reduce__(self) -> tuple[Any, ...]:
        if self.messages:
            return (_again, (type(self), self.messages, self.where))
        return (type(self), (self.reason, self.where))


def _again(kind: type[Refusal], messages: tuple[Message, ...], where: list[int]) -> Refusal:
    refusal = kind.of(messages[0], messages[1:])
    refusal.where = where
    return refusal


class Coded:
    """What errors and warnings have whose argument is a `Message`."""

    args: tuple[Any, ...]

    @property
    def code(self) -> str:
        """A short name for what it says; empty if it has none."""
        return str(getattr(self.args[0], "code", "")) if self.args else ""


class FillWarning(Coded, UserWarning):
    """What a person should know of a result that comes without a report.

    Attributes:
        code: a short name for the warning, as of those in reports; empty if it has none.
    """


class WrongValue(Coded, ValueError):
    """An argument of the right type that cannot be used; the argument of the error is a `Message`."""


class WrongType(Coded, TypeError):
    """An argument of another type than is needed; the argument of the error is a `Message`."""


def because(error: Exception) -> str:
    """What an error says: its message, or the words of the system."""
    said = getattr(error, "said", error.args[0] if error.args else "")
    return said if isinstance(said, Message) else str(getattr(error, "strerror", None) or error)


def meant(word: object, known: Iterable[object]) -> dict[str, str]:
    """The parameter of a message that suggests what may have been meant, or none."""
    near = difflib.get_close_matches(str(word), [str(each) for each in known], n=1)
    return {"meant": near[0]} if near else {}


def wrong_type(name: str, types: str, value: object) -> TypeError:
    """The error for an argument of another type than these, which are written as annotations."""
    return WrongType(Message("wrong_type", {"name": name, "types": types, "value": f"{value!r:.60}"}))


def out_of_range(name: str, value: float, least: float, most: float = math.inf, *, is_open: bool = False) -> ValueError:
    """The error for a number that is not finite, or not within a range. is_open: its ends are not allowed."""
    if not isinstance(value, numbers.Integral) and not math.isfinite(value):
        return WrongValue(Message("not_finite", {"name": name}))
    ends = {"above" if is_open else "least": least}
    if math.isfinite(most):
        ends = {"after": least, "before": most} if is_open else {"from": least, "to": most}
    said = {end: f"{number:.12g}" for end, number in ends.items()}
    shown = str(value) if isinstance(value, numbers.Integral) else f"{value:.12g}"
    return WrongValue(Message("out_of_range", {"name": name, **said, "value": shown}))


def wrong_shape(name: str, shape: str, given: object, *, ragged: bool = False) -> ValueError:
    """The error for an array of another shape. ragged: its rows differ in length."""
    said = {"ragged": 1} if ragged else {"given": str(given)}
    return WrongValue(Message("wrong_shape", {"name": name, "shape": shape, **said}))


def not_one_of(name: str, value: object, allowed: Iterable[object]) -> ValueError:
    """The error for a name that is not known, with the one that may have been meant."""
    values = [str(each) for each in allowed]
    return WrongValue(Message("not_one_of", {"name": name, "values": values, "value": f"{value!r:.60}", **meant(value, values)}))
