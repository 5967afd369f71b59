"""Measure the monitor, and write docs/results-online.md.

Usage:
    python -m benchmarks.online                              # everything; an hour on two cores
    python -m benchmarks.online --arms panda --suites single pair
    python -m benchmarks.online --quick                      # one case in six, to the terminal

Outcomes are kept in .cache/online, so that a run that was interrupted goes on where it was.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from benchmarks.online.plan import SUITES
from benchmarks.online.running import run_arms
from benchmarks.online.scenarios import ARMS
from benchmarks.outcomes import CHECKOUT, tell
from benchmarks.publishing import publish, stated

PAGE = CHECKOUT / "docs" / "results-online.md"


def main() -> None:
    """Run the cases, measure the cost and write the page."""
    given = argparse.ArgumentParser(prog="python -m benchmarks.online", description="Measure the monitor.")
    given.add_argument("--arms", nargs="+", choices=ARMS, default=list(ARMS))
    given.add_argument("--suites", nargs="+", choices=[*SUITES, "cost"], default=[*SUITES, "cost"])
    given.add_argument("--jobs", type=int, default=2, help="processes")
    given.add_argument("--quick", action="store_true", help="a sample of the cases, printed")
    given.add_argument("--fresh", action="store_true", help="forget outcomes of earlier runs")
    given.add_argument(
        "--out", type=Path, help="page to write; by default docs/results-online.md if all is run"
    )
    options = given.parse_args()

    whole = set(options.arms) == set(ARMS) and {*SUITES, "cost"} == set(options.suites) and not options.quick
    suites = tuple(s for s in options.suites if s != "cost")
    outcomes = run_arms(options.arms, suites, options.jobs, options.quick, options.fresh)

    from benchmarks.online.cost import measure
    from benchmarks.online.page import page

    cost = None
    if "cost" in options.suites:
        tell("cost: some minutes")
        cost = measure()
    text = page(outcomes, cost, stated(given, options, ("arms", "suites", "quick")), options.quick)
    publish(text, options.out or (PAGE if whole else None))


if __name__ == "__main__":
    main()
