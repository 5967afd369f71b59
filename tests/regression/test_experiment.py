"""A model against conditioned logs: residuals are what is missing, columns are how they change."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.effects import EFFECTS, Expression, Signal, Term, Unknown
from cdia_pin.errors import LogError
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment
from tests.made_logs import CUTOFF, conditioned, make, motion

# Parameters about which each effect is differentiated, of a size that a double pendulum of 0.6 kg may have.
SIZES = {
    "coulomb_friction": [0.05],
    "viscous_friction": [0.05],
    "bearing_friction": [0.05, 0.03],
    "stribeck_friction": [0.03, 0.04],
    "asymmetric_friction": [0.03, 0.05, 0.02, 0.04],
    "quadratic_friction": [0.05],
    "load_friction": [0.1],
    "load_stribeck_friction": [0.05, 0.08],
    "presliding_friction": [0.05],
    "thermal_friction": [0.05, 0.05],
    "position_ripple": [0.05, -0.03],
    "actuator_gain": [-0.2],
    "torque_offset": [0.1],
    "rotor_inertia": [0.01],
    "joint_spring": [0.1, 0.05],
    "counterbalance": [0.3, 0.2],
    "joint_elasticity": [0.005],
    "coupled_friction": [0.02, 0.03],
    "link_inertia": [0.05, 0.0, 0.002, -0.004, 1e-3, 0.0, 1e-3, 0.0, 0.0, 1e-3],
    "payload": [0.05, 0.0, 0.002, 0.004, 1e-3, 0.0, 1e-3, 0.0, 0.0, 1e-3],
    "base_tilt": [0.8, -0.5],
    "tool_wrench": [0.3, -0.2, 0.5, 0.02, 0.01, -0.02],
    "external_wrench": [0.3, -0.2, 0.5, 0.02, 0.01, -0.02],
    "viscous_medium": [0.5, 0.05],
    "encoder_offset": [0.05],
    "effort_delay": [0.01],
}
SMALL = 1e-4  # step of a parameter beside its size


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


@pytest.fixture(scope="module")
def clean(pendulum):
    return make(pendulum, seed=1)


@pytest.fixture(scope="module")
def experiment(pendulum, clean):
    return Experiment.of(pendulum, [conditioned(pendulum, clean)])


def effect_of(name, robot):
    return EFFECTS[name].from_scope(next(iter(EFFECTS[name].scopes(robot))), {})


def residual(experiment, *terms):
    return experiment.predict(Dynamics(experiment.robot, tuple(terms))).residual


def test_every_effect_is_differentiated_here():
    assert set(SIZES) == set(EFFECTS) - {Unknown.name, Expression.name}


def test_a_model_that_lacks_nothing_leaves_nothing(pendulum, experiment):
    size = np.abs(experiment.measured).max(axis=0)
    assert (np.abs(residual(experiment)).max(axis=0) < 1e-3 * size).all()


def test_the_residual_is_the_missing_torque_filtered_alike(pendulum):
    def missing(q, v, a):
        return np.column_stack([0.3 * np.sin(2 * q[:, 0]) - 0.1 * v[:, 0], 0.05 + 0.02 * q[:, 0]])

    made = make(pendulum, missing, seed=2)
    m = conditioned(pendulum, made)
    experiment = Experiment.of(pendulum, [m])
    # the log's torque was filtered once on the way in and is filtered again to be compared, and so is f
    once = condition(replace(made.log, effort=made.f), pendulum, CUTOFF)
    np.testing.assert_allclose(
        residual(experiment), m.compared(once.effort), atol=2e-3 * np.abs(made.f).max()
    )


@pytest.mark.parametrize("at", ["nothing known", "in the model"])
@pytest.mark.parametrize("name", SIZES)
def test_columns_are_the_derivative_of_the_prediction(name, at, pendulum, experiment):
    """The residual falls by a column times what is added to its parameter."""
    effect = effect_of(name, pendulum)
    size = np.array(SIZES[name])
    theta = size if at == "in the model" else np.zeros(len(size))
    model = Dynamics(pendulum, (Term(effect, tuple(theta)),))
    prediction = experiment.predict(model)
    columns = experiment.columns(effect, prediction, theta)
    joints = list(effect.acts_on(pendulum))
    rest = [j for j in range(pendulum.n) if j not in joints]
    for i in range(effect.size):
        step = SMALL * max(abs(size[i]), 0.1 * np.abs(size).max()) * np.eye(effect.size)[i]
        up, down = (residual(experiment, Term(effect, tuple(theta + s * step))) for s in (0.5, -0.5))
        change = (up - down) / step[i]
        scale = np.abs(columns[:, :, i]).max() + 1e-12
        np.testing.assert_allclose(-change[:, joints], columns[:, :, i], atol=2e-3 * scale)
        np.testing.assert_allclose(change[:, rest], 0.0, atol=1e-6 * scale)


@pytest.mark.parametrize("name", ["viscous_friction", "payload", "load_friction"])
def test_columns_of_a_model_whose_reading_is_late_are_late(name, pendulum, experiment):
    effect, theta = effect_of(name, pendulum), np.array(SIZES[name])
    delay = Term(effect_of("effort_delay", pendulum), (0.06,))
    model = Dynamics(pendulum, (Term(effect, tuple(theta)), delay))
    columns = DesignMatrix(experiment).of(effect, experiment.predict(model), theta)
    step = SMALL * theta[0] * np.eye(effect.size)[0]
    up, down = (residual(experiment, Term(effect, tuple(theta + s * step)), delay) for s in (0.5, -0.5))
    change = -(up - down)[:, list(effect.acts_on(pendulum))] / step[0]
    assert np.linalg.norm(columns[:, :, 0] - change) < 0.03 * np.linalg.norm(change)


def test_a_gain_in_the_model_divides_what_else_is_missing(pendulum, experiment):
    gain, offset = (effect_of(n, pendulum) for n in ("actuator_gain", "torque_offset"))
    with_gain = experiment.predict(Dynamics(pendulum, (Term(gain, (-0.2,)),)))
    bare = experiment.predict(Dynamics(pendulum))
    np.testing.assert_allclose(
        experiment.columns(offset, with_gain), experiment.columns(offset, bare) / 0.8, rtol=1e-9
    )


@pytest.mark.parametrize("name", SIZES)
def test_the_measured_torque_is_never_a_regressor(name, pendulum, clean):
    effect = effect_of(name, pendulum)
    if Signal.TORQUE not in effect.traits.depends_on:
        return
    noise = np.random.default_rng(3).standard_normal(clean.q.shape)
    columns = []
    for log in (clean.log, replace(clean.log, effort=clean.log.effort + noise)):
        experiment = Experiment.of(pendulum, [condition(log, pendulum, CUTOFF)])
        columns.append(experiment.columns(effect, experiment.predict(Dynamics(pendulum))))
    np.testing.assert_array_equal(*columns)


# ---------------------------------------------------------------- which samples count


def with_rest(robot, share):
    """A log whose second joint rests for a share of the time."""
    t, q, _v, _a = motion(robot.n, seed=4)
    scale = np.clip((t - share * t[-1]) / 2.0, 0.0, 1.0)
    q[:, 1] *= scale**3
    made = make(robot, seed=4)
    return replace(made.log, position=q)


def test_a_joint_that_hardly_moves_is_at_rest_and_all_its_samples_count(pendulum):
    log = with_rest(pendulum, 0.97)
    experiment = Experiment.of(pendulum, [condition(log, pendulum, CUTOFF)])
    np.testing.assert_array_equal(experiment.resting, [False, True])
    assert experiment.informative[:, 1].all()
    assert not experiment.informative[:, 0].all()


def test_samples_near_a_reversal_say_nothing_of_friction(pendulum, experiment):
    _, _, v, _ = experiment.compared_motion()
    turns = np.abs(v) < 1e-3 * np.abs(v).max(axis=0)
    assert turns.any()
    assert not (experiment.informative & turns).any()
    assert experiment.informative.mean() > 0.8
    assert (experiment.nearness[turns] == 0).all()


def test_friction_between_two_joints_may_stick_while_both_of_them_move(pendulum):
    """The joints' sum of positions is a clipped sine: it rests for a third of the time, and neither joint does."""
    t, q, _v, _a = motion(2, seed=8)
    q[:, 1] = np.clip(0.5 * np.sin(2.0 * t), -0.4, 0.4) - q[:, 0]
    log = replace(make(pendulum, seed=8).log, position=q)
    plain = Experiment.of(pendulum, [condition(log, pendulum, CUTOFF)])
    beside = plain.without_rest_of([effect_of("coupled_friction", pendulum)])
    stuck = np.abs(np.cos(plain.compared_motion()[0] * 2.0)) < 0.4
    used = plain.informative[stuck]
    assert used.mean() > 0.7
    assert not beside.informative[stuck].any()
    assert (beside.nearness[stuck] == 0).all()
    assert beside.informative.mean() > 0.4
    np.testing.assert_array_equal(beside.resting, plain.resting)


