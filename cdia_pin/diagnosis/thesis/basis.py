"""The bases in which an observer expresses a fault, for all joints at once: known effects, or neurons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Channel, JointEffect, JointState, Signal, Term, Unknown
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

LARGEST_WEIGHT = 1e4  # [N·m or N], of a neuron where the URDF states no effort limit: beyond any arm

# Range of neurons where the URDF states no limits: a full turn, and usual speeds.
REVOLUTE_POSITION = np.pi  # [rad]
REVOLUTE_SPEED = 3.0  # [rad/s]
PRISMATIC_POSITION = 0.5  # [m]
PRISMATIC_SPEED = 0.5  # [m/s]


class Basis(Protocol):
    """Columns φ for P weights per joint; Σ φ w is the torque of each joint."""

    @property
    def of_torque(self) -> NDArray[np.bool_]:
        """Which columns are proportional to the torque, shape (P,)."""
        ...

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Smallest and largest physical weights, shape (n, P) each."""
        ...

    def columns(self, x: JointState) -> Array:
        """Return φ, shape (n, P).

        Args:
            x: Motion and torque of all joints, each signal of shape (n,).
        """
        ...


@dataclass(frozen=True)
class KnownEffects:
    """The effects of a bank, each on every joint ([Thesis] §2.2.3–2.2.4).

    Attributes:
        robot: The arm.
        effects: One of each type; their joint does not matter.
    """

    robot: RobotModel
    effects: tuple[JointEffect, ...]

    @classmethod
    def of(cls, robot: RobotModel, bank: Sequence[JointEffect | type[JointEffect]]) -> KnownEffects:
        """Build the basis.

        Args:
            robot: The arm.
            bank: Effects, on any joint, or their classes for the usual shape.

        Raises:
            EffectError: If an entry is not an effect of one joint, or two are the same.
        """
        effects = []
        for entry in bank:
            effect = (
                entry(robot.joints[0])
                if isinstance(entry, type) and issubclass(entry, JointEffect)
                else entry
            )
            if not isinstance(effect, JointEffect) or effect.traits.channel is not Channel.JOINT_TORQUE:
                raise EffectError(f"a bank holds effects on the torque of one joint, given {entry!r}")
            if effect.memories:
                raise EffectError(f"{effect.name} has memory; a bank cannot hold it yet")
            effects.append(replace(effect, joint=robot.joints[0]))
        if len(set(effects)) < len(effects):
            names = ", ".join(e.name for e in effects)
            raise EffectError(f"a bank holds each type of effect once, given {names}")
        return cls(robot, tuple(effects))

    @cached_property
    def of_type(self) -> NDArray[np.intp]:
        """Index of the effect that each column belongs to, shape (P,)."""
        return np.repeat(np.arange(len(self.effects)), [e.size for e in self.effects])

    @cached_property
    def of_torque(self) -> NDArray[np.bool_]:
        """Which columns are proportional to the torque, shape (P,)."""
        return np.array(
            [Signal.TORQUE in self.effects[i].traits.depends_on for i in self.of_type], dtype=bool
        )

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Smallest and largest physical parameters, shape (n, P) each."""
        sides = [
            np.concatenate([np.empty((2, 0)), *(np.stack(e.bounds(self.robot)) for e in each)], axis=1)
            for each in self._on
        ]
        lower, upper = np.stack(sides, axis=1)
        return lower, upper

    def columns(self, x: JointState) -> Array:
        """Return Φ, shape (n, P).

        Args:
            x: Motion and torque of all joints, each signal of shape (n,).
        """
        columns = [c for effect in self.effects for c in effect.columns(x)]
        return np.array(columns).T if columns else np.empty((len(x.q), 0))

    def terms(self, weights: Array, present: NDArray[np.bool_]) -> tuple[Term, ...]:
        """Return faults as terms.

        Args:
            weights: Parameters, shape (n, P).
            present: Which effect is present on which joint, shape (n, N).
        """
        return tuple(
            Term(effect, tuple(weights[j, self.of_type == i]))
            for j, each in enumerate(self._on)
            for i, effect in enumerate(each)
            if present[j, i]
        )

    @cached_property
    def _on(self) -> tuple[tuple[JointEffect, ...], ...]:
        """The effects on each joint."""
        return tuple(tuple(replace(e, joint=joint) for e in self.effects) for joint in self.robot.joints)


@dataclass(frozen=True, eq=False)
class Neurons:
    """The approximator of [Thesis] (3.1): per joint k neurons in position, k in velocity, and one in torque.

    A neuron is `cdia_pin.effects.Unknown` with centre 0 and width 1, at its distance from its own centre.

    Attributes:
        robot: The arm.
        position_centres: [rad or m], shape (n, k).
        velocity_centres: [rad/s or m/s], shape (n, k).
        position_width: [rad or m], shape (n,).
        velocity_width: [rad/s or m/s], shape (n,).
    """

    robot: RobotModel
    position_centres: Array
    velocity_centres: Array
    position_width: Array
    velocity_width: Array

    @classmethod
    def over(cls, robot: RobotModel, position: Array, velocity: Array, count: int) -> Neurons:
        """Spread neurons evenly over ±position and ±velocity, as wide as they are apart.

        Args:
            robot: The arm.
            position: Half the range [rad or m], shape (n,).
            velocity: Half the range [rad/s or m/s], shape (n,).
            count: k.
        """
        places = np.linspace(-1.0, 1.0, count)
        apart = 2.0 / max(count - 1, 1)
        return cls(
            robot, np.outer(position, places), np.outer(velocity, places), apart * position, apart * velocity
        )

    @classmethod
    def within_limits(cls, robot: RobotModel, count: int) -> Neurons:
        """Spread neurons evenly over the joint limits, or over usual ranges where there are none.

        Args:
            robot: The arm.
            count: k.
        """
        limits, slides = robot.limits, robot.is_prismatic
        far = np.maximum(np.abs(limits.lower), np.abs(limits.upper))
        usual = np.where(slides, PRISMATIC_POSITION, REVOLUTE_POSITION)
        position = np.where(np.isfinite(far) & (far > 0), far, usual)
        usual = np.where(slides, PRISMATIC_SPEED, REVOLUTE_SPEED)
        velocity = np.where(np.isfinite(limits.velocity), limits.velocity, usual)
        return cls.over(robot, position, velocity, count)

    @cached_property
    def of_torque(self) -> NDArray[np.bool_]:
        """Which columns are proportional to the torque: the last, shape (P,)."""
        out = np.zeros(2 * self.position_centres.shape[1] + 1, dtype=bool)
        out[-1] = True
        return out

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Weights up to the effort limits, and the gain within the effect's own bounds, shape (n, P) each."""
        most = np.minimum(self.robot.limits.effort, LARGEST_WEIGHT)
        upper = np.repeat(most[:, None], len(self.of_torque), axis=1)
        lower = -upper
        lower[:, -1], upper[:, -1] = self._unit.parameters[-1].lower, self._unit.parameters[-1].upper
        return lower, upper

    def columns(self, x: JointState) -> Array:
        """Return the activations and the torque, shape (n, 2k + 1).

        Args:
            x: Motion and torque of all joints, each signal of shape (n,).
        """
        distance = JointState(
            (x.q[:, None] - self.position_centres) / self.position_width[:, None],
            (x.v[:, None] - self.velocity_centres) / self.velocity_width[:, None],
            x.a,
            x.effort[:, None],
            x.sign,
            x.time,
        )
        return np.concatenate(self._unit.columns(distance), axis=1)

    @cached_property
    def _unit(self) -> Unknown:
        return Unknown(self.robot.joints[0], (0.0,), (0.0,), 1.0, 1.0)
