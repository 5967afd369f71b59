"""Ripples of measured arms: what both logs have is no change, though it is larger at one place than at another."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot, what_changed
from cdia_pin.effects import PositionRipple
from cdia_pin.effects.state import State
from cdia_pin.logs import Log
from tests.made_logs import motion

PENDULUM = load_robot("double_pendulum")


def log(name: str, seed: int, about: float, size: Callable[[np.ndarray], np.ndarray]) -> Log:
    """A log about some position of joint 2, with a ripple of some size along the joint."""
    t, q, v, a = motion(PENDULUM.n, seed, duration=24.0)
    q = 0.7 * q
    v, a = 0.7 * v, 0.7 * a
    q[:, 1] += about
    effort = PENDULUM.inverse_dynamics(q, v, a)
    effort[:, 1] -= size(q[:, 1]) * np.sin(14.0 * q[:, 1])
    noise = np.random.default_rng(seed).normal(0.0, 0.003, effort.shape)
    return Log(PENDULUM.joints, t, q, effort + noise, source=name)


def modulated(q: np.ndarray) -> np.ndarray:
    return 0.15 * (1.0 + 0.9 * np.sin(1.2 * q))


def steady(q: np.ndarray) -> np.ndarray:
    return np.full_like(q, 0.15)


def names(before: Log, after: Log) -> list[str]:
    return [c.term.label for c in what_changed(Dynamics(PENDULUM), before, after).changes]


@pytest.mark.parametrize("seed", [2, 3])
def test_a_ripple_that_is_larger_elsewhere_is_no_change_of_the_arm(seed: int) -> None:
    assert names(log("a.csv", seed, -0.4, modulated), log("b.csv", seed + 10, 0.5, modulated)) == []


@pytest.mark.parametrize("seed", [4, 7, 9])
def test_what_a_ripple_of_both_stood_for_is_found_without_it(seed: int) -> None:
    """Before, the ripple was what explained most, was none, and nothing was named in its place."""
    before, after = log("a.csv", seed, -0.4, modulated), log("b.csv", seed + 10, 0.5, modulated)
    after = replace(after, effort=after.effort - np.array([0.0, 0.1]))
    assert names(before, after) == ["torque_offset@joint2"]


def test_a_ripple_that_grew_is_a_change_between_other_positions_too() -> None:
    before = log("a.csv", 2, -0.4, steady)
    after = log("b.csv", 12, 0.5, lambda q: 3.0 * steady(q))
    assert names(before, after) == ["position_ripple@joint2"]


def test_the_ripples_beside_one_are_a_resolution_cell_away() -> None:
    q = np.column_stack([np.zeros(50), np.linspace(0.0, 2.0, 50)])
    x = State.of(PENDULUM, q, np.zeros_like(q))
    beside = PositionRipple("joint2", frequency=9.0).nearly_alike(x)
    assert [e.frequency for e in beside] == pytest.approx([9.0 - np.pi, 9.0 + np.pi])
    assert PositionRipple("joint1", frequency=9.0).nearly_alike(x) == []  # it rests
