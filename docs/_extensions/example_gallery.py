"""The directive `example-gallery`: every numbered example with what it printed when the site was built."""

from __future__ import annotations

import ast
import subprocess
from concurrent.futures import Future
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from background import POOL, ROOT, run
from docutils import nodes
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

LOGGER = logging.getLogger(__name__)
EXAMPLES = sorted((ROOT / "examples").glob("[0-9][0-9]_*.py"))
RUNS: dict[Path, Future[subprocess.CompletedProcess[str]]] = {}


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive, and begin to run the examples if a page shows them anew."""
    app.add_directive("example-gallery", ExampleGallery)
    app.connect("env-get-outdated", _begin)
    return {"parallel_read_safe": False, "parallel_write_safe": True}


class ExampleGallery(SphinxDirective):
    """Write a section for each example."""

    def run(self) -> list[nodes.Node]:
        """Return the sections."""
        return [self._section(path) for path in EXAMPLES]

    def _section(self, path: Path) -> nodes.section:
        self.env.note_dependency(str(path))
        text = path.read_text(encoding="utf-8")
        docstring = ast.get_docstring(ast.parse(text)) or ""
        title, _, rest = docstring.partition("\n")
        section = nodes.section(ids=[path.stem.replace("_", "-")], names=[path.stem])
        section.document = self.state.document
        section += nodes.title("", title.rstrip("."))
        self.state.nested_parse(StringList(rest.partition("Usage:")[0].splitlines(), path.name), 0, section)
        section += nodes.paragraph("", "", nodes.literal("", f"examples/{path.name}"))
        code = text[text.index('"""', 3) + 3 :].strip()
        section += nodes.literal_block("", code, language="python")
        section += nodes.paragraph("", "It prints")
        section += nodes.literal_block("", _printed(path), language="text")
        return section


def _begin(app: Sphinx, env: Any, added: set[str], changed: set[str], removed: set[str]) -> list[str]:
    if "gallery" in added | changed:
        RUNS.update({path: POOL.submit(_run, path) for path in EXAMPLES})
    return []


def _run(path: Path) -> subprocess.CompletedProcess[str]:
    with TemporaryDirectory() as folder:
        return run([str(path)], folder)


def _printed(path: Path) -> str:
    done = RUNS[path].result()
    if done.returncode:
        LOGGER.warning("%s ended with an error: %s", path.name, done.stderr.strip().rpartition("\n")[2])
    return done.stdout.strip()
