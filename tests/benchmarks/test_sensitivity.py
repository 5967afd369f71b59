"""Each number that decides is a setting with a reason, and can be halved and doubled."""

from dataclasses import fields

import pytest

from benchmarks.sensitivity.page import page
from benchmarks.sensitivity.trial import Trial, TrialOutcome, cases
from benchmarks.sensitivity.variation import Variation, decisions, variations
from cdia_pin.selection import DiscoverySettings


def value_of(settings, path):
    for name in path.split("."):
        settings = getattr(settings, name)
    return settings


@pytest.mark.parametrize("decision", decisions(), ids=lambda d: d.path)
def test_a_number_that_decides_has_a_unit_and_a_reason(decision):
    assert len(decision.reason.split()) >= 5
    assert decision.value != 0


@pytest.mark.parametrize("decision", decisions(), ids=lambda d: d.path)
def test_a_variation_changes_one_number_and_no_other(decision):
    plain, changed = DiscoverySettings(), Variation(decision.path, 2.0).settings()
    assert value_of(changed, decision.path) == pytest.approx(2 * decision.value)
    for other in decisions():
        if other.path != decision.path:
            assert value_of(changed, other.path) == value_of(plain, other.path)


def test_every_group_of_settings_is_varied():
    groups = {
        f.name for f in fields(DiscoverySettings) if f.name in {d.path.split(".")[0] for d in decisions()}
    }
    assert {"criterion", "every_link", "alternatives", "lack_of_fit", "memory", "noise", "rest"} <= groups


def test_the_page_says_what_changes():
    base = [TrialOutcome(f"{k}", "as it is", 0, 0, 2, False) for k in range(2)]
    name = Variation("criterion.least_share", 2.0).id
    worse = [TrialOutcome("0", name, 1, 0, 2, False), TrialOutcome("1", name, 0, 0, 2, False)]
    text = page([*base, *worse], "a command")
    (row,) = [line for line in text.splitlines() if "criterion.least_share`" in line]
    assert "| not run |" in row
    assert "**1 / 1 / 0 / 0 / 4**" in row


def test_trials_have_names_of_their_own():
    names = [Trial(c, v).id for c in cases() for v in variations()]
    assert len(names) == len(set(names))
