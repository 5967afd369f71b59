"""Ten inertial parameters: changes of frame are those of rigid bodies, and bodies that cannot be are told."""

import numpy as np
import pinocchio as pin
import pytest

from cdia_pin.errors import RobotError
from cdia_pin.robot.inertia import (
    at_centre_of_mass,
    from_pseudo_inertia,
    is_physical,
    parameters_of,
    physical_margin,
    pseudo_inertia,
    transform_parameters,
)


def cloud(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Point masses [kg] at places [m]: a body that exists by construction."""
    return rng.uniform(0.1, 1.0, 12), rng.normal(0.0, 0.2, (12, 3))


def of_cloud(masses: np.ndarray, places: np.ndarray) -> np.ndarray:
    return sum(parameters_of(m, x, np.zeros((3, 3))) for m, x in zip(masses, places, strict=True))


def test_the_order_of_the_parameters_is_pinocchios():
    body = pin.Inertia.Random()
    parameters = parameters_of(body.mass, body.lever, body.inertia)
    np.testing.assert_allclose(parameters, body.toDynamicParameters(), atol=1e-14)


def test_pseudo_inertia_is_the_second_moment_of_homogeneous_points():
    masses, places = cloud(np.random.default_rng(1))
    points = np.column_stack([places, np.ones(len(places))])
    expected = (points.T * masses) @ points
    np.testing.assert_allclose(pseudo_inertia(of_cloud(masses, places)), expected, atol=1e-14)


def test_pseudo_inertia_and_back_is_the_identity_for_a_batch():
    parameters = np.random.default_rng(2).normal(size=(5, 3, 10))
    np.testing.assert_allclose(from_pseudo_inertia(pseudo_inertia(parameters)), parameters, atol=1e-14)


def test_a_body_described_in_another_frame_is_the_same_body():
    masses, places = cloud(np.random.default_rng(3))
    pose = pin.SE3.Random()
    in_joint = places @ pose.rotation.T + pose.translation
    moved = transform_parameters(pose.homogeneous) @ of_cloud(masses, places)
    np.testing.assert_allclose(moved, of_cloud(masses, in_joint), atol=1e-13)


def test_changes_of_frame_compose():
    A, B = pin.SE3.Random(), pin.SE3.Random()
    both = transform_parameters(A.homogeneous) @ transform_parameters(B.homogeneous)
    np.testing.assert_allclose(both, transform_parameters((A * B).homogeneous), atol=1e-12)


def test_a_cloud_of_points_is_physical_and_remains_so_in_any_frame():
    parameters = of_cloud(*cloud(np.random.default_rng(4)))
    assert is_physical(parameters)
    assert is_physical(transform_parameters(pin.SE3.Random().homogeneous) @ parameters)


@pytest.mark.parametrize("where", [np.zeros(3), np.array([3.0, -2.0, 0.4])])
def test_a_point_is_on_the_edge_and_physical(where):
    point = parameters_of(50.0, where, np.zeros((3, 3)))
    assert is_physical(point)
    assert abs(physical_margin(point)) < 1e-12


def test_a_body_of_zero_mass_and_moments_is_physical():
    assert is_physical(np.zeros(10))


@pytest.mark.parametrize(
    "impossible",
    [
        parameters_of(-1.0, np.zeros(3), np.eye(3)),
        parameters_of(1.0, np.zeros(3), np.diag([1.0, 1.0, 2.1])),  # triangle inequality
        np.array([0.0, 0.1, 0, 0, 1.0, 0, 1.0, 0, 0, 1.0]),  # first moments without mass
        np.array([1.0, 1.0, 0, 0, 0.1, 0, 0.1, 0, 0, 0.1]),  # too little inertia for its lever
        np.full(10, np.nan),
    ],
)
def test_bodies_that_cannot_exist_are_recognised(impossible):
    assert not is_physical(impossible)


def test_the_triangle_inequality_may_hold_with_equality():
    assert is_physical(parameters_of(1.0, np.zeros(3), np.diag([1.0, 1.0, 2.0])))


def test_is_physical_returns_one_value_for_each_body_of_a_batch():
    good = parameters_of(1.0, np.ones(3), np.eye(3))
    np.testing.assert_array_equal(is_physical(np.array([good, -good, good])), [True, False, True])


def test_centre_of_mass_values_are_those_given():
    tensor = np.diag([0.1, 0.2, 0.25])
    mass, com, at_com = at_centre_of_mass(parameters_of(3.0, [0.1, -0.2, 0.3], tensor))
    assert mass == 3.0
    np.testing.assert_allclose(com, [0.1, -0.2, 0.3], atol=1e-15)
    np.testing.assert_allclose(at_com, tensor, atol=1e-14)


def test_a_wrong_number_of_parameters_is_refused():
    with pytest.raises(RobotError, match="10 inertial parameters"):
        pseudo_inertia(np.zeros(9))
