"""Reader of ROS 2 bags (``.db3``, ``.mcap`` or a bag directory) with sensor_msgs/JointState."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.decoding import decoding
from cdia_pin.errors import LogError
from cdia_pin.extras import require
from cdia_pin.logs.joint_names import match_joints
from cdia_pin.logs.readers import mcap
from cdia_pin.logs.readers.bag_files import storage_files
from cdia_pin.logs.readers.bounds import require_bounded
from cdia_pin.logs.readers.joint_states import JointStates, joint_states
from cdia_pin.logs.readers.table import Table

JOINT_STATE = "sensor_msgs/msg/JointState"
_COMMANDS = ("command", "cmd", "desired", "target", "reference", "goal")


@dataclass(frozen=True)
class _Topic:
    """JointState messages of one topic: times of reception [ns], shape (N,), and the messages by their joints."""

    name: str
    received: NDArray[np.int64]
    states: list[JointStates]

    @property
    def joint_lists(self) -> list[tuple[str, ...]]:
        return sorted({s.names for s in self.states})

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
    states = [s for s in chosen.states if s.names in usable]
    index = np.concatenate([s.index for s in states])
    notes = [f"{len(index)} messages of topic {chosen.name} read"]
    if len(index) < len(chosen.received):
        notes.append(f"{len(chosen.received) - len(index)} of its messages lack the robot's joints, left out")
    time = np.concatenate([s.stamp for s in states])
    if not time.any():
        notes.append("header stamps are all zero; the times of reception are used")
        time = chosen.received[index]
    order = np.lexsort((index, time))
    if (np.diff(index[order]) < 0).any():
        notes.append("messages sorted by time; some were recorded out of order")
    columns: dict[str, NDArray[Any]] = {"time": time[order]}
    for signal in ("position", "velocity", "effort"):
        columns.update({name: values[order] for name, values in _signal(states, signal, source).items()})
    if (lists := len({s.names for s in states})) > 1:
        notes.append(f"messages list their joints in {lists} different ways; read by name")
    return Table(columns, time_unit="ns", notes=tuple(notes), format="ros2")


def _signal(states: list[JointStates], signal: str, source: str) -> dict[str, NDArray[np.float64]]:
    """Return the columns ``signal.joint`` by name; the order of joints may differ between messages."""
    values = [getattr(s, signal) for s in states]
    if not any(v.shape[1] for v in values):
        return {}
    for s, v in zip(states, values, strict=True):
        if v.shape[1] != len(s.names):
            raise LogError(
                f"{source}: a message names {len(s.names)} joints but holds {v.shape[1]} values of {signal}; "
                f"either all or none of the messages may leave {signal} out"
            )
    shared = [j for j in states[0].names if all(j in s.names for s in states)]
    picked = [v[:, [s.names.index(j) for j in shared]] for s, v in zip(states, values, strict=True)]
    return {
        f"{signal}.{joint}": column for joint, column in zip(shared, np.concatenate(picked).T, strict=True)
    }


def _received(bag: Any, path: Path, wanted: list[Any]) -> dict[str, mcap.Received]:
    """Return the messages of some connections of an open bag, by topic."""
    found: dict[str, mcap.Received] = {}
    files = storage_files(path)
    if files and all(file.suffix == ".mcap" for file in files):
        for file in files:
            for topic, more in mcap.messages(file, {c.topic for c in wanted}).items():
                known = found.setdefault(topic, mcap.Received([], []))
                known.times.extend(more.times)
                known.messages.extend(more.messages)
        return found
    for connection, time, message in bag.messages(wanted) if wanted else ():
        known = found.setdefault(connection.topic, mcap.Received([], []))
        known.times.append(time)
        known.messages.append(message)
    return found


def _require_bounded(path: Path) -> None:
    """Refuse MCAP files whose chunks become too large."""
    for file in storage_files(path):
        if file.suffix == ".mcap":
            require_bounded(mcap.contents(file), file.stat().st_size, file.name)


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
    with_effort = [t for t in measured if any(s.effort.size for s in t.states)] or measured
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

    _require_bounded(path)
    mend = "a recording that was cut off may be repaired with 'ros2 bag reindex' or 'mcap recover'"
    with decoding(lambda said: LogError(f"{source}: not readable as a ROS 2 bag ({said}); {mend}")):
        with mcap.bounded_decompression(), Reader(path) as bag:
            wanted = [c for c in bag.connections if c.msgtype == JOINT_STATE]
            others = [f"{c.topic} ({c.msgtype})" for c in bag.connections if c.msgtype != JOINT_STATE]
            received = _received(bag, path, wanted)
        topics = [
            _Topic(name, np.array(r.times, dtype=np.int64), joint_states(r.messages))
            for name, r in received.items()
        ]
    return topics, others
