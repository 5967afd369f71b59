"""A term that is present at times only is fitted by the samples at which it is present."""

import numpy as np
import pytest

from cdia_pin import Dynamics, discover, load_robot
from cdia_pin.effects import (
    ALWAYS,
    ActuatorGain,
    Between,
    CoulombFriction,
    Incipient,
    Region,
    StribeckFriction,
    Term,
    ViscousFriction,
    after,
)
from cdia_pin.errors import EffectError
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.gauss_newton import refit
from cdia_pin.regression.intervals import with_intervals
from cdia_pin.regression.noise import NoiseModel
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.shape_slopes import slopes
from cdia_pin.regression.time_blocks import time_blocks
from cdia_pin.regression.whitening import Whitening
from tests.made_logs import CUTOFF, motion

COULOMB, GAIN = CoulombFriction("joint1"), ActuatorGain("joint1")
LATE = after(12.0)  # [s] of 20
PROFILES = [LATE, Between(4.0, 9.0), Incipient(8.0, 0.3), Region("joint1", "position", lower=0.1)]
VISCOUS = Term(ViscousFriction("joint2"), (0.05,))
NOISE = 0.005  # [N·m]


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


def log_of(robot, *terms):
    """A log of 20 s of an arm with terms."""
    t, q, v, a = motion(robot.n)
    effort = Dynamics(robot, terms).inverse_dynamics(q, v, a, time=t)
    noise = NOISE * np.random.default_rng(1).standard_normal(q.shape)
    return Log(robot.joints, t, q, effort + noise, source="made")


def regression_of(robot, *terms):
    """The regression of such a log, whitened by known noise."""
    experiment = Experiment.of(robot, [condition(log_of(robot, *terms), robot, CUTOFF)])
    count = len(experiment.measured)
    noise = [NoiseModel(np.zeros(0), np.full(count, NOISE), (count,))] * robot.n
    whitening = Whitening.of(experiment, noise, time_blocks(experiment.segments, 10))
    return Regression(DesignMatrix(experiment), whitening)


@pytest.mark.parametrize("profile", PROFILES, ids=lambda p: p.kind)
@pytest.mark.parametrize("start", [0.0, 0.02])
def test_a_fit_finds_the_size_that_a_term_has_while_it_is_present(profile, start, pendulum):
    regression = regression_of(pendulum, Term(COULOMB, (0.08,), profile))
    model, equations = refit(regression, Dynamics(pendulum, (Term(COULOMB, (start,), profile),)))
    (term,) = with_intervals(model, equations).terms
    assert term.theta[0] == pytest.approx(0.08, rel=0.03)
    assert term.half_widths[0] < 0.1 * 0.08


def test_a_fit_finds_friction_that_acts_under_load_only(pendulum):
    profile = Region("joint1", "effort", lower=0.3)
    regression = regression_of(pendulum, Term(COULOMB, (0.08,), profile))
    model, _ = refit(regression, Dynamics(pendulum, (Term(COULOMB, (0.02,), profile),)))
    assert model.theta[0] == pytest.approx(0.08, rel=0.05)


@pytest.mark.parametrize("effect", [COULOMB, GAIN], ids=lambda e: e.name)
@pytest.mark.parametrize("profile", PROFILES, ids=lambda p: p.kind)
def test_columns_are_the_derivative_of_the_prediction(effect, profile, pendulum):
    regression = regression_of(pendulum)
    at, step = 0.05, 1e-5
    here, there = (
        regression.experiment.predict(Dynamics(pendulum, (Term(effect, (at + d,), profile),)))
        for d in (0.0, step)
    )
    columns = regression.design.columns(effect, here, np.array([at]))
    change = (there.residual - here.residual)[:, 0] / step
    np.testing.assert_allclose(-columns.values[:, 0, 0], change, atol=1e-3 * np.abs(change).max())
    assert columns.fixed is None  # they are no other model's


def test_columns_of_a_candidate_are_those_of_an_effect_that_is_always_present(pendulum):
    regression = regression_of(pendulum)
    given = regression.experiment.predict(Dynamics(pendulum, (Term(COULOMB, (0.05,), LATE),)))
    bare = regression.experiment.predict(Dynamics(pendulum))
    design = regression.design
    np.testing.assert_array_equal(design.of(COULOMB, given), design.of(COULOMB, bare))


def test_the_slope_of_a_shape_acts_while_its_term_does(pendulum):
    term = Term(StribeckFriction("joint1"), (0.03, 0.04), LATE)
    (slope,) = slopes(Dynamics(pendulum, (term,)))
    regression = regression_of(pendulum, term)
    experiment = regression.experiment
    x = regression.design.of(slope, experiment.predict(Dynamics(pendulum, (term,))))
    time, *_ = experiment.compared_motion()
    assert np.abs(x[time < 11.0]).max() < 1e-3 * np.abs(x).max()


def test_an_effect_that_a_model_has_twice_is_refused(pendulum):
    twice = Dynamics(pendulum, (Term(COULOMB, (0.1,), Between(end=12.0)), Term(COULOMB, (0.2,), LATE)))
    regression = regression_of(pendulum, *twice.terms)
    for model in (twice, Dynamics(pendulum, twice.terms[:1] * 2)):
        with pytest.raises(EffectError, match="coulomb_friction@joint1 is in the model twice"):
            regression.normal_equations(model, [COULOMB])
    with pytest.raises(EffectError, match="is in the model twice"):
        discover(twice, log_of(pendulum, *twice.terms))


def test_a_discovery_fits_a_term_of_the_model_at_its_times(pendulum):
    log = log_of(pendulum, Term(COULOMB, (0.08,), LATE), VISCOUS)
    found = discover(Dynamics(pendulum, (Term(COULOMB, (0.02,), LATE),)), log)
    assert found.model.find(COULOMB.label).theta[0] == pytest.approx(0.08, rel=0.05)
    assert [s.term.label for s in found.steps] == [VISCOUS.label]
    assert {t.label: t.profile for t in found.model.terms} == {
        COULOMB.label: LATE,
        VISCOUS.label: ALWAYS,
    }
