"""Structure that is left: does anything smooth in the motion still explain the residual?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.discovery.experiment import Experiment, Prediction
from cdia_pin.discovery.whitening import NoiseModel, fit_noise

Array = NDArray[np.float64]

NEURONS = 7  # radial bases over position, speed and load
LEAST_IMPROVEMENT = 0.03  # share by which held-out RMS must fall for structure to be worth a word
ALARM = 1e-4  # probability of calling noise structure, per joint


@dataclass(frozen=True)
class Structure:
    """What smooth functions of the motion find in each joint's residual.

    Attributes:
        left: Whether structure is left, shape (n,).
        improvement: Share by which they lower the held-out RMS [1], shape (n,).
        noise: What they leave: the noise of each joint.
        floor: RMS of what they leave [N·m or N], shape (n,).
    """

    left: NDArray[np.bool_]
    improvement: Array
    noise: tuple[NoiseModel, ...]
    floor: Array


def smooth_columns(experiment: Experiment, prediction: Prediction, j: int) -> Array:
    """Return smooth functions of joint j's motion and load, of time, and of the other joints, shape (K, m)."""
    time, q, v, a = experiment.compared_motion()
    load = np.concatenate(
        [s.motion.sampled(t.actuator) for s, t in zip(experiment.segments, prediction.torques, strict=True)]
    )
    own = [_bases(signal[:, j], NEURONS) for signal in (q, v, load)]
    speed = np.tanh(v[:, j] / max(np.percentile(np.abs(v[:, j]), 95) * 0.05, 1e-9))
    t = (time - time.mean()) / (np.ptp(time) or 1.0)
    others = [s[:, k] for k in range(experiment.robot.n) if k != j for s in (q, v)]
    scaled = [(s - s.mean()) / (s.std() or 1.0) for s in others]
    columns = [
        *own,
        np.column_stack([speed, speed * t, t, t**2, a[:, j], np.abs(a[:, j]), q[:, j] * v[:, j]]),
        *([np.column_stack(scaled), np.column_stack(scaled) ** 2] if scaled else []),
    ]
    raw = np.column_stack([np.ones(len(t)), *columns])
    return raw


def look_for_structure(
    experiment: Experiment, prediction: Prediction, own: list[Array], edges: NDArray[np.intp]
) -> Structure:
    """Compare each joint's residual with smooth functions of the motion.

    Args:
        experiment: The conditioned logs.
        prediction: Of a model fitted to them.
        own: Columns of the model's terms for each joint, refitted alongside; shapes (K, p_j).
        edges: Blocks of time for held-out errors, shape (B + 1,).
    """
    from scipy.special import fdtrc

    n = experiment.robot.n
    left, improvement, floor, noises = np.zeros(n, bool), np.zeros(n), np.zeros(n), []
    for j in range(n):
        use = experiment.informative[:, j]
        y, fitted = prediction.residual[:, j], _orthonormal(own[j], use)
        both = _orthonormal(np.column_stack([own[j], smooth_columns(experiment, prediction, j)]), use)
        rest = y - _project(both, y, use)
        noise = fit_noise(rest, use, experiment.lengths, both.shape[1])
        noises.append(noise)
        freedom = max(int(use.sum()) - both.shape[1], 1)
        floor[j] = np.sqrt(np.sum(rest[use] ** 2) / freedom)
        white = lambda s, noise=noise, use=use: np.where(  # noqa: E731
            (use & noise.kept).reshape(-1, *([1] * (s.ndim - 1))), noise.whiten(s), 0.0
        )
        rss_own, rss_both = _left_after(white(fitted), white(y)), _left_after(white(both), white(y))
        more = max(both.shape[1] - fitted.shape[1], 1)
        spare = max(int((use & noise.kept).sum()) - both.shape[1], 1)
        chance = float(fdtrc(more, spare, max((rss_own - rss_both) / more, 0.0) / (rss_both / spare)))
        before = _held_out(white(fitted), white(y), edges)
        after = _held_out(white(both), white(y), edges)
        improvement[j] = 1.0 - np.sqrt(after / before) if before > 0 else 0.0
        left[j] = chance < ALARM and improvement[j] > LEAST_IMPROVEMENT
    return Structure(left, improvement, tuple(noises), floor)


def _bases(signal: Array, count: int) -> Array:
    low, high = np.percentile(signal, [0.5, 99.5])
    width = (high - low) / (count - 1) or 1.0
    return np.exp(-(((signal[:, None] - np.linspace(low, high, count)) / width) ** 2))


def _orthonormal(columns: Array, use: NDArray[np.bool_]) -> Array:
    """Return columns with the same span over the samples that count, those that add nothing left out."""
    if not columns.shape[1]:
        return columns
    scaled = columns / np.maximum(np.linalg.norm(columns[use], axis=0), 1e-300)
    _, values, right = np.linalg.svd(scaled[use], full_matrices=False)
    keep = values > 1e-3 * values[0]
    return scaled @ right[keep].T / values[keep]


def _project(orthonormal: Array, y: Array, use: NDArray[np.bool_]) -> Array:
    return orthonormal @ (orthonormal[use].T @ y[use])


def _left_after(x: Array, y: Array) -> float:
    if not x.shape[1]:
        return float(y @ y)
    theta = np.linalg.lstsq(x, y, rcond=None)[0]
    return float(np.sum((y - x @ theta) ** 2))


def _held_out(x: Array, y: Array, edges: NDArray[np.intp]) -> float:
    gram, right = x.T @ x, x.T @ y
    ridge = 1e-6 * (np.trace(gram) / max(len(gram), 1)) * np.eye(len(gram))
    total = 0.0
    for start, stop in zip(edges[:-1], edges[1:], strict=True):
        xb, yb = x[start:stop], y[start:stop]
        theta = np.linalg.solve(gram - xb.T @ xb + ridge, right - xb.T @ yb) if len(gram) else np.zeros(0)
        total += float(np.sum((yb - xb @ theta) ** 2))
    return total
