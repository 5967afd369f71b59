"""The engine as a whole: on the SCARA plant of another integrator, and on a log."""

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.campaigns.scara_run import Fault, Scenario, run
from cdia_pin.campaigns.thesis_presets import KNOWN, KNOWN_BOUND, UNMODELLED
from cdia_pin.diagnosis.status import Stage, Verdict
from cdia_pin.diagnosis.thesis import ThesisEngine, ThesisSettings
from cdia_pin.dynamics.sensors import Sensors
from cdia_pin.dynamics.simulate import simulate
from cdia_pin.dynamics.trajectories import exciting_trajectory
from cdia_pin.effects import ActuatorGain, CoulombFriction, parse_term
from cdia_pin.errors import ModelError

FRICTION = np.array([[30.0], [15.0], [0.015], [30.0]])


@pytest.fixture(scope="module")
def arm():
    return load_robot("scara")


def coulomb(start=0.5, end=np.inf):
    return Fault(CoulombFriction("joint1"), FRICTION, start, end)


def scenario(*faults, duration=2.0):
    return Scenario(faults, UNMODELLED, duration=duration, tick=2e-3)


def engine(arm, bank=(), **settings):
    return ThesisEngine(arm, bank, ThesisSettings(**{"unmodelled": KNOWN_BOUND, **settings}))


def test_a_healthy_arm_is_never_called_faulty(arm):
    watched = run(scenario(duration=3.0), engine(arm))
    assert watched.events == ()
    assert set(watched.stages) == {Stage.HEALTHY}
    assert (
        np.abs(watched.residual / np.maximum(watched.threshold, 1e-12)).max() > 0.2
    )  # and not for lack of sight


def test_a_fault_is_detected_and_called_unknown_without_a_bank(arm):
    watched = run(scenario(coulomb()), engine(arm))
    assert [e.stage for e in watched.events] == ["detection", "accommodation", "isolation"]
    assert watched.events[0].time == pytest.approx(0.5, abs=0.02)
    assert watched.events[2].verdict is Verdict.UNKNOWN
    assert watched.stages[-1] is Stage.ACCOMMODATED


def test_nothing_is_corrected_unless_asked(arm):
    watching = engine(arm, accommodate=False)
    watched = run(scenario(coulomb()), watching)
    np.testing.assert_array_equal(watched.effort, run(scenario(coulomb())).effort)
    assert [e.stage for e in watched.events] == ["detection", "isolation"]
    np.testing.assert_array_equal(watching.correct(np.ones(4)), np.ones(4))


def test_as_printed_every_filter_is_excluded_before_it_has_learned(arm):
    watched = run(scenario(coulomb()), engine(arm, KNOWN))
    said = [e for e in watched.events if e.stage == "isolation"]
    assert [e.verdict for e in said] == [Verdict.UNKNOWN]
    assert said[0].time - watched.events[0].time < 0.02


def test_with_time_to_learn_the_true_combination_is_the_smallest_of_several_survivors(arm):
    watching = engine(arm, KNOWN, grace=2.0, longest_isolation=2.5)
    watched = run(scenario(coulomb(), duration=3.5), watching)
    said = next(e for e in watched.events if e.stage == "isolation")
    assert said.verdict is Verdict.AMBIGUOUS
    assert {t.effect.name for t in said.faults} == {"coulomb_friction"}
    assert said.alternatives
    level = {t.effect.joint: t.theta[0] for t in said.faults}
    assert level["joint4"] == pytest.approx(30.0, rel=0.15)


def test_a_bank_of_one_isolates_it_and_accommodates_by_it(arm):
    watching = engine(arm, (CoulombFriction,), grace=0.8)
    watched = run(scenario(coulomb(), duration=3.0), watching)
    isolation = next(e for e in watched.events if e.stage == "isolation")
    assert isolation.verdict is Verdict.UNIQUE
    assert watched.events[-1].stage == "accommodation"
    assert "joint4" in isolation.joints
    plain = run(scenario(coulomb(), duration=3.0))
    assert (watched.tracking(2.0)[[0, 1, 3]] < 0.4 * plain.tracking(2.0)[[0, 1, 3]]).all()


def test_a_cleared_fault_is_noticed(arm):
    watching = engine(arm, idle_time=0.4)
    watched = run(scenario(coulomb(0.3, 1.0), duration=3.0), watching)
    idle = [e.time for e in watched.events if e.stage == "idle"]
    assert idle
    assert 1.3 < idle[0] < 3.0
    assert watched.stages[-1] is Stage.IDLE
    np.testing.assert_array_equal(watching.correct(np.ones(4)), np.ones(4))


def test_a_lost_share_of_torque_is_given_back(arm):
    loss = Fault(ActuatorGain("joint1"), np.full((4, 1), -0.3), 0.5)
    plain, watched = (run(scenario(loss, duration=3.0), e) for e in (None, engine(arm)))
    assert (watched.tracking(1.5) < 0.1 * plain.tracking(1.5)).all()


def replay(watching, samples):
    return [watching.update(*sample) for sample in samples]


def test_the_same_samples_give_the_same_events(arm):
    live = engine(arm, KNOWN, grace=0.5, shortest_isolation=0.5, longest_isolation=1.0)
    watched = run(scenario(coulomb()), live)
    before = np.vstack([np.zeros(4), watched.effort[:-1]])
    again = engine(arm, KNOWN, grace=0.5, shortest_isolation=0.5, longest_isolation=1.0)
    samples = list(zip(watched.time, watched.q, watched.v, before, strict=True))
    for watching in (again, live):
        watching.reset()
        status = replay(watching, samples)
        assert tuple(e for s in status for e in s.events) == watched.events
        np.testing.assert_array_equal([s.residual for s in status], watched.residual)


