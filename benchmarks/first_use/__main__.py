"""Measure what was asked of the first use, run the tests that hold it, and write docs/results-first-use.md.

Usage:
    python -m benchmarks.first_use                   # ten minutes; needs chromium
    python -m benchmarks.first_use --messages 50000  # shorter bags

The pages of `python -m benchmarks.newcomer` and `python -m benchmarks.pages` are read, not made again.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from benchmarks.first_use.asked import PROMISES, Promise
from benchmarks.first_use.figures import figures
from benchmarks.first_use.tests_run import TestRun, of_promise, run
from benchmarks.markdown import Row, table
from benchmarks.outcomes import CHECKOUT, tell
from benchmarks.pages import word
from benchmarks.publishing import made_by, publish, stated
from cdia_pin.viewers.words import percent

PAGE = CHECKOUT / "docs" / "results-first-use.md"


def main() -> int:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.first_use", description=__doc__.split("\n")[0]
    )
    parser.add_argument("--messages", type=int, default=300_000, help="messages in a bag")
    given = parser.parse_args()
    rows: list[tuple[str, Row]] = []
    for area, claim, target, measured, met in figures(given.messages):
        tell(claim)
        rows.append((area, (claim, target, measured, word(met))))
    with tempfile.TemporaryDirectory() as folder:
        runs = list(run((test for p in PROMISES for test in p.tests), Path(folder)))
    rows += [(p.area, row(p, of_promise(runs, p.tests))) for p in PROMISES]
    areas = dict.fromkeys([*(p.area for p in PROMISES), *(area for area, _ in rows)])
    met = [cells[-1] == "yes" for _, cells in rows]
    text = [
        "# Results of the first use",
        made_by(stated(parser, given, ["messages"]), ("pin", "mujoco", "rosbags")),
        "What was asked of the way from a stranger's log to a verdict. Each row is measured, or is held by tests that "
        f"ran with this page. {sum(met)} of {len(met)} are met.",
    ]
    for area in areas:
        cells = [cells for where, cells in rows if where == area]
        text += [f"## {area}", table(("asked", "target", "shown", "met"), cells)]
    publish("\n\n".join(text) + "\n", PAGE)
    return 0 if all(met) else 1


def row(promise: Promise, runs: Sequence[TestRun]) -> Row:
    """Return what became of a promise as a row of the table."""
    passed = sum(r.state == "passed" for r in runs)
    whole = bool(runs) and passed == len(runs)
    tests = ", ".join(f"`{test}`" for test in promise.tests)
    said = f"{passed} of {len(runs)} tests pass: {tests}"
    if not promise.figure:
        return promise.text, "–", said, word(whole)
    found = [r.figures[promise.figure] for r in runs if promise.figure in r.figures]
    figure = max(found, default=float("nan"))
    target = f"≤ {percent(promise.target)}"
    return promise.text, target, f"{percent(figure)}; {said}", word(whole and figure <= promise.target)


if __name__ == "__main__":
    sys.exit(main())
