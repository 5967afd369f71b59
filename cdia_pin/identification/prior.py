r"""The prior of an identification: a metric of inertial parameters that scales with the body itself.

The Riemannian metric of pseudo-inertias, taken at the URDF [Lee2020]: a change dJ of the pseudo-inertia J has length

.. math:: \|d\pi\|^2 = \tfrac12 \, \mathrm{tr}(J^{-1} dJ \; J^{-1} dJ)

It does not depend on units or axes, and is 2 for a body that becomes twice itself.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from cdia_pin.effects import ActuatorGain, RotorInertia
from cdia_pin.effects.body import Body
from cdia_pin.effects.link_inertias import LEAST_MASS, LEAST_RADIUS
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.whitening import Whitening
from cdia_pin.robot.inertia import pseudo_inertia
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# Prior standard deviation of an effect in a joint, as its RMS torque over the joint's RMS torque [1].
LARGEST_SHARE = 1.0
# Prior standard deviation of a drive's gain [1]. Links, friction and rotor of a joint grow together with its gain and
# leave the same torque, so that only what is known beforehand separates them: nominal gains are right to 10 %.
GAIN_TOLERANCE = 0.1


def precision(
    equations: NormalEquations, experiment: Experiment, whitening: Whitening, strength: float
) -> Array:
    """Return the precision of the prior around the URDF without friction.

    The prior on bodies keeps them near the URDF. The prior on effects in a joint is weak: it only keeps those small
    that the motion does not show. Its standard deviation is the joint's own torque, or for a rotor the inertia of the
    arm behind it.

    Args:
        equations: Normal equations, for the effects and the size of their columns.
        experiment: The conditioned logs.
        whitening: Noise of each joint.
        strength: Strength of the prior on bodies around the URDF [1].

    Returns:
        Shape (P, P).
    """
    robot = experiment.robot
    sigma = np.array([float(np.mean(m.sigma)) for m in whitening.noise])
    count = whitening.used.sum(axis=0)
    energy = count * (rms(experiment.measured, whitening.used) / sigma) ** 2  # whitening torque
    inertia = _inertia(experiment)
    blocks = []
    for effect, span in zip(equations.effects, equations.parameters, strict=True):
        joints = list(effect.acts_on(robot))
        own = np.diag(equations.total)[span] / np.maximum(energy[joints].sum(), 1e-300)
        if isinstance(effect, Body):
            blocks.append(strength * urdf_precision(effect, robot))
        elif isinstance(effect, RotorInertia):
            blocks.append(np.eye(1) / inertia.max() ** 2)
        elif isinstance(effect, ActuatorGain):
            blocks.append(np.eye(1) / GAIN_TOLERANCE**2)
        else:
            blocks.append(np.diag(own / LARGEST_SHARE**2 + 1e-12))
    return np.asarray(block_diag(*blocks))


def urdf_precision(body: Body, robot: RobotModel) -> Array:
    """Return the precision of a body's parameters around the URDF at strength 1.

    Args:
        body: The body.
        robot: The arm.

    Returns:
        Shape (10, 10).
    """
    link = robot.inertial_parameters[body.carrier(robot)]
    A = body.to_joint_frame(robot)
    return A.T @ metric(_solid(pseudo_inertia(link), LEAST_MASS * robot.total_mass)) @ A


def metric(J: Array) -> Array:
    """Return the metric of inertial parameters at a pseudo-inertia.

    Args:
        J: Pseudo-inertia of full rank, shape (4, 4).

    Returns:
        Shape (10, 10).
    """
    relative = np.linalg.inv(J) @ pseudo_inertia(np.eye(10))  # J⁻¹ dJ for each parameter, (10, 4, 4)
    return np.asarray(0.5 * np.einsum("aij,bji->ab", relative, relative))


def _solid(J: Array, least_mass: float) -> Array:
    """Return a pseudo-inertia with at least the smallest mass and radius of a link, shape (4, 4)."""
    mass = max(J[3, 3], least_mass)
    centre = J[:3, 3] / J[3, 3] if J[3, 3] > 0 else np.zeros(3)
    about_centre = J[:3, :3] - J[3, 3] * np.outer(centre, centre)
    values, vectors = np.linalg.eigh(about_centre)
    about_centre = (vectors * np.maximum(values, mass * LEAST_RADIUS**2)) @ vectors.T
    out = np.empty((4, 4))
    out[:3, :3] = about_centre + mass * np.outer(centre, centre)
    out[:3, 3] = out[3, :3] = mass * centre
    out[3, 3] = mass
    return out


def _inertia(experiment: Experiment) -> Array:
    """Return the mean inertia of the arm about each joint in the first log [kg·m² or kg], shape (n,)."""
    q = experiment.segments[0].state.q
    some = q[:: max(len(q) // 20, 1)]
    return np.asarray(np.mean([np.diag(experiment.robot.mass_matrix(x)) for x in some], axis=0))
