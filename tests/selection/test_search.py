"""The search goes on where one candidate's fit diverges, and takes no drive that could not have moved the arm."""

import numpy as np
import pytest

from cdia_pin import Dynamics, Log, discover, load_robot
from cdia_pin.discovery.trace import trace
from cdia_pin.effects import parse_term
from cdia_pin.errors import EffectError
from cdia_pin.selection import DiscoverySettings, Problem, idle_drives, search
from cdia_pin.selection.simpler import simplified
from tests.made_logs import motion


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def log_of(robot, *terms, torque=None):
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    model = Dynamics(robot, tuple(parse_term(x) for x in terms))
    effort = model.inverse_dynamics(q, v, a)
    effort += np.random.default_rng(0).normal(0.0, 0.02, effort.shape)
    if torque is not None:
        effort[:, 1] = torque(effort[:, 1])
    return Log(robot.joints, t, q, effort)


def problem_of(robot, log):
    model = Dynamics(robot)
    return Problem.conditioned(robot, [log], [], DiscoverySettings()).around(model).with_first_noise(model)


def found(robot, log):
    return {
        t.label
        for t in discover(Dynamics(robot), log, settings=DiscoverySettings(most_effects=4)).model.terms
    }


def test_a_model_costs_what_it_leaves_and_not_what_its_linearisation_promises(robot):
    problem = problem_of(robot, log_of(robot, torque=lambda effort: 1.25 * effort))  # a gain of −0.2
    here, away = (
        search.fitted(problem, Dynamics(robot, (parse_term(f"actuator_gain@joint2: gain={x}"),)))
        for x in (-0.2, 0.3)
    )
    assert here.cost == pytest.approx(here.fit.cost, rel=0.05)
    assert away.cost > 1.5 * max(here.cost, away.fit.cost)


def test_a_linear_model_with_old_parameters_costs_what_it_leaves(robot):
    problem = problem_of(robot, log_of(robot, "coulomb_friction@joint2: level=0.4"))
    old = search.fitted(problem, Dynamics(robot, (parse_term("coulomb_friction@joint2: level=0.2"),)))
    assert old.cost > 1.5 * old.fit.cost


@pytest.mark.parametrize("failure", [EffectError, np.linalg.LinAlgError])
def test_a_candidate_whose_fit_diverges_is_not_the_end_of_the_run(robot, monkeypatch, failure):
    fitted = search.fitted_together

    def diverges(regression, model, *rest):
        if any(t.effect.name == "viscous_friction" for t in model.terms):
            raise failure("it diverges")
        return fitted(regression, model, *rest)

    log = log_of(robot, "coulomb_friction@joint2: level=0.4", "viscous_friction@joint2: coefficient=0.2")
    assert "coulomb_friction@joint2" in found(robot, log)
    monkeypatch.setattr(search, "fitted_together", diverges)
    assert "coulomb_friction@joint2" in found(robot, log)


def test_a_drive_that_could_not_move_the_arm_is_no_name(robot, monkeypatch):
    log = log_of(robot, torque=lambda effort: 2.5 * effort)  # a gain of −0.6
    assert "actuator_gain@joint2" in found(robot, log)
    monkeypatch.setattr(idle_drives, "WEAKEST", -0.4)
    assert "actuator_gain@joint2" not in found(robot, log)


def test_neither_a_search_nor_its_conclusion_keeps_such_a_drive_that_it_begins_with(robot):
    problem = problem_of(robot, log_of(robot, torque=lambda effort: 10.0 * effort))  # a gain of −0.9
    idle = Dynamics(robot, (parse_term("actuator_gain@joint2: gain=-0.9"),))
    ended = search.search(problem, idle, set(), lambda *_: None)
    assert "actuator_gain@joint2" not in {t.label for t in ended.terms}
    assert [t.label for t in trace(problem, Dynamics(robot), idle)[0].terms] == []
    assert [t.label for t in trace(problem, idle, idle)[0].terms] == ["actuator_gain@joint2"]


def test_moves_to_a_drive_that_could_not_move_the_arm_end_the_search_as_others_that_fail(robot, monkeypatch):
    log = log_of(robot, "coulomb_friction@joint2: level=0.4", "viscous_friction@joint1: coefficient=0.3")
    refitted, tried = search._refitted, []
    monkeypatch.setattr(search, "_refitted", lambda *x: tried.append(x) or refitted(*x))
    monkeypatch.setattr(search, "has_idle_drive", lambda model: bool(model.terms))
    monkeypatch.setattr(search, "MOST_REJECTED", 2)
    problem = problem_of(robot, log)
    assert not search.search(problem, Dynamics(robot), set(), lambda *_: None).terms
    assert len(tried) == 2


def test_a_friction_that_does_not_fall_with_the_speed_is_plain_from_the_start(robot):
    log = log_of(robot, "coulomb_friction@joint2: level=0.4")
    start = Dynamics(robot, (parse_term("stribeck_friction@joint2: level=0.3, breakaway=0.1"),))
    nothing_is_tried = search._refitted(problem_of(robot, log), start, {"stribeck_friction@joint2"})
    assert [t.label for t in nothing_is_tried.model.terms] == ["coulomb_friction@joint2"]
    assert nothing_is_tried.fit.physical


def test_a_model_of_distinct_effects_is_not_simplified(robot):
    falls = Dynamics(robot, (parse_term("stribeck_friction@joint2: level=0.3, breakaway=0.1"),))
    assert simplified(falls) is falls
    plain = simplified(Dynamics(robot, (parse_term("stribeck_friction@joint2: level=0.3, breakaway=0.01"),)))
    assert [(t.label, t.theta) for t in plain.terms] == [("coulomb_friction@joint2", (0.3,))]
    of_load = simplified(
        Dynamics(robot, (parse_term("load_stribeck_friction@joint2: coefficient=0.1, breakaway=0.0"),))
    )
    assert [(t.label, t.theta) for t in of_load.terms] == [("load_friction@joint2", (0.1,))]
