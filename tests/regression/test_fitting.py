"""Fitting: the joint optimum, from wherever it starts, with intervals that mean what they say."""

import itertools
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.discovery import add_effect
from cdia_pin.effects import (
    ActuatorGain,
    CoulombFriction,
    EffortDelay,
    EncoderOffset,
    JointEffect,
    Parameter,
    PositionRipple,
    Signal,
    State,
    StribeckFriction,
    Term,
    TorqueOffset,
    Traits,
    ViscousFriction,
    parse_effect,
)
from cdia_pin.regression import gauss_newton
from cdia_pin.regression.bounded_fit import bounded_fit
from cdia_pin.regression.cross_validation import held_out_rms
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.regression.gauss_newton import Before, fitted_together, refit, with_parameters
from cdia_pin.regression.intervals import with_intervals
from cdia_pin.regression.noise import NoiseModel
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.shape_slopes import slopes
from cdia_pin.regression.time_blocks import time_blocks
from cdia_pin.regression.whitening import Whitening
from tests.made_logs import autoregressive, conditioned, make, motion

COULOMB, VISCOUS, OFFSET = (
    parse_effect(f"{name}@joint1") for name in ("coulomb_friction", "viscous_friction", "torque_offset")
)
BLOCKS = 10


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


def friction(q, v, a):
    """Coulomb 0.08 N·m, viscous 0.05 N·m·s/rad and an offset of 0.1 N·m on the first joint."""
    return np.column_stack([-0.08 * np.sign(v[:, 0]) - 0.05 * v[:, 0] + 0.1, np.zeros(len(v))])


def prepared(robot, missing, *, noise=0.005, seed=0, order=0, duration=20.0, late=0.0):
    """The regression of a made log, whitened by known noise; its torque is late by some seconds."""
    made = make(robot, missing, seed=seed, noise=noise, duration=duration)
    at = made.log.time - late
    effort = np.column_stack([np.interp(at, made.log.time, x) for x in made.log.effort.T])
    log = replace(made.log, effort=effort)
    experiment = Experiment.of(robot, [conditioned(robot, replace(made, log=log))])
    count = len(experiment.measured)
    model = NoiseModel(np.full(order, 0.3 / max(order, 1)), np.full(count, max(noise, 1e-4)), (count,))
    blocks = time_blocks(experiment.segments, BLOCKS)
    return Regression(DesignMatrix(experiment), Whitening.of(experiment, [model] * robot.n, blocks))


def numbered(regression):
    """The number of each sample's block; every sample is in one."""
    count = len(regression.experiment.measured)
    members = [np.arange(count)[samples] for samples in regression.whitening.blocks]
    assert sorted(np.concatenate(members)) == list(range(count))
    out = np.empty(count, int)
    for b, samples in enumerate(members):
        out[samples] = b
    return out


def model_with(robot, *effects, theta=None):
    values = theta or [(0.0,) * e.size for e in effects]
    return Dynamics(robot, tuple(Term(e, v) for e, v in zip(effects, values, strict=True)))


def stacked(regression, effects):
    """Whitened columns (S, P) and response (S,) of all joints, written out."""
    experiment = regression.experiment
    bare = regression.experiment.predict(Dynamics(experiment.robot))
    x, y = [], []
    for j in range(experiment.robot.n):
        rows = np.zeros((len(regression.experiment.measured), sum(e.size for e in effects)))
        at = 0
        for effect in effects:
            acts = list(effect.acts_on(experiment.robot))
            if j in acts:
                rows[:, at : at + effect.size] = regression.design.of(effect, bare)[:, acts.index(j), :]
            at += effect.size
        x.append(regression.whitening.joint(j, rows))
        y.append(regression.whitening.joint(j, bare.residual[:, j]))
    return np.vstack(x), np.concatenate(y)


# ---------------------------------------------------------------- the optimum


