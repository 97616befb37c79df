"""How many threads fills work on."""

from . import _native


def set_threads(n: int | None) -> None:
    """Set how many threads fills work on, the calling thread included. No result depends on it.

    Args:
        n: from 1 on. None (the default): as many as there are cores, or fewer if the environment variable TRIPATCH_THREADS
            says so.

    Raises:
        ValueError: n is less than 1.
    """
    _native.set_threads(n)
