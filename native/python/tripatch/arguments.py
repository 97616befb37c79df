"""Options on a command line, of `tripatch` and of Blender without a window: arguments by the table, their texts as values."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from . import messages
from ._arrays import MAX_SIDES
from ._native import Option
from .errors import WrongValue, meant, not_one_of
from .messages import Message
from .options import OPTIONS, described, groups
from .options import names as names_of


def unreadable(text: str, example: str) -> argparse.ArgumentTypeError:
    """The error for a text that is not such as the example."""
    return argparse.ArgumentTypeError(Message("text_unreadable", {"text": f"{text!r:.60}", "example": example}))


def number(text: str, kind: Callable[[str], Any] = float, example: str = "0.5") -> Any:
    """A number."""
    try:
        return kind(text)
    except ValueError:
        raise unreadable(text, example) from None


def whole(text: str) -> int:
    """A whole number."""
    return int(number(text, int, "12"))


def indices(text: str) -> list[int]:
    """Vertex indices from 3,17,42."""
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise unreadable(text, "3,17,42") from None


def _indices_or_none(text: str) -> list[int]:
    return [] if text.lower() in ("none", "") else indices(text)


def _by_side(kind: Callable[..., Any], word: str) -> Callable[..., Any]:
    """One value or one a side, or the word."""

    def read(text: str) -> Any:
        if text == word:
            return text
        try:
            values = tuple(kind(part) for part in text.split(","))
        except ValueError:
            values = ()
        if not 1 <= len(values) <= MAX_SIDES:
            raise unreadable(text, word or "1,0.5,1")
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
            raise unreadable(text, example)
        return values

    return read


def _json(text: str) -> dict[str, Any]:
    try:
        found: dict[str, Any] = json.loads(text)
        return found
    except (ValueError, RecursionError) as error:
        raise unreadable(text, '{"scheme": "loop"}') from error


def _loops(text: str) -> list[list[int]] | str:
    if text in ("auto", "none"):
        return text
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
            raise unreadable(part, "0,0.5,1")
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
        "whole": whole,
        "number": number,
        "position": number,
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
        return "auto|none|V,V,...;V,V,..."
    if option.kind == "points":
        return "X,Y,Z;X,Y,Z;..."
    if option.kind == "indices":
        return "V,V,..."
    one = {"whole": "N", "number": "X", "choice": "NAME", "position": "X", "subdivision": "JSON"}[option.kind]
    if option.by_side:
        return f"{one}[,{one},...]"
    several = "MN" if one == "N" else "XYZ"
    return ",".join(several[: option.count]) if option.count > 1 else one


#: What an option is called on a command line where that is not its name; the name is understood there too.
FLAGS = {"output": "--faces"}


def flag(name: str) -> str:
    """What an option is called on a command line."""
    return FLAGS.get(name, f"--{name.replace('_', '-')}")


#: What a command line calls what Python names.
NAMES = {name: flag(name) for name in OPTIONS} | {"join": "--join", "fill_all": "--all"}


def worded(said: str) -> str:
    """A sentence as a command line says it."""
    return said.worded(names=NAMES) if isinstance(said, Message) else said


def _default(option: Option) -> dict[str, Any]:
    """What help says of the default, as a parameter of its text."""
    if option.kind in ("indices", "loops", "points", "subdivision") or "(default: " in option.description:
        return {}
    if option.kind == "flag":
        return {"on": 1} if option.default else {}
    return {"default": listed(option.default if isinstance(option.default, tuple) else (option.default,))}


def listed(values: Iterable[Any]) -> str:
    """Values as a command line takes them."""
    return ",".join("none" if x is None else x if isinstance(x, str) else f"{x:g}" for x in values)


def flag_help(code: str, **parameters: Any) -> dict[str, Any]:
    """The placeholder and the help of an argument, by the table of labels."""
    placeholder = messages.label(code)
    return {"help": messages.text(code, **parameters)} | ({"metavar": placeholder} if placeholder else {})


def command(commands: Any, name: str, **parameters: Any) -> argparse.ArgumentParser:
    """The parser of a command, by the table of labels. parameters: of its description."""
    code, end = f"command_{name}", f"exit_{name}"
    made: argparse.ArgumentParser = commands.add_parser(
        name,
        usage=messages.label(code),
        help=messages.text(code),
        description=messages.text(f"about_{name}", **parameters),
        epilog=messages.text(end) if end in messages.TABLE else None,
    )
    return made


def add(parser: argparse._ActionsContainer, option: Option) -> None:
    """`--name` for an option; what is not given is not in the namespace."""
    text = described(option, **_default(option)).replace("%", "%%")
    names = [flag(option.name)]
    if option.kind == "flag":
        value: dict[str, Any] = {"action": argparse.BooleanOptionalAction if option.default else "store_true"}
    else:
        value = {"type": reader(option), "metavar": _metavar(option)}
        if option.name == "output":
            value["metavar"] = "|".join(each.name for each in option.choices)
    parser.add_argument(*names, dest=option.name, default=argparse.SUPPRESS, help=text, **value)
    if option.name in FLAGS:
        name = f"--{option.name.replace('_', '-')}"
        parser.add_argument(name, dest=option.name, default=argparse.SUPPRESS, help=argparse.SUPPRESS, **value)


def add_groups(parser: argparse.ArgumentParser, options: Iterable[Option]) -> None:
    """Options in the groups of the table."""
    for code, rows in groups(options).items():
        group = parser.add_argument_group(messages.label(code))
        for option in rows:
            add(group, option)


def add_out(parser: argparse.ArgumentParser, code: str) -> None:
    """The file to write, as a second argument or by -o; `out_of` reads it."""
    parser.add_argument("out", metavar=messages.label(code), type=Path, nargs="?", help=argparse.SUPPRESS)
    parser.add_argument("-o", "--out", dest="out_by_name", type=Path, **flag_help(code))


def out_of(args: argparse.Namespace) -> Path:
    """The file to write.

    Raises:
        ValueError: none is named, or two are.
    """
    if args.out is not None and args.out_by_name is not None:
        raise WrongValue(Message("files_left_over", {"words": str(args.out), "usage": messages.label(f"command_{args.command}")}))
    found: Path | None = args.out if args.out_by_name is None else args.out_by_name
    if found is None:
        raise WrongValue(Message("output_unnamed", {"usage": messages.label(f"command_{args.command}")}))
    return found


def add_talk(parser: argparse.ArgumentParser, *, json: bool = False) -> None:
    """How much is said, and in which form."""
    group = parser.add_argument_group(messages.label("messages_group")).add_mutually_exclusive_group()
    if json:
        group.add_argument("--json", action="store_true", **flag_help("json_flag"))
    group.add_argument("-q", "--quiet", action="store_true", **flag_help("quiet_flag"))
    if json:
        group.add_argument("-v", "--verbose", action="store_true", **flag_help("verbose_flag"))
        group.add_argument("--why", action="store_true", **flag_help("why_flag"))


class _Help(argparse.RawDescriptionHelpFormatter):
    def add_usage(self, usage: Any, actions: Any, groups: Any, prefix: str | None = None) -> None:
        super().add_usage(usage, actions, groups, messages.label("usage") if prefix is None else prefix)


class Parser(argparse.ArgumentParser):
    """A parser that takes whole names only, shows its help if nothing is given, and suggests what may have been meant."""

    def __init__(self, *args: Any, **settings: Any) -> None:
        super().__init__(*args, **{"formatter_class": _Help, **settings, "allow_abbrev": False, "exit_on_error": False})
        self._optionals.title = messages.label("general_group")
        self._positionals.title = messages.label("arguments_group")
        next(action for action in self._actions if action.dest == "help").help = messages.text("help_flag")

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As of argparse, but what is not known is an error here, where it can be said what may have been meant."""
        given = sys.argv[1:] if args is None else list(args)
        if not given and not all(action.option_strings for action in self._actions):
            self.print_help()
            self.exit(2)
        try:
            found, unknown = super().parse_known_args(given, namespace)
        except argparse.ArgumentError as error:
            said = error.message
            self.error(Message("of_object", {"name": error.argument_name, "reason": said}) if error.argument_name else said)
        # argparse gives up on an argument that may be left out where options come before it
        late = [a for a in self._actions if a.nargs == "?" and not a.option_strings and getattr(found, a.dest) is None]
        if len(unknown) == len(late) == 1 and not unknown[0].startswith("-"):
            setattr(found, late[0].dest, self._get_value(late[0], unknown.pop()))
        if unknown and not any(word.startswith("-") for word in unknown):
            self.error(Message("files_left_over", {"words": " ".join(unknown), "usage": self.usage or self.prog}))
        if unknown:
            self.error(Message("unknown_arguments", {"words": " ".join(unknown), **self._meant(unknown[0])}))
        return found, unknown

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            name = (*action.option_strings, action.dest)[0]
            raise argparse.ArgumentError(None, str(not_one_of(name, value, action.choices)))

    def _match_argument(self, action: argparse.Action, pattern: str) -> int:
        try:
            return super()._match_argument(action, pattern)
        except argparse.ArgumentError:
            needed = action.metavar or "|".join(action.choices or ())
            said = Message("option_needs", {"option": action.option_strings[0], "needed": str(needed)})
            raise argparse.ArgumentError(None, said) from None

    def _meant(self, word: str) -> dict[str, str]:
        if not word.startswith("--"):
            return {}
        name = word.partition("=")[0][2:]
        shown = [each for action in self._actions if action.help != argparse.SUPPRESS for each in action.option_strings]
        own = {option: flag(option) for option in OPTIONS if flag(option) in shown}
        value = name.replace("-", "_")
        of_values = [f"{each} {value}" for option, each in own.items() if value in names_of(OPTIONS[option])]
        if len(of_values) == 1:  # the value of one option
            return {"meant": of_values[0]}
        if name in own:  # as Python calls it
            return {"meant": own[name]}
        near = meant(name, [each[2:] for each in shown if each.startswith("--")])  # "--" would make all names alike
        return {"meant": f"--{near['meant']}"} if near else {}
