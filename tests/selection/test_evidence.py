"""Evidence: whatever is read from the normal equations equals what the samples themselves give."""

from itertools import combinations, pairwise

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from cdia_pin import load_robot
from cdia_pin.effects import (
    AsymmetricFriction,
    CoulombFriction,
    JointSpring,
    LinkInertia,
    Payload,
    PositionRipple,
    QuadraticFriction,
    StribeckFriction,
    TorqueOffset,
    ViscousFriction,
)
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.physical_consistency import consistent_parameters
from cdia_pin.robot.inertia import parameters_of, pseudo_inertia
from cdia_pin.selection import moves
from cdia_pin.selection.criterion import SelectionCriterion
from cdia_pin.selection.evidence import Evidence, needed_gain
from cdia_pin.selection.moves import improve

JOINT = "joint1"
LEAST_SHARE = SelectionCriterion().least_share
FREE = [TorqueOffset(JOINT), PositionRipple(JOINT), TorqueOffset("joint2"), PositionRipple("joint2")]
BOUND = [CoulombFriction(JOINT), ViscousFriction(JOINT), QuadraticFriction(JOINT), JointSpring(JOINT)]
SAMPLES, BLOCKS = 400, 5
EDGES = np.linspace(0, SAMPLES, BLOCKS + 1).astype(int)


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


def spans(effects):
    ends = np.cumsum([e.size for e in effects])
    return [np.arange(end - e.size, end) for e, end in zip(effects, ends, strict=True)]


def problem(robot, effects, theta=None, *, seed=0, noise=1.0, mix=0.5):
    """Evidence of correlated random columns, and the columns X and response y themselves."""
    rng = np.random.default_rng(seed)
    size = sum(e.size for e in effects)
    x = rng.standard_normal((SAMPLES, size)) @ (np.eye(size) + mix * rng.standard_normal((size, size)))
    y = x @ (rng.standard_normal(size) if theta is None else np.asarray(theta, float))
    y = y + noise * rng.standard_normal(SAMPLES)
    whole = np.column_stack([x, y])
    blocks = np.array([whole[a:b].T @ whole[a:b] for a, b in pairwise(EDGES)])
    return Evidence(NormalEquations(robot, effects, blocks, SAMPLES)), x, y


def left(x, y):
    return float(np.sum((y - x @ np.linalg.lstsq(x, y, rcond=None)[0]) ** 2)) if x.shape[1] else float(y @ y)


def subsets(count):
    return [list(c) for k in range(count + 1) for c in combinations(range(count), k)]


# ---------------------------------------------------------------- one set


@pytest.mark.parametrize("chosen", subsets(len(FREE)), ids=str)
def test_a_fit_is_least_squares(pendulum, chosen):
    evidence, x, y = problem(pendulum, FREE)
    at = evidence.equations.columns(chosen)
    fit = evidence.fit(chosen)
    np.testing.assert_allclose(fit.theta, np.linalg.lstsq(x[:, at], y, rcond=None)[0], rtol=1e-6, atol=1e-8)
    assert fit.chi2 == pytest.approx(left(x[:, at], y), rel=1e-8)
    assert fit.cost == pytest.approx(fit.chi2 + evidence.penalty[chosen].sum())
    assert fit.physical


def test_the_order_in_which_effects_are_named_changes_nothing(pendulum):
    evidence, *_ = problem(pendulum, FREE)
    one, other = evidence.fit([3, 0, 2]), evidence.fit((0, 2, 3))
    assert one.chosen == other.chosen == (0, 2, 3)
    np.testing.assert_array_equal(one.theta, other.theta)


