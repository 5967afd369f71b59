"""Intervals of an estimate, from the information of the log and from the scatter between blocks of time."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import LinkInertia, Term
from cdia_pin.effects.body import Body
from cdia_pin.identification.estimate import Estimate
from cdia_pin.identification.prior import precision
from cdia_pin.regression.effort_scale import scale_error
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.scaled_gram import ScaledGram
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

RANK_CUTOFF = 1e-13  # eigenvalues of scaled precisions, over the largest [1], that count as zero
LOOSE = 1.0  # strength of the prior in intervals [1]: a link may differ by as much as itself


@dataclass(frozen=True, repr=False)
class Uncertainty:
    """Covariances of all parameters, shape (P, P) each.

    Attributes:
        before: Covariance of the prior alone.
        after: Covariance given the prior and the log.
    """

    before: Array
    after: Array

    def __repr__(self) -> str:
        return f"Uncertainty({len(self.after)} parameters)"


def uncertainty(experiment: Experiment, estimate: Estimate) -> Uncertainty:
    """Return the covariance of the parameters before and after the log.

    The strength that predicts best may be larger than the true confidence in the URDF, so the intervals use a weak
    prior. Errors are correlated in time and therefore contain less information than independent ones; the scatter
    between blocks of time allows for that [Liang1986].

    Args:
        experiment: The conditioned logs.
        estimate: The final estimate.
    """
    equations = estimate.equations
    loose = precision(equations, experiment, estimate.whitening, min(estimate.strength, LOOSE))
    after = _inverse(equations.total[:-1, :-1] + loose)
    scores = equations.blocks[:, :-1, -1] - equations.blocks[:, :-1, :-1] @ estimate.theta
    scores = scores - scores.mean(axis=0)  # the mean comes from the prior alone
    count = len(scores)
    between = after @ (scores.T @ scores) @ after * count / (count - 1)
    return Uncertainty(_inverse(loose), after + between)


def with_intervals(estimate: Estimate, covariance: Array, tolerance: Array) -> Dynamics:
    """Return the model whose terms carry 95 % intervals: those of the fit, and with what the torques' scale is worth.

    A link is found as a whole, so the scale concerns all of it and not only its difference from the URDF.

    Args:
        estimate: The final estimate.
        covariance: Covariance of all parameters, shape (P, P).
        tolerance: Tolerance of the scale of each joint's torque, 95 % [1], shape (n,).
    """
    robot = estimate.model.robot
    half = quantile(estimate) * np.sqrt(np.maximum(np.diag(covariance), 0.0))
    terms = []
    for term, span in zip(estimate.model.terms, estimate.equations.parameters, strict=True):
        shown = term.with_intervals(half[span])
        relative = scale_error(term.effect, _acted_on(term, robot), tolerance)
        theta = np.array(term.theta)
        whole = term.effect.total(theta, robot) if isinstance(term.effect, LinkInertia) else theta
        terms.append(shown.less_certain(relative * np.abs(whole)) if relative else shown)
    return replace(estimate.model, terms=tuple(terms))


def quantile(estimate: Estimate) -> float:
    """Return the half width of a 95 % interval over the standard deviation [1], for the number of blocks of time.

    Args:
        estimate: The final estimate.
    """
    from scipy.special import stdtrit

    return float(stdtrit(len(estimate.equations.blocks) - 1, 0.975))


def of_bodies(estimate: Estimate) -> Array:
    """Return the linear map from all parameters to the inertial parameters of the links in their joints' frames.

    Args:
        estimate: The final estimate.

    Returns:
        Shape (10 n, P).
    """
    robot = estimate.model.robot
    out = np.zeros((10 * robot.n, len(estimate.prior)))
    for effect, span in zip(estimate.equations.effects, estimate.equations.parameters, strict=True):
        if isinstance(effect, Body):
            j = effect.carrier(robot)
            out[10 * j : 10 * j + 10, span] = effect.to_joint_frame(robot)
    return out


def _acted_on(term: Term, robot: RobotModel) -> Array:
    """Return one for the joints on which a term acts, else zero, shape (n,)."""
    return np.isin(range(robot.n), list(term.effect.acts_on(robot))).astype(float)


def _inverse(matrix: Array) -> Array:
    return ScaledGram.of(matrix).pseudo_inverse(RANK_CUTOFF)
