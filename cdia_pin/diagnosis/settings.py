"""Settings of the engine `momentum`, with the reason for each default."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from cdia_pin.errors import ModelError


@dataclass(frozen=True)
class MonitorSettings:
    """How quickly, how surely and how boldly a monitor acts.

    Attributes:
        bandwidth: γ of the residuals' filter [1/s]; higher is faster, and lets more noise through. Joints whose
            sensors are too noisy for it get a lower one from the healthy runs.
        slowest: Least γ that noise may force upon a joint [1/s].
        sensitivity: Threshold over RMS torque that γ is lowered for [1].
        margin: Threshold over the largest residual of the healthy runs [1].
        noise_margin: Least threshold over the RMS residual of the healthy runs [1]; what white noise passes
            once in some hundred hours.
        debounce: Ticks in a row beyond the threshold that make a detection.
        calibrate: Whether inertial parameters are corrected by the healthy runs.
        memory: Time after which a sample counts 1/e in a decision [s].
        decide_every: Time between decisions of a joint [s].
        votes: Decisions in a row that must agree.
        tolerance: How far beyond the healthy level a hypothesis may leave a residual [1].
        mismatch: Share of a fault that its formula need not explain [1].
        price: Log-likelihood that an effect must gain for each of its parameters [1].
        lead: Log-likelihood by which a hypothesis must lead to be the only one [1].
        most_effects: Largest number of effects that may appear on a joint at once.
        ambiguous_after: Time after detection when equal hypotheses are reported as such [s].
        unknown_after: Time after detection when what nothing explains is called unknown [s].
        gone_after: Time without a fault's torque, where it would show, after which it is dropped [s].
        neurons: Radial basis functions per joint, in position and in velocity each.
        accommodate: Whether `Status.torque_correction` and `Monitor.correct` correct anything.
        gain_floor: Least 1 + h that a weak drive is divided by [1].
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
    neurons: int = 7
    accommodate: bool = True
    gain_floor: float = 0.1
    soft_sign: float = 0.02

    def __post_init__(self) -> None:
        for f in fields(self):
            value = getattr(self, f.name)
            if f.type != "bool" and not 0 < value < np.inf:
                raise ModelError(f"monitor settings: {f.name} must be above 0, given {value}")
