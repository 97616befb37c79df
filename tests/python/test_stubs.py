"""The type stubs name what the package has, with the same parameters and defaults."""

import ast
import inspect
from pathlib import Path

import pytest
import tripatch

STUB = ast.parse((Path(tripatch.__file__).parent / "__init__.pyi").read_text())
FUNCTIONS = {node.name: node for node in STUB.body if isinstance(node, ast.FunctionDef)}
CLASSES = {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}


def parameters(node):
    """Names and defaults of a function in the stub."""
    a = node.args
    positional = [*a.posonlyargs, *a.args]
    defaults = [inspect.Parameter.empty] * (len(positional) - len(a.defaults)) + [ast.literal_eval(d) for d in a.defaults]
    found = dict(zip([p.arg for p in positional], defaults, strict=True))
    for p, d in zip(a.kwonlyargs, a.kw_defaults, strict=True):
        found[p.arg] = inspect.Parameter.empty if d is None else ast.literal_eval(d)
    return found


def test_every_public_name_has_a_stub():
    taken = {a.asname for node in STUB.body if isinstance(node, ast.ImportFrom) for a in node.names if a.asname == a.name}
    named = set(FUNCTIONS) | set(CLASSES) | taken | {"METHODS", "OPTIONS", "SURROUNDING_RINGS"}
    assert set(tripatch.__all__) <= named


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_functions_have_the_same_parameters(name):
    signature = inspect.signature(getattr(tripatch, name))
    assert parameters(FUNCTIONS[name]) == {p.name: p.default for p in signature.parameters.values()}


@pytest.mark.parametrize("name", sorted(set(CLASSES) & set(tripatch.__all__) - {"Fill"}))
def test_classes_have_what_the_stub_says(name):
    members = [
        node.name if isinstance(node, ast.FunctionDef) else node.target.id
        for node in CLASSES[name].body
        if isinstance(node, (ast.FunctionDef, ast.AnnAssign))
    ]
    public = getattr(tripatch, name)
    missing = [m for m in members if not hasattr(public, m) and m not in getattr(public, "__annotations__", ())]
    assert missing == []


@pytest.mark.parametrize("name", sorted(set(tripatch.__all__) - {"METHODS", "OPTIONS", "SURROUNDING_RINGS"}))
def test_everything_public_is_described(name):
    public = getattr(tripatch, name)
    assert inspect.getdoc(public)
    members = [m for m in vars(public) if not m.startswith("_")] if inspect.isclass(public) else []
    texts = {m: inspect.getdoc(getattr(public, m)) or "" for m in members}
    undescribed = [m for m, text in texts.items() if not text or text.startswith("Alias for field")]
    assert undescribed == []
    if inspect.isfunction(public) and inspect.signature(public).parameters:
        assert "Args:" in inspect.getdoc(public)
