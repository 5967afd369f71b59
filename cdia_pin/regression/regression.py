r"""The regression of measured torques on effects, :math:`y = X \theta + e`."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction
from cdia_pin.regression.jointwise_equations import JointGram, JointwiseEquations
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.whitening import Whitening

Array = NDArray[np.float64]

MOST_KEPT = 3  # sets of effects [1] whose normal equations are kept for the next iterations


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

    def chi2(self, model: Dynamics) -> float:
        """Return the residual sum of squares of a model, in variances of the noise [1].

        Args:
            model: The model.
        """
        return float(np.sum(self.whitening.every(self.experiment.predict(model).residual) ** 2))

    def normal_equations(
        self,
        model: Dynamics | Prediction,
        effects: Sequence[Effect],
        *,
        like: JointwiseEquations | None = None,
        but: Collection[int] = (),
    ) -> JointwiseEquations:
        """Form the normal equations of effects around a model.

        The response is the torque that the URDF lacks: the model's residual plus what the model's own terms explain, to
        first order. Effects that the model has in the same shape are differentiated at the model's parameters.

        Args:
            model: The present model, or its prediction.
            effects: The effects; the model's own may be among them.
            like: Normal equations around a model that differs only in effects of some joints, of effects that differ
                only there and in their shape. A torque changes no other joint's torque, so that the rest is reused.
            but: Indices of those joints.

        Raises:
            EffectError: If two terms of the model have the same effect.
        """
        prediction = self.experiment.predict(model) if isinstance(model, Dynamics) else model
        robot = self.experiment.robot
        present = {e: np.array(t.theta) for e, t in prediction.present.items()}
        parameters = ParameterBlocks.of(effects)
        anew = range(robot.n) if like is None else sorted(but)
        reused: list[list[_Reused]] = [[] for _ in range(robot.n)]
        others: list[list[tuple[slice, Array]]] = [[] for _ in range(robot.n)]
        response = prediction.residual.copy()
        for effect, own in zip(effects, parameters, strict=True):
            if like is not None and not set(effect.acts_on(robot)) & set(but):
                continue
            theta = present.get(effect)
            x = self.design.columns(effect, prediction, theta)
            for i, j in enumerate(effect.acts_on(robot)):
                if x.fixed is not None and np.isfinite(x.factors[i]):
                    reused[j].append(_Reused(own, effect, x.fixed[:, i, :], float(x.factors[i])))
                else:
                    others[j].append((own, x.values[:, i, :]))
                if theta is not None:
                    response[:, j] += x.values[:, i, :] @ theta
        last = slice(parameters.total, parameters.total + 1)
        grams = {j: self._of_joint(j, reused[j], [*others[j], (last, response[:, j, None])]) for j in anew}
        joints = [grams[j] if like is None or j in grams else like.joints[j] for j in range(robot.n)]
        return JointwiseEquations(robot, list(effects), joints, self.whitening.samples)

    def _of_joint(self, j: int, reused: list[_Reused], others: list[tuple[slice, Array]]) -> JointGram:
        """Return the normal equations of one joint's samples.

        Args:
            j: Index of the joint.
            reused: Columns that depend on the motion alone; what follows from them is kept.
            others: Positions of all other columns, and the columns, shape (K, p) each.
        """
        white = self.whitening.joint(j, np.column_stack([x for _, x in others]))
        at, own = _positions(s for s, _ in others), self._products(white, white)
        if not reused:
            return JointGram(at, own)
        fixed, gram = self._fixed(j, reused)
        scale = np.concatenate([np.full(r.columns.shape[1], r.factor) for r in reused])
        across = scale[:, None] * self._products(fixed, white)
        known = len(scale)
        blocks = np.empty((len(own), known + len(at), known + len(at)))
        blocks[:, :known, :known] = gram * np.outer(scale, scale)
        blocks[:, :known, known:] = across
        blocks[:, known:, :known] = across.transpose(0, 2, 1)
        blocks[:, known:, known:] = own
        return JointGram(np.concatenate([_positions(r.own for r in reused), at]), blocks)

    def _products(self, left: Array, right: Array) -> Array:
        """Return LᵀR of each block of time, shape (B, columns of L, columns of R)."""
        return np.stack([left[s].T @ right[s] for s in self.whitening.blocks])

    def _fixed(self, j: int, reused: list[_Reused]) -> tuple[Array, Array]:
        """Return whitened columns that depend on the motion alone, and their normal equations in each block.

        Args:
            j: Index of the joint.
            reused: The columns.

        Returns:
            Shapes (K, p) and (B, p, p).
        """
        key = (j, tuple(r.effect for r in reused))
        known = self._known.pop(key, None)
        if known is None or any(a is not b.columns.base for a, b in zip(known[0], reused, strict=True)):
            white = np.column_stack([self._white(j, r) for r in reused])
            gram = self._products(white, white)
            known = ([r.columns.base for r in reused], white, gram)
        self._known[key] = known
        while len(self._known) > MOST_KEPT * self.experiment.robot.n:
            self._known.pop(next(iter(self._known)))
        return known[1:]

    def _white(self, j: int, one: _Reused) -> Array:
        """Return the whitened columns of one effect, shape (K, p)."""
        known = self._whitened.get((j, one.effect))
        if known is None or known[0] is not one.columns.base:
            known = (one.columns.base, self.whitening.joint(j, one.columns))
            self._whitened[j, one.effect] = known
        return known[1]

    @cached_property
    def _known(self) -> dict[tuple[int, tuple[Effect, ...]], tuple[list[Array | None], Array, Array]]:
        return {}

    @cached_property
    def _whitened(self) -> dict[tuple[int, Effect], tuple[Array | None, Array]]:
        return {}


def _positions(parts: Iterable[slice]) -> NDArray[np.intp]:
    return np.concatenate([np.arange(s.start, s.stop) for s in parts])


@dataclass(frozen=True, eq=False)
class _Reused:
    """Columns of one effect on one joint that depend on the motion alone, up to a factor.

    Attributes:
        own: Positions of the parameters.
        effect: The effect.
        columns: The columns, a view of an array that is always the same, shape (K, p).
        factor: Factor [1].
    """

    own: slice
    effect: Effect
    columns: Array
    factor: float
