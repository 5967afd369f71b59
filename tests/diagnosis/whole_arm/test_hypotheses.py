"""Effects of the whole arm: their columns, and the arm that carries them."""

from __future__ import annotations

import numpy as np
import pytest

from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.whole_arm.belief import added_torque, carried, is_possible
from cdia_pin.diagnosis.whole_arm.hypotheses import HYPOTHESES
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import BaseTilt, Term
from cdia_pin.robot import load_robot
from cdia_pin.robot.inertia import is_physical, parameters_of

ROBOT = load_robot("ur5")
RNG = np.random.default_rng(2)
Q, V, A = (RNG.uniform(-1, 1, ROBOT.n) for _ in range(3))
PAYLOAD, TILT = HYPOTHESES
NUMBERS = {"payload": np.array([1.3, 0.05, -0.02, 0.06]), "base_tilt": np.array([0.01, -0.02])}


@pytest.mark.parametrize("hypothesis", HYPOTHESES, ids=lambda h: h.effect.name)
def test_columns_are_the_torque_of_the_arm_that_carries_it(hypothesis) -> None:
    theta = NUMBERS[hypothesis.effect.name]
    columns = np.hstack(ROBOT.regressors(Q, V, A)) @ hypothesis.on_regressors(ROBOT)
    now = carried(Nominal.of(Dynamics(ROBOT)), (hypothesis.term(theta, np.zeros(hypothesis.shown)),))
    lacking = ROBOT.inverse_dynamics(Q, V, A) - now.inverse_dynamics(Q, V, A)
    largest = np.abs(lacking).max()
    np.testing.assert_allclose(columns @ theta, lacking, atol=0.02 * largest)


def test_a_payload_of_any_mass_and_place_is_a_possible_body() -> None:
    for mass, centre in ((0.3, (0, 0, 0)), (2.0, (0.1, -0.2, 0.3))):
        term = PAYLOAD.term(np.array([mass, *(mass * np.array(centre))]), np.zeros(4))
        np.testing.assert_allclose(
            term.theta, parameters_of(mass, centre, 0.4 * mass * 0.05**2 * np.eye(3)), atol=1e-12
        )
        assert is_physical(term.theta)


@pytest.mark.parametrize("inertia_left", [1.0, -0.2])
def test_a_link_that_is_no_possible_body_carries_a_payload(inertia_left: float) -> None:
    """Healthy runs correct sums of parameters alone; the links that come out of it need not be possible."""
    pi = ROBOT.inertial_parameters.copy()
    pi[-1, 4:] *= inertia_left
    robot = ROBOT.with_inertial_parameters(pi)
    assert is_physical(pi[-1]) == (inertia_left > 0)

    def may_carry(mass: float, centre: tuple[float, float, float]) -> bool:
        return is_possible(PAYLOAD.term(np.array([mass, *(mass * np.array(centre))]), np.zeros(4)), robot)

    assert may_carry(0.3, (0.02, -0.05, 0.1))
    beyond_reach = (2.0, 0.0, 0.0)  # a moment without the inertia that belongs to it
    assert not may_carry(0.3, beyond_reach)
    assert not may_carry(-1.1 * pi[-1, 0], (0.0, 0.0, 0.0))


def test_a_base_tilts_no_further_than_gravity_reaches() -> None:
    assert is_possible(Term(BaseTilt(), (3.0, 3.0)), ROBOT)
    assert not is_possible(Term(BaseTilt(), (9.0, 9.0)), ROBOT)


def test_nothing_believed_is_the_healthy_arm_itself() -> None:
    nominal = Nominal.of(Dynamics(ROBOT))
    assert carried(nominal, ()) is nominal.robot


def test_the_added_torque_moves_the_heavier_arm_as_the_healthy_one() -> None:
    nominal = Nominal.of(Dynamics(ROBOT))
    terms = (PAYLOAD.term(NUMBERS["payload"], np.zeros(4)), Term(BaseTilt(), (0.3, 0.1)))
    now = carried(nominal, terms)
    tau = RNG.normal(size=ROBOT.n) * 20
    wanted = ROBOT.forward_dynamics(Q, V, tau)
    np.testing.assert_allclose(
        now.forward_dynamics(Q, V, tau + added_torque(ROBOT, now, Q, V, tau)), wanted, rtol=1e-6
    )
