"""Measure what a log and a scenario cost, and write docs/scale.md.

Usage:
    python -m benchmarks.scale                          # costs; a few minutes
    python -m benchmarks.scale --speed-up 1000          # also 1,000 runs on one worker and on two; an hour
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from benchmarks.outcomes import CHECKOUT, tell
from benchmarks.publishing import publish, stated
from benchmarks.scale.costs import engine_cost, log_cost, scenario_cost, speed_up
from benchmarks.scale.page import page

PAGE = CHECKOUT / "docs" / "scale.md"


def main() -> None:
    """Measure, and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.scale", description="Measure what many logs need."
    )
    given.add_argument(
        "--speed-up", type=int, default=0, metavar="RUNS", help="runs on one worker and on two"
    )
    given.add_argument("--out", type=Path, default=PAGE, help="page to write")
    options = given.parse_args()
    tell("a log")
    log = log_cost()
    tell("a scenario")
    run = scenario_cost()
    tell("the engine")
    engine = engine_cost()
    load, gain = os.getloadavg()[0], None  # before the runs that load the machine themselves
    if options.speed_up:
        tell(f"{options.speed_up} runs on one worker, then on two")
        gain = speed_up(options.speed_up)
    command = stated(given, options, ()) + (f" --speed-up {options.speed_up}" if options.speed_up else "")
    publish(page(log, run, engine, load, gain, command), options.out)


if __name__ == "__main__":
    main()
