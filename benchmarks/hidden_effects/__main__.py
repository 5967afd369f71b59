"""Measure the discovery, and write docs/results-discovery.md.

Usage:
    python -m benchmarks.hidden_effects                        # everything
    python -m benchmarks.hidden_effects --arms panda --kinds single pair
    python -m benchmarks.hidden_effects --sample               # one case in eight, to the terminal

Outcomes are kept in .cache/discovery, so that a run that was interrupted goes on where it was.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from benchmarks.hidden_effects.cases import EVERY_ARM, SAMPLE, SUITES, planned
from benchmarks.hidden_effects.claims import fell_short
from benchmarks.hidden_effects.contest import Score, entries, run_entry
from benchmarks.hidden_effects.outcome import Outcome
from benchmarks.hidden_effects.page import page
from benchmarks.hidden_effects.precision import Estimate, repeats, run_repeat
from benchmarks.hidden_effects.running import store_of
from benchmarks.hidden_effects.trial import run_case
from benchmarks.outcomes import CHECKOUT
from benchmarks.publishing import publish, stated
from benchmarks.running import run_all

REPEATED, CONTEST = "repeated", "contest"  # kinds that are not suites of cases
KINDS = [*SUITES, REPEATED, CONTEST]
PAGE = CHECKOUT / "docs" / "results-discovery.md"


def main() -> None:
    """Run the cases and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.hidden_effects", description="Measure the discovery."
    )
    given.add_argument("--arms", nargs="+", choices=EVERY_ARM, default=list(EVERY_ARM))
    given.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    given.add_argument("--jobs", type=int, default=2, help="processes")
    given.add_argument("--limit", type=int, help="most cases to run")
    given.add_argument("--sample", action="store_true", help=f"one case in {SAMPLE}, printed")
    given.add_argument("--kept", action="store_true", help="run nothing: print what is kept")
    given.add_argument("--out", type=Path, help="page to write; docs/results-discovery.md if all is run")
    options = given.parse_args()

    every = SAMPLE if options.sample else 1
    cases = planned(options.arms, [k for k in options.kinds if k in SUITES], every)
    draws = [r for r in repeats() if r.arm in options.arms][::every] if REPEATED in options.kinds else []
    contest = [e for e in entries() if e.case.arm in options.arms] if CONTEST in options.kinds else []
    jobs = 0 if options.kept else options.jobs
    few = slice(options.limit)
    outcomes = run_all(cases[few], run_case, store_of("cases", Outcome.from_json), jobs, _word)
    estimates = run_all(draws[few], run_repeat, store_of("repeats", Estimate.from_json), jobs, lambda e: e.id)
    scores = run_all(contest[few], run_entry, store_of("contest", Score.from_json), jobs, lambda s: s.id)
    whole = [len(outcomes), len(estimates), len(scores)] == [len(planned()), len(repeats()), len(entries())]
    command = stated(given, options, ("arms", "kinds", "limit", "sample"))
    text = page(outcomes, estimates, scores, command, whole)
    publish(text, options.out or (PAGE if whole else None))


def _word(o: Outcome) -> str:
    why = fell_short(o)
    found = f": {', '.join(o.found) or 'nothing'}, {o.verdict}" if why else ""
    return f"{o.seconds:4.1f} s  {'MISS' if why else 'ok  '}  {o.id}  {'; '.join(why)}{found}"


if __name__ == "__main__":
    main()
