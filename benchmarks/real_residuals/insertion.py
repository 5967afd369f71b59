"""An effect of known size put into a measured log: M q̈ + nle = τ + f, so the torque becomes τ − f."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.real_residuals.filtered import FilteredLog
from cdia_pin.effects import Signal, State, Term
from cdia_pin.effects.actuation import ActuatorGain
from cdia_pin.effects.body import Body
from cdia_pin.effects.sensing import EffortDelay, EncoderOffset
from cdia_pin.logs import Log

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Insertion:
    """An effect that is put into a log, or taken out again.

    Attributes:
        term: The effect with its numbers.
        along: The log without it.
    """

    term: Term
    along: FilteredLog

    def torque(self) -> Array:
        """Return the torque f that the model misses along the filtered motion [N·m or N], shape (N, n)."""
        return self._torque(self.along.state)

    def _torque(self, x: State) -> Array:
        effect = self.term.effect
        if isinstance(effect, Body):
            return self._of_body(effect, x)
        if isinstance(effect, EncoderOffset):  # the joint is at q, the encoder will read q − δ
            read = x.with_position(x.q - self.term.shift(x))
            return self.term.torque(read)
        if Signal.TORQUE in self.term.depends_on and not isinstance(effect, EffortDelay):
            return x.effort - self._driven(x)
        return self.term.torque(x)

    def into(self, log: Log) -> Log:
        """Return a log with the effect.

        Args:
            log: The log of `along`.
        """
        return self._changed(log, 1.0)

    def out_of(self, log: Log) -> Log:
        """Return a log without the effect, as it was before `into`.

        Args:
            log: The log of `along` with the effect.
        """
        return self._changed(log, -1.0)

    def _changed(self, log: Log, sign: float) -> Log:
        effect, theta = self.term.effect, np.array(self.term.theta)
        if isinstance(effect, EncoderOffset):
            return replace(log, position=log.position - sign * effect.offset(self.along.robot, theta))
        effort = log.effort.copy()
        if isinstance(effect, ActuatorGain):
            effort[:, effect.acts_on(self.along.robot)] /= (1.0 + theta[0]) ** sign
        elif isinstance(effect, EffortDelay):
            joints = list(effect.acts_on(self.along.robot))
            earlier = log.time - sign * theta[0]
            effort[:, joints] = np.column_stack(
                [np.interp(earlier, log.time, log.effort[:, j]) for j in joints]
            )
        else:
            effort -= sign * self._torque(self.along.state_of_log)
        return replace(log, effort=effort)

    def _of_body(self, effect: Body, x: State) -> Array:
        """Return the torque of the arm without the body, less that of the arm with it."""
        robot = self.along.robot
        bodies = robot.inertial_parameters.copy()
        bodies[effect.carrier(robot)] = effect.total(np.array(self.term.theta), robot)
        heavier = robot.with_inertial_parameters(bodies)
        return x.rigid_torque - heavier.inverse_dynamics(x.q, x.v, x.a)

    def _driven(self, x: State) -> Array:
        """Return the torque that the drives need with an effect in proportion to it [N·m or N], shape (N, n)."""
        share = np.divide(self.term.torque(x), x.effort, out=np.zeros_like(x.effort), where=x.effort != 0)
        return x.effort / (1.0 + share)