@pytest.mark.parametrize("order", [0, 3])
def test_a_refit_of_linear_effects_is_least_squares(order, pendulum):
    regression = prepared(pendulum, friction, order=order)
    effects = [COULOMB, VISCOUS, OFFSET]
    model, _ = refit(regression, model_with(pendulum, *effects))
    x, y = stacked(regression, effects)
    expected = np.linalg.lstsq(x, y, rcond=None)[0]
    np.testing.assert_allclose(model.theta, expected, rtol=1e-5)
    np.testing.assert_allclose(expected, [0.08, 0.05, 0.1], rtol=0.03)


def test_all_effects_are_fitted_together_and_not_one_to_what_the_other_left(pendulum):
    """Coulomb alone takes some of the viscous torque; beside it each gets its own."""
    regression = prepared(pendulum, friction)
    alone, _ = refit(regression, model_with(pendulum, COULOMB, OFFSET))
    both, _ = refit(regression, alone.add(Term(VISCOUS, (0.0,))))
    level = lambda m: m.find(COULOMB.label).theta[0]  # noqa: E731
    assert level(alone) > 1.2 * 0.08
    assert level(both) == pytest.approx(0.08, rel=0.03)


@pytest.mark.parametrize(
    ("effects", "truth", "starts"),
    [
        ([COULOMB, VISCOUS], [0.08, 0.05], [[0.0, 0.0], [1.0, 2.0]]),
        ([ActuatorGain("joint1"), COULOMB], [-0.3, 0.06], [[0.0, 0.0], [0.2, 0.3]]),
        ([EncoderOffset("joint1"), OFFSET], [0.15, 0.05], [[0.0, 0.0], [-0.1, 0.2]]),
        ([EffortDelay()], [0.03], [[0.0], [-0.02]]),
        ([parse_effect("base_tilt")], [0.0, -3.0], [[0.0, 0.0], [0.0, 2.0]]),
    ],
    ids=["coulomb and viscous", "gain and coulomb", "encoder and torque offset", "delay", "tilt"],
)
def test_wherever_it_starts_a_refit_ends_at_the_truth(effects, truth, starts, pendulum):
    made = make(pendulum, seed=3)
    ends = np.split(np.array(truth), np.cumsum([e.size for e in effects])[:-1])
    true = Dynamics(pendulum, tuple(Term(e, tuple(p)) for e, p in zip(effects, ends, strict=True)))
    log = replace(made.log, effort=true.inverse_dynamics(made.q, made.v, made.a, time=made.log.time))
    experiment = Experiment.of(pendulum, [conditioned(pendulum, replace(made, log=log))])
    count = len(experiment.measured)
    noise = NoiseModel(np.zeros(0), np.full(count, 1e-3), (count,))
    whitening = Whitening.of(experiment, [noise] * 2, time_blocks(experiment.segments, BLOCKS))
    found = []
    for start in starts:
        model = with_parameters(model_with(pendulum, *effects), np.array(start))
        model, _ = refit(Regression(DesignMatrix(experiment), whitening), model)
        found.append(model.theta)
    np.testing.assert_allclose(found[0], found[1], rtol=1e-3, atol=1e-6)
    np.testing.assert_allclose(found[0], truth, rtol=0.03, atol=1e-6)


def test_what_a_late_torque_lacks_is_late_too(pendulum, monkeypatch):
    """Else the steps of a fit lead elsewhere than they promise, and are halved until it ends."""
    formed = []
    evaluate = Regression.normal_equations
    monkeypatch.setattr(
        Regression, "normal_equations", lambda *a, **given: formed.append(a) or evaluate(*a, **given)
    )
    regression = prepared(pendulum, friction, late=0.06)
    found, _ = refit(regression, model_with(pendulum, COULOMB, VISCOUS, OFFSET, EffortDelay()))
    for term, truth in zip(found.terms, (0.08, 0.05, 0.1, 0.06), strict=True):
        assert term.theta[0] == pytest.approx(truth, rel=0.02)
    assert len(formed) <= 8


