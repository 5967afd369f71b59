"""Time that a log does not count: its recorder paused and stamped the rows by counting them.

Most steps between rows are then as long as the recorded velocities say, and a few are many times longer, on all joints
at once. The positions after such a step are real, the times are not: accelerations and friction come out wrong.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cdia_pin.logs.log import Log

FAST = 0.2  # speed of a step that can be told from rest, over the joint's largest [1]
JUMP = 3.0  # length of a step over that of its velocity [1]; noise and held samples make up to twice as much
AS_SAID = 0.1  # by which the median step differs at most from its velocity [1], so that velocities are right
LEAST_SHARE = 0.05  # of the time that is not counted [1]; single lost rows are fewer
FEWEST = 3  # pauses [1]; one or two may be a stretch that was cut out
MOST_ROWS = 0.1  # share of the rows that follow a pause [1]; more are no pauses


class Pauses(NamedTuple):
    """Pauses that the times of a log do not count.

    Attributes:
        number: Number of pauses that the motion shows [1].
        usual: Duration of a usual one [s].
        lost: Time that is not counted, in all [s]; where no joint moves fast, as much per row as elsewhere.
    """

    number: int
    usual: float
    lost: float


def uncounted(log: Log, joints: list[int]) -> Pauses | None:
    """Return the pauses that the times of a log do not count, or None.

    Args:
        log: A log with velocities.
        joints: Indices of joints that move, and whose velocities are recorded.
    """
    if log.velocity is None or not joints or len(log.time) < 2:
        return None
    seconds = np.diff(log.time)
    speed = (log.velocity[1:, joints] + log.velocity[:-1, joints]) / 2.0
    said = speed * seconds[:, None]
    fast = (np.abs(speed) > FAST * np.abs(speed).max(axis=0)) & (said != 0.0)
    ratio = np.divide(
        np.diff(log.position[:, joints], axis=0), said, out=np.full(said.shape, np.nan), where=fast
    )
    if not fast.any(axis=0).all() or (np.abs(np.nanmedian(ratio, axis=0) - 1.0) > AS_SAID).any():
        return None
    known = fast.any(axis=1)
    of_row = np.nanmedian(ratio[known], axis=1)
    jumps = of_row > JUMP
    pauses = ((of_row - 1.0) * seconds[known])[jumps]
    lost = float(pauses.sum()) * len(known) / int(known.sum())
    many = len(pauses) > MOST_ROWS * len(of_row)
    if many or len(pauses) < FEWEST or lost < LEAST_SHARE * (log.duration + lost):
        return None
    return Pauses(len(pauses), float(np.median(pauses)), lost)
