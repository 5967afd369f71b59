"""Faults that only the online benchmark has: a part of the motion is healthy."""

from __future__ import annotations

from typing import ClassVar

from benchmarks.plant.faults import MECHANISMS, Fault, Mechanism, Step
from benchmarks.plant.faults.mechanism import Parameters
from cdia_pin.errors import EffectError, unknown_name


class FastViscousFriction(Mechanism):
    """f = −coefficient q̇ where |q̇| > speed, and nothing where it is slower."""

    name = "fast_viscous_friction"
    defaults: ClassVar[Parameters] = {"coefficient": 1.0, "speed": 0.5}
    sizes = ("coefficient",)

    def act(self, x: Step) -> None:
        """Act at one step."""
        v = x.v[self.j]
        if abs(v) > self.p["speed"]:
            x.force[self.j] -= self.amount * self.p["coefficient"] * v


ONLINE: dict[str, type[Mechanism]] = {**MECHANISMS, FastViscousFriction.name: FastViscousFriction}


def mechanism(fault: Fault) -> Mechanism:
    """Return a new mechanism that makes a fault happen.

    Raises:
        EffectError: If the plant does not know it, or it changes what is recorded and not what happens.
    """
    if fault.effect not in ONLINE:
        raise EffectError("online plant: " + unknown_name("fault", fault.effect, ONLINE))
    if fault.effect in {"encoder_offset", "effort_delay"}:
        raise EffectError(f"online plant: {fault.effect} is a fault of a log; see Sensors and Drives")
    return ONLINE[fault.effect](fault)


def resized(fault: Fault, factor: float) -> Fault:
    """Return a fault with the parameters that set its size multiplied."""
    kind = ONLINE[fault.effect]
    given = {**kind.defaults, **fault.parameters}
    return fault.with_parameters({k: factor * float(given[k]) for k in kind.sizes})  # type: ignore[arg-type]
