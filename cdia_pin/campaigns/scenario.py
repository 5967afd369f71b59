"""Scenarios: runs that are determined by their numbers, and the arms that share them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count, product
from zlib import crc32

import numpy as np

from cdia_pin.campaigns.campaign_spec import CampaignSpec, Setting, with_joint
from cdia_pin.campaigns.closed_loop import LoopSettings
from cdia_pin.robot import load_robot


@dataclass(frozen=True)
class DrawnArm:
    """An arm whose inertias, motions and noise are drawn, with the monitor that learns from it.

    Attributes:
        robot: Name of the catalogue, or path of a URDF file.
        loop: Rate, noise, model error, healthy runs and seed.
        bank: Known effects.
        engine: Of the monitor.
        settings: Of the engine.
    """

    robot: str
    loop: LoopSettings
    bank: tuple[str, ...]
    engine: str
    settings: tuple[Setting, ...]


@dataclass(frozen=True)
class Scenario:
    """A run to be made.

    Attributes:
        number: Number of the run in its campaign; it stays the same for the same plan.
        repeat: Number of the arm among those of the same combination.
        faults: What is hidden, as terms; none in a healthy run.
        share: Size of each fault as a share of its joint's torque [1]; None leaves the terms as written.
        duration: Length [s].
        noise: Number of the noise.
    """

    number: int
    repeat: int
    faults: tuple[str, ...]
    share: float | None
    duration: float
    noise: int


@dataclass(frozen=True)
class Batch:
    """All runs of one arm: its monitor learns once.

    Attributes:
        arm: The arm.
        scenarios: Its runs.
        tracking: Whether tracking is compared with other runs.
    """

    arm: DrawnArm
    scenarios: tuple[Scenario, ...]
    tracking: bool


def planned(spec: CampaignSpec) -> Iterator[Batch]:
    """Yield the runs of a campaign arm by arm, always the same ones for the same plan.

    Arms that differ in settings alone are the same draws, so that settings are compared on equal terms.

    Args:
        spec: The plan.
    """
    numbers = count()
    joints = {name: load_robot(name).joints for name in spec.robots}
    for repeat in range(spec.repeats):
        seed = int(np.random.SeedSequence([spec.seed, repeat]).generate_state(1)[0])
        for robot, loop in product(spec.robots, spec.loops(seed)):
            happens: list[tuple[tuple[str, ...], float | None, float]] = []
            if spec.healthy:
                happens.append(((), None, spec.healthy))
            for k, case in enumerate(spec.faults):
                joint = drawn_joint(joints[robot], seed, robot, k)
                terms = tuple(with_joint(text, joint) for text in case.terms)
                happens += [(terms, share, spec.duration) for share in case.shares]
            for chosen in spec.combinations():
                arm = DrawnArm(robot, loop, spec.bank, spec.engine, chosen)
                runs = (Scenario(next(numbers), repeat, *what, noise=k) for k, what in enumerate(happens))
                yield Batch(arm, tuple(runs), spec.tracking)


def drawn_joint(joints: tuple[str, ...], seed: int, robot: str, case: int) -> str:
    """Return the joint on which a case of faults acts.

    Args:
        joints: Names of the robot's joints.
        seed: Of the arm.
        robot: Name of the robot.
        case: Number of the case.
    """
    rng = np.random.default_rng([seed, 4, case, crc32(robot.encode())])
    return joints[int(rng.integers(len(joints)))]
