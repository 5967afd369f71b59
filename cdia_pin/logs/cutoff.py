"""Choice of the filter's cut-off from a log: the end of the band in which positions show motion and not noise."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.derivatives import smooth_motion, zero_phase
from cdia_pin.logs.log import Log
from cdia_pin.logs.stretches import stretches
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# [Hz], range of the cut-off: a working motion of an arm needs the lower end, and the resonances of its structure
# lie near the upper end
LOWEST_CUTOFF, HIGHEST_CUTOFF = 5.0, 25.0
HIGHEST_SHARE = 0.15  # [1], of the log's rate: seven samples a period, so that a held one is a small part
FINEST = 1e-15  # [1], smallest floor of a position over its peak power: an error of about 10⁻⁶ of its travel
FINEST_EFFORT = 1e-9  # [1], the same for torques, which no sensor measures that finely
FLAT = 10.0  # [1], power over the spectrum's floor below which a band holds noise only
AMPLIFIED = 2.0  # [1], computed over measured torque above which a band holds noise: accelerations amplify it
NOISE_BAND = 0.3  # [1], of the rate; above it spectra show the noise floor alone
JUDGED = 2**17  # samples [1] by which the cut-off is chosen, of a longer log in stretches
# At 1 and with sgn at instants `discover` left 6 % more of the URDF's error in 53 measured logs.
WITHIN = (
    0.9  # [1], cut-off over the end of the band: noise is largest there, and a third of its amplitude passes
)
BANDS = (
    13  # bands between the lowest and the highest cut-off, each wider than the one before by the same factor
)


def choose_cutoff(even: Log, robot: RobotModel) -> float:
    """Choose the cut-off, just within the band in which positions show motion and not their own noise.

    Args:
        even: A uniformly sampled log.
        robot: Its robot.

    Returns:
        Cut-off [Hz], at most 0.15 of the rate.
    """
    return WITHIN * _end_of_band(even, robot)


def _end_of_band(even: Log, robot: RobotModel) -> float:
    """Return where the band ends in which positions show motion [Hz], within 5 to 25 Hz.

    Two signs of noise end the band. Either the spectra of positions and torques are flat on every joint. Or the
    rigid-body torque that is computed from the positions is larger than the measured one on most joints, because
    accelerations amplify noise.
    """
    rate = (len(even.time) - 1) / even.duration
    highest = min(HIGHEST_CUTOFF, HIGHEST_SHARE * rate)
    if highest <= LOWEST_CUTOFF:
        return highest
    edges = np.geomspace(LOWEST_CUTOFF, highest, BANDS + 1)
    parts = [even.slice(p.start, p.stop) for p in stretches(len(even.time), JUDGED)]
    position, frequency = _spectrum([p.position for p in parts], rate)
    high_band = frequency > NOISE_BAND * rate
    # positions without noise of their own, such as filtered ones, are taken to be as fine as the best encoders
    floor = np.maximum(np.median(position[high_band], axis=0), FINEST * position.max(axis=0))
    effort, _ = _spectrum([p.effort for p in parts], rate)
    hiss = np.maximum(np.median(effort[high_band], axis=0), FINEST_EFFORT * effort.max(axis=0))
    every = max(1, int(rate / (4 * highest)))
    computed, low_rate = _spectrum([_computed(p, robot, highest, rate, every) for p in parts], rate / every)
    measured, _ = _spectrum([zero_phase(p.effort, highest, rate)[::every] for p in parts], rate / every)
    for low, high in pairwise(edges):
        band, low_band = ((f >= low) & (f < high) for f in (frequency, low_rate))
        if not band.any() or not low_band.any():
            continue
        flat = (position[band].mean(axis=0) < FLAT * floor).all() and (
            effort[band].mean(axis=0) < FLAT * hiss
        ).all()
        amplified = np.median(
            computed[low_band].mean(axis=0) / np.maximum(measured[low_band].mean(axis=0), 1e-300)
        )
        if flat or amplified > AMPLIFIED**2:
            return float(low)
    return float(highest)


def _computed(part: Log, robot: RobotModel, cutoff: float, rate: float, every: int) -> Array:
    """Return the rigid-body torque of the filtered positions [N·m or N], one of so many samples."""
    return robot.inverse_dynamics(*(x[::every] for x in smooth_motion(part.position, cutoff, rate)))


def _spectrum(parts: Sequence[Array], rate: float) -> tuple[Array, Array]:
    """Return the mean power of each column without the line through its ends, and the frequencies [Hz].

    Args:
        parts: Parts of a signal, shape (N, n) each.
        rate: Their rate [Hz].
    """
    count = len(parts[0])
    line, window = np.linspace(0, 1, count)[:, None], np.hanning(count)[:, None]
    moving = (x - (x[0] + line * (x[-1] - x[0])) for x in parts)
    power = [np.abs(np.fft.rfft(x * window, axis=0)) ** 2 for x in moving]
    mean = power[0] if len(power) == 1 else np.mean(power, axis=0)
    return mean, np.asarray(np.fft.rfftfreq(count, 1 / rate), float)
