"""The estimate: weighted least squares with a prior around the URDF, over physically consistent parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.identification.identification_settings import IdentificationSettings
from cdia_pin.identification.prior import precision
from cdia_pin.identification.terms import moving_joints
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.regression.gauss_newton import is_exact, with_parameters
from cdia_pin.regression.noise import NoiseModel
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.physical_consistency import consistent_parameters
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.scaled_gram import ScaledGram
from cdia_pin.regression.time_blocks import time_blocks
from cdia_pin.regression.whitening import Whitening

Array = NDArray[np.float64]

MOST_ITERATIONS = 8  # iterations of Gauss-Newton [1] where an effect depends on the torque; a guard
# Change of the parameter vector over its norm [1], in units of the columns, that counts as none.
CONVERGED = 1e-3
# Error of a joint over its torque [1] before anything is fitted, so that all joints weigh alike.
FIRST_ERROR = 0.05
FINEST_ERROR = 1e-6  # least error of a moving joint over its torque [1], because less is rounding
# Error of a resting joint over its torque, all samples together [1], because dry friction may carry it.
STUCK_ERROR = 1.0
PATIENCE = 3  # rounds [1] of fitting and weighting, because weights and fit depend on each other
RIDGE = 1e-12  # added to a unit diagonal [1], so that columns that repeat each other can be solved


@dataclass(frozen=True, repr=False)
class Estimate:
    """A fitted model with its normal equations and prior.

    Attributes:
        model: The model at its optimum.
        equations: Normal equations of its terms at the optimum.
        prior: Precision of the prior, shape (P, P).
        whitening: Weight of each joint, samples that count, blocks of time.
        strength: Strength of the prior on bodies around the URDF [1].
    """

    model: Dynamics
    equations: NormalEquations
    prior: Array
    whitening: Whitening
    strength: float

    def __repr__(self) -> str:
        return f"Estimate({self.model!r}, strength {self.strength:g})"

    @property
    def theta(self) -> Array:
        """Parameters of all terms, one after another, shape (P,)."""
        return self.model.theta


class Fitter:
    """Fits models to one experiment. Samples count if their joint moves, or if the joint hardly ever moves.

    Args:
        experiment: The conditioned logs.
        settings: When a joint counts as moving, and the number of blocks of time.
    """

    def __init__(self, experiment: Experiment, settings: IdentificationSettings) -> None:
        self.experiment = experiment
        self.settings = settings
        self.design = DesignMatrix(experiment)
        self.moving = moving_joints(experiment, settings.least_motion)
        self.used = experiment.moving | ~self.moving
        self.blocks = time_blocks(experiment.segments, settings.blocks)

    def __repr__(self) -> str:
        return f"Fitter({self.experiment!r}, {len(self.blocks)} blocks)"

    def weights(self, residual: Array) -> Whitening:
        """Weight every joint by its own error, so that a wrist counts as much as the shoulder.

        Errors are not whitened in time. The residual of friction laws is slow, and a filter that treats slow errors as
        noise would no longer minimise the error that is reported. Intervals allow for it by the blocks of time.

        Args:
            residual: Residual of the present model [N·m or N], shape (K, n).
        """
        e = self.experiment
        share = np.where(self.moving, FINEST_ERROR, STUCK_ERROR * np.sqrt(len(residual)))
        sigma = np.maximum(rms(residual, self.used), share * rms(e.measured, self.used) + 1e-12)
        noise = [NoiseModel(np.zeros(0), np.full(len(residual), s), tuple(e.runs)) for s in sigma]
        return Whitening(tuple(noise), self.used, self.blocks)

    def fit(self, model: Dynamics, strength: float, whitening: Whitening | None = None) -> Estimate:
        """Fit all parameters of a model.

        Args:
            model: The model; iterations start at its parameters.
            strength: Strength of the prior on bodies around the URDF [1].
            whitening: Weight of each joint; found from the residual if omitted.
        """
        rounds = 1 if whitening else PATIENCE
        whitening = whitening or self.weights(FIRST_ERROR * self.experiment.measured)
        for k in range(rounds):
            estimate = self._fit(model, strength, whitening)
            model = estimate.model
            if k < rounds - 1:
                whitening = self.weights(self.experiment.predict(model).residual)
        return estimate

    def _fit(self, model: Dynamics, strength: float, whitening: Whitening) -> Estimate:
        effects = [t.effect for t in model.terms]
        exact = all(map(is_exact, effects))
        regression = Regression(self.design, whitening)
        before = model.theta
        for _ in range(MOST_ITERATIONS):
            equations = regression.normal_equations(model, effects)
            prior = precision(equations, self.experiment, whitening, strength)
            theta = constrained(equations, equations.total, prior)
            model = with_parameters(model, theta)
            moved = np.linalg.norm((theta - before) * equations.scale)
            if exact or moved <= CONVERGED * np.linalg.norm(theta * equations.scale):
                break
            before = theta
        if not exact:
            equations = regression.normal_equations(model, effects)
        return Estimate(model, equations, prior, whitening, strength)


def constrained(equations: NormalEquations, total: Array, prior: Array) -> Array:
    """Return the most probable physical parameters, shape (P,).

    Args:
        equations: Normal equations, for effects and bounds.
        total: Normal equations of all or some blocks, shape (P + 1, P + 1).
        prior: Precision of the prior, shape (P, P).
    """
    return consistent_parameters(total[:-1, :-1] + prior, total[:-1, -1], equations.effects, equations.robot)


def unconstrained(total: Array, prior: Array) -> Array:
    """Return the most probable parameters, physical or not.

    Args:
        total: Normal equations of all or some blocks, shape (P + 1, P + 1).
        prior: Precision of the prior, shape (P, P).

    Returns:
        Shape (P,).
    """
    matrix = total[:-1, :-1] + prior
    return ScaledGram.of(matrix, RIDGE).solve(total[:-1, -1])
