"""Words as the command line of `tripatch`: bad usage is said in a sentence, never by a traceback; what is read, `fill` takes.

python tests/fuzz/fuzz_command.py [CORPUS] [options of libFuzzer], as scripts/fuzz does
"""

from __future__ import annotations

import argparse
import contextlib
import io
import sys

import atheris

with atheris.instrument_imports(include=["tripatch"]):
    import tripatch
    from tripatch import __main__ as command
    from tripatch.arguments import reader
    from tripatch.batch import command as batch
    from tripatch.options import OPTIONS, checked, subdivision, value

import numpy as np

NAMES = sorted(OPTIONS)
WORDS = ["none", "auto", "optimal", "nan", "inf", "1e999", "-1", "0", "1,2,3", "0.5,0.5,0.5", "{}", "[]", ";", ",", "9" * 30]
WORDS += sorted({choice.name for option in OPTIONS.values() for choice in option.choices} | set(tripatch.METHODS))
PARSER = command.parser()
argparse.ArgumentParser.print_usage = lambda *_: None  # twenty times as long as all the rest
OCTAHEDRON = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]], float)
SEVEN = [[1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]


def text(given):
    """A value: a word that is known, or any."""
    if given.ConsumeBool():
        return given.PickValueInList(WORDS)
    return given.ConsumeUnicodeNoSurrogates(given.ConsumeIntInRange(0, 40))


def words(given):
    found = ["--all"] if given.ConsumeBool() else []
    for _ in range(given.ConsumeIntInRange(0, 4)):
        name = given.PickValueInList(NAMES)
        flag = f"--{'no-' * (given.ConsumeIntInRange(0, 9) == 0)}{name.replace('_', '-')}"
        found.append(flag if OPTIONS[name].kind == "flag" else f"{flag}={text(given)}")
    return found


def fill_with(options):
    """On a mesh that is small, with what makes no more than some hundred faces."""
    large = {"resolution": 12, "level": 3}
    try:
        if any((options.get(name) or 0) > most for name, most in large.items()) or (options.get("tolerance") or 1) < 1e-3:
            return
        fill = tripatch.fill(OCTAHEDRON, SEVEN, **options)
    except (ValueError, TypeError) as error:
        assert len(str(error)) > 10, error
        return
    assert np.isfinite(fill.vertices).all() and np.isfinite(fill.normals).all(), options


def anything(given, depth=0):
    """A value of Python as a script may pass one."""
    kind = given.ConsumeIntInRange(0, 11 if depth < 3 else 7)
    if kind == 0:
        return given.PickValueInList([None, True, False, 2**63, -(2**63) - 1, 10**400, 1j, b"a", {}, np.int8(3), np.float32(2)])
    if kind < 3:
        return given.ConsumeIntInRange(-3, 9)
    if kind < 5:
        return given.ConsumeInt(9)
    if kind == 5:
        return given.ConsumeRegularFloat() if given.ConsumeBool() else given.ConsumeFloat()
    if kind < 8:
        return text(given)
    many = [anything(given, depth + 1) for _ in range(given.ConsumeIntInRange(0, 5))]
    if kind == 8:
        return {text(given): each for each in many}
    if kind == 9:
        try:
            return np.array(many)
        except (ValueError, OverflowError):
            return many
    return many if kind == 10 else tuple(many)


def one_value(given):
    """The text of one option, or a value for it."""
    name = given.PickValueInList(NAMES)
    option, said = OPTIONS[name], text(given)
    try:
        found = reader(option)(said) if option.kind != "flag" and given.ConsumeBool() else anything(given)
        value(option, found) if option.kind != "subdivision" else subdivision(found)
    except (ValueError, TypeError, argparse.ArgumentTypeError) as error:
        assert len(str(error)) > 10, error
        return
    # seldom, as a fill takes a hundred times as long as all before; not 0, which is all there is where the bytes end
    if given.ConsumeIntInRange(0, 255) == 7 and "fill" in option.functions and option.kind != "subdivision":
        fill_with({name: found})


def one_call(given):
    options = {given.PickValueInList(NAMES): anything(given) for _ in range(given.ConsumeIntInRange(1, 4))}
    options = {name: each for name, each in options.items() if "fill" in OPTIONS[name].functions}
    try:
        checked("fill", options)
    except (ValueError, TypeError) as error:
        assert len(str(error)) > 10, error


def one_command(given):
    argv = ["batch", "a.obj", "--out=/nowhere"] if given.ConsumeIntInRange(0, 3) == 0 else ["fill", "a.obj", "b.obj"]
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(said):
            args = PARSER.parse_args(argv + words(given))
    except SystemExit as end:
        assert end.code in (0, 2)
        return
    try:
        if argv[0] == "batch":
            options = {name: getattr(args, name) for name in batch.BATCH_OPTIONS if hasattr(args, name)}
            checked("fill_all", {name: each for name, each in options.items() if "fill_all" in OPTIONS[name].functions})
            return
        options = command._options(args)
        checked("fill_all" if args.all else "fill", options)
    except (ValueError, TypeError) as error:
        assert len(str(error)) > 10, error
        return
    if not args.all and given.ConsumeIntInRange(0, 15) == 7:
        fill_with(options)


def one(data):
    given = atheris.FuzzedDataProvider(data)
    kind = given.ConsumeIntInRange(0, 63)
    (one_command if kind == 0 else one_call if kind < 16 else one_value)(given)


if __name__ == "__main__":
    atheris.Setup(sys.argv, one)
    atheris.Fuzz()
