"""Arms whose joints a log names, where it does not fit the arm that was given."""

from __future__ import annotations

from collections.abc import Sequence

from cdia_pin.errors import RobotError


def arms_named_by(labels: Sequence[str]) -> list[str]:
    """Find the arms on this machine whose joints a log names.

    Args:
        labels: Joint labels of the log.

    Returns:
        Names of the catalogue, those with the most joints first.
    """
    from cdia_pin.robot.catalogue import catalogue, load_robot

    found = {}
    for name, entry in catalogue().items():
        if not entry.available:
            continue
        try:
            joints = load_robot(name).joints
        except RobotError:  # a file that was damaged
            continue
        if set(joints) <= set(labels):
            found[name] = len(joints)
    return sorted(found, key=lambda name: -found[name])
