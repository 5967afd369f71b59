"""Evidence by blocks: the same numbers as fitting everything again without each block."""

import numpy as np
import pytest

from cdia_pin.effects import CoulombFriction, TorqueOffset, ViscousFriction
from cdia_pin.regression.block_evidence import BlockEvidence, certainty_of
from cdia_pin.regression.shared_parameters import ColumnGroup, SharedRegression
from cdia_pin.robot import load_robot

EFFECTS = [CoulombFriction("joint1"), ViscousFriction("joint1"), TorqueOffset("joint1")]
BLOCKS = [slice(k, k + 25) for k in range(0, 200, 25)]
PRIOR = 0.5  # standard deviation of each parameter of the common structure


@pytest.fixture(scope="module")
def rows():
    """Columns of a common structure and of the effects, and a response that has the first two effects."""
    rng = np.random.default_rng(0)
    common, x = rng.standard_normal((200, 4)), rng.standard_normal((200, 3))
    y = common @ [1.0, -1.0, 0.3, 0.0] + x @ [2.0, -1.0, 0.0] + 0.3 * rng.standard_normal(200)
    return common, x, y


def evidence_of(rows, parts=()):
    common, x, y = rows
    groups = [ColumnGroup({0: common}, np.full(4, PRIOR))]
    groups += [ColumnGroup({0: x[:, [k]]}, np.full(1, np.inf)) for k in range(3)]
    regression = SharedRegression.of(groups, y[:, None], lambda _, part: part)
    return BlockEvidence.of(EFFECTS, regression, BLOCKS, load_robot("double_pendulum"), parts)


@pytest.fixture(scope="module")
def evidence(rows):
    return evidence_of(rows)


def fitted(rows, chosen, seen):
    """Parameters of the common structure and of some effects, fitted to some samples."""
    common, x, y = rows
    columns = np.column_stack([common, x[:, chosen]])[seen]
    prior = np.diag([PRIOR**-2] * 4 + [0.0] * len(chosen))
    return np.linalg.solve(columns.T @ columns + prior, columns.T @ y[seen])


def left(rows, chosen):
    """Sum of squares of each block, predicted from all others."""
    common, x, y = rows
    out = []
    for block in BLOCKS:
        theta = fitted(rows, chosen, np.delete(np.arange(200), block))
        unseen = np.column_stack([common, x[:, chosen]])[block]
        out.append(np.sum((y[block] - unseen @ theta) ** 2))
    return np.array(out)


@pytest.mark.parametrize("chosen", [[], [0], [0, 1], [0, 1, 2]])
def test_what_a_set_leaves_is_that_of_a_fit_without_each_block(rows, evidence, chosen):
    np.testing.assert_allclose(evidence.unexplained(chosen), left(rows, chosen), rtol=1e-6)


def test_a_gain_is_what_the_effect_lowers_on_blocks_that_were_left_out(rows, evidence):
    fits = evidence.fits([0])
    for one in (1, 2):
        wanted = left(rows, [0]) - left(rows, [0, one])
        np.testing.assert_allclose(fits.gains[one], wanted, atol=0.02 * np.abs(wanted).max())
    assert fits.gain[1] > 50 > fits.gain[2]


def test_the_covariance_is_the_jackknife_over_blocks(rows, evidence):
    theta, covariance = evidence.estimate([0, 1])
    without = [fitted(rows, [0, 1], np.delete(np.arange(200), b))[4:] for b in BLOCKS]
    whole = fitted(rows, [0, 1], np.arange(200))[4:]
    np.testing.assert_allclose(theta, whole, rtol=1e-6)
    moved = np.array(without) - whole
    np.testing.assert_allclose(covariance, 7 / 8 * moved.T @ moved, rtol=1e-4)


SPEED = np.abs(np.sin(1.7 * np.arange(200)))  # of the joint, at each sample
QUARTERS = [np.isin(np.arange(200), part) for part in np.array_split(np.argsort(SPEED), 4)]


