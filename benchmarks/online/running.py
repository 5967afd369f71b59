"""Run the cases of several arms, and keep their outcomes."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.online.outcome import Outcome
from benchmarks.online.plan import Store, fingerprint, planned
from benchmarks.online.scenarios import Case
from benchmarks.outcomes import tell
from benchmarks.running import run_all


def run_arms(
    arms: Sequence[str], suites: Sequence[str], jobs: int, quick: bool, fresh: bool
) -> list[Outcome]:
    """Run the cases that have not been run; returns all outcomes, arm by arm."""
    version = fingerprint()
    out: list[Outcome] = []
    for arm in arms:  # one after the other: a process keeps the monitors that it has taught for an arm
        store = Store(arm, version)
        if fresh:
            store.forget()
        cases = planned(arm, suites, quick)
        outcomes = run_all(cases, run_one, store, jobs, _word)
        if len(outcomes) < len(cases):
            raise SystemExit(
                f"{arm}: {len(cases) - len(outcomes)} cases failed; the same command runs them again"
            )
        out += outcomes
    if fingerprint() != version:
        tell("the package's text changed while cases ran: figures may be of both versions")
    return out


def run_one(case: Case) -> Outcome:
    """Run a case."""
    from benchmarks.online.trial import run_case  # what simulates is loaded in the processes that do

    return run_case(case)


def _word(o: Outcome) -> str:
    from benchmarks.online.claims import fell_short

    why = fell_short(o)
    return f"{'MISS' if why else 'ok  '}  {o.id}  {'; '.join(why)}"
