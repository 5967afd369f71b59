"""What a simulator makes of a term: the same torque, or the nearest one, from what simulators know."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from cdia_pin.effects import (
    AsymmetricFriction,
    BaseTilt,
    BearingFriction,
    CoulombFriction,
    Effect,
    JointSpring,
    LinkInertia,
    LinkInertias,
    Payload,
    PreslidingFriction,
    RotorInertia,
    StribeckFriction,
    Term,
    ThermalFriction,
    Varying,
    ViscousFriction,
)
from cdia_pin.effects.friction import LARGEST_DECAY


class Quantity(StrEnum):
    """A quantity that a simulator or a controller may hold."""

    BODIES = "link inertias"
    PAYLOAD = "payload"
    DAMPING = "joint damping"
    FRICTION = "dry friction"
    BREAKAWAY = "dry friction at rest beyond that in motion"
    ARMATURE = "rotor inertia"
    SPRING = "joint springs"
    GRAVITY = "gravity"


QUANTITIES: dict[type[Effect], Quantity] = {
    LinkInertia: Quantity.BODIES,
    LinkInertias: Quantity.BODIES,
    Payload: Quantity.PAYLOAD,
    ViscousFriction: Quantity.DAMPING,
    CoulombFriction: Quantity.FRICTION,
    StribeckFriction: Quantity.BREAKAWAY,  # as `_breakaway` makes it
    RotorInertia: Quantity.ARMATURE,
    JointSpring: Quantity.SPRING,
    BaseTilt: Quantity.GRAVITY,
}
FRICTION = CoulombFriction | ViscousFriction | StribeckFriction  # has a mean that is friction again
PARTS = {"log": "the logs", "time": "beginning and end"}  # of an effect that varies, by kind


@dataclass(frozen=True)
class Simplified:
    """Terms of simulators in place of one of ours.

    Attributes:
        terms: Terms whose effects are in `QUANTITIES`.
        how: What was made of the term, as in ``its mean over both directions``; empty if the torque is the same.
    """

    terms: tuple[Term, ...]
    how: str = ""


def simplified(term: Term, at_rest: bool = False) -> Simplified | None:
    """Return the terms of simulators that are nearest to a term; None if none is near.

    Args:
        term: An effect with numbers.
        at_rest: Whether the simulator knows friction at rest beside that in motion.
    """
    effect, values = term.effect, term.values
    if isinstance(effect, JointSpring) and values["stiffness"] <= 0:
        return None  # what is left is an offset
    if isinstance(effect, Varying):
        return _mean(effect, term, at_rest)
    match effect:
        case StribeckFriction(joint=joint) if at_rest:
            terms = (*_friction(joint, values["level"]), _breakaway(effect, values["breakaway"]))
            how = "its level at speed and its breakaway at rest"
        case AsymmetricFriction(joint=joint):
            level = (values["level_positive"] + values["level_negative"]) / 2
            coefficient = (values["coefficient_positive"] + values["coefficient_negative"]) / 2
            terms, how = _friction(joint, level, coefficient), "its mean over both directions"
        case BearingFriction(joint=joint):
            terms, how = _friction(joint, values["level"], values["coefficient"]), ""
        case StribeckFriction(joint=joint):
            terms, how = _friction(joint, values["level"]), "its level at speed"
        case PreslidingFriction(joint=joint):
            terms, how = _friction(joint, values["level"]), "Coulomb friction, without the bristles"
        case ThermalFriction(joint=joint):
            terms, how = _friction(joint, values["level"], values["coefficient"]), "its size at 20 °C"
        case _:
            return Simplified((term,)) if type(effect) in QUANTITIES else None
    return Simplified(terms, how)


def _mean(effect: Varying, term: Term, at_rest: bool) -> Simplified | None:
    """Return friction that varies as its mean; None for other effects, such as a payload that was exchanged."""
    plain = simplified(Term(effect.effect, effect.mean(term.theta), term.profile), at_rest)
    if plain is None or not all(isinstance(t.effect, FRICTION) for t in plain.terms):
        return None
    return Simplified(
        plain.terms, f"its mean over {PARTS[effect.kind]}" + (plain.how and f", and {plain.how}")
    )


def _friction(joint: str, level: float, coefficient: float | None = None) -> tuple[Term, ...]:
    """Return Coulomb friction [N·m or N], and viscous friction [N·m·s/rad or N·s/m] if there is any."""
    dry = Term.of(CoulombFriction(joint), level=level)
    return (dry,) if coefficient is None else (dry, Term.of(ViscousFriction(joint), coefficient=coefficient))


def _breakaway(effect: StribeckFriction, size: float) -> Term:
    """Return friction [N·m or N] that is gone as soon as the joint moves."""
    return Term.of(effect.with_shape(decay=LARGEST_DECAY), level=0.0, breakaway=max(size, 0.0))
