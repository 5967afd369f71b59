"""Let the monitor watch measured logs, and write docs/results-monitored-logs.md.

Usage:
    python -m benchmarks.monitored_logs                      # draws for reporting; some twenty minutes
    python -m benchmarks.monitored_logs --suite tuning
    python -m benchmarks.monitored_logs --kinds weight pushed

Outcomes are kept in .cache/monitored-logs, so that a run that was interrupted goes on where it was.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from benchmarks.measured_logs import folder
from benchmarks.monitored_logs.cases import DRAWS, EFFECT, HEALTHY, PUSHED, WEIGHT, planned
from benchmarks.monitored_logs.outcome import Outcome
from benchmarks.monitored_logs.page import page
from benchmarks.monitored_logs.trial import run_case
from benchmarks.outcomes import CHECKOUT, Store, package_text, tell, text_hash
from benchmarks.publishing import publish, stated
from benchmarks.running import run_all

FOLDER = CHECKOUT / ".cache" / "monitored-logs"
PAGE = CHECKOUT / "docs" / "results-monitored-logs.md"
KINDS = (HEALTHY, WEIGHT, PUSHED, EFFECT)
WITHOUT = ("cli", "viewers", "app", "campaigns", "cluster")  # parts of the package that no outcome needs


def main() -> None:
    """Run the cases and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.monitored_logs", description="Let the monitor watch measured logs."
    )
    folder.add_option(given)
    given.add_argument("--suite", choices=list(DRAWS), default="reporting", help="which draws")
    given.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    given.add_argument("--jobs", type=int, default=2, help="processes")
    given.add_argument("--out", type=Path, help="page to write; by default the one in docs if all is run")
    options = given.parse_args()
    if not folder.are_there(options.data):
        tell("measured logs: not there, skipped")
        return
    os.environ[folder.VARIABLE] = str(options.data)  # processes that start inherit it
    cases = [c for c in planned(options.suite) if c.kind in options.kinds]
    here = [f for f in Path(__file__).parent.glob("*.py") if f.name not in ("__main__.py", "page.py")]
    store = Store(FOLDER / f"cases-{text_hash([*package_text(WITHOUT), *here])}.jsonl", Outcome.from_json)
    outcomes = run_all(cases, run_case, store, options.jobs, _word)
    whole = options.suite == "reporting" and {o.id for o in outcomes} == {c.id for c in planned("reporting")}
    text = page(outcomes, stated(given, options, ("suite", "kinds")))
    publish(text, options.out or (PAGE if whole else None))


def _word(o: Outcome) -> str:
    if o.failure:
        return f"{o.id}  {o.failure}"
    good = "right" if o.effect and o.is_right else "holds" if o.effect and o.holds else ""
    return f"{o.id}  {o.effect}  {good}  {', '.join(o.named)}"


if __name__ == "__main__":
    main()
