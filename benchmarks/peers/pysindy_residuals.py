"""PySINDy: sparse regression of what the URDF misses, joint by joint.

A fair chance: it gets our conditioned signals, a library of the right physics for each joint (the columns of our
effects of one joint, as functions of q, q̇, q̈ and the rigid-body torque), columns of equal size, and the threshold
and ridge that predict the last quarter of the log best. Effects of the whole arm are not in such a library.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from pysindy import STLSQ

from benchmarks.peers.answer import Answer
from cdia_pin.dynamics import Dynamics
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.experiment import Experiment
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]

SMOOTH = 0.01  # [rad/s or m/s], over which sgn q̇ is smoothed
THRESHOLDS = np.geomspace(3e-3, 1.0, 12)  # as shares of the RMS of what is missing
RIPPLES = range(5, 15)  # [1/rad]
RIDGES = (
    1e-3,
    1e-2,
    1e-1,
)  # [1], on columns of unit size: without, alike columns cancel, and extrapolate wildly
SMALLEST = 1e-6  # [1], columns below that are rounding
FITTED = 0.75  # share of the log that is fitted while the threshold is chosen

Feature = Callable[[Array, Array, Array, Array], Array]  # of q, q̇, q̈, τ of the joint
LIBRARY: dict[str, Feature] = {
    "torque_offset": lambda q, v, a, tau: np.ones_like(q),
    "joint_spring": lambda q, v, a, tau: q,
    "viscous_friction": lambda q, v, a, tau: v,
    "quadratic_friction": lambda q, v, a, tau: np.abs(v) * v,
    "coulomb_friction": lambda q, v, a, tau: np.tanh(v / SMOOTH),
    "rotor_inertia": lambda q, v, a, tau: a,
    "actuator_gain": lambda q, v, a, tau: tau,
    "load_friction": lambda q, v, a, tau: np.abs(tau) * np.tanh(v / SMOOTH),
    **{f"position_ripple sin {k}": lambda q, v, a, tau, k=k: np.sin(k * q) for k in RIPPLES},
    **{f"position_ripple cos {k}": lambda q, v, a, tau, k=k: np.cos(k * q) for k in RIPPLES},
}


def fit(robot: RobotModel, log: Log) -> Answer:
    """Fit what the URDF misses of a log."""
    experiment = Experiment.of(robot, [condition(log, robot)])
    missing = -experiment.predict(Dynamics(robot)).residual  # measured less predicted torque
    _, *motion = experiment.compared_motion()
    use = experiment.informative
    weights = np.zeros((len(LIBRARY), robot.n))
    for j in range(robot.n):
        theta, y = _features(robot, *motion)[use[:, j], j, :], missing[use[:, j], j]
        split = int(FITTED * len(y))
        scale = np.maximum(np.sqrt(np.mean(y**2)), 1e-12)
        size = np.maximum(np.sqrt(np.mean(theta**2, axis=0)), SMALLEST)
        x, y = theta / size, y / scale
        errors = {
            (float(t), ridge): float(
                np.mean((y[split:] - x[split:] @ _sparse(x[:split], y[:split], t, ridge)) ** 2)
            )
            for t in THRESHOLDS
            for ridge in RIDGES
        }
        weights[:, j] = _sparse(x, y, *min(errors, key=errors.__getitem__)) * scale / size
    named = {
        f"{name.partition(' ')[0]}@{joint}": None
        for j, joint in enumerate(robot.joints)
        for name, w in zip(LIBRARY, weights[:, j], strict=True)
        if w
    }

    def torque(q: Array, v: Array, a: Array) -> Array:
        return robot.inverse_dynamics(q, v, a) + np.einsum("kjp,pj->kj", _features(robot, q, v, a), weights)

    return Answer(tuple(named), torque)


def _sparse(x: Array, y: Array, threshold: float, ridge: float) -> Array:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that a threshold leaves nothing is an answer
        fitted = STLSQ(threshold=threshold, alpha=ridge * len(x), max_iter=30, unbias=False).fit(
            x, y[:, None]
        )
    return np.ravel(fitted.coef_)


def _features(robot: RobotModel, q: Array, v: Array, a: Array) -> Array:
    tau = robot.inverse_dynamics(q, v, a)
    return np.stack([f(q, v, a, tau) for f in LIBRARY.values()], axis=-1)
