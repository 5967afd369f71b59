"""The side of the gear on which a log's torque was measured."""

from __future__ import annotations

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
