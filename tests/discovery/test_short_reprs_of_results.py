"""The ``repr`` of every result and of what it was made from is one short line."""

import dataclasses
from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, compare, discover, excite, identify, load_robot, what_changed
from cdia_pin.effects import CoulombFriction, StribeckFriction, Term
from cdia_pin.excitation import ExcitationSettings
from cdia_pin.identification import IdentificationSettings
from cdia_pin.regression.experiment import rms
from cdia_pin.selection import DiscoverySettings, Problem
from cdia_pin.selection.criterion import SelectionCriterion
from cdia_pin.selection.search import fitted
from tests.changes.test_conditions import pair

LONGEST = 199  # characters
ROOMS = tuple(
    f"cdia_pin.{room}."
    for room in ("regression", "selection", "identification", "excitation", "changes", "discovery")
)


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


@pytest.fixture(scope="module")
def logs(robot):
    """Two logs between which the friction of one joint changed; their names are long."""
    return [
        replace(log, source=f"{'a_long_name_of_a_folder/' * 4}{log.source}") for log in pair(robot, 0.1, 0.2)
    ]


@pytest.fixture(scope="module")
def results(robot, logs):
    model = Dynamics(robot)
    settings = ExcitationSettings(duration=6.0, draws=2, refinements=0, floor=None)
    effects = (CoulombFriction("joint1"), StribeckFriction("joint1"))
    problem = Problem.of(model, logs, [], DiscoverySettings())
    whitened = problem.with_first_noise(model)
    return {
        "discovery": discover(model, logs),
        "changes": what_changed(model, *logs),
        "comparison": compare(model, logs),
        "identification": identify(model, logs[0]),
        "parameters": excite(model, settings=settings),
        "explanations": excite(model, between=effects, settings=settings),
        "problem": whitened,
        "found": fitted(whitened, model),
        "lack of fit": problem.lack_of_fit(model),
        "prediction": problem.experiment.predict(model),
    }


def objects(value, seen):
    """Yield every dataclass instance of the rooms that can be reached from a value."""
    if id(value) in seen:
        return
    seen[id(value)] = value
    if isinstance(value, dict):
        for part in (*value.keys(), *value.values()):
            yield from objects(part, seen)
    elif isinstance(value, list | tuple):
        for part in value:
            yield from objects(part, seen)
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        if type(value).__module__.startswith(ROOMS):
            yield value
        for field in dataclasses.fields(value):
            yield from objects(getattr(value, field.name), seen)


@pytest.mark.parametrize(
    "name",
    [
        "discovery",
        "changes",
        "comparison",
        "identification",
        "parameters",
        "explanations",
        "problem",
        "found",
        "lack of fit",
        "prediction",
    ],
)
def test_every_repr_is_one_short_line(results, name):
    found = list(objects(results[name], {}))
    assert found
    for one in found:
        shown = repr(one)
        assert len(shown) <= LONGEST, shown
        assert "\n" not in shown
        assert shown.startswith(f"{type(one).__name__}("), shown


@pytest.mark.parametrize(
    "settings",
    [
        DiscoverySettings(),
        DiscoverySettings(
            effects=("coulomb_friction", "viscous_friction", "payload", "stribeck_friction") * 3,
            criterion=SelectionCriterion(penalty_per_parameter=5.0, least_share=0.2, least_torque=0.02),
        ),
        IdentificationSettings(strength=10.0),
        ExcitationSettings(duration=12.0, seed=3, clearance=0.02, floor=None, acceleration={"joint1": 2.0}),
    ],
)
def test_settings_show_what_differs_from_the_defaults(settings):
    shown = repr(settings)
    assert len(shown) <= LONGEST
    assert shown.startswith(type(settings).__name__)
    assert (shown == f"{type(settings).__name__}()") == (settings == type(settings)())


def test_a_discovery_shows_verdict_effects_and_errors(results):
    found = results["discovery"]
    shown = repr(found)
    assert shown.startswith("Discovery(explained: ")
    assert all(step.term.label in shown for step in found.steps)
    torque = found.torque_rms
    for step in (found.trace[0], found.trace[-1]):
        assert f"{100 * np.mean(step.heldout_rms / torque):.3g} %" in shown


def test_a_comparison_shows_the_error(results):
    comparison = results["comparison"]
    share = np.mean(rms(comparison.residual, comparison.informative) / comparison.torque_rms)
    assert f"{100 * share:.3g} %" in repr(comparison)


def test_changes_show_what_changed(robot, results):
    found = results["changes"]
    assert repr(found).startswith("Changes(changed: viscous_friction@joint1;")
    nothing = replace(found, changes=(), bounds={}, findings=())
    assert repr(nothing).startswith("Changes(unchanged; from ")


def test_a_long_label_is_cut(results):
    found = results["discovery"]
    term = Term(CoulombFriction("joint_with_a_name_of_" + 10 * "many_" + "words"), (0.1,))
    steps = (found.trace[0], *(replace(found.trace[1], term=term) for _ in range(9)))
    shown = repr(replace(found, trace=steps))
    assert len(shown) <= LONGEST
    assert "(9 in all)" in shown
