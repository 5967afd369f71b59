"""What is fuzzed: every kind of input that comes from outside. Its reader reads it, or raises `CdiaError`."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from cdia_pin.diagnosis import Monitor
from cdia_pin.dynamics import Dynamics, load_model
from cdia_pin.effects import from_expression, parse_term
from cdia_pin.errors import CdiaError
from cdia_pin.logs import check_log, read_log
from cdia_pin.logs.gains import read_gains
from cdia_pin.robot import load_robot

CORPUS = Path(__file__).parent / "corpus"
ROBOT = load_robot("double_pendulum")
LONGEST = 20_000  # characters of an error


def read_and_check(file: Path) -> None:
    check_log(read_log(file, ROBOT), ROBOT)


def read_lines(read: Callable[[str], object]) -> Callable[[Path], None]:
    """Each line of a file is an input of its own."""

    def reading(file: Path) -> None:
        for line in file.read_text(errors="replace").splitlines():
            try:
                read(line)
            except CdiaError as error:
                assert len(str(error)) < LONGEST

    return reading


@cache
def healthy_monitor() -> Monitor:
    return Monitor(Dynamics(ROBOT), threshold=dict.fromkeys(ROBOT.joints, 1.0), rate=100.0)


def monitor_samples(file: Path) -> None:
    """Each row of eight numbers is a tick: time, positions, velocities, torques, what is to be commanded."""
    monitor, limit = healthy_monitor(), ROBOT.limits.effort
    monitor.reset()
    numbers = np.frombuffer(file.read_bytes()[: 64 * 200 * 8], np.float64, file.stat().st_size // 8)
    for t, *row in numbers[: len(numbers) // 8 * 8].reshape(-1, 8):
        q, v, tau = np.array(row[:2]), np.array(row[2:4]), np.array(row[4:6])
        status = monitor.update(t, q, v, tau)
        command = monitor.correct(np.full(2, row[6]))
        assert np.isfinite(command).all() and (np.abs(command) <= limit).all()
        assert np.isfinite(status.torque_correction).all() and np.isfinite(status.residual).all()


READERS: dict[str, Callable[[Path], object]] = {
    "logs": read_and_check,
    "models": lambda file: load_model(file, ROBOT),
    "gains": lambda file: read_gains(file, ROBOT.joints),
    "urdf": load_robot,
    "expressions": read_lines(from_expression),
    "terms": read_lines(lambda line: parse_term(line, ROBOT)),
    "samples": monitor_samples,
}
