"""figaroh in a process and an environment of its own, whose interpreter is in ``CDIA_FIGAROH_PYTHON``."""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.measured_logs.errors import Bench, Column
from benchmarks.measured_logs.process import run
from cdia_pin.regression.experiment import Segment
from cdia_pin.regression.rest import RestSettings
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]

PYTHON = os.environ.get("CDIA_FIGAROH_PYTHON", "")
SCRIPT = Path(__file__).with_name("figaroh_fit.py")
LONGEST = 600.0  # [s]


class AbsentError(Exception):
    """figaroh cannot take part; the message says why."""


def ask(
    python: str, robot: RobotModel, fitted: Segment, q: Array, v: Array, a: Array
) -> tuple[dict[str, Array], float]:
    """Let figaroh fit a log and predict a motion.

    Args:
        python: Interpreter of an environment that has figaroh.
        robot: The robot.
        fitted: The log, filtered as everybody gets it.
        q: Positions of the motion [rad or m], shape (N, n).
        v: Velocities [rad/s or m/s], shape (N, n).
        a: Accelerations [rad/s² or m/s²], shape (N, n).

    Returns:
        What its script answers, and the processor time of the process [s].

    Raises:
        AbsentError: If it is not there, or fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        given, answer = Path(folder) / "given.npz", Path(folder) / "answer.npz"
        np.savez(
            given,
            urdf=str(robot.urdf),
            joints=list(robot.joints),
            locked=list(robot.locked),
            locked_at=[held.position for held in robot.locked.values()],
            moving=(np.abs(fitted.state.v) > RestSettings().near_rest * fitted.state.sign_width).all(axis=1),
            decimation=fitted.motion.decimation,
            **{name: getattr(fitted.motion, name) for name in ("time", "q", "v", "a", "effort")},
            unseen_q=q,
            unseen_v=v,
            unseen_a=a,
        )
        try:
            done, seconds = run([python, str(SCRIPT), str(given), str(answer)], LONGEST)
        except OSError as error:  # of its own words the page has no use: they are about a path
            raise AbsentError(f"its interpreter does not start ({error.strerror})") from None
        except subprocess.TimeoutExpired:
            raise AbsentError(f"it took longer than {LONGEST:g} s") from None
        if done.returncode:
            raise AbsentError((done.stderr or "no reason given").strip().splitlines()[-1])
        return dict(np.load(answer)), seconds


def figaroh(bench: Bench, python: str) -> list[Column]:
    """Return what figaroh's fits leave of the unseen log.

    Args:
        bench: The case; figaroh gets the same filtered signals as everybody.
        python: Interpreter of an environment that has figaroh.

    Raises:
        AbsentError: If it is not there, or fails.
    """
    (fitted,), (unseen,) = bench.fitted.segments, bench.unseen.segments
    motion = unseen.motion
    told, seconds = ask(python, bench.case.robot, fitted, motion.q, motion.v, motion.a)
    columns = []
    for key, name in (("base", "figaroh, weighted least squares"), ("physical", "figaroh, physical fit")):
        if key in told:
            left = motion.compared(told[key] - motion.effort)
            spent = seconds - float(told["physical_seconds"]) + float(told[f"{key}_seconds"])
            columns.append(bench.left(name, left, seconds=spent))
    return columns
