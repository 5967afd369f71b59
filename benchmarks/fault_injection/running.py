"""Run all kinds on all arms with both engines, one process for each arm, and keep the outcomes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context

from benchmarks import outcomes
from benchmarks.fault_injection.kinds import RATE, kinds
from benchmarks.fault_injection.recordings import LENGTH
from benchmarks.fault_injection.trial import ENGINES, Outcome, run
from benchmarks.outcomes import CHECKOUT, package_text, tell, text_hash

STORE = CHECKOUT / ".cache" / "fault_injection"
APART = {"__main__.py", "page.py", "running.py"}  # files that no outcome depends on
ARMS = ("scara", "ur5", "panda", "xarm7")
Store = outcomes.Store[Outcome]


def fingerprint() -> str:
    """Return a hash of all text that an outcome depends on."""
    parts = ("fault_injection", "online")
    here = [f for p in parts for f in (CHECKOUT / "benchmarks" / p).glob("*.py") if f.name not in APART]
    return text_hash([*package_text(("cli", "viewers", "campaigns", "discovery")), *here])


def rounds(ticks: int) -> int:
    """Return how often each kind is run on each arm with each engine, for a number of ticks in all."""
    return max(1, round(ticks / (len(kinds()) * len(ARMS) * len(ENGINES) * LENGTH * RATE)))


def run_all(arms: Sequence[str], count: int, jobs: int) -> list[Outcome]:
    """Run what has not been run; returns all outcomes, arm by arm."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # small matrices; processes that start inherit it
    version = fingerprint()
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        running = [pool.submit(run_arm, arm, count, version) for arm in arms]
        for done in as_completed(running):
            done.result()
    known = {arm: _store(arm, version).read() for arm in arms}
    return [o for arm in arms for o in known[arm].values() if int(o.id.rsplit("/", 1)[1]) < count]


def _store(arm: str, version: str) -> Store:
    return Store(STORE / f"{arm}-{version}.jsonl", Outcome.from_json)


def run_arm(arm: str, count: int, version: str) -> None:
    """Run what has not been run of one arm."""
    store = _store(arm, version)
    known = store.read()
    for engine in ENGINES:
        for number in range(count):
            for kind in kinds():
                if f"{arm}/{engine}/{kind.name}/{number}" in known:
                    continue
                outcome = run(arm, engine, kind, number)
                store.add(outcome)
                if why := fell_short(outcome):
                    tell(f"MISS  {outcome.id}: {'; '.join(why)}")
            tell(f"{arm} {engine}: {number + 1} of {count}")


MOST_PUSH = 0.05  # [1], of the largest torque, by which a bad sample may move a correction


def fell_short(o: Outcome) -> list[str]:
    """Return what a run falls short of."""
    said = []
    if o.raised:
        said.append(f"raised {o.raised}")
    if o.not_finite:
        said.append(f"not finite or beyond the effort limit at {o.not_finite} ticks")
    if o.pushed > MOST_PUSH:
        said.append(f"pushed by {o.pushed:.0%}")
    if o.named:
        said.append(f"named {'; '.join(o.named)}")
    if o.expected and o.expected not in o.accused:
        said.append(f"{o.expected} not named, but {', '.join(o.accused) or 'nothing'}")
    if o.wrongly:
        said.append(f"named {', '.join(o.wrongly)}, which is sound")
    if o.seen_after == float("inf"):
        said.append("fault not seen")
    return said
