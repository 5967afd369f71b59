"""``cdia view`` refuses what it cannot show, in one line, before it serves anything."""

import pytest

SIMULATE = ("--simulate", "--robot", "double_pendulum", "--no-open")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--robot", "ur5"), "give a LOG, or --simulate"),
        ((*SIMULATE, "run.csv"), "either a LOG or --simulate"),
        (("run.csv", "--robot", "double_pendulum", "--fault", "payload: mass=1"), "add --simulate"),
        ((*SIMULATE, "--healthy", "before.csv"), "need a LOG"),
        ((*SIMULATE, "--monitor"), "need a LOG"),
        (
            ("run.csv", "--robot", "double_pendulum", "--bank", "coulomb_friction"),
            "add --healthy or --monitor",
        ),
        ((*SIMULATE, "--duration", "0"), "duration > 0"),
        ((*SIMULATE, "--rate", "0"), "rate > 0"),
        ((*SIMULATE, "--speed", "-1"), "speed ≥ 0"),
        ((*SIMULATE, "--seed", "-1"), "seed ≥ 0"),
        ((*SIMULATE, "--fault", "columb_friction@joint1: level=1"), "did you mean coulomb_friction"),
        ((*SIMULATE, "--fault", "coulomb_friction@jiont1: level=1"), "did you mean joint1"),
        ((*SIMULATE, "--bank", "payload"), "not an effect of one joint"),
        (("--simulate", "--robot", "ur6", "--no-open"), "did you mean"),
        ((*SIMULATE, "--port", "99999"), "cannot serve at"),
        (("nowhere.csv", "--robot", "double_pendulum", "--no-open"), "nowhere.csv"),
    ],
)
def test_what_cannot_be_shown_is_one_line(cdia, arguments, said):
    assert said in cdia("view", *arguments).error


def test_help_has_an_example(cdia):
    shown = cdia("view", "--help").out
    assert "cdia view --simulate" in " ".join(shown.split())
