"""Reader of a robot's logs in any of the formats, in SI units and the robot's joint order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.columns import sort_names
from cdia_pin.logs.conversion import Conversion, GravityInEffort
from cdia_pin.logs.gains import Gains, read_gains
from cdia_pin.logs.joint_names import check_joint_map, joint_map_of
from cdia_pin.logs.log import Log
from cdia_pin.logs.readers.dispatch import read_table
from cdia_pin.logs.signal_picker import SignalPicker
from cdia_pin.logs.timestamps import in_seconds
from cdia_pin.logs.torque_side import BEHIND_THE_GEAR, TorqueSide, torque_side_of

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
) -> Log:
    """Read a log of a robot; the suffix of the file gives its format.

    Every inference and change is a sentence in the log's ``notes``. A missing signal is an error, except velocity,
    which is optional. Missing values are not filled in.

    Args:
        path: CSV (``.csv``, ``.tsv``, ``.txt``), Parquet (``.parquet``, ``.pq``), ``.npz``, or a
            ROS 2 bag (``.db3``, ``.mcap`` or its directory) with sensor_msgs/JointState.
        robot: The robot; its joints are looked up by name and returned in its order.
        gains: Drive gains {joint: gain [N·m/A]}, or a JSON file with them, for a log with motor currents; see
            `read_gains`.
        joint_map: {name in the log: joint of the robot} for names that differ, or texts ``name=joint``.
        convert: Units and signs that are not SI or not those of the URDF, see ``Conversion``.
        topic: JointState topic of a bag, if several topics have the robot's joints.
        torque_side: Side of the gear on which the torque was measured, ``motor`` or ``link``. Currents are of the
            motor's side; of other torques it is not known.

    Returns:
        The log. Its times are as given [s]; times since 1970 are counted from the first sample.

    Raises:
        LogError: If the file cannot be read, lacks a signal, or has values that cannot be used.
    """
    path = Path(path)
    conversion = Conversion.of(convert)
    conversion.check_joints(robot.joints)
    renames = joint_map_of(joint_map)
    table, sha256 = read_table(path, robot.joints, renames, topic)
    columns = sort_names((*table.columns, *table.not_numbers))
    pick = SignalPicker(table, columns, robot.joints, renames, path.name, list(table.notes))
    check_joint_map(pick.joint_map, pick.labels, robot.joints)

    position = _scaled(pick.required("position"), conversion.position_scale(robot))
    velocity = pick.optional("velocity") if conversion.use_velocity else None
    if velocity is not None:
        velocity = _scaled(velocity, conversion.velocity_scale(robot))
    side = torque_side_of(torque_side)
    effort, tolerance = _effort(pick, gains, conversion)
    if tolerance is not None:
        side = side if side is not TorqueSide.UNKNOWN else TorqueSide.MOTOR
    effort = _scaled(effort, conversion.effort_scale(robot))
    if side is TorqueSide.LINK:
        pick.notes.append(f"{BEHIND_THE_GEAR}, as asked")
    temperature = _temperature(pick)
    if conversion.gravity == GravityInEffort.COMPENSATED:
        effort = effort + robot.gravity(position)
    pick.note_what_was_ignored()
    unit = conversion.time or table.time_unit or columns.time.get(columns.time_column or "")
    time, time_notes = in_seconds(pick.time(), unit, path.name)
    signals = [s for s in (position, effort, velocity, temperature) if s is not None]
    keep, repeat_notes = _once(time, signals, path.name)
    if not repeat_notes:
        keep = np.s_[:]  # without copies
    return Log(
        joints=robot.joints,
        time=time[keep],
        position=position[keep],
        effort=effort[keep],
        velocity=None if velocity is None else velocity[keep],
        source=path.name,
        sha256=sha256,
        notes=(*pick.notes, *conversion.notes(), *time_notes, *repeat_notes),
        temperature=None if temperature is None else temperature[keep],
        torque_side=side,
        effort_tolerance=tolerance,
    )


def _effort(pick: SignalPicker, gains: Gains | None, conversion: Conversion) -> tuple[Array, Array | None]:
    """Return the efforts as logged, or the motor currents times the drive gains, shape (N, n).

    With currents, return the relative tolerance of the gains [1] as well, shape (n,).
    """
    has_current, has_effort = bool(pick.columns.labels("current")), bool(pick.columns.labels("effort"))
    if has_current and has_effort:
        pick.notes.append("the log has both effort and current; the effort is used")
    if has_effort and conversion.torque != "A":
        if gains is not None:
            pick.notes.append("drive gains not used: the log has efforts (--convert torque=A applies them)")
        return pick.required("effort"), None
    if not has_effort and not has_current:
        return pick.required("effort"), None  # raises and names what is missing
    current = pick.required("effort" if has_effort else "current")
    if gains is None:
        example = ", ".join(f'"{j}": 10.0' for j in pick.joints[:2])
        raise LogError(
            f"{pick.source}: the log has motor currents [A]; give drive gains [N·m/A] per joint with "
            f"--gains gains.json (in Python gains=), holding {{{example}, …}}"
        )
    read = read_gains(gains, pick.joints)
    rows = zip(pick.joints, read.value, read.relative_tolerance, strict=True)
    said = ", ".join(f"{j} {k:g} ± {share:.2g} %" for j, k, share in ((j, k, 100 * r) for j, k, r in rows))
    pick.notes.append(
        f"effort is current times drive gain [N·m/A] and no more accurate than these gains: {said}"
    )
    return current * read.value, read.relative_tolerance


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
