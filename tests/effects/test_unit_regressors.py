"""An effect of the rigid bodies is a matrix on the arm's regressors, which comes from its own source."""

import numpy as np
import pytest

from cdia_pin.effects import BaseTilt, Payload, State
from cdia_pin.effects.unit_regressors import on_regressors
from cdia_pin.robot import load_robot

RNG = np.random.default_rng(5)


@pytest.mark.parametrize("effect", [Payload(), BaseTilt()], ids=lambda e: e.name)
@pytest.mark.parametrize("name", ["ur5", "scara", "double_pendulum"])
def test_the_matrix_gives_the_effects_own_columns(name, effect) -> None:
    robot = load_robot(name)
    q, v, a = RNG.uniform(-1, 1, (3, robot.n))
    own = effect.jacobian(State.of(robot, q, v, a), np.zeros(effect.size))[0]
    np.testing.assert_allclose(
        np.hstack(robot.regressors(q, v, a)) @ on_regressors(effect, robot),
        own,
        atol=1e-12 * np.abs(own).max(),
    )


def test_without_gravity_a_tilt_does_nothing() -> None:
    robot = load_robot("ur5").with_gravity(np.zeros(3))
    assert not on_regressors(BaseTilt(), robot).any()
