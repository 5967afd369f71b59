"""Known effects of the whole arm that a monitor asks for when joints leave their thresholds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import BaseTilt, Effect, Payload, Term
from cdia_pin.effects.unit_regressors import on_regressors
from cdia_pin.robot.inertia import parameters_of
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

BALL = 0.4  # [1], inertia of a ball about its centre over m r²
REACH = 1.0  # [m], furthest that the centre of a payload can be from the tool
RADIUS = 0.05  # [m], of the ball that stands for a payload: its size hardly shows in a torque


@dataclass(frozen=True)
class Hypothesis:
    """An effect of the whole arm, of which a short motion shows the first parameters.

    Attributes:
        effect: The effect.
        shown: Number of parameters that are estimated; those after them follow.
    """

    effect: Effect
    shown: int

    def on_regressors(self, robot: RobotModel) -> Array:
        """Return A with [Y K] A, the torque per unit of each estimated parameter near zero, shape (10 n + 3, shown).

        Args:
            robot: The arm, n joints; Y and K are its `regressors`.
        """
        return on_regressors(self.effect, robot)[:, : self.shown]

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return the prior standard deviation of each estimated parameter, ``inf`` where nothing is known.

        Args:
            robot: The arm.
        """
        return self.effect.prior_scale(robot)[: self.shown]

    def term(self, theta: Array, half: Array) -> Term:
        """Return the effect with its numbers, and 95 % intervals of the estimated ones.

        Args:
            theta: Estimated parameters, shape (shown,).
            half: Half widths of their intervals, shape (shown,).
        """
        whole = np.zeros(self.effect.size)
        whole[: self.shown] = theta
        if isinstance(self.effect, Payload):
            whole = _ball(theta)
        term = Term(self.effect, tuple(whole))
        return term.with_intervals(np.concatenate([half, np.zeros(self.effect.size - self.shown)]))


HYPOTHESES = (Hypothesis(Payload(), 4), Hypothesis(BaseTilt(), 2))


def _ball(theta: Array) -> Array:
    """Return the ten parameters of a small ball with this mass and these first moments, shape (10,)."""
    mass, moment = float(theta[0]), np.asarray(theta[1:4])
    if np.linalg.norm(moment) >= REACH * abs(mass):  # moments of noise, or of a change that is none
        return np.concatenate([theta, np.zeros(6)])
    return parameters_of(mass, moment / mass, BALL * mass * RADIUS**2 * np.eye(3))
