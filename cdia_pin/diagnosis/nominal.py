"""What the monitor holds for healthy: a model, taken apart into what a tick can evaluate quickly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import (
    BaseTilt,
    EffortDelay,
    EncoderOffset,
    JointEffect,
    State,
    Term,
    Varying,
)
from cdia_pin.errors import ModelError
from cdia_pin.robot.inertia import is_physical
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Nominal:
    """A model of the healthy arm.

    Attributes:
        robot: The rigid body, with the bodies and the tilt that the model adds to it.
        of_joints: Terms of one joint that are always present, evaluated by the compiled tick.
        others: All other terms, evaluated in Python at every tick, which takes tens of microseconds.
        offset: What encoders read too little [rad or m], shape (n,).
        delay: By how much the torque acts later than its signal says [s].
    """

    robot: RobotModel
    of_joints: tuple[Term, ...]
    others: Dynamics
    offset: Array
    delay: float

    @classmethod
    def of(cls, model: Dynamics) -> Nominal:
        """Take a model apart.

        Raises:
            ModelError: If a body of it is impossible, a delay differs from joint to joint, or an effect has memory.
        """
        _require_no_memory(model)
        robot, of_joints, others = model.robot, [], []
        offset, delay = np.zeros(robot.n), 0.0
        pi, g = robot.inertial_parameters.copy(), robot.gravity_vector
        for term in model.terms:
            effect, theta = term.effect, np.array(term.theta)
            always = term.profile.kind == "always"
            if always and effect.bodies and not isinstance(effect, Varying):
                for body, part in effect.by_body(theta):
                    pi[body.carrier(robot)] += body.in_joint_frame(part, robot)
            elif always and isinstance(effect, BaseTilt):
                g = g + effect.tilt(robot, theta)
            elif always and isinstance(effect, EncoderOffset):
                offset += effect.offset(robot, theta)
            elif isinstance(effect, EffortDelay):
                if effect.scope:
                    raise ModelError("a monitor takes a delay of all torques alike, not of one joint")
                delay -= float(theta[0])
            elif always and isinstance(effect, JointEffect) and effect.name != "unknown":
                of_joints.append(term)
            else:
                others.append(term)
        if not np.array_equal(pi, robot.inertial_parameters):
            if not all(is_physical(p, 1e-6) for p in pi):
                raise ModelError(
                    "the bodies of the model are not possible; a monitor needs a model that can be"
                )
            robot = robot.with_inertial_parameters(pi)
        if not np.array_equal(g, robot.gravity_vector):
            robot = robot.with_gravity(g)
        return cls(robot, tuple(of_joints), Dynamics(robot, tuple(others)), offset, delay)

    def outside(self, q: Array, v: Array, a: Array, tau: Array, time: float, width: Array) -> Array:
        """Return the torque of the other terms [N·m or N], shape (n,)."""
        x = State.of(self.robot, q, v, a, effort=tau, time=time, sign_width=width)
        return self.others.missing_torque(x)[0]


def _require_no_memory(model: Dynamics) -> None:
    labels = [t.label for t in model.terms if t.effect.memories]
    if labels:
        raise ModelError(f"a monitor cannot hold effects with memory yet: {', '.join(labels)}")