def variances(rows, left_out):
    """Of the first two effects, from fits without each of some parts."""
    whole = fitted(rows, [0, 1], np.arange(200))[4:]
    moved = np.array([fitted(rows, [0, 1], np.setdiff1d(np.arange(200), part))[4:] for part in left_out])
    return (len(moved) - 1) / len(moved) * np.sum((moved - whole) ** 2, axis=0)


def test_a_parameter_is_as_uncertain_as_parts_of_the_speeds_say_if_they_say_more(rows):
    common, x, y = rows
    bent = (common, x, y + 2 * SPEED**4 * x[:, 0])  # the first effect is another at high speeds
    evidence = evidence_of(bent, [part[:, None] for part in QUARTERS])
    by_time = variances(bent, [np.arange(200)[block] for block in BLOCKS])
    by_speed = variances(bent, [np.flatnonzero(part) for part in QUARTERS])
    found = np.diag(evidence.estimate([0, 1])[1])
    assert by_speed[0] > 2 * by_time[0]
    # each quarter holds about as much of what is known
    assert found[0] == pytest.approx(by_speed[0], rel=0.1)
    assert found[1] == pytest.approx(by_time[1], rel=1e-4)
    assert evidence.fits([1]).certainties[1][0] < 0.7 * evidence.fits([1]).certainties[0][0]


def test_an_effect_of_one_part_of_the_speeds_is_not_less_certain_for_that(rows):
    common, x, y = rows
    # as Stribeck friction, which the slowest quarter shows
    own = x * np.where(QUARTERS[0], 1.0, 0.05)[:, None]
    slow = (common, own, y - x @ [2.0, -1.0, 0.0] + own @ [2.0, -1.0, 0.0])
    by_time, by_both = evidence_of(slow, [part[:, None] for part in QUARTERS]).fits([]).certainties
    of_time = variances(slow, [np.arange(200)[block] for block in BLOCKS])
    assert variances(slow, [np.flatnonzero(part) for part in QUARTERS])[0] > 1.6 * of_time.max()
    np.testing.assert_allclose(by_both, by_time)


def test_a_part_without_which_two_effects_are_alike_says_nothing_of_them(rows):
    common, x, y = rows
    # as Coulomb friction and bristles, which only the slowest quarter tells apart
    alike = np.where(QUARTERS[0], x[:, 1], x[:, 0] + 0.1 * x[:, 1])
    both = np.column_stack([x[:, 0], alike, x[:, 2]])
    bent = 2 * SPEED * x[:, 1]  # something else at high speeds
    sizes = (common, both, y - x @ [2.0, -1.0, 0.0] + both @ [2.0, -1.0, 0.0] + bent)
    by_part = variances(sizes, [np.flatnonzero(part) for part in QUARTERS])
    by_time = variances(sizes, [np.arange(200)[block] for block in BLOCKS])
    assert (by_part > 100 * by_time).all()
    _, covariances = evidence_of(sizes, [part[:, None] for part in QUARTERS]).estimate_with_both([0, 1])
    assert (np.diag(covariances[1]) < 10 * by_time).all()


def test_what_is_there_is_certain_and_what_is_not_there_is_not(evidence):
    certainty = evidence.fits([]).certainty
    assert min(certainty[0], evidence.fits([0]).certainty[1]) > 10
    assert evidence.fits([0, 1]).certainty[2] < 4


@pytest.mark.parametrize("size", [1, 10, 20, 60])
def test_noise_is_one_standard_deviation_from_zero_whatever_the_number_of_parameters(size):
    rng, blocks = np.random.default_rng(0), 32
    best = rng.normal(size=(40, size))
    moved = rng.normal(size=(40, blocks, size)) / np.sqrt(blocks)
    covariance = (blocks - 1) / blocks * np.einsum("cbp,cbq->cpq", moved, moved)
    assert np.median(certainty_of(best, covariance)) < 1.5
