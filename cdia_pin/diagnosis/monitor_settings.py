"""Settings of the engine `momentum`."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from cdia_pin.errors import ModelError
from cdia_pin.phrases import settings_repr


@dataclass(frozen=True, repr=False)
class MonitorSettings:
    """How quickly and how cautiously a monitor decides and corrects.

    Attributes:
        bandwidth: γ of the residuals' filter [1/s]; a higher one is faster and lets more noise through. Joints with
            noisy sensors get a lower one from the healthy runs.
        slowest: Least γ to which noise may lower a joint's filter [1/s].
        sensitivity: Threshold over RMS torque [1], above which γ is lowered.
        margin: Threshold over the largest residual of the healthy runs [1].
        noise_margin: Least threshold over the RMS residual of the healthy runs [1]; white noise passes it once in
            some hundred hours.
        debounce: Ticks in a row beyond the threshold that make a detection.
        calibrate: Whether inertial parameters are corrected by the healthy runs.
        memory: Time after which a sample counts 1/e in a decision [s].
        decide_every: Time between decisions of a joint [s].
        votes: Decisions in a row that must agree.
        tolerance: RMS residual that a combination may leave, over the healthy level [1].
        mismatch: Share of a fault that its formula need not explain [1].
        price: Penalty of each parameter, and of each effect after the first: log-likelihood that it must gain [1].
        lead: Log-likelihood by which a combination must lead to be the only explanation [1].
        most_effects: Largest number of effects that may appear on a joint at once.
        ambiguous_after: Time after detection at which equal combinations are reported as ambiguous [s].
        unknown_after: Time after detection at which a fault that no combination explains is called unknown [s].
        gone_after: Time without a fault's torque, where it would show, after which it counts as cleared [s].
        false_alarm_every: Mean time between two false alarms of the second detector, for faults that last [s].
        neurons: Radial basis functions per joint in position, and as many of damping in one place; over the usual 4 rad
            of a joint they show what repeats every 0.6 rad.
        velocity_neurons: Radial basis functions per joint in velocity; many, since what a joint does at one speed
            alone, such as a resonance, spans a few hundredths of its range.
        accommodate: Whether `Status.torque_correction` and `Monitor.correct` correct anything.
        gain_floor: Least 1 + h by which the torque of a weak drive is divided [1].
        soft_sign: Speed below which dry friction is compensated only in part [rad/s or m/s].
    """

    bandwidth: float = 30.0
    slowest: float = 8.0
    sensitivity: float = 0.05
    margin: float = 1.3
    noise_margin: float = 6.0
    debounce: int = 2
    calibrate: bool = True
    memory: float = 4.0
    decide_every: float = 0.05
    votes: int = 10
    tolerance: float = 1.5
    mismatch: float = 0.02
    price: float = 3.0
    lead: float = 3.0
    most_effects: int = 3
    ambiguous_after: float = 2.0
    unknown_after: float = 2.5
    gone_after: float = 0.15
    false_alarm_every: float = 36000.0
    neurons: int = 21
    velocity_neurons: int = 41
    accommodate: bool = True
    gain_floor: float = 0.1
    soft_sign: float = 0.02

    def __post_init__(self) -> None:
        for f in fields(self):
            value = getattr(self, f.name)
            if f.type != "bool" and not 0 < value < np.inf:
                raise ModelError(f"monitor settings: {f.name} must be above 0, given {value}")

    __repr__ = settings_repr
