"""What the formats share of writing: numbers and lines of a file that keep what is around them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence


def most(values):
    """The most frequent, the first of equals."""
    return Counter(values).most_common(1)[0][0]


def number(x: float) -> bytes:
    return repr(float(x)).encode()


def numbers(row) -> bytes:
    return b" ".join(map(number, row))


def with_numbers(text: bytes, first: int, values) -> bytes:
    """A line, or several that continue it, with other numbers from word `first` on; what is between the words stays."""
    words = list(re.finditer(rb"(?:(?!\\\r?\n)\S)+", text))[first : first + len(values)]
    for word, value in reversed(list(zip(words, values))):
        text = text[: word.start()] + value + text[word.end() :]
    return text


def lines(data: bytes) -> list[bytes]:
    return data.splitlines(keepends=True)


def line_end(lines: Sequence[bytes]) -> bytes:
    first = lines[0] if lines else b"\n"
    return first[len(first.rstrip(b"\r\n")) :] or b"\n"
