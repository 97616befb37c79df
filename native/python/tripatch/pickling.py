"""How patches travel: by what they were made from, since the core makes the same from the same."""

from __future__ import annotations

from typing import Any

from . import _native
from ._native import BezierRectangle, BezierTriangle, Patch, RectangleSurface, Report, Side
from .errors import WrongType
from .messages import Message


def remade(function: str, *arguments: Any) -> Any:
    """A patch made by a function of the core, which can be made so again."""
    made = getattr(_native, function)(*arguments)
    patch = made[0] if isinstance(made, tuple) else made
    if isinstance(made, tuple) and isinstance(made[1], Report):
        patch._report = made[1]
    patch._recipe = remade, (function, *arguments)
    return patch


def _reduce(self: Any) -> tuple[Any, ...]:
    """For pickle: what makes it again."""
    if isinstance(self, BezierTriangle | BezierRectangle):
        return type(self), (self.net,)
    recipe = vars(self).get("_recipe")
    if recipe is None:
        raise WrongType(Message("not_picklable", {"type": type(self).__name__}))
    made: tuple[Any, ...] = recipe() if callable(recipe) else recipe
    return made


def _itself(self: Any, _: Any = None) -> Any:
    """A copy: it never changes."""
    return self


class SavedReport(Report):
    """A report that was pickled: the same values, no longer the core's."""

    def __init__(self, values: dict[str, Any]) -> None:
        super().__init__()
        self._values = values


def _saved(name: str, described: str | None) -> property:
    return property(lambda self: self._values[name], doc=described)


for _name, _member in list(vars(Report).items()):
    if isinstance(_member, property):
        setattr(SavedReport, _name, _saved(_name, _member.__doc__))
setattr(Report, "__reduce__", lambda self: (SavedReport, ({**self.as_dict(), "candidates": self.candidates},)))  # noqa: B010
_VALUES: tuple[type, ...] = (Patch, RectangleSurface, Report, Side)
for _class in _VALUES[:2]:
    setattr(_class, "__reduce__", _reduce)  # noqa: B010
for _class in _VALUES:
    for _name in ("__copy__", "__deepcopy__"):
        setattr(_class, _name, _itself)
