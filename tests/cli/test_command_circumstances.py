"""The user's word that a fluid, a contact or a tilt is to be expected reaches the search."""

import pytest

from cdia_pin.effects import EFFECTS
from cdia_pin.errors import CdiaError

ROBOT = ("--robot", "double_pendulum", "--no-check")
WORDS = {
    (): (),
    ("--environment", "air", "--mounted", "upright"): (),
    ("--environment", "water"): ("viscous_medium",),
    ("--contact",): ("tool_wrench",),
    ("--mounted", "tilted"): ("base_tilt",),
    ("--mounted", "tilted", "--environment", "water", "--contact"): (
        "viscous_medium",
        "tool_wrench",
        "base_tilt",
    ),
}


@pytest.fixture
def asked(monkeypatch):
    """Settings that a search was asked for; it ends there."""
    seen = []

    def search(*given, settings=None, **more):
        seen.append(settings or given[2])
        raise CdiaError("that is enough")

    monkeypatch.setattr("cdia_pin.discovery.discover", search)
    monkeypatch.setattr("cdia_pin.changes.changes_between", search)
    return seen


@pytest.mark.parametrize("command", ["discover", "compare"])
@pytest.mark.parametrize(("words", "expected"), WORDS.items(), ids=lambda x: " ".join(x) or "nothing")
def test_what_the_user_expects_is_expected(cdia, log, asked, command, words, expected):
    assert "that is enough" in cdia(command, log, *ROBOT, *words).error
    (settings,) = asked
    assert settings.expected == expected


def test_what_a_user_can_expect_is_unusual():
    named = {name for expected in WORDS.values() for name in expected}
    assert all(EFFECTS[name].plausibility.unusual for name in named)


def test_unknown_surroundings_are_refused(cdia, log):
    assert "water" in cdia("discover", log, *ROBOT, "--environment", "lava").error
