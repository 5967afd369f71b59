"""Docstrings are plain text with `names`, equations and Google sections; other markup characters are text."""

from __future__ import annotations

import re
from typing import Any

from reference_keys import linked
from sphinx.application import Sphinx

BEFORE_NAPOLEON = 400  # napoleon reads the Google sections at priority 500
MARKUP = re.compile(r"(``.+?``|:\w+:`.+?`|`[^`]+`)|([*|])|(\w)_(?!\w)")
SECTION = re.compile(r"(Args|Attributes|Returns|Raises|Yields|Notes?|Examples?|Usage|References):")
KEPT = "\0"  # marks a line that is kept as it is


def setup(app: Sphinx) -> dict[str, Any]:
    """Escape docstrings before the Google sections are read."""
    app.connect("autodoc-process-docstring", _process, priority=BEFORE_NAPOLEON)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _process(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    lines[:] = [escaped(line) for line in with_literal_blocks(lines)]


def escaped(line: str) -> str:
    """Return a line whose asterisks, bars and trailing underscores are text, with links at reference keys."""
    if line.startswith(KEPT):
        return line.removeprefix(KEPT)

    def replace(found: re.Match[str]) -> str:
        code, sign, letter = found.groups()
        return code or (f"\\{sign}" if sign else f"{letter}\\_")

    return linked(MARKUP.sub(replace, line), ":ref:")


def with_literal_blocks(lines: list[str]) -> list[str]:
    """Return the lines; an indented block after an empty line, outside the sections, is literal."""
    out: list[str] = []
    in_section, in_block = False, False
    for before, line in zip(["", *lines], lines, strict=False):
        indented = line.startswith("    ")
        if line and not indented:
            in_section, in_block = bool(SECTION.fullmatch(line)), False
        elif indented and not in_section and not in_block and not before.strip():
            out += [KEPT + "::", ""]
            in_block = True
        out.append(KEPT + line if in_block and line else line)
    return out
