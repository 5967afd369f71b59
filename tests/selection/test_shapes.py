"""Shapes of an effect are moved to the best fit, whatever their number."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

from cdia_pin import Log
from cdia_pin.discovery import add_effect
from cdia_pin.dynamics import Dynamics, Sensors, exciting_trajectory, simulate
from cdia_pin.effects import JointEffect, JointState, Parameter, Signal, State, Term, Traits, parse_term
from cdia_pin.robot import load_robot
from cdia_pin.selection import DiscoverySettings, Problem
from cdia_pin.selection.shapes import with_shapes_fitted
from tests.made_logs import motion


@dataclass(frozen=True)
class Bump(JointEffect):
    """A torque around one position, with two shape parameters."""

    centre: float = 0.0
    width: float = 0.5

    name: ClassVar[str] = "bump"
    equation: ClassVar[str] = "h exp(−(q − c)²/w²)"
    traits: ClassVar[Traits] = Traits({Signal.POSITION})
    parameters = (Parameter("height", "{effort}"),)
    shape = (
        Parameter("centre", "{position}", lower=-7.0, upper=7.0),
        Parameter("width", "{position}", lower=0.05, upper=3.0),
    )

    def columns(self, x: JointState) -> Sequence[np.ndarray]:
        """Return the column of the height."""
        return [np.exp(-(((x.q - self.centre) / self.width) ** 2))]

    def shape_grid(self, x: State) -> Sequence["Bump"]:
        """Return centres and widths, each a factor from the next."""
        return [replace(self, centre=c, width=w) for c in (0.1, 0.4, 0.8) for w in (0.2, 0.4, 0.8)]


def test_every_shape_of_an_effect_is_refined():
    robot = load_robot("scara")
    true = Bump(robot.joints[0], centre=0.5, width=0.5)
    rng = np.random.default_rng(1)
    path = exciting_trajectory(robot, rng, duration=10.0)
    plant = Dynamics(robot, (Term.of(true, height=5.0),))
    log = simulate(plant, path, duration=10.0, sensors=Sensors(effort_noise=0.02), rng=rng)

    found = add_effect(Dynamics(robot), Bump(robot.joints[0]), log).steps[0].term
    assert found is not None
    assert found.effect.shape_values == pytest.approx(true.shape_values, rel=0.05)


RIPPLE = "position_ripple@joint{}: frequency={}, sine={}, cosine={}"


def rippled(*frequencies):
    """Return the equations of a log with a ripple of each joint and an offset of the first one."""
    robot = load_robot("double_pendulum")
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    ripples = [parse_term(RIPPLE.format(j, f, 0.4, 0.2)) for j, f in enumerate(frequencies, 1)]
    terms = (*ripples, parse_term("torque_offset@joint1: offset=0.3"))
    effort = Dynamics(robot, terms).inverse_dynamics(q, v, a)
    effort += np.random.default_rng(0).normal(0.0, 0.02, effort.shape)
    logs = Problem.conditioned(robot, [Log(robot.joints, t, q, effort)], [], DiscoverySettings())
    return robot, logs.around(Dynamics(robot)).with_first_noise(Dynamics(robot, terms)).regression


def together(robot, regression, *starts, moving=(0, 1)):
    """Return the terms after a fit from other frequencies and amplitudes."""
    ripples = [parse_term(RIPPLE.format(j, f, 0.1, 0.1)) for j, f in enumerate(starts, 1)]
    model = Dynamics(robot, (*ripples, parse_term("torque_offset@joint1: offset=0.0")))
    labels = [t.label for k, t in enumerate(ripples) if k in moving]
    return with_shapes_fitted(regression, model, labels).terms


@pytest.mark.parametrize("start", [(6.8, 10.3), (7.2, 9.7)])
def test_shapes_and_parameters_are_fitted_together(start):
    one, two, offset = together(*rippled(7.0, 10.0), *start)
    for ripple, frequency in ((one, 7.0), (two, 10.0)):
        assert ripple.effect.shape_values["frequency"] == pytest.approx(frequency, abs=0.02)
        assert ripple.theta == pytest.approx((0.4, 0.2), abs=0.02)
    assert offset.theta == pytest.approx((0.3,), abs=0.01)


def test_shapes_that_are_not_asked_for_stay():
    one, two, _ = together(*rippled(7.0, 10.0), 6.8, 10.1, moving=(1,))
    assert one.effect.shape_values["frequency"] == 6.8
    assert two.effect.shape_values["frequency"] == pytest.approx(10.0, abs=0.02)


def test_a_shape_stays_where_the_motion_can_show_it_and_stops_no_other():
    one, two, _ = together(*rippled(3.0, 10.0), 5.5, 10.3)  # below 5 rad⁻¹ a ripple is a spring
    assert one.effect.shape_values["frequency"] == pytest.approx(5.0)
    assert two.effect.shape_values["frequency"] == pytest.approx(10.0, abs=0.02)
