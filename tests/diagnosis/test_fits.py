"""Fits of all combinations at once are those of each combination alone."""

import numpy as np
import pytest

from cdia_pin.diagnosis.fits import BOUND_SLACK, ranked, variances

ENDS = np.array([0, 1, 3, 4, 5])  # four effects, the second with two parameters
P = 5
INDEPENDENT, PRICE, TOLERANCE = 20.0, 3.0, 1.5


def problem(seed: int = 0, count: int = 400):
    rng = np.random.default_rng(seed)
    y = rng.standard_normal((count, P)) @ rng.standard_normal((P, P))
    r = y @ np.array([1.0, 0.0, 0.0, -2.0, 0.0]) + 0.1 * rng.standard_normal(count)
    return y, r


def run(y, r, *, required=0, most=4, lower=-np.inf, prior=0.0, centre=0.0, noise2=4.0):
    both = np.column_stack([y, r])
    theta, score, order = np.zeros((16, P)), np.zeros(16), np.zeros(16, np.int64)
    full = [np.full(P, float(x)) for x in (lower, np.inf, prior, centre)]
    count = ranked(
        np.triu(both.T @ both), ENDS, full[0], full[1], required, full[2], full[3], most,
        float(len(r)), noise2, INDEPENDENT, TOLERANCE**2, PRICE, theta, score, order,
    )  # fmt: skip
    return theta, score, order[:count].tolist()


def alone(y, r, mask):
    """Parameters and score of one combination by least squares."""
    columns = [k for i in range(4) if mask >> i & 1 for k in range(ENDS[i], ENDS[i + 1])]
    theta = np.zeros(P)
    theta[columns] = np.linalg.lstsq(y[:, columns], r, rcond=None)[0]
    rss = float(((r - y @ theta) ** 2).sum())
    return theta, rss / 8.0 / INDEPENDENT + PRICE * (len(columns) + max(mask.bit_count() - 1, 0)), rss


@pytest.mark.parametrize("required", [0, 0b0010, 0b1001])
@pytest.mark.parametrize("most", [1, 2, 4])
def test_each_combination_is_fitted_as_if_alone(required: int, most: int) -> None:
    y, r = problem()
    theta, score, order = run(y, r, required=required, most=most)
    possible = {}
    for mask in range(16):
        if mask & required != required or (mask & ~required).bit_count() > most:
            continue
        own, expected, rss = alone(y, r, mask)
        if rss / len(r) <= TOLERANCE**2 * 4.0:
            possible[mask] = expected
            np.testing.assert_allclose(theta[mask], own, rtol=1e-6, atol=1e-6)
            assert score[mask] == pytest.approx(expected, rel=1e-6)
    assert order == sorted(possible, key=lambda m: (possible[m], m))
    assert np.isinf(np.delete(score, list(possible))).all()


def test_parameters_beyond_their_bounds_make_a_combination_impossible() -> None:
    y, r = problem()
    _, _, order = run(y, r, lower=0.0)  # the true one has −2
    assert BOUND_SLACK < 2.0
    assert not any(mask & 0b0100 for mask in order)


def test_what_is_believed_already_counts_as_measured() -> None:
    y, r = problem()
    theta, _, _ = run(y, r, prior=1e9, centre=0.5, noise2=1e6)
    np.testing.assert_allclose(theta[0b1111], 0.5, atol=1e-4)


def test_effects_that_are_sums_of_each_other_are_not_together() -> None:
    y, r = problem()
    y[:, 4] = 2 * y[:, 0]
    _, score, order = run(y, r)
    assert not any(mask & 0b1001 == 0b1001 for mask in order)
    assert np.isfinite(score[0b0101])


def test_variances_are_the_diagonal_of_the_inverse() -> None:
    y, _ = problem()
    gram, columns, out = np.triu(y.T @ y), np.array([0, 2, 4]), np.zeros(3)
    assert variances(gram, columns, out)
    np.testing.assert_allclose(out, np.diag(np.linalg.inv((y.T @ y)[np.ix_(columns, columns)])), rtol=1e-10)
    y[:, 4] = y[:, 0]
    assert not variances(np.triu(y.T @ y), columns, out)
