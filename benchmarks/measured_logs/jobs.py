"""Measured logs of real arms: what `cdia discover` makes of them, run as a user would run it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.measured_logs.process import cdia
from cdia_pin.discovery import DiscoveryVerdict, compare
from cdia_pin.dynamics import Dynamics, load_model
from cdia_pin.logs import read_log
from cdia_pin.robot import load_robot

Array = NDArray[np.float64]

UR10E = "ur10e/ur10e.urdf"
GAINS = "ur10e/drive_gains.json"
UNSEEN = ("fourier_40s", "point_to_point", *(f"jointwise_{k}" for k in range(1, 7)))  # of the UR10e


@dataclass(frozen=True)
class Job:
    """One call of ``cdia discover``; paths are relative to the folder of the measured logs.

    Attributes:
        arm: What the results call the arm.
        log: The log that is fitted.
        robot: Name in the catalogue, or a URDF.
        gains: File of drive gains, where the log has currents.
        holdout: Log that is only predicted; without, each tenth of the log is predicted from the others.
    """

    arm: str
    log: str
    robot: str
    gains: str | None = None
    holdout: str | None = None


PANDA = Job("panda", "panda/exciting.csv", "panda")
UR10 = Job("ur10", "ur10/exciting.csv", "ur10")
FOURIER = Job("ur10e", "ur10e/fourier_50s.csv", UR10E, GAINS, "ur10e/fourier_40s.csv")
MAIN = (PANDA, UR10, FOURIER)
ALONE = tuple(Job("ur10e", f"ur10e/{name}.csv", UR10E, GAINS) for name in UNSEEN)
JOBS = (*MAIN, *ALONE)


@dataclass(frozen=True)
class Errors:
    """Errors on one log that was not fitted, RMS over torque RMS of that log [1], shape (n,) each."""

    log: str
    joints: tuple[str, ...]
    before: Array
    after: Array

    @property
    def ratio(self) -> float:
        """Mean over the joints of the error after over the error of the URDF alone [1]."""
        return float(np.mean(self.after / self.before))


@dataclass(frozen=True)
class Outcome:
    """What one call of ``cdia discover`` gave.

    Attributes:
        job: The call.
        found: JSON of the result; empty if the command failed.
        errors: On the log's own blocks, or on each of the logs held out.
        has_model: Whether a model was written that loads again.
        seconds: Processor time of the whole process [s].
        failure: What the command said if it failed.
    """

    job: Job
    found: dict[str, Any]
    errors: tuple[Errors, ...]
    has_model: bool
    seconds: float
    failure: str = ""

    @property
    def complete(self) -> bool:
        """Whether there is a verdict and a model."""
        return self.has_model and self.found.get("verdict") in set(DiscoveryVerdict)


def run(job: Job, data: Path, out: Path) -> Outcome:
    """Run ``cdia discover`` as a process of its own.

    Args:
        job: What to run it on.
        data: Folder of the measured logs.
        out: Folder for what it writes.
    """
    result, model = out / "result.json", out / "model.json"
    for old in (result, model):
        old.unlink(missing_ok=True)
    options = ["--robot", _robot(job, data), "--save", str(model), "--json", str(result)]
    options += ["--gains", str(data / job.gains)] if job.gains else []
    options += ["--holdout", str(data / job.holdout)] if job.holdout else []
    done, seconds = cdia("discover", str(data / job.log), *options)
    if done.returncode or not (result.exists() and model.exists()):
        said = (done.stderr or "no result").strip().splitlines()[-1]
        return Outcome(job, {}, (), False, seconds, said.replace(f"{data}/", ""))
    found = json.loads(result.read_text(encoding="utf-8"))
    improved = load_model(model, load_robot(_robot(job, data)))
    errors = _of_logs(job, data, improved) if job.holdout else (_of_blocks(job, found),)
    return Outcome(job, found, errors, True, seconds)


def compare_formats(data: Path, out: Path) -> float:
    """Return by how much the errors that ``cdia compare`` gives for a CSV and a bag of one run differ at most [1]."""
    shares = []
    for name in ("exciting.csv", "exciting.db3"):
        result = out / f"{name}.json"
        done, _ = cdia("compare", str(data / "ur10" / name), "--robot", "ur10", "--json", str(result))
        done.check_returncode()
        relative = json.loads(result.read_text(encoding="utf-8"))["relative_rms"]
        shares.append(np.array([relative[j] for j in sorted(relative)]))
    return float(np.max(np.abs(shares[1] / shares[0] - 1.0)))


def _of_blocks(job: Job, found: dict[str, Any]) -> Errors:
    joints, torque = tuple(found["joints"]), found["torque_rms"]
    before, after = (
        np.array([found["trace"][k]["heldout_rms"][j] / torque[j] for j in joints]) for k in (0, -1)
    )
    return Errors(_name(job), joints, before, after)


def _of_logs(job: Job, data: Path, improved: Dynamics) -> tuple[Errors, ...]:
    """Return the errors on every other log of the arm."""
    robot, gains = improved.robot, data / job.gains if job.gains else None
    out = []
    for name in UNSEEN:
        log = read_log(data / Path(job.log).with_name(f"{name}.csv"), robot, gains=gains)
        before, after = (compare(model, log).relative_rms for model in (Dynamics(robot), improved))
        out.append(Errors(name, robot.joints, before, after))
    return tuple(out)


def _robot(job: Job, data: Path) -> str:
    return str(data / job.robot) if job.robot.endswith(".urdf") else job.robot


def _name(job: Job) -> str:
    return Path(job.log).stem
