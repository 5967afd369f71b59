"""Evidence for effects of the whole arm: normal equations of all joints, with the columns of their own effects."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.healthy_arm import HealthyArm
from cdia_pin.diagnosis.joint_gram import TINY, symmetric
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.whole_arm import evidence_kernel
from cdia_pin.diagnosis.whole_arm.hypotheses import Hypothesis
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

LIGHTEST = (
    1e-3  # [1], least level of a joint over the largest of the arm; [N·m or N], least of the largest one
)


class ArmEvidence(Stateful):
    """Normal equations of [y z; r] for every joint: the bank's columns, the whole arm's columns, the remainder.

    Args:
        observer: Filters, remainder and columns of the joints' own effects.
        width: P, number of columns of the bank.
        hypotheses: Effects of the whole arm.
        healthy: What is known of the healthy arm.

    Attributes:
        gram: Gram matrices, upper triangles, shape (n, P + A + 1, P + A + 1).
        weight: Duration of the samples in them, old ones discounted [s], shape (n,).
        ends: First of the A columns of each hypothesis among those of [y z], and the last one's end.
        prior: Prior standard deviations of the A parameters, ``inf`` where nothing is known, shape (A,).
        unusual: Which hypotheses arms in use hardly ever have.
    """

    STATE = ("gram", "weight", "_rows", "_since", "_previous")
    DERIVED = ("_robot", "_on_regressors", "_used")

    def __init__(
        self, observer: MomentumObserver, width: int, hypotheses: Sequence[Hypothesis], healthy: HealthyArm
    ) -> None:
        self.observer, self.width, self.hypotheses = observer, width, tuple(hypotheses)
        self.level = np.maximum(healthy.level, LIGHTEST * max(float(healthy.level.max()), LIGHTEST))
        self.independent = healthy.independent
        self.ends = np.cumsum([width, *(h.shown for h in hypotheses)])
        size = int(self.ends[-1]) + 1
        self.gram = np.zeros((observer.nominal.robot.n, size, size))
        self.weight = np.zeros(observer.nominal.robot.n)
        self.prior = np.concatenate([h.prior_scale(observer.nominal.robot) for h in hypotheses])
        self.unusual = np.array([h.effect.plausibility.unusual for h in hypotheses])
        self._robot: RobotModel | None = None  # of the columns' matrix
        self._rows = np.zeros((observer.nominal.robot.n, size))
        self.stop()

    @property
    def is_active(self) -> bool:
        """Whether samples are collected."""
        return not np.isnan(self._since)

    @property
    def columns(self) -> Array:
        """Filtered columns of the whole arm's effects, shape (n, A)."""
        return self._rows[:, self.width : -1]

    def start(self, t: float) -> None:
        """Start to collect, from nothing.

        Args:
            t: Time [s].
        """
        self.stop()
        self._since = t

    def stop(self) -> None:
        """Collect no more."""
        self._since = np.nan
        self._previous: tuple[float, Array, Array] | None = None  # time, velocity, columns
        self.gram[:], self.weight[:] = 0.0, 0.0

    def add(self, t: float, q: Array, v: Array) -> None:
        """Add a sample.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
        """
        o, phi = self.observer, self._columns_at(q, v, t)
        last, _, last_phi = self._previous or (t, v, phi)
        dt = t - last
        evidence_kernel.add(
            self.gram,
            self.weight,
            self._rows,
            phi,
            last_phi,
            o.filtered,
            o.remainder,
            o.state.moving,
            o.bandwidth,
            t - self._since,
            dt,
            exp(-dt / o.settings.memory),
        )
        self._previous = (t, v.copy(), phi)

    def _columns_at(self, q: Array, v: Array, t: float) -> Array:
        """Return the torque per unit of each parameter of the whole arm's effects, shape (n, A)."""
        robot, before = self.observer.carried, self._previous
        if robot is not self._robot:
            self._robot = robot
            self._on_regressors = np.hstack([h.on_regressors(robot) for h in self.hypotheses])
            self._used = np.flatnonzero(self._on_regressors.any(axis=1))
        a = np.zeros_like(v) if before is None else (v - before[1]) / (t - before[0])
        bodies, gravity = robot.regressors(q, v, a)
        found: Array = evidence_kernel.columns(bodies, gravity, self._on_regressors, self._used)
        return found

    def forget(self, j: int) -> None:
        """Forget the samples of a joint.

        Args:
            j: The joint's index.
        """
        self.gram[j], self.weight[j] = 0.0, 0.0

    def rms(self, k: int, theta: Array) -> Array:
        """Return the RMS torque of a hypothesis over the collected samples [N·m or N], shape (n,); 0 without samples.

        Args:
            k: Index of the hypothesis.
            theta: Its parameters, shape (shown,).
        """
        columns = slice(int(self.ends[k]), int(self.ends[k + 1]))
        energy = [theta @ symmetric(gram)[columns, columns] @ theta for gram in self.gram]
        return np.sqrt(np.maximum(energy, 0.0) / np.maximum(self.weight, TINY))

    def shift(self, k: int, theta: Array) -> None:
        """Take the torque of a hypothesis out of the collected remainder.

        Args:
            k: Index of the hypothesis.
            theta: Its parameters, shape (shown,).
        """
        less = np.eye(self.gram.shape[1])
        less[int(self.ends[k]) : int(self.ends[k + 1]), -1] = -theta
        for j, gram in enumerate(self.gram):
            self.gram[j] = less.T @ symmetric(gram) @ less
