"""The table of options, and what a caller gives checked by it: its rows serve functions, command lines and Blender's panels."""

from __future__ import annotations

import functools
import inspect
import math
import numbers
import textwrap
import types
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar, overload

import numpy as np

from . import _arrays, _native, messages
from ._native import Option
from .errors import WrongType, WrongValue, meant, not_one_of, out_of_range, wrong_shape, wrong_type
from .messages import Message

#: name -> construction, with .description, .citation, .fills_holes, .continuity, .sides (the smallest and the largest number;
#: (0, None): any rim) and .options: those of `fill` that it reads and not every construction does
METHODS = _native._methods()

#: name -> option of a fill, in the order of the table: .kind, .default, .optional, .by_side, .count, .choices, .range, .soft,
#: .unit, .description, .applies, .functions
OPTIONS: dict[str, Option] = _native._options()

#: What the checks of a call read. Every reading of a field of an Option makes new objects of what the core holds, and the fill
#: of a small hole spent a quarter of its time on that.
_FIELDS = ("name", "kind", "default", "optional", "by_side", "count", "none", "range", "applies", "functions")
_ROWS = [types.SimpleNamespace(**{field: getattr(option, field) for field in _FIELDS}) for option in OPTIONS.values()]

_LARGEST = 2**31 - 1
Function = TypeVar("Function", bound=Callable[..., Any])


def choice(value: Any, name: str, allowed: Sequence[Any]) -> Any:
    """The value, if it is one of the names allowed."""
    if value is not None and not isinstance(value, str):
        raise wrong_type(name, "str", value)
    if value not in allowed:
        raise not_one_of(name, value, allowed)
    return value


def whole(value: Any, name: str, least: float, most: float) -> int:
    """A whole number within a range; inf: no end, but for what the core can hold."""
    if isinstance(value, bool) or not isinstance(value, numbers.Integral):
        raise wrong_type(name, "int", value)
    if not least <= int(value) <= min(most, _LARGEST):
        raise out_of_range(name, int(value), least, most)
    return int(value)


def _flag(value: Any, option: Option) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise wrong_type(option.name, "bool", value)
    return bool(value)


def _wrong_count(option: Option, given: int) -> ValueError:
    return WrongValue(Message("wrong_count", {"name": option.name, "count": option.count, "given": given}))


def _whole(value: Any, option: Option) -> Any:
    if option.name == "resolution" and isinstance(value, numbers.Integral) and abs(int(value)) <= _LARGEST:
        return whole(value, option.name, -math.inf, math.inf)  # the core checks the range, which depends on the output
    if option.count == 1:
        return whole(value, option.name, option.range.least, option.range.most)
    numbers_given = tuple(value) if isinstance(value, Iterable) else (value,)
    if len(numbers_given) != option.count:
        raise _wrong_count(option, len(numbers_given))
    return [whole(each, option.name, option.range.least, option.range.most) for each in numbers_given]


def _float(value: Any, name: str) -> float:
    try:
        return float(value)
    except OverflowError:
        raise WrongValue(Message("not_finite", {"name": name})) from None


def _number(value: Any, option: Option) -> Any:
    if option.by_side:
        return [_float(x, option.name) for x in _arrays.by_side(value, option.name, numbers.Real)]
    if option.count > 1:
        try:
            numbers_given = np.asarray(value, dtype=float)
        except (TypeError, ValueError, OverflowError):
            raise wrong_type(option.name, "Sequence[float]", value) from None
        if numbers_given.shape != (option.count,):
            raise wrong_shape(option.name, f"({option.count},)", numbers_given.shape)
        if not np.isfinite(numbers_given).all():
            raise WrongValue(Message("not_finite", {"name": option.name}))
        return numbers_given.tolist()
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise wrong_type(option.name, "float | None" if option.optional else "float", value)
    return _float(value, option.name)


def names(option: Option) -> tuple[str, ...]:
    """What a choice offers."""
    return _names(option.name)


@functools.cache
def _names(option: str) -> tuple[str, ...]:
    return ("auto", *METHODS) if option == "method" else tuple(each.name for each in OPTIONS[option].choices)


