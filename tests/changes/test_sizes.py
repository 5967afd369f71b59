"""Sizes of changes: an interval that holds with another effect beside it and without."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot, what_changed
from cdia_pin.changes import detection
from cdia_pin.changes.differing import Differing
from cdia_pin.changes.run_to_run import _common_friction
from cdia_pin.changes.sizes import covering, friction_before
from cdia_pin.effects import Term, ViscousFriction, parse_term
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.regression.shared_parameters import SharedRegression
from cdia_pin.selection.discovery_settings import DiscoverySettings
from tests.made_logs import motion


def friction(value: float, half: float) -> Term:
    return Term(ViscousFriction("elbow_joint"), (value,)).with_intervals(
        np.array([half]), np.array([half / 2])
    )


@pytest.mark.parametrize(
    ("other", "total"), [(friction(2.8, 0.4), (0.4, 3.2)), (friction(1.8, 0.1), (1.5, 2.1))]
)
def test_an_interval_covers_another_estimate_and_is_never_narrower(other: Term, total: tuple) -> None:
    wide = covering(friction(1.8, 0.3), other)
    assert wide.theta == (1.8,)
    assert wide.ci95 == (pytest.approx(total),)
    assert wide.ci95_statistical == (pytest.approx((1.65, 1.95)),)


def pendulum_log(name: str, seed: int, *, level: float = 0.0, gain: float = 0.0, offset: float = 0.0) -> Log:
    """A log with friction and another gain of the second joint, and an offset of the first."""
    robot = load_robot("double_pendulum")
    t, q, v, a = motion(robot.n, seed, duration=24.0)
    effort = robot.inverse_dynamics(q, v, a)
    effort[:, 1] = effort[:, 1] / (1 + gain) + level * np.tanh(v[:, 1] / 0.01)
    effort[:, 0] += offset
    outside = 0.02 * np.sin(5 * q + seed) * np.cos(3 * v) if gain else 0.0
    noise = np.random.default_rng(seed).normal(0.0, 0.003, effort.shape)
    return Log(robot.joints, t, q, effort + noise + outside, source=name)


@pytest.mark.parametrize(
    "known", [(), ("coulomb_friction@joint2: level=0.5",), ("viscous_friction@joint2: coefficient=0.1",)]
)
def test_friction_before_is_all_of_it_whatever_the_model_has(known: tuple) -> None:
    model = Dynamics(load_robot("double_pendulum"), tuple(map(parse_term, known)))
    logs = (pendulum_log(name, 5, level=level) for name, level in (("a.csv", 0.6), ("b.csv", 0.9)))
    (change,) = what_changed(model, *logs).changes
    assert change.before == pytest.approx((0.6,), rel=0.05)
    assert change.growth == pytest.approx(0.5, rel=0.05)


def test_friction_that_was_not_there_has_no_growth() -> None:
    logs = (pendulum_log(name, 5, level=level) for name, level in (("a.csv", 0.0), ("b.csv", 0.5)))
    (change,) = what_changed(Dynamics(load_robot("double_pendulum")), *logs).changes
    assert change.growth is None


def one_way_log(seed: int, level: float) -> Log:
    """A log with friction of the second joint, which turns one way all the time."""
    robot = load_robot("double_pendulum")
    t, q, v, a = motion(robot.n, seed, duration=24.0)
    q[:, 1], v[:, 1], a[:, 1] = 0.15 * q[:, 1] + 1.2 * t, 0.15 * v[:, 1] + 1.2, 0.15 * a[:, 1]
    effort = robot.inverse_dynamics(q, v, a) + level * np.sign(v) * [0.0, 1.0]
    noise = np.random.default_rng(seed).normal(0.0, 0.003, effort.shape)
    return Log(robot.joints, t, q, effort + noise, source=f"{seed}.csv")


def differing(*logs: Log) -> Differing:
    robot = load_robot("double_pendulum")
    experiment = Experiment.of(robot, [condition(log, robot) for log in logs])
    return Differing.of(experiment, Dynamics(experiment.robot), 1, DiscoverySettings())


@pytest.fixture(scope="module")
def one_way() -> Differing:
    return differing(one_way_log(10, 0.5), one_way_log(20, 0.62))


def with_common(x: Differing, *terms: str) -> Differing:
    """The same logs, with other effects that both have."""
    model = Dynamics(x.experiment.robot, tuple(map(parse_term, terms)))
    return replace(x, prediction=x.experiment.predict(model))


def test_common_friction_that_an_offset_cancels_is_what_both_are_together(one_way: Differing) -> None:
    """Before, 488 N·m less an offset of 493 N·m were friction of 488 N·m, beside which any change was usual."""
    cancelled = with_common(
        one_way, "coulomb_friction@joint2: level=488", "torque_offset@joint2: offset=487.5"
    )
    assert rms(_common_friction(cancelled), one_way.counted) == pytest.approx([0.0, 0.5], rel=1e-3)


def test_common_friction_beside_an_offset_is_friction() -> None:
    both_ways = differing(pendulum_log("a.csv", 5), pendulum_log("b.csv", 6))
    common = with_common(both_ways, "coulomb_friction@joint2: level=0.5", "torque_offset@joint2: offset=-0.4")
    assert rms(_common_friction(common), common.counted)[1] == pytest.approx(0.5, rel=0.03)


@pytest.mark.parametrize("prior", [1.0, 1e4])
def test_friction_before_is_not_known_where_an_offset_cancels_it(
    one_way: Differing, prior: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(SharedRegression, "theta", lambda shared: prior * np.ones(len(shared.gram) - 1))
    grown = next(d for d in one_way.changes if d.label == "coulomb_friction@joint2")
    assert (grown in friction_before(one_way, [grown])) == (prior == 1.0)


def test_a_gain_is_as_large_and_as_certain_beside_what_is_only_likely() -> None:
    robot = load_robot("double_pendulum")
    widths = {}
    for offset in (0.02, 0.1):
        found = what_changed(
            Dynamics(robot), pendulum_log("a.csv", 5), pendulum_log("b.csv", 6, gain=-0.3, offset=offset)
        )
        gain = next(c.term for c in found.changes if c.term.label == "actuator_gain@joint2")
        assert gain.theta[0] == pytest.approx(-0.3, abs=0.01)
        widths[offset] = gain.half_widths[0]
    assert max(widths.values()) < 0.03


def test_a_gain_of_a_joint_that_carries_little_is_a_gain() -> None:
    """A weaker drive needs more of all its torque: friction by the same share, where most of it is friction."""

    def log(name: str, seed: int, gain: float = 0.0) -> Log:
        made = pendulum_log(name, seed, level=3.0)
        effort = made.effort.copy()
        effort[:, 1] /= 1.0 + gain
        return Log(made.joints, made.time, made.position, effort, source=name)

    robot = load_robot("double_pendulum")
    (change,) = what_changed(Dynamics(robot), log("a.csv", 5), log("b.csv", 6, gain=-0.2)).changes
    assert change.term.label == "actuator_gain@joint2"
    assert change.term.theta == pytest.approx((-0.2,), rel=0.1)


def test_a_size_is_that_without_what_cannot_be_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two of the found changes have the same torque with the other sign; one of them cannot be named."""
    gain, other = parse_term("actuator_gain@joint2: gain=0.3"), parse_term("joint_spring@joint2: stiffness=1")
    beside, alone = (replace(gain, theta=(x,)).with_intervals(np.array([0.05])) for x in (0.3, 0.06))
    terms = {0: beside, 1: other.with_intervals(np.array([0.1, 0.1]))}
    fitted = {(0, 1): terms, (0,): {0: alone}}
    monkeypatch.setattr(detection, "_sizes", lambda found, _: (fitted[found], []))
    monkeypatch.setattr(detection, "sized_about_themselves", lambda _, kept: kept)
    found = SimpleNamespace(chosen=(0, 1), search=None)
    assert detection._sizes_of([0], found, terms, [], None)[0].theta == (0.06,)
    assert detection._sizes_of([0, 1], found, terms, [], None) is terms
    assert not detection._agree(alone, beside)
    assert detection._agree(alone, alone)


@pytest.mark.parametrize(("gain", "least"), [(0.0, 0.0), (0.5, 0.1)])
def test_an_interval_reaches_to_where_the_gain_of_the_model_is_something_else(
    gain: float, least: float
) -> None:
    """A model with a gain of 0.5 states 0.45 N·m where the measured torque shows 0.3."""
    robot = load_robot("double_pendulum")
    model = Dynamics(robot, (parse_term(f"actuator_gain@joint2: gain={gain}"),)) if gain else Dynamics(robot)
    logs = (pendulum_log(name, 5, level=level, gain=gain) for name, level in (("a.csv", 0.6), ("b.csv", 0.9)))
    (change,) = what_changed(model, *logs).changes
    assert change.term.label == "coulomb_friction@joint2"
    ((low, high),) = change.term.ci95
    assert low < 0.3 < high
    assert high - change.term.theta[0] > least
