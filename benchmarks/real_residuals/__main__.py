"""Measure known effects on real residuals, and write docs/results-real-residuals.md.

Usage:
    python -m benchmarks.real_residuals                                 # everything, draws for reporting
    python -m benchmarks.real_residuals --suite tuning --flows compare --sizes 25
    python -m benchmarks.real_residuals --sample                        # one draw in sixteen, to the terminal

Outcomes are kept in .cache/real-residuals, so that a run that was interrupted goes on where it was.
"""

from __future__ import annotations

import argparse
import os

from benchmarks.measured_logs import folder
from benchmarks.outcomes import CHECKOUT, tell
from benchmarks.publishing import publish, stated
from benchmarks.real_residuals.bases import Base, BaseCase, needed, planned_bases, run_base
from benchmarks.real_residuals.cases import FLOWS, GONE, REPORTING, SIZES, planned
from benchmarks.real_residuals.options import add_options
from benchmarks.real_residuals.outcome import Outcome
from benchmarks.real_residuals.page import page
from benchmarks.real_residuals.repeats import Repeat, planned_repeats, run_repeat
from benchmarks.real_residuals.running import store_of
from benchmarks.real_residuals.trial import run_case
from benchmarks.running import run_all

UNTOUCHED = "untouched"  # not a flow of cases: what is found in the logs themselves, and whether it repeats
PAGE = CHECKOUT / "docs" / "results-real-residuals.md"


def main() -> None:
    """Run the cases and write the page."""
    given = _parser()
    options = given.parse_args()
    if not folder.are_there(options.data):
        tell("measured logs: not there, skipped")
        return
    os.environ[folder.VARIABLE] = str(options.data)  # processes that start inherit it
    every = options.sample or 1
    flows = [f for f in options.flows if f != UNTOUCHED]
    cases = planned(options.suite, options.arms, options.sizes, flows, every)[: options.limit]
    repeats = [r for r in planned_repeats() if r.one.arm in options.arms]
    own = [b for b in planned_bases() if b.recording.arm in options.arms]
    if UNTOUCHED not in options.flows or options.sample:
        repeats, own = [], []
    logs: list[BaseCase] = list(dict.fromkeys([*own, *needed(cases)]))
    jobs = 0 if options.kept else options.jobs
    bases = run_all(logs, run_base, store_of("bases", Base.from_json), jobs, _base)
    outcomes = run_all(cases, run_case, store_of("cases", Outcome.from_json), jobs, _word)
    pairs = run_all(repeats, run_repeat, store_of("repeats", Repeat.from_json), jobs, lambda r: r.id)
    whole = (
        options.suite == REPORTING
        and {o.id for o in outcomes} == {c.id for c in planned(REPORTING)}
        and {r.id for r in pairs} == {r.id for r in planned_repeats()}
        and {b.id for b in planned_bases()} <= {b.id for b in bases}
    )
    command = stated(given, options, ("suite", "arms", "sizes", "flows", "limit", "sample"))
    text = page(outcomes, bases, pairs, command, options.suite, whole)
    publish(text, options.out or (PAGE if whole else None))


def _parser() -> argparse.ArgumentParser:
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.real_residuals", description="Measure known effects on real residuals."
    )
    add_options(given, SIZES, PAGE.name)
    flows = [*FLOWS, UNTOUCHED]
    given.add_argument("--flows", nargs="+", choices=[*flows, GONE], default=flows)
    given.add_argument("--limit", type=int, help="most cases to run")
    return given


def _word(o: Outcome) -> str:
    if o.impossible:
        return f"        –       {o.id}: {o.impossible}"
    said = (
        ""
        if o.exact
        else f": {o.failure or ', '.join(sorted(o.labels)) or 'nothing'} (is: {o.truth or 'nothing'})"
    )
    return f"{o.seconds:5.1f} s  {o.answer:7}  {o.id}{said}"


def _base(b: Base) -> str:
    return f"{b.seconds:5.1f} s  {b.failure or f'{len(b.named)} named, {b.verdict}'}  {b.id}"


if __name__ == "__main__":
    main()