def test_a_refit_of_an_optimum_stays_there(pendulum):
    regression = prepared(pendulum, friction)
    effects = [ActuatorGain("joint1"), COULOMB, VISCOUS]
    once, _ = refit(regression, model_with(pendulum, *effects))
    again, _ = refit(regression, once)
    for a, b in zip(once.terms, again.terms, strict=True):
        np.testing.assert_allclose(a.theta, b.theta, rtol=1e-3)


def test_friction_that_adds_power_is_held_at_none(pendulum):
    regression = prepared(pendulum, lambda q, v, a: -friction(q, v, a))
    model, _ = refit(regression, model_with(pendulum, COULOMB, VISCOUS, OFFSET))
    assert model.find(COULOMB.label).theta == (0.0,)
    assert model.find(VISCOUS.label).theta == (0.0,)
    assert model.find(OFFSET.label).theta[0] == pytest.approx(-0.1, rel=0.1)


def test_what_happens_near_rest_is_no_evidence(pendulum):
    """A sample that does not count must not reach others through the whitening filter either."""
    regression = prepared(pendulum, friction, order=6)
    prediction = regression.experiment.predict(Dynamics(pendulum))
    strange = np.where(regression.experiment.informative, prediction.residual, prediction.residual + 5.0)
    effects = [COULOMB, VISCOUS, OFFSET]
    as_it_is, disturbed = (
        regression.normal_equations(replace(prediction, residual=r), effects)
        for r in (prediction.residual, strange)
    )
    np.testing.assert_allclose(disturbed.total, as_it_is.total, rtol=1e-6, atol=1e-6 * as_it_is.total.max())


# ---------------------------------------------------------------- held-out errors


def test_held_out_error_is_that_of_fits_to_the_other_blocks(pendulum):
    regression = prepared(pendulum, friction, seed=5)
    effects = [COULOMB, VISCOUS, OFFSET, PositionRipple("joint2")]
    model, _ = refit(regression, model_with(pendulum, *effects))
    prediction = regression.experiment.predict(model)
    x, y = stacked(regression, effects)
    block = np.tile(numbered(regression), pendulum.n)
    bare = regression.experiment.predict(Dynamics(pendulum)).residual
    expected = bare.copy()
    for b, samples in enumerate(regression.whitening.blocks):
        theta = np.linalg.lstsq(x[block != b], y[block != b], rcond=None)[0]
        at = 0
        for effect in effects:
            part = regression.design.of(effect, prediction)[samples] @ theta[at : at + effect.size]
            expected[samples, list(effect.acts_on(pendulum))] -= part
            at += effect.size
    np.testing.assert_allclose(
        held_out_rms(regression, prediction),
        rms(expected, regression.experiment.informative),
        rtol=1e-4,
    )


def test_held_out_error_is_above_the_fitted_error(pendulum):
    regression = prepared(pendulum, friction, seed=6)
    model, _ = refit(regression, model_with(pendulum, COULOMB, VISCOUS, OFFSET))
    prediction = regression.experiment.predict(model)
    fitted = rms(prediction.residual, regression.experiment.informative)
    unseen = held_out_rms(regression, prediction)
    assert (unseen >= fitted * (1 - 1e-9)).all()
    assert (unseen < 1.1 * fitted).all()


def test_blocks_hold_every_sample_once(pendulum):
    regression = prepared(pendulum, friction)
    assert set(numbered(regression)) == set(range(BLOCKS))
    equations = regression.normal_equations(Dynamics(pendulum), [COULOMB])
    x, y = stacked(regression, [COULOMB])
    whole = np.column_stack([x, y])
    np.testing.assert_allclose(equations.total, whole.T @ whole, rtol=1e-9)


# ---------------------------------------------------------------- intervals

THETA = np.array([2.0, -1.0])
PAIR = [TorqueOffset("joint1"), TorqueOffset("joint2")]