# ------------------------------------------------------------- another arm, with noise


@pytest.fixture(scope="module")
def ur5():
    return load_robot("ur5")


def noisy(robot, seed, *faults):
    motion, noise = np.random.default_rng(seed).spawn(2)
    plant = Dynamics(robot, tuple(parse_term(f) for f in faults))
    return simulate(
        plant, exciting_trajectory(robot, motion, duration=5.0), sensors=Sensors(effort_share=0.01), rng=noise
    )


def play(watching, log):
    return replay(watching, zip(log.time, log.position, log.velocity, log.effort, strict=True))


def test_the_bound_learned_from_healthy_runs_holds_on_others_and_not_on_faulty_ones(ur5):
    watching = ThesisEngine(ur5, healthy=[noisy(ur5, 1), noisy(ur5, 2)])
    assert not any(status.events for status in play(watching, noisy(ur5, 3)))
    watching.reset()
    faulty = noisy(ur5, 3, "coulomb_friction@elbow_joint: level=6, after=2")
    first = next(e for status in play(watching, faulty) for e in status.events)
    assert first.stage == "detection"
    assert "elbow_joint" in first.joints
    assert 2.0 <= first.time < 2.5


# ------------------------------------------------------------- bad data


@pytest.mark.parametrize(
    ("sample", "said"),
    [
        ((0.002, np.full(4, np.nan), np.zeros(4), np.zeros(4)), "position of joint1 must be finite"),
        ((0.002, np.zeros(4), np.array([0, 0, np.inf, 0]), np.zeros(4)), "velocity of joint3"),
        ((0.002, np.zeros(4), np.zeros(4), np.zeros(3)), r"torque: expected .* \(4,\), given \(3,\)"),
        ((0.0, np.zeros(4), np.zeros(4), np.zeros(4)), "time must increase"),
        ((-1.0, np.zeros(4), np.zeros(4), np.zeros(4)), "time must increase"),
        ((np.nan, np.zeros(4), np.zeros(4), np.zeros(4)), "time must be finite"),
        ((3.0, np.zeros(4), np.zeros(4), np.zeros(4)), "no sample for 3 s"),
        ((0.002, np.zeros(4), np.full(4, 1e200), np.zeros(4)), "is too large"),
    ],
)
def test_bad_samples_are_refused_and_leave_no_trace(arm, sample, said):
    hold = np.array([0, 0, 0, 294.0])
    good = [(0.0, np.zeros(4), np.zeros(4), hold), (0.004, np.zeros(4), np.zeros(4), hold)]
    spoilt, clean = engine(arm), engine(arm)
    spoilt.update(*good[0])
    with pytest.raises(ModelError, match=said) as error:
        spoilt.update(*sample)
    assert "\n" not in str(error.value)
    after = spoilt.update(*good[1])
    np.testing.assert_array_equal(after.residual, replay(clean, good)[-1].residual)


def test_a_nominal_torque_that_is_not_finite_is_returned_unchanged(arm):
    watching = engine(arm)
    run(scenario(coulomb()), watching)
    assert not np.array_equal(watching.correct(np.ones(4)), np.ones(4))
    np.testing.assert_array_equal(watching.correct([np.nan, 1, 1, 1]), [np.nan, 1, 1, 1])
    with pytest.raises(ModelError, match="one number per joint"):
        watching.correct([1.0, 2.0])


def test_velocities_are_needed(arm):
    with pytest.raises(ModelError, match="use the engine momentum"):
        engine(arm).update(0.0, np.zeros(4), None, np.zeros(4))


def test_at_rest_dry_friction_is_compensated_in_the_desired_direction(arm):
    watching = engine(arm, (CoulombFriction,), grace=0.8)
    run(scenario(coulomb()), watching)
    assert watching.faults
    nominal = np.array([0.0, 0.0, 0.0, 294.0])
    forth, back = (watching.correct(nominal, sign * np.full(4, 0.5)) - nominal for sign in (1.0, -1.0))
    np.testing.assert_allclose(forth, -back)
    assert (forth > 0).all()


def test_a_bound_of_the_unmodelled_torque_is_needed(arm):
    with pytest.raises(ModelError, match="give unmodelled= or healthy runs"):
        ThesisEngine(arm)
    with pytest.raises(ModelError, match="one for each of joint1, joint2"):
        engine(arm, unmodelled=(1.0, 2.0))


# ------------------------------------------------------------- a second fault


def test_a_second_fault_is_detected_beside_the_isolated_one_and_accommodated(arm):
    loss = Fault(ActuatorGain("joint1"), np.full((4, 1), -0.3), 2.5)
    both = scenario(coulomb(), loss, duration=4.5)
    watching = engine(arm, (CoulombFriction,), grace=0.8)
    watched = run(both, watching)
    detections = [e.time for e in watched.events if e.stage == "detection"]
    assert len(detections) == 2
    assert 2.5 + watching.settings.readapt <= detections[1] < 3.2
    assert {t.effect.name for t in watched.events[2].faults} == {"coulomb_friction"}
    assert (watched.tracking(3.5) < 0.3 * run(both).tracking(3.5)).all()
