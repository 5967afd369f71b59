"""Several logs: effects are common unless the logs say that they differ."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, discover, load_robot
from tests.made_logs import make


def pair(robot, before, after):
    logs = []
    for seed, coefficient in ((1, before), (2, after)):

        def missing(q, v, a, coefficient=coefficient):
            return np.column_stack([-coefficient * v[:, 0], -0.05 * np.tanh(v[:, 1] / 1e-3)])

        logs.append(replace(make(robot, missing, seed=seed, noise=0.004).log, source=f"log{seed}.csv"))
    return logs


def test_an_effect_is_common_unless_the_logs_say_that_it_differs():
    robot = load_robot("double_pendulum")
    same, other = (discover(Dynamics(robot), pair(robot, 0.1, after)) for after in (0.1, 0.2))
    assert {s.term.label for s in same.steps} == {"viscous_friction@joint1", "coulomb_friction@joint2"}
    found = {s.term.label: s.term for s in other.steps}
    assert set(found) == {"viscous_friction@joint1[log]", "coulomb_friction@joint2"}
    term = found["viscous_friction@joint1[log]"]
    assert term.theta == pytest.approx((0.1, 0.2), rel=0.03)
    assert [p.name for p in term.effect.parameters] == ["coefficient[log1.csv]", "coefficient[log2.csv]"]
    entry = next(e for e in other.to_dict()["effects"] if e["effect"] == "viscous_friction")
    assert entry["varies"] == {"with": "log", "logs": ["log1.csv", "log2.csv"]}


def test_logs_of_one_condition_share_their_parameters():
    robot = load_robot("double_pendulum")
    logs = [*pair(robot, 0.1, 0.2), replace(pair(robot, 0.1, 0.2)[1], source="log3.csv")]
    named = [replace(log, condition=c) for log, c in zip(logs, ("cold", "warm", "warm"), strict=True)]
    term = next(
        s.term for s in discover(Dynamics(robot), named).steps if s.term.label.startswith("viscous_friction")
    )
    assert [p.name for p in term.effect.parameters] == ["coefficient[cold]", "coefficient[warm]"]
