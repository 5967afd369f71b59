"""The side of the gear on which a log's torque was measured."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

from cdia_pin.errors import LogError, unknown_name


class TorqueSide(StrEnum):
    """Side of the gear on which a torque was measured."""

    UNKNOWN = "unknown"
    MOTOR = "motor"  # from the current: it drives the motor's friction and rotor too
    LINK = "link"  # a sensor behind the gear: it sees neither, and has a zero of its own


BEHIND_THE_GEAR = (
    "the torque is taken as measured behind the gear: friction of the motor and its rotor are not looked for"
)


def side_of_all(sides: Iterable[TorqueSide]) -> TorqueSide:
    """Return the side of several torques: behind the gear if one is and none is of the motor, else the one of all.

    Args:
        sides: Side of each.
    """
    known = set(sides)
    if TorqueSide.LINK in known and TorqueSide.MOTOR not in known:
        return TorqueSide.LINK
    return known.pop() if len(known) == 1 else TorqueSide.UNKNOWN


def torque_side_of(given: str | None) -> TorqueSide:
    """Return the side that a user names.

    Args:
        given: ``motor`` or ``link``; None if nobody says it.

    Raises:
        LogError: If it is something else.
    """
    if given is None:
        return TorqueSide.UNKNOWN
    if given not in tuple(TorqueSide):
        raise LogError(unknown_name("side of the torque sensor", given, [TorqueSide.MOTOR, TorqueSide.LINK]))
    return TorqueSide(given)
