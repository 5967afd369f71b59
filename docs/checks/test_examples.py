"""The examples in README.md and in the pages run as they are printed.

Blocks of `python` run page by page, one after another, with common names. The `cdia` commands in blocks of `sh` run
as well: those of the README to their end unless they take long, all of them with CDIA_EVERY_EXAMPLE=1. A block that
does not run says so: ```` ```python not-run ````. Notebooks and `console` blocks run when the site is built.
"""

import os
import re
import shlex
from pathlib import Path

import pytest

from cdia_pin.cli import main

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    ROOT / "README.md",
    *(p for p in sorted((ROOT / "docs").rglob("*.md")) if not p.name.startswith("results")),
]
BLOCK = re.compile(r"^```(python|sh)\n(.*?)^```", re.MULTILINE | re.DOTALL)
SERVERS = ("app", "view")  # wait for a browser until they are ended
LONG = ("simulate", "study")  # take half a minute and more
EVERY = "CDIA_EVERY_EXAMPLE" in os.environ
INDENTED = re.compile(r"^    (cdia |from |import )", re.MULTILINE)


def blocks(page: Path, language: str) -> list[str]:
    return [text for kind, text in BLOCK.findall(page.read_text(encoding="utf-8")) if kind == language]


def commands(page: Path) -> list[list[str]]:
    """The arguments of every `cdia` command of a page, without comments."""
    lines = "".join(blocks(page, "sh")).replace("\\\n", " ").splitlines()
    words = [shlex.split(line, comments=True) for line in lines]
    return [given[1:] for given in words if given[:1] == ["cdia"]]


def runs(page: Path, given: list[str]) -> bool:
    """Whether a command runs to its end; of the others only the options are read."""
    return given[0] not in SERVERS and (EVERY or (page.name == "README.md" and given[0] not in LONG))


COMMANDS = [(page, given) for page in PAGES for given in commands(page)]
PYTHON = [pytest.param(page, id=page.stem) for page in PAGES if blocks(page, "python")]


@pytest.mark.parametrize("page", PYTHON)
def test_the_python_of_a_page_runs(page, names):
    for text in blocks(page, "python"):
        exec(compile(text, str(page), "exec"), names)


@pytest.mark.parametrize("k", range(len(COMMANDS)), ids=[f"{p.stem}: {shlex.join(g)}" for p, g in COMMANDS])
def test_a_command_of_a_page_runs(k, names, capsys):
    page, given = COMMANDS[k]
    if not runs(page, given):
        given = [*given, "--help"]
    assert main(given) == 0, capsys.readouterr().err


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_examples_are_in_blocks_that_run(page):
    found = INDENTED.search(BLOCK.sub("", page.read_text(encoding="utf-8")))
    assert found is None, f"write it as a block of python or sh: {found.group()}"
