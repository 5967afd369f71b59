"""Laws that hold on every arm of the catalogue, whatever its numbers are."""

import numpy as np
import pytest

from cdia_pin.errors import RobotError
from cdia_pin.robot import RobotModel, catalogue, load_robot
from tests import one_joint

N = 5


@pytest.fixture(
    scope="module",
    params=[
        *(name for name, entry in catalogue().items() if entry.source != "robot_descriptions"),
        *one_joint.KINDS,
    ],
)
def arm(request, tmp_path_factory) -> RobotModel:
    if request.param in one_joint.KINDS:
        return load_robot(one_joint.write_urdf(request.param, tmp_path_factory.mktemp("arm")))
    return load_robot(request.param)


@pytest.fixture(scope="module")
def motion(arm):
    rng = np.random.default_rng(11)
    limits = arm.limits
    lower = np.where(np.isfinite(limits.lower), limits.lower, -np.pi)
    upper = np.where(np.isfinite(limits.upper), limits.upper, np.pi)
    shape = (N, arm.n)
    return rng.uniform(lower, upper, shape), rng.normal(0, 1.0, shape), rng.normal(0, 3.0, shape)


def scale(x) -> float:
    return max(1.0, float(np.abs(x).max()))


def test_mass_matrix_is_symmetric_and_positive_definite(arm, motion):
    for M in arm.mass_matrix(motion[0]):
        np.testing.assert_array_equal(M, M.T)
        assert np.linalg.eigvalsh(M)[0] > 0


def test_inverse_dynamics_is_mass_times_acceleration_plus_nonlinear_effects(arm, motion):
    q, v, a = motion
    expected = np.einsum("nij,nj->ni", arm.mass_matrix(q), a) + arm.nonlinear_effects(q, v)
    tau = arm.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(tau, expected, atol=1e-11 * scale(tau))


def test_inverse_dynamics_is_linear_in_the_inertial_parameters(arm, motion):
    tau = arm.inverse_dynamics(*motion)
    by_regressor = arm.torque_regressor(*motion) @ arm.inertial_parameters.ravel()
    np.testing.assert_allclose(by_regressor, tau, atol=1e-11 * scale(tau))


def test_forward_dynamics_inverts_inverse_dynamics(arm, motion):
    q, v, a = motion
    again = arm.forward_dynamics(q, v, arm.inverse_dynamics(q, v, a))
    np.testing.assert_allclose(again, a, rtol=1e-7, atol=1e-8)


def test_gravity_torques_are_linear_in_the_gravity_vector(arm, motion):
    G = arm.gravity(motion[0])
    by_regressor = arm.gravity_regressor(motion[0]) @ arm.gravity_vector
    np.testing.assert_allclose(by_regressor, G, atol=1e-12 * scale(G))


def test_at_rest_only_gravity_is_left(arm, motion):
    q = motion[0]
    np.testing.assert_allclose(
        arm.nonlinear_effects(q, 0 * q), arm.gravity(q), atol=1e-12 * scale(arm.gravity(q))
    )


def test_velocity_torques_conserve_energy(arm, motion):
    q, v, _ = motion
    step = 1e-6
    rate = (arm.mass_matrix(q + step * v) - arm.mass_matrix(q - step * v)) / (2 * step)
    kinetic = 0.5 * np.einsum("ni,nij,nj->n", v, rate, v)
    V = arm.nonlinear_effects(q, v) - arm.gravity(q)
    np.testing.assert_allclose(kinetic, np.einsum("ni,ni->n", v, V), atol=1e-7 * scale(kinetic))


def tool_position(arm: RobotModel, q: np.ndarray) -> np.ndarray:
    return (arm.joint_placements(q)[:, arm.joint_index(arm.tool_joint)] @ arm.tool_placement)[:, :3, 3]


def test_tool_jacobian_is_the_derivative_of_the_tool_position(arm, motion):
    q, v, _ = motion
    step = 1e-6
    rate = (tool_position(arm, q + step * v) - tool_position(arm, q - step * v)) / (2 * step)
    by_jacobian = np.einsum("nij,nj->ni", arm.tool_jacobian(q)[:, :3], v)
    np.testing.assert_allclose(by_jacobian, rate, atol=1e-7 * scale(rate))


def test_a_batch_equals_a_loop_over_its_samples(arm, motion):
    for name, signals in (
        ("mass_matrix", 1),
        ("gravity", 1),
        ("gravity_regressor", 1),
        ("tool_jacobian", 1),
        ("point_mass_matrix", 1),
        ("joint_placements", 1),
        ("nonlinear_effects", 2),
        ("inverse_dynamics", 3),
        ("forward_dynamics", 3),
        ("torque_regressor", 3),
    ):
        term = getattr(arm, name)
        batch = term(*motion[:signals])
        loop = np.array([term(*(s[k] for s in motion[:signals])) for k in range(N)])
        np.testing.assert_array_equal(batch, loop, err_msg=name)


@pytest.mark.parametrize("name", ["kinova", "pr2_left_arm", "bravo7", "double_pendulum_continuous"])
def test_continuous_joints_repeat_after_a_turn(name):
    arm = load_robot(name)
    q, v, a = np.random.default_rng(5).normal(size=(3, N, arm.n))
    turned = q + 2 * np.pi * arm.is_continuous
    tau = arm.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(arm.inverse_dynamics(turned, v, a), tau, atol=1e-11 * scale(tau))
    assert arm.is_continuous.any()
    assert np.isinf(arm.limits.upper[arm.is_continuous]).all()


def test_results_are_copies(arm, motion):
    first = arm.mass_matrix(motion[0][0])
    kept = first.copy()
    arm.mass_matrix(motion[0][1])
    np.testing.assert_array_equal(first, kept)


def test_signals_of_the_wrong_shape_are_refused(arm):
    with pytest.raises(RobotError, match="shape"):
        arm.gravity(np.zeros(arm.n + 1))
