"""What to do about a table whose first line holds numbers: the line of names to add."""

from __future__ import annotations

from collections.abc import Sequence

# Signals that a table of one time and one, two or three columns for each joint holds, in the usual order.
USUAL = {
    ("position",): "all positions (efforts are needed too)",
    ("position", "effort"): "all positions, then all efforts",
    ("position", "velocity", "effort"): "all positions, then all velocities, then all efforts",
}


def header_advice(count: int, joints: Sequence[str], delimiter: str) -> str:
    """Return how to go on, with the line to add where the number of columns is a usual one.

    Args:
        count: Number of columns.
        joints: Joints of the robot; empty if they are not known.
        delimiter: What stands between two columns.
    """
    for signals, order in USUAL.items():
        if joints and count == 1 + len(signals) * len(joints):
            names = ["time", *(f"{signal}.{joint}" for signal in signals for joint in joints)]
            return f"if its {count} columns are the time, then {order}, add the first line {delimiter.join(names)}"
    example = delimiter.join(("time", "position.<joint>", "effort.<joint>"))
    return f"add a first line with a name for each of its {count} columns, such as {example}"
