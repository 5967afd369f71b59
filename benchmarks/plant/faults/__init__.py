"""Faults of the plant, written apart from the package's effects: neither can lend the other its error."""

from __future__ import annotations

from benchmarks.plant.faults import actuation, bodies, environment, friction, outside, sensing
from benchmarks.plant.faults.mechanism import Fault, Mechanism, Step, Value
from cdia_pin.errors import EffectError, unknown_name

VOCABULARY: dict[str, type[Mechanism]] = {
    kind.name: kind
    for kind in (
        friction.CoulombFriction,
        friction.ViscousFriction,
        friction.StribeckFriction,
        friction.AsymmetricFriction,
        friction.QuadraticFriction,
        friction.LoadFriction,
        actuation.PositionRipple,
        actuation.ActuatorGain,
        actuation.TorqueOffset,
        actuation.RotorInertia,
        actuation.JointSpring,
        friction.CoupledFriction,
        bodies.LinkInertia,
        bodies.Payload,
        environment.BaseTilt,
        environment.ToolWrench,
        environment.ViscousMedium,
        sensing.EncoderOffset,
        sensing.EffortDelay,
    )
}
OUTSIDE: dict[str, type[Mechanism]] = {
    kind.name: kind
    for kind in (
        outside.CubicSpring,
        outside.TorqueDeadzone,
        outside.SpeedCogging,
        outside.PostureFriction,
        outside.WarmingFriction,
        outside.CrossSpring,
        outside.Presliding,
        outside.SpeedBump,
    )
}
MECHANISMS = VOCABULARY | OUTSIDE


def mechanism(fault: Fault) -> Mechanism:
    """Return a new mechanism that makes a fault happen."""
    if fault.effect not in MECHANISMS:
        raise EffectError("plant: " + unknown_name("fault", fault.effect, MECHANISMS))
    return MECHANISMS[fault.effect](fault)


def scaled(fault: Fault, factor: float) -> Fault:
    """Return a fault with the parameters that set its size multiplied."""
    sizes = MECHANISMS[fault.effect].sizes
    return fault.with_parameters({k: _times(v, factor) for k, v in fault.parameters.items() if k in sizes})


def _times(value: Value, factor: float) -> Value:
    return tuple(factor * x for x in value) if isinstance(value, tuple) else factor * float(value or 0.0)


__all__ = [
    "MECHANISMS",
    "OUTSIDE",
    "VOCABULARY",
    "Fault",
    "Mechanism",
    "Step",
    "Value",
    "mechanism",
    "scaled",
]
