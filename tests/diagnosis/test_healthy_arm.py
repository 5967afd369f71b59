"""What healthy runs teach, measured on a plant that is not the model, and on motions that were not learned from."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin.diagnosis import Bank, MonitorSettings
from cdia_pin.diagnosis.alignment import Alignment
from cdia_pin.diagnosis.healthy_arm import assumed_healthy_arm, learn_healthy_arm
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.residuals import residual_along, velocity_noise
from cdia_pin.dynamics import Dynamics
from cdia_pin.errors import LogError
from cdia_pin.logs import Log
from cdia_pin.robot import load_robot

pytest.importorskip("mujoco")

from benchmarks.online import EXACT, POSITION_ONLY, Drives, NominalControl, OnlinePlant
from benchmarks.online.trial import log_of

ROBOT = load_robot("ur5")
NOMINAL = Nominal.of(Dynamics(ROBOT))
BANK = Bank.of(ROBOT, ["coulomb_friction", "viscous_friction"])
DT = 1e-3


def healthy_run(motion: int, duration: float = 12.0, robot: str = "ur5", **plant) -> Log:
    arm = OnlinePlant(robot, seed=1, **plant)
    return log_of(
        arm.run(NominalControl(arm.robot), arm.reference(duration=duration, seed=motion), (), duration)
    )


def residuals(nominal: Nominal, run: Log, bandwidth=None) -> np.ndarray:
    observer = MomentumObserver(nominal, BANK.prototypes, MonitorSettings(), DT, bandwidth=bandwidth)
    return residual_along(observer, Alignment(DT, nominal.delay, run.velocity is None), run)


@pytest.fixture(scope="module")
def first() -> Log:
    return healthy_run(0)


@pytest.fixture(scope="module")
def other() -> Log:
    return healthy_run(3)


@pytest.fixture(scope="module")
def learned(first: Log):
    return learn_healthy_arm(NOMINAL, [first], BANK, MonitorSettings())


@pytest.mark.parametrize("sensors", [None, POSITION_ONLY], ids=["velocities", "positions"])
def test_a_delay_of_the_torque_loop_is_found_within_half_a_tick(sensors) -> None:
    run = healthy_run(0, drives=Drives(delay=0.004), sensors=sensors)
    healthy = learn_healthy_arm(NOMINAL, [run], BANK, MonitorSettings(calibrate=False))
    assert healthy.nominal.delay == pytest.approx(0.004, abs=0.5 * DT + 1e-9)
    assert any("after their signal" in note for note in healthy.notes)


def test_a_delay_is_found_beside_larger_errors_of_the_masses() -> None:
    run = healthy_run(0, robot="panda", duration=20.0, drives=Drives(delay=0.005))
    robot = load_robot("panda")
    bank = Bank.of(robot, ["coulomb_friction", "viscous_friction"])
    healthy = learn_healthy_arm(Nominal.of(Dynamics(robot)), [run], bank, MonitorSettings())
    assert healthy.nominal.delay == pytest.approx(0.005, abs=0.5 * DT + 1e-9)


def test_where_there_is_no_delay_none_is_learned(learned) -> None:
    assert learned.nominal.delay == 0.0


def test_masses_that_are_wrong_are_corrected_for_other_motions_too() -> None:
    """Without noise of the sensors, what is left is the error of the masses."""
    first, other = (healthy_run(motion, sensors=EXACT) for motion in (0, 3))
    learned = learn_healthy_arm(NOMINAL, [first], BANK, MonitorSettings())
    before, after = (np.sqrt(np.mean(residuals(n, other) ** 2, axis=0)) for n in (NOMINAL, learned.nominal))
    assert np.mean(after / before) < 0.5
    assert any("masses corrected" in note for note in learned.notes)


def test_masses_stay_as_stated_if_that_is_asked_for(first: Log) -> None:
    healthy = learn_healthy_arm(NOMINAL, [first], BANK, MonitorSettings(calibrate=False))
    np.testing.assert_array_equal(healthy.nominal.robot.inertial_parameters, ROBOT.inertial_parameters)


def test_a_healthy_residual_stays_below_the_bound_on_another_motion(learned, other: Log) -> None:
    r = residuals(learned.nominal, other, learned.bandwidth)
    assert (np.abs(r).max(axis=0) < learned.bound).all()
    assert (learned.level < learned.bound).all()


def test_noise_of_velocities_is_measured_beside_the_motion(first: Log) -> None:
    np.testing.assert_allclose(velocity_noise([first], DT), 1e-3, rtol=0.1)


def test_the_position_range_is_that_of_the_runs(learned, first: Log) -> None:
    np.testing.assert_array_equal(
        learned.position_range, [first.position.min(axis=0), first.position.max(axis=0)]
    )


def test_a_given_threshold_is_the_bound() -> None:
    given = dict(zip(ROBOT.joints, np.arange(1.0, ROBOT.n + 1), strict=True))
    np.testing.assert_array_equal(
        assumed_healthy_arm(NOMINAL, given, MonitorSettings()).bound, np.arange(1.0, ROBOT.n + 1)
    )


# ---------------------------------------------------------------- what is refused


def test_runs_that_are_too_short_are_refused(first: Log) -> None:
    with pytest.raises(LogError, match="too short"):
        learn_healthy_arm(NOMINAL, [first.slice(0, 1500)], BANK, MonitorSettings())


def test_an_arm_at_rest_teaches_nothing(first: Log) -> None:
    rest = replace(
        first, **{k: np.tile(getattr(first, k)[:1], (len(first.time), 1)) for k in ("position", "effort")}
    )
    with pytest.raises(LogError, match="nothing moves"):
        learn_healthy_arm(NOMINAL, [replace(rest, velocity=None)], BANK, MonitorSettings())


def test_several_short_runs_are_enough_together(first: Log) -> None:
    parts = [first.slice(k, k + 1500) for k in (0, 1500, 3000)]
    assert np.isfinite(learn_healthy_arm(NOMINAL, parts, BANK, MonitorSettings(calibrate=False)).bound).all()


def test_runs_of_other_joints_are_refused(first: Log) -> None:
    with pytest.raises(LogError, match="joints are"):
        learn_healthy_arm(NOMINAL, [replace(first, joints=first.joints[::-1])], BANK, MonitorSettings())


def test_runs_of_several_rates_are_refused(first: Log) -> None:
    slow = replace(first, time=2 * first.time)
    with pytest.raises(LogError, match="one rate"):
        learn_healthy_arm(NOMINAL, [first, slow], BANK, MonitorSettings())


def test_runs_with_and_without_velocities_are_not_mixed(first: Log) -> None:
    with pytest.raises(LogError, match="velocities or none"):
        learn_healthy_arm(NOMINAL, [first, replace(first, velocity=None)], BANK, MonitorSettings())
