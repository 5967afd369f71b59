"""Information of a motion: the normal equations that a log of the motion would have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics, Trajectory
from cdia_pin.effects import Effect
from cdia_pin.logs.conditioning import MOTION_OVERSAMPLING, TORQUE_OVERSAMPLING, Motion
from cdia_pin.logs.motion import MotionRecord
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.scaled_gram import ScaledGram
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

CUTOFF = 4.0  # cut-off of the filter for planned motions [Hz]
SAMPLES_PER_SECOND = 50.0  # independent torque samples that a log gives [Hz], after its filter
RANK_CUTOFF = 1e-12  # eigenvalues of scaled normal equations, over the largest [1], that count as zero
# Least RMS torque over that of the most loaded joint [1], because a lightly loaded joint has noise too.
QUIETEST = 0.02


@dataclass(frozen=True, repr=False)
class Information:
    """Normal equations of effects along a motion, in variances of the noise.

    Attributes:
        effects: The effects.
        gram: XᵀX of their whitened columns, shape (P, P).
    """

    effects: tuple[Effect, ...]
    gram: Array

    def __repr__(self) -> str:
        return f"Information({len(self.effects)} effects, {len(self.gram)} parameters)"

    @classmethod
    def along(
        cls, experiment: Experiment, model: Dynamics, effects: Sequence[Effect], noise: Array
    ) -> Information:
        """Compute the normal equations along a motion.

        Args:
            experiment: A planned motion, or conditioned logs.
            model: The model as it is known; its own effects are differentiated at their parameters.
            effects: The effects; the model's own may be among them.
            noise: Standard deviation of an independent torque sample [N·m or N], shape (n,).
        """
        prediction = experiment.predict(model)
        present = {t.effect: np.array(t.theta) for t in model.terms}
        parameters = ParameterBlocks.of(effects)
        per_joint: list[list[tuple[Array, Array]]] = [[] for _ in range(experiment.robot.n)]
        for effect, own in zip(effects, parameters, strict=True):
            x = experiment.columns(effect, prediction, present.get(effect))
            for i, j in enumerate(effect.acts_on(experiment.robot)):
                per_joint[j].append((np.arange(own.start, own.stop), x[:, i, :]))
        rates = [s.motion.rate / s.motion.decimation for s in experiment.segments]
        weight = np.repeat(np.sqrt(SAMPLES_PER_SECOND / np.array(rates)), experiment.lengths)
        gram = np.zeros((parameters.total,) * 2)
        for j, parts in enumerate(per_joint):
            if parts:
                at = np.concatenate([columns for columns, _ in parts])
                used = weight * experiment.informative[:, j] / noise[j]
                x = np.column_stack([values for _, values in parts]) * used[:, None]
                gram[np.ix_(at, at)] += x.T @ x
        return cls(tuple(effects), gram)

    def columns(self, effects: Sequence[Effect]) -> NDArray[np.intp]:
        """Return the positions of the parameters of some of the effects.

        Args:
            effects: Some of the effects.

        Returns:
            Shape (p,).
        """
        at = {e: k for k, e in enumerate(self.effects)}
        return ParameterBlocks.of(self.effects).indices([at[e] for e in effects])

    def unexplained(self, hidden: Sequence[Effect], others: Sequence[Effect], precision: Array) -> Array:
        """Return the part of hidden effects that other effects cannot explain.

        It is the Schur complement S: parameters θ of the hidden effects leave a sum of squares θᵀ S θ.

        Args:
            hidden: Effects that the arm has.
            others: Effects that are fitted in their place.
            precision: Precision of the prior on the others' parameters [1/unit²], shape (number of them,).

        Returns:
            S, shape (p, p).
        """
        a, b = self.columns(hidden), self.columns(others)
        cross = self.gram[np.ix_(b, a)]
        own = self.gram[np.ix_(b, b)] + np.diag(precision)
        explained = cross.T @ ScaledGram.of(own).pseudo_inverse(RANK_CUTOFF) @ cross
        return self.gram[np.ix_(a, a)] - explained


def planned(robot: RobotModel, *trajectories: Trajectory, cutoff: float = CUTOFF) -> Experiment:
    """Return planned motions as an experiment, as if logs of them had been conditioned.

    Args:
        robot: The arm.
        *trajectories: The motions.
        cutoff: Cut-off of the filter [Hz].
    """
    rate = MOTION_OVERSAMPLING * cutoff
    decimation = max(1, int(rate / (TORQUE_OVERSAMPLING * cutoff)))
    motions = []
    for k, trajectory in enumerate(trajectories):
        time = np.arange(0.0, trajectory.duration, 1.0 / rate)
        q, v, a = trajectory(time)
        motions.append(
            Motion(
                joints=robot.joints,
                time=time,
                q=q,
                v=v,
                a=a,
                effort=np.zeros_like(q),
                rate=rate,
                cutoff=cutoff,
                decimation=decimation,
                speed_noise=np.zeros(robot.n),
                acceleration_noise=np.zeros(robot.n),
                effort_step=np.zeros(robot.n),
                record=_record(f"planned {k}", rate, cutoff, decimation),
            )
        )
    return Experiment.of(robot, motions)


def _record(condition: str, rate: float, cutoff: float, decimation: int) -> MotionRecord:
    return MotionRecord(
        cutoff=cutoff,
        motion_cutoff=rate / 2,
        trim=0.0,
        source="planned",
        condition=condition,
        sha256="",
        log_rate=rate,
        motion_rate=rate,
        compared_rate=rate / decimation,
        velocity="planned",
        acceleration_drowned=[],
        notes=[],
    )


def torque_rms(experiment: Experiment, model: Dynamics) -> Array:
    """Return the RMS torque of a model along a motion, at least a share of that of the most loaded joint.

    Args:
        experiment: The motion.
        model: The model.

    Returns:
        In N·m or N, shape (n,).
    """
    torques = np.vstack([t.actuator for t in experiment.predict(model).torques])
    size = rms(torques, np.ones(torques.shape, bool))
    slides = experiment.robot.is_prismatic
    for kind in (slides, ~slides):
        size[kind] = np.maximum(size[kind], QUIETEST * size[kind].max(initial=0.0))
    return np.maximum(size, 1e-9)
