"""Measure the discovery, and write docs/results-discovery.md.

Usage:
    python -m benchmarks.hidden_effects                        # everything
    python -m benchmarks.hidden_effects --arms panda --kinds single pair
    python -m benchmarks.hidden_effects --sample               # one case in eight, to the terminal

Outcomes are kept in .cache/discovery, so that a run that was interrupted goes on where it was.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks.hidden_effects.cases import ARMS, SAMPLE, SUITES, planned
from benchmarks.hidden_effects.claims import fell_short
from benchmarks.hidden_effects.outcome import Outcome
from benchmarks.hidden_effects.page import page
from benchmarks.hidden_effects.running import run_all, store_of
from benchmarks.hidden_effects.trial import run_case
from benchmarks.outcomes import CHECKOUT, tell

PAGE = CHECKOUT / "docs" / "results-discovery.md"


def main() -> None:
    """Run the cases and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.hidden_effects", description="Measure the discovery."
    )
    given.add_argument("--arms", nargs="+", choices=ARMS, default=list(ARMS))
    given.add_argument("--kinds", nargs="+", choices=SUITES, default=list(SUITES))
    given.add_argument("--jobs", type=int, default=2, help="processes")
    given.add_argument("--limit", type=int, help="most cases to run")
    given.add_argument("--sample", action="store_true", help=f"one case in {SAMPLE}, printed")
    given.add_argument("--kept", action="store_true", help="run nothing: print what is kept")
    given.add_argument("--out", type=Path, help="page to write; docs/results-discovery.md if all is run")
    options = given.parse_args()

    cases = planned(options.arms, options.kinds, SAMPLE if options.sample else 1)[: options.limit]
    store = store_of("cases", Outcome.from_json)
    if options.kept:
        known = store.read()
        outcomes = [known[c.id] for c in cases if c.id in known]
    else:
        outcomes = run_all(cases, run_case, store, options.jobs, _word)
    whole = len(outcomes) == len(planned())
    text = page(outcomes, "python -m benchmarks.hidden_effects " + " ".join(sys.argv[1:]), whole)
    out = options.out or (PAGE if whole else None)
    if out is None:
        print(text)
    else:
        out.write_text(text, encoding="utf-8")
        tell(f"wrote {out}")


def _word(o: Outcome) -> str:
    why = fell_short(o)
    found = f": {', '.join(o.found) or 'nothing'}, {o.verdict}" if why else ""
    return f"{o.seconds:4.1f} s  {'MISS' if why else 'ok  '}  {o.id}  {'; '.join(why)}{found}"


if __name__ == "__main__":
    main()
