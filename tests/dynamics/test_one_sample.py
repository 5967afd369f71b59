"""One sample at a time gives the accelerations that arrays over samples give, for every kind of term."""

import numpy as np
import pytest

from cdia_pin.dynamics import Dynamics
from cdia_pin.dynamics.one_sample import OneSample, carrying
from cdia_pin.effects import parse_term
from cdia_pin.robot import load_robot

WIDTH = 0.05  # [rad/s], over which sgn is smoothed
PLANTS = {
    "nothing": (),
    "friction": ("coulomb_friction@{1}: level=4, after=0.5", "viscous_friction@{1}: coefficient=3"),
    "several of one joint": (
        "actuator_gain@{0}: gain=-0.3",
        "stribeck_friction@{0}: level=2, breakaway=1",
        "joint_spring@{0}: stiffness=3, preload=1",
        "position_ripple@{0}: sine=1, cosine=2",
        "torque_offset@{0}: offset=2",
    ),
    "a line of arithmetic": ("-k*q**3 + c*tau@{2}: k=2, c=0.1",),
    "a rotor": ("rotor_inertia@{0}: inertia=0.3", "coulomb_friction@{2}: level=1"),
    "a rotor of late": ("rotor_inertia@{2}: inertia=0.1, after=0.5", "rotor_inertia@{1}: inertia=0.1"),
    "a payload": ("payload: mass=2, first_moment_z=0.1, after=0.5", "viscous_friction@{1}: coefficient=3"),
    "a payload and a rotor": ("payload: mass=2", "rotor_inertia@{0}: inertia=0.3"),
    "a body that is not possible": ("payload: mass=0.1, inertia_xx=-0.001",),
    "a tilt and a payload": ("base_tilt: tilt_x=0.05, tilt_y=0.1", "payload: mass=2"),
    "a medium": ("viscous_medium: drag=3", "coulomb_friction@{2}: level=1"),
}


def plant(robot, terms) -> Dynamics:
    return Dynamics(robot, tuple(parse_term(t.format(*robot.joints), robot) for t in terms))


@pytest.mark.parametrize("arm", ["ur5", "panda"])
@pytest.mark.parametrize("terms", PLANTS.values(), ids=PLANTS)
def test_it_is_the_forward_dynamics(arm, terms) -> None:
    robot = load_robot(arm)
    model = plant(robot, terms)
    width = np.full(robot.n, WIDTH)
    sample, rng = OneSample(model, width), np.random.default_rng(1)
    time = np.linspace(0.0, 1.0, 6)
    sample.look_ahead(time)
    for k, t in enumerate(time.tolist()):
        q, v, tau = rng.standard_normal((3, robot.n))
        expected = model.forward_dynamics(q, v, 20 * tau, t, width)
        found = sample.acceleration(k, q, v, 20 * tau)
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_a_robot_carries_a_body_or_says_that_it_cannot() -> None:
    robot = load_robot("ur5")
    terms = plant(robot, ("payload: mass=2",)).terms
    assert carrying(robot, terms, [0.0]) is robot
    loaded = carrying(robot, terms, [1.0])
    assert loaded is not None
    assert loaded.total_mass == pytest.approx(robot.total_mass + 2)
    assert carrying(robot, plant(robot, ("payload: mass=-50",)).terms, [1.0]) is None
