"""What healthy runs teach, tested on a plant that is not the model, and on other motions."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin.diagnosis import Bank, MonitorSettings
from cdia_pin.diagnosis.alignment import Alignment
from cdia_pin.diagnosis.healthy_arm import assumed_healthy_arm, learn_healthy_arm
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.residuals import velocity_noise, watched_along
from cdia_pin.dynamics import Dynamics
from cdia_pin.errors import LogError
from cdia_pin.logs import Log
from cdia_pin.robot import load_robot

pytest.importorskip("mujoco")

from benchmarks.online import EXACT, POSITION_ONLY, Drives, NominalControl, OnlinePlant
from benchmarks.online.trial import log_of

ROBOT = load_robot("ur5")
MODEL = Dynamics(ROBOT)
NOMINAL = Nominal.of(MODEL)
BANK = Bank.of(ROBOT, ["coulomb_friction", "viscous_friction"])
DT = 1e-3


def healthy_run(motion: int, duration: float = 12.0, robot: str = "ur5", **plant) -> Log:
    arm = OnlinePlant(robot, seed=1, **plant)
    return log_of(
        arm.run(NominalControl(arm.robot), arm.reference(duration=duration, seed=motion), (), duration)
    )


def residuals(nominal: Nominal, run: Log, bandwidth=None) -> np.ndarray:
    observer = MomentumObserver(nominal, BANK.prototypes, MonitorSettings(), DT, bandwidth=bandwidth)
    return watched_along(observer, Alignment(DT, nominal.delay, run.velocity is None), run).residual


@pytest.fixture(scope="module")
def first() -> Log:
    return healthy_run(0)


@pytest.fixture(scope="module")
def other() -> Log:
    return healthy_run(3)


@pytest.fixture(scope="module")
def learned(first: Log):
    return learn_healthy_arm(MODEL, [first], BANK, MonitorSettings())


@pytest.mark.parametrize("sensors", [None, POSITION_ONLY], ids=["velocities", "positions"])
def test_a_delay_of_the_torque_loop_is_found_within_half_a_tick(sensors) -> None:
    run = healthy_run(0, drives=Drives(delay=0.004), sensors=sensors)
    healthy = learn_healthy_arm(MODEL, [run], BANK, MonitorSettings(calibrate=False))
    assert healthy.nominal.delay == pytest.approx(0.004, abs=0.5 * DT + 1e-9)
    assert any("after their signal" in note for note in healthy.notes)


def test_a_delay_is_found_beside_larger_errors_of_the_masses() -> None:
    run = healthy_run(0, robot="panda", duration=20.0, drives=Drives(delay=0.005))
    robot = load_robot("panda")
    bank = Bank.of(robot, ["coulomb_friction", "viscous_friction"])
    healthy = learn_healthy_arm(Dynamics(robot), [run], bank, MonitorSettings())
    assert healthy.nominal.delay == pytest.approx(0.005, abs=0.5 * DT + 1e-9)


def test_where_there_is_no_delay_none_is_learned(learned) -> None:
    assert learned.nominal.delay == 0.0


def test_masses_that_are_wrong_are_corrected_for_other_motions_too() -> None:
    """Without noise of the sensors, what is left is the error of the masses."""
    first, other = (healthy_run(motion, sensors=EXACT) for motion in (0, 3))
    learned = learn_healthy_arm(MODEL, [first], BANK, MonitorSettings())
    before, after = (np.sqrt(np.mean(residuals(n, other) ** 2, axis=0)) for n in (NOMINAL, learned.nominal))
    assert np.mean(after / before) < 0.5
    assert any("masses corrected" in note for note in learned.notes)


def test_masses_stay_as_stated_if_that_is_asked_for(first: Log) -> None:
    healthy = learn_healthy_arm(MODEL, [first], BANK, MonitorSettings(calibrate=False))
    np.testing.assert_array_equal(healthy.nominal.robot.inertial_parameters, ROBOT.inertial_parameters)


def test_a_healthy_residual_stays_below_the_bound_on_another_motion(learned, other: Log) -> None:
    r = residuals(learned.nominal, other, learned.bandwidth)
    assert (np.abs(r).max(axis=0) < learned.bound).all()
    assert (learned.level < learned.bound).all()


def test_noise_of_velocities_is_measured_beside_the_motion(first: Log) -> None:
    np.testing.assert_allclose(velocity_noise([first.velocity]), 1e-3, rtol=0.1)


def test_the_position_range_is_that_of_the_runs(learned, first: Log) -> None:
    np.testing.assert_array_equal(
        learned.position_range, [first.position.min(axis=0), first.position.max(axis=0)]
    )


def test_a_given_threshold_is_the_bound() -> None:
    given = dict(zip(ROBOT.joints, np.arange(1.0, ROBOT.n + 1), strict=True))
    np.testing.assert_array_equal(
        assumed_healthy_arm(NOMINAL, given, MonitorSettings()).bound, np.arange(1.0, ROBOT.n + 1)
    )


def test_thresholds_stand_beside_the_torque_of_the_runs(learned, first: Log) -> None:
    np.testing.assert_allclose(learned.torque, np.sqrt(np.mean(first.effort**2, axis=0)))
    assert learned.sight.blind == ()


# ---------------------------------------------------------------- little healthy motion


def test_from_a_few_seconds_thresholds_are_wider_and_say_so(learned, first: Log, other: Log) -> None:
    brief = first.slice(0, 3500)
    short = learn_healthy_arm(MODEL, [brief], BANK, MonitorSettings())
    r = residuals(short.nominal, other, short.bandwidth)
    assert (np.abs(r).max(axis=0) < short.bound).all()
    # What the same seconds gave alone: the margins over the residual of the motion that was fitted.
    alone = residuals(short.nominal, brief, short.bandwidth)
    least = np.maximum(1.3 * np.abs(alone).max(axis=0), 6 * np.sqrt(np.mean(alone**2, axis=0)))
    assert (short.bound >= 0.999 * least).all()
    assert np.mean(short.bound / least) > 1.1
    (note,) = [n for n in short.notes if "of healthy motion" in n and n.startswith("only")]
    assert "× wider than from 120 s" in note


def test_a_joint_that_did_not_move_has_its_effort_limit_as_threshold(first: Log) -> None:
    position, velocity = first.position.copy(), first.velocity.copy()
    position[:, 2], velocity[:, 2] = position[0, 2], 0.0
    still = replace(first, position=position, velocity=velocity)
    healthy = learn_healthy_arm(MODEL, [still], BANK, MonitorSettings(calibrate=False))
    assert healthy.bound[2] == ROBOT.limits.effort[2]
    assert ROBOT.joints[2] in healthy.sight.blind
    assert any(n.startswith("less than 1 s of motion on elbow_joint:") for n in healthy.notes)
    assert any(n.startswith("blind on") for n in healthy.notes)


def test_masses_that_do_not_explain_the_other_half_are_not_corrected(first: Log) -> None:
    """The torques of the second half are those of an arm whose masses differ the other way."""
    half = len(first.time) // 2
    inertial = ROBOT.inverse_dynamics(first.position, first.velocity, np.gradient(first.velocity, DT, axis=0))
    sign = np.where(np.arange(len(first.time)) < half, 0.05, -0.05)[:, None]
    run = replace(first, effort=inertial * (1 + sign))
    healthy = learn_healthy_arm(MODEL, [run], BANK, MonitorSettings())
    np.testing.assert_array_equal(healthy.nominal.robot.inertial_parameters, ROBOT.inertial_parameters)


# ---------------------------------------------------------------- rejected runs


def test_runs_that_are_too_short_are_refused(first: Log) -> None:
    with pytest.raises(LogError, match="too short"):
        learn_healthy_arm(MODEL, [first.slice(0, 1500)], BANK, MonitorSettings())


def test_an_arm_at_rest_teaches_nothing(first: Log) -> None:
    rest = replace(
        first, **{k: np.tile(getattr(first, k)[:1], (len(first.time), 1)) for k in ("position", "effort")}
    )
    with pytest.raises(LogError, match="nothing moves"):
        learn_healthy_arm(MODEL, [replace(rest, velocity=None)], BANK, MonitorSettings())


def test_several_short_runs_are_enough_together(first: Log) -> None:
    parts = [first.slice(k, k + 1500) for k in (0, 1500, 3000)]
    assert np.isfinite(learn_healthy_arm(MODEL, parts, BANK, MonitorSettings(calibrate=False)).bound).all()


def test_runs_in_which_no_filter_settles_do_not_count(first: Log) -> None:
    scraps = [first.slice(k, k + 500) for k in range(0, 5000, 500)]
    with pytest.raises(LogError, match="too short"):
        learn_healthy_arm(MODEL, scraps, BANK, MonitorSettings())
    usable = [*scraps, first.slice(5000, 8000)]
    assert np.isfinite(learn_healthy_arm(MODEL, usable, BANK, MonitorSettings()).bound).all()


def test_runs_of_other_joints_are_refused(first: Log) -> None:
    with pytest.raises(LogError, match="joints are"):
        learn_healthy_arm(MODEL, [replace(first, joints=first.joints[::-1])], BANK, MonitorSettings())


def test_runs_with_and_without_velocities_are_not_mixed(first: Log) -> None:
    with pytest.raises(LogError, match="velocities or none"):
        learn_healthy_arm(MODEL, [first, replace(first, velocity=None)], BANK, MonitorSettings())
