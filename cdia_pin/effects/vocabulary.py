"""The vocabulary: every effect that has a name, one line each in the table below."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from cdia_pin.effects import arithmetic
from cdia_pin.effects.actuation import ActuatorGain, JointSpring, PositionRipple, RotorInertia, TorqueOffset
from cdia_pin.effects.counterbalance import Counterbalance
from cdia_pin.effects.effect import Effect
from cdia_pin.effects.elasticity import JointElasticity
from cdia_pin.effects.environment import BaseTilt, ExternalWrench, ToolWrench, ViscousMedium
from cdia_pin.effects.expression import Expression
from cdia_pin.effects.friction import (
    AsymmetricFriction,
    BearingFriction,
    CoulombFriction,
    CoupledFriction,
    LoadFriction,
    QuadraticFriction,
    StribeckFriction,
    ViscousFriction,
)
from cdia_pin.effects.inertia import LinkInertia, Payload
from cdia_pin.effects.link_inertias import LinkInertias
from cdia_pin.effects.load_stribeck import LoadStribeckFriction
from cdia_pin.effects.presliding import PreslidingFriction
from cdia_pin.effects.sensing import EffortDelay, EncoderOffset
from cdia_pin.effects.thermal import ThermalFriction
from cdia_pin.effects.unknown import Unknown
from cdia_pin.effects.variations import varied
from cdia_pin.errors import EffectError, unknown_name
from cdia_pin.robot.model import RobotModel

EFFECTS: dict[str, type[Effect]] = {
    e.name: e
    for e in (
        CoulombFriction,
        ViscousFriction,
        BearingFriction,
        StribeckFriction,
        AsymmetricFriction,
        QuadraticFriction,
        LoadFriction,
        LoadStribeckFriction,
        PreslidingFriction,
        ThermalFriction,
        PositionRipple,
        ActuatorGain,
        TorqueOffset,
        RotorInertia,
        JointSpring,
        Counterbalance,
        JointElasticity,
        CoupledFriction,
        LinkInertia,
        Payload,
        BaseTilt,
        ToolWrench,
        ExternalWrench,
        ViscousMedium,
        EncoderOffset,
        EffortDelay,
        Unknown,
        Expression,
    )
}
OF_SEVERAL: dict[str, type[Effect]] = {
    LinkInertias.name: LinkInertias
}  # under the same name, on several joints


def register(effect: type[Effect]) -> type[Effect]:
    """Add a user's effect class to the vocabulary; usable as a decorator.

    Args:
        effect: A frozen dataclass with a name of its own.

    Raises:
        EffectError: If the name is taken by another class.
    """
    if EFFECTS.setdefault(effect.name, effect) is not effect:
        raise EffectError(f"an effect named '{effect.name}' exists already; give yours another name")
    return effect


def parse_effect(text: str, robot: RobotModel | None = None) -> Effect:
    """Read ``NAME``, ``NAME@JOINT``, ``NAME@JOINT+JOINT`` or ``EXPRESSION@JOINT``.

    Args:
        text: The label.
        robot: Checks the joint names, if given.

    Raises:
        EffectError: If the name is not in the vocabulary and is not an expression either.
        RobotError: If a joint is not of the robot.
    """
    name, at, joints = (part.strip() for part in text.partition("@"))
    scope = [j.strip() for j in joints.split("+")] if at else []
    if name in EFFECTS:
        effect = _kind(name, scope).from_scope(scope, {})
    elif not name or (name.isidentifier() and name not in (*arithmetic.SIGNALS, *arithmetic.CONSTANTS)):
        raise EffectError(unknown_name("effect", name, EFFECTS))
    else:
        effect = Expression.from_scope(scope, {"text": name})
    if robot is not None:
        effect.check(robot)
    return effect


def _kind(name: str, scope: Sequence[str]) -> type[Effect]:
    return OF_SEVERAL[name] if len(scope) > 1 and name in OF_SEVERAL else EFFECTS[name]


def effect_from_dict(given: Mapping[str, Any]) -> Effect:
    """Read back what `Effect.to_dict` wrote; raises EffectError with what is valid.

    Args:
        given: Name, joints, shape and variation, as in a file.
    """
    name = str(given.get("effect", ""))
    if name not in EFFECTS:
        raise EffectError(unknown_name("effect", name, EFFECTS))
    joints, shape = given.get("joints", []), given.get("shape", {})
    if not isinstance(joints, list | tuple) or not isinstance(shape, Mapping):
        raise EffectError(f"{name}: joints must be a list and shape an object, given {joints!r}, {shape!r}")
    effect = _kind(name, joints).from_scope(joints, shape)
    return varied(effect, given["varies"]) if "varies" in given else effect
