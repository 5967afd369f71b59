"""The equation of motion with terms: inverse and forward agree, whatever the terms are."""

import numpy as np
import pytest

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import EffortDelay, EncoderOffset, Payload, State, Term, from_expression, parse_term
from cdia_pin.errors import ModelError, RobotError
from cdia_pin.robot import load_robot

BODY = "mass=2, first_moment_x=.1, first_moment_z=.2, inertia_xx=.05, inertia_yy=.06, inertia_zz=.04"
MODELS = {
    "bare": [],
    "friction": ["coulomb_friction@elbow_joint: level=5", "viscous_friction@wrist_1_joint: coefficient=2"],
    "coupled": ["coupled_friction@wrist_1_joint+wrist_2_joint: level=1, coefficient=.5"],
    "gain": ["actuator_gain@elbow_joint: gain=-.4", "actuator_gain@wrist_1_joint: gain=.3"],
    "load": ["load_friction@elbow_joint: coefficient=.2", "actuator_gain@elbow_joint: gain=-.2"],
    "bodies": [f"payload: {BODY}", "link_inertia@elbow_joint: mass=-.5, inertia_zz=.1"],
    "rotor": ["rotor_inertia@elbow_joint: inertia=.7"],
    "encoders": ["encoder_offset@elbow_joint: offset=.05", "encoder_offset@wrist_1_joint: offset=-.1"],
    "surroundings": [
        "base_tilt: tilt_x=1, tilt_y=-.5",
        "tool_wrench: force_z=10, torque_x=1",
        "viscous_medium: drag=5, displaced_mass=2",
    ],
    "expressions": ["-.3*ddq@elbow_joint: coefficient=1", "tau*sin(q)@wrist_1_joint: coefficient=.2"],
    "unknown": ["unknown@elbow_joint: position_weight_1=3, velocity_weight_2=2, torque_gain=.2"],
    "in time": [
        "coulomb_friction@elbow_joint: level=5, after=4",
        "torque_offset@wrist_1_joint: offset=1, rate=2",
    ],
    "together": [
        f"payload: {BODY}",
        "encoder_offset@elbow_joint: offset=.05",
        "load_friction@elbow_joint: coefficient=.2",
        "rotor_inertia@shoulder_lift_joint: inertia=.5",
        "joint_spring@wrist_1_joint: stiffness=3, preload=.2",
        "position_ripple@elbow_joint: sine=1",
        "base_tilt: tilt_x=1",
    ],
}


@pytest.fixture(scope="module")
def arm():
    return load_robot("ur5")


@pytest.fixture(scope="module", params=list(MODELS))
def model(request, arm):
    return Dynamics(arm, tuple(parse_term(t, arm) for t in MODELS[request.param]))


@pytest.fixture(scope="module")
def motion(arm):
    return np.random.default_rng(3).normal(size=(3, 20, arm.n))


def test_forward_dynamics_inverts_inverse_dynamics(model, motion):
    for q, v, a in zip(*motion, strict=True):
        tau = model.inverse_dynamics(q, v, a, time=5.0)
        np.testing.assert_allclose(model.forward_dynamics(q, v, tau, time=5.0), a, rtol=1e-6, atol=1e-7)


def test_the_motion_balances_the_torques(model, motion):
    x = State.of(model.robot, *motion, time=5.0)
    tau = model.torques(x).actuator
    f = model.missing_torque(x.with_effort(tau))
    np.testing.assert_allclose(x.rigid_torque, tau + f, atol=1e-8)


def test_the_gain_is_the_response_of_the_torque_to_a_missing_torque(model, motion):
    extra = 1e-5
    more = model.add(Term.of(from_expression("1", "elbow_joint"), coefficient=extra))
    x = State.of(model.robot, *motion, time=5.0)
    change = (more.torques(x).actuator - model.torques(x).actuator)[:, 2]
    np.testing.assert_allclose(change, -extra / model.torques(x).gain[:, 2], rtol=1e-4)


def test_the_mass_matrix_with_terms_is_torque_per_acceleration(model, motion):
    q, v, a = (s[0] for s in motion)
    x = State.of(model.robot, q, v, effort=np.zeros(6), time=5.0)
    M = model.mass_matrix(x)
    at = [
        model.missing_torque(State.of(model.robot, q, v, b, effort=np.zeros(6), time=5.0))[0]
        for b in (0 * a, a)
    ]
    rigid = [model.robot.inverse_dynamics(q, v, b) for b in (0 * a, a)]
    np.testing.assert_allclose(M @ a, rigid[1] - rigid[0] - (at[1] - at[0]), atol=1e-9)


def test_one_sample_equals_a_batch(model, motion):
    together = model.inverse_dynamics(*motion, time=5.0)
    alone = [model.inverse_dynamics(q, v, a, time=5.0) for q, v, a in zip(*motion, strict=True)]
    np.testing.assert_allclose(together, alone, atol=1e-10)


# ------------------------------------------------------------------ bodies


def test_a_payload_is_a_body_added_to_the_last_link(arm, motion):
    """A point mass at the tool changes the energy as its own kinetic and potential energy do."""
    q, v, _ = (s[0] for s in motion)
    model = Dynamics(arm, (Term.of(Payload(), mass=2.0),))
    x = State.of(arm, q, v, effort=np.zeros(6))
    J = arm.tool_jacobian(q)[:3]
    np.testing.assert_allclose(model.mass_matrix(x) - arm.mass_matrix(q), 2.0 * J.T @ J, atol=1e-9)
    weight = model.inverse_dynamics(q, 0 * q, 0 * q) - arm.gravity(q)
    np.testing.assert_allclose(weight, -2.0 * J.T @ arm.gravity_vector, atol=1e-9)


