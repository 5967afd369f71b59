"""Settings of the engine `thesis`."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.thesis.basis import Neurons
from cdia_pin.diagnosis.thesis.gains import Gains, ScaledGains
from cdia_pin.diagnosis.thesis.threshold import THRESHOLDS, ThresholdForm
from cdia_pin.errors import ModelError, unknown_name
from cdia_pin.phrases import settings_repr
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class ThesisSettings:
    """Settings of `ThesisEngine`.

    Attributes:
        gamma: γ of every observer and filter, one number or one per joint [1/s].
        unmodelled: η₀, bound of the unmodelled torque, one number per joint [N·m or N]; learned from healthy runs
            if omitted.
        unmodelled_margin: η₀ over the largest value that healthy runs showed, where it is learned [1].
        threshold: Form of the detection threshold, ``dynamic`` or ``time-varying`` ([Thesis] §3.3).
        confirm: Samples in a row beyond the threshold that make a detection.
        neurons: k neurons in position, and k in velocity, per joint; or the neurons themselves. Few and wide ones
            learn before the motion leaves them; with 7 the accommodated SCARA tracked two to seven times worse.
        observer_gains: Adaptation law of the observer's neurons.
        filter_gains: Adaptation law of the isolation filters' parameters.
        equivalence: μ̃, error that a filter may have, as a share of sup |M⁻¹| η₀ [1]. The thesis defines it by the
            unknown true parameters, which makes its threshold circular; here it is a tolerance.
        grace: Time after detection in which no filter is excluded [s]. The thesis has none; without it, a true
            filter is excluded before it has learned.
        shortest_isolation: Shortest time from detection to a decision [s].
        longest_isolation: Time after detection at which several survivors are called ambiguous [s].
        readapt: Time in which isolated effects may adapt before a second fault is detected [s].
        accommodate: Whether torques are corrected.
        smallest_gain: ε, least |1 + h| by which a torque is divided [1] ([Thesis] §3.6).
        idle_torque: Torque over η₀ below which an effect counts as absent [1].
        idle_time: t_pr, how long the torque must stay below it, for the fault to count as cleared [s].
        sign_width: Speed below which sgn q̇ is smoothed [rad/s or m/s].
        longest_step: Longest gap between samples that may be bridged [s].
    """

    gamma: float | tuple[float, ...] = 100.0
    unmodelled: tuple[float, ...] | None = None
    unmodelled_margin: float = 1.3
    threshold: str = ThresholdForm.DYNAMIC
    confirm: int = 2
    neurons: int | Neurons = 4
    observer_gains: Gains = field(default_factory=ScaledGains)
    filter_gains: Gains = field(default_factory=ScaledGains)
    equivalence: float = 1.0
    grace: float = 0.0
    shortest_isolation: float = 1.0
    longest_isolation: float = 4.0
    readapt: float = 0.5
    accommodate: bool = True
    smallest_gain: float = 0.1
    idle_torque: float = 2.0
    idle_time: float = 1.0
    sign_width: float = 0.01
    longest_step: float = 0.05

    def __post_init__(self) -> None:
        for name in ("gamma", "unmodelled_margin", "smallest_gain", "sign_width", "longest_step"):
            if not np.all(np.asarray(getattr(self, name)) > 0):
                raise ModelError(f"{name} must be above 0, given {getattr(self, name)}")
        for name in ("equivalence", "grace", "shortest_isolation", "readapt", "idle_torque", "idle_time"):
            if not 0 <= getattr(self, name) < np.inf:
                raise ModelError(f"{name} must be 0 or more, given {getattr(self, name)}")
        if self.longest_isolation < self.shortest_isolation:
            raise ModelError(
                f"longest_isolation must not be below shortest_isolation, given {self.longest_isolation:g} s and "
                f"{self.shortest_isolation:g} s"
            )
        if self.confirm < 1 or (isinstance(self.neurons, int) and self.neurons < 2):
            raise ModelError(f"confirm ≥ 1 and neurons ≥ 2 are needed, given {self.confirm}, {self.neurons}")
        if self.threshold not in THRESHOLDS:
            raise ModelError(unknown_name("threshold", self.threshold, THRESHOLDS))

    __repr__ = settings_repr


def per_joint(robot: RobotModel, name: str, given: float | tuple[float, ...]) -> Array:
    """Return a setting as one number per joint, shape (n,).

    Args:
        robot: The arm.
        name: Name of the setting, for the message.
        given: One number, or one per joint.

    Raises:
        ModelError: If the number of values does not fit the robot, or one is not above 0.
    """
    value = np.array(given, dtype=np.float64)
    if value.shape not in {(), (robot.n,)} or not (np.isfinite(value).all() and (value > 0).all()):
        raise ModelError(
            f"{name} must be above 0, one number or one for each of {', '.join(robot.joints)}, given {given}"
        )
    return np.broadcast_to(value, (robot.n,)).copy()
