"""The design matrix: columns of effects in the residual. Columns that can be reused are computed once."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import ALWAYS, Channel, Effect, Signal
from cdia_pin.regression.experiment import Experiment, Prediction
from cdia_pin.regression.noise import NoiseModel
from cdia_pin.regression.shape_slopes import Slope

Array = NDArray[np.float64]


# Change of gravity [m/s²] up to which the columns of bodies are reused, because they change by 0.3 %.
SAME_GRAVITY = 0.03
RIDGE = 1e-6  # added to a Gram matrix's diagonal, over its trace [1], because columns may repeat each other
WEAKEST = 1e-12  # least that is added [1/unit²], because a shape that no sample shows has columns of zeros


@dataclass(frozen=True, eq=False, repr=False)
class Columns:
    """Columns of one effect.

    Attributes:
        values: Torque per unit of each parameter [N·m or N per unit], shape (K, joints, p).
        fixed: Columns that depend on the motion alone, always the same array; None if there are none.
        factors: For each joint the factor of the fixed columns in the values [1], NaN where the values are not
            proportional to them, shape (joints,).
    """

    values: Array
    fixed: Array | None
    factors: Array

    def __repr__(self) -> str:
        return f"Columns({self.values.shape[2]} parameters, {self.values.shape[1]} joints)"


class DesignMatrix:
    """Columns of effects in the residual. Columns that do not depend on the model's torque are computed once.

    Args:
        experiment: The conditioned logs.

    Attributes:
        follows_zeros: Whether the columns of a model's own effects are those at its true positions, as encoders' zeros
            move them. A search takes them at the positions that are read: exact ones lead it into unusual effects.
    """

    def __init__(self, experiment: Experiment) -> None:
        self.experiment = experiment
        self.follows_zeros = False
        self._fixed: dict[Effect, Array] = {}
        self._weighed: tuple[Array, dict[Effect, Array]] = (np.zeros(3), {})
        self._gravity: tuple[Prediction, Array] | None = None
        self._families: dict[Effect, tuple[NoiseModel, list[Effect], Array, Array]] = {}

    def following_zeros(self) -> DesignMatrix:
        """Return the same columns, those of a model's own effects at its true positions."""
        out = copy(self)
        out.follows_zeros = True
        return out

    def of(self, effect: Effect, prediction: Prediction, theta: Array | None = None) -> Array:
        """Return the columns of an effect.

        The columns of the model's own effects are exact. For a candidate (θ omitted), a gain that changes along the
        motion is replaced by its mean; this is enough to rank the candidate.

        Args:
            effect: The effect.
            prediction: Prediction of the model that has the effect, or for which it is a candidate.
            theta: Parameters of the effect if the model has it, shape (p,).

        Returns:
            Torque per unit of each parameter [N·m or N per unit], shape (K, len(acts_on), p).
        """
        return self.columns(effect, prediction, theta).values

    def columns(self, effect: Effect, prediction: Prediction, theta: Array | None = None) -> Columns:
        """Return the columns of an effect as `of` does, and where they can be reused.

        Args:
            effect: The effect.
            prediction: Prediction of the model that has the effect, or for which it is a candidate.
            theta: Parameters of the effect if the model has it, shape (p,).
        """
        out = self._unread(effect, prediction, theta)
        if theta is None or not prediction.model.reads_otherwise(effect):
            return out
        joints = list(effect.acts_on(self.experiment.robot))
        values = self.experiment.read(prediction.model, out.values, joints)
        return Columns(values, None, np.full(len(joints), np.nan))

    def _unread(self, effect: Effect, prediction: Prediction, theta: Array | None) -> Columns:
        """Return the columns of an effect in the torque itself, before it is read.

        Args:
            effect: The effect.
            prediction: Prediction of the model that has the effect, or for which it is a candidate.
            theta: Parameters of the effect if the model has it, shape (p,).
        """
        exact = theta is not None
        joints = list(effect.acts_on(self.experiment.robot))
        traits = effect.traits
        # at zero, a nonlinear effect has the columns of a candidate
        bends = not traits.linear and theta is not None and bool(np.any(theta))
        moves = self.follows_zeros and prediction.model.moves(effect)
        is_own = exact and (moves or prediction.profile(effect) != ALWAYS)
        # slopes are right for the present parameters alone and cannot be reused
        if isinstance(effect, Slope) or Signal.TORQUE in traits.depends_on or bends or is_own:
            values = self.experiment.columns(effect, prediction, theta, follows_zeros=self.follows_zeros)
            return Columns(values, None, np.full(len(joints), np.nan))
        fixed = self.fixed(effect, prediction)
        mean, varies = prediction.gains
        if traits.channel is Channel.TORQUE_READING or not (
            varies[joints].any() or (mean[joints] != 1.0).any()
        ):
            return Columns(fixed, fixed, np.ones(len(joints)))
        values = fixed / mean[joints][:, None]
        factors = 1.0 / mean[joints]
        if exact and varies[joints].any():
            along = np.flatnonzero(varies[joints])
            values[:, along] = self.experiment.columns(effect, prediction, theta, at=along)
            factors[along] = np.nan
        return Columns(values, fixed, factors)

    def fixed(self, effect: Effect, prediction: Prediction) -> Array:
        """Return the columns of an effect that depends on the motion alone, as in a model without gains.

        Args:
            effect: The effect.
            prediction: Prediction of the present model, for the direction of gravity.

        Returns:
            Torque per unit of each parameter [N·m or N per unit], shape (K, len(acts_on), p).
        """
        known = self._fixed
        if Signal.GRAVITY in effect.traits.depends_on:
            change = self._gravity_change(prediction)
            if np.linalg.norm(change - self._weighed[0], axis=1).max() > SAME_GRAVITY:
                self._weighed = (change, {})
            known = self._weighed[1]
        if effect not in known:
            bare = replace(
                prediction, torques=tuple(replace(t, gain=np.ones_like(t.gain)) for t in prediction.torques)
            )
            known[effect] = self.experiment.columns(effect, bare)
        return known[effect]

    def _gravity_change(self, prediction: Prediction) -> Array:
        """Return the change of gravity along all segments [m/s²], shape (number of samples, 3)."""
        if self._gravity is None or self._gravity[0] is not prediction:
            model = prediction.model
            self._gravity = (
                prediction,
                np.vstack([model.gravity_change(s.state) for s in self.experiment.segments]),
            )
        return self._gravity[1]

    def family(self, family: list[Effect], prediction: Prediction, noise: NoiseModel) -> tuple[Array, Array]:
        """Return the whitened columns of a family of C shapes of one effect, and their inverse Gram matrices.

        Args:
            family: One effect of one joint in C shapes.
            prediction: Prediction of the present model.
            noise: Noise of the joint.

        Returns:
            Columns [1 per unit], shape (C, p, K), and inverse Gram matrices, shape (C, p, p).
        """
        if Signal.TORQUE in family[0].traits.depends_on:  # the next model has another torque
            return self._whitened([self.of(e, prediction) for e in family], family[0], noise)
        known = self._families.get(family[0])
        if known is None or known[0] is not noise or known[1] != family:
            columns = [self.fixed(e, prediction) for e in family]
            known = (noise, family, *self._whitened(columns, family[0], noise))
            self._families[family[0]] = known
        return known[2:]

    def _whitened(self, columns: Sequence[Array], of: Effect, noise: NoiseModel) -> tuple[Array, Array]:
        """Return the whitened columns of C shapes of an effect of one joint, and their inverse Gram matrices.

        Args:
            columns: Columns of each shape, shape (K, 1, p) each.
            of: One of the shapes.
            noise: Noise of the joint.
        """
        (j,) = of.acts_on(self.experiment.robot)
        at = self.experiment.informative[:, j, None, None]
        stacked = np.stack([c[:, 0, :] for c in columns], axis=1)  # (K, C, p)
        white = np.where(at, noise.whiten(np.where(at, stacked, 0.0)), 0.0).transpose(1, 2, 0)
        gram = white @ white.transpose(0, 2, 1)
        ridge = np.maximum(RIDGE * np.einsum("cpp->c", gram), WEAKEST)
        inverse = np.linalg.inv(gram + ridge[:, None, None] * np.eye(gram.shape[1]))
        return np.ascontiguousarray(white), inverse
