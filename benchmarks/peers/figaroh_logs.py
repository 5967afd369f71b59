"""figaroh: all base parameters, friction, rotors and offsets of all joints at once; it names no effect.

It runs in an environment of its own, whose interpreter is in the variable ``CDIA_FIGAROH_PYTHON``.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.peers.answer import Answer
from benchmarks.peers.figaroh_process import SCRIPT
from cdia_pin.discovery.experiment import NEAR_REST, Experiment, Segment
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]

PYTHON = os.environ.get("CDIA_FIGAROH_PYTHON", "")
LONGEST = 300.0  # [s]

if not PYTHON:
    raise ImportError("figaroh: CDIA_FIGAROH_PYTHON does not name an interpreter")


def fit(robot: RobotModel, log: Log) -> Answer:
    """Fit a log; the fit is made again for each motion that is predicted, since its script keeps none."""
    (segment,) = Experiment.of(robot, [condition(log, robot)]).segments
    motion = segment.motion
    _predicted(robot, segment, motion.q, motion.v, motion.a)  # what a user waits for
    return Answer((), lambda q, v, a: _predicted(robot, segment, q, v, a))


def _predicted(robot: RobotModel, fitted: Segment, q: Array, v: Array, a: Array) -> Array:
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
            unseen_q=q,
            unseen_v=v,
            unseen_a=a,
        )
        done = subprocess.run(
            [PYTHON, str(SCRIPT), str(given), str(answer)],
            capture_output=True,
            text=True,
            check=False,
            timeout=LONGEST,
        )
        if done.returncode:
            raise RuntimeError((done.stderr or "no reason given").strip().splitlines()[-1])
        told = dict(np.load(answer))
    return np.asarray(told.get("physical", told["base"]))
