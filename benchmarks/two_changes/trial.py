"""One case from beginning to end: draw both effects, put them in, ask, and hold the answer against the truth."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import nan
from time import process_time
from typing import ClassVar

from benchmarks.outcomes import JsonLine
from benchmarks.real_residuals.answers import Named, of_changes
from benchmarks.real_residuals.draws import drawn
from benchmarks.real_residuals.failures import failed
from benchmarks.real_residuals.filtered import FilteredLog
from benchmarks.real_residuals.insertion import Insertion
from benchmarks.real_residuals.sizing import NoSizeError
from benchmarks.real_residuals.trial import Truth, misses, truth_of
from benchmarks.two_changes.cases import Case
from cdia_pin.changes import what_changed
from cdia_pin.dynamics import Dynamics
from cdia_pin.logs import Log


@dataclass(frozen=True)
class Outcome(JsonLine):
    """What came of a case.

    Attributes:
        id: Of the case.
        arm: Name of the arm.
        effects: Names of both effects.
        size: Of each [%] of its joint's RMS torque.
        truth: Labels of both.
        impossible: Why both could not be put in; empty if they could.
        named: What the program named.
        errors: Relative errors of the parameters that tell a size, of what was rightly named [1].
        held: Whether the interval of each of them holds the truth.
        seconds: Processor time of the question [s].
        failure: What the program failed with; empty if it did not.
    """

    id: str
    arm: str
    effects: tuple[str, ...]
    size: int
    truth: tuple[str, ...] = ()
    impossible: str = ""
    named: tuple[Named, ...] = ()
    errors: tuple[float, ...] = ()
    held: tuple[bool, ...] = ()
    seconds: float = nan
    failure: str = ""

    READ: ClassVar = {
        "named": lambda v: tuple(map(Named.from_dict, v)),
        **dict.fromkeys(("effects", "truth", "errors", "held"), tuple),
    }

    @property
    def labels(self) -> frozenset[str]:
        """Names that the program gave."""
        return frozenset(n.label for n in self.named)

    @property
    def exact(self) -> bool:
        """Whether both are named, and nothing else."""
        return self.labels == frozenset(self.truth)

    @property
    def among(self) -> bool:
        """Whether both are among the named."""
        return self.labels >= frozenset(self.truth)

    @property
    def on_one_joint(self) -> bool:
        """Whether both are on the same joint; an effect of the whole arm is on none."""
        one, two = (t.partition("@")[2] for t in self.truth)
        return bool(one) and one == two


def run_case(case: Case) -> Outcome:
    """Run a case.

    Args:
        case: The case.
    """
    outcome = Outcome(case.id, case.pair.arm, case.effects, case.size)
    try:
        before, after, truths = logs_of(case)
    except NoSizeError as why:
        return replace(outcome, impossible=str(why))
    outcome, began = replace(outcome, truth=tuple(t.label for t in truths)), process_time()
    try:
        found = what_changed(Dynamics(case.pair.before.robot), before, after)
    except BaseException as why:  # a solver may panic, which is no Exception
        return replace(outcome, failure=failed(why), seconds=process_time() - began)
    said = replace(outcome, named=of_changes(found), seconds=process_time() - began)
    errors: list[float] = []
    held: list[bool] = []
    for named in said.named:
        for truth in truths:
            if truth.label == named.label and truth.values:
                missed, holds = misses(named, truth.values)
                errors += missed.values()
                held += holds.values()
    return replace(said, errors=tuple(errors), held=tuple(held))


def logs_of(case: Case) -> tuple[Log, Log, tuple[Truth, Truth]]:
    """Return both logs of a case, the second with both effects, and what differs.

    Args:
        case: The case.

    Raises:
        NoSizeError: If one of them can have its size on no joint.
    """
    before, after = case.pair.before.read(), case.pair.after.read()
    robot = case.pair.before.robot
    unchanged, along = FilteredLog.of(before, robot), FilteredLog.of(after, robot)
    share, (one, other) = case.size / 100, case.effects
    first = drawn(one, share, unchanged, along, case.seed)
    among = list(robot.joints)
    if first.effect.scope:
        (joint,) = first.effect.joints(robot)
        among = [j for j in robot.joints if (j == joint) is case.on_one_joint]
    second = drawn(other, share, unchanged, along, case.seed + 1, among)
    with_first = Insertion(first, along).into(after)
    beside = FilteredLog.of(with_first, robot)
    return (
        before,
        Insertion(second, beside).into(with_first),
        (truth_of(first, along), truth_of(second, beside)),
    )
