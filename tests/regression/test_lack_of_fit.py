"""Structure that is left: smooth functions of the motion find what is no noise, and leave noise alone."""

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.effects import Term, parse_effect
from cdia_pin.regression.gauss_newton import refit
from cdia_pin.regression.lack_of_fit import smooth_columns
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.problem import Problem
from tests.made_logs import CUTOFF, autoregressive, make, motion

NOISE = 0.005  # [N·m]
SETTINGS = DiscoverySettings(conditioning=CUTOFF)

SMOOTH = {
    "of the position": lambda q, v, a: 0.05 * np.exp(-((q[:, 0] / 0.3) ** 2)),
    "of the speed": lambda q, v, a: 0.05 * np.exp(-(((np.abs(v[:, 0]) - 0.6) / 0.2) ** 2)) * np.sign(v[:, 0]),
    "of another joint": lambda q, v, a: 0.04 * np.sin(2 * q[:, 1]),
    "of the acceleration": lambda q, v, a: -0.01 * a[:, 0],
    "of time and direction": lambda q, v, a: -0.1 * np.linspace(1, 0, len(q)) * np.sign(v[:, 0]),
    "of the product of place and speed": lambda q, v, a: -0.1 * q[:, 0] * v[:, 0],
}


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


def on_first(f):
    return lambda q, v, a: np.column_stack([f(q, v, a), np.zeros(len(q))])


def problem_of(robot, *made):
    return Problem.of(Dynamics(robot), [m.log for m in made], [], SETTINGS)


def structure_of(robot, made, *terms):
    return problem_of(robot, made).lack_of_fit(Dynamics(robot, terms))


@pytest.mark.parametrize("what", SMOOTH)
def test_a_smooth_missing_torque_is_structure_on_its_joint_only(what, pendulum):
    structure = structure_of(pendulum, make(pendulum, on_first(SMOOTH[what]), noise=NOISE, seed=3))
    np.testing.assert_array_equal(structure.left, [True, False])


@pytest.mark.parametrize(
    "colour", [[], [0.6], [0.9], [1.2, -0.5]], ids=["white", "gentle", "slow", "second order"]
)
def test_noise_is_no_structure(colour, pendulum):
    """At odds of 10⁻⁴ for each joint, none of 40 may alarm."""
    count = len(motion(2)[0])
    for seed in range(20):
        noise = NOISE * autoregressive(colour, (count, 2), np.random.default_rng(seed))
        structure = structure_of(pendulum, make(pendulum, noise=noise, seed=seed))
        assert not structure.left.any(), seed


def fitted_to(problem, robot, *names):
    model = Dynamics(robot, tuple(Term(parse_effect(f"{n}@joint1"), (0.0,)) for n in names))
    return refit(problem.with_first_noise(model).regression, model)[0]


@pytest.mark.parametrize(
    "what",
    [
        lambda q, v, a: 0.05 * np.ones(len(q)),
        lambda q, v, a: -0.05 * np.sign(v[:, 0]),
        lambda q, v, a: 0.05 * a[:, 0],
    ],
    ids=["offset", "friction", "load"],
)
def test_what_only_one_of_two_logs_has_is_structure(what, pendulum):
    """The model has the effects, so that only their sizes per log are left."""
    names = ("torque_offset", "coulomb_friction", "rotor_inertia")
    one = make(pendulum, noise=NOISE, seed=3)
    other, alike = (
        make(pendulum, on_first(f), noise=NOISE, seed=4) for f in (what, lambda q, v, a: 0.0 * a[:, 0])
    )
    for second, left in ((other, True), (alike, False)):
        problem = problem_of(pendulum, one, second)
        assert problem.lack_of_fit(fitted_to(problem, pendulum, *names)).left.tolist() == [left, False]


def test_what_the_model_holds_is_no_structure(pendulum):
    made = make(pendulum, on_first(lambda q, v, a: -0.05 * v[:, 0] + 0.1), noise=NOISE, seed=4)
    assert structure_of(pendulum, made).left[0]
    problem = problem_of(pendulum, made)
    fitted = fitted_to(problem, pendulum, "viscous_friction", "torque_offset")
    assert not problem.lack_of_fit(fitted).left.any()


def test_the_floor_is_the_noise_that_passes_the_filter(pendulum):
    """White noise of 100 Hz, twice through a low-pass of 8 Hz: the floor is known beforehand."""
    made = make(pendulum, on_first(SMOOTH["of the position"]), noise=NOISE, seed=5)
    problem = problem_of(pendulum, made)
    floor = problem.lack_of_fit(Dynamics(pendulum)).floor
    noise = NOISE * np.random.default_rng(9).standard_normal(made.q.shape)
    from cdia_pin.logs.derivatives import zero_phase

    motion_of = problem.experiment.segments[0].motion
    expected = zero_phase(zero_phase(noise, motion_of.cutoff, 100.0), motion_of.cutoff, 100.0).std(axis=0)
    np.testing.assert_allclose(floor, expected, rtol=0.25)


def test_where_structure_is_left_the_noise_is_what_lies_under_it(pendulum):
    structure = structure_of(
        pendulum, make(pendulum, on_first(SMOOTH["of the position"]), noise=NOISE, seed=6)
    )
    assert structure.noise[0] is structure.innermost[0]
    assert structure.noise[1] is structure.residual_noise[1]
    assert np.median(structure.innermost[0].sigma) < np.median(structure.residual_noise[0].sigma)


def test_smooth_columns_know_nothing_of_the_measured_torque(pendulum):
    columns = []
    for noise in (0.0, 0.5):
        problem = problem_of(pendulum, make(pendulum, noise=noise, seed=7))
        prediction = problem.experiment.predict(Dynamics(pendulum))
        columns.append(smooth_columns(problem.experiment, prediction, 0))
    np.testing.assert_array_equal(*columns)


def test_the_first_estimate_of_the_noise_is_not_fooled_by_a_large_missing_torque(pendulum):
    """Friction of a hundred times the noise, of which no model knows yet, must not pass for noise."""
    plain = make(pendulum, noise=NOISE, seed=8)
    rough = make(pendulum, on_first(lambda q, v, a: -0.5 * v[:, 0] - 0.3), noise=NOISE, seed=8)
    sigma = [
        np.median(problem_of(pendulum, m).with_first_noise(Dynamics(pendulum)).whitening.noise[0].sigma)
        for m in (plain, rough)
    ]
    assert sigma[0] * 0.8 < sigma[1] < sigma[0] * 2
