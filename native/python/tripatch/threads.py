"""How many threads fills work on."""

from __future__ import annotations

import numbers

from . import _native
from .errors import wrong_type


def set_threads(n: int | None) -> None:
    """Set how many threads fills work on, the calling thread included. No result depends on it.

    Args:
        n: from 1 on. None (the default): as many as there are cores, or fewer if the environment variable TRIPATCH_THREADS
            says so.

    Raises:
        TypeError: n is no whole number.
        ValueError: n is less than 1.
    """
    if n is not None and (isinstance(n, bool) or not isinstance(n, numbers.Integral)):
        raise wrong_type("n", "int | None", n)
    _native.set_threads(n)
