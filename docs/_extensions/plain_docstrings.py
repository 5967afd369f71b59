"""Docstrings are plain text with `names`, equations and Google sections; other markup characters are text."""

from __future__ import annotations

import re
from typing import Any

from reference_keys import linked
from sphinx.application import Sphinx
from sphinx.domains.python import PyObject

BEFORE_NAPOLEON, AFTER_NAPOLEON = 400, 600  # napoleon reads the Google sections at priority 500
MARKUP = re.compile(r"(``.+?``|:\w+:`.+?`|`[^`]+`)|([*|])|(\w)_(?!\w)")
SECTION = re.compile(r"(Args|Attributes|Returns|Raises|Yields|Notes?|Examples?|Usage|References):")
KEPT = "\0"  # marks a line that is kept as it is
COLON = "\1"  # stands for a colon in the line of a property, which napoleon would read as the end of a type
VALUES = ("attribute", "data", "property")


def setup(app: Sphinx) -> dict[str, Any]:
    """Escape docstrings before the Google sections are read."""
    app.connect("autodoc-process-docstring", _process, priority=BEFORE_NAPOLEON)
    app.connect("autodoc-process-docstring", _restore, priority=AFTER_NAPOLEON)
    for field in PyObject.doc_field_types:
        if field.name == "variable":
            field.label = "Attributes"  # as the docstrings head them
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _process(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    lines[:] = [escaped(line) for line in with_literal_blocks(lines)]
    if what in VALUES and lines:
        lines[0] = lines[0].replace(": ", f"{COLON} ")


def _restore(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    lines[:] = [line.replace(COLON, ":") for line in lines]


def escaped(line: str) -> str:
    """Return a line whose asterisks, bars and trailing underscores are text, with links at reference keys."""
    if line.startswith(KEPT):
        return line.removeprefix(KEPT)

    def replace(found: re.Match[str]) -> str:
        code, sign, letter = found.groups()
        return code or (f"\\{sign}" if sign else f"{letter}\\_")

    return linked(MARKUP.sub(replace, line), ":ref:")


def with_literal_blocks(lines: list[str]) -> list[str]:
    """Return the lines; an indented block after an empty line, outside sections and directives, is literal."""
    out: list[str] = []
    in_section, in_block, head = False, False, ""
    for before, line in zip(["", *lines], lines, strict=False):
        indented = line.startswith("    ")
        if line and not indented:
            in_section, in_block, head = bool(SECTION.fullmatch(line)), False, line
        elif indented and not in_section and not in_block and not before.strip():
            out += [] if head.startswith(".. ") else [KEPT + "::", ""]
            in_block = True
        out.append(KEPT + line if in_block and line else line)
    return out
