"""Units are converted at the door, in words that say so."""

import numpy as np
import pytest

from cdia_pin import load_robot, read_log
from cdia_pin.errors import LogError
from cdia_pin.logs import Conversion, write_log
from cdia_pin.logs.gains import NOMINAL_TOLERANCE, read_gains
from cdia_pin.logs.timestamps import in_order, in_seconds
from tests.made_logs import make
from tests.one_joint import write_urdf

STEPS = np.arange(100)


@pytest.mark.parametrize(
    ("raw", "step"),
    [
        (STEPS * 0.008, 0.008),
        (STEPS * 8.0, 0.008),
        (STEPS * 1.0, 0.001),
        (STEPS * 8000.0, 0.008),
        (STEPS * 8_000_000, 0.008),
        (100.0 + STEPS * 0.001, 0.001),
    ],
)
def test_the_unit_of_time_follows_from_the_step(raw, step):
    time, _ = in_seconds(raw, None, "log")
    np.testing.assert_allclose(np.diff(time), step)


def test_nanoseconds_since_1970_keep_their_digits():
    raw = 1_700_000_000_123_456_789 + STEPS * 1_000_001
    time, notes = in_seconds(raw, None, "log")
    assert time[0] == 0.0
    np.testing.assert_allclose(time, STEPS * 1_000_001e-9, atol=1e-15)
    assert "1700000000.12" in " ".join(notes)


def test_seconds_since_1970_are_seconds_even_at_one_hertz():
    time, notes = in_seconds(1.7e9 + STEPS, None, "log")
    np.testing.assert_allclose(time, STEPS)
    assert len(notes) == 1


def test_times_in_seconds_are_left_as_given():
    time, notes = in_seconds(283.0 + STEPS * 0.01, None, "log")
    assert time[0] == 283.0
    assert notes == []


def test_a_stated_unit_of_time_is_used():
    time, notes = in_seconds(STEPS * 1.0, "s", "log")
    assert time[1] == 1.0
    assert notes == []


def test_a_missing_time_is_named():
    with pytest.raises(LogError, match="sample 3"):
        in_seconds(np.array([0.0, 1.0, 2.0, np.nan]), None, "log")


def test_conversions_scale_revolute_joints_and_flip_named_ones(ur5):
    asked = Conversion(
        angle="deg", torque="Nmm", flip_position=("elbow_joint",), reduction={"wrist_1_joint": 50.0}
    )
    assert asked.position_scale(ur5)[0] == pytest.approx(np.pi / 180)
    assert asked.position_scale(ur5)[2] == pytest.approx(-np.pi / 180)
    assert asked.effort_scale(ur5)[0] == pytest.approx(1e-3)
    assert asked.effort_scale(ur5)[3] == pytest.approx(0.05)
    assert len(asked.notes()) == 4


def test_conversions_mean_the_same_in_python_and_on_the_command_line():
    texts = ["angle=deg", "flip_effort=a,b", "reduction=a:100,b:50.5", "use_velocity=false"]
    assert Conversion.of(texts) == Conversion(
        angle="deg", flip_effort=("a", "b"), reduction={"a": 100.0, "b": 50.5}, use_velocity=False
    )
    assert Conversion.of({"angle": "deg"}) == Conversion.of("angle=deg")


def test_currents_of_a_slide_are_currents_and_its_force_is_in_newton(tmp_path):
    robot = load_robot(str(write_urdf("prismatic", tmp_path)))
    assert Conversion.of("torque=mA").effort_scale(robot) == pytest.approx([1e-3])
    assert Conversion.of("torque=Nmm").effort_scale(robot) == pytest.approx([1.0])


def test_several_conversions_fit_in_one_text():
    together = Conversion.of("angle=deg, torque=mA,flip_effort=a,b,reduction=a:100,b:50.5")
    assert together == Conversion(
        angle="deg", torque="mA", flip_effort=("a", "b"), reduction={"a": 100.0, "b": 50.5}
    )


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"angle": "degree"}, "did you mean deg"),
        ({"angel": "deg"}, "did you mean angle"),
        ("angle", "key=value"),
        ("reduction=elbow_joint", "joint:ratio"),
        ({"reduction": {"elbow_joint": -1.0}}, "above 0"),
        ({"time": "h"}, "unit of time"),
        ("rate=fast", "number above 0"),
        ({"rate": -100.0}, "number above 0"),
    ],
)
def test_an_invalid_conversion_is_refused_with_the_valid_ones(given, said):
    with pytest.raises(LogError, match=said):
        Conversion.of(given)


