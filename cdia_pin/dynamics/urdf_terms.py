"""What a URDF can hold of a model's terms, and what it cannot."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import (
    ALWAYS,
    CoulombFriction,
    LinkInertia,
    LinkInertias,
    Payload,
    Term,
    ViscousFriction,
)
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass
class UrdfValues:
    """What a URDF can hold of a model's terms.

    Attributes:
        inertial: Inertial parameters by joint, as ``write_corrected_urdf`` takes them.
        damping: Viscous friction by joint [N·m·s/rad or N·s/m].
        friction: Coulomb friction by joint [N·m or N].
        payload: Inertial parameters of the payload, if there is one.
        written: Labels of the terms with a place.
        left_out: Labels of the others, with the reason.
    """

    inertial: dict[str, Array] = field(default_factory=dict)
    damping: dict[str, float] = field(default_factory=dict)
    friction: dict[str, float] = field(default_factory=dict)
    payload: Array | None = None
    written: list[str] = field(default_factory=list)
    left_out: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, terms: Iterable[Term], robot: RobotModel) -> UrdfValues:
        """Sort a model's terms into what a URDF can hold and what it cannot."""
        out = cls()
        for term in terms:
            if term.profile != ALWAYS:
                out.left_out[term.label] = "present only at times or in a region"
            elif not out._take(term, robot):
                out.left_out[term.label] = "a URDF has no such thing"
            else:
                out.written.append(term.label)
        return out

    @property
    def arguments(self) -> dict[str, Any]:
        """What ``write_corrected_urdf`` takes."""
        return {
            "inertial": self.inertial,
            "damping": self.damping,
            "friction": self.friction,
            "payload": self.payload,
        }

    def _take(self, term: Term, robot: RobotModel) -> bool:
        # A fit may end on the edge of what a body can be; a URDF must not be beyond it.
        theta = term.effect.nearest_physical(np.array(term.theta), robot)
        match term.effect:
            case ViscousFriction(joint=joint):
                self.damping[joint] = float(theta[0])
            case CoulombFriction(joint=joint):
                self.friction[joint] = float(theta[0])
            case LinkInertia() | LinkInertias() as effect:
                for body, part in effect.by_body(theta):
                    joint = robot.joints[body.carrier(robot)]
                    known = self.inertial.get(joint, robot.inertial_parameters[robot.joint_index(joint)])
                    self.inertial[joint] = known + body.in_joint_frame(part, robot)
            case Payload():
                self.payload = theta
            case _:
                return False
        return True
