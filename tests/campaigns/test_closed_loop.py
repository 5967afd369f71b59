"""A closed loop: the plant is not the model, a number makes it repeatable, and held torques are held."""

import math
from itertools import islice

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
from cdia_pin.campaigns.loop_comparison import compare_loops, onset
from cdia_pin.campaigns.model_error import with_model_error
from cdia_pin.dynamics.trajectories import Repeated
from cdia_pin.effects import parse_term
from cdia_pin.errors import CdiaError, ModelError
from cdia_pin.robot.inertia import is_physical

FAULT = "viscous_friction@joint2: coefficient=0.2, after=1"


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def loop_of(robot, **settings):
    given = {"rate": 200.0, "healthy_runs": 1, "healthy_duration": 6.0}
    return ClosedLoop(Dynamics(robot), LoopSettings(**given | settings))


def test_a_model_error_has_the_requested_size_and_keeps_bodies_physical():
    arm = load_robot("ur5")
    for seed in range(5):
        wrong = with_model_error(arm, 0.1, np.random.default_rng(seed))
        share = wrong.inertial_parameters[:, 0] / arm.inertial_parameters[:, 0] - 1
        assert (np.abs(share) <= 0.1).all()
        assert np.abs(share).max() > 0.02
        assert all(is_physical(p) for p in wrong.inertial_parameters)


def test_no_model_error_is_the_arm_of_the_file():
    arm = load_robot("panda")
    same = with_model_error(arm, 0.0, np.random.default_rng(0))
    np.testing.assert_allclose(same.inertial_parameters, arm.inertial_parameters, rtol=1e-9, atol=1e-12)


def test_a_body_of_zero_mass_stays_unchanged():
    arm = load_robot("scara")
    wrong = with_model_error(arm, 0.1, np.random.default_rng(0)).inertial_parameters
    assert np.isfinite(wrong).all()
    np.testing.assert_array_equal((wrong == 0).all(axis=1), (arm.inertial_parameters == 0).all(axis=1))


@pytest.mark.parametrize("size", [-0.1, 0.6, np.nan])
def test_an_impossible_model_error_is_refused(robot, size):
    with pytest.raises(CdiaError, match=r"between 0 and 0\.5"):
        with_model_error(robot, size, np.random.default_rng(0))


def test_the_same_seed_is_the_same_run(robot):
    a, b, c = (loop_of(robot, seed=s).run(loop_of(robot, seed=s).motion(0, 2.0)) for s in (1, 1, 2))
    np.testing.assert_array_equal(a.log.effort, b.log.effort)
    assert not np.array_equal(a.log.effort, c.log.effort)


def test_a_torque_is_held_from_tick_to_tick_and_logged_with_the_next_sample(robot):
    loop = loop_of(robot, noise=0.0)
    ran = loop.run(loop.motion(0, 2.0))
    inner = round(1 / 200.0 / (ran.run.time[1] - ran.run.time[0]))
    assert inner > 1
    whole = len(ran.run.effort) // inner
    held = ran.run.effort[: whole * inner].reshape(whole, inner, -1)
    assert (held == held[:, :1]).all()
    np.testing.assert_array_equal(ran.log.effort[1 : whole + 1], held[: len(ran.log.time) - 1, 0])


def test_without_model_error_noise_or_fault_the_arm_follows(robot):
    exact = loop_of(robot, noise=0.0, model_error=0.0, rate=1000.0)
    flawed = loop_of(robot, rate=1000.0, model_error=0.1)
    errors = [loop.run(loop.motion(0, 4.0)).tracking().max() for loop in (exact, flawed)]
    assert errors[0] < 2e-4
    assert errors[1] > 5 * errors[0]


