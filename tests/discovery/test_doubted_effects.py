"""Unusual effects: certain ones stay, others leave a model that predicts as well without them."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, Log, load_robot
from cdia_pin.discovery import doubted_effects, missing_effects
from cdia_pin.discovery.doubted_effects import doubted, plain_model, predicts_as_well
from cdia_pin.discovery.unusual_effects import everyday
from cdia_pin.effects import parse_term
from cdia_pin.progress import silent
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.problem import Problem
from tests.made_logs import motion

FRICTION = parse_term("coulomb_friction@joint2: level=0.3")
SPRING = "counterbalance@joint1: torque_at_centre=2.0, torque_opposite=1.0"


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def fitted(robot, hidden, settings=None, unknown=np.zeros_like, spring=SPRING):
    """Return the problem of a log, the model with friction and a counterbalance, and the one with friction alone."""
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    noise = np.random.default_rng(0).normal(0.0, 0.05, q.shape)
    effort = Dynamics(robot, (FRICTION, *hidden)).inverse_dynamics(q, v, a) + unknown(q) + noise
    logs = Problem.conditioned(robot, [Log(robot.joints, t, q, effort)], [], settings or DiscoverySettings())
    problem = logs.around(Dynamics(robot)).with_first_noise(Dynamics(robot))
    models = (Dynamics(robot, (FRICTION, parse_term(spring))), Dynamics(robot, (FRICTION,)))
    return problem, *(fitted_together(problem.regression, m) for m in models)


def test_what_is_not_there_is_doubted_and_not_missed(robot):
    problem, found, plain = fitted(robot, ())
    assert doubted(problem, found, Dynamics(robot)) == {"counterbalance@joint1"}
    assert predicts_as_well(problem, plain, found)


def test_what_is_there_is_missed(robot):
    problem, found, plain = fitted(robot, (parse_term(SPRING),))
    assert not predicts_as_well(problem, plain, found)


def spring_near_its_anchor(q):
    """Return minus the torque of a spring of constant force on a lever that nearly reaches its anchor, shape (N, 2)."""
    length = np.sqrt(1 + 0.8**2 - 2 * 0.8 * np.cos(q[:, 0] - 0.4))
    return np.column_stack([4.0 * np.sin(q[:, 0] - 0.4) / length, np.zeros(len(q))])


def test_what_no_other_effect_replaces_is_not_doubted_however_uncertain(robot):
    """Nothing on an arm is that certain here, so only the error that all others leave can tell."""
    settings = DiscoverySettings()
    strict = replace(settings.confidence, unusual_certainty=1e6)
    near = f"{SPRING}, centre=0.4, ratio=0.6"

    def is_doubted(unknown, clear_of_others):
        rule = replace(strict, clear_of_others=clear_of_others)
        problem, found, _ = fitted(robot, (), replace(settings, confidence=rule), unknown, near)
        return "counterbalance@joint1" in doubted(problem, found, Dynamics(robot))

    assert not is_doubted(spring_near_its_anchor, 1.5)
    assert is_doubted(spring_near_its_anchor, 10.0)
    assert is_doubted(np.zeros_like, 1.5)


def test_the_model_before_is_plain_enough_without_a_search(robot, monkeypatch):
    problem, found, plain = fitted(robot, ())
    monkeypatch.setattr(doubted_effects, "search", None)
    assert plain_model(problem, found, plain, {"counterbalance@joint1"}, silent) is plain


def test_a_second_search_begins_at_the_model_before(robot, monkeypatch):
    """What was found beside a doubted effect may lead nowhere without it."""
    problem, found, plain = fitted(robot, ())
    before, begun = Dynamics(robot), []

    def search(problem, start, *_):
        begun.append(start)
        return plain if start is before else start

    monkeypatch.setattr(doubted_effects, "search", search)
    doubt = {t.label for t in found.terms}
    assert plain_model(problem, found, before, doubt, silent) is plain
    assert len(begun) == 2
    monkeypatch.setattr(doubted_effects, "search", lambda problem, start, *_: start)
    assert plain_model(problem, found, before, doubt, silent) is None


def test_the_first_search_has_everyday_effects_and_those_of_the_model(robot):
    problem, found, plain = fitted(robot, ())
    of_found, of_plain = ({f[0].label for f in everyday(problem, m).problem.families} for m in (found, plain))
    assert of_found - of_plain == {"counterbalance@joint1"}
    kinds = {f[0] for f in problem.problem.families}
    assert of_plain == {e.label for e in kinds if not problem.settings.is_unusual(e)}


@pytest.mark.parametrize("is_there", [True, False])
def test_where_an_unusual_effect_is_there_a_search_begins_again_with_all(robot, monkeypatch, is_there):
    """What everyday effects had explained before may have stood for it."""
    problem, found, plain = fitted(robot, (parse_term(SPRING),) if is_there else ())
    begun = []

    def search(problem, start, *_):
        begun.append((start, {f[0].label for f in problem.problem.families}))
        return plain if len(begun) == 1 else found

    for module in (missing_effects, doubted_effects):
        monkeypatch.setattr(module, "search", search)
    given = Dynamics(robot)
    missing_effects._searched(problem, given, given, silent)
    assert "counterbalance@joint1" not in begun[0][1]
    assert "counterbalance@joint1" in begun[1][1]
    again = [labels for start, labels in begun[2:] if start is given]
    assert [("counterbalance@joint1" in labels) for labels in again] == ([True] if is_there else [])


def test_what_the_user_expects_or_has_given_is_not_doubted(robot):
    problem, found, _ = fitted(robot, (), DiscoverySettings(expected=("counterbalance",)))
    assert doubted(problem, found, Dynamics(robot)) == set()
    problem, found, _ = fitted(robot, ())
    assert doubted(problem, found, found) == set()
