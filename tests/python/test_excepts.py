"""A `Refusal` is a ValueError, which outside programs rely on; in here nobody catches one without naming it."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
#: What may refuse.
REFUSE = {
    *("fill", "fill_all", "fill_holes", "patch", "blend", "network", "find_corners", "choose_holes", "find"),
    *("smooth_triangles", "smits_patch", "coons_bezier", "coons_rectangle", "sides_from_normals", "Side", "SurfaceEdge"),
    *("_fill", "_fill_all", "_patch", "mesh_between", "_follow", "apply", "fill_rims", "fills"),
}
SOURCES = [*(ROOT / "native" / "python").rglob("*.py"), *(ROOT / "addon").rglob("*.py")]


def caught(handler):
    """Names of what a handler catches."""
    kinds = handler.type.elts if isinstance(handler.type, ast.Tuple) else [handler.type]
    return {kind.attr if isinstance(kind, ast.Attribute) else getattr(kind, "id", "") for kind in kinds if kind}


def called(statements):
    """Names of what is called, or handed on to be called."""
    nodes = [node for statement in statements for node in ast.walk(statement)]
    return {
        node.attr if isinstance(node, ast.Attribute) else node.id for node in nodes if isinstance(node, ast.Attribute | ast.Name)
    }


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.name)
def test_who_catches_value_errors_names_refusals(source):
    for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Try):
            continue
        named = set()
        for handler in node.handlers:
            named |= caught(handler)
            if "ValueError" in named and "Refusal" not in named:
                assert not called(node.body) & REFUSE, f"{source.name}:{handler.lineno}"