def test_a_conversion_of_an_unknown_joint_is_refused_with_the_nearest_ones(ur5):
    with pytest.raises(LogError, match="did you mean elbow_joint"):
        Conversion(flip_effort=("elbow",)).check_joints(ur5.joints)


@pytest.mark.parametrize(
    ("gains", "said"),
    [
        ({"a": 1.0}, "no gain for b"),
        ({"a": 1.0, "b": 0.0}, "above 0"),
        ({"a": 1.0, "b": "ten"}, "above 0"),
        ({"a": 1.0, "b": float("nan")}, "above 0"),
        ({"a": 1.0, "b": {"tolerance": 1.0}}, "above 0"),
        ({"a": 1.0, "b": {"value": 1.0, "tolerance": -1.0}}, "tolerance of b"),
        ("missing.json", "cannot read the drive gains missing.json: No such file"),
    ],
)
def test_invalid_gains_are_refused_with_the_reason(gains, said):
    with pytest.raises(LogError, match=said):
        read_gains(gains, ("a", "b"))


def test_gains_may_be_in_a_file(tmp_path):
    file = tmp_path / "gains.json"
    file.write_text('{"b": 2, "a": 1.5, "gripper": 9}')
    read = read_gains(file, ("a", "b"))
    np.testing.assert_allclose(read.value, [1.5, 2.0])
    np.testing.assert_allclose(read.relative_tolerance, NOMINAL_TOLERANCE)


def test_gains_may_have_a_tolerance():
    read = read_gains({"a": {"value": 2.0, "tolerance": 0.1}, "b": 4.0}, ("a", "b"))
    np.testing.assert_allclose(read.value, [2.0, 4.0])
    np.testing.assert_allclose(read.tolerance, [0.1, NOMINAL_TOLERANCE * 4.0])


def damaged(count, rows):
    """Times of a controller [s], 100 Hz, in which some rows hold what another packet has."""
    time = 3047.0 + np.arange(count) / 100
    time[list(rows)] = list(rows.values())
    return time


@pytest.mark.parametrize(
    "rows",
    [
        {1: -0.1231, 2: 0.79, 3: 0.0, 4: -1.1e81, 5: 47.5, 6: 0.0, 7: 0.0},  # a packet that was read askew
        {500: 0.0},
        {500: 3047.2},  # within the log, but not there
        {0: 9e9, 999: 2.0},
    ],
)
def test_damaged_rows_are_left_out_by_their_times(rows):
    time = damaged(1000, rows)
    kept, notes = in_order(time)
    assert set(np.flatnonzero(~kept)) == set(rows)
    assert (np.diff(time[kept]) > 0).all()
    (note,) = notes
    assert note.startswith(f"{len(rows)} row") and f"sample {min(rows)}" in note


@pytest.mark.parametrize(
    "time",
    [
        np.arange(100.0),
        np.r_[np.arange(50.0), np.arange(50.0)],  # two logs in one file
        np.r_[np.arange(30.0), np.arange(31.0, 60.0) - 5.0],
        np.r_[np.arange(500.0), np.arange(500.0, 1000.0) + 7200.0],  # a long pause
        np.r_[0.0, 1.0, 1.0, 2.0],  # a row twice
        np.r_[0.0, np.nan, 1.0],
    ],
)
def test_a_log_without_damaged_rows_keeps_them_all(time):
    kept, notes = in_order(time)
    assert kept.all() and not notes


def test_a_log_with_damaged_rows_is_read(ur5, tmp_path):
    lines = make(ur5, lambda q, v, a: 0 * q, seed=1).log
    path = write_log(lines, tmp_path / "good.csv")
    text = path.read_text().splitlines()
    at = next(k for k, line in enumerate(text) if line.startswith("time")) + 5
    text.insert(at, ",".join(["-0.5", *["253.0"] * (text[at].count(","))]))
    (tmp_path / "bad.csv").write_text("\n".join(text) + "\n")
    good, bad = read_log(path, ur5), read_log(tmp_path / "bad.csv", ur5)
    np.testing.assert_array_equal(bad.position, good.position)
    assert any("1 row left out, the first one sample 4" in note for note in bad.notes)
