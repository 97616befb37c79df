"""What the system under the tests is, and what it says."""

from __future__ import annotations

import ctypes
import os
import sys

#: Wine, not Windows: no symbolic links, no complex functions in its C library (wine 8); worker processes of Dask do not start.
WINE = sys.platform == "win32" and hasattr(ctypes.windll.ntdll, "wine_get_version")


def missing_file() -> str:
    """What the system says of a file that does not exist."""
    try:
        os.stat("no such file")
    except OSError as error:
        return str(error.strerror)
    raise AssertionError("there is a file of that name")
