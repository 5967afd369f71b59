"""Give monitors samples that cannot be, and write docs/results-bad-samples.md.

Usage:
    python -m benchmarks.fault_injection                       # 10 million ticks; hours
    python -m benchmarks.fault_injection --ticks 3000000       # every kind once on each arm with each engine

Outcomes are kept in .cache/fault_injection, so that a run that was interrupted goes on where it was.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from benchmarks.fault_injection.running import ARMS, rounds, run_arms
from benchmarks.outcomes import CHECKOUT
from benchmarks.publishing import publish, stated

PAGE = CHECKOUT / "docs" / "results-bad-samples.md"


def main() -> None:
    """Run all kinds and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.fault_injection", description="Give monitors samples that cannot be."
    )
    given.add_argument("--arms", nargs="+", choices=ARMS, default=list(ARMS))
    given.add_argument(
        "--ticks", type=int, default=10_000_000, help="ticks in all; at least one run of each kind"
    )
    given.add_argument("--jobs", type=int, default=2, help="processes")
    given.add_argument(
        "--out", type=Path, help="page to write; by default docs/results-bad-samples.md for all arms"
    )
    options = given.parse_args()
    outcomes = run_arms(options.arms, rounds(options.ticks), options.jobs)

    from benchmarks.fault_injection.page import page

    whole = set(options.arms) == set(ARMS)
    text = page(outcomes, stated(given, options, ("arms", "ticks")))
    publish(text, options.out or (PAGE if whole else None))


if __name__ == "__main__":
    main()
