"""The healthy arm taken apart: bodies and tilt into the rigid body, friction into columns, the rest beside."""

import numpy as np
import pytest

from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import (
    BaseTilt,
    CoulombFriction,
    CoupledFriction,
    Drift,
    EffortDelay,
    EncoderOffset,
    Payload,
    PerLog,
    Region,
    State,
    Term,
    ViscousFriction,
)
from cdia_pin.errors import ModelError
from cdia_pin.robot import load_robot

ROBOT = load_robot("ur5")
ELBOW, WRIST = "elbow_joint", "wrist_1_joint"
PAYLOAD = Term(Payload(), (1.5, 0.02, 0.0, 0.08, 0.02, 0.0, 0.02, 0.0, 0.0, 0.02))


def joints_torque(nominal: Nominal, q, v, a, tau, width) -> np.ndarray:
    x = State.of(nominal.robot, q, v, a, effort=tau, sign_width=width)
    return sum(term.torque(x)[0] for term in nominal.of_joints) + nominal.outside(q, v, a, tau, 0.0, width)


# Of a payload on a tilted base the nominal arm has the payload's weight along the tilted gravity too, which a
# `Dynamics`, the sum of its terms, leaves out: so one of the two at a time.
@pytest.mark.parametrize("whole", [PAYLOAD, Term(BaseTilt(), (0.05, -0.02))], ids=lambda t: t.label)
def test_the_parts_are_the_model(whole: Term) -> None:
    model = Dynamics(
        ROBOT,
        (
            whole,
            Term(CoulombFriction(ELBOW), (3.0,)),
            Term(CoupledFriction(ELBOW, WRIST), (1.0, 0.5)),
            Term(ViscousFriction(WRIST), (2.0,), Region(WRIST, "speed", lower=0.4)),
        ),
    )
    nominal = Nominal.of(model)
    rng, width = np.random.default_rng(0), np.full(ROBOT.n, 1e-3)
    for _ in range(10):
        q, v, a = rng.uniform(-1, 1, (3, ROBOT.n))
        tau = model.inverse_dynamics(q, v, a)
        parts = nominal.robot.inverse_dynamics(q, v, a) - joints_torque(nominal, q, v, a, tau, width)
        np.testing.assert_allclose(parts, tau, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    "varying", [lambda e: Drift(e, 0.0, 14.0, 3.0), lambda e: PerLog(e, ("cold", "warm"))]
)
def test_what_varies_is_held_at_its_mean_whatever_the_clock_says(varying) -> None:
    friction = CoulombFriction(ELBOW)
    nominal = Nominal.of(Dynamics(ROBOT, (Term(varying(friction), (2.0, 4.0)),)))
    assert nominal.of_joints == (Term(friction, (3.0,)),)
    assert nominal.others.terms == ()


def test_only_what_is_always_there_on_one_joint_is_compiled() -> None:
    there = Term(CoulombFriction(ELBOW), (3.0,))
    sometimes = Term(ViscousFriction(ELBOW), (2.0,), Region(ELBOW, "speed", lower=0.4))
    shared = Term(CoupledFriction(ELBOW, WRIST), (1.0, 0.5))
    nominal = Nominal.of(Dynamics(ROBOT, (there, sometimes, shared)))
    assert nominal.of_joints == (there,)
    assert nominal.others.terms == (sometimes, shared)


def test_an_encoder_offset_is_added_to_the_readings() -> None:
    nominal = Nominal.of(Dynamics(ROBOT, (Term(EncoderOffset(ELBOW), (0.03,)),)))
    model = Dynamics(ROBOT, (Term(EncoderOffset(ELBOW), (0.03,)),))
    q, zero = np.full(ROBOT.n, 0.4), np.zeros(ROBOT.n)
    held = model.inverse_dynamics(q, zero, zero)
    np.testing.assert_allclose(nominal.robot.nonlinear_effects(q + nominal.offset, zero), held, rtol=1e-9)
    assert np.count_nonzero(nominal.offset) == 1


def test_a_delay_is_that_of_all_torques() -> None:
    one = Nominal.of(Dynamics(ROBOT, (Term(EffortDelay(), (-0.004,)),)))
    assert one.delay == pytest.approx(0.004)
    with pytest.raises(ModelError, match="not of one joint"):
        Nominal.of(Dynamics(ROBOT, (Term(EffortDelay(ELBOW), (-0.004,)),)))


def test_a_link_without_mass_is_rejected() -> None:
    nothing = Term(Payload(), (-30.0, *[0.0] * 9))
    with pytest.raises(ModelError, match="no mass left"):
        Nominal.of(Dynamics(ROBOT, (nothing,)))


def test_estimated_bodies_of_one_link_need_not_be_possible_together() -> None:
    flat = Term(Payload(), (0.01, *[0.0] * 3, -0.05, 0.0, -0.05, 0.0, 0.0, -0.05))
    nominal = Nominal.of(Dynamics(ROBOT, (flat,)))
    assert nominal.robot.total_mass == pytest.approx(ROBOT.total_mass + 0.01)


def test_a_plain_robot_stays_as_it_is() -> None:
    nominal = Nominal.of(Dynamics(ROBOT))
    assert nominal.robot is ROBOT
    assert (nominal.of_joints, nominal.others.terms, nominal.delay) == ((), (), 0.0)
