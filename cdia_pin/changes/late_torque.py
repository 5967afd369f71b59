"""Logs whose torques were recorded later or earlier beside the positions than those of the other side.

A recorder that is late by a tenth of a second delays quick torques by half of their period. No column of a delay is
right there: it is the slope at no delay at all. Where the model misses the shape of the torque, as where friction
reverses, it makes even a short delay too small. So the delay that explains most is looked for at its own size, and the
torques of that side are put right by it. What the search finds then is taken if it leaves less than what it finds in
the logs as they are.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.difference import Difference
from cdia_pin.changes.differing import Differing
from cdia_pin.effects import EffortDelay
from cdia_pin.effects.sensing import LATEST
from cdia_pin.logs.checks.velocity import vertex
from cdia_pin.logs.motion import Motion
from cdia_pin.regression.experiment import Experiment, Segment
from cdia_pin.regression.shared_parameters import ColumnGroup

Array = NDArray[np.float64]

# Delays that are tried [s]; on measured arms a delay's column is right within such a step.
DELAYS = np.linspace(-LATEST, LATEST, 21)
# Share of what the common structure leaves [1] that a delay must explain for a second search, beyond what a delay of
# the other side alike explains. It only saves time, because what is taken out in vain leaves more: with 0, 0.005 and
# 0.02 the ten comparisons of an AIRBOT, whose 23 ms explain 0.03 to 0.06, and 58 pairs of unchanged logs are decided
# alike.
LEAST_SHARE = 0.01


def put_right(differing: Differing) -> Differing | None:
    """Return the logs with the torques of one side at the right time; None if neither side seems to be late.

    Where the logs before are late, to take the delay out of those after would make all logs late.

    Args:
        differing: The logs as they were recorded.
    """
    change = next((c for c in differing.changes if isinstance(c.effect, EffortDelay)), None)
    if change is None:
        return None
    sides = [change, replace(change, logs=differing.names[0], sign=-1.0)]
    explained = [_explained(differing, side) for side in sides]
    shares, delays = [float(e.max()) for e in explained], [vertex(DELAYS, -e) for e in explained]
    most = int(np.argmax(shares))
    side, late = sides[most], delays[most]
    # logs that are all late, as by a filter of the drives, differ by no more than what the other side does not explain
    common = min(shares) if delays[0] * delays[1] > 0 else 0.0
    if shares[most] - common < LEAST_SHARE or not late:
        return None
    x = differing.experiment
    in_time = [_put_right(s, side, late) for s in x.segments]
    again = Differing.of(
        Experiment.of(x.robot, in_time, x.rest), differing.given.model, differing.before, differing.settings
    )
    return replace(again, given=differing.given, size=differing.size, put_right={change: np.array([late])})


def _explained(differing: Differing, side: Difference) -> Array:
    """Return which share of what the common structure leaves each delay of one side explains as it is [1]."""
    x = differing.experiment
    efforts = [t.actuator for t in differing.prediction.torques]
    missed = (x.torque_of(side, np.array([delay]), efforts) for delay in DELAYS)
    left = differing.beside_common([ColumnGroup.of(side, f[:, :, None], x.robot) for f in missed])
    return np.asarray((2 * left[:-1, -1] - np.diag(left)[:-1]) / left[-1, -1])


def _put_right(segment: Segment, side: Difference, late: float) -> Motion:
    """Return a conditioned log with its torques earlier by a delay [s], if it is one of those that have it."""
    motion = segment.motion
    missed = side.torque(segment.state.with_effort(motion.effort), np.array([-late]))
    return replace(motion, effort=motion.effort - missed)
