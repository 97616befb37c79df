"""What users read: codes with parameters, and the sentences that interfaces make of them by one table."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from . import _native


@dataclass(frozen=True)
class Row:
    """What the table says of a code.

    Attributes:
        kind: "refusal", "warning", "report", "reason" or "note"; or "label".
        sentence: the pattern of its sentence; messages.h in the core describes patterns. Of a label: its tooltip, or its help.
        panel: the same for a window; empty: as `sentence`. Of a label: the label.
        meaning: what it means and what to do.
    """

    kind: str
    sentence: str
    panel: str
    meaning: str


_LARGEST = 2**63 - 1

#: Every code and its sentences.
TABLE: dict[str, Row] = {code: Row(*row) for code, *row in _native._messages()}


def _plain(value: Any, style: dict[str, Any]) -> Any:
    """A parameter as the core reads it, whose whole numbers have 64 bits."""
    if isinstance(value, int):
        return max(-_LARGEST, min(int(value), _LARGEST))
    return value.worded(**style) if isinstance(value, Message) else value


def wording(
    code: str,
    parameters: Mapping[str, Any],
    where: Iterable[int] = (),
    *,
    vertices: str = "numbered",
    panel: bool = False,
    names: Mapping[str, str] | None = None,
) -> str:
    """The sentence of a message.

    Args:
        code: of the table.
        parameters: what the sentence names; messages among them are worded likewise.
        where: vertices.
        vertices: "numbered"; "selected", for a window in which they are; or "unnamed".
        panel: whether it is for a window, where sides and corners count from 1.
        names: what the interface calls options and methods.
    """
    row = TABLE[code]
    style: dict[str, Any] = {"vertices": vertices, "panel": panel, "names": names}
    plain = {name: _plain(value, style) for name, value in parameters.items()}
    pattern = row.panel if panel and row.panel else row.sentence
    return _native._format(pattern, plain, [int(v) for v in where], vertices, panel, dict(names or {}))


def label(code: str) -> str:
    """What a control, a section or the value of a flag is called."""
    return TABLE[code].panel


def text(code: str, **parameters: Any) -> str:
    """What a control or a flag does. A text without parameters is no pattern."""
    return wording(code, parameters) if parameters else TABLE[code].sentence


class Message(str):
    """A sentence with the code that it stands for.

    Attributes:
        code: what the message is about; the page "Messages" of the documentation lists them.
        parameters: what the sentence names.
        where: vertex indices of the place, possibly empty.
    """

    code: str
    parameters: dict[str, Any]
    where: list[int]

    def __new__(cls, code: str, parameters: Mapping[str, Any] | None = None, where: Iterable[int] = ()) -> Message:
        """The message of a code."""
        given, at = dict(parameters or {}), [int(v) for v in where]
        message = super().__new__(cls, wording(code, given, at))
        message.code, message.parameters, message.where = code, given, at
        return message

    @property
    def names_vertices(self) -> bool:
        """Whether the sentence names the place."""
        parts = [value for value in self.parameters.values() if isinstance(value, Message)]
        return ":vertices}" in TABLE[self.code].sentence.lower() or any(part.names_vertices for part in parts)

    @property
    def codes(self) -> set[str]:
        """The code, and those of messages that the sentence contains."""
        parts = [value.codes for value in self.parameters.values() if isinstance(value, Message)]
        return {self.code}.union(*parts)

    def worded(self, **style: Any) -> str:
        """The sentence in the words of an interface; keywords as of `wording`."""
        return wording(self.code, self.parameters, self.where, **style)

    def renumbered(self, number: Callable[[int], int]) -> Message:
        """The same of a mesh whose vertices have other numbers."""
        row = TABLE[self.code]
        named = set(re.findall(r"\{(\w+):[Vv]ertices\}", row.sentence + row.panel))

        def again(name: str, value: Any) -> Any:
            if isinstance(value, Message):
                return value.renumbered(number)
            return [number(int(v)) for v in value] if name in named else value

        parameters = {name: again(name, value) for name, value in self.parameters.items()}
        return Message(self.code, parameters, [number(v) for v in self.where])

    def __reduce__(self) -> tuple[Any, ...]:
        """For pickle and copies."""
        return (type(self), (self.code, self.parameters, self.where))
