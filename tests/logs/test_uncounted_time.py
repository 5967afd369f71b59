"""A recorder that pauses and counts its rows: the times leave out what the positions show."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.logs import Log
from cdia_pin.logs.checks import check_log
from tests.made_logs import make

ROBOT = load_robot("ur5")


def log_of(seed: int = 3) -> Log:
    log = make(ROBOT, seed=seed).log
    return (
        log
        if log.velocity is not None
        else replace(log, velocity=np.gradient(log.position, log.time, axis=0))
    )


def paused(log: Log, rows: int, left_out: int) -> Log:
    """The log without some rows after each stretch of rows, and with times that count the rows that are left."""
    kept = np.arange(len(log.time)) % (rows + left_out) < rows
    step = float(np.median(np.diff(log.time)))
    assert log.velocity is not None
    return replace(
        log,
        time=step * np.arange(kept.sum()),
        position=log.position[kept],
        velocity=log.velocity[kept],
        effort=log.effort[kept],
    )


@pytest.mark.parametrize(("rows", "left_out"), [(50, 10), (20, 5)])
def test_time_that_is_not_counted_is_said_with_its_length(rows: int, left_out: int) -> None:
    log = log_of()
    check = check_log(paused(log, rows, left_out), ROBOT)
    (found,) = check.about("velocity")
    assert found.severity == "error" and "times leave out" in found.message
    assert found.value["lost"] == pytest.approx(log.duration * left_out / (rows + left_out), rel=0.1)


def test_lost_rows_that_are_counted_are_no_pauses() -> None:
    log = log_of()
    kept = np.arange(len(log.time)) % 60 < 50
    assert log.velocity is not None
    gaps = replace(
        log,
        time=log.time[kept],
        position=log.position[kept],
        velocity=log.velocity[kept],
        effort=log.effort[kept],
    )
    assert all("times leave out" not in f.message for f in check_log(gaps, ROBOT).findings)


def test_held_positions_and_another_unit_of_velocities_are_no_pauses() -> None:
    log = log_of()
    assert log.velocity is not None
    held = replace(log, position=log.position[3 * (np.arange(len(log.time)) // 3)])
    slow = replace(log, velocity=0.2 * log.velocity)
    for other in (held, slow):
        assert all("times leave out" not in f.message for f in check_log(other, ROBOT).findings)
