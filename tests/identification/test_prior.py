"""The distance to the URDF: laws of the metric, and what becomes of odd links."""

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.effects import LinkInertia, Payload
from cdia_pin.identification.prior import metric, urdf_precision
from cdia_pin.robot.inertia import parameters_of, pseudo_inertia, transform_parameters

BODY = parameters_of(3.0, [0.02, -0.1, 0.3], np.diag([0.05, 0.08, 0.06]))


def pose(seed=0):
    rotation = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    out = np.eye(4)
    out[:3, :3] = rotation * np.sign(np.linalg.det(rotation))
    out[:3, 3] = [0.2, -0.4, 0.1]
    return out


def length(precision, change):
    return float(change @ precision @ change)


def test_a_body_that_becomes_twice_itself_has_gone_the_same_way_whatever_it_is():
    for body in (BODY, 0.01 * BODY):
        assert length(metric(pseudo_inertia(body)), body) == pytest.approx(2.0)


def test_it_does_not_depend_on_the_frame():
    A = transform_parameters(pose())
    change = np.random.default_rng(1).normal(size=10)
    here, there = (metric(pseudo_inertia(b)) for b in (BODY, A @ BODY))
    assert length(there, A @ change) == pytest.approx(length(here, change))


def test_it_does_not_depend_on_units():
    grams = np.array([1e3] * 10)
    millimetres = np.array([1.0] + [1e3] * 3 + [1e6] * 6)
    change = np.random.default_rng(2).normal(size=10)
    for unit in (grams, millimetres):
        assert length(metric(pseudo_inertia(unit * BODY)), unit * change) == pytest.approx(
            length(metric(pseudo_inertia(BODY)), change)
        )


def test_it_is_a_metric():
    values = np.linalg.eigvalsh(metric(pseudo_inertia(BODY)))
    assert values.min() > 0


def test_a_heavy_link_may_change_more_than_a_light_one():
    robot = load_robot("ur5")
    kilogram = np.eye(10)[0]
    by_mass = sorted(robot.joints, key=lambda j: robot.inertial_parameters[robot.joint_index(j), 0])
    light, heavy = (urdf_precision(LinkInertia(j), robot)[0, 0] for j in (by_mass[0], by_mass[-1]))
    assert heavy < light
    assert kilogram @ urdf_precision(LinkInertia(by_mass[-1]), robot) @ kilogram > 0


def test_a_link_without_mass_has_a_finite_precision():
    robot = load_robot("ur5")
    parameters = robot.inertial_parameters.copy()
    parameters[2] = 0.0
    precision = urdf_precision(LinkInertia(robot.joints[2]), robot.with_inertial_parameters(parameters))
    assert np.isfinite(precision).all()
    assert np.linalg.eigvalsh(precision).min() > 0


def test_a_tool_is_as_far_as_the_same_change_of_its_link():
    robot = load_robot("ur5")
    link, tool = LinkInertia(robot.tool_joint), Payload()
    change = np.random.default_rng(4).normal(size=10)
    A = tool.to_joint_frame(robot)
    assert length(urdf_precision(tool, robot), change) == pytest.approx(
        length(urdf_precision(link, robot), A @ change)
    )