def test_friction_of_single_joints_rests_where_they_do(pendulum, experiment):
    known = [effect_of(name, pendulum) for name in ("coulomb_friction", "payload", "joint_spring")]
    assert experiment.without_rest_of(known) is experiment


def test_sgn_is_smoothed_no_narrower_than_the_speeds_noise(pendulum, clean):
    widths = []
    for noise in (0.0, 1e-3):
        shaken = clean.log.position + noise * np.random.default_rng(5).standard_normal(clean.q.shape)
        m = condition(replace(clean.log, position=shaken), pendulum, CUTOFF)
        (segment,) = Experiment.of(pendulum, [m]).segments
        assert (segment.state.sign_width >= 3 * m.speed_noise).all()
        assert (segment.state.sign_width >= 0.005 * np.percentile(np.abs(m.v), 95, axis=0)).all()
        widths.append(segment.state.sign_width)
    assert (widths[1] > widths[0]).all()


# ---------------------------------------------------------------- several logs


def test_several_logs_are_compared_each_by_itself(pendulum):
    """No motion is made up where one log ends and the next begins, however far apart their postures are."""
    logs = [make(pendulum, seed=k, duration=12.0) for k in (6, 7)]
    away = replace(logs[1].log, position=logs[1].log.position + np.array([1.5, -1.0]))
    motions = [condition(log, pendulum, CUTOFF) for log in (logs[0].log, away)]
    both = Experiment.of(pendulum, motions)
    alone = [Experiment.of(pendulum, [m]) for m in motions]
    assert both.lengths == [len(e.measured) for e in alone]
    np.testing.assert_array_equal(both.measured, np.vstack([e.measured for e in alone]))
    np.testing.assert_array_equal(residual(both), np.vstack([residual(e) for e in alone]))
    for signal, parts in zip(
        both.compared_motion(), zip(*(e.compared_motion() for e in alone), strict=True), strict=True
    ):
        np.testing.assert_array_equal(signal, np.concatenate(parts))


def test_columns_of_several_logs_are_those_of_each(pendulum):
    motions = [conditioned(pendulum, make(pendulum, seed=k, duration=12.0)) for k in (6, 7)]
    both = Experiment.of(pendulum, motions)
    alone = [Experiment.of(pendulum, [m]) for m in motions]
    for name in ("viscous_friction", "payload", "base_tilt", "effort_delay"):
        effect, bare = effect_of(name, pendulum), Dynamics(pendulum)
        parts = [e.columns(effect, e.predict(bare)) for e in alone]
        np.testing.assert_allclose(
            both.columns(effect, both.predict(bare)), np.vstack(parts), rtol=1e-9, atol=1e-12
        )


# ---------------------------------------------------------------- refusals


def test_a_log_of_another_arm_is_refused(pendulum, clean):
    m = conditioned(pendulum, clean)
    with pytest.raises(LogError, match="joint"):
        Experiment.of(load_robot("scara"), [m])


def test_a_log_too_short_to_compare_is_refused(pendulum):
    short = make(pendulum, duration=3.5)
    with pytest.raises(LogError, match="record for longer"):
        Experiment.of(pendulum, [condition(short.log, pendulum, Conditioning(cutoff=4.0))])
