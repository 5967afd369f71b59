"""Reader of ROS 2 bags (``.db3``, ``.mcap`` or a bag directory) with sensor_msgs/JointState."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.extras import require
from cdia_pin.logs.joint_names import match_joints
from cdia_pin.logs.readers.bounds import require_bounded
from cdia_pin.logs.readers.mcap import bounded_decompression, contents
from cdia_pin.logs.readers.table import Table

JOINT_STATE = "sensor_msgs/msg/JointState"
_COMMANDS = ("command", "cmd", "desired", "target", "reference", "goal")


class _Message(NamedTuple):
    """A JointState message: names, stamp [ns] and signals; messages of one arm share their names."""

    name: tuple[str, ...]
    stamp: int
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    effort: NDArray[np.float64]


@dataclass
class _Topic:
    """JointState messages of one topic, in the order they were received."""

    name: str
    received: list[int] = field(default_factory=list)  # [ns]
    messages: list[_Message] = field(default_factory=list)

    @property
    def joint_lists(self) -> list[tuple[str, ...]]:
        return sorted({m.name for m in self.messages})

    def covering(self, joints: Sequence[str], joint_map: Mapping[str, str] | None) -> set[tuple[str, ...]]:
        """Return the lists of joints in the messages that contain every joint of the robot."""
        found = set()
        for names in self.joint_lists:
            try:
                match_joints(names, joints, {k: v for k, v in (joint_map or {}).items() if k in names})
            except LogError:
                continue
            found.add(names)
        return found


def read_rosbag(
    path: Path,
    joints: Sequence[str],
    joint_map: Mapping[str, str] | None = None,
    topic: str | None = None,
) -> Table:
    """Read the JointState messages that hold the joints of a robot.

    Args:
        path: A ``.db3`` or ``.mcap`` file, or the directory of a bag.
        joints: Joints of the robot.
        joint_map: {name in the bag: joint of the robot}.
        topic: Topic to read, if several have the joints.

    Returns:
        Times [ns] and the columns ``<signal>.<joint>``.

    Raises:
        LogError: If the bag cannot be read, or not exactly one topic has the joints.
    """
    source = path.name
    topics, others = _joint_states(path, source)
    if not topics:
        listed = ", ".join(others[:12]) or "none"
        raise LogError(f"{source}: no messages of type {JOINT_STATE}; topics: {listed}")
    if topic is not None:
        topics = _named(topics, topic, source)
    chosen = _choose(topics, joints, joint_map, source)
    usable = chosen.covering(joints, joint_map)
    keep = [k for k, m in enumerate(chosen.messages) if m.name in usable]
    notes = [f"{len(keep)} messages of topic {chosen.name} read"]
    if len(keep) < len(chosen.messages):
        notes.append(f"{len(chosen.messages) - len(keep)} of its messages lack the robot's joints, left out")
    messages = [chosen.messages[k] for k in keep]
    time = np.array([m.stamp for m in messages], dtype=np.int64)
    if not time.any():
        notes.append("header stamps are all zero; the times of reception are used")
        time = np.array([chosen.received[k] for k in keep], dtype=np.int64)
    order = np.argsort(time, kind="stable")
    if (np.diff(order) < 0).any():
        notes.append("messages sorted by time; some were recorded out of order")
    columns: dict[str, NDArray[Any]] = {"time": time[order]}
    for signal in ("position", "velocity", "effort"):
        columns.update(
            {name: values[order] for name, values in _signal(messages, signal, source, notes).items()}
        )
    return Table(columns, time_unit="ns", notes=tuple(notes))


def _signal(
    messages: list[_Message], signal: str, source: str, notes: list[str]
) -> dict[str, NDArray[np.float64]]:
    """Return the columns ``signal.joint`` by name; the order of joints may differ between messages."""
    filled = [len(getattr(m, signal)) for m in messages]
    if not any(filled):
        return {}
    orders: dict[tuple[str, ...], int] = {}
    for message, count in zip(messages, filled, strict=True):
        names = message.name
        if count != len(names):
            raise LogError(
                f"{source}: a message names {len(names)} joints but holds {count} values of {signal}; "
                f"either all or none of the messages may leave {signal} out"
            )
        orders.setdefault(names, len(orders))
    if len(orders) > 1 and signal == "position":
        notes.append(f"messages list their joints in {len(orders)} different ways; read by name")
    shared = [j for j in next(iter(orders)) if all(j in names for names in orders)]
    pick = {names: [names.index(j) for j in shared] for names in orders}
    values = np.array([getattr(m, signal)[pick[m.name]] for m in messages])
    return {f"{signal}.{joint}": values[:, k] for k, joint in enumerate(shared)}


def _light(message: Any, names: dict[tuple[str, ...], tuple[str, ...]]) -> _Message:
    """Return what is needed of a message, which takes a tenth of its memory."""
    name = tuple(message.name)
    stamp = message.header.stamp
    signals = (np.array(getattr(message, s), dtype=np.float64) for s in ("position", "velocity", "effort"))
    return _Message(names.setdefault(name, name), stamp.sec * 10**9 + stamp.nanosec, *signals)


def _require_bounded(path: Path) -> None:
    """Refuse MCAP files whose chunks become too large."""
    for file in sorted(path.iterdir()) if path.is_dir() else [path]:
        if file.suffix == ".mcap":
            require_bounded(contents(file), file.stat().st_size, file.name)


def _named(topics: list[_Topic], wanted: str, source: str) -> list[_Topic]:
    named = [t for t in topics if t.name == wanted]
    if not named:
        raise LogError(
            f"{source}: no JointState topic '{wanted}'; it has {', '.join(t.name for t in topics)}"
        )
    return named


def _choose(
    topics: list[_Topic], joints: Sequence[str], joint_map: Mapping[str, str] | None, source: str
) -> _Topic:
    fitting = [t for t in topics if t.covering(joints, joint_map)]
    if not fitting:
        listed = "; ".join(f"{t.name} has {', '.join(t.joint_lists[0])}" for t in topics[:4] if t.joint_lists)
        raise LogError(
            f"{source}: no JointState topic has all joints of the robot ({', '.join(joints)}); {listed}; "
            "name them with --joint-map name=joint,…"
        )
    measured = [t for t in fitting if not any(word in t.name.lower() for word in _COMMANDS)] or fitting
    with_effort = [t for t in measured if any(len(m.effort) for m in t.messages)] or measured
    if len(with_effort) > 1:
        raise LogError(
            f"{source}: several JointState topics have the robot's joints: "
            f"{', '.join(t.name for t in with_effort)}; choose one with --topic"
        )
    return with_effort[0]


def _joint_states(path: Path, source: str) -> tuple[list[_Topic], list[str]]:
    """Return all JointState messages by topic, and the other topics with their types."""
    require("ros", "ROS 2 bags")
    from rosbags.rosbag2 import Reader
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)  # JointState is the same in every ROS 2
    topics: dict[str, _Topic] = {}
    names: dict[tuple[str, ...], tuple[str, ...]] = {}
    _require_bounded(path)
    try:
        with bounded_decompression(), Reader(path) as bag:
            wanted = [c for c in bag.connections if c.msgtype == JOINT_STATE]
            others = [f"{c.topic} ({c.msgtype})" for c in bag.connections if c.msgtype != JOINT_STATE]
            for connection, received, raw in bag.messages(wanted) if wanted else ():
                topic = topics.setdefault(connection.topic, _Topic(connection.topic))
                topic.received.append(received)
                topic.messages.append(_light(store.deserialize_cdr(raw, JOINT_STATE), names))
    except Exception as error:  # rosbags, apsw, struct and lz4 each raise their own
        said = " ".join(str(error).split())[:160] or type(error).__name__
        raise LogError(
            f"{source}: not readable as a ROS 2 bag ({said}); a recording that was cut off may be "
            "repaired with 'ros2 bag reindex' or 'mcap recover'"
        ) from None
    return list(topics.values()), others
