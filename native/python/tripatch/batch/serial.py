"""The files one after the other, without a scheduler: what a command of a render farm does."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .keeper import Keeper
from .settings import Settings


def run(
    files: Sequence[Path],
    settings: Settings,
    before: Sequence[dict[str, Any] | None],
    take: Callable[[list[tuple[int, dict[str, Any]]]], None],
) -> None:
    """Does every file, and hands over (place in the list, entry) of each; before: of each what `job.work` wants of journals."""
    with Keeper(settings) as keeper:
        for k, file in enumerate(files):
            take([(k, keeper.work(str(file), before[k]))])
