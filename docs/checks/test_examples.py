"""The examples in README.md and in the pages run as they are printed.

Blocks of `python` run page by page, one after another, with common names. The `cdia` commands in blocks of `sh` run
as well, to their end, unless they wait for a browser, take many minutes or need a folder of the machine: of those only
the options are read. A block that does not run says so: ```` ```python not-run ````. Notebooks and `console` blocks run
when the site is built.
"""

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
LONG = ("simulate", "study", "campaign", "tune")  # take minutes
MACHINE = "/var/"  # a folder that only some machines have
INDENTED = re.compile(r"^    (cdia |from |import )", re.MULTILINE)


def blocks(page: Path, language: str) -> list[str]:
    return [text for kind, text in BLOCK.findall(page.read_text(encoding="utf-8")) if kind == language]


def commands(page: Path) -> list[list[str]]:
    """The arguments of every `cdia` command of a page, without comments."""
    lines = "".join(blocks(page, "sh")).replace("\\\n", " ").splitlines()
    words = [shlex.split(line, comments=True) for line in lines]
    return [given[1:] for given in words if given[:1] == ["cdia"]]


def runs(given: list[str]) -> bool:
    """Whether a command runs to its end; of the others only the options are read."""
    return given[0] not in (*SERVERS, *LONG) and not any(word.startswith(MACHINE) for word in given)


COMMANDS = [
    pytest.param(page, given, id=f"{page.stem}: {shlex.join(given)}")
    for page in PAGES
    for given in commands(page)
]
RUN = [command for command in COMMANDS if runs(command.values[1])]
PYTHON = [pytest.param(page, id=page.stem) for page in PAGES if blocks(page, "python")]


@pytest.mark.parametrize("page", PYTHON)
def test_the_python_of_a_page_runs(page, names):
    for text in blocks(page, "python"):
        exec(compile(text, str(page), "exec"), names)


@pytest.mark.parametrize("page, given", RUN)
def test_a_command_of_a_page_runs(page, given, names, capsys):
    assert main(given) == 0, capsys.readouterr().err


@pytest.mark.parametrize("page, given", [command for command in COMMANDS if command not in RUN])
def test_a_command_that_is_not_run_has_the_options_of_its_page(page, given, capsys):
    assert main([*given, "--help"]) == 0, capsys.readouterr().err


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_examples_are_in_blocks_that_run(page):
    found = INDENTED.search(BLOCK.sub("", page.read_text(encoding="utf-8")))
    assert found is None, f"write it as a block of python or sh: {found.group()}"
