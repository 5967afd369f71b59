"""Gravity that differs from log to log, and bodies that do: the columns are those of the plain effect in each log."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.effects import PerLog, Term, parse_effect, parse_term
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.physical_consistency import consistent_parameters
from tests.made_logs import conditioned, make

LOGS = ("empty", "loaded")
TILT = parse_term("base_tilt: tilt_x=3, tilt_y=-0.5")  # 18°
LEVEL = parse_term("base_tilt: tilt_x=0, tilt_y=0")
PAYLOAD = parse_term("payload: mass=2, first_moment_x=0.1, first_moment_z=0.3")
LINK = parse_term("link_inertia@elbow_joint: mass=2, first_moment_x=0.4, inertia_zz=0.3")
EVERY_LINK = parse_effect("link_inertia@elbow_joint+wrist_1_joint")


@pytest.fixture(scope="module")
def ur5():
    return load_robot("ur5")


@pytest.fixture(scope="module")
def experiment(ur5):
    logs = [make(ur5, seed=s, duration=6.0) for s in (0, 1)]
    named = [replace(m, log=replace(m.log, condition=name)) for m, name in zip(logs, LOGS, strict=True)]
    return Experiment.of(ur5, [conditioned(ur5, m) for m in named])


def per_log(*terms: Term) -> Term:
    """A term that has the parameters of one term in the first log, of another in the second."""
    theta = tuple(v for term in terms for v in term.theta)
    return Term(PerLog(terms[0].effect, LOGS), theta)


def readings(model: Dynamics, experiment: Experiment) -> list[np.ndarray]:
    return [t.reading for t in experiment.predict(model).torques]


def test_bodies_feel_a_tilt_that_differs_from_log_to_log(ur5, experiment):
    both = readings(Dynamics(ur5, (per_log(LEVEL, TILT), PAYLOAD)), experiment)
    for i, tilt in enumerate((LEVEL, TILT)):
        alone = readings(Dynamics(ur5, (tilt, PAYLOAD)), experiment)
        np.testing.assert_allclose(both[i], alone[i], atol=1e-9)


@pytest.mark.parametrize("body", [PAYLOAD, LINK], ids=lambda t: t.label)
def test_a_payload_per_log_feels_a_tilt(ur5, experiment, body):
    prediction = experiment.predict(Dynamics(ur5, (TILT,)))
    both = experiment.columns(PerLog(body.effect, LOGS), prediction)
    alone = experiment.columns(body.effect, prediction)
    first = experiment.lengths[0]
    np.testing.assert_allclose(both[:first, :, :10], alone[:first], atol=1e-9)
    np.testing.assert_allclose(both[first:, :, 10:], alone[first:], atol=1e-9)
    level = experiment.columns(body.effect, experiment.predict(Dynamics(ur5)))
    weight = np.abs((alone - level) @ np.array(body.theta))
    assert weight.max() > 1.0  # [N·m], what it would miss


def test_kept_columns_of_bodies_follow_gravity_log_by_log(ur5, experiment):
    columns = DesignMatrix(experiment)
    for tilt in (per_log(LEVEL, LEVEL), per_log(LEVEL, TILT), per_log(TILT, LEVEL), TILT):
        prediction = experiment.predict(Dynamics(ur5, (tilt,)))
        for effect in (PAYLOAD.effect, PerLog(PAYLOAD.effect, LOGS)):
            np.testing.assert_allclose(
                columns.of(effect, prediction), experiment.columns(effect, prediction), atol=1e-9
            )


@pytest.mark.parametrize("effect", [PAYLOAD.effect, EVERY_LINK], ids=lambda e: e.label)
def test_each_log_has_bodies_that_can_be(ur5, effect):
    both = PerLog(effect, LOGS)
    count = len(effect.bodies)
    assert len(both.bodies) == 2 * count
    wanted = np.tile(np.r_[0.1, 0.0, 0.0, 0.0, -5.0, 0.0, -5.0, 0.0, 0.0, -5.0], 2 * count)
    found = consistent_parameters(np.eye(len(wanted)), wanted, [both], ur5)
    assert not both.is_physical(wanted, ur5)
    assert both.is_physical(both.nearest_physical(found, ur5), ur5)
    np.testing.assert_allclose(both.nearest_physical(found, ur5), found, atol=1e-3)
    for part, (body, own) in zip(np.reshape(found, (-1, 10)), both.by_body(found), strict=True):
        assert body in effect.bodies
        np.testing.assert_array_equal(part, own)
