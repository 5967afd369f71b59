"""On measured logs of real arms the checks raise no alarm, and find what is done to them."""

import json
from dataclasses import replace

import numpy as np
import pytest

from cdia_pin.errors import LogError
from cdia_pin.logs import check_log, read_log
from cdia_pin.robot import load_robot

UR10E = [
    "fourier_40s",
    "fourier_50s",
    *(f"jointwise_{k}" for k in range(1, 7)),
    "point_to_point",
]


@pytest.fixture(scope="module")
def ur10e(measured):
    return load_robot(measured / "ur10e" / "ur10e.urdf")


@pytest.fixture(scope="module")
def ur10():
    return load_robot("ur10")


@pytest.fixture(scope="module")
def panda_run(measured, panda):
    return read_log(measured / "panda" / "exciting.csv", panda)


@pytest.fixture(scope="module")
def ur10_run(measured, ur10):
    return read_log(measured / "ur10" / "exciting.csv", ur10)


def test_the_panda_log_has_no_problem(panda, panda_run):
    check = check_log(panda_run, panda)
    assert check.ok, check.problems
    assert check.about("duplicates")[0].value["source_rate_hz"] == pytest.approx(924, abs=5)
    assert check.about("velocity")[0].value["lag_s"] == pytest.approx(0.0053, abs=5e-4)


def test_the_ur10_log_has_no_problem(ur10, ur10_run):
    check = check_log(ur10_run, ur10)
    assert check.ok, check.problems


@pytest.mark.parametrize("name", UR10E)
def test_the_ur10e_logs_have_no_problem(measured, ur10e, name):
    folder = measured / "ur10e"
    check = check_log(read_log(folder / f"{name}.csv", ur10e, gains=folder / "drive_gains.json"), ur10e)
    assert check.ok, check.problems


def test_a_bag_and_a_csv_of_the_same_recording_agree(measured, ur10, ur10_run):
    bag = read_log(measured / "ur10" / "exciting.db3", ur10)
    np.testing.assert_allclose(bag.time, ur10_run.time, atol=2e-9)
    np.testing.assert_allclose(bag.position, ur10_run.position, atol=1e-7)
    np.testing.assert_allclose(bag.effort, ur10_run.effort, atol=1e-5)


@pytest.mark.parametrize("joint", range(6))
def test_a_flipped_effort_of_the_real_ur10_is_found(ur10, ur10_run, joint):
    sign = np.where(np.arange(6) == joint, -1.0, 1.0)
    (found,) = check_log(replace(ur10_run, effort=ur10_run.effort * sign), ur10).problems
    assert found.advice == f"--convert flip_effort={ur10.joints[joint]}"


def test_degrees_and_exchanged_joints_of_the_real_panda_are_found(panda, panda_run):
    run = panda_run.slice(0, 10_000)
    degrees = replace(run, position=np.degrees(run.position), velocity=np.degrees(run.velocity))
    assert "--convert angle=deg" in {f.advice for f in check_log(degrees, panda).problems}
    order = [0, 3, 2, 1, 4, 5, 6]
    exchanged = replace(
        run, position=run.position[:, order], velocity=run.velocity[:, order], effort=run.effort[:, order]
    )
    found = {f.topic: f for f in check_log(exchanged, panda).problems}
    assert found["joint_order"].value["joints"] == ["panda_joint2", "panda_joint4"]
    alone = check_log(replace(run, effort=1000 * run.effort), panda).problems
    assert "--convert torque=Nmm" in {f.advice for f in alone}


@pytest.mark.parametrize(
    ("log", "gains", "given", "best"),
    [
        ("ur10/exciting.csv", None, "ur5", "ur10"),
        ("ur10/exciting.csv", None, "kinova", "ur10"),
        ("ur10/exciting.csv", None, "ur3", "ur10"),
        ("ur10e/fourier_40s.csv", "ur10e/drive_gains.json", "ur3", "ur10"),
        ("ur5/free.csv", "ur5/drive_gains.json", "ur10", "ur5"),
        ("panda/exciting.csv", None, "xarm7", "panda"),
        ("panda/exciting.csv", None, "baxter_left_arm", "panda"),
    ],
)
def test_the_arm_that_a_log_is_of_is_named_where_another_was_given(
    measured, monkeypatch, tmp_path, log, gains, given, best
):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))  # fetched arms are candidates too
    arm, right = load_robot(given), load_robot(best)
    renamed = {r: j for r, j in zip(right.joints, arm.joints, strict=True) if r != j}
    known = json.loads((measured / gains).read_text()) if gains else {}
    scaled = {renamed.get(joint, joint): gain for joint, gain in known.items()}
    read = read_log(measured / log, arm, gains=scaled or None, joint_map=renamed or None)
    (found,) = check_log(read, arm).about("robot")
    assert found.value["best"] == best
    with_right = read_log(measured / log, right, gains=known or None)
    assert not check_log(with_right, right).about("robot")


def test_the_arm_whose_joints_a_log_names_is_said(measured, ur10):
    with pytest.raises(LogError, match="its joints are those of panda"):
        read_log(measured / "panda" / "exciting.csv", ur10)