def drawn(robot, count, rng, colour=()):
    """A fitted model of two parameters with intervals, from slow columns and noise taken for white."""
    x = autoregressive([0.9], (count, 2), rng)
    y = x @ THETA + autoregressive(list(colour), (count,), rng)
    whole = np.column_stack([x, y])
    edges = np.linspace(0, count, BLOCKS + 1).astype(int)
    blocks = np.array([whole[a:b].T @ whole[a:b] for a, b in itertools.pairwise(edges)])
    equations = NormalEquations(robot, PAIR, blocks, count)
    model = with_parameters(model_with(robot, *PAIR), bounded_fit(equations, [0, 1]).theta)
    return with_intervals(model, equations)


def covered(model):
    return [low <= t <= high for term, t in zip(model.terms, THETA, strict=True) for low, high in term.ci95]


def widths(model):
    return np.array([high - low for term in model.terms for low, high in term.ci95])


def test_intervals_cover_the_truth_under_white_noise(pendulum):
    rng = np.random.default_rng(0)
    hits = np.mean([covered(drawn(pendulum, 500, rng)) for _ in range(200)])
    assert 0.93 <= hits <= 1.0


def test_intervals_know_of_colour_that_the_noise_model_does_not(pendulum):
    """Taken for white, noise of correlation 0.7 makes intervals that hold the truth in three of four cases."""
    rng = np.random.default_rng(1)
    models = [drawn(pendulum, 2000, rng, [0.7]) for _ in range(200)]
    assert np.mean([covered(m) for m in models]) >= 0.9


def test_intervals_shrink_with_the_root_of_the_samples(pendulum):
    rng = np.random.default_rng(2)
    few, many = (np.mean([widths(drawn(pendulum, n, rng)) for _ in range(40)]) for n in (500, 4500))
    assert few / many == pytest.approx(3.0, rel=0.15)


def test_intervals_of_a_longer_log_are_narrower(pendulum):
    half = []
    for duration in (15.0, 60.0):
        regression = prepared(pendulum, friction, duration=duration, seed=8)
        model, equations = refit(regression, model_with(pendulum, COULOMB, VISCOUS, OFFSET))
        half.append(widths(with_intervals(model, equations)))
    assert np.median(half[0] / half[1]) == pytest.approx(2.0, rel=0.4)


def test_intervals_hold_the_estimate_at_their_middle(pendulum):
    model = drawn(pendulum, 500, np.random.default_rng(3))
    for term in model.terms:
        assert np.mean(term.ci95[0]) == pytest.approx(term.theta[0])


def test_a_model_without_terms_needs_no_intervals(pendulum):
    equations = NormalEquations(pendulum, [], np.ones((BLOCKS, 1, 1)), 100)
    assert with_intervals(Dynamics(pendulum), equations).terms == ()


def test_profiles_of_terms_are_kept(pendulum):
    from cdia_pin.effects import after

    regression = prepared(pendulum, friction)
    model = Dynamics(pendulum, (Term(CoulombFriction("joint1"), (0.0,), after(5.0)),))
    fitted, equations = refit(regression, model)
    assert with_intervals(fitted, equations).terms[0].profile == after(5.0)


def test_viscous_friction_is_distinguished_from_none(pendulum):
    regression = prepared(pendulum, friction)
    model, equations = refit(
        regression, model_with(pendulum, COULOMB, OFFSET, VISCOUS, ViscousFriction("joint2"))
    )
    one, none = (with_intervals(model, equations).find(f"viscous_friction@joint{k}").ci95[0] for k in (1, 2))
    assert one[0] > 0.02
    assert none[0] <= 0.0 <= none[1] + 1e-3


# ---------------------------------------------------------------- shapes that were searched for

STRIBECK, RIPPLE = StribeckFriction("joint1"), PositionRipple("joint1")


