"""Figures of the first use that are measured here, or stand in a page of results."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from runpy import run_path

from benchmarks.outcomes import CHECKOUT, environment_of
from benchmarks.reading_bags import WANTED, rates
from cdia_pin.effects import EFFECTS, parse_term
from cdia_pin.robot import catalogue

Figure = tuple[str, str, str, str, bool]  # area, what was asked, target, measured, met

DOCS = CHECKOUT / "docs"
ASKED_ARMS = ("ur3e", "ur5e", "ur10e", "ur16e", "fr3", "iiwa14", "gen3", "xarm6")
DEMO = 60.0  # [s]
READING = 250  # words that a person reads in a minute
NOTEBOOKS = 3
TUTORIALS = 4  # a UR, a ROS 2 bag, a Franka, a monitor in one's own loop
SIZES = DOCS / "_extensions" / "measured_sizes.py"
ENTRY = re.compile(r"^```\{effect\} (.+)\n(:size:)?", re.MULTILINE)  # of the catalogue of effects
RUNS = re.compile(r"^```\{(console|code-cell)\}", re.MULTILINE)
CODE = re.compile(r"^```.*?^```|^    .*?$|!\[.*?\]\(.*?\)", re.MULTILINE | re.DOTALL)


def figures(messages: int) -> Iterator[Figure]:
    """Yield what is measured.

    Args:
        messages: Of each bag that is read.
    """
    for kind, rate in rates(messages):
        claim = f"{kind}: JointState messages a second"
        yield "Formats", claim, f"≥ {WANTED:,}", f"{rate:,.0f}", rate >= WANTED
    yield "Formats", "five formats, from `pip install` to a report", "5 of 5", *_newcomers()
    yield "Command line", "`cdia demo`, from the command to the report", f"≤ {DEMO:g} s", *_demo()
    there = [name for name in ASKED_ARMS if name in catalogue()]
    yield _count("Arms", "e-series, FR3, iiwa, Gen3, xArm6 by name", len(ASKED_ARMS), len(there))
    yield from _of_docs()
    words = _words(CHECKOUT / "README.md", "\n## Install")
    claim = "words before *Install*, without output and code"
    yield "README", claim, f"≤ {READING}", str(words), words <= READING
    yield from _of_pages()


def _count(area: str, claim: str, wanted: int, found: int) -> Figure:
    return area, claim, str(wanted), str(found), found >= wanted


def _of_docs() -> Iterator[Figure]:
    """Yield how many pages of each kind there are."""
    notebooks, tutorials = (
        len([p for p in (DOCS / folder).glob("*.md") if RUNS.search(p.read_text(encoding="utf-8"))])
        for folder in ("notebooks", "tutorials")
    )
    yield _count("Docs", "notebooks, run by `make docs`", NOTEBOOKS, notebooks)
    yield _count("Docs", "tutorials, run by `make docs`", TUTORIALS, tutorials)
    pages = [p.read_text(encoding="utf-8") for p in (DOCS / "effects").glob("*.md")]
    entries = {parse_term(term).effect.name: told for text in pages for term, told in ENTRY.findall(text)}
    yield _count("Docs", "effects with physics, picture and rivals", len(EFFECTS), len(entries))
    measured = [name for name in entries if run_path(str(SIZES))["sentence"](name)]
    sized = {*measured, *(name for name, told in entries.items() if told)}
    claim = "effects with a typical size: measured on arms, or in words what sets it"
    shown = f"{len(sized)}, of which {len(measured)} measured"
    yield "Docs", claim, str(len(EFFECTS)), shown, len(sized) >= len(EFFECTS)


def _newcomers() -> tuple[str, bool]:
    rows = re.findall(r"^\| \[\w+\]\(formats/.*\| (\S+) \|$", _page("results-newcomer.md"), re.MULTILINE)
    met = rows.count("yes")
    return f"{met} of {len(rows)} ([page](results-newcomer.md))", met == len(rows) == 5


def _demo() -> tuple[str, bool]:
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "cdia_pin", "demo"]
        done = subprocess.run(
            command, cwd=folder, env=environment_of(CHECKOUT), stdout=subprocess.DEVNULL, check=False
        )
    took = time.monotonic() - begin
    return f"{took:.0f} s", done.returncode == 0 and took <= DEMO


def _words(path: Path, end: str) -> int:
    """Return how many words a page has before a heading, without its blocks and pictures."""
    text = path.read_text(encoding="utf-8").partition(end)[0]
    return len([word for word in CODE.sub("", text).split() if re.search(r"\w", word)])


def _of_pages() -> Iterator[Figure]:
    """Yield the rows of the page that measures the pages in a browser."""
    for line in _page("results-pages.md").splitlines():
        cells = [cell.strip() for cell in line.strip("| ").split(" | ")]
        if len(cells) == 4 and cells[3].strip("*") in {"yes", "no"}:
            claim, target, measured, met = cells
            yield "Pages, as [measured](results-pages.md)", claim, target, measured, met == "yes"


def _page(name: str) -> str:
    path = DOCS / name
    return path.read_text(encoding="utf-8") if path.exists() else ""
