"""Types that annotations name; nothing is computed with them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

from numpy.typing import ArrayLike, NDArray

__all__ = ["Array", "ArrayLike", "Faces"]

Array: TypeAlias = NDArray[Any]
#: (m, 3), (m, 4), ... or lists of vertex indices
Faces: TypeAlias = NDArray[Any] | Sequence[Sequence[int]]
