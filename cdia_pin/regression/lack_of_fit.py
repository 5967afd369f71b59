"""Lack of fit: structure that a model leaves in the residual, which smooth functions of the motion explain."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cdia_pin.phrases import settings_repr
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.noise import NoiseModel, NoiseSettings, fit_noise

Array = NDArray[np.float64]

# Radial basis functions [1] over each of position, speed and load; they resolve a sixth of the range.
NEURONS = 7
FINEST_TORQUE = 1e-7  # smallest noise over a joint's RMS torque [1], because less is rounding
RIDGES = (1e-3, 1e-2, 1e-1)  # ridges [1] on smooth functions of unit norm; the best on held-out blocks counts


@dataclass(frozen=True, repr=False)
class LackOfFitSettings:
    """When the residual of a model counts as structure.

    Smooth functions of the motion are fitted to the residual together with the model's terms. A share is the relative
    fall of the RMS of held-out blocks.

    Attributes:
        false_alarm: Probability that white noise counts as structure, for each joint [1].
        least_improvement: Least share of a significant structure [1].
        sure_improvement: Least share if slow structure is not whitened away as noise [1].
        plain_improvement: Least share of a structure whose significance is not proven [1].
        least_torque: RMS torque of a structure over the joint's RMS torque [1]. Less is no flaw of a model.
    """

    false_alarm: float = 1e-4
    least_improvement: float = 0.03
    sure_improvement: float = 0.12
    plain_improvement: float = 0.25
    least_torque: float = 0.001

    __repr__ = settings_repr


@dataclass(frozen=True, repr=False)
class LackOfFit:
    """Structure in the residual of each joint that smooth functions of the motion explain.

    Attributes:
        left: True if structure is left, shape (n,).
        improvement: Share by which the functions lower the held-out RMS [1], shape (n,).
        residual_noise: Noise of each joint if all of the model's residual is noise.
        innermost: Noise of each joint if what the functions leave is noise.
        floor: RMS of what the functions leave [N·m or N], shape (n,).
    """

    left: NDArray[np.bool_]
    improvement: Array
    residual_noise: tuple[NoiseModel, ...]
    innermost: tuple[NoiseModel, ...]
    floor: Array

    def __repr__(self) -> str:
        return f"LackOfFit(structure left on {int(self.left.sum())} of {len(self.left)} joints)"

    @property
    def noise(self) -> tuple[NoiseModel, ...]:
        """Best estimate of each joint's noise: the residual, or what is below the structure if some is left."""
        both = zip(self.left, self.innermost, self.residual_noise, strict=True)
        return tuple(inner if left else outer for left, inner, outer in both)


def slow_columns(experiment: Experiment, j: int) -> Array:
    """Return smooth functions of a joint's position and speed, of time, of the other joints, and what a log adds.

    Of several logs each may have an offset and friction of its own.

    Args:
        experiment: The conditioned logs.
        j: Index of the joint.

    Returns:
        Columns, shape (K, m).
    """
    time, q, v, _ = experiment.compared_motion()
    speed = np.tanh(v[:, j] / max(np.percentile(np.abs(v[:, j]), 95) * 0.05, 1e-9))
    t = (time - time.mean()) / (np.ptp(time) or 1.0)
    others = [s[:, k] for k in range(experiment.robot.n) if k != j for s in (q, v)]
    scaled = [(s - s.mean()) / (s.std() or 1.0) for s in others]
    columns = [
        np.ones(len(t)),
        *(_bases(signal[:, j], NEURONS) for signal in (q, v)),
        np.column_stack([speed, speed * t, q[:, j] * v[:, j]]),
        *([np.column_stack([*scaled, *(s**2 for s in scaled)])] if scaled else []),
        *(np.column_stack([of_log, of_log * speed]) for of_log in _all_logs_but_one(experiment)),
    ]
    return np.column_stack(columns)


