"""One mesh that may be larger than the memory: its file is mapped and cut into parts, processes fill the holes of each, and what
they add goes into a copy of the file. The result is the same as that of a file which is read as a whole."""

from __future__ import annotations

import contextlib
import hashlib
import json
import mmap
import os
import shutil
import time
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .. import files
from .._types import Array
from ..files import evidence
from ..files.ply_parts import PlyParts
from ..files.writing import FileError, unreadable, write_over
from ..messages import Message
from . import job, journal, record
from .cutting import BorderMesh, Cuts
from .keeper import Ended
from .parts import Answers, Filled, Found, Task
from .settings import FILL, LIST, Settings

#: Has tasks done in any order: yields the place of each and what `parts.fill` returns of it.
Runner = Callable[[Iterator[Task]], Answers]


def is_cut(file: Path, settings: Settings, least: int) -> bool:
    """Whether a file is filled in parts: a PLY file of more bytes than `least`, if no option needs the mesh as a whole."""
    options = settings.options
    output = options.get("output")
    splits = output == "quads" and options.get("odd") != "triangle"  # edges of old faces
    whole = output == "cage" or options.get("surroundings") == "limit" or splits or "join" in options
    try:
        if whole or file.suffix.lower() != ".ply" or file.stat().st_size <= least:
            return False
        with file.open("rb") as opened:
            return opened.read(100).find(b"format binary") >= 0
    except OSError:
        return False


def work(
    path: Path, settings: Settings, done_before: dict[str, Any] | None, run: Runner, tell: Callable[[int, int], None]
) -> dict[str, Any] | None:
    """As `job.work`, of a mesh that is filled in parts; None of a file that has to be read as a whole.

    Args:
        run: has the parts filled.
        tell: is called with the number of parts that are filled, and of all.
    """
    begun = time.monotonic()
    name = path.relative_to(settings.root).as_posix()
    sha256, known = job.opened(path, name, settings, done_before, begun)
    if known:
        return known
    values: dict[str, Any] = {"sha256": sha256}
    try:
        with path.open("rb") as file:
            data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)  # ends with the last that looks into it
        lines = Large(PlyParts(data), name, sha256, settings).lines(run, tell)
        return job.entry(settings, name, sha256, lines, begun)
    except NotImplementedError:
        return None
    except (FileError, OSError) as error:
        values |= {"status": record.UNREADABLE, "reason": str(unreadable(path, error)).replace(os.fspath(path), name)}
    except MemoryError:
        values |= {"status": record.MEMORY_LIMIT, "reason": job.memory_reason(settings)}
    except Ended as end:
        values |= {"status": end.status, "reason": str(end)}
    return job.entry(settings, name, sha256, [record.of_file(settings, name, **values)], begun)


