"""An effect of the whole arm after its isolation: what is on trial, when it is gone, and what its event says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.whole_arm.isolation import ArmDecision
from cdia_pin.effects import Term

Array = NDArray[np.float64]

GONE_SHARE = 0.15  # [1], share of an effect that may be left when it counts as cleared


@dataclass(frozen=True)
class ArmTrial:
    """An effect that was believed in of late.

    Attributes:
        index: Of its hypothesis.
        before: What was believed before.
        moved: By how much its parameters have changed since, shape (shown,).
        since: When [s].
    """

    index: int
    before: tuple[Term, ...]
    moved: Array
    since: float


def is_gone(before: Array, change: ArmDecision) -> bool:
    """Tell whether nearly nothing is left of an effect: it was put down, or stands upright again.

    Args:
        before: Its parameters as they were, shape (shown,).
        change: By how much they changed.
    """
    after = before + change.theta
    return not change.differs(after) or change.distance(after) < GONE_SHARE * change.distance(before)


def why(term: Term) -> str:
    """Return the reason for an effect of the whole arm in words.

    Args:
        term: The effect, with intervals.
    """
    no_number = (np.abs(term.theta) <= term.half_widths)[term.half_widths > 0].all()
    unknown = "; this motion shows that it is there, and none of its numbers by itself" if no_number else ""
    return f"one cause for all joints{unknown}"
