"""The bound η₀ of the unmodelled torque, learned from healthy runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.thesis.sample_interval import IntervalEvaluator, SampleInterval
from cdia_pin.diagnosis.thesis.threshold import THRESHOLDS, decay
from cdia_pin.errors import ModelError
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

LEAST_SAMPLES = 3  # two intervals: fewer show no filtered residual
LEAST_BOUND = 1e-9  # [1], η₀ of a joint over the largest one: keeps thresholds above zero


def learn_unmodelled(
    evaluator: IntervalEvaluator, gamma: Array, healthy: Sequence[Log], *, margin: float, threshold: str
) -> Array:
    """Return η₀ for which no healthy residual exceeds 1/margin of its threshold [N·m or N], shape (n,).

    The largest missing torque of each joint, filtered as an observer filters it, gives the proportions between joints.
    Then all are raised by one factor until the thresholds hold.

    Args:
        evaluator: The engine's model between samples.
        gamma: γ [1/s], shape (n,).
        healthy: Runs without fault, with velocities. A log's torque is taken to have acted since the previous
            sample, as in a replay; the error of that is part of η₀.
        margin: Factor on the largest residual seen [1].
        threshold: Form of the threshold, ``dynamic`` or ``time-varying``.

    Raises:
        ModelError: If there is no run, or one has no velocities or too few samples.
    """
    if not healthy:
        raise ModelError("the bound of the unmodelled torque is missing: give unmodelled= or healthy runs")
    largest = np.zeros_like(gamma)
    steps: list[list[SampleInterval]] = []
    for log in healthy:
        if log.velocity is None or len(log.time) < LEAST_SAMPLES:
            raise ModelError(
                f"a healthy run needs velocities and {LEAST_SAMPLES} samples or more: {log.source or 'log'}"
            )
        samples = [evaluator.sample(*row) for row in zip(log.time, log.position, log.velocity, strict=True)]
        run = [
            evaluator.between(a, b, tau)
            for a, b, tau in zip(samples[:-1], samples[1:], log.effort[1:], strict=True)
        ]
        filtered = np.zeros_like(gamma)
        for step in run:
            left, gain = decay(gamma, step.duration)
            filtered = left * filtered + gain * gamma * step.missing
            largest = np.maximum(largest, np.abs(filtered))
        steps.append(run)
    largest = np.maximum(largest, LEAST_BOUND * max(float(largest.max()), 1.0))
    nearest = 0.0
    for run in steps:
        bound, error = THRESHOLDS[threshold](gamma, largest), np.zeros_like(gamma)
        for step in run:
            left, gain = decay(gamma, step.duration)
            error = left * error - gain * (step.inverse_inertia @ step.missing)
            nearest = max(
                nearest, float((np.abs(error) / bound.step(step.inverse_inertia, step.duration)).max())
            )
    return margin * max(nearest, 1.0) * largest
