"""Drift within a log and memory at reversals are found and fitted, and neither where there is none."""

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.discovery.recognition import recognised
from cdia_pin.effects.presliding import deflection
from cdia_pin.logs import Log
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.problem import Problem
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


@pytest.mark.parametrize(("period", "seen"), [(40.0, False), (4.0, True)])
def test_a_joint_has_memory_only_if_it_turns_back_three_times(period, seen):
    """The same friction builds up, once from a start at rest and then at reversals."""
    robot = load_robot("double_pendulum")
    settings = DiscoverySettings()
    t, w = np.arange(0.0, 20.0, 0.01), 2 * np.pi / period
    q = np.column_stack([-np.cos(w * t), 0.2 * np.sin(3 * t)])
    v = np.column_stack([w * np.sin(w * t), 0.6 * np.cos(3 * t)])
    a = np.column_stack([w**2 * np.cos(w * t), -1.8 * np.sin(3 * t)])
    friction = 0.3 * deflection(np.diff(q[:, 0]), 0.05)
    noise = 0.002 * np.random.default_rng(0).standard_normal(q.shape)
    effort = robot.inverse_dynamics(q, v, a) + np.column_stack([friction, 0 * friction]) + noise
    model = Dynamics(robot)
    problem = Problem.of(model, [Log(robot.joints, t, q, effort, source="made")], [], settings)
    logs = problem.with_noise_of(problem.lack_of_fit(model))
    found = recognised(logs.regression, model, robot.joints, settings.memory)
    assert [f.joints for f in found] == ([(robot.joints[0],)] if seen else [])
    assert all("9 reversals" in f.sentence for f in found)