def test_a_fault_adds_to_the_terms_of_the_model(robot):
    known = Dynamics(robot, (parse_term("viscous_friction@joint2: coefficient=0.1"),))
    twice = ClosedLoop(known, LoopSettings(rate=200.0, noise=0.0, model_error=0.0))
    once = ClosedLoop(Dynamics(robot), twice.settings)
    fault = parse_term("viscous_friction@joint2: coefficient=0.1")
    motion = once.motion(0, 3.0)
    a, b = twice.run(motion, [fault]), once.run(motion, [fault])
    # Nominal control compensates what it knows: what is left is the same fault.
    np.testing.assert_allclose(a.tracking(), b.tracking(), rtol=0.15)
    assert (a.tracking() > 2 * twice.run(motion).tracking())[1]


def test_an_arm_that_diverges_without_compensation_is_reported(robot):
    loop = loop_of(robot, rate=500.0)
    monitor = loop.monitor(bank=("coulomb_friction", "viscous_friction"))
    ran = compare_loops(loop, monitor, [parse_term(FAULT)], 3.0)
    assert ran.since == 1.0
    lost = type(ran)(ran.loop, ran.since, ran.healthy, None, ran.monitored)
    assert np.isinf(lost.tracking()["faulty"]).all()
    assert np.isfinite(lost.tracking()["accommodated"]).all()


def test_the_onset_is_that_of_the_first_fault():
    assert onset([]) == 0.0
    assert onset([parse_term("viscous_friction@a: coefficient=1")]) == 0.0
    late = [parse_term(f"viscous_friction@a: coefficient=1, after={t}") for t in (5, 3)]
    assert onset(late) == 3.0


@pytest.mark.parametrize(
    "wrong",
    [{"rate": 0.0}, {"noise": -1.0}, {"healthy_runs": 0}, {"healthy_duration": 0.0}, {"seed": -1}],
)
def test_impossible_settings_are_refused(wrong):
    with pytest.raises(ModelError):
        LoopSettings(**wrong)


def test_ticks_are_those_of_a_run(robot):
    loop = loop_of(robot)
    motion, faults = loop.motion(0, 2.0), [parse_term(FAULT)]
    run = loop.run(motion, faults)
    ticks = list(islice(loop.ticks(motion, faults), len(run.log.time)))
    np.testing.assert_array_equal([t.time for t in ticks], run.log.time)
    np.testing.assert_array_equal([t.q for t in ticks], run.log.position)
    np.testing.assert_array_equal([t.effort for t in ticks], run.log.effort)
    np.testing.assert_array_equal([t.desired for t in ticks], motion(run.log.time).q)


def test_a_fault_that_is_switched_on_acts_from_then_on(robot):
    loop = loop_of(robot)
    motion, fault = loop.motion(0, 4.0), parse_term("coulomb_friction@joint2: level=0.3")
    on = {"now": False}
    walk = loop.ticks(motion, [fault], acts=lambda term: on["now"])
    before = list(islice(walk, 200))
    on["now"] = True
    after = list(islice(walk, 200))
    healthy = list(islice(loop.ticks(motion, [fault], acts=lambda term: False), 400))
    torque = lambda ticks: np.array([t.effort[1] for t in ticks])  # noqa: E731
    np.testing.assert_array_equal(torque(before), torque(healthy[:200]))
    assert np.abs(torque(after) - torque(healthy[200:])).max() > 0.2


def test_a_motion_may_be_repeated_without_end(robot):
    motion = loop_of(robot).motion(0, 2.0)
    again = Repeated(motion)
    for whole, part in zip(again([0.7, 2.7, 8.7]), motion(0.7), strict=True):
        np.testing.assert_allclose(whole, np.repeat(part[None], 3, axis=0), atol=1e-9)
    assert again.duration == motion.duration
    assert again(0.7).q.shape == (robot.n,)


@pytest.mark.parametrize("wrong", [{"noise": 1e300}, {"noise": math.nan}, {"rate": math.inf}, {"rate": 1e12}])
def test_settings_that_no_loop_has_are_refused(wrong):
    with pytest.raises(ModelError, match="a closed loop needs"):
        LoopSettings(**wrong)