@functools.cache
def _seen_names(option: str) -> dict[str, str]:
    """From what a panel calls the values of a choice, in small letters, to their names."""
    return {each.label.lower(): each.name for each in OPTIONS[option].choices if each.label}


def named_value(value: Any, option: Option) -> Any:
    """The value of a choice, or a list of those by side."""
    allowed = (None,) * option.optional + names(option)

    def named(each: Any) -> Any:
        known = each in allowed or not isinstance(each, str)
        return choice(each if known else _seen_names(option.name).get(each.lower(), each), option.name, allowed)

    if option.by_side:
        return [named(each) for each in _arrays.by_side(value, option.name, str)]
    return named(value)


def _indices(value: Any, option: Option) -> list[int]:
    found = _arrays.indices(value, option.name)
    if option.count and len(found) != option.count:
        raise _wrong_count(option, len(found))
    return found


def _loops(value: Any, option: Option) -> list[list[int]]:
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise wrong_type(option.name, "Sequence[Sequence[int]]", value)
    return [_arrays.indices(loop, option.name) for loop in value]


def _position(value: Any, option: Option) -> list[float]:
    position = np.asarray(value)
    if position.dtype.kind not in "fiu":
        raise wrong_type(option.name, "Sequence[float] | None", value)
    if position.shape != (3,):
        raise wrong_shape(option.name, "(3,)", position.shape)
    found: list[float] = position.astype(float).tolist()
    return found


