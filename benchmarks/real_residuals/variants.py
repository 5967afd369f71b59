"""The same log, recorded otherwise: what it says of the arm stays as it is."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum

import numpy as np

from cdia_pin.logs import Log
from cdia_pin.logs.derivatives import uniform, zero_phase

WIDEST = 100.0  # [Hz], bandwidth above which a recorded torque says nothing of an arm
SLOWER = 0.75  # [1], rate of a resampled log over its own
BELOW_NYQUIST = 0.4  # [1], bandwidth of a resampled torque over its rate


class Variant(StrEnum):
    """What is done to a log."""

    NONE = ""
    HALF_BANDWIDTH = "torque filtered at half its bandwidth"
    RESAMPLED = "resampled"


def varied(log: Log, variant: Variant) -> Log:
    """Return a log recorded otherwise.

    Args:
        log: The log.
        variant: What is done to it.
    """
    if variant is Variant.NONE:
        return log
    even = uniform(log)
    if variant is Variant.HALF_BANDWIDTH:
        half = min(WIDEST, even.rate / 2) / 2
        return replace(even, effort=zero_phase(even.effort, half, even.rate))
    return _resampled(even, SLOWER * even.rate)


def _resampled(even: Log, rate: float) -> Log:
    from scipy.interpolate import Akima1DInterpolator

    time = np.arange(even.time[0], even.time[-1], 1.0 / rate)
    slow = zero_phase(even.effort, BELOW_NYQUIST * rate, even.rate)
    effort = np.column_stack([np.interp(time, even.time, column) for column in slow.T])
    position = np.asarray(Akima1DInterpolator(even.time, even.position, axis=0)(time))
    return replace(even, time=time, position=position, effort=effort, velocity=None)
