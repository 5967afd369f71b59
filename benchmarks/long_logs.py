"""Measure processor time and memory of commands on a long log, and how they grow with its length.

Usage:
    python -m benchmarks.long_logs                              # 20 minutes at 1 kHz: check, compare, discover
    python -m benchmarks.long_logs --rows 10000000 --suffix parquet --commands compare
    python -m benchmarks.long_logs --also OTHER_CHECKOUT        # another state of the package, in the same run

The arm is a Panda that moves along sines of all joints. Its motors have friction and it carries a load, which the
robot's description lacks; positions are rounded to the steps of an encoder, and torques are noisy.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.outcomes import CHECKOUT, environment_of
from cdia_pin import Dynamics, load_robot
from cdia_pin.effects import CoulombFriction, Payload, Term, ViscousFriction
from cdia_pin.logs import Log, write_log

Array = NDArray[np.float64]

ARM = "panda"
RATE = 1000.0  # [Hz]
ROWS = 1_200_000  # [1], twenty minutes
COMMANDS = ("check", "compare", "discover")
SINES = 6  # of each joint
SLOWEST, FASTEST = 0.03, 0.6  # [Hz], of the sines: what an arm does in a working motion
SPAN = 0.9  # [rad], of a joint about its middle
STEP = 2e-6  # [rad], of the encoders
NOISE = 0.05  # [N·m], standard deviation of the noise of a torque
PART = 50_000  # [rows] that are made at a time
SEED = 5


@dataclass(frozen=True)
class Spent:
    """What a command took.

    Attributes:
        processor: Time of the processor, user and system [s].
        memory: Largest resident memory [GB].
        code: Exit code.
    """

    processor: float
    memory: float
    code: int

    def __str__(self) -> str:
        failed = "" if self.code in {0, 1} else f", exit code {self.code}"
        return f"{self.processor:7.1f} s {self.memory:6.2f} GB{failed}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the log and print one line per command."""
    given = _parsed(arguments)
    with tempfile.TemporaryDirectory(prefix="long-") as folder:
        file = given.log or Path(folder) / f"long.{given.suffix}"
        if not file.exists():
            # in a process of its own: a command begins with the memory of the process that starts it
            making = multiprocessing.get_context("spawn").Process(target=make, args=(given.rows, file))
            making.start()
            making.join()
        print(
            f"{given.rows} rows of {ARM}, {file.stat().st_size / 1e6:.0f} MB of {file.suffix[1:]}", flush=True
        )
        for command in given.commands:
            for checkout in (CHECKOUT, *given.also):
                spent = spend([command, str(file.resolve()), "--robot", ARM], checkout)
                print(f"{command:10s} {spent}; load {os.getloadavg()[0]:.1f}; {checkout.name}", flush=True)


def spend(line: Sequence[str], checkout: Path) -> Spent:
    """Run one command in a process of its own and return what it took.

    Args:
        line: What follows ``cdia``.
        checkout: Folder of the package that runs.
    """
    with subprocess.Popen(
        [sys.executable, "-m", "cdia_pin", *line],
        env=environment_of(checkout),
        cwd=checkout,  # Python looks for the package there first
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as process:
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return Spent(usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1e6, process.returncode)


def make(rows: int, file: Path) -> None:
    """Write a log of the arm.

    Args:
        rows: Number of samples [1].
        file: The file.
    """
    write_log(long_log(rows), file)


def long_log(rows: int) -> Log:
    """Return a log of the arm.

    Args:
        rows: Number of samples [1].
    """
    rng = np.random.default_rng(SEED)
    robot = load_robot(ARM)
    lower, upper = robot.limits.lower, robot.limits.upper
    middle = np.where(np.isfinite(lower + upper), (lower + upper) / 2, 0.0)
    frequency = 2 * np.pi * rng.uniform(SLOWEST, FASTEST, (SINES, robot.n))
    phase = rng.uniform(0, 2 * np.pi, (SINES, robot.n))
    amplitude = SPAN * rng.dirichlet(np.ones(SINES), robot.n).T
    model = Dynamics(
        robot,
        (
            *(Term(CoulombFriction(j), (1.0,)) for j in robot.joints[::2]),
            *(Term(ViscousFriction(j), (2.0,)) for j in robot.joints[1::2]),
            Term(Payload(), (1.5, 0.0, 0.0, 0.09, 0.01, 0.0, 0.01, 0.0, 0.0, 0.01)),
        ),
    )
    time = np.arange(rows) / RATE
    position, effort = np.empty((rows, robot.n)), np.empty((rows, robot.n))
    for start in range(0, rows, PART):
        at = slice(start, start + PART)
        angle = time[at, None, None] * frequency + phase
        q = middle + (amplitude * np.sin(angle)).sum(axis=1)
        v = (amplitude * frequency * np.cos(angle)).sum(axis=1)
        a = -(amplitude * frequency**2 * np.sin(angle)).sum(axis=1)
        position[at] = np.round(q / STEP) * STEP
        effort[at] = model.inverse_dynamics(q, v, a) + rng.normal(0.0, NOISE, q.shape)
    return Log(robot.joints, time, position, effort)


def _parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.long_logs", description="Measure time and memory on a long log."
    )
    parser.add_argument("--rows", type=int, default=ROWS, help="samples of the log")
    parser.add_argument("--suffix", default="csv", help="format of the file: csv or parquet")
    parser.add_argument("--log", type=Path, help="file of the log; made if it is not there, and kept")
    parser.add_argument("--commands", nargs="+", default=COMMANDS, help="commands that are measured")
    parser.add_argument("--also", type=Path, nargs="*", default=(), help="other checkouts to measure")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    main()
