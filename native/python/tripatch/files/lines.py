"""The lines of a text file as arrays: where they begin, and the numbers in many of them at once."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from .._types import Array

SPACE = np.zeros(256, bool)  # by byte, what bytes.split parts words by
SPACE[[9, 10, 11, 12, 13, 32]] = True
_PART = 2**21  # bytes
_CONTINUED = re.compile(rb"\\[\r\n]+(?=.)", re.DOTALL)


class Lines:
    """The lines of a text; one that ends with a backslash continues in the next if `continued`.

    Attributes:
        data: the text.
        starts: (n + 1,) byte where each line begins, and the end of the last.
    """

    def __init__(self, data: bytes, continued: bool = False) -> None:
        self.data = data
        self._bytes = np.frombuffer(data, np.uint8)
        ends = np.flatnonzero(self._bytes == 10)
        if b"\r" in data:
            ends = np.flatnonzero((self._bytes == 10) | (self._bytes == 13))
            half = (self._bytes[ends] == 13) & (self._bytes[np.minimum(ends + 1, len(data) - 1)] == 10) & (ends + 1 < len(data))
            ends = ends[~half]
        if continued and b"\\" in data:
            ends = ends[~self._continues(ends)]
        starts = np.concatenate([[0], ends + 1])
        if starts[-1] < len(data):
            starts = np.append(starts, len(data))
        self.starts: Array = starts.astype(np.int32 if len(data) < 2**30 else np.int64)

    def _continues(self, ends: Array) -> Array:
        """Of ends of lines: whether a backslash stands before."""
        before = self._bytes[np.maximum(ends - 1, 0)]
        two = self._bytes[np.maximum(ends - 2, 0)]
        found = (before == 92) & (ends > 0) | (before == 13) & (two == 92) & (ends > 1)
        return np.asarray(found & (ends + 1 < len(self.data)))

    def __len__(self) -> int:
        return len(self.starts) - 1

    def text(self, k: int) -> bytes:
        """A line with its end."""
        return self.data[self.starts[k] : self.starts[k + 1]]

    def words(self, k: int) -> list[bytes]:
        """The words of a line."""
        return _CONTINUED.sub(b" ", self.text(k)).split()

    def heads(self) -> tuple[Array, Array, Array]:
        """Of each line its first three bytes; spaces where it is shorter."""

        def byte(k: int) -> Array:
            at = np.asarray(self.starts[:-1]) + k
            found = self._bytes[np.minimum(at, len(self.data) - 1)] if len(at) else np.zeros(0, np.uint8)
            return np.where(at < len(self.data), found, 32)

        first, second, third = byte(0), byte(1), byte(2)
        first_space = SPACE[first]
        return first, np.where(first_space, 32, second), np.where(first_space | SPACE[second], 32, third)

    def joined(self, chosen: Array) -> bytes:
        """Lines, ascending, one after another."""
        if not len(chosen):
            return b""
        cuts = np.flatnonzero(np.diff(chosen) != 1)
        first = self.starts[chosen[np.concatenate([[0], cuts + 1])]].tolist()
        end = self.starts[chosen[np.concatenate([cuts, [len(chosen) - 1]])] + 1].tolist()
        return b"".join([self.data[a:b] for a, b in zip(first, end, strict=True)])

    def beginning_with(self, keyword: bytes) -> Array:
        """The lines whose first word this is, in letters of either case."""
        lower = keyword.lower()
        found = np.flatnonzero((self._bytes | 32) == lower[0])
        found = found[found + len(keyword) <= len(self.data)]
        for k, letter in enumerate(lower[1:], 1):
            found = found[(self._bytes[found + k] | 32) == letter]
        after = found + len(keyword)
        found = found[SPACE[self._bytes[np.minimum(after, len(self.data) - 1)]] | (after == len(self.data))]
        lines = np.searchsorted(self.starts, found, "right") - 1
        starts, at = self.starts[lines], found - 1
        while True:  # back over what is blank before it
            inside = at >= starts
            blank = inside & SPACE[self._bytes[at]]
            if not blank.any():
                return np.asarray(np.unique(lines[~inside]))
            at = at - blank

    def table(self, chosen: Array, blank: bytes, kind: Any = float, keyword: bytes = b"") -> list[tuple[Array, Array, int]]:
        """The numbers of some lines: for each count of words and form of words the lines (k,), their numbers (k, words, width),
        and the width. Lines that hold anything else are in none.

        Args:
            chosen: lines, ascending.
            blank: letters that count as spaces; keyword: a word that does, in small letters or capitals.
            kind: float, or an integer type, whose words may be several numbers with slashes between them.
        """
        made = []
        sizes = np.cumsum(self.starts[chosen + 1] - self.starts[chosen], dtype=np.int64)
        first = 0
        while first < len(chosen):  # in parts that caches hold
            end = max(int(np.searchsorted(sizes, (sizes[first - 1] if first else 0) + _PART)), first + 1)
            made += self._table(chosen[first:end], blank, kind, keyword)
            first = end
        return made

    def _table(self, chosen: Array, blank: bytes, kind: Any, keyword: bytes) -> list[tuple[Array, Array, int]]:
        spaced = self.joined(chosen).translate(bytes(32 if k in blank else k for k in range(256))) + b" "
        for word in {keyword, keyword.upper()} - {b""}:
            spaced = spaced.replace(word, b" " * len(word))
        raw = np.frombuffer(spaced, np.uint8)
        space = SPACE[raw]
        begins = ~space
        begins[1:] &= space[:-1]
        words = np.flatnonzero(begins)
        lengths = self.starts[chosen + 1] - self.starts[chosen]
        line_starts = np.cumsum(lengths) - lengths
        counts = np.diff(np.searchsorted(words, line_starts), append=len(words))
        forms = counts.astype(np.int64)
        if kind is not float:
            forms = forms * 8 + self._slashes(spaced, raw, words, counts)
        made = []
        for form in np.unique(forms).tolist():
            mine = forms == form
            count, slashes = (form, 0) if kind is float else (form // 8, form % 8)
            if not count or slashes == 7:
                continue
            own = spaced if mine.all() else _chosen(spaced, line_starts, lengths, mine)
            width = {0: 1, 1: 2, 2: 3, 3: 2}[slashes]
            numbers = _numbers(own.replace(b"/", b" ") if slashes else own, kind)
            if numbers is not None and len(numbers) == mine.sum() * count * width:
                made.append((chosen[mine], numbers.reshape(-1, count, width), width))
        return made

    def _slashes(self, text: bytes, raw: Array, words: Array, counts: Array) -> Array:
        """The form of the words of each line: 0 "v", 1 "v/t", 2 "v/t/n", 3 "v//n", 7 others or not all alike."""
        if b"/" not in text or not len(words):
            return np.zeros(len(counts), np.int64)
        slash = np.flatnonzero(raw == 47)
        each = len(slash) // len(words)
        if each in (1, 2) and len(slash) == each * len(words):  # most files have one form throughout
            inside = slash.reshape(-1, each)
            double = inside[:, -1] - inside[:, 0] == 1
            ends = raw[inside[:, -1] + 1]
            alike = (inside[:, 0] > words).all() and (inside[:-1, -1] < words[1:]).all() and not SPACE[ends].any()
            if alike and (not double.any() or double.all()):
                return np.full(len(counts), 3 if double.all() and each == 2 else each)
        of_word = np.searchsorted(words, slash, "right") - 1
        form = np.bincount(of_word, minlength=len(words))
        twice = np.bincount(of_word[1:][np.diff(slash) == 1], minlength=len(words))
        form[(form == 2) & (twice == 1)] = 3
        form[(form > 3) | (twice > 1) | (twice == 1) & (form != 3)] = 7
        # neither begins nor ends with one
        form[of_word[SPACE[raw[slash + 1]] | (slash == words[of_word])]] = 7
        of_line = np.repeat(np.arange(len(counts)), counts)
        first = np.zeros(len(counts), np.int64)
        begin = np.cumsum(counts) - counts
        first[counts > 0] = form[begin[counts > 0]]
        first[of_line[form != first[of_line]]] = 7
        return first


class EditedLines(Lines):
    """Lines that may be changed one by one."""

    def __init__(self, data: bytes) -> None:
        super().__init__(data)
        self._edited: dict[int, bytes] = {}

    def __getitem__(self, k: int) -> bytes:
        return self._edited.get(int(k)) or self.text(k)

    def __setitem__(self, k: int, line: bytes) -> None:
        self._edited[int(k)] = line

    def between(self, first: int, end: int) -> bytes:
        """Lines as they are by now, one after another."""
        pieces, at = [], first
        for k in [*sorted(k for k in self._edited if first <= k < end), end]:
            pieces += [self.data[self.starts[at] : self.starts[k]], self._edited[k] if k < end else b""]
            at = k + 1
        return b"".join(pieces)

    def filled(self) -> Array:
        """The lines that hold a word."""
        first, _, _ = self.heads()
        held = ~SPACE[first]
        for k in np.flatnonzero(~held).tolist():
            held[k] = bool(self.text(k).strip())
        return np.flatnonzero(held)

    def _last_letters(self, chosen: Array) -> Array:
        """Of lines the byte where their last word ends."""
        at, starts = self.starts[chosen + 1] - 1, self.starts[chosen]
        while (blank := SPACE[self._bytes[at]] & (at > starts)).any():
            at = at - blank
        return np.asarray(at)

    def with_word(self, chosen: Array, word: bytes) -> bytes:
        """The text with one more word at the end of some lines."""
        added, at = np.frombuffer(b" " + word, np.uint8), self._last_letters(chosen)
        return np.insert(self._bytes, np.repeat(at + 1, len(added)), np.tile(added, len(at))).tobytes()

    def without_words(self, first: int, end: int, chosen: Array) -> bytes:
        """Lines without the last word of some of them, and the space before it."""
        last, starts = self._last_letters(chosen), self.starts[chosen]
        at = last
        while (inside := ~SPACE[self._bytes[at]] & (at > starts)).any():
            at = at - inside
        gone = np.zeros(len(self.data) + 1, np.int8)
        gone[at] = 1
        gone[last + 1] -= 1
        part = slice(self.starts[first], self.starts[end])
        kept: Array = self._bytes[part][np.cumsum(gone, dtype=np.int8)[part] == 0]
        return kept.tobytes()


def _chosen(text: bytes, starts: Array, lengths: Array, mine: Array) -> bytes:
    places = np.flatnonzero(mine)
    cuts = np.flatnonzero(np.diff(places) != 1)
    first, last = places[np.concatenate([[0], cuts + 1])], places[np.concatenate([cuts, [len(places) - 1]])]
    ends = starts[last] + lengths[last]
    return b"".join([text[a:b] for a, b in zip(starts[first].tolist(), ends.tolist(), strict=True)])


def _numbers(text: bytes, kind: Any) -> Array | None:
    """All of a text; None if something in it is none."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, kind, sep=" ")
        except (DeprecationWarning, ValueError, OverflowError):
            return None


def rows_of(sizes: Array, groups: Sequence[tuple[Array, Array]]) -> tuple[Any, Array]:
    """Faces from the numbers of corners of each and groups of (places, corners (k, size)): offsets, or one size for all, and
    corners."""
    size = int(sizes[0]) if len(sizes) and (sizes == sizes[0]).all() else 0
    if size:
        table = np.empty((len(sizes), size), np.int64)
        for places, rows in groups:
            table[places] = rows
        return size, table.reshape(-1)
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    corners = np.empty(offsets[-1], np.int64)
    for places, rows in groups:
        corners[offsets[places][:, None] + np.arange(rows.shape[1])] = rows
    return offsets, corners
