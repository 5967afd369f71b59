"""Resampling of a log to another rate: without aliases, or with the noise that a slower recorder would have kept."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cdia_pin.logs.derivatives import sampled_at, uniform, zero_phase
from cdia_pin.logs.log import Log

# [1], cut-off over the new rate: at half the rate, from where on a signal would alias, a tenth of the amplitude is left
KEPT_BAND = 0.4


def resampled(log: Log, rate: float) -> Log:
    """Resample a log to another rate; to a lower one after a low-pass filter without lag.

    Args:
        log: Any log.
        rate: Samples per second [Hz].

    Returns:
        The log at the times t₀ + k / rate up to its last sample [s], with a note.

    Raises:
        LogError: If most of the log is gaps, or less than one period of the new rate long.
    """
    even = uniform(log)
    before = (len(even.time) - 1) / even.duration
    if rate < before:
        cutoff = KEPT_BAND * rate
        position, effort = (zero_phase(s, cutoff, before) for s in (even.position, even.effort))
        velocity, temperature = (
            None if s is None else zero_phase(s, cutoff, before) for s in (even.velocity, even.temperature)
        )
        even = replace(even, position=position, effort=effort, velocity=velocity, temperature=temperature)
    count = int(np.floor(even.duration * rate * (1.0 + 1e-12) + 1e-9)) + 1
    time = np.minimum(
        even.time[0] + np.arange(count) / rate, even.time[-1]
    )  # rounding may pass the last sample
    said = f"resampled from {log.rate:.4g} Hz to {rate:.4g} Hz"
    return replace(sampled_at(even, time), notes=(*log.notes, said))


def thinned(log: Log, rate: float) -> Log:
    """Return the samples of a log that a slower recorder would have kept, as they were measured.

    Without a filter, a sample keeps its whole noise. That is what a bound of noise has to be learned from: after the
    filter of `resampled`, thresholds were passed by healthy logs of a slower recorder.

    Args:
        log: Any log.
        rate: Samples per second, below those of the log [Hz].

    Returns:
        The samples next to the times t₀ + k / rate, with their own times and a note.
    """
    middle = 0.5 * (log.time[1:] + log.time[:-1])
    wanted = np.arange(log.time[0], log.time[-1], 1.0 / rate)
    kept = np.unique(np.searchsorted(middle, wanted))
    velocity, temperature = (None if s is None else s[kept] for s in (log.velocity, log.temperature))
    return replace(
        log,
        time=log.time[kept],
        position=log.position[kept],
        velocity=velocity,
        effort=log.effort[kept],
        temperature=temperature,
    ).noted(f"thinned from {log.rate:.4g} Hz to {rate:.4g} Hz")