def _all_logs_but_one(experiment: Experiment) -> list[Array]:
    """Return one for the compared samples of a log and zero for others, shape (K,) each, for all logs but the first."""
    segments, lengths = experiment.segments, experiment.lengths
    return [np.repeat([float(s.state.log == log) for s in segments], lengths) for log in experiment.logs[1:]]


def smooth_columns(experiment: Experiment, prediction: Prediction, j: int) -> Array:
    """Return the slow columns and smooth functions of the acceleration and of the load, which depends on it.

    Of several logs each may have a load of its own.

    Args:
        experiment: The conditioned logs.
        prediction: Prediction of the model, for the load.
        j: Index of the joint.

    Returns:
        Columns, shape (K, m).
    """
    a = experiment.compared_motion()[3][:, j]
    load = np.concatenate(
        [s.motion.sampled(t.actuator) for s, t in zip(experiment.segments, prediction.torques, strict=True)]
    )
    of_logs = [of_log * load[:, j] for of_log in _all_logs_but_one(experiment)]
    return np.column_stack([slow_columns(experiment, j), _bases(load[:, j], NEURONS), a, np.abs(a), *of_logs])


def lack_of_fit(
    experiment: Experiment,
    prediction: Prediction,
    own: list[Array],
    edges: NDArray[np.intp],
    settings: LackOfFitSettings | None = None,
    noise_settings: NoiseSettings | None = None,
) -> LackOfFit:
    """Compare each joint's residual with smooth functions of the motion.

    Args:
        experiment: The conditioned logs.
        prediction: Prediction of a model that was fitted to them.
        own: Columns of the model's terms for each joint, which are fitted again, shapes (K, p_j).
        edges: First sample of each block of time and the end, shape (B + 1,).
        settings: When the residual counts as structure.
        noise_settings: How the noise of each joint is estimated.
    """
    from scipy.special import fdtrc

    settings, n = settings or LackOfFitSettings(), experiment.robot.n
    left, improvement, floor = np.zeros(n, bool), np.zeros(n), np.zeros(n)
    outer: list[NoiseModel] = []
    inner: list[NoiseModel] = []
    torque = rms(experiment.measured, experiment.informative)
    smallest = np.maximum(experiment.resolution, settings.least_torque * torque)
    for j in range(n):
        use, nearness = experiment.informative[:, j], experiment.nearness[:, j]
        smooth = smooth_columns(experiment, prediction, j)
        y, fitted = prediction.residual[:, j], _orthonormal(own[j], use)
        both = _orthonormal(np.column_stack([own[j], smooth]), use)
        slow = _orthonormal(slow_columns(experiment, j), use)
        for found, columns in ((inner, both), (outer, fitted)):
            explained = _project(columns, y, use)
            noise = _at_least(
                experiment.resolution[j], y - explained, explained - _project(slow, explained, use), use
            )
            least = FINEST_TORQUE * torque[j]
            found.append(
                fit_noise(noise, use, nearness, experiment.runs, columns.shape[1], least, noise_settings)
            )
        rest = y - _project(both, y, use)
        floor[j] = np.sqrt(np.sum(rest[use] ** 2) / max(int(use.sum()) - both.shape[1], 1))
        by_outer, by_inner = (partial(_white, noise=noise, use=use) for noise in (outer[j], inner[j]))
        white = by_outer(y)
        rss, rss_both = float(white @ white), _left_after(by_outer(both), white)
        more = max(both.shape[1], 1)
        spare = max(int((use & outer[j].kept).sum()) - both.shape[1], 1)
        chance = float(fdtrc(more, spare, max((rss - rss_both) / more, 0.0) / max(rss_both / spare, 1e-300)))
        improvement[j], plain = (
            _improvement(white(fitted), white(smooth), white(y), edges) for white in (by_outer, by_inner)
        )
        visible = improvement[j] > settings.least_improvement or plain > settings.sure_improvement
        shown = (chance < settings.false_alarm and visible) or plain > settings.plain_improvement
        left[j] = shown and np.sqrt(max(np.mean(y[use] ** 2) - floor[j] ** 2, 0.0)) > smallest[j]
    return LackOfFit(left, improvement, tuple(outer), tuple(inner), floor)


