"""The estimate: the least cost among bodies that can exist, and a joint that rests counts for little."""

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.effects import ActuatorGain, Term
from cdia_pin.effects.body import Body
from cdia_pin.identification.block_validation import STRENGTHS, choose_strength, held_out_rms
from cdia_pin.identification.estimate import Fitter, unconstrained
from cdia_pin.identification.identification_settings import IdentificationSettings
from cdia_pin.identification.intervals import with_intervals
from cdia_pin.identification.refinement import fitted_without_idle_drives, refine
from cdia_pin.identification.terms import full_model
from cdia_pin.progress import silent
from cdia_pin.regression.experiment import Experiment
from cdia_pin.robot.inertia import parameters_of
from cdia_pin.selection.idle_drives import WEAKEST, has_idle_drive
from tests.made_logs import conditioned, make

STRENGTH = 10.0
SOLID = parameters_of(
    0.5, np.zeros(3), 0.05 * np.eye(3)
)  # added to a link, it leaves the edge of what can exist


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def fitted(robot, made, strength=STRENGTH):
    experiment = Experiment.of(robot, [conditioned(robot, made)])
    fitter = Fitter(experiment, IdentificationSettings())
    return fitter, fitter.fit(full_model(Dynamics(robot), experiment), strength)


def impossible(robot):
    """Torques of a last link whose second moments no body can have."""
    parameters = robot.inertial_parameters.copy()
    parameters[-1, 4:] *= 0.05
    wrong = robot.with_inertial_parameters(parameters)
    return lambda q, v, a: robot.inverse_dynamics(q, v, a) - wrong.inverse_dynamics(q, v, a)


def cost(estimate, theta):
    total = estimate.equations.total
    v = np.append(theta, -1.0)
    return float(v @ total @ v + theta @ estimate.prior @ theta)


def is_possible(estimate, theta):
    robot, evidence = estimate.model.robot, estimate.equations
    return all(
        e.is_physical(theta[s], robot) for e, s in zip(evidence.effects, evidence.parameters, strict=True)
    )


def test_no_possible_parameters_cost_less(robot):
    _, estimate = fitted(robot, make(robot, impossible(robot), noise=1e-3))
    free = unconstrained(estimate.equations.total, estimate.prior)
    assert not is_possible(estimate, free)  # else there is nothing to hold
    assert is_possible(estimate, estimate.theta)
    least, rng = cost(estimate, estimate.theta), np.random.default_rng(0)
    inside = np.concatenate(
        [SOLID if isinstance(t.effect, Body) else np.full(t.effect.size, 0.1) for t in estimate.model.terms]
    )
    tried = 0
    for _ in range(500):
        step = 10.0 ** rng.uniform(-6, 0)
        away = rng.normal(size=len(free)) / np.sqrt(np.diag(estimate.prior) + estimate.equations.scale**2)
        toward = rng.uniform() * (free - estimate.theta) + rng.uniform() * (inside - estimate.theta)
        theta = estimate.theta + step * (0.01 * away + toward)
        if is_possible(estimate, theta):
            tried += 1
            assert cost(estimate, theta) > least * (1 - 1e-6) - 1e-9
    assert tried > 50


def test_where_nothing_holds_it_is_plain_least_squares(robot):
    _, estimate = fitted(
        robot, make(robot, lambda q, v, a: -0.3 * np.tanh(v / 1e-3) - 0.2 * v - 0.05 * a, noise=1e-2), 1.0
    )
    free = unconstrained(estimate.equations.total, estimate.prior)
    assert is_possible(estimate, free)  # else something holds
    assert cost(estimate, estimate.theta) == pytest.approx(cost(estimate, free), rel=1e-4)


def test_the_stronger_the_hold_the_nearer_to_the_urdf(robot):
    made = make(robot, impossible(robot), noise=1e-2)
    lengths = []
    for strength in (1.0, 1e3, 1e6, 1e9):
        _, estimate = fitted(robot, made, strength)
        bodies = np.concatenate([t.theta for t in estimate.model.terms if isinstance(t.effect, Body)])
        lengths.append(np.linalg.norm(bodies))
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[-1] < 0.01 * lengths[0]


