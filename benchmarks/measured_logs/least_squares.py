"""Least squares with the full inertial regressor, Coulomb and viscous friction, offset and rotor: the usual way."""

from __future__ import annotations

from time import process_time

import numpy as np
from numpy.typing import NDArray

from benchmarks.measured_logs.errors import Bench, Column
from cdia_pin.regression.experiment import Experiment, rms

Array = NDArray[np.float64]

RANK = 1e-6  # singular values below that share of the largest are no parameters
ROUNDS = 3  # of weighting each joint by its own error


def least_squares(bench: Bench) -> Column:
    """Fit all samples to be judged on all, and moving ones to be judged on those."""
    began = process_time()
    residuals = []
    fitted, unseen = (_design(e) for e in (bench.fitted, bench.unseen))
    for used in (np.ones_like(bench.fitted.informative), bench.fitted.informative):
        theta = _fit(fitted, bench.fitted.measured, used)
        residuals.append(unseen @ theta - bench.unseen.measured)
    return bench.left("full least squares", *residuals, seconds=process_time() - began)


def _fit(design: Array, measured: Array, used: NDArray[np.bool_]) -> Array:
    sigma = np.ones(measured.shape[1])
    for _ in range(ROUNDS):
        weight = (1.0 / np.broadcast_to(sigma, measured.shape))[used]
        x = design[used] * weight[:, None]
        size = np.maximum(np.linalg.norm(x, axis=0), 1e-12)
        theta = np.linalg.lstsq(x / size, measured[used] * weight, rcond=RANK)[0] / size
        sigma = rms(measured - design @ theta, used)
    return theta


def _design(experiment: Experiment) -> Array:
    """Return the regressor of all parameters, filtered as torques are, shape (K, n, 14 n)."""
    (segment,) = experiment.segments
    x, n = segment.state, experiment.robot.n
    own = np.zeros((len(x), n, 4 * n))
    for k, signal in enumerate((x.sign, x.v, np.ones_like(x.v), x.a)):
        own[:, range(n), range(k, 4 * n, 4)] = signal
    regressor = np.concatenate([experiment.robot.torque_regressor(x.q, x.v, x.a), own], axis=2)
    flat = segment.motion.compared(regressor.reshape(len(x), -1))
    return flat.reshape(len(flat), n, -1)
