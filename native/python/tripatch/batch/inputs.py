"""Which files are meant, and in what portions they are done."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from ..errors import because
from ..messages import Message

#: What is looked for in folders. Files that are named may have any format that `tripatch fill` reads.
SUFFIXES = (".obj", ".ply", ".stl", ".off", ".glb", ".gltf", ".3mf", ".usd", ".usda", ".usdc", ".blend")

#: A portion is about this much to read: some seconds of work, so that little is lost with a worker and the milliseconds that a
#: scheduler takes for a task do not count.
_BYTES = 8_000_000
_FILES = 32
#: A file costs something however small it is.
_LEAST = 4096


class InputError(ValueError):
    """Files that cannot be meant; the argument is a `Message`."""


def listed(inputs: Sequence[str], out: Path) -> list[Path]:
    """The files that inputs mean, absolute, each once, sorted; folders are searched, `out` is not."""
    found: set[Path] = set()
    own = _identity(out)
    for given in inputs:
        path = Path(os.path.abspath(given))
        if path.is_dir():
            found.update(_below(path, own))
        elif path.exists() or path.is_symlink():
            found.add(path)
        else:
            raise InputError(Message("path_missing", {"path": given}))
    return sorted(found, key=os.fspath)


def _identity(path: Path) -> tuple[int, int] | None:
    """The same for all names of a file or folder, links among them; None where there is none."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_dev, found.st_ino


def _below(folder: Path, out: tuple[int, int] | None) -> Iterator[Path]:
    for place, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith(".") and not (out and _identity(Path(place, name)) == out)]
        for name in names:
            if name.lower().endswith(SUFFIXES) and not name.startswith("."):
                yield Path(place, name)


def from_list(path: Path) -> list[Path]:
    """The files that a list names, one a line, in its order."""
    try:
        # not by splitlines: a name may hold what else ends a line of text
        lines = path.read_text(encoding="utf-8-sig", errors="surrogateescape").split("\n")
    except OSError as error:
        raise InputError(Message("file_unreadable", {"path": str(path), "reason": because(error)})) from error
    if any("\0" in line for line in lines):
        raise InputError(Message("not_a_list", {"path": str(path)}))
    return [Path(os.path.abspath(path.parent / line)) for line in lines if line.strip()]


def root_of(files: Sequence[Path], given: str | None) -> Path:
    """The folder that names are counted from: the deepest that holds all files, unless another is given."""
    if given:
        root = Path(os.path.abspath(given))
        outside = next((file for file in files if not file.is_relative_to(root)), None)
        if outside:
            raise InputError(Message("outside_root", {"path": str(outside), "root": str(root)}))
        return root
    return Path(os.path.commonpath([file.parent for file in files])) if files else Path.cwd()


def check_places(files: Sequence[Path], inputs: Sequence[Path], root: Path, out: Path) -> None:
    """No result of files takes the place of an input, nor by a link."""
    there = {identity for file in files if (identity := _identity(out / file.relative_to(root)))}
    over = next((file for file in inputs if _identity(file) in there), None) if there else None
    if over:
        raise InputError(Message("would_overwrite", {"path": str(over), "option": "--out"}))


def size(path: Path) -> int:
    """Bytes; of what cannot be asked 0."""
    try:
        return path.stat().st_size
    except OSError:
        return 0


def portions(files: Sequence[Path], workers: int) -> list[range]:
    """Neighbors in the list that are done together: of about the same size in bytes, several for each worker."""
    sizes = [max(size(file), _LEAST) for file in files]
    most = min(_BYTES, max(_LEAST, sum(sizes) // (4 * workers)))
    parts, start, weight = [], 0, 0
    for k, bytes_ in enumerate(sizes):
        if k > start and (weight + bytes_ > most or k - start >= _FILES):
            parts.append(range(start, k))
            start, weight = k, 0
        weight += bytes_
    if files:
        parts.append(range(start, len(files)))
    return parts
