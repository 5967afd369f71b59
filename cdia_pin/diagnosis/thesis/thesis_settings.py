"""What a user may choose about the thesis' scheme."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from cdia_pin.diagnosis.thesis.basis import Neurons
from cdia_pin.diagnosis.thesis.gains import Gains, ScaledGains
from cdia_pin.diagnosis.thesis.threshold import THRESHOLDS
from cdia_pin.errors import ModelError, unknown_name


@dataclass(frozen=True)
class ThesisSettings:
    """Settings of `ThesisEngine`.

    Attributes:
        gamma: γ of every observer and filter, one number or one per joint [1/s].
        unmodelled: η₀, bound of the unmodelled torque, one per joint [N·m or N]; learned from healthy runs if
            omitted.
        unmodelled_margin: η₀ over the largest that healthy runs showed, where it is learned [1].
        threshold: Form of the detection threshold, ``dynamic`` or ``time-varying`` ([Thesis] §3.3).
        confirm: Samples in a row beyond the threshold that make a fault.
        neurons: k in position, and k in velocity, per joint; or the neurons themselves. Few and wide ones
            learn sooner than they are left behind; with 7 the accommodated SCARA tracked two to seven times worse.
        observer_gains: How the observer's neurons adapt.
        filter_gains: How the parameters of the isolation filters adapt.
        equivalence: μ̃, what a filter may be wrong by, as a share of sup |M⁻¹| η₀ [1]. The thesis defines it by
            the unknown true parameters, which makes its threshold circular: here it is a tolerance.
        grace: Time after detection in which no filter is excluded [s]. The thesis has none; without, a true
            filter is excluded for what it has not learned yet.
        shortest_isolation: Soonest decision after detection [s].
        longest_isolation: Time after which several survivors are called ambiguous [s].
        readapt: Time that isolated effects have to follow before a second fault is declared [s].
        accommodate: Whether torques are corrected.
        smallest_gain: ε, smallest |1 + h| by which a torque is divided [1] ([Thesis] §3.6).
        idle_torque: Torque of an effect that counts as absent, over η₀ [1].
        idle_time: t_pr, how long it must stay below that [s].
        sign_width: Speed below which sgn q̇ is smoothed [rad/s or m/s].
        longest_step: Longest gap between samples that may be bridged [s].
    """

    gamma: float | tuple[float, ...] = 100.0
    unmodelled: tuple[float, ...] | None = None
    unmodelled_margin: float = 1.3
    threshold: str = "dynamic"
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
