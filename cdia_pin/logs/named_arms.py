"""Arms whose joints a log names, where it does not fit the arm that was given."""

from __future__ import annotations

from collections.abc import Sequence


def arms_named_by(labels: Sequence[str]) -> list[str]:
    """Find the arms on this machine whose joints a log names.

    Args:
        labels: Joint labels of the log.

    Returns:
        Names of the catalogue, those with the most joints first.
    """
    from cdia_pin.robot.catalogue import joints_here

    found = {name: len(joints) for name, joints in joints_here() if joints <= set(labels)}
    return sorted(found, key=lambda name: -found[name])
