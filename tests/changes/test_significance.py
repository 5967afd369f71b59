"""Several parameters are asked for the certainty that chance shows as rarely as that of one."""

import numpy as np
import pytest
from scipy.special import stdtr

from cdia_pin.changes.significance import certainty_of_several


@pytest.mark.parametrize(("parameters", "blocks"), [(1, 16), (2, 32), (4, 32), (10, 64)])
def test_chance_exceeds_it_as_often_as_that_of_one_parameter(parameters, blocks):
    rng, draws, one = np.random.default_rng(1), 20_000, 2.5
    estimates = rng.standard_normal((draws, blocks, parameters))
    mean = estimates.mean(axis=1)
    apart = estimates - mean[:, None]
    covariance = np.einsum("dbp,dbq->dpq", apart, apart) / (blocks - 1) / blocks
    squares = np.einsum("dp,dp->d", mean, np.linalg.solve(covariance, mean[..., None])[..., 0])
    exceeded = np.sqrt(squares / parameters) > certainty_of_several(one, parameters, 1, blocks)
    single = np.abs(rng.standard_t(blocks - 1, 10 * draws)) > one
    assert np.mean(exceeded) == pytest.approx(np.mean(single), rel=0.15)


def test_more_parameters_need_less_and_more_shapes_need_more():
    few, more = (certainty_of_several(5.0, k, 1, 32) for k in (2, 4))
    assert more < few < certainty_of_several(5.0, 2, 6, 32) < 5.0
    assert certainty_of_several(5.0, 1, 1, 32) == pytest.approx(5.0)


@pytest.mark.parametrize("blocks", [2, 10, 11])
def test_few_blocks_never_ask_for_more_than_of_one_parameter(blocks):
    assert certainty_of_several(5.0, 10, 3, blocks) == 5.0


def test_it_is_exact_far_out():
    """There one less what is rare would be one. Of two parameters the distribution has a closed form."""
    rarity = 2.0 * stdtr(31, -17.0)
    expected = np.sqrt(15 * (rarity ** (-1 / 15) - 1) * 31 / 30)
    assert certainty_of_several(17.0, 2, 1, 32) == pytest.approx(expected)
