"""The plan of a simulated fleet: its robots, their days, and the faults that some of them get."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from benchmarks.plant import Fault

Array = NDArray[np.float64]

ARM = "ur5"
FIRST_DAY = datetime(2026, 3, 1, 6, tzinfo=UTC)
SUITES = {
    "tuning": 100,
    "reporting": 200,
}  # first seed of each; what is tuned never saw the draws for reporting
FAULTY = 8  # robots that get a fault [1], the first ones, so that a part of the fleet has them too
# Friction of a UR5 at 30 °C, as a sum of Coulomb [N·m] and viscous [N·m·s/rad], base to wrist.
LEVEL = np.array([8.0, 8.0, 6.0, 2.0, 2.0, 1.5])
COEFFICIENT = np.array([9.0, 9.0, 7.0, 2.0, 2.0, 1.5])
OF_ROBOT = 0.2  # standard deviation of a robot's friction over that [1]
OF_DAY = 0.01  # and from day to day for no reason that a log tells [1]
COULOMB_DECAY, VISCOUS_DECAY = 0.008, 0.03  # friction that a kelvin takes away [1/K], as lubricants do
REFERENCE = 30.0  # [°C]
LINKS = 0.02  # largest relative error of the URDF's links [1]
PAYLOADS = (0.0, 1.0, 2.0, 3.0)  # [kg]
# Fault → its size: a share of the joint's own friction, of its torque, or N·m over its Coulomb friction.
SIZES = {
    "coulomb_friction": (0.2, 0.4),
    "viscous_friction": (0.2, 0.4),
    "torque_offset": (0.15, 0.3),
    "actuator_gain": (0.04, 0.08),
}
PARAMETER = {
    "coulomb_friction": "level",
    "viscous_friction": "coefficient",
    "torque_offset": "offset",
    "actuator_gain": "gain",
}
GROWTH = 20.0  # [days] in which a fault grows to its size, where it does not step


@dataclass(frozen=True)
class Hidden:
    """The fault of a robot.

    Attributes:
        effect: Name of the effect.
        joint: Its joint, by index.
        size: Its full size, in the unit of its parameter.
        day: Day on which it begins.
        growth: Days in which it grows to its size; zero for a step.
    """

    effect: str
    joint: int
    size: float
    day: int
    growth: float

    def at(self, day: int) -> float:
        """Return its size on a day, in the unit of its parameter."""
        if day < self.day:
            return 0.0
        return self.size * (min(1.0, (day - self.day + 1) / self.growth) if self.growth else 1.0)


@dataclass(frozen=True)
class FleetRobotPlan:
    """One robot of the simulated fleet.

    Attributes:
        number: Its number, from 0.
        seed: Seed of all that is drawn for it.
        days: Number of days.
    """

    number: int
    seed: int
    days: int

    @property
    def name(self) -> str:
        """Its name in the map."""
        return f"arm-{self.number:02d}"

    @cached_property
    def friction(self) -> tuple[Array, Array]:
        """Coulomb level [N·m] and viscous coefficient [N·m·s/rad] at the reference temperature, shape (n,) each."""
        rng = np.random.default_rng([self.seed, 1])
        own = np.maximum(1 + OF_ROBOT * rng.standard_normal((2, len(LEVEL))), 0.5)
        return LEVEL * own[0], COEFFICIENT * own[1]

    @cached_property
    def temperature(self) -> Array:
        """Temperature of the joints on each day [°C], shape (days, n): season, weather, and how hard a joint works."""
        rng = np.random.default_rng([self.seed, 2])
        day = np.arange(self.days)
        season = 28.0 + 6.0 * np.sin(2 * np.pi * (day / 50.0 + rng.uniform()))
        return (
            season[:, None]
            + rng.normal(0.0, 2.0, (self.days, 1))
            + rng.uniform(2.0, 8.0, (self.days, len(LEVEL)))
        )

    @cached_property
    def hidden(self) -> Hidden | None:
        """Its fault; None for most."""
        if self.number >= FAULTY:
            return None
        rng = np.random.default_rng([self.seed, 3])
        effects = list(SIZES)
        effect = effects[self.number % len(effects)]
        # a gain shows where gravity loads the joint
        joint = int(rng.integers(1, 3)) if effect == "actuator_gain" else int(rng.integers(0, len(LEVEL)))
        share = rng.uniform(*SIZES[effect])
        level, coefficient = self.friction
        size = {
            "coulomb_friction": share * level[joint],
            "viscous_friction": share * coefficient[joint],
            "torque_offset": rng.choice((-1, 1)) * share * level[joint],
            "actuator_gain": -share,
        }[effect]
        day = int(rng.integers(self.days // 3, 2 * self.days // 3))
        return Hidden(effect, joint, float(size), day, GROWTH if self.number >= len(effects) else 0.0)

    def faults(self, day: int, joints: tuple[str, ...]) -> list[Fault]:
        """Return what the plant has on a day: friction at its temperature, a payload, and the fault.

        Args:
            day: The day.
            joints: Names of the joints.
        """
        rng = np.random.default_rng([self.seed, 4, day])
        warm = self.temperature[day] - REFERENCE
        level, coefficient = self.friction
        scatter = 1 + OF_DAY * rng.standard_normal((2, len(joints)))
        level = level * np.exp(-COULOMB_DECAY * warm) * scatter[0]
        coefficient = coefficient * np.exp(-VISCOUS_DECAY * warm) * scatter[1]
        mass, where = float(rng.choice(PAYLOADS)), rng.uniform(-0.03, 0.03, 2)
        out = []
        if mass:
            out.append(Fault("payload", mass=mass, com=(*where, rng.uniform(0.03, 0.12))))
        if self.hidden is not None and (size := self.hidden.at(day)):
            at, effect = self.hidden.joint, self.hidden.effect
            if effect == "coulomb_friction":
                level[at] += size
            elif effect == "viscous_friction":
                coefficient[at] += size
            else:
                out.append(Fault(effect, joint=joints[at], **{PARAMETER[effect]: size}))
        for j, joint in enumerate(joints):
            out.append(Fault("coulomb_friction", joint=joint, level=level[j]))
            out.append(Fault("viscous_friction", joint=joint, coefficient=coefficient[j]))
        return out

    def date(self, day: int) -> datetime:
        """Return the time at which a day's log is recorded."""
        return FIRST_DAY + timedelta(days=day)


def planned(suite: str, robots: int, days: int) -> list[FleetRobotPlan]:
    """Return the robots of a suite.

    Args:
        suite: ``tuning`` or ``reporting``.
        robots: Their number.
        days: Number of days.
    """
    return [FleetRobotPlan(k, SUITES[suite] * 1000 + k, days) for k in range(robots)]
