"""Events of a monitor in words, shared by the terminal and the pages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.viewers.parameter_rows import parameters, shape_parameters
from cdia_pin.viewers.words import effect_name, listed, profile_words, short_names

if TYPE_CHECKING:
    from cdia_pin.diagnosis import Event
    from cdia_pin.effects import Term
    from cdia_pin.robot.model import RobotModel

VERDICTS = {"unique": "only explanation", "ambiguous": "one of several", "unknown": "no known effect"}

MANY = 5  # parameters [1] of an effect, from which those that were not estimated are left out


@dataclass(frozen=True)
class EventRow:
    """One line of a table of events.

    Attributes:
        time: When [s].
        joints: Short names of the joints, or ``all``.
        concerned: Full names of the joints.
        stage: ``detection``, ``isolation``, ``isolation, accommodation``, ``accommodation`` or ``idle``.
        verdict: Verdict of the isolation in words; empty without one.
        said: Faults, each with its size.
        alternatives: Other explanations, one combination each.
        reason: What a reader should know besides.
    """

    time: float
    joints: str
    concerned: tuple[str, ...]
    stage: str
    verdict: str
    said: tuple[str, ...]
    alternatives: tuple[str, ...]
    reason: str


def event_rows(events: Sequence[Event], robot: RobotModel) -> list[EventRow]:
    """Return events as lines; isolation and the accommodation that follows at once share one line.

    Args:
        events: Of a monitor, in their order.
        robot: The arm.
    """
    rows: list[EventRow] = []
    previous: Event | None = None
    for event in events:
        again = (
            event.stage == "accommodation"
            and previous is not None
            and previous.stage == "isolation"
            and (previous.time, previous.joints) == (event.time, event.joints)
        )
        if again:
            rows[-1] = _row(previous, robot, "isolation, accommodation")  # type: ignore[arg-type]
        else:
            rows.append(_row(event, robot, event.stage))
        previous = event
    return rows


def fault_words(term: Term, robot: RobotModel, *, joint: bool = False) -> str:
    """Return a fault in words: ``coulomb friction: level 4.99 ± 0.01 N·m``.

    Args:
        term: A fault.
        robot: The arm.
        joint: Whether to name its joint.
    """
    where = f" on {listed(term.effect.scope)}" if joint and term.effect.scope else ""
    if term.effect.name == "unknown":
        return f"unknown fault{where}; its torque was learned"
    # What was not estimated follows from the rest: of a payload the inertia, of a contact the torque.
    estimated = np.array(term.theta) != 0 if term.ci95 is None else term.half_widths > 0
    shown = [
        p
        for p, is_own in zip(parameters(term, robot), estimated, strict=True)
        if is_own or term.effect.size < MANY
    ]
    numbers = [f"{p['name']} {p['text']}" for p in (*shown, *shape_parameters(term, robot))]
    present = profile_words(term)
    return f"{effect_name(term.effect)}{where}: {', '.join(numbers)}" + (
        f"; present: {present}" if present else ""
    )


def _row(event: Event, robot: RobotModel, stage: str) -> EventRow:
    short = short_names(robot.joints)
    every = len(event.joints) == robot.n > 1
    return EventRow(
        time=event.time,
        joints="all" if every else ", ".join(short[j] for j in event.joints),
        concerned=event.joints,
        stage=stage,
        verdict=VERDICTS.get(str(event.verdict), ""),
        said=tuple(fault_words(t, robot, joint=len(event.joints) > 1) for t in event.faults),
        alternatives=tuple(" with ".join(effect_name(t.effect) for t in one) for one in event.alternatives),
        reason=event.reason,
    )
