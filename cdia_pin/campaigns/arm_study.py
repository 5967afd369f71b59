"""An accommodation study like the thesis', on arms of today: healthy, with faults, and with a monitor.

Faults act on all joints at once, as in [Thesis] §4.3, each in proportion to the torque of its joint. The plant's
inertias differ from the model's, its sensors have noise and rounding, and the monitor has learned from other motions.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
from cdia_pin.campaigns.loop_comparison import LoopComparison, compare_loops, onset
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import ActuatorGain, CoulombFriction, Term, ViscousFriction, after
from cdia_pin.phrases import shortened
from cdia_pin.progress import Progress, silent
from cdia_pin.robot import load_robot

Array = NDArray[np.float64]

ARMS = ("panda", "ur5", "xarm7")
FIRST, SECOND, DURATION = 2.0, 5.0, 12.0  # [s], onset of the first and second faults, end of a run
SETTLED = 3.0  # [s], from the last onset to the start of the comparison: time for both isolations
LOSS = -0.3  # [1], lost share of the torque, as in the thesis
FRICTION = 0.2  # [1], torque of each friction over the RMS torque of its joint


class ArmCaseRecord(TypedDict):
    """A case in JSON.

    Attributes:
        arm: Name of the robot.
        case: Name of the case.
        joints: Names of the joints.
        since: Start of the comparison of tracking [s].
        tracking_rms: RMS tracking error by run and joint [rad or m].
        faults: Records of the true faults.
        named: Number of faults that are believed at the end by their right name and joint.
        of: Number of true faults.
        wrong: Labels of faults that are believed at the end and are not true.
        events: Records of the monitor's events.
    """

    arm: str
    case: str
    joints: list[str]
    since: float
    tracking_rms: dict[str, dict[str, float]]
    faults: Sequence[Mapping[str, object]]
    named: int
    of: int
    wrong: list[str]
    events: Sequence[Mapping[str, object]]


class ArmStudyRecord(TypedDict):
    """The study in JSON, schema ``cdia-study-arms/1``.

    Attributes:
        schema: Name of the schema.
        cases: Records of the cases.
    """

    schema: str
    cases: list[ArmCaseRecord]


@dataclass(frozen=True, eq=False, repr=False)
class ArmCase:
    """One fault on one arm.

    Attributes:
        arm: Name of the robot.
        name: Kind of fault.
        faults: The true faults.
        compared: The runs: healthy, with faults, and with faults under the monitor.
    """

    arm: str
    name: str
    faults: tuple[Term, ...]
    compared: LoopComparison

    def __repr__(self) -> str:
        return f"ArmCase({shortened(self.arm)}, {shortened(self.name)}, {len(self.faults)} faults)"

    def tracking(self) -> dict[str, Array]:
        """Return the RMS tracking error of each run by its name [rad or m], shape (n,) each."""
        return self.compared.tracking()

    def named(self) -> tuple[int, int]:
        """Count the faults that are believed at the end by their right name and joint, and all true faults."""
        run = self.compared.monitored.monitored
        believed = set() if run is None else {t.label for t in run.faults}
        true = {t.label for t in self.faults}
        return len(believed & true), len(true)

    def wrong(self) -> tuple[str, ...]:
        """Return the labels of faults that are believed at the end and are not true."""
        run = self.compared.monitored.monitored
        true = {t.label for t in self.faults}
        return () if run is None else tuple(t.label for t in run.faults if t.label not in true)

    def to_dict(self) -> ArmCaseRecord:
        """Return the numbers as ``cdia study arms --json`` writes them."""
        robot = self.compared.loop.robot
        run = self.compared.monitored.monitored
        right, there = self.named()
        return {
            "arm": self.arm,
            "case": self.name,
            "joints": list(robot.joints),
            "since": self.compared.since,
            "tracking_rms": {
                kind: dict(zip(robot.joints, rms.tolist(), strict=True))
                for kind, rms in self.tracking().items()
            },
            "faults": [t.to_dict(robot) for t in self.faults],
            "named": right,
            "of": there,
            "wrong": list(self.wrong()),
            "events": [] if run is None else [e.to_dict(robot) for e in run.events],
        }


def arm_study(
    arms: Sequence[str] = ARMS,
    *,
    settings: LoopSettings | None = None,
    duration: float = DURATION,
    cases: Sequence[str] | None = None,
    done: Collection[tuple[str, str]] = (),
    keep: Callable[[ArmCase], None] = lambda case: None,
    progress: Progress = silent,
) -> tuple[ArmCase, ...]:
    """Run every case on every arm.

    Args:
        arms: Names of robots.
        settings: Settings of the loops.
        duration: Length of a run [s].
        cases: Names of cases of `arm_faults`; all if omitted.
        done: Arm and name of cases that are not run again.
        keep: Called with each case as soon as it has been run.
        progress: Called with the current work and the share that is done [1].

    Returns:
        The cases that were run, arm by arm.
    """
    out = []
    for i, arm in enumerate(arms):
        loop = ClosedLoop(Dynamics(load_robot(arm)), settings or LoopSettings())
        faults = arm_faults(loop, duration)
        chosen = [name for name in (faults if cases is None else cases) if (arm, name) not in done]
        if not chosen:
            continue
        monitor = loop.monitor(progress=_part(progress, f"{arm}, ", i / len(arms), 0.1 / len(arms)))
        width = 0.9 / len(arms) / len(chosen)
        for k, name in enumerate(chosen):
            tell = _part(progress, f"{arm}, {name}: ", (i + 0.1) / len(arms) + k * width, width)
            since = max(onset([t]) for t in faults[name]) + SETTLED
            compared = compare_loops(loop, monitor, faults[name], duration, since=since, progress=tell)
            out.append(ArmCase(arm, name, faults[name], compared))
            keep(out[-1])
    return tuple(out)


def _part(progress: Progress, about: str, begin: float, width: float) -> Progress:
    """Return the progress of a part of the work."""
    return lambda sentence, share: progress(about + sentence, begin + width * share)


def arm_faults(loop: ClosedLoop, duration: float) -> dict[str, tuple[Term, ...]]:
    """Return the faults of each case, in proportion to the torques of a motion.

    Args:
        loop: The loop; its motion number 0 gives the torques.
        duration: Length of that motion [s].

    Returns:
        True faults by the name of the case.
    """
    robot = loop.model.robot
    asked = loop.motion(0, duration)(np.linspace(0.0, duration, 1000))
    torque = np.sqrt(np.mean(robot.inverse_dynamics(asked.q, asked.v, asked.a) ** 2, axis=0))
    speed = np.sqrt(np.mean(asked.v**2, axis=0))
    every = list(zip(robot.joints, torque, speed, strict=True))
    coulomb = tuple(Term(CoulombFriction(j), (FRICTION * t,), after(FIRST)) for j, t, _ in every)
    viscous = tuple(Term(ViscousFriction(j), (FRICTION * t / v,), after(FIRST)) for j, t, v in every)
    loss = tuple(Term(ActuatorGain(j), (LOSS,), after(FIRST)) for j, _, _ in every)
    late_loss = tuple(Term(ActuatorGain(j), (LOSS,), after(SECOND)) for j, _, _ in every)
    return {
        f"{-100 * LOSS:.0f} % torque loss": loss,
        "Coulomb friction": coulomb,
        "friction, then torque loss": (*coulomb, *viscous, *late_loss),
    }


def to_dict(cases: Sequence[ArmCaseRecord]) -> ArmStudyRecord:
    """Return a study as ``cdia study arms --json`` writes it.

    Args:
        cases: Records of the results of `arm_study`.

    Returns:
        Plain JSON.
    """
    return {"schema": schemas.STUDY_ARMS, "cases": list(cases)}
