"""Options on a command line, of `tripatch` and of Blender without a window: arguments by the table, their texts as values."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from typing import Any

from ._arrays import MOST_SIDES
from ._native import Option
from .options import described

_COUNTS = {2: "two", 3: "three"}


def indices(text: str) -> list[int]:
    """Vertex indices from 3,17,42."""
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no list of vertex indices such as 3,17,42") from None


def _indices_or_none(text: str) -> list[int]:
    return [] if text.lower() == "none" else indices(text)


def _by_side(kind: Callable[..., Any], word: str) -> Callable[..., Any]:
    """One value or one a side, or the word."""

    def read(text: str) -> Any:
        if text == word:
            return text
        try:
            values = tuple(kind(part) for part in text.split(","))
        except ValueError:
            other = f"neither one value nor one a side, separated by commas{', nor ' * bool(word)}{word}"
            raise argparse.ArgumentTypeError(f"{text!r} is {other}") from None
        if len(values) > MOST_SIDES:
            raise argparse.ArgumentTypeError(f"one value or one a side are needed, {MOST_SIDES} at most, not {len(values)}")
        return values[0] if len(values) == 1 else values

    return read


def _numbers(kind: Callable[..., Any], count: int) -> Callable[..., Any]:
    example = "2,6" if kind is int else "0,0.5,1" if count == 3 else "0.1,0"

    def read(text: str) -> tuple[float, ...]:
        try:
            values = tuple(kind(part) for part in text.split(","))
        except ValueError:
            values = ()
        if len(values) != count:
            raise argparse.ArgumentTypeError(f"{text!r} are no {_COUNTS[count]} numbers such as {example}")
        return values

    return read


def _json(text: str) -> dict[str, Any]:
    try:
        found: dict[str, Any] = json.loads(text)
        return found
    except (ValueError, RecursionError) as error:
        given = text if len(text) <= 60 else text[:57] + "..."
        raise argparse.ArgumentTypeError(f"{given!r} is no JSON: {error}") from None


def _loops(text: str) -> list[list[int]]:
    return [indices(part) for part in text.split(";") if part]


def _points(text: str) -> list[list[float] | list[list[float]]]:
    """Points x,y,z, or with their normals x,y,z,nx,ny,nz."""
    found: list[Any] = []
    for part in text.split(";"):
        try:
            values = [float(number) for number in part.split(",")]
        except ValueError:
            values = []
        if len(values) not in (3, 6):
            raise argparse.ArgumentTypeError(f"{part!r} is no point such as 0,0.5,1, nor a point and its normal")
        found.append(values if len(values) == 3 else [values[:3], values[3:]])
    return found


def _or_none(read: Callable[..., Any], word: str) -> Callable[..., Any]:
    def read_or_none(text: str) -> Any:
        return None if text.lower() == word else read(text)

    read_or_none.__name__ = read.__name__
    return read_or_none


def reader(option: Option) -> Callable[..., Any]:
    """From a text to a value that `tripatch.fill` takes."""
    of_kind: dict[str, Callable[..., Any]] = {
        "whole": int,
        "number": float,
        "position": float,
        "choice": str,
        "subdivision": _json,
    }
    read: Callable[..., Any]
    if option.kind == "loops":
        read = _loops
    elif option.kind == "points":
        read = _points
    elif option.kind == "indices":
        read = _indices_or_none
    elif option.by_side:
        read = _by_side(of_kind[option.kind], option.none.name if option.none else "")
    elif option.kind == "position" or option.count > 1:
        read = _numbers(of_kind[option.kind], option.count)
    else:
        read = of_kind[option.kind]
    alone = option.kind != "indices" and not option.by_side
    return _or_none(read, option.none.name if option.none else "none") if option.optional and alone else read


def _metavar(option: Option) -> str:
    if option.kind == "loops":
        return "V,V,...;V,V,..."
    if option.kind == "points":
        return "X,Y,Z;X,Y,Z;..."
    if option.kind == "indices":
        return "V,V,..."
    one = {"whole": "N", "number": "X", "choice": "NAME", "position": "X", "subdivision": "JSON"}[option.kind]
    if option.by_side:
        return f"{one}[,{one},...]"
    several = "MN" if one == "N" else "XYZ"
    return ",".join(several[: option.count]) if option.count > 1 else one


def add(parser: argparse.ArgumentParser, option: Option) -> None:
    """`--name` for an option; what is not given is not in the namespace."""
    text = described(option)
    if option.kind not in ("flag", "indices", "loops", "points", "subdivision"):
        text += f" ({'none' if option.default is None else option.default})".replace("(0.0, 0.0)", "0,0")
    if option.kind == "flag":
        value: dict[str, Any] = {"action": argparse.BooleanOptionalAction if option.default else "store_true"}
    else:
        value = {"type": reader(option), "metavar": _metavar(option)}
    parser.add_argument(f"--{option.name.replace('_', '-')}", default=argparse.SUPPRESS, help=text.replace("%", "%%"), **value)
