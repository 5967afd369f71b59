"""Columns of unknown names: each gets a guess, and what to type makes the log readable."""

import shlex

import numpy as np
import pytest

from benchmarks.recordings import numbered, write
from cdia_pin.logs import read_log
from cdia_pin.logs.formats.guess import guess_columns, reading_of
from cdia_pin.logs.missing_columns import MissingColumnsError
from cdia_pin.robot import load_robot
from tests.made_logs import with_velocity
from tests.one_joint import write_urdf


@pytest.fixture(scope="module")
def made(ur5):
    return with_velocity(ur5)


def named(stem: str, values: np.ndarray) -> dict[str, np.ndarray]:
    parts = ("base", "shoulder", "elbow", "wrist_a", "wrist_b", "wrist_c")
    return {f"{stem}:{part}.x": values[:, k] for k, part in enumerate(parts)}


@pytest.mark.parametrize(
    "columns",
    [
        lambda log: {
            "sample": np.arange(len(log.time)) * 10.0,
            **numbered("J", np.degrees(log.position), "{}{} ang"),
            **numbered("J", np.degrees(log.velocity), "{}{} spd"),
            **numbered("J", log.effort, "{}{} mom"),
        },
        lambda log: {  # no word tells, sizes and derivatives do
            "zeit": log.time,
            **numbered("b", log.velocity),
            **numbered("a", log.position),
            **numbered("c", log.effort),
            **numbered("d", np.round(31.0 + 0.3 * log.time[:, None] + np.arange(6.0), 1)),  # a temperature
        },
        lambda log: {
            "zeit": log.time,
            **numbered("u", log.position, "{}.{}"),
            **numbered("w", log.effort, "{}.{}"),
        },
    ],
)
def test_what_the_message_says_to_type_reads_the_log(ur5, made, tmp_path, columns):
    path = write(tmp_path / "x.csv", columns(made))
    with pytest.raises(MissingColumnsError) as caught:
        read_log(path, ur5)
    options = reading_of(caught.value.guesses, ur5)
    assert f"--columns {shlex.quote(options['columns'])}" in str(caught.value)
    log = read_log(path, ur5, **{name: [value] for name, value in options.items()})
    np.testing.assert_allclose(log.position, made.position, rtol=1e-9)
    np.testing.assert_allclose(log.effort, made.effort, rtol=1e-9)


def test_parts_of_another_name_are_mapped_in_the_order_of_the_file(ur5, made, tmp_path):
    columns = {"zeit": made.time}
    for stem, values in (("pos", made.position), ("moment", made.effort)):
        columns |= {f"{stem}/{part}": values[:, k] for k, part in enumerate("ABCDEF")}
    path = write(tmp_path / "x.csv", columns)
    with pytest.raises(MissingColumnsError, match="--joint-map A=shoulder_pan_joint,B=") as caught:
        read_log(path, ur5)
    options = reading_of(caught.value.guesses, ur5)
    log = read_log(path, ur5, **{name: [value] for name, value in options.items()})
    np.testing.assert_array_equal(log.effort, made.effort)


def test_a_current_is_told_by_its_size_and_asks_for_gains(ur5, made, tmp_path):
    columns = {"zeit": made.time, **numbered("a", made.position), **numbered("b", made.velocity)}
    path = write(tmp_path / "x.csv", columns | numbered("c", made.effort / 100.0))
    with pytest.raises(MissingColumnsError, match=r"current=c_#' --gains gains\.json"):
        read_log(path, ur5)


@pytest.mark.parametrize(
    ("name", "factor", "unit"),
    [
        ("Axis{1} Current [mA]", 1000.0, "mA"),
        ("i{1}_mA", 1000.0, "mA"),
        ("A{1} torque (mN.m)", 1000.0, "Nmm"),
    ],
)
def test_a_unit_in_the_name_is_converted(ur5, made, tmp_path, name, factor, unit):
    columns = {"Time": made.time, **numbered("", np.degrees(made.position), "Axis{1} Pos [deg]")}
    path = write(tmp_path / "x.csv", columns | numbered("", factor * made.effort, name))
    with pytest.raises(MissingColumnsError, match=f"--convert angle=deg,torque={unit}") as caught:
        read_log(path, ur5)
    assert ("--gains" in str(caught.value)) == (unit == "mA")
    gains = dict.fromkeys(ur5.joints, 1.0) if unit == "mA" else None
    log = read_log(path, ur5, gains=gains, **reading_of(caught.value.guesses, ur5))
    np.testing.assert_allclose(log.effort, made.effort, rtol=1e-9)
    assert any("converted from mA to A" in note for note in log.notes) == (unit == "mA")


@pytest.mark.parametrize("name", ["gamma_{1}", "current_{1}", "torque_Nm_{1}", "tau_{1} [A]"])
def test_a_unit_is_no_part_of_a_word(ur5, made, tmp_path, name):
    columns = {"zeit": made.time, **numbered("", made.position, "winkel_{1}")}
    path = write(tmp_path / "x.csv", columns | numbered("", made.effort, name))
    with pytest.raises(MissingColumnsError) as caught:
        read_log(path, ur5)
    assert "torque=" not in str(caught.value)


def test_what_is_known_is_not_guessed_again(ur5, made, tmp_path):
    columns = {
        "time": made.time,
        **numbered("pos_joint", made.position),
        **numbered("cur_joint", made.effort),
    }
    path = write(tmp_path / "x.csv", columns)
    with pytest.raises(MissingColumnsError, match=r"type --columns 'current=cur_joint_#' --gains") as caught:
        read_log(path, ur5)
    log = read_log(path, ur5, gains=dict.fromkeys(ur5.joints, 2.0), **reading_of(caught.value.guesses, ur5))
    np.testing.assert_array_equal(log.effort, 2.0 * made.effort)


