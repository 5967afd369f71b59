"""Messages speak of the arm and of what to type, not of methods, classes and Python's exceptions."""

import ast
import re
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "cdia_pin"
METHOD = re.compile(r"\b(Log|Motion|State|Term|Effect|Dynamics|RobotModel)\.[a-z_]+|\ballow_unphysical\b")
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def texts(tree: ast.Module):
    """String constants that are no docstrings."""
    docs = {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, DOCUMENTED) and node.body and isinstance(node.body[0], ast.Expr)
    }
    return [
        n
        for n in ast.walk(tree)
        if isinstance(n, ast.Constant) and isinstance(n.value, str) and id(n) not in docs
    ]


def shows_an_exception(node: ast.AST) -> bool:
    """Whether a text holds the `repr` of an exception, ``{error!r}``."""
    return (
        isinstance(node, ast.FormattedValue)
        and node.conversion == ord("r")
        and isinstance(node.value, ast.Name)
        and node.value.id == "error"
    )


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_no_message_names_a_method_or_shows_an_exception(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert [n.value for n in texts(tree) if METHOD.search(n.value)] == []
    assert not any(map(shows_an_exception, ast.walk(tree)))
