r"""Base parameters: the combinations of inertial parameters on which torques depend, and how well a log shows them.

A torque regressor has dependent columns: :math:`Y = Y_b [\,1 \; K\,]`, so that :math:`Y \pi = Y_b (\pi_b + K \pi_d)`
[Gautier1991].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cdia_pin.robot.inertia import PARAMETER_NAMES, PARAMETER_UNITS
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

SAMPLES = 200  # random states [1] from which dependent columns are found; 200 give many rows per column
INDEPENDENT = (
    1e-8  # norm of what the columns before it leave of a column, over its own norm [1]; below it is rounding
)
# Standard deviation after the log over that before [1], below which a parameter counts as identified.
IDENTIFIED = 1.0 / 3.0
REACH = 1.0  # range of joints without limits [rad or m]


@dataclass(frozen=True, repr=False)
class BaseParameters:
    """Identified base parameters of an arm. Arrays have shape (n_b,) and the unit of each parameter.

    Attributes:
        names: The first standard parameter of each combination, such as ``elbow_joint.mx``.
        units: Unit of each parameter.
        grouped: Number of other standard parameters in each combination [1].
        urdf: Values of the URDF.
        value: Identified values.
        deviation: Standard deviations of the identified values, if the scale of the torques is right.
        half_width: Half widths of their 95 % intervals, with the tolerance of that scale.
        identifiable: True for parameters that this log identifies; the prior around the URDF determines the others.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    grouped: NDArray[np.intp]
    urdf: Array
    value: Array
    deviation: Array
    half_width: Array
    identifiable: NDArray[np.bool_]

    def __repr__(self) -> str:
        return f"BaseParameters({len(self)}, {int(self.identifiable.sum())} of them identified by the log)"

    def __len__(self) -> int:
        return len(self.names)

    @property
    def moved(self) -> Array:
        """Distance from the URDF in standard deviations [1]."""
        return np.abs(self.value - self.urdf) / np.maximum(self.deviation, 1e-300)


def base_parameters(
    robot: RobotModel,
    change: Array,
    covariance: Array,
    prior_covariance: Array,
    quantile: float,
    tolerance: Array,
) -> BaseParameters:
    """Reduce inertial parameters to those on which torques depend.

    Args:
        robot: The arm.
        change: Difference of all links' parameters from the URDF, shape (10 n,).
        covariance: Covariance of this difference, shape (10 n, 10 n).
        prior_covariance: Covariance before the log, shape (10 n, 10 n).
        quantile: Half width of a 95 % interval over the standard deviation [1].
        tolerance: Tolerance of the scale of each joint's torque, 95 % [1], shape (n,). A link acts on all joints before
            it.
    """
    first, reduction = base_reduction(robot)
    urdf = robot.inertial_parameters.ravel()
    deviation, prior_deviation = (
        np.sqrt(np.maximum(np.einsum("bi,ij,bj->b", reduction, c, reduction), 0.0))
        for c in (covariance, prior_covariance)
    )
    value = reduction @ (urdf + change)
    scale = np.array([tolerance[: k // 10 + 1].mean() for k in first])
    return BaseParameters(
        names=tuple(f"{robot.joints[k // 10]}.{PARAMETER_NAMES[k % 10]}" for k in first),
        units=tuple(PARAMETER_UNITS[k % 10] for k in first),
        grouped=np.count_nonzero(reduction, axis=1) - 1,
        urdf=reduction @ urdf,
        value=value,
        deviation=deviation,
        half_width=np.hypot(quantile * deviation, scale * np.abs(value)),
        identifiable=deviation < IDENTIFIED * prior_deviation,
    )


@lru_cache(maxsize=16)
def base_reduction(robot: RobotModel) -> tuple[tuple[int, ...], Array]:
    """Return the first standard parameter of each base parameter, and the linear map from standard to base parameters.

    Columns are taken from the base to the tool: what a link shares with a link nearer to the base is added to the
    parameters of the latter.

    Args:
        robot: The arm.

    Returns:
        Indices into the 10 n standard parameters, and the reduction L with π_base = L π, shape (n_b, 10 n).
    """
    rng = np.random.default_rng(0)
    limits = robot.limits
    free = ~(np.isfinite(limits.lower) & np.isfinite(limits.upper))
    low, high = np.where(free, -REACH, limits.lower), np.where(free, REACH, limits.upper)
    q = rng.uniform(low, high, (SAMPLES, robot.n))
    v, a = rng.normal(size=(2, SAMPLES, robot.n))
    Y = robot.torque_regressor(q, v, a).reshape(-1, 10 * robot.n)
    norm = np.linalg.norm(Y, axis=0)
    at = np.flatnonzero(norm > INDEPENDENT * norm.max()).astype(int)
    R: Array = np.asarray(np.linalg.qr(Y[:, at] / norm[at], mode="r"))
    lead = np.abs(np.diag(R)) > INDEPENDENT
    b, d = (np.flatnonzero(x).astype(int) for x in (lead, ~lead))
    K = np.linalg.solve(R[np.ix_(b, b)], R[np.ix_(b, d)])
    reduction = np.zeros((len(b), 10 * robot.n))
    reduction[np.arange(len(b)), at[b]] = 1.0
    reduction[:, at[d]] = K * norm[at[d]] / norm[at[b], None]
    reduction[np.abs(reduction) < 1e-9] = 0.0
    return tuple(int(k) for k in at[b]), reduction
