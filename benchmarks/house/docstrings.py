"""Public functions and methods that take arguments, and those whose docstring says what the arguments are."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from benchmarks.house.source import Module

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Share:
    """How many of some functions have a section `Args`."""

    have: int
    of: int

    def __str__(self) -> str:
        percent = round(100 * self.have / self.of) if self.of else 0
        return f"{self.have} of {self.of} ({percent} %)"


def with_args(found: Sequence[Module]) -> Share:
    """Count over all public functions and methods with arguments."""
    return _share(function for module in found for _, function in _public(module.tree))


def with_args_in_reference(found: Sequence[Module]) -> Share:
    """Count over the functions that rooms export and the methods of the classes that they export."""
    exported = _exported(found)
    return _share(
        function for module in found for owner, function in _public(module.tree) if owner in exported
    )


def _share(functions: Iterator[Function]) -> Share:
    asked = [function for function in functions if _takes_arguments(function)]
    have = sum("Args:" in (ast.get_docstring(function) or "") for function in asked)
    return Share(have, len(asked))


def _public(tree: ast.Module) -> Iterator[tuple[str, Function]]:
    """Yield the public functions and methods, each with the name that is imported to reach it."""
    for node in tree.body:
        if isinstance(node, Function) and _is_public(node.name):
            yield node.name, node
        elif isinstance(node, ast.ClassDef) and _is_public(node.name):
            yield from ((node.name, m) for m in node.body if isinstance(m, Function) and _is_public(m.name))


def _is_public(name: str) -> bool:
    return not name.startswith("_")


def _takes_arguments(function: Function) -> bool:
    given = function.args
    names = [a.arg for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    names += [a.arg for a in (given.vararg, given.kwarg) if a is not None]
    return any(name not in {"self", "cls"} for name in names)


def _exported(found: Sequence[Module]) -> set[str]:
    """Return the names in `__all__` of the package and of its rooms."""
    names: set[str] = set()
    for module in found:
        if not module.name.endswith("__init__.py"):
            continue
        for node in module.tree.body:
            if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
                names |= {str(name) for name in ast.literal_eval(node.value)}
    return names
