"""What is fuzzed: every kind of input that comes from outside. Its reader reads it, or raises `CdiaError`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import numpy as np

from cdia_pin.diagnosis import Monitor, Status
from cdia_pin.dynamics import Dynamics, load_model
from cdia_pin.effects import from_expression, parse_term
from cdia_pin.errors import CdiaError
from cdia_pin.logs import check_log, read_log
from cdia_pin.logs.gains import read_gains
from cdia_pin.robot import load_robot

CORPUS = Path(__file__).parent / "corpus"
ROBOT = load_robot("double_pendulum")
ARM = load_robot("ur5")  # with limits of its effort
LONGEST = 20_000  # characters of an error
MOST_TICKS = 200


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
    return Monitor(Dynamics(ARM), threshold=dict.fromkeys(ARM.joints, 1.0), rate=100.0)


def monitor_samples(file: Path) -> None:
    for status, nominal, command in monitored(file):
        assert np.isfinite(command).all() and (np.abs(command) <= ARM.limits.effort).all()
        assert np.isfinite(status.torque_correction).all() and np.isfinite(status.residual).all()
        assert np.isfinite(nominal) or np.isfinite(command).all()


def monitored(file: Path) -> Iterator[tuple[Status, float, np.ndarray]]:
    """Each row of numbers is a tick: time, positions, velocities, torques, and what is commanded of all joints."""
    monitor, data, n = healthy_monitor(), file.read_bytes(), ARM.n
    monitor.reset()
    width = 2 + 3 * n
    numbers = np.frombuffer(data[: len(data) // 8 * 8], np.float64)
    for row in numbers[: len(numbers) // width * width].reshape(-1, width)[:MOST_TICKS]:
        q, v, tau = row[1 : 1 + 3 * n].reshape(3, n)
        status = monitor.update(row[0], q, v, tau)
        yield status, row[-1], monitor.correct(np.full(n, row[-1]))


READERS: dict[str, Callable[[Path], object]] = {
    "logs": read_and_check,
    "models": lambda file: load_model(file, ROBOT),
    "gains": lambda file: read_gains(file, ROBOT.joints),
    "urdf": load_robot,
    "expressions": read_lines(from_expression),
    "terms": read_lines(lambda line: parse_term(line, ROBOT)),
    "samples": monitor_samples,
}
