"""Files of a motion that an arm shall make: CSV in the project's dialect, and YAML for ROS 2 controllers."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.whole_files import write_whole

Array = NDArray[np.float64]

DIGITS = 9  # decimals of an exported number: to a nanometre or a nanoradian, below any encoder's step


def write_motion(path: str | Path, joints: Sequence[str], time: Array, signals: Mapping[str, Array]) -> Path:
    """Write signals of all joints as CSV, ``time`` and then ``<signal>.<joint>``.

    Args:
        path: File to write; an existing one is replaced.
        joints: Joint names, in the order of the columns.
        time: Time of each sample [s], shape (N,).
        signals: Signals by name [SI units], shape (N, n) each.

    Returns:
        The path that was written.

    Raises:
        LogError: If the file cannot be written.
    """
    heads = ["time", *(f"{signal}.{joint}" for signal in signals for joint in joints)]
    rows = np.column_stack([time, *signals.values()])
    lines = (",".join(f"{x:.{DIGITS}f}" for x in row) for row in rows)
    return _write(path, [",".join(heads), *lines])


def write_joint_trajectory(
    path: str | Path,
    joints: Sequence[str],
    time: Array,
    position: Array,
    velocity: Array,
    acceleration: Array,
) -> Path:
    """Write a ``trajectory_msgs/msg/JointTrajectory`` as YAML.

    ``ros2 topic pub --once --yaml-file FILE TOPIC trajectory_msgs/msg/JointTrajectory`` sends it. Efforts are left
    out: a ``joint_trajectory_controller`` that commands positions refuses a trajectory that has them.

    Args:
        path: File to write; an existing one is replaced.
        joints: Joint names, in the order of the columns.
        time: Time of each point from the start [s], shape (N,).
        position: Positions [rad or m], shape (N, n).
        velocity: Velocities [rad/s or m/s], shape (N, n).
        acceleration: Accelerations [rad/s² or m/s²], shape (N, n).

    Returns:
        The path that was written.

    Raises:
        LogError: If the file cannot be written.
    """
    # lists and strings of JSON are valid YAML
    lines = [f"joint_names: {json.dumps(list(joints))}", "points:"]
    for t, *point in zip(time, position, velocity, acceleration, strict=True):
        nanoseconds = round(float(t) * 1e9)
        stamp = f"{{sec: {nanoseconds // 10**9}, nanosec: {nanoseconds % 10**9}}}"
        q, v, a = ("[" + ", ".join(f"{x:.{DIGITS}f}" for x in row) + "]" for row in point)
        lines.append(f"- {{positions: {q}, velocities: {v}, accelerations: {a}, time_from_start: {stamp}}}")
    return _write(path, lines)


def _write(path: str | Path, lines: Iterable[str]) -> Path:
    path = Path(path)
    try:
        write_whole(path, "\n".join(lines) + "\n")
    except OSError as error:
        raise LogError(f"{path}: cannot be written ({error.strerror or error})") from None
    return path
