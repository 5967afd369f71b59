"""The public names of the package: a directive that lists them, and a check that the reference has all."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from inspect import getdoc
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

import cdia_pin

LOGGER = logging.getLogger(__name__)
COMMANDS = {"app", "cli"}  # rooms without a Python interface for users
NO_OBJECTS = {"effects", "__version__"}  # a module and a string
LEAF = "cdia_pin.errors"  # a module with a page of its own


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive, and check the reference once all pages are read."""
    app.add_directive("public-names", PublicNames)
    app.connect("env-check-consistency", _check)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


class PublicNames(SphinxDirective):
    """List the names of `cdia_pin.__all__`; document those that no room exports."""

    def run(self) -> list[nodes.Node]:
        """Return the list and the documentation."""
        homes = {full.rpartition(".")[2]: full for full in names_of_rooms()}
        listed, documented = [], []
        for name in objects():
            value = getattr(cdia_pin, name)
            home = homes.get(name, f"cdia_pin.{name}")
            summary = (getdoc(value) or "").partition("\n")[0]
            listed.append(f"* :py:obj:`{name} <{home}>`: {summary}")
            if name not in homes:
                kind = "autoclass" if isinstance(value, type) else "autofunction"
                documented += ["", f".. {kind}:: {home}", *(["   :members:"] if kind == "autoclass" else [])]
        parent = nodes.section()
        parent.document = self.state.document
        self.state.nested_parse(StringList([*listed, *documented], "public-names"), 0, parent)
        return parent.children


def objects() -> list[str]:
    """Return the public names of the package that are classes, functions or values."""
    return [name for name in cdia_pin.__all__ if name not in NO_OBJECTS]


def names_of_rooms() -> Iterator[str]:
    """Yield the full name of everything that a room exports."""
    for path in sorted(Path(cdia_pin.__file__).parent.glob("*/__init__.py")):
        if path.parent.name not in COMMANDS:
            room = import_module(f"cdia_pin.{path.parent.name}")
            yield from (f"{room.__name__}.{name}" for name in getattr(room, "__all__", ()))
    errors = import_module(LEAF)
    yield from (
        f"{LEAF}.{name}" for name, value in vars(errors).items() if getattr(value, "__module__", "") == LEAF
    )


def missing(documented: set[str]) -> list[str]:
    """Return the public names that are not among the documented ones."""
    of_rooms = set(names_of_rooms())
    last = {full.rpartition(".")[2] for full in of_rooms}
    alone = {f"cdia_pin.{name}" for name in objects() if name not in last}
    return sorted((of_rooms | alone) - documented)


def _check(app: Sphinx, env: BuildEnvironment) -> None:
    for name in missing(set(env.get_domain("py").data["objects"])):
        LOGGER.warning("%s is public, and not in the API reference", name)
