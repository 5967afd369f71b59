"""What the monitor says of explanations that it cannot tell apart."""

from __future__ import annotations

from collections.abc import Sequence

from cdia_pin.effects import Term
from cdia_pin.identifiability.distinguishing_motions import distinguishing_motion
from cdia_pin.robot.model import RobotModel


def what_separates(combinations: Sequence[Sequence[Term]], robot: RobotModel) -> str:
    """Return a sentence that names combinations of faults which explain a motion alike, and what separates them.

    Args:
        combinations: Each the faults that explain the motion together; none for an arm without a fault.
        robot: The arm.
    """
    names = [" with ".join(t.effect.name for t in terms) or "none" for terms in combinations]
    motion = distinguishing_motion([[t.effect for t in terms] for terms in combinations], robot)
    return f"{' and '.join(names)} explain this motion alike; to tell them apart, {motion}"