def stribeck(q, v, a):
    """Dry friction that falls from 0.2 to 0.1 N·m at a Stribeck speed of 0.33 rad/s."""
    level = 0.1 + 0.1 * np.exp(-3 * np.abs(v[:, 0]))
    return np.column_stack([-level * np.sign(v[:, 0]), np.zeros(len(v))])


def test_intervals_know_that_a_shape_was_searched_for(pendulum):
    """With the decay taken for known, errors are one and a half times what the intervals say."""
    errors = []
    for k in range(20):
        noise = 0.05 * np.random.default_rng(k).standard_normal((2000, 2))
        found = add_effect(Dynamics(pendulum), STRIBECK, make(pendulum, stribeck, seed=3, noise=noise).log)
        term = found.steps[-1].term
        both = (term.ci95_statistical, term.ci95)
        errors.append([(np.array(term.theta) - 0.1) / (np.ptp(ci, axis=1) / 2 / 1.96) for ci in both])
    statistical, total = np.std(errors, axis=0)
    assert (statistical > 0.7).all()
    assert (statistical < 1.3).all()
    assert (total <= statistical).all()  # total intervals hold the statistical ones


@pytest.mark.parametrize(
    ("frequency", "off"), [(9.0, 1e-6), (RIPPLE.shape[0].upper, 0.1)], ids=["inside", "bound"]
)
def test_the_slope_of_a_shape_is_its_derivative(frequency, off, pendulum):
    """∂/∂w (a sin wq + b cos wq) = q (a cos wq − b sin wq); at a bound of w only one side can be looked at."""
    _t, q, v, a = motion(2, seed=5)
    effect = RIPPLE.with_shape(frequency=frequency)
    (slope,) = slopes(model_with(pendulum, effect, theta=[(0.05, 0.08)]))
    angle = frequency * q[:, 0]
    expected = q[:, 0] * (0.05 * np.cos(angle) - 0.08 * np.sin(angle))
    basis = slope.basis(State.of(pendulum, q, v, a))
    np.testing.assert_allclose(basis[:, 0, 0], expected, atol=off * np.abs(expected).max())
    assert not basis[:, 1].any()


def test_effects_without_a_shape_have_no_slopes(pendulum):
    assert not list(slopes(model_with(pendulum, COULOMB, VISCOUS)))


def test_the_slope_of_a_shape_that_is_zero_is_finite(pendulum):
    """A step in proportion to the shape would be none."""

    @dataclass(frozen=True)
    class SpringAbout(JointEffect):
        rest: float = 0.0

        name: ClassVar[str] = "spring_about"
        equation: ClassVar[str] = "−k (q − r)³"
        traits: ClassVar[Traits] = Traits({Signal.POSITION})
        parameters = (Parameter("stiffness", "{effort}/{position}³"),)
        shape = (Parameter("rest", "{position}"),)

        def columns(self, x):
            return [-((x.q - self.rest) ** 3)]

    regression = prepared(pendulum, lambda q, v, a: np.column_stack([-0.2 * q[:, 0] ** 3, np.zeros(len(q))]))
    model, equations = refit(regression, model_with(pendulum, SpringAbout("joint1")))
    (low, high), *_ = with_intervals(model, equations).terms[0].ci95
    assert low < 0.2 < high
    assert high - low < 0.05


def test_a_step_that_diverges_is_halved_until_it_no_longer_does(pendulum, monkeypatch):
    from cdia_pin.regression import gauss_newton

    steps, tried = [], []
    evaluate = Regression.chi2

    def wild(equations, chosen, **options):
        fit = bounded_fit(equations, chosen, **options)
        steps.append(fit)
        return replace(fit, theta=fit.theta + 30.0) if len(steps) == 1 else fit

    def counted(self, *args):
        tried.append(args)
        return evaluate(self, *args)

    regression = prepared(pendulum, friction)
    start = Dynamics(pendulum, (Term(COULOMB, (0.0,)), Term(EncoderOffset("joint2"), (0.0,))))
    expected = gauss_newton.fitted_together(regression, start)
    monkeypatch.setattr(gauss_newton, "bounded_fit", wild)
    monkeypatch.setattr(Regression, "chi2", counted)
    found = gauss_newton.fitted_together(regression, start)
    assert len(tried) > len(steps)
    for one, other in zip(found.terms, expected.terms, strict=True):
        np.testing.assert_allclose(one.theta, other.theta, atol=1e-3)


