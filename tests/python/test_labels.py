"""Labels, tooltips and help are rows of the table of labels: none is a literal, none is glued together, and every row is used."""

import argparse
import ast
import re
from pathlib import Path

import pytest
import tripatch
from test_messages import in_pseudo_language  # noqa: F401  a fixture
from tripatch import __main__ as cli
from tripatch import _native, messages
from tripatch.batch import journal

ROOT = Path(__file__).resolve().parents[2]
ADDON, PACKAGE = ROOT / "addon" / "tripatch_blender", ROOT / "native" / "python" / "tripatch"
TREES = {file: ast.parse(file.read_text()) for folder in (ADDON, PACKAGE) for file in folder.rglob("*.py")}
LABELS = {code for code, row in messages.TABLE.items() if row.kind == "label"}
#: Functions that take the code of a label.
READERS = {"label", "text", "titled", "named", "flag_help", "shown"}


def test_no_code_has_two_rows():
    codes = [code for code, *_ in _native._messages()]
    assert len(codes) == len(set(codes))


@pytest.mark.parametrize("code", sorted(LABELS))
def test_a_label_says_something_in_one_form(code):
    row = messages.TABLE[code]
    assert row.panel or row.sentence
    assert not row.sentence.endswith(".") or code.startswith("about_")
    assert row.sentence.count("{") == row.sentence.count("}") and row.sentence.count("[") == row.sentence.count("]")
    assert row.sentence[:1].isupper() or not row.sentence or code.startswith(("exit_", "option_"))


def parsers():
    """The parser of `tripatch` and those of its commands."""
    main = cli.parser()
    yield main
    yield from next(action for action in main._actions if action.dest == "command").choices.values()


def texts_of_options():
    """What the table of options says, longest first."""
    for option in tripatch.OPTIONS.values():
        yield from (option.name, option.description, option.unit, option.none.name if option.none else "")
        for each in [*option.choices, *filter(None, [option.none])]:
            yield from (each.name, each.description)
    yield from (f"--{name}" for name in ("islands", "rim"))


def rest(said, names):
    """What is left of a text without some names."""
    for name in sorted(filter(None, names), key=len, reverse=True):
        said = said.replace(name, "")
    return said


@pytest.mark.usefixtures("in_pseudo_language")
def test_help_has_no_words_but_those_of_the_tables():
    names = [*texts_of_options(), "auto|none|V,V,...;V,V,..."]
    for parser in parsers():
        flags = [flag for action in parser._actions for flag in action.option_strings]
        usage = rest(parser.format_usage(), [parser.prog, *flags])
        assert not re.search("[A-Za-z]", usage), usage
        said = [parser.description or "", parser.epilog or "", *(group.title or "" for group in parser._action_groups)]
        for action in parser._actions:
            if action.help == argparse.SUPPRESS:
                continue
            of_table = action.dest in tripatch.OPTIONS
            said.append(rest(action.help or "", names) if of_table else rest(action.help or "", [str(action.default)]))
            said += [] if of_table or action.metavar is None else [action.metavar]
            said += [each.help for each in getattr(action, "_choices_actions", [])]
        for text in said:
            assert not re.search("[A-Za-z]", rest(text, [journal.LINES, journal.SHEET])), text


def spoken(node):
    """The literal words of an expression that is shown; what a call returns is its own concern."""
    if isinstance(node, ast.Constant):
        return [node.value] if isinstance(node.value, str) and re.search("[A-Za-z]", node.value) else []
    parts = {
        ast.JoinedStr: lambda: node.values,
        ast.BinOp: lambda: [node.left, node.right],
        ast.IfExp: lambda: [node.body, node.orelse],
        ast.List: lambda: node.elts,
        ast.Tuple: lambda: node.elts[1:],  # of an enumeration; the first is its identifier
    }.get(type(node), lambda: [])()
    return [word for part in parts for word in spoken(part)]


def name_of(call):
    return getattr(call.func, "attr", getattr(call.func, "id", ""))


