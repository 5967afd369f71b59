"""Which logs are monitored, and what was healthy for each."""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.real_residuals.draws import can_be_seen
from benchmarks.real_residuals.recordings import Part, Recording

EFFECTS = (
    "coulomb_friction",
    "viscous_friction",
    "bearing_friction",
    "actuator_gain",
    "torque_offset",
    "joint_spring",
    "payload",
)
SHARE = 0.25  # [1], RMS torque of an effect over that of the joint on which it is largest
DRAWS = {"tuning": (1, 2, 3), "reporting": (11, 12, 13)}  # seeds of joint, sign and shape
HEALTHY, WEIGHT, PUSHED, EFFECT = "healthy", "weight", "pushed", "effect"  # kinds of case
PUSHES = (("ur10e", "push_1"), ("ur5", "pushed"), ("ur5", "pushed_at_rest"))


@dataclass(frozen=True)
class Case:
    """A log to be monitored.

    Attributes:
        kind: What is asked.
        before: The healthy log: its model is discovered, and thresholds are learned from it.
        after: The monitored log.
        effect: Effect that is there from its middle on; empty for none.
        seed: Of the effect's joint, sign and shape.
    """

    kind: str
    before: Recording
    after: Recording
    effect: str = ""
    seed: int = 0

    @property
    def id(self) -> str:
        """Name that stays the same."""
        what = f"/{self.effect}/{self.seed}" if self.effect else ""
        return f"{self.kind}/{self.before.id} → {self.after.id}{what}"

    @property
    def arm(self) -> str:
        """Name of the arm."""
        return self.before.arm


def pairs() -> list[tuple[Recording, Recording]]:
    """Return pairs of healthy logs of each arm, the first before the second."""
    halved = [Recording(a, "exciting").halves() for a in ("panda", "ur10", "kuka_lwr4")]
    long, short, points = (Recording("ur10e", f) for f in ("fourier_50s", "fourier_40s", "point_to_point"))
    swings = (Recording("double_pendulum", "swing_1"), Recording("double_pendulum", "swing_2"))
    return [*halved, (long, short), (long, points), Recording("ur5", "free").halves(), swings]


def planned(suite: str) -> list[Case]:
    """Return all cases.

    Args:
        suite: Of which draws.
    """
    long, free = Recording("ur10e", "fourier_50s"), Recording("ur5", "free", Part.FIRST)
    whole = {"ur10e": long, "ur5": free}
    out = [Case(HEALTHY, a, b) for a, b in pairs()]
    out += [Case(HEALTHY, long, Recording("ur10e", f"jointwise_{k}")) for k in range(1, 7)]
    out.append(Case(WEIGHT, long, Recording("ur10e", "loaded_2600g")))
    out += [Case(PUSHED, whole[arm], Recording(arm, file)) for arm, file in PUSHES]
    for a, b in pairs():
        if b.file == "point_to_point":
            continue
        for effect in EFFECTS:
            if can_be_seen(effect, a.arm):
                out += [Case(EFFECT, a, b, effect, seed) for seed in DRAWS[suite]]
    return out
