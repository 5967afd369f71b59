"""The directive `command-reference`: every command with its arguments and options, as `--help` prints them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import typer
from docutils import nodes
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from cdia_pin.cli.program import app as program

MARKUP = re.compile(r"\[/?(?:bold|cyan|dim|green|red|yellow)\]")  # of the terminal


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive."""
    app.add_directive("command-reference", CommandReference)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


class CommandReference(SphinxDirective):
    """Write a section for each command."""

    def run(self) -> list[nodes.Node]:
        """Return the sections."""
        commands: dict[str, Any] = typer.main.get_command(program).commands
        return [self._section(name, command) for name, command in commands.items()]

    def _section(self, name: str, command: Any) -> nodes.section:
        section = nodes.section(ids=[f"cdia-{name}"])
        section.document = self.state.document
        section += nodes.title("", f"cdia {name}")
        for paragraph in plain(command.help or "").split("\n\n"):
            section += nodes.paragraph("", " ".join(paragraph.split()))
        lines = StringList(list(options(command)), f"cdia {name}")
        self.state.nested_parse(lines, 0, section)
        if example := plain(command.epilog or "").partition("\n")[2].strip():
            section += nodes.literal_block("", re.sub(r"\n\s*", "\n", example), language="sh")
        return section


def options(command: Any) -> Iterator[str]:
    """Yield the arguments and options of a command as a definition list."""
    for parameter in command.params:
        if getattr(parameter, "hidden", False):
            continue
        dashed = [name for name in (*parameter.opts, *parameter.secondary_opts) if name.startswith("-")]
        names = ", ".join(f"``{name}``" for name in dashed)
        value = f" ``{parameter.metavar}``" if parameter.metavar else ""
        required = " Required." if parameter.required else ""
        said = " ".join(plain(parameter.help or "").split())
        yield from (f"{names}{value}".strip(), f"   {literal(said)}{required}", "")


def plain(text: str) -> str:
    """Return a text without the markup of the terminal."""
    return MARKUP.sub("", text).replace(r"\[", "[")


def literal(text: str) -> str:
    """Return a text whose characters mean themselves."""
    return re.sub(r"([*|`\\_])", r"\\\1", text)
