"""The modules of the package in a checkout, read and parsed."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

PACKAGE = "cdia_pin"


@dataclass(frozen=True)
class Module:
    """One file of the package.

    Attributes:
        name: Its path below the package, such as `effects/effect.py`.
        text: Its source.
    """

    name: str
    text: str

    @cached_property
    def tree(self) -> ast.Module:
        """The syntax tree."""
        return ast.parse(self.text)

    @cached_property
    def lines(self) -> list[str]:
        """The lines, without their ends."""
        return self.text.splitlines()

    @property
    def room(self) -> str:
        """The folder below the package, or the module itself where there is none."""
        return self.name.partition("/")[0].removesuffix(".py")

    def calls(self) -> Iterator[ast.Call]:
        """Yield every call."""
        yield from (node for node in ast.walk(self.tree) if isinstance(node, ast.Call))

    def classes(self) -> Iterator[ast.ClassDef]:
        """Yield every class, nested ones included."""
        yield from (node for node in ast.walk(self.tree) if isinstance(node, ast.ClassDef))


def modules(checkout: Path) -> list[Module]:
    """Return the modules of the package in a checkout, in the order of their names.

    Raises:
        FileNotFoundError: If the checkout has no package.
    """
    package = checkout / PACKAGE
    if not package.is_dir():
        raise FileNotFoundError(f"{checkout} holds no folder {PACKAGE}: give the root of a checkout")
    paths = sorted(p for p in package.rglob("*.py") if "_data" not in p.parts)
    return [Module(p.relative_to(package).as_posix(), p.read_text(encoding="utf-8")) for p in paths]
