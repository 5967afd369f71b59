"""Put two known effects into measured logs, ask `compare` for both, and write docs/results-two-changes.md.

Usage:
    python -m benchmarks.two_changes                          # all draws for reporting
    python -m benchmarks.two_changes --suite tuning --arms ur10e --sample     # one case in sixteen, to the terminal

Outcomes are kept in .cache/two-changes, so that a run that was interrupted goes on where it was.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from benchmarks.measured_logs import folder
from benchmarks.outcomes import CHECKOUT, Store, tell, text_hash
from benchmarks.publishing import publish, stated
from benchmarks.real_residuals.cases import REPORTING
from benchmarks.real_residuals.options import add_options
from benchmarks.real_residuals.recordings import ARMS
from benchmarks.real_residuals.running import texts
from benchmarks.running import run_all
from benchmarks.two_changes.cases import SIZES, planned
from benchmarks.two_changes.page import page, said
from benchmarks.two_changes.trial import Outcome, run_case

PAGE = CHECKOUT / "docs" / "results-two-changes.md"
STORE = CHECKOUT / ".cache" / "two-changes"


def main() -> None:
    """Run the cases and write the page."""
    given = _parser()
    options = given.parse_args()
    if not folder.are_there(options.data):
        tell("measured logs: not there, skipped")
        return
    os.environ[folder.VARIABLE] = str(options.data)  # processes that start inherit it
    cases = planned(options.suite, options.arms, options.sizes, options.sample or 1)
    outcomes = run_all(cases, run_case, _store(), 0 if options.kept else options.jobs, _word)
    whole = {o.id for o in outcomes} == {c.id for c in planned(REPORTING, ARMS)}
    command = stated(given, options, ("suite", "arms", "sizes", "sample"))
    publish(page(outcomes, command, options.suite, whole), options.out or (PAGE if whole else None))


def _store() -> Store[Outcome]:
    """Return where outcomes of the present text are kept."""
    own = [Path(__file__).parent / name for name in ("cases.py", "trial.py")]
    return Store(STORE / f"{text_hash([*texts(), *own])}.jsonl", Outcome.from_json)


def _parser() -> argparse.ArgumentParser:
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.two_changes", description="Put two known effects into measured logs."
    )
    add_options(given, SIZES, PAGE.name)
    return given


def _word(o: Outcome) -> str:
    if o.impossible:
        return f"      –  {o.id}: {o.impossible}"
    if o.exact:
        return f"{o.seconds:5.1f} s  exact  {o.id}"
    return f"{o.seconds:5.1f} s  other  {o.id}: {said(o)} (is: {', '.join(o.truth)})"


if __name__ == "__main__":
    main()
