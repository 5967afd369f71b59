"""The verdict: what is left matters by its size, whatever a test of its structure says."""

import numpy as np
import pytest

from cdia_pin.discovery.verdict import stands_out, verdict_on
from cdia_pin.selection.discovery_settings import PracticeSettings

PRACTICE = PracticeSettings()


@pytest.mark.parametrize(
    ("residual", "floor", "structure"),
    [
        (1.66, 0.61, True),  # no noise leaves two and a half times what smooth functions leave
        (0.53, 0.44, False),
        (0.08, 0.01, False),  # too small to be judged by its size alone
    ],
)
def test_a_residual_of_several_noise_floors_is_structure(residual, floor, structure):
    assert stands_out(np.array([residual]), np.array([floor]), PRACTICE).tolist() == [structure]


@pytest.mark.parametrize(
    ("error", "floor", "verdict"),
    [
        (0.0078, 0.0008, "explained-in-practice"),  # nobody knows a drive's gain to one percent
        (0.03, 0.008, "unexplained"),
        (0.03, 0.02, "explained-in-practice"),
        (0.15, 0.14, "unexplained"),
    ],
)
def test_structure_matters_where_it_is_large(error, floor, verdict):
    assert verdict_on([True], np.array([error]), np.array([floor]), 1, PRACTICE) == verdict
