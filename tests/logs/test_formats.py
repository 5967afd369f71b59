"""Recordings of UR's RTDE, libfranka and LeRobot are recognised, and what their numbers are is said."""

import numpy as np
import pytest
from pyarrow import parquet

from benchmarks.recordings import lerobot, libfranka, numbered, rtde, write
from cdia_pin.errors import LogError
from cdia_pin.logs import Log, check_log, read_log
from cdia_pin.logs.effort_origin import EffortOrigin
from cdia_pin.logs.formats import FORMATS, column_patterns
from cdia_pin.logs.torque_side import TorqueSide
from tests.made_logs import with_velocity

GAIN = 10.0  # [N·m/A]


@pytest.fixture(scope="module")
def of_ur5(ur5) -> Log:
    return with_velocity(ur5)


@pytest.fixture(scope="module")
def of_panda(panda) -> Log:
    return with_velocity(panda)


# ---------------------------------------------------------------- RTDE


@pytest.mark.parametrize("separator", [" ", ","])
def test_rtde_currents_become_torques_of_the_motors_side_with_gains(ur5, of_ur5, tmp_path, separator):
    columns = rtde(of_ur5, actual_current=of_ur5.effort / GAIN, target_moment=of_ur5.effort)
    path = write(tmp_path / "robot_data.csv", columns, separator)
    with pytest.raises(LogError, match=r"motor currents.*--gains gains\.json"):
        read_log(path, ur5)
    log = read_log(path, ur5, gains=dict.fromkeys(ur5.joints, GAIN))
    np.testing.assert_allclose(log.effort, of_ur5.effort)
    np.testing.assert_array_equal(log.position, of_ur5.position)
    np.testing.assert_array_equal(log.temperature, 30.0)
    assert log.torque_side is TorqueSide.MOTOR
    assert log.effort_origin is EffortOrigin.MEASURED
    assert any("rtde" in note for note in log.notes)


def test_rtde_torque_without_gravity_gets_the_urdfs_and_is_said_in_check(ur5, of_ur5, tmp_path):
    bare = of_ur5.effort - ur5.gravity(of_ur5.position)
    path = write(tmp_path / "x.csv", rtde(of_ur5, actual_current_as_torque=bare, target_moment=of_ur5.effort))
    log = read_log(path, ur5)
    np.testing.assert_allclose(log.effort, of_ur5.effort, atol=1e-9)
    assert log.effort_origin is EffortOrigin.COMPENSATED
    (kind,) = check_log(log, ur5).about("effort_kind")
    assert "payload cannot be judged" in kind.message
    as_recorded = read_log(path, ur5, convert="gravity=included")
    np.testing.assert_allclose(as_recorded.effort, bare)


def test_rtde_currents_with_gains_come_before_a_torque_without_gravity(ur5, of_ur5, tmp_path):
    columns = rtde(of_ur5, actual_current=of_ur5.effort / GAIN, actual_current_as_torque=of_ur5.effort)
    path = write(tmp_path / "x.csv", columns)
    with_gains = read_log(path, ur5, gains=dict.fromkeys(ur5.joints, GAIN))
    assert with_gains.effort_origin is EffortOrigin.MEASURED
    assert read_log(path, ur5).effort_origin is EffortOrigin.COMPENSATED


def test_a_commanded_torque_is_used_on_request_only_and_warned_of(ur5, of_ur5, tmp_path):
    path = write(tmp_path / "x.csv", rtde(of_ur5, target_moment=of_ur5.effort))
    with pytest.raises(LogError, match="actual_current"):
        read_log(path, ur5)
    log = read_log(path, ur5, columns="effort=target_moment_#")
    assert log.effort_origin is EffortOrigin.COMMANDED
    (kind,) = check_log(log, ur5).about("effort_kind")
    assert kind.severity == "warning"
    assert "not a measurement" in kind.message


# ---------------------------------------------------------------- libfranka


@pytest.mark.parametrize("prefix", ["state.", ""])
def test_libfranka_torque_is_of_the_link_side(panda, of_panda, tmp_path, prefix):
    columns = {name.replace("state.", prefix): x for name, x in libfranka(of_panda).items()}
    log = read_log(write(tmp_path / "log.csv", columns), panda)
    np.testing.assert_array_equal(log.effort, of_panda.effort)
    np.testing.assert_allclose(log.time, of_panda.time, atol=1e-12)
    assert log.torque_side is TorqueSide.LINK
    assert any("behind the gear" in note and "libfranka" in note for note in log.notes)
    (side,) = check_log(log, panda).about("torque_side")
    assert side.value["side"] == "link"
    assert read_log(tmp_path / "log.csv", panda, torque_side="motor").torque_side is TorqueSide.MOTOR


def test_libfranka_without_the_measured_torque_says_which_one_it_has(panda, of_panda, tmp_path):
    columns = {n: x for n, x in libfranka(of_panda).items() if "tau_J[" not in n}
    with pytest.raises(LogError, match="tau_J_d is the commanded one without gravity"):
        read_log(write(tmp_path / "log.csv", columns), panda)


# ---------------------------------------------------------------- LeRobot


@pytest.fixture
def dataset(ur5, of_ur5, tmp_path):
    names = [f"{j}.{s}" for s in ("pos", "vel", "torque") for j in ur5.joints]
    values = np.column_stack([np.degrees(of_ur5.position), np.degrees(of_ur5.velocity), of_ur5.effort])
    return lambda episodes=1: lerobot(tmp_path / "set", of_ur5, names, values, episodes=episodes)


