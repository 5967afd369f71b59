"""Steps of dry friction pass the filters as those of the measured torque do, so that friction has its true size."""

import numpy as np
import pytest

from benchmarks.blurred_steps import LAWS, errors
from cdia_pin.logs.conditioning import Conditioning

CUTOFF, BASE = 10.0, 0.25  # [Hz]; a joint turns back some eighty times a minute


@pytest.mark.parametrize("law", LAWS, ids=[law.name for law in LAWS])
def test_every_law_has_its_size(law):
    wrong = np.abs(errors(law, CUTOFF, Conditioning().motion_band, BASE))
    assert wrong.max() < 0.02
    assert np.median(wrong) < 0.003


def test_a_motion_filtered_as_the_torque_makes_dry_friction_too_large():
    level, viscous = errors(LAWS[0], CUTOFF, 1.0, BASE).mean(axis=0)
    assert level > 0.01
    assert viscous < -0.01
