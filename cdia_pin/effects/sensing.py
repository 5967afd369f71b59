"""Signals that do not say what they should: an encoder's zero, a late torque."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.nonlinear_effect import NonlinearEffect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Channel, Signal, Traits
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

LATEST = 0.1  # [s], by which a reading is late or early at most: more than any drive or network has, as in `check_lag`


@dataclass(frozen=True)
class EncoderOffset(NonlinearEffect):
    """The joint is not where its encoder says, q = q_read + δ; f is the torque that the model misses by it.

    A model evaluates all its other effects at q; a simulation moves at q and reads q − δ. The effect's own
    `torque` is what the rigid body alone misses.

    Attributes:
        joint: Name of the joint.
    """

    joint: str

    name: ClassVar[str] = "encoder_offset"
    equation: ClassVar[str] = "ID(q) − ID(q + δ)"
    scope_fields: ClassVar[tuple[str, ...]] = ("joint",)
    traits: ClassVar[Traits] = Traits(
        {Signal.POSITION, Signal.VELOCITY, Signal.ACCELERATION}, Channel.POSITION_READING, linear=False
    )
    parameters = (Parameter("offset", "{position}", lower=-0.5, upper=0.5),)
    steps: ClassVar[tuple[float, ...]] = (1e-5,)

    def torque(self, x: State, theta: Array) -> Array:
        """Return f [N·m or N] for the offset θ = (δ,), shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: δ [rad or m], shape (1,).
        """
        return x.rigid_torque - x.rigid.at(x.q + self.shift(x, theta)).torque

    def shift(self, x: State, theta: Array) -> Array:
        """Return δ at the joint and zero elsewhere [rad or m], alike at all samples, shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: δ [rad or m], shape (1,).
        """
        return np.tile(self.offset(x.robot, theta), (len(x), 1))

    def offset(self, robot: RobotModel, theta: Array) -> Array:
        """Return δ of θ = (δ,) at the joint and zero elsewhere [rad or m], shape (n,).

        Args:
            robot: The arm, n joints.
            theta: δ [rad or m], shape (1,).
        """
        out = np.zeros(robot.n)
        out[robot.joint_index(self.joint)] = theta[0]
        return out

    @classmethod
    def scopes(cls, robot: RobotModel) -> Iterator[tuple[str, ...]]:
        """Yield every joint.

        Args:
            robot: The arm, n joints.
        """
        yield from ((j,) for j in robot.joints)


@dataclass(frozen=True)
class EffortDelay(NonlinearEffect):
    """The torque reading lags, τ_read(t) = τ(t − d), f = τ(t) − τ(t − d); d < 0 where it leads.

    A command that is logged before it acts reads as a leading torque. The effect needs a trajectory: on a
    single sample it is zero.

    Attributes:
        joint: Name of the joint, or None where all readings lag alike.
    """

    joint: str | None = None

    name: ClassVar[str] = "effort_delay"
    equation: ClassVar[str] = "τ(t) − τ(t − d)"
    traits: ClassVar[Traits] = Traits({Signal.TORQUE, Signal.TIME}, Channel.TORQUE_READING, linear=False)
    scope_fields: ClassVar[tuple[str, ...]] = ("joint",)
    parameters = (Parameter("delay", "s", lower=-LATEST, upper=LATEST),)
    steps: ClassVar[tuple[float, ...]] = (1e-4,)

    def torque(self, x: State, theta: Array) -> Array:
        """Return f [N·m or N] for the delay θ = (d,), shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: d [s], shape (1,).
        """
        return self.torques(x, x.effort[:, :, None], theta)[:, :, 0]

    def torques(self, x: State, efforts: Array, theta: Array) -> Array:
        """Return f of several torques for the delay θ = (d,) [N·m or N], shape (N, n, k).

        Args:
            x: The motion, N samples; its ``effort`` is not used.
            efforts: The torques [N·m or N], shape (N, n, k).
            theta: d [s], shape (1,).
        """
        (out,) = self._late(x, efforts, [float(theta[0])])
        return out

    def jacobian(self, x: State, theta: Array) -> Array:
        """Return ∂f/∂d by a central difference, shape (N, n, 1).

        Args:
            x: Motion and torques, N samples.
            theta: d [s], shape (1,).
        """
        (step,) = self.steps
        later, earlier = self._late(x, x.effort[:, :, None], [float(theta[0]) + step, float(theta[0]) - step])
        return np.asarray((later - earlier) / (2 * step))

    def _late(self, x: State, efforts: Array, delays: Sequence[float]) -> list[Array]:
        """Return f for each of some delays [s]: torques are interpolated once and held at both ends, (N, n, k) each."""
        from scipy.interpolate import CubicSpline

        out = [np.zeros_like(efforts) for _ in delays]
        if len(x) < 4 or np.ptp(x.time) == 0 or not any(delays):
            return out
        joints = [j for j in self.acts_on(x.robot) if efforts[:, j].any()]
        effort = efforts[:, joints]
        along = CubicSpline(x.time, effort)
        for f, delay in zip(out, delays, strict=True):
            if delay:
                f[:, joints] = effort - along(np.clip(x.time - delay, x.time[0], x.time[-1]))
        return out

    def acts_on(self, robot: RobotModel) -> tuple[int, ...]:
        """Return the index of the joint, or of all joints.

        Args:
            robot: The arm, n joints.
        """
        return tuple(range(robot.n)) if self.joint is None else (robot.joint_index(self.joint),)

    @classmethod
    def scopes(cls, robot: RobotModel) -> Iterator[tuple[str, ...]]:
        """Yield the whole arm: a search does not ask whether one drive alone is late.

        Args:
            robot: The arm, n joints.
        """
        yield ()
