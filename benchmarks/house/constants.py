"""Numbers in capitals at the top of a module and numbers in settings, with and without a stated reason."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from benchmarks.house.source import Module

CONSTANT = re.compile(r"_?[A-Z][A-Z0-9_]*$")
UNIT = re.compile(r"\[[^\]]+\]")
SOURCE = re.compile(
    r"\[[A-Z][A-Za-z]+\d{4}[a-z]?\]|\[Thesis\]|\b(measured|sensitivity|chosen on|docs/|benchmark|because|so that)\b"
)


@dataclass(frozen=True)
class Number:
    """A constant or a setting.

    Attributes:
        name: Its name, with that of its class where it has one.
        said: What stands about it: its comment, or its line among the attributes of the class.
    """

    name: str
    said: str

    @property
    def has_comment(self) -> bool:
        """Whether anything is said of it besides a unit."""
        return bool(UNIT.sub("", self.said).strip(" ,;:"))

    @property
    def has_source(self) -> bool:
        """Whether it is said where the value comes from: a reference, a measurement, a reason."""
        return bool(SOURCE.search(self.said))


def constants(found: Sequence[Module]) -> list[Number]:
    """Return the numbers in capitals at the top of modules."""
    return [number for module in found for number in _of_module(module)]


def settings(found: Sequence[Module]) -> list[Number]:
    """Return the numbers that are defaults of frozen settings and criteria."""
    return [number for module in found for base in module.classes() for number in _of_class(module, base)]


def _of_module(module: Module) -> Iterator[Number]:
    for node in module.tree.body:
        for name, value in _assigned(node):
            if CONSTANT.match(name) and _is_number(value):
                yield Number(name, _comment(module, node))


def _of_class(module: Module, base: ast.ClassDef) -> Iterator[Number]:
    if not base.name.endswith(("Settings", "Criterion")):
        return
    attributes = _attributes(ast.get_docstring(base) or "")
    for node in base.body:
        for name, value in _assigned(node):
            if _is_number(value):
                said = f"{attributes.get(name, '')} {_comment(module, node)}".strip()
                yield Number(f"{base.name}.{name}", said)


def _assigned(node: ast.stmt) -> list[tuple[str, ast.expr]]:
    """Return the names that a statement gives values to; `A, B = 1, 2` gives two."""
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value is not None:
        return [(node.target.id, node.value)]
    if not isinstance(node, ast.Assign):
        return []
    pairs: list[tuple[str, ast.expr]] = []
    for target in node.targets:
        if isinstance(target, ast.Name):
            pairs.append((target.id, node.value))
        elif isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
            both = zip(target.elts, node.value.elts, strict=False)
            pairs += [(one.id, value) for one, value in both if isinstance(one, ast.Name)]
    return pairs


def _is_number(value: ast.expr) -> bool:
    """Return whether an expression is made of numbers alone: 3, −1e-4, 2 * 5, (0.1, 0.3), np.pi / 2."""
    if isinstance(value, ast.Tuple | ast.List):
        return bool(value.elts) and all(_is_number(element) for element in value.elts)
    if isinstance(value, ast.BinOp):
        return _is_number(value.left) and _is_number(value.right)
    if isinstance(value, ast.UnaryOp):
        return _is_number(value.operand)
    if isinstance(value, ast.Attribute):
        return ast.unparse(value) in {"np.pi", "math.pi"}
    return isinstance(value, ast.Constant) and type(value.value) in {int, float}


def _comment(module: Module, node: ast.stmt) -> str:
    """Return the comments at the end of a statement's lines and in the lines right above it."""
    own = " ".join(_after_hash(line) for line in module.lines[node.lineno - 1 : node.end_lineno])
    above: list[str] = []
    k = node.lineno - 2
    while k >= 0 and module.lines[k].lstrip().startswith("#"):
        above.insert(0, module.lines[k].lstrip(" #"))
        k -= 1
    return " ".join([*above, own]).strip()


def _after_hash(line: str) -> str:
    return line.partition("#")[2].strip()


def _attributes(docstring: str) -> dict[str, str]:
    """Return what the section `Attributes` of a class says of each."""
    _, _, section = docstring.partition("Attributes:\n")
    found: dict[str, str] = {}
    for name, said in re.findall(r"^    (\w+): (.*(?:\n {8,}.*)*)", section, re.MULTILINE):
        found[name] = " ".join(said.split())
    return found
