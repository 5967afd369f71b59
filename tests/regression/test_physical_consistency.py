"""The best physical parameters, also where the solver of the semidefinite program fails."""

import clarabel
import numpy as np
import pytest

from cdia_pin import Dynamics, Log, load_robot
from cdia_pin.discovery import add_effect
from cdia_pin.effects import CoulombFriction, Payload, TorqueOffset, parse_term
from cdia_pin.identification import identify
from cdia_pin.regression.physical_consistency import consistent_parameters
from tests.made_logs import motion

EFFECTS = [Payload(), CoulombFriction("joint1")]


class PanicException(BaseException):
    """What a panic of the solver looks like from Python."""


def failing(how, at_once=False):
    class Solver:
        def __init__(self, *problem):
            if at_once:
                raise how

        def solve(self):
            raise how

    return Solver


class NoNumbers:
    """A solver that claims success without numbers."""

    status = "Solved"
    x = (np.nan,) * 11

    def __init__(self, *problem):
        pass

    def solve(self):
        return self


@pytest.fixture
def wanted():
    rng = np.random.default_rng(0)
    x = rng.standard_normal((300, 11))
    theta = np.array(
        [-5.0, 0, 0, 0.01, 1e-3, 0, 1e-3, 0, 0, 1e-3, -2.0]
    )  # less mass than there is, and friction that drives
    return x.T @ x, x.T @ (x @ theta)


FAILURES = {
    "panic": failing(PanicException("Eigval error")),
    "error": failing(RuntimeError("no memory")),
    "refused": failing(ValueError("not a cone"), at_once=True),
    "panic at once": failing(PanicException("index out of bounds"), at_once=True),
    "no numbers": NoNumbers,
}


@pytest.mark.parametrize("how", FAILURES)
def test_a_solver_that_fails_is_a_worse_fit_and_not_the_end(monkeypatch, wanted, how):
    robot = load_robot("double_pendulum")
    best = consistent_parameters(*wanted, EFFECTS, robot)
    monkeypatch.setattr(clarabel, "DefaultSolver", FAILURES[how])
    found = consistent_parameters(*wanted, EFFECTS, robot)
    gram, right = wanted
    cost = lambda p: 0.5 * p @ gram @ p - right @ p  # noqa: E731
    assert all(e.is_physical(part, robot) for e, part in zip(EFFECTS, (found[:10], found[10:]), strict=True))
    assert cost(found) >= cost(best) - 1e-6 * abs(cost(best))


@pytest.mark.parametrize("how", [KeyboardInterrupt(), SystemExit(3)])
def test_an_interrupt_is_no_failure_of_the_solver(monkeypatch, wanted, how):
    monkeypatch.setattr(clarabel, "DefaultSolver", failing(how))
    with pytest.raises(type(how)):
        consistent_parameters(*wanted, EFFECTS, load_robot("double_pendulum"))


def test_without_its_solver_a_run_ends_with_a_result(monkeypatch):
    robot = load_robot("double_pendulum")
    t, q, v, a = motion(robot.n, 3, duration=10.0)
    effort = Dynamics(robot, (parse_term("payload: mass=0.5"),)).inverse_dynamics(q, v, a)
    noise = np.random.default_rng(0).normal(0.0, 0.01, effort.shape)
    log = Log(robot.joints, t, q, effort + noise)
    monkeypatch.setattr(clarabel, "DefaultSolver", FAILURES["panic"])
    added = add_effect(Dynamics(robot), Payload(), log)
    assert added.trace[1].heldout_rms.sum() < 0.5 * added.trace[0].heldout_rms.sum()
    assert np.isfinite(identify(Dynamics(robot), log).model.terms[0].theta).all()


def test_parameters_without_any_bound_need_no_solver(monkeypatch):
    monkeypatch.setattr(clarabel, "DefaultSolver", FAILURES["error"])
    theta = consistent_parameters(
        np.eye(1), np.array([-2.0]), [TorqueOffset("joint1")], load_robot("double_pendulum")
    )
    np.testing.assert_allclose(theta, [-2.0])
