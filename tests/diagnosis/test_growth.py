"""The largest of few values is smaller than the largest of many."""

import numpy as np
import pytest

from cdia_pin.diagnosis.growth import REFERENCE_DURATION, growth, moving_time

MEMORY = np.array([0.05, 0.2, 1.0])


def test_it_is_that_of_normal_values():
    """N = 40 against 1200: the medians of 4000 draws each."""
    rng = np.random.default_rng(0)
    seen, usual = (np.median(np.abs(rng.standard_normal((4000, count))).max(axis=1)) for count in (40, 1200))
    found = growth(np.array([4.0]), np.array([0.1]))
    assert found[0] == pytest.approx(usual / seen, rel=0.01)


def test_it_falls_with_time_to_one_at_the_reference():
    factors = np.array([growth(np.full(3, s), MEMORY) for s in (0.0, 3.5, 10.0, 20.0, 60.0)])
    assert (np.diff(factors, axis=0) < 0).all()
    assert (factors[-1] < 1.15).all()
    np.testing.assert_array_equal(growth(np.full(3, REFERENCE_DURATION), MEMORY), 1.0)
    np.testing.assert_array_equal(growth(np.full(3, 3600.0), MEMORY), 1.0)


def test_a_residual_that_changes_slowly_has_shown_less():
    assert (np.diff(growth(np.full(3, 5.0), MEMORY)) > 0).all()


def test_only_the_time_in_motion_counts():
    v = np.zeros((300, 2))
    v[100:200, 1] = -0.5
    np.testing.assert_allclose(moving_time([v, v[:150]], np.full(2, 0.005), 0.01), [0.0, 1.5])