def test_a_joint_that_rests_weighs_as_one_sample(robot):
    made = make(robot, duration=40.0)
    resting = made.q.copy()
    resting[:, 1] = 0.3
    log = made.log
    still = type(log)(log.joints, log.time, resting, log.effort, source="one joint rests")
    experiment = Experiment.of(
        robot, [conditioned(robot, type(made)(still, resting, made.v, made.a, made.f))]
    )
    fitter = Fitter(experiment, IdentificationSettings())
    weights = fitter.weights(np.zeros_like(experiment.measured))
    torque = np.sqrt(np.mean(experiment.measured[:, 1] ** 2))
    assert len(experiment.measured) * (torque / weights.noise[1].sigma[0]) ** 2 == pytest.approx(1.0)
    labels = {t.label for t in full_model(Dynamics(robot), experiment).terms}
    assert f"coulomb_friction@{robot.joints[0]}" in labels
    assert f"coulomb_friction@{robot.joints[1]}" not in labels


def test_held_out_blocks_are_not_fitted(robot):
    made = make(robot, lambda q, v, a: -0.3 * np.tanh(v / 1e-3), noise=0.05)
    fitter, estimate = fitted(robot, made)
    residual = fitter.experiment.predict(estimate.model).residual
    inside = np.sqrt(np.mean(residual[fitter.used.all(axis=1)] ** 2, axis=0))
    assert (held_out_rms(fitter, estimate) > 0.98 * inside).all()
    assert (held_out_rms(fitter, estimate) < 1.5 * inside).all()


def test_a_log_that_agrees_with_the_urdf_is_held_to_it_firmly(robot):
    fitter, estimate = fitted(robot, make(robot, noise=0.05))
    assert choose_strength(fitter, estimate) == max(STRENGTHS)


def test_links_that_are_twice_as_heavy_are_no_gain_of_the_drives(robot):
    """Links, friction and gain leave the same torque when all of them grow; a drive's gain is known beforehand."""
    made = make(robot, lambda q, v, a: -robot.inverse_dynamics(q, v, a) - 0.3 * np.tanh(v / 1e-3), noise=0.05)
    experiment = Experiment.of(robot, [conditioned(robot, made)])
    gains = [Term(ActuatorGain(j), (0.0,)) for j in robot.joints]
    whole = full_model(Dynamics(robot), experiment).add(*gains)
    model = Fitter(experiment, IdentificationSettings()).fit(whole, STRENGTHS[0]).model
    for joint in robot.joints:
        assert abs(model.find(f"actuator_gain@{joint}").theta[0]) < 0.3
        assert model.find(f"coulomb_friction@{joint}").theta[0] == pytest.approx(0.3, rel=0.3)


def test_no_drive_that_delivers_next_to_nothing_is_believed(robot):
    """Such a gain makes the torque of its joint out of nothing, and the rest of the model is free of the log."""

    def missing(q, v, a):  # nine tenths of what the first drive is asked for arrive nowhere
        return np.array([-9.0, 0.0]) * robot.inverse_dynamics(q, v, a)

    experiment = Experiment.of(robot, [conditioned(robot, make(robot, missing, noise=0.05))])
    fitter = Fitter(experiment, IdentificationSettings())
    gain = ActuatorGain(robot.joints[0])
    whole = full_model(Dynamics(robot), experiment).add(Term(gain, (0.0,)))
    idle = fitter.fit(whole, STRENGTHS[0]).model.find(gain.label)
    assert idle.theta[0] < WEAKEST
    found = fitted_without_idle_drives(fitter, whole, STRENGTHS[0]).model
    assert gain.label not in {t.label for t in found.terms}
    started = fitter.fit(found, STRENGTHS[0])
    assert not has_idle_drive(refine(fitter, started, silent, lambda _: None).model)


def test_no_interval_is_narrower_than_the_scale_of_the_torques_is_known(robot):
    """Drive gains that are right to 10 % leave friction, and a whole link, no more certain than that."""
    _, estimate = fitted(robot, make(robot, lambda q, v, a: -0.3 * np.tanh(v / 1e-3), noise=0.05))
    size = len(estimate.theta)
    model = with_intervals(estimate, np.zeros((size, size)), np.array([0.1, 0.1]))
    first, second = robot.joints
    friction, link = model.find(f"coulomb_friction@{second}"), model.find(f"link_inertia@{second}")
    assert friction.half_widths == pytest.approx(0.1 * np.abs(friction.theta))
    whole = robot.inertial_parameters[1] + link.theta
    assert link.half_widths == pytest.approx(0.1 * np.abs(whole))
    assert friction.ci95_statistical == ((friction.theta[0], friction.theta[0]),)
    exact = with_intervals(estimate, np.zeros((size, size)), np.zeros(2))
    assert exact.find(f"coulomb_friction@{first}").half_widths == pytest.approx(0.0)
