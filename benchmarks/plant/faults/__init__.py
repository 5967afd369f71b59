"""Faults of the plant, written apart from the package's effects so that neither can lend the other its error."""

from __future__ import annotations

from benchmarks.plant.faults import actuation, bodies, environment, friction, outside, sensing
from benchmarks.plant.faults.mechanism import Fault, Mechanism, Step
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


__all__ = ["MECHANISMS", "OUTSIDE", "VOCABULARY", "Fault", "Mechanism", "Step", "mechanism"]
