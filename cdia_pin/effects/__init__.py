"""Physical effects, one class each; `vocabulary` names them."""

from __future__ import annotations

from cdia_pin.effects.actuation import ActuatorGain, JointSpring, PositionRipple, RotorInertia, TorqueOffset
from cdia_pin.effects.counterbalance import Counterbalance
from cdia_pin.effects.drift import Drift
from cdia_pin.effects.effect import Effect
from cdia_pin.effects.elasticity import JointElasticity
from cdia_pin.effects.environment import BaseTilt, ExternalWrench, ToolWrench, ViscousMedium
from cdia_pin.effects.expression import Expression, from_expression
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
from cdia_pin.effects.joint_effect import JointEffect
from cdia_pin.effects.link_inertias import LinkInertias
from cdia_pin.effects.load_stribeck import LoadStribeckFriction
from cdia_pin.effects.nonlinear_effect import NonlinearEffect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.per_log import PerLog
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.presliding import PreslidingFriction
from cdia_pin.effects.profile import (
    ALWAYS,
    Always,
    Between,
    Incipient,
    Intermittent,
    Profile,
    Region,
    after,
    profile_from_dict,
)
from cdia_pin.effects.sensing import EffortDelay, EncoderOffset
from cdia_pin.effects.specification import parse_term
from cdia_pin.effects.state import JointState, State
from cdia_pin.effects.stateful_effect import StatefulEffect
from cdia_pin.effects.term import Term
from cdia_pin.effects.thermal import ThermalFriction
from cdia_pin.effects.traits import Channel, SensedFrom, Signal, Traits
from cdia_pin.effects.unknown import Unknown
from cdia_pin.effects.variations import varied
from cdia_pin.effects.varying import Varying
from cdia_pin.effects.vocabulary import EFFECTS, effect_from_dict, parse_effect, register
from cdia_pin.effects.wrapped import WrappedEffect

__all__ = [
    "ALWAYS", "EFFECTS", "ActuatorGain", "Always", "AsymmetricFriction", "BaseTilt", "BearingFriction", "Between",
    "Channel", "CoulombFriction", "Counterbalance", "CoupledFriction", "Drift", "Effect", "EffortDelay",
    "EncoderOffset", "Expression", "ExternalWrench", "Incipient", "Intermittent", "JointEffect",
    "JointElasticity", "JointSpring", "JointState", "LinkInertia", "LinkInertias", "LoadFriction",
    "LoadStribeckFriction", "NonlinearEffect", "Parameter", "Payload", "PerLog", "Plausibility",
    "PositionRipple", "PreslidingFriction", "Profile", "QuadraticFriction", "Region", "RotorInertia",
    "SensedFrom", "Signal", "State", "StatefulEffect", "StribeckFriction", "Term", "ThermalFriction", "ToolWrench",
    "TorqueOffset", "Traits", "Unknown", "Varying", "ViscousFriction", "ViscousMedium", "WrappedEffect",
    "after", "effect_from_dict", "from_expression", "parse_effect", "parse_term", "profile_from_dict",
    "register", "varied",
]  # fmt: skip
