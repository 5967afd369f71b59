"""The SCARA arm that ships is the thesis' closed form; the printed form is not a rigid body."""

import numpy as np
import pytest

from cdia_pin import robot as package
from cdia_pin.errors import RobotError
from cdia_pin.robot import scara


@pytest.fixture(scope="module")
def arm():
    return package.load_robot("scara")


@pytest.fixture(scope="module")
def states():
    rng = np.random.default_rng(7)
    speed = np.array([10 / 3 * np.pi, 5 * np.pi, 55 / 3 * np.pi, 1.2])  # table 1
    return rng.uniform(-np.pi, np.pi, (1000, 4)), rng.uniform(-speed, speed, (1000, 4))


def test_mass_matrix_is_that_of_the_urdf(arm, states):
    q, _ = states
    np.testing.assert_allclose(scara.mass_matrix(q), arm.mass_matrix(q), rtol=0, atol=1e-11)


def test_velocity_torques_are_those_of_the_urdf(arm, states):
    q, v = states
    expected = arm.nonlinear_effects(q, v) - arm.gravity(q)
    np.testing.assert_allclose(scara.velocity_torques(q, v), expected, rtol=0, atol=1e-11)


def test_gravity_lifts_the_quill_only(arm, states):
    q, _ = states
    np.testing.assert_allclose(scara.gravity_torques(q), arm.gravity(q), rtol=0, atol=1e-11)
    np.testing.assert_array_equal(scara.gravity_torques(np.zeros(4)), [0, 0, 0, 30.0 * 9.8])


def test_gravity_is_the_thesis_own(arm):
    np.testing.assert_array_equal(arm.gravity_vector, [0, 0, -9.8])


def test_limits_are_those_of_table_1(arm):
    pi = np.pi
    np.testing.assert_allclose(arm.limits.upper, [5 / 6 * pi, 7 / 9 * pi, 3 / 2 * pi, 0.2])
    np.testing.assert_allclose(arm.limits.lower, [-5 / 6 * pi, -7 / 9 * pi, -3 / 2 * pi, 0.0])
    np.testing.assert_allclose(arm.limits.velocity, [10 / 3 * pi, 5 * pi, 55 / 3 * pi, 1.2])
    assert np.isinf(arm.limits.effort).all()


def mass_matrix_rate(q, v, step=1e-6):
    return (scara.mass_matrix(q + step * v) - scara.mass_matrix(q - step * v)) / (2 * step)


def power_error(q, v, torques):
    """v·(½ Ṁ v − V) [W]: zero if velocity torques neither create nor take energy."""
    kinetic = 0.5 * np.einsum("ni,nij,nj->n", v, mass_matrix_rate(q, v), v)
    return np.abs(kinetic - np.einsum("ni,ni->n", v, torques)).max()


def test_velocity_torques_do_no_work_beyond_the_kinetic_energy(states):
    q, v = states
    assert power_error(q, v, scara.velocity_torques(q, v)) < 1e-3  # of 1e5 W


def test_printed_velocity_torques_create_energy(states):
    q, v = states
    assert power_error(q, v, scara.printed_velocity_torques(q, v)) > 1e4


def test_printed_mass_matrix_leaves_out_the_quills_inertia(states):
    q, _ = states
    difference = scara.mass_matrix(q) - scara.printed_mass_matrix(q)
    np.testing.assert_allclose(difference[:, :2, :2], 0.006, atol=1e-12)
    np.testing.assert_array_equal(difference[:, 2:], 0.0)


def test_one_sample_equals_a_batch(states):
    q, v = states
    for term in (scara.velocity_torques, scara.printed_velocity_torques, scara.nonlinear_effects):
        np.testing.assert_array_equal(term(q[3], v[3]), term(q, v)[3])
    np.testing.assert_array_equal(scara.mass_matrix(q[3]), scara.mass_matrix(q)[3])


def test_a_state_of_the_wrong_size_is_refused():
    with pytest.raises(RobotError, match="4 joints"):
        scara.mass_matrix(np.zeros(3))


def test_scara_can_be_drawn_without_meshes(arm):
    text = arm.urdf.read_text()
    assert "<mesh" not in text
    assert text.count("<visual>") >= 5
