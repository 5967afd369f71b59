"""The best physical parameters, also where the solver of the semidefinite program fails."""

import clarabel
import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.effects import CoulombFriction, Payload
from cdia_pin.regression.physical_consistency import consistent_parameters

EFFECTS = [Payload(), CoulombFriction("joint1")]


class PanicException(BaseException):
    """What a panic of the solver looks like from Python."""


def failing(how):
    class Solver:
        def __init__(self, *problem):
            pass

        def solve(self):
            raise how

    return Solver


@pytest.fixture
def wanted():
    rng = np.random.default_rng(0)
    x = rng.standard_normal((300, 11))
    theta = np.array(
        [-5.0, 0, 0, 0.01, 1e-3, 0, 1e-3, 0, 0, 1e-3, -2.0]
    )  # less mass than there is, and friction that drives
    return x.T @ x, x.T @ (x @ theta)


@pytest.mark.parametrize("how", [PanicException("Eigval error"), RuntimeError("no memory")])
def test_a_solver_that_fails_is_a_worse_fit_and_not_the_end(monkeypatch, wanted, how):
    robot = load_robot("double_pendulum")
    best = consistent_parameters(*wanted, EFFECTS, robot)
    monkeypatch.setattr(clarabel, "DefaultSolver", failing(how))
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
