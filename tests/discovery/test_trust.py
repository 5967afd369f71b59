"""Confidence: a repeat that could show an effect and does not speaks against it, one that could not says nothing."""

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.discovery.trust import Repeat, trust_in
from cdia_pin.effects import parse_term
from cdia_pin.logs import Log
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


def test_friction_of_each_joint_comes_before_friction_between_two(robot):
    from cdia_pin.discovery.plain_friction import with_plain_friction

    logs = problem(robot).around(Dynamics(robot))
    shared = Dynamics(robot, (parse_term("coupled_friction@joint1+joint2: coefficient=0.0, level=0.1"),))
    plain = with_plain_friction(logs.with_first_noise(Dynamics(robot)), shared, Dynamics(robot))
    assert {t.label for t in plain.terms} == {"coulomb_friction@joint2"}
    assert plain.find("coulomb_friction@joint2").theta == pytest.approx((0.3,), rel=0.05)
    assert (
        with_plain_friction(logs.with_first_noise(shared), shared, shared) is shared
    )  # what was given stays
