"""Derivatives of measured signals: uniform resampling, and a filter without lag that differentiates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

# [1], largest error of a sample's time over the period without resampling: below the jitter of any clock
UNIFORM_TOLERANCE = 1e-3
# A longer signal is filtered in blocks: memory does not grow, and transforms of 2^18 values are fast.
BLOCK = 2**17 + 1  # [samples], of a block with its margins
MARGIN = (
    15.0  # [periods of the cut-off], after which the filter's impulse response is below 10⁻¹⁵ of its peak
)
ORDER = 4  # [1], of the Butterworth filter of one pass
LARGEST_GROWTH = 4.0  # [1], samples of the grid over those of the log; above it most of the log is gaps


def uniform(log: Log) -> Log:
    """Resample a log to a uniform grid at its median rate.

    Positions are interpolated by Akima's cubic. It is smooth at a reversal, where PCHIP is flat, and does not
    overshoot on held samples, where a spline rings. Velocities and efforts carry white noise and are interpolated
    linearly. A log that is already uniform is returned unchanged, with its times.

    Args:
        log: Any log.

    Returns:
        The log at the times t₀ + k / rate up to its last sample [s].

    Raises:
        LogError: If gaps make the grid several times longer than the log.
    """
    period = 1.0 / log.rate
    count = int(np.floor(log.duration / period * (1.0 + 1e-12) + 1e-9)) + 1
    if count > LARGEST_GROWTH * len(log.time):
        raise LogError(
            f"{log.source}: {len(log.time)} samples at {log.rate:.4g} Hz span {log.duration:.4g} s, so most "
            "of the log is gaps; make a log of each recording"
        )
    mean_period = log.duration / (len(log.time) - 1)
    if _furthest_from_grid(log.time, mean_period) <= UNIFORM_TOLERANCE * mean_period:
        return log
    # the last time of the grid passes the last sample by a rounding error, where nothing can be interpolated
    time = np.minimum(log.time[0] + period * np.arange(count), log.time[-1])
    note = f"resampled from {len(log.time)} samples to a uniform grid of {count} at {log.rate:.4g} Hz"
    return sampled_at(log, time).noted(note)


def _furthest_from_grid(time: Array, period: float) -> float:
    """Return the largest distance of a time from the even grid that begins with them [s], block by block."""
    return max(
        float(
            np.abs(time[k : k + BLOCK] - (time[0] + period * np.arange(k, min(k + BLOCK, len(time))))).max()
        )
        for k in range(0, len(time), BLOCK)
    )


def sampled_at(log: Log, time: Array) -> Log:
    """Return a log at other times: positions by Akima's cubic, the rest linearly.

    Args:
        log: Any log.
        time: Times within the log, increasing [s], shape (K,).
    """
    velocity, temperature = (
        None if s is None else linear(time, log.time, s) for s in (log.velocity, log.temperature)
    )
    return replace(
        log,
        time=time,
        position=akima(time, log.time, log.position),
        velocity=velocity,
        effort=linear(time, log.time, log.effort),
        temperature=temperature,
    )


def zero_phase(
    signal: ArrayLike, cutoff: float, rate: float, *, derivative: int = 0, order: int = ORDER
) -> Array:
    r"""Low-pass a signal without lag, or a derivative of it: Butterworth forward and backward, odd padding.

    .. math:: |H(f)|^2 = \frac{1}{1 + (\tan(\pi f/r) / \tan(\pi f_c/r))^{2 n}}

    The product of both passes, |H|², is applied in the frequency domain to the signal without the line through its
    ends. The rest is odd about both ends, so the result equals filtfilt with endless odd padding. A constant and a
    ramp pass unchanged. As with any odd padding, the first and the last sample pass unfiltered: cut about
    ``rate / cutoff`` samples from each end before derivatives are used. A derivative is that of the filtered signal
    between the samples: (2 π i f)ᵈ in the same domain. Central differences lose amplitude, 8 % of an acceleration at
    10 Hz where the rate is 125 Hz.

    Args:
        signal: Uniformly sampled signal, shape (N,) or (N, n), in any unit.
        cutoff: Frequency at which the two passes together halve the amplitude [Hz].
        rate: Sampling rate [Hz].
        derivative: Order of the derivative d, 0 to 2 [1].
        order: Order of the Butterworth filter of one pass [1].

    Returns:
        Filtered signal or its derivative [unit of ``signal`` per sᵈ], shape of ``signal``.

    Raises:
        LogError: If the cutoff is not between 0 and half the sampling rate.
    """
    return _derivatives(signal, cutoff, rate, (derivative,), order)[0]


def smooth_motion(position: ArrayLike, cutoff: float, rate: float) -> tuple[Array, Array, Array]:
    """Return filtered positions with their first and second derivatives, as `zero_phase` does one by one.

    Args:
        position: Uniformly sampled positions [rad or m], shape (N, n).
        cutoff: Cut-off of the filter [Hz].
        rate: Sampling rate [Hz].

    Returns:
        Positions [rad or m], velocities and accelerations [per s and s²], shape (N, n) each.

    Raises:
        LogError: If the cutoff is not between 0 and half the sampling rate.
    """
    q, v, a = _derivatives(position, cutoff, rate, (0, 1, 2), ORDER)
    return q, v, a


def _derivatives(
    signal: ArrayLike, cutoff: float, rate: float, derivatives: Sequence[int], order: int
) -> list[Array]:
    """Return derivatives of a filtered signal, of a long one in blocks."""
    if not 0.0 < cutoff < 0.5 * rate:
        raise LogError(f"cutoff {cutoff:g} Hz must lie between 0 and half the sampling rate {rate:g} Hz")
    x = np.asarray(signal, dtype=np.float64)
    margin = int(np.ceil(MARGIN * rate / cutoff))
    if len(x) <= BLOCK or 4 * margin > BLOCK:
        return _filtered(x, cutoff, rate, derivatives, order)
    out = [np.empty_like(x) for _ in derivatives]
    for first in range(0, len(x), BLOCK - 2 * margin):
        start = min(max(first - margin, 0), len(x) - BLOCK)
        last = min(first + BLOCK - 2 * margin, len(x))
        blocks = _filtered(x[start : start + BLOCK], cutoff, rate, derivatives, order)
        for whole, block in zip(out, blocks, strict=True):
            whole[first:last] = block[first - start : last - start]
    return out


def _filtered(x: Array, cutoff: float, rate: float, derivatives: Sequence[int], order: int) -> list[Array]:
    """Filter a signal in one piece, column by column."""
    if x.ndim > 1 and not x.shape[1]:
        return [x.copy() for _ in derivatives]
    if x.ndim > 1:
        columns = [_filtered(column, cutoff, rate, derivatives, order) for column in x.T]
        return [np.column_stack(of_all).reshape(x.shape) for of_all in zip(*columns, strict=True)]
    count = len(x)
    if count < 3:
        return [np.zeros_like(x) if d else x.copy() for d in derivatives]
    share, rise = np.linspace(0.0, 1.0, count), x[-1] - x[0]
    line = x[0] + share * rise
    inside = x - line
    odd = np.concatenate([inside, -inside[-2:0:-1]])  # one period of the odd extension, (2 N − 2, …)
    angle = np.pi * np.fft.rfftfreq(len(odd))  # π f / rate, up to π/2
    with np.errstate(over="ignore"):
        gain = 1.0 / (1.0 + (np.tan(angle) / np.tan(np.pi * cutoff / rate)) ** (2 * order))
    spectrum = np.fft.rfft(odd) * gain
    of_line = (line, rise * rate / (count - 1), 0.0)
    return [
        of_line[d] + np.fft.irfft(spectrum * (2j * rate * angle) ** d, n=len(odd))[:count]
        for d in derivatives
    ]


def speed_of(position: Array, time: Array) -> Array:
    """Compute the speed of one joint, as `numpy.gradient` does, in a fifth of its memory.

    Args:
        position: Positions [rad or m], shape (N,).
        time: Their times [s], shape (N,).

    Returns:
        Absolute speeds [rad/s or m/s], shape (N,).
    """
    step = np.diff(time)
    if (step == step[0]).all():
        speed = np.gradient(position, step[0])
        return np.abs(speed, out=speed)
    out = np.empty(len(position))
    out[0], out[-1] = (position[1] - position[0]) / step[0], (position[-1] - position[-2]) / step[-1]
    for k in range(1, len(position) - 1, BLOCK):
        last = min(k + BLOCK, len(position) - 1)
        x, before, after = position[k - 1 : last + 1], step[k - 1 : last - 1], step[k:last]
        both = before + after
        out[k:last] = (
            -after / (before * both) * x[:-2]
            + (after - before) / (before * after) * x[1:-1]
            + before / (after * both) * x[2:]
        )
    return np.abs(out, out=out)


def linear(time: Array, given: Array, signal: Array) -> Array:
    """Interpolate a signal linearly; beyond its ends it is constant.

    Args:
        time: Times that are wanted [s], shape (K,).
        given: Times of the samples [s], shape (N,).
        signal: Samples in any unit, shape (N, n).

    Returns:
        In the unit of the signal, shape (K, n).
    """
    return np.column_stack([np.interp(time, given, column) for column in signal.T])


def akima(time: Array, given: Array, signal: Array) -> Array:
    """Interpolate a signal by Akima's cubic; of fewer than five samples linearly.

    Args:
        time: Times that are wanted [s], within the samples, shape (K,).
        given: Times of the samples [s], shape (N,).
        signal: Samples in any unit, shape (N, n).

    Returns:
        In the unit of the signal, shape (K, n).
    """
    if len(given) < 5:
        return linear(time, given, signal)
    from scipy.interpolate import Akima1DInterpolator

    return np.asarray(Akima1DInterpolator(given, signal, axis=0)(time))
