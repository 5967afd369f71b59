"""Encoders that stand still alone: the joint jumps at the end of a rest, or enters and leaves it at full speed.

A joint must slow down before it rests, and speed up afterwards. A coarse encoder has no larger step than others of its
own, and no larger change of speed.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.joint_units import units_of
from cdia_pin.logs.checks.motion import STANDSTILL, STANDSTILL_PRISMATIC
from cdia_pin.logs.checks.sampling import FROZEN, runs
from cdia_pin.logs.held_stretch import MOVING, changes_of
from cdia_pin.logs.log import Log

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Rests = list[tuple[int, int]]

# [1], speed of a jump over the joint's largest one elsewhere: a joint that rests starts slower than it moves
JUMP = 5.0
AROUND = (
    0.02  # [s], over which speeds are taken: an arm loses 0.4 rad/s in it at the most that arms do, 20 rad/s²
)
USUAL = 99.0  # [%], of the changes of speed are usual; stamps that jitter make the few larger ones
ABRUPT = 2.0  # [1], change of speed over the largest usual one; no rest in 19 measured logs is above 0.3
FEWEST = 50  # samples in motion by which the changes of speed of a joint are judged
MOST = 2  # rests of a joint; one that stops abruptly more often was made so, by a simulation or a table of positions


def check_stuck(log: Log, robot: RobotModel) -> Iterator[Finding]:
    """Report the longest stretch in which a position alone stands still although the joint moves on.

    Args:
        log: The log.
        robot: Its robot.

    Yields:
        One finding per joint, or none.
    """
    changes = np.concatenate([[0], np.cumsum(changes_of(log))])
    for k, q in enumerate(log.position.T):
        starts, stops = runs(np.diff(q) == 0.0)
        long = (log.time[stops] - log.time[starts] > FROZEN) & (stops < len(q) - 1)
        # where nothing at all changes, `held_stretch` finds it
        long &= changes[stops] > changes[starts]
        rests = list(zip(starts[long].tolist(), stops[long].tolist(), strict=True))
        if not rests:
            continue
        unit = units_of(robot, k)[0]
        still = STANDSTILL_PRISMATIC if robot.is_prismatic[k] else STANDSTILL
        if jumping := _jumping(q, log.time, rests):
            start, stop = _longest(jumping, log.time)
            jump = float(q[stop + 1] - q[stop])
            how = f"then jumps by {jump:.3g} {unit}, faster than the joint ever moves"
            yield _finding(log, k, start, stop, how, jump=jump)
        elif np.ptp(q) > still and (abrupt := _abrupt(q, log.time, rests)):
            start, stop = _longest(list(abrupt), log.time)
            before, after = abrupt[start, stop]
            how = (
                f"the joint enters and leaves this rest at {before:.3g} and {after:.3g} {unit}/s, without slowing "
                "down and speeding up as it does elsewhere"
            )
            yield _finding(log, k, start, stop, how, speed_before=before, speed_after=after)


def _finding(log: Log, k: int, start: int, stop: int, how: str, **numbers: float) -> Finding:
    seconds, since = float(log.time[stop] - log.time[start]), float(log.time[start])
    return Finding(
        Topic.FROZEN,
        Severity.WARNING,
        f"the position stands still for {seconds:.3g} s from t = {since:.4g} s and {how}: nothing was measured there",
        joint=log.joints[k],
        advice="leave that part out of the file, or find out why the position was not updated",
        value={"signal": "position", "from_s": since, "seconds": seconds, **numbers},
    )


def _longest(rests: Rests, time: Array) -> tuple[int, int]:
    return max(rests, key=lambda rest: float(time[rest[1]] - time[rest[0]]))


def _jumping(q: Array, time: Array, rests: Rests) -> Rests:
    """Return the rests that end in a jump which is faster than any other step."""
    speed = np.abs(np.diff(q)) / np.diff(time)
    stops = np.array([stop for _, stop in rests])
    usual = float(np.delete(speed, stops).max(initial=0.0))
    return [rest for rest in rests if usual and speed[rest[1]] > JUMP * usual]


def _abrupt(q: Array, time: Array, rests: Rests) -> dict[tuple[int, int], tuple[float, float]]:
    """Return the rests that a joint enters and leaves without slowing down, and the two speeds [rad/s or m/s]."""
    width = max(2, round(AROUND * (len(time) - 1) / float(time[-1] - time[0])))
    inner = [(i, j) for i, j in rests if i >= width and j < len(q) - width]
    ends = np.array(inner, dtype=np.intp).reshape(-1, 2)
    before = np.abs(_speed(q, time, ends[:, 0] - width, width))
    after = np.abs(_speed(q, time, ends[:, 1], width))
    if not (np.minimum(before, after) > 0.0).any():  # nearly always
        return {}
    speed = _speed(q, time, np.arange(len(q) - width), width)
    change = np.abs(speed[width:] - speed[:-width])
    judged = (speed[width:] != 0.0) | (speed[:-width] != 0.0)
    for end in ends.ravel().tolist():
        judged[max(0, end - 3 * width) : end + width] = False
    if int(judged.sum()) < FEWEST:
        return {}
    # of the speeds too, since one bad stamp makes a speed of any size
    limit = max(
        ABRUPT * float(np.percentile(change[judged], USUAL)),
        MOVING * float(np.percentile(np.abs(speed), USUAL)),
    )
    found = {
        rest: (float(v), float(w))
        for rest, v, w in zip(inner, before, after, strict=True)
        if min(v, w) > limit
    }
    return found if len(found) <= MOST else {}


def _speed(q: Array, time: Array, start: NDArray[np.intp], width: int) -> Array:
    """Return the mean speed over some samples from each start on [rad/s or m/s], shape of `start`."""
    return (q[start + width] - q[start]) / (time[start + width] - time[start])
