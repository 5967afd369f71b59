"""What a motion tells of effects: sums of squares that a log of it would have, and what no motion tells."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.effects import parse_effect, parse_term
from cdia_pin.errors import EffectError, RobotError
from cdia_pin.excitation import ExcitationSettings, motion_limits
from cdia_pin.excitation.goals import Parameters
from cdia_pin.excitation.information import SAMPLES_PER_SECOND, Information
from cdia_pin.excitation.question import Question

ELBOW = "elbow_joint"


def question(robot, *terms):
    loaded = load_robot(robot)
    model = Dynamics(loaded, tuple(parse_term(t, loaded) for t in terms))
    return Question(model, motion_limits(loaded), ExcitationSettings(duration=15.0))


@pytest.fixture(scope="module")
def ur5():
    return question("ur5")


def effects(asked, *labels):
    return [parse_effect(label, asked.model.robot) for label in labels]


def separable(asked, one, two):
    """Whether each of two explanations, with commas between effects, leaves something of the other."""
    return asked.between(*(effects(asked, *side.split(",")) for side in (one, two))).separable


def test_the_gram_is_that_of_whitened_columns(ur5):
    friction, load = effects(ur5, f"coulomb_friction@{ELBOW}", f"load_friction@{ELBOW}")
    x, j = ur5.everything, 2
    info = ur5.information(x, (friction, load))
    prediction = x.predict(ur5.model)
    columns = np.column_stack([x.columns(e, prediction)[:, 0, 0] for e in (friction, load)])
    columns[~x.informative[:, j]] = 0.0
    motion = x.segments[0].motion
    scale = SAMPLES_PER_SECOND / (motion.rate / motion.decimation) / ur5.noise[j] ** 2
    np.testing.assert_allclose(info.gram, scale * columns.T @ columns, rtol=1e-9)


def test_what_is_unexplained_is_what_least_squares_leaves(ur5):
    rng = np.random.default_rng(3)
    a, b = effects(ur5, f"asymmetric_friction@{ELBOW}", f"stribeck_friction@{ELBOW}")
    x = rng.standard_normal((50, a.size + b.size))
    info = Information((a, b), x.T @ x)
    left = info.unexplained([a], [b], np.zeros(b.size))
    hidden, others = x[:, : a.size], x[:, a.size :]
    residual = hidden - others @ np.linalg.lstsq(others, hidden, rcond=None)[0]
    np.testing.assert_allclose(left, residual.T @ residual, atol=1e-9)
    known = info.unexplained([a], [b], np.full(b.size, 1e12))  # parameters known to be zero explain nothing
    np.testing.assert_allclose(known, hidden.T @ hidden, rtol=1e-6)


def test_the_same_effect_twice_is_a_wrong_question(ur5):
    with pytest.raises(EffectError, match="given twice"):
        separable(ur5, f"coulomb_friction@{ELBOW}", f"coulomb_friction@{ELBOW}")


@pytest.mark.parametrize(
    ("one", "two", "which"),
    [
        (f"coulomb_friction@{ELBOW}", f"viscous_friction@{ELBOW}", (True, True)),
        (f"actuator_gain@{ELBOW}", f"link_inertia@{ELBOW}", (True, True)),
        # what has all that the other has, and more
        (f"stribeck_friction@{ELBOW}", f"coulomb_friction@{ELBOW}", (True, False)),
        (f"torque_offset@{ELBOW}", f"joint_spring@{ELBOW}", (False, True)),
        (
            f"asymmetric_friction@{ELBOW}",
            f"coulomb_friction@{ELBOW},torque_offset@{ELBOW}",
            (True, False),
        ),
    ],
)
def test_which_of_two_is_separable(ur5, one, two, which):
    assert separable(ur5, one, two) == which


@pytest.mark.parametrize(
    ("robot", "one", "two", "why"),
    [
        ("ur5", "payload", "link_inertia@wrist_3_joint", "a body on the same link"),
        (
            "ur5",
            "rotor_inertia@shoulder_pan_joint",
            "link_inertia@shoulder_pan_joint",
            "gravity does not load",
        ),
        ("double_pendulum", "encoder_offset@joint1", "base_tilt", "base_tilt can do as well"),
    ],
)
def test_what_no_motion_identifies_is_reported_with_the_reason(robot, one, two, why):
    with pytest.raises(EffectError, match=f"no motion of this arm tells {one} from {two}: .*{why}"):
        separable(question(robot), one, two)


@pytest.mark.parametrize(
    ("one", "said"),
    [
        ("encoder_offset@joint1", "has no torque on any motion.*gravity does not load joint1"),
        ("unknown@joint1", "has no equation"),
    ],
)
def test_what_has_no_torque_or_no_form_is_said(one, said):
    with pytest.raises(EffectError, match=said):
        separable(question("scara"), one, "payload")


def test_gravity_along_the_axis_hides_the_mass_of_the_first_link(ur5):
    """Of ten parameters of a link that turns about a vertical axis only one moment of inertia can be seen."""
    first, second = (Parameters.of((e,), ur5.information(ur5.everything, (e,))) for e in effects(
        ur5, "link_inertia@shoulder_pan_joint", "link_inertia@shoulder_lift_joint"
    ))  # fmt: skip
    assert first.seen.shape == (10, 1)
    assert second.seen.shape[1] > 3


def test_the_numbers_of_a_model_are_the_size_of_its_effects():
    asked = question("ur5", f"asymmetric_friction@{ELBOW}: level_positive=4, level_negative=2")
    friction, load = effects(asked, f"asymmetric_friction@{ELBOW}", f"load_friction@{ELBOW}")
    known = np.array([4.0, 2.0, 0.0, 0.0])
    (covariance,) = asked.between(friction, load).one.covariance
    np.testing.assert_array_equal(covariance, np.outer(known, known))


def test_other_effects_have_a_share_of_their_joints_torque(ur5):
    friction, load = effects(ur5, f"viscous_friction@{ELBOW}", f"load_friction@{ELBOW}")
    (covariance,) = ur5.between(friction, load).one.covariance
    x, j = ur5.everything, 2
    used = x.informative[:, j]
    speed = np.sqrt(np.mean(x.columns(friction, x.predict(ur5.model))[used, 0, 0] ** 2))
    torque = ur5.noise[j] / ur5.settings.noise
    assert np.sqrt(covariance[0, 0]) * speed == pytest.approx(ur5.settings.size * torque, rel=1e-6)


def test_what_is_fitted_along_makes_two_harder_to_tell_apart():
    pair = (f"coulomb_friction@{ELBOW}", f"load_friction@{ELBOW}")
    apart = []
    for terms in (
        (),
        (f"viscous_friction@{ELBOW}: coefficient=1", f"stribeck_friction@{ELBOW}: level=1, breakaway=1"),
    ):
        q = question("ur5", *terms)
        goal = q.between(*([e] for e in effects(q, *pair)))
        apart.append(goal.distances(q.information(q.everything, goal.effects))[0] * q.noise[2])
    assert apart[1] < apart[0]


def test_a_motion_without_an_effects_joint_tells_nothing_of_its_friction(ur5):
    """The information of a joint at rest is that of gravity, not of friction."""
    friction = parse_effect(f"viscous_friction@{ELBOW}")
    rest = ur5.everything
    still = replace(
        rest,
        segments=tuple(
            replace(s, state=replace(s.state, v=np.zeros_like(s.state.v), a=np.zeros_like(s.state.a)))
            for s in rest.segments
        ),
    )
    assert ur5.information(rest, (friction,)).gram[0, 0] > 1.0
    assert ur5.information(still, (friction,)).gram[0, 0] == pytest.approx(0.0, abs=1e-12)


def test_settings_out_of_range_are_refused():
    for given in (
        {"duration": 1.0},
        {"rate": 1.0},
        {"size": 0.0},
        {"noise": -1.0},
        {"seed": -1},
        {"draws": 0},
    ):
        with pytest.raises(RobotError):
            ExcitationSettings(**given)


def test_an_effect_of_another_robot_is_refused(ur5):
    with pytest.raises(RobotError, match="unknown joint"):
        ur5.parameters([parse_effect("coulomb_friction@nothing")])
