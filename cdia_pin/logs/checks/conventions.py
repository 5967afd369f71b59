"""How a log may be written otherwise than assumed: order of joints, signs, unit of angle."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.fit import misfit, physical_columns, unexplained
from cdia_pin.logs.checks.motion import Motion

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

DEGREE = float(np.pi / 180.0)
SEARCH_SAMPLES = 400  # plenty for five coefficients; each hypothesis costs an inverse dynamics of them
CERTAIN = 1.5  # [1] gain in misfit that no measured log came near without a reason
LIKELY = 0.7  # [1]
BROKEN = 0.2  # share left unexplained from which an effort may be misread; missing physics leaves less


@dataclass(frozen=True)
class Conventions:
    """A reading of the log's columns.

    Attributes:
        position_column: Column of position and velocity of each joint of the robot, shape (n,).
        effort_column: Column of effort of each joint of the robot, shape (n,).
        position_sign: Sign of each joint's position and velocity, shape (n,).
        effort_sign: Sign of each joint's effort, shape (n,).
        angle: Size of the unit of angle [rad].
    """

    position_column: tuple[int, ...]
    effort_column: tuple[int, ...]
    position_sign: tuple[int, ...]
    effort_sign: tuple[int, ...]
    angle: float = 1.0

    @classmethod
    def assumed(cls, n: int) -> Conventions:
        """Return the reading that everything is as it says."""
        return cls(tuple(range(n)), tuple(range(n)), (1,) * n, (1,) * n)

    def apply(self, motion: Motion, robot: RobotModel) -> Motion:
        """Return the motion as this reading has it."""
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
    """A reading that differs in one thing, and how it fits.

    Attributes:
        kind: ``effort sign``, ``position sign``, ``both signs``, ``order``, ``effort order`` or ``degrees``.
        joints: Joints of the robot that it changes, by index.
        conventions: The reading.
        share: Unexplained share of each joint's effort, shape (n,).
        gain: Fall of the misfit against the reading before [1].
    """

    kind: str
    joints: tuple[int, ...]
    conventions: Conventions
    share: Array
    gain: float


@dataclass(frozen=True)
class Search:
    """Result of the search for a reading that fits better.

    Attributes:
        steps: Readings adopted one after the other, each with the rivals that fit about as well.
        rest: All other readings tried from the last one, best first.
        conventions: The last reading.
        before: Unexplained share of each joint's effort as the log says, shape (n,).
        after: The same with the last reading, shape (n,).
    """

    steps: tuple[tuple[Trial, tuple[Trial, ...]], ...]
    rest: tuple[Trial, ...]
    conventions: Conventions
    before: Array
    after: Array


def search_conventions(motion: Motion, robot: RobotModel) -> Search:
    """Adopt, one at a time, the change of reading that explains most, while it explains much more."""
    shares = _Shares(motion, robot)
    current = Conventions.assumed(robot.n)
    share = before = shares.of(current)
    steps: list[tuple[Trial, tuple[Trial, ...]]] = []
    while True:
        trials = _trials(current, shares, share)
        if not trials or trials[0].gain < CERTAIN or len(steps) >= 2 * robot.n:
            return Search(tuple(steps), tuple(trials), current, before, share)
        best = trials[0]
        rivals = tuple(
            t for t in trials[1:] if t.gain > best.gain - LIKELY and set(t.joints) & set(best.joints)
        )
        steps.append((best, rivals))
        current, share = best.conventions, best.share


def _trials(current: Conventions, shares: _Shares, share: Array) -> list[Trial]:
    now = misfit(share)
    trials = []
    for kind, joints, conventions in _changes(current, shares.motion, shares.robot):
        new = shares.of(conventions)
        gain = now - misfit(new)
        trials.append(Trial(kind, joints, conventions, new, gain if _mends(share, new) else min(gain, 0.0)))
    return sorted(trials, key=lambda t: -t.gain)


def _mends(old: Array, new: Array) -> bool:
    """True where an effort that did not fit does so now; what is missing in a model may look like less."""
    return bool(np.any((old > BROKEN) & (new < 0.5 * old)))


def _changes(
    current: Conventions, motion: Motion, robot: RobotModel
) -> Iterator[tuple[str, tuple[int, ...], Conventions]]:
    moves = motion.moves[list(current.position_column)]
    for k in np.flatnonzero(moves).tolist():
        effort = _negated(current.effort_sign, k)
        position = _negated(current.position_sign, k)
        yield "effort sign", (k,), replace(current, effort_sign=effort)
        yield "position sign", (k,), replace(current, position_sign=position)
        yield "both signs", (k,), replace(current, effort_sign=effort, position_sign=position)
    for i, j in itertools.combinations(range(robot.n), 2):
        if not (moves[i] or moves[j]):
            continue
        effort_column = _swapped(current.effort_column, i, j)
        position_column = _swapped(current.position_column, i, j)
        yield "order", (i, j), replace(current, effort_column=effort_column, position_column=position_column)
        if moves[i] and moves[j]:
            yield "effort order", (i, j), replace(current, effort_column=effort_column)
    for order in _whole_orders(robot.joints):
        both = (_reordered(current.position_column, order), _reordered(current.effort_column, order))
        changed = tuple(k for k in range(robot.n) if order[k] != k)
        yield "order", changed, replace(current, position_column=both[0], effort_column=both[1])
        yield "effort order", changed, replace(current, effort_column=both[1])
    if current.angle == 1.0 and not robot.is_prismatic.all():
        revolute = tuple(np.flatnonzero(~robot.is_prismatic).tolist())
        yield "degrees", revolute, replace(current, angle=DEGREE)


class _Shares:
    """Unexplained shares of readings; those that agree on the motion share its model torques."""

    def __init__(self, motion: Motion, robot: RobotModel) -> None:
        self.motion, self.robot = motion, robot
        self._columns: dict[tuple[object, ...], Array] = {}
        self._known: dict[tuple[object, ...], float] = {}

    def of(self, conventions: Conventions) -> Array:
        """Unexplained share of every joint that moves, NaN elsewhere, shape (n,)."""
        read = conventions.apply(self.motion, self.robot)
        key = (conventions.position_column, conventions.position_sign, conventions.angle)
        if key not in self._columns:
            self._columns[key] = physical_columns(read, self.robot)
        columns = self._columns[key]
        out = np.full(self.robot.n, np.nan)
        for k in np.flatnonzero(read.moves).tolist():
            own = (*key, k, conventions.effort_column[k], conventions.effort_sign[k])
            if own not in self._known:
                self._known[own] = unexplained(read.effort[:, k], columns[k])
            out[k] = self._known[own]
        return out


def _negated(signs: tuple[int, ...], k: int) -> tuple[int, ...]:
    return tuple(-s if i == k else s for i, s in enumerate(signs))


def _whole_orders(joints: Sequence[str]) -> list[tuple[int, ...]]:
    """Orders that people meet beyond exchanges: rotated, reversed, alphabetical (ROS sorts names)."""
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
