"""The terms of a model that a URDF can state, and those that it cannot."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics.physical import unphysical
from cdia_pin.effects import (
    ALWAYS,
    CoulombFriction,
    LinkInertia,
    LinkInertias,
    Payload,
    Term,
    ViscousFriction,
)
from cdia_pin.errors import ModelError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

BOUNDARY = (
    0.01  # [1], by which a fit may pass a bound, relative to its largest parameter; the URDF gets the bound
)


class UrdfChanges(TypedDict):
    """Arguments of ``write_corrected_urdf``; keys and units as the attributes of `UrdfValues`."""

    inertial: dict[str, Array]
    damping: dict[str, float]
    friction: dict[str, float]
    payload: Array | None


@dataclass(repr=False)
class UrdfValues:
    """Values of a model's terms that a URDF can state.

    Attributes:
        inertial: Inertial parameters [kg, kg·m, kg·m²], shape (10,), by joint, as ``write_corrected_urdf`` takes them.
        damping: Viscous friction by joint [N·m·s/rad or N·s/m].
        friction: Coulomb friction by joint [N·m or N].
        payload: Inertial parameters of the payload, shape (10,) or (4,); None without a payload.
        written: Labels of the terms that a URDF can state.
        left_out: Labels of the other terms, with the reason.
    """

    inertial: dict[str, Array] = field(default_factory=dict)
    damping: dict[str, float] = field(default_factory=dict)
    friction: dict[str, float] = field(default_factory=dict)
    payload: Array | None = None
    written: list[str] = field(default_factory=list)
    left_out: dict[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"UrdfValues(written: {len(self.written)} terms, left out: {len(self.left_out)} terms)"

    @classmethod
    def of(cls, terms: Iterable[Term], robot: RobotModel) -> UrdfValues:
        """Sort a model's terms into those that a URDF can state and the others.

        Args:
            terms: Terms of the model.
            robot: Its robot.

        Returns:
            Values for the URDF, and the labels of all terms.

        Raises:
            ModelError: If no arm can have a term that would be written.
        """
        out = cls()
        for term in terms:
            if term.profile != ALWAYS:
                out.left_out[term.label] = "it is present only at times or in a region"
            elif not out._take(term, robot):
                out.left_out[term.label] = "a URDF has no element for it"
            elif why := unphysical(term, robot, BOUNDARY):
                raise ModelError(f"no arm can be written with {why}")
            else:
                out.written.append(term.label)
        return out

    @property
    def arguments(self) -> UrdfChanges:
        """Keyword arguments of ``write_corrected_urdf``."""
        return {
            "inertial": self.inertial,
            "damping": self.damping,
            "friction": self.friction,
            "payload": self.payload,
        }

    def _take(self, term: Term, robot: RobotModel) -> bool:
        # A fit may end on the boundary of physical consistency; the values of a URDF must be inside.
        theta = term.effect.nearest_physical(np.array(term.theta), robot)
        match term.effect:
            case ViscousFriction(joint=joint):
                self.damping[joint] = self.damping.get(joint, 0.0) + float(theta[0])
            case CoulombFriction(joint=joint):
                self.friction[joint] = self.friction.get(joint, 0.0) + float(theta[0])
            case LinkInertia() | LinkInertias() as effect:
                for body, part in effect.by_body(theta):
                    joint = robot.joints[body.carrier(robot)]
                    known = self.inertial.get(joint, robot.inertial_parameters[robot.joint_index(joint)])
                    self.inertial[joint] = known + body.in_joint_frame(part, robot)
            case Payload():
                self.payload = theta if self.payload is None else self.payload + theta
            case _:
                return False
        return True
