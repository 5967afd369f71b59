r"""Memory: the internal state of an effect whose torque depends on the past.

.. math:: z_{k+1} = g(z_k, x_k, \Delta q_k, \Delta t_k), \qquad f_k = \Phi(x_k, z_k)\,\theta

The state z depends on the motion and on the effect's shape, not on θ: f stays linear in θ, and terms of one effect with
different parameters share their state. A simulation steps it; along a log it is found from the motion.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.state import State
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


class Memory(ABC):
    """The internal state z of an effect, shape (m,); the effect itself is its only subclass."""

    @abstractmethod
    def initial_state(self, robot: RobotModel) -> Array:
        """Return z where nothing is known of the past, shape (m,).

        Args:
            robot: The arm, n joints.
        """

    @abstractmethod
    def advance(self, z: Array, x: State, dq: Array, dt: float) -> Array:
        """Return z after a step of the motion, shape (m,).

        Args:
            z: At the beginning of the step, shape (m,).
            x: One sample at the beginning of the step.
            dq: Motion during the step [rad or m], shape (n,).
            dt: Duration of the step [s], above 0.
        """

    def along(self, x: State) -> Array:
        """Return z at each sample of a motion, shape (N, m).

        It begins as `State.memory` has it and follows the time: where time stands still, z is kept; where time goes
        back, as from one log to the next, z begins anew.

        Args:
            x: Motion and torques, N samples.
        """
        start = self.initial_state(x.robot)
        z = np.asarray(x.memory.get(self, start), float)
        out = np.tile(z, (len(x), 1))
        duration, motion = np.diff(x.time), np.diff(x.q, axis=0)
        if not duration.any():
            return out
        for k, (dt, dq) in enumerate(zip(duration.tolist(), motion, strict=True)):
            if dt < 0:
                z = start
            elif dt > 0:
                z = self.advance(z, x.sample(k), dq, dt)
            out[k + 1] = z
        return out
