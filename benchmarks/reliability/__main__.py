"""Try by kinds what must not break, and write docs/results-reliability.md: how often it held, and what was lost.

Usage:
    python -m benchmarks.reliability              # below three minutes; new damage in each run
    python -m benchmarks.reliability --times 1    # damage each file as often as `make test` does

The tries are those of the tests. Each case of a test is one try, and each input that a property test draws is one.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from benchmarks.claims import met
from benchmarks.markdown import Row, table
from benchmarks.outcomes import CHECKOUT
from benchmarks.publishing import made_by, publish, stated
from benchmarks.reliability.counting import Tries
from benchmarks.reliability.probes import KINDS, Kind

PAGE = CHECKOUT / "docs" / "results-reliability.md"
HEADS = ("tried", "what must happen", "tries", "held", "lost")
TIMES = 10  # 600 damaged files of each kind; the run stays below three minutes


def run(kinds: Sequence[Kind]) -> Tries:
    """Run the tests of some kinds of probes in this process, and return what they tried."""
    tries = Tries()
    tests = sorted({str(CHECKOUT / test) for kind in kinds for test in kind.tests})
    pytest.main([*tests, "--rootdir", str(CHECKOUT), "-q", "-p", "no:xdist"], plugins=[tries])
    return tries


def rows(kinds: Sequence[Kind], tries: Tries) -> list[Row]:
    """Return a row for each kind, and their sum."""
    out: list[Row] = []
    all_tried = all_held = all_lost = 0
    for kind in kinds:
        cases = [case for case in tries.tried if kind.has(case)]
        tried = sum(tries.tried[case] for case in cases)
        broke = sum(case in tries.failed for case in cases)
        lost = broke if kind.at_stake else 0
        words = f"{lost} ({kind.at_stake})" if kind.at_stake else "–"
        out.append((kind.title, kind.promise, f"{tried:,}", f"{tried - broke:,}", words))
        all_tried, all_held, all_lost = all_tried + tried, all_held + tried - broke, all_lost + lost
    return [*out, ("**all**", "", f"{all_tried:,}", f"{all_held:,}", all_lost)]


def page(kinds: Sequence[Kind], tries: Tries, command: str) -> str:
    """Return the page."""
    held = not tries.failed and all(any(map(kind.has, tries.tried)) for kind in kinds)
    return (
        "\n\n".join(
            (
                "# What was tried, what held, and what was lost",
                made_by(command, ("pin", "numpy", "pyarrow", "hypothesis")),
                str(__doc__).split("\n\n")[2].strip().replace("\n", " ")
                + " [reliability.md](reliability.md) names what is promised, the test of each promise, and known gaps.",
                f"Everything held: {met(held)}.",
                "## By kind",
                table(HEADS, rows(kinds, tries)),
                "## The tests",
                table(
                    ("tried", "by"), [(k.title, ", ".join(f"`{test}`" for test in k.tests)) for k in kinds]
                ),
            )
        )
        + "\n"
    )


def main() -> int:
    """Try everything and write the page; return 1 if something did not hold."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.reliability", description="Try by kinds what must not break."
    )
    given.add_argument(
        "--times", type=int, default=TIMES, help="how many times as many files are damaged as by `make test`"
    )
    given.add_argument("--out", type=Path, default=PAGE, help="page to write")
    options = given.parse_args()
    if options.times != 1:
        os.environ["CDIA_FUZZ"] = str(options.times)  # which the tests read
    tries = run(KINDS)
    publish(page(KINDS, tries, stated(given, options, ("times",))), options.out)
    return 1 if tries.failed else 0


if __name__ == "__main__":
    sys.exit(main())
