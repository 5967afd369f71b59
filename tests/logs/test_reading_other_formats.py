"""Parquet, npz and ROS 2 bags hold the same log; what is damaged is refused."""

import subprocess
import sys

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from cdia_pin.errors import LogError
from cdia_pin.logs import Log, read_log, write_log

STORE = get_typestore(Stores.ROS2_HUMBLE)
JOINT_STATE = "sensor_msgs/msg/JointState"


@pytest.fixture(scope="module")
def small(ur5):
    rng = np.random.default_rng(0)
    signals = rng.normal(size=(3, 60, ur5.n))
    return Log(ur5.joints, 2.0 + np.arange(60) * 0.01, signals[0], signals[1], signals[2])


def agree(a: Log, b: Log, tolerance: float = 1e-9) -> None:
    for signal in ("time", "position", "velocity", "effort"):
        np.testing.assert_allclose(getattr(a, signal), getattr(b, signal), atol=tolerance)


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".npz"])
@pytest.mark.parametrize("with_velocity", [True, False])
def test_writing_and_reading_is_exact(ur5, small, tmp_path, suffix, with_velocity):
    log = small if with_velocity else Log(small.joints, small.time, small.position, small.effort)
    again = read_log(write_log(log, tmp_path / f"x{suffix}"), ur5)
    np.testing.assert_array_equal(again.position, log.position)
    np.testing.assert_array_equal(again.effort, log.effort)
    np.testing.assert_array_equal(again.time, log.time)
    assert (again.velocity is None) == (not with_velocity)


def test_writing_to_an_unknown_format_or_place_raises_a_log_error(small, tmp_path):
    with pytest.raises(LogError, match=r"\.csv, \.parquet, \.npz"):
        write_log(small, tmp_path / "x.mat")
    with pytest.raises(LogError, match="cannot be written"):
        write_log(small, tmp_path / "nowhere" / "x.csv")


def test_parquet_with_dates_is_read_from_its_first_sample(ur5, small, tmp_path):
    columns = {f"q_{k + 1}": small.position[:, k] for k in range(ur5.n)}
    columns |= {f"tau_{k + 1}": small.effort[:, k] for k in range(ur5.n)}
    stamps = 1_700_000_000_000_000_000 + (np.arange(60) * 10_000_000)
    columns["timestamp"] = pa.array(stamps, pa.timestamp("ns"))
    parquet.write_table(pa.table(columns), tmp_path / "x.parquet")
    log = read_log(tmp_path / "x.parquet", ur5)
    np.testing.assert_allclose(log.time, np.arange(60) * 0.01, atol=1e-12)
    np.testing.assert_array_equal(log.position, small.position)


def test_npz_may_hold_arrays_with_or_without_joint_names(ur5, small, tmp_path):
    back = np.arange(ur5.n)[::-1]
    named = {"joints": np.array(ur5.joints)[back], "q": small.position[:, back], "tau": small.effort[:, back]}
    np.savez(tmp_path / "named.npz", time=small.time, dq=small.velocity[:, back], **named)
    agree(read_log(tmp_path / "named.npz", ur5), small)
    np.savez(tmp_path / "bare.npz", t=small.time, position=small.position, effort=small.effort)
    bare = read_log(tmp_path / "bare.npz", ur5)
    np.testing.assert_array_equal(bare.effort, small.effort)
    assert any("numbered" in note for note in bare.notes)


def test_npz_may_hold_what_was_commanded_beside_what_was_measured(ur5, small, tmp_path):
    both = {"tau_measured": small.effort, "tau_command": 2 * small.effort, "q_cmd": 0 * small.position}
    np.savez(tmp_path / "x.npz", time=small.time, q=small.position, **both)
    log = read_log(tmp_path / "x.npz", ur5)
    np.testing.assert_array_equal(log.position, small.position)
    np.testing.assert_array_equal(log.effort, small.effort)


