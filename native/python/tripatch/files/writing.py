"""What the formats share of writing: numbers and lines of a file that keep what is around them."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import secrets
import shutil
import stat
import tempfile
from array import array
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TypeVar

from ..errors import Coded, because
from ..messages import Message

Value = TypeVar("Value")
BYTE_ORDER_MARK = b"\xef\xbb\xbf"  # some editors put it before UTF-8


class FileError(Coded, ValueError):
    """A file that cannot be read or written; the argument is a `Message`.

    Attributes:
        code: a short name for what is wrong, such as "file_unreadable".
    """


def unreadable(path: object, error: Exception) -> FileError:
    """The error for a file that cannot be read for that reason."""
    return FileError(Message("file_unreadable", {"path": str(path), "reason": because(error)}))


def unwritable(path: object, error: Exception) -> FileError:
    """The same for one that cannot be written."""
    return FileError(Message("file_unwritable", {"path": str(path), "reason": because(error)}))


def damaged(form: str, error: object = "") -> FileError:
    """The error for a file that is not of its format, or not whole."""
    return FileError(Message("file_damaged", {"format": form, **({"reason": str(error)} if error else {})}))


def without_faces(points: int) -> FileError:
    """The error for a file that has points at most."""
    return FileError(Message("file_without_faces", {"points": points} if points else {}))


def write_over(path: Path, save: Callable[[Path], object]) -> None:
    """Has `save` write a file of a new name next to `path`, then puts it in its place: a full disk, or an end in between, costs
    nobody the file that was there. What is written over keeps its mode, owner and links."""
    try:
        target = Path(os.path.realpath(path))  # a link stays one
        try:
            before = target.stat()
        except FileNotFoundError:
            before = None
        if before and stat.S_ISDIR(before.st_mode):
            raise IsADirectoryError(Message("is_a_folder"))
        if before and not os.access(target, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        through = before and (before.st_nlink > 1 or not stat.S_ISREG(before.st_mode))  # it has other names, or is a device
        part = target.with_name(f".tripatch-{secrets.token_hex(6)}.part")
        if before and not stat.S_ISREG(before.st_mode):  # where nothing can be next to it
            part = Path(tempfile.gettempdir()) / part.name
        name = str(part)
        try:
            os.close(os.open(name, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
            save(part)
            if through:
                with part.open("rb") as source, target.open("wb") as out:
                    shutil.copyfileobj(source, out)
                return
            if before:
                os.chmod(part, stat.S_IMODE(before.st_mode))
                if (before.st_uid, before.st_gid) != (part.stat().st_uid, part.stat().st_gid) and hasattr(os, "chown"):
                    with contextlib.suppress(OSError):  # only root may give files away
                        os.chown(part, before.st_uid, before.st_gid)
            os.replace(part, target)
        finally:
            try:
                os.unlink(name)  # a function of C with a plain name: `Path.unlink` would let an interrupt in before it is done
            except FileNotFoundError:
                pass
    except OSError as error:
        raise unwritable(path, error) from error


def most(values: Iterable[Value]) -> Value:
    """The most frequent, the first of equals."""
    return Counter(values).most_common(1)[0][0]


def number(x: float) -> bytes:
    return repr(float(x)).encode()


def numbers(row: Iterable[float]) -> bytes:
    return b" ".join(map(number, row))


def with_numbers(text: bytes, first: int, values: Sequence[bytes]) -> bytes:
    """A line, or several that continue it, with other numbers from word `first` on; what is between the words stays."""
    words = list(re.finditer(rb"(?:(?!\\\r?\n)\S)+", text))[first : first + len(values)]
    for word, value in reversed(list(zip(words, values))):
        text = text[: word.start()] + value + text[word.end() :]
    return text


def lines(data: bytes) -> list[bytes]:
    return data.splitlines(keepends=True)


def line_starts(data: bytes) -> array[int]:
    """Of each line as `lines` has it, and the end of the last."""
    starts = array("q", [0])
    starts.extend(match.end() for match in re.finditer(rb"\r\n?|\n", data))
    if starts[-1] < len(data):
        starts.append(len(data))
    return starts


def line_end(lines: Sequence[bytes]) -> bytes:
    first = lines[0] if lines else b"\n"
    return first[len(first.rstrip(b"\r\n")) :] or b"\n"
