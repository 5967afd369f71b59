"""Drift within a log and memory at reversals are found and fitted, and neither where there is none."""

import numpy as np
import pytest

from cdia_pin.effects.presliding import deflection
from tests.hidden_plants import hidden, plant_of

ARMS = ("ur5", "panda")


def outside(arm, name):
    return next(s for s in hidden("outside", arm) if s.faults[0].effect == name)


@pytest.mark.parametrize("arm", ARMS)
def test_friction_that_falls_as_a_drive_warms_up_is_found_with_its_time_constant(arm, discovered):
    scenario = outside(arm, "warming_friction")
    (fault,) = scenario.faults
    found = discovered(arm, scenario.run(plant_of(arm)).log)
    assert found.verdict == "explained"
    (step,) = found.steps
    assert step.term.label == f"coulomb_friction@{fault.joint}[time]"
    level, time = fault.parameters["level"], fault.parameters["time"]
    assert step.term.effect.time_constant == pytest.approx(time, rel=0.1)
    assert step.term.values["level[start]"] == pytest.approx(level, rel=0.05)
    assert step.term.values["level[end]"] == pytest.approx(
        level * np.exp(-scenario.duration / time), abs=0.03 * level
    )
    (finding,) = found.findings
    assert (finding.kind, finding.joints) == ("drift", (fault.joint,))
    assert "warms up" in finding.sentence


@pytest.mark.parametrize("arm", ARMS)
def test_presliding_is_found_with_its_level_and_reach(arm, discovered):
    scenario = outside(arm, "presliding")
    (fault,) = scenario.faults
    found = discovered(arm, scenario.run(plant_of(arm)).log)
    assert (found.verdict, found.findings) == ("explained", ())
    (step,) = found.steps
    assert step.term.label == f"presliding_friction@{fault.joint}"
    assert step.term.theta[0] == pytest.approx(fault.parameters["level"], rel=0.01)
    assert step.term.effect.reach == pytest.approx(fault.parameters["reach"], rel=0.02)


@pytest.mark.parametrize("name", ["coulomb_friction", "stribeck_friction"])
def test_friction_without_memory_or_drift_has_none(name, discovered):
    scenario = next(s for s in hidden("singles", "ur5") if s.faults[0].effect == name)
    assert discovered("ur5", scenario.run(plant_of("ur5")).log).findings == ()


def test_bristles_follow_distance_and_not_speed():
    reach, q = 0.1, np.concatenate([np.linspace(0, 1, 401), np.linspace(1, 0, 401)[1:]])
    z = deflection(np.diff(q), reach)
    assert z[400] == pytest.approx(1.0, abs=1e-4)
    after = z[400:] - (-1 + 2 * np.exp(-(1 - q[400:]) / reach))  # from +1 to −1 over the reach
    np.testing.assert_allclose(after, 0.0, atol=1e-4)
    np.testing.assert_allclose(deflection(np.diff(q[::10]), reach), z[::10], atol=1e-9)  # however fast it was
