"""Plants whose hidden effects are to be found, and what a discovery makes of a log."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from benchmarks.plant import MujocoPlant
from benchmarks.plant.faults import Fault
from cdia_pin import load_robot
from cdia_pin.discovery import Discovery

MEASURED = Path(__file__).resolve().parents[2] / "shared" / "data"
ARM_WIDE = ("payload", "base_tilt", "tool_wrench", "viscous_medium", "effort_delay")


@cache
def plant_of(name: str) -> MujocoPlant:
    return MujocoPlant(load_robot(name))


def label(fault: Fault) -> str:
    """What the discovery calls a fault of the plant."""
    return fault.effect if fault.effect in ARM_WIDE else f"{fault.effect}@{'+'.join(fault.joints)}"


def labels(found: Discovery) -> set[str]:
    return {step.term.label for step in found.steps}
