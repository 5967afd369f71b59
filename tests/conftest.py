"""Fixtures that several folders of tests share."""

from __future__ import annotations

import os
from collections.abc import Callable

import pytest
from hypothesis import settings

from cdia_pin import Dynamics, load_robot
from cdia_pin.discovery import Discovery, discover
from cdia_pin.logs import Log

# A run that judges a change tries the same inputs each time: what one of them breaks, the change broke. With
# CDIA_FUZZ the inputs are new in each run.
settings.register_profile("repeatable", derandomize=True)
if "CDIA_FUZZ" not in os.environ:
    settings.load_profile("repeatable")


@pytest.fixture(scope="session")
def ur5():
    return load_robot("ur5")


@pytest.fixture(scope="session")
def discovered() -> Callable[[str, Log], Discovery]:
    return lambda robot, log: discover(Dynamics(load_robot(robot)), log)
