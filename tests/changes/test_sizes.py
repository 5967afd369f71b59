"""Sizes of changes: an interval that holds with another effect beside it and without."""

import numpy as np
import pytest

from cdia_pin.changes.sizes import covering
from cdia_pin.effects import Term, ViscousFriction


def friction(value: float, half: float) -> Term:
    return Term(ViscousFriction("elbow_joint"), (value,)).with_intervals(
        np.array([half]), np.array([half / 2])
    )


@pytest.mark.parametrize(
    ("other", "total"), [(friction(2.8, 0.4), (0.4, 3.2)), (friction(1.8, 0.1), (1.5, 2.1))]
)
def test_an_interval_covers_another_estimate_and_is_never_narrower(other: Term, total: tuple) -> None:
    wide = covering(friction(1.8, 0.3), other)
    assert wide.theta == (1.8,)
    assert wide.ci95 == (pytest.approx(total),)
    assert wide.ci95_statistical == (pytest.approx((1.65, 1.95)),)
