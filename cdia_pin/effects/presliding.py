r"""Friction with memory: after a reversal the torque depends on the distance travelled, not on the direction alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.friction import CoulombFriction
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.state import JointState, State
from cdia_pin.effects.stateful_effect import StatefulEffect
from cdia_pin.effects.traits import SensedFrom, Signal, Traits
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# Reaches that are tried, over the joint's travel [1]. Below the first, what differs from Coulomb friction lies within
# the samples near a reversal, which the filter blurs; above the last, the friction would never slide freely.
SHORTEST, LONGEST = 0.01, 0.3
# Longest reach by itself [rad], [m]: belts, cables and soft gears; what builds up over more is a spring or a cable.
LONGEST_TURNING, LONGEST_SLIDING = 0.15, 0.02
TRIED = 13  # reaches [1]: neighbours differ by a third, and a parabola finds the rest
SHORTEST_TRAVEL = 1e-3  # [rad or m], a joint that moves less has no reversals that count


@dataclass(frozen=True)
class PreslidingFriction(StatefulEffect):
    r"""Dry friction that builds up over a distance after each reversal, Dahl's model [Armstrong1994].

    f = −α z with dz = (sgn q̇ − z) |dq| / r. The bristles have the stiffness α / r. As r goes to zero it is Coulomb
    friction; LuGre's model adds to it what `stribeck_friction` and `viscous_friction` are.

    Attributes:
        reach: r, distance over which the friction builds up [rad or m].
    """

    reach: float = 0.02

    name: ClassVar[str] = "presliding_friction"
    equation: ClassVar[str] = "−α z,  dz = (sgn(q̇) − z) |dq| / r"
    traits: ClassVar[Traits] = Traits(
        {Signal.POSITION}, sensed=SensedFrom.MOTOR
    )  # bristles give back what they store
    plausibility: ClassVar[Plausibility] = Plausibility(penalty=3.0)  # Coulomb friction is more common
    parameters = (Parameter("level", "{effort}", lower=0.0),)
    shape = (Parameter("reach", "{position}", lower=1e-6, upper=10.0),)

    @property
    def steady(self) -> CoulombFriction:
        """Coulomb friction, which it is far from a reversal."""
        return CoulombFriction(self.joint)

    def initial_state(self, robot: RobotModel) -> Array:
        """Return z of bristles that are straight, shape (1,).

        Args:
            robot: The arm, n joints.
        """
        return np.zeros(1)

    def step(self, z: Array, x: JointState, dq: float, dt: float) -> Array:
        """Return z after a step in one direction, exactly, shape (1,).

        Args:
            z: At the beginning of the step, shape (1,).
            x: The joint at the beginning of the step.
            dq: Motion of the joint during the step [rad or m].
            dt: Duration of the step [s], above 0.
        """
        end = np.sign(dq)
        return np.asarray(end + (z - end) * np.exp(-abs(dq) / self.reach))

    def along(self, x: State) -> Array:
        """Return z at each sample, shape (N, 1); as `Memory.along` does, a stroke at a time.

        Args:
            x: Motion and torques, N samples.
        """
        start = self.initial_state(x.robot)
        first = np.asarray(x.memory.get(self, start), float)
        position, duration = x.q[:, x.robot.joint_index(self.joint)], np.diff(x.time)
        if not duration.any():
            return np.tile(first, (len(x), 1))
        anew = np.flatnonzero(duration < 0) + 1
        out = np.empty(len(x))
        bounds = [0, *anew.tolist(), len(x)]
        for a, b in pairwise(bounds):
            travel = np.where(duration[a : b - 1] > 0, np.diff(position[a:b]), 0.0)
            out[a:b] = deflection(travel, self.reach, float(first[0] if a == 0 else start[0]))
        return out[:, None]

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the column of the level.

        Args:
            x: Signals of the joint with z, N samples.
        """
        return [-x.memory[:, 0]]

    def shape_grid(self, x: State) -> Sequence[Self]:
        """Return reaches between a hundredth of the joint's travel and a third of it, none if it does not move.

        Args:
            x: Motion and torques, N samples.
        """
        j = x.robot.joint_index(self.joint)
        travel = float(np.ptp(x.q[:, j]))
        if travel < SHORTEST_TRAVEL:
            return []
        longest = min(LONGEST * travel, longest_reach(x.robot, j))
        shortest = min(SHORTEST * travel, longest / 3)
        return [self.with_shape(reach=float(r)) for r in np.geomspace(shortest, longest, TRIED)]


def longest_reach(robot: RobotModel, j: int) -> float:
    """Return the longest distance over which presliding builds up [rad or m]; more is a spring or a cable.

    Args:
        robot: The arm.
        j: Index of the joint.
    """
    return LONGEST_SLIDING if robot.is_prismatic[j] else LONGEST_TURNING


def deflection(travel: Array, reach: float, start: float = 0.0) -> Array:
    r"""Return the deflection z of bristles along a motion, −1 to 1 [1], shape (N,).

    After a reversal z changes its sign over a distance of about r; far from a reversal it is sgn q̇.

    Args:
        travel: Motion from each sample to the next [rad or m], shape (N − 1,).
        reach: r [rad or m].
        start: z at the first sample [1].
    """
    out = np.full(len(travel) + 1, start)
    if not len(travel):
        return out
    direction = np.sign(travel)
    turns = np.flatnonzero(np.diff(direction)) + 1
    first, last = np.append(0, turns), np.append(turns, len(travel))
    path = np.concatenate([[0.0], np.cumsum(np.abs(travel))])
    # a stroke is monotone, so the solution is exact: z approaches ± 1 by a factor of the way
    limits, factors = direction[first], np.exp(-(path[last] - path[first]) / reach)
    z, begins = start, []
    for limit, factor in zip(limits.tolist(), factors.tolist(), strict=True):
        begins.append(z)
        z = limit + (z - limit) * factor
    of_stroke = np.repeat(np.arange(len(first)), last - first)
    limit, begin = limits[of_stroke], np.array(begins)[of_stroke]
    out[1:] = limit + (begin - limit) * np.exp(-(path[1:] - path[first][of_stroke]) / reach)
    return out