def test_lerobot_asks_for_the_unit_of_its_angles(ur5, of_ur5, dataset):
    folder = dataset()
    with pytest.raises(LogError, match=r"--convert angle=deg or --convert angle=rad"):
        read_log(folder, ur5)
    log = read_log(folder, ur5, convert="angle=deg")
    np.testing.assert_allclose(log.position, of_ur5.position)
    np.testing.assert_allclose(log.velocity, of_ur5.velocity)
    np.testing.assert_allclose(log.effort, of_ur5.effort)
    file = folder / "data" / "chunk-000" / "file-000.parquet"
    np.testing.assert_array_equal(read_log(file, ur5, convert="angle=deg").effort, log.effort)


def test_lerobot_episodes_are_not_run_together(ur5, of_ur5, dataset):
    folder = dataset(3)
    with pytest.raises(LogError, match=r"3 episodes, 0 to 2; .*--episode N"):
        read_log(folder, ur5, convert="angle=deg")
    log = read_log(folder, ur5, convert="angle=deg", episode=2)
    assert len(log.time) == len(of_ur5.time)
    with pytest.raises(LogError, match="7 is none of them"):
        read_log(folder, ur5, convert="angle=deg", episode=7)


def test_lerobot_keeps_no_file_open(ur5, of_ur5, dataset, monkeypatch):
    opened = []
    usual = parquet.ParquetFile

    def noted(file):
        opened.append(usual(file))
        return opened[-1]

    monkeypatch.setattr(parquet, "ParquetFile", noted)
    read_log(dataset(2), ur5, convert="angle=deg", episode=1)
    assert len(opened) == 2 and all(file.closed for file in opened)


def test_lerobot_without_torques_says_what_is_needed(ur5, of_ur5, tmp_path):
    folder = lerobot(tmp_path / "set", of_ur5, [f"{j}.pos" for j in ur5.joints], of_ur5.position)
    with pytest.raises(LogError, match="positions and pictures only"):
        read_log(folder, ur5, convert="angle=rad")


@pytest.mark.parametrize("info", ["", "[]", '{"features": {}}', '{"features": {"observation.state": 3}}'])
def test_a_broken_description_of_a_dataset_is_refused(ur5, dataset, info):
    folder = dataset()
    (folder / "meta" / "info.json").write_text(info)
    with pytest.raises(LogError, match=r"info\.json"):
        read_log(folder, ur5)


def test_only_a_dataset_has_episodes(ur5, of_ur5, tmp_path):
    path = write(tmp_path / "x.csv", rtde(of_ur5, actual_current_as_torque=of_ur5.effort))
    with pytest.raises(LogError, match="--episode 1"):
        read_log(path, ur5, episode=1)


# ---------------------------------------------------------------- any format


def test_a_format_that_is_asked_for_must_fit_the_columns(ur5, of_ur5, tmp_path):
    path = write(tmp_path / "recording", rtde(of_ur5, actual_current_as_torque=of_ur5.effort))
    with pytest.raises(LogError, match="unknown log format"):
        read_log(path, ur5)
    assert read_log(path, ur5, format="rtde").torque_side is TorqueSide.MOTOR
    with pytest.raises(LogError, match=r"not of format 'libfranka'"):
        read_log(path, ur5, format="libfranka")
    with pytest.raises(LogError, match="did you mean rtde"):
        read_log(path, ur5, format="rtd")


def test_a_dataset_is_not_read_as_another_format(ur5, dataset):
    with pytest.raises(LogError, match="not a ROS 2 bag"):
        read_log(dataset(), ur5, format="rtde")


@pytest.mark.parametrize(("value", "said"), [(0.0, "zero throughout"), (np.nan, "NaN throughout")])
def test_efforts_that_nobody_measured_are_refused(ur5, of_ur5, tmp_path, value, said):
    columns = {"time": of_ur5.time, **numbered("q", of_ur5.position)}
    columns |= numbered("tau", np.full_like(of_ur5.effort, value))
    with pytest.raises(LogError, match=said):
        read_log(write(tmp_path / "x.csv", columns), ur5)


def test_columns_of_other_names_are_named_by_patterns(ur5, of_ur5, tmp_path):
    columns = {"clock": of_ur5.time, **numbered("J", of_ur5.position, "{}{} angle")}
    columns |= {f"M/{joint}": of_ur5.effort[:, k] for k, joint in enumerate(ur5.joints)}
    path = write(tmp_path / "x.csv", columns)
    log = read_log(path, ur5, columns=["position=J# angle,effort=M/*", "time=clock"])
    np.testing.assert_array_equal(log.position, of_ur5.position)
    np.testing.assert_array_equal(log.effort, of_ur5.effort)
    with pytest.raises(LogError, match=r"effort=moment_# matches no column"):
        read_log(path, ur5, columns={"effort": "moment_#"})


@pytest.mark.parametrize(
    ("given", "said"),
    [("effort", "signal=pattern"), ("efort=tau_#", "did you mean effort"), ("effort=tau_1", "effort=tau_#")],
)
def test_a_pattern_that_cannot_be_understood_is_refused(given, said):
    with pytest.raises(LogError, match=said):
        column_patterns(given)


@pytest.mark.parametrize("name", FORMATS)
def test_a_format_is_recognised_by_what_no_other_has(name):
    others = [f for f in FORMATS.values() if f.name != name]
    columns = [mark.replace("#", "0") for mark in FORMATS[name].marks]
    assert not any(other.marked(columns) for other in others)
