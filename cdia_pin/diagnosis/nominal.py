"""The nominal model of the healthy arm, taken apart into what a tick can evaluate quickly."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import (
    BaseTilt,
    EffortDelay,
    EncoderOffset,
    JointEffect,
    Signal,
    State,
    Term,
    Varying,
)
from cdia_pin.errors import ModelError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Nominal:
    """A model of the healthy arm.

    Attributes:
        robot: The rigid bodies, with the bodies and the tilt that the model adds to them.
        of_joints: Terms of one joint that are always present; the compiled tick evaluates them.
        others: All other terms; they are evaluated in Python at every tick, in tens of microseconds.
        offset: Angle to add to the encoders' readings [rad or m], shape (n,).
        delay: Delay of the torques after their signal [s].
        masses: Inertial parameters by which healthy runs corrected the robot, shape (n, 10); None without.
    """

    robot: RobotModel
    of_joints: tuple[Term, ...]
    others: Dynamics
    offset: Array
    delay: float
    masses: Array | None = None

    @classmethod
    def of(cls, model: Dynamics) -> Nominal:
        """Take a model apart.

        Args:
            model: The healthy arm.

        Raises:
            ModelError: If a link has no mass with what the model adds to it, a delay is of one joint only, or an effect
                has memory that it cannot do without, or depends on temperature.
        """
        robot, of_joints, others = model.robot, [], []
        offset, delay = np.zeros(robot.n), 0.0
        pi, g = robot.inertial_parameters.copy(), robot.gravity_vector
        for term in map(_steady, model.terms):
            effect, theta = term.effect, np.array(term.theta)
            always = term.profile.kind == "always"
            if always and effect.bodies:
                pi += effect.on_links(theta, robot)
            elif always and isinstance(effect, BaseTilt):
                g = g + effect.tilt(robot, theta)
            elif always and isinstance(effect, EncoderOffset):
                offset += effect.offset(robot, theta)
            elif isinstance(effect, EffortDelay):
                if effect.scope:
                    raise ModelError("a monitor takes one delay for all torques, not of one joint")
                delay -= float(theta[0])
            elif always and isinstance(effect, JointEffect) and effect.name != "unknown":
                of_joints.append(term)
            else:
                others.append(term)
        if not np.array_equal(pi, robot.inertial_parameters):
            if not (pi[:, 0] > 0).all():
                raise ModelError("a link of the model has no mass left; a monitor needs masses above 0")
            robot = robot.with_inertial_parameters(pi)
        if not np.array_equal(g, robot.gravity_vector):
            robot = robot.with_gravity(g)
        return cls(robot, tuple(of_joints), Dynamics(robot, tuple(others)), offset, delay)

    def corrected(self, delay: float, masses: Array | None) -> Nominal:
        """Return the model with another delay, and with other inertial parameters where they are given.

        Args:
            delay: Delay of the torques after their signal [s].
            masses: Inertial parameters of the links, shape (n, 10), or None.
        """
        if masses is None:
            return replace(self, delay=delay)
        robot = self.robot.with_inertial_parameters(masses)
        return replace(
            self, robot=robot, others=replace(self.others, robot=robot), delay=delay, masses=masses
        )

    def outside(self, q: Array, v: Array, a: Array, tau: Array, time: float, width: Array) -> Array:
        """Return the torque of the other terms [N·m or N], shape (n,).

        Args:
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
            a: Accelerations [rad/s² or m/s²], shape (n,).
            tau: Torques [N·m or N], shape (n,).
            time: Time [s].
            width: Speed over which sgn q̇ is smoothed [rad/s or m/s], shape (n,).
        """
        x = State.of(self.robot, q, v, a, effort=tau, time=time, sign_width=width)
        torque: Array = self.others.missing_torque(x)[0]
        return torque


def _steady(term: Term) -> Term:
    """Return a term as a monitor can hold it: where the past has no weight, and as it was in the mean of its logs.

    A drift belongs to the clock of its log, and says nothing about another day; the thresholds cover what it drifts.

    Raises:
        ModelError: If the effect has memory and is nothing else, or depends on temperature.
    """
    if isinstance(term.effect, Varying):
        term = Term(term.effect.effect, term.effect.mean(term.theta), term.profile)
    effect = term.effect.steady
    if effect is None:
        raise ModelError(f"a monitor cannot hold effects with memory yet: {term.label}")
    if Signal.TEMPERATURE in effect.traits.depends_on:
        raise ModelError(f"a monitor is not given temperatures, which {term.label} depends on")
    return replace(term, effect=effect)
