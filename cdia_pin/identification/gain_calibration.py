r"""Calibration of drive gains by a payload of known mass.

The torque that a log states is the true one over an unknown scale k of each joint. With u = 1 / k,

.. math:: \tau_j = C_j\,\gamma_j + u_j\, Y_j\,(m, m c, I), \qquad u \sim \mathcal N(1, \Sigma)

where the payload's column Y is zero in the logs without it. C holds what the logs have in common, for each joint on its
own: the inertial parameters of all links, and a friction of each log. So an error of the URDF, or friction that changed
between the logs, does not enter the scale. The mass m is known; its centre c and inertia I are fitted. The scales of an
arm are alike before any data, so joints that the weight does not load get the scale of the others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.effects import Payload
from cdia_pin.errors import LogError
from cdia_pin.logs.checks.effort_kind import GravityGain, gravity_gains
from cdia_pin.logs.checks.motion import motion_of
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.logs.gains import NOMINAL_TOLERANCE
from cdia_pin.logs.log import Log
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.intervals import NORMAL_95
from cdia_pin.robot.model import RobotModel
from cdia_pin.version import __version__

Array = NDArray[np.float64]

BLOCKS = 16  # parts of the logs [1] whose residuals count as independent: they repeat with the posture
# RMS share of a residual [1] that goes along with the weight through a whole log, because one motion shows of the links
# and of friction what another does not. Weights put into logs of a UR10e by calculation show 0.05 to 0.15.
COHERENT = 0.07
ITERATIONS = 20  # of Gauss-Newton [1]; the scale and the centre of mass multiply each other
HEAVIEST = 1e4  # [kg], more than any arm carries
FARTHEST = 0.3  # [m], prior standard deviation of the centre of mass from the tool frame
WIDEST = 0.05  # [m²], prior standard deviation of the inertia over the mass
REPEATED = 1e-6  # ridge of the common columns in units of their RMS [1]: some repeat each other
LARGEST = 4.0  # [1], either way; a scale beyond it is another mass, another unit or no payload
DETERMINED = (
    0.5  # tolerance over the one before [1] from which the weight itself has told the scale of a joint
)


class CalibrationRecord(TypedDict):
    """A calibration in JSON, schema ``cdia-calibration/1``; by joint, as the properties of `GainCalibration`."""

    schema: str
    version: str
    payload: dict[str, object]
    scale: dict[str, dict[str, float]]
    gains: dict[str, dict[str, float]]
    determined: dict[str, bool]
    by_own_weight: dict[str, float]


@dataclass(frozen=True)
class GainCalibration:
    """Scales of the torque of each joint.

    Attributes:
        joints: Names of the joints (n of them).
        scale: True torque over the stated one [1], shape (n,).
        tolerance: Half widths of the 95 % intervals of the scales [1], shape (n,).
        prior_tolerance: The same before the calibration [1], shape (n,).
        mass: Mass of the payload, as it is known [kg].
        centre: Its centre of mass in the tool frame, as it was fitted [m], shape (3,).
        own_weight: Gravity of the arm in its torque over that of the URDF, with a standard error, where it shows.
    """

    joints: tuple[str, ...]
    scale: Array
    tolerance: Array
    prior_tolerance: Array
    mass: float
    centre: Array
    own_weight: Mapping[str, GravityGain]

    @property
    def determined(self) -> NDArray[np.bool_]:
        """True for joints whose scale follows from the weight on them; others have the common one, shape (n,)."""
        return self.tolerance < DETERMINED * self.prior_tolerance

    @property
    def by_own_weight(self) -> dict[str, float]:
        """Scale [1] that the arm's own weight by its URDF asks for, of joints on which it shows."""
        known = {j: g for j, g in self.own_weight.items() if g.known and not g.absent}
        return {j: 1.0 / g.gain for j, g in known.items() if g.gain > 0}

    def gains(self, nominal: Array | None = None) -> dict[str, dict[str, float]]:
        """Return calibrated gains as ``--gains`` reads them.

        Args:
            nominal: Gains with which the logs were read [N·m/A], shape (n,); None where they hold torques.
        """
        unit = np.ones(len(self.joints)) if nominal is None else nominal
        rows = zip(self.joints, unit * self.scale, unit * self.tolerance, strict=True)
        return {j: {"value": float(f"{v:.6g}"), "tolerance": float(f"{t:.3g}")} for j, v, t in rows}

    def to_dict(self, nominal: Array | None = None) -> CalibrationRecord:
        """Return the calibration for JSON, schema ``cdia-calibration/1``.

        Args:
            nominal: As in `gains`.
        """
        rows = zip(self.joints, self.scale, self.tolerance, strict=True)
        return {
            "schema": schemas.CALIBRATION,
            "version": __version__,
            "payload": {"mass": self.mass, "centre": self.centre.tolist()},
            "scale": {j: {"value": float(k), "tolerance": float(t)} for j, k, t in rows},
            "gains": self.gains(nominal),
            "determined": dict(zip(self.joints, self.determined.tolist(), strict=True)),
            "by_own_weight": self.by_own_weight,
        }


