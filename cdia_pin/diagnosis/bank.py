"""The bank: the effects that are asked of every joint, and where their columns stand."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import ALWAYS, EFFECTS, Effect, JointEffect, Profile, Region, parse_term
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

DEFAULT_BANK = (
    "coulomb_friction",
    "viscous_friction",
    "actuator_gain",
    "torque_offset",
    "joint_spring",
    "position_ripple",
)
MOST_EFFECTS = 12  # 2^12 combinations are decided upon in a few milliseconds


@dataclass(frozen=True)
class Bank:
    """Effects of one joint, the same for every joint, with their columns side by side.

    Attributes:
        robot: Whose joints are asked.
        prototypes: One of each effect, on the robot's first joint.
        profiles: Where each may be present at all.
    """

    robot: RobotModel
    prototypes: tuple[JointEffect, ...]
    profiles: tuple[Profile, ...]

    @classmethod
    def of(cls, robot: RobotModel, effects: Iterable[str | JointEffect] = DEFAULT_BANK) -> Bank:
        """Build a bank.

        Args:
            robot: Whose joints are asked.
            effects: Names of effects of one joint, with their shape or profile where need be, such as
                ``coulomb_friction``, ``position_ripple: frequency=7``, ``viscous_friction: speed=0.5..``; lines of
                arithmetic such as ``sin(3*q)*dq``; or effects, of whatever joint.

        Raises:
            EffectError: If an effect is not one of a joint, is named twice, or there are too many.
        """
        given = [_entry(e, robot) for e in effects]
        names = [bare(p) for p, _ in given]
        if len(set(names)) < len(names):
            raise EffectError(f"the bank names an effect twice: {', '.join(names)}")
        if not 0 < len(given) <= MOST_EFFECTS:
            raise EffectError(f"a bank holds 1 to {MOST_EFFECTS} effects, given {len(given)}")
        return cls(robot, tuple(p for p, _ in given), tuple(profile for _, profile in given))

    def __len__(self) -> int:
        return len(self.prototypes)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the effects, without a joint."""
        return tuple(bare(p) for p in self.prototypes)

    @cached_property
    def ends(self) -> NDArray[np.int64]:
        """First column of each effect, and the number of all, shape (N + 1,)."""
        return np.cumsum([0, *(p.size for p in self.prototypes)])

    @property
    def width(self) -> int:
        """Number of columns P."""
        return int(self.ends[-1])

    def span(self, i: int) -> slice:
        """Return the columns of an effect."""
        return slice(int(self.ends[i]), int(self.ends[i + 1]))

    def columns(self, chosen: Sequence[int]) -> NDArray[np.int64]:
        """Return the columns of some effects."""
        return np.concatenate(
            [np.arange(self.ends[i], self.ends[i + 1]) for i in chosen] or [np.zeros(0, int)]
        )

    def members(self, mask: int) -> list[int]:
        """Return the effects of a combination, which has one bit for each."""
        return [i for i in range(len(self)) if mask >> i & 1]

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Smallest and largest physical parameter of every column, shape (P,) each."""
        lower, upper = zip(*(p.bounds(self.robot) for p in self.prototypes), strict=True)
        return np.concatenate(lower), np.concatenate(upper)

    def effect(self, i: int, joint: str) -> JointEffect:
        """Return an effect of the bank on a joint."""
        return replace(self.prototypes[i], joint=joint)

    def index(self, effect: JointEffect) -> int | None:
        """Return which effect of the bank another one is, whatever its joint."""
        alike = replace(effect, joint=self.robot.joints[0])
        return self.prototypes.index(alike) if alike in self.prototypes else None


def prototype(effect: JointEffect, robot: RobotModel) -> JointEffect:
    """Return an effect of one joint on the robot's first joint."""
    return replace(effect, joint=robot.joints[0])


def bare(effect: JointEffect) -> str:
    """Return the label of an effect without its joint."""
    return effect.label.rpartition("@")[0]


def on_joint(profile: Profile, joint: str) -> Profile:
    """Return a profile as it is on a joint."""
    return replace(profile, joint=joint) if isinstance(profile, Region) else profile


def _entry(given: str | JointEffect, robot: RobotModel) -> tuple[JointEffect, Profile]:
    effect, profile = (_parsed(given, robot)) if isinstance(given, str) else (given, ALWAYS)
    if not isinstance(effect, JointEffect):
        of_joint = [
            n for n, e in EFFECTS.items() if issubclass(e, JointEffect) and n not in ("expression", "unknown")
        ]
        raise EffectError(f"{effect.name} is not an effect of one joint; a bank holds {', '.join(of_joint)}")
    if effect.name == "unknown":
        raise EffectError("what is unknown is learned when no effect of the bank explains it; leave it out")
    if effect.memories:
        raise EffectError(f"{effect.name} has memory; a bank cannot hold it yet")
    return prototype(effect, robot), profile


def _parsed(text: str, robot: RobotModel) -> tuple[Effect, Profile]:
    label, colon, rest = (part.strip() for part in text.partition(":"))
    if "@" in label:
        raise EffectError(f"a bank asks every joint: write '{label.partition('@')[0]}' without a joint")
    kind = EFFECTS.get(label)
    scope = "@" + "+".join(robot.joints[: len(kind.scope_fields)]) if kind and kind.scope_fields else ""
    term = parse_term((label + (scope if kind else f"@{robot.joints[0]}")) + colon + rest, robot)
    if any(term.theta):
        raise EffectError(f"'{text}': a bank asks for the size of an effect, it is not given one")
    return term.effect, term.profile
