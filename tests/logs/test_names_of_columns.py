"""Column names as people write them become signals of joints."""

import pytest

from cdia_pin.errors import LogError
from cdia_pin.logs import read_log
from cdia_pin.logs.columns import signal_of, sort_names
from cdia_pin.logs.joint_names import joint_map_of, match_joints
from cdia_pin.robot import load_robot
from tests.one_joint import write_urdf

JOINTS = ("shoulder_pan_joint", "elbow_joint", "wrist_1_joint")


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("position.elbow_joint", ("position", "elbow_joint")),
        ("position/elbow_joint", ("position", "elbow_joint")),
        ("position_elbow_joint", ("position", "elbow_joint")),
        ("Velocity.elbow_joint", ("velocity", "elbow_joint")),
        ("q_1", ("position", "1")),
        ("q1", ("position", "1")),
        ("q.0", ("position", "0")),
        ("q[3]", ("position", "3")),
        ("dq_1", ("velocity", "1")),
        ("qd1", ("velocity", "1")),
        ("q_dot_2", ("velocity", "2")),
        ("tau_elbow_joint", ("effort", "elbow_joint")),
        ("torque1", ("effort", "1")),
        ("current.elbow_joint", ("current", "elbow_joint")),
        ("actual_q_0", ("position", "0")),
        ("actual_qd_0", ("velocity", "0")),
        ("actual_current_5", ("current", "5")),
        ("/joint_states/elbow_joint/position", ("position", "joint_states/elbow_joint")),
        ("elbow_joint_torque", ("effort", "elbow_joint")),
        ("temperature.elbow_joint", ("temperature", "elbow_joint")),
        ("motor_temperature_3", ("temperature", "3")),
        ("tau_measured_3", ("effort", "3")),
        ("joint_1_torque_measured", ("effort", "joint_1")),
        ("tau_command_3", ("effort", "command_3")),
        ("state", None),
        ("target_q_0", None),
    ],
)
def test_a_column_name_gives_signal_and_joint(name, expected):
    assert signal_of(name) == expected


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("time", None),
        ("t", None),
        ("Timestamp", None),
        ("time_ns", "ns"),
        ("time [ms]", "ms"),
        ("t_us", "us"),
    ],
)
def test_times_are_recognised_with_the_unit_in_their_name(name, unit):
    assert sort_names([name]).time == {name: unit}


def test_the_column_called_time_is_preferred():
    assert sort_names(["timestamp", "time"]).time_column == "time"


def test_joints_are_found_by_name_in_any_order():
    assert (
        match_joints(["wrist_1_joint", "elbow_joint", "gripper", "shoulder_pan_joint"], JOINTS).labels
        == JOINTS
    )


def test_one_common_prefix_is_removed_and_noted():
    found = match_joints([f"left_{j}" for j in JOINTS], JOINTS)
    assert found.labels == tuple(f"left_{j}" for j in JOINTS)
    assert "left_elbow_joint → elbow_joint" in found.note


def test_a_prefix_that_only_the_robot_has_is_added():
    found = match_joints(["joint1", "joint2"], ("panda_joint1", "panda_joint2"))
    assert found.labels == ("joint1", "joint2")


@pytest.mark.parametrize(
    ("names", "joints"),
    [
        (("shoulder_pan", "elbow", "wrist_1"), JOINTS),  # which all end with _joint
        (("hip.deg", "knee.deg"), ("hip", "knee")),
        (("motor",), ("only",)),
    ],
)
def test_one_common_end_may_be_missing_or_more_and_an_only_label_is_the_only_joint(names, joints):
    found = match_joints([*names, *(f"{joint}_target" for joint in joints if len(joints) > 1)], joints)
    assert found.labels == names
    assert f"{names[0]} → {joints[0]}" in found.note


def test_two_arms_in_one_log_need_a_joint_map():
    both = [f"{side}_{j}" for side in ("left", "right") for j in JOINTS]
    with pytest.raises(LogError, match=r"left_shoulder_pan_joint.*--joint-map"):
        match_joints(both, JOINTS)


def test_commanded_signals_are_not_read_as_measured_ones():
    names = [f"{p}{j}" for p in ("meas_", "desired_") for j in JOINTS]
    assert match_joints(names, JOINTS).labels == tuple(f"meas_{j}" for j in JOINTS)


@pytest.mark.parametrize("names", [["1", "2", "3"], ["0", "1", "2"], ["joint_3", "joint_2", "joint_1"]])
def test_numbered_joints_are_taken_in_the_robots_order_with_a_note(names):
    found = match_joints(names, JOINTS)
    assert found.labels == tuple(sorted(names))
    assert "numbered" in found.note


@pytest.mark.parametrize(
    "names", [["1", "2"], ["1", "2", "4"], ["2", "3", "4"], ["motor1", "motor2", "motor3"]]
)
def test_numbers_that_do_not_count_the_joints_are_refused(names):
    with pytest.raises(LogError, match="no column for joint"):
        match_joints(names, JOINTS)


def test_a_joint_map_renames_some_and_leaves_the_rest():
    names = ["base", "elbow_joint", "wrist_1_joint"]
    found = match_joints(names, JOINTS, {"base": "shoulder_pan_joint"})
    assert found.labels == ("base", "elbow_joint", "wrist_1_joint")


def test_a_joint_map_may_exchange_two_joints():
    swap = {"elbow_joint": "wrist_1_joint", "wrist_1_joint": "elbow_joint"}
    assert match_joints(JOINTS, JOINTS, swap).labels == ("shoulder_pan_joint", "wrist_1_joint", "elbow_joint")


def test_a_joint_map_may_be_written_on_the_command_line():
    assert joint_map_of(["a=b,c=d", "e=f"]) == {"a": "b", "c": "d", "e": "f"}
    with pytest.raises(LogError, match="name=joint"):
        joint_map_of("a:b")


@pytest.mark.parametrize("header", ["time,position,velocity,torque", "t,q,dq,tau", "stamp,pos,vel,eff"])
def test_columns_of_an_only_joint_need_not_name_it(tmp_path, header):
    robot = load_robot(str(write_urdf("continuous", tmp_path)))
    path = tmp_path / "bare.csv"
    path.write_text(header + "\n" + "".join(f"{0.01 * k},{0.1 * k},10.0,{k}.5\n" for k in range(20)))
    log = read_log(path, robot)
    assert log.velocity is not None
    assert (log.position[2, 0], log.effort[2, 0]) == (pytest.approx(0.2), 2.5)
    assert any("the only joint, only" in note for note in log.notes)


def test_columns_that_name_the_only_joint_come_first(tmp_path):
    robot = load_robot(str(write_urdf("continuous", tmp_path)))
    path = tmp_path / "both.csv"
    rows = "".join(f"{0.01 * k},{0.1 * k},7,{k}.5\n" for k in range(20))
    path.write_text("time,position.only,position,effort.only\n" + rows)
    log = read_log(path, robot)
    assert log.position[2, 0] == pytest.approx(0.2)
    assert not any("the only joint" in note for note in log.notes)


def test_columns_of_several_joints_must_name_them(tmp_path):
    path = tmp_path / "bare.csv"
    path.write_text("time,position,torque\n0,1,2\n0.1,1,2\n0.2,1,2\n")
    with pytest.raises(LogError, match="no position columns"):
        read_log(path, load_robot("double_pendulum"))
