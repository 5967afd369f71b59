"""Repeatability: what two logs of one arm say alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, nan
from typing import ClassVar

from benchmarks.outcomes import JsonLine
from benchmarks.real_residuals.answers import ESTABLISHED, Named, half
from benchmarks.real_residuals.bases import Base, BaseCase
from benchmarks.real_residuals.pairs import repeated
from benchmarks.real_residuals.recordings import Recording
from benchmarks.real_residuals.running import store_of
from cdia_pin import Dynamics
from cdia_pin.discovery import compare
from cdia_pin.regression.shares import mean_share


@dataclass(frozen=True)
class RepeatCase:
    """Two logs of one arm that is the same in both."""

    one: Recording
    other: Recording

    @property
    def id(self) -> str:
        """Name that stays the same."""
        return f"{self.one.id} and {self.other.id.partition('/')[2]}"


@dataclass(frozen=True)
class Repeat(JsonLine):
    """How far two logs agree.

    Attributes:
        id: Of the pair.
        arm: Name of the arm.
        common: Names that count as established in both.
        apart: Names that count as established in one.
        within: Parameters found in both that agree within their intervals.
        compared: Parameters found in both.
        carried_over: Error of each one's model on the other log over that of the URDF, mean over the joints [1].
        failure: Why they could not be compared; empty if they could.
    """

    id: str
    arm: str
    common: int = 0
    apart: int = 0
    within: int = 0
    compared: int = 0
    carried_over: tuple[float, float] = (nan, nan)
    failure: str = ""

    @property
    def alike(self) -> float:
        """Intersection over union of the names [1]; 1 where neither names anything, 0 where a program failed."""
        if self.failure:
            return 0.0
        return self.common / (self.common + self.apart) if self.common + self.apart else 1.0

    READ: ClassVar = {"carried_over": tuple}


def planned_repeats() -> list[RepeatCase]:
    """Return every pair that is compared."""
    return [RepeatCase(*two) for two in repeated()]


def run_repeat(case: RepeatCase) -> Repeat:
    """Compare what is kept of both logs."""
    kept = store_of("bases", Base.from_json).read()
    return compared(case, *(kept[BaseCase(r).id] for r in (case.one, case.other)))


def compared(case: RepeatCase, *bases: Base) -> Repeat:
    """Compare what was found in both logs.

    Args:
        case: The logs.
        bases: What was found in the one and in the other.
    """
    if why := "; ".join(b.failure for b in bases if b.failure):
        return Repeat(case.id, case.one.arm, failure=why)
    first, second = ({n.label: n for n in b.named if n.confidence in ESTABLISHED} for b in bases)
    shared = first.keys() & second.keys()
    agreed = [a for label in sorted(shared) for a in agree(first[label], second[label])]
    return Repeat(
        case.id,
        case.one.arm,
        len(shared),
        len(first.keys() ^ second.keys()),
        sum(agreed),
        len(agreed),
        (_carried(bases[0], case.other), _carried(bases[1], case.one)),
    )


def agree(one: Named, other: Named) -> Sequence[bool]:
    """Return for each parameter with intervals whether two estimates agree within both together."""
    both = [k for k in one.intervals if k in other.intervals]
    return [abs(one.values[k] - other.values[k]) <= hypot(half(one, k), half(other, k)) for k in both]


def _carried(base: Base, onto: Recording) -> float:
    log, robot = onto.read(), onto.robot
    found, urdf = (compare(m, log).rms for m in (base.load(robot), Dynamics(robot)))
    return mean_share(found, urdf)