def test_npz_never_unpickles(ur5, tmp_path):
    np.savez(tmp_path / "x.npz", time=np.array([{"a": 1}], dtype=object))
    with pytest.raises(LogError, match="npz"):
        read_log(tmp_path / "x.npz", ur5)


@pytest.mark.parametrize(
    ("arrays", "said"),
    [
        ({"position": np.zeros((6, 9))}, "no effort columns|expected|lengths"),
        ({"joints": np.array(["a", "b"]), "position": np.zeros((9, 6))}, "expected \\(N, 2\\)"),
        ({"position": np.zeros((9, 6)), "effort": np.zeros((8, 6))}, "different lengths"),
    ],
)
def test_npz_of_the_wrong_shape_is_refused_with_the_shape(ur5, tmp_path, arrays, said):
    np.savez(tmp_path / "x.npz", time=np.arange(9.0), **arrays)
    with pytest.raises(LogError, match=said):
        read_log(tmp_path / "x.npz", ur5)


@pytest.mark.parametrize("suffix", [".parquet", ".npz", ".db3", ".mcap"])
@pytest.mark.parametrize("content", [b"", b"nonsense " * 50])
def test_garbage_is_refused_with_any_suffix(ur5, tmp_path, suffix, content):
    path = tmp_path / f"x{suffix}"
    path.write_bytes(content)
    with pytest.raises(LogError, match=r"x\."):
        read_log(path, ur5)


# ---------------------------------------------------------------- ROS 2 bags


def joint_state(names, position, velocity, effort, stamp):
    types = STORE.types
    time = types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
    header = types["std_msgs/msg/Header"](stamp=time, frame_id="")
    as_array = lambda x: np.asarray(x, dtype=np.float64)  # noqa: E731
    return types[JOINT_STATE](header, list(names), as_array(position), as_array(velocity), as_array(effort))


def write_bag(path, topics, plugin=StoragePlugin.SQLITE3):
    """Write {topic: [(received ns, message)]} as a bag directory."""
    with Writer(path, version=9, storage_plugin=plugin) as bag:
        for topic, messages in topics.items():
            connection = bag.add_connection(topic, JOINT_STATE, typestore=STORE)
            for received, message in messages:
                bag.write(connection, received, STORE.serialize_cdr(message, JOINT_STATE))
    return path


def messages_of(log, *, stamped=True, velocity=True, prefix="", shuffle=False):
    out = []
    for k, t in enumerate(log.time):
        order = (
            np.random.default_rng(k).permutation(len(log.joints)) if shuffle else np.arange(len(log.joints))
        )
        names = [prefix + log.joints[i] for i in order]
        speed = log.velocity[k, order] if velocity else []
        stamp = round(t * 1e9)
        message = joint_state(
            names, log.position[k, order], speed, log.effort[k, order], stamp if stamped else 0
        )
        out.append((stamp + 500, message))
    return out