class Large:
    """A mesh and what has become of its holes so far."""

    def __init__(self, ply: PlyParts, name: str, sha256: str, settings: Settings) -> None:
        self._ply, self._name, self._sha256, self._settings = ply, name, sha256, settings
        self._mesh = BorderMesh(ply, settings.choosing())
        self._done: dict[int, Filled] = {}
        self._part: dict[int, int] = {}  # of each hole, in which it was filled
        self._parts = 0
        self._folder = Path(settings.out, journal.FOLDER, "parts-" + record.key(settings, name, sha256)[:16])

    def lines(self, run: Runner, tell: Callable[[int, int], None]) -> list[dict[str, Any]]:
        """Fills the holes and writes the file; that of the file and those of its holes."""
        settings, name, holes = self._settings, self._name, self._mesh.holes
        if settings.mode != LIST:
            self._fill(run, tell)

        def line(k: int) -> dict[str, Any]:
            if k in holes.refused:
                return record.of_hole(settings, name, holes.refused[k].renumbered(self._mesh.number))
            return self._done[k].line

        found = job.lines_of_holes(holes, self._mesh.vertices, settings, name, line, self._mesh.number)
        values = {"vertices": self._ply.count, "faces": self._ply.rows.faces, **record.outcome(found)}
        if not self._ply.rows.faces:
            values["reason"] = str(files.without_faces(self._ply.count))
        if values["filled"]:
            obstacle = self._obstacle()
            if obstacle:
                values = {"status": record.NOT_WRITTEN, "reason": obstacle}
                return [record.of_file(settings, name, sha256=self._sha256, **values)]
            values["output"] = name
        if settings.mode == FILL:
            shutil.rmtree(self._folder, ignore_errors=True)
        return [record.of_file(settings, name, sha256=self._sha256, **values), *found]

    def _fill(self, run: Runner, tell: Callable[[int, int], None]) -> None:
        cuts = Cuts(self._ply, self._mesh, self._name)
        wanted = sorted(cuts.of_hole)
        while wanted:
            parts = list(cuts.tasks_of(wanted))
            short: set[int] = set()
            for done, (place, found) in enumerate(self._filled(cuts, parts, run), 1):
                for k, filled in found.items():
                    if filled is None:
                        short.add(k)
                    else:
                        self._done[k], self._part[k] = filled, self._parts + place
                tell(done, len(parts))
            self._parts += len(parts)
            for k in short:
                cuts.of_hole[k].rings *= 2
            fresh = [k for part in parts for k in part if k not in short]
            wanted = sorted(short | self._without_faces_near(cuts, fresh) | self._in_each_others_way(cuts, fresh))

    def _filled(self, cuts: Cuts, parts: Sequence[list[int]], run: Runner) -> Iterator[tuple[int, Found]]:
        """What became of parts, those that a run before has left first."""
        kept = [self._folder / self._label(cuts, part) for part in parts]
        left = []
        for place, path in enumerate(kept):
            before = _kept(path)
            if before is None:
                left.append(place)
            else:
                yield place, before
        with contextlib.closing(run(cuts.task(parts[place]) for place in left)) as results:
            for number, found in results:
                place = left[number]
                self._folder.mkdir(parents=True, exist_ok=True)
                _keep(found, kept[place])
                yield place, found

    def _label(self, cuts: Cuts, part: list[int]) -> str:
        """What the result of a part depends on, in short, apart from the file and the options."""
        said = [(k, cuts.of_hole[k].rings, sorted(cuts.of_hole[k].more)) for k in part]
        return hashlib.sha256(record.text(said).encode()).hexdigest()[:32]

    def _without_faces_near(self, cuts: Cuts, fresh: Sequence[int]) -> set[int]:
        """The holes whose fills other faces of the mesh come near, which their parts get now."""
        looked_at = [k for k in fresh if self._done[k].box is not None]
        if not looked_at:
            return set()
        boxes = np.array([self._done[k].box for k in looked_at])
        counts = self._ply.count_meeting(boxes)
        few = [i for i, k in enumerate(looked_at) if counts[i] != self._done[k].meeting]
        if few:
            for i, more in zip(few, self._ply.meeting(boxes[few]), strict=True):
                cuts.of_hole[looked_at[i]].more.update(more.tolist())
        return {looked_at[i] for i in few}

    def _in_each_others_way(self, cuts: Cuts, fresh: Sequence[int]) -> set[int]:
        """Holes whose fills may pass through each other, which were filled in different parts."""
        named = [k for k, filled in self._done.items() if filled.box is not None]
        new = set(fresh)
        found = set()
        for i, j in _overlapping(np.array([self._done[k].box for k in named]).reshape(-1, 6)):
            a, b = named[i], named[j]
            if self._part[a] != self._part[b] and (a in new or b in new):
                cuts.unite(a, b)
                found |= {a, b}
        return found

    def _obstacle(self) -> str:
        """Writes the file; why that cannot be done, else nothing."""
        out = Path(self._settings.out, self._name)

        def save(path: Path) -> None:
            with path.open("wb") as file:
                for piece in self._pieces():
                    file.write(piece)

        try:
            out.parent.mkdir(parents=True, exist_ok=True)
            write_over(out, save)
        except (FileError, OSError) as error:
            return str(error).replace(os.fspath(out), self._name)
        return ""

    def _pieces(self) -> Iterable[Any]:
        ply, first = self._ply, self._ply.fills_before()
        fills = [self._done[k] for k in sorted(self._done) if self._done[k].about is not None]
        offsets = np.cumsum([0, *(fill.vertices[0] for fill in fills)])
        if element := ply.is_too_many(ply.count + int(offsets[-1]), first + len(fills)):
            raise FileError(Message("indices_too_large", {"element": element}))
        numbers = range(first + 1, first + 1 + len(fills))
        about = [{"fill": number, **(fill.about or {})} for number, fill in zip(numbers, fills, strict=True)]
        kinds = ply.kinds_in_faces(evidence.FILL)
        faces = (_renumbered(*each, ply.count, *kinds) for each in zip(fills, offsets[:-1].tolist(), numbers, strict=True))
        new = sum(fill.faces[0] for fill in fills)
        added = {"vertex": (int(offsets[-1]), (fill.vertices[1] for fill in fills)), "face": (new, faces)}
        return ply.with_fills(self._sha256, about, added)


