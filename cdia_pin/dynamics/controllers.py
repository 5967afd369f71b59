r"""Controllers of a simulated arm: computed torque, the nominal control law.

.. math:: \tau = M(q)\,[\ddot q_d - K_p (q - q_d) - K_v (\dot q - \dot q_d)] + \mathrm{nle} - f

with M, nle and f of the controller's own model [Siciliano2009]. A model with terms compensates them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.dynamics.trajectories import Reference
from cdia_pin.effects import State
from cdia_pin.errors import ModelError

Array = NDArray[np.float64]


class Controller(Protocol):
    """A control law: a torque for each reading, once per step of the simulation."""

    def __call__(self, t: float, q: Array, v: Array, reference: Reference) -> Array:
        """Compute the torque to command.

        Args:
            t: Time [s].
            q: Positions as read [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
            reference: The desired motion at that time.

        Returns:
            Torques [N·m or N], shape (n,).
        """
        ...


@dataclass(frozen=True)
class ComputedTorque:
    """Feedback that makes the arm behave as unit masses on springs and dampers, if the model is right.

    Attributes:
        model: The controller's model of the arm; `Dynamics(robot)` without terms gives the nominal control law.
        stiffness: K_p [1/s²].
        damping: K_v [1/s]; 2 √K_p is critical damping.
        sign_width: Speed below which the model's friction is compensated only in part [rad/s or m/s]; a
            narrow width compensates too much at rest.
        limited: True if torques stay within the robot's effort limits.
    """

    model: Dynamics
    stiffness: float = 400.0
    damping: float = 40.0
    sign_width: float = 0.05
    limited: bool = True

    def __post_init__(self) -> None:
        if not (self.stiffness >= 0 and self.damping >= 0 and self.sign_width > 0):
            raise ModelError(
                "a controller needs stiffness ≥ 0, damping ≥ 0 and sign_width > 0, given "
                f"{self.stiffness}, {self.damping}, {self.sign_width}"
            )

    def __call__(self, t: float, q: Array, v: Array, reference: Reference) -> Array:
        """Compute the torque to command.

        Args:
            t: Time [s].
            q: Positions as read [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
            reference: The desired motion at that time.

        Returns:
            Torques [N·m or N], shape (n,).
        """
        a = reference.a - self.stiffness * (q - reference.q) - self.damping * (v - reference.v)
        robot = self.model.robot
        if self.model.terms:
            x = State.of(robot, q, v, a, effort=np.zeros_like(q), time=t, sign_width=self.sign_width)
            tau = self.model.torques(x).actuator[0]
        else:
            tau = robot.torque(np.asarray(q, float), np.asarray(v, float), a)
        if self.limited:
            most = robot.limits.effort
            tau = np.minimum(np.maximum(tau, -most), most)
        return np.asarray(tau)
