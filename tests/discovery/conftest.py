"""Plants whose hidden effects are to be found, and what a discovery makes of a log."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from benchmarks.plant import MujocoPlant
from benchmarks.plant.faults import Fault
from cdia_pin import Dynamics, load_robot
from cdia_pin.discovery import Discovery, discover
from cdia_pin.logs import Log

MEASURED = Path(__file__).resolve().parents[3] / "shared" / "data"
ARM_WIDE = ("payload", "base_tilt", "tool_wrench", "viscous_medium", "effort_delay")


@cache
def plant_of(name: str) -> MujocoPlant:
    return MujocoPlant(load_robot(name))


def label(fault: Fault) -> str:
    """What the discovery calls a fault of the plant."""
    return fault.effect if fault.effect in ARM_WIDE else f"{fault.effect}@{'+'.join(fault.joints)}"


def labels(found: Discovery) -> set[str]:
    return {step.term.label for step in found.steps}


@pytest.fixture(scope="session")
def ur5():
    return load_robot("ur5")


@pytest.fixture(scope="session")
def discovered() -> Callable[[str, Log], Discovery]:
    return lambda robot, log: discover(Dynamics(load_robot(robot)), log)