def test_a_fit_of_more_effects_never_leaves_more(pendulum):
    evidence, *_ = problem(pendulum, FREE)
    for chosen in subsets(len(FREE)):
        for c in set(range(len(FREE))) - set(chosen):
            assert evidence.fit([*chosen, c]).chi2 <= evidence.fit(chosen).chi2 * (1 + 1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_parameters_that_would_pass_their_bounds_are_held_and_the_others_refitted(pendulum, seed):
    """The truth has negative friction; the best physical fit is that of a bounded least-squares solver."""
    evidence, x, y = problem(pendulum, BOUND, theta=[-1.0, 2.0, 0.5, 3.0, -2.0], seed=seed)
    lower, upper = (np.concatenate(b) for b in zip(*(e.bounds(pendulum) for e in BOUND), strict=True))
    fit = evidence.fit(range(len(BOUND)))
    assert (fit.theta >= lower).all() and (fit.theta <= upper).all()
    best = lsq_linear(x, y, (lower, upper), tol=1e-12)
    assert fit.chi2 == pytest.approx(2 * best.cost, rel=1e-3)
    assert fit.theta[0] == 0.0


def test_no_physical_fit_costs_less_than_its_bound(pendulum):
    for seed in range(5):
        evidence, *_ = problem(pendulum, BOUND, seed=seed)
        for chosen in subsets(len(BOUND)):
            assert evidence.bound(chosen) <= evidence.fit(chosen).cost + 1e-6
            assert evidence.bound(chosen) == pytest.approx(
                evidence.free_chi2(chosen) + evidence.penalty[chosen].sum()
            )


def test_a_set_in_which_one_effect_repeats_another_is_not_accepted(pendulum):
    effects = [CoulombFriction(JOINT), TorqueOffset(JOINT), AsymmetricFriction(JOINT)]
    rng = np.random.default_rng(1)
    v = rng.standard_normal(SAMPLES)
    x = np.column_stack(
        [-np.sign(v), np.ones(SAMPLES), -1.0 * (v > 0), v < 0, -np.maximum(v, 0), -np.minimum(v, 0)]
    )
    whole = np.column_stack([x, x @ [2.0, 1.0, 0, 0, 0, 0] + rng.standard_normal(SAMPLES)])
    evidence = Evidence(NormalEquations(pendulum, effects, (whole.T @ whole)[None], SAMPLES))
    assert evidence.fit([0, 1]).physical
    assert evidence.fit([2]).physical
    assert not evidence.fit([0, 1, 2]).physical
    assert not evidence.fit([0, 2]).physical


# ---------------------------------------------------------------- every candidate beside a set


@pytest.mark.parametrize("chosen", subsets(3), ids=str)
def test_gains_are_what_each_candidate_would_take_from_the_sum_of_squares(pendulum, chosen):
    evidence, x, y = problem(pendulum, FREE, seed=3)
    gains = evidence.gains(chosen)
    before = left(x[:, evidence.equations.columns(chosen)], y)
    for c in range(len(FREE)):
        after = left(x[:, evidence.equations.columns([*chosen, c])], y) if c not in chosen else before
        assert gains[c] == pytest.approx(before - after, rel=2e-3, abs=1e-6 * before), c


@pytest.mark.parametrize("seed", range(5))
def test_bounded_gains_are_those_of_possible_parameters(pendulum, seed):
    effects = [TorqueOffset(JOINT), JointSpring(JOINT), *BOUND[:3], AsymmetricFriction(JOINT)]
    evidence, x, y = problem(pendulum, effects, seed=seed)
    base = x[:, spans(effects)[0]]
    rest = y - base @ np.linalg.lstsq(base, y, rcond=None)[0]
    free, gains = evidence.gains([0]), evidence.gains([0], bounded=True)
    assert (gains <= free + 1e-9).all()
    for c, (effect, own) in enumerate(zip(effects[1:], spans(effects)[1:], strict=True), start=1):
        columns = x[:, own] - base @ np.linalg.lstsq(base, x[:, own], rcond=None)[0]
        best = lsq_linear(columns, rest, bounds=effect.bounds(pendulum))
        assert gains[c] <= rest @ rest - 2.0 * best.cost + 1e-3 * (y @ y)
        if effect.size == 1:
            assert gains[c] == pytest.approx(rest @ rest - 2.0 * best.cost, abs=1e-3 * (y @ y))


def test_friction_that_would_push_does_not_hide_that_of_another_joint(pendulum, monkeypatch):
    """A joint whose effort has the wrong sign: every kind of friction explains it, and none is possible."""
    pushing = [AsymmetricFriction(JOINT), StribeckFriction(JOINT)]
    effects = [*pushing, CoulombFriction("joint2")]
    pushed = sum(e.size for e in pushing)
    evidence, *_ = problem(pendulum, effects, [-6.0] * pushed + [5.0], mix=0.0)
    monkeypatch.setattr(moves, "TRIED", len(pushing))  # both explain more than the last one does
    only = len(effects) - 1
    assert improve(evidence, (), lambda _: True, most=5).chosen == (only,)
    monkeypatch.setattr(moves, "HIDDEN", 1.0)
    assert improve(evidence, (), lambda _: True, most=5) is None


def test_a_candidate_that_the_set_spans_gains_nothing(pendulum):
    rng = np.random.default_rng(4)
    x = rng.standard_normal((SAMPLES, 2))
    whole = np.column_stack([x[:, 0], x @ [1.0, 2.0], x[:, 1], 3 * x[:, 0] + rng.standard_normal(SAMPLES)])
    effects = [TorqueOffset(JOINT), TorqueOffset("joint2"), CoulombFriction(JOINT)]
    evidence = Evidence(NormalEquations(pendulum, effects, (whole.T @ whole)[None], SAMPLES))
    assert evidence.gains([0, 2])[1] < 1e-3 * evidence.gains([])[1]


# ---------------------------------------------------------------- held-out blocks


def at_its_limit(robot):
    """Evidence in which a payload of negative mass would explain what an offset does."""
    rng = np.random.default_rng(7)
    x = rng.standard_normal((SAMPLES, 11))
    x[:, 10] = -x[:, 0] + 0.1 * rng.standard_normal(SAMPLES)
    whole = np.column_stack([x, 5.0 * x[:, 10] + rng.standard_normal(SAMPLES)])
    blocks = np.array([whole[a:b].T @ whole[a:b] for a, b in pairwise(EDGES)])
    return Evidence(NormalEquations(robot, [Payload(), TorqueOffset(JOINT)], blocks, SAMPLES))


def test_a_body_that_is_held_at_its_limit_predicts_no_better_than_it_fits(pendulum):
    evidence = at_its_limit(pendulum)
    held = evidence.fit([0], bodies=True)
    assert evidence.equations.held_out([0], held.theta) > 0.99 * held.chi2
    free = evidence.fit([0])  # within its bounds
    assert evidence.equations.held_out([0], evidence.equations.optimum([0])[0]) < 0.1 * held.chi2 < free.chi2


def held_out(evidence, chosen):
    return evidence.equations.held_out(chosen, evidence.fit(chosen).theta)


@pytest.mark.parametrize("chosen", [[0], [0, 1], [0, 1, 2, 3]], ids=str)
def test_held_out_error_is_that_of_fits_to_the_other_blocks(pendulum, chosen):
    evidence, x, y = problem(pendulum, FREE, seed=5)
    at, expected = evidence.equations.columns(chosen), 0.0
    for start, stop in pairwise(EDGES):
        rest = np.r_[0:start, stop:SAMPLES]
        theta = np.linalg.lstsq(x[np.ix_(rest, at)], y[rest], rcond=None)[0]
        expected += float(np.sum((y[start:stop] - x[start:stop][:, at] @ theta) ** 2))
    assert held_out(evidence, chosen) == pytest.approx(expected, rel=1e-6)


def test_an_effect_of_noise_alone_does_not_pay_on_held_out_blocks(pendulum):
    worse = 0
    for seed in range(20):
        evidence, *_ = problem(pendulum, FREE, theta=[2.0, 0, 0, 0, 0, 0], seed=seed, mix=0.0)
        worse += held_out(evidence, [0, 1, 2, 3]) > held_out(evidence, [0])
    assert worse >= 15


# ---------------------------------------------------------------- penalties


def test_each_parameter_has_a_penalty(pendulum):
    evidence, *_ = problem(pendulum, [CoulombFriction(JOINT), AsymmetricFriction(JOINT)])
    coulomb, asymmetric = evidence.penalty
    assert asymmetric > 2 * coulomb > 0


def test_noise_never_pays_the_penalty(pendulum):
    """Over 200 draws of noise alone hardly a candidate is worth its penalty: clean data must give none."""
    effects = [*FREE, *BOUND]
    paid = 0
    for seed in range(200):
        evidence, *_ = problem(pendulum, effects, theta=np.zeros(11), seed=seed)
        paid += int((evidence.gains([]) > evidence.least_gain).any())
    assert paid == 0


def test_an_effect_must_matter_beside_the_residual_and_beside_the_torque():
    left_over = np.array([1000.0, 1000.0])
    dominated = needed_gain(left_over, np.array([1.0, 1.0]), np.array([0.015, 0.015]), LEAST_SHARE)
    tiny = needed_gain(left_over, np.array([1e-3, 1e-3]), np.array([0.015, 0.15]), LEAST_SHARE)
    assert (dominated >= 0.05 * left_over).all() and (dominated <= 0.2 * left_over).all()
    assert (tiny > left_over).all()  # nothing in so small a residual is worth a name
    assert tiny[1] == pytest.approx(100 * tiny[0])


# ---------------------------------------------------------------- possible bodies


def bodies(robot, tail_mass=None):
    """A body on the last link as seen by random rows, and what is true of it."""
    effect = Payload()
    theta = parameters_of(0.4, [0.02, 0.01, 0.05], np.diag([1e-3, 1.2e-3, 8e-4]))
    if tail_mass is not None:
        theta = theta.copy()
        theta[0] = tail_mass
    x = np.random.default_rng(0).standard_normal((500, 10))
    return effect, theta, x


def test_a_possible_body_is_left_as_the_unconstrained_fit_has_it(pendulum):
    effect, theta, x = bodies(pendulum)
    y = x @ theta + 1e-4 * np.random.default_rng(1).standard_normal(500)
    found = consistent_parameters(x.T @ x, x.T @ y, [effect], pendulum)
    np.testing.assert_allclose(found, np.linalg.solve(x.T @ x, x.T @ y), atol=1e-6)


@pytest.mark.parametrize("effect", [Payload(), LinkInertia("joint1"), LinkInertia("joint2")])
def test_an_impossible_body_becomes_the_nearest_possible_one(pendulum, effect):
    rng = np.random.default_rng(2)
    x = rng.standard_normal((500, 10))
    wanted = np.array([-1.0, 0.3, 0.2, -0.4, -0.01, 0.0, 0.02, 0.0, 0.0, -0.03])  # less mass than there is
    gram, right = x.T @ x, x.T @ (x @ wanted)
    found = consistent_parameters(gram, right, [effect], pendulum)
    assert not effect.is_physical(wanted, pendulum)
    assert effect.is_physical(found, pendulum)
    assert np.linalg.eigvalsh(pseudo_inertia(effect.total(found, pendulum))).min() > -1e-9
    cost = lambda p: 0.5 * p @ gram @ p - right @ p  # noqa: E731
    total = effect.total(np.zeros(10), pendulum)
    for _ in range(300):  # no possible body between it and any other fits better
        body = parameters_of(
            rng.uniform(0.01, 2), rng.uniform(-0.3, 0.3, 3), np.diag(rng.uniform(0.01, 0.02, 3))
        )
        other = np.linalg.solve(effect.to_joint_frame(pendulum), body - total)
        if effect.is_physical(other, pendulum):
            towards = found + 1e-3 * (other - found)
            assert cost(towards) >= cost(found) - 1e-6 * abs(cost(found))


def test_bodies_and_friction_are_held_to_their_bounds_together(pendulum):
    effects = [Payload(), CoulombFriction(JOINT)]
    x = np.random.default_rng(3).standard_normal((500, 11))
    theta = np.array([0.3, 0, 0, 0.01, 1e-3, 0, 1e-3, 0, 0, 1e-3, -2.0])
    found = consistent_parameters(x.T @ x, x.T @ (x @ theta), effects, pendulum)
    assert found[-1] == pytest.approx(0.0, abs=1e-6)
    assert effects[0].is_physical(found[:10], pendulum)


def test_fits_with_bodies_return_possible_ones(pendulum):
    effect, theta, x = bodies(pendulum, tail_mass=-2.0)
    whole = np.column_stack([x, x @ theta + 0.1 * np.random.default_rng(4).standard_normal(500)])
    evidence = Evidence(NormalEquations(pendulum, [effect], (whole.T @ whole)[None], 500))
    fit = evidence.fit([0], bodies=True)
    assert effect.is_physical(fit.theta, pendulum)


def test_an_addition_may_turn_an_effect_into_the_simpler_one_that_it_reduces_to(pendulum):
    rng = np.random.default_rng(4)
    level, offset = rng.standard_normal((2, SAMPLES))
    # it stands for the offset until that is there
    breakaway = 0.7 * offset + 0.3 * rng.standard_normal(SAMPLES)
    y = 2.0 * level + 5.0 * offset + 0.1 * rng.standard_normal(SAMPLES)
    whole = np.column_stack([level, breakaway, level, offset, y])
    blocks = np.array([whole[a:b].T @ whole[a:b] for a, b in pairwise(EDGES)])
    effects = [StribeckFriction(JOINT), CoulombFriction(JOINT), TorqueOffset(JOINT)]
    evidence = Evidence(NormalEquations(pendulum, effects, blocks, SAMPLES))
    falls, plain, constant = range(3)
    assert evidence.fit((falls,)).physical
    assert not evidence.fit((falls, constant)).physical
    assert evidence.simpler_set(evidence.fit((falls,))) is None
    assert evidence.simpler_set(evidence.fit((falls, constant))) == (plain, constant)
    better = improve(evidence, (falls,), lambda _: True, most=5)
    assert better.chosen == (plain, constant)
    forbidden = improve(evidence, (falls,), lambda c: c != (plain, constant), most=5)
    assert forbidden is None or forbidden.chosen != (plain, constant)