@pytest.mark.parametrize("plugin", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_a_bag_is_read_as_a_directory_and_as_its_file(ur5, small, tmp_path, plugin):
    bag = write_bag(tmp_path / "bag", {"/joint_states": messages_of(small)}, plugin)
    agree(read_log(bag, ur5), small)
    file = next(p for p in bag.iterdir() if p.suffix in {".db3", ".mcap"})
    alone = read_log(file, ur5)
    agree(alone, small)
    assert len(alone.sha256) == 64


def test_messages_may_list_joints_in_another_order_each_time(ur5, small, tmp_path):
    bag = write_bag(tmp_path / "bag", {"/joint_states": messages_of(small, shuffle=True)})
    log = read_log(bag, ur5)
    agree(log, small)
    assert any("different ways" in note for note in log.notes)


def test_without_header_stamps_the_time_of_reception_is_used_and_noted(ur5, small, tmp_path):
    log = read_log(write_bag(tmp_path / "bag", {"/joint_states": messages_of(small, stamped=False)}), ur5)
    np.testing.assert_allclose(log.time, small.time + 500e-9, atol=1e-12)
    assert any("reception" in note for note in log.notes)


def test_the_topic_with_the_robots_joints_is_found_among_others(ur5, small, tmp_path):
    gripper = [(t, joint_state(["finger"], [0.0], [0.0], [0.0], t)) for t, _ in messages_of(small)]
    topics = {"/gripper/joint_states": gripper, "/joint_states": messages_of(small)}
    topics["/joint_commands"] = messages_of(small)
    log = read_log(write_bag(tmp_path / "bag", topics), ur5)
    agree(log, small)
    assert any("/joint_states" in note for note in log.notes)


def test_messages_of_a_gripper_on_the_same_topic_are_left_out(ur5, small, tmp_path):
    both = messages_of(small)
    both += [(t + 1, joint_state(["finger"], [0.0], [0.0], [0.0], t + 1)) for t, _ in messages_of(small)]
    log = read_log(write_bag(tmp_path / "bag", {"/joint_states": sorted(both, key=lambda m: m[0])}), ur5)
    agree(log, small)
    assert any("left out" in note for note in log.notes)


def test_two_topics_with_the_robots_joints_need_a_choice(ur5, small, tmp_path):
    bag = write_bag(tmp_path / "bag", {"/a": messages_of(small), "/b": messages_of(small)})
    with pytest.raises(LogError, match=r"/a, /b; choose one with --topic"):
        read_log(bag, ur5)
    agree(read_log(bag, ur5, topic="/b"), small)


def test_a_bag_without_the_robots_joints_lists_what_it_has(ur5, panda, small, tmp_path):
    bag = write_bag(tmp_path / "bag", {"/joint_states": messages_of(small)})
    with pytest.raises(LogError, match=r"/joint_states has shoulder_pan_joint"):
        read_log(bag, panda)


def test_prefixes_and_joint_maps_work_in_bags_too(ur5, small, tmp_path):
    bag = write_bag(tmp_path / "bag", {"/joint_states": messages_of(small, prefix="left_")})
    agree(read_log(bag, ur5), small)
    renames = {f"left_{j}": j for j in ur5.joints}
    agree(read_log(bag, ur5, joint_map=renames), small)


def test_empty_velocities_are_missing_and_empty_efforts_are_an_error(ur5, small, tmp_path):
    silent = read_log(write_bag(tmp_path / "a", {"/joint_states": messages_of(small, velocity=False)}), ur5)
    assert silent.velocity is None
    no_effort = [(t, joint_state(m.name, m.position, [], [], t)) for t, m in messages_of(small)]
    with pytest.raises(LogError, match="no effort columns"):
        read_log(write_bag(tmp_path / "b", {"/joint_states": no_effort}), ur5)


def test_velocities_that_are_nan_throughout_count_as_missing(ur5, small, tmp_path):
    nan = np.full(ur5.n, np.nan)
    messages = [(t, joint_state(m.name, m.position, nan, m.effort, t)) for t, m in messages_of(small)]
    log = read_log(write_bag(tmp_path / "bag", {"/joint_states": messages}), ur5)
    assert log.velocity is None
    assert any("NaN throughout" in note for note in log.notes)


def test_the_error_of_a_cut_off_bag_names_the_repair(ur5, small, tmp_path):
    bag = write_bag(tmp_path / "bag", {"/joint_states": messages_of(small)}, StoragePlugin.MCAP)
    file = next(bag.glob("*.mcap"))
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    with pytest.raises(LogError, match="mcap recover"):
        read_log(cut, ur5)


def test_a_directory_that_is_not_a_bag_is_refused(ur5, tmp_path):
    with pytest.raises(LogError, match="not a ROS 2 bag"):
        read_log(tmp_path, ur5)


def test_importing_logs_does_not_import_the_heavy_parts():
    code = (
        "import sys, cdia_pin.logs; "
        "heavy = {'pyarrow', 'rosbags', 'mcap', 'scipy', 'pinocchio'} & set(sys.modules); "
        "sys.exit(', '.join(heavy) or 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
