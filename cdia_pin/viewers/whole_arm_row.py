"""The row of the whole arm beside those of its joints: payload, tilt of the base, contact."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from cdia_pin.diagnosis.status import Stage
from cdia_pin.effects import ExternalWrench, JointEffect, Term
from cdia_pin.viewers.event_words import fault_words

if TYPE_CHECKING:
    from cdia_pin.diagnosis import MonitorRun

WHOLE_ARM = "whole arm"


class WholeArmRow(NamedTuple):
    """What a table says of the whole arm.

    Attributes:
        stage: Its stage at the end.
        believed: Faults at the end in words.
    """

    stage: Stage
    believed: tuple[str, ...]


def whole_arm_row(run: MonitorRun) -> WholeArmRow | None:
    """Return the row of the whole arm at the end of a run; None for an engine that knows joints alone.

    Args:
        run: Of a replay or a closed loop.
    """
    if not run.in_torque:
        return None
    faults = of_whole_arm(run.faults)
    words = tuple(fault_words(t, run.robot, joint=True) for t in faults)
    had = any(of_whole_arm(e.faults) for e in run.events)
    compensated = bool(run.record["settings"].get("accommodate")) and not _is_touched(faults)
    if not faults:
        return WholeArmRow(Stage.IDLE if had else Stage.HEALTHY, words)
    return WholeArmRow(Stage.ACCOMMODATED if compensated else Stage.ISOLATED, words)


def of_whole_arm(faults: tuple[Term, ...]) -> tuple[Term, ...]:
    """Return the faults that concern the whole arm and no single joint.

    Args:
        faults: Believed faults.
    """
    return tuple(t for t in faults if not isinstance(t.effect, JointEffect))


def of_joint(faults: tuple[Term, ...], joint: str) -> tuple[Term, ...]:
    """Return the faults of one joint.

    Args:
        faults: Believed faults.
        joint: Name of the joint.
    """
    return tuple(t for t in faults if isinstance(t.effect, JointEffect) and joint in t.effect.scope)


def _is_touched(faults: tuple[Term, ...]) -> bool:
    """Tell whether there is contact, during which nothing is compensated."""
    return any(isinstance(t.effect, ExternalWrench) for t in faults)