# ------------------------------------------------------------------ sensors


def test_all_effects_act_at_the_true_position_and_not_at_the_reading(arm, motion):
    offset = 0.1
    others = tuple(
        parse_term(t)
        for t in ("position_ripple@elbow_joint: sine=2", f"payload: {BODY}", "base_tilt: tilt_x=1")
    )
    shifted = Dynamics(arm, (*others, Term(EncoderOffset("elbow_joint"), (offset,))))
    q, v, a = motion
    q_true = q + offset * (np.arange(arm.n) == arm.joint_index("elbow_joint"))
    expected = Dynamics(arm, others).inverse_dynamics(q_true, v, a)
    np.testing.assert_allclose(shifted.inverse_dynamics(q, v, a), expected, atol=1e-9)


def test_a_late_reading_is_an_earlier_torque(arm):
    time = np.linspace(0.0, 4.0, 400)
    q = np.sin(np.outer(time, np.linspace(1, 3, arm.n)))
    zero = np.zeros_like(q)
    model = Dynamics(arm, (Term(EffortDelay("elbow_joint"), (0.05,)),))
    tau = arm.inverse_dynamics(q, zero, zero)
    reading = model.inverse_dynamics(q, zero, zero, time=time)
    j = arm.joint_index("elbow_joint")
    np.testing.assert_allclose(reading[50:, j], np.interp(time[50:] - 0.05, time, tau[:, j]), atol=2e-3)
    np.testing.assert_array_equal(np.delete(reading, j, 1), np.delete(tau, j, 1))


# ------------------------------------------------------------------ composing


def test_a_term_of_the_same_effect_and_joint_is_replaced(arm):
    one, two = (parse_term(f"coulomb_friction@elbow_joint: level={k}") for k in (1, 2))
    other = parse_term("coulomb_friction@wrist_1_joint: level=3")
    model = Dynamics(arm).add(one, other).add(two)
    assert set(model.terms) == {two, other}
    assert model.find("coulomb_friction @ elbow_joint") == two
    assert model.remove("coulomb_friction@elbow_joint").terms == (other,)


def test_a_model_without_some_terms_is_itself_if_it_has_none_of_them(arm):
    one, other = (parse_term(f"coulomb_friction@{joint}: level=1") for joint in arm.joints[:2])
    model = Dynamics(arm, (one, other))
    assert model.without({one.label, "payload"}).terms == (other,)
    assert model.without({"payload"}) is model


def test_an_unknown_term_is_refused(arm):
    model = Dynamics(arm, (parse_term("payload: mass=1"),))
    with pytest.raises(ModelError, match="its terms: payload"):
        model.remove("coulomb_friction@elbow_joint")
    with pytest.raises(ModelError, match="no term"):
        model.find("coulomb_friction@elbow_joint")
    with pytest.raises(RobotError, match="elbow_joint"):
        Dynamics(arm, (parse_term("coulomb_friction@elbow: level=1"),))


def test_tilted_gravity_keeps_its_size_in_any_direction():
    for gravity in ([0, 0, -9.81], [0, 0, 9.81], [9.81, 0, 0], [3.0, -8.0, 4.0]):
        arm = load_robot("ur5", gravity=gravity)
        term = parse_term("base_tilt: tilt_x=1, tilt_y=-2")
        change = term.effect.tilt(arm, np.array(term.theta))
        assert np.linalg.norm(arm.gravity_vector + change) == pytest.approx(np.linalg.norm(gravity))
        assert term.effect.is_physical(np.array(term.theta), arm)
    weightless = load_robot("ur5", gravity=0.0)
    x = State.of(weightless, np.ones((1, 6)), np.ones((1, 6)))
    np.testing.assert_array_equal(term.torque(x), 0.0)


def test_added_bodies_feel_a_tilt_too(arm):
    """Heavier links and a tilt as terms are the arm with those links, mounted on the slope."""
    body = "link_inertia@elbow_joint: mass=2, first_moment_x=0.4, inertia_zz=0.3"
    tilt, body, medium = (
        parse_term(t) for t in ("base_tilt: tilt_x=3, tilt_y=-2", body, "viscous_medium: displaced_mass=2")
    )
    q, v, a = np.random.default_rng(0).standard_normal((3, 20, arm.n))
    pi = arm.inertial_parameters.copy()
    pi[arm.joint_index("elbow_joint")] += body.theta
    slope = arm.gravity_vector + tilt.effect.tilt(arm, np.array(tilt.theta))
    built = arm.with_inertial_parameters(pi).with_gravity(slope)
    added = Dynamics(arm, (tilt, body)).inverse_dynamics(q, v, a)
    np.testing.assert_allclose(added, built.inverse_dynamics(q, v, a), atol=1e-9)
    for k in range(3):
        back = Dynamics(arm, (tilt, body)).forward_dynamics(q[k], v[k], added[k])
        np.testing.assert_allclose(back, a[k], atol=1e-8)
    lifted = Dynamics(arm, (medium, tilt)).inverse_dynamics(q, v, a)
    alone = Dynamics(arm.with_gravity(slope), (medium,)).inverse_dynamics(q, v, a)
    np.testing.assert_allclose(lifted, alone, atol=1e-9)
