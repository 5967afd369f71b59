"""Follow the pages of docs/formats as somebody new does, and write docs/results-newcomer.md.

Usage:
    python -m benchmarks.newcomer           # ten minutes; pip fetches what is not in its cache
    python -m benchmarks.newcomer rtde csv  # only these pages, and the result is printed

For each page: an environment without anything, a folder with nothing but a recording, the wheel of this checkout, and
the commands of the page, from `pip install` to the report. Of each recording the arm carries a tool of 1.2 kg that
its URDF lacks.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks.markdown import details, table
from benchmarks.newcomer.guide import steps
from benchmarks.newcomer.newcomer import Newcomer
from benchmarks.newcomer.samples import SAMPLES
from benchmarks.outcomes import CHECKOUT, tell
from benchmarks.publishing import made_by, publish, stated

PAGES = CHECKOUT / "docs" / "formats"
PAGE = CHECKOUT / "docs" / "results-newcomer.md"
WANTED = 600.0  # [s], from the first command to the report
HIDDEN = "payload"  # what every recording has and its URDF lacks
SEED = 7
ABOUT = """\
Somebody new has a recording and its page of [Formats](formats/index.md), and types what stands there, in an empty
folder and an environment without anything. Of each recording the arm, in MuJoCo, carries a tool of 1.2 kg. All but the
Franka's, whose torque is measured behind the gears, have friction in every joint. `pip` had the packages at hand."""


def main() -> int:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.newcomer", description=__doc__.split("\n")[0])
    parser.add_argument("pages", nargs="*", metavar="PAGE", help=f"of {', '.join(SAMPLES)}")
    given = parser.parse_args()
    if unknown := set(given.pages) - set(SAMPLES):
        parser.error(f"no pages: {', '.join(sorted(unknown))}")
    rows, typed, stopped = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        wheel = built(Path(folder))
        for name in given.pages or SAMPLES:
            tell(name)
            with tempfile.TemporaryDirectory() as home:
                somebody = Newcomer(Path(home) / "work", wheel)
                somebody.folder.mkdir()
                sample = SAMPLES[name]
                sample.write(somebody.folder, sample.log(SEED))
                somebody.follow(steps(PAGES / f"{name}.md"))
                if somebody.stopped:
                    tell(f"{name}: stopped at {somebody.stopped}")
                    stopped.append(name)
                rows.append(row(name, somebody))
                typed.append(details(name, "\n".join(["```text", *map(str, somebody.typed), "```"])))
    command = stated(parser, given, ())
    heads = ("page", "installing", "commands", "their time", "report", "says", "met")
    text = [
        "# Results of a newcomer",
        made_by(command, ("pin", "numpy")),
        ABOUT,
        f"Asked for: a report within {WANTED / 60:g} minutes that names the tool.",
        table(heads, rows),
        "## What was typed",
        *typed,
    ]
    publish("\n\n".join(text) + "\n", None if given.pages else PAGE)
    return 1 if stopped else 0


def built(folder: Path) -> Path:
    """Build the wheel of this checkout and return it."""
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(folder)]
    subprocess.run([*command, str(CHECKOUT)], check=True)
    return next(folder.glob("cdia_pin-*.whl"))


def row(name: str, somebody: Newcomer) -> tuple[str, ...]:
    """Return what came of a page as a row of the table."""
    there = {path: printed for path, printed in somebody.reports.items() if path.is_file()}
    said = list(dict.fromkeys("; ".join(answers(printed)) for printed in there.values()))
    found = bool(said) and all(HIDDEN in words for words in said) and not somebody.stopped
    return (
        f"[{name}](formats/{name}.md)",
        f"{somebody.installing:.0f} s",
        str(len(somebody.typed)),
        f"{somebody.working:.0f} s",
        ", ".join(f"{path.stat().st_size / 1e6:.1f} MB" for path in there) or "none",
        " / ".join(said) or "–",
        "yes" if found and somebody.installing + somebody.working <= WANTED else "**no**",
    )


def answers(printed: str) -> Iterator[str]:
    """Yield the verdict and the effects of what `cdia discover` printed, before its table of errors."""
    for line in printed.splitlines():
        head, _, text = line.strip().partition("  ")
        if head.startswith("explained") or head in {"established", "likely"}:
            yield f"{head}: {text.strip()}"


if __name__ == "__main__":
    sys.exit(main())