def calibrate_gains(
    robot: RobotModel,
    loaded: Sequence[Log],
    unloaded: Sequence[Log],
    mass: float,
    conditioning: Conditioning | None = None,
) -> GainCalibration:
    """Fit the scale of each joint's torque by a payload of known mass.

    Args:
        robot: The arm, n joints.
        loaded: Logs with the payload on the tool.
        unloaded: Logs without it; their motions may be others, but should reach the same postures.
        mass: Mass of the payload [kg].
        conditioning: How logs are filtered.

    Raises:
        LogError: If no arm carries the mass, a log is missing or too short, or the logs do not show the payload.
    """
    if not 0 < mass <= HEAVIEST:
        raise LogError(f"a known payload has a mass above 0 kg and up to {HEAVIEST:g} kg, given {mass:g}")
    if not loaded or not unloaded:
        raise LogError("a calibration needs a log with the payload and one without it")
    given = [*unloaded, *loaded]
    experiment = Experiment.of(robot, [condition(log, robot, conditioning) for log in given])
    rows = [_beside_common(experiment, j, len(unloaded), mass) for j in range(robot.n)]
    tolerance = _stated_tolerance(given, robot.n)
    stated = (tolerance / NORMAL_95) ** 2  # as much for the arm as for each joint of it
    of_arm = np.sqrt(np.outer(stated, stated))
    prior = of_arm + np.diag(stated)
    scale, spread, body = _fitted(robot.joints, rows, mass, prior)
    far = np.abs(1.0 / scale - 1.0)  # a tolerance that the weight contradicts is no knowledge
    contradicted = far > NORMAL_95 * np.sqrt(np.diag(prior))
    if contradicted.any():
        own = np.where(contradicted, far**2, stated)
        scale, spread, body = _fitted(robot.joints, rows, mass, of_arm + np.diag(own))
    motion = motion_of(unloaded[0], robot.is_prismatic)
    return GainCalibration(
        robot.joints,
        scale,
        NORMAL_95 * spread,
        NORMAL_95 * np.sqrt(np.diag(prior)),
        mass,
        body[:3] / mass,
        {} if motion is None else {robot.joints[k]: g for k, g in gravity_gains(motion, robot).items()},
    )


def _stated_tolerance(logs: Sequence[Log], n: int) -> Array:
    """Return the tolerance of the torques [1], the nominal one where no log states any, shape (n,)."""
    stated = [log.effort_tolerance for log in logs if log.effort_tolerance is not None]
    widest = np.max(stated, axis=0) if stated else np.zeros(n)
    return np.where(widest > 0, widest, NOMINAL_TOLERANCE)


