"""What is fuzzed: every kind of input that comes from outside. Its reader reads it, or raises `CdiaError`."""

from __future__ import annotations

import shutil
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from cdia_pin.campaigns.campaign_spec import read_spec
from cdia_pin.diagnosis import Monitor, Status, monitor_file
from cdia_pin.dynamics import Dynamics, load_model
from cdia_pin.effects import from_expression, parse_term
from cdia_pin.errors import CdiaError
from cdia_pin.fleet import FleetMap
from cdia_pin.logs import check_log, read_log
from cdia_pin.logs.gains import read_gains
from cdia_pin.robot import load_robot

CORPUS = Path(__file__).parent / "corpus"
ROBOT = load_robot("double_pendulum")
ARM = load_robot("ur5")  # with limits of its effort
LONGEST = 20_000  # characters of an error
MOST_TICKS = 200
SEED_VERSION = "0.1.0"  # of the package that wrote the stored monitors of the corpus; others refuse them


def read_and_check(file: Path, **options: Any) -> None:
    check_log(read_log(file, ROBOT, **options), ROBOT)


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


def read_dataset(file: Path) -> None:
    """A LeRobot dataset: its description or its table is the file, the other one is that of the corpus."""
    with tempfile.TemporaryDirectory() as name:
        for place, part in (("meta", "info.json"), ("data/chunk-000", "data.parquet")):
            (folder := Path(name) / place).mkdir(parents=True)
            plain = CORPUS / "lerobot" / part
            shutil.copy(file if file.suffix == plain.suffix else plain, folder / part)
        read_and_check(Path(name), convert={"angle": "rad"})


def load_monitor(file: Path) -> None:
    """A stored monitor, or the text in it: the checksums of the archive would hide damage of the text."""
    with (
        tempfile.TemporaryDirectory() as folder,
        patch.object(monitor_file, "__version__", SEED_VERSION),
    ):
        if file.suffix == ".json":
            file = archived(file, Path(folder) / "monitor.npz")
        Monitor.load(file, ROBOT)


def archived(text: Path, to: Path) -> Path:
    """The stored monitor of the corpus with another text."""
    with zipfile.ZipFile(CORPUS / "monitors" / "plain.npz") as plain, zipfile.ZipFile(to, "w") as made:
        for part in plain.namelist():
            made.writestr(part, text.read_bytes() if part == monitor_file.TEXT else plain.read(part))
    return to


READERS: dict[str, Callable[[Path], object]] = {
    "logs": read_and_check,
    # as UR's client and libfranka write them
    "recordings": lambda file: read_and_check(file, gains=dict.fromkeys(ROBOT.joints, 10.0)),
    "bags": read_and_check,
    "lerobot": read_dataset,
    "models": lambda file: load_model(file, ROBOT),
    "gains": lambda file: read_gains(file, ROBOT.joints),
    "urdf": load_robot,
    "expressions": read_lines(from_expression),
    "terms": read_lines(lambda line: parse_term(line, ROBOT)),
    "samples": monitor_samples,
    "monitors": load_monitor,
    "fleets": FleetMap.read,
    "campaigns": read_spec,
}
