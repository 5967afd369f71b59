"""Conditioning: from a log to motion, acceleration and torque that can be compared, with every step recorded.

Positions and torques pass the same zero-phase filter, whatever is computed from the positions passes it again
together with the measured torque, and both are decimated to what the filter left of them: both sides of
M q̈ + nle = τ + f are treated alike [Gautier1997].
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.derivatives import differentiate, uniform, zero_phase
from cdia_pin.logs.log import Log
from cdia_pin.logs.resolution import quantum
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

LOWEST_CUTOFF, HIGHEST_CUTOFF = 5.0, 25.0  # [Hz]
HIGHEST_SHARE = 0.15  # of the log's rate
FINEST = 1e-15  # floor over peak power of a position: about 10⁻⁶ of its travel
FINEST_EFFORT = 1e-9  # the same for torques, which nothing measures that finely
FLAT = 10.0  # times the spectrum's floor: power below that is noise
AMPLIFIED = 2.0  # computed over measured torque: a band where it is larger holds no motion
SHORTEST = 3.0  # [s], less cannot be conditioned
MOTION_OVERSAMPLING = 8.0  # rate of the motion over the cut-off: nonlinear effects make harmonics
DROWNED = 3.0  # times the power of its noise: an acceleration that has less at its busiest is none
STRETCH = 1.0  # [s], over which that is asked
KERNEL = 5.0  # periods of the cut-off after which the filter's response is below 10⁻⁵
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
        a: Accelerations [rad/s² or m/s²], zero where a joint's are no more than noise, shape (N, n).
        effort: Torques, filtered once as the positions were [N·m or N], shape (N, n).
        rate: Samples per second of all of these [Hz].
        cutoff: Cut-off of the filter [Hz].
        decimation: Every how many samples a compared torque is kept.
        speed_noise: Standard deviation of the noise in v [rad/s or m/s], shape (n,).
        acceleration_noise: Standard deviation of what a does not know [rad/s² or m/s²], shape (n,).
        effort_step: Step between the levels of rounded torques [N·m or N], 0 where they are not, shape (n,).
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
    acceleration_noise: Array
    effort_step: Array
    record: dict[str, Any]

    @cached_property
    def kept(self) -> NDArray[np.intp]:
        """Samples that are compared: every `decimation`-th, far enough from the ends, shape (K,)."""
        every = np.arange(0, len(self.time), self.decimation)
        cut = int(np.ceil(self.record["trim"] / self.cutoff * self.rate / self.decimation))
        return every[cut : len(every) - cut]

    @cached_property
    def _filter(self) -> Any:
        """The zero-phase filter at the samples that are compared, a sparse matrix of shape (K, N).

        It equals `zero_phase` and costs a tenth, since most of what a filter computes is decimated away. Beyond the
        ends the signal goes on as its odd mirror image.
        """
        from scipy.sparse import csr_array

        count = len(self.time)
        reach = min(int(np.ceil(KERNEL / self.cutoff * self.rate)), count - 1)
        impulse = np.zeros(4 * reach + 1)
        impulse[2 * reach] = 1.0
        kernel = zero_phase(impulse, self.cutoff, self.rate)[reach : 3 * reach + 1]
        kernel /= kernel.sum()
        rows = np.repeat(np.arange(len(self.kept)), 2 * reach + 1)
        columns = (self.kept[:, None] + np.arange(-reach, reach + 1)).ravel()
        weights = np.tile(kernel, len(self.kept))
        entries = [(rows, columns, weights)]
        for end, beyond in ((0, columns < 0), (count - 1, columns >= count)):
            # x(end ± i) = 2 x(end) − x(end ∓ i)
            entries.append((rows[beyond], np.full(beyond.sum(), end), 2 * weights[beyond]))
            weights = np.where(beyond, -weights, weights)
            columns = np.where(beyond, 2 * end - columns, columns)
        entries[0] = (rows, columns, weights)
        i, j, w = (np.concatenate(part) for part in zip(*entries, strict=True))
        return csr_array((w, (i, j)), shape=(len(self.kept), count))

    def compared(self, torque: ArrayLike) -> Array:
        """Filter a torque and decimate it to the samples that are compared.

        Args:
            torque: Along this motion, shape (N,) or (N, n).

        Returns:
            Shape (K,) or (K, n).
        """
        return np.asarray(self._filter @ np.ascontiguousarray(torque, dtype=float))

    def sampled(self, signal: ArrayLike) -> Array:
        """Return a signal of the motion, unfiltered, at the samples that are compared."""
        return np.asarray(signal)[self.kept]


def condition(log: Log, robot: RobotModel, settings: Conditioning | None = None) -> Motion:
    """Condition a log.

    Velocities are derived from the positions, also where the log has its own: a drive's velocity has been
    filtered by the drive, with a lag that nobody recorded.

    Args:
        log: The measured log.
        robot: Its robot; the cut-off is chosen with its help.
        settings: Cut-off and trimming; the cut-off is chosen from the log if omitted.

    Returns:
        Motion and torque on a uniform grid.

    Raises:
        LogError: If the log is too short, or the cut-off too high for its rate.
    """
    settings = settings or Conditioning()
    if log.joints != robot.joints:
        raise LogError(
            f"{log.source}: its joints are {', '.join(log.joints)}, those of '{robot.name}' {', '.join(robot.joints)}"
        )
    if log.duration < SHORTEST:
        raise LogError(
            f"{log.source}: {log.duration:.2g} s is too short to compare, at least {SHORTEST:g} s are needed"
        )
    even = uniform(log)
    rate = (len(even.time) - 1) / even.duration
    cutoff = choose_cutoff(even, robot) if settings.cutoff is None else settings.cutoff
    if not 0 < cutoff < 0.4 * rate:
        raise LogError(
            f"{log.source}: a cut-off of {cutoff:g} Hz does not fit a log of {rate:.4g} Hz (at most 0.4 of it)"
        )
    q = zero_phase(even.position, cutoff, rate)
    v = differentiate(q, rate)
    a = differentiate(v, rate)
    effort = zero_phase(even.effort, cutoff, rate)
    speed_noise = _speed_noise(even.position, q, rate, cutoff)
    acceleration_noise = np.maximum(
        # white noise of a position, filtered: that of its acceleration from that of its speed
        speed_noise * 2 * np.pi * cutoff * np.sqrt(3 / 5),
        _rounding(even.position, rate, cutoff),
    )
    # a joint that hardly accelerates would have the noise of its acceleration explained by bodies
    drowned = _busiest(a, rate) < DROWNED * acceleration_noise**2
    a[:, drowned] = 0.0
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
        speed_noise=speed_noise,
        acceleration_noise=acceleration_noise,
        effort_step=np.array([quantum(of_joint) for of_joint in log.effort.T]),
        record={
            **asdict(settings),
            "cutoff": cutoff,
            "source": log.source,
            "condition": log.condition,
            "sha256": log.sha256,
            "log_rate": rate,
            "motion_rate": rate / every,
            "compared_rate": rate / every / again,
            "velocity": "derived from position",
            "acceleration_drowned": [j for j, lost in zip(log.joints, drowned, strict=True) if lost],
            "notes": list(even.notes),
        },
    )


def _busiest(a: Array, rate: float) -> Array:
    """Return the power of each acceleration over the stretch of time where it is largest, shape (n,)."""
    count = max(1, int(len(a) / (STRETCH * rate)))
    return np.max([np.mean(part**2, axis=0) for part in np.array_split(a, count)], axis=0)


def choose_cutoff(even: Log, robot: RobotModel) -> float:
    """Choose a cut-off from the log: up to where positions still tell of the motion, and not of their own noise.

    Two signs of noise end the band: the spectra of positions and torques are flat on every joint, or the rigid-body
    torque computed from the positions is larger than the measured one on most joints, since accelerations amplify
    what is no motion.

    Args:
        even: A uniformly sampled log.
        robot: Its robot.

    Returns:
        Cut-off [Hz], within 5 to 25 Hz and well below half the rate.
    """
    rate = (len(even.time) - 1) / even.duration
    highest = min(HIGHEST_CUTOFF, HIGHEST_SHARE * rate)
    if highest <= LOWEST_CUTOFF:
        return highest
    edges = np.geomspace(LOWEST_CUTOFF, highest, 14)
    position, frequency = _spectrum(even.position, rate)
    # positions without noise of their own, such as filtered ones, are taken to be as fine as the best encoders
    floor = np.maximum(np.median(position[frequency > 0.3 * rate], axis=0), FINEST * position.max(axis=0))
    effort, _ = _spectrum(even.effort, rate)
    hiss = np.maximum(np.median(effort[frequency > 0.3 * rate], axis=0), FINEST_EFFORT * effort.max(axis=0))
    q = zero_phase(even.position, highest, rate)
    every = max(1, int(rate / (4 * highest)))
    v = differentiate(q, rate)
    motion = [x[::every] for x in (q, v, differentiate(v, rate))]
    computed, low_rate = _spectrum(robot.inverse_dynamics(*motion), rate / every)
    measured, _ = _spectrum(zero_phase(even.effort, highest, rate)[::every], rate / every)
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


def _spectrum(signal: Array, rate: float) -> tuple[Array, Array]:
    """Power of each column, less the line through its ends, and the frequencies [Hz]."""
    line = np.linspace(0, 1, len(signal))[:, None]
    moving = signal - (signal[0] + line * (signal[-1] - signal[0]))
    power = np.abs(np.fft.rfft(moving * np.hanning(len(signal))[:, None], axis=0)) ** 2
    return power, np.asarray(np.fft.rfftfreq(len(signal), 1 / rate), float)


def _speed_noise(raw: Array, smooth: Array, rate: float, cutoff: float) -> Array:
    """Standard deviation of the filtered speed from the noise that the filter took out of the position."""
    white = np.std(raw - smooth, axis=0) / np.sqrt(max(1.0 - 2 * cutoff / rate, 0.1))
    return white * 2 * np.pi * cutoff * np.sqrt(2 * cutoff / rate / 3)


def _rounding(position: Array, rate: float, cutoff: float) -> Array:
    """RMS acceleration that rounding of the positions leaves in the band; 0 for positions that are not rounded.

    It is not white where a joint moves evenly, and beats where steps of its encoder meet the samples: so a smoother
    motion is rounded again.
    """
    step = np.array([quantum(of_joint) for of_joint in position.T])
    if not step.any():
        return step
    safe, smooth = np.where(step > 0, step, 1.0), zero_phase(position, min(LOWEST_CUTOFF, cutoff), rate)
    error = np.where(step > 0, np.round(smooth / safe) * safe - smooth, 0.0)
    again = differentiate(differentiate(zero_phase(error, cutoff, rate), rate), rate)
    return np.asarray(np.sqrt(np.mean(again**2, axis=0)))
