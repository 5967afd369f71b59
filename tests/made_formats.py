"""Recordings in the formats that people have, made from a log."""

import json
from dataclasses import replace

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from cdia_pin.logs import Log
from tests.made_logs import make


def numbered(stem: str, values: np.ndarray, form: str = "{}_{}") -> dict[str, np.ndarray]:
    return {form.format(stem, k): values[:, k] for k in range(values.shape[1])}


def write(path, columns: dict[str, np.ndarray], separator: str = ","):
    rows = np.column_stack(list(columns.values()))
    lines = [separator.join(columns), *(separator.join(map(repr, row)) for row in rows.tolist())]
    path.write_text("\n".join(lines) + "\n")
    return path


def with_velocity(robot) -> Log:
    made = make(robot, duration=8.0, noise=0.2)
    return replace(made.log, velocity=made.v)


def rtde(log: Log, **torques: np.ndarray) -> dict[str, np.ndarray]:
    """A recording as UR's record.py writes it, its time counted from the start of the controller."""
    n = len(log.joints)
    return {
        "timestamp": 3000.0 + log.time,
        **numbered("target_q", log.position + 0.01),
        **numbered("actual_q", log.position),
        **numbered("actual_qd", log.velocity),
        **{name: x for stem, values in torques.items() for name, x in numbered(stem, values).items()},
        **numbered("joint_temperatures", np.full((len(log.time), n), 30.0)),
        **numbered("actual_TCP_pose", log.position),
        "robot_mode": np.full(len(log.time), 7),
    }


def libfranka(log: Log) -> dict[str, np.ndarray]:
    """A recording as franka::logToCSV writes it: time in ms, and states before commands."""
    form = "state.{}[{}]"
    return {
        "time": np.round(1e3 * log.time),
        "success_rate": np.ones(len(log.time)),
        **numbered("q", log.position, form),
        **numbered("q_d", log.position + 0.01, form),
        **numbered("dq", log.velocity, form),
        **numbered("dq_d", log.velocity, form),
        **numbered("tau_J", log.effort, form),
        **numbered("tau_ext_hat_filtered", 0.1 * log.effort, form),
        **numbered("tau_J_d", 0.2 * log.effort, "cmd.{}[{}]"),
    }


def lerobot(folder, log: Log, names: list[str], values: np.ndarray, *, episodes: int = 1, extra=None):
    """A dataset in the layout of version 3: several episodes in one Parquet file, names in meta/info.json."""
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
    info = {"codebase_version": "v3.0", "fps": 100, "features": features}
    (folder / "meta" / "info.json").write_text(json.dumps(info))
    parquet.write_table(pa.table(table), folder / "data" / "chunk-000" / "file-000.parquet")
    return folder
