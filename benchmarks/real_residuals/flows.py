"""The questions that a user asks of two logs, and what the program names.

`benchmarks.monitored_logs` asks the monitor: healthy on the first log, with the effect from the middle of the second.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import process_time

from benchmarks.real_residuals.answers import Named, differences, of_changes, of_discovery
from benchmarks.real_residuals.bases import Base
from benchmarks.real_residuals.cases import ALONE, COMPARE, GONE, MODEL
from cdia_pin import Dynamics, discover, what_changed
from cdia_pin.logs import Log
from cdia_pin.robot import RobotModel


@dataclass(frozen=True)
class Question:
    """Two logs, and what was found on them before anything was inserted.

    Attributes:
        robot: The arm.
        before: The first log, as it was measured.
        after: The second, with an effect or without.
        base_before: What was found on the first; None where the flow does not need it.
        base_after: What was found on the second before anything was inserted; None where it is not needed.
    """

    robot: RobotModel
    before: Log
    after: Log
    base_before: Base | None = None
    base_after: Base | None = None


@dataclass(frozen=True)
class Answer:
    """What the program said.

    Attributes:
        named: Effects by which the second log differs.
        verdict: In the program's word.
        seconds: Processor time of the question [s], without reading logs.
    """

    named: tuple[Named, ...]
    verdict: str
    seconds: float


def _compare(q: Question) -> Answer:
    began = process_time()
    found = what_changed(Dynamics(q.robot), q.before, q.after)
    return Answer(of_changes(found), found.verdict, process_time() - began)


def _gone(q: Question) -> Answer:
    answer = _compare(replace(q, before=q.after, after=q.before))
    return replace(answer, named=tuple(n.negated() for n in answer.named))


def _model(q: Question) -> Answer:
    assert q.base_before is not None
    model = q.base_before.load(q.robot)
    began = process_time()
    found = discover(model, q.after)
    return Answer(of_discovery(found), found.verdict, process_time() - began)


def _alone(q: Question) -> Answer:
    assert q.base_after is not None
    began = process_time()
    found = discover(Dynamics(q.robot), q.after)
    seconds = process_time() - began
    return Answer(differences(q.base_after.named, of_discovery(found)), found.verdict, seconds)


FLOW: dict[str, Callable[[Question], Answer]] = {
    COMPARE: _compare,
    MODEL: _model,
    ALONE: _alone,
    GONE: _gone,
}
NEEDS_BEFORE, NEEDS_AFTER = (MODEL,), (ALONE,)  # flows that need a discovery of an untouched log
