"""What every joint has, and which effects draw the same more finely."""

from __future__ import annotations

from cdia_pin.effects.actuation import JointSpring, TorqueOffset
from cdia_pin.effects.drift import Drift
from cdia_pin.effects.effect import Effect
from cdia_pin.effects.friction import (
    AsymmetricFriction,
    BearingFriction,
    CoulombFriction,
    LoadFriction,
    StribeckFriction,
    ViscousFriction,
)
from cdia_pin.effects.joint_effect import JointEffect
from cdia_pin.effects.load_stribeck import LoadStribeckFriction
from cdia_pin.effects.presliding import PreslidingFriction
from cdia_pin.effects.varying import Varying

PLAIN_FRICTION = (CoulombFriction, ViscousFriction)
# Effects, with the plain ones that they refine.
REFINED: dict[type[Effect], tuple[type[JointEffect], ...]] = {
    # a level of its own each way is one level and an offset
    AsymmetricFriction: (*PLAIN_FRICTION, TorqueOffset),
    StribeckFriction: PLAIN_FRICTION,
    PreslidingFriction: PLAIN_FRICTION,
    LoadStribeckFriction: (LoadFriction, *PLAIN_FRICTION),
    JointSpring: (TorqueOffset,),
}
# Both together are the levels of asymmetric friction itself, and no plainer.
LEVELS = {CoulombFriction, TorqueOffset}


def plain_forms(effect: Effect) -> tuple[Effect, ...]:
    """Return the plain effects that an effect refines; none if it refines nothing.

    Args:
        effect: The effect.
    """
    if isinstance(effect, Drift):
        return (effect.effect,)
    return tuple(kind(*effect.scope) for kind in REFINED.get(type(effect), ()))


def is_plain(effect: Effect) -> bool:
    """Tell whether every joint of every arm has an effect: plain friction that stays as it is.

    Args:
        effect: The effect.
    """
    plain = {kind.name for kind in (*PLAIN_FRICTION, BearingFriction)}
    return effect.name in plain and not isinstance(effect, Varying)
