"""Reader of a robot's logs in any of the formats, in SI units and the robot's joint order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.conversion import Conversion
from cdia_pin.logs.effort_signal import pick_effort
from cdia_pin.logs.formats import CSV, ColumnChoice, choose_columns, column_patterns, format_of, recognised
from cdia_pin.logs.formats.choice import for_one_joint, names_no_joint
from cdia_pin.logs.gains import Gains, read_gains
from cdia_pin.logs.joint_names import check_joint_map, joint_map_of
from cdia_pin.logs.log import Log
from cdia_pin.logs.missing_columns import require_columns
from cdia_pin.logs.readers.dispatch import Wanted, read_table
from cdia_pin.logs.readers.table import Table
from cdia_pin.logs.signal_picker import SignalPicker
from cdia_pin.logs.timestamps import in_order, in_seconds, recorded_at
from cdia_pin.logs.torque_side import torque_side_of
from cdia_pin.logs.whole_turns import without_wraps

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


def read_log(
    path: str | Path,
    robot: RobotModel,
    *,
    gains: Gains | None = None,
    joint_map: Mapping[str, str] | Sequence[str] | None = None,
    convert: Conversion | Mapping[str, Any] | Sequence[str] | None = None,
    topic: str | None = None,
    torque_side: str | None = None,
    format: str | None = None,
    columns: Mapping[str, str] | Sequence[str] | None = None,
    episode: int | None = None,
) -> Log:
    """Read a log of a robot; the file and the names of its columns give its format.

    Every inference and change is a sentence in the log's ``notes``. A missing signal is an error, except velocity,
    which is optional. Missing values are not filled in.

    Args:
        path: CSV (``.csv``, ``.tsv``, ``.txt``), Parquet (``.parquet``, ``.pq``), ``.npz``, a
            ROS 2 bag (``.db3``, ``.mcap`` or its directory) with sensor_msgs/JointState, or a LeRobot dataset (its
            directory).
        robot: The robot; its joints are looked up by name and returned in its order.
        gains: Drive gains {joint: gain [N·m/A]}, or a JSON file with them, for a log with motor currents; see
            `read_gains`.
        joint_map: {name in the log: joint of the robot} for names that differ, or texts ``name=joint``.
        convert: Units and signs that are not SI or not those of the URDF, see ``Conversion``.
        topic: JointState topic of a bag, if several topics have the robot's joints.
        torque_side: Side of the gear on which the torque was measured, ``motor`` or ``link``. Currents are of the
            motor's side, and some formats state it; of other torques it is not known.
        format: Name of the format, one of ``FORMATS``; recognised if omitted.
        columns: {signal: pattern} for columns of other names, or texts ``signal=pattern``; in a pattern ``#`` stands
            for the number of a joint and ``*`` for its name.
        episode: Episode of a LeRobot dataset, if it has several.

    Returns:
        The log. Its times are as given [s]; times since 1970 are counted from the first sample.

    Raises:
        LogError: If the file cannot be read, lacks a signal, or has values that cannot be used.
    """
    path = Path(path)
    conversion = Conversion.of(convert)
    conversion.check_joints(robot.joints)
    renames = joint_map_of(joint_map)
    own = column_patterns(columns, one_joint=robot.n == 1)
    # a mistyped file is refused also where the log has torques and nobody needs it
    known_gains = None if gains is None else read_gains(gains, robot.joints)
    if format is not None:
        format_of(format)
    table, sha256 = read_table(path, robot.joints, Wanted(format, renames, topic, episode))
    choice = choice_of(table, format, own, path.name, robot.joints)
    pick = SignalPicker(table, choice, robot.joints, renames, path.name, list(table.notes))
    if names_no_joint(choice, robot.joints[0]):
        pick.notes.append(
            f"columns without the name of a joint are those of the only joint, {robot.joints[0]}"
        )
    if choice.format.marks:
        pick.notes.append(
            f"read as {choice.format.description} ({choice.format.name}); --format csv changes it"
        )
    check_joint_map(pick.joint_map, pick.labels, robot.joints)

    require_columns(pick, robot, times=conversion.rate is None)
    _require_units(choice, conversion, path.name)
    position = _scaled(pick.required("position"), conversion.position_scale(robot))
    velocity = pick.optional("velocity") if conversion.use_velocity else None
    if velocity is not None:
        velocity = _scaled(velocity, conversion.velocity_scale(robot))
    effort = pick_effort(pick, known_gains, conversion, torque_side_of(torque_side))
    torque = _scaled(effort.values, conversion.effort_scale(robot))
    temperature = _temperature(pick)
    if effort.without_gravity:
        torque = torque + robot.gravity(position)
    pick.note_what_was_ignored()
    if conversion.rate is None:
        stamps = pick.time()
        unit = conversion.time or table.time_unit or choice.columns.time.get(choice.columns.time_column or "")
    else:
        stamps, unit = np.arange(len(position)) / conversion.rate, "s"
    placed, order_notes = in_order(stamps)
    if order_notes:
        stamps, position, torque = stamps[placed], position[placed], torque[placed]
        velocity, temperature = (None if s is None else s[placed] for s in (velocity, temperature))
    time, time_notes = in_seconds(stamps, unit, path.name)
    position, turn_notes = without_wraps(time, position, robot)
    signals = [s for s in (position, torque, velocity, temperature) if s is not None]
    keep, repeat_notes = _once(time, signals, path.name)
    if not repeat_notes:
        keep = np.s_[:]  # without copies
    return Log(
        joints=robot.joints,
        time=time[keep],
        position=position[keep],
        effort=torque[keep],
        velocity=None if velocity is None else velocity[keep],
        source=path.name,
        sha256=sha256,
        notes=(*pick.notes, *conversion.notes(), *order_notes, *time_notes, *turn_notes, *repeat_notes),
        temperature=None if temperature is None else temperature[keep],
        torque_side=effort.side,
        side_of_format=effort.side_of_format,
        effort_origin=effort.origin,
        effort_tolerance=effort.tolerance,
        recorded=recorded_at(stamps, unit, path.name),
    )


def choice_of(
    table: Table, asked: str | None, own: Mapping[str, str], source: str, joints: Sequence[str]
) -> ColumnChoice:
    """Return the columns of each signal.

    Args:
        table: The columns of a file.
        asked: Name of the format, if the user gives it.
        own: {signal: pattern} as the user gives it.
        source: Name of the log, for messages.
        joints: Joints of the robot; columns of an only joint need not name it.

    Raises:
        LogError: If the columns are not those that were asked for.
    """
    names = [*table.columns, *table.not_numbers]
    try:
        if asked is not None and table.format not in {None, asked}:
            raise LogError(f"not of format '{asked}': it is {format_of(str(table.format)).description}")
        format_ = recognised(names, asked) if table.format is None else format_of(table.format)
        choice = choose_columns(names, format_, own)
    except LogError as error:
        raise LogError(f"{source}: {error}") from None
    return for_one_joint(choice, joints[0]) if len(joints) == 1 and format_ == CSV else choice


def _require_units(choice: ColumnChoice, conversion: Conversion, source: str) -> None:
    """Ask for the unit of angles where neither the file nor the user states it."""
    if conversion.angle is None and not choice.facts("position").unit_stated:
        raise LogError(
            f"{source}: a file of format '{choice.format.name}' does not state the unit of its positions; say it with "
            "--convert angle=deg or --convert angle=rad (percent of a calibrated range cannot be used)"
        )


def _scaled(signal: Array, scale: Array) -> Array:
    """Return a signal in SI units; one that has them already is not copied."""
    return signal if (scale == 1.0).all() else signal * scale


def _temperature(pick: SignalPicker) -> Array | None:
    """Return the temperatures of the joints [°C], shape (N, n); None if the log has none that can be used."""
    if not pick.columns.labels("temperature"):
        return None
    temperature = pick.optional("temperature")
    if temperature is None or np.isfinite(temperature).all():
        return temperature
    pick.notes.append("temperature not used, because values are missing")
    return None


def _once(time: Array, signals: list[Array], source: str) -> tuple[Any, list[str]]:
    """Return the mask of samples to keep: a repeated row counts once, and raises LogError if its values differ."""
    keep = np.ones(len(time), dtype=bool)
    again = np.flatnonzero(np.diff(time) == 0) + 1
    for row in again:
        if not all(np.array_equal(s[row], s[row - 1], equal_nan=True) for s in signals):
            raise LogError(
                f"{source}: samples {row - 1} and {row} have the same time {time[row]:g} s but different "
                "values; keep one of them"
            )
        keep[row] = False
    return keep, [f"{len(again)} rows were written twice and count once"] if len(again) else []
