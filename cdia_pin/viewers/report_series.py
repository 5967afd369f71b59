"""Curves and clouds of a report: the signals of one joint, thinned to what a chart can show."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from cdia_pin.discovery import Comparison
    from cdia_pin.discovery.comparison import ResidualShape

Array = NDArray[np.float64]

Numbers = list[float | None]  # None where a value is not finite
Curve = list[Numbers]  # x and y

SIGNALS = ("velocity", "position", "acceleration", "load")
CURVE_BINS = 48  # regions of the curve of what was added
CURVE_FEWEST = 3  # samples that each of them must hold
LEAST_SHARE = 0.6  # of the variance of what was added that its curve must hold to be one
SAME = 1e-9  # [N·m or N], models whose torques differ by less are one model on that joint


class OverTime(TypedDict):
    """Torque and residuals of a joint over time.

    ``rest`` holds the intervals near rest, which do not count; ``logs`` the times at which further logs begin.
    """

    time: list[float]
    measured: Numbers
    before: Numbers
    after: Numbers | None
    rest: list[list[float]]
    logs: list[float]


class Cloud(TypedDict):
    """Motion, load and residuals of a joint at the samples that count."""

    velocity: Numbers
    position: Numbers
    acceleration: Numbers
    load: Numbers
    before: Numbers
    after: Numbers | None
    load_after: Numbers | None


class Means(TypedDict):
    """Means of a residual by region of a signal; ``share`` is the part of its variance that they hold [1]."""

    x: Numbers
    mean: Numbers
    spread: Numbers
    share: float


class MeansOfModels(TypedDict):
    """Means for the model as given and, where there is one, for the improved model."""

    before: Means
    after: NotRequired[Means]


class Against(TypedDict):
    """A residual against a signal; ``curve`` is the torque of the added effects."""

    means: MeansOfModels
    curve: Curve | None


def compact(values: Iterable[float]) -> Numbers:
    """Return numbers with 5 significant digits.

    Args:
        values: Numbers; those that are not finite become None.
    """
    return [float(f"{v:.5g}") if np.isfinite(v) else None for v in values]


def compact_one(value: float) -> float | None:
    """Return one number with 5 significant digits.

    Args:
        value: The number; None if it is not finite.
    """
    return compact([value])[0]


def end_to_end(comparison: Comparison) -> tuple[Array, list[int]]:
    """Lay the logs of a comparison one after the other.

    Args:
        comparison: Of one log or several.

    Returns:
        Time that always increases [s], shape (K,), and the index at which each further log begins.
    """
    time = np.asarray(comparison.time, float)
    step = np.diff(time)
    usual = 1.0 / min(log["compared_rate"] for log in comparison.record["logs"])
    breaks = np.flatnonzero((step <= 0) | (step > 1.5 * usual))
    step[breaks] = usual
    return time[0] + np.concatenate([[0.0], np.cumsum(step)]), [int(b) + 1 for b in breaks]


def over_time(before: Comparison, after: Comparison | None, j: int, points: int) -> OverTime:
    """Return measured torque and residuals of joint j over time, extremes kept where samples are left out.

    Args:
        before: Comparison of the model as given.
        after: Comparison of the improved model.
        j: Column of the joint.
        points: Most samples to return.
    """
    time, breaks = end_to_end(before)
    keep = extremes([before.measured[:, j], before.residual[:, j]], points)
    return {
        "time": [round(float(t), 3) for t in time[keep]],
        "measured": compact(before.measured[keep, j]),
        "before": compact(before.residual[keep, j]),
        "after": None if after is None else compact(after.residual[keep, j]),
        "rest": _intervals(time, ~before.informative[:, j]),
        "logs": [round(float(time[b]), 3) for b in breaks],
    }


def extremes(signals: list[Array], points: int) -> NDArray[np.intp]:
    """Return the indices of some samples, with the extremes of each signal in every stretch.

    Args:
        signals: Each of shape (K,).
        points: Most indices to return.
    """
    count = len(signals[0])
    if count <= points:
        return np.arange(count)
    kept = []
    for stretch in np.array_split(np.arange(count), max(points // (2 * len(signals)), 1)):
        for signal in signals:
            kept += [stretch[np.argmin(signal[stretch])], stretch[np.argmax(signal[stretch])]]
    return np.unique(kept)


def cloud(before: Comparison, after: Comparison | None, j: int, points: int) -> Cloud:
    """Return motion, load and residuals of a joint at the samples that count.

    Both models share the motion; the load is the torque of each model itself.

    Args:
        before: Comparison of the model as given.
        after: Comparison of the improved model; None without one.
        j: Index of the joint.
        points: Most samples to return.
    """
    use = np.flatnonzero(before.informative[:, j])
    use = use[:: -(-len(use) // points) or 1]  # every so many-th, rounded up

    def pick(signal: Array) -> Numbers:
        return compact(signal[use, j])

    return {
        "velocity": pick(before.signals["velocity"]),
        "position": pick(before.signals["position"]),
        "acceleration": pick(before.signals["acceleration"]),
        "load": pick(before.signals["load"]),
        "before": pick(before.residual),
        "after": None if after is None else pick(after.residual),
        "load_after": None if after is None else pick(after.signals["load"]),
    }


def against(signal: str, before: Comparison, after: Comparison | None, joint: str, j: int) -> Against:
    """Return the mean residual of a joint by region of a signal, and the curve that the added effects explain.

    The curve is the difference of both residuals: the torque of the added effects, filtered as the residuals are. It is
    None where that torque is no function of this signal.

    Args:
        signal: One of `SIGNALS`.
        before: Comparison of the model as given.
        after: Comparison of the improved model; None without one.
        joint: Name of the joint.
        j: Its index.
    """
    means: MeansOfModels = {"before": _means(before.shapes[joint][signal])}
    curve = None
    if after is not None:
        means["after"] = _means(after.shapes[joint][signal])
        use = before.informative[:, j]
        added = (before.residual - after.residual)[use, j]
        if len(added) and np.abs(added).max() > SAME:
            curve = curve_of(before.signals[signal][use, j], added)
    return {"means": means, "curve": curve}


def _means(shape: ResidualShape) -> Means:
    known = np.isfinite(shape.mean)
    middles = (shape.edges[:-1] + shape.edges[1:]) / 2
    return {
        "x": compact(middles[known]),
        "mean": compact(shape.mean[known]),
        "spread": compact(shape.spread[known]),
        "share": float(f"{shape.share:.4g}"),
    }


def curve_of(x: Array, y: Array) -> Curve | None:
    """Return y as a curve over x, means of regions; None where y is no function of x.

    Args:
        x: A signal of the motion, shape (K,).
        y: A torque at the same samples [N·m or N], shape (K,).
    """
    low, high = np.percentile(x, [0.5, 99.5])
    inside = (x >= low) & (x <= high)
    x, y = x[inside], y[inside]
    at = np.minimum(((x - low) / ((high - low) or 1.0) * CURVE_BINS).astype(int), CURVE_BINS - 1)
    count = np.bincount(at, minlength=CURVE_BINS)
    middle, mean = (np.bincount(at, s, CURVE_BINS) / np.maximum(count, 1) for s in (x, y))
    if np.sum((y - mean[at]) ** 2) > (1 - LEAST_SHARE) * np.sum((y - y.mean()) ** 2):
        return None
    known = count >= CURVE_FEWEST
    return [compact(middle[known]), compact(mean[known])]


def _intervals(time: Array, where: NDArray[np.bool_]) -> list[list[float]]:
    edge = np.diff(np.concatenate([[0], where.astype(int), [0]]))
    starts, ends = np.flatnonzero(edge == 1), np.flatnonzero(edge == -1) - 1
    half = 0.5 * float(np.median(np.diff(time)))
    return [
        [round(float(time[s]) - half, 3), round(float(time[e]) + half, 3)]
        for s, e in zip(starts, ends, strict=True)
    ]
