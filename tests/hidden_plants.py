"""Plants whose hidden effects are to be found, and what a discovery makes of a log."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from benchmarks.measured_logs.folder import folder
from benchmarks.plant import MujocoPlant, scenarios
from benchmarks.plant.faults import Fault
from benchmarks.plant.scenarios import Scenario
from cdia_pin import load_robot
from cdia_pin.discovery import Discovery

MEASURED = folder()
FRACTION = 0.2  # of the joint's RMS torque
RATE = 125.0  # [Hz]; a search of a log of 250 Hz takes twice as long and has the same answer
ARM_WIDE = ("payload", "base_tilt", "tool_wrench", "viscous_medium", "effort_delay")


@cache
def plant_of(name: str) -> MujocoPlant:
    return MujocoPlant(load_robot(name))


@cache
def hidden(kind: str, arm: str) -> list[Scenario]:
    """Return the scenarios of a kind for an arm: singles, pairs, triples or outside."""
    plant = plant_of(arm)
    made = scenarios.outside(plant) if kind == "outside" else getattr(scenarios, kind)(plant, FRACTION)
    return [replace(s, rate=RATE) for s in made]


def label(fault: Fault) -> str:
    """What the discovery calls a fault of the plant."""
    return fault.effect if fault.effect in ARM_WIDE else f"{fault.effect}@{'+'.join(fault.joints)}"


def labels(found: Discovery) -> set[str]:
    return {step.term.label for step in found.steps}