@dataclass
class Overshooting:
    """A regression of one delay whose linearisation is wrong: each step goes beyond the optimum at zero."""

    formed: int = 0
    tried: int = 0

    def normal_equations(self, model, effects):
        self.formed += 1
        (delay,) = model.terms[0].theta
        return SimpleNamespace(
            delay=delay,
            samples=100,
            objective=lambda every, theta: 1 + 1e6 * theta[0] ** 2,
            from_prior=lambda every, theta: 0.0,
        )

    def chi2(self, model):
        self.tried += 1
        return 1 + 1e6 * model.theta[0] ** 2


def fitted_delay(pendulum, regression):
    model = Dynamics(pendulum, (Term(EffortDelay(), (0.003,)),))
    return fitted_together(regression, model).terms[0].theta[0]


def test_a_step_that_promises_no_more_ends_a_fit(pendulum, monkeypatch):
    """Bodies are made possible to a tolerance: at the optimum a step may promise a little more than there is."""

    def promised(equations, every, bodies):
        now = 1 + 1e6 * equations.delay**2
        if equations.delay == 0.003:  # the first step comes near the optimum
            return SimpleNamespace(theta=[1e-4], chi2=1.01, objective=1.01)
        return SimpleNamespace(theta=[1.01 * equations.delay], chi2=now + 0.3, objective=now + 0.3)

    monkeypatch.setattr(gauss_newton, "bounded_fit", promised)
    regression = Overshooting()
    delay = fitted_delay(pendulum, regression)
    assert abs(delay) < 1.1e-4
    assert regression.formed == 2


def test_a_direction_that_leads_nowhere_ends_a_fit(pendulum, monkeypatch):
    """Each step promises less and leaves more, however short it is: the fit ends where it was."""

    def promised(equations, every, bodies):
        return SimpleNamespace(theta=[equations.delay + 0.01], chi2=0.0, objective=0.0)

    monkeypatch.setattr(gauss_newton, "bounded_fit", promised)
    monkeypatch.setattr(gauss_newton, "MOST_LEFT", 0.0)
    regression = Overshooting()
    delay = fitted_delay(pendulum, regression)
    assert delay == 0.003
    assert (regression.formed, regression.tried) == (1, gauss_newton.MOST_HALVED + 1)


@pytest.mark.parametrize("beyond", [0.5, 1.3, 3.0])
def test_a_fit_never_ends_worse_than_it_was(pendulum, monkeypatch, beyond):
    def promised(equations, every, bodies):
        return SimpleNamespace(theta=[-beyond * equations.delay], chi2=1.0, objective=1.0)

    monkeypatch.setattr(gauss_newton, "bounded_fit", promised)
    delay = fitted_delay(pendulum, Overshooting())
    assert abs(delay) <= 0.003
    if beyond < 3.0:
        assert abs(delay) < 2e-4


def test_the_step_to_a_model_is_halved_too(pendulum, monkeypatch):
    """A search hands over a model after the first step, which may be too long for the linearisation."""

    def promised(equations, every, bodies):
        return SimpleNamespace(theta=[equations.delay], chi2=1.0, objective=1.0)

    monkeypatch.setattr(gauss_newton, "bounded_fit", promised)
    far = Dynamics(pendulum, (Term(EffortDelay(), (0.05,)),))
    began = Before(np.array([0.003]), 1 + 1e6 * 0.003**2)
    alone, known = (
        fitted_together(Overshooting(), far, 2, before).terms[0].theta[0] for before in (None, began)
    )
    assert alone == 0.05
    assert known == pytest.approx(0.003, abs=1e-3)
