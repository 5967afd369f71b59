"""The command that a page states: what a reader has to type, and nothing of the machine that it was run on."""

import argparse
import re
import shlex
from pathlib import Path

import pytest

from benchmarks.publishing import stated

PAGES = sorted(Path(__file__).parents[2].glob("docs/results*.md"))


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ("", "python -m some"),
        ("--jobs 4 --kept --out /home/somebody/page.md", "python -m some"),
        ("--arms panda ur5 --sample --jobs 4", "python -m some --arms panda ur5 --sample"),
        ("--arms ur5 panda --limit 3", "python -m some --limit 3"),
        ("--arms 'my arm'", "python -m some --arms 'my arm'"),
    ],
)
def test_only_what_decides_the_page_is_stated(typed: str, said: str) -> None:
    parser = argparse.ArgumentParser(prog="python -m some")
    parser.add_argument("--arms", nargs="+", default=["ur5", "panda"])
    parser.add_argument("--limit", type=int)
    parser.add_argument("--jobs", type=int, default=2)
    for flag in ("--sample", "--kept"):
        parser.add_argument(flag, action="store_true")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args(shlex.split(typed))
    assert stated(parser, options, ("arms", "limit", "sample")) == said


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_names_no_folder_of_a_machine(page: Path) -> None:
    assert not re.findall(r"(?<![\w.])/(?:home|root|tmp|Users|work)/\S*", page.read_text(encoding="utf-8"))
