"""PySINDy: sparse regression of what the URDF misses, joint by joint.

A fair chance: it gets our conditioned signals, a library of the right physics for each joint (the columns of our
effects of one joint, as functions of q, q̇, q̈ and the rigid-body torque), columns of equal size, and the threshold
that predicts the last quarter of the log best. Effects of the whole arm are not in such a library.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from pysindy import STLSQ

from benchmarks.peers.answer import Answer
from cdia_pin.discovery.experiment import Experiment
from cdia_pin.dynamics import Dynamics
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]

SMOOTH = 0.01  # [rad/s or m/s], over which sgn q̇ is smoothed
THRESHOLDS = np.geomspace(3e-3, 1.0, 12)  # as shares of the RMS of what is missing
RIPPLES = range(5, 15)  # [1/rad]; the slower ones are much alike, and extrapolate wildly
RIDGE = 0.01  # [1], on columns of unit size
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
        size = np.sqrt(np.mean(theta**2, axis=0))
        x, y = theta / size, y / scale
        errors = {
            t: float(np.mean((y[split:] - x[split:] @ _sparse(x[:split], y[:split], t)) ** 2))
            for t in THRESHOLDS
        }
        weights[:, j] = _sparse(x, y, min(errors, key=errors.__getitem__)) * scale / size
    named = {
        f"{name.partition(' ')[0]}@{joint}": None
        for j, joint in enumerate(robot.joints)
        for name, w in zip(LIBRARY, weights[:, j], strict=True)
        if w
    }

    def torque(q: Array, v: Array, a: Array) -> Array:
        return robot.inverse_dynamics(q, v, a) + np.einsum("kjp,pj->kj", _features(robot, q, v, a), weights)

    return Answer(tuple(named), torque)


def _sparse(x: Array, y: Array, threshold: float) -> Array:
    fitted = STLSQ(threshold=threshold, alpha=RIDGE, max_iter=30).fit(x, y[:, None])
    return np.ravel(fitted.coef_)


def _features(robot: RobotModel, q: Array, v: Array, a: Array) -> Array:
    tau = robot.inverse_dynamics(q, v, a)
    return np.stack([f(q, v, a, tau) for f in LIBRARY.values()], axis=-1)
