"""What seems to have changed and is not certain enough to be named is told, with how far it is from a name."""

from dataclasses import replace

import pytest

from cdia_pin import Dynamics, load_robot, what_changed
from cdia_pin.changes.change_search import ChangeSearch
from cdia_pin.viewers.change_words import changes_sentence, is_quiet, notes
from tests.changes.test_conditions import pair

NAMED = "viscous_friction@joint1"


def found(monkeypatch, share):
    """A change that has a share of the certainty of a name, because effects that are not there seem certain too."""
    beside = ChangeSearch.beside

    def doubted(search, chosen):
        plain = replace(beside(search, chosen), spreads=(1.0, 1.0))
        one = next(c for c in chosen if plain.evidence.effects[c].label == NAMED)
        certainty = plain.certainty(plain.evidence.fits([c for c in chosen if c != one]))[one]
        spread = certainty / (share * plain.settings.least_certainty)
        return replace(plain, spreads=(spread, spread))

    monkeypatch.setattr(ChangeSearch, "beside", doubted)
    robot = load_robot("double_pendulum")
    return what_changed(Dynamics(robot), *pair(robot, 0.1, 0.2))


def test_what_is_nearly_certain_is_told_and_not_named(monkeypatch):
    some = found(monkeypatch, 0.8)
    (uncertain,) = some.uncertain
    assert not some.changes
    assert uncertain.term.label == NAMED
    assert uncertain.share == pytest.approx(0.8)
    ((low, high),) = uncertain.term.ci95
    assert low < 0.1 < high
    # four of five standard deviations from zero, and a 95 % interval has 2.04 of them each way with 32 blocks
    assert (high - low) / 2 == pytest.approx(uncertain.term.theta[0] * 2.04 / 4, rel=0.2)
    (entry,) = some.to_dict()["uncertain"]
    assert (entry["effect"], entry["joints"]) == ("viscous_friction", ["joint1"])
    assert changes_sentence(some).startswith("No change is certain from")
    said = notes(some)[0]
    assert "viscous friction on joint1" in said
    assert "80" in said
    assert not is_quiet(some)


@pytest.mark.parametrize(("share", "named"), [(0.3, []), (1.2, [NAMED])])
def test_what_is_named_or_far_from_it_is_not_told_as_uncertain(monkeypatch, share, named):
    some = found(monkeypatch, share)
    assert [c.term.label for c in some.changes] == named
    assert not some.uncertain
    assert is_quiet(some) is not bool(named)
