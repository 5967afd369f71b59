"""The examples in README.md and in the pages run as they are printed.

Blocks of `python` run page by page, one after another, with common names. Of blocks of `sh` every `cdia` command
runs. A block that is to be read only says so: ```` ```python not-run ````.
"""

import re
import shlex
from pathlib import Path

import pytest

from cdia_pin.cli import main

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    ROOT / "README.md",
    *(p for p in sorted((ROOT / "docs").glob("*.md")) if not p.name.startswith("results")),
]
BLOCK = re.compile(r"^```(python|sh)\n(.*?)^```", re.MULTILINE | re.DOTALL)
SERVERS = (
    "app",
    "view",
)  # wait for a browser until they are ended: the options are checked, nothing is served
INDENTED = re.compile(r"^    (cdia |from |import )", re.MULTILINE)


def blocks(page: Path, language: str) -> list[str]:
    return [text for kind, text in BLOCK.findall(page.read_text(encoding="utf-8")) if kind == language]


def commands(page: Path) -> list[list[str]]:
    """The arguments of every `cdia` command of a page, without comments."""
    lines = "".join(blocks(page, "sh")).replace("\\\n", " ").splitlines()
    words = [shlex.split(line, comments=True) for line in lines]
    return [given[1:] for given in words if given[:1] == ["cdia"]]


COMMANDS = [
    pytest.param(page, given, id=f"{page.stem}: {shlex.join(given)}")
    for page in PAGES
    for given in commands(page)
]
PYTHON = [pytest.param(page, id=page.stem) for page in PAGES if blocks(page, "python")]


@pytest.mark.parametrize("page", PYTHON)
def test_the_python_of_a_page_runs(page, place):
    for text in blocks(page, "python"):
        exec(compile(text, str(page), "exec"), place)


@pytest.mark.parametrize(("page", "given"), COMMANDS)
def test_a_command_of_a_page_runs(page, given, place, capsys):
    if given[0] in SERVERS:
        given = [*given, "--help"]
    assert main(given) == 0, capsys.readouterr().err


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_examples_are_in_blocks_that_run(page):
    found = INDENTED.search(page.read_text(encoding="utf-8"))
    assert found is None, f"write it as a block of python or sh: {found.group()}"
