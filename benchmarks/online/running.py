"""Run the cases of several arms, one process each, and keep their outcomes."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context

from benchmarks.online.outcome import Outcome
from benchmarks.online.plan import Store, fingerprint, planned
from benchmarks.outcomes import tell


def run_all(arms: Sequence[str], suites: Sequence[str], jobs: int, quick: bool, fresh: bool) -> list[Outcome]:
    """Run the cases that have not been run; returns all outcomes, arm by arm."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # small matrices; processes that start inherit it
    version = fingerprint()
    if fresh:
        for arm in arms:
            Store(arm, version).forget()
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        running = [pool.submit(run_arm, arm, suites, quick, version) for arm in arms]
        for done in as_completed(running):
            done.result()
    if fingerprint() != version:
        tell("the package's text changed while cases ran: figures may be of both versions")
    out = []
    for arm in arms:
        known = Store(arm, version).read()
        out += [known[case.id] for case in planned(arm, suites, quick)]
    return out


def run_arm(arm: str, suites: Sequence[str], quick: bool, version: str) -> None:
    """Run the cases of one arm that have not been run."""
    from benchmarks.online.claims import fell_short  # what simulates is loaded in the processes that do
    from benchmarks.online.trial import run_case

    store, cases = Store(arm, version), planned(arm, suites, quick)
    known = store.read()
    for k, case in enumerate(cases, 1):
        if case.id in known:
            continue
        begin = time.perf_counter()
        outcome = run_case(case)
        store.add(outcome)
        why = fell_short(outcome)
        seconds = time.perf_counter() - begin
        tell(
            f"{arm:6} {k:4}/{len(cases)} {seconds:5.1f} s  {'ok' if not why else 'MISS'}  {case.id}  {'; '.join(why)}"
        )
