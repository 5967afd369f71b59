r"""The regression of measured torques on effects, :math:`y = X \theta + e`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.whitening import Whitening

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Regression:
    """Conditioned logs with the columns of effects X and the noise e.

    Attributes:
        design: Columns of effects, kept for reuse.
        whitening: Noise of each joint, samples that count, and blocks of time.
    """

    design: DesignMatrix
    whitening: Whitening

    def __repr__(self) -> str:
        return f"Regression({self.experiment!r})"

    @property
    def experiment(self) -> Experiment:
        """The conditioned logs."""
        return self.design.experiment

    def normal_equations(self, model: Dynamics | Prediction, effects: Sequence[Effect]) -> NormalEquations:
        """Form the normal equations of effects around a model.

        The response is the torque that the URDF lacks: the model's residual plus what the model's own terms explain, to
        first order. Effects that the model has in the same shape are differentiated at the model's parameters.

        Args:
            model: The present model, or its prediction.
            effects: The effects; the model's own may be among them.
        """
        prediction = self.experiment.predict(model) if isinstance(model, Dynamics) else model
        robot = self.experiment.robot
        present = {t.effect: np.array(t.theta) for t in prediction.model.terms}
        parameters = ParameterBlocks.of(effects)
        per_joint: list[list[tuple[slice, Array]]] = [[] for _ in range(robot.n)]
        response = prediction.residual.copy()
        for effect, own in zip(effects, parameters, strict=True):
            theta = present.get(effect)
            x = self.design.of(effect, prediction, theta)
            for i, j in enumerate(effect.acts_on(robot)):
                per_joint[j].append((own, x[:, i, :]))
                if theta is not None:
                    response[:, j] += x[:, i, :] @ theta
        total = parameters.total
        blocks = np.zeros((len(self.whitening.edges) - 1, total + 1, total + 1))
        for j, parts in enumerate(per_joint):
            at = np.concatenate([*(np.arange(s.start, s.stop) for s, _ in parts), [total]]).astype(int)
            stacked = self.whitening.joint(j, np.column_stack([*(x for _, x in parts), response[:, j]]))
            for b, samples in enumerate(self.whitening.blocks):
                rows = stacked[samples]
                blocks[b][np.ix_(at, at)] += rows.T @ rows
        return NormalEquations(robot, list(effects), blocks, self.whitening.samples)
