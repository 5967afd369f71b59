"""Recordings in the formats that people have, written from a log."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import parquet
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from cdia_pin import Log
from cdia_pin.whole_files import whole_file, write_whole

Array = NDArray[np.float64]
Columns = dict[str, NDArray[Any]]

STARTED = 3000.0  # [s], times of a UR count from the start of its controller
WARM = 30.0  # [°C]
JOINT_STATE = "sensor_msgs/msg/JointState"


def numbered(stem: str, values: Array, form: str = "{}_{}") -> Columns:
    """Return a column for each joint, by a name with the joint's number."""
    return {form.format(stem, k): values[:, k] for k in range(values.shape[1])}


def write(path: Path, columns: Mapping[str, NDArray[Any]], separator: str = ",") -> Path:
    """Write columns of one length as text, with every digit."""
    rows = np.column_stack(list(columns.values()))
    lines = [separator.join(columns), *(separator.join(map(repr, row)) for row in rows.tolist())]
    return write_whole(path, "\n".join(lines) + "\n")


def rtde(log: Log, **torques: Array) -> Columns:
    """Return a recording as UR's record.py writes it, its time counted from the start of the controller."""
    n = len(log.joints)
    return {
        "timestamp": STARTED + log.time,
        **numbered("target_q", log.position + 0.01),
        **numbered("actual_q", log.position),
        **numbered("actual_qd", velocity_of(log)),
        **{name: x for stem, values in torques.items() for name, x in numbered(stem, values).items()},
        **numbered("joint_temperatures", np.full((len(log.time), n), WARM)),
        **numbered("actual_TCP_pose", log.position),
        "robot_mode": np.full(len(log.time), 7),
    }


def libfranka(log: Log) -> Columns:
    """Return a recording as franka::logToCSV writes it: time in ms, and states before commands."""
    form = "state.{}[{}]"
    return {
        "time": np.round(1e3 * log.time),
        "success_rate": np.ones(len(log.time)),
        **numbered("q", log.position, form),
        **numbered("q_d", log.position + 0.01, form),
        **numbered("dq", velocity_of(log), form),
        **numbered("dq_d", velocity_of(log), form),
        **numbered("tau_J", log.effort, form),
        **numbered("tau_ext_hat_filtered", 0.1 * log.effort, form),
        **numbered("tau_J_d", 0.2 * log.effort, "cmd.{}[{}]"),
    }


def ros2(folder: Path, log: Log) -> Path:
    """Write an MCAP bag of /joint_states whose messages sort the joints by the alphabet, beside a gripper."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    order = np.argsort(log.joints)
    names = [*(log.joints[k] for k in order), "gripper_joint"]
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as bag:
        topic = bag.add_connection("/joint_states", JOINT_STATE, typestore=store)
        for k, stamp in enumerate(np.round(1e9 * log.time).astype(int).tolist()):
            time = types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
            header = types["std_msgs/msg/Header"](stamp=time, frame_id="")
            signals = (np.append(s[k, order], 0.0) for s in (log.position, velocity_of(log), log.effort))
            message = types[JOINT_STATE](header, names, *signals)
            bag.write(topic, stamp, store.serialize_cdr(message, JOINT_STATE))
    return folder


def lerobot(
    folder: Path,
    log: Log,
    names: list[str],
    values: Array,
    *,
    episodes: int = 1,
    extra: Mapping[str, object] | None = None,
) -> Path:
    """Write a dataset of version 3: several episodes in one Parquet file, names in meta/info.json.

    Args:
        folder: Of the dataset.
        log: Whose times are written.
        names: Names of the numbers of ``observation.state``.
        values: Those numbers in each episode, shape (N, k).
        episodes: How often they are written.
        extra: More features of the dataset.
    """
    count = len(log.time)
    index = np.repeat(np.arange(episodes), count)
    features = {
        "observation.state": {"dtype": "float32", "shape": [len(names)], "names": names},
        **(extra or {}),
    }
    table = {
        "observation.state": pa.array(np.tile(values, (episodes, 1)).tolist(), pa.list_(pa.float64())),
        "action": pa.array(np.tile(values, (episodes, 1)).tolist(), pa.list_(pa.float64())),
        "timestamp": np.tile(log.time, episodes),
        "frame_index": np.tile(np.arange(count), episodes),
        "episode_index": index,
    }
    (folder / "meta").mkdir(parents=True)
    (folder / "data" / "chunk-000").mkdir(parents=True)
    info = {"codebase_version": "v3.0", "fps": round(log.rate), "features": features}
    write_whole(folder / "meta" / "info.json", json.dumps(info))
    with whole_file(folder / "data" / "chunk-000" / "file-000.parquet") as file:
        parquet.write_table(pa.table(table), file)
    return folder


def velocity_of(log: Log) -> Array:
    """Return the velocities of a log that has some, shape (N, n)."""
    assert log.velocity is not None
    return log.velocity
