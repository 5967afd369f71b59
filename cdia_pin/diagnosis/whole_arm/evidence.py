"""Evidence for effects of the whole arm: normal equations of all joints, with the columns of their own effects."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.healthy_arm import HealthyArm
from cdia_pin.diagnosis.kernels import MOVING_SHARE
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.whole_arm.hypotheses import Hypothesis
from cdia_pin.effects import State

Array = NDArray[np.float64]

LIGHTEST = (
    1e-3  # [1], least level of a joint over the largest of the arm; [N·m or N], least of the largest one
)
SETTLED = 2.0  # [1], time constants until the start of a filter is forgotten, which is the present columns


class ArmEvidence(Stateful):
    """Normal equations of [y z; r] for every joint: the bank's columns, the whole arm's columns, the remainder.

    Args:
        observer: Filters, remainder and columns of the joints' own effects.
        width: P, number of columns of the bank.
        hypotheses: Effects of the whole arm.
        healthy: What is known of the healthy arm.

    Attributes:
        gram: Gram matrices, shape (n, P + A + 1, P + A + 1).
        weight: Duration of the samples in them, old ones discounted [s], shape (n,).
        ends: First of the A columns of each hypothesis among those of [y z], and the last one's end.
    """

    STATE = ("gram", "weight", "_rows", "_since", "_previous")

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
        self._no_effort = np.zeros(observer.nominal.robot.n)
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
        o, before = self.observer, self._previous
        dt = 0.0 if before is None else t - before[0]
        a = np.zeros_like(v) if before is None else (v - before[1]) / dt
        x = State.of(o.carried, q, v, a, effort=self._no_effort)  # no effect of the whole arm reads it
        phi = np.concatenate([h.columns(x) for h in self.hypotheses], axis=1)
        if before is None:
            self.columns[:] = phi
        else:
            E = np.exp(-o.bandwidth * dt)[:, None]
            self.columns[:] = E * self.columns + (1.0 - E) * 0.5 * (phi + before[2])
        self._previous = (t, v.copy(), phi)
        self._rows[:, : self.width] = o.filtered[:, : self.width]
        self._rows[:, -1] = o.remainder
        counts = (o.state.moving > MOVING_SHARE) & (t - self._since > SETTLED / o.bandwidth)
        forget = np.where(counts, np.exp(-dt / o.settings.memory), 1.0)
        rows = self._rows * counts[:, None]
        self.gram *= forget[:, None, None]
        self.gram += dt * rows[:, :, None] * rows[:, None, :]
        self.weight[:] = forget * self.weight + dt * counts

    def forget(self, j: int) -> None:
        """Forget the samples of a joint.

        Args:
            j: The joint's index.
        """
        self.gram[j], self.weight[j] = 0.0, 0.0

    def shift(self, k: int, theta: Array) -> None:
        """Take the torque of a hypothesis out of the collected remainder.

        Args:
            k: Index of the hypothesis.
            theta: Its parameters, shape (shown,).
        """
        less = np.eye(self.gram.shape[1])
        less[int(self.ends[k]) : int(self.ends[k + 1]), -1] = -theta
        self.gram[:] = less.T @ self.gram @ less
