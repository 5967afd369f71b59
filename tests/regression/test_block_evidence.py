"""Evidence by blocks: the same numbers as fitting everything again without each block."""

import numpy as np
import pytest

from cdia_pin.effects import CoulombFriction, TorqueOffset, ViscousFriction
from cdia_pin.regression.block_evidence import BlockEvidence
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


@pytest.fixture(scope="module")
def evidence(rows):
    common, x, y = rows
    groups = [ColumnGroup({0: common}, np.full(4, PRIOR))]
    groups += [ColumnGroup({0: x[:, [k]]}, np.full(1, np.inf)) for k in range(3)]
    regression = SharedRegression.of(groups, y[:, None], lambda _, part: part)
    return BlockEvidence.of(EFFECTS, regression, BLOCKS, load_robot("double_pendulum"))


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


def test_what_is_there_is_certain_and_what_is_not_there_is_not(evidence):
    certainty = evidence.fits([]).certainty
    assert min(certainty[0], evidence.fits([0]).certainty[1]) > 10
    assert evidence.fits([0, 1]).certainty[2] < 4
