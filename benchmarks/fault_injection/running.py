"""Run all kinds on all arms with both engines, and keep the outcomes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks import outcomes
from benchmarks.fault_injection.kinds import RATE, kinds
from benchmarks.fault_injection.recordings import LENGTH
from benchmarks.fault_injection.trial import ENGINES, Outcome, run
from benchmarks.outcomes import CHECKOUT, package_text, text_hash
from benchmarks.running import run_all

STORE = CHECKOUT / ".cache" / "fault_injection"
APART = {"__main__.py", "page.py", "running.py"}  # files that no outcome depends on
ARMS = ("scara", "ur5", "panda", "xarm7")
Store = outcomes.Store[Outcome]


def fingerprint() -> str:
    """Return a hash of all text that an outcome depends on."""
    parts = ("fault_injection", "online")
    here = [f for p in parts for f in (CHECKOUT / "benchmarks" / p).glob("*.py") if f.name not in APART]
    return text_hash([*package_text(("cli", "viewers", "campaigns", "cluster", "discovery")), *here])


def rounds(ticks: int) -> int:
    """Return how often each kind is run on each arm with each engine, for a number of ticks in all."""
    return max(1, round(ticks / (len(kinds()) * len(ARMS) * len(ENGINES) * LENGTH * RATE)))


@dataclass(frozen=True)
class Trial:
    """A run to be made.

    Attributes:
        arm: Name of the arm.
        engine: Name of the engine.
        number: Which repetition.
        kind: Name of the kind of bad sample.
    """

    arm: str
    engine: str
    number: int
    kind: str

    @property
    def id(self) -> str:
        """Name that stays the same."""
        return f"{self.arm}/{self.engine}/{self.kind}/{self.number}"


def run_arms(arms: Sequence[str], count: int, jobs: int) -> list[Outcome]:
    """Run what has not been run; returns all outcomes, arm by arm."""
    version = fingerprint()
    out: list[Outcome] = []
    for arm in arms:  # one after the other: a process keeps the monitors that it has taught for an arm
        trials = [Trial(arm, e, number, k.name) for e in ENGINES for number in range(count) for k in kinds()]
        store = Store(STORE / f"{arm}-{version}.jsonl", Outcome.from_json)
        out += run_all(trials, run_trial, store, jobs, _word)
    return out


def run_trial(trial: Trial) -> Outcome:
    """Run one."""
    kind = next(k for k in kinds() if k.name == trial.kind)
    return run(trial.arm, trial.engine, kind, trial.number)


def _word(o: Outcome) -> str:
    why = fell_short(o)
    return f"{'MISS' if why else 'ok  '}  {o.id}  {'; '.join(why)}"


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
