"""The formats that are known, one entry each. Sources of what is stated here: the pages of docs/formats."""

from __future__ import annotations

from collections.abc import Sequence

from cdia_pin.errors import LogError, unknown_name
from cdia_pin.logs.formats.log_format import LogFormat, Recorded
from cdia_pin.logs.torque_side import TorqueSide
from cdia_pin.phrases import some

CSV = LogFormat("csv", "columns named <signal>.<joint>, in CSV, Parquet or npz")

ROS2 = LogFormat(
    "ros2",
    "ROS 2 bag with sensor_msgs/JointState",
    advice="the driver publishes none: turn its effort on, or record a topic that has it",
)

RTDE = LogFormat(
    "rtde",
    "recording of a UR controller's RTDE interface",
    recorded=(
        Recorded("position", ("actual_q_#",)),
        Recorded("velocity", ("actual_qd_#",)),
        Recorded("current", ("actual_current_#",), side=TorqueSide.MOTOR),
        Recorded(
            "effort",
            ("actual_current_as_torque_#",),
            side=TorqueSide.MOTOR,
            without_gravity=True,
            caveat="actual_current_as_torque has no gravity: the controller takes away the weight of the arm and of "
            "the payload that is set in it; the URDF's gravity is added, so masses and payload cannot be judged "
            "(actual_current with --gains shows them)",
        ),
        Recorded(
            "effort",
            ("target_moment_#",),
            side=TorqueSide.MOTOR,
            commanded=True,
            only_on_request=True,
            caveat="target_moment is what the controller's model asks for, not a measurement: nothing that the arm "
            "does otherwise shows in it",
        ),
        Recorded("temperature", ("joint_temperatures_#",)),
    ),
    marks=("actual_q_#", "actual_current_#", "actual_current_as_torque_#"),
    time=(("timestamp", "s"),),
    advice="record timestamp, actual_q, actual_qd and actual_current (A, with --gains), or actual_current_as_torque",
)

LIBFRANKA = LogFormat(
    "libfranka",
    "robot state of a Franka arm, as franka::logToCSV writes it",
    recorded=(
        Recorded("position", ("state.q[#]", "q[#]", "q_#", "robot_state.q[#]")),
        Recorded("velocity", ("state.dq[#]", "dq[#]", "dq_#", "robot_state.dq[#]")),
        Recorded(
            "effort", ("state.tau_J[#]", "tau_J[#]", "tau_J_#", "robot_state.tau_J[#]"), side=TorqueSide.LINK
        ),
        Recorded(
            "effort",
            ("state.tau_J_d[#]", "cmd.tau_J_d[#]", "tau_J_d[#]", "tau_J_d_#", "robot_state.tau_J_d[#]"),
            without_gravity=True,
            commanded=True,
            only_on_request=True,
            caveat="tau_J_d is the torque that was asked for, without gravity, not a measurement",
        ),
    ),
    marks=("state.tau_J[#]", "tau_J[#]", "tau_J_#", "robot_state.tau_J[#]", "tau_J_d[#]", "cmd.tau_J_d[#]"),
    time=(("time", None), ("state.time", None), ("robot_state.time", None)),
    advice="log q, dq and tau_J, the measured torque; tau_J_d is the commanded one without gravity, and "
    "tau_ext_hat_filtered what the controller's model leaves over",
)

LEROBOT = LogFormat(
    "lerobot",
    "LeRobot dataset, Parquet files beside meta/info.json",
    recorded=(
        Recorded("position", ("observation.state.*.pos", "observation.state.*"), unit_stated=False),
        Recorded("velocity", ("observation.state.*.vel", "observation.velocity.*"), unit_stated=False),
        Recorded(
            "effort",
            ("observation.state.*.torque", "observation.state.*.effort", "observation.effort.*"),
            caveat="a LeRobot dataset does not state the unit of its torques; N·m is taken (--convert torque= "
            "changes it)",
        ),
        Recorded("current", ("observation.state.*.current", "observation.current.*"), side=TorqueSide.MOTOR),
    ),
    time=(("timestamp", "s"),),
    advice="most datasets hold positions and pictures only; a recording with torques or motor currents is needed",
)

FORMATS = {format_.name: format_ for format_ in (CSV, RTDE, LIBFRANKA, ROS2, LEROBOT)}
"""Every format by the name that ``--format`` takes."""


def recognised(names: Sequence[str], asked: str | None = None) -> LogFormat:
    """Find the format of a table by the names of its columns.

    Args:
        names: Names of the columns.
        asked: Name of the format, if the user gives it.

    Returns:
        The format; `CSV` if the columns are those of no other.

    Raises:
        LogError: If the columns are not those of the format that was asked for.
    """
    if asked is None:
        return next((f for f in FORMATS.values() if f.marked(names)), CSV)
    format_ = format_of(asked)
    if format_.marks and not format_.marked(names):
        raise LogError(
            f"not of format '{asked}', which has columns {format_.marks[0].replace('#', '0')} and so on; "
            f"found {some(list(names))}"
        )
    return format_


def format_of(name: str) -> LogFormat:
    """Return a format by its name.

    Args:
        name: A key of `FORMATS`.

    Raises:
        LogError: If there is none of that name.
    """
    if name not in FORMATS:
        raise LogError(unknown_name("format", name, FORMATS))
    return FORMATS[name]
