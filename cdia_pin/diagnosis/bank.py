"""The bank: the known effects that are tested on every joint, and the places of their columns."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import (
    ALWAYS,
    EFFECTS,
    Effect,
    JointEffect,
    Profile,
    Region,
    SensedFrom,
    Signal,
    parse_term,
)
from cdia_pin.errors import EffectError
from cdia_pin.logs.torque_side import TorqueSide
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

MOST_SHOWN = 6  # effects that `repr` lists
DEFAULT_BANK = (
    "coulomb_friction",
    "viscous_friction",
    "actuator_gain",
    "torque_offset",
    "joint_spring",
    "position_ripple",
)
BEHIND_GEAR = "bearing_friction"  # what a torque sensor there sees in place of the drive's friction
MOST_EFFECTS = 12  # a decision between 2^12 combinations takes a few milliseconds


@dataclass(frozen=True, repr=False)
class Bank:
    """Effects of one joint, the same for every joint, with their columns side by side.

    Attributes:
        robot: The arm.
        prototypes: One of each effect, on the robot's first joint.
        profiles: Where in the motion each effect may be present.
    """

    robot: RobotModel
    prototypes: tuple[JointEffect, ...]
    profiles: tuple[Profile, ...]

    @classmethod
    def of(cls, robot: RobotModel, effects: Iterable[str | JointEffect] = DEFAULT_BANK) -> Bank:
        """Build a bank.

        Args:
            robot: The arm.
            effects: Names of effects of one joint, with a shape or a profile if needed, such as
                ``coulomb_friction``, ``position_ripple: frequency=7``, ``viscous_friction: speed=0.5..``; lines of
                arithmetic such as ``sin(3*q)*dq``; or effects, on any joint.

        Raises:
            EffectError: If an effect is not one of a joint, is given twice, or there are too many.
        """
        given = [_entry(e, robot) for e in effects]
        names = [bare(p) for p, _ in given]
        if len(set(names)) < len(names):
            raise EffectError(f"a bank holds each effect once, given twice in {', '.join(names)}")
        if not 0 < len(given) <= MOST_EFFECTS:
            raise EffectError(f"a bank holds 1 to {MOST_EFFECTS} effects, given {len(given)}")
        return cls(robot, tuple(p for p, _ in given), tuple(profile for _, profile in given))

    @classmethod
    def usual(cls, robot: RobotModel, side: TorqueSide = TorqueSide.UNKNOWN) -> Bank:
        """Build the bank of the usual effects that a torque sensor sees.

        Args:
            robot: The arm.
            side: Side of the gear of the sensor; where it is unknown, that of the motor.
        """
        usual = cls.of(robot, (BEHIND_GEAR, *DEFAULT_BANK))
        seen_from = SensedFrom.of(side is TorqueSide.LINK)
        return cls.of(robot, [e for e in usual.prototypes if e.traits.sensed.meets(seen_from)])

    def __len__(self) -> int:
        return len(self.prototypes)

    def __repr__(self) -> str:
        more = ", …" if len(self) > MOST_SHOWN else ""
        return f"Bank({self.robot.name}, {len(self)} effects: {', '.join(self.names[:MOST_SHOWN])}{more})"

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
        """Return the columns of an effect.

        Args:
            i: Index of the effect.
        """
        return slice(int(self.ends[i]), int(self.ends[i + 1]))

    def columns(self, chosen: Sequence[int]) -> NDArray[np.int64]:
        """Return the columns of some effects, shape (p,).

        Args:
            chosen: Indices of the effects.
        """
        return np.concatenate(
            [np.arange(self.ends[i], self.ends[i + 1]) for i in chosen] or [np.zeros(0, int)]
        )

    def members(self, mask: int) -> list[int]:
        """Return the indices of the effects of a combination.

        Args:
            mask: The combination, one bit for each effect.
        """
        return [i for i in range(len(self)) if mask >> i & 1]

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Smallest and largest physical parameter of every column, shape (P,) each."""
        lower, upper = zip(*(p.bounds(self.robot) for p in self.prototypes), strict=True)
        return np.concatenate(lower), np.concatenate(upper)

    def effect(self, i: int, joint: str) -> JointEffect:
        """Return an effect of the bank on a joint.

        Args:
            i: Index of the effect.
            joint: Name of the joint.
        """
        return replace(self.prototypes[i], joint=joint)

    def index(self, effect: JointEffect) -> int | None:
        """Return the index of an effect in the bank, whatever its joint; None if the bank does not have it.

        Args:
            effect: The effect.
        """
        alike = replace(effect, joint=self.robot.joints[0])
        return self.prototypes.index(alike) if alike in self.prototypes else None


def prototype(effect: JointEffect, robot: RobotModel) -> JointEffect:
    """Return an effect of one joint on the robot's first joint.

    Args:
        effect: The effect.
        robot: The arm.
    """
    return replace(effect, joint=robot.joints[0])


def is_followed(effect: Effect) -> bool:
    """Tell whether the tick of a monitor has all that an effect depends on: no memory, no temperature.

    Args:
        effect: The effect.
    """
    return not effect.memories and Signal.TEMPERATURE not in effect.traits.depends_on


def bare(effect: JointEffect) -> str:
    """Return the label of an effect without its joint.

    Args:
        effect: The effect.
    """
    return effect.label.rpartition("@")[0]


def on_joint(profile: Profile, joint: str) -> Profile:
    """Return a profile on a joint; one of a whole arm stays as it is.

    Args:
        profile: The profile.
        joint: Name of the joint.
    """
    return replace(profile, joint=joint) if isinstance(profile, Region) else profile


def _entry(given: str | JointEffect, robot: RobotModel) -> tuple[JointEffect, Profile]:
    effect, profile = (_parsed(given, robot)) if isinstance(given, str) else (given, ALWAYS)
    if not isinstance(effect, JointEffect):
        of_joint = [
            n for n, e in EFFECTS.items() if issubclass(e, JointEffect) and n not in ("expression", "unknown")
        ]
        raise EffectError(f"{effect.name} is not an effect of one joint; a bank holds {', '.join(of_joint)}")
    if effect.name == "unknown":
        raise EffectError(
            "an unknown fault is learned when no effect of the bank explains it; leave 'unknown' out"
        )
    if not is_followed(effect):
        why = "has memory" if effect.memories else "depends on temperature"
        raise EffectError(f"{effect.name} {why}; a bank cannot hold it yet")
    return prototype(effect, robot), profile


def _parsed(text: str, robot: RobotModel) -> tuple[Effect, Profile]:
    label, colon, rest = (part.strip() for part in text.partition(":"))
    if "@" in label:
        raise EffectError(f"a bank tests every joint: write '{label.partition('@')[0]}' without a joint")
    kind = EFFECTS.get(label)
    scope = "@" + "+".join(robot.joints[: len(kind.scope_fields)]) if kind and kind.scope_fields else ""
    term = parse_term((label + (scope if kind else f"@{robot.joints[0]}")) + colon + rest, robot)
    if any(term.theta):
        raise EffectError(f"'{text}': a bank estimates the parameters of an effect, it is not given them")
    return term.effect, term.profile