def _points(value: Any, option: Option) -> list[tuple[list[float], list[float] | None]]:
    """Points, each with its normal or None, of points, pairs and polylines."""

    def wrong(given: Any) -> Message:
        return Message("not_points", {"name": option.name, "value": f"{given!r:.60}"})

    if isinstance(value, str) or not isinstance(value, Iterable):
        raise WrongType(wrong(value))
    found: list[tuple[list[float], list[float] | None]] = []
    for one in value:
        try:
            given = np.asarray(one, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise WrongType(wrong(one)) from None
        if given.ndim not in (1, 2) or given.shape[-1] != 3 or len(given) < 2 or not np.isfinite(given).all():
            raise WrongValue(wrong(one))
        if given.ndim == 1:
            found.append((given.tolist(), None))
        elif len(given) == 2:
            found.append((given[0].tolist(), given[1].tolist()))
        else:
            found += [(point.tolist(), None) for point in given]
    return found


def _creases(value: Any, name: str, width: int) -> tuple[list[Any], list[float]]:
    """(indices, values) of creases as lists, checked."""
    if value is None:
        return [], []
    try:
        places, values = (np.asarray(part) for part in value)
    except (TypeError, ValueError):
        raise wrong_type(name, "tuple[ndarray, ndarray]", value) from None
    if places.size == 0:
        return [], []
    if places.dtype.kind not in "iu" or values.dtype.kind not in "fiu":
        raise wrong_type(name, "tuple[ndarray[int], ndarray[float]]", value)
    _arrays.indices(places.ravel(), name)
    shapes = "(e, 2) and (e,)" if width == 2 else "(k,) and (k,)"
    if places.shape[1:] != (() if width == 1 else (width,)) or values.shape != places.shape[:1]:
        raise wrong_shape(name, shapes, f"{places.shape}, {values.shape}")
    outside = ~((values >= 0) & (values <= 1))
    if outside.any():
        raise out_of_range(name, float(values[outside][0]), 0, 1)
    return places.tolist(), values.astype(float).tolist()


def subdivision(settings: Mapping[str, Any] | None, level: int = 2) -> _native.Subdivision:
    """The settings of a Subdivision modifier of that level, as the core reads them."""
    if not isinstance(settings, Mapping | None):
        raise wrong_type("subdivision", "dict | None", settings)
    given = {} if settings is None else dict(settings)
    s = _native.Subdivision()
    s.loop = choice(given.pop("scheme", "catmull_clark"), "scheme", ("catmull_clark", "loop")) == "loop"
    smooth = choice(given.pop("boundary_smooth", "all"), "boundary_smooth", ("all", "preserve_corners"))
    s.preserve_corners = smooth == "preserve_corners"
    quality = given.pop("quality", 3)
    s.quality = None if quality is None else whole(quality, "quality", 1, 10)
    s.level = level
    s.use_limit_surface = bool(given.pop("use_limit_surface", True))
    s.crease_edges, s.edge_creases = _creases(given.pop("edge_creases", None), "edge_creases", 2)
    s.crease_vertices, s.vertex_creases = _creases(given.pop("vertex_creases", None), "vertex_creases", 1)
    s.loose_vertices = _arrays.indices(given.pop("loose_vertices", ()), "loose_vertices")
    if given:
        raise WrongValue(Message("no_such_option", {"function": "subdivision", "name": ", ".join(given)}))
    return s


_CHECKS: dict[str, Callable[..., Any]] = {
    "flag": _flag,
    "whole": _whole,
    "number": _number,
    "choice": named_value,
    "indices": _indices,
    "loops": _loops,
    "position": _position,
    "points": _points,
}


def applies(option: Option, values: dict[str, Any]) -> bool:
    """Whether an option is read where the others have these values."""

    def holds(name: str, value: str) -> bool:
        return values[name] == value if value else values[name] is not None

    return not option.applies or any(holds(name, value) for name, value in option.applies)


def value(option: Option, value: Any) -> Any:
    """What the core reads for a value that was given: names, numbers and lists."""
    if option.none is not None and isinstance(value, str) and value == option.none.name:
        return None
    if option.optional and value is None:
        return None
    if option.none is not None and isinstance(value, str) and option.kind != "choice":
        return choice(value, option.name, (option.none.name,))
    return _CHECKS[option.kind](value, option)


def of(function: str) -> list[Option]:
    """The options that a function takes."""
    return [option for option in OPTIONS.values() if function in option.functions]


@functools.cache
def _rows(function: str) -> list[Any]:
    return [row for row in _ROWS if function in row.functions]


@functools.cache
def _defaults(function: str) -> dict[str, Any]:
    return {option.name: option.default for option in _rows(function)}


@functools.cache
def _ready(function: str) -> dict[str, Any]:
    """The defaults as the core reads them: most options of most calls."""
    return {option.name: value(option, option.default) for option in _rows(function) if option.kind != "subdivision"}


def checked(function: str, given: dict[str, Any], called: str = "") -> dict[str, Any]:
    """The options of a function, by their types and with defaults, as the core reads them; it checks their ranges itself.

    Args:
        called: the function that a user called, if it is another.

    Raises:
        TypeError, ValueError: what is given has the wrong type or shape, or is no option. What a method takes the core knows.
    """
    rows, defaults, ready = _rows(function), _defaults(function), _ready(function)
    unknown = given.keys() - defaults.keys()
    if unknown:
        said = {"function": f"{called or function}()", "name": min(unknown), **meant(min(unknown), defaults)}
        raise WrongType(Message("no_such_option", said))
    values, made = defaults | given, dict(ready)
    if "method" in values:
        choice(values["method"], "method", names(OPTIONS["method"]))
    for option in rows:
        if option.name in given and option.kind != "subdivision":
            made[option.name] = value(option, values[option.name])
    for option in rows:
        if option.kind == "subdivision":
            settings = values[option.name] if applies(option, values) else None
            made[option.name] = subdivision(settings, made["level"])
    return made


def not_at_default(function: str, values: dict[str, Any]) -> dict[str, Any]:
    """Of what `checked` has returned what the core does not have anyway, which takes it 50 us to read."""
    ready = _ready(function)
    return {name: each for name, each in values.items() if name not in ready or each is not ready[name]}


def not_taken(method: str, values: Mapping[str, Any]) -> list[str]:
    """Of values for `fill`: the names of those that are not at their defaults and that a method, not "auto", does not read.

    Raises:
        TypeError, ValueError: no method of that name, or a value has the wrong type or range.
    """
    given = {name: value(OPTIONS[name], each) for name, each in values.items() if name in OPTIONS and name != "subdivision"}
    return _native._not_taken(method, given)


def described(option: Option, **default: Any) -> str:
    """The sentence, with the values of a choice. default: as the text `option_help` has it."""
    listed = [] if option.none is None else [option.none]
    if option.name != "method":
        listed += option.choices
    if option.unit:
        default["unit"] = option.unit
    if listed:
        default["choices"] = "; ".join(f"{each.name}: {each.description}" for each in listed)
    return messages.text("option_help", about=option.description, **default)


#: Groups, in their order: codes of their titles.
HOLES, FACES, SURFACE, CAGES, PAPERS = (f"{name}_group" for name in ("holes", "faces", "surface", "cages", "papers"))
_OF_FACES = ("output", "resolution", "features")


def group(option: Option) -> str:
    """The group that an option is listed in."""
    if "choose_holes" in option.functions or (not {"patch", "fill_all"} & set(option.functions)):
        return HOLES
    if option.name in _OF_FACES:
        return FACES
    if (
        not option.name == "method"
        and "patch" in option.functions
        and not any(METHODS[name].takes(option.name) for name in ("multi_sided", "polyharmonic_spline"))
    ):
        return PAPERS
    return SURFACE if "patch" in option.functions else CAGES


def groups(rows: Iterable[Option]) -> dict[str, list[Option]]:
    """Options by their groups."""
    found: dict[str, list[Option]] = {code: [] for code in (HOLES, FACES, SURFACE, CAGES, PAPERS)}
    for option in rows:
        found[group(option)].append(option)
    return {code: listed for code, listed in found.items() if listed}


#: What Python takes for an option of a kind.
_TYPES = {
    "flag": "bool",
    "whole": "int",
    "number": "float",
    "position": "(3,) float",
    "choice": "str",
    "indices": "(k,) int",
    "loops": "list of (k,) int",
    "points": "list",
    "subdivision": "dict",
}


def _type(option: Option) -> str:
    """Type and shape of the values that Python takes for an option."""
    one = _TYPES[option.kind]
    if option.count > 1 and option.kind != "position":
        one = f"({option.count},) {one}"
    if option.by_side:
        one += ", or one per side"
    return f"{one}, or None" if option.optional and not (option.none and option.none.name != "none") else one


@overload
def takes_options(named: Function) -> Function: ...
@overload
def takes_options(named: str) -> Callable[[Function], Function]: ...
def takes_options(named: Any) -> Any:
    """`help` and editors see by name the options that the code passes on, and what the table says of them.

    Args:
        named: the function; or the name of that whose options it takes.
    """
    if isinstance(named, str):
        return functools.partial(_described, named)
    return _described(named.__name__, named)


def _described(name: str, function: Function) -> Function:
    own = inspect.signature(function)
    keyword = inspect.Parameter.KEYWORD_ONLY
    kept = [p for p in own.parameters.values() if p.kind is not p.VAR_KEYWORD]
    rows = [option for option in of(name) if option.name not in own.parameters]
    parameters = [inspect.Parameter(option.name, keyword, default=option.default) for option in rows]
    vars(function)["__signature__"] = own.replace(parameters=[*kept, *parameters])
    described_rows: dict[bool, list[str]] = {True: [], False: []}  # by whether only papers need them
    for option in rows:
        text = f"{option.name} ({_type(option)}): {described(option)}.".replace("; none: ", "; None: ")
        lines = textwrap.fill(text, 126, initial_indent=" " * 4, subsequent_indent=" " * 8)
        described_rows[group(option) == PAPERS].append(lines)
    text = inspect.cleandoc(function.__doc__ or "")  # Python 3.13 does so itself
    text = text.replace("    **options: see OPTIONS.", "\n".join(described_rows[False]))
    if described_rows[True]:
        papers = "\n".join(["Other Parameters:", *described_rows[True]])
        text = text.replace("\nReturns:", f"\n{papers}\n\nReturns:", 1)
    function.__doc__ = text
    return function
