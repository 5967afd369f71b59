"""Public functions and methods that take arguments, and those whose docstring says what the arguments are."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from benchmarks.house.source import Module

COMMANDS = "cli"  # its functions are commands, whose options carry their own help

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
    rooms = (module for module in found if module.room != COMMANDS)
    return _share(
        function for module in rooms for owner, function in _public(module.tree) if owner in exported
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
        if module.name.endswith("__init__.pyi"):
            names |= _imported(module.tree)
        elif module.name.endswith("__init__.py"):
            values = {
                ast.unparse(node.targets[0]): node.value
                for node in module.tree.body
                if isinstance(node, ast.Assign)
            }
            values |= {
                ast.unparse(node.target): node.value
                for node in module.tree.body
                if isinstance(node, ast.AnnAssign) and node.value is not None
            }
            if "__all__" in values:
                names |= _strings(values["__all__"], values)
    return names


def _imported(stub: ast.Module) -> set[str]:
    """Return the names that a stub passes on, `from room import name as name`."""
    imports = (node for node in stub.body if isinstance(node, ast.ImportFrom))
    return {alias.name for node in imports for alias in node.names if alias.asname == alias.name}


def _strings(value: ast.expr, values: Mapping[str, ast.expr]) -> set[str]:
    """Return the strings of an expression and the keys of the tables of the module that it names."""
    found: set[str] = set()
    for node in ast.walk(value):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            found.add(node.value)
        elif isinstance(node, ast.Name) and isinstance(table := values.get(node.id), ast.Dict):
            found |= {
                key.value
                for key in table.keys
                if isinstance(key, ast.Constant) and isinstance(key.value, str)
            }
    return found
