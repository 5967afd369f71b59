"""Fixtures that several folders of tests share."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.discovery import Discovery, discover
from cdia_pin.logs import Log


@pytest.fixture(scope="session")
def ur5():
    return load_robot("ur5")


@pytest.fixture(scope="session")
def discovered() -> Callable[[str, Log], Discovery]:
    return lambda robot, log: discover(Dynamics(load_robot(robot)), log)
