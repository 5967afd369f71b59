"""η₀, the bound of the unmodelled torque, from healthy runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.thesis.sample_interval import IntervalEvaluator
from cdia_pin.diagnosis.thesis.threshold import THRESHOLDS, decay
from cdia_pin.errors import ModelError
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]


def learn_unmodelled(
    stepper: IntervalEvaluator, gamma: Array, healthy: Sequence[Log], *, margin: float, threshold: str
) -> Array:
    """Return η₀ [N·m or N], shape (n,), for which no healthy run comes nearer to its threshold than 1/margin.

    The largest missing torque of each joint, filtered as an observer filters it, sets the proportions between
    joints; then all are raised together as far as the residuals ask for.

    Args:
        stepper: Of the engine.
        gamma: γ [1/s], shape (n,).
        healthy: Runs without fault, with velocities. A log's torque is taken to have acted since the sample
            before, as in a replay: what that is wrong by is part of η₀.
        margin: How much more than the largest seen [1].
        threshold: Form of the threshold.

    Raises:
        ModelError: If there is no run, or one has no velocities or too few samples.
    """
    if not healthy:
        raise ModelError("the bound of the unmodelled torque is missing: give unmodelled= or healthy runs")
    largest, steps = np.zeros_like(gamma), []
    for log in healthy:
        if log.velocity is None or len(log.time) < 3:
            raise ModelError(
                f"a healthy run needs velocities and three samples or more: {log.source or 'log'}"
            )
        samples = [stepper.sample(*row) for row in zip(log.time, log.position, log.velocity, strict=True)]
        run = [
            stepper.step(a, b, tau)
            for a, b, tau in zip(samples[:-1], samples[1:], log.effort[1:], strict=True)
        ]
        filtered = np.zeros_like(gamma)
        for step in run:
            left, gain = decay(gamma, step.duration)
            filtered = left * filtered + gain * gamma * step.missing
            largest = np.maximum(largest, np.abs(filtered))
        steps.append(run)
    largest = np.maximum(largest, 1e-9 * max(float(largest.max()), 1.0))
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
