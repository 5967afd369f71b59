"""A body at the end of the arm is a payload where the log shows its weight; where it does not, it is the last link.

Makers often give the last link an inertia that nobody has measured. The body that mends it weighs nothing, and whoever
reads of a payload looks for a load.
"""

from __future__ import annotations

import numpy as np

from cdia_pin.discovery.plain_bodies import found_bodies
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import LinkInertia, Payload, Term
from cdia_pin.regression.gauss_newton import fitted_together, refit
from cdia_pin.regression.intervals import with_intervals
from cdia_pin.selection.problem import WhitenedProblem

# Parameters of a body [1] that gravity acts on: its mass and its first moments, which come first.
PARAMETERS_OF_WEIGHT = 4


def with_weighed_payload(problem: WhitenedProblem, model: Dynamics, given: Dynamics) -> Dynamics:
    """Return a model in which a payload whose weight may be nothing is part of the last link.

    A payload beside that link is one body with it.

    Args:
        problem: The logs and their noise.
        model: The fitted model.
        given: The model before the discovery; its terms stay as they are.
    """
    robot = model.robot
    link = LinkInertia(robot.tool_joint)
    loads = [t for t in found_bodies(model, given) if isinstance(t.effect, Payload)]
    possible = {f[0].label for f in problem.problem.families} - {t.label for t in given.terms}
    if not loads or link.label not in possible:
        return model
    fitted = with_intervals(*refit(problem.regression, model.without({link.label})))
    payload = fitted.find(loads[0].label)
    weight = slice(PARAMETERS_OF_WEIGHT)
    if np.any(np.abs(payload.theta[weight]) > payload.half_widths[weight]):
        return fitted
    same = Term(link, tuple(Payload().in_joint_frame(np.array(payload.theta), robot)))
    terms = (same if t is payload else t for t in fitted.terms)
    return fitted_together(problem.regression, Dynamics(robot, tuple(terms)))