def shown_by(call):
    """The expressions that a call shows to a user."""
    name = name_of(call)
    given = {keyword.arg: keyword.value for keyword in call.keywords}
    if name in ("add_argument", "add_parser", "add_subparsers", "Parser", "ArgumentParser", "add_argument_group"):
        yield from (given[each] for each in ("help", "description", "epilog", "usage", "title", "metavar") if each in given)
        yield from call.args if name == "add_argument_group" else ()
        return
    of_property = name.endswith("Property") or name in ("of", "by_side")
    keywords = ("name", "description", "items") if of_property else ("text", "heading", "message")
    yield from (given[each] for each in keywords if each in given)
    if name in ("label", "status_text_set", "header_text_set") and getattr(call.func, "value", None) is not None:
        owner = ast.unparse(call.func.value)
        yield from () if owner in ("library", "messages", "properties", "tripatch.messages") else call.args


def literals(tree):
    """(line, what) of each literal in a tree that a user would read."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            yield from ((node.lineno, word) for shown in shown_by(node) for word in spoken(shown))
        elif isinstance(node, ast.Assign):
            named = {getattr(each, "id", "") for target in node.targets for each in getattr(target, "elts", [target])}
            if named & {"bl_label", "bl_description"}:
                yield from ((node.lineno, word) for each in getattr(node.value, "elts", [node.value]) for word in spoken(each))


@pytest.mark.parametrize("file", TREES, ids=lambda file: file.name)
def test_no_label_tooltip_or_help_is_a_literal(file):
    assert list(literals(TREES[file])) == []


@pytest.mark.parametrize(
    "source",
    [
        'parser.add_argument("--all", help="Fill all")',
        'parser.add_argument_group("Limits")',
        'row.prop(self, "width", text="Width")',
        'layout.label(text=f"{n} holes")',
        'x: BoolProperty(name="Keep")',
        'x = EnumProperty(items=[("a", "First", "")])',
        'class A:\n    bl_label = "Fill"',
        'class A:\n    bl_label, bl_description = "Fill", label("x")',
    ],
)
def test_literals_are_found(source):
    assert list(literals(ast.parse(source)))


def test_what_has_a_tooltip_takes_it_from_the_table():
    """Blender takes the docstring of an operator or a panel that has no description."""
    for file, tree in TREES.items():
        for node in ast.walk(tree):
            bases = {ast.unparse(base) for base in node.bases} if isinstance(node, ast.ClassDef) else set()
            if bases & {"bpy.types.Operator", "bpy.types.Panel", "bpy.types.WorkSpaceTool"}:
                assert "bl_description" in ast.unparse(node.body), f"{file.name}: {node.name}"


def test_every_label_is_used_and_every_label_that_is_used_exists():
    named, patterns = set(), []
    for tree in TREES.values():
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                named.add(node.value)
            elif isinstance(node, ast.JoinedStr):  # such as f"shading_{name}"
                parts = [each.value if isinstance(each, ast.Constant) else ".+" for each in node.values]
                patterns += ["".join(parts)] if re.search(r"[a-z]{3,}_|_[a-z]{3,}", "".join(parts)) else []
            if isinstance(node, ast.Call) and name_of(node) == "items" and node.args:  # of an enumeration
                prefix, *values = (getattr(each, "value", None) for each in node.args)
                named |= {f"{prefix}_{value}".lower() for value in values}
            if isinstance(node, ast.Call) and name_of(node) in READERS and node.args:
                code = node.args[0]
                if isinstance(code, ast.Constant) and isinstance(node.func, ast.Name | ast.Attribute):
                    owner = ast.unparse(node.func).rpartition(".")[0]
                    assert owner not in ("library", "messages") or code.value in LABELS, code.value
    patterns = [pattern for pattern in patterns if re.fullmatch(r"[\w.+]+", pattern)]
    assert not {code for code in LABELS - named if not any(re.fullmatch(pattern, code) for pattern in patterns)}