def test_other_columns_that_may_be_torques_are_noted_until_one_is_chosen(ur5, made, tmp_path):
    columns = {"time": made.time, **numbered("q", made.position), **numbered("tau", made.effort)}
    path = write(
        tmp_path / "x.csv", columns | numbered("TorqueSm", made.effort) | numbered("tau_ref", made.effort)
    )
    (note,) = (n for n in read_log(path, ur5).notes if "may be torques too" in n)
    assert "'tau_0'" in note and "TorqueSm_#" in note and "tau_ref" not in note
    chosen = read_log(path, ur5, columns="effort=TorqueSm_#")
    assert not any("may be torques" in n for n in chosen.notes)


def test_a_command_that_follows_the_positions_is_not_taken_for_a_torque(ur5, made, tmp_path):
    columns = {"zeit": made.time, **numbered("a", made.position), **numbered("b", made.velocity)}
    columns |= numbered("c", made.position + 1e-3)
    with pytest.raises(MissingColumnsError) as caught:
        read_log(write(tmp_path / "x.csv", columns), ur5)
    assert "effort" not in {g.signal for g in caught.value.guesses}
    assert "commanded?" in str(caught.value)


def test_columns_in_no_group_of_joints_are_listed(ur5, made, tmp_path):
    path = write(tmp_path / "x.csv", {"zeit": -made.time, "angle": made.position[:, 0]})
    with pytest.raises(MissingColumnsError, match="found zeit, angle"):
        read_log(path, ur5)


def test_a_velocity_in_another_unit_is_left_out(ur5, made, tmp_path):
    columns = {"zeit": made.time, **numbered("a", np.degrees(made.position)), **numbered("c", made.effort)}
    rpm = np.degrees(made.velocity) / 6.0
    with pytest.raises(MissingColumnsError, match=r"velocity in another unit\?") as caught:
        read_log(write(tmp_path / "x.csv", columns | numbered("b", rpm)), ur5)
    assert "velocity" not in reading_of(caught.value.guesses, ur5)["columns"]


@pytest.mark.parametrize("rows", [1, 2])
def test_of_very_few_samples_nothing_is_guessed(ur5, made, tmp_path, rows):
    columns = {"zeit": made.time[:rows], **numbered("a", made.position[:rows])}
    with pytest.raises(MissingColumnsError) as caught:
        read_log(write(tmp_path / "x.csv", columns), ur5)
    assert caught.value.guesses == []


def test_the_times_of_an_arm_of_one_joint_are_no_torque(tmp_path):
    robot = load_robot(write_urdf("revolute", tmp_path))
    t = np.arange(0.0, 6.0, 0.01)
    q = np.sin(2.0 * t)
    effort = np.array(
        [robot.inverse_dynamics(*x) for x in zip(q[:, None], 0 * q[:, None], 0 * q[:, None], strict=True)]
    )
    guesses = guess_columns({"zeit_s": t, "motor_angle": q, "motor_torque": effort[:, 0]}, robot)
    assert [(g.pattern, g.signal) for g in guesses] == [
        ("zeit_s", "time"),
        ("motor_angle", "position"),
        ("motor_torque", "effort"),
    ]


@pytest.mark.parametrize(
    "names",
    [
        ("zeit", "winkel", "moment"),
        ("zeit", "motor_angle", "motor_torque"),  # the torque has a known name, and another label
        ("time", "angle", "tau"),
    ],
)
def test_an_arm_of_one_joint_has_columns_by_their_whole_names(tmp_path, names):
    robot = load_robot(write_urdf("revolute", tmp_path))
    t = np.arange(0.0, 6.0, 0.01)
    q, effort = np.sin(2.0 * t), 3.0 * np.cos(5.0 * t)
    path = write(tmp_path / "x.csv", dict(zip(names, (t, q, effort), strict=True)))
    with pytest.raises(MissingColumnsError) as caught:
        read_log(path, robot)
    options = reading_of(caught.value.guesses, robot)
    assert options.keys() == {"columns"}
    log = read_log(path, robot, **options)
    np.testing.assert_array_equal(log.position[:, 0], q)
    np.testing.assert_array_equal(log.effort[:, 0], effort)


def test_what_the_user_names_is_not_guessed_again(ur5, made, tmp_path):
    columns = {"zeit": made.time, **numbered("a", made.position), **numbered("b", made.velocity)}
    path = write(tmp_path / "x.csv", columns | numbered("c", made.effort))
    with pytest.raises(MissingColumnsError, match="no effort columns") as caught:
        read_log(path, ur5, columns={"position": "a_#"})
    guessed = {g.signal: g.pattern for g in caught.value.guesses if g.signal}
    assert guessed == {"time": "zeit", "velocity": "b_#", "effort": "c_#"}


@pytest.mark.parametrize(
    ("kind", "name", "unit"),
    [
        ("continuous", "position", "rad"),  # nothing says how far it turns
        ("continuous", "position [deg]", "deg"),
        ("revolute", "position", "deg"),  # its limits are a part of a turn
        ("revolute", "position [rad]", "rad"),
    ],
)
def test_several_turns_are_degrees_only_of_a_joint_with_limits(tmp_path, kind, name, unit):
    robot = load_robot(str(write_urdf(kind, tmp_path)))
    time = np.linspace(0.0, 10.0, 1001)
    turns = 8.0 * np.sin(time)
    columns = {
        "time": time,
        name: turns - 8.0,
        "velocity": np.gradient(turns, time),
        "torque": np.cos(3 * time),
    }
    (found,) = [g for g in guess_columns(columns, robot) if g.signal == "position"]
    assert found.said == unit
