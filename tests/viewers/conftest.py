"""Results to look at: a SCARA with friction that its model lacks, two logs and a held-out one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from cdia_pin.discovery import Comparison, Discovery, compare, discover
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import CoulombFriction, StribeckFriction, Term, ViscousFriction
from cdia_pin.identifiability import Confusion
from cdia_pin.logs import Log, LogCheck, check_log
from cdia_pin.resources import robots_dir
from cdia_pin.robot import RobotModel, load_robot
from cdia_pin.viewers import write_report

LEVEL = 4.0  # [N·m] of the dry friction that is missing
COMMAND = "cdia discover a.csv --robot scara --report out.html"


@dataclass(frozen=True)
class Results:
    """What a session has in hand when it writes a report."""

    robot: RobotModel
    logs: tuple[Log, ...]
    given: Comparison
    improved: Comparison
    discovery: Discovery
    checks: tuple[LogCheck, ...]
    level: float = LEVEL

    def write(self, path: Path) -> str:
        """Write the report and return its text."""
        written = write_report(
            path,
            self.given,
            improved=self.improved,
            discovery=self.discovery,
            checks=self.checks,
            command=COMMAND,
        )
        return written.read_text(encoding="utf-8")


def measured(robot: RobotModel, seed: int, source: str, duration: float = 12.0) -> Log:
    """Return a log of the arm with friction on its first and third joint."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, duration, 0.01)
    reach = np.where(robot.is_prismatic, 0.04, 0.25)
    position = np.zeros((len(time), robot.n))
    for k in range(1, 6):
        phase = rng.uniform(0, 2 * np.pi, robot.n)
        position += reach / k * np.sin(0.2 * np.pi * k * time[:, None] + phase)
    velocity = np.gradient(position, time, axis=0)
    acceleration = np.gradient(velocity, time, axis=0)
    plant = Dynamics(
        robot,
        (
            Term.of(CoulombFriction(joint=robot.joints[2]), level=LEVEL),
            Term.of(ViscousFriction(joint=robot.joints[0]), coefficient=2.0),
        ),
    )
    effort = plant.inverse_dynamics(position, velocity, acceleration)
    return Log(robot.joints, time, position, effort + rng.normal(0, 0.02, effort.shape), source=source)


def results_of(robot: RobotModel, source: str) -> Results:
    """Run what a session runs."""
    model = Dynamics(robot)
    logs = (measured(robot, 1, source), measured(robot, 2, f"second {source}"))
    discovery = discover(model, logs, holdout=measured(robot, 3, f"held out {source}"))
    improved = compare(discovery.model, logs)
    checks = (check_log(logs[0], robot),)
    return Results(robot, logs, compare(model, logs), improved, discovery, checks)


@pytest.fixture(scope="session")
def results() -> Results:
    return results_of(load_robot("scara"), "a.csv")


@pytest.fixture(scope="session")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """The same, with names that would like to be markup."""
    text = (robots_dir() / "scara.urdf").read_text()
    text = text.replace('"joint2"', '"[red]j2&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;"')
    path = tmp_path_factory.mktemp("hostile") / "arm.urdf"
    path.write_text(text)
    return results_of(load_robot(path), "<script>alert(2)</script><!--.csv")


@pytest.fixture(scope="session")
def doubtful(results: Results) -> Discovery:
    """A discovery with one effect of each kind: several parameters, a shape, a confusion."""
    robot = results.robot
    term = Term(
        StribeckFriction(joint=robot.joints[2], decay=8.0), (LEVEL, 1.5), ci95=((3.9, 4.1), (-0.5, 3.5))
    )
    other = CoulombFriction(joint=robot.joints[2])
    first = results.discovery.trace[0]
    last = replace(first, term=term, rms=0.1 * first.rms, heldout_rms=0.2 * first.rms)
    last = replace(last, confusions=(Confusion((other,), "move the joint slowly"),))
    return replace(results.discovery, trace=(first, last), verdict="explained", structure_left=())
