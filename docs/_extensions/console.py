"""The directive `console`: commands of a tutorial, run when the site is built, with what they print.

Its argument names the recordings in the folder in which all commands of a page run, one after another. `:lines:` is
the number of lines of the output that are shown.
"""

from __future__ import annotations

import re
import shlex
from concurrent.futures import Future
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, ClassVar

from background import POOL, run
from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

LOGGER = logging.getLogger(__name__)
BLOCK = re.compile(r"^```\{console\} (\w+)\n((?::\w+:[^\n]*\n)*)(.*?)^```", re.MULTILINE | re.DOTALL)
WIDTH = "80"  # characters of a terminal
Outputs = dict[str, tuple[int, str]]  # by the commands of a block, the exit code and what was said
RUNS: dict[str, Future[Outputs]] = {}


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive, and begin to run the pages that are read anew."""
    app.add_directive("console", Console)
    app.connect("env-get-outdated", _begin)
    return {"parallel_read_safe": False, "parallel_write_safe": True}


class Console(SphinxDirective):
    """Show commands and their output."""

    required_arguments = 1
    has_content = True
    option_spec: ClassVar = {"lines": directives.positive_int}

    def run(self) -> list[nodes.Node]:
        """Return two blocks."""
        commands = "\n".join(self.content)
        code, words = RUNS[self.env.docname].result()[commands]
        if code:
            LOGGER.warning("a command ended with %d: %s", code, words, location=self.get_location())
        said = [line.rstrip() for line in words.strip("\n").splitlines()]
        most = self.options.get("lines", len(said))
        shown = "\n".join(said[:most] + ["…"] * (len(said) > most))
        command = nodes.literal_block("", commands, language="sh")
        return [command, *([nodes.literal_block("", shown, language="text")] if shown else [])]


def _begin(
    app: Sphinx, env: BuildEnvironment, added: set[str], changed: set[str], removed: set[str]
) -> list[str]:
    for page in sorted(added | changed):
        path = Path(env.doc2path(page))
        blocks = BLOCK.findall(path.read_text(encoding="utf-8")) if path.suffix == ".md" else []
        if blocks:
            RUNS[page] = POOL.submit(_session, blocks[0][0], [commands.strip() for _, _, commands in blocks])
    return []


def _session(sample: str, blocks: list[str]) -> Outputs:
    from tutorial_samples import SAMPLES

    with TemporaryDirectory() as folder:
        SAMPLES[sample](Path(folder))
        return {commands: _run(commands, folder) for commands in blocks}


def _run(commands: str, folder: str) -> tuple[int, str]:
    """Run the commands of a block, up to the first that fails."""
    words = ""
    for line in commands.replace("\\\n", " ").splitlines():
        program, *given = shlex.split(line, comments=True)
        if program != "cdia":
            return 2, f"only cdia is run here, given {program}"
        done = run(["-m", "cdia_pin", *given], folder, COLUMNS=WIDTH, NO_COLOR="1")
        words += done.stdout
        if done.returncode:
            return done.returncode, words + done.stderr
    return 0, words
