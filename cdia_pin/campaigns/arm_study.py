"""The thesis' accommodation study in spirit, on arms of today: nominal control, with faults, and with a monitor.

Faults act on all joints at once, as in [Thesis] §4.3, each in proportion to the torque of its joint. The plant's
inertias are not the model's, its sensors round and are noisy, and the monitor has learned from other motions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
from cdia_pin.campaigns.loop_comparison import Comparison, compare_loops, onset
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import ActuatorGain, CoulombFriction, Term, ViscousFriction, after
from cdia_pin.robot import load_robot

Array = NDArray[np.float64]
Tell = Callable[[str, float], None]

ARMS = ("panda", "ur5", "xarm7")
FIRST, SECOND, DURATION = 2.0, 5.0, 12.0  # [s]
SETTLED = 3.0  # [s] after the last fault began, from which tracking is compared
LOSS = -0.3  # [1], share of the torque
FRICTION = 0.2  # [1], torque of each friction over the RMS torque of its joint


@dataclass(frozen=True, eq=False)
class ArmCase:
    """One fault on one arm.

    Attributes:
        arm: Name of the robot.
        name: What breaks.
        faults: The truth.
        compared: Healthy, faulty and under the monitor.
    """

    arm: str
    name: str
    faults: tuple[Term, ...]
    compared: Comparison

    def tracking(self) -> dict[str, Array]:
        """Return the RMS of the tracking error of each run [rad or m], shape (n,), by its name."""
        return self.compared.tracking()

    def named(self) -> tuple[int, int]:
        """Return how many faults are believed at the end by their right name and joint, and how many there were."""
        run = self.compared.monitored.monitored
        believed = set() if run is None else {t.label for t in run.faults}
        true = {t.label for t in self.faults}
        return len(believed & true), len(true)

    def wrong(self) -> tuple[str, ...]:
        """Return what is believed at the end and was not there."""
        run = self.compared.monitored.monitored
        true = {t.label for t in self.faults}
        return () if run is None else tuple(t.label for t in run.faults if t.label not in true)

    def to_dict(self) -> dict[str, Any]:
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
    progress: Tell = lambda sentence, share: None,
) -> tuple[ArmCase, ...]:
    """Run every case on every arm.

    Args:
        arms: Names of robots.
        settings: Of the loops.
        duration: Length of a run [s].
        cases: Which of `arm_faults`; all if omitted.
        progress: Told what is being done, and the share that is done.
    """
    out = []
    for i, arm in enumerate(arms):
        loop = ClosedLoop(Dynamics(load_robot(arm)), settings or LoopSettings())
        monitor = loop.monitor(progress=_part(progress, f"{arm}, ", i / len(arms), 0.1 / len(arms)))
        faults = arm_faults(loop, duration)
        chosen = list(faults) if cases is None else list(cases)
        width = 0.9 / len(arms) / len(chosen)
        for k, name in enumerate(chosen):
            tell = _part(progress, f"{arm}, {name}: ", (i + 0.1) / len(arms) + k * width, width)
            since = max(onset([t]) for t in faults[name]) + SETTLED
            compared = compare_loops(loop, monitor, faults[name], duration, since=since, progress=tell)
            out.append(ArmCase(arm, name, faults[name], compared))
    return tuple(out)


def _part(progress: Tell, about: str, begin: float, width: float) -> Tell:
    """Return what tells of a part of the work."""
    return lambda sentence, share: progress(about + sentence, begin + width * share)


def arm_faults(loop: ClosedLoop, duration: float) -> dict[str, tuple[Term, ...]]:
    """Return the faults of each case, in proportion to the torques of a motion.

    Args:
        loop: Whose motion number 0 sets the sizes.
        duration: Its length [s].
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


def to_dict(cases: Sequence[ArmCase]) -> dict[str, Any]:
    """Return a study as ``cdia study arms --json`` writes it."""
    return {"schema": schemas.STUDY_ARMS, "cases": [case.to_dict() for case in cases]}
