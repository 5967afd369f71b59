"""The numbers of a model that a file format can hold, and the terms that it cannot."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics.physical import unphysical
from cdia_pin.dynamics.simple_terms import QUANTITIES, Quantity, simplified
from cdia_pin.effects import (
    ALWAYS,
    BaseTilt,
    Channel,
    CoulombFriction,
    JointSpring,
    LinkInertia,
    LinkInertias,
    Payload,
    RotorInertia,
    StribeckFriction,
    Term,
    ViscousFriction,
)
from cdia_pin.errors import ModelError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# A fit that ends on a bound passes it by what its solver leaves; the file gets the bound. More is another arm.
BOUNDARY = 0.01  # by how much a fit may pass a bound, relative to its largest parameter [1]


@dataclass(frozen=True)
class FileFormat:
    """What a format can hold.

    Attributes:
        noun: What such a file is called, with its article.
        holds: Quantities with a place in it.
        instead: Where the others belong, by quantity; for the rest there is no place.
    """

    noun: str
    holds: frozenset[Quantity]
    instead: Mapping[Quantity, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Beyond:
    """A term that a file does not hold, or not whole.

    Attributes:
        term: The term.
        written: What the file holds of it; nothing if it was left out.
    """

    term: Term
    written: tuple[Term, ...] = ()


@dataclass(repr=False)
class SimulatorValues:
    """Numbers of a model's terms that a format can hold.

    Attributes:
        inertial: Inertial parameters [kg, kg·m, kg·m²] of all links that move with a joint, shape (10,), by joint.
        damping: Viscous friction by joint [N·m·s/rad or N·s/m].
        friction: Coulomb friction by joint [N·m or N].
        breakaway: Friction at rest beyond that, by joint [N·m or N].
        armature: Inertia of rotor and gear, seen at the joint [kg·m² or kg].
        springs: Stiffness [N·m/rad or N/m] and preload [N·m or N] by joint.
        gravity: Change of gravity in the base frame [m/s²], shape (3,); None without one.
        payload: Inertial parameters of the payload about the tool frame, shape (10,); None without a payload.
        written: Labels of the terms that are held as they are.
        approximated: Labels of the terms that are held nearly, with what was made of them.
        left_out: Labels of the other terms, with the reason.
        beyond: What is not held, by label.
    """

    inertial: dict[str, Array] = field(default_factory=dict)
    damping: dict[str, float] = field(default_factory=dict)
    friction: dict[str, float] = field(default_factory=dict)
    breakaway: dict[str, float] = field(default_factory=dict)
    armature: dict[str, float] = field(default_factory=dict)
    springs: dict[str, tuple[float, float]] = field(default_factory=dict)
    gravity: Array | None = None
    payload: Array | None = None
    written: list[str] = field(default_factory=list)
    approximated: dict[str, str] = field(default_factory=dict)
    left_out: dict[str, str] = field(default_factory=dict)
    beyond: dict[str, Beyond] = field(default_factory=dict)

    def __repr__(self) -> str:
        held = len(self.written) + len(self.approximated)
        return f"{type(self).__name__}(written: {held} terms, left out: {len(self.left_out)} terms)"

    @classmethod
    def sort(cls, terms: Iterable[Term], robot: RobotModel, wanted: FileFormat) -> Self:
        """Sort a model's terms into those that a format can hold and the others.

        Args:
            terms: Terms of the model.
            robot: Its robot.
            wanted: The format.

        Returns:
            Values for the file, and the labels of all terms.

        Raises:
            ModelError: If no arm can have a term that would be written.
        """
        out = cls()
        for term in terms:
            at_rest = Quantity.BREAKAWAY in wanted.holds
            simple = None if term.profile != ALWAYS else simplified(_possible(term, robot), at_rest)
            held = (
                tuple(t for t in simple.terms if QUANTITIES[type(t.effect)] in wanted.holds) if simple else ()
            )
            if not held or not simple:
                out.left_out[term.label] = _reason(term, wanted)
                out.beyond[term.label] = Beyond(term)
                continue
            if why := unphysical(term, robot, BOUNDARY):
                raise ModelError(f"no arm can be written with {why}")
            for t in held:
                out._take(t, robot)
            lost = [str(QUANTITIES[type(t.effect)]) for t in simple.terms if t not in held]
            how = ", ".join(filter(None, [simple.how, f"without its {' and '.join(lost)}" if lost else ""]))
            if how:
                out.approximated[term.label] = how
                out.beyond[term.label] = Beyond(term, held)
            else:
                out.written.append(term.label)
        return out

    @property
    def held(self) -> list[str]:
        """Labels of the terms that the file holds, wholly or nearly."""
        return [*self.written, *self.approximated]

    def _take(self, term: Term, robot: RobotModel) -> None:
        theta = np.array(term.theta)
        match term.effect:
            case ViscousFriction(joint=joint):
                self.damping[joint] = self.damping.get(joint, 0.0) + float(theta[0])
            case CoulombFriction(joint=joint):
                self.friction[joint] = self.friction.get(joint, 0.0) + float(theta[0])
            case StribeckFriction(joint=joint):
                self.breakaway[joint] = self.breakaway.get(joint, 0.0) + float(theta[1])
            case RotorInertia(joint=joint):
                self.armature[joint] = self.armature.get(joint, 0.0) + float(theta[0])
            case JointSpring(joint=joint):
                stiffness, preload = self.springs.get(joint, (0.0, 0.0))
                self.springs[joint] = (stiffness + float(theta[0]), preload + float(theta[1]))
            case BaseTilt() as effect:
                self.gravity = effect.tilt(robot, theta)
            case LinkInertia() | LinkInertias() as effect:
                added = effect.on_links(theta, robot)
                for j in dict.fromkeys(body.carrier(robot) for body in effect.bodies):
                    joint = robot.joints[j]
                    self.inertial[joint] = self.inertial.get(joint, robot.inertial_parameters[j]) + added[j]
            case Payload():
                self.payload = theta if self.payload is None else self.payload + theta


def _possible(term: Term, robot: RobotModel) -> Term:
    """Return the term inside its bounds: a fit may end on the boundary of physical consistency."""
    return term.with_theta(term.effect.nearest_physical(np.array(term.theta), robot))


def _reason(term: Term, wanted: FileFormat) -> str:
    """Return why a format cannot hold a term."""
    if term.profile != ALWAYS:
        return "present only at times or in a region"
    simple = simplified(term)
    belongs = [wanted.instead.get(QUANTITIES[type(t.effect)], "") for t in simple.terms] if simple else []
    if belongs and all(belongs):
        return belongs[0]
    if term.effect.traits.channel is not Channel.JOINT_TORQUE:
        return "of a sensor, not of the arm"
    return f"{wanted.noun} has no such element"
