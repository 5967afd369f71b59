"""Watch a simulated fleet and a measured arm, and write docs/results-fleet.md.

Usage:
    python -m benchmarks.fleet                                # the whole fleet: 2,400 logs, half an hour of one core
    python -m benchmarks.fleet --robots 20                    # its first 20 robots, the faulty ones among them
    python -m benchmarks.fleet --suite tuning --robots 6

Logs and store are kept in .cache/fleet, so that a run that was interrupted goes on where it was.
"""

from __future__ import annotations

import argparse
import math
import time
from pathlib import Path

from benchmarks.fleet.measured import fleet_of_one
from benchmarks.fleet.page import page
from benchmarks.fleet.plan import ARM, SUITES, planned
from benchmarks.fleet.recording import record, recordings, write_map
from benchmarks.measured_logs import folder as measured
from benchmarks.outcomes import CHECKOUT, tell
from benchmarks.publishing import publish, stated
from cdia_pin.cluster import run_each
from cdia_pin.fleet import FleetMap, FleetStore, TrendSettings, add_logs, fleet_trend
from cdia_pin.robot import load_robot

FOLDER = CHECKOUT / ".cache" / "fleet"
PAGE = CHECKOUT / "docs" / "results-fleet.md"


def main() -> None:
    """Record the fleet, add its logs, look for changes, and write the page."""
    given = argparse.ArgumentParser(prog="python -m benchmarks.fleet", description="Watch a simulated fleet.")
    measured.add_option(given)
    given.add_argument("--suite", choices=list(SUITES), default="reporting", help="which draws")
    given.add_argument("--robots", type=int, default=40, help="number of robots")
    given.add_argument("--days", type=int, default=60, help="number of days")
    given.add_argument("--jobs", type=int, default=1, help="processes")
    given.add_argument(
        "--out", type=Path, help="page to write; by default the one in docs for the reporting draws"
    )
    options = given.parse_args()
    folder = FOLDER / options.suite
    plans = planned(options.suite, options.robots, options.days)
    for done in run_each(record, recordings(plans, folder), workers=options.jobs):
        done.result  # noqa: B018  (raises where a log could not be recorded)
    fleet = FleetMap.read(write_map(plans, folder))
    store = FleetStore.at(folder / "store", make=True)
    began = time.process_time()
    added = add_logs(store, fleet, workers=options.jobs)
    spent = time.process_time() - began
    tell(f"{len(added.added)} logs added, {len(added.known)} known, {len(added.failed)} failed")
    cost = spent / len(added.added) if added.added and options.jobs == 1 else math.nan
    trends = tuple(fleet_trend(store, TrendSettings(regressors=regressors)) for regressors in (True, False))
    one = fleet_of_one(options.data, FOLDER / "measured") if measured.are_there(options.data) else None
    text = page(
        plans,
        load_robot(ARM).joints,
        (trends[0], trends[1]),
        one,
        cost,
        stated(given, options, ("suite", "robots", "days")),
    )
    publish(text, options.out or (PAGE if options.suite == "reporting" else None))


if __name__ == "__main__":
    main()
