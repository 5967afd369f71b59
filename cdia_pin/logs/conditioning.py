"""Conditioning: from a log to motion, acceleration and torque that can be compared, with every step recorded.

Positions and torques pass the same zero-phase filter, whatever is computed from the positions passes it again
together with the measured torque, and both are decimated to what the filter left of them: both sides of
M q̈ + nle = τ + f are treated alike [Gautier1997].
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.derivatives import differentiate, uniform, zero_phase
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

LOWEST_CUTOFF, HIGHEST_CUTOFF = 5.0, 25.0  # [Hz]
SHORTEST = 3.0  # [s], less cannot be conditioned
MOTION_OVERSAMPLING = 8.0  # rate of the motion over the cut-off: nonlinear effects make harmonics
TORQUE_OVERSAMPLING = 2.2  # rate of the compared torques over the cut-off: just above Nyquist


@dataclass(frozen=True)
class Conditioning:
    """Settings of the conditioning.

    Attributes:
        cutoff: Cut-off of the zero-phase filter [Hz]; chosen from the log if None.
        trim: Length cut from both ends, where the filter has no neighbours, in periods of the cut-off [1].
    """

    cutoff: float | None = None
    trim: float = 2.0


@dataclass(frozen=True)
class Motion:
    """A conditioned log.

    Attributes:
        joints: Joint names.
        time: Time [s], uniform, shape (N,).
        q: Positions [rad or m], shape (N, n).
        v: Velocities [rad/s or m/s], shape (N, n).
        a: Accelerations [rad/s² or m/s²], shape (N, n).
        effort: Torques, filtered once as the positions were [N·m or N], shape (N, n).
        rate: Samples per second of all of these [Hz].
        cutoff: Cut-off of the filter [Hz].
        decimation: Every how many samples a compared torque is kept.
        speed_noise: Standard deviation of the noise in v [rad/s or m/s], shape (n,).
        record: What was done, for files and reports.
    """

    joints: tuple[str, ...]
    time: Array
    q: Array
    v: Array
    a: Array
    effort: Array
    rate: float
    cutoff: float
    decimation: int
    speed_noise: Array
    record: dict[str, Any]

    @property
    def ends(self) -> slice:
        """Which compared torques are far enough from the ends."""
        cut = int(np.ceil(self.record["trim"] / self.cutoff * self.rate / self.decimation))
        return slice(cut, -cut or None)

    def compared(self, torque: ArrayLike) -> Array:
        """Filter a torque and decimate it to the samples that are compared.

        Args:
            torque: Along this motion, shape (N,) or (N, n).

        Returns:
            Shape (K,) or (K, n).
        """
        return zero_phase(torque, self.cutoff, self.rate)[:: self.decimation][self.ends]

    def sampled(self, signal: ArrayLike) -> Array:
        """Return a signal of the motion, unfiltered, at the samples that are compared."""
        return np.asarray(signal)[:: self.decimation][self.ends]


def condition(log: Log, settings: Conditioning | None = None) -> Motion:
    """Condition a log.

    Velocities are derived from the positions, also where the log has its own: a drive's velocity has been
    filtered by the drive, with a lag that nobody recorded.

    Args:
        log: The measured log.
        settings: Cut-off and trimming; the cut-off is chosen from the log if omitted.

    Returns:
        Motion and torque on a uniform grid.

    Raises:
        LogError: If the log is too short, or the cut-off too high for its rate.
    """
    settings = settings or Conditioning()
    if log.duration < SHORTEST:
        raise LogError(
            f"{log.source}: {log.duration:.2g} s is too short to compare, at least {SHORTEST:g} s are needed"
        )
    even = uniform(log)
    rate = (len(even.time) - 1) / even.duration
    cutoff = settings.cutoff or choose_cutoff(even.position, rate)
    if not 0 < cutoff < 0.4 * rate:
        raise LogError(
            f"{log.source}: a cut-off of {cutoff:g} Hz does not fit a log of {rate:.4g} Hz (at most 0.4 of it)"
        )
    q = zero_phase(even.position, cutoff, rate)
    v = differentiate(q, rate)
    a = differentiate(v, rate)
    effort = zero_phase(even.effort, cutoff, rate)
    every = max(1, int(rate / (MOTION_OVERSAMPLING * cutoff)))
    kept = np.s_[::every]
    again = max(1, int(rate / every / (TORQUE_OVERSAMPLING * cutoff)))
    return Motion(
        joints=log.joints,
        time=even.time[kept],
        q=q[kept],
        v=v[kept],
        a=a[kept],
        effort=effort[kept],
        rate=rate / every,
        cutoff=cutoff,
        decimation=again,
        speed_noise=_speed_noise(even.position, q, rate, cutoff),
        record={
            **asdict(settings),
            "cutoff": cutoff,
            "source": log.source,
            "sha256": log.sha256,
            "log_rate": rate,
            "motion_rate": rate / every,
            "compared_rate": rate / every / again,
            "velocity": "derived from position",
            "notes": list(even.notes),
        },
    )


def choose_cutoff(position: Array, rate: float) -> float:
    """Choose a cut-off from the positions: where their accelerations sink into the noise.

    The acceleration's spectrum is (2πf)⁴ times the position's. The cut-off is the lowest frequency above which,
    on every joint, only noise is left, kept within 5 to 25 Hz and well below half the rate.

    Args:
        position: Uniformly sampled, shape (N, n).
        rate: Sampling rate [Hz].

    Returns:
        Cut-off [Hz].
    """
    highest = min(HIGHEST_CUTOFF, 0.2 * rate)
    window = np.hanning(len(position))[:, None]
    line = np.linspace(0, 1, len(position))[:, None]
    moving = position - (position[0] + line * (position[-1] - position[0]))
    power = np.abs(np.fft.rfft(moving * window, axis=0)) ** 2
    frequency = np.fft.rfftfreq(len(position), 1 / rate)
    floor = np.median(power[frequency > 0.3 * rate], axis=0)
    edges = np.geomspace(LOWEST_CUTOFF, highest, 16) if highest > LOWEST_CUTOFF else np.array([highest])
    for low, high in zip(edges[:-1], edges[1:], strict=True):
        band = (frequency >= low) & (frequency < high)
        if band.any() and not (power[band].mean(axis=0) > 10 * floor).any():
            return float(low)
    return float(edges[-1])


def _speed_noise(raw: Array, smooth: Array, rate: float, cutoff: float) -> Array:
    """Standard deviation of the filtered speed from the noise that the filter took out of the position."""
    white = np.std(raw - smooth, axis=0) / np.sqrt(max(1.0 - 2 * cutoff / rate, 0.1))
    return white * 2 * np.pi * cutoff * np.sqrt(2 * cutoff / rate / 3)
