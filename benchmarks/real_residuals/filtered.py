"""A log along its filtered motion, on which an inserted effect is computed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from cdia_pin.effects import State
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.derivatives import zero_phase
from cdia_pin.regression.experiment import Experiment, Segment
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]

LEAST_TRAVEL = 0.05  # [rad or m], standard deviation of a position from which a joint counts as moving


@dataclass(frozen=True)
class FilteredLog:
    """A measured log with its filtered motion.

    Attributes:
        log: As it was measured.
        experiment: Its filtered motion, and the torque that is compared.
    """

    log: Log
    experiment: Experiment

    @classmethod
    def of(cls, log: Log, robot: RobotModel) -> FilteredLog:
        """Filter a log as the program does."""
        return cls(log, Experiment.of(robot, [condition(log, robot)]))

    @property
    def segment(self) -> Segment:
        """The one log of the experiment."""
        return self.experiment.segments[0]

    @property
    def robot(self) -> RobotModel:
        """The arm."""
        return self.segment.state.robot

    @cached_property
    def state(self) -> State:
        """The filtered motion under the measured torque, filtered twice: noise of a sensor loads no joint."""
        motion = self.segment.motion
        return self.segment.state.with_effort(
            zero_phase(motion.effort, motion.record["motion_cutoff"], motion.rate)
        )

    @cached_property
    def state_of_log(self) -> State:
        """The same at the times of the log, where a step of friction is one: no part of the program smooths it."""
        x, time = self.state, self.segment.motion.time
        at = np.clip(self.log.time, time[0], time[-1])
        q, v, a, effort = (CubicSpline(time, s)(at) for s in (x.q, x.v, x.a, x.effort))
        warmth = (
            None
            if x.temperature is None
            else np.column_stack([np.interp(at, time, s) for s in x.temperature.T])
        )
        return replace(x, q=q, v=v, a=a, effort=effort, time=at, temperature=warmth, sampled_every=0.0)

    @cached_property
    def torque_rms(self) -> Array:
        """RMS of the measured torque, filtered [N·m or N], shape (n,)."""
        return rms(self.segment.measured)

    @cached_property
    def fast(self) -> Array:
        """Speed that each joint exceeds in a twentieth of the time [rad/s or m/s], shape (n,)."""
        return np.percentile(np.abs(self.state.v), 95, axis=0)

    @cached_property
    def moving(self) -> NDArray[np.bool_]:
        """Which joints move, shape (n,)."""
        return np.asarray(self.state.q.std(axis=0) >= LEAST_TRAVEL)

    @cached_property
    def rigid_share(self) -> Array:
        """RMS torque of the URDF's rigid bodies over the measured one [1], shape (n,)."""
        rigid = self.segment.motion.compared(self.state.rigid_torque)
        return rms(rigid) / np.maximum(self.torque_rms, 1e-12)

    def size(self, torque: Array) -> Array:
        """Return the RMS of a torque of the motion as it is compared [N·m or N], shape (n,).

        Args:
            torque: Along the filtered motion [N·m or N], shape (N, n).
        """
        return rms(self.segment.motion.compared(torque))


def rms(signal: Array) -> Array:
    """Return the root mean square of each column."""
    return np.asarray(np.sqrt(np.mean(signal**2, axis=0)))