def _beside_common(experiment: Experiment, j: int, unloaded: int, mass: float) -> Array:
    """Return the payload's ten columns and the torque of one joint without what the logs have in common, (K, 11)."""
    common, payload, effort = [], [], []
    for k, s in enumerate(experiment.segments):
        x = s.state
        sign, v = x.sign[:, j], x.v[:, j]
        friction = np.zeros((len(x), 3 * len(experiment.segments)))
        friction[:, 3 * k : 3 * k + 3] = np.column_stack([sign, v, np.ones(len(x))])  # of each log its own
        body = -Payload().basis(x)[:, j, :] * float(k >= unloaded)
        # friction grows with the load; a measured torque that is mostly friction would be a regressor of itself
        load = np.abs(x.rigid_torque[:, j] + mass * body[:, 0])
        alike = [load * sign, np.abs(v) * v, x.a[:, j]]
        links = experiment.robot.torque_regressor(x.q, x.v, x.a)[:, j, :]
        common.append(s.motion.compared(np.column_stack([links, friction, *alike])))
        payload.append(s.motion.compared(body))
        effort.append(s.measured[:, [j]])
    use = experiment.informative[:, j]
    columns, rest = np.vstack(common)[use], np.column_stack([np.vstack(payload), np.vstack(effort)])[use]
    size = np.sqrt(np.mean(columns**2, axis=0))
    seen = size > 1e-9 * size.max()
    columns = columns[:, seen] / size[seen]
    gram = columns.T @ columns + REPEATED * len(columns) * np.eye(columns.shape[1])
    return np.asarray(rest - columns @ np.linalg.solve(gram, columns.T @ rest))


def _fitted(
    joints: Sequence[str], rows: Sequence[Array], mass: float, prior: Array
) -> tuple[Array, Array, Array]:
    """Return the scales, their standard deviations, shape (n,), and the payload's parameters but its mass, (9,)."""
    n = len(rows)
    precision = np.zeros((n + 9, n + 9))
    precision[:n, :n] = np.linalg.inv(prior)
    precision[n:, n:] = np.diag(1.0 / np.array([FARTHEST * mass] * 3 + [WIDEST * mass] * 6) ** 2)
    mean = np.concatenate([np.ones(n), np.zeros(9)])
    at = mean.copy()
    for _ in range(ITERATIONS):
        normal, right = precision.copy(), precision @ (mean - at)
        for j, row in enumerate(rows):
            body = np.concatenate([[mass], at[n:]])
            alone = row[:, :10] @ body
            left = row[:, 10] - at[j] * alone
            slope = np.zeros((len(row), n + 9))
            slope[:, j], slope[:, n:] = alone, at[j] * row[:, 1:10]
            weight = 1.0 / _variance(left, alone)
            normal += weight * slope.T @ slope
            right += weight * slope.T @ left
        at = at + np.linalg.solve(normal, right)
    inverse, spread = at[:n], np.sqrt(np.diag(np.linalg.inv(normal)))[:n]
    shown = _shown(spread, np.sqrt(np.diag(prior)))
    if not shown.any() or (inverse <= 0).any():
        raise LogError("the logs do not show the payload: is the first log the one with it?")
    far = shown & ((inverse < 1 / LARGEST) | (inverse > LARGEST))
    if far.any():
        j = int(np.argmin(np.where(far, spread, np.inf)))
        raise LogError(
            f"the torque of {joints[j]} shows {inverse[j] * mass:.2g} kg of the {mass:g} kg: is the first log the one "
            "with the payload, is its mass in kg, and are the torques in N·m?"
        )
    return 1.0 / inverse, spread / inverse**2, at[n:]


def _shown(spread: Array, before: Array) -> NDArray[np.bool_]:
    """Tell which joints show the payload: the logs would determine a scale that is known as well as nominal ones, (n,).

    Args:
        spread: Standard deviation of each scale with the logs [1], shape (n,).
        before: The same without the logs [1], shape (n,).
    """
    usual = np.maximum(before, NOMINAL_TOLERANCE / NORMAL_95)
    told = np.maximum(1.0 / spread**2 - 1.0 / before**2, 0.0)
    return np.asarray(1.0 / np.sqrt(told + 1.0 / usual**2) < DETERMINED * usual)


def _variance(left: Array, alone: Array) -> float:
    """Return the variance of a residual, larger by what repeats in its blocks and along the logs [(N·m)²].

    The residual is that at the scale which suits this joint best. Else a wrong scale makes its own evidence weak.
    """
    left = left - alone * (alone @ left) / max(float(alone @ alone), 1e-12)
    plain = float(np.mean(left**2)) * (1.0 + COHERENT**2 * len(left))
    parts = np.array_split(np.arange(len(left)), BLOCKS)
    scatter = float(sum((alone[p] @ left[p]) ** 2 for p in parts))
    return max(plain, scatter / max(float(alone @ alone), 1e-12), 1e-18)
