"""Terms that no arm can have, such as a friction of −5 N·m."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from cdia_pin.effects import Term
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

ROUNDING = 1e-6  # [1], by which an estimate may pass a bound, relative to its largest parameter


def unphysical(term: Term, robot: RobotModel, tolerance: float = ROUNDING) -> str:
    """Return why no arm can have a term; empty if one can.

    Args:
        term: An effect with numbers.
        robot: The arm.
        tolerance: By how much a parameter may pass a bound, relative to the largest parameter [1].
    """
    theta = np.array(term.theta)
    nearest = term.effect.nearest_physical(theta, robot)
    if term.effect.is_physical(theta, robot) or np.allclose(
        theta, nearest, rtol=0.0, atol=tolerance * float(np.abs(theta).max(initial=0.0))
    ):
        return ""
    outside = []
    rows = zip(term.effect.parameters, theta, *term.effect.bounds(robot), strict=True)
    for parameter, value, lower, upper in rows:
        if not lower <= value <= upper:
            outside.append(f"{parameter.name} = {value:.4g} is not within {lower:g} to {upper:g}")
    return f"{term.label}: " + (", ".join(outside) or "no body has this mass, first moments and inertia")


def require_physical(faults: Sequence[Term], robot: RobotModel, known: Iterable[Term] = ()) -> None:
    """Refuse faults that no arm can have; one may take away what the model already has.

    Args:
        faults: Terms that are added to the model.
        robot: The arm.
        known: Terms of the model.

    Raises:
        EffectError: If there is one; the message names its parameter and the bounds.
    """
    present = {term.effect: np.array(term.theta) for term in known}
    for fault in faults:
        together = np.array(fault.theta) + present.get(fault.effect, 0.0)
        if why := unphysical(fault.with_theta(together), robot):
            raise EffectError(why)
