"""figaroh on a case of measured logs, in a process and an environment of its own."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.measured_logs.errors import Bench, Column
from benchmarks.measured_logs.process import run
from cdia_pin.discovery.experiment import NEAR_REST

SCRIPT = Path(__file__).with_name("figaroh_fit.py")
LONGEST = 600.0  # [s]


class AbsentError(Exception):
    """figaroh cannot take part; the message says why."""


def figaroh(bench: Bench, python: str) -> list[Column]:
    """Return what figaroh's fits leave of the unseen log.

    Args:
        bench: The case; figaroh gets the same filtered signals as everybody.
        python: Interpreter of an environment that has figaroh.

    Raises:
        AbsentError: If it is not there, or fails.
    """
    (fitted,), (unseen,) = bench.fitted.segments, bench.unseen.segments
    robot = bench.case.robot
    with tempfile.TemporaryDirectory() as folder:
        given, answer = Path(folder) / "given.npz", Path(folder) / "answer.npz"
        np.savez(
            given,
            urdf=str(robot.urdf),
            joints=list(robot.joints),
            locked=list(robot.locked),
            locked_at=[held.position for held in robot.locked.values()],
            moving=(np.abs(fitted.state.v) > NEAR_REST * fitted.state.sign_width).all(axis=1),
            decimation=fitted.motion.decimation,
            **{name: getattr(fitted.motion, name) for name in ("time", "q", "v", "a", "effort")},
            **{f"unseen_{name}": getattr(unseen.motion, name) for name in "qva"},
        )
        try:
            done, seconds = run([python, str(SCRIPT), str(given), str(answer)], LONGEST)
        except OSError as error:  # of its own words the page has no use: they are about a path
            raise AbsentError(f"its interpreter does not start ({error.strerror})") from None
        except subprocess.TimeoutExpired:
            raise AbsentError(f"it took longer than {LONGEST:g} s") from None
        if done.returncode:
            raise AbsentError((done.stderr or "no reason given").strip().splitlines()[-1])
        told = dict(np.load(answer))
    columns = []
    for key, name in (("base", "figaroh, weighted least squares"), ("physical", "figaroh, physical fit")):
        if key in told:
            left = unseen.motion.compared(told[key] - unseen.motion.effort)
            spent = seconds - float(told["physical_seconds"]) + float(told[f"{key}_seconds"])
            columns.append(bench.left(name, left, seconds=spent))
    return columns