def _renumbered(fill: Filled, by: int, number: int, count: int, corner: Any, mark: Any) -> bytes:
    """The rows of a fill's faces. by: how many vertices fills before it have added; count: of the mesh; corner, mark: types."""
    rows = np.frombuffer(fill.faces[1], np.uint8).copy()
    places, vertices = fill.corners
    for at, values, kind in (
        (places, np.where(vertices >= count, vertices + by, vertices), corner),
        (fill.marks, np.full(len(fill.marks), number), mark),
    ):
        rows[at[:, None] + np.arange(kind.itemsize)] = values.astype(kind).view(np.uint8).reshape(len(at), -1)
    return rows.tobytes()


def _overlapping(boxes: Array) -> Iterator[tuple[int, int]]:
    """Pairs of boxes (k, 6) that meet."""
    order = np.argsort(boxes[:, 0], kind="stable")
    low, high = boxes[order, :3], boxes[order, 3:]
    ends = np.searchsorted(low[:, 0], high[:, 0], "right")
    for i, end in enumerate(ends.tolist()):
        others = slice(i + 1, end)
        meets = ((low[others, 1:] <= high[i, 1:]) & (high[others, 1:] >= low[i, 1:])).all(axis=1)
        for j in np.flatnonzero(meets).tolist():
            yield int(order[i]), int(order[i + 1 + j])


_ARRAYS = ("places", "vertices", "marks", "box")


def _keep(found: Found, path: Path) -> None:
    """Writes what became of the holes of a part, for a run that continues this one."""
    said: list[list[Any]] = []
    rows: dict[str, list[Array]] = {name: [np.zeros(0)] for name in _ARRAYS}
    bytes_: list[bytes] = []
    for k, filled in found.items():
        if filled is None:
            said.append([k])
            continue
        own = {"places": filled.corners[0], "vertices": filled.corners[1], "marks": filled.marks, "box": filled.box}
        arrays = {name: np.zeros(0) if value is None else value for name, value in own.items()}
        for name, value in arrays.items():
            rows[name].append(value)
        bytes_ += [filled.vertices[1], filled.faces[1]]
        sizes = [len(arrays[name]) for name in _ARRAYS], [len(piece) for piece in bytes_[-2:]]
        said.append([k, filled.line, filled.about, filled.vertices[0], filled.faces[0], filled.meeting, *sizes])
    arrays = {name: np.concatenate(values) for name, values in rows.items()}
    text = np.frombuffer(record.text(said).encode(), np.uint8)

    def save(part: Path) -> None:
        with part.open("wb") as file:
            np.savez(file, said=text, bytes=np.frombuffer(b"".join(bytes_), np.uint8), **arrays)

    write_over(path, save)


def _kept(path: Path) -> Found | None:
    """What a run before has written; None where it has not."""
    try:
        with np.load(path, allow_pickle=False) as held:
            data, said = {name: held[name] for name in (*_ARRAYS, "bytes")}, json.loads(held["said"].tobytes())
    except (OSError, EOFError, ValueError, KeyError, zipfile.BadZipFile):
        return None
    found: Found = {}
    at = dict.fromkeys(data, 0)

    def taken(name: str, size: int) -> Array:
        at[name] += size
        found: Array = data[name][at[name] - size : at[name]]
        return found

    for k, *rest in said:
        if not rest:
            found[k] = None
            continue
        line, about, vertices, faces, meeting, sizes, lengths = rest
        places, corners, marks, box = (taken(name, size) for name, size in zip(_ARRAYS, sizes, strict=True))
        rows = [taken("bytes", length).tobytes() for length in lengths]
        both = places.astype(np.int64), corners.astype(np.int64)
        own = (vertices, rows[0]), (faces, rows[1]), both, marks.astype(np.int64)
        found[k] = Filled(line, about, *own, box if len(box) else None, meeting)
    return found
