"""Drive gains: joint torque per ampere of motor current, and how well each is known."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.input_files import read_text
from cdia_pin.phrases import shortened, some

Array = NDArray[np.float64]
Gains = Mapping[str, Any] | str | Path

# Relative tolerance of a gain from a data sheet, 95 % [1]. Magnets and gears of one type differ by 5 % and more, and
# known weights on a measured arm came out 3 to 10 % heavy by nominal gains.
NOMINAL_TOLERANCE = 0.1
NAMED = 8  # names of a file that are shown: one of another kind may have any number
LARGEST = 1e12  # [N·m/A], above it a product with a current overflows


@dataclass(frozen=True)
class DriveGains:
    """The drive gain of each joint and its tolerance.

    Attributes:
        value: Gains [N·m/A], shape (n,).
        tolerance: Half widths of their 95 % intervals [N·m/A], shape (n,).
    """

    value: Array
    tolerance: Array

    @property
    def relative_tolerance(self) -> Array:
        """Tolerance over the gain [1], shape (n,)."""
        return self.tolerance / self.value


def read_gains(gains: Gains, joints: Sequence[str]) -> DriveGains:
    """Read the drive gain of each joint.

    Args:
        gains: {joint: gain [N·m/A]} or {joint: {"value": gain, "tolerance": half width of its 95 % interval}}, or a
            JSON file with it. A gain without a tolerance is taken as nominal, see `NOMINAL_TOLERANCE`.
        joints: Joints of the robot.

    Returns:
        Gains in the order of the joints.

    Raises:
        LogError: If the file cannot be read, a joint is missing, a gain is not a number above 0, or a tolerance not a
            number of 0 or more.
    """
    where, gains = "gains" if isinstance(gains, Mapping) else str(gains), gains_by_joint(gains)
    missing = [j for j in joints if j not in gains]
    if missing:
        has = some([shortened(str(name)) for name in gains], NAMED) if gains else "none"
        raise LogError(f"{where}: no gain for {', '.join(missing)}; it has {has}")
    both = np.array([_value_and_tolerance(gains[j], j, where) for j in joints])
    return DriveGains(both[:, 0], both[:, 1])


def gains_by_joint(gains: Gains) -> Mapping[str, Any]:
    """Return drive gains by joint as they are given, unchecked, from a JSON file if it is one.

    Args:
        gains: {joint: …} or a file, as of `read_gains`.

    Raises:
        LogError: If the file cannot be read, or holds no object.
    """
    if isinstance(gains, Mapping):
        return gains
    try:
        found = json.loads(read_text(gains))
    except OSError as error:
        raise LogError(f"cannot read the drive gains {gains}: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise LogError(f"{gains}: not readable as JSON {{joint: N·m/A}} ({error})") from None
    if not isinstance(found, Mapping):
        raise LogError(f"{gains}: expected {{joint: N·m/A}}, found {type(found).__name__}")
    return found


def _value_and_tolerance(given: Any, joint: str, where: str) -> tuple[float, float]:
    value: Any = given.get("value") if isinstance(given, Mapping) else given
    if not _is_number(value) or value <= 0:
        raise LogError(f"{where}: the gain of {joint} must be a number above 0 [N·m/A], given {given!r}")
    tolerance: Any = given.get("tolerance") if isinstance(given, Mapping) else None
    if tolerance is None:
        return float(value), NOMINAL_TOLERANCE * float(value)
    if not _is_number(tolerance) or tolerance < 0:
        raise LogError(
            f"{where}: the tolerance of {joint} must be a number of 0 or more [N·m/A], given {tolerance!r}"
        )
    return float(value), float(tolerance)


def _is_number(given: Any) -> bool:
    if isinstance(given, bool) or not isinstance(given, (int, float)):
        return False
    return abs(given) < LARGEST  # also of an integer that no float can hold
