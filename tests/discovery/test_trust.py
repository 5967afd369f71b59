"""Confidence: a repeat that could show an effect and does not speaks against it, one that could not says nothing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.changes.confidence import Confidence
from cdia_pin.discovery.decision import Repeat
from cdia_pin.discovery.trust import Trust, _without_descriptive, trust_in, variations
from cdia_pin.effects import (
    CoulombFriction,
    Drift,
    LinkInertias,
    LoadFriction,
    PerLog,
    Term,
    ViscousFriction,
    parse_effect,
    parse_term,
)
from cdia_pin.effects.refinements import is_plain
from cdia_pin.logs import Log
from cdia_pin.regression.block_evidence import BlockFits
from cdia_pin.regression.effort_scale import doubted_scale
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.problem import Problem
from tests.made_logs import motion

FRICTION = parse_term("coulomb_friction@joint2: level=0.3")


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def problem(robot, present=np.ones_like, until=np.inf):
    """Friction of a joint that is there at some times only, or a joint that stays where it is from some time on."""
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    stays = t >= until
    q[stays, 1] = q[np.argmax(stays), 1]
    v[stays, 1] = a[stays, 1] = 0.0
    effort = Dynamics(robot).inverse_dynamics(q, v, a)
    effort[:, 1] += 0.3 * np.sign(v[:, 1]) * present(t)
    log = Log(robot.joints, t, q, effort + np.random.default_rng(0).normal(0.0, 0.03, effort.shape))
    return Problem.conditioned(robot, [log], [], DiscoverySettings())


def confidence(logs, robot):
    model = Dynamics(robot, (FRICTION,))
    return trust_in(logs, model, Dynamics(robot))[FRICTION.label].confidence


def test_what_both_halves_show_is_established(robot):
    assert confidence(problem(robot), robot) == "established"


def test_what_one_half_could_show_and_does_not_is_not_established(robot):
    logs = problem(robot, present=lambda t: (t < 12.0).astype(float))
    assert confidence(logs, robot) != "established"


def test_a_half_in_which_the_joint_hardly_moves_says_nothing(robot):
    logs = problem(robot, until=11.5)
    model = Dynamics(robot, (FRICTION,))
    rests = Repeat(logs.design, model, logs.settings, part=1)
    assert not rests.could_show(FRICTION, np.array(FRICTION.theta))
    assert confidence(logs, robot) == "established"


def test_an_effect_that_is_smaller_than_what_is_left_is_not_established(robot):
    t, q, v, a = motion(robot.n, 5, duration=240.0)
    effort = Dynamics(robot).inverse_dynamics(q, v, a)
    effort[:, 1] += 0.3 * np.sign(v[:, 1]) + np.sin(9 * q[:, 1])
    log = Log(robot.joints, t, q, effort)
    logs = Problem.conditioned(robot, [log], [], DiscoverySettings())
    assert confidence(logs, robot) == "likely"
    effort[:, 1] -= 0.9 * np.sin(9 * q[:, 1])
    assert confidence(Problem.conditioned(robot, [log], [], DiscoverySettings()), robot) == "established"


@pytest.mark.parametrize("silent", [(0,), (1,), (0, 1)])
def test_an_effect_that_not_every_joint_has_must_be_shown_by_each_half_of_the_log(robot, silent):
    rotor = parse_term("rotor_inertia@joint2: inertia=0.05")
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    effort = Dynamics(robot, (rotor,)).inverse_dynamics(q, v, a)
    effort += np.random.default_rng(0).normal(0.0, 0.03, effort.shape)

    def said(halves_tell):
        log = Log(robot.joints, t, q, effort)
        logs = Problem.conditioned(robot, [log], [], DiscoverySettings())
        could, survives = Repeat.could_show, Repeat.survives
        with pytest.MonkeyPatch.context() as patch:
            if not halves_tell:
                patch.setattr(Repeat, "could_show", lambda r, *x: r.part not in silent and could(r, *x))
                patch.setattr(Repeat, "survives", lambda r, *x: r.part not in silent and survives(r, *x))
            return trust_in(logs, Dynamics(robot, (rotor,)), Dynamics(robot))[rotor.label].confidence

    assert said(halves_tell=True) == "established"
    assert said(halves_tell=False) == "likely"


def test_an_effect_that_not_every_joint_has_must_be_of_one_size_in_all_of_the_log(robot):
    offset = parse_term("torque_offset@joint2: offset=-0.5")
    t, q, v, a = motion(robot.n, 5, duration=48.0)

    def said(term, early, late):
        effort = Dynamics(robot).inverse_dynamics(q, v, a)
        size = np.where(t < 24.0, early, late)
        effort[:, 1] += size if term is offset else size * np.sign(v[:, 1])
        effort += np.random.default_rng(0).normal(0.0, 0.03, effort.shape)
        logs = Problem.conditioned(robot, [Log(robot.joints, t, q, effort)], [], DiscoverySettings())
        return trust_in(logs, Dynamics(robot, (term,)), Dynamics(robot))[term.label].confidence

    assert said(offset, 0.5, 0.5) == said(offset, 0.45, 0.55) == "established"
    assert said(offset, 0.25, 0.75) == "likely"
    assert said(FRICTION, 0.18, 0.42) == "established"  # every joint has friction, whatever its size


@pytest.mark.parametrize(("resting", "said"), [([], "established"), ([0], "descriptive"), ([0, 1], "likely")])
def test_what_only_a_joint_at_rest_shows_is_descriptive_beside_one_that_moves(robot, resting, said):
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    # static friction may carry a part of its load
    q[:, resting], v[:, resting], a[:, resting] = 0.4, 0.0, 0.0
    effort = Dynamics(robot).inverse_dynamics(q, v, a)
    effort[:, 0] += 0.5
    effort[:, 1] += 0.3 * np.sign(v[:, 1])
    log = Log(robot.joints, t, q, effort + np.random.default_rng(0).normal(0.0, 0.03, effort.shape))
    logs = Problem.conditioned(robot, [log], [], DiscoverySettings())
    offset = parse_term("torque_offset@joint1: offset=-0.5")
    found = trust_in(logs, Dynamics(robot, (FRICTION, offset)), Dynamics(robot))
    assert found[offset.label].confidence == said
    assert (found[FRICTION.label].confidence == "established") == (1 not in resting)


def test_one_block_whose_motion_no_other_has_does_not_speak_against_an_effect(robot, monkeypatch):
    logs = problem(robot)
    whole = Repeat(logs.design, Dynamics(robot, (FRICTION,)), logs.settings)
    unlike = BlockFits((np.array([0.3]),), np.full((2, 1), 9.0), np.array([[4.0, 5.0, -100.0, 3.0]]))
    monkeypatch.setattr(Repeat, "_beside", lambda *_: unlike)
    assert whole.survives(FRICTION)
    assert not whole.survives(FRICTION, spared=0)
    two = BlockFits(unlike.theta, unlike.certainties, np.array([[4.0, -50.0, -100.0, 3.0]]))
    monkeypatch.setattr(Repeat, "_beside", lambda *_: two)
    assert not whole.survives(FRICTION)


def test_what_every_joint_has_stays_as_it_is():
    coulomb = CoulombFriction("joint1")
    assert is_plain(coulomb) and is_plain(ViscousFriction("joint1"))
    assert not is_plain(Drift(coulomb, 0.0, 10.0, 3.0)) and not is_plain(LoadFriction("joint1"))


@pytest.mark.parametrize(("moving", "said"), [(24.0, "established"), (2.0, "likely")])
def test_what_one_short_motion_shows_is_not_established(robot, moving, said):
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    late = t > moving
    q[late, 1], v[late, 1], a[late, 1] = q[~late][-1, 1], 0.0, 0.0
    effort = Dynamics(robot).inverse_dynamics(q, v, a)
    effort[:, 1] += 0.3 * np.sign(v[:, 1])
    log = Log(robot.joints, t, q, effort + np.random.default_rng(0).normal(0.0, 0.03, effort.shape))
    logs = Problem.conditioned(robot, [log], [], DiscoverySettings())
    assert trust_in(logs, Dynamics(robot, (FRICTION,)), Dynamics(robot))[FRICTION.label].confidence == said


@pytest.mark.parametrize("durations", [(24.0, 24.0), (24.0, 48.0)])
def test_a_half_is_a_half_of_every_log(robot, durations):
    logs = []
    for seed, (duration, coefficient) in enumerate(zip(durations, (0.3, 0.6), strict=True)):
        t, q, v, a = motion(robot.n, seed, duration=duration)
        effort = robot.inverse_dynamics(q, v, a)
        effort[:, 1] += coefficient * v[:, 1]
        effort += np.random.default_rng(seed).normal(0.0, 0.01, effort.shape)
        logs.append(Log(robot.joints, t, q, effort, source=f"{seed}.csv"))
    friction = Term(PerLog(ViscousFriction("joint2"), ("0.csv", "1.csv")), (0.3, 0.6))
    both = Problem.conditioned(robot, logs, [], DiscoverySettings())
    trust = trust_in(both, Dynamics(robot, (friction,)), Dynamics(robot))[friction.label]
    assert trust.confidence == "established"
    assert max(trust.systematic) < 0.01


def test_repeats_leave_out_the_samples_at_which_friction_between_two_joints_may_stick(robot):
    logs = problem(robot)
    coupled = Dynamics(robot, (parse_term("coupled_friction@joint1+joint2: level=0.2, coefficient=0.1"),))
    wrong_links = [
        x
        for x in variations(logs, coupled)
        if x.segments[0].motion.cutoff == logs.experiment.segments[0].motion.cutoff
    ]
    assert wrong_links
    sticking = logs.without_rest_of([coupled.terms[0].effect]).experiment.moving
    assert sticking.sum() < 0.9 * logs.experiment.moving.sum()
    for x in wrong_links:
        np.testing.assert_array_equal(x.moving, sticking)


def test_noise_alone_is_not_certain_whatever_the_number_of_parameters():
    robot = load_robot("ur5")
    t, q, v, a = motion(robot.n, 1, rate=50.0)
    effort = robot.inverse_dynamics(q, v, a)
    effort += np.random.default_rng(1).normal(0.0, 0.3, effort.shape)
    logs = Problem.conditioned(robot, [Log(robot.joints, t, q, effort)], [], DiscoverySettings())
    every = LinkInertias(robot.joints)
    term = Term(every, (0.0,) * every.size)
    whole = Repeat.of(logs, Dynamics(robot, (term,)))
    for repeat in (whole, *whole.halves):
        assert repeat.certainty(term) < 3.0


def test_a_gain_that_may_be_something_else_leaves_the_scale_of_its_joint_open():
    robot = load_robot("scara")
    one, other = robot.joints[:2]
    terms = map(parse_term, (f"actuator_gain@{other}: gain=-0.6", f"coulomb_friction@{other}: level=0.4"))
    doubt = doubted_scale(terms, robot)
    assert doubt[robot.joint_index(other)] == pytest.approx(1.5)
    assert doubt[robot.joint_index(one)] == 0.0


def test_what_only_descriptive_effects_hold_up_is_likely(robot):
    """A spring over the little that a joint moves is nearly an offset: each is large only beside the other."""
    spring = Term(parse_effect("joint_spring@joint2"), (4.0, 0.0)).with_intervals(np.array([0.5, 0.5]))
    gain = parse_term("actuator_gain@joint1: gain=0.2")
    sure = Trust(Confidence.ESTABLISHED, np.zeros(1), np.zeros(1))
    trust = {
        FRICTION.label: sure,
        spring.label: replace(sure, confidence=Confidence.DESCRIPTIVE),
        gain.label: replace(sure, confidence=Confidence.DESCRIPTIVE),
    }

    def said(without):
        whole = SimpleNamespace(
            model=Dynamics(robot, (FRICTION, spring, gain)),
            theta=lambda term: np.array([0.3]),
            theta_without=lambda term, left_out: np.array([without]) if left_out == [spring] else None,
            covariance=lambda term: np.array([[0.01**2]]),
        )
        return _without_descriptive(FRICTION, whole, trust)

    assert said(0.31) == sure
    assert said(0.10).confidence == "likely"
    assert said(0.10).systematic == pytest.approx(0.2)


def test_parameters_without_others_are_those_of_a_fit_without_them(robot):
    logs = problem(robot)
    viscous = parse_term("viscous_friction@joint2: coefficient=0.05")
    both, alone = (Repeat.of(logs, Dynamics(robot, terms)) for terms in ((FRICTION, viscous), (FRICTION,)))
    assert both.theta_without(FRICTION, [viscous]) == pytest.approx(alone.theta(FRICTION), rel=0.02)
    assert both.theta_without(FRICTION, []) == pytest.approx(both.theta(FRICTION))
