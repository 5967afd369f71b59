"""A designed motion: its samples, the limits that it keeps, and its gain."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.dynamics import Reference, Trajectory
from cdia_pin.excitation.excitation_documents import ExcitationJson, ExcitationRecord
from cdia_pin.excitation.limits import MotionLimits
from cdia_pin.logs.trajectories import write_joint_trajectory, write_motion
from cdia_pin.phrases import clipped
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

APART = 10.0  # standard deviations between two explanations [1] from which `discover` chooses the true one


@dataclass(frozen=True, repr=False)
class Gain:
    """What a motion shows, compared with another motion.

    Attributes:
        between: Labels of the two explanations; empty if parameters were asked for.
        before: Standard deviations between the two on the other motion [1]; 1 for parameters.
        after: Standard deviations between the two on the designed motion [1]; for parameters, the factor by which their
            standard deviations are smaller.
        seen: Number of combinations of parameters that any motion shows, and number of parameters.
        separable: For each of the two, True if a log shows it when the arm has it; if not, the other explains it too.
        beside: The other motion in words, ``on the logs given`` or ``on some motion within the limits``.
    """

    between: tuple[str, ...]
    before: float
    after: float
    seen: tuple[int, int]
    separable: tuple[bool, ...]
    beside: str

    def __repr__(self) -> str:
        if not self.between:
            return f"Gain(standard deviations {self.after:.3g} times smaller than {self.beside})"
        pair = " and ".join(clipped(name, 40) for name in self.between)
        return f"Gain({pair} {self.before:.3g} → {self.after:.3g} standard deviations apart)"

    @property
    def enough(self) -> bool:
        """True if a log of the motion separates the two explanations."""
        return not self.between or self.after >= APART


@dataclass(frozen=True, repr=False)
class Excitation:
    """The outcome of `excite`.

    Attributes:
        robot: The arm.
        trajectory: The motion as a function of time.
        time: Time of each sample [s], shape (N,).
        position: Positions [rad or m], shape (N, n).
        velocity: Velocities [rad/s or m/s], shape (N, n).
        acceleration: Accelerations [rad/s² or m/s²], shape (N, n).
        effort: Torques that the model predicts [N·m or N], shape (N, n).
        limits: Limits of the motion.
        clearance: Distance that links keep from each other and from the floor [m].
        floor: Height of the floor above the base's origin [m]; None without a floor.
        checked: Number of pairs of shapes that were checked for contact.
        gain: What the motion shows.
        warnings: Assumptions of the design, one sentence each.
        record: Settings and version, enough to design the motion again.
    """

    robot: RobotModel
    trajectory: Trajectory
    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    effort: Array
    limits: MotionLimits
    clearance: float
    floor: float | None
    checked: int
    gain: Gain
    warnings: tuple[str, ...]
    record: ExcitationRecord

    def __repr__(self) -> str:
        size = f"{self.time[-1]:g} s at {(len(self.time) - 1) / self.time[-1]:.4g} Hz"
        return f"Excitation({clipped(self.robot.name, 30)}, {size}; {self.gain!r})"

    @property
    def joints(self) -> tuple[str, ...]:
        """Joint names, in the order of the columns."""
        return self.robot.joints

    @property
    def reference(self) -> Reference:
        """Positions, velocities and accelerations of all samples."""
        return Reference(self.position, self.velocity, self.acceleration)

    def peaks(self) -> dict[str, Array]:
        """Return the smallest and largest position, and the largest absolute value of all else, shape (n,) each."""
        return {
            "lower": self.position.min(axis=0),
            "upper": self.position.max(axis=0),
            "velocity": np.abs(self.velocity).max(axis=0),
            "acceleration": np.abs(self.acceleration).max(axis=0),
            "effort": np.abs(self.effort).max(axis=0),
        }

    def to_csv(self, path: str | Path) -> Path:
        """Write time, position, velocity, acceleration and predicted effort of every sample.

        Args:
            path: File to write.

        Raises:
            LogError: If the file cannot be written.
        """
        signals = {
            "position": self.position,
            "velocity": self.velocity,
            "acceleration": self.acceleration,
            "effort": self.effort,
        }
        return write_motion(path, self.joints, self.time, signals)

    def to_ros(self, path: str | Path, rate: float = 50.0) -> Path:
        """Write a ``trajectory_msgs/JointTrajectory`` as YAML.

        Args:
            path: File to write.
            rate: Largest number of points per second [Hz]; controllers interpolate.

        Raises:
            LogError: If the file cannot be written.
        """
        duration = float(self.time[-1])
        time = np.linspace(0.0, duration, max(2, int(np.ceil(duration * rate)) + 1))
        return write_joint_trajectory(path, self.joints, time, *self.trajectory(time))

    def to_dict(self) -> ExcitationJson:
        """Return the JSON of schema ``cdia-excitation/1``; the samples are in the CSV file."""
        peaks, limits = self.peaks(), self.limits
        allowed = {name: getattr(limits, name) for name in peaks}
        return {
            "schema": schemas.EXCITATION,
            "robot": self.robot.name,
            "joints": list(self.joints),
            "duration": float(self.time[-1]),
            "limits": {
                joint: {
                    name: {"peak": float(peaks[name][j]), "limit": float(allowed[name][j])} for name in peaks
                }
                for j, joint in enumerate(self.joints)
            },
            "start": self.robot.by_joint(self.position[0]),
            "collisions": {"clearance": self.clearance, "floor": self.floor, "pairs": self.checked},
            "gain": {
                "between": list(self.gain.between),
                "before": self.gain.before,
                "after": self.gain.after,
                "enough": self.gain.enough,
                "seen": {"combinations": self.gain.seen[0], "parameters": self.gain.seen[1]},
            },
            "warnings": list(self.warnings),
            "record": self.record,
        }
