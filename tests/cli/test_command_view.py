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
        ((*SIMULATE, "--duration", "0"), "'--duration': must be 0.01 to 100000 s"),
        ((*SIMULATE, "--rate", "0"), "'--rate': must be 0.1 to 100000 Hz"),
        ((*SIMULATE, "--speed", "-1"), "'--speed': must be 0, or 0.001 to 1000"),
        ((*SIMULATE, "--seed", "-1"), "'--seed': must be 0 to"),
        ((*SIMULATE, "--fault", "columb_friction@joint1: level=1"), "did you mean coulomb_friction"),
        ((*SIMULATE, "--fault", "coulomb_friction@jiont1: level=1"), "did you mean joint1"),
        ((*SIMULATE, "--bank", "payload"), "not an effect of one joint"),
        (("--simulate", "--robot", "ur6", "--no-open"), "did you mean"),
        ((*SIMULATE, "--port", "99999"), "'--port': must be 0 to 65535"),
        (("nowhere.csv", "--robot", "double_pendulum", "--no-open"), "nowhere.csv"),
    ],
)
def test_what_cannot_be_shown_is_one_line(cdia, arguments, said):
    assert said in cdia("view", *arguments).error


def test_help_has_an_example(cdia):
    shown = cdia("view", "--help").out
    assert "cdia view --simulate" in " ".join(shown.split())
