"""Sizes that no log has, and that overflow in what is computed from it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.log import Log
from cdia_pin.phrases import counted

Array = NDArray[np.float64]

LARGEST = 1e9  # [rad, m, N·m or N], a million times what arms have in any unit that is in use
LONGEST = 1e9  # [s], thirty years


def require_magnitudes(log: Log) -> None:
    """Refuse a log whose numbers cannot be those of an arm.

    Args:
        log: The log, without its wild samples.

    Raises:
        LogError: If a position, an effort or the length of the log is beyond all units.
    """
    for signal, values in (("position", log.position), ("effort", log.effort), ("velocity", log.velocity)):
        if values is None:
            continue
        largest = largest_of(values)
        if largest.max() > LARGEST:
            joint = int(largest.argmax())
            rows = np.flatnonzero((np.abs(values) > LARGEST).any(axis=1))
            raise LogError(
                f"{log.source}: the {signal} of {log.joints[joint]} reaches {largest[joint]:.3g}: no arm in any unit, "
                f"in {len(rows)} of {counted(len(log.time), 'sample')}, first in sample {rows[0]} "
                f"(t = {log.time[rows[0]]:g} s)"
            )
    if log.duration > LONGEST:
        raise LogError(
            f"{log.source}: its times span {log.duration:.3g} s; give their unit (--convert time=ns)"
        )


def largest_of(values: Array) -> Array:
    """Return the largest magnitude of each column, without a copy of a long log.

    Args:
        values: Values of any unit, shape (N, n).

    Returns:
        Largest absolute values, shape (n,).
    """
    return np.asarray(np.maximum(values.max(axis=0), -values.min(axis=0)))
