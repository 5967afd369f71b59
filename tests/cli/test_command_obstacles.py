"""``cdia discover`` refuses a log that contradicts its robot, with what mends it, or goes on when it is told to."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import load_robot, read_log, write_log
from cdia_pin.resources import logs_dir

SEARCH = ("--robot", "ur5", "--effects", "joint_spring")
LIFT, ELBOW = "shoulder_lift_joint", "elbow_joint"
EXCHANGED = [0, 2, 1, 3, 4, 5]
MENDS = {
    "flipped": f"--convert flip_effort={ELBOW}",
    "degrees": "--convert angle=deg",
    "order": f"--joint-map {ELBOW}={LIFT},{LIFT}={ELBOW}",
    "both": f"--convert angle=deg --convert flip_effort={ELBOW}",
}


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """The demo log as it is, and with a mistake each that people make."""
    folder, log = (
        tmp_path_factory.mktemp("mistakes"),
        read_log(logs_dir() / "demo_ur5.csv", load_robot("ur5")),
    )
    log = replace(log.slice(0, len(log.time) // 3), velocity=None)
    sign = np.where(np.array(log.joints) == ELBOW, -1.0, 1.0)
    degrees = np.degrees(log.position)
    for name, wrong in {
        "right": log,
        "flipped": replace(log, effort=log.effort * sign),
        "degrees": replace(log, position=degrees),
        "order": replace(log, position=log.position[:, EXCHANGED], effort=log.effort[:, EXCHANGED]),
        "both": replace(log, position=degrees, effort=log.effort * sign),
    }.items():
        write_log(wrong, folder / f"{name}.csv")
    return folder


@pytest.mark.parametrize("mistake", MENDS)
def test_a_log_that_contradicts_its_robot_is_refused_with_its_mend(cdia, logs, mistake):
    log = logs / f"{mistake}.csv"
    said = cdia("discover", log, *SEARCH).error
    assert said.startswith(f"{mistake}.csv: ")
    assert f"add {MENDS[mistake]}; or go on with --anyway" in said
    assert cdia("check", log, "--robot", "ur5", *MENDS[mistake].split(), "--json", "-").json["ok"]


def test_it_goes_on_when_told_to_and_says_so_last_before_the_command_that_mends_it(cdia, logs):
    done = cdia("discover", logs / "flipped.csv", *SEARCH, "--anyway")
    assert done.code == 0, done.err
    last, _, following = done.out[done.out.rindex("This result is doubtful") :].partition("\nnext: ")
    assert " ".join(last.split()).endswith(f"--convert flip_effort={ELBOW}.")
    assert following.startswith(f"cdia discover --convert flip_effort={ELBOW} ")


def test_a_right_log_is_searched_without_a_word(cdia, logs):
    done = cdia("discover", logs / "right.csv", *SEARCH)
    assert (done.code, done.err) == (0, "")
    assert "doubtful" not in done.out


def test_a_wrong_held_out_log_is_refused_too(cdia, logs):
    said = cdia("discover", logs / "right.csv", "--holdout", logs / "degrees.csv", *SEARCH).error
    assert "angle=deg" in said


def test_a_log_of_another_arm_is_said_by_check_and_at_the_end_of_discover(cdia, measured):
    log = measured / "ur10" / "exciting.csv"
    found = cdia("check", log, "--robot", "ur5", "--json", "-").json["findings"]
    (other,) = [f for f in found if f["topic"] == "robot"]
    assert (other["severity"], other["value"]["best"]) == ("warning", "ur10")
    assert "masses 1.9 to 2.4 times" in other["message"]
    done = cdia("discover", log, *SEARCH)
    assert "looks like a log of 'ur10'" in done.err
    assert "looks like a log of 'ur10'" in " ".join(done.out[done.out.rindex("doubtful") :].split())
    right = cdia("check", log, "--robot", "ur10", "--json", "-").json["findings"]
    assert not [f for f in right if f["topic"] == "robot"]
