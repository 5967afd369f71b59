"""Why a sample cannot be, in words."""

from __future__ import annotations

import numpy as np

from cdia_pin.diagnosis import sample_codes as codes
from cdia_pin.diagnosis.sensor_fault import SensorSignal

SIGNALS = (SensorSignal.POSITION, SensorSignal.VELOCITY, SensorSignal.TORQUE, SensorSignal.TIME)


def why_bad(code: int, joint: str, value: float, last: float, t: float) -> str:
    """Return why a sample cannot be, in words.

    Args:
        code: One of `sample_codes`.
        joint: Name of the joint that it is about.
        value: Value of the signal there [rad, rad/s, N·m, …].
        last: Time of the last good sample [s].
        t: Time of the sample [s].
    """
    kind, signal = codes.kind_of(code), SIGNALS[codes.signal_of(code)]
    beyond = ", beyond what the arm can do" if np.isfinite(value) else ""
    return {
        codes.TIME_IMPOSSIBLE: f"the time of a sample is {t:g} s",
        codes.TIME_BACK: f"time goes from {last:.6g} s to {t:.6g} s",
        codes.TIME_TWICE: f"time goes from {last:.6g} s to {t:.6g} s",
        codes.GAP: f"no sample from {last:.6g} s to {t:.6g} s",
        codes.OUTSIDE: f"{signal} of {joint} is {value:.4g}{beyond}",
        codes.JUMP: f"{signal} of {joint} jumps as no motion does",
        codes.ZEROED: f"{signal} of all joints is 0 at once",
        codes.FROZEN: f"{signal} of {joint} stays the same while the arm moves",
        codes.kind_of(codes.DISAGREE): f"position and velocity of {joint} contradict each other",
    }[kind]
