"""Logs whose torques were recorded later or earlier beside the positions than those of the other side.

A recorder that is late by a tenth of a second delays quick torques by half of their period. No column of a delay is
right there: it is the slope at no delay at all. So the delay that explains most is looked for first, at its own size,
and the torques are put right by it. The search for changes decides afterwards whether it is one.
"""

from __future__ import annotations

from collections.abc import Iterator
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
# Share of what the common structure leaves [1], from which on a delay that explains it is clear. Delays of 47 to 94 ms
# that were put into logs of a UR3 and a Kinova Gen3 explain 29 to 58 % there, other changes at most 12 %: values from
# 0.13 to 0.28 decide alike in all 118 cases.
CLEAR_SHARE = 0.2


def put_right(differing: Differing) -> Differing | None:
    """Return the logs with the torques of those after at the right time; None if none of them are clearly late.

    Args:
        differing: The logs as they were recorded.
    """
    change = next((c for c in differing.changes if isinstance(c.effect, EffortDelay)), None)
    late = 0.0 if change is None else _lateness(differing, change)
    if change is None or not late:
        return None
    x = differing.experiment
    in_time = [_put_right(s, change, late) for s in x.segments]
    again = Differing.of(
        Experiment.of(x.robot, in_time, x.rest), differing.given.model, differing.before, differing.settings
    )
    return replace(again, given=differing.given, put_right={change: np.array([late])})


def _lateness(differing: Differing, change: Difference) -> float:
    """Return by how much the torques of the logs after are late [s], as far as it is clear; 0 if it is not."""
    torques = _torques(differing, change)
    left = differing.beside_common(
        [ColumnGroup.of(change, f[:, :, None], differing.experiment.robot) for f in torques]
    )
    explained = 2 * left[:-1, -1] - np.diag(left)[:-1]  # by each torque as it is
    clear = explained.max() >= CLEAR_SHARE * left[-1, -1]
    return vertex(DELAYS, -explained) if clear else 0.0


def _torques(differing: Differing, change: Difference) -> Iterator[Array]:
    """Yield the torque that a model without a delay misses by each of the delays [N·m or N], shape (K, n) each."""
    segments = differing.experiment.segments
    states = [
        s.state.with_effort(t.actuator) for s, t in zip(segments, differing.prediction.torques, strict=True)
    ]
    for delay in DELAYS:
        along = zip(segments, states, strict=True)
        yield np.vstack([s.motion.compared(change.torque(x, np.array([delay]))) for s, x in along])


def _put_right(segment: Segment, change: Difference, late: float) -> Motion:
    """Return a conditioned log with its torques earlier by a delay [s], if it is one of those that have it."""
    motion = segment.motion
    missed = change.torque(segment.state.with_effort(motion.effort), np.array([-late]))
    return replace(motion, effort=motion.effort - missed)
