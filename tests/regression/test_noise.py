"""Whitening: what a noise model leaves of its own noise is white, of unit variance, and knows where logs end."""

import numpy as np
import pytest

from cdia_pin.regression.noise import NoiseModel, fit_noise
from tests.made_logs import autoregressive

COLOURS = {"white": [], "first order": [0.7], "second order": [1.2, -0.5], "slow": [0.95]}


def fitted(residual, lengths=None, informative=None, nearness=None, parameters=0.0):
    count = len(residual)
    return fit_noise(
        residual,
        np.ones(count, bool) if informative is None else informative,
        np.zeros(count, int) if nearness is None else nearness,
        lengths or [count],
        parameters,
    )


def autocorrelation(x, lag):
    return float(x[lag:] @ x[:-lag]) / float(x @ x)


@pytest.mark.parametrize("colour", COLOURS)
def test_innovations_are_white_and_of_unit_variance(colour):
    e = autoregressive(COLOURS[colour], (6000,), np.random.default_rng(1), sigma=0.3)
    noise = fitted(e)
    w = noise.whiten(e)[noise.kept]
    assert w.std() == pytest.approx(1.0, abs=0.03)
    # a share of white noise is taken for granted, so that a quarter of a strong colour may be left at first
    assert abs(autocorrelation(w, 1)) < max(0.06, 0.25 * autocorrelation(e, 1))
    for lag in (2, 3, 5, 10):
        assert abs(autocorrelation(w, lag)) < 0.06, lag


def test_white_noise_is_left_as_it_is():
    e = 0.3 * np.random.default_rng(2).standard_normal(6000)
    noise = fitted(e)
    assert np.abs(noise.coefficients).max() < 0.05
    assert noise.sigma == pytest.approx(0.3, rel=0.03)


def test_whitening_is_linear():
    rng = np.random.default_rng(3)
    noise = NoiseModel(np.array([0.6, -0.2]), np.full(300, 0.5), (300,))
    x, y = rng.standard_normal((2, 300, 4))
    np.testing.assert_allclose(
        noise.whiten(2 * x - 3 * y), 2 * noise.whiten(x) - 3 * noise.whiten(y), atol=1e-12
    )


def test_columns_are_whitened_one_by_one():
    noise = NoiseModel(np.array([0.6, -0.2]), np.linspace(0.5, 1, 300), (300,))
    x = np.random.default_rng(4).standard_normal((300, 3))
    np.testing.assert_allclose(noise.whiten(x)[:, 1], noise.whiten(x[:, 1]))


def test_each_log_is_whitened_as_if_alone():
    x = np.random.default_rng(5).standard_normal(500)
    a = np.array([0.8, -0.1, 0.05])
    both = NoiseModel(a, np.ones(500), (200, 300))
    alone = [NoiseModel(a, np.ones(k), (k,)) for k in (200, 300)]
    np.testing.assert_array_equal(both.kept, np.concatenate([m.kept for m in alone]))
    np.testing.assert_allclose(
        both.whiten(x), np.concatenate([alone[0].whiten(x[:200]), alone[1].whiten(x[200:])])
    )


def test_samples_without_a_full_past_do_not_count():
    noise = NoiseModel(np.array([0.8, -0.1]), np.ones(10), (6, 4))
    np.testing.assert_array_equal(np.flatnonzero(~noise.kept), [0, 1, 6, 7])
    assert not noise.whiten(np.ones(10))[~noise.kept].any()


def test_a_jump_between_logs_is_no_innovation():
    rng = np.random.default_rng(6)
    quiet = autoregressive([0.8], (4000,), rng)
    jump = quiet + np.repeat([0.0, 500.0], 2000)
    at_once, apart = fitted(jump), fitted(jump, lengths=[2000, 2000])
    seen = [m.whiten(jump)[m.kept] for m in (at_once, apart)]
    assert np.abs(seen[0]).max() > 20
    assert np.abs(seen[1]).max() < 20


def test_slow_noise_makes_a_constant_less_certain():
    """The whitened information about a mean is that of its long-run variance, σ²/(1 − a)²/N."""
    e = autoregressive([0.7], (20_000,), np.random.default_rng(7))
    noise = fitted(e)
    variance = 1.0 / float(np.sum(noise.whiten(np.ones(len(e))) ** 2))
    assert variance == pytest.approx(1.0 / (1 - 0.7) ** 2 / len(e), rel=0.2)


def test_degrees_of_freedom_make_the_noise_larger():
    e = np.random.default_rng(8).standard_normal(400)
    more, none = fitted(e, parameters=100).sigma, fitted(e).sigma
    assert more / none == pytest.approx(np.sqrt(1 / (1 - 100 / none.size)), rel=0.03)


def test_noise_has_a_size_of_its_own_near_rest():
    rng = np.random.default_rng(9)
    nearness = np.repeat([0, 1, 0, 1], 1000)
    e = np.where(nearness == 0, 3.0, 1.0) * rng.standard_normal(4000)
    sigma = fitted(e, nearness=nearness).sigma
    assert sigma[0] == pytest.approx(3.0, rel=0.1)
    assert sigma[1500] == pytest.approx(1.0, rel=0.1)


def test_a_class_of_few_samples_borrows_from_all():
    rng = np.random.default_rng(10)
    nearness = np.ones(2000, int)
    nearness[500:502] = 0
    e = rng.standard_normal(2000)
    e[500:502] = 1e-6  # by chance nothing: not to be trusted without limit
    assert fitted(e, nearness=nearness).sigma[500] > 0.8


@pytest.mark.parametrize("colour", ["white", "first order", "slow"])
def test_samples_that_do_not_count_say_nothing_about_the_noise(colour):
    """Near a reversal friction is whatever keeps the joint where it is, as large as it likes."""
    rng = np.random.default_rng(11)
    e = autoregressive(COLOURS[colour], (6000,), rng)
    informative = np.ones(6000, bool)
    informative[::60] = informative[1::60] = False
    strange = np.where(informative, e, e + 30.0)
    as_it_is, disturbed = (fitted(x, informative=informative) for x in (e, strange))
    assert np.median(disturbed.sigma / as_it_is.sigma) == pytest.approx(1.0, abs=0.02)
