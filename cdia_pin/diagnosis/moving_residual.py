"""The healthy residual while a joint moves: its bound, its level and its correlation time.

A model of friction errs most near rest, where friction turns round. On measured arms the residual there is three to
ten times as large as in motion, so one bound for both hides most faults. Decisions use samples in motion only, so the
level and the correlation time that they are weighed by are those of motion too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.growth import growth
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.residuals import Watched, pooled

Array = NDArray[np.float64]

LEVEL_WINDOW = 1.0  # [s], over which the RMS of the healthy level is taken
LEAST_MOTION = 1.0  # [s] of a joint, below which nothing is known of its healthy residual in motion
# On motions unlike the healthy ones, models of measured arms were up to 0.2 of the torque off. A fault of 0.3 must be
# seen (`sight.BLIND_SHARE`).
LEAST_LOWERED = 0.2  # bound in motion over the joint's RMS torque, below which it is not lowered [1]


@dataclass(frozen=True)
class MovingResidual:
    """The residual of a healthy arm while its joints move.

    Attributes:
        bound: Bound [N·m or N], shape (n,).
        level: RMS in the worst second [N·m or N], shape (n,).
        memory: Correlation time [s], shape (n,).
    """

    bound: Array
    level: Array
    memory: Array


def learn_moving(
    seen: Sequence[Watched],
    unseen: Sequence[Watched],
    dt: float,
    rest_bound: Array,
    torque: Array,
    settings: MonitorSettings,
) -> MovingResidual:
    """Learn from what an observer saw of healthy runs.

    Args:
        seen: What the observer saw of each run.
        unseen: The same of motion to which the model was not fitted; empty if it was fitted to none.
        dt: Time between ticks [s].
        rest_bound: Bound of the residual near rest [N·m or N], shape (n,). It is the largest bound in motion too: half
            of a short run hardly determines a model, and must not make joints blind that the whole run lets us see.
        torque: RMS torque of the healthy runs [N·m or N], shape (n,).
        settings: Margins.
    """
    joints = range(len(torque))
    moving = [_moving(seen, j, dt) for j in joints]
    tried = [_moving(unseen, j, dt) for j in joints]
    memory = np.array([correlation_time(parts, dt) for parts in moving])
    duration = dt * np.array([sum(map(len, parts)) for parts in moving])
    wider = growth(duration, memory)
    bound = np.array([bound_of([*moving[j], *tried[j]], settings, wider[j]) for j in joints])
    bound = np.maximum(bound, LEAST_LOWERED * torque)
    window = max(1, round(LEVEL_WINDOW / dt))
    level = np.array([max(_worst_window(part, window) for part in parts) for parts in moving])
    return MovingResidual(np.minimum(bound, rest_bound), level, memory)


def bound_of(residuals: Sequence[Array], settings: MonitorSettings, wider: Array | float = 1.0) -> Array:
    """Return the bound of a healthy residual [N·m or N], shape (n,) or ().

    Args:
        residuals: Of each run, shape (K, n) each, or (K,) of one joint.
        settings: Margins over the largest residual, and over the RMS.
        wider: Growth of the largest residual with time [1], shape (n,); the RMS does not grow.
    """
    largest = np.abs(np.concatenate(residuals)).max(axis=0)
    return np.asarray(
        np.maximum(wider * settings.margin * largest, settings.noise_margin * pooled(residuals))
    )


def correlation_time(series: Sequence[Array], dt: float) -> float:
    """Return the correlation time of a residual: the sum of its autocorrelation up to the first zero [s].

    Args:
        series: Residuals of one joint [N·m or N], shape (K,) each; the longest one is used.
        dt: Time between samples [s].
    """
    longest = max(series, key=len)
    x = longest - longest.mean()
    size = 1 << (2 * len(x) - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(x, size)) ** 2
    auto = np.fft.irfft(spectrum)[: max(len(x) // 2, 1)]
    auto /= auto[0] if auto[0] > 0 else 1.0
    negative = np.flatnonzero(auto <= 0)
    return float(dt * (2 * auto[: negative[0] if len(negative) else len(auto)].sum() - 1))


def _moving(seen: Sequence[Watched], j: int, dt: float) -> list[Array]:
    """Return the residual of a joint in motion, run by run; all of it if there is hardly any motion."""
    parts = [one.residual[one.moves[:, j], j] for one in seen]
    if dt * sum(map(len, parts)) < LEAST_MOTION:
        parts = [one.residual[:, j] for one in seen]
    return [part for part in parts if len(part)]


def _worst_window(r: Array, window: int) -> float:
    """Return the RMS of the window [samples] in which it is largest [N·m or N]."""
    total = np.concatenate([[0.0], np.cumsum(r**2)])
    window = min(window, len(r))
    return float(np.sqrt((total[window:] - total[:-window]).max() / window))
