"""Measure how much each number that decides matters, and write docs/results-sensitivity.md.

Usage:
    python -m benchmarks.sensitivity                           # everything; an interrupted run goes on
    python -m benchmarks.sensitivity --only criterion          # some of the settings, to the terminal
"""

from __future__ import annotations

import argparse

from benchmarks.hidden_effects.running import store_of
from benchmarks.outcomes import CHECKOUT
from benchmarks.publishing import publish, stated
from benchmarks.running import run_all
from benchmarks.sensitivity.page import page
from benchmarks.sensitivity.trial import Trial, TrialOutcome, cases, run_trial
from benchmarks.sensitivity.variation import variations

PAGE = CHECKOUT / "docs" / "results-sensitivity.md"
FOLDER = CHECKOUT / ".cache" / "sensitivity"


def main() -> None:
    """Run the trials and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.sensitivity", description="Halve and double each number that decides."
    )
    given.add_argument("--only", default="", help="settings whose name has this part")
    given.add_argument("--jobs", type=int, default=2, help="processes")
    options = given.parse_args()
    some = [v for v in variations() if not v.path or options.only in v.path]
    trials = [Trial(case, variation) for variation in some for case in cases()]
    store = store_of("trials", TrialOutcome.from_json, FOLDER)
    outcomes = run_all(trials, run_trial, store, options.jobs, lambda o: o.id)
    outcomes.sort(key=lambda o: [t.id for t in trials].index(o.id))
    publish(page(outcomes, stated(given, options, ("only",))), None if options.only else PAGE)


if __name__ == "__main__":
    main()
