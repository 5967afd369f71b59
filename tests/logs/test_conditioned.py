"""Conditioning: accelerations that are noise, cut-offs that are none."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.errors import LogError
from cdia_pin.logs import Log, check_log
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.logs.derivatives import zero_phase
from cdia_pin.logs.motion_file import motion_document, motion_from
from tests.made_logs import make

NOISE = 2e-5  # [rad]


@pytest.fixture(scope="module")
def log():
    """Two joints that swing, four that creep, whose encoders hiss."""
    arm = load_robot("ur5")
    t = np.arange(0, 20, 0.004)
    swings = np.where(np.arange(arm.n) < 2, 0.5, 0.001)
    q = swings * np.sin(2 * np.pi * 0.3 * t)[:, None] + NOISE * np.random.default_rng(1).standard_normal(
        (len(t), 6)
    )
    return arm, Log(arm.joints, t, q, effort=np.cos(t)[:, None] * np.ones(6))


def test_an_acceleration_that_is_only_noise_is_set_to_zero(log):
    arm, run = log
    motion = condition(run, arm, Conditioning(cutoff=20.0))
    assert motion.record["acceleration_drowned"] == list(arm.joints[2:])
    assert not motion.a[:, 2:].any()
    assert motion.a[:, :2].std() == pytest.approx(0.5 * (2 * np.pi * 0.3) ** 2 / np.sqrt(2), rel=0.05)
    assert (motion.acceleration_noise[2:] > 0).all()  # what is not known of them


def test_a_cutoff_of_zero_is_refused(log):
    arm, run = log
    with pytest.raises(LogError, match="cut-off of 0 Hz"):
        condition(run, arm, Conditioning(cutoff=0.0))


@pytest.mark.parametrize("amplitude", [0.003, 0.01, 0.05, 0.4])
def test_the_acceleration_that_the_steps_of_an_encoder_make_is_known(amplitude):
    """From three steps a second to hundreds: the estimate needs no true motion."""
    arm, counts, rate = load_robot("z1"), 2**13, 250.0
    t = np.arange(0, 30, 1 / rate)
    speed = 2 * np.pi * np.linspace(0.11, 0.23, arm.n)
    true = amplitude * np.sin(speed * t[:, None] + np.arange(arm.n))
    step = 2 * np.pi / counts
    log = Log(arm.joints, t, np.round(true / step) * step, effort=arm.gravity(true))
    motion = condition(log, arm, Conditioning(cutoff=5.0))
    a = zero_phase(log.position - true, 5.0, rate, derivative=2)
    made = np.sqrt(np.mean(a[200:-200] ** 2, axis=0))
    ratio = motion.acceleration_noise / made
    assert ((ratio > 0.75) & (ratio < 1.75)).all()  # rather too large: steps may beat with the samples


def test_an_effort_that_never_changes_is_known_to_its_own_size_only(log):
    arm, run = log
    effort = run.effort.copy()
    effort[:, 3] = 2.0
    motion = condition(replace(run, effort=effort), arm, Conditioning(cutoff=20.0))
    assert motion.effort_step[3] == 2.0
    assert motion.effort_step[0] == 0.0


@pytest.mark.parametrize("cutoff", [1e-300, 1e-3, 0.04])
def test_a_cut_off_whose_period_is_longer_than_the_log_is_refused(log, cutoff):
    arm, run = log
    with pytest.raises(LogError, match="too low for a log of 20 s"):
        condition(run, arm, Conditioning(cutoff=cutoff))


@pytest.mark.parametrize("first", [2, 3, 50, 150])
def test_a_log_of_which_hardly_anything_was_measured_is_too_short(first):
    robot = load_robot("double_pendulum")
    log = make(robot, duration=20.0, noise=0.02).log
    held = {
        name: np.concatenate([s[:first], np.repeat(s[first : first + 1], len(s) - first, axis=0)])
        for name, s in (("position", log.position), ("effort", log.effort))
    }
    ended = replace(log, **held)
    with pytest.raises(LogError, match="too short to compare"):
        condition(ended, robot)
    assert check_log(ended, robot).about("frozen")


@pytest.mark.parametrize("band", [0.0, 0.8, np.nan])
def test_a_motion_narrower_than_what_is_compared_is_refused(log, band):
    arm, run = log
    with pytest.raises(LogError, match="as wide as that of the compared"):
        condition(run, arm, Conditioning(cutoff=10.0, motion_band=band))


@pytest.mark.parametrize("given", [1.0, 0.0, "wide", None])
def test_a_stored_motion_with_impossible_filters_is_refused(log, given):
    arm, run = log
    document = motion_document(condition(run, arm, Conditioning(cutoff=10.0)))
    record = {**document["record"], "motion_cutoff": given}
    with pytest.raises(LogError):
        motion_from({**document, "record": record})


def test_a_motion_that_was_stored_before_has_no_cut_off_of_its_own(log):
    arm, run = log
    document = motion_document(condition(run, arm, Conditioning(cutoff=10.0)))
    record = {k: v for k, v in document["record"].items() if k != "motion_cutoff"}
    assert motion_from({**document, "record": record}).cutoff == 10.0
