"""Settings of a discovery are recorded where they are not the usual ones."""

from dataclasses import replace

import pytest

from benchmarks.sensitivity.variation import Variation, decisions
from cdia_pin.selection import DiscoverySettings


def test_the_usual_settings_have_nothing_to_record():
    assert DiscoverySettings().changed_decisions() == {}
    assert (
        replace(DiscoverySettings(), most_effects=3, blocks=5).changed_decisions() == {}
    )  # recorded by themselves


@pytest.mark.parametrize("decision", decisions(), ids=lambda d: d.path)
def test_a_number_that_was_changed_is_recorded(decision):
    changed = Variation(decision.path, 2.0).settings().changed_decisions()
    assert changed == {decision.path: pytest.approx(2 * decision.value)}
