"""Drive gains: joint torque per ampere of motor current."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError

Array = NDArray[np.float64]


def read_gains(gains: Mapping[str, float] | str | Path, joints: Sequence[str]) -> Array:
    """Read the drive gain of each joint.

    Args:
        gains: {joint: gain [N·m/A]}, or a JSON file with it.
        joints: Joints of the robot.

    Returns:
        Gains in the order of the joints [N·m/A], shape (n,).

    Raises:
        LogError: If the file cannot be read, a joint is missing or a gain is not a number above 0.
    """
    where = "gains"
    if not isinstance(gains, Mapping):
        where = str(gains)
        try:
            gains = json.loads(Path(gains).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise LogError(f"{where}: not readable as JSON {{joint: N·m/A}} ({error})") from None
    if not isinstance(gains, Mapping):
        raise LogError(f"{where}: expected {{joint: N·m/A}}, found {type(gains).__name__}")
    missing = [j for j in joints if j not in gains]
    if missing:
        raise LogError(
            f"{where}: no gain for {', '.join(missing)}; it has {', '.join(map(str, gains)) or 'none'}"
        )
    bad = [j for j in joints if not _is_gain(gains[j])]
    if bad:
        raise LogError(
            f"{where}: the gain of {bad[0]} must be a number above 0 [N·m/A], given {gains[bad[0]]!r}"
        )
    return np.array([float(gains[j]) for j in joints])


def _is_gain(value: object) -> bool:
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return number and bool(np.isfinite(value)) and value > 0  # type: ignore[operator, call-overload]
