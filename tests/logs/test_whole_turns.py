"""Encoders that wrap jump by a whole turn; the joint does not."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import load_robot, read_log
from cdia_pin.logs import write_log
from cdia_pin.logs.whole_turns import TURN, without_wraps

RATE = 100.0
TIME = np.arange(0.0, 10.0, 1 / RATE)


def motion(robot, joint, x):
    """Return positions of an arm at rest but for one joint."""
    out = np.full((len(x), robot.n), 0.3)
    out[:, robot.joint_index(joint)] = x
    return out


def wrapped(x, lowest=-np.pi):
    return (x - lowest) % TURN + lowest


@pytest.mark.parametrize("lowest", [-np.pi, 0.0])
@pytest.mark.parametrize(
    "x", [3.0 * np.sin(TIME) + 1.0, 1.5 * TIME - 7.5], ids=["to and fro", "several turns"]
)
def test_a_joint_that_wraps_is_continuous_again(panda, lowest, x):
    expected = motion(panda, "panda_joint7", x)
    read = motion(panda, "panda_joint7", wrapped(x, lowest))
    assert np.abs(np.diff(read, axis=0)).max() > 6.0
    found, notes = without_wraps(TIME, read, panda)
    np.testing.assert_allclose(found, expected, atol=1e-9)
    assert len(notes) == 1
    assert "panda_joint7" in notes[0]


def test_a_joint_that_wraps_is_read_alike_whatever_its_encoder_counts_from(panda):
    x = 3.0 * np.sin(TIME) + 1.0
    given = (motion(panda, "panda_joint7", wrapped(x, lowest)) for lowest in (-np.pi, 0.0, 2.0))
    read = [without_wraps(TIME, q, panda)[0] for q in given]
    np.testing.assert_allclose(read[1:], [read[0]] * 2, atol=1e-9)


def test_noise_at_the_end_of_the_range_is_no_motion(panda):
    x = np.pi + np.random.default_rng(0).normal(0.0, 1e-3, len(TIME))
    found, notes = without_wraps(TIME, motion(panda, "panda_joint7", wrapped(x)), panda)
    assert np.ptp(found, axis=0).max() < 0.01
    assert "jumps" in notes[0]


@pytest.mark.parametrize(
    "x",
    [60.0 * np.sin(2.1 * TIME), np.clip(130.0 * (TIME - 5.0), -500.0, 500.0), 3.0 * np.sin(TIME)],
    ids=["in degrees", "in degrees at one speed", "without a wrap"],
)
def test_other_motions_are_left_as_they_are(panda, x):
    time, read = TIME[::5], motion(panda, "panda_joint7", x)[::5]
    found, notes = without_wraps(time, read, panda)
    assert found is read
    assert notes == []


def test_a_gap_and_a_slide_may_be_as_long_as_a_turn(panda):
    gap = motion(panda, "panda_joint7", np.where(TIME < 5.0, 0.0, TURN))
    late = np.where(TIME < 5.0, TIME, TIME + 1.0)
    assert without_wraps(late, gap, panda)[1] == []
    slide = load_robot("scara")
    prismatic = slide.joints[int(np.flatnonzero(slide.is_prismatic)[0])]
    assert without_wraps(TIME, motion(slide, prismatic, np.where(TIME < 5.0, 0.0, TURN)), slide)[1] == []


def test_positions_with_missing_values_are_left_as_they_are(panda):
    read = motion(panda, "panda_joint7", wrapped(1.5 * TIME))
    read[500] = np.nan
    found, notes = without_wraps(TIME, read, panda)
    assert found is read
    assert notes == []


def test_a_log_says_that_it_was_made_continuous(panda, plant, tmp_path):
    log = plant(panda)
    turned = log.position + np.where(np.arange(panda.n) == 6, np.pi - log.position[0], 0.0)
    path = tmp_path / "log.csv"
    write_log(replace(log, position=wrapped(turned)), path)
    read = read_log(path, panda)
    assert any("one turn" in n and "panda_joint7" in n for n in read.notes)
    assert np.abs(np.diff(read.position, axis=0)).max() < 1.0


@pytest.mark.parametrize("gap", [0.05, 0.3])
@pytest.mark.parametrize("where", ["before", "after"])
def test_a_row_of_a_failed_bus_beside_a_gap_is_no_turn(panda, gap, where):
    """Before, each such row turned the joint once more."""
    x = 2.9 + 0.1 * np.sin(TIME)
    x[500] = -np.pi
    time = TIME + gap * (np.arange(len(TIME)) >= (500 if where == "before" else 501))
    found, _ = without_wraps(time, motion(panda, "panda_joint7", x), panda)
    left = np.delete(found[:, panda.joint_index("panda_joint7")], 500)
    assert np.ptp(left) == pytest.approx(0.2, abs=0.01)