def _at_least(resolution: float, left: Array, by_acceleration: Array, use: NDArray[np.bool_]) -> Array:
    """Return the part of a residual that is noise, at least as large as that of the sensors.

    Errors of the acceleration cause torque. Columns that depend on the acceleration contain them and explain them away.

    Args:
        resolution: RMS torque that the sensors' errors cause [N·m or N].
        left: What columns leave of a residual [N·m or N], shape (K,).
        by_acceleration: What only columns of the acceleration explained [N·m or N], shape (K,).
        use: Samples that count, shape (K,).
    """
    square, mixed, own = (
        float(np.mean((x * y)[use])) if use.any() else 0.0
        for x, y in ((by_acceleration,) * 2, (by_acceleration, left), (left, left))
    )
    lacking = resolution**2 - own
    if lacking <= 0 or square == 0:
        return left
    # the share to give back so that the RMS of the noise reaches the resolution
    share = (np.sqrt(mixed**2 + square * lacking) - mixed) / square
    return np.asarray(left + min(share, 1.0) * by_acceleration)


def _white(signal: Array, noise: NoiseModel, use: NDArray[np.bool_]) -> Array:
    used = use.reshape(-1, *([1] * (signal.ndim - 1)))
    return np.where(used, noise.whiten(np.where(used, signal, 0.0)), 0.0)


def _improvement(own: Array, smooth: Array, y: Array, edges: NDArray[np.intp]) -> float:
    """Return the share by which smooth functions lower the held-out RMS [1].

    An effect of several joints may fit each of them worse than parameters of its own would: that is structure too.
    """
    before = max(_held_out(own, np.zeros((len(y), 0)), y, edges, 0.0), float(y @ y))
    after = min(_held_out(own, smooth, y, edges, ridge) for ridge in RIDGES)
    return 1.0 - float(np.sqrt(after / before)) if before > 0 else 0.0


def _bases(signal: Array, count: int) -> Array:
    low, high = np.percentile(signal, [0.5, 99.5])
    width = (high - low) / (count - 1) or 1.0
    return np.asarray(np.exp(-(((signal[:, None] - np.linspace(low, high, count)) / width) ** 2)))


def _orthonormal(columns: Array, use: NDArray[np.bool_]) -> Array:
    """Return orthonormal columns with the same span over the samples that count, without repeated ones."""
    if not columns.shape[1] or not use.any():
        return columns[:, :0]
    scaled = columns / np.maximum(np.linalg.norm(columns[use], axis=0), 1e-300)
    _, values, right = np.linalg.svd(scaled[use], full_matrices=False)
    keep = values > 1e-2 * values[0]
    return np.asarray(scaled @ right[keep].T / values[keep])


def _project(orthonormal: Array, y: Array, use: NDArray[np.bool_]) -> Array:
    return orthonormal @ (orthonormal[use].T @ y[use])


def _left_after(x: Array, y: Array) -> float:
    if not x.shape[1]:
        return float(y @ y)
    theta = np.linalg.lstsq(x, y, rcond=None)[0]
    return float(np.sum((y - x @ theta) ** 2))


def _held_out(own: Array, smooth: Array, y: Array, edges: NDArray[np.intp], ridge: float) -> float:
    """Return the held-out sum of squares over all blocks; a ridge keeps the smooth functions small."""
    x = np.column_stack([own, smooth])
    x = x / np.maximum(np.linalg.norm(x, axis=0), 1e-300)
    gram, right = x.T @ x, x.T @ y
    penalty = np.diag(np.repeat([1e-9, ridge], [own.shape[1], smooth.shape[1]]))
    total = 0.0
    for start, stop in itertools.pairwise(edges):
        xb, yb = x[start:stop], y[start:stop]
        theta = np.linalg.solve(gram - xb.T @ xb + penalty, right - xb.T @ yb) if len(gram) else np.zeros(0)
        total += float(np.sum((yb - xb @ theta) ** 2))
    return total
