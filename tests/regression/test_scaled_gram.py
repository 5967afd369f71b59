"""A scaled Gram matrix solves what the plain one does, whatever the units of the parameters."""

import numpy as np
import pytest

from cdia_pin.regression.scaled_gram import ScaledGram

UNITS = np.array([1e-6, 1.0, 1e5])  # of three parameters, in one system of units over another


@pytest.fixture
def gram():
    columns = np.random.default_rng(0).normal(size=(50, 3))
    return columns.T @ columns


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
def test_the_diagonal_is_one_whatever_the_size(size, gram):
    np.testing.assert_allclose(np.diag(ScaledGram.of(size * gram).matrix), 1.0)


def test_other_units_change_neither_the_scaled_matrix_nor_the_inflation(gram):
    plain, scaled = ScaledGram.of(gram), ScaledGram.of(gram * np.outer(UNITS, UNITS))
    np.testing.assert_allclose(scaled.matrix, plain.matrix)
    np.testing.assert_allclose(scaled.inflation, plain.inflation)


def test_it_solves_the_equations(gram):
    matrix = gram * np.outer(UNITS, UNITS)
    scaled, x = ScaledGram.of(matrix), np.array([2e6, -3.0, 1e-5])
    np.testing.assert_allclose(scaled.solve(matrix @ x), x)
    np.testing.assert_allclose(scaled.solve(np.outer(matrix @ x, [1.0, 2.0])), np.outer(x, [1.0, 2.0]))
    for inverse in (scaled.inverse(), scaled.pseudo_inverse(1e-12)):
        np.testing.assert_allclose(inverse @ matrix / np.outer(1 / UNITS, UNITS), np.eye(3), atol=1e-9)


def test_a_column_of_zeros_is_no_error(gram):
    gram[1] = gram[:, 1] = 0.0
    assert np.isfinite(ScaledGram.of(gram).pseudo_inverse(1e-12)).all()


def test_orthogonal_columns_inflate_nothing_and_equal_ones_without_bound():
    np.testing.assert_allclose(ScaledGram.of(np.diag([1e-4, 2.0, 3e4])).inflation, 1.0)
    r = 1 - 1e-6
    np.testing.assert_allclose(
        ScaledGram.of(np.array([[1.0, r], [r, 1.0]])).inflation, 1 / (1 - r**2), rtol=1e-6
    )


def test_a_ridge_is_a_share_of_the_diagonal(gram):
    matrix = gram * np.outer(UNITS, UNITS)
    b = np.array([1e-6, 2.0, 3e5])
    expected = np.linalg.solve(matrix + 0.1 * np.diag(np.diag(matrix)), b)
    np.testing.assert_allclose(ScaledGram.of(matrix, ridge=0.1).solve(b), expected, rtol=1e-6)


def test_a_singular_matrix_is_solved_by_the_smallest_parameters():
    same = ScaledGram.of(np.ones((2, 2)))
    np.testing.assert_allclose(same.solve(np.array([2.0, 2.0])), [1.0, 1.0])
    assert np.isinf(same.inflation).all()
