"""Search for other conventions of a log: order of joints, signs, unit of angle, direction of gravity."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.fit import misfit, physical_columns, unexplained
from cdia_pin.logs.checks.motion import SmoothedMotion
from cdia_pin.logs.checks.mounting import gravity_elsewhere

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

DEGREE = float(np.pi / 180.0)  # [rad]
SEARCH_SAMPLES = 400  # [samples], many for five coefficients; each hypothesis needs inverse dynamics of them
CERTAIN = 1.5  # [1], gain in misfit that is adopted: no measured log with right conventions came near it
LIKELY = 0.7  # [1], gain in misfit that is reported as possible
# Between few postures a wrong sign or order can explain what missing masses or springs do. So a change must
# also fit better where each part of the time has coefficients of its own. Of 653 wrong signs, orders and units put into
# 17 measured logs 546 are mended, 548 without that (`python -m benchmarks.wrong_conventions`).
PARTS = 4  # parts of the time [1]
LASTS = 0.3  # [1], gain in misfit that this must bring; 5 of 2247 right changes do not, with 0.0 it is 1, with 0.7 18
BROKEN = 0.2  # [1], unexplained share above which an effort may be misread; missing physics leaves less


class ConventionChange(StrEnum):
    """One change of conventions that the search tries."""

    EFFORT_SIGN = "effort sign"
    POSITION_SIGN = "position sign"
    BOTH_SIGNS = "both signs"
    ORDER = "order"
    EFFORT_ORDER = "effort order"
    DEGREES = "degrees"
    MOUNTING = "mounting"


# Changes that neither joints in step nor single strokes can tell from missing physics: what one joint does looks like
# what another does.
BY_INDEPENDENT_JOINTS = {
    ConventionChange.POSITION_SIGN,
    ConventionChange.BOTH_SIGNS,
    ConventionChange.ORDER,
    ConventionChange.EFFORT_ORDER,
    ConventionChange.MOUNTING,
}


@dataclass(frozen=True)
class Conventions:
    """An assumption of what the log's columns mean.

    Attributes:
        position_column: Index of the column of position and velocity of each joint of the robot, shape (n,).
        effort_column: Index of the column of effort of each joint of the robot, shape (n,).
        position_sign: Sign of each joint's position and velocity, shape (n,).
        effort_sign: Sign of each joint's effort, shape (n,).
        angle: Size of the unit of angle [rad].
        gravity: Gravity in the base [m/s²]; None for the URDF's.
    """

    position_column: tuple[int, ...]
    effort_column: tuple[int, ...]
    position_sign: tuple[int, ...]
    effort_sign: tuple[int, ...]
    angle: float = 1.0
    gravity: tuple[float, float, float] | None = None

    @classmethod
    def assumed(cls, n: int) -> Conventions:
        """Return the conventions in which every column is what its name says.

        Args:
            n: Number of joints.

        Returns:
            Columns in order, signs +1, angles in rad.
        """
        return cls(tuple(range(n)), tuple(range(n)), (1,) * n, (1,) * n)

    def mounted(self, robot: RobotModel) -> RobotModel:
        """Return the robot under the gravity of these conventions.

        Args:
            robot: The robot as its URDF has it.
        """
        return robot if self.gravity is None else robot.with_gravity(self.gravity)

    def apply(self, motion: SmoothedMotion, robot: RobotModel) -> SmoothedMotion:
        """Return the motion under these conventions.

        Args:
            motion: Signals as logged.
            robot: The robot, which tells the prismatic joints.

        Returns:
            Signals in the robot's order, signs and SI units.
        """
        pick = list(self.position_column)
        scale = np.where(robot.is_prismatic, 1.0, self.angle) * np.array(self.position_sign)
        return replace(
            motion,
            q=motion.q[:, pick] * scale,
            v=motion.v[:, pick] * scale,
            a=motion.a[:, pick] * scale,
            effort=motion.effort[:, list(self.effort_column)] * np.array(self.effort_sign),
            moves=motion.moves[pick],
        )


@dataclass(frozen=True)
class Trial:
    """Conventions with one change, and how they fit.

    Attributes:
        kind: The change.
        joints: Indices of the joints of the robot that it changes.
        conventions: The conventions after the change.
        share: Unexplained share of each joint's effort [1], shape (n,).
        gain: Fall of the misfit by the change [1].
    """

    kind: ConventionChange
    joints: tuple[int, ...]
    conventions: Conventions
    share: Array
    gain: float


@dataclass(frozen=True)
class ConventionSearch:
    """Result of the search for conventions that fit better.

    Attributes:
        start: The conventions that the search began with.
        steps: Changes adopted one after the other, each with the rivals that fit about as well.
        rest: Changes of the last conventions that were tried and not adopted, best first.
        possible: The best of them, if it explains so much that it may be true; None otherwise.
        conventions: The last conventions.
        before: Unexplained share of each joint's effort under the first conventions [1], shape (n,).
        after: The same under the last conventions [1], shape (n,).
    """

    start: Conventions
    steps: tuple[tuple[Trial, tuple[Trial, ...]], ...]
    rest: tuple[Trial, ...]
    possible: Trial | None
    conventions: Conventions
    before: Array
    after: Array


def search_conventions(
    motion: SmoothedMotion, robot: RobotModel, start: Conventions | None = None
) -> ConventionSearch:
    """Adopt the change of conventions that explains most, one at a time, while it explains much more.

    Args:
        motion: Signals as logged, thinned.
        robot: The robot of the log.
        start: Conventions to begin with; every column is what its name says if left out.

    Returns:
        Adopted changes, rivals and the last conventions.
    """
    unsure = BY_INDEPENDENT_JOINTS if motion.is_in_step or motion.is_of_single_strokes else set()
    shares = _Shares(motion, robot)
    start = current = start or Conventions.assumed(robot.n)
    share = before = shares.of(current)
    steps: list[tuple[Trial, tuple[Trial, ...]]] = []
    while True:
        trials = _trials(current, shares, share)
        first = next((t for t in trials if t.gain >= CERTAIN and t.kind not in unsure), None)
        if first is None or len(steps) >= 2 * robot.n:
            possible = next((t for t in trials if t.gain > (CERTAIN if t.kind in unsure else LIKELY)), None)
            return ConventionSearch(start, tuple(steps), tuple(trials), possible, current, before, share)
        alike = [t for t in trials if t.gain > first.gain - LIKELY and set(t.joints) & set(first.joints)]
        best = commonest(alike)
        rivals = tuple(t for t in alike if t is not best)
        steps.append((best, rivals))
        current, share = best.conventions, best.share


def _trials(current: Conventions, shares: _Shares, share: Array) -> list[Trial]:
    now = misfit(share)
    trials = []
    for kind, joints, conventions in _changes(current, shares.motion, shares.robot):
        new = shares.of(conventions)
        gain = now - misfit(new)
        if gain > 0.0 and not _mends(share, new):
            gain = 0.0
        if gain > LIKELY and shares.gain_in_parts(current, conventions) < LASTS:
            gain = 0.0
        trials.append(Trial(kind, joints, conventions, new, gain))
    return sorted(trials, key=lambda t: -t.gain)


def commonest(alike: Sequence[Trial]) -> Trial:
    """Return the change that is adopted of those that explain about as much.

    A turned effort comes before a turned position of the same joint: drives often count their torque against the axis
    of the URDF, while a position that is turned alone is rare.

    Args:
        alike: The changes, best first.
    """
    first = alike[0]
    if first.kind is not ConventionChange.POSITION_SIGN:
        return first
    efforts = (t for t in alike if t.kind is ConventionChange.EFFORT_SIGN and t.joints == first.joints)
    return next((t for t in efforts if t.gain > CERTAIN), first)


def _mends(old: Array, new: Array) -> bool:
    """Tell whether an effort that did not fit does so now; missing physics can imitate a smaller gain."""
    return bool(np.any((old > BROKEN) & (new < 0.5 * old)))


def _changes(
    current: Conventions, motion: SmoothedMotion, robot: RobotModel
) -> Iterator[tuple[ConventionChange, tuple[int, ...], Conventions]]:
    moves = motion.moves[list(current.position_column)]
    moving = tuple(np.flatnonzero(moves).tolist())
    for k in moving:
        effort = _negated(current.effort_sign, k)
        position = _negated(current.position_sign, k)
        yield ConventionChange.EFFORT_SIGN, (k,), replace(current, effort_sign=effort)
        yield ConventionChange.POSITION_SIGN, (k,), replace(current, position_sign=position)
        yield ConventionChange.BOTH_SIGNS, (k,), replace(current, effort_sign=effort, position_sign=position)
    if len(moving) > 1:
        efforts = tuple(-s for s in current.effort_sign)
        yield ConventionChange.EFFORT_SIGN, moving, replace(current, effort_sign=efforts)
    for i, j in itertools.combinations(range(robot.n), 2):
        if not (moves[i] or moves[j]):
            continue
        effort_column = _swapped(current.effort_column, i, j)
        position_column = _swapped(current.position_column, i, j)
        yield (
            ConventionChange.ORDER,
            (i, j),
            replace(current, effort_column=effort_column, position_column=position_column),
        )
        if moves[i] and moves[j]:
            yield ConventionChange.EFFORT_ORDER, (i, j), replace(current, effort_column=effort_column)
    for order in _whole_orders(robot.joints):
        both = (_reordered(current.position_column, order), _reordered(current.effort_column, order))
        changed = tuple(k for k in range(robot.n) if order[k] != k)
        yield (
            ConventionChange.ORDER,
            changed,
            replace(current, position_column=both[0], effort_column=both[1]),
        )
        yield ConventionChange.EFFORT_ORDER, changed, replace(current, effort_column=both[1])
    if current.angle == 1.0 and not robot.is_prismatic.all():
        revolute = tuple(np.flatnonzero(~robot.is_prismatic).tolist())
        yield ConventionChange.DEGREES, revolute, replace(current, angle=DEGREE)
    if current.gravity is None and (gravity := gravity_elsewhere(current.apply(motion, robot), robot)):
        yield ConventionChange.MOUNTING, moving, replace(current, gravity=gravity)


class _Shares:
    """Unexplained shares of conventions; those with the same motion share its model torques."""

    def __init__(self, motion: SmoothedMotion, robot: RobotModel) -> None:
        self.motion, self.robot = motion, robot
        self._columns: dict[tuple[object, ...], Array] = {}
        self._known: dict[tuple[object, ...], float] = {}

    def of(self, conventions: Conventions, parts: int = 1) -> Array:
        """Return the unexplained share of every joint that moves, NaN elsewhere [1], shape (n,).

        Args:
            conventions: What the columns mean.
            parts: Number of parts of the time that have coefficients of their own.
        """
        read = conventions.apply(self.motion, self.robot)
        key = (
            conventions.position_column,
            conventions.position_sign,
            conventions.angle,
            conventions.gravity,
        )
        if key not in self._columns:
            self._columns[key] = physical_columns(read, conventions.mounted(self.robot))
        columns = self._columns[key]
        out = np.full(self.robot.n, np.nan)
        for k in np.flatnonzero(read.moves).tolist():
            own = (*key, parts, k, conventions.effort_column[k], conventions.effort_sign[k])
            if own not in self._known:
                self._known[own] = unexplained(read.effort[:, k], columns[k], parts)
            out[k] = self._known[own]
        return out

    def gain_in_parts(self, before: Conventions, after: Conventions) -> float:
        """Return the fall of the misfit by a change, where each part of the time has coefficients of its own [1]."""
        return misfit(self.of(before, PARTS)) - misfit(self.of(after, PARTS))


def _negated(signs: tuple[int, ...], k: int) -> tuple[int, ...]:
    return tuple(-s if i == k else s for i, s in enumerate(signs))


def _whole_orders(joints: Sequence[str]) -> list[tuple[int, ...]]:
    """List common orders beyond exchanges of two: rotated, reversed, alphabetical (ROS sorts names)."""
    n = len(joints)
    alphabet = sorted(joints)
    orders = [tuple((k + shift) % n for k in range(n)) for shift in range(1, n)]
    orders += [tuple(reversed(range(n)))]
    orders += [tuple(alphabet.index(j) for j in joints), tuple(joints.index(j) for j in alphabet)]
    exchanges = {tuple(range(n))} | {
        _swapped(tuple(range(n)), i, j) for i, j in itertools.combinations(range(n), 2)
    }
    return [order for order in dict.fromkeys(orders) if order not in exchanges]


def _reordered(columns: tuple[int, ...], order: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(columns[k] for k in order)


def _swapped(columns: tuple[int, ...], i: int, j: int) -> tuple[int, ...]:
    out = list(columns)
    out[i], out[j] = out[j], out[i]
    return tuple(out)
