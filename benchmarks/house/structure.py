"""Counts of structure: flags of the base effect, arguments handed on together, names, types, lines."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Sequence

from benchmarks.house.source import Module

BASE_EFFECT = "Effect"
CLUMP = {"experiment", "columns", "whitened"}  # arguments that belong to one regression
TOGETHER = 2  # of the clump in one call
LONG = 300  # lines of a file


def effect_flags(found: Sequence[Module]) -> int:
    """Count the class variables of the base effect whose default is a truth value or a number."""
    return sum(
        _is_flag(node)
        for module in found
        if module.room == "effects"
        for base in module.classes()
        if base.name == BASE_EFFECT
        for node in base.body
    )


def _is_flag(node: ast.stmt) -> bool:
    value = node.value if isinstance(node, ast.AnnAssign | ast.Assign) else None
    return isinstance(value, ast.Constant) and isinstance(value.value, bool | int | float)


def clump_calls(found: Sequence[Module]) -> int:
    """Count the calls that hand on at least two of experiment, columns and whitened."""
    return sum(len(_passed(call) & CLUMP) >= TOGETHER for module in found for call in module.calls())


def _passed(call: ast.Call) -> set[str]:
    values = [*call.args, *(keyword.value for keyword in call.keywords)]
    names = [
        v.id if isinstance(v, ast.Name) else v.attr for v in values if isinstance(v, ast.Name | ast.Attribute)
    ]
    return {name.lstrip("_") for name in names}


def names_taken_twice(found: Sequence[Module]) -> list[str]:
    """Return the names of classes that stand at more than one place of the package."""
    times = Counter(base.name for module in found for base in module.classes())
    return sorted(name for name, count in times.items() if count > 1)


def open_records(found: Sequence[Module]) -> int:
    """Count the annotations `dict[str, Any]`."""
    return sum(
        ast.unparse(node) == "dict[str, Any]"
        for module in found
        for node in ast.walk(module.tree)
        if isinstance(node, ast.Subscript)
    )


def lines(found: Sequence[Module]) -> int:
    """Count the lines of all files."""
    return sum(len(module.lines) for module in found)


def long_files(found: Sequence[Module]) -> list[str]:
    """Return the files of more than 300 lines."""
    return [module.name for module in found if len(module.lines) > LONG]
